/* SPDX-License-Identifier: MIT */
#include "warp_coords.h"

#include <math.h>

enum { FRACTION_BITS = 32 };

/* Positions stay under FAR + MAX_STEP * 2^14 samples: 52 bits in 64-bit fixed point, 30 in a run's 32-bit one. */
static const double FAR = 524288.0;
static const double MAX_STEP = 32.0;

L1L2WarpGrid l1l2_warp_grid(const L1L2FormatInfo *format, int plane, L1L2StabChromaSite site, int width, int height)
{
    const int sub_x = 1 << format->plane[plane].log2_sub_x;
    const int sub_y = 1 << format->plane[plane].log2_sub_y;
    return (L1L2WarpGrid){
        .size_x = width,
        .size_y = height,
        .first_x = site == L1L2STAB_CHROMA_SITE_CENTER ? 0.5 * sub_x : 0.5,
        .first_y = site == L1L2STAB_CHROMA_SITE_TOP_LEFT ? 0.5 : 0.5 * sub_y,
        .step_x = sub_x,
        .step_y = sub_y,
    };
}

/* Sample -> frame position -> centred -> map -> frame position -> sample. All offsets are multiples of 1/2, so that the
 * identity and whole steps come out exact. */
L1L2WarpAffine l1l2_warp_affine(const L1L2Mat *map, const L1L2WarpGrid *dst, const L1L2WarpGrid *src)
{
    const double *m = map->m;
    const double u = dst->first_x - dst->size_x / 2.0;
    const double v = dst->first_y - dst->size_y / 2.0;
    const double x = m[0] * u + m[1] * v + m[2] + src->size_x / 2.0 - src->first_x;
    const double y = m[3] * u + m[4] * v + m[5] + src->size_y / 2.0 - src->first_y;
    return (L1L2WarpAffine){
        .x = {m[0] * dst->step_x / src->step_x, m[1] * dst->step_y / src->step_x, x / src->step_x},
        .y = {m[3] * dst->step_x / src->step_y, m[4] * dst->step_y / src->step_y, y / src->step_y},
    };
}

/* To the nearest: at 1.5 * 2^52 a double's unit is 1. Calls of floor() would take a quarter of a mesh's time. */
static inline uint64_t to_fixed(double at)
{
    const double one = 4294967296.0, ground = 6755399441055744.0;
    return (uint64_t)((int64_t)(at * one + ground) - (int64_t)ground);
}

/* Exact: steps in 64 bits. Unsigned, for its shift is defined: the bits that are kept are the signed one's. */
static inline void run_exact(double start, double step, int u, int count, int32_t *out)
{
    const int shift = FRACTION_BITS - L1L2_WARP_PHASE_BITS;
    const uint64_t step_fixed = to_fixed(step);
    uint64_t at = to_fixed(start) + (uint64_t)u * step_fixed + (1u << (shift - 1));
    for (int i = 0; i < count; i++, at += step_fixed)
        out[i] = (int32_t)(uint32_t)(at >> shift);
}

/* For maps that no stabilizer makes: every position on its own, NaN (an overflow) at the near end. */
static void run_saturated(double start, double step, int u, int count, int32_t *out)
{
    for (int i = 0; i < count; i++) {
        const double at = start + step * (u + i);
        const double near = at > -FAR ? (at < FAR ? at : FAR) : -FAR;
        out[i] = (int32_t)floor(near * L1L2_WARP_PHASES + 0.5);
    }
}

static void run_axis(const double axis[3], int u, int v, int count, int32_t *out)
{
    const double start = axis[1] * v + axis[2];
    if (fabs(start) <= FAR && fabs(axis[0]) <= MAX_STEP)
        run_exact(start, axis[0], u, count, out);
    else
        run_saturated(start, axis[0], u, count, out);
}

void l1l2_warp_affine_run(const L1L2WarpAffine *affine, int u, int v, int count, int32_t *x, int32_t *y)
{
    run_axis(affine->x, u, v, count, x);
    run_axis(affine->y, u, v, count, y);
}

/* What turns a mesh's node into a position in samples of the source plane, by axis: node * scale + shift. */
typedef struct ToSource {
    double scale_x, shift_x, scale_y, shift_y;
} ToSource;

static inline double saturate(double at)
{
    const double near = at < FAR ? at : FAR;
    return near > -FAR ? near : -FAR;
}

/* Between two nodes, one above the other. */
static inline L1L2Point node_at(const L1L2Point *upper, const L1L2Point *lower, double share, const ToSource *to)
{
    const double x = (1.0 - share) * upper->x + share * lower->x;
    const double y = (1.0 - share) * upper->y + share * lower->y;
    return (L1L2Point){saturate(x * to->scale_x + to->shift_x), saturate(y * to->scale_y + to->shift_y)};
}

/* The first sample of cell c's columns. */
static int first_of_cell(double width, double origin, int c)
{
    const double border = width * c - origin;
    const int whole = (int)border;
    return whole < border ? whole + 1 : whole;
}

/* Cell by cell: in each, positions are a line from its left to its right side. */
void l1l2_warp_mesh_run(const L1L2WarpMeshPlane *plane, int u, int v, int count, int32_t *x, int32_t *y)
{
    const L1L2WarpMesh *mesh = plane->mesh;
    const L1L2WarpGrid *dst = &plane->dst, *src = &plane->src;
    const int last_column = mesh->columns - 2, last_row = mesh->rows - 2; /* of cells */
    const double down = (dst->first_y + dst->step_y * v) * (mesh->rows - 1) / dst->size_y;
    const int row = down < last_row ? (int)down : last_row;
    const double share = down - row;
    const L1L2Point *upper = mesh->node + row * mesh->columns, *lower = upper + mesh->columns;
    const ToSource to = {1.0 / src->step_x, (src->size_x / 2.0 - src->first_x) / src->step_x,
                         1.0 / src->step_y, (src->size_y / 2.0 - src->first_y) / src->step_y};
    const double width = dst->size_x / (mesh->columns - 1) / dst->step_x; /* of a cell, samples */
    const double origin = dst->first_x / dst->step_x;                     /* of sample 0 from the left border */
    const double slope = 1.0 / width;

    int c = (int)((origin + u) * slope);
    c = c < last_column ? c : last_column;
    while (c > 0 && first_of_cell(width, origin, c) > u)
        c--;
    int first = first_of_cell(width, origin, c), next = first;
    L1L2Point left = node_at(upper + c, lower + c, share, &to);
    for (const int end = u + count; u < end; c++, first = next) {
        next = c < last_column ? first_of_cell(width, origin, c + 1) : end;
        const int stop = next < end ? next : end;
        const L1L2Point right = node_at(upper + c + 1, lower + c + 1, share, &to);
        const double step_x = (right.x - left.x) * slope, step_y = (right.y - left.y) * slope;
        const double offset = first + origin - width * c; /* of the cell's first sample from its left side */
        if (stop > u) {
            run_exact(left.x + offset * step_x, step_x, u - first, stop - u, x);
            run_exact(left.y + offset * step_y, step_y, u - first, stop - u, y);
            x += stop - u;
            y += stop - u;
            u = stop;
        }
        left = right;
    }
}
