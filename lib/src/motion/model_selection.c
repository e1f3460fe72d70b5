/* SPDX-License-Identifier: MIT */
#include "motion/model_selection.h"

#include <math.h>
#include <string.h>

#include "fit/least_squares.h"
#include "rolling_shutter/similarity_by_rows.h"

/* What a camera does from one frame to the next; beyond it, the fit is wrong. */
static const double min_scale = 0.8, max_scale = 1.25, max_rotation_rad = 0.25;
static const int min_inliers = 30, min_inliers_translation = 8;
static const double min_inlier_share = 0.2;
/* Few points tell where the picture went, but not how it turned: a wider threshold, and more of them have to agree. */
static const double wider = 2.0, min_share_fallback = 0.5;
/* Points of nothing but noise agree with a shift if it is wide enough; then they fill the circle around it evenly. */
static const double max_spread = 0.5; /* rms of the inliers' residuals, of the threshold; evenly filled it is 0.71 */
/* Where fewer agree, rows may have moved differently. */
static const double most_agree = 0.7;
/* The inner threshold, of the outer one; the part of the inliers' votes that has to agree so well; the part left
 * then, at least, and what of it has to agree with itself as well; and how far apart both are. */
static const double sharper = 0.3, min_core = 0.5, min_rest = 0.05, min_second = 0.8, min_apart = 0.5;
/* Up again. */
static const double plenty = 1.5;
static const int good_frames = 3;

/* Where nothing can be measured, the last motion goes on and fades; after this many frames it is gone. */
static const int max_predicted = 15;
static const double prediction_fade = 0.8;

/* Another motion is looked for among outliers that have this part of the votes. */
static const double min_rival_share = 0.1;
static const int min_rival_inliers = 8;
/* A motion that does not rise above what the tracks' noise makes of it is none: the dark would shake. Below the first,
 * in thresholds, noise is not in question (200 good tracks: 0.01). */
static const double clear_error = 0.035, significant = 3.0, most_unseen = 3.0;
/* So long a motion has been none, so many times what noise makes of it; what is left of a sum from frame to frame. */
static const int still_frames = 15;
static const double still_errors = 4.0, still_memory = 0.98;
/* Next to the inliers it is another depth of the same scene, and no harm to follow; from here on, in thresholds, it is
 * another thing. */
static const double far_apart = 4.0;
/* Below it, a motion is as likely the subject's as the background's. */
static const double min_quality = 0.12;
/* Inliers in this part of the cells are as good as all over the frame. */
static const double full_coverage = 0.3;

void l1l2_motion_model_reset(L1L2ModelSelection *l)
{
    l->rung = l->wanted;
    l->waiting = l->lost = 0;
    l->last = l1l2_mat_identity();
    l->agreed = 1.0;
    memset(&l->still, 0, sizeof l->still);
}

/* The singular values of the linear part lie within the scales, and it turns little. */
static bool plausible(const L1L2Mat *F)
{
    const double a = F->m[0], b = F->m[1], c = F->m[3], d = F->m[4];
    const double turn = hypot(a + d, c - b) / 2.0, shear = hypot(a - d, b + c) / 2.0;
    return turn - shear >= min_scale && turn + shear <= max_scale && fabs(atan2(c - b, a + d)) <= max_rotation_rad;
}

static double spread(const L1L2Mat *F, const L1L2Pair *pairs, const bool *inlier, int count)
{
    double sum = 0.0;
    int inliers = 0;
    for (int i = 0; i < count; i++)
        if (inlier[i]) {
            const L1L2Point p = l1l2_mat_apply(F, pairs[i].from);
            sum += (p.x - pairs[i].to.x) * (p.x - pairs[i].to.x) + (p.y - pairs[i].to.y) * (p.y - pairs[i].to.y);
            inliers++;
        }
    return sqrt(sum / inliers);
}

/* How far off the corners are to be expected, from the scatter of the inliers about F. What noise scatters beyond the
 * threshold is not seen, so few inliers mean more of it, if only up to a point: there are other outliers. */
