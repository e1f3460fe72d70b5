/* SPDX-License-Identifier: MIT */
/*
 * For the implementations of warp_coords.h: positions are lines in 64-bit fixed point, one for an affine map's run, one
 * for each cell of a mesh. An implementation writes run_fixed(), which all the rest is compiled around.
 */
#ifndef L1L2_WARP_COORDS_IMPL_H
#define L1L2_WARP_COORDS_IMPL_H

#include <math.h>
#include <string.h>

#include "warp/coords.h"
#include "warp/sample.h"

enum {
    FRACTION_BITS = 32,
    POSITION_SHIFT = FRACTION_BITS - L1L2_WARP_PHASE_BITS,
    HALF_PHASE = 1 << (POSITION_SHIFT - 1)
};

/* Positions stay under FAR + MAX_STEP * 2^14 samples: 52 bits in 64-bit fixed point, 30 in a run's 32-bit one. */
static const double FAR = 524288.0;
static const double MAX_STEP = 32.0;

/* Writes `at`, `at + step`, ... as positions, cut, not rounded; up to L1L2_WARP_RUN_SLACK more than count. Unsigned,
 * for that shift is defined: the bits that are kept are the signed one's. */
typedef void RunFixed(uint64_t at, uint64_t step, int count, int32_t *out);

/* To the nearest, by way of a double's bits where its unit is 1, which vectorizes. |at| <= 2^19. */
SPECIALIZED uint64_t to_fixed(double at)
{
    const double ground = 6755399441055744.0; /* 1.5 * 2^52 */
    const double moved = at * 4294967296.0 + ground;
    uint64_t bits, ground_bits;
    memcpy(&bits, &moved, sizeof bits);
    memcpy(&ground_bits, &ground, sizeof ground_bits);
    return bits - ground_bits;
}

/* Positions `start + step * (u + i)`. */
SPECIALIZED void run_line(double start, double step, int u, int count, int32_t *out, RunFixed *run_fixed)
{
    const uint64_t step_fixed = to_fixed(step);
    run_fixed(to_fixed(start) + (uint64_t)u * step_fixed + HALF_PHASE, step_fixed, count, out);
}

/* For maps that no stabilizer makes: every position on its own, NaN (an overflow) at the near end. */
static inline void run_saturated(double start, double step, int u, int count, int32_t *out)
{
    for (int i = 0; i < count; i++) {
        const double at = start + step * (u + i);
        const double near = at > -FAR ? (at < FAR ? at : FAR) : -FAR;
        out[i] = (int32_t)floor(near * L1L2_WARP_PHASES + 0.5);
    }
}

SPECIALIZED void run_axis(const double axis[3], int u, int v, int count, int32_t *out, RunFixed *run_fixed)
{
    const double start = axis[1] * v + axis[2];
    if (fabs(start) <= FAR && fabs(axis[0]) <= MAX_STEP)
        run_line(start, axis[0], u, count, out, run_fixed);
    else
        run_saturated(start, axis[0], u, count, out);
}

SPECIALIZED void affine_run(const L1L2WarpAffine *affine, int u, int v, int count, int32_t *x, int32_t *y,
                            RunFixed *run_fixed)
{
    run_axis(affine->x, u, v, count, x, run_fixed);
    run_axis(affine->y, u, v, count, y, run_fixed);
}

SPECIALIZED double saturate(double at)
{
    const double near = at < FAR ? at : FAR;
    return near > -FAR ? near : -FAR;
}

/* A mesh's row of cells, cut at an output row: one coordinate of the cuts' ends, in samples of the source plane. */
SPECIALIZED void cut_cells(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, double *x, double *y)
{
    const L1L2WarpMesh *mesh = plane->mesh;
    const L1L2WarpGrid *dst = &plane->dst, *src = &plane->src;
    const double down = (dst->first_y + dst->step_y * v) * (mesh->rows - 1) / dst->size_y;
    const int row = down < mesh->rows - 2 ? (int)down : mesh->rows - 2;
    const double share = down - row;
    const L1L2Point *above = mesh->node + row * mesh->columns + cells->column, *below = above + mesh->columns;
    const double scale_x = 1.0 / src->step_x, shift_x = (src->size_x / 2.0 - src->first_x) / src->step_x;
    const double scale_y = 1.0 / src->step_y, shift_y = (src->size_y / 2.0 - src->first_y) / src->step_y;
    for (int k = 0; k <= cells->count; k++) {
        x[k] = saturate(((1.0 - share) * above[k].x + share * below[k].x) * scale_x + shift_x);
        y[k] = saturate(((1.0 - share) * above[k].y + share * below[k].y) * scale_y + shift_y);
    }
}

/* One axis, by its coordinate at the cells' sides. */
SPECIALIZED void run_cells(const L1L2WarpCells *cells, const double *side, int32_t *out, RunFixed *run_fixed)
{
    uint64_t at[L1L2_WARP_MAX_CELLS], step[L1L2_WARP_MAX_CELLS];
    for (int k = 0; k < cells->count; k++) {
        const double slope = (side[k + 1] - side[k]) * cells->slope;
        at[k] = to_fixed(side[k] + cells->offset[k] * slope) + HALF_PHASE;
        step[k] = to_fixed(slope);
    }
    at[0] += (uint64_t)cells->skipped * step[0];
    for (int k = 0; k < cells->count; k++)
        run_fixed(at[k], step[k], cells->from[k + 1] - cells->from[k], out + cells->from[k]);
}

SPECIALIZED void mesh_run(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, int32_t *x, int32_t *y,
                          RunFixed *run_fixed)
{
    double side_x[L1L2_WARP_MAX_CELLS + 1], side_y[L1L2_WARP_MAX_CELLS + 1];
    cut_cells(plane, cells, v, side_x, side_y);
    run_cells(cells, side_x, x, run_fixed);
    run_cells(cells, side_y, y, run_fixed);
}

/* From run_fixed() the generators. */
#define DEFINE_GENERATORS(name)                                                                                       \
    static void run_affine(const L1L2WarpAffine *affine, int u, int v, int count, int32_t *x, int32_t *y)             \
    {                                                                                                                 \
        affine_run(affine, u, v, count, x, y, run_fixed);                                                             \
    }                                                                                                                 \
    static void run_mesh(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, int32_t *x, int32_t *y)   \
    {                                                                                                                 \
        mesh_run(plane, cells, v, x, y, run_fixed);                                                                   \
    }                                                                                                                 \
    const L1L2WarpGenerators name = {run_affine, run_mesh};

#endif
