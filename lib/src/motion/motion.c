/* SPDX-License-Identifier: MIT */
#include "motion/motion.h"

#include <math.h>
#include <string.h>

#include "common/clock.h"
#include "common/log.h"
#include "common/mem.h"
#include "motion/model_selection.h"
#include "motion/shot_dissolve.h"
#include "motion/static_overlay.h"
#include "motion/vision.h"
#include "rolling_shutter/camera_gate.h"
#include "rolling_shutter/fit.h"

/* On ten real clips 150 points are as good, 250 no better; on synthetic ones the median error is 0.016 px at 720p. */
enum { MAX_POINTS = 200, FEW_POINTS = MAX_POINTS / 2, RESELECT_FRAMES = 10 /* paper, section 4.3 */ };

/* All in pixels of the tracked picture. The minimum distance spreads the points (paper, section 4.3); pictures so small
 * that MAX_POINTS would not fit get less, down to 3. At 20 px, low-contrast frames have too few points. */
static const double max_distance_px = 12.0, min_distance_px = 3.0;
/* The backward check. */
static const double max_return_px = 0.5;
/* Parallax makes 1 px flicker between surfaces; at 2 px, slow things that move by themselves are let in. */
static const double inlier_px = 1.5;

struct L1L2Motion {
    L1L2MotionConfig cfg;
    L1L2Vision *vision;
    int width, height;      /* of the tracked picture */
    double diagonal_px;     /* of the frame */
    double distance_px;     /* between points */
    L1L2Rng rng;
    L1L2Pixel point[MAX_POINTS], moved[MAX_POINTS];
    int age[MAX_POINTS];    /* frames that a point has moved with the camera */
    L1L2Pair pair[MAX_POINTS];
    double votes[MAX_POINTS], weights[MAX_POINTS];
    bool ok[MAX_POINTS], inlier[MAX_POINTS], core[MAX_POINTS];
    int points;             /* in `point`, in the current picture */
    int since_selection;    /* frames */
    L1L2ShutterModel shape; /* of what F leaves, if that is fitted */
    L1L2TrackWeights voters;
    L1L2ModelSelection ladder;
    L1L2StaticOverlay overlay;
    L1L2ShotDissolve dissolve;
    L1L2ShutterGate cause;        /* of what F leaves */
    L1L2Thumbnail thumbnail;  /* of the current picture */
    L1L2ShotCut shot;
};

L1L2StabResult l1l2_motion_create(L1L2Motion **out, const L1L2MotionConfig *cfg)
{
    *out = NULL;
    L1L2Motion *m = l1l2_mem_new(1, sizeof *m);
    if (!m)
        return L1L2STAB_ERR_NOMEM;
    m->cfg = *cfg;
    const L1L2VisionConfig vision = {
        .format = cfg->format,
        .width = cfg->width,
        .height = cfg->height,
        .analysis_size = cfg->analysis_size,
        .log = cfg->log,
    };
    const L1L2StabResult result = l1l2_vision_create(&m->vision, &vision);
    if (result != L1L2STAB_OK) {
        l1l2_motion_free(m);
        return result;
    }
    l1l2_vision_size(m->vision, &m->width, &m->height);
    m->diagonal_px = hypot(cfg->width, cfg->height);
    const double half_w = 0.5 * cfg->width / m->diagonal_px, half_h = 0.5 * cfg->height / m->diagonal_px;
    const double pixel = 1.0 / hypot(m->width, m->height);
    m->shape = (L1L2ShutterModel){cfg->rolling_shutter, half_w, half_h, NULL};
    m->voters = (L1L2TrackWeights){.half_w = half_w, .half_h = half_h};
    m->overlay = (L1L2StaticOverlay){.half_w = half_w, .half_h = half_h, .pixel = pixel};
    /* Where the picture moves as a whole is best told by a similarity: of a picture that turns, translations agree with
     * one part now and with another then. */
    const bool translation = cfg->model == L1L2STAB_MOTION_MODEL_TRANSLATION;
    m->ladder = (L1L2ModelSelection){.wanted = translation ? L1L2STAB_MOTION_MODEL_SIMILARITY : cfg->model,
                             .threshold = inlier_px * pixel};
    /* 0.4 of the distance of as many points on a square grid. */
    m->distance_px = fmax(0.4 * sqrt((double)m->width * m->height / MAX_POINTS), min_distance_px);
    m->distance_px = fmin(m->distance_px, max_distance_px);
    l1l2_motion_reset(m);
    *out = m;
    return L1L2STAB_OK;
}

