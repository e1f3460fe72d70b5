/* SPDX-License-Identifier: MIT */
/*
 * Informational: the time of each stage in ms per frame, as the public interface reports it, for sizes from 480p to
 * 2160p. A clip of 24 synthetic frames is drawn once and then played forward and backward, so that drawing does not
 * count.
 *
 * usage: bench_stages [FRAMES [THREADS [HEIGHT]]]     default: 600 frames, as many threads as cores, all sizes
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <l1l2stab/l1l2stab.h>

#include "common/clock.h"
#include "synth.h"

enum { CLIP = 24 };

static int turn(int t)
{
    const int phase = t % (2 * CLIP - 2);
    return phase < CLIP ? phase : 2 * CLIP - 2 - phase;
}

static double cpu_ms(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1e3 * (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-3 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static void bench(int width, int height, int frames, int threads)
{
    SynthConfig scene = synth_defaults();
    scene.width = width, scene.height = height;
    scene.shake = 4.0 * width / 640, scene.pan_x = 1.0;
    Synth *synth = synth_new(&scene);
    SynthPicture clip[CLIP], out = synth_picture_new(L1L2STAB_FORMAT_I420, width, height);
    for (int t = 0; t < CLIP; t++) {
        clip[t] = synth_picture_new(L1L2STAB_FORMAT_I420, width, height);
        synth_render(synth, t, L1L2STAB_FORMAT_I420, clip[t].data, clip[t].stride);
    }
    synth_free(synth);

    L1L2StabConfig cfg;
    L1L2Stab *s;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = width, cfg.height = height;
    cfg.frame_rate = 30;
    cfg.threads = threads;
    if (l1l2stab_create(&s, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    L1L2StabFrame picture = {0};
    memcpy(picture.data, out.data, sizeof picture.data);
    memcpy(picture.stride, out.stride, sizeof picture.stride);
    double stage_ms[L1L2STAB_STAGE_COUNT] = {0};
    int pulled = 0;
    const double cpu_start = cpu_ms();
    const int64_t start_ns = l1l2_clock_ns();
    for (int t = 0; pulled < frames; t++) {
        if (t < frames) {
            L1L2StabFrame in = {.pts = t};
            memcpy(in.data, clip[turn(t)].data, sizeof in.data);
            memcpy(in.stride, clip[turn(t)].stride, sizeof in.stride);
            if (l1l2stab_push(s, &in) != L1L2STAB_OK)
                exit(EXIT_FAILURE);
        } else if (l1l2stab_finish(s) != L1L2STAB_OK) {
            exit(EXIT_FAILURE);
        }
        L1L2StabInfo info;
        while (l1l2stab_pull(s, &picture, &info) == L1L2STAB_OK) {
            for (int i = 0; i < L1L2STAB_STAGE_COUNT; i++)
                stage_ms[i] += 1e-6 * (double)info.stage_ns[i] / frames;
            pulled++;
        }
    }
    const double wall_ms = 1e-6 * (double)(l1l2_clock_ns() - start_ns) / frames;
    printf("%4dx%-4d  %6.2f %6.2f %6.2f %6.2f %6.2f   %7.2f %7.2f  %8.1f\n", width, height,
           stage_ms[L1L2STAB_STAGE_SCALE], stage_ms[L1L2STAB_STAGE_TRACK], stage_ms[L1L2STAB_STAGE_FIT],
           stage_ms[L1L2STAB_STAGE_SOLVE], stage_ms[L1L2STAB_STAGE_WARP], wall_ms,
           (cpu_ms() - cpu_start) / frames, 1e3 / wall_ms);
    fflush(stdout);
    l1l2stab_free(&s);
    for (int t = 0; t < CLIP; t++)
        synth_picture_free(&clip[t]);
    synth_picture_free(&out);
}

int main(int argc, char **argv)
{
    static const int sizes[][2] = {{854, 480}, {1280, 720}, {1920, 1080}, {3840, 2160}};
    const int frames = argc > 1 ? atoi(argv[1]) : 600, threads = argc > 2 ? atoi(argv[2]) : 0;
    const int height = argc > 3 ? atoi(argv[3]) : 0;
    printf("ms per frame, I420, defaults (window 150, bicubic), threads=%d\n", threads);
    printf("size        scale  track    fit  solve   warp      wall     cpu  frames/s\n");
    for (int i = 0; i < 4; i++)
        if (height == 0 || height == sizes[i][1])
            bench(sizes[i][0], sizes[i][1], frames, threads);
    return EXIT_SUCCESS;
}
