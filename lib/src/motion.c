/* SPDX-License-Identifier: MIT */
#include "motion.h"

#include <math.h>
#include <string.h>

#include "clock.h"
#include "log.h"
#include "mem.h"
#include "ransac.h"
#include "vision.h"

/* On ten real clips 150 points are as good, 250 no better; on synthetic ones the median error is 0.016 px at 720p. */
enum { MAX_POINTS = 200, FEW_POINTS = MAX_POINTS / 2, RESELECT_FRAMES = 10 /* paper, section 4.3 */ };

/* All in pixels of the tracked picture. The minimum distance spreads the points (paper, section 4.3); pictures so small
 * that MAX_POINTS would not fit get less, down to 3. At 20 px, low-contrast frames have too few points. */
static const double max_distance_px = 12.0, min_distance_px = 3.0;
/* The backward check. */
static const double max_return_px = 0.5;
/* Parallax makes 1 px flicker between surfaces; at 2 px, slow things that move by themselves are let in. */
static const double inlier_px = 1.5;

/* What a camera does from one frame to the next; beyond it, the fit is wrong. */
static const double min_scale = 0.8, max_scale = 1.25, max_rotation_rad = 0.25;
static const int min_inliers = 30, min_inliers_translation = 8;
static const double min_inlier_share = 0.2;

/* Where nothing can be measured, the last motion goes on and fades; after this many frames it is gone. */
static const int max_predicted = 15;
static const double prediction_fade = 0.8;

struct L1L2Motion {
    L1L2MotionConfig cfg;
    L1L2Vision *vision;
    int width, height;      /* of the tracked picture */
    double diagonal_px;     /* of the frame */
    double threshold;       /* inlier_px in diagonals */
    double distance_px;     /* between points */
    L1L2Rng rng;
    L1L2Pixel point[MAX_POINTS], moved[MAX_POINTS];
    L1L2Pair pair[MAX_POINTS];
    bool ok[MAX_POINTS], inlier[MAX_POINTS];
    int points;             /* in `point`, in the current picture */
    int since_selection;    /* frames */
    L1L2Mat last;           /* the last measured motion, fading while it is predicted from */
    int lost;               /* frames since the last measured one */
    L1L2Thumbnail thumbnail;  /* of the current picture */
    L1L2Thumbnail last_shown; /* of the last picture whose motion was measured, or with which a path started */
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
    m->threshold = inlier_px / hypot(m->width, m->height);
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
    m->last = l1l2_mat_identity();
    m->lost = 0;
    m->last_shown = m->thumbnail;
}

void l1l2_motion_reset(L1L2Motion *m)
{
    l1l2_vision_reset(m->vision);
    m->rng = l1l2_rng_seeded(m->cfg.seed);
    start_path(m);
}

/* From the tracked picture's pixels, whose centres are integers, to diagonals from the frame's centre. The two axes
 * have scales of their own, since the tracked picture's sides are rounded. */
static L1L2Point to_diagonals(const L1L2Motion *m, L1L2Pixel p)
{
    return (L1L2Point){((p.x + 0.5) * m->cfg.width / m->width - 0.5 * m->cfg.width) / m->diagonal_px,
                       ((p.y + 0.5) * m->cfg.height / m->height - 0.5 * m->cfg.height) / m->diagonal_px};
}

/* Step 1: the points of the previous picture, new ones where due, followed into the current one. */
static L1L2StabResult track(L1L2Motion *m)
{
    L1L2StabResult result = L1L2STAB_OK;
    if (m->since_selection >= RESELECT_FRAMES || m->points < FEW_POINTS) {
        int found;
        result = l1l2_vision_corners(m->vision, m->point, m->points, m->distance_px, m->point + m->points,
                                     MAX_POINTS - m->points, &found);
        m->points += found;
        m->since_selection = 0;
    }
    m->since_selection++;
    if (result == L1L2STAB_OK)
        result = l1l2_vision_track(m->vision, m->point, m->moved, m->ok, m->points, max_return_px);
    if (result != L1L2STAB_OK)
        return result;
    int kept = 0;
    for (int i = 0; i < m->points; i++)
        if (m->ok[i]) {
            m->pair[kept] = (L1L2Pair){to_diagonals(m, m->moved[i]), to_diagonals(m, m->point[i])};
            m->point[kept++] = m->moved[i];
        }
    m->points = kept;
    return L1L2STAB_OK;
}

