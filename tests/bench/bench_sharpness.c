/* SPDX-License-Identifier: MIT */
/*
 * Informational: how much sharpness pulses. Prints the gradient energy of the output, in percent of the source's, over
 * a pan of 0.05 px per frame, for each kernel: for a crop that is zoomed to fill the frame (output-size=input) and
 * without zoom (output-size=crop). With zoom, every frame has all phases, so the energy hardly changes. Without zoom, a
 * frame has one phase.
 *
 * usage: bench_sharpness [FRAME.pgm ...]     binary, 8 bits, no comment; default: a frame of the test scene
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "synth.h"
#include "warp/warp.h"

enum { FRAMES = 41, MARGIN = 8 };
static const double PAN_PX = 0.05, CROP = 0.9;

static double gradient_energy(const uint8_t *data, ptrdiff_t stride, int width, int height)
{
    double sum = 0.0;
    for (int v = MARGIN; v < height - MARGIN; v++)
        for (int u = MARGIN; u < width - MARGIN; u++) {
            const uint8_t *p = data + v * stride + u;
            const double dx = p[1] - p[0], dy = p[stride] - p[0];
            sum += dx * dx + dy * dy;
        }
    return sum / ((width - 2.0 * MARGIN) * (height - 2.0 * MARGIN));
}

typedef struct Gray {
    int width, height;
    uint8_t *data;
} Gray;

static Gray scene(void)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 1280, cfg.height = 720;
    Synth *synth = synth_new(&cfg);
    SynthPicture picture = synth_picture_new(L1L2STAB_FORMAT_GRAY8, cfg.width, cfg.height);
    synth_render(synth, 0, L1L2STAB_FORMAT_GRAY8, picture.data, picture.stride);
    synth_free(synth);
    return (Gray){cfg.width, cfg.height, picture.data[0]};
}

static Gray read_pgm(const char *name)
{
    Gray gray = {0, 0, NULL};
    FILE *file = fopen(name, "rb");
    if (!file || fscanf(file, "P5 %d %d 255", &gray.width, &gray.height) != 2 || fgetc(file) == EOF ||
        !(gray.data = malloc((size_t)gray.width * (size_t)gray.height)) ||
        fread(gray.data, (size_t)gray.width, (size_t)gray.height, file) != (size_t)gray.height) {
        fprintf(stderr, "%s: not a PGM of 8 bits\n", name);
        exit(EXIT_FAILURE);
    }
    fclose(file);
    return gray;
}

static void bench(const Gray *src, L1L2StabInterpolation interpolation, bool zoomed, bool diagonal)
{
    static const char *const names[] = {"bilinear", "bicubic", "lanczos"};
    const int width = zoomed ? src->width : (int)(CROP * src->width);
    const int height = zoomed ? src->height : (int)(CROP * src->height);
    const L1L2WarpConfig cfg = {.format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .in_width = src->width,
                                .in_height = src->height, .out_width = width, .out_height = height,
                                .interpolation = interpolation};
    L1L2Warp *warp;
    uint8_t *out = malloc((size_t)width * (size_t)height);
    if (!out || l1l2_warp_create(&warp, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    const double whole = gradient_energy(src->data, src->width, src->width, src->height);
    double least = INFINITY, most = 0.0;
    for (int t = 0; t < FRAMES; t++) {
        const double zoom = zoomed ? CROP : 1.0, at = PAN_PX * t;
        const L1L2WarpMap map = {.affine = {{zoom, 0, at, 0, zoom, diagonal ? at : 0, 0, 0, 1}}};
        const uint8_t *const from[4] = {src->data};
        uint8_t *const dst[4] = {out};
        const ptrdiff_t from_stride[4] = {src->width}, stride[4] = {width};
        l1l2_warp_render(warp, &map, from, from_stride, dst, stride);
        const double energy = gradient_energy(out, width, width, height);
        least = fmin(least, energy);
        most = fmax(most, energy);
    }
    printf("  %-6s %-9s %-9s least %5.1f   most %5.1f   pulse %5.2f %%\n", zoomed ? "input" : "crop",
           names[interpolation], diagonal ? "diagonal" : "across", 100 * least / whole, 100 * most / whole,
           100 * (most - least) / most);
    l1l2_warp_free(warp);
    free(out);
}

int main(int argc, char **argv)
{
    printf("gradient energy of a frame, %% of the source's, over a pan of %.2f px per frame\n", PAN_PX);
    for (int i = 1; i < argc || i == 1; i++) {
        const Gray src = argc > 1 ? read_pgm(argv[i]) : scene();
        printf("%s, %dx%d\n", argc > 1 ? argv[i] : "the test scene", src.width, src.height);
        for (int zoomed = 1; zoomed >= 0; zoomed--)
            for (int k = 0; k < 3; k++)
                for (int diagonal = 0; diagonal < 2; diagonal++)
                    bench(&src, (L1L2StabInterpolation)k, zoomed, diagonal);
        free(src.data);
    }
    return EXIT_SUCCESS;
}
