/* SPDX-License-Identifier: MIT */
#include "synth_mover.h"

#include <math.h>

#include "synth_scene.h"

static const double pi = 3.141592653589793;

/* It moves in the frame, independent of the camera's shake. */
static SynthMover disc_at(const SynthConfig *cfg, double frames)
{
    const double size = sqrt((double)cfg->width * cfg->height), radius = size * sqrt(cfg->foreground / pi);
    return (SynthMover){0.12 * size * sin(0.13 * frames), 0.05 * size * cos(0.11 * frames), radius, radius,
                        300.0, 500.0};
}

/* Places a mover in the frame. (x, y) are scene coordinates that drift with the camera's pan, so that movers stay in
 * view. */
static void place(const SynthConfig *cfg, double frames, const double M[9], double x, double y, SynthMover *mover)
{
    const double norm = M[0] * M[0] + M[3] * M[3];
    const double dx = x + cfg->pan_x * frames - M[2], dy = y + cfg->pan_y * frames - M[5];
    mover->x = (M[0] * dx + M[3] * dy) / norm;
    mover->y = (M[0] * dy - M[3] * dx) / norm;
}

/* It has the frame's proportions, and moves to and fro by a tenth of the width. */
static SynthMover subject_at(const SynthConfig *cfg, double frames, const double M[9])
{
    const double reach = 0.05 * cfg->width, extent = sqrt(cfg->foreground / pi);
    SynthMover mover = {.half_w = cfg->width * extent, .half_h = cfg->height * extent};
    mover.texture_x = 300.0, mover.texture_y = 500.0;
    const double x = cfg->mover_x * cfg->width + reach * sin(cfg->mover_speed / reach * frames);
    place(cfg, frames, M, x, 0.0, &mover);
    return mover;
}

/* Twice as high as wide; where one leaves the frame on one side, the next comes in on the other. */
static SynthMover walker_at(const SynthConfig *cfg, double frames, const double M[9], int k)
{
    const uint64_t key = synth_hash(cfg->seed) + 1000u + (uint64_t)(8 * k);
    const double area = cfg->foreground * cfg->width * cfg->height / cfg->movers;
    const double half_w = sqrt(0.5 * area / pi), margin = half_w + 100.0, track = cfg->width + 2.0 * margin;
    const double speed = cfg->mover_speed * (0.6 + 0.8 * synth_fraction(key)) * (k % 2 ? -1.0 : 1.0);
    const double along = (k + synth_fraction(key + 1)) / cfg->movers * track + speed * frames;
    SynthMover mover = {.half_w = half_w, .half_h = 2.0 * half_w};
    mover.texture_x = 300.0 + 230.0 * k, mover.texture_y = 500.0 + 370.0 * k;
    place(cfg, frames, M, along - track * floor(along / track) - 0.5 * track,
          (0.4 * synth_fraction(key + 2) - 0.1) * cfg->height, &mover);
    return mover;
}

int synth_movers_at(const SynthConfig *cfg, double frames, const double M[9], SynthMover mover[SYNTH_MAX_MOVERS])
{
    if (cfg->foreground <= 0.0)
        return 0;
    if (cfg->movers <= 1) {
        mover[0] = cfg->movers ? subject_at(cfg, frames, M) : disc_at(cfg, frames);
        return 1;
    }
    const int count = cfg->movers < SYNTH_MAX_MOVERS ? cfg->movers : SYNTH_MAX_MOVERS;
    for (int k = 0; k < count; k++)
        mover[k] = walker_at(cfg, frames, M, k);
    return count;
}
