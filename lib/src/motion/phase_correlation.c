/* SPDX-License-Identifier: MIT */
#include "motion/phase_correlation.h"

#include <math.h>
#include <stdbool.h>

#include "common/mem.h"

/* The grid to which both pictures are sampled; its longer side lies along theirs. 64 x 32 loses the fine detail that
 * tells a weak peak from noise, 256 x 128 costs 4 times as much. */
enum { LONG = 128, SHORT = 64, SIZE = LONG * SHORT };
static const double pi = 3.14159265358979323846;
/* Frequencies count by a Gaussian of this deviation, in cycles a sample: the highest ones are noise and aliasing. */
static const double bandwidth = 0.22;
/* Samples from a peak within which another one is the same. */
enum { NEAR = 3 };

typedef struct Complex {
    float re, im;
} Complex;

struct L1L2PhaseCorrelator {
    Complex grid[SIZE];    /* both pictures, one in each component; then their cross-power spectrum */
    Complex spectrum[SIZE];
    Complex column[LONG];
    Complex root[LONG / 2]; /* exp(-2 pi i k / LONG) */
    float window[2][LONG];  /* Hann's, of LONG and SHORT samples */
    float band[2][LONG];
    float peak[SIZE];
};

L1L2PhaseCorrelator *l1l2_motion_phase_new(void)
{
    L1L2PhaseCorrelator *c = l1l2_mem_new(1, sizeof *c);
    if (!c)
        return NULL;
    for (int k = 0; k < LONG / 2; k++)
        c->root[k] = (Complex){(float)cos(2.0 * pi * k / LONG), (float)-sin(2.0 * pi * k / LONG)};
    for (int which = 0; which < 2; which++) {
        const int n = which ? SHORT : LONG;
        for (int k = 0; k < n; k++) {
            const double frequency = (double)(k < n / 2 ? k : k - n) / n;
            c->window[which][k] = (float)(0.5 - 0.5 * cos(2.0 * pi * (k + 0.5) / n));
            c->band[which][k] = (float)exp(-0.5 * frequency * frequency / (bandwidth * bandwidth));
        }
    }
    return c;
}

void l1l2_motion_phase_free(L1L2PhaseCorrelator *c)
{
    l1l2_mem_free(c);
}

/* In place, radix 2 (Cooley & Tukey, 1965): n values, a power of two of at most LONG. */
static void transform(const L1L2PhaseCorrelator *c, Complex *v, int n, bool inverse)
{
    for (int i = 1, j = 0; i < n; i++) { /* bit reversal */
        int bit = n >> 1;
        for (; j & bit; bit >>= 1)
            j ^= bit;
        j ^= bit;
        if (i < j) {
            const Complex t = v[i];
            v[i] = v[j];
            v[j] = t;
        }
    }
    for (int half = 1; half < n; half *= 2)
        for (int k = 0; k < half; k++) {
            const Complex w = c->root[k * (LONG / 2 / half)];
            const float im = inverse ? -w.im : w.im;
            for (int i = k; i < n; i += 2 * half) {
                const Complex q = v[i + half];
                const Complex t = {w.re * q.re - im * q.im, w.re * q.im + im * q.re};
                v[i + half] = (Complex){v[i].re - t.re, v[i].im - t.im};
                v[i] = (Complex){v[i].re + t.re, v[i].im + t.im};
            }
        }
}

static void transform_grid(L1L2PhaseCorrelator *c, Complex *grid, int columns, int rows, bool inverse)
{
    for (int y = 0; y < rows; y++)
        transform(c, grid + y * columns, columns, inverse);
    for (int x = 0; x < columns; x++) {
        for (int y = 0; y < rows; y++)
            c->column[y] = grid[y * columns + x];
        transform(c, c->column, rows, inverse);
        for (int y = 0; y < rows; y++)
            grid[y * columns + x] = c->column[y];
    }
}

/* A picture's brightness between its samples. */
static float sample_at(const float *picture, int width, int height, float x, float y)
{
    const int i = x <= 0.0f ? 0 : x >= (float)(width - 2) ? width - 2 : (int)x;
    const int j = y <= 0.0f ? 0 : y >= (float)(height - 2) ? height - 2 : (int)y;
    const float *p = picture + j * width + i;
    const float right = x - (float)i, below = y - (float)j;
    const float upper = p[0] + right * (p[1] - p[0]), lower = p[width] + right * (p[width + 1] - p[width]);
    return upper + below * (lower - upper);
}

static double mean_of(const float *picture, int width, int height)
{
    double sum = 0.0;
    for (int i = 0; i < width * height; i++)
        sum += (double)picture[i];
    return sum / (width * height);
}

