/* SPDX-License-Identifier: MIT */
#include "motion/track_weights.h"

#include <math.h>

enum { CELLS_X = L1L2_FIT_CELLS_X, CELLS_Y = L1L2_FIT_CELLS_Y, CELLS = L1L2_FIT_CELLS };

static int cell_of(const L1L2TrackWeights *w, L1L2Point p)
{
    return l1l2_cell_of(p, w->half_w, w->half_h, CELLS_X, CELLS_Y);
}

/* Grows with the fourth power of the distance from the middle, so that the inner half of the frame hardly differs. */
static double place_weight(const L1L2TrackWeights *w, int cell)
{
    const double x = 2.0 * (cell % CELLS_X + 0.5) / CELLS_X - 1.0, y = 2.0 * (cell / CELLS_X + 0.5) / CELLS_Y - 1.0;
    const double out = fmax(fabs(x), -y);
    return 1.0 + w->parameters->rim_weight * out * out * out * out;
}

void l1l2_motion_weights_reset(L1L2TrackWeights *w)
{
    for (int cell = 0; cell < CELLS; cell++)
        w->agreement[cell] = 1.0;
}

void l1l2_motion_weights_assign(const L1L2TrackWeights *w, const L1L2Pair *pairs, const int *age, int count,
                                double *consensus, double *fit)
{
    const L1L2MotionParameters *p = w->parameters;
    int population[CELLS] = {0};
    for (int i = 0; i < count; i++)
        population[cell_of(w, pairs[i].from)]++;
    for (int i = 0; i < count; i++) {
        const int cell = cell_of(w, pairs[i].from);
        const double by_age = 1.0 + (p->age_weight - 1.0) * fmin(age[i], p->age_frames) / p->age_frames;
        const double by_cell = p->min_cell_weight + (1.0 - p->min_cell_weight) * w->agreement[cell];
        fit[i] = by_age * by_cell;
        consensus[i] = fit[i] * place_weight(w, cell) / population[cell];
    }
}

void l1l2_motion_weights_learn(L1L2TrackWeights *w, const L1L2Pair *pairs, const bool *inlier, int count)
{
    int population[CELLS] = {0}, agreeing[CELLS] = {0};
    for (int i = 0; i < count; i++) {
        const int cell = cell_of(w, pairs[i].from);
        population[cell]++;
        agreeing[cell] += inlier[i];
    }
    for (int cell = 0; cell < CELLS; cell++)
        if (population[cell] > 0)
            w->agreement[cell] += w->parameters->learning_rate *
                                  ((double)agreeing[cell] / population[cell] - w->agreement[cell]);
}

double l1l2_motion_weights_agreement(const L1L2TrackWeights *w, L1L2Point p)
{
    return w->agreement[cell_of(w, p)];
}
