/* SPDX-License-Identifier: MIT */
#include "motion/motion.h"

#include <math.h>
#include <string.h>

#include "common/clock.h"
#include "common/log.h"
#include "common/mem.h"
#include "fit/ransac.h"
#include "motion/model_selection.h"
#include "motion/motion_gap.h"
#include "motion/shot_cut.h"
#include "motion/shot_dissolve.h"
#include "motion/static_overlay.h"
#include "motion/vision.h"
#include "motion/whole_picture.h"
#include "rolling_shutter/camera_gate.h"
#include "rolling_shutter/fit.h"

enum {
    MAX_POINTS = L1L2_RANSAC_MAX_PAIRS,
    OVERLAY_LEVEL = 1, /* of the pyramid, where static overlays are found */
    CHECK_LEVEL = 2    /* and where motions are checked by whole pictures */
};

/* The least distance of points in tiny pictures: corners are found by windows of 3x3 pixels. */
static const double min_distance_px = 3.0;

/* The tracks are contradicted if another motion fits clearly better in this part of the cells with detail, and theirs
 * in no more than that part. Half and twice of either changes no film with text. */
static const double min_against = 0.25, max_support = 0.2;
/* After it, motions that repeat are contradicted without a look: what was burnt in stays for a while. */
static const int contradiction_frames = 60;

struct L1L2Motion {
    L1L2MotionConfig cfg;
    L1L2Vision *vision;
    int width, height;      /* of the downscaled picture */
    double pixel_aspect;    /* a pixel's width by its height */
    double diagonal_px;     /* of the frame as it is shown */
    double half_w, half_h;  /* of the frame, in diagonals */
    double distance_px;     /* between points, in the downscaled picture */
    L1L2ShutterModel shape; /* of the rolling-shutter residual */

    /* The tracks: [0, points) of each array. */
    int points;
    L1L2Pixel point[MAX_POINTS], moved[MAX_POINTS]; /* in the previous picture; in the current one */
    int age[MAX_POINTS];                            /* frames for which the track has followed the camera */
    L1L2Pair pair[MAX_POINTS];
    bool ok[MAX_POINTS];                            /* it was found in the current picture */
    double consensus_weights[MAX_POINTS], fit_weights[MAX_POINTS];
    bool inlier[MAX_POINTS], core[MAX_POINTS];      /* of the selected model, and to which it was fitted */
    int since_selection;                            /* frames, of corners */

    bool had_detail;          /* the previous picture had detail */
    bool has_previous;        /* a picture was pushed since the last reset */
    L1L2Rng rng;
    L1L2Thumbnail thumbnail;  /* of the current picture */
    L1L2TrackWeights weights;
    L1L2ModelSelection selection;
    L1L2StaticOverlay overlay;
    L1L2ShotCut cut;
    L1L2ShotDissolve dissolve;
    L1L2WholePicture *whole;  /* NULL: pictures too small */
    int since_contradiction;  /* frames, of the tracks by whole pictures */
    bool was_tracked;         /* the tracks of the frame before yielded a motion, or it is the first of a shot */
    L1L2MotionGap gap;        /* of frames whose tracks yielded no motion */
    L1L2Mat tracks_F;         /* what the tracks of the frame before yielded */
    L1L2ShutterGate gate;     /* which of the residuals follow the camera's motion */
};

