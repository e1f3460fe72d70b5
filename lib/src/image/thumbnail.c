/* SPDX-License-Identifier: MIT */
#include "image/thumbnail.h"

#include <math.h>

enum { W = L1L2_THUMBNAIL_W, H = L1L2_THUMBNAIL_H, MAX_SHIFT_X = W / 8, MAX_SHIFT_Y = H / 8, BLOCK = 6 };

static const double min_deviation = 4.0; /* gray levels; less can be noise or compression artifacts */
static const double same_shot = 0.5;     /* correlation; two shots of different things are around 0 */
/* A hand in front of the lens leaves parts of the picture visible. So two pictures are of one shot if `enough_blocks`
 * of their blocks have a correlation of `same_block`. */
static const double same_block = 0.8, enough_blocks = 0.2;

typedef struct Sums {
    double n, a, b, aa, bb, ab;
} Sums;

/* How far b is moved against a. */
typedef struct Shift {
    int x, y;
} Shift;

/* The samples with x0 <= x < x1 and y0 <= y < y1. */
typedef struct Area {
    int x0, y0, x1, y1;
} Area;

static int most(int a, int b)
{
    return a > b ? a : b;
}

/* Compares a at (x, y) with b at (x, y) + shift, where both exist, for the (x, y) of an area. */
static Sums area_sums(const L1L2Thumbnail *a, const L1L2Thumbnail *b, Shift shift, Area area)
{
    Sums s = {0};
    for (int y = most(area.y0, -shift.y); y < area.y1 && y + shift.y < H; y++)
        for (int x = most(area.x0, -shift.x); x < area.x1 && x + shift.x < W; x++) {
            const double p = a->level[y * W + x], q = b->level[(y + shift.y) * W + x + shift.x];
            s.n += 1.0, s.a += p, s.b += q;
            s.aa += p * p, s.bb += q * q, s.ab += p * q;
        }
    return s;
}

static Sums overlap_sums(const L1L2Thumbnail *a, const L1L2Thumbnail *b, Shift shift)
{
    return area_sums(a, b, shift, (Area){0, 0, W, H});
}

static double correlation(Sums s)
{
    const double va = s.aa - s.a * s.a / s.n, vb = s.bb - s.b * s.b / s.n;
    return va > 0.0 && vb > 0.0 ? (s.ab - s.a * s.b / s.n) / sqrt(va * vb) : 0.0;
}

bool l1l2_image_thumbnail_has_detail(const L1L2Thumbnail *thumbnail)
{
    const Sums s = overlap_sums(thumbnail, thumbnail, (Shift){0, 0});
    return s.aa / s.n - s.a * s.a / (s.n * s.n) >= min_deviation * min_deviation;
}

double l1l2_image_thumbnail_correlation(const L1L2Thumbnail *a, const L1L2Thumbnail *b)
{
    if (!l1l2_image_thumbnail_has_detail(a) || !l1l2_image_thumbnail_has_detail(b))
        return 0.0;
    double best = -1.0;
    for (int dy = -MAX_SHIFT_Y; dy <= MAX_SHIFT_Y; dy++)
        for (int dx = -MAX_SHIFT_X; dx <= MAX_SHIFT_X; dx++)
            best = fmax(best, correlation(overlap_sums(a, b, (Shift){dx, dy})));
    return best;
}

/* Which part of the blocks match at this shift, [0, 1]. */
static double alike_blocks(const L1L2Thumbnail *a, const L1L2Thumbnail *b, Shift shift)
{
    int alike = 0;
    for (int y = 0; y < H; y += BLOCK)
        for (int x = 0; x < W; x += BLOCK) {
            const Area block = {x, y, x + BLOCK < W ? x + BLOCK : W, y + BLOCK < H ? y + BLOCK : H};
            alike += correlation(area_sums(a, b, shift, block)) >= same_block;
        }
    return (double)alike / (((W + BLOCK - 1) / BLOCK) * ((H + BLOCK - 1) / BLOCK));
}

bool l1l2_image_thumbnails_differ(const L1L2Thumbnail *a, const L1L2Thumbnail *b)
{
    if (!l1l2_image_thumbnail_has_detail(a) || !l1l2_image_thumbnail_has_detail(b) ||
        l1l2_image_thumbnail_correlation(a, b) >= same_shot)
        return false;
    double best = 0.0;
    for (int dy = -MAX_SHIFT_Y; dy <= MAX_SHIFT_Y; dy++)
        for (int dx = -MAX_SHIFT_X; dx <= MAX_SHIFT_X; dx++)
            best = fmax(best, alike_blocks(a, b, (Shift){dx, dy}));
    return best < enough_blocks;
}
