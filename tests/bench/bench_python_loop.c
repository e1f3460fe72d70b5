/* SPDX-License-Identifier: MIT */
/*
 * Informational: the loop of l1l2stab.h, for tests/bench/bench_python.py, which runs the same loop in Python. The
 * frames of a raw file are played forward and backward from memory. Prints the wall and the CPU time, ms per frame.
 *
 * usage: bench_python_loop FILE FORMAT WIDTH HEIGHT PLAYED    FORMAT: I420 or BGR; PLAYED: how many frames are pushed
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <l1l2stab/l1l2stab.h>

enum { MAX_CLIP = 64 };

typedef struct Clip {
    L1L2StabFormat format;
    int width, height; /* pixels */
    size_t bytes;      /* of a frame */
    uint8_t *frame[MAX_CLIP];
    int frames;
} Clip;

static void set_planes(L1L2StabFrame *frame, uint8_t *memory, const Clip *clip)
{
    frame->data[0] = memory;
    if (clip->format == L1L2STAB_FORMAT_BGR) {
        frame->stride[0] = (ptrdiff_t)clip->width * 3;
        return;
    }
    frame->stride[0] = clip->width;
    frame->stride[1] = frame->stride[2] = clip->width / 2;
    frame->data[1] = memory + (size_t)clip->width * (size_t)clip->height;
    frame->data[2] = frame->data[1] + (size_t)clip->width * (size_t)clip->height / 4;
}

static void read_clip(Clip *clip, const char *path)
{
    FILE *file = fopen(path, "rb");
    while (file && clip->frames < MAX_CLIP) {
        uint8_t *memory = malloc(clip->bytes);
        if (!memory || fread(memory, 1, clip->bytes, file) != clip->bytes) {
            free(memory);
            break;
        }
        clip->frame[clip->frames++] = memory;
    }
    if (file)
        fclose(file);
}

static int pull_ready(L1L2Stab *s, L1L2StabFrame *out)
{
    int pulled = 0;
    while (l1l2stab_pull(s, out, NULL) == L1L2STAB_OK)
        pulled++;
    return pulled;
}

/* Returns the number of frames that came out. */
static int run(L1L2Stab *s, const Clip *clip, int played, uint8_t *memory)
{
    L1L2StabFrame in = {0}, out = {0};
    int pulled = 0;
    set_planes(&out, memory, clip);
    for (int t = 0; t < played; t++) {
        const int period = 2 * clip->frames - 2, phase = t % period;
        set_planes(&in, clip->frame[phase < clip->frames ? phase : period - phase], clip);
        in.pts = L1L2STAB_NO_PTS;
        if (l1l2stab_push(s, &in) != L1L2STAB_OK)
            return pulled;
        pulled += pull_ready(s, &out);
    }
    l1l2stab_finish(s);
    return pulled + pull_ready(s, &out);
}

static double now_ms(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

int main(int argc, char **argv)
{
    if (argc != 6)
        return 2;
    Clip clip = {.width = atoi(argv[3]), .height = atoi(argv[4])};
    clip.format = strcmp(argv[2], "BGR") == 0 ? L1L2STAB_FORMAT_BGR : L1L2STAB_FORMAT_I420;
    const size_t pixels = (size_t)clip.width * (size_t)clip.height;
    clip.bytes = clip.format == L1L2STAB_FORMAT_BGR ? 3 * pixels : pixels * 3 / 2;
    read_clip(&clip, argv[1]);
    uint8_t *memory = malloc(clip.bytes);
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = clip.format, cfg.width = clip.width, cfg.height = clip.height;
    cfg.frame_rate = 30;
    L1L2Stab *s = NULL;
    const int played = atoi(argv[5]);
    if (!memory || clip.frames < 2 || l1l2stab_create(&s, &cfg) != L1L2STAB_OK)
        return 1;

    const double wall_ms = now_ms(CLOCK_MONOTONIC), cpu_ms = now_ms(CLOCK_PROCESS_CPUTIME_ID);
    const int pulled = run(s, &clip, played, memory);
    printf("%.4f %.4f\n", (now_ms(CLOCK_MONOTONIC) - wall_ms) / played,
           (now_ms(CLOCK_PROCESS_CPUTIME_ID) - cpu_ms) / played);

    l1l2stab_free(&s);
    free(memory);
    for (int i = 0; i < clip.frames; i++)
        free(clip.frame[i]);
    return pulled == played ? 0 : 1;
}
