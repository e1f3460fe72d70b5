/* SPDX-License-Identifier: MIT */
#include "motion/track_weights.h"

#include <math.h>

enum { CELLS_X = L1L2_FIT_CELLS_X, CELLS_Y = L1L2_FIT_CELLS_Y, CELLS = L1L2_FIT_CELLS };

/* At the left, right and upper rim a vote counts so much more than in the middle, by the fourth power of the distance.
 * A subject stands in the middle or at the bottom. */
static const double rim_factor = 8.0;
/* A track of ten frames has three times a new one's vote. */
static const int grown_up = 10;
static const double age_factor = 3.0;
/* A cell's vote where nothing moved with the camera lately; more than 0, so that it can come to do so. */
static const double least_trust = 0.2, learning_rate = 0.15;

static int cell_of(const L1L2TrackWeights *v, L1L2Point p)
{
    return l1l2_cell_of(p, v->half_w, v->half_h, CELLS_X, CELLS_Y);
}

static double place_factor(int cell)
{
    const double x = 2.0 * (cell % CELLS_X + 0.5) / CELLS_X - 1.0, y = 2.0 * (cell / CELLS_X + 0.5) / CELLS_Y - 1.0;
    const double out = fmax(fabs(x), -y);
    return 1.0 + rim_factor * out * out * out * out;
}

void l1l2_motion_weights_reset(L1L2TrackWeights *v)
{
    for (int cell = 0; cell < CELLS; cell++)
        v->trust[cell] = 1.0;
}

void l1l2_motion_weights_assign(const L1L2TrackWeights *v, const L1L2Pair *pairs, const int *age, int count,
                                double *votes, double *weights)
{
    int population[CELLS] = {0};
    for (int i = 0; i < count; i++)
        population[cell_of(v, pairs[i].from)]++;
    for (int i = 0; i < count; i++) {
        const int cell = cell_of(v, pairs[i].from);
        const double seniority = 1.0 + (age_factor - 1.0) * fmin(age[i], grown_up) / grown_up;
        const double trust = least_trust + (1.0 - least_trust) * v->trust[cell];
        weights[i] = seniority * trust;
        votes[i] = weights[i] * place_factor(cell) / population[cell];
    }
}

void l1l2_motion_weights_learn(L1L2TrackWeights *v, const L1L2Pair *pairs, const bool *inlier, int count)
{
    int population[CELLS] = {0}, agreeing[CELLS] = {0};
    for (int i = 0; i < count; i++) {
        const int cell = cell_of(v, pairs[i].from);
        population[cell]++;
        agreeing[cell] += inlier[i];
    }
    for (int cell = 0; cell < CELLS; cell++)
        if (population[cell] > 0)
            v->trust[cell] += learning_rate * ((double)agreeing[cell] / population[cell] - v->trust[cell]);
}

double l1l2_motion_weights_trust(const L1L2TrackWeights *v, L1L2Point p)
{
    return v->trust[cell_of(v, p)];
}