static double expected_error(const L1L2ModelSelection *l, const L1L2TrackWeights *v, const L1L2SelectedModel *r,
                             const L1L2Pair *pairs, const bool *inlier, int count)
{
    const double n = r->inliers, deviation = spread(&r->F, pairs, inlier, count) / sqrt(2.0);
    double radius2 = 0.0;
    for (int i = 0; i < count; i++)
        if (inlier[i])
            radius2 += (pairs[i].from.x * pairs[i].from.x + pairs[i].from.y * pairs[i].from.y) / n;
    const double corner2 = v->half_w * v->half_w + v->half_h * v->half_h;
    const double lever =
        r->model == L1L2STAB_MOTION_SOURCE_TRANSLATION || radius2 == 0.0 ? 1.0 : 1.0 + corner2 / radius2;
    const double unseen = fmin(count * count / (n * n), most_unseen);
    return deviation * sqrt(lever / n) * unseen;
}

/* F as far as it is significant: Wiener's gain, over the identity. */
static L1L2Mat significant_part(const L1L2ModelSelection *l, const L1L2Mat *F, double expected,
                                const L1L2TrackWeights *v)
{
    const L1L2Mat identity = l1l2_mat_identity();
    const double error = fmax(0.0, expected - clear_error * l->threshold);
    const double size = l1l2_mat_corner_distance(F, &identity, v->half_w, v->half_h), noise = significant * error;
    const double gain = noise > 0.0 ? fmax(0.0, 1.0 - noise * noise / (size * size + 1e-300)) : 1.0;
    L1L2Mat part = *F;
    for (int i = 0; i < 6 && gain < 1.0; i++)
        part.m[i] = identity.m[i] + gain * (F->m[i] - identity.m[i]);
    return part;
}

/* Small errors of many frames add up to a drift, and a tripod's picture would wander. While the sum of the motions
 * stays within what noise makes of it, the camera stands still. A pan of some thousandths of a pixel a frame ends
 * that. */
static void hold_still(L1L2ModelSelection *l, L1L2Mat *F, double expected, const L1L2TrackWeights *v)
{
    const L1L2Mat identity = l1l2_mat_identity();
    L1L2Mat sum = identity;
    for (int i = 0; i < 6; i++) {
        l->still.sum[i] = still_memory * l->still.sum[i] + F->m[i] - identity.m[i];
        sum.m[i] += l->still.sum[i];
    }
    l->still.variance = still_memory * l->still.variance + expected * expected;
    const double moved = l1l2_mat_corner_distance(&sum, &identity, v->half_w, v->half_h);
    if (moved > still_errors * sqrt(l->still.variance))
        memset(&l->still, 0, sizeof l->still);
    else if (++l->still.frames >= still_frames)
        *F = identity;
}

/* Does the rung bear? */
static bool stands(const L1L2ModelSelection *l, L1L2StabMotionModel rung, const L1L2TrackWeights *v,
                   const L1L2Pair *pairs, int count, const bool *inlier, const L1L2SelectedModel *r)
{
    if (rung == L1L2STAB_MOTION_MODEL_TRANSLATION) {
        return r->inliers >= min_inliers_translation && r->inliers >= min_share_fallback * count &&
               spread(&r->F, pairs, inlier, count) <= max_spread * wider * l->threshold;
    }
    return r->inliers >= min_inliers && r->inliers >= min_inlier_share * count && plausible(&r->F) &&
           (rung == L1L2STAB_MOTION_MODEL_SIMILARITY ||
            l1l2_fit_coverage(v->half_w, v->half_h, pairs, inlier, count) >= full_coverage);
}

/* A rung above the last one waits until it has borne for some frames. */
static bool may_rise(L1L2ModelSelection *l, L1L2StabMotionModel rung, int inliers)
{
    if (rung <= l->rung || inliers >= plenty * min_inliers || ++l->waiting >= good_frames) {
        l->waiting = 0;
        return true;
    }
    return false;
}

static double votes_of(const double *votes, const bool *inlier, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += !inlier || inlier[i] ? votes[i] : 0.0;
    return sum;
}