static void configure(L1L2Motion *m)
{
    const L1L2MotionParameters *p = m->cfg.parameters;
    const double aspect = m->cfg.pixel_aspect > 0.0 ? m->cfg.pixel_aspect : 1.0;
    /* Of the downscaled picture: the side of a square of a pixel's area. */
    const double pixel = sqrt(aspect) / hypot(m->width * aspect, m->height);
    m->pixel_aspect = aspect;
    m->diagonal_px = hypot(m->cfg.width * aspect, m->cfg.height);
    m->half_w = 0.5 * m->cfg.width * aspect / m->diagonal_px;
    m->half_h = 0.5 * m->cfg.height / m->diagonal_px;
    m->shape = (L1L2ShutterModel){m->cfg.rolling_shutter, m->half_w, m->half_h, NULL};
    m->weights = (L1L2TrackWeights){.parameters = p, .half_w = m->half_w, .half_h = m->half_h};
    m->overlay = (L1L2StaticOverlay){.parameters = p, .half_w = m->half_w, .half_h = m->half_h};
    m->dissolve.parameters = p;
    /* A similarity measures the translation of the whole picture best: where the camera rolls, a translation alone
     * would fit one part of the picture in one frame and another part in the next. The result is reduced in the end. */
    const bool translation = m->cfg.model == L1L2STAB_MOTION_MODEL_TRANSLATION;
    m->selection = (L1L2ModelSelection){.parameters = p,
                                        .measured_share = 1.0,
                                        .highest = translation ? L1L2STAB_MOTION_MODEL_SIMILARITY : m->cfg.model,
                                        .threshold = p->inlier_distance * pixel};
}

/* share: the part of the frame that is measured. Points lie closer where there is less room for them. */
static void adapt_to_area(L1L2Motion *m, double share)
{
    const L1L2MotionParameters *p = m->cfg.parameters;
    const double grid_px = sqrt((double)m->width * m->height * share / p->max_points);
    m->distance_px = fmin(fmax(p->point_grid * grid_px, min_distance_px), p->point_distance);
    m->selection.measured_share = share;
}

/* Excludes what the caller does not want to be measured. */
static L1L2StabResult set_area(L1L2Motion *m, const L1L2MeasuredArea *area)
{
    double share = 1.0;
    if (area && !l1l2_motion_area_is_whole(area) && !l1l2_motion_overlay_exclude(&m->overlay, area, &share))
        return L1L2STAB_ERR_NOMEM;
    if (share < l1l2_motion_area_least) {
        l1l2_log(m->cfg.log, L1L2STAB_LOG_ERROR,
                 "region and mask leave %.2g %% of the frame to be measured: at least %g %% is needed, so choose a "
                 "larger region, or exclude less by the mask",
                 100.0 * share, 100.0 * l1l2_motion_area_least);
        return L1L2STAB_ERR_ARGUMENT;
    }
    adapt_to_area(m, share);
    return L1L2STAB_OK;
}

/* The current or the previous picture at the sizes that whole_picture.h wants. */
static void take_pictures(const L1L2Motion *m, bool previous, L1L2GrayPicture picture[L1L2_WHOLE_PICTURE_SIZES])
{
    picture[L1L2_WHOLE_PICTURE_FULL] = l1l2_vision_picture(m->vision, previous, 0);
    picture[L1L2_WHOLE_PICTURE_SMALL] = l1l2_vision_picture(m->vision, previous, CHECK_LEVEL);
}

static L1L2StabResult build(L1L2Motion *m, const L1L2MotionConfig *cfg)
{
    const L1L2VisionConfig vision = {
        .format = cfg->format,
        .width = cfg->width,
        .height = cfg->height,
        .analysis_size = cfg->analysis_size,
        .parameters = m->cfg.parameters,
        .log = cfg->log,
    };
    const L1L2StabResult result = l1l2_vision_create(&m->vision, &vision);
    if (result != L1L2STAB_OK)
        return result;
    l1l2_vision_size(m->vision, &m->width, &m->height);
    configure(m);
    L1L2GrayPicture size[L1L2_WHOLE_PICTURE_SIZES];
    take_pictures(m, false, size);
    const L1L2GrayPicture overlay = l1l2_vision_picture(m->vision, false, OVERLAY_LEVEL);
    if (!l1l2_motion_whole_picture_create(&m->whole, size, m->pixel_aspect * cfg->width, cfg->height) ||
        !l1l2_motion_overlay_init(&m->overlay, overlay.width, overlay.height))
        return L1L2STAB_ERR_NOMEM;
    return set_area(m, cfg->area);
}

