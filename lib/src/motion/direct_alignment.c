/* SPDX-License-Identifier: MIT */
#include "motion/direct_alignment.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "common/cholesky.h"
#include "common/mem.h"
#include "motion/phase_correlation.h"

enum {
    LANES = 8,          /* partial sums of a row: they let a compiler vectorize without changing the result */
    MAX_SAMPLES = 7000, /* of a level, about; more are passed over evenly */
    UNKNOWNS = 6,       /* zoom, turn, x, y, gain, offset */
    MOTION = 4,         /* of these, the motion's */
    PEAKS = 4,          /* of the phase correlation, that are tried */
    MAX_GUESSES = L1L2_ALIGN_MAX_STARTS + PEAKS + 1,
    CELLS = L1L2_ALIGN_CELLS,
    BINS = 1024,        /* of the residuals' histogram */
    BIN_PER_GREY = 16
};

/* Guesses that are refined at the finest level, the next one and the coarsest; and Gauss-Newton steps of each. */
static const int guesses_kept[] = {2, 3, 5}, max_steps[] = {8, 6, 6};
/* A step below it ends the iteration; pixels of the level, at the frame's corners. */
static const double last_step = 0.02;
/* Guesses that differ by less than this at the corners are one; pixels of the level. */
static const double same_guess = 0.5;
static const double rival_distance = 2.0; /* pixels of level 0 */
static const double as_good = 1.03; /* ratio of residuals */
/* Of the picture that has to lie in the other one. */
static const double min_overlap = 0.5;
/* The clip of a difference, of the picture's contrast (standard deviation), and its limits in grey levels. */
static const double clip_of_contrast = 0.4, min_clip = 1.5, max_clip = 20.0;
/* Residuals weigh 1 / (1 + (r / (width scatter))^2)^2. */
static const double weight_width = 2.0, min_scatter = 0.3;
/* A sample counts 1, and this for each grey level a pixel of the picture's slope, for the residuals' scatter. */
static const float detail_per_slope = 8.0f;
/* How firmly the gain is held, as part of the samples. */
static const double gain_hold = 0.1;
/* The deviation that a motion's step has before any picture is seen, pixels of the level. It holds what the picture
 * does not tell. */
static const double prior_step = 10.0;

/* The samples of picture `now` at one level. */
typedef struct Template {
    const L1L2FloatLevel *level;
    int margin, spacing, columns, rows, pitch;
    double unit_x, unit_y; /* diagonals a pixel of the level */
    double half_w, half_h;
    /* Rows of `pitch`. Slopes are in grey levels a pixel; those down the picture are scaled to the unit across. */
    float *grey, *slope_x, *slope_y;
    int16_t *detail;                 /* of each sample: how much its residual tells of the motion */
} Template;

typedef struct Guess {
    L1L2Mat F;
    double gain, offset;
    double residual; /* clipped mean; FLT_MAX where too little overlaps */
    double overlap;
    bool expected;   /* from the caller's first guess: kept at every level */
} Guess;

typedef struct Normal {
    double product[UNKNOWNS][UNKNOWNS]; /* lower triangle */
    double right[UNKNOWNS];
} Normal;

struct L1L2DirectAlignment {
    double half_w, half_h;    /* of the frame, diagonals */
    L1L2PhaseCorrelator *phase;
    float *memory;
    int16_t *detail;
    Template template;
    float *warped, *residual, *weight; /* of each sample; weight 0 outside the other picture, or the cell's */
    double clip, mean;        /* of the pictures */
    double gain, offset;      /* that are expected */
    L1L2Mask mask;
    bool layered;             /* samples that move with a layer over the scene do not count */
    float *layer_residual;    /* what its motion leaves of each sample */
    float *open;              /* of each sample of the template's level: 0 where it is masked */
    int histogram[BINS];
    float trust[CELLS];       /* how much the samples of each cell count */
    float pattern[L1L2_ALIGN_CELLS_Y][L1L2_FLOAT_PYRAMID_SIDE + LANES]; /* the same for each sample of a row */
    float column[UNKNOWNS + 2][L1L2_FLOAT_PYRAMID_SIDE + LANES];
};

L1L2DirectAlignment *l1l2_motion_align_new(int width, int height, double frame_width, double frame_height)
{
    L1L2DirectAlignment *d = l1l2_mem_new(1, sizeof *d);
    if (!d)
        return NULL;
    const double diagonal = hypot(frame_width, frame_height);
    d->half_w = 0.5 * frame_width / diagonal, d->half_h = 0.5 * frame_height / diagonal;
    /* Of any level: MAX_SAMPLES, rounded up in each row and column. */
    const size_t samples = MAX_SAMPLES + (size_t)(LANES + 2) * L1L2_FLOAT_PYRAMID_SIDE;
    d->phase = l1l2_motion_phase_new();
    d->memory = l1l2_mem_new(7 * samples, sizeof *d->memory);
    d->detail = l1l2_mem_new(samples, sizeof *d->detail);
    d->open = l1l2_mem_new((size_t)L1L2_FLOAT_PYRAMID_SIDE * L1L2_FLOAT_PYRAMID_SIDE, sizeof *d->open);
    if (!d->phase || !d->memory || !d->detail || !d->open) {
        l1l2_motion_align_free(d);
        return NULL;
    }
    d->template.grey = d->memory;
    d->template.detail = d->detail;
    d->template.slope_x = d->memory + samples;
    d->template.slope_y = d->memory + 2 * samples;
    d->warped = d->memory + 3 * samples;
    d->residual = d->memory + 4 * samples;
    d->weight = d->memory + 5 * samples;
    d->layer_residual = d->memory + 6 * samples;
    return d;
}

