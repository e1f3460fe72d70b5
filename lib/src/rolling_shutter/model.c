/* SPDX-License-Identifier: MIT */
#include "rolling_shutter/model.h"

#include <math.h>
#include <string.h>

int l1l2_shutter_model_size(const L1L2ShutterModel *shape)
{
    return shape->kind == L1L2STAB_ROLLING_SHUTTER_MIXTURE ? L1L2_SHUTTER_SIZE : 8;
}

double l1l2_shutter_band_row(int band)
{
    return (band + 0.5) / L1L2_SHUTTER_BANDS - 0.5;
}

/* Gaussians as wide as a band is high, which sum to 1 at every row. From one to the next they change by a factor that
 * itself falls by e: two exponentials make all. */
static void weigh_bands(double row, double weight[L1L2_SHUTTER_BANDS])
{
    const double place = (fmin(fmax(row, -1.0), 1.0) - l1l2_shutter_band_row(0)) * L1L2_SHUTTER_BANDS,
                 fall = 0.36787944117144233;
    double gauss = exp(-0.5 * place * place), factor = exp(place - 0.5), sum = 0.0;
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
        weight[k] = gauss;
        sum += gauss;
        gauss *= factor;
        factor *= fall;
    }
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
        weight[k] /= sum;
}

void l1l2_shutter_model_basis(const L1L2ShutterModel *shape, L1L2Point p, double x[L1L2_SHUTTER_SIZE],
                         double y[L1L2_SHUTTER_SIZE])
{
    memset(x, 0, L1L2_SHUTTER_SIZE * sizeof *x);
    memset(y, 0, L1L2_SHUTTER_SIZE * sizeof *y);
    if (shape->kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE) {
        x[0] = y[3] = p.x;
        x[1] = y[4] = p.y;
        x[2] = y[5] = 1.0;
        x[6] = p.x * p.x, y[6] = p.x * p.y;
        x[7] = p.x * p.y, y[7] = p.y * p.y;
        return;
    }
    const double row = p.y / (2.0 * shape->half_h);
    weigh_bands(row, x + L1L2_SHUTTER_X);
    memcpy(y + L1L2_SHUTTER_Y, x + L1L2_SHUTTER_X, L1L2_SHUTTER_BANDS * sizeof *y);
    /* What moves a whole row alike is the bands': roll and zoom that vary by row have only the rest. */
    x[L1L2_SHUTTER_ROLL] = -p.y, y[L1L2_SHUTTER_ROLL] = p.x;
    y[L1L2_SHUTTER_ROLL_BY_ROW] = p.x * row;
    x[L1L2_SHUTTER_ZOOM] = p.x, y[L1L2_SHUTTER_ZOOM] = p.y;
    x[L1L2_SHUTTER_ZOOM_BY_ROW] = p.x * row;
    x[L1L2_SHUTTER_PERSPECTIVE] = p.x * p.x, y[L1L2_SHUTTER_PERSPECTIVE] = p.x * p.y;
}

L1L2Point l1l2_shutter_residual_at(const L1L2ShutterModel *shape, const L1L2ShutterResidual *r, L1L2Point p)
{
    double x[L1L2_SHUTTER_SIZE], y[L1L2_SHUTTER_SIZE];
    L1L2Point sum = {0.0, 0.0};
    l1l2_shutter_model_basis(shape, p, x, y);
    for (int i = 0; i < l1l2_shutter_model_size(shape); i++)
        sum.x += x[i] * r->p[i], sum.y += y[i] * r->p[i];
    return sum;
}

/* Points all over the frame, of mean 0. */
enum { COLUMNS = 5, ROWS = 10, POINTS = COLUMNS * ROWS };

static L1L2Point sample(const L1L2ShutterModel *shape, int i)
{
    return (L1L2Point){(2.0 * (i % COLUMNS) / (COLUMNS - 1) - 1.0) * shape->half_w,
                       2.0 * l1l2_shutter_band_row(i / COLUMNS) * shape->half_h};
}

L1L2Mat l1l2_shutter_residual_extract_similarity(const L1L2ShutterModel *shape, L1L2ShutterResidual *r)
{
    double a = 0.0, b = 0.0, x = 0.0, y = 0.0, norm = 0.0;
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point p = sample(shape, i), d = l1l2_shutter_residual_at(shape, r, p);
        a += p.x * d.x + p.y * d.y, b += p.x * d.y - p.y * d.x;
        x += d.x / POINTS, y += d.y / POINTS;
        norm += p.x * p.x + p.y * p.y;
    }
    a /= norm, b /= norm;
    if (shape->kind == L1L2STAB_ROLLING_SHUTTER_MIXTURE) {
        for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
            r->p[L1L2_SHUTTER_X + k] -= x, r->p[L1L2_SHUTTER_Y + k] -= y;
        r->p[L1L2_SHUTTER_ROLL] -= b, r->p[L1L2_SHUTTER_ZOOM] -= a;
    } else {
        r->p[0] -= a, r->p[1] += b, r->p[2] -= x;
        r->p[3] -= b, r->p[4] -= a, r->p[5] -= y;
    }
    return (L1L2Mat){{a, -b, x, b, a, y, 0.0, 0.0, 0.0}};
}

double l1l2_shutter_residual_stretch(const L1L2ShutterModel *shape, const L1L2ShutterResidual *r)
{
    double xx = 0.0, xy = 0.0, yx = 0.0, yy = 0.0, norm_x = 0.0, norm_y = 0.0;
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point p = sample(shape, i), d = l1l2_shutter_residual_at(shape, r, p);
        xx += p.x * d.x, xy += p.y * d.x, yx += p.x * d.y, yy += p.y * d.y;
        norm_x += p.x * p.x, norm_y += p.y * p.y;
    }
    return hypot(xx / norm_x - yy / norm_y, xy / norm_y + yx / norm_x);
}

double l1l2_shutter_residual_reach(const L1L2ShutterModel *shape, const L1L2ShutterResidual *r)
{
    double reach = 0.0;
    for (int k = 0; k < 9; k++) {
        const L1L2Point p = {(k % 3 - 1) * shape->half_w, (k / 3 - 1) * shape->half_h};
        const L1L2Point d = l1l2_shutter_residual_at(shape, r, p);
        reach = fmax(reach, hypot(d.x, d.y));
    }
    return reach;
}
