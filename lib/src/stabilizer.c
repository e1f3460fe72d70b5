/* SPDX-License-Identifier: MIT */
/*
 * The public entry points and the state machine: Algorithm 1, one frame at a time.
 *
 *   push    motion/worker.c: steps 1 and 2a, the motion F_t, beside the caller
 *           path/path.c: steps 2b and 3, C_t and B_t, once the motion is known: settle()
 *   pull    rolling_shutter/filter.c: step 4, warp/warp.c: step 5, or border/border.c, which crops nothing
 *
 * States: open -> finished (finish) -> open (reset). A frame waits in the queue from push to pull. Its record there has
 * all that is known of it. Motions are in diagonals from the moment that they are known; units.h converts for the
 * caller.
 */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "border/border.h"
#include "common/clock.h"
#include "common/fade.h"
#include "common/log.h"
#include "common/mem.h"
#include "config.h"
#include "frame_check.h"
#include "frame_queue.h"
#include "frame_time.h"
#include "info.h"
#include "motion/worker.h"
#include "neighbors_of.h"
#include "path/path.h"
#include "rolling_shutter/filter.h"
#include "units.h"
#include "warp/warp.h"

struct L1L2Stab {
    L1L2StabConfig cfg;
    const L1L2FormatInfo *format;
    int out_width, out_height;
    double diagonal_px;        /* of the frame as it is shown */
    L1L2Pool *pool;
    L1L2MotionWorker *worker;
    L1L2Path *path;
    L1L2ShutterFilter *filter;
    L1L2Warp *warp;
    L1L2Border *border;        /* NULL: the picture is cropped */
    L1L2BorderNeighbor *neighbors; /* room for those of one frame */
    bool border_rendered;      /* the border has a map of a frame's pixels */
    L1L2FrameQueue queue;
    L1L2FrameTime time;        /* of the frame pushed last */
    bool finished;
    int hurried;               /* number of the oldest held frames that are ready although the window is not full */
    L1L2StabResult error;      /* of measuring: the first that l1l2stab_take_error() has not yet returned */
    L1L2Mat camera, smooth;    /* C_t and P_t of the frame pulled last relative to its path's first: for display only */
    L1L2Fade bypass;
    double lambda, crop_ratio; /* of the frames that are pushed from now on */
};

/* Neighbors are at most so many frames away. */
static int reach_of(const L1L2StabConfig *cfg)
{
    return cfg->border == L1L2STAB_BORDER_FILL ? cfg->fill_frames : 0;
}

static L1L2StabResult build_border(L1L2Stab *s)
{
    const L1L2StabConfig *cfg = &s->cfg;
    const L1L2BorderConfig border = {
        .format = s->format,
        .width = cfg->width,
        .height = cfg->height,
        .chroma_site = cfg->chroma_site,
        .reach = reach_of(cfg),
        .warp = s->warp,
        .pool = s->pool,
    };
    if (cfg->border == L1L2STAB_BORDER_CROP)
        return L1L2STAB_OK;
    s->border = l1l2_border_new(&border);
    s->neighbors = l1l2_mem_new((size_t)(2 * border.reach + 1), sizeof *s->neighbors);
    return s->border && s->neighbors ? L1L2STAB_OK : L1L2STAB_ERR_NOMEM;
}