void l1l2_motion_align_free(L1L2DirectAlignment *d)
{
    if (!d)
        return;
    l1l2_motion_phase_free(d->phase);
    l1l2_mem_free(d->memory);
    l1l2_mem_free(d->detail);
    l1l2_mem_free(d->open);
    l1l2_mem_free(d);
}

static int larger(int a, int b)
{
    return a > b ? a : b;
}

/* How much the samples of each cell count from now on. */
static void set_trust(L1L2DirectAlignment *d, const float *trust)
{
    const Template *t = &d->template;
    memcpy(d->trust, trust, sizeof d->trust);
    for (int y = 0; y < L1L2_ALIGN_CELLS_Y; y++)
        for (int c = 0; c < t->columns; c++)
            d->pattern[y][c] = trust[y * L1L2_ALIGN_CELLS_X + c * L1L2_ALIGN_CELLS_X / t->columns];
}

/* The mask at the size of a level. */
static void set_mask(L1L2DirectAlignment *d, const L1L2FloatLevel *level)
{
    const L1L2Mask *mask = &d->mask;
    for (int y = 0; mask->blocked && y < level->height; y++) {
        const uint8_t *row = mask->blocked + (ptrdiff_t)(y * mask->height / level->height) * mask->width;
        for (int x = 0; x < level->width; x++)
            d->open[(ptrdiff_t)y * level->width + x] = row[x * mask->width / level->width] ? 0.0f : 1.0f;
    }
}

static void set_template(L1L2DirectAlignment *d, const L1L2FloatPyramid *now, int which)
{
    Template *t = &d->template;
    const L1L2FloatLevel *level = now->level + which;
    t->level = level;
    t->margin = larger(2, 6 >> which);
    t->spacing = larger(1, (int)ceil(sqrt((double)level->width * level->height / MAX_SAMPLES)));
    t->columns = (level->width - 2 * t->margin + t->spacing - 1) / t->spacing;
    t->rows = (level->height - 2 * t->margin + t->spacing - 1) / t->spacing;
    t->pitch = (t->columns + LANES - 1) / LANES * LANES;
    t->unit_x = 2.0 * d->half_w * level->step / now->width;
    t->unit_y = 2.0 * d->half_h * level->step / now->height;
    t->half_w = d->half_w, t->half_h = d->half_h;
    set_mask(d, level);
    const float half = 0.5f, half_y = (float)(0.5 * t->unit_x / t->unit_y);
    for (int r = 0; r < t->rows; r++) {
        const float *row = level->sample + (ptrdiff_t)(t->margin + r * t->spacing) * level->width + t->margin;
        float *grey = t->grey + r * t->pitch, *sx = t->slope_x + r * t->pitch, *sy = t->slope_y + r * t->pitch;
        int16_t *detail = t->detail + r * t->pitch;
        for (int c = 0; c < t->columns; c++) {
            const float *p = row + c * t->spacing;
            grey[c] = p[0];
            sx[c] = half * (p[1] - p[-1]);
            sy[c] = half_y * (p[level->width] - p[-level->width]);
            detail[c] = (int16_t)(1.0f + detail_per_slope * fminf(fabsf(sx[c]) + fabsf(sy[c]), 100.0f));
        }
        for (int c = t->columns; c < t->pitch; c++)
            grey[c] = sx[c] = sy[c] = 0.0f;
    }
}

/* Where sample (c, r) lies, diagonals from the frame's centre. */
static double sample_x(const Template *t, double c)
{
    return (t->margin + c * t->spacing + 0.5) * t->unit_x - t->half_w;
}

static double sample_y(const Template *t, double r)
{
    return (t->margin + r * t->spacing + 0.5) * t->unit_y - t->half_h;
}

/* True if a place of a level, in pixels, has samples on all sides. */
static bool lies_inside(const L1L2FloatLevel *level, float u, float v)
{
    return u >= 1.0f && v >= 1.0f && u < (float)(level->width - 2) && v < (float)(level->height - 2);
}

/* Samples that the layer's motion explains clearly better do not count. */
static void exclude_layer(float *residual, const float *by_layer, float *weight, int count)
{
    const float clearly = 0.5f, least = 4.0f; /* ratio; grey levels */
    for (int c = 0; c < count; c++)
        if (fabsf(residual[c]) > least && fabsf(by_layer[c]) < clearly * fabsf(residual[c]))
            residual[c] = weight[c] = 0.0f;
}

