/* SPDX-License-Identifier: MIT */
/*
 * The public entry points and the state machine: Algorithm 1, one frame at a time.
 *
 *   push    motion.c: steps 1 and 2a, F_t, beside the caller: analysis.c
 *           path.c: steps 2b and 3, C_t and B_t, once the motion is there: settle()
 *   pull    wobble.c: step 4, warp.c: step 5
 *
 * States: open -> finished (finish) -> open (reset). Frames wait in the ring from push to pull.
 */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "common/clock.h"
#include "common/fade.h"
#include "common/log.h"
#include "common/mem.h"
#include "config.h"
#include "frame_check.h"
#include "frame_queue.h"
#include "info.h"
#include "motion/worker.h"
#include "path/path.h"
#include "rolling_shutter/filter.h"
#include "warp/warp.h"

struct L1L2Stab {
    L1L2StabConfig cfg;
    const L1L2FormatInfo *format;
    int out_width, out_height;
    L1L2Pool *pool;
    L1L2MotionWorker *analysis;
    L1L2Path *path;
    L1L2ShutterFilter *wobble;
    L1L2Warp *warp;
    L1L2FrameQueue ring;
    bool finished;
    int hurried;              /* of the held frames, the oldest, which are ready whatever comes */
    uint64_t pulled;          /* frames since create or reset */
    L1L2Mat camera, smooth;   /* C_t and P_t of the last pulled frame relative to its path's first: for display only */
    L1L2Fade bypass;
    double lambda, crop_ratio; /* of the frames that are pushed from now on */
    L1L2StabResult error;     /* the first that measuring met and l1l2stab_take_error() has not returned */
    double diagonal_px;
};

static L1L2StabResult build(L1L2Stab *s)
{
    const L1L2StabConfig *cfg = &s->cfg;
    const L1L2MotionConfig motion = {
        .format = s->format,
        .width = cfg->width,
        .height = cfg->height,
        .analysis_size = cfg->analysis_size,
        .model = cfg->motion_model,
        .rolling_shutter = cfg->rolling_shutter,
        .seed = cfg->seed,
        .log = &cfg->logger,
    };
    const L1L2PathConfig path = {
        .width = cfg->width,
        .height = cfg->height,
        .lambda = cfg->lambda,
        .frame_rate = cfg->frame_rate,
        .crop_ratio = cfg->crop_ratio,
        .window = cfg->window,
        .overlap = cfg->overlap,
        .join = cfg->join,
        .model = cfg->motion_model,
        .solver = cfg->solver,
        .weights = {cfg->weights[0], cfg->weights[1], cfg->weights[2]},
        .log = &cfg->logger,
    };
    const L1L2WarpConfig warp = {
        .format = s->format,
        .in_width = cfg->width,
        .in_height = cfg->height,
        .out_width = s->out_width,
        .out_height = s->out_height,
        .chroma_site = cfg->chroma_site,
        .interpolation = cfg->interpolation,
        .pool = s->pool,
    };
    const L1L2ShutterFilterConfig wobble = {cfg->rolling_shutter, cfg->width, cfg->height,
                                     s->out_width, s->out_height, cfg->window};
    if (!s->pool || !l1l2_frame_queue_init(&s->ring, cfg->window))
        return L1L2STAB_ERR_NOMEM;
    L1L2StabResult result = l1l2_motion_worker_create(&s->analysis, &motion, s->pool);
    if (result == L1L2STAB_OK)
        result = l1l2_path_create(&s->path, &path);
    if (result == L1L2STAB_OK)
        result = l1l2_warp_create(&s->warp, &warp);
    if (result == L1L2STAB_OK)
        result = l1l2_shutter_filter_create(&s->wobble, &wobble);
    return result;
}

L1L2StabResult l1l2stab_create(L1L2Stab **out, const L1L2StabConfig *cfg)
{
    L1L2StabConfig resolved;
    if (!out)
        return L1L2STAB_ERR_ARGUMENT;
    *out = NULL;
    L1L2StabResult result = l1l2_config_resolve(cfg, &resolved);
    if (result != L1L2STAB_OK)
        return result;
    L1L2Stab *s = l1l2_mem_new(1, sizeof *s);
    if (!s)
        return L1L2STAB_ERR_NOMEM;
    s->cfg = resolved;
    s->format = l1l2_image_format_info(resolved.format);
    s->pool = l1l2_pool_create(resolved.threads);
    s->lambda = resolved.lambda;
    s->crop_ratio = resolved.crop_ratio;
    s->diagonal_px = hypot(resolved.width, resolved.height);
    s->bypass.length = L1L2STAB_BYPASS_FRAMES;
    l1l2_config_output_size(&resolved, &s->out_width, &s->out_height);
    result = build(s);
    if (result != L1L2STAB_OK) {
        l1l2_log(&resolved.logger, L1L2STAB_LOG_ERROR, "create: %s", l1l2stab_strerror(result));
        l1l2stab_free(&s);
        return result;
    }
    l1l2stab_reset(s);
    *out = s;
    return L1L2STAB_OK;
}