L1L2StabResult l1l2_motion_create(L1L2Motion **out, const L1L2MotionConfig *cfg)
{
    *out = NULL;
    L1L2Motion *m = l1l2_mem_new(1, sizeof *m);
    if (!m)
        return L1L2STAB_ERR_NOMEM;
    m->cfg = *cfg;
    m->cfg.area = NULL; /* the caller's */
    if (!m->cfg.parameters)
        m->cfg.parameters = &l1l2_motion_defaults;
    const L1L2StabResult result = build(m, cfg);
    if (result != L1L2STAB_OK) {
        l1l2_motion_free(m);
        return result;
    }
    l1l2_motion_reset(m);
    *out = m;
    return L1L2STAB_OK;
}

void l1l2_motion_free(L1L2Motion *m)
{
    if (!m)
        return;
    l1l2_vision_free(m->vision);
    l1l2_motion_whole_picture_free(m->whole);
    l1l2_motion_overlay_clear(&m->overlay);
    l1l2_mem_free(m);
}

void l1l2_motion_reset(L1L2Motion *m)
{
    l1l2_vision_reset(m->vision);
    l1l2_motion_whole_picture_reset(m->whole);
    m->has_previous = false;
    m->rng = l1l2_rng_seeded(m->cfg.seed);
    l1l2_motion_overlay_reset(&m->overlay);
    memset(&m->gate, 0, sizeof m->gate);
}

/* The current picture is the first of a shot, or the first after a reset. */
static void start_shot(L1L2Motion *m)
{
    l1l2_motion_gap_close(&m->gap);
    m->was_tracked = true;
    m->since_contradiction = contradiction_frames + 1;
    m->tracks_F = l1l2_mat_identity();
    m->points = 0;
    m->since_selection = (int)m->cfg.parameters->reselect_frames;
    l1l2_motion_cut_start(&m->cut, &m->thumbnail);
    l1l2_motion_dissolve_start(&m->dissolve, &m->thumbnail);
    l1l2_motion_weights_reset(&m->weights);
    l1l2_motion_model_reset(&m->selection);
    l1l2_shutter_gate_break(&m->gate);
}

/* ---- Step 1: features and tracks ---- */

/* From the downscaled picture's pixels, whose centers are integers, to diagonals from the frame's center. The two axes
 * have different scales, since the downscaled picture's sides are rounded. */
static L1L2Point to_diagonals(const L1L2Motion *m, L1L2Pixel p)
{
    const double x = (p.x + 0.5) * m->cfg.width / m->width - 0.5 * m->cfg.width;
    return (L1L2Point){x * m->pixel_aspect / m->diagonal_px,
                       ((p.y + 0.5) * m->cfg.height / m->height - 0.5 * m->cfg.height) / m->diagonal_px};
}

/* Selects new corners if that is due, where nothing is excluded. */
static L1L2StabResult select_corners(L1L2Motion *m)
{
    const L1L2MotionParameters *p = m->cfg.parameters;
    if (m->since_selection++ < p->reselect_frames && m->points >= p->min_points_share * p->max_points)
        return L1L2STAB_OK;
    int found;
    const L1L2Mask mask = l1l2_motion_overlay_mask(&m->overlay);
    const L1L2StabResult result =
        l1l2_vision_corners(m->vision, m->point, m->points, &mask, m->distance_px, m->point + m->points,
                            (int)p->max_points - m->points, &found);
    l1l2_motion_overlay_age(&m->overlay);
    memset(m->age + m->points, 0, (size_t)found * sizeof *m->age);
    m->points += found;
    m->since_selection = 1;
    return result;
}

static void keep_track(L1L2Motion *m, int i, int *kept)
{
    m->point[*kept] = m->point[i];
    m->age[*kept] = m->age[i];
    m->pair[*kept] = m->pair[i];
    ++*kept;
}