/* The other picture at F of each sample, and what is left between the two. Returns how many samples lie in it. */
static int compare(L1L2DirectAlignment *d, const L1L2FloatLevel *other, const Guess *g)
{
    const Template *t = &d->template;
    const double *m = g->F.m;
    const int width = other->width;
    const float gain = (float)g->gain, constant = (float)(d->mean * (1.0 - g->gain) + g->offset);
    int inside = 0;
    for (int r = 0; r < t->rows; r++) {
        const double x0 = sample_x(t, 0.0), y0 = sample_y(t, r), dx = t->spacing * t->unit_x;
        /* In pixels of the level, of the row's first sample and from one to the next. */
        const float u0 = (float)((m[0] * x0 + m[1] * y0 + m[2] + t->half_w) / t->unit_x - 0.5);
        const float v0 = (float)((m[3] * x0 + m[4] * y0 + m[5] + t->half_h) / t->unit_y - 0.5);
        const float du = (float)(m[0] * dx / t->unit_x), dv = (float)(m[3] * dx / t->unit_y);
        const float *grey = t->grey + r * t->pitch;
        float *warped = d->warped + r * t->pitch, *weight = d->weight + r * t->pitch;
        float *residual = d->residual + r * t->pitch;
        int first = 0, end = t->columns; /* those in between lie inside too */
        while (first < end && !lies_inside(other, u0 + (float)first * du, v0 + (float)first * dv))
            warped[first] = weight[first] = 0.0f, first++;
        while (end > first && !lies_inside(other, u0 + (float)(end - 1) * du, v0 + (float)(end - 1) * dv))
            end--;
        for (int c = first; c < end; c++) {
            const float u = u0 + (float)c * du, v = v0 + (float)c * dv;
            const int i = (int)u, j = (int)v;
            const float *p = other->sample + (ptrdiff_t)j * width + i;
            const float fx = u - (float)i, fy = v - (float)j;
            const float upper = p[0] + fx * (p[1] - p[0]), lower = p[width] + fx * (p[width + 1] - p[width]);
            warped[c] = upper + fy * (lower - upper);
        }
        if (end > first)
            memcpy(weight + first, d->pattern[r * L1L2_ALIGN_CELLS_Y / t->rows] + first,
                   (size_t)(end - first) * sizeof *weight);
        for (int c = first; d->mask.blocked && c < end; c++) {
            const float u = u0 + (float)c * du + 0.5f, v = v0 + (float)c * dv + 0.5f;
            weight[c] *= d->open[(ptrdiff_t)(t->margin + r * t->spacing) * width + t->margin + c * t->spacing] *
                         d->open[(ptrdiff_t)v * width + (ptrdiff_t)u];
        }
        for (int c = end; c < t->pitch; c++)
            warped[c] = weight[c] = 0.0f;
        inside += end - first;
        for (int c = 0; c < t->pitch; c++)
            residual[c] = weight[c] > 0.0f ? gain * warped[c] + constant - grey[c] : 0.0f;
        if (d->layered)
            exclude_layer(residual, d->layer_residual + r * t->pitch, weight, t->pitch);
    }
    return inside;
}

/* The weighted mean of min(|residual|, clip). */
static double clipped_mean(const L1L2DirectAlignment *d)
{
    const Template *t = &d->template;
    const float clip = (float)d->clip;
    double sum = 0.0, weights = 0.0;
    for (int r = 0; r < t->rows; r++) {
        const float *residual = d->residual + r * t->pitch, *weight = d->weight + r * t->pitch;
        float lane[LANES] = {0.0f}, all[LANES] = {0.0f};
        for (int c = 0; c < t->pitch; c += LANES)
            for (int k = 0; k < LANES; k++) {
                const float size = fabsf(residual[c + k]);
                lane[k] += weight[c + k] * (size < clip ? size : clip);
                all[k] += weight[c + k];
            }
        for (int k = 0; k < LANES; k++)
            sum += (double)lane[k], weights += (double)all[k];
    }
    return weights > 0.0 ? sum / weights : (double)FLT_MAX;
}

static void judge(L1L2DirectAlignment *d, const L1L2FloatLevel *other, Guess *g)
{
    const int inside = compare(d, other, g), all = d->template.columns * d->template.rows;
    g->overlap = (double)inside / all;
    g->residual = g->overlap >= min_overlap ? clipped_mean(d) : (double)FLT_MAX;
}

/* The deviation of the residuals by their median, since half of them may be of something else. Each counts by the
 * picture's slope there: of stars in a dark sky, the median of all samples would be the sky's noise. */
static double scatter(L1L2DirectAlignment *d)
{
    const Template *t = &d->template;
    int64_t all = 0, below = 0;
    memset(d->histogram, 0, sizeof d->histogram);
    for (int r = 0; r < t->rows; r++) {
        const float *weight = d->weight + r * t->pitch, *residual = d->residual + r * t->pitch;
        const int16_t *detail = t->detail + r * t->pitch;
        for (int c = 0; c < t->columns; c++) {
            const float at = fabsf(residual[c]) * (float)BIN_PER_GREY;
            const int count = weight[c] > 0.0f ? detail[c] : 0;
            d->histogram[at < (float)(BINS - 1) ? (int)at : BINS - 1] += count;
            all += count;
        }
    }
    int bin = 0;
    for (; bin < BINS - 1; bin++) {
        below += d->histogram[bin];
        if (2 * below >= all)
            break;
    }
    return fmax(min_scatter, 1.4826 * (bin + 0.5) / BIN_PER_GREY);
}

static double dot(const float *a, const float *b, int count)
{
    float lane[LANES] = {0.0f};
    for (int c = 0; c < count; c += LANES)
        for (int k = 0; k < LANES; k++)
            lane[k] += a[c + k] * b[c + k];
    double sum = 0.0;
    for (int k = 0; k < LANES; k++)
        sum += (double)lane[k];
    return sum;
}

/*
 * The normal equations of one step. Picture `now`, moved by a small similarity (1 + p0, p1, p2, p3), is to match the
 * other one, whose contrast and brightness change by p4 and p5:
 *
 *     slope . (p0 u + p1 u' + (p2, p3)) - p4 (w - mean) - p5 = r          u' = (-v, u)
 *
 * with (u, v) the sample's place in half diagonals: then p0 ... p3 are pixels of the level by which corners move.
 */
static void add_row(L1L2DirectAlignment *d, int r, double spread, Normal *n)
{
    const Template *t = &d->template;
    const int at = r * t->pitch;
    const float *sx = t->slope_x + at, *sy = t->slope_y + at, *warped = d->warped + at, *residual = d->residual + at;
    const float *inside = d->weight + at;
    const float x0 = (float)(2.0 * sample_x(t, 0.0)), dx = (float)(2.0 * t->spacing * t->unit_x);
    const float y = (float)(2.0 * sample_y(t, r)), mean = (float)d->mean, sharp = (float)(1.0 / spread);
    float(*column)[L1L2_FLOAT_PYRAMID_SIDE + LANES] = d->column;
    float *weight = column[UNKNOWNS], *weighted = column[UNKNOWNS + 1];
    for (int c = 0; c < t->pitch; c++) {
        const float x = x0 + (float)c * dx, q = residual[c] * sharp, one = 1.0f + q * q;
        weight[c] = inside[c] / (one * one);
        column[0][c] = sx[c] * x + sy[c] * y;
        column[1][c] = sy[c] * x - sx[c] * y;
        column[2][c] = sx[c];
        column[3][c] = sy[c];
        column[4][c] = mean - warped[c];
        column[5][c] = -1.0f;
    }
    for (int i = 0; i < UNKNOWNS; i++) {
        for (int c = 0; c < t->pitch; c++)
            weighted[c] = weight[c] * column[i][c];
        for (int j = 0; j <= i; j++)
            n->product[i][j] += dot(weighted, column[j], t->pitch);
        n->right[i] += dot(weighted, residual, t->pitch);
    }
}

