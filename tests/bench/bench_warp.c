/* SPDX-License-Identifier: MIT */
/*
 * Informational: the time of the warp in ms per frame, for some sizes, formats, kernels and numbers of threads, and
 * that of a memcpy of the frame. Best and median of 40 frames. Every frame has a map of its own, as in a stabilizer:
 * 0.9 of the frame zoomed to fill it, turned by up to 1 degree.
 *
 * usage: bench_warp
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/clock.h"
#include "common/rng.h"
#include "warp/warp.h"

enum { FRAMES = 40 };

typedef struct Picture {
    uint8_t *data[4];
    ptrdiff_t stride[4];
    size_t size[4];
} Picture;

static Picture make_picture(const L1L2FormatInfo *format, int width, int height)
{
    Picture p = {{NULL}, {0}, {0}};
    L1L2Rng rng = l1l2_rng_seeded(1);
    for (int i = 0; i < format->planes; i++) {
        const int bytes = l1l2_image_format_bytes(format) * format->plane[i].components;
        p.stride[i] = (ptrdiff_t)l1l2_image_plane_size(width, format->plane[i].log2_sub_x) * bytes;
        p.size[i] = (size_t)p.stride[i] * (size_t)l1l2_image_plane_size(height, format->plane[i].log2_sub_y);
        p.data[i] = malloc(p.size[i]);
        if (!p.data[i])
            exit(EXIT_FAILURE);
        for (size_t k = 0; k + 1 < p.size[i]; k += 2) {
            const uint32_t level = format->depth > 8 ? l1l2_rng_below(&rng, 1u << format->depth) << format->shift
                                                     : l1l2_rng_below(&rng, 1u << 16);
            p.data[i][k] = (uint8_t)level;
            p.data[i][k + 1] = (uint8_t)(level >> 8);
        }
    }
    return p;
}

static void free_picture(Picture *p)
{
    for (int i = 0; i < L1L2_MAX_PLANES; i++)
        free(p->data[i]);
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_times(const char *what, double *ms)
{
    qsort(ms, FRAMES, sizeof *ms, compare);
    printf("  %-30s best %7.3f   median %7.3f\n", what, ms[0], ms[FRAMES / 2]);
}

static void bench_copy(const L1L2FormatInfo *format, const Picture *src, Picture *dst)
{
    double ms[FRAMES];
    for (int t = 0; t < FRAMES; t++) {
        const int64_t start = l1l2_clock_ns();
        for (int i = 0; i < format->planes; i++)
            memcpy(dst->data[i], src->data[i], src->size[i]);
        ms[t] = (double)(l1l2_clock_ns() - start) * 1e-6;
    }
    print_times("memcpy", ms);
}

typedef enum Way { AFFINE, MESH, IDENTITY } Way;

static void bench_kernel(const L1L2WarpConfig *cfg, const char *name, Way way, const Picture *src, Picture *dst)
{
    L1L2Warp *warp;
    L1L2WarpMesh mesh;
    if (l1l2_warp_create(&warp, cfg) != L1L2STAB_OK || !l1l2_warp_mesh_init(&mesh, cfg->out_width, cfg->out_height))
        exit(EXIT_FAILURE);
    double ms[FRAMES];
    for (int t = -2; t < FRAMES; t++) {
        const double angle = 0.0174 * sin(0.7 * t), zoom = 0.9;
        const L1L2WarpMap map = {
            .affine = way == IDENTITY
                ? l1l2_mat_identity()
                : l1l2_mat_similarity(zoom * cos(angle), zoom * sin(angle), 5.0 * sin(t), 5.0 * cos(t)),
            .mesh = way == MESH ? &mesh : NULL,
        };
        l1l2_warp_mesh_set(&mesh, &map.affine);
        const int64_t start = l1l2_clock_ns();
        l1l2_warp_render(warp, &map, (const uint8_t *const *)src->data, src->stride, dst->data, dst->stride);
        if (t >= 0)
            ms[t] = (double)(l1l2_clock_ns() - start) * 1e-6;
    }
    char what[64];
    snprintf(what, sizeof what, "%s%s%s, %d thread%s", name,
             way == MESH ? ", mesh" : way == IDENTITY ? ", identity" : "", cfg->plain ? ", plain C" : "",
             cfg->pool ? 2 : 1, cfg->pool ? "s" : "");
    print_times(what, ms);
    l1l2_warp_mesh_clear(&mesh);
    l1l2_warp_free(warp);
}

static void bench(L1L2StabFormat id, int width, int height)
{
    static const char *const kernels[] = {"bilinear", "bicubic", "lanczos"};
    const L1L2FormatInfo *format = l1l2_image_format_info(id);
    Picture src = make_picture(format, width, height), dst = make_picture(format, width, height);
    L1L2Pool *pool = l1l2_pool_create(2);
    printf("%s %dx%d, ms per frame\n", format->name, width, height);
    bench_copy(format, &src, &dst);
    for (int k = 0; k < 3; k++)
        for (int way = 0; way < 4; way++) {
            const L1L2WarpConfig cfg = {.format = format, .in_width = width, .in_height = height, .out_width = width,
                                        .out_height = height, .interpolation = (L1L2StabInterpolation)k,
                                        .pool = way % 2 ? pool : NULL, .plain = way / 2};
            bench_kernel(&cfg, kernels[k], AFFINE, &src, &dst);
            if (way == 0)
                bench_kernel(&cfg, kernels[k], MESH, &src, &dst);
            if (way == 0 && k == L1L2STAB_INTERPOLATION_BICUBIC)
                bench_kernel(&cfg, kernels[k], IDENTITY, &src, &dst);
        }
    l1l2_pool_free(pool);
    free_picture(&src);
    free_picture(&dst);
}

int main(void)
{
    bench(L1L2STAB_FORMAT_I420, 1280, 720);
    bench(L1L2STAB_FORMAT_I420, 1920, 1080);
    bench(L1L2STAB_FORMAT_NV12, 1280, 720);
    bench(L1L2STAB_FORMAT_BGR, 1280, 720);
    bench(L1L2STAB_FORMAT_BGRX, 1280, 720);
    bench(L1L2STAB_FORMAT_YUY2, 1280, 720);
    bench(L1L2STAB_FORMAT_I420_10LE, 1280, 720);
    bench(L1L2STAB_FORMAT_P010_10LE, 1280, 720);
    bench(L1L2STAB_FORMAT_GRAY16_LE, 1280, 720);
    return EXIT_SUCCESS;
}
