/* SPDX-License-Identifier: MIT */
#include "motion/model_selection.h"

#include <math.h>
#include <string.h>

#include "fit/ransac.h"
#include "rolling_shutter/similarity_by_rows.h"

enum { MAX = L1L2_RANSAC_MAX_PAIRS };

/* A motion among the outliers is one from this many tracks on; any two tracks agree with some similarity. */
static const int min_rival_inliers = 8;

void l1l2_motion_model_reset(L1L2ModelSelection *s)
{
    s->current = s->highest;
    s->acceptable_frames = s->lost = 0;
    s->last = l1l2_mat_identity();
    s->agreement = 1.0;
    s->rivalry = 0.0;
    memset(&s->still, 0, sizeof s->still);
}

/* Root mean square of the distances between F's prediction and the marked tracks. */
static double rms_residual(const L1L2Mat *F, const L1L2TrackSet *tracks, const bool *marked)
{
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < tracks->count; i++)
        if (marked[i]) {
            const L1L2Pair *pair = &tracks->pairs[i];
            const L1L2Point p = l1l2_mat_apply(F, pair->from);
            sum += (p.x - pair->to.x) * (p.x - pair->to.x) + (p.y - pair->to.y) * (p.y - pair->to.y);
            count++;
        }
    return sqrt(sum / count);
}

static double weight_of(const double *weights, const bool *marked, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += !marked || marked[i] ? weights[i] : 0.0;
    return sum;
}

/* Fits a map to the tracks that `members` marks. agreeing: flags of its inliers, written. Returns their number. */
static int fit_among(L1L2StabMotionModel model, const L1L2TrackSet *tracks, const bool *members, bool *agreeing,
                     L1L2Mat *F)
{
    L1L2Pair pairs[MAX] = {0};
    double consensus[MAX], fit[MAX];
    bool inlier[MAX];
    L1L2TrackSet some = *tracks;
    some.pairs = pairs, some.consensus_weights = consensus, some.fit_weights = fit;
    some.count = 0;
    for (int i = 0; i < tracks->count; i++)
        if (members[i]) {
            pairs[some.count] = tracks->pairs[i];
            consensus[some.count] = tracks->consensus_weights[i];
            fit[some.count++] = tracks->fit_weights[i];
        }
    const int inliers = l1l2_ransac(model, &some, inlier, F);
    for (int i = 0, k = 0; i < tracks->count; i++)
        agreeing[i] = members[i] && inlier[k++];
    return inliers;
}

/* ---- Acceptance ---- */

/* A model that was fitted to the tracks of a frame. */
typedef struct Candidate {
    L1L2StabMotionModel model;
    L1L2Mat F;
    int inliers;
    bool by_rows; /* the rows moved differently */
    bool inlier[MAX];
} Candidate;

static void fit_candidate(const L1L2ModelSelection *s, const L1L2TrackWeights *w, const L1L2TrackSet *tracks,
                          L1L2StabMotionModel model, Candidate *c)
{
    L1L2TrackSet set = *tracks;
    if (model == L1L2STAB_MOTION_MODEL_TRANSLATION)
        set.threshold *= s->parameters->translation_threshold;
    c->model = model;
    c->inliers = l1l2_ransac(model, &set, c->inlier, &c->F);
    c->by_rows = false;
    if (model == L1L2STAB_MOTION_MODEL_SIMILARITY &&
        c->inliers < s->parameters->rows_max_inlier_share * tracks->count) {
        const L1L2ShutterRowTracks rows = {set.pairs, set.consensus_weights, set.count, w->half_h, set.threshold, NULL};
        const int inliers = l1l2_shutter_similarity_by_rows(&rows, c->inlier, &c->F);
        c->by_rows = inliers > 0;
        if (c->by_rows)
            c->inliers = inliers;
    }
}