static Normal normal_equations(L1L2DirectAlignment *d, double spread)
{
    Normal n = {{{0.0}}, {0.0}};
    for (int r = 0; r < d->template.rows; r++)
        add_row(d, r, spread, &n);
    return n;
}

/* F after the inverse of the step p, which is in pixels of the level. */
static L1L2Mat compose(const Template *t, const L1L2Mat *F, const double *p)
{
    const double unit = t->unit_x;
    L1L2Mat inverse;
    const L1L2Mat step =
        l1l2_mat_similarity(1.0 + 2.0 * unit * p[0], 2.0 * unit * p[1], unit * p[2], unit * p[3]);
    if (!l1l2_mat_inverse(step, &inverse))
        return *F;
    return l1l2_mat_mul(*F, inverse);
}

/* Gauss-Newton from a guess; it is replaced where the result fits better. */
static void refine(L1L2DirectAlignment *d, const L1L2FloatLevel *other, int steps, Guess *guess)
{
    const int all = d->template.columns * d->template.rows;
    Guess g = *guess;
    for (int step = 0; step < steps; step++) {
        const int inside = compare(d, other, &g);
        if (inside < min_overlap * all)
            break;
        const double deviation = scatter(d);
        Normal n = normal_equations(d, weight_width * deviation);
        for (int i = 0; i < MOTION; i++)
            n.product[i][i] += deviation * deviation / (prior_step * prior_step);
        const double hold = gain_hold * n.product[4][4] + 1e-6;
        n.product[4][4] += hold;
        n.right[4] += hold * (d->gain - g.gain);
        n.product[5][5] += 1e-6;
        if (!l1l2_cholesky_factorize(n.product[0], UNKNOWNS, UNKNOWNS))
            break;
        l1l2_cholesky_solve(n.product[0], UNKNOWNS, UNKNOWNS, n.right);
        g.F = compose(&d->template, &g.F, n.right);
        g.gain += n.right[4], g.offset += n.right[5];
        double size = 0.0;
        for (int i = 0; i < MOTION; i++)
            size += n.right[i] * n.right[i];
        if (size < last_step * last_step)
            break;
    }
    judge(d, other, &g);
    if (g.residual < guess->residual)
        *guess = g;
}

/* How far two motions put the corners apart, pixels of the level. */
static double distance(const L1L2DirectAlignment *d, const L1L2Mat *a, const L1L2Mat *b)
{
    return l1l2_mat_corner_distance(a, b, d->half_w, d->half_h) / d->template.unit_x;
}

/* The best ones first, and of those that are alike only the best. Returns how many are left. */
static int sort_guesses(const L1L2DirectAlignment *d, Guess *guess, int count, double same)
{
    int kept = 0;
    for (int i = 1; i < count; i++)
        for (int j = i; j > 0 && guess[j].residual < guess[j - 1].residual; j--) {
            const Guess g = guess[j];
            guess[j] = guess[j - 1];
            guess[j - 1] = g;
        }
    for (int i = 0; i < count; i++) {
        bool novel = true;
        for (int j = 0; j < kept && novel; j++)
            if (distance(d, &guess[i].F, &guess[j].F) < same) {
                guess[j].expected |= guess[i].expected;
                novel = false;
            }
        if (novel)
            guess[kept++] = guess[i];
    }
    return kept;
}

/* The first `most` of the sorted guesses, and the expected one. Returns how many are left. */
static int drop_guesses(Guess *guess, int count, int most)
{
    int kept = count < most ? count : most;
    for (int i = kept; i < count; i++)
        if (guess[i].expected && guess[i].residual < (double)FLT_MAX)
            guess[kept++] = guess[i];
    return kept;
}

/* Texture that repeats fits about as well at every period: of guesses that do, the expected one is right. */
static void prefer_expected(const L1L2DirectAlignment *d, Guess *guess, int count)
{
    for (int i = 1; i < count; i++)
        if (guess[i].expected && guess[i].residual <= as_good * guess[0].residual &&
            distance(d, &guess[i].F, &guess[0].F) >= rival_distance) {
            const Guess g = guess[i];
            memmove(guess + 1, guess, (size_t)i * sizeof *guess);
            guess[0] = g;
            return;
        }
}

static void moments(const L1L2FloatLevel *level, double *mean, double *deviation)
{
    double sum = 0.0, squares = 0.0;
    const int count = level->width * level->height;
    for (int i = 0; i < count; i++) {
        const double v = (double)level->sample[i];
        sum += v, squares += v * v;
    }
    *mean = sum / count;
    *deviation = sqrt(fmax(0.0, squares / count - *mean * *mean));
}

