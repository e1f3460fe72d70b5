/* SPDX-License-Identifier: MIT */
/*
 * The fixed point. B_t and the zoom map an output point to a point u of the source frame as a camera without rolling
 * shutter would have taken it. What the source shows at p belongs at p + e(p) (model.h). So the sample for u is at the
 * p that solves
 *
 *     p = u - e(p).
 *
 * Two steps of fixed-point iteration from u solve it: p_1 = u - e(u), p_2 = u - e(p_1). If e is Lipschitz with constant
 * L < 1 (L is how much e changes from point to point, relative to their distance), then |p_1 - p| <= L |p - u|, and
 * |p_2 - p| <= L^2 |p - u|. filter.c limits |e| to 2 % of the diagonal and the stretch of the frame to 3 %. With L =
 * 0.05 and |e| at its limit, which is 14.7 px at 640x360, two steps leave less than 0.04 px; one step would leave 0.7
 * px.
 *
 * The edge compression. Along each axis, let `most` be the largest coordinate of any node. If it is beyond the source's
 * side at `half`, the coordinates between `inner`, an eighth of the side inside, and `most` are mapped linearly to
 * [inner, half]. The same holds at the opposite side. Guaranteed, for any finite mesh:
 *   - Inclusion. Every node is in [-half, half] along both axes: a last clip takes care of rounding. Samples are convex
 *     combinations of the four nodes around them, so every sample is inside the source, too.
 *   - No fold. The map is continuous and increasing, so the order of the nodes along each axis stays.
 *   - No jump in time. Where `most` equals `half`, the map is the identity. Beyond that it changes continuously with
 *     `most`, which is as smooth in time as B_t and the residual.
 *   - The rest keeps its correction: nodes that are farther inside than an eighth of the side are not moved.
 */
#include "rolling_shutter/mesh.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* A table of the bands' translations by row, so that no node needs an exponential. Linear interpolation is off by 1e-4
 * of their differences. */
enum { ROWS = 129 };

typedef struct Rows {
    L1L2ShutterModel model;
    L1L2ShutterResidual residual;
    L1L2Point translation[ROWS]; /* from row -1 to row 1; the frame is the middle half. Unused with a homography */
} Rows;

static void tabulate(Rows *rows, const L1L2ShutterModel *model, const L1L2ShutterResidual *residual)
{
    rows->model = *model;
    rows->residual = *residual;
    if (model->kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE)
        return;
    for (int i = 0; i < ROWS; i++) {
        const double row = 2.0 * i / (ROWS - 1) - 1.0;
        L1L2ShutterResidual bands = *residual;
        for (int k = L1L2_SHUTTER_ROLL; k < L1L2_SHUTTER_SIZE; k++)
            bands.p[k] = 0.0;
        rows->translation[i] = l1l2_shutter_residual_at(model, &bands, (L1L2Point){0.0, row * 2.0 * model->half_h});
    }
}

/* l1l2_shutter_residual_at(), with the bands by the table. */
static L1L2Point displacement(const Rows *rows, L1L2Point p)
{
    const double *m = rows->residual.p;
    if (rows->model.kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE)
        return l1l2_shutter_residual_at(&rows->model, &rows->residual, p);
    const double row = p.y / (2.0 * rows->model.half_h);
    const double at = fmin(fmax((row + 1.0) * 0.5 * (ROWS - 1), 0.0), ROWS - 1);
    const int below = at >= ROWS - 1 ? ROWS - 2 : (int)at;
    const L1L2Point a = rows->translation[below], b = rows->translation[below + 1];
    const double part = at - below;
    const double zoom = m[L1L2_SHUTTER_PERSPECTIVE] * p.x + m[L1L2_SHUTTER_ZOOM];
    return (L1L2Point){
        a.x + part * (b.x - a.x) - m[L1L2_SHUTTER_ROLL] * p.y + (zoom + m[L1L2_SHUTTER_ZOOM_BY_ROW] * row) * p.x,
        a.y + part * (b.y - a.y) + (m[L1L2_SHUTTER_ROLL] + m[L1L2_SHUTTER_ROLL_BY_ROW] * row) * p.x + zoom * p.y,
    };
}

typedef struct Range {
    double least, most;
} Range;

static void extend(Range *range, double value)
{
    range->least = fmin(range->least, value);
    range->most = fmax(range->most, value);
}

/* The edge compression along one axis. zone: part of the whole side, < 1/2. */
static double compress(double value, const Range *range, double half, double zone)
{
    const double inner = half - 2.0 * half * zone;
    if (range->most > half && value > inner)
        value = inner + (value - inner) * (half - inner) / (range->most - inner);
    if (range->least < -half && value < -inner)
        value = -inner + (value + inner) * (half - inner) / (-inner - range->least);
    return fmin(fmax(value, -half), half);
}

#ifndef NDEBUG
static bool inside(const L1L2WarpMesh *mesh, double half_w, double half_h)
{
    for (int i = 0; i < mesh->columns * mesh->rows; i++)
        if (!(fabs(mesh->node[i].x) <= half_w && fabs(mesh->node[i].y) <= half_h))
            return false;
    return true;
}
#endif

double l1l2_shutter_mesh_set(L1L2WarpMesh *mesh, const L1L2Mat *map, const L1L2ShutterModel *model,
                             const L1L2ShutterResidual *residual, const L1L2ShutterSource *source)
{
    const int width = source->width, height = source->height;
    const double pixel_aspect = source->pixel_aspect;
    const double diagonal_px = hypot(width * pixel_aspect, height); /* as it is shown */
    const double zone = l1l2_shutter_parameters_or_default(model->parameters)->compress_zone;
    Rows rows;
    tabulate(&rows, model, residual);
    Range x = {DBL_MAX, -DBL_MAX}, y = {DBL_MAX, -DBL_MAX};
    double longest = 0.0;
    l1l2_warp_mesh_set(mesh, map);
    const int count = mesh->columns * mesh->rows;
    for (int i = 0; i < count; i++) {
        const L1L2Point from = {mesh->node[i].x * pixel_aspect / diagonal_px, mesh->node[i].y / diagonal_px};
        const L1L2Point first = displacement(&rows, from);
        const L1L2Point d = displacement(&rows, (L1L2Point){from.x - first.x, from.y - first.y});
        const L1L2Point to = {(from.x - d.x) * diagonal_px / pixel_aspect, (from.y - d.y) * diagonal_px};
        if (!isfinite(to.x) || !isfinite(to.y))
            return -1.0;
        longest = fmax(longest, hypot(d.x, d.y) * diagonal_px);
        extend(&x, to.x);
        extend(&y, to.y);
        mesh->node[i] = to;
    }
    if (source->may_leave)
        return longest;
    for (int i = 0; i < count; i++)
        mesh->node[i] = (L1L2Point){compress(mesh->node[i].x, &x, 0.5 * width, zone),
                                    compress(mesh->node[i].y, &y, 0.5 * height, zone)};
    assert(inside(mesh, 0.5 * width, 0.5 * height));
    return longest;
}