/* Tracks the points of the previous picture into the current one. */
static L1L2StabResult track_points(L1L2Motion *m)
{
    const L1L2StabResult result = l1l2_vision_track(m->vision, m->point, m->moved, m->ok, m->points,
                                                    m->cfg.parameters->max_return_distance);
    if (result != L1L2STAB_OK)
        return result;
    int kept = 0;
    for (int i = 0; i < m->points; i++) {
        m->pair[i] = (L1L2Pair){to_diagonals(m, m->moved[i]), to_diagonals(m, m->point[i])};
        m->point[i] = m->moved[i];
        if (m->ok[i] && !l1l2_motion_overlay_covers(&m->overlay, m->pair[i].from))
            keep_track(m, i, &kept);
    }
    m->points = kept;
    return L1L2STAB_OK;
}

/* ---- Step 2: the motion ---- */

static L1L2TrackSet weigh_tracks(L1L2Motion *m)
{
    l1l2_motion_weights_assign(&m->weights, m->pair, m->age, m->points, m->consensus_weights, m->fit_weights);
    return (L1L2TrackSet){
        .pairs = m->pair,
        .consensus_weights = m->consensus_weights,
        .fit_weights = m->fit_weights,
        .count = m->points,
        .threshold = m->selection.threshold,
        .rng = &m->rng,
    };
}

/* Learns from a measured motion, and drops the outliers: they are on subjects, or drift. If they were kept, a subject
 * that covers a third of the frame would be taken for the background now and then. */
static void learn(L1L2Motion *m, const L1L2Mat *F)
{
    l1l2_motion_weights_learn(&m->weights, m->pair, m->core, m->points);
    const L1L2GrayPicture now = l1l2_vision_picture(m->vision, false, OVERLAY_LEVEL);
    const L1L2GrayPicture previous = l1l2_vision_picture(m->vision, true, OVERLAY_LEVEL);
    l1l2_motion_overlay_learn(&m->overlay, &now, &previous, F);
    int kept = 0;
    for (int i = 0; i < m->points; i++) {
        m->age[i] = m->core[i] ? m->age[i] + 1 : 0;
        if (m->inlier[i])
            keep_track(m, i, &kept);
    }
    m->points = kept;
}

/* ---- Step 4, as far as it concerns two frames: the rolling-shutter residual ---- */

/* What the residual of a frame was fitted to, and the fit. */
typedef struct ResidualFit {
    int count;               /* of the tracks that it was fitted to */
    int track[MAX_POINTS];   /* which those are */
    bool inlier[MAX_POINTS]; /* which of those agree with motion and residual */
    int inliers;             /* their number */
    L1L2ShutterMeasurement step;
} ResidualFit;

/* Fits the residual to the tracks, except where subjects moved lately, however slowly. False: there is no fit. */
static bool fit_residual(const L1L2Motion *m, const L1L2TrackSet *tracks, const L1L2Mat *F, ResidualFit *fit)
{
    L1L2Pair pairs[MAX_POINTS] = {0};
    fit->count = 0;
    for (int i = 0; i < tracks->count; i++)
        if (l1l2_motion_weights_agreement(&m->weights, tracks->pairs[i].from) >=
            m->cfg.parameters->residual_min_agreement) {
            pairs[fit->count] = tracks->pairs[i];
            fit->inlier[fit->count] = m->core[i];
            fit->track[fit->count++] = i;
        }
    fit->inliers = l1l2_shutter_fit(&m->shape, pairs, fit->count, tracks->threshold, fit->inlier, F, &fit->step);
    return fit->inliers > 0;
}

/* True if the fit explains each part of the tracks that it was not fitted to, in all splits. Less is required if the
 * camera's motion predicts the residuals: that distinguishes a rolling shutter from parallax and slow subjects. */
static bool validate_residual(const L1L2Motion *m, const ResidualFit *fit)
{
    const L1L2MotionParameters *p = m->cfg.parameters;
    const bool by_camera = l1l2_shutter_gate_share(&m->gate) >= p->camera_share;
    const double required = by_camera ? p->residual_explained_camera : p->residual_explained;
    for (int split = 0; split < L1L2_SPLITS; split++)
        if (fit->step.explained[split] < required * fit->step.all[split])
            return false;
    return true;
}

