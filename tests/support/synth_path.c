/* SPDX-License-Identifier: MIT */
#include "synth_path.h"

#include <math.h>
#include <string.h>

#include "synth_scene.h"

enum { TONES = 6 };

enum { CHANNEL_X, CHANNEL_Y, CHANNEL_ROLL, CHANNEL_ZOOM };

static const double two_pi = 6.283185307179586;

/* The hand's shake: tones from 0.6 to 7 Hz, weaker the faster, of rms 1 in all. */
static double shake(const SynthConfig *cfg, int channel, double frames)
{
    static const double hz[TONES] = {0.6, 1.1, 1.9, 3.1, 4.7, 7.0};
    double sum = 0.0, power = 0.0;
    for (int k = 0; k < TONES; k++) {
        const uint64_t key = synth_hash(cfg->seed) + (uint64_t)(16 * channel + 2 * k);
        const double amplitude = 1.0 / sqrt(hz[k]);
        const double f = hz[k] * (0.85 + 0.3 * synth_fraction(key));
        sum += amplitude * sin(two_pi * (f * frames / cfg->fps + synth_fraction(key + 1)));
        power += 0.5 * amplitude * amplitude;
    }
    return sum / sqrt(power);
}

/* An engine: one tone, of amplitude 1. */
static double vibration(const SynthConfig *cfg, int channel, double frames)
{
    const double phase = synth_fraction(synth_hash(cfg->seed) + (uint64_t)(16 * channel + 15));
    return sin(two_pi * (cfg->vibration_hz * frames / cfg->fps + phase));
}

void synth_path_pose(const SynthConfig *cfg, double frames, double M[9])
{
    const double zoom = exp(cfg->zoom * shake(cfg, CHANNEL_ZOOM, frames));
    const double roll = cfg->turn * frames + cfg->roll * shake(cfg, CHANNEL_ROLL, frames) +
                        cfg->vibration_roll * vibration(cfg, CHANNEL_ROLL, frames);
    const double a = zoom * cos(roll), b = zoom * sin(roll);
    const double x = cfg->pan_x * frames + cfg->shake * shake(cfg, CHANNEL_X, frames) +
                     cfg->vibration * vibration(cfg, CHANNEL_X, frames);
    const double y = cfg->pan_y * frames + cfg->shake * shake(cfg, CHANNEL_Y, frames) +
                     cfg->vibration * vibration(cfg, CHANNEL_Y, frames);
    memcpy(M, (double[9]){a, -b, x, b, a, y, 0.0, 0.0, 1.0}, 9 * sizeof *M);
}
