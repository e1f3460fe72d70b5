/* SPDX-License-Identifier: MIT */
/*
 * The recursion. The residual of frame t is wanted as soon as the frames up to T are known, with e_{t-1} given, because
 * that frame has been emitted. The terms of the objective (filter.h) from frame j on, minimized over e_j ... e_T, are a
 * function of e_{j-1} alone, the cost-to-go V_j. It is quadratic:
 *
 *     V_j(e_{j-1}) = q_j |e_{j-1} - r_j|^2 + constant,     with q_{T+1} = 0.
 *
 * Proof by induction from j = T + 1 downward. Suppose it holds for j + 1. The terms that contain e_j are
 *
 *     w_j |e_j - (e_{j-1} + m_j)|^2  +  leak |e_j - k_j|^2 + q_{j+1} |e_j - r_{j+1}|^2.
 *
 * The last two are own |e_j - c|^2 + constant, with own = leak + q_{j+1} and c = (leak k_j + q_{j+1} r_{j+1}) / own.
 * What remains is a sum of two squares of e_j, whose minimum is at their weighted mean
 *
 *     e_j = (own c + w_j (e_{j-1} + m_j)) / (own + w_j)                                                    (1)
 *
 * and has the value w_j own / (w_j + own) |e_{j-1} + m_j - c|^2. That is the claim for j, with
 *
 *     q_j = w_j own / (w_j + own),     r_j = c - m_j.                                                      (2)
 *
 * So one backward pass of (2) from T to t + 1, and (1) for e_t. All weights are scalars, so each parameter of the
 * residual has the same q and its own r. At the start of a path w is 0: then e_t = c, whatever e_{t-1} was.
 *
 * With all w_j = 1 and leak = 0.03, q converges to 0.159, and frame j has 0.84^(j-t) of the influence of frame t: the
 * filter remembers about 1 / sqrt(leak) = 6 frames each way. A longer memory gathers the errors of the measured
 * changes; a shorter one leaves slow wobble.
 */
#include "rolling_shutter/filter.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "common/mem.h"
#include "rolling_shutter/mesh.h"
#include "rolling_shutter/readout.h"

/* Frames that the recursion reaches ahead, at most. Their influence has fallen to 0.84^40 = 0.1 % by then: half or
 * twice as many changed nothing in bench_shutter_parameters. */
enum { LOOKAHEAD = 40 };

_Static_assert((int)L1L2_SHUTTER_READOUT_FRAMES <= (int)L1L2_SHUTTER_FILTER_PAST + 1,
               "the readout is learned from more frames than are kept");

struct L1L2ShutterFilter {
    L1L2ShutterFilterConfig cfg;
    const L1L2ShutterParameters *parameters;
    L1L2ShutterModel model;
    L1L2WarpMesh mesh;
    int64_t pushed, pulled;
    L1L2ShutterResidual last;           /* e of the frame pulled last */
    L1L2ShutterResidual last_predicted; /* k of that frame */
    L1L2ShutterResidual emitted;        /* e of that frame after the limits */
    double explained[L1L2_VALIDATIONS], all[L1L2_VALIDATIONS]; /* faded sums over the frames pulled */
    L1L2ShutterReadout readout; /* learned with a mixture only */
};

static L1L2ShutterFrame *frame_at(const L1L2ShutterFilter *filter, int64_t t)
{
    return l1l2_frame_column_at(filter->cfg.frames, t);
}

static const L1L2Mat *motion_at(const L1L2ShutterFilter *filter, int64_t t)
{
    return l1l2_frame_column_at(filter->cfg.motions, t);
}

L1L2StabResult l1l2_shutter_filter_create(L1L2ShutterFilter **out, const L1L2ShutterFilterConfig *cfg)
{
    *out = NULL;
    if (cfg->model == L1L2STAB_ROLLING_SHUTTER_NONE)
        return L1L2STAB_OK;
    assert(cfg->motions.rows >= cfg->capacity + L1L2_SHUTTER_FILTER_PAST);
    assert(cfg->frames.rows >= cfg->capacity + L1L2_SHUTTER_FILTER_PAST);
    L1L2ShutterFilter *filter = l1l2_mem_new(1, sizeof *filter);
    if (!filter)
        return L1L2STAB_ERR_NOMEM;
    filter->cfg = *cfg;
    filter->cfg.pixel_aspect = cfg->pixel_aspect > 0.0 ? cfg->pixel_aspect : 1.0;
    const double shown_width = cfg->in_width * filter->cfg.pixel_aspect;
    const double diagonal_px = hypot(shown_width, cfg->in_height);
    filter->parameters = l1l2_shutter_parameters_or_default(cfg->parameters);
    filter->model = (L1L2ShutterModel){
        .kind = cfg->model,
        .half_w = 0.5 * shown_width / diagonal_px,
        .half_h = 0.5 * cfg->in_height / diagonal_px,
        .parameters = cfg->parameters,
    };
    if (!l1l2_warp_mesh_init(&filter->mesh, cfg->out_width, cfg->out_height)) {
        l1l2_shutter_filter_free(filter);
        return L1L2STAB_ERR_NOMEM;
    }
    l1l2_shutter_filter_reset(filter);
    *out = filter;
    return L1L2STAB_OK;
}