void l1l2stab_free(L1L2Stab **s)
{
    if (!s || !*s)
        return;
    l1l2_motion_worker_free((*s)->analysis); /* it may be reading a frame */
    l1l2_frame_queue_clear(&(*s)->ring);
    l1l2_path_free((*s)->path);
    l1l2_shutter_filter_free((*s)->wobble);
    l1l2_warp_free((*s)->warp);
    l1l2_pool_free((*s)->pool);
    l1l2_mem_free(*s);
    *s = NULL;
}

void l1l2stab_reset(L1L2Stab *s)
{
    if (!s)
        return;
    l1l2_motion_worker_reset(s->analysis);
    l1l2_frame_queue_drop_all(&s->ring);
    l1l2_path_reset(s->path);
    l1l2_shutter_filter_reset(s->wobble);
    s->finished = false;
    s->hurried = 0;
    s->pulled = 0;
    s->error = L1L2STAB_OK;
    l1l2_fade_next(&s->bypass, true);
}

/* The frames between given motions are not tracked: a measured one after them starts from nothing. */
static L1L2MotionResult given_motion(L1L2Stab *s, bool starts_path)
{
    l1l2_motion_worker_reset(s->analysis);
    return (L1L2MotionResult){
        .F = l1l2_mat_identity(),
        .model = starts_path ? L1L2STAB_MOTION_SOURCE_NONE : L1L2STAB_MOTION_SOURCE_GIVEN,
        .quality = starts_path ? 0.0 : 1.0,
    };
}

/* Steps 2b and 3 for the newest frame, whose motion is known. The path is made of the motion that info tells, to the
 * bit: whoever gives it back gets the same path. given_px: that motion, if it was given. */
static void extend_path(L1L2Stab *s, L1L2QueuedFrame *held, const double *given_px)
{
    L1L2MotionResult *motion = &held->motion;
    if (motion->model == L1L2STAB_MOTION_SOURCE_GIVEN)
        memcpy(held->F_px, given_px, sizeof held->F_px);
    else
        l1l2_info_export(&motion->F, s->diagonal_px, held->F_px);
    memcpy(motion->F.m, held->F_px, sizeof held->F_px);
    motion->F = l1l2_mat_rescale(motion->F, 1.0 / s->diagonal_px);
    const int64_t start_ns = l1l2_clock_ns();
    l1l2_path_set_lambda(s->path, held->lambda);
    l1l2_path_set_crop_ratio(s->path, held->crop_ratio);
    l1l2_path_push(s->path, &motion->F, motion->model == L1L2STAB_MOTION_SOURCE_NONE);
    l1l2_shutter_filter_push(s->wobble, &motion->F, motion->has_residual ? &motion->residual : NULL,
                     motion->model == L1L2STAB_MOTION_SOURCE_NONE);
    l1l2_frame_queue_at(&s->ring, 0)->solve_ns += l1l2_clock_ns() - start_ns;
}

/* Waits for the newest frame's motion, if it is being measured, and extends the path by it. A frame that could not be
 * measured starts a path, so that no call but l1l2stab_take_error() has to return the error. */
static void settle(L1L2Stab *s)
{
    if (!l1l2_motion_worker_is_open(s->analysis))
        return;
    L1L2QueuedFrame *held = l1l2_frame_queue_at(&s->ring, s->ring.count - 1);
    const L1L2StabResult result = l1l2_motion_worker_take(s->analysis, &held->motion);
    if (result != L1L2STAB_OK) {
        l1l2_log(&s->cfg.logger, L1L2STAB_LOG_ERROR, "the motion of frame %llu could not be measured: %s. A new path"
                 " starts there", (unsigned long long)(s->pulled + (uint64_t)s->ring.count - 1),
                 l1l2stab_strerror(result));
        held->motion = (L1L2MotionResult){.F = l1l2_mat_identity(), .model = L1L2STAB_MOTION_SOURCE_NONE};
        held->failed = true;
        if (s->error == L1L2STAB_OK)
            s->error = result;
    }
    extend_path(s, held, NULL);
}

