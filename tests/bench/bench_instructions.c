/* SPDX-License-Identifier: MIT */
/*
 * Runs one of the library's inner loops a number of times and prints nothing, for a program that counts instructions
 * (tests/cross/count-instructions.sh). Where a processor is emulated its time says nothing.
 *
 * usage: bench_instructions WORK simd|plain COUNT
 *   WORK: bilinear, bicubic, lanczos: a frame of 1280x720 is warped, 8 bits (10 with bilinear-10, ...), turned by 1
 *         degree and zoomed by 1/0.9; take, compare: a window of Lucas-Kanade; scale: a row of 1280 pixels to 640
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/cpu.h"
#include "common/rng.h"
#include "image/area_scale_row.h"
#include "motion/lucas_kanade.h"
#include "warp/warp.h"

enum { WIDTH = 1280, HEIGHT = 720, SAMPLE_BYTES = 2 };

static void randomize(uint8_t *at, size_t bytes)
{
    L1L2Rng rng = l1l2_rng_seeded(1);
    for (size_t i = 0; i < bytes; i++)
        at[i] = (uint8_t)l1l2_rng_below(&rng, i % 2 ? 4 : 256); /* two bytes are also a sample of 10 bits */
}

static void warp(L1L2StabInterpolation interpolation, bool ten_bits, bool plain, int count)
{
    static uint8_t src[WIDTH * HEIGHT * SAMPLE_BYTES], dst[WIDTH * HEIGHT * SAMPLE_BYTES];
    const L1L2WarpConfig cfg = {
        .format = l1l2_image_format_info(ten_bits ? L1L2STAB_FORMAT_I420_10LE : L1L2STAB_FORMAT_I420),
        .in_width = WIDTH, .in_height = HEIGHT, .out_width = WIDTH, .out_height = HEIGHT,
        .interpolation = interpolation, .plain = plain};
    L1L2Warp *w;
    if (l1l2_warp_create(&w, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    const double angle = 0.0174, zoom = 0.9;
    const L1L2WarpMap map = {.affine = l1l2_mat_similarity(zoom * cos(angle), zoom * sin(angle), 3.3, -2.7)};
    const ptrdiff_t stride = WIDTH * (ten_bits ? SAMPLE_BYTES : 1), chroma = stride / 2;
    /* All planes are read from one, and written to one: only the work counts. */
    const uint8_t *const from[4] = {src, src, src, src};
    uint8_t *const to[4] = {dst, dst, dst, dst};
    const ptrdiff_t strides[4] = {stride, chroma, chroma, chroma};
    randomize(src, sizeof src);
    for (int i = 0; i < count; i++)
        l1l2_warp_render(w, &map, from, strides, to, strides);
    l1l2_warp_free(w);
}

static void follow(bool compare, bool plain, int count)
{
    enum { SIDE = 64 };
    static uint8_t grey[SIDE * SIDE];
    static int16_t slope[SIDE * SIDE * 2];
    const L1L2LkLevel level = {grey, slope, SIDE, 2 * SIDE, SIDE, SIDE};
    const L1L2LkPlace place = {.x = 20, .y = 20, .weight = {8192, 4096, 2048, 2048}};
    L1L2LkFunctions functions;
    l1l2_lk_functions_init(&functions, plain ? L1L2_CPU_PLAIN : l1l2_cpu_features());
    L1L2LkPatch patch = {0};
    randomize(grey, sizeof grey);
    for (int i = 0; i < count; i++)
        compare ? functions.compare(&level, &place, &patch) : functions.take(&level, &place, &patch);
}

static void scale(bool plain, int count)
{
    enum { TAPS = L1L2_AREA_SCALE_BLOCK, OUT = WIDTH / 2 };
    static int16_t samples[WIDTH + TAPS], weight[OUT * TAPS];
    static int32_t first[OUT], sum[OUT];
    L1L2AreaScaleFunctions functions;
    l1l2_image_scale_functions_init(&functions, plain ? L1L2_CPU_PLAIN : l1l2_cpu_features());
    for (int x = 0; x < OUT; x++)
        first[x] = 2 * x;
    for (int i = 0; i < count; i++)
        functions.row(samples, first, weight, TAPS, OUT, sum);
}

int main(int argc, char **argv)
{
    static const char *const kernels[] = {"bilinear", "bicubic", "lanczos"};
    if (argc != 4 || (strcmp(argv[2], "simd") != 0 && strcmp(argv[2], "plain") != 0)) {
        fprintf(stderr, "usage: bench_instructions WORK simd|plain COUNT\n");
        return EXIT_FAILURE;
    }
    const char *what = argv[1];
    const bool plain = strcmp(argv[2], "plain") == 0, ten_bits = strstr(what, "-10") != NULL;
    const int count = atoi(argv[3]);
    if (strcmp(what, "scale") == 0)
        scale(plain, count);
    else if (strcmp(what, "take") == 0 || strcmp(what, "compare") == 0)
        follow(strcmp(what, "compare") == 0, plain, count);
    else
        for (int k = 0; k < 3; k++)
            if (strncmp(what, kernels[k], strlen(kernels[k])) == 0)
                warp((L1L2StabInterpolation)k, ten_bits, plain, count);
    return EXIT_SUCCESS;
}