void l1l2_motion_free(L1L2Motion *m)
{
    if (!m)
        return;
    l1l2_vision_free(m->vision);
    l1l2_mem_free(m);
}

static void start_path(L1L2Motion *m)
{
    m->points = 0;
    m->since_selection = RESELECT_FRAMES;
    l1l2_motion_cut_start(&m->shot, &m->thumbnail);
    l1l2_motion_weights_reset(&m->voters);
    l1l2_motion_model_reset(&m->ladder);
    l1l2_motion_dissolve_start(&m->dissolve, &m->thumbnail);
    l1l2_shutter_gate_break(&m->cause);
}

void l1l2_motion_reset(L1L2Motion *m)
{
    l1l2_vision_reset(m->vision);
    m->rng = l1l2_rng_seeded(m->cfg.seed);
    l1l2_motion_overlay_reset(&m->overlay);
    memset(&m->cause, 0, sizeof m->cause);
    start_path(m);
}

/* From the tracked picture's pixels, whose centres are integers, to diagonals from the frame's centre. The two axes
 * have scales of their own, since the tracked picture's sides are rounded. */
static L1L2Point to_diagonals(const L1L2Motion *m, L1L2Pixel p)
{
    return (L1L2Point){((p.x + 0.5) * m->cfg.width / m->width - 0.5 * m->cfg.width) / m->diagonal_px,
                       ((p.y + 0.5) * m->cfg.height / m->height - 0.5 * m->cfg.height) / m->diagonal_px};
}

/* New points where due: not where something stands still. */
static L1L2StabResult select_points(L1L2Motion *m)
{
    if (m->since_selection++ < RESELECT_FRAMES && m->points >= FEW_POINTS)
        return L1L2STAB_OK;
    L1L2Mask mask;
    int found;
    l1l2_motion_overlay_mask(&m->overlay, &mask);
    const L1L2StabResult result =
        l1l2_vision_corners(m->vision, m->point, m->points, &mask, m->distance_px, m->point + m->points,
                            MAX_POINTS - m->points, &found);
    memset(m->age + m->points, 0, (size_t)found * sizeof *m->age);
    m->points += found;
    m->since_selection = 1;
    return result;
}

static void keep(L1L2Motion *m, int i, int *kept)
{
    m->point[*kept] = m->point[i];
    m->age[*kept] = m->age[i];
    m->pair[*kept] = m->pair[i];
    ++*kept;
}

/* Step 1: the points of the previous picture, followed into the current one. */
static L1L2StabResult track(L1L2Motion *m)
{
    L1L2StabResult result = select_points(m);
    if (result == L1L2STAB_OK)
        result = l1l2_vision_track(m->vision, m->point, m->moved, m->ok, m->points, max_return_px);
    if (result != L1L2STAB_OK)
        return result;
    int kept = 0;
    for (int i = 0; i < m->points; i++) {
        m->pair[i] = (L1L2Pair){to_diagonals(m, m->moved[i]), to_diagonals(m, m->point[i])};
        m->point[i] = m->moved[i];
        if (m->ok[i] && !l1l2_motion_overlay_covers(&m->overlay, m->pair[i].from))
            keep(m, i, &kept);
    }
    m->points = kept;
    return L1L2STAB_OK;
}

/* What is learned from a measured motion. Outliers go: on something that moves by itself, or drifting. If they stayed,
 * an object that covers a third of the frame would now and then be taken for the background. */