/* True if a camera makes this motion from one frame to the next: the singular values of its linear part are within the
 * limits of scale, and so is its rotation. With [a b; c d] = R(phi) diag(u, v) R(psi), u and v are
 * (|(a + d, c - b)| +- |(a - d, b + c)|) / 2. */
static bool is_plausible(const L1L2MotionParameters *p, const L1L2Mat *F)
{
    const double a = F->m[0], b = F->m[1], c = F->m[3], d = F->m[4];
    const double mean = hypot(a + d, c - b) / 2.0, difference = hypot(a - d, b + c) / 2.0;
    return mean - difference >= p->min_scale && mean + difference <= p->max_scale &&
           fabs(atan2(c - b, a + d)) <= p->max_rotation;
}

/* True if the model passes its acceptance tests. Few tracks still determine a translation, but more of them have to
 * agree, and more closely than tracks of pure noise would. */
static bool is_acceptable(const L1L2ModelSelection *s, const L1L2TrackWeights *w, const L1L2TrackSet *tracks,
                          const Candidate *c)
{
    const L1L2MotionParameters *p = s->parameters;
    if (c->model == L1L2STAB_MOTION_MODEL_TRANSLATION)
        return c->inliers >= p->translation_min_inliers && c->inliers >= p->translation_min_share * tracks->count &&
               rms_residual(&c->F, tracks, c->inlier) <=
                   p->translation_max_spread * p->translation_threshold * s->threshold;
    return c->inliers >= p->min_inliers && c->inliers >= p->min_inlier_share * tracks->count &&
           is_plausible(p, &c->F) &&
           (c->model == L1L2STAB_MOTION_MODEL_SIMILARITY ||
            l1l2_fit_coverage(w->half_w, w->half_h, tracks->pairs, c->inlier, tracks->count) >= p->full_coverage);
}

/* Finds the highest acceptable model. One above the current model is put off until it has been acceptable for some
 * frames, unless it has many inliers or nothing below it is acceptable. False: no model is acceptable. */
static bool choose_candidate(L1L2ModelSelection *s, const L1L2TrackWeights *w, const L1L2TrackSet *tracks,
                             Candidate *chosen)
{
    const L1L2MotionParameters *p = s->parameters;
    Candidate put_off = {.inliers = 0};
    bool found = false, waiting = false;
    for (int model = (int)s->highest; model >= L1L2STAB_MOTION_MODEL_TRANSLATION && !found; model--) {
        fit_candidate(s, w, tracks, (L1L2StabMotionModel)model, chosen);
        if (!is_acceptable(s, w, tracks, chosen))
            continue;
        found = chosen->model <= s->current || chosen->inliers >= p->return_inlier_factor * p->min_inliers ||
                s->acceptable_frames + 1 >= p->return_frames;
        if (!found && !waiting) {
            put_off = *chosen;
            waiting = true;
        }
    }
    if (!found && waiting)
        *chosen = put_off;
    s->acceptable_frames = found && waiting ? s->acceptable_frames + 1 : 0;
    return found || waiting;
}

/* ---- Quality: does another motion compete? ---- */

/* Looks for the best motion among the outliers. rival: flags of its inliers, written. Returns how far F is from its
 * tracks, [0, 1]: 0 if there is no rival, 1 from rival_distance on. Nearer ones are other depths of a scene. */
static double find_rival(const L1L2ModelSelection *s, const L1L2TrackSet *tracks, const Candidate *c, bool *rival)
{
    const L1L2MotionParameters *p = s->parameters;
    bool outlier[MAX] = {false};
    L1L2Mat G;
    for (int i = 0; i < tracks->count; i++)
        outlier[i] = !c->inlier[i];
    const int inliers = fit_among(L1L2STAB_MOTION_MODEL_SIMILARITY, tracks, outlier, rival, &G);
    if (inliers < min_rival_inliers ||
        rms_residual(&G, tracks, rival) > p->translation_max_spread * s->threshold)
        return 0.0;
    return fmin(1.0, rms_residual(&c->F, tracks, rival) / (p->rival_distance * s->threshold));
}