/* The brightness and contrast of both pictures: what gain is expected, and where a difference is clipped. */
static void set_brightness(L1L2DirectAlignment *d, const L1L2FloatLevel *now, const L1L2FloatLevel *other)
{
    const double same_contrast = 0.08, same_mean = 6.0, flat = 1.0;
    double mean, deviation, other_deviation;
    moments(now, &mean, &deviation);
    moments(other, &d->mean, &other_deviation);
    d->clip = fmin(fmax(clip_of_contrast * deviation, min_clip), max_clip);
    d->gain = 1.0, d->offset = 0.0;
    if (deviation < flat || other_deviation < flat)
        return;
    const double gain = deviation / other_deviation;
    if (fabs(log(gain)) < same_contrast && fabs(mean - d->mean) < same_mean)
        return;
    d->gain = fmin(fmax(gain, 0.25), 4.0);
    d->offset = mean - d->mean;
}

/* The guesses that the two pictures give by themselves: the identity and the peaks of the phase correlation. */
static int guess_without_caller(L1L2DirectAlignment *d, const L1L2FloatPyramid *now, const L1L2FloatPyramid *other,
                         Guess *guess)
{
    const int level = now->levels > 1 ? 1 : 0;
    L1L2Shift shift[PEAKS];
    const int peaks = l1l2_motion_phase_correlate(d->phase, now->level[level].sample, other->level[level].sample,
                                                  now->level[level].width, now->level[level].height, shift, PEAKS);
    guess[0] = (Guess){.F = l1l2_mat_identity()};
    for (int i = 0; i < peaks; i++)
        guess[i + 1] = (Guess){
            .F = l1l2_mat_translation(2.0 * d->half_w * shift[i].x, 2.0 * d->half_h * shift[i].y)};
    return peaks + 1;
}

static int take_starts(const L1L2AlignmentGuide *guide, Guess *guess)
{
    const int count = guide->starts < L1L2_ALIGN_MAX_STARTS ? guide->starts : L1L2_ALIGN_MAX_STARTS;
    for (int i = 0; i < count; i++)
        guess[i] = (Guess){.F = guide->start[i], .expected = i == 0};
    return count;
}

/* One level: the best guesses are refined. Returns how many are left. */
static int refine_level(L1L2DirectAlignment *d, const L1L2FloatPyramid *other, int level, Guess *guess, int count)
{
    for (int i = 0; i < count; i++)
        judge(d, other->level + level, guess + i);
    count = drop_guesses(guess, sort_guesses(d, guess, count, same_guess), guesses_kept[level]);
    for (int i = 0; i < count; i++)
        refine(d, other->level + level, max_steps[level], guess + i);
    return sort_guesses(d, guess, count, same_guess);
}

/* The coarsest level. What the pictures give by themselves is refined before the caller's guesses come in. */
static int refine_coarsest(L1L2DirectAlignment *d, const L1L2FloatPyramid *now, const L1L2FloatPyramid *other,
                           int level, const L1L2AlignmentGuide *guide, Guess *guess, L1L2Mat *blind)
{
    int count = guess_without_caller(d, now, other, guess);
    for (int i = 0; i < count; i++)
        guess[i].gain = d->gain, guess[i].offset = d->offset;
    count = refine_level(d, other, level, guess, count);
    *blind = guess->F;
    if (guide->trust)
        set_trust(d, guide->trust);
    const int given = take_starts(guide, guess + count);
    for (int i = count; i < count + given; i++) {
        guess[i].gain = d->gain, guess[i].offset = d->offset;
        judge(d, other->level + level, guess + i);
        refine(d, other->level + level, max_steps[level], guess + i);
    }
    return sort_guesses(d, guess, count + given, same_guess);
}

/* Sums over a cell. */
typedef struct Cell {
    double n, a, b, aa, bb, ab;
    double difference; /* clipped */
    double xx, xy, yy, xr, yr;
} Cell;

static void add_sample(const L1L2DirectAlignment *d, int at, Cell *cell)
{
    const double a = (double)d->template.grey[at], b = (double)d->warped[at], r = (double)d->residual[at];
    const double x = (double)d->template.slope_x[at], y = (double)d->template.slope_y[at];
    cell->n += 1.0, cell->a += a, cell->b += b;
    cell->aa += a * a, cell->bb += b * b, cell->ab += a * b;
    cell->difference += fmin(fabs(r), d->clip);
    cell->xx += x * x, cell->xy += x * y, cell->yy += y * y;
    cell->xr += x * r, cell->yr += y * r;
}

/* The cells under a guess. The template is level 0's. */
static void survey(L1L2DirectAlignment *d, const L1L2FloatLevel *other, const Guess *g, Cell cell[CELLS])
{
    const Template *t = &d->template;
    memset(cell, 0, CELLS * sizeof *cell);
    compare(d, other, g);
    for (int r = 0; r < t->rows; r++)
        for (int c = 0; c < t->columns; c++)
            if (d->weight[r * t->pitch + c] > 0.0f) {
                const int x = c * L1L2_ALIGN_CELLS_X / t->columns, y = r * L1L2_ALIGN_CELLS_Y / t->rows;
                add_sample(d, r * t->pitch + c, cell + y * L1L2_ALIGN_CELLS_X + x);
            }
}

static double correlation(const Cell *cell, int count)
{
    Cell s = {0};
    for (int i = 0; i < count; i++) {
        s.n += cell[i].n, s.a += cell[i].a, s.b += cell[i].b;
        s.aa += cell[i].aa, s.bb += cell[i].bb, s.ab += cell[i].ab;
    }
    const double va = s.n * s.aa - s.a * s.a, vb = s.n * s.bb - s.b * s.b;
    return va > 0.0 && vb > 0.0 ? (s.n * s.ab - s.a * s.b) / sqrt(va * vb) : 0.0;
}

/* How far a cell by itself would still move the picture, pixels of the level. */
typedef struct CellShift {
    bool valid;  /* the cell has detail in every direction */
    double u, v; /* the cell's centre, half diagonals */
    double x, y;
} CellShift;