static L1L2StabResult build(L1L2Stab *s)
{
    const L1L2StabConfig *cfg = &s->cfg;
    if (!s->pool || !l1l2_frame_queue_init(&s->queue, cfg->window, reach_of(cfg)))
        return L1L2STAB_ERR_NOMEM;
    const L1L2MeasuredArea area = {
        .region = {cfg->region[0], cfg->region[1], cfg->region[2], cfg->region[3]},
        .mask = cfg->mask,
        .mask_stride = cfg->mask_stride,
        .mask_width = cfg->mask_width,
        .mask_height = cfg->mask_height,
    };
    const L1L2MotionConfig motion = {
        .format = s->format,
        .width = cfg->width,
        .height = cfg->height,
        .analysis_size = cfg->analysis_size,
        .model = cfg->motion_model,
        .rolling_shutter = cfg->rolling_shutter,
        .seed = cfg->seed,
        .pixel_aspect = cfg->pixel_aspect,
        .area = &area,
        .log = &cfg->logger,
    };
    const L1L2PathConfig path = {
        .width = cfg->width * cfg->pixel_aspect,
        .height = cfg->height,
        .frame_rate = cfg->frame_rate,
        .window = cfg->window,
        .overlap = cfg->overlap,
        .join = cfg->join,
        .model = cfg->motion_model,
        .solver = cfg->solver,
        .weights = {cfg->weights[0], cfg->weights[1], cfg->weights[2]},
        .fill_reach = reach_of(cfg),
        .fill_margin = L1L2_BORDER_MARGIN_PX / s->diagonal_px,
        .log = &cfg->logger,
        .frames = l1l2_frame_queue_path_frames(&s->queue),
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
    const L1L2ShutterFilterConfig filter = {
        .model = cfg->rolling_shutter,
        .in_width = cfg->width,
        .in_height = cfg->height,
        .out_width = s->out_width,
        .out_height = s->out_height,
        .capacity = cfg->window,
        .motions = l1l2_frame_queue_motions(&s->queue),
        .frames = l1l2_frame_queue_shutter_frames(&s->queue),
        .pixel_aspect = cfg->pixel_aspect,
        .may_leave = cfg->border != L1L2STAB_BORDER_CROP,
    };
    L1L2StabResult result = l1l2_motion_worker_create(&s->worker, &motion, s->pool);
    if (result == L1L2STAB_OK)
        result = l1l2_path_create(&s->path, &path);
    if (result == L1L2STAB_OK)
        result = l1l2_warp_create(&s->warp, &warp);
    if (result == L1L2STAB_OK)
        result = l1l2_shutter_filter_create(&s->filter, &filter);
    return result == L1L2STAB_OK ? build_border(s) : result;
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
    s->diagonal_px = hypot(resolved.width * resolved.pixel_aspect, resolved.height);
    s->bypass.length = L1L2STAB_BYPASS_FRAMES;
    l1l2_config_output_size(&resolved, &s->out_width, &s->out_height);
    result = build(s);
    s->cfg.mask = NULL; /* the caller's, who may free it now */
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
    l1l2_motion_worker_free((*s)->worker); /* it may be reading a frame */
    l1l2_frame_queue_clear(&(*s)->queue);
    l1l2_path_free((*s)->path);
    l1l2_shutter_filter_free((*s)->filter);
    l1l2_border_free((*s)->border);
    l1l2_mem_free((*s)->neighbors);
    l1l2_warp_free((*s)->warp);
    l1l2_pool_free((*s)->pool);
    l1l2_mem_free(*s);
    *s = NULL;
}

void l1l2stab_reset(L1L2Stab *s)
{
    if (!s)
        return;
    l1l2_motion_worker_reset(s->worker);
    l1l2_frame_queue_reset(&s->queue);
    s->time = l1l2_frame_time_start(s->cfg.frame_rate);
    l1l2_path_reset(s->path);
    l1l2_shutter_filter_reset(s->filter);
    if (s->border)
        l1l2_border_reset(s->border);
    s->border_rendered = false;
    s->finished = false;
    s->hurried = 0;
    s->error = L1L2STAB_OK;
    l1l2_fade_next(&s->bypass, true);
}

/* The time of solving a window is counted on the oldest frame. */
static void add_solve_time(L1L2Stab *s, int64_t start_ns)
{
    l1l2_frame_queue_oldest(&s->queue)->solve_ns += l1l2_clock_ns() - start_ns;
}

/* The record of the frame `back` frames before the newest. */
static L1L2QueuedFrame *record_before(L1L2Stab *s, int back)
{
    return l1l2_frame_queue_at(&s->queue, s->queue.end - 1 - back);
}

/* A bridge changed the motions of frames before the newest. Those that the path has not decided get their new motion;
 * the first of these, or the newest frame, makes up for what decided ones lack. Returns the newest frame's motion. */
static L1L2Mat amend_bridged(L1L2Stab *s, const L1L2MotionResult *motion)
{
    const int undecided = l1l2_path_undecided(s->path);
    L1L2Mat had = l1l2_mat_identity(), wanted = had, inverse;
    for (int i = 0; i < motion->bridged; i++) {
        const int back = motion->bridged - 1 - i; /* from the newest frame of the path, which is the one before ours */
        L1L2QueuedFrame *record = back < undecided ? record_before(s, back + 1) : NULL;
        wanted = l1l2_mat_mul(wanted, motion->bridged_F[i]);
        if (!record) {
            had = l1l2_mat_mul(had, l1l2_path_motion(s->path, back));
            continue;
        }
        l1l2_mat_inverse(had, &inverse);
        const L1L2Mat F = l1l2_mat_mul(inverse, wanted);
        l1l2_units_export(&F, s->diagonal_px, record->F_px);
        const L1L2Mat as_told = l1l2_units_import(record->F_px, s->diagonal_px);
        l1l2_path_amend(s->path, back, &as_told);
        record->bridged = true;
        had = wanted = l1l2_mat_identity();
    }
    l1l2_mat_inverse(had, &inverse);
    return l1l2_mat_mul(inverse, l1l2_mat_mul(wanted, motion->F));
}

/* Steps 2b and 3 for the newest frame, whose motion is known: in pixels in F_px, all else in *motion. */
static void extend_path(L1L2Stab *s, const L1L2MotionResult *motion, const double F_px[9])
{
    L1L2QueuedFrame *record = l1l2_frame_queue_newest(&s->queue);
    const L1L2Mat F = l1l2_units_import(F_px, s->diagonal_px);
    const L1L2PathInput input = {
        .F = &F,
        .starts_path = motion->model == L1L2STAB_MOTION_SOURCE_NONE,
        .lost = motion->model == L1L2STAB_MOTION_SOURCE_IDENTITY || motion->model == L1L2STAB_MOTION_SOURCE_PREDICTED,
        .lambda = record->lambda,
        .crop_ratio = record->crop_ratio,
        .step = record->step,
    };
    memcpy(record->F_px, F_px, sizeof record->F_px);
    record->source = motion->model;
    record->tracks = motion->tracks;
    record->inliers = motion->inliers;
    record->quality = motion->quality;
    record->scale_ns = motion->scale_ns;
    record->track_ns = motion->track_ns;
    record->fit_ns = motion->fit_ns;
    const int64_t start_ns = l1l2_clock_ns();
    l1l2_path_push(s->path, &input);
    l1l2_shutter_filter_push(s->filter, motion->has_residual ? &motion->residual : NULL, input.starts_path);
    add_solve_time(s, start_ns);
}

/* Extends the path by a frame whose motion the caller gave. Such frames are not tracked, so a measured frame after them
 * has no previous picture. */
static void extend_path_as_given(L1L2Stab *s, const double given_px[9], bool starts_path)
{
    const L1L2Mat none = l1l2_mat_identity();
    const L1L2MotionResult motion = {
        .model = starts_path ? L1L2STAB_MOTION_SOURCE_NONE : L1L2STAB_MOTION_SOURCE_GIVEN,
        .quality = starts_path ? 0.0 : 1.0,
    };
    l1l2_motion_worker_reset(s->worker);
    extend_path(s, &motion, starts_path ? none.m : given_px);
}

/* Waits for the newest frame's motion, if it is being measured, and extends the path by it. A frame that could not be
 * measured starts a path, so that no call but l1l2stab_take_error() has to return the error. */
static void settle(L1L2Stab *s)
{
    if (!l1l2_motion_worker_is_open(s->worker))
        return;
    L1L2MotionResult motion;
    const L1L2StabResult result = l1l2_motion_worker_take(s->worker, &motion);
    if (result != L1L2STAB_OK) {
        l1l2_log(&s->cfg.logger, L1L2STAB_LOG_ERROR,
                 "the motion of frame %lld could not be measured: %s. A new path starts there",
                 (long long)s->queue.end - 1, l1l2stab_strerror(result));
        motion = (L1L2MotionResult){.F = l1l2_mat_identity(), .model = L1L2STAB_MOTION_SOURCE_NONE};
        l1l2_frame_queue_newest(&s->queue)->failed = true;
        if (s->error == L1L2STAB_OK)
            s->error = result;
    }
    double F_px[9];
    if (motion.bridged > 0) {
        motion.F = amend_bridged(s, &motion);
        l1l2_frame_queue_newest(&s->queue)->bridged = true;
    }
    l1l2_units_export(&motion.F, s->diagonal_px, F_px);
    extend_path(s, &motion, F_px);
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
    if (l1l2_frame_queue_count(&s->queue) == s->queue.capacity)
        return L1L2STAB_AGAIN;
    const bool starts_path = (frame.flags & L1L2STAB_FRAME_DISCONT) != 0 || s->queue.end == 0;
    settle(s);
    L1L2QueuedFrame *record = l1l2_frame_queue_append(&s->queue);
    record->frame = frame;
    record->lambda = s->lambda;
    record->crop_ratio = s->crop_ratio;
    record->step = l1l2_frame_time_step(&s->time, frame.pts, starts_path);
    if (frame.motion)
        extend_path_as_given(s, frame.motion, starts_path);
    else
        l1l2_motion_worker_begin(s->worker, frame.data[0], frame.stride[0], starts_path);
    return L1L2STAB_OK;
}

L1L2StabResult l1l2stab_hurry(L1L2Stab *s, int frames)
{
    if (!s || frames < 0)
        return L1L2STAB_ERR_ARGUMENT;
    const int held = l1l2_frame_queue_count(&s->queue);
    if (frames > held)
        frames = held;
    if (frames <= s->hurried)
        return L1L2STAB_OK;
    settle(s);
    const int64_t start_ns = l1l2_clock_ns();
    l1l2_path_hurry(s->path, frames);
    add_solve_time(s, start_ns);
    s->hurried = frames;
    return L1L2STAB_OK;
}

/* At the end of the stream, frames that were kept for borders are not needed any more. */
static void release_at_end(L1L2Stab *s)
{
    if (s->finished && l1l2_frame_queue_count(&s->queue) == 0)
        l1l2_frame_queue_release_kept(&s->queue);
}

L1L2StabResult l1l2stab_finish(L1L2Stab *s)
{
    if (!s)
        return L1L2STAB_ERR_ARGUMENT;
    settle(s);
    if (!s->finished && l1l2_frame_queue_count(&s->queue) > 0) {
        const int64_t start_ns = l1l2_clock_ns();
        l1l2_path_finish(s->path);
        add_solve_time(s, start_ns);
    }
    s->finished = true;
    release_at_end(s);
    return L1L2STAB_OK;
}

static L1L2StabResult readiness(const L1L2Stab *s)
{
    const int held = l1l2_frame_queue_count(&s->queue);
    if (held > 0 && (s->finished || s->hurried > 0 || held == s->queue.capacity))
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
    const L1L2StabFrame *frame = &l1l2_frame_queue_oldest(&s->queue)->frame;
    if (pts)
        *pts = frame->pts;
    if (opaque)
        *opaque = frame->opaque;
    return L1L2STAB_OK;
}

/* Output pixel to source pixel, in samples: B_t after the zoom that makes the crop window out of the output picture. If
 * the border is not cropped there is no zoom. */
static L1L2Mat warp_map(const L1L2Stab *s, const L1L2Mat *B, double crop_ratio)
{
    const bool zooms = s->cfg.output_size == L1L2STAB_OUTPUT_SIZE_INPUT;
    const double zoom = s->border ? 1.0 : zooms ? crop_ratio : crop_ratio / s->cfg.crop_ratio;
    const L1L2Mat shown = l1l2_mat_mul(l1l2_mat_rescale(*B, s->diagonal_px), l1l2_mat_diagonal(zoom, zoom));
    return l1l2_mat_to_samples(shown, s->cfg.pixel_aspect);
}

/* Whether C is within the range that is accumulated: a million diagonals, a zoom of a million either way. */
static bool is_displayable(const L1L2Mat *C)
{
    const double limit = 1e6;
    double most, least;
    l1l2_mat_stretch(C, &most, &least);
    return hypot(C->m[2], C->m[5]) <= limit && most <= limit && fabs(least) >= 1.0 / limit;
}

/* Makes sure that the oldest frame's path is decided, and accumulates C_t and P_t. Usually it was decided long ago,
 * and there is no need to wait for the newest frame's motion. */
static void fetch_path(L1L2Stab *s)
{
    const L1L2PathFrame *next = l1l2_path_pull(s->path);
    if (!next) {
        settle(s);
        next = l1l2_path_pull(s->path);
    }
    assert(next == &l1l2_frame_queue_oldest(&s->queue)->path);
    l1l2_shutter_filter_pull(s->filter);
    s->camera = next->path_index == 0 ? l1l2_mat_identity() : l1l2_mat_mul(s->camera, next->F);
    if (!is_displayable(&s->camera))
        s->camera = l1l2_mat_identity();
    s->smooth = l1l2_mat_mul(s->camera, next->B);
}

/* Step 5. */
static L1L2BorderShares render(L1L2Stab *s, const L1L2WarpMap *map, const L1L2StabFrame *target)
{
    const L1L2StabFrame *frame = &l1l2_frame_queue_oldest(&s->queue)->frame;
    const uint8_t *const *src = (const uint8_t *const *)frame->data;
    if (!s->border) {
        l1l2_warp_render(s->warp, map, src, frame->stride, target->data, target->stride);
        return (L1L2BorderShares){0.0, 0.0};
    }
    const L1L2Geometry geometry = {s->diagonal_px, s->cfg.pixel_aspect};
    const int64_t known_end = s->queue.end - l1l2_motion_worker_is_open(s->worker);
    const L1L2BorderJob job = {
        .t = s->queue.begin,
        .own = map,
        .src = src,
        .src_stride = frame->stride,
        .dst = target->data,
        .dst_stride = target->stride,
        .neighbors = s->neighbors,
        .count = l1l2_neighbors_of_oldest(&s->queue, reach_of(&s->cfg), known_end, &geometry, s->neighbors),
    };
    s->border_rendered = true;
    return l1l2_border_render(s->border, &job);
}

L1L2StabResult l1l2stab_border_map(const L1L2Stab *s, uint8_t *map, ptrdiff_t stride)
{
    if (!s || !map)
        return L1L2STAB_ERR_ARGUMENT;
    if (!s->border_rendered)
        return L1L2STAB_ERR_STATE;
    const uint8_t *provider = l1l2_border_providers(s->border);
    for (int y = 0; y < s->out_height; y++)
        memcpy(map + y * stride, provider + (size_t)y * (size_t)s->out_width, (size_t)s->out_width);
    return L1L2STAB_OK;
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
        if (!planes_given(s, &target) || !planes_given(s, &l1l2_frame_queue_oldest(&s->queue)->frame))
            return L1L2STAB_ERR_ARGUMENT;
    }
    fetch_path(s);
    const L1L2QueuedFrame *record = l1l2_frame_queue_oldest(&s->queue);
    const L1L2Mat stable = warp_map(s, &record->path.B, record->path.crop_ratio), untouched = l1l2_mat_identity();
    const double bypass = l1l2_fade_next(&s->bypass, record->path.path_index == 0);
    const L1L2Mat map = l1l2_mat_mix(&stable, &untouched, bypass);
    const int64_t start_ns = l1l2_clock_ns();
    double residual_px;
    const L1L2WarpMap bent = {.affine = map,
                              .mesh = l1l2_shutter_filter_mesh(s->filter, &map, 1.0 - bypass, &residual_px)};
    L1L2BorderShares shares = {0.0, 0.0};
    if (out) {
        shares = render(s, &bent, &target);
        out->pts = record->frame.pts;
        out->opaque = record->frame.opaque;
    }
    if (info) {
        l1l2_info_describe(info, record, s->diagonal_px);
        info->index = (uint64_t)s->queue.begin;
        l1l2_units_export(&s->camera, s->diagonal_px, info->C);
        l1l2_units_export(&s->smooth, s->diagonal_px, info->P);
        memcpy(info->warp, map.m, sizeof map.m);
        info->bypass = bypass;
        info->residual = residual_px;
        info->filled = shares.filled;
        info->extended = shares.extended;
        info->readout = l1l2_shutter_filter_readout(s->filter);
        info->stage_ns[L1L2STAB_STAGE_WARP] = out ? l1l2_clock_ns() - start_ns : 0;
    }
    s->hurried -= s->hurried > 0;
    l1l2_frame_queue_drop_oldest(&s->queue);
    release_at_end(s);
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