/* The part of the weight that agrees, less what a rival has. It is found with and without the tracks' history, and the
 * lower value counts, because history would confirm a mistake. A rival that was seen a while ago still counts in
 * part: two motions look like one while they are close to each other. ambiguous: even with history the motion is as
 * likely a subject's as the background's. */
static double find_quality(L1L2ModelSelection *s, const L1L2TrackWeights *w, const L1L2TrackSet *tracks,
                           const Candidate *c, bool *ambiguous)
{
    const L1L2MotionParameters *p = s->parameters;
    const int count = tracks->count;
    double without_history[MAX];
    bool rival[MAX] = {false};
    s->rivalry *= p->rival_memory;
    double least = 1.0, share = 1.0, distance = 0.0;
    const double inlying = weight_of(tracks->consensus_weights, c->inlier, count);
    const double all = weight_of(tracks->consensus_weights, NULL, count);
    if (all - inlying >= p->rival_min_share * all)
        distance = find_rival(s, tracks, c, rival);
    for (int i = 0; i < count; i++)
        without_history[i] = tracks->consensus_weights[i] / tracks->fit_weights[i];
    for (int history = 1; history >= 0; history--) {
        const double *weights = history ? tracks->consensus_weights : without_history;
        const double agreed = weight_of(weights, c->inlier, count);
        const double opposed = distance * weight_of(weights, rival, count);
        const double part = agreed / weight_of(weights, NULL, count), unopposed = fmax(0.0, 1.0 - opposed / agreed);
        share = fmin(share, part);
        least = fmin(least, part * unopposed);
        s->rivalry = fmax(s->rivalry, 1.0 - unopposed);
        if (history)
            *ambiguous = least < p->min_quality;
    }
    least = fmin(least, share * (1.0 - s->rivalry));
    const double coverage = l1l2_fit_coverage(w->half_w, w->half_h, tracks->pairs, c->inlier, count);
    return least * fmin(1.0, coverage / (p->full_coverage * s->measured_share));
}

/* ---- The core: is one of two close motions the background's? ---- */

/* The inliers may belong to two motions, each of which fits its tracks far better than the threshold requires: the
 * background's and that of a slow subject or another surface. Then F and the core become those of the first alone.
 * Where depth is continuous there are no two such motions, and F stays the mean of all inliers. */
static void find_core(const L1L2ModelSelection *s, const L1L2TrackSet *tracks, const Candidate *c, bool *core,
                      L1L2Mat *F)
{
    const L1L2MotionParameters *p = s->parameters;
    bool first[MAX], second[MAX], rest[MAX] = {false};
    L1L2Mat first_F, second_F;
    L1L2TrackSet tight = *tracks;
    const int count = tracks->count;
    tight.threshold = p->core_threshold * s->threshold;
    memcpy(core, c->inlier, (size_t)count * sizeof *core);
    const double all = weight_of(tracks->consensus_weights, c->inlier, count);
    fit_among(c->model, &tight, c->inlier, first, &first_F);
    const double firsts = weight_of(tracks->consensus_weights, first, count);
    if (firsts < p->core_min_share * all || firsts > all - p->core_min_rest * all)
        return;
    for (int i = 0; i < count; i++)
        rest[i] = c->inlier[i] && !first[i];
    fit_among(c->model, &tight, rest, second, &second_F);
    if (weight_of(tracks->consensus_weights, second, count) < p->second_min_share * (all - firsts) ||
        rms_residual(&first_F, tracks, second) < p->second_min_distance * s->threshold)
        return;
    memcpy(core, first, (size_t)count * sizeof *core);
    *F = first_F;
}

/* ---- Noise: is the motion significant? ---- */