static void find_shifts(const L1L2DirectAlignment *d, const Cell *cell, double noise, CellShift *shift)
{
    const double least_samples = 50.0, deviation = 0.5; /* pixels of the level */
    for (int i = 0; i < CELLS; i++) {
        const Cell *c = cell + i;
        const double root = sqrt((c->xx - c->yy) * (c->xx - c->yy) + 4.0 * c->xy * c->xy);
        const double smaller = 0.5 * (c->xx + c->yy - root), det = c->xx * c->yy - c->xy * c->xy;
        shift[i] = (CellShift){c->n >= least_samples && det > 0.0 && smaller * deviation * deviation > noise * noise,
                               2.0 * d->half_w * (2.0 * (i % L1L2_ALIGN_CELLS_X) + 1.0 - L1L2_ALIGN_CELLS_X) /
                                   L1L2_ALIGN_CELLS_X,
                               2.0 * d->half_h * (2.0 * (i / L1L2_ALIGN_CELLS_X) + 1.0 - L1L2_ALIGN_CELLS_Y) /
                                   L1L2_ALIGN_CELLS_Y,
                               0.0, 0.0};
        if (shift[i].valid) {
            shift[i].x = (c->yy * c->xr - c->xy * c->yr) / det;
            shift[i].y = (c->xx * c->yr - c->xy * c->xr) / det;
        }
    }
}

static double shift_error(const CellShift *s, const double *p)
{
    return hypot(p[0] * s->u - p[1] * s->v + p[2] - s->x, p[0] * s->v + p[1] * s->u + p[3] - s->y);
}

/* The small similarity p that takes two cells by their shifts. */
static bool through_two(const CellShift *a, const CellShift *b, double *p)
{
    const double u = b->u - a->u, v = b->v - a->v, x = b->x - a->x, y = b->y - a->y, size = u * u + v * v;
    if (size <= 0.0)
        return false;
    p[0] = (u * x + v * y) / size, p[1] = (u * y - v * x) / size;
    p[2] = a->x - p[0] * a->u + p[1] * a->v, p[3] = a->y - p[0] * a->v - p[1] * a->u;
    return true;
}

/* The similarity by which the most cells agree, of those that `of` names; of two such, the one that they fit better.
 * All pairs are tried. Returns the trust of the cells that agree. */
static double find_consensus(const CellShift *shift, const float *trust, const bool *of, bool *agrees, double *motion)
{
    const double tolerance = 0.35, far_pair = 0.5; /* pixels of the level; half diagonals */
    double most = 0.0, score = 0.0;
    memset(agrees, 0, CELLS * sizeof *agrees);
    for (int i = 0; i < CELLS; i++)
        for (int j = i + 1; j < CELLS; j++) {
            double p[MOTION], votes = 0.0, fit = 0.0;
            if (!of[i] || !of[j] || hypot(shift[i].u - shift[j].u, shift[i].v - shift[j].v) < far_pair ||
                !through_two(shift + i, shift + j, p))
                continue;
            for (int k = 0; k < CELLS; k++) {
                const double error = of[k] ? shift_error(shift + k, p) : INFINITY;
                if (error < tolerance) {
                    votes += (double)trust[k];
                    fit += (double)trust[k] * (1.0 - error * error / (tolerance * tolerance));
                }
            }
            if (fit <= score)
                continue;
            score = fit, most = votes;
            memcpy(motion, p, sizeof p);
            for (int k = 0; k < CELLS; k++)
                agrees[k] = of[k] && shift_error(shift + k, p) < tolerance;
        }
    return most;
}

/* Gauss-Newton on the cells that agree, from the winner and the similarity that they have beside it. */
static Guess refine_part(L1L2DirectAlignment *d, const L1L2FloatLevel *other, const Guess *winner, const double *p,
                         const bool *part)
{
    float trust[CELLS], all[CELLS];
    Guess g = *winner;
    memcpy(all, d->trust, sizeof all);
    for (int i = 0; i < CELLS; i++)
        trust[i] = part[i] ? all[i] : 0.0f;
    set_trust(d, trust);
    g.F = compose(&d->template, &winner->F, p);
    judge(d, other, &g);
    refine(d, other, max_steps[0], &g);
    set_trust(d, all);
    judge(d, other, &g);
    return g;
}

/*
 * Two things that move differently: Gauss-Newton ends between their motions where these are close to each other. The
 * cells tell: where some agree with one motion and nearly all others with another one, both are refined by their own
 * cells. The one with more cells is the winner, the other one is added to the guesses as its rival. Where depth is
 * continuous the cells do not part like that, and the winner stays. Returns the part of the cells that agree with the
 * winner's motion.
 */
static double split(L1L2DirectAlignment *d, const L1L2FloatLevel *other, bool wanted, Guess *guess, int *count)
{
    const double least_first = 0.3, least_second = 0.45, fewest = 3.0;
    Cell cell[CELLS];
    CellShift shift[CELLS];
    bool of[CELLS], first[CELLS], second[CELLS];
    double p[MOTION], q[MOTION], all = 0.0;
    survey(d, other, guess, cell);
    find_shifts(d, cell, scatter(d), shift);
    for (int i = 0; i < CELLS; i++) {
        of[i] = shift[i].valid && d->trust[i] > 0.0f;
        all += of[i] ? (double)d->trust[i] : 0.0;
    }
    const double one = find_consensus(shift, d->trust, of, first, p);
    if (!(one > 0.0))
        return 0.0;
    if (!wanted)
        return one / all;
    for (int i = 0; i < CELLS; i++)
        of[i] = of[i] && !first[i];
    const double two = find_consensus(shift, d->trust, of, second, q);
    if (one >= least_first * all && two >= fewest && two >= least_second * (all - one)) {
        const Guess rival = refine_part(d, other, guess, q, second);
        guess[0] = refine_part(d, other, guess, p, first);
        guess[1] = rival;
        *count = 2;
    }
    return one / all;
}

