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

/* Exact: steps in 64 bits. Unsigned, for its shift is defined: the bits that are kept are the signed one's. */
static void run_exact(double start, double step, int u, int count, int32_t *out)
{
    const double one = 4294967296.0;
    const int shift = FRACTION_BITS - L1L2_WARP_PHASE_BITS;
    const uint64_t step_fixed = (uint64_t)(int64_t)floor(step * one + 0.5);
    uint64_t at = (uint64_t)(int64_t)floor(start * one + 0.5) + (uint64_t)u * step_fixed + (1u << (shift - 1));
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