/* Both pictures without their means, faded out to the edges, so that the edges do not count as detail. */
static void fill_grid(L1L2PhaseCorrelator *c, const float *a, const float *b, int width, int height, int columns,
                      int rows)
{
    const float mean_a = (float)mean_of(a, width, height), mean_b = (float)mean_of(b, width, height);
    const float *across = c->window[columns == LONG ? 0 : 1], *down = c->window[rows == LONG ? 0 : 1];
    const float step_x = (float)width / (float)columns, step_y = (float)height / (float)rows;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < columns; x++) {
            const float u = ((float)x + 0.5f) * step_x - 0.5f, v = ((float)y + 0.5f) * step_y - 0.5f;
            const float weight = across[x] * down[y];
            c->grid[y * columns + x] = (Complex){weight * (sample_at(a, width, height, u, v) - mean_a),
                                                 weight * (sample_at(b, width, height, u, v) - mean_b)};
        }
}

/* The grid holds z = a + i b, so that one transform serves both: A(k) = (Z(k) + conj Z(-k)) / 2 and
 * B(k) = (Z(k) - conj Z(-k)) / 2i. Returns the sum of the weights, which is the highest possible peak. */
static double cross_power(L1L2PhaseCorrelator *c, int columns, int rows)
{
    const float *across = c->band[columns == LONG ? 0 : 1], *down = c->band[rows == LONG ? 0 : 1];
    double all = 0.0;
    for (int y = 0; y < rows; y++)
        for (int x = 0; x < columns; x++) {
            const Complex z = c->grid[y * columns + x];
            const Complex m = c->grid[(rows - y) % rows * columns + (columns - x) % columns];
            const Complex a = {z.re + m.re, z.im - m.im}, b = {z.im + m.im, m.re - z.re};
            const Complex cross = {a.re * b.re + a.im * b.im, a.re * b.im - a.im * b.re}; /* conj(A) B */
            const float size = sqrtf(cross.re * cross.re + cross.im * cross.im);
            const float weight = across[x] * down[y];
            all += (double)weight;
            c->spectrum[y * columns + x] =
                size > 0.0f ? (Complex){weight * cross.re / size, weight * cross.im / size} : (Complex){0.0f, 0.0f};
        }
    return all;
}

static int highest(const float *peak)
{
    int best = 0;
    for (int i = 1; i < SIZE; i++)
        if (peak[i] > peak[best])
            best = i;
    return best;
}

/* The top of the parabola through three samples, from the middle one. */
static double parabola(float before, float top, float after)
{
    const double curve = (double)before - 2.0 * (double)top + (double)after;
    return curve < 0.0 ? 0.5 * ((double)before - (double)after) / curve : 0.0;
}

static L1L2Shift shift_at(const L1L2PhaseCorrelator *c, int at, int columns, int rows, double all)
{
    const int x = at % columns, y = at / columns;
    const float left = c->spectrum[y * columns + (x + columns - 1) % columns].re;
    const float right = c->spectrum[y * columns + (x + 1) % columns].re;
    const float above = c->spectrum[(y + rows - 1) % rows * columns + x].re;
    const float below = c->spectrum[(y + 1) % rows * columns + x].re;
    const float top = c->spectrum[at].re;
    const double u = x + parabola(left, top, right), v = y + parabola(above, top, below);
    return (L1L2Shift){(u < columns / 2 ? u : u - columns) / columns, (v < rows / 2 ? v : v - rows) / rows,
                       (double)top / all};
}

static void forget_near(float *peak, int at, int columns, int rows)
{
    for (int dy = -NEAR; dy <= NEAR; dy++)
        for (int dx = -NEAR; dx <= NEAR; dx++)
            peak[(at / columns + dy + rows) % rows * columns + (at % columns + dx + columns) % columns] = 0.0f;
}

int l1l2_motion_phase_correlate(L1L2PhaseCorrelator *c, const float *a, const float *b, int width, int height,
                                L1L2Shift *shift, int capacity)
{
    const int columns = width >= height ? LONG : SHORT, rows = SIZE / columns;
    fill_grid(c, a, b, width, height, columns, rows);
    transform_grid(c, c->grid, columns, rows, false);
    const double all = cross_power(c, columns, rows);
    transform_grid(c, c->spectrum, columns, rows, true);
    for (int i = 0; i < SIZE; i++)
        c->peak[i] = c->spectrum[i].re;
    int found = 0;
    while (found < capacity) {
        const int at = highest(c->peak);
        if (c->peak[at] <= 0.0f)
            break;
        shift[found++] = shift_at(c, at, columns, rows, all);
        forget_near(c->peak, at, columns, rows);
    }
    return found;
}