/* Cells that have detail, and how each of them sees the winner beside the others. */
static void compare_cells(const Cell *winner, const Cell *identity, const Cell *rival, const CellShift *shift,
                          double pixel, L1L2AlignmentEvidence *e)
{
    const double clearly = 0.9;
    double length[CELLS] = {0};
    int with_detail = 0, support = 0, opposition = 0;
    for (int i = 0; i < CELLS; i++) {
        if (!shift[i].valid)
            continue;
        const double value = hypot(shift[i].x, shift[i].y);
        int at = with_detail++;
        for (; at > 0 && length[at - 1] > value; at--)
            length[at] = length[at - 1];
        length[at] = value;
        const double mine = winner[i].difference / winner[i].n;
        double best = identity[i].n > 0.0 ? identity[i].difference / identity[i].n : INFINITY;
        if (rival && rival[i].n > 0.0)
            best = fmin(best, rival[i].difference / rival[i].n);
        support += mine < clearly * best;
        opposition += best < clearly * mine;
    }
    e->detail = (double)with_detail / CELLS;
    e->support = with_detail ? (double)support / with_detail : 0.0;
    e->opposition = with_detail ? (double)opposition / with_detail : 0.0;
    e->local_shift = with_detail ? pixel * length[with_detail / 2] : INFINITY;
}