/* Tracks that agree with a validated residual follow the camera, too. If far more tracks agree with motion and residual
 * than with the motion alone, the similarity nearest to both becomes the frame's motion. */
static void adopt_residual(L1L2Motion *m, const L1L2TrackSet *tracks, ResidualFit *fit, L1L2SelectedModel *selected)
{
    const L1L2MotionParameters *p = m->cfg.parameters;
    for (int k = 0; k < fit->count; k++)
        m->inlier[fit->track[k]] = m->core[fit->track[k]] = fit->inlier[k];
    if (fit->inliers < p->adopt_min_share * tracks->count ||
        selected->inliers >= p->adopt_max_similarity * fit->inliers)
        return;
    const L1L2Mat part = l1l2_shutter_residual_extract_similarity(&m->shape, &fit->step.r); /* which leaves the rest */
    L1L2Mat F = selected->F;
    for (int i = 0; i < 6; i++)
        F.m[i] += part.m[i];
    *selected = l1l2_motion_model_adopt(&m->selection, &F, fit->inliers, (double)fit->inliers / tracks->count);
}

static void measure_residual(L1L2Motion *m, const L1L2TrackSet *tracks, L1L2SelectedModel *selected,
                             L1L2MotionResult *out)
{
    ResidualFit fit;
    if (m->shape.kind == L1L2STAB_ROLLING_SHUTTER_NONE || m->cfg.model == L1L2STAB_MOTION_MODEL_TRANSLATION ||
        selected->source < L1L2STAB_MOTION_SOURCE_SIMILARITY || !fit_residual(m, tracks, &selected->F, &fit))
        return;
    if (validate_residual(m, &fit))
        adopt_residual(m, tracks, &fit, selected);
    out->has_residual = true;
    out->residual = fit.step;
}

/* ---- Where the tracks do not yield the motion: whole pictures ---- */

/* F was found from whole pictures. The tracks that agree with it follow the camera. quality: what the pictures say. */
static L1L2SelectedModel adopt_alignment(L1L2Motion *m, const L1L2TrackSet *tracks, const L1L2Mat *F, double quality)
{
    int inliers = 0;
    for (int i = 0; i < tracks->count; i++) {
        const L1L2Point p = l1l2_mat_apply(F, tracks->pairs[i].from), to = tracks->pairs[i].to;
        m->inlier[i] = m->core[i] = hypot(p.x - to.x, p.y - to.y) <= tracks->threshold;
        inliers += m->inlier[i];
    }
    L1L2SelectedModel selected = l1l2_motion_model_adopt(&m->selection, F, inliers,
                                                         fmin(quality, m->cfg.parameters->align_max_quality));
    selected.source = L1L2STAB_MOTION_SOURCE_ALIGNMENT;
    return selected;
}

/* How much each cell of the alignment counts: by the part of its tracks that followed the camera lately. */
static void cell_trust(const L1L2Motion *m, float trust[L1L2_ALIGN_CELLS])
{
    const double least = m->cfg.parameters->min_cell_weight;
    for (int i = 0; i < L1L2_ALIGN_CELLS; i++) {
        const double x = (i % L1L2_ALIGN_CELLS_X + 0.5) / L1L2_ALIGN_CELLS_X;
        const double y = ((double)(i / L1L2_ALIGN_CELLS_X) + 0.5) / L1L2_ALIGN_CELLS_Y;
        const L1L2Point center = {(2.0 * x - 1.0) * m->half_w, (2.0 * y - 1.0) * m->half_h};
        trust[i] = (float)(least + (1.0 - least) * l1l2_motion_weights_agreement(&m->weights, center));
    }
}

/* How far whole pictures have to be asked about the motion of the tracks. */
typedef enum Doubt {
    SURE,         /* not at all */
    IN_DOUBT,     /* the tracks yield no motion, or one with which many of them disagree */
    CONTRADICTED, /* most parts of the picture move otherwise: the tracks may be on something burnt in */
} Doubt;

