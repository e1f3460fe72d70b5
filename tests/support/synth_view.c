/* SPDX-License-Identifier: MIT */
#include "synth_view.h"

#include <math.h>
#include <string.h>

#include "synth_path.h"

enum { NEAR_LAYERS = 2 };

typedef struct Row {
    const SynthView *view;
    const SynthViewpoint *viewpoint;
    const SynthScene *scene;
    const SynthTile *tile;
    double x, y, step;
} Row;

/* How far the picture moves while the shutter is open, px: at the corner of the frame that moves most. */
static double smear(const SynthConfig *cfg, double frames)
{
    double A[9], B[9], length = 0.0;
    synth_path_pose(cfg, frames - 0.5 * cfg->exposure, A);
    synth_path_pose(cfg, frames + 0.5 * cfg->exposure, B);
    for (int k = 0; k < 4; k++) {
        const double x = (k & 1 ? 0.5 : -0.5) * cfg->width, y = (k & 2 ? 0.5 : -0.5) * cfg->height;
        length = fmax(length, hypot((A[0] - B[0]) * x + (A[1] - B[1]) * y + A[2] - B[2],
                                    (A[3] - B[3]) * x + (A[4] - B[4]) * y + A[5] - B[5]));
    }
    return length;
}

void synth_view_aim(SynthView *view, const SynthConfig *cfg, double frames, double blur)
{
    double length = blur;
    if (cfg->exposure > 0.0)
        length = fmax(length, smear(cfg, frames));
    double x[SYNTH_MAX_VIEWPOINTS], y[SYNTH_MAX_VIEWPOINTS], mean_x = 0.0, mean_y = 0.0;
    view->parallax = cfg->parallax;
    view->viewpoints = (int)fmin(1.0 + ceil(length), SYNTH_MAX_VIEWPOINTS);
    for (int k = 0; k < view->viewpoints; k++) { /* the aperture's points lie on a spiral, evenly spread */
        const double radius = 0.5 * blur * sqrt((k + 0.5) / view->viewpoints), angle = 2.399963229728653 * k;
        x[k] = radius * cos(angle), y[k] = radius * sin(angle);
        mean_x += x[k] / view->viewpoints, mean_y += y[k] / view->viewpoints;
    }
    for (int k = 0; k < view->viewpoints; k++) {
        SynthViewpoint *viewpoint = &view->viewpoint[k];
        const double time = frames + cfg->exposure * ((k + 0.5) / view->viewpoints - 0.5);
        synth_path_pose(cfg, time, viewpoint->M);
        viewpoint->M[2] += x[k] - mean_x; /* less the mean, so that blur does not shift the picture */
        viewpoint->M[5] += y[k] - mean_y;
        viewpoint->movers = synth_movers_at(cfg, time, viewpoint->M, viewpoint->mover);
    }
}

void synth_view_aim_at(SynthView *view, const SynthConfig *cfg, const double M[9])
{
    view->parallax = cfg->parallax;
    view->viewpoints = 1;
    view->viewpoint[0].movers = 0;
    memcpy(view->viewpoint[0].M, M, sizeof view->viewpoint[0].M);
}

/* Samples [i0, i1) of a tile through M, whose translation is multiplied by `reach`. */
static void look(const Row *row, const SynthTile *tile, double reach, double x, double y, int i0, int i1,
                 uint16_t *deep)
{
    const double *M = row->viewpoint->M, at = row->x + i0 * row->step;
    synth_tile_lookup(tile, M[0] * at + M[1] * row->y + M[2] * reach + x, M[3] * at + M[4] * row->y + M[5] * reach + y,
                      M[0] * row->step, M[3] * row->step, i1 - i0, deep);
}

/* Draws the scene, and the nearer layers over it where their mask says so. */
static void draw_scene(const Row *row, int i0, int i1, uint16_t *deep)
{
    uint16_t near[SYNTH_SPAN], mask[SYNTH_SPAN];
    look(row, row->tile, 1.0, 0.0, 0.0, i0, i1, deep);
    for (int k = 1; k <= NEAR_LAYERS && row->view->parallax > 0.0; k++) {
        const double reach = 1.0 + row->view->parallax * k / NEAR_LAYERS, offset = 330.0 * k;
        look(row, row->tile, reach, offset, 0.7 * offset, i0, i1, near);
        look(row, &row->scene->mask, reach, offset, offset, i0, i1, mask);
        for (int i = 0; i < i1 - i0; i++) {
            const uint32_t full = 255 * SYNTH_DEEP;
            deep[i] = (uint16_t)((deep[i] * (full - mask[i]) + (uint32_t)near[i] * mask[i] + full / 2) / full);
        }
    }
}

static int clamp(double v, int low, int high)
{
    return v < low ? low : v > high ? high : (int)v;
}

/* Draws samples [i0, i1) with the first k movers. The last mover is the nearest. */
static void draw_movers(const Row *row, int k, int i0, int i1, uint16_t *deep)
{
    if (i0 >= i1)
        return;
    if (k == 0) {
        draw_scene(row, i0, i1, deep);
        return;
    }
    const SynthMover *m = &row->viewpoint->mover[k - 1];
    const double y = row->y - m->y, chord = m->half_h * m->half_h - y * y;
    int from = i1, to = i1; /* the part that it covers */
    if (chord > 0.0) {
        const double half = sqrt(chord) * (m->half_w / m->half_h), middle = m->x - row->x;
        from = clamp(ceil((middle - half) / row->step), i0, i1);
        to = clamp(ceil((middle + half) / row->step), i0, i1);
    }
    draw_movers(row, k - 1, i0, from, deep);
    if (from < to)
        synth_tile_lookup(row->tile, row->x + from * row->step - m->x + m->texture_x, y + m->texture_y, row->step, 0.0,
                          to - from, deep + (from - i0));
    draw_movers(row, k - 1, to, i1, deep + (to - i0));
}

void synth_view_draw(const SynthView *view, const SynthScene *scene, const SynthSpan *span, uint16_t *deep)
{
    const SynthTile *tile = span->component ? &scene->chroma[span->component - 1] : &scene->luma;
    Row row = {view, view->viewpoint, scene, tile, span->x, span->y, span->step};
    const uint32_t viewpoints = (uint32_t)view->viewpoints;
    uint16_t one[SYNTH_SPAN];
    uint32_t sum[SYNTH_SPAN] = {0};
    if (viewpoints == 1) {
        draw_movers(&row, row.viewpoint->movers, 0, span->count, deep);
        return;
    }
    for (uint32_t k = 0; k < viewpoints; k++) {
        row.viewpoint = &view->viewpoint[k];
        draw_movers(&row, row.viewpoint->movers, 0, span->count, one);
        for (int i = 0; i < span->count; i++)
            sum[i] += one[i];
    }
    for (int i = 0; i < span->count; i++)
        deep[i] = (uint16_t)((sum[i] + viewpoints / 2) / viewpoints);
}
