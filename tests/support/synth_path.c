/* SPDX-License-Identifier: MIT */
/* A shake is a sum of tones, scaled to an rms of 1. */
#include "synth_path.h"

#include <math.h>
#include <string.h>

#include "synth_scene.h"

enum { TONES = 8 };

enum { CHANNEL_X, CHANNEL_Y, CHANNEL_ROLL, CHANNEL_ZOOM };

typedef struct Tone {
    double hz, amplitude;
} Tone;

static const double two_pi = 6.283185307179586;

/* A walker's body falls with each step, and leans from foot to foot half as often. */
static const Tone steps[TONES] = {{0.4, 0.4}, {2.0, 1.0}, {4.0, 0.4}, {6.0, 0.15}, {8.0, 0.05}};
static const Tone leans[TONES] = {{0.3, 0.5}, {1.0, 1.0}, {2.0, 0.4}, {3.0, 0.25}, {5.0, 0.1}};
static const Tone standing[TONES] = {{0.1, 1.0}, {0.2, 0.5}, {0.4, 0.25}, {0.8, 0.125}, {1.6, 0.06}, {3.2, 0.03},
                                     {9.0, 0.03}};
static const Tone driving[TONES] = {{0.25, 1.0}, {0.6, 0.5}, {1.4, 0.3}, {10.5, 0.12}, {13.0, 0.15}, {16.0, 0.12},
                                    {19.0, 0.1}};

static uint64_t key_of(const SynthConfig *cfg, int channel)
{
    return synth_hash(cfg->seed) + (uint64_t)(16 * channel);
}

/* The tones of a hold. *spread: whether the seed shifts the frequency of each tone by itself, or of all tones
 * together. */
static int tones_of(SynthHold hold, int channel, Tone tone[TONES], bool *spread)
{
    static const double hand_hz[] = {0.6, 1.1, 1.9, 3.1, 4.7, 7.0};
    const Tone *table = hold == SYNTH_STAND ? standing
                        : hold == SYNTH_VEHICLE ? driving
                        : channel == CHANNEL_Y || channel == CHANNEL_ZOOM ? steps : leans;
    int count = 0;
    *spread = hold != SYNTH_WALK; /* so that harmonics stay harmonics */
    if (hold == SYNTH_HAND)
        for (; count < 6; count++)
            tone[count] = (Tone){hand_hz[count], 1.0 / sqrt(hand_hz[count])};
    else
        for (; count < TONES && table[count].hz > 0.0; count++)
            tone[count] = table[count];
    return count;
}

static double shake(const SynthConfig *cfg, int channel, double frames)
{
    Tone tone[TONES];
    bool spread;
    const int tones = tones_of(cfg->hold, channel, tone, &spread);
    const double pace = 0.85 + 0.3 * synth_fraction(key_of(cfg, 8));
    double sum = 0.0, power = 0.0;
    for (int k = 0; k < tones; k++) {
        const uint64_t key = key_of(cfg, channel) + (uint64_t)(2 * k);
        const double f = tone[k].hz * (spread ? 0.85 + 0.3 * synth_fraction(key) : pace);
        sum += tone[k].amplitude * sin(two_pi * (f * frames / cfg->fps + synth_fraction(key + 1)));
        power += 0.5 * tone[k].amplitude * tone[k].amplitude;
    }
    return sum / sqrt(power);
}

/* An engine: one tone, of amplitude 1. */
static double vibration(const SynthConfig *cfg, int channel, double frames)
{
    return sin(two_pi * (cfg->vibration_hz * frames / cfg->fps + synth_fraction(key_of(cfg, channel) + 15)));
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

void synth_path_motion(const double M[9], const double N[9], double F[9])
{
    const double norm = N[0] * N[0] + N[3] * N[3];
    const double c = N[0] / norm, d = -N[3] / norm; /* the inverse's rotation and scale */
    const double x = M[2] - N[2], y = M[5] - N[5];
    const double a = c * M[0] - d * M[3], b = d * M[0] + c * M[3];
    memcpy(F, (double[9]){a, -b, c * x - d * y, b, a, d * x + c * y, 0.0, 0.0, 1.0}, 9 * sizeof *F);
}
