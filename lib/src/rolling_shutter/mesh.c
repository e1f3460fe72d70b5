/* SPDX-License-Identifier: MIT */
#include "rolling_shutter/mesh.h"

#include <assert.h>
#include <float.h>
#include <math.h>

/* Part of the source's side along which the picture is compressed. */
static const double zone = 0.125;

/* Bands' translations by row, so that no node needs an exponential. Linear between: off by 1e-4 of what they differ. */
enum { ROWS = 129 };

typedef struct Rows {
    L1L2ShutterModel shape;
    L1L2ShutterResidual residual;      /* of a mixture, without the bands */
    L1L2Point translation[ROWS]; /* from row -1 to row 1; the frame is the middle half */
} Rows;

static void tabulate(Rows *rows, const L1L2ShutterModel *shape, const L1L2ShutterResidual *residual)
{
    rows->shape = *shape;
    rows->residual = *residual;
    if (shape->kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE)
        return;
    for (int i = 0; i < ROWS; i++) {
        const double row = 2.0 * i / (ROWS - 1) - 1.0;
        L1L2ShutterResidual bands = *residual;
        for (int k = L1L2_SHUTTER_ROLL; k < L1L2_SHUTTER_SIZE; k++)
            bands.p[k] = 0.0;
        rows->translation[i] = l1l2_shutter_residual_at(shape, &bands, (L1L2Point){0.0, row * 2.0 * shape->half_h});
    }
}

static L1L2Point displacement(const Rows *rows, L1L2Point p)
{
    const double *m = rows->residual.p;
    if (rows->shape.kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE)
        return l1l2_shutter_residual_at(&rows->shape, &rows->residual, p);
    const double row = p.y / (2.0 * rows->shape.half_h);
    const double at = fmin(fmax((row + 1.0) * 0.5 * (ROWS - 1), 0.0), ROWS - 1);
    const int below = at >= ROWS - 1 ? ROWS - 2 : (int)at;
    const L1L2Point a = rows->translation[below], b = rows->translation[below + 1];
    const double part = at - below;
    const double tilt = m[L1L2_SHUTTER_PERSPECTIVE] * p.x + m[L1L2_SHUTTER_ZOOM];
    return (L1L2Point){
        a.x + part * (b.x - a.x) - m[L1L2_SHUTTER_ROLL] * p.y + (tilt + m[L1L2_SHUTTER_ZOOM_BY_ROW] * row) * p.x,
        a.y + part * (b.y - a.y) + (m[L1L2_SHUTTER_ROLL] + m[L1L2_SHUTTER_ROLL_BY_ROW] * row) * p.x + tilt * p.y,
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

/* Along one axis: what reaches beyond +-half is brought back by compressing the zone inside that side. */
static double compress(double value, const Range *range, double half)
{
    const double inner = half - 2.0 * half * zone;
    if (range->most > half && value > inner)
        value = inner + (value - inner) * (half - inner) / (range->most - inner);
    if (range->least < -half && value < -inner)
        value = -inner + (value + inner) * (half - inner) / (-inner - range->least);
    return fmin(fmax(value, -half), half);
}

#ifndef NDEBUG
/* Samples lie between nodes: none is outside the source if no node is. */
static bool inside(const L1L2WarpMesh *mesh, double half_w, double half_h)
{
    for (int i = 0; i < mesh->columns * mesh->rows; i++)
        if (!(fabs(mesh->node[i].x) <= half_w && fabs(mesh->node[i].y) <= half_h))
            return false;
    return true;
}
#endif

double l1l2_shutter_mesh_set(L1L2WarpMesh *mesh, const L1L2Mat *map, const L1L2ShutterModel *shape,
                            const L1L2ShutterResidual *residual, int width, int height)
{
    const double diagonal_px = hypot(width, height);
    Rows rows;
    tabulate(&rows, shape, residual);
    Range x = {DBL_MAX, -DBL_MAX}, y = {DBL_MAX, -DBL_MAX};
    double longest = 0.0;
    l1l2_warp_mesh_set(mesh, map);
    const int count = mesh->columns * mesh->rows;
    for (int i = 0; i < count; i++) {
        const L1L2Point from = {mesh->node[i].x / diagonal_px, mesh->node[i].y / diagonal_px};
        /* p + e(p) = from: the displacement is that of the row where the sample lies in the end. */
        const L1L2Point first = displacement(&rows, from);
        const L1L2Point d = displacement(&rows, (L1L2Point){from.x - first.x, from.y - first.y});
        const L1L2Point to = {(from.x - d.x) * diagonal_px, (from.y - d.y) * diagonal_px};
        if (!isfinite(to.x) || !isfinite(to.y))
            return -1.0;
        longest = fmax(longest, hypot(d.x, d.y) * diagonal_px);
        extend(&x, to.x);
        extend(&y, to.y);
        mesh->node[i] = to;
    }
    for (int i = 0; i < count; i++)
        mesh->node[i] = (L1L2Point){compress(mesh->node[i].x, &x, 0.5 * width),
                                    compress(mesh->node[i].y, &y, 0.5 * height)};
    assert(inside(mesh, 0.5 * width, 0.5 * height));
    return longest;
}