/*
 * The standard error of F at the frame's corners, from the scatter of the inliers about it.
 *
 * Let each coordinate of a track have the standard deviation sigma: rms_residual^2 = 2 sigma^2. Least squares over n
 * tracks gives the mean with the variance sigma^2 / n per coordinate. A similarity's rotation and zoom add, at the
 * distance R from the center, R^2 sigma^2 / (n r^2) where r^2 is the tracks' mean squared distance from the center. So
 * the error at a corner is sigma sqrt((1 + R^2 / r^2) / n) per coordinate; a translation has the first term alone.
 *
 * Residuals beyond the threshold are missing from the scatter, so the noise is larger than it seems. If it spreads the
 * residuals evenly over a disc of which a part q = n / count is within the threshold, sigma is larger by 1 / sqrt(q).
 * The factor used is q^-2, an empirical choice on the safe side, at most max_truncation since there are other outliers
 * too.
 */
static double standard_error(const L1L2ModelSelection *s, const L1L2TrackWeights *w, const L1L2TrackSet *tracks,
                             const Candidate *c, const L1L2Mat *F)
{
    const double n = c->inliers, count = tracks->count;
    const double sigma = rms_residual(F, tracks, c->inlier) / sqrt(2.0);
    double radius2 = 0.0;
    for (int i = 0; i < tracks->count; i++)
        if (c->inlier[i]) {
            const L1L2Point p = tracks->pairs[i].from;
            radius2 += (p.x * p.x + p.y * p.y) / n;
        }
    const double corner2 = w->half_w * w->half_w + w->half_h * w->half_h;
    const bool translation = c->model == L1L2STAB_MOTION_MODEL_TRANSLATION;
    const double leverage = translation || radius2 == 0.0 ? 1.0 : 1.0 + corner2 / radius2;
    return sigma * sqrt(leverage / n) * fmin(count * count / (n * n), s->parameters->max_truncation);
}

/*
 * Shrinks F towards the identity by as much as it is noise: else a dark scene would shake.
 *
 * A motion m observed with noise e of variance N has |F - 1|^2 = m^2 + N on average. The linear estimate of m with the
 * least squared error is the observation times Wiener's gain m^2 / (m^2 + N) = 1 - N / |F - 1|^2, limited to >= 0. N is
 * (significance * error)^2, so that motions within that many standard errors vanish. Errors below negligible_error are
 * not counted, so that well tracked frames keep their motion to the bit.
 */
static L1L2Mat shrink_to_significant(const L1L2ModelSelection *s, const L1L2TrackWeights *w, const L1L2Mat *F,
                                     double error)
{
    const L1L2Mat identity = l1l2_mat_identity();
    const double counted = fmax(0.0, error - s->parameters->negligible_error * s->threshold);
    const double size = l1l2_mat_corner_distance(F, &identity, w->half_w, w->half_h);
    const double noise = s->parameters->significance * counted;
    const double gain = noise > 0.0 ? fmax(0.0, 1.0 - noise * noise / (size * size + 1e-300)) : 1.0;
    L1L2Mat part = *F;
    for (int i = 0; i < 6 && gain < 1.0; i++)
        part.m[i] = identity.m[i] + gain * (F->m[i] - identity.m[i]);
    return part;
}

/* Holds a camera on a tripod still: small errors of many frames would add up to a drift. The camera counts as standing
 * still while the decaying sum of its motions stays within what noise makes of it. A pan of a few thousandths of a
 * pixel per frame ends that. */
static void hold_still(L1L2ModelSelection *s, const L1L2TrackWeights *w, L1L2Mat *F, double error)
{
    const L1L2MotionParameters *p = s->parameters;
    const L1L2Mat identity = l1l2_mat_identity();
    L1L2Mat sum = identity;
    for (int i = 0; i < 6; i++) {
        s->still.sum[i] = p->still_memory * s->still.sum[i] + F->m[i] - identity.m[i];
        sum.m[i] += s->still.sum[i];
    }
    s->still.variance = p->still_memory * s->still.variance + error * error;
    const double moved = l1l2_mat_corner_distance(&sum, &identity, w->half_w, w->half_h);
    if (moved > p->still_significance * sqrt(s->still.variance))
        memset(&s->still, 0, sizeof s->still);
    else if (++s->still.frames >= p->still_frames)
        *F = identity;
}