/* True if F is the motion of something burnt in: none at all, or the same as in the frame before. A camera in a hand
 * hardly ever moves like that. */
static bool repeats(const L1L2Motion *m, const L1L2Mat *F)
{
    const L1L2Mat identity = l1l2_mat_identity();
    const double same = m->cfg.parameters->uniform_motion * m->selection.threshold;
    return l1l2_mat_corner_distance(F, &m->tracks_F, m->half_w, m->half_h) < same ||
           l1l2_mat_corner_distance(F, &identity, m->half_w, m->half_h) < same;
}

static Doubt find_doubt(L1L2Motion *m, const L1L2TrackSet *tracks, const L1L2SelectedModel *selected,
                        const L1L2Mat *expected)
{
    const L1L2MotionParameters *p = m->cfg.parameters;
    L1L2AlignmentCheck check;
    if (!m->had_detail || !l1l2_image_thumbnail_has_detail(&m->thumbnail))
        return SURE;
    if (selected->source == L1L2STAB_MOTION_SOURCE_NONE)
        return IN_DOUBT;
    if (selected->quality < p->align_below_quality && selected->inliers <= p->align_max_inlier_share * tracks->count)
        return IN_DOUBT;
    if (!repeats(m, &selected->F))
        return SURE;
    if (m->since_contradiction <= contradiction_frames)
        return CONTRADICTED;
    l1l2_motion_whole_picture_check(m->whole, &selected->F, expected, l1l2_motion_overlay_mask(&m->overlay), &check);
    if (check.against < min_against || check.support > max_support)
        return SURE;
    m->since_contradiction = 0;
    return CONTRADICTED;
}

/* False if the contrast of the two pictures differs so much that one of them is covered. */
static bool is_same_light(const L1L2MotionParameters *p, const L1L2Alignment *a)
{
    return fabs(log(a->evidence.gain)) <= p->align_max_gain;
}

/* Measures the motion of a frame from whole pictures, if the tracks leave it in doubt. It replaces the motion of the
 * tracks where it fits the pictures clearly better. */
static void align_pictures(L1L2Motion *m, const L1L2TrackSet *tracks, const L1L2Mat *expected,
                           L1L2SelectedModel *selected)
{
    const L1L2MotionParameters *p = m->cfg.parameters;
    float trust[L1L2_ALIGN_CELLS];
    L1L2Alignment a;
    const Doubt doubt = find_doubt(m, tracks, selected, expected);
    m->since_contradiction++;
    if (doubt == SURE)
        return;
    const bool measured = selected->source != L1L2STAB_MOTION_SOURCE_NONE;
    L1L2AlignmentGuide guide = {.start = {*expected}, .starts = 1, .trust = trust, .split = true,
                                .mask = l1l2_motion_overlay_mask(&m->overlay)};
    if (measured || selected->ambiguous)
        guide.start[guide.starts++] = selected->F;
    if (doubt == CONTRADICTED)
        guide.layer = &selected->F;
    cell_trust(m, trust);
    if (!l1l2_motion_whole_picture_align(m->whole, &guide, &a) || !is_same_light(p, &a))
        return;
    const double better = doubt == CONTRADICTED ? p->contradicted_better : p->align_better;
    if (measured && a.evidence.residual >= better * a.evidence.start_residual[1])
        return;
    if (doubt == CONTRADICTED)
        m->since_contradiction = 0;
    *selected = adopt_alignment(m, tracks, &a.F, a.evidence.correlation * a.evidence.agreement);
}

/* Two motions have about equal weight, and whole pictures do not tell either. Many tracks are never given up: one of
 * the two is right, and the tracks' history says which is likelier. */
static void follow_history(L1L2Motion *m, const L1L2TrackSet *tracks, L1L2SelectedModel *selected)
{
    if (selected->source != L1L2STAB_MOTION_SOURCE_NONE || !selected->ambiguous ||
        tracks->count < m->cfg.parameters->many_tracks)
        return;
    memcpy(m->core, m->inlier, (size_t)tracks->count * sizeof *m->core);
    *selected = l1l2_motion_model_adopt(&m->selection, &selected->F, selected->inliers, selected->quality);
}