/* The motion of the pairs that `of` names. agreeing: `count` flags out. Returns how many agree. */
static int motion_among(L1L2StabMotionModel model, const L1L2Pair *pairs, L1L2PairWeights say, const bool *of,
                        int count, double threshold, L1L2Rng *rng, bool *agreeing, L1L2Mat *F)
{
    L1L2Pair some[L1L2_RANSAC_MAX_PAIRS] = {0};
    double votes[L1L2_RANSAC_MAX_PAIRS], weights[L1L2_RANSAC_MAX_PAIRS];
    bool inlier[L1L2_RANSAC_MAX_PAIRS];
    int n = 0;
    for (int i = 0; i < count; i++)
        if (of[i])
            some[n] = pairs[i], votes[n] = say.votes[i], weights[n++] = say.weights[i];
    const int inliers = l1l2_ransac(model, some, (L1L2PairWeights){votes, weights}, n, threshold, rng, inlier, F);
    for (int i = 0, k = 0; i < count; i++)
        agreeing[i] = of[i] && inlier[k++];
    return inliers;
}

/* The best motion among those that do not agree with F. rival: `count` flags out. Returns how far it is from F where it
 * is measured: 0 where there is none or it is the same, 1 for another thing altogether. */
static double find_rival(const L1L2ModelSelection *l, const L1L2Mat *F, const L1L2Pair *pairs, L1L2PairWeights say,
                         const bool *inlier, int count, L1L2Rng *rng, bool *rival)
{
    bool outlier[L1L2_RANSAC_MAX_PAIRS] = {false};
    L1L2Mat G;
    for (int i = 0; i < count; i++)
        outlier[i] = !inlier[i];
    const int inliers = motion_among(L1L2STAB_MOTION_MODEL_SIMILARITY, pairs, say, outlier, count, l->threshold, rng,
                                     rival, &G);
    if (inliers < min_rival_inliers || spread(&G, pairs, rival, count) > max_spread * l->threshold)
        return 0.0;
    return fmin(1.0, spread(F, pairs, rival, count) / (far_apart * l->threshold));
}

static double quality(const L1L2ModelSelection *l, const L1L2TrackWeights *v, const L1L2Mat *F, const L1L2Pair *pairs,
                      L1L2PairWeights say, int count, L1L2Rng *rng, const bool *inlier, bool *ambiguous)
{
    double standing[L1L2_RANSAC_MAX_PAIRS]; /* the votes without memory: it would confirm itself */
    bool rival[L1L2_RANSAC_MAX_PAIRS] = {false};
    double least = 1.0;
    const double mine = votes_of(say.votes, inlier, count), all = votes_of(say.votes, NULL, count);
    double apart = 0.0;
    if (all - mine >= min_rival_share * all)
        apart = find_rival(l, F, pairs, say, inlier, count, rng, rival);
    for (int i = 0; i < count; i++)
        standing[i] = say.votes[i] / say.weights[i];
    for (int memory = 1; memory >= 0; memory--) {
        const double *votes = memory ? say.votes : standing;
        const double agreed = votes_of(votes, inlier, count), opposed = apart * votes_of(votes, rival, count);
        least = fmin(least, agreed / votes_of(votes, NULL, count) * fmax(0.0, 1.0 - opposed / agreed));
        if (memory)
            *ambiguous = least < min_quality;
    }
    return least * fmin(1.0, l1l2_fit_coverage(v->half_w, v->half_h, pairs, inlier, count) / full_coverage);
}

/* The inliers may be of two motions, each of which agrees far better than the threshold asks: a background, and a
 * subject that moves slowly or another surface. Then F is the first one's alone. Where depth is continuous it is not
 * so, and F is the mean of all. core: of `count`, to whom F was fitted. */
static void sharpen(const L1L2ModelSelection *l, L1L2StabMotionModel model, const L1L2Pair *pairs, L1L2PairWeights say,
                    int count, L1L2Rng *rng, const bool *inlier, bool *core, L1L2Mat *F)
{
    bool first[L1L2_RANSAC_MAX_PAIRS], second[L1L2_RANSAC_MAX_PAIRS], rest[L1L2_RANSAC_MAX_PAIRS] = {false};
    L1L2Mat sharp, other;
    memcpy(core, inlier, (size_t)count * sizeof *core);
    const double all = votes_of(say.votes, inlier, count);
    const double tight = sharper * l->threshold;
    motion_among(model, pairs, say, inlier, count, tight, rng, first, &sharp);
    const double firsts = votes_of(say.votes, first, count);
    if (firsts < min_core * all || firsts > all - min_rest * all)
        return;
    for (int i = 0; i < count; i++)
        rest[i] = inlier[i] && !first[i];
    motion_among(model, pairs, say, rest, count, tight, rng, second, &other);
    if (votes_of(say.votes, second, count) < min_second * (all - firsts) ||
        spread(&sharp, pairs, second, count) < min_apart * l->threshold)
        return;
    memcpy(core, first, (size_t)count * sizeof *core);
    *F = sharp;
}

