/* SPDX-License-Identifier: MIT */
#include "synth_overlay.h"

#include <math.h>

#include "synth_scene.h"

enum { BLACK = 16, NEUTRAL = 128, WHITE = 235, DIGITS = 6, CELL_W = 6, CELL_H = 9 };

/* Seven segments of each digit, on a cell of 4x7 blocks: top, upper left, upper right, middle, lower left, lower right,
 * bottom. */
static const uint8_t segments[10] = {0x77, 0x24, 0x5d, 0x6d, 0x2e, 0x6b, 0x7b, 0x25, 0x7f, 0x6f};

/* Is block (x, y) of a digit's cell lit? */
static bool lit(int digit, int x, int y)
{
    if (x < 0 || x > 3 || y < 0 || y > 6)
        return false;
    const bool across = x > 0 && x < 3, upper = y < 4, lower = y > 2;
    const unsigned on = segments[digit];
    return (across && ((y == 0 && on & 1u) || (y == 3 && on & 8u) || (y == 6 && on & 64u))) ||
           (x == 0 && ((upper && y > 0 && on & 2u) || (lower && y < 6 && on & 16u))) ||
           (x == 3 && ((upper && y > 0 && on & 4u) || (lower && y < 6 && on & 32u)));
}

/* The level of the timecode, white digits on a black box in the upper left corner of the picture; -1 outside it. x, y:
 * px from that corner. */
static int timecode_level(const SynthConfig *cfg, int t, double x, double y)
{
    const double block = fmax(cfg->height / 160.0, 1.0), left = 4.0 * block;
    const int column = (int)floor((x - left) / block), row = (int)floor((y - left) / block);
    if (column < 0 || column >= DIGITS * CELL_W || row < 0 || row >= CELL_H)
        return -1;
    int digit = t;
    for (int k = column / CELL_W; k < DIGITS - 1; k++)
        digit /= 10;
    return lit(digit % 10, column % CELL_W - 1, row - 1) ? WHITE : BLACK;
}

/* The level of the logo, light and dark blocks as dense as letters in the lower right corner; -1 outside it. x, y: px
 * from that corner. */
static int logo_level(const SynthConfig *cfg, double x, double y)
{
    const double block = fmax(cfg->height / 120.0, 1.0), margin = 4.0 * block;
    const double w = cfg->width / 8.0, h = w / 3.0;
    if (x < margin || x >= margin + w || y < margin || y >= margin + h)
        return -1;
    const uint64_t key = ((uint64_t)((y - margin) / block) << 16) + (uint64_t)((x - margin) / block);
    return synth_hash(key + 7u) & 1u ? WHITE : BLACK;
}

void synth_overlay_draw(const SynthConfig *cfg, int t, int depth, const SynthSpan *span, uint16_t *code)
{
    if (!cfg->overlay && cfg->letterbox <= 0.0 && cfg->pillarbox <= 0.0)
        return;
    const double half_w = 0.5 * cfg->width * (1.0 - cfg->pillarbox);
    const double half_h = 0.5 * cfg->height * (1.0 - cfg->letterbox);
    for (int i = 0; i < span->count; i++) {
        const double x = span->x + i * span->step, y = span->y;
        int level = -1;
        if (fabs(x) > half_w || fabs(y) > half_h)
            level = BLACK;
        else if (cfg->overlay & SYNTH_OVERLAY_TIMECODE)
            level = timecode_level(cfg, t, x + half_w, y + half_h);
        if (level < 0 && cfg->overlay & SYNTH_OVERLAY_LOGO)
            level = logo_level(cfg, half_w - x, half_h - y);
        if (level >= 0)
            code[i] = (uint16_t)((span->component ? NEUTRAL : level) << (depth - 8));
    }
}
