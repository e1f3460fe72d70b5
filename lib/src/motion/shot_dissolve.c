/* SPDX-License-Identifier: MIT */
#include "motion/shot_dissolve.h"

#include <math.h>
#include <stdlib.h>

/* Each of the two pictures has at least this part in a mixture; the three pictures share at least this part of the
 * frame. */
static const double min_part = 0.2, min_overlap_share = 0.5;

enum { W = L1L2_THUMBNAIL_W, H = L1L2_THUMBNAIL_H };

/* Frames between the old and the new picture, for dissolves of 4 to 40 frames. */
static const int lags[] = {6, 9, 12, 18, 24, 36, 48};

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

/*
 * True if m is a mixture u a + v b of two pictures that differ. About their means, the least-squares u and v solve [aa
 * ab; ab bb] [u; v] = [am; bm], and the part of m's variance that the mixture explains is (u am + v bm) / mm. In a
 * dissolve both parts are positive and their sum is 1.
 */
static bool is_mixture(const L1L2MotionParameters *p, const Sums *s)
{
    const double n = s->n, aa = s->aa - s->a * s->a / n, bb = s->bb - s->b * s->b / n, mm = s->mm - s->m * s->m / n;
    const double ab = s->ab - s->a * s->b / n, am = s->am - s->a * s->m / n, bm = s->bm - s->b * s->m / n;
    if (!(aa > 0.0 && bb > 0.0 && mm > 0.0) || ab >= p->dissolve_same_shot * sqrt(aa * bb))
        return false;
    const double determinant = aa * bb - ab * ab;
    const double part_a = (am * bb - bm * ab) / determinant, part_b = (bm * aa - am * ab) / determinant;
    const double sum = part_a + part_b;
    return part_a >= min_part && part_b >= min_part && sum >= p->dissolve_min_sum &&
           sum <= p->dissolve_max_sum && part_a * am + part_b * bm >= p->dissolve_explained * mm;
}

static int frame_before(const L1L2ShotDissolve *d, int lag)
{
    return (d->newest + L1L2_DISSOLVE_FRAMES - lag) % L1L2_DISSOLVE_FRAMES;
}

/* The offset from the center of frame i to the point of it that lies at the newest frame's center, by the motion. */
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
    const double min_overlap = min_overlap_share * W * H;
    if ((W - abs(at_a.x)) * (H - abs(at_a.y)) < min_overlap || abs(at_a.x) > W || abs(at_a.y) > H)
        return false;
    const Sums s = shared_sums(a, at_a, &d->frame[between].thumbnail, at_m, b);
    return s.n >= min_overlap && is_mixture(d->parameters, &s) && l1l2_image_thumbnails_differ(a, b);
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
