/* SPDX-License-Identifier: MIT */
#include "synth_cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Factors from a motion per frame to the rms of the hand's shake that makes it: A_FRAME from the rms of the motion,
 * AT_MOST from its maximum, which is 2.6 times the rms. */
#define A_FRAME (1.0 / 0.46)
#define AT_MOST (A_FRAME / 2.6)

#define DEGREE 0.017453292519943295
#define BASE .width = 1280, .height = 720, .fps = 30.0, .seed = 1
#define NOISY BASE, .noise = 5.0
#define HAND NOISY, .pan_x = 1.0, .shake = 8.0, .roll = 0.006, .zoom = 0.002
#define WALK BASE, .noise = 2.0, .hold = SYNTH_WALK, .pan_x = 2.0, .shake = 14.0, .roll = 0.01, .zoom = 0.003
#define EVENT(kind, from, frames, amount) {SYNTH_##kind, from, frames, amount}

const SynthCase synth_cases[] = {
    {"tripod", SYNTH_CASE_PLANAR, {NOISY}},
    {"shake 0.5 px a frame", SYNTH_CASE_PLANAR, {NOISY, .shake = 0.5 * A_FRAME, .roll = 0.0005}},
    {"shake 1 px", SYNTH_CASE_PLANAR, {NOISY, .pan_x = 0.5, .shake = 1.0 * A_FRAME, .roll = 0.001}},
    {"shake 2 px", SYNTH_CASE_PLANAR, {NOISY, .pan_x = 1.0, .shake = 2.0 * A_FRAME, .roll = 0.002}},
    {"shake 5 px", SYNTH_CASE_PLANAR, {NOISY, .pan_x = 1.0, .shake = 5.0 * A_FRAME, .roll = 0.005, .zoom = 0.002}},
    {"shake 10 px", SYNTH_CASE_PLANAR, {NOISY, .pan_x = 2.0, .shake = 10.0 * A_FRAME, .roll = 0.01, .zoom = 0.005}},
    {"shake 20 px", SYNTH_CASE_PLANAR, {NOISY, .pan_x = 2.0, .shake = 20.0 * A_FRAME, .roll = 0.02, .zoom = 0.01}},
    {"shake 30 px", SYNTH_CASE_PLANAR, {NOISY, .pan_x = 2.0, .shake = 30.0 * A_FRAME, .roll = 0.02, .zoom = 0.01}},
    {"roll to 3 degrees a frame", SYNTH_CASE_PLANAR, {NOISY, .shake = 4.0, .roll = 3.0 * DEGREE * AT_MOST}},
    {"zoom to 5 % a frame", SYNTH_CASE_PLANAR, {NOISY, .shake = 4.0, .zoom = 0.05 * AT_MOST}},
    {"shake 10 px, roll, zoom", SYNTH_CASE_PLANAR,
     {NOISY, .shake = 10.0 * A_FRAME, .roll = 3.0 * DEGREE * AT_MOST, .zoom = 0.05 * AT_MOST}},
    {"pan 60 px a frame", SYNTH_CASE_PLANAR, {NOISY, .pan_x = 60.0, .shake = 2.0, .roll = 0.002}},

    {"standing", SYNTH_CASE_HOLD, {BASE, .noise = 2.0, .hold = SYNTH_STAND, .shake = 8.0, .roll = 0.003}},
    {"walking", SYNTH_CASE_HOLD, {WALK}},
    {"vehicle", SYNTH_CASE_HOLD,
     {BASE, .noise = 2.0, .hold = SYNTH_VEHICLE, .pan_x = 4.0, .shake = 20.0, .roll = 0.006}},
    {"walking, some depth", SYNTH_CASE_HOLD, {WALK, .parallax = 0.3}},
    {"walking, much depth", SYNTH_CASE_HOLD, {WALK, .parallax = 1.0}},
    {"walking, shutter half open", SYNTH_CASE_HOLD, {WALK, .exposure = 0.5}},
    {"shake 20 px, shutter open", SYNTH_CASE_HOLD, {NOISY, .shake = 20.0 * A_FRAME, .roll = 0.01, .exposure = 1.0}},
    {"walking, rolling shutter", SYNTH_CASE_HOLD, {WALK, .readout = 0.025}},
    {"engine 20 Hz, rolling shutter", SYNTH_CASE_HOLD,
     {WALK, .readout = 0.025, .vibration = 4.0, .vibration_roll = 0.002, .vibration_hz = 20.0}},

    {"mover on 20 %", SYNTH_CASE_MOVER, {HAND, .foreground = 0.2, .movers = 1, .mover_speed = 8.0}},
    {"mover on 40 %, slow", SYNTH_CASE_MOVER, {HAND, .foreground = 0.4, .movers = 1, .mover_speed = 2.0}},
    {"mover on 40 %", SYNTH_CASE_MOVER, {HAND, .foreground = 0.4, .movers = 1, .mover_speed = 8.0}},
    {"mover on 40 %, fast", SYNTH_CASE_MOVER, {HAND, .foreground = 0.4, .movers = 1, .mover_speed = 25.0}},
    {"mover on 40 %, in the frame", SYNTH_CASE_MOVER, {HAND, .foreground = 0.4}},
    {"mover on 40 %, tripod", SYNTH_CASE_MOVER, {NOISY, .foreground = 0.4, .movers = 1, .mover_speed = 8.0}},
    {"mover on 60 %", SYNTH_CASE_MOVER, {HAND, .foreground = 0.6, .movers = 1, .mover_speed = 8.0}},
    {"walkers on 25 %", SYNTH_CASE_MOVER, {HAND, .foreground = 0.25, .movers = 7, .mover_speed = 6.0}},
    {"walkers on 50 %", SYNTH_CASE_MOVER, {HAND, .foreground = 0.5, .movers = 10, .mover_speed = 6.0}},

    {"cut", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(CUT, 70, 0, 0)}}},
    {"cut through black", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(BLACK, 70, 8, 0), EVENT(CUT, 74, 0, 0)}}},
    {"fade out, another in", SYNTH_CASE_EVENT,
     {HAND, .event = {EVENT(FADE_OUT, 60, 15, 0), EVENT(CUT, 80, 0, 0), EVENT(FADE_IN, 80, 15, 0)}}},
    {"fade out and in again", SYNTH_CASE_EVENT,
     {HAND, .event = {EVENT(FADE_OUT, 60, 15, 0), EVENT(FADE_IN, 80, 15, 0)}}},
    {"dissolve of 10", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(DISSOLVE, 70, 10, 0)}}},
    {"dissolve of 30", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(DISSOLVE, 70, 30, 0)}}},
    {"flash", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(FLASH, 70, 2, 0.9)}}},
    {"black frames", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(BLACK, 70, 10, 0)}}},
    {"lens covered 1 s", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(COVER, 70, 30, 0)}}},
    {"lens covered 2 s", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(COVER, 60, 60, 0)}}},
    {"out of focus", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(BLUR, 70, 20, 16.0)}}},
    {"dark for 1 s", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(GAIN, 70, 30, 0.03)}}},
    {"darker by half", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(RAMP, 60, 30, 0.5)}}},
    {"flicker", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(FLICKER, 45, 80, 0.2)}}},
    {"dark throughout", SYNTH_CASE_EVENT, {HAND, .event = {EVENT(GAIN, 0, 100000, 0.12)}}},

    {"every 5th frame again", SYNTH_CASE_REPEAT, {HAND, .repeat_every = 5}},
    {"nearly again", SYNTH_CASE_REPEAT, {HAND, .repeat_every = 5, .fresh_noise = true}},
    {"every 2nd, coded", SYNTH_CASE_REPEAT, {HAND, .repeat_every = 2, .coding = 6.0}},
    {"frozen for 6 frames", SYNTH_CASE_REPEAT, {HAND, .event = {EVENT(FREEZE, 70, 6, 0)}}},
    {"coarsely coded", SYNTH_CASE_REPEAT, {HAND, .coding = 16.0}},

    {"logo and timecode", SYNTH_CASE_OVERLAY, {HAND, .overlay = SYNTH_OVERLAY_LOGO | SYNTH_OVERLAY_TIMECODE}},
    {"logo and timecode, dark", SYNTH_CASE_OVERLAY,
     {HAND, .overlay = SYNTH_OVERLAY_LOGO | SYNTH_OVERLAY_TIMECODE, .event = {EVENT(GAIN, 0, 100000, 0.12)}}},
    {"letterbox", SYNTH_CASE_OVERLAY, {HAND, .letterbox = 0.25}},
    {"pillarbox and logo", SYNTH_CASE_OVERLAY, {HAND, .pillarbox = 0.4, .overlay = SYNTH_OVERLAY_LOGO}},
};

const int synth_case_count = sizeof synth_cases / sizeof *synth_cases;

const SynthCase *synth_case_named(const char *name)
{
    for (int i = 0; i < synth_case_count; i++)
        if (strcmp(synth_cases[i].name, name) == 0)
            return &synth_cases[i];
    abort();
}

SynthConfig synth_case_at(const SynthCase *c, int width)
{
    const double scale = (double)width / c->cfg.width;
    SynthConfig cfg = c->cfg;
    cfg.width = width;
    cfg.height = (int)lrint(c->cfg.height * scale);
    cfg.pan_x *= scale, cfg.pan_y *= scale;
    cfg.shake *= scale, cfg.vibration *= scale, cfg.mover_speed *= scale;
    for (int k = 0; k < SYNTH_MAX_EVENTS; k++)
        if (cfg.event[k].kind == SYNTH_BLUR)
            cfg.event[k].amount *= scale;
    return cfg;
}
