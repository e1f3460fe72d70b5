/* SPDX-License-Identifier: MIT */
#include "motion/shot_dissolve.h"

#include <math.h>
#include <stdlib.h>

enum { W = L1L2_THUMBNAIL_W, H = L1L2_THUMBNAIL_H };

static const int lags[] = {6, 9, 12, 18, 24, 36, 48}; /* frames */
static const double same_shot = 0.5;       /* correlation */
static const double mixed = 0.9;           /* part of the variance of the picture in between that the two explain */
static const double least_part = 0.2;      /* of each of the two in it */
/* Both parts together are the whole picture. A picture between two of a turning camera may look like a mix as well, but
 * it has the contrast of both: from 1.17 on at this correlation. */
static const double least_whole = 0.8, most_whole = 1.1;
static const double least_overlap = 0.5;   /* of the three pictures */

typedef struct Shift {
    int x, y;
} Shift;

/* Sums over the pixels that three pictures share: a the old one, b the new one, m the one in between. */
typedef struct Sums {
    double n, a, b, m, aa, bb, mm, ab, am, bm;
} Sums;

static Sums shared_sums(const L1L2Thumbnail *a, Shift at_a, const L1L2Thumbnail *m, Shift at_m, const L1L2Thumbnail *b)
{
    Sums s = {0};
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const int ax = x + at_a.x, ay = y + at_a.y, mx = x + at_m.x, my = y + at_m.y;
            if (ax < 0 || ay < 0 || ax >= W || ay >= H || mx < 0 || my < 0 || mx >= W || my >= H)
                continue;
            const double p = a->level[ay * W + ax], q = b->level[y * W + x], r = m->level[my * W + mx];
            s.n += 1.0, s.a += p, s.b += q, s.m += r;
            s.aa += p * p, s.bb += q * q, s.mm += r * r;
            s.ab += p * q, s.am += p * r, s.bm += q * r;
        }
    return s;
}

/* m as a mix of a and b in the sense of least squares: is it one? */
static bool is_mix(const Sums *s)
{
    const double n = s->n, aa = s->aa - s->a * s->a / n, bb = s->bb - s->b * s->b / n, mm = s->mm - s->m * s->m / n;
    const double ab = s->ab - s->a * s->b / n, am = s->am - s->a * s->m / n, bm = s->bm - s->b * s->m / n;
    if (!(aa > 0.0 && bb > 0.0 && mm > 0.0) || ab >= same_shot * sqrt(aa * bb))
        return false;
    const double determinant = aa * bb - ab * ab;
    const double part_a = (am * bb - bm * ab) / determinant, part_b = (bm * aa - am * ab) / determinant;
    const double whole = part_a + part_b;
    return part_a >= least_part && part_b >= least_part && whole >= least_whole && whole <= most_whole &&
           part_a * am + part_b * bm >= mixed * mm;
}

static int frame_before(const L1L2ShotDissolve *d, int lag)
{
    return (d->newest + L1L2_DISSOLVE_FRAMES - lag) % L1L2_DISSOLVE_FRAMES;
}

/* Where in frame i the point is that lies at the newest frame's centre, from its own centre. */
static Shift shift_to(const L1L2ShotDissolve *d, int i)
{
    const double x = d->frame[d->newest].x - d->frame[i].x, y = d->frame[d->newest].y - d->frame[i].y;
    return (Shift){(int)lround(x), (int)lround(y)};
}

static bool dissolved(const L1L2ShotDissolve *d, int lag)
{
    const int old = frame_before(d, lag), between = frame_before(d, lag / 2);
    const L1L2Thumbnail *a = &d->frame[old].thumbnail, *b = &d->frame[d->newest].thumbnail;
    const Shift at_a = shift_to(d, old), at_m = shift_to(d, between);
    if ((W - abs(at_a.x)) * (H - abs(at_a.y)) < least_overlap * W * H || abs(at_a.x) > W || abs(at_a.y) > H)
        return false;
    const Sums s = shared_sums(a, at_a, &d->frame[between].thumbnail, at_m, b);
    return s.n >= least_overlap * W * H && is_mix(&s) && l1l2_image_thumbnails_differ(a, b);
}

static void append(L1L2ShotDissolve *d, const L1L2Thumbnail *thumbnail, double x, double y)
{
    d->newest = (d->newest + 1) % L1L2_DISSOLVE_FRAMES;
    d->frame[d->newest].thumbnail = *thumbnail;
    d->frame[d->newest].x = x, d->frame[d->newest].y = y;
    d->count += d->count < L1L2_DISSOLVE_FRAMES;
}

void l1l2_motion_dissolve_start(L1L2ShotDissolve *d, const L1L2Thumbnail *thumbnail)
{
    d->count = d->newest = 0;
    append(d, thumbnail, 0.0, 0.0);
}

bool l1l2_motion_dissolve_push(L1L2ShotDissolve *d, const L1L2Thumbnail *thumbnail, const L1L2Mat *F, double half_w,
                        double half_h)
{
    const double x = d->frame[d->newest].x + 0.5 * W * F->m[2] / half_w;
    const double y = d->frame[d->newest].y + 0.5 * H * F->m[5] / half_h;
    append(d, thumbnail, x, y);
    for (size_t i = 0; i < sizeof lags / sizeof *lags; i++)
        if (lags[i] < d->count && dissolved(d, lags[i]))
            return true;
    return false;
}