static const L1L2StabMotionSource model_of[] = {L1L2STAB_MOTION_SOURCE_TRANSLATION, L1L2STAB_MOTION_SOURCE_SIMILARITY,
                                                L1L2STAB_MOTION_SOURCE_AFFINE};

L1L2SelectedModel l1l2_motion_model_select(L1L2ModelSelection *l, const L1L2TrackWeights *v, const L1L2Pair *pairs,
                                           L1L2PairWeights say, int count, bool selected, L1L2Rng *rng, bool *inlier,
                                           bool *core)
{
    L1L2SelectedModel r = {.model = L1L2STAB_MOTION_SOURCE_NONE, .F = l1l2_mat_identity()};
    memset(core, false, (size_t)count * sizeof *core);
    for (int rung = (int)l->wanted; rung >= L1L2STAB_MOTION_MODEL_TRANSLATION; rung--) {
        const L1L2StabMotionModel model = (L1L2StabMotionModel)rung;
        const double threshold = (rung == L1L2STAB_MOTION_MODEL_TRANSLATION ? wider : 1.0) * l->threshold;
        int in_rows = 0;
        r.inliers = l1l2_ransac(model, pairs, say, count, threshold, rng, inlier, &r.F);
        if (rung == L1L2STAB_MOTION_MODEL_SIMILARITY && r.inliers < most_agree * count) {
            const L1L2ShutterRowTracks tracks = {pairs, say.votes, count, v->half_h, threshold, NULL};
            in_rows = l1l2_shutter_similarity_by_rows(&tracks, inlier, &r.F);
            r.inliers = in_rows > 0 ? in_rows : r.inliers;
        }
        if (!stands(l, model, v, pairs, count, inlier, &r) || !may_rise(l, model, r.inliers))
            continue;
        bool ambiguous;
        r.quality = quality(l, v, &r.F, pairs, say, count, rng, inlier, &ambiguous);
        l->agreed = selected ? r.quality : fmin(r.quality, l->agreed);
        r.quality = l->agreed;
        if (ambiguous)
            break;
        r.model = model_of[rung];
        if (in_rows > 0 || rung == L1L2STAB_MOTION_MODEL_TRANSLATION)
            memcpy(core, inlier, (size_t)count * sizeof *core);
        else
            sharpen(l, model, pairs, say, count, rng, inlier, core, &r.F);
        const double error = expected_error(l, v, &r, pairs, inlier, count);
        r.quality /= 1.0 + fmax(0.0, error / l->threshold - clear_error);
        r.F = significant_part(l, &r.F, error, v);
        hold_still(l, &r.F, error, v);
        l->rung = model;
        l->last = r.F;
        l->lost = 0;
        break;
    }
    return r;
}

L1L2SelectedModel l1l2_motion_model_adopt(L1L2ModelSelection *l, const L1L2Mat *F, int inliers, double quality)
{
    l->rung = L1L2STAB_MOTION_MODEL_SIMILARITY;
    l->waiting = l->lost = 0;
    l->last = *F;
    return (L1L2SelectedModel){
        .model = L1L2STAB_MOTION_SOURCE_SIMILARITY, .F = *F, .inliers = inliers, .quality = quality};
}

L1L2SelectedModel l1l2_motion_model_predict(L1L2ModelSelection *l)
{
    l->lost++;
    l->rung = l->wanted;
    l->waiting = 0;
    memset(&l->still, 0, sizeof l->still);
    for (int i = 0; i < 9; i++) {
        const double identity = i % 4 == 0 ? 1.0 : 0.0;
        l->last.m[i] = identity + prediction_fade * (l->last.m[i] - identity);
    }
    const bool fading = l->lost <= max_predicted;
    return (L1L2SelectedModel){.model = fading ? L1L2STAB_MOTION_SOURCE_PREDICTED : L1L2STAB_MOTION_SOURCE_IDENTITY,
                      .F = fading ? l->last : l1l2_mat_identity()};
}