/* ---- Bridges: over frames that could not be tracked ---- */

/* The motion from the current picture to the reference, by aligning the two. False: it was not found. */
static bool align_with_reference(L1L2Motion *m, L1L2Mat *G)
{
    L1L2Alignment a;
    L1L2AlignmentGuide guide = {.start = {l1l2_motion_gap_product(&m->gap)}, .starts = 1,
                                .mask = l1l2_motion_overlay_mask(&m->overlay)};
    if (!l1l2_image_thumbnail_has_detail(&m->thumbnail) || !l1l2_motion_whole_picture_bridge(m->whole, &guide, &a) ||
        !is_same_light(m->cfg.parameters, &a))
        return false;
    *G = a.F;
    return true;
}

/* Opens a gap at a frame whose tracks yielded no motion, if those of the frame before did. When a picture is sharp
 * again, measures its motion to the picture before the gap, and makes the motions of all frames since agree with it. */
static void bridge(L1L2Motion *m, const L1L2TrackSet *tracks, bool tracked, L1L2SelectedModel *selected,
                   L1L2MotionResult *out)
{
    const bool measured = selected->source != L1L2STAB_MOTION_SOURCE_NONE, opens = m->gap.frames == 0;
    const L1L2Mat *F = measured ? &selected->F : &m->selection.last;
    L1L2Mat G;
    const bool follows_tracked = m->was_tracked;
    m->was_tracked = tracked;
    if (opens && (tracked || !follows_tracked || !m->had_detail))
        return;
    if (opens)
        l1l2_motion_whole_picture_keep(m->whole);
    if (!l1l2_motion_gap_add(&m->gap, F, measured ? 1.0 : 0.0) || opens)
        return;
    if (!tracked && !l1l2_motion_whole_picture_is_sharp(m->whole))
        return;
    if (!align_with_reference(m, &G)) {
        if (tracked)
            l1l2_motion_gap_close(&m->gap);
        return;
    }
    l1l2_motion_gap_bridge(&m->gap, &G);
    out->bridged = m->gap.frames - 1;
    for (int i = 0; i < out->bridged; i++)
        out->bridged_F[i] = l1l2_mat_reduce(&m->gap.F[i], l1l2_mat_dim(m->cfg.model));
    /* Where tracks were measured, they stay: F has what the frames before it lacked as well. */
    if (tracked)
        selected->F = m->gap.F[out->bridged];
    else
        *selected = adopt_alignment(m, tracks, &m->gap.F[out->bridged], selected->quality);
    l1l2_motion_gap_close(&m->gap);
}

/* ---- One frame ---- */

/* Drops all tracks and predicts the motion. */
static L1L2SelectedModel predict(L1L2Motion *m, const L1L2SelectedModel *selected)
{
    if (m->selection.lost == 0)
        l1l2_log(m->cfg.log, L1L2STAB_LOG_WARN, "motion: lost, %d of %d tracks agree: predicting", selected->inliers,
                 m->points);
    m->points = 0;
    m->since_selection = (int)m->cfg.parameters->reselect_frames;
    return l1l2_motion_model_predict(&m->selection);
}

/* Another shot begins with the current frame. */
static void cut_to(L1L2Motion *m, const char *what)
{
    l1l2_log(m->cfg.log, L1L2STAB_LOG_DEBUG, "motion: %s", what);
    start_shot(m);
}

