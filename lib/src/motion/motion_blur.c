/* SPDX-License-Identifier: MIT */
#include "motion/motion_blur.h"

#include <math.h>
#include <stdbool.h>

enum { MARGIN = 3, SPACING = 3 };

/* Below this part of the slope's energy, the picture is blurred; else its length is called 0. Two sharp pictures of a
 * pan have 0.85 to 1.15 of each other's. */
static const double still_sharp = 0.8;
/* The energy of the slopes that white noise of deviation 1 makes: half the difference of samples two apart. */
static const double noise_energy = 0.5;

L1L2StructureTensor l1l2_motion_blur_tensor(const L1L2FloatPyramid *p)
{
    const L1L2FloatLevel *l = p->level;
    L1L2StructureTensor sum = {0.0, 0.0, 0.0};
    int count = 0;
    for (int y = MARGIN; y < l->height - MARGIN; y += SPACING) {
        const float *row = l->sample + (ptrdiff_t)y * l->width;
        float xx = 0.0f, xy = 0.0f, yy = 0.0f;
        for (int x = MARGIN; x < l->width - MARGIN; x += SPACING, count++) {
            const float sx = 0.5f * (row[x + 1] - row[x - 1]), sy = 0.5f * (row[x + l->width] - row[x - l->width]);
            xx += sx * sx, xy += sx * sy, yy += sy * sy;
        }
        sum.xx += (double)xx, sum.xy += (double)xy, sum.yy += (double)yy;
    }
    return (L1L2StructureTensor){sum.xx / count, sum.xy / count, sum.yy / count};
}

/* The smaller and the larger generalized eigenvalue of (a, b), and the direction of the smaller one. */
static bool compare_tensors(const L1L2StructureTensor *a, const L1L2StructureTensor *b, double *low, double *high,
                            double *x, double *y)
{
    /* det(a - e b) = 0 */
    const double A = b->xx * b->yy - b->xy * b->xy, C = a->xx * a->yy - a->xy * a->xy;
    const double B = a->xx * b->yy + a->yy * b->xx - 2.0 * a->xy * b->xy;
    *low = *high = 0.0, *x = 1.0, *y = 0.0;
    if (!(A > 0.0))
        return false;
    const double root = sqrt(fmax(0.0, B * B - 4.0 * A * C));
    *low = fmax(0.0, (B - root) / (2.0 * A)), *high = (B + root) / (2.0 * A);
    /* A row of a - e b is orthogonal to the eigenvector; the longer one is the more exact. */
    const double p = a->xx - *low * b->xx, q = a->xy - *low * b->xy, r = a->yy - *low * b->yy;
    const bool first = p * p + q * q > q * q + r * r;
    double u = first ? -q : r, v = first ? p : -q;
    const double size = hypot(u, v);
    if (size > 0.0) {
        *x = (u < 0.0 ? -u : u) / size, *y = (u < 0.0 ? -v : v) / size;
    }
    return true;
}

double l1l2_motion_blur_sharper(const L1L2StructureTensor *a, const L1L2StructureTensor *b)
{
    double low, high, x, y;
    return compare_tensors(a, b, &low, &high, &x, &y) ? low : 0.0;
}

static float sample_at(const L1L2FloatLevel *l, double x, double y)
{
    const int i = (int)x, j = (int)y;
    const float fx = (float)(x - i), fy = (float)(y - j);
    const float *p = l->sample + (ptrdiff_t)j * l->width + i;
    const float upper = p[0] + fx * (p[1] - p[0]), lower = p[l->width] + fx * (p[l->width + 1] - p[l->width]);
    return upper + fy * (lower - upper);
}

/*
 * The energy of the slope along (x, y) that a level would have if it were smeared by `length` >= 1 samples along it.
 * The slope is half the difference of samples f two apart, and its mean over the smear is
 *
 *     (integral of f over [length/2 - 1, length/2 + 1] - the same over [-length/2 - 1, -length/2 + 1]) / (2 length):
 *
 * only the two ends count. Each integral is taken as two samples. A length of 1 is the slope itself.
 */
static double smeared_energy(const L1L2FloatLevel *l, double x, double y, double length)
{
    const double far = 0.5 * length + 0.5, near = 0.5 * length - 0.5, reach_x = far * x, reach_y = far * fabs(y);
    double sum = 0.0;
    int count = 0;
    for (int j = MARGIN; j < l->height - MARGIN; j += SPACING)
        for (int i = MARGIN; i < l->width - MARGIN; i += SPACING) {
            if (i - reach_x < 0.0 || j - reach_y < 0.0 || i + reach_x >= l->width - 1 || j + reach_y >= l->height - 1)
                continue;
            const float ahead = sample_at(l, i + far * x, j + far * y) + sample_at(l, i + near * x, j + near * y);
            const float behind = sample_at(l, i - far * x, j - far * y) + sample_at(l, i - near * x, j - near * y);
            const double slope = (double)(ahead - behind) / (2.0 * length);
            sum += slope * slope;
            count++;
        }
    return count > 0 ? sum / count : 0.0;
}

/* The variance of the smallest level, which a blur hardly changes: where it differs, light does. */
static double contrast(const L1L2FloatPyramid *p)
{
    const L1L2FloatLevel *l = p->level + p->levels - 1;
    const int count = l->width * l->height;
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < count; i++) {
        const double v = (double)l->sample[i];
        sum += v, squares += v * v;
    }
    return squares / count - sum / count * (sum / count);
}

L1L2MotionBlur l1l2_motion_blur_measure(const L1L2FloatPyramid *picture, const L1L2FloatPyramid *sharp,
                                        double noise)
{
    const L1L2FloatLevel *l = sharp->level;
    const double taken = noise_energy * noise * noise;
    L1L2StructureTensor a = l1l2_motion_blur_tensor(picture), b = l1l2_motion_blur_tensor(sharp);
    L1L2MotionBlur out = {.x = 1.0, .along = 1.0, .across = 1.0};
    a.xx = fmax(0.0, a.xx - taken), a.yy = fmax(0.0, a.yy - taken);
    b.xx = fmax(0.0, b.xx - taken), b.yy = fmax(0.0, b.yy - taken);
    if (!compare_tensors(&a, &b, &out.along, &out.across, &out.x, &out.y) || out.along >= still_sharp)
        return out;
    /* Of the same light. */
    const double wanted = out.along * contrast(sharp) / fmax(contrast(picture), 1e-9);
    const double whole = fmax(smeared_energy(l, out.x, out.y, 1.0) - taken, 0.0);
    double low = 1.0, high = 0.4 * fmin(l->width, l->height);
    for (int i = 0; i < 8 && whole > 0.0; i++) { /* the energy falls as the length grows */
        const double middle = 0.5 * (low + high);
        if (smeared_energy(l, out.x, out.y, middle) > wanted * whole)
            low = middle;
        else
            high = middle;
    }
    out.length = l->step * 0.5 * (low + high);
    return out;
}