static void learn(L1L2Motion *m, const L1L2Mat *F)
{
    l1l2_motion_weights_learn(&m->voters, m->pair, m->core, m->points);
    l1l2_motion_overlay_learn(&m->overlay, m->pair, m->inlier, m->points, F);
    int kept = 0;
    for (int i = 0; i < m->points; i++) {
        m->age[i] = m->core[i] ? m->age[i] + 1 : 0;
        if (m->inlier[i])
            keep(m, i, &kept);
    }
    m->points = kept;
}

static void start_shot(L1L2Motion *m, L1L2MotionResult *out, const char *how)
{
    l1l2_log(m->cfg.log, L1L2STAB_LOG_DEBUG, "motion: %s", how);
    *out = (L1L2MotionResult){.F = l1l2_mat_identity(), .scale_ns = out->scale_ns, .track_ns = out->track_ns};
    start_path(m);
}

/* Whose motion may bend the picture: not where something moved by itself lately, however slowly. */
static int trusted(const L1L2Motion *m, const bool *agrees, L1L2Pair *pairs, bool *agreeing, int *from)
{
    const double least_trust = 0.8;
    int n = 0;
    for (int i = 0; i < m->points; i++)
        if (l1l2_motion_weights_trust(&m->voters, m->pair[i].from) >= least_trust) {
            pairs[n] = m->pair[i];
            agreeing[n] = agrees[i];
            from[n++] = i;
        }
    return n;
}

/* Each part of the points, in whatever way they are divided, by the others. A shutter alone explains 97 %; parallax and
 * slow movers up to 77 %, of which the camera's motion tells one from the other. */
static bool explains_all(const L1L2Motion *m, const L1L2ShutterMeasurement *step)
{
    const double alone = 0.8, caused = 0.5, cause = 0.3;
    const double enough = l1l2_shutter_gate_share(&m->cause) >= cause ? caused : alone;
    for (int division = 0; division < L1L2_SPLITS; division++)
        if (step->explained[division] < enough * step->all[division])
            return false;
    return true;
}

/* Step 4, as far as it is about two frames. Points that agree with the residual are the camera's too, if all columns
 * tell it alike: a slow subject that was taken in once would never be found out. Where rows move so differently that no
 * similarity is found, a wide one is good enough to begin with, if all comes together in the end. */
static void fit_residual(L1L2Motion *m, L1L2SelectedModel *rung, L1L2MotionResult *out)
{
    const double wide = 3.0, min_share = 0.7, most = 0.85, few = 0.7;
    L1L2Rng rng = m->rng; /* the next frame has the same as without step 4 */
    const int count = m->points;
    const double threshold = m->ladder.threshold;
    if (m->shape.kind == L1L2STAB_ROLLING_SHUTTER_NONE || m->cfg.model == L1L2STAB_MOTION_MODEL_TRANSLATION)
        return;
    const bool found = rung->model >= L1L2STAB_MOTION_SOURCE_SIMILARITY;
    L1L2Mat F = rung->F;
    L1L2Pair pairs[MAX_POINTS] = {0};
    bool agrees[MAX_POINTS], agreeing[MAX_POINTS];
    int from[MAX_POINTS];
    memcpy(agrees, m->core, sizeof agrees);
    if (!found && l1l2_ransac(L1L2STAB_MOTION_MODEL_SIMILARITY, m->pair, (L1L2PairWeights){m->votes, m->weights}, count,
                              wide * threshold, &rng, agrees, &F) < min_share * count)
        return;
    const int n = trusted(m, agrees, pairs, agreeing, from);
    const int inliers = l1l2_shutter_fit(&m->shape, pairs, n, threshold, agreeing, &F, &out->residual);
    const bool adopted = inliers > 0 && (found || inliers >= min_share * count) && explains_all(m, &out->residual);
    out->has_residual = found ? inliers > 0 : adopted;
    if (!adopted)
        return;
    if (!found) { /* what is not trusted goes by the wide similarity */
        memcpy(m->inlier, agrees, sizeof agrees);
        memcpy(m->core, agrees, sizeof agrees);
    }
    for (int k = 0; k < n; k++)
        m->inlier[from[k]] = m->core[from[k]] = agreeing[k];
    if (!found || (inliers >= most * count && rung->inliers < few * inliers)) {
        const L1L2Mat rest = l1l2_shutter_residual_extract_similarity(&m->shape, &out->residual.r);
        for (int i = 0; i < 6; i++)
            F.m[i] += rest.m[i];
        *rung = l1l2_motion_model_adopt(&m->ladder, &F, inliers, (double)inliers / count);
    }
}