L1L2StabResult l1l2stab_take_error(L1L2Stab *s)
{
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    const L1L2StabResult error = s->error;
    s->error = L1L2STAB_OK;
    return error;
}

L1L2StabResult l1l2stab_set_lambda(L1L2Stab *s, double lambda)
{
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    L1L2StabConfig wanted = s->cfg;
    wanted.lambda = lambda;
    if (!l1l2_config_check_live(&wanted))
        return L1L2STAB_ERR_ARGUMENT;
    s->lambda = lambda;
    return L1L2STAB_OK;
}

L1L2StabResult l1l2stab_set_crop_ratio(L1L2Stab *s, double crop_ratio)
{
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    L1L2StabConfig wanted = s->cfg;
    wanted.crop_ratio = crop_ratio;
    if (!l1l2_config_check_live(&wanted))
        return L1L2STAB_ERR_ARGUMENT;
    s->crop_ratio = crop_ratio;
    return L1L2STAB_OK;
}

L1L2StabResult l1l2stab_set_bypass(L1L2Stab *s, int bypass)
{
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    s->bypass.on = bypass != 0;
    return L1L2STAB_OK;
}

static bool planes_given(const L1L2Stab *s, const L1L2StabFrame *frame)
{
    return l1l2_frame_has_planes(frame, s->format, &s->cfg.logger);
}

L1L2StabResult l1l2stab_push(L1L2Stab *s, const L1L2StabFrame *in)
{
    L1L2StabFrame frame;
    if (!s || !in)
        return L1L2STAB_ERR_ARGUMENT;
    const L1L2StabResult result = l1l2_frame_read(in, &frame, &s->cfg.logger);
    if (result != L1L2STAB_OK)
        return result;
    if (!(frame.motion ? l1l2_frame_has_motion(&frame, &s->cfg) : planes_given(s, &frame)))
        return L1L2STAB_ERR_ARGUMENT;
    if (s->finished)
        return L1L2STAB_ERR_STATE;
    if (s->ring.count == s->ring.capacity)
        return L1L2STAB_AGAIN;
    const bool starts_path = (frame.flags & L1L2STAB_FRAME_DISCONT) != 0 || s->ring.count + s->pulled == 0;
    settle(s);
    L1L2QueuedFrame *held = l1l2_frame_queue_append(&s->ring);
    *held = (L1L2QueuedFrame){.frame = frame, .lambda = s->lambda, .crop_ratio = s->crop_ratio};
    if (frame.motion) {
        held->motion = given_motion(s, starts_path);
        extend_path(s, held, frame.motion);
    } else {
        l1l2_motion_worker_begin(s->analysis, frame.data[0], frame.stride[0], starts_path);
    }
    return L1L2STAB_OK;
}

L1L2StabResult l1l2stab_hurry(L1L2Stab *s, int frames)
{
    if (!s || frames < 0)
        return L1L2STAB_ERR_ARGUMENT;
    if (frames > s->ring.count)
        frames = s->ring.count;
    if (frames <= s->hurried)
        return L1L2STAB_OK;
    settle(s);
    const int64_t start_ns = l1l2_clock_ns();
    l1l2_path_hurry(s->path, frames);
    l1l2_frame_queue_at(&s->ring, 0)->solve_ns += l1l2_clock_ns() - start_ns;
    s->hurried = frames;
    return L1L2STAB_OK;
}

L1L2StabResult l1l2stab_finish(L1L2Stab *s)
{
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    settle(s);
    if (!s->finished && s->ring.count > 0) {
        const int64_t start_ns = l1l2_clock_ns();
        l1l2_path_finish(s->path);
        l1l2_frame_queue_at(&s->ring, 0)->solve_ns += l1l2_clock_ns() - start_ns;
    }
    s->finished = true;
    return L1L2STAB_OK;
}

static L1L2StabResult readiness(const L1L2Stab *s)
{
    if (s->ring.count > 0 && (s->finished || s->hurried > 0 || s->ring.count == s->ring.capacity))
        return L1L2STAB_OK;
    return s->finished ? L1L2STAB_EOS : L1L2STAB_AGAIN;
}

L1L2StabResult l1l2stab_peek(const L1L2Stab *s, int64_t *pts, void **opaque)
{
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    const L1L2StabResult ready = readiness(s);
    if (ready != L1L2STAB_OK)
        return ready;
    const L1L2StabFrame *frame = &l1l2_frame_queue_at(&s->ring, 0)->frame;
    if (pts)
        *pts = frame->pts;
    if (opaque)
        *opaque = frame->opaque;
    return L1L2STAB_OK;
}

