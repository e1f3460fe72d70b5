/* SPDX-License-Identifier: MIT */
/*
 * The warp's reference: for every sample, the sum over its taps in doubles, with unrounded positions and weights. Where
 * the warp renders along scanlines, a column's taps lie around the row at which the scanline crosses the column.
 */
#ifndef WARP_REFERENCE_H
#define WARP_REFERENCE_H

#include "warp/warp_fixture.h"

#define PI 3.14159265358979323846

static inline double weigh(L1L2StabInterpolation interpolation, double x)
{
    const double t = fabs(x), a = -0.75;
    if (interpolation == L1L2STAB_INTERPOLATION_BILINEAR)
        return t < 1 ? 1 - t : 0;
    if (interpolation == L1L2STAB_INTERPOLATION_BICUBIC)
        return t < 1 ? (a + 2) * t * t * t - (a + 3) * t * t + 1
                     : t < 2 ? a * t * t * t - 5 * a * t * t + 8 * a * t - 4 * a : 0;
    return t == 0 ? 1 : t < 3 ? sin(PI * t) / (PI * t) * sin(PI * t / 3) / (PI * t / 3) : 0;
}

static inline int clamp(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

/* The frame position of a sample along one axis, from the definition of the chroma sites. */
static inline double frame_position(double index, int log2_sub, int cosited)
{
    return index * (1 << log2_sub) + (cosited ? 0.5 : 0.5 * (1 << log2_sub));
}

static inline double plane_position(double at, int log2_sub, int cosited)
{
    return (at - frame_position(0, log2_sub, cosited)) / (1 << log2_sub);
}

/* The definition of mesh.h. */
static inline L1L2Point mesh_apply(const L1L2WarpMesh *mesh, L1L2Point p)
{
    const double across = (p.x / mesh->width + 0.5) * (mesh->columns - 1);
    const double down = (p.y / mesh->height + 0.5) * (mesh->rows - 1);
    const int column = clamp((int)floor(across), 0, mesh->columns - 2);
    const int row = clamp((int)floor(down), 0, mesh->rows - 2);
    const double a = across - column, b = down - row;
    const L1L2Point *n = mesh->node + row * mesh->columns + column, *m = n + mesh->columns;
    return (L1L2Point){(1 - b) * ((1 - a) * n[0].x + a * n[1].x) + b * ((1 - a) * m[0].x + a * m[1].x),
                       (1 - b) * ((1 - a) * n[0].y + a * n[1].y) + b * ((1 - a) * m[0].y + a * m[1].y)};
}

/* Output sample (u, v), where u may lie between samples, to its source position in samples of the same plane. */
static inline L1L2Point source_position(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, int plane, double u,
                                        int v)
{
    const int sub_x = cfg->format->plane[plane].log2_sub_x, sub_y = cfg->format->plane[plane].log2_sub_y;
    const int left = cfg->chroma_site != L1L2STAB_CHROMA_SITE_CENTER;
    const int top = cfg->chroma_site == L1L2STAB_CHROMA_SITE_TOP_LEFT;
    const L1L2Point to = {frame_position(u, sub_x, left) - cfg->out_width / 2.0,
                          frame_position(v, sub_y, top) - cfg->out_height / 2.0};
    const L1L2Point from = map->mesh ? mesh_apply(map->mesh, to) : l1l2_mat_apply(&map->affine, to);
    return (L1L2Point){plane_position(from.x + cfg->in_width / 2.0, sub_x, left),
                       plane_position(from.y + cfg->in_height / 2.0, sub_y, top)};
}

/* Two output samples between which row v crosses a column on a straight line: the sides of a mesh's cell, or any
 * two. */
static inline void find_crossing(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, int plane, int v, int column,
                                 double side[2])
{
    side[0] = 0, side[1] = 1;
    for (int k = 0; map->mesh && k < map->mesh->columns - 1; k++) {
        const int sub_x = cfg->format->plane[plane].log2_sub_x;
        const int left = cfg->chroma_site != L1L2STAB_CHROMA_SITE_CENTER;
        side[0] = plane_position((double)k * cfg->out_width / (map->mesh->columns - 1), sub_x, left);
        side[1] = plane_position((k + 1.0) * cfg->out_width / (map->mesh->columns - 1), sub_x, left);
        if (source_position(cfg, map, plane, side[1], v).x > column)
            break;
    }
}

/* True if a plane is rendered along scanlines in two passes (scanline_u8.h). */
static inline bool uses_scanlines(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, int plane)
{
    const L1L2Point a = source_position(cfg, map, plane, 0, 0), b = source_position(cfg, map, plane, 1, 0);
    const double step = b.x - a.x, slope = (b.y - a.y) / step;
    return cfg->format->depth == 8 && cfg->interpolation != L1L2STAB_INTERPOLATION_BILINEAR &&
           (map->mesh || (step > 0 && step <= 4.0 / 3.0 && fabs(slope) <= 0.5));
}

/* The row around which a column's taps lie, for the sample of row v at position `at`. */
static inline double row_of_column(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, int plane, L1L2Point at, int v,
                                   int column)
{
    if (!uses_scanlines(cfg, map, plane))
        return at.y;
    double side[2];
    find_crossing(cfg, map, plane, v, column, side);
    const L1L2Point a = source_position(cfg, map, plane, side[0], v), b = source_position(cfg, map, plane, side[1], v);
    return a.y + (b.y - a.y) / (b.x - a.x) * (column - a.x);
}

static inline void weigh_axis(const L1L2WarpConfig *cfg, double at, int size, double weight[6], int index[6])
{
    const int first = (int)floor(at) - 2;
    double sum = 0;
    for (int k = 0; k < 6; k++) {
        weight[k] = weigh(cfg->interpolation, first + k - at);
        index[k] = clamp(first + k, 0, size - 1);
        sum += weight[k];
    }
    for (int k = 0; k < 6; k++)
        weight[k] /= sum;
}

static inline double reference(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, const Picture *src, int plane,
                               int u, int v, int component)
{
    const L1L2Point at = source_position(cfg, map, plane, u, v);
    double wx[6], wy[6], sum = 0;
    int ix[6], iy[6];
    weigh_axis(cfg, at.x, src->plane[plane].width, wx, ix);
    for (int k = 0; k < 6; k++) {
        if (wx[k] == 0)
            continue;
        weigh_axis(cfg, row_of_column(cfg, map, plane, at, v, (int)floor(at.x) - 2 + k), src->plane[plane].height, wy,
                   iy);
        for (int r = 0; r < 6; r++)
            sum += wy[r] * wx[k] * level(src, plane, ix[k], iy[r], component);
    }
    return fmin(fmax(sum, 0), max_level(src));
}

/*
 * The largest error of the fixed point on noise of full range. G is the largest sum of a kernel's |weights| along an
 * axis, D half the largest sum of their |slopes|:
 *
 *   rounding of the output                          0.5
 *   positions rounded to 1/1024, along two axes     2 * 255 * D * G / 2048
 *   weights rounded to 14 bits; twice for each, as the nearest tap gets what is left over
 *                                                   2 * 255 * G * taps / 16384; 0 for bilinear, whose are exact
 *   products rounded to 7 bits before the second axis   taps * G / 256; rows of bilinear: 2 / 256
 *
 * The sum is below 1.5, so a sample is never more than 1 from the rounded exact value. For deeper samples, all terms
 * but the rounding of the output grow with their range.
 */
static const double WORST[] = {
    [L1L2STAB_INTERPOLATION_BILINEAR] = 0.5 + 0.25 + 0.01,          /* G = 1, D = 1 */
    [L1L2STAB_INTERPOLATION_BICUBIC] = 0.5 + 0.52 + 0.18 + 0.03,    /* G = 1.375, D = 1.5 */
    [L1L2STAB_INTERPOLATION_LANCZOS] = 0.5 + 0.63 + 0.30 + 0.04,    /* G = 1.55, D = 1.59 */
};

static inline void assert_close_to_reference(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, const Picture *src,
                                             const Picture *dst)
{
    const double range = max_level(dst), worst = 0.5 + (WORST[cfg->interpolation] - 0.5) * range / 255.0;
    double squares = 0;
    int number = 0;
    for (int i = 0; i < dst->format->planes; i++)
        for (int v = 0; v < dst->plane[i].height; v++)
            for (int u = 0; u < dst->plane[i].width; u++)
                for (int c = 0; c < dst->plane[i].components; c++) {
                    const double exact = reference(cfg, map, src, i, u, v, c);
                    const double error = level(dst, i, u, v, c) - exact;
                    if (fabs(error) > worst)
                        ck_abort_msg("%s kernel %d site %d plane %d (%d, %d): %d for %f", cfg->format->name,
                                     cfg->interpolation, cfg->chroma_site, i, u, v, level(dst, i, u, v, c), exact);
                    squares += error * error;
                    number++;
                }
    /* Rounding alone gives 58.9 dB at 8 bits. */
    ck_assert_double_ge(10 * log10(range * range * number / squares), dst->format->depth > 8 ? 62.0 : 58.0);
}

/* Warps the picture and compares it with the reference. */
static inline void assert_follows_reference(const L1L2WarpConfig *cfg, const L1L2WarpMap *map, const Picture *src,
                                            Picture *dst)
{
    warp_picture_by(cfg, map, src, dst);
    assert_close_to_reference(cfg, map, src, dst);
    assert_guards_untouched(dst);
}

#endif