/* Outliers go: on something that moves by itself, or drifting. If they stayed, an object that covers a third of the
 * frame would now and then be taken for the background (measured: errors of 7 px). */
static void keep_inliers(L1L2Motion *m)
{
    int kept = 0;
    for (int i = 0; i < m->points; i++)
        if (m->inlier[i])
            m->point[kept++] = m->point[i];
    m->points = kept;
}

static bool plausible(const L1L2Mat *F)
{
    const double scale = hypot(F->m[0], F->m[3]), rotation = fabs(atan2(F->m[3], F->m[0]));
    return scale >= min_scale && scale <= max_scale && rotation <= max_rotation_rad;
}

/* Nothing could be measured: is it because another shot begins? A picture that shows nothing is none; what comes after
 * it is compared with the one before. */
static bool is_cut(const L1L2Motion *m)
{
    return l1l2_thumbnails_differ(&m->last_shown, &m->thumbnail);
}

/* Step 2: the ladder similarity, translation, predicted, identity; or a cut, which has no motion. */
static void fit(L1L2Motion *m, L1L2MotionResult *out)
{
    const int count = m->points;
    out->tracks = count;
    out->inliers = l1l2_ransac_similarity(m->pair, count, m->threshold, &m->rng, m->inlier, &out->F);
    if (out->inliers >= min_inliers && out->inliers >= min_inlier_share * count && plausible(&out->F)) {
        out->model = L1L2STAB_MODEL_SIMILARITY;
    } else {
        /* Few points tell where the picture went, but not how it turned. */
        out->inliers = l1l2_ransac_translation(m->pair, count, 2.0 * m->threshold, &m->rng, m->inlier, &out->F);
        if (out->inliers >= min_inliers_translation && 2 * out->inliers >= count)
            out->model = L1L2STAB_MODEL_TRANSLATION;
    }
    if (out->model != L1L2STAB_MODEL_NONE) {
        if (m->lost > 0)
            l1l2_log(m->cfg.log, L1L2STAB_LOG_DEBUG, "motion: measured again after %d frames", m->lost);
        keep_inliers(m);
        m->last = out->F;
        m->lost = 0;
        m->last_shown = m->thumbnail;
        return;
    }
    if (is_cut(m)) {
        l1l2_log(m->cfg.log, L1L2STAB_LOG_DEBUG, "motion: a cut");
        *out = (L1L2MotionResult){.F = l1l2_mat_identity(), .scale_ns = out->scale_ns, .track_ns = out->track_ns};
        start_path(m);
        return;
    }
    if (m->lost++ == 0)
        l1l2_log(m->cfg.log, L1L2STAB_LOG_WARN, "motion: lost, %d of %d points agree: predicting", out->inliers, count);
    m->points = 0;
    m->since_selection = RESELECT_FRAMES;
    for (int i = 0; i < 9; i++) {
        const double identity = i % 4 == 0 ? 1.0 : 0.0;
        m->last.m[i] = identity + prediction_fade * (m->last.m[i] - identity);
    }
    out->inliers = 0;
    out->model = m->lost <= max_predicted ? L1L2STAB_MODEL_PREDICTED : L1L2STAB_MODEL_IDENTITY;
    out->F = m->lost <= max_predicted ? m->last : l1l2_mat_identity();
}

L1L2StabResult l1l2_motion_push(L1L2Motion *m, const uint8_t *data, ptrdiff_t stride, bool starts_path,
                                L1L2MotionResult *out)
{
    *out = (L1L2MotionResult){.F = l1l2_mat_identity(), .model = L1L2STAB_MODEL_NONE};
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
