/* SPDX-License-Identifier: MIT */
/*
 * Finds the scanline that a run of output samples follows through the source.
 *
 * Row v of an affine map is the straight line (x, y)(u) = start + u * (x[0], y[0]). Along it, sample u is at column
 * x(u). Down it, the line has the slope y[0] / x[0] and crosses column c at row y(0) + slope * (c - x(0)). A mesh gives
 * one such line for each cell.
 */
#include "warp/coords_impl.h"

static const double MAX_STEP_ALONG = 4.0 / 3.0;
static const double MAX_SLOPE = 0.5;

enum { HALF_PHASE_OF_STEPS = 1 << (L1L2_WARP_STEP_BITS - L1L2_WARP_PHASE_BITS - 1) };

/* True if a scanline may move by this much from one output sample to the next. */
static inline bool fits_scanline(double step_x, double step_y)
{
    return step_x > 0.0 && step_x <= MAX_STEP_ALONG && fabs(step_y) <= MAX_SLOPE * step_x;
}

static inline int64_t to_steps(double at)
{
    enum { CUT = FRACTION_BITS - L1L2_WARP_STEP_BITS };
    return (int64_t)(to_fixed(at) + (1 << (CUT - 1))) >> CUT;
}

static inline int floor_of(double at)
{
    return (int)at - ((int)at > at); /* not by floor(): it is a call */
}

/* Sets the columns that all taps have, from the first sample's position to the last one's, and counts `along` from the
 * first of them. */
static void set_columns(L1L2WarpScanline *scanline, int taps)
{
    const L1L2WarpPiece *first = scanline->along, *last = scanline->along + scanline->along_pieces - 1;
    const int64_t end = last->at + (int64_t)(scanline->count - 1 - last->from) * last->step;
    scanline->first = (int)(first->at >> L1L2_WARP_STEP_BITS) - (taps / 2 - 1);
    scanline->columns = (int)(end >> L1L2_WARP_STEP_BITS) + taps / 2 - scanline->first + 1;
    for (int k = 0; k < scanline->along_pieces; k++)
        scanline->along[k].at -= (int64_t)scanline->first * ((int64_t)1 << L1L2_WARP_STEP_BITS);
}

bool l1l2_warp_affine_scanline(const L1L2WarpAffine *affine, int taps, int u, int v, int count,
                               L1L2WarpScanline *scanline)
{
    const double *x = affine->x, *y = affine->y;
    if (!fits_scanline(x[0], y[0]))
        return false;
    const double slope = y[0] / x[0];
    const double start = x[0] * u + x[1] * v + x[2];
    if (!(fabs(start) <= FAR))
        return false;
    scanline->count = count;
    scanline->along_pieces = scanline->down_pieces = 1;
    scanline->along[0] = (L1L2WarpPiece){to_steps(start) + HALF_PHASE_OF_STEPS, (int32_t)to_steps(x[0]), 0};
    set_columns(scanline, taps);
    const bool by_column = taps > 2;
    const double row = y[0] * u + y[1] * v + y[2] + (by_column ? slope * (scanline->first - start) : 0.0);
    if (!(fabs(row) <= FAR))
        return false;
    const double step = by_column ? slope : y[0];
    scanline->down[0] = (L1L2WarpPiece){to_steps(row) + HALF_PHASE_OF_STEPS, (int32_t)to_steps(step), 0};
    return true;
}

/* Sets `down` from the positions of the cells' sides. The first and the last piece go on beyond the outermost sides. */
static void set_down(L1L2WarpScanline *scanline, const double *x, const double *y, int cells)
{
    int pieces = 0, from = scanline->first;
    for (int k = 0; k < cells; k++) {
        const int end = k + 1 < cells ? floor_of(x[k + 1]) + 1 : scanline->first + scanline->columns;
        if (end <= from)
            continue;
        const double slope = (y[k + 1] - y[k]) / (x[k + 1] - x[k]);
        scanline->down[pieces++] = (L1L2WarpPiece){to_steps(y[k] + (from - x[k]) * slope) + HALF_PHASE_OF_STEPS,
                                               (int32_t)to_steps(slope), from - scanline->first};
        from = end;
    }
    scanline->down_pieces = pieces;
}

bool l1l2_warp_mesh_scanline(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int taps, int v,
                         L1L2WarpScanline *scanline)
{
    double x[L1L2_WARP_MAX_CELLS + 1], y[L1L2_WARP_MAX_CELLS + 1];
    bool fits = true;
    cut_cells(plane, cells, v, x, y);
    for (int k = 0; k < cells->count; k++) {
        const double step = (x[k + 1] - x[k]) * cells->slope, rise = (y[k + 1] - y[k]) * cells->slope;
        fits &= fits_scanline(step, rise);
        if (taps == 2)
            scanline->down[k] = (L1L2WarpPiece){to_steps(y[k] + cells->offset[k] * rise) + HALF_PHASE_OF_STEPS,
                                            (int32_t)to_steps(fits ? rise : 0.0), cells->from[k]};
        scanline->along[k] = (L1L2WarpPiece){to_steps(x[k] + cells->offset[k] * step) + HALF_PHASE_OF_STEPS,
                                         (int32_t)to_steps(fits ? step : 0.0), cells->from[k]};
    }
    if (!fits)
        return false;
    scanline->along[0].at += (int64_t)cells->skipped * scanline->along[0].step;
    scanline->along_pieces = cells->count;
    scanline->count = cells->from[cells->count];
    set_columns(scanline, taps);
    if (taps > 2) {
        set_down(scanline, x, y, cells->count);
    } else {
        scanline->down[0].at += (int64_t)cells->skipped * scanline->down[0].step;
        scanline->down_pieces = cells->count;
    }
    return true;
}
