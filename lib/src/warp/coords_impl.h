/* SPDX-License-Identifier: MIT */
/*
 * For the implementations of coords.h. Positions are evenly spaced numbers in 64-bit fixed point: one sequence for the
 * run of an affine map, one for each cell of a mesh. An implementation writes run_fixed(), and all the rest is compiled
 * around it.
 */
#ifndef L1L2_WARP_COORDS_IMPL_H
#define L1L2_WARP_COORDS_IMPL_H

#include <math.h>
#include <string.h>

#include "warp/functions.h"

enum {
    FRACTION_BITS = 32,
    POSITION_SHIFT = FRACTION_BITS - L1L2_WARP_PHASE_BITS,
    HALF_PHASE = 1 << (POSITION_SHIFT - 1)
};

/* Where fixed point is used, the size of a position stays below FAR + MAX_STEP * 2^14 = 2^20 samples. That is 20 bits
 * and a sign: 53 bits with 32 fractional bits, and 31 bits with the 10 fractional bits of a phase. */
static const double FAR = 524288.0;
static const double MAX_STEP = 32.0;

/* Writes `at`, `at + step`, ... as positions, cut, not rounded; up to L1L2_WARP_RUN_SLACK more than count. The numbers
 * have a sign, but are passed as unsigned ones: their sums wrap around and their shift to the right is defined. The
 * bits that are kept are the same. */
typedef void RunFixed(uint64_t at, uint64_t step, int count, int32_t *out);

/* The nearest fixed-point number. A double between 2^52 and 2^53 has the unit 1, so adding 1.5 * 2^52 rounds to an
 * integer, which is then the difference of the bits. Unlike a call of llrint(), this vectorizes. |at| <= 2^19. */
L1L2_INLINE uint64_t to_fixed(double at)
{
    const double ground = 6755399441055744.0; /* 1.5 * 2^52 */
    const double moved = at * 4294967296.0 + ground;
    uint64_t bits, ground_bits;
    memcpy(&bits, &moved, sizeof bits);
    memcpy(&ground_bits, &ground, sizeof ground_bits);
    return bits - ground_bits;
}

/* Writes the positions `start + step * (u + i)`. */
L1L2_INLINE void run_even_steps(double start, double step, int u, int count, int32_t *out, RunFixed *run_fixed)
{
    const uint64_t step_fixed = to_fixed(step);
    run_fixed(to_fixed(start) + (uint64_t)u * step_fixed + HALF_PHASE, step_fixed, count, out);
}

/* The same beyond FAR and MAX_STEP, where no stabilizer's map is: every position is computed by itself. NaN, from an
 * overflow, becomes -FAR. */
static inline void run_saturated(double start, double step, int u, int count, int32_t *out)
{
    for (int i = 0; i < count; i++) {
        const double at = start + step * (u + i);
        const double near = at > -FAR ? (at < FAR ? at : FAR) : -FAR;
        out[i] = (int32_t)floor(near * L1L2_WARP_PHASES + 0.5);
    }
}

L1L2_INLINE void run_axis(const double axis[3], int u, int v, int count, int32_t *out, RunFixed *run_fixed)
{
    const double start = axis[1] * v + axis[2];
    if (fabs(start) <= FAR && fabs(axis[0]) <= MAX_STEP)
        run_even_steps(start, axis[0], u, count, out, run_fixed);
    else
        run_saturated(start, axis[0], u, count, out);
}

L1L2_INLINE double saturate(double at)
{
    const double near = at < FAR ? at : FAR;
    return near > -FAR ? near : -FAR;
}

/* Where output row v crosses the sides of the cells: positions in samples of the source plane, [cells->count + 1]. */
L1L2_INLINE void cut_cells(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, double *x, double *y)
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

/* Writes one coordinate of the positions, given its values at the cells' sides. */
L1L2_INLINE void run_cells(const L1L2WarpCells *cells, const double *side, int32_t *out, RunFixed *run_fixed)
{
    uint64_t at[L1L2_WARP_MAX_CELLS], step[L1L2_WARP_MAX_CELLS];
    for (int k = 0; k < cells->count; k++) {
        const double slope = (side[k + 1] - side[k]) * cells->slope;
        at[k] = to_fixed(side[k] + cells->offset[k] * slope) + HALF_PHASE;
        step[k] = to_fixed(slope);
    }
    for (int k = 0; k < cells->count; k++) {
        const uint64_t skipped = k == 0 ? (uint64_t)cells->skipped * step[0] : 0;
        run_fixed(at[k] + skipped, step[k], cells->from[k + 1] - cells->from[k], out + cells->from[k]);
    }
}

L1L2_INLINE void mesh_run(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, int32_t *x, int32_t *y,
                          RunFixed *run_fixed)
{
    double side_x[L1L2_WARP_MAX_CELLS + 1], side_y[L1L2_WARP_MAX_CELLS + 1];
    cut_cells(plane, cells, v, side_x, side_y);
    run_cells(cells, side_x, x, run_fixed);
    run_cells(cells, side_y, y, run_fixed);
}

/* Compiles the generators around run_fixed(), and defines the function init() that puts them into the table. */
#define DEFINE_GENERATORS(init)                                                                                       \
    static void run_affine(const L1L2WarpAffine *affine, int u, int v, int count, int32_t *x, int32_t *y)             \
    {                                                                                                                 \
        run_axis(affine->x, u, v, count, x, run_fixed);                                                               \
        run_axis(affine->y, u, v, count, y, run_fixed);                                                               \
    }                                                                                                                 \
    static void run_mesh(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, int32_t *x, int32_t *y)   \
    {                                                                                                                 \
        mesh_run(plane, cells, v, x, y, run_fixed);                                                                   \
    }                                                                                                                 \
    void init(L1L2WarpFunctions *functions)                                                                           \
    {                                                                                                                 \
        functions->generators = (L1L2WarpGenerators){run_affine, run_mesh};                                           \
    }

#endif