static L1L2StabMotionSource source_of(L1L2StabMotionModel model)
{
    switch (model) {
    case L1L2STAB_MOTION_MODEL_TRANSLATION:
        return L1L2STAB_MOTION_SOURCE_TRANSLATION;
    case L1L2STAB_MOTION_MODEL_AFFINE:
        return L1L2STAB_MOTION_SOURCE_AFFINE;
    default:
        return L1L2STAB_MOTION_SOURCE_SIMILARITY;
    }
}

L1L2SelectedModel l1l2_motion_model_select(L1L2ModelSelection *s, const L1L2TrackWeights *w,
                                           const L1L2TrackSet *tracks, bool reselected, bool *inlier, bool *core)
{
    Candidate c = {.inliers = 0};
    bool ambiguous = false;
    memset(core, false, (size_t)tracks->count * sizeof *core);
    const bool found = choose_candidate(s, w, tracks, &c);
    memcpy(inlier, c.inlier, (size_t)tracks->count * sizeof *inlier);
    L1L2SelectedModel selected = {.source = L1L2STAB_MOTION_SOURCE_NONE, .F = c.F, .inliers = c.inliers};
    if (!found)
        return selected;
    selected.quality = find_quality(s, w, tracks, &c, &ambiguous);
    s->agreement = reselected ? selected.quality : fmin(selected.quality, s->agreement);
    selected.quality = s->agreement;
    selected.ambiguous = ambiguous;
    if (ambiguous)
        return selected;
    selected.source = source_of(c.model);
    if (c.by_rows || c.model == L1L2STAB_MOTION_MODEL_TRANSLATION)
        memcpy(core, inlier, (size_t)tracks->count * sizeof *core);
    else
        find_core(s, tracks, &c, core, &selected.F);
    const double error = standard_error(s, w, tracks, &c, &selected.F);
    selected.quality /= 1.0 + fmax(0.0, error / s->threshold - s->parameters->negligible_error);
    selected.F = shrink_to_significant(s, w, &selected.F, error);
    hold_still(s, w, &selected.F, error);
    s->current = c.model;
    s->last = selected.F;
    s->lost = 0;
    return selected;
}

L1L2SelectedModel l1l2_motion_model_adopt(L1L2ModelSelection *s, const L1L2Mat *F, int inliers, double quality)
{
    s->current = L1L2STAB_MOTION_MODEL_SIMILARITY;
    s->acceptable_frames = s->lost = 0;
    s->last = *F;
    s->agreement = fmin(s->agreement, quality);
    return (L1L2SelectedModel){
        .source = L1L2STAB_MOTION_SOURCE_SIMILARITY, .F = *F, .inliers = inliers, .quality = quality};
}

L1L2SelectedModel l1l2_motion_model_predict(L1L2ModelSelection *s)
{
    s->lost++;
    s->current = s->highest;
    s->acceptable_frames = 0;
    memset(&s->still, 0, sizeof s->still);
    for (int i = 0; i < 9; i++) {
        const double identity = i % 4 == 0 ? 1.0 : 0.0;
        s->last.m[i] = identity + s->parameters->prediction_fade * (s->last.m[i] - identity);
    }
    const bool predicted = s->lost <= s->parameters->max_predicted_frames;
    return (L1L2SelectedModel){
        .source = predicted ? L1L2STAB_MOTION_SOURCE_PREDICTED : L1L2STAB_MOTION_SOURCE_IDENTITY,
        .F = predicted ? s->last : l1l2_mat_identity()};
}