/* Output pixel to source pixel: B_t after the zoom that makes the crop window out of the output picture. */
static L1L2Mat warp_map(const L1L2Stab *s, const L1L2Mat *B, double crop_ratio)
{
    const bool fill = s->cfg.output_size == L1L2STAB_OUTPUT_SIZE_INPUT;
    const double zoom = fill ? crop_ratio : crop_ratio / s->cfg.crop_ratio;
    return l1l2_mat_mul(l1l2_mat_rescale(*B, s->diagonal_px), l1l2_mat_diagonal(zoom, zoom));
}

/* Whether C is within the range that is accumulated: a million diagonals, a zoom of a million either way. */
static bool is_displayable(const L1L2Mat *C)
{
    const double limit = 1e6;
    double most, least;
    l1l2_mat_stretch(C, &most, &least);
    return hypot(C->m[2], C->m[5]) <= limit && most <= limit && fabs(least) >= 1.0 / limit;
}

/* Takes the oldest frame's path out of path.c, and accumulates C_t and P_t. Mostly the path was decided long ago, and
 * the newest frame's motion can wait. */
static L1L2PathFrame fetch_path(L1L2Stab *s)
{
    L1L2PathFrame next;
    if (!l1l2_path_pull(s->path, &next)) {
        settle(s);
        const bool decided = l1l2_path_pull(s->path, &next);
        assert(decided);
        (void)decided;
    }
    l1l2_shutter_filter_pull(s->wobble);
    s->camera = next.path_index == 0 ? l1l2_mat_identity() : l1l2_mat_mul(s->camera, next.F);
    if (!is_displayable(&s->camera))
        s->camera = l1l2_mat_identity();
    s->smooth = l1l2_mat_mul(s->camera, next.B);
    return next;
}

L1L2StabResult l1l2stab_pull(L1L2Stab *s, L1L2StabFrame *out, L1L2StabInfo *info)
{
    L1L2StabFrame target;
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    const L1L2StabResult ready = readiness(s);
    if (ready != L1L2STAB_OK)
        return ready;
    if (out) {
        const L1L2StabResult result = l1l2_frame_read(out, &target, &s->cfg.logger);
        if (result != L1L2STAB_OK)
            return result;
        if (!planes_given(s, &target) || !planes_given(s, &l1l2_frame_queue_at(&s->ring, 0)->frame))
            return L1L2STAB_ERR_ARGUMENT;
    }
    const L1L2PathFrame next = fetch_path(s);
    const L1L2QueuedFrame *held = l1l2_frame_queue_at(&s->ring, 0);
    const L1L2Mat stable = warp_map(s, &next.B, next.crop_ratio), untouched = l1l2_mat_identity();
    const double bypass = l1l2_fade_next(&s->bypass, next.path_index == 0);
    const L1L2Mat map = l1l2_mat_mix(&stable, &untouched, bypass);
    const int64_t start_ns = l1l2_clock_ns();
    double residual_px;
    const L1L2WarpMap bent = {.affine = map,
                              .mesh = l1l2_shutter_filter_mesh(s->wobble, &map, 1.0 - bypass, &residual_px)};
    if (out) {
        l1l2_warp_render(s->warp, &bent, (const uint8_t *const *)held->frame.data, held->frame.stride, target.data,
                         target.stride);
        out->pts = held->frame.pts;
        out->opaque = held->frame.opaque;
    }
    if (info) {
        l1l2_info_describe(info, held, &next, s->diagonal_px);
        info->index = s->pulled;
        l1l2_info_export(&s->camera, s->diagonal_px, info->C);
        l1l2_info_export(&s->smooth, s->diagonal_px, info->P);
        memcpy(info->warp, map.m, sizeof map.m);
        info->bypass = bypass;
        info->residual = residual_px;
        info->readout = l1l2_shutter_filter_readout(s->wobble);
        info->stage_ns[L1L2STAB_STAGE_WARP] = out ? l1l2_clock_ns() - start_ns : 0;
    }
    s->hurried -= s->hurried > 0;
    s->pulled++;
    l1l2_frame_queue_drop_oldest(&s->ring);
    return L1L2STAB_OK;
}

int l1l2stab_threads(const L1L2Stab *s)
{
    return s ? l1l2_pool_threads(s->pool) : 0;
}

const char *l1l2stab_simd(void)
{
    return l1l2_warp_simd();
}