void l1l2_shutter_filter_free(L1L2ShutterFilter *filter)
{
    if (!filter)
        return;
    l1l2_warp_mesh_clear(&filter->mesh);
    l1l2_mem_free(filter);
}

static void forget_explained(L1L2ShutterFilter *filter)
{
    memset(filter->explained, 0, sizeof filter->explained);
    memset(filter->all, 0, sizeof filter->all);
}

void l1l2_shutter_filter_reset(L1L2ShutterFilter *filter)
{
    if (!filter)
        return;
    filter->pushed = filter->pulled = 0;
    memset(&filter->last, 0, sizeof filter->last);
    memset(&filter->last_predicted, 0, sizeof filter->last_predicted);
    memset(&filter->emitted, 0, sizeof filter->emitted);
    forget_explained(filter);
    filter->readout = (L1L2ShutterReadout){0};
}

/* Adds the newest frame that has enough frames after it to the estimate of the readout. */
static void learn_readout(L1L2ShutterFilter *filter)
{
    const int64_t t = filter->pushed - 1 - L1L2_SHUTTER_READOUT_DELAY;
    L1L2ShutterReadoutFrames around;
    if (t < L1L2_SHUTTER_READOUT_DELAY)
        return;
    for (int j = 0; j < L1L2_SHUTTER_READOUT_FRAMES; j++) {
        const int64_t u = t - L1L2_SHUTTER_READOUT_DELAY + j;
        if (frame_at(filter, u)->weight < 1.0)
            return;
        around.F[j] = motion_at(filter, u);
        around.r[j] = &frame_at(filter, u)->measurement.r;
    }
    l1l2_shutter_readout_learn(&filter->readout, &around);
}

double l1l2_shutter_filter_readout(const L1L2ShutterFilter *filter)
{
    return filter ? l1l2_shutter_readout_estimate(&filter->readout, filter->parameters) : 0.0;
}

/*
 * k_t: the skew that the estimated readout predicts. A row is read at the time tau = readout * row after the frame's
 * own time, and the camera has moved until then by
 *
 *     tau v + tau^2 a / 2,
 *
 * where v is the mean of the motions into and out of the frame and a is their difference. The roll is linear in the
 * row. At the start of a path, and at the newest frame, one of the two motions is missing: the other stands for both.
 */
static L1L2ShutterResidual predict(const L1L2ShutterFilter *filter, int64_t t, double readout)
{
    L1L2ShutterResidual k = {{0.0}};
    if (readout == 0.0)
        return k;
    const int64_t next = t + 1 < filter->pushed ? t + 1 : t;
    const L1L2Mat *into = motion_at(filter, frame_at(filter, t)->weight > 0.0 ? t : next);
    const L1L2Mat *out = motion_at(filter, frame_at(filter, next)->weight > 0.0 ? next : t);
    const int entry[3] = {2, 5, 3}; /* of the matrix: x, y, sine of the roll */
    double velocity[3], acceleration[3];
    for (int i = 0; i < 3; i++) {
        velocity[i] = 0.5 * (into->m[entry[i]] + out->m[entry[i]]);
        acceleration[i] = out->m[entry[i]] - into->m[entry[i]];
        /* A caller may give any motion. From one that moves the frame by its diagonal or more, nothing is predicted. */
        if (!(fabs(velocity[i]) + fabs(acceleration[i]) < 2.0))
            return k;
    }
    for (int b = 0; b < L1L2_SHUTTER_BANDS; b++) {
        const double tau = readout * l1l2_shutter_band_row(b);
        k.p[L1L2_SHUTTER_X + b] = tau * velocity[0] + 0.5 * tau * tau * acceleration[0];
        k.p[L1L2_SHUTTER_Y + b] = tau * velocity[1] + 0.5 * tau * tau * acceleration[1];
    }
    k.p[L1L2_SHUTTER_ROLL_BY_ROW] = readout * velocity[2];
    return k;
}

void l1l2_shutter_filter_push(L1L2ShutterFilter *filter, const L1L2ShutterMeasurement *measurement, bool starts_path)
{
    if (!filter)
        return;
    assert(filter->pushed - filter->pulled < filter->cfg.capacity);
    L1L2ShutterFrame *frame = frame_at(filter, filter->pushed);
    memset(frame, 0, sizeof *frame);
    starts_path = starts_path || filter->pushed == 0;
    frame->measured = measurement && !starts_path && l1l2_shutter_residual_is_finite(&measurement->r);
    frame->weight = starts_path ? 0.0 : frame->measured ? 1.0 : filter->parameters->unmeasured_weight;
    if (frame->measured)
        frame->measurement = *measurement;
    filter->pushed++;
    if (filter->model.kind == L1L2STAB_ROLLING_SHUTTER_MIXTURE)
        learn_readout(filter);
}

/* The confidence in the measured changes around frame t, [0, 1]: the least of the validation tests'. Each test takes
 * the part that it explains of the frames before t and of those up to `last`, with weights that fade with the
 * distance. */
