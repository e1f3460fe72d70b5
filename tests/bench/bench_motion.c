/* SPDX-License-Identifier: MIT */
/*
 * The library on synthetic clips at its defaults: its measured motion and its stabilized output against the truth.
 *
 * error: of F_t, rms over the frame's corners, px; over all frames whose motion was measured, and the worst. drift:
 * error of the product of all F_t since the shot began. lost: frames without a measured motion. starts: paths after the
 * first. jitter: rms acceleration of the true camera and of the stabilized picture, px. Times are those of one core if
 * the process is bound to one.
 *
 * usage: bench_motion [WIDTH [FRAMES [CASE]]]      default: 1280 300, all; CASE is part of a name
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "synth_cases.h"
#include "synth_trial.h"

static const char *const kinds[] = {"planar, noise 5", "hand-held, walking, vehicle",
                                    "movers", "events", "repeated", "overlays"};

static int ascending(const void *a, const void *b)
{
    return *(const double *)a < *(const double *)b ? -1 : *(const double *)a > *(const double *)b;
}

static void print_trial(const char *name, const SynthTrial *t)
{
    printf("%-30s %7.3f %7.3f %7.2f  %5.2f %5d %5d   %6.2f %6.2f %s  %5.2f %5.2f %5.2f\n", name, t->rms, t->worst,
           t->drift, t->quality, t->lost, t->starts, t->jitter_in, t->jitter_out,
           t->jitter_out > t->jitter_in ? "WORSE" : "     ", t->stage_ms[L1L2STAB_STAGE_SCALE],
           t->stage_ms[L1L2STAB_STAGE_TRACK], t->stage_ms[L1L2STAB_STAGE_FIT]);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    const int width = argc > 1 ? atoi(argv[1]) : 1280, frames = argc > 2 ? atoi(argv[2]) : 300;
    double rms[64], drift[64];
    size_t planar = 0;
    printf("%4dx%-4d, %3d frames", width, width * 9 / 16, frames);
    printf("                error, px   drift                       jitter, px         ms a frame\n");
    printf("                                   rms   worst      px  quality lost starts   in    out        scale track"
           "   fit\n");
    for (int i = 0; i < synth_case_count; i++) {
        const SynthCase *c = &synth_cases[i];
        if (argc > 3 && !strstr(c->name, argv[3]))
            continue;
        if (i == 0 || c->kind != c[-1].kind)
            printf("-- %s\n", kinds[c->kind]);
        const SynthConfig cfg = synth_case_at(c, width);
        SynthTrial trial = synth_trial_new(&cfg, frames);
        print_trial(c->name, &trial);
        if (c->kind == SYNTH_CASE_PLANAR && planar < sizeof rms / sizeof *rms) {
            rms[planar] = trial.rms;
            drift[planar++] = trial.drift;
        }
        synth_trial_free(&trial);
    }
    if (planar > 0) {
        qsort(rms, planar, sizeof *rms, ascending);
        qsort(drift, planar, sizeof *drift, ascending);
        printf("planar clips: error %.3f in the median, %.3f at worst; drift %.2f and %.2f\n", rms[planar / 2],
               rms[planar - 1], drift[planar / 2], drift[planar - 1]);
    }
    return EXIT_SUCCESS;
}