/* Eigenvalues of a symmetric 4 x 4 matrix, the largest first: Jacobi's rotations. */
static void eigenvalues(double A[MOTION][MOTION], double *value)
{
    for (int sweep = 0; sweep < 12; sweep++)
        for (int p = 0; p < MOTION; p++)
            for (int q = p + 1; q < MOTION; q++) {
                if (A[p][q] == 0.0)
                    continue;
                const double theta = 0.5 * (A[q][q] - A[p][p]) / A[p][q];
                const double tangent = (theta < 0.0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
                const double cosine = 1.0 / sqrt(tangent * tangent + 1.0), sine = tangent * cosine;
                for (int k = 0; k < MOTION; k++) {
                    const double u = A[k][p], v = A[k][q];
                    A[k][p] = cosine * u - sine * v, A[k][q] = sine * u + cosine * v;
                }
                for (int k = 0; k < MOTION; k++) {
                    const double u = A[p][k], v = A[q][k];
                    A[p][k] = cosine * u - sine * v, A[q][k] = sine * u + cosine * v;
                }
            }
    for (int i = 0; i < MOTION; i++) {
        int at = i;
        for (; at > 0 && value[at - 1] < A[i][i]; at--)
            value[at] = value[at - 1];
        value[at] = A[i][i];
    }
}

/* The motion's deviations: the inverse of the normal matrix without gain and offset (Schur's complement), times the
 * residuals' variance. */
static void set_deviation(const Normal *n, double noise, double pixel, double *deviation)
{
    double A[MOTION][MOTION], value[MOTION];
    const double e = n->product[4][4] + 1e-6, f = n->product[5][4], g = n->product[5][5] + 1e-6, det = e * g - f * f;
    const double *u = n->product[4], *v = n->product[5];
    for (int i = 0; i < MOTION; i++)
        for (int j = 0; j < MOTION; j++) {
            A[i][j] = i >= j ? n->product[i][j] : n->product[j][i];
            if (det > 0.0)
                A[i][j] -= (u[i] * (g * u[j] - f * v[j]) + v[i] * (e * v[j] - f * u[j])) / det;
        }
    eigenvalues(A, value);
    for (int i = 0; i < MOTION; i++)
        deviation[i] = value[i] > 0.0 ? pixel * noise / sqrt(value[i]) : INFINITY;
}

static void gather_evidence(L1L2DirectAlignment *d, const L1L2FloatLevel *other, const Guess *guess, int count,
                            L1L2AlignmentEvidence *e)
{
    Cell winner[CELLS], identity[CELLS], rival[CELLS];
    Guess still = {.F = l1l2_mat_identity(), .gain = d->gain, .offset = d->offset};
    const Guess *second = NULL;
    const double pixel = other->step;
    for (int i = 1; i < count && !second; i++)
        if (guess[i].residual < (double)FLT_MAX && distance(d, &guess[i].F, &guess[0].F) >= rival_distance)
            second = guess + i;
    judge(d, other, &still);
    survey(d, other, &still, identity);
    *e = (L1L2AlignmentEvidence){.correlation = 0.0, .rival_correlation = -1.0, .rival_residual = INFINITY};
    e->identity_correlation = correlation(identity, CELLS);
    e->identity_residual = still.residual;
    if (second) {
        survey(d, other, second, rival);
        e->rival_correlation = correlation(rival, CELLS);
        e->rival_residual = second->residual;
        e->rival_distance = pixel * distance(d, &second->F, &guess[0].F);
    }
    survey(d, other, guess, winner);
    e->correlation = correlation(winner, CELLS);
    e->residual = guess->residual;
    e->overlap = guess->overlap;
    e->gain = guess->gain;
    e->offset = d->mean * (1.0 - guess->gain) + guess->offset;
    e->scatter = scatter(d);
    const Normal n = normal_equations(d, weight_width * e->scatter);
    set_deviation(&n, e->scatter, pixel, e->deviation);
    CellShift shift[CELLS];
    find_shifts(d, winner, e->scatter, shift);
    compare_cells(winner, identity, second ? rival : NULL, shift, pixel, e);
}

static void judge_starts(L1L2DirectAlignment *d, const L1L2FloatLevel *other, const L1L2AlignmentGuide *guide,
                         const Guess *winner, L1L2AlignmentEvidence *e)
{
    for (int i = 0; i < guide->starts && i < L1L2_ALIGN_MAX_STARTS; i++) {
        Guess start = {.F = guide->start[i], .gain = winner->gain, .offset = winner->offset};
        judge(d, other, &start);
        e->start_residual[i] = start.residual < (double)FLT_MAX ? start.residual : INFINITY;
    }
}

/* The winner is refined by what does not move with the layer. From then on, that does not count. */
static void refine_beside(L1L2DirectAlignment *d, const L1L2FloatLevel *other, const L1L2Mat *layer, Guess *winner)
{
    const Template *t = &d->template;
    const Guess by_layer = {.F = *layer, .gain = winner->gain, .offset = winner->offset};
    compare(d, other, &by_layer);
    memcpy(d->layer_residual, d->residual, (size_t)t->rows * (size_t)t->pitch * sizeof *d->residual);
    d->layered = true;
    for (int round = 0; round < 3; round++) {
        judge(d, other, winner);
        refine(d, other, max_steps[0], winner);
    }
}

void l1l2_motion_align(L1L2DirectAlignment *d, const L1L2FloatPyramid *now, const L1L2FloatPyramid *other,
                       const L1L2AlignmentGuide *guide, L1L2Alignment *out)
{
    Guess guess[MAX_GUESSES];
    float even[CELLS];
    for (int i = 0; i < CELLS; i++)
        even[i] = 1.0f;
    const int coarsest = now->levels > 2 ? 2 : now->levels - 1;
    set_brightness(d, now->level + coarsest, other->level + coarsest);
    d->mask = guide->mask;
    d->layered = false;
    set_template(d, now, coarsest);
    set_trust(d, even);
    int n = refine_coarsest(d, now, other, coarsest, guide, guess, &out->blind);
    for (int level = coarsest - 1; level >= 0; level--) {
        set_template(d, now, level);
        set_trust(d, guide->trust ? guide->trust : even);
        n = refine_level(d, other, level, guess, n);
    }
    prefer_expected(d, guess, n);
    if (guide->layer && guess->residual < (double)FLT_MAX)
        refine_beside(d, other->level, guide->layer, guess);
    double agreement = 0.0;
    if (guess->residual < (double)FLT_MAX)
        agreement = split(d, other->level, guide->split, guess, &n);
    out->F = guess->F;
    gather_evidence(d, other->level, guess, n, &out->evidence);
    judge_starts(d, other->level, guide, guess, &out->evidence);
    out->evidence.agreement = agreement;
}

/* The better of F refined and of the expected motion refined. */
static Guess refine_near(L1L2DirectAlignment *d, const L1L2FloatLevel *other, const Guess *F, const L1L2Mat *expected)
{
    const int steps = 4;
    Guess near = *F, other_guess = *F;
    refine(d, other, steps, &near);
    if (distance(d, expected, &F->F) < same_guess)
        return near;
    other_guess.F = *expected;
    judge(d, other, &other_guess);
    refine(d, other, steps, &other_guess);
    return other_guess.residual < near.residual ? other_guess : near;
}

void l1l2_motion_align_check(L1L2DirectAlignment *d, const L1L2FloatPyramid *now, const L1L2FloatPyramid *other,
                             const L1L2Mat *F, const L1L2Mat *expected, L1L2Mask mask, L1L2AlignmentCheck *out)
{
    const double clearly = 0.85, same = 0.15;
    Cell cell[CELLS], better_cell[CELLS];
    CellShift shift[CELLS];
    float even[CELLS];
    for (int i = 0; i < CELLS; i++)
        even[i] = 1.0f;
    set_brightness(d, now->level, other->level);
    d->mask = mask;
    d->layered = false;
    set_template(d, now, 0);
    set_trust(d, even);
    Guess measured = {.F = *F, .gain = d->gain, .offset = d->offset};
    judge(d, other->level, &measured);
    const Guess better = refine_near(d, other->level, &measured, expected);
    *out = (L1L2AlignmentCheck){0.0, 0.0};
    if (distance(d, &better.F, F) < same)
        return;
    survey(d, other->level, &measured, cell);
    survey(d, other->level, &better, better_cell);
    find_shifts(d, better_cell, scatter(d), shift);
    int with_detail = 0, support = 0, against = 0;
    for (int i = 0; i < CELLS; i++)
        if (shift[i].valid && cell[i].n > 0.0) {
            const double one = cell[i].difference / cell[i].n, two = better_cell[i].difference / better_cell[i].n;
            with_detail++;
            support += one < clearly * two;
            against += two < clearly * one;
        }
    if (with_detail > 0) {
        out->support = (double)support / with_detail;
        out->against = (double)against / with_detail;
    }
}

/*
 * What an alignment has to bring. Unit and evidence of each:
 *
 *   overlap      0.5    part of the frame. Less is not searched for either.
 *   correlation  0.7    of the cases of tests/support/synth_hard.h: pictures of different scenes and noise alone have
 *                       at most 0.14, motions that are right to 3 pixels 0.84 and more.
 *   deviation    1.0    pixels. One edge: 10 and more; the right motions: at most 0.45.
 *   detail       0.15   part of the cells. A flat picture: 0; the right motions: 0.17 and more.
 *   rival        1.05   ratio of residuals. A floor of tiles: another tile fits as well.
 *   far rival    8.0    pixels. A rival closer by is another depth of the same scene.
 */
bool l1l2_motion_align_accepts(const L1L2AlignmentEvidence *e)
{
    const double least_overlap = 0.5, least_correlation = 0.7, most_deviation = 1.0, least_detail = 0.15;
    const double clearly_better = 1.05, far_rival = 8.0;
    if (!(e->overlap >= least_overlap && e->correlation >= least_correlation && e->detail >= least_detail &&
          e->deviation[MOTION - 1] <= most_deviation))
        return false;
    return e->rival_distance < far_rival || e->rival_residual >= clearly_better * e->residual;
}
