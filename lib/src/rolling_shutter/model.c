/* SPDX-License-Identifier: MIT */
#include "rolling_shutter/model.h"

#include <math.h>
#include <string.h>

int l1l2_shutter_model_size(const L1L2ShutterModel *model)
{
    return model->kind == L1L2STAB_ROLLING_SHUTTER_MIXTURE ? L1L2_SHUTTER_SIZE : 8;
}

double l1l2_shutter_band_row(int band)
{
    return (band + 0.5) / L1L2_SHUTTER_BANDS - 0.5;
}

/*
 * The weights of the bands at a row: Gaussians whose standard deviation is one band's height, divided by their sum.
 *
 * With u the row's position in bands, counted from the middle of band 0, the weight of band k is
 *     g_k = exp(-(u - k)^2 / 2).
 * Neighboring weights have the ratio
 *     g_{k+1} / g_k = exp((u - k)^2 / 2 - (u - k - 1)^2 / 2) = exp(u - k - 1/2),
 * which itself falls by the factor exp(-1) from one k to the next. So g_0 and the first ratio give all weights by
 * multiplication: two exponentials in place of ten. Rows are clipped to [-1, 1]; there u is between -5.5 and 14.5, and
 * no weight underflows.
 */
static void weigh_bands(double row, double weight[L1L2_SHUTTER_BANDS])
{
    const double inverse_e = 0.36787944117144233;
    const double u = (fmin(fmax(row, -1.0), 1.0) - l1l2_shutter_band_row(0)) * L1L2_SHUTTER_BANDS;
    double gauss = exp(-0.5 * u * u), ratio = exp(u - 0.5), sum = 0.0;
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
        weight[k] = gauss;
        sum += gauss;
        gauss *= ratio;
        ratio *= inverse_e;
    }
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
        weight[k] /= sum;
}

void l1l2_shutter_model_basis(const L1L2ShutterModel *model, L1L2Point p, double x[L1L2_SHUTTER_SIZE],
                         double y[L1L2_SHUTTER_SIZE])
{
    memset(x, 0, L1L2_SHUTTER_SIZE * sizeof *x);
    memset(y, 0, L1L2_SHUTTER_SIZE * sizeof *y);
    if (model->kind != L1L2STAB_ROLLING_SHUTTER_MIXTURE) {
        /* A homography I + h maps p to p + (h0 x + h1 y + h2, h3 x + h4 y + h5) + p (h6 x + h7 y) to first order in h,
         * with the signs of h6 and h7 turned. */
        x[0] = y[3] = p.x;
        x[1] = y[4] = p.y;
        x[2] = y[5] = 1.0;
        x[6] = p.x * p.x, y[6] = p.x * p.y;
        x[7] = p.x * p.y, y[7] = p.y * p.y;
        return;
    }
    const double row = p.y / (2.0 * model->half_h);
    weigh_bands(row, x + L1L2_SHUTTER_X);
    memcpy(y + L1L2_SHUTTER_Y, x + L1L2_SHUTTER_X, L1L2_SHUTTER_BANDS * sizeof *y);
    /* The bands already describe what moves a whole row alike. So roll by row has no x component, and zoom by row has
     * no y component: those would depend on the row alone. */
    x[L1L2_SHUTTER_ROLL] = -p.y, y[L1L2_SHUTTER_ROLL] = p.x;
    y[L1L2_SHUTTER_ROLL_BY_ROW] = p.x * row;
    x[L1L2_SHUTTER_ZOOM] = p.x, y[L1L2_SHUTTER_ZOOM] = p.y;
    x[L1L2_SHUTTER_ZOOM_BY_ROW] = p.x * row;
    x[L1L2_SHUTTER_PERSPECTIVE] = p.x * p.x, y[L1L2_SHUTTER_PERSPECTIVE] = p.x * p.y;
}

L1L2Point l1l2_shutter_residual_at(const L1L2ShutterModel *model, const L1L2ShutterResidual *r, L1L2Point p)
{
    double x[L1L2_SHUTTER_SIZE], y[L1L2_SHUTTER_SIZE];
    L1L2Point sum = {0.0, 0.0};
    l1l2_shutter_model_basis(model, p, x, y);
    for (int i = 0; i < l1l2_shutter_model_size(model); i++)
        sum.x += x[i] * r->p[i], sum.y += y[i] * r->p[i];
    return sum;
}

/* Sample points all over the frame. Their mean is 0, and so is the sum of their products x y. */
enum { COLUMNS = 5, ROWS = 10, POINTS = COLUMNS * ROWS };

static L1L2Point sample(const L1L2ShutterModel *model, int i)
{
    return (L1L2Point){(2.0 * (i % COLUMNS) / (COLUMNS - 1) - 1.0) * model->half_w,
                       2.0 * l1l2_shutter_band_row(i / COLUMNS) * model->half_h};
}

L1L2Mat l1l2_shutter_residual_extract_similarity(const L1L2ShutterModel *model, L1L2ShutterResidual *r)
{
    double a = 0.0, b = 0.0, x = 0.0, y = 0.0, norm = 0.0;
    /* Least squares of d = (a + ib) p + (x + iy) in complex numbers. The points' mean is 0, so the two parts
     * separate. */
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point p = sample(model, i), d = l1l2_shutter_residual_at(model, r, p);
        a += p.x * d.x + p.y * d.y, b += p.x * d.y - p.y * d.x;
        x += d.x / POINTS, y += d.y / POINTS;
        norm += p.x * p.x + p.y * p.y;
    }
    a /= norm, b /= norm;
    if (model->kind == L1L2STAB_ROLLING_SHUTTER_MIXTURE) {
        for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
            r->p[L1L2_SHUTTER_X + k] -= x, r->p[L1L2_SHUTTER_Y + k] -= y;
        r->p[L1L2_SHUTTER_ROLL] -= b, r->p[L1L2_SHUTTER_ZOOM] -= a;
    } else {
        r->p[0] -= a, r->p[1] += b, r->p[2] -= x;
        r->p[3] -= b, r->p[4] -= a, r->p[5] -= y;
    }
    return (L1L2Mat){{a, -b, x, b, a, y, 0.0, 0.0, 0.0}};
}

double l1l2_shutter_residual_stretch(const L1L2ShutterModel *model, const L1L2ShutterResidual *r)
{
    /* The least squares fit d = A p. The symmetric, traceless part of A stretches: its eigenvalues are half of the
     * returned length, with both signs. */
    double xx = 0.0, xy = 0.0, yx = 0.0, yy = 0.0, norm_x = 0.0, norm_y = 0.0;
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point p = sample(model, i), d = l1l2_shutter_residual_at(model, r, p);
        xx += p.x * d.x, xy += p.y * d.x, yx += p.x * d.y, yy += p.y * d.y;
        norm_x += p.x * p.x, norm_y += p.y * p.y;
    }
    return hypot(xx / norm_x - yy / norm_y, xy / norm_y + yx / norm_x);
}

double l1l2_shutter_residual_reach(const L1L2ShutterModel *model, const L1L2ShutterResidual *r)
{
    double reach = 0.0;
    for (int k = 0; k < 9; k++) {
        const L1L2Point p = {(k % 3 - 1) * model->half_w, (k / 3 - 1) * model->half_h};
        const L1L2Point d = l1l2_shutter_residual_at(model, r, p);
        reach = fmax(reach, hypot(d.x, d.y));
    }
    return reach;
}

bool l1l2_shutter_residual_is_finite(const L1L2ShutterResidual *r)
{
    for (int i = 0; i < L1L2_SHUTTER_SIZE; i++)
        if (!isfinite(r->p[i]))
            return false;
    return true;
}