static void fit(L1L2Motion *m, L1L2MotionResult *out)
{
    const int count = m->points;
    l1l2_motion_weights_assign(&m->voters, m->pair, m->age, count, m->votes, m->weights);
    const L1L2PairWeights say = {m->votes, m->weights};
    L1L2SelectedModel rung = l1l2_motion_model_select(&m->ladder, &m->voters, m->pair, say, count,
                                                      m->since_selection == 1, &m->rng, m->inlier, m->core);
    fit_residual(m, &rung, out);
    const bool measured = rung.model != L1L2STAB_MOTION_SOURCE_NONE;
    if (l1l2_motion_cut_push(&m->shot, &m->thumbnail, measured)) {
        start_shot(m, out, "a cut");
        return;
    }
    if (measured) {
        learn(m, &rung.F);
    } else {
        if (m->ladder.lost == 0)
            l1l2_log(m->cfg.log, L1L2STAB_LOG_WARN, "motion: lost, %d of %d points agree: predicting", rung.inliers,
                     count);
        m->points = 0;
        m->since_selection = RESELECT_FRAMES;
        rung = l1l2_motion_model_predict(&m->ladder);
    }
    if (l1l2_motion_dissolve_push(&m->dissolve, &m->thumbnail, &rung.F, m->voters.half_w, m->voters.half_h)) {
        start_shot(m, out, "a dissolve");
        return;
    }
    if (out->has_residual && measured)
        l1l2_shutter_gate_push(&m->cause, &m->shape, &rung.F, &out->residual);
    else
        l1l2_shutter_gate_break(&m->cause);
    out->F = l1l2_mat_reduce(&rung.F, l1l2_mat_dim(m->cfg.model));
    out->model = rung.model;
    if (m->cfg.model == L1L2STAB_MOTION_MODEL_TRANSLATION && rung.model == L1L2STAB_MOTION_SOURCE_SIMILARITY)
        out->model = L1L2STAB_MOTION_SOURCE_TRANSLATION;
    out->tracks = count;
    out->inliers = rung.inliers;
    out->quality = rung.quality;
}

L1L2StabResult l1l2_motion_push(L1L2Motion *m, const uint8_t *data, ptrdiff_t stride, bool starts_path,
                                L1L2MotionResult *out)
{
    *out = (L1L2MotionResult){.F = l1l2_mat_identity(), .model = L1L2STAB_MOTION_SOURCE_NONE};
    const int64_t start_ns = l1l2_clock_ns();
    L1L2StabResult result = l1l2_vision_advance(m->vision, data, stride);
    if (result == L1L2STAB_OK)
        result = l1l2_vision_thumbnail(m->vision, &m->thumbnail);
    const int64_t scaled_ns = l1l2_clock_ns();
    out->scale_ns = scaled_ns - start_ns;
    if (result == L1L2STAB_OK && starts_path) {
        start_path(m);
        return L1L2STAB_OK;
    }
    if (result == L1L2STAB_OK)
        result = track(m);
    const int64_t tracked_ns = l1l2_clock_ns();
    out->track_ns = tracked_ns - scaled_ns;
    if (result != L1L2STAB_OK) {
        l1l2_motion_reset(m);
        return result;
    }
    fit(m, out);
    out->fit_ns = l1l2_clock_ns() - tracked_ns;
    return L1L2STAB_OK;
}
