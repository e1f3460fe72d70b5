/* SPDX-License-Identifier: MIT */
#include "cut.h"

#include <math.h>

enum { W = L1L2_THUMBNAIL_W, H = L1L2_THUMBNAIL_H, MAX_SHIFT_X = W / 8, MAX_SHIFT_Y = H / 8 };

static const double min_deviation = 4.0; /* grey levels: below it is noise and compression */
static const double same_shot = 0.5;     /* correlation; two shots of different things are around 0 */

typedef struct Sums {
    double n, a, b, aa, bb, ab;
} Sums;

/* a at (x, y) against b at (x + dx, y + dy), where both exist. */
static Sums overlap_sums(const L1L2Thumbnail *a, const L1L2Thumbnail *b, int dx, int dy)
{
    Sums s = {0};
    for (int y = dy < 0 ? -dy : 0; y < H && y + dy < H; y++)
        for (int x = dx < 0 ? -dx : 0; x < W && x + dx < W; x++) {
            const double p = a->level[y * W + x], q = b->level[(y + dy) * W + x + dx];
            s.n += 1.0, s.a += p, s.b += q;
            s.aa += p * p, s.bb += q * q, s.ab += p * q;
        }
    return s;
}

static double correlation(Sums s)
{
    const double va = s.aa - s.a * s.a / s.n, vb = s.bb - s.b * s.b / s.n;
    return va > 0.0 && vb > 0.0 ? (s.ab - s.a * s.b / s.n) / sqrt(va * vb) : 0.0;
}

bool l1l2_thumbnail_shows_something(const L1L2Thumbnail *thumbnail)
{
    const Sums s = overlap_sums(thumbnail, thumbnail, 0, 0);
    return s.aa / s.n - s.a * s.a / (s.n * s.n) >= min_deviation * min_deviation;
}

double l1l2_thumbnail_likeness(const L1L2Thumbnail *a, const L1L2Thumbnail *b)
{
    if (!l1l2_thumbnail_shows_something(a) || !l1l2_thumbnail_shows_something(b))
        return 0.0;
    double best = -1.0;
    for (int dy = -MAX_SHIFT_Y; dy <= MAX_SHIFT_Y; dy++)
        for (int dx = -MAX_SHIFT_X; dx <= MAX_SHIFT_X; dx++)
            best = fmax(best, correlation(overlap_sums(a, b, dx, dy)));
    return best;
}

bool l1l2_thumbnails_differ(const L1L2Thumbnail *a, const L1L2Thumbnail *b)
{
    return l1l2_thumbnail_shows_something(a) && l1l2_thumbnail_shows_something(b) &&
           l1l2_thumbnail_likeness(a, b) < same_shot;
}