static double confidence(const L1L2ShutterFilter *filter, int64_t t, int64_t last)
{
    const L1L2ShutterParameters *parameters = filter->parameters;
    const struct {
        int test;
        L1L2ShutterRamp ramp;
    } gates[] = {
        {L1L2_SPLIT_HALVES, parameters->halves},
        {L1L2_SPLIT_COLUMNS, parameters->columns},
        {L1L2_VALIDATION_CAMERA, parameters->camera},
    };
    double least = 1.0;
    for (int k = 0; k < (int)(sizeof gates / sizeof *gates); k++) {
        const int test = gates[k].test;
        double explained = filter->explained[test], all = filter->all[test], fade = 1.0;
        for (int64_t j = t; j <= last; j++, fade *= parameters->confidence_fade) {
            explained += fade * frame_at(filter, j)->measurement.explained[test];
            all += fade * frame_at(filter, j)->measurement.all[test];
        }
        least = fmin(least, all > 0.0 ? l1l2_shutter_ramp(explained / all, gates[k].ramp) : 0.0);
    }
    return least;
}

/* e_t, by the recursion at the top of this file. The change m_j of a frame is the measured one as far as there is
 * confidence in it, and for the rest the predicted one, k_j - k_{j-1}. */
static L1L2ShutterResidual estimate(const L1L2ShutterFilter *filter, int64_t t)
{
    const int size = l1l2_shutter_model_size(&filter->model);
    const double readout = l1l2_shutter_filter_readout(filter), leak = filter->parameters->leak;
    const int64_t farthest = t + LOOKAHEAD;
    int64_t last = t; /* of the path, as far as it is known and matters */
    while (last + 1 < filter->pushed && last < farthest && frame_at(filter, last + 1)->weight > 0.0)
        last++;
    const double trusted = confidence(filter, t, last);
    double q = 0.0;
    L1L2ShutterResidual k = predict(filter, last, readout), r = {{0.0}}, e = {{0.0}};
    for (int64_t j = last; j >= t; j--) {
        const L1L2ShutterFrame *frame = frame_at(filter, j);
        const L1L2ShutterResidual before = j > t ? predict(filter, j - 1, readout) : filter->last_predicted;
        const double own = leak + q, measured = frame->measured ? trusted : 0.0;
        for (int p = 0; p < size; p++) {
            const double c = (leak * k.p[p] + q * r.p[p]) / own;
            const double m = measured * frame->measurement.r.p[p] + (1.0 - measured) * (k.p[p] - before.p[p]);
            if (j == t)
                e.p[p] = (own * c + frame->weight * (filter->last.p[p] + m)) / (own + frame->weight);
            r.p[p] = c - m;
        }
        q = frame->weight * own / (frame->weight + own);
        k = before;
    }
    return e;
}

/* Scales a residual down that displaces or stretches the frame by more than it may. */
static L1L2ShutterResidual limited(const L1L2ShutterFilter *filter, L1L2ShutterResidual e)
{
    const double excess = fmax(l1l2_shutter_residual_reach(&filter->model, &e) / filter->parameters->max_reach,
                               l1l2_shutter_residual_stretch(&filter->model, &e) / filter->parameters->max_stretch);
    for (int p = 0; p < L1L2_SHUTTER_SIZE && excess > 1.0; p++)
        e.p[p] /= excess;
    return e;
}

const L1L2ShutterResidual *l1l2_shutter_filter_pull(L1L2ShutterFilter *filter)
{
    if (!filter)
        return NULL;
    assert(filter->pulled < filter->pushed);
    const L1L2ShutterFrame *now = frame_at(filter, filter->pulled);
    if (now->weight == 0.0)
        forget_explained(filter);
    filter->last = estimate(filter, filter->pulled);
    filter->last_predicted = predict(filter, filter->pulled, l1l2_shutter_filter_readout(filter));
    filter->emitted = limited(filter, filter->last);
    for (int k = 0; k < L1L2_VALIDATIONS; k++) {
        const double fade = filter->parameters->confidence_fade;
        filter->explained[k] = fade * (filter->explained[k] + now->measurement.explained[k]);
        filter->all[k] = fade * (filter->all[k] + now->measurement.all[k]);
    }
    filter->pulled++;
    return &filter->emitted;
}

const L1L2WarpMesh *l1l2_shutter_filter_mesh(L1L2ShutterFilter *filter, const L1L2Mat *map, double part,
                                             double *reach_px)
{
    *reach_px = 0.0;
    if (!filter)
        return NULL;
    L1L2ShutterResidual residual = filter->emitted;
    for (int p = 0; p < L1L2_SHUTTER_SIZE; p++)
        residual.p[p] *= part;
    const L1L2ShutterSource source = {filter->cfg.in_width, filter->cfg.in_height, filter->cfg.pixel_aspect,
                                      filter->cfg.may_leave};
    const double reach = l1l2_shutter_mesh_set(&filter->mesh, map, &filter->model, &residual, &source);
    if (!(reach > 0.0))
        return NULL;
    *reach_px = reach;
    return &filter->mesh;
}