/* From the tracks of a frame to its motion. False: it starts another shot. */
static bool measure(L1L2Motion *m, L1L2MotionResult *out)
{
    const L1L2TrackSet tracks = weigh_tracks(m);
    const bool reselected = m->since_selection == 1;
    const L1L2Mat expected = m->selection.last;
    L1L2SelectedModel selected =
        l1l2_motion_model_select(&m->selection, &m->weights, &tracks, reselected, m->inlier, m->core);
    measure_residual(m, &tracks, &selected, out);
    const L1L2Mat tracks_F = selected.F;
    const bool tracked = selected.source != L1L2STAB_MOTION_SOURCE_NONE;
    align_pictures(m, &tracks, &expected, &selected);
    follow_history(m, &tracks, &selected);
    m->tracks_F = tracks_F;
    bridge(m, &tracks, tracked, &selected, out);
    m->had_detail = l1l2_image_thumbnail_has_detail(&m->thumbnail);
    const bool measured = selected.source != L1L2STAB_MOTION_SOURCE_NONE;
    if (l1l2_motion_cut_push(&m->cut, &m->thumbnail, measured)) {
        cut_to(m, "a cut");
        return false;
    }
    if (measured)
        learn(m, &selected.F);
    else
        selected = predict(m, &selected);
    if (l1l2_motion_dissolve_push(&m->dissolve, &m->thumbnail, &selected.F, m->half_w, m->half_h)) {
        cut_to(m, "a dissolve");
        return false;
    }
    if (selected.source == L1L2STAB_MOTION_SOURCE_ALIGNMENT || out->bridged > 0)
        out->has_residual = false; /* it is what the tracks' own motion leaves */
    if (out->has_residual)
        l1l2_shutter_gate_push(&m->gate, &m->shape, &selected.F, &out->residual);
    else
        l1l2_shutter_gate_break(&m->gate);
    out->F = l1l2_mat_reduce(&selected.F, l1l2_mat_dim(m->cfg.model));
    out->model = selected.source;
    if (m->cfg.model == L1L2STAB_MOTION_MODEL_TRANSLATION && out->model == L1L2STAB_MOTION_SOURCE_SIMILARITY)
        out->model = L1L2STAB_MOTION_SOURCE_TRANSLATION;
    out->tracks = tracks.count;
    out->inliers = selected.inliers;
    out->quality = selected.quality;
    return true;
}

static const L1L2MotionResult path_start = {
    .F = {{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}}, .model = L1L2STAB_MOTION_SOURCE_NONE};

static L1L2StabResult advance_picture(L1L2Motion *m, const uint8_t *data, ptrdiff_t stride)
{
    const L1L2StabResult result = l1l2_vision_advance(m->vision, data, stride);
    L1L2GrayPicture previous[L1L2_WHOLE_PICTURE_SIZES], current[L1L2_WHOLE_PICTURE_SIZES];
    take_pictures(m, true, previous);
    take_pictures(m, false, current);
    l1l2_motion_whole_picture_advance(m->whole, previous, current);
    return result == L1L2STAB_OK ? l1l2_vision_thumbnail(m->vision, &m->thumbnail) : result;
}

L1L2StabResult l1l2_motion_push(L1L2Motion *m, const uint8_t *data, ptrdiff_t stride, bool starts_path,
                                L1L2MotionResult *out)
{
    *out = path_start;
    const int64_t start_ns = l1l2_clock_ns();
    L1L2StabResult result = advance_picture(m, data, stride);
    const int64_t scaled_ns = l1l2_clock_ns();
    const bool first = starts_path || !m->has_previous;
    if (result == L1L2STAB_OK && !first)
        result = select_corners(m);
    if (result == L1L2STAB_OK && !first)
        result = track_points(m);
    if (result != L1L2STAB_OK) {
        l1l2_motion_reset(m);
        return result;
    }
    m->has_previous = true;
    const int64_t tracked_ns = l1l2_clock_ns();
    if (first) {
        m->had_detail = l1l2_image_thumbnail_has_detail(&m->thumbnail);
        start_shot(m);
        out->model = starts_path ? L1L2STAB_MOTION_SOURCE_NONE : L1L2STAB_MOTION_SOURCE_IDENTITY;
    } else if (!measure(m, out)) {
        *out = path_start;
    }
    out->scale_ns = scaled_ns - start_ns;
    out->track_ns = tracked_ns - scaled_ns;
    out->fit_ns = l1l2_clock_ns() - tracked_ns;
    return L1L2STAB_OK;
}
