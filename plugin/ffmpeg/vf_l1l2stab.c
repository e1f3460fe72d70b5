/* SPDX-License-Identifier: MIT */
/**
 * @file
 * A filter of libavfilter that stabilizes video with libl1l2stab, in one pass.
 *
 * This file is compiled within FFmpeg's source tree, from version 5.1 to 7.1. add-to-ffmpeg.sh puts it there.
 *
 * The library holds a window of frames by reference and emits them in their order. Each comes out with its own
 * properties: timestamp, color, side data. Where the size, the pixel aspect or the chroma location of the frames
 * changes, the held frames come out first. Then a new instance of the library starts.
 */

#include <l1l2stab/l1l2stab.h>

#include "libavutil/avconfig.h"
#include "libavutil/common.h"
#include "libavutil/eval.h"
#include "libavutil/frame.h"
#include "libavutil/log.h"
#include "libavutil/mathematics.h"
#include "libavutil/opt.h"
#include "libavutil/pixdesc.h"
#include "libavutil/version.h"

#include "avfilter.h"
#include "filters.h"
#include "formats.h"
#include "version.h"
#include "video.h"

/* FFmpeg 7.1 moved the frame rate of a link to another struct, and internal.h into filters.h. */
#define HAVE_FILTER_LINK (LIBAVFILTER_VERSION_INT >= AV_VERSION_INT(10, 2, 100))
#if !HAVE_FILTER_LINK
#include "internal.h"
#endif

/* Limits of the library. */
#define MAX_FRAME_RATE 1000.0
#define MIN_PIXEL_ASPECT 0.1
#define MAX_PIXEL_ASPECT 10.0
#define MAX_THREADS 64

static const AVRational nanoseconds = { 1, 1000000000 };

typedef struct L1L2StabContext {
    const AVClass *class;

    double lambda, crop_ratio;
    int bypass, window, overlap, join, motion_model, rolling_shutter, interpolation, output_size, border, fill_frames;
    char *region;          ///< as the user wrote it; NULL: the whole frame

    L1L2Stab *stab;        ///< NULL before the first frame
    L1L2StabConfig config; ///< of stab
    int width, height;     ///< of the frames that stab makes
    AVFrame *next;         ///< the first frame for the next instance: it waits until stab is empty
    int status;            ///< of the input, once it has ended and the library knows
    int64_t status_pts;
    int warned;            ///< that frames are interlaced
} L1L2StabContext;

#define OFFSET(x) offsetof(L1L2StabContext, x)
#define FLAGS (AV_OPT_FLAG_VIDEO_PARAM | AV_OPT_FLAG_FILTERING_PARAM)
#define COMMAND (FLAGS | AV_OPT_FLAG_RUNTIME_PARAM)
#define CHOICE(name, help, value, of) { name, help, 0, AV_OPT_TYPE_CONST, { .i64 = value }, 0, 0, FLAGS, .unit = of }

/* Names, ranges and defaults are those of the properties of the GStreamer element, with '_' for '-'. Every filter has
 * the option `threads` already. */
static const AVOption l1l2stab_options[] = {
    { "lambda", "how closely the result follows the camera: 0.1 is very smooth, 2 follows most of the shake",
      OFFSET(lambda), AV_OPT_TYPE_DOUBLE, { .dbl = 0.5 }, 0, 1000, COMMAND },
    { "crop_ratio", "part of the width and of the height that is shown; the rest is room for stabilization",
      OFFSET(crop_ratio), AV_OPT_TYPE_DOUBLE, { .dbl = 0.9 }, 0.5, 0.99, COMMAND },
    { "bypass", "show whole frames without stabilization, with the same delay",
      OFFSET(bypass), AV_OPT_TYPE_BOOL, { .i64 = 0 }, 0, 1, COMMAND },
    { "window", "number of frames that are optimized together, which is also the delay in frames",
      OFFSET(window), AV_OPT_TYPE_INT, { .i64 = 150 }, 4, 900, FLAGS },
    { "overlap", "number of frames that two windows share; 0 = a default that depends on join",
      OFFSET(overlap), AV_OPT_TYPE_INT, { .i64 = 0 }, 0, 899, FLAGS },
    { "join", "how the paths of two windows are joined", OFFSET(join), AV_OPT_TYPE_INT,
      { .i64 = L1L2STAB_JOIN_CONTINUOUS }, L1L2STAB_JOIN_CONTINUOUS, L1L2STAB_JOIN_BLEND, FLAGS, .unit = "join" },
        CHOICE("continuous", "the next window continues the path that was emitted", L1L2STAB_JOIN_CONTINUOUS, "join"),
        CHOICE("blend", "the paths are averaged where two windows overlap", L1L2STAB_JOIN_BLEND, "join"),
    { "motion_model", "the model of the camera's motion between two frames", OFFSET(motion_model), AV_OPT_TYPE_INT,
      { .i64 = L1L2STAB_MOTION_MODEL_SIMILARITY }, L1L2STAB_MOTION_MODEL_TRANSLATION, L1L2STAB_MOTION_MODEL_AFFINE,
      FLAGS, .unit = "motion_model" },
        CHOICE("translation", "the picture moves", L1L2STAB_MOTION_MODEL_TRANSLATION, "motion_model"),
        CHOICE("similarity", "it also rotates and changes its scale", L1L2STAB_MOTION_MODEL_SIMILARITY, "motion_model"),
        CHOICE("affine", "it is also sheared", L1L2STAB_MOTION_MODEL_AFFINE, "motion_model"),
    { "rolling_shutter", "how the wobble and skew of a rolling shutter are corrected",
      OFFSET(rolling_shutter), AV_OPT_TYPE_INT, { .i64 = L1L2STAB_ROLLING_SHUTTER_MIXTURE },
      L1L2STAB_ROLLING_SHUTTER_NONE, L1L2STAB_ROLLING_SHUTTER_MIXTURE, FLAGS, .unit = "rolling_shutter" },
        CHOICE("none", "no correction", L1L2STAB_ROLLING_SHUTTER_NONE, "rolling_shutter"),
        CHOICE("homography", "one homography per frame", L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY, "rolling_shutter"),
        CHOICE("mixture", "one homography per row", L1L2STAB_ROLLING_SHUTTER_MIXTURE, "rolling_shutter"),
    { "interpolation", "how pixels are interpolated; sharper methods take more time",
      OFFSET(interpolation), AV_OPT_TYPE_INT, { .i64 = L1L2STAB_INTERPOLATION_BICUBIC },
      L1L2STAB_INTERPOLATION_BILINEAR, L1L2STAB_INTERPOLATION_LANCZOS, FLAGS, .unit = "interpolation" },
        CHOICE("bilinear", "over 2x2 pixels", L1L2STAB_INTERPOLATION_BILINEAR, "interpolation"),
        CHOICE("bicubic", "over 4x4 pixels", L1L2STAB_INTERPOLATION_BICUBIC, "interpolation"),
        CHOICE("lanczos", "over 6x6 pixels", L1L2STAB_INTERPOLATION_LANCZOS, "interpolation"),
    { "output_size", "size of the output", OFFSET(output_size), AV_OPT_TYPE_INT,
      { .i64 = L1L2STAB_OUTPUT_SIZE_INPUT }, L1L2STAB_OUTPUT_SIZE_INPUT, L1L2STAB_OUTPUT_SIZE_CROP, FLAGS,
      .unit = "output_size" },
        CHOICE("input", "that of the input: the crop window is enlarged", L1L2STAB_OUTPUT_SIZE_INPUT, "output_size"),
        CHOICE("crop", "that of the crop window, in even numbers", L1L2STAB_OUTPUT_SIZE_CROP, "output_size"),
    { "border", "what is shown where the stabilized frame reaches beyond the source", OFFSET(border),
      AV_OPT_TYPE_INT, { .i64 = L1L2STAB_BORDER_CROP }, L1L2STAB_BORDER_CROP, L1L2STAB_BORDER_EXTEND, FLAGS,
      .unit = "border" },
        CHOICE("crop", "nothing: the crop window is shown", L1L2STAB_BORDER_CROP, "border"),
        CHOICE("fill", "what the frames before and after show there", L1L2STAB_BORDER_FILL, "border"),
        CHOICE("extend", "the frame mirrored at its sides", L1L2STAB_BORDER_EXTEND, "border"),
    { "fill_frames", "with border=fill: how many frames away the frames are that fill it, at most",
      OFFSET(fill_frames), AV_OPT_TYPE_INT, { .i64 = 30 }, 0, 120, FLAGS },
    { "region", "part of the frame that is measured: x,y,width,height in pixels, or with % signs in parts of it",
      OFFSET(region), AV_OPT_TYPE_STRING, { .str = NULL }, 0, 0, FLAGS },
    { NULL }
};

AVFILTER_DEFINE_CLASS(l1l2stab);

/* Formats of FFmpeg and the same of the library. VYUY, YV12, NV61, AV12, ARGB64 and ABGR64 have no counterpart here. */
static const struct {
    enum AVPixelFormat ff;
    L1L2StabFormat ours;
} formats[] = {
    { AV_PIX_FMT_YUV420P, L1L2STAB_FORMAT_I420 },
    { AV_PIX_FMT_YUVJ420P, L1L2STAB_FORMAT_I420 },
    { AV_PIX_FMT_NV12, L1L2STAB_FORMAT_NV12 },
    { AV_PIX_FMT_NV21, L1L2STAB_FORMAT_NV21 },
    { AV_PIX_FMT_YUV422P, L1L2STAB_FORMAT_Y42B },
    { AV_PIX_FMT_YUVJ422P, L1L2STAB_FORMAT_Y42B },
    { AV_PIX_FMT_NV16, L1L2STAB_FORMAT_NV16 },
    { AV_PIX_FMT_YUYV422, L1L2STAB_FORMAT_YUY2 },
    { AV_PIX_FMT_UYVY422, L1L2STAB_FORMAT_UYVY },
    { AV_PIX_FMT_YVYU422, L1L2STAB_FORMAT_YVYU },
    { AV_PIX_FMT_YUV444P, L1L2STAB_FORMAT_Y444 },
    { AV_PIX_FMT_YUVJ444P, L1L2STAB_FORMAT_Y444 },
    { AV_PIX_FMT_NV24, L1L2STAB_FORMAT_NV24 },
    { AV_PIX_FMT_YUV411P, L1L2STAB_FORMAT_Y41B },
    { AV_PIX_FMT_YUVJ411P, L1L2STAB_FORMAT_Y41B },
    { AV_PIX_FMT_YUVA420P, L1L2STAB_FORMAT_A420 },
    { AV_PIX_FMT_BGR0, L1L2STAB_FORMAT_BGRX },
    { AV_PIX_FMT_RGB0, L1L2STAB_FORMAT_RGBX },
    { AV_PIX_FMT_0RGB, L1L2STAB_FORMAT_XRGB },
    { AV_PIX_FMT_0BGR, L1L2STAB_FORMAT_XBGR },
    { AV_PIX_FMT_BGRA, L1L2STAB_FORMAT_BGRA },
    { AV_PIX_FMT_RGBA, L1L2STAB_FORMAT_RGBA },
    { AV_PIX_FMT_ARGB, L1L2STAB_FORMAT_ARGB },
    { AV_PIX_FMT_ABGR, L1L2STAB_FORMAT_ABGR },
    { AV_PIX_FMT_BGR24, L1L2STAB_FORMAT_BGR },
    { AV_PIX_FMT_RGB24, L1L2STAB_FORMAT_RGB },
    { AV_PIX_FMT_GBRP, L1L2STAB_FORMAT_GBR },
    { AV_PIX_FMT_GBRAP, L1L2STAB_FORMAT_GBRA },
    { AV_PIX_FMT_GRAY8, L1L2STAB_FORMAT_GRAY8 },
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(57, 36, 100)
    { AV_PIX_FMT_VUYA, L1L2STAB_FORMAT_VUYA },
    { AV_PIX_FMT_VUYX, L1L2STAB_FORMAT_VUYA },
#endif
/* The library reads components of 16 bits in the byte order of the processor. */
#if !AV_HAVE_BIGENDIAN
    { AV_PIX_FMT_YUV420P10LE, L1L2STAB_FORMAT_I420_10LE },
    { AV_PIX_FMT_YUV420P12LE, L1L2STAB_FORMAT_I420_12LE },
    { AV_PIX_FMT_YUV422P10LE, L1L2STAB_FORMAT_I422_10LE },
    { AV_PIX_FMT_YUV422P12LE, L1L2STAB_FORMAT_I422_12LE },
    { AV_PIX_FMT_YUV444P10LE, L1L2STAB_FORMAT_Y444_10LE },
    { AV_PIX_FMT_YUV444P12LE, L1L2STAB_FORMAT_Y444_12LE },
    { AV_PIX_FMT_YUV444P16LE, L1L2STAB_FORMAT_Y444_16LE },
    { AV_PIX_FMT_YUVA420P10LE, L1L2STAB_FORMAT_A420_10LE },
    { AV_PIX_FMT_YUVA422P10LE, L1L2STAB_FORMAT_A422_10LE },
    { AV_PIX_FMT_YUVA444P10LE, L1L2STAB_FORMAT_A444_10LE },
    { AV_PIX_FMT_P010LE, L1L2STAB_FORMAT_P010_10LE },
#if LIBAVUTIL_VERSION_INT >= AV_VERSION_INT(57, 36, 100)
    { AV_PIX_FMT_P012LE, L1L2STAB_FORMAT_P012_LE },
#endif
    { AV_PIX_FMT_P016LE, L1L2STAB_FORMAT_P016_LE },
    { AV_PIX_FMT_GBRP10LE, L1L2STAB_FORMAT_GBR_10LE },
    { AV_PIX_FMT_GBRP12LE, L1L2STAB_FORMAT_GBR_12LE },
    { AV_PIX_FMT_GBRAP10LE, L1L2STAB_FORMAT_GBRA_10LE },
    { AV_PIX_FMT_GBRAP12LE, L1L2STAB_FORMAT_GBRA_12LE },
    { AV_PIX_FMT_RGBA64LE, L1L2STAB_FORMAT_RGBA64_LE },
    { AV_PIX_FMT_BGRA64LE, L1L2STAB_FORMAT_BGRA64_LE },
    { AV_PIX_FMT_AYUV64LE, L1L2STAB_FORMAT_AYUV64 },
    { AV_PIX_FMT_GRAY16LE, L1L2STAB_FORMAT_GRAY16_LE },
#endif
};

static L1L2StabFormat find_format(int ff)
{
    for (int i = 0; i < FF_ARRAY_ELEMS(formats); i++)
        if (formats[i].ff == ff)
            return formats[i].ours;
    return L1L2STAB_FORMAT_UNKNOWN;
}

static int query_formats(AVFilterContext *ctx)
{
    int list[FF_ARRAY_ELEMS(formats) + 1];

    for (int i = 0; i < FF_ARRAY_ELEMS(formats); i++)
        list[i] = formats[i].ff;
    list[FF_ARRAY_ELEMS(formats)] = AV_PIX_FMT_NONE;
    return ff_set_common_formats_from_list(ctx, list);
}

static const struct {
    L1L2StabLogLevel ours;
    int av;
} levels[] = {
    { L1L2STAB_LOG_ERROR, AV_LOG_ERROR },
    { L1L2STAB_LOG_WARN, AV_LOG_WARNING },
    { L1L2STAB_LOG_INFO, AV_LOG_VERBOSE },
    { L1L2STAB_LOG_DEBUG, AV_LOG_DEBUG },
    { L1L2STAB_LOG_TRACE, AV_LOG_TRACE },
};

static void write_message(void *ctx, L1L2StabLogLevel level, const char *message)
{
    for (int i = 0; i < FF_ARRAY_ELEMS(levels); i++)
        if (levels[i].ours == level)
            av_log(ctx, levels[i].av, "%s\n", message);
}

static L1L2StabLogger make_logger(AVFilterContext *ctx)
{
    L1L2StabLogger logger = { .write = write_message, .cookie = ctx, .max_level = L1L2STAB_LOG_ERROR };

    for (int i = 0; i < FF_ARRAY_ELEMS(levels); i++)
        if (levels[i].av <= av_log_get_level())
            logger.max_level = levels[i].ours;
    return logger;
}

/* The library has logged the reason. */
static int error_code(L1L2StabResult result)
{
    switch (result) {
    case L1L2STAB_OK:
    case L1L2STAB_AGAIN:
    case L1L2STAB_EOS:
        return 0;
    case L1L2STAB_ERR_ARGUMENT:
        return AVERROR(EINVAL);
    case L1L2STAB_ERR_UNSUPPORTED:
        return AVERROR(ENOSYS);
    case L1L2STAB_ERR_NOMEM:
        return AVERROR(ENOMEM);
    case L1L2STAB_ERR_BACKEND:
        return AVERROR_EXTERNAL;
    default:
        return AVERROR_BUG;
    }
}

static L1L2StabChromaSite chroma_site(enum AVChromaLocation location)
{
    switch (location) {
    case AVCHROMA_LOC_CENTER:
    case AVCHROMA_LOC_TOP:
    case AVCHROMA_LOC_BOTTOM:
        return L1L2STAB_CHROMA_SITE_CENTER;
    case AVCHROMA_LOC_TOPLEFT:
        return L1L2STAB_CHROMA_SITE_TOP_LEFT;
    default:
        return L1L2STAB_CHROMA_SITE_LEFT;
    }
}

/* A wrong value must not stop the stream: it counts as square pixels. */
static double pixel_aspect(AVRational aspect)
{
    const double ratio = aspect.num > 0 && aspect.den > 0 ? av_q2d(aspect) : 1;

    return ratio >= MIN_PIXEL_ASPECT && ratio <= MAX_PIXEL_ASPECT ? ratio : 1;
}

static double frame_rate(AVFilterLink *inlink)
{
#if HAVE_FILTER_LINK
    const AVRational rate = ff_filter_link(inlink)->frame_rate;
#else
    const AVRational rate = inlink->frame_rate;
#endif

    return rate.num > 0 && rate.den > 0 ? FFMIN(av_q2d(rate), MAX_FRAME_RATE) : 0;
}

/* Sets everything that does not depend on the frames. */
static void config_from_options(L1L2StabConfig *config, AVFilterContext *ctx)
{
    const L1L2StabContext *s = ctx->priv;

    l1l2stab_config_init(config, sizeof(*config));
    config->logger          = make_logger(ctx);
    config->lambda          = s->lambda;
    config->crop_ratio      = s->crop_ratio;
    config->window          = s->window;
    config->overlap         = s->overlap;
    config->join            = s->join;
    config->motion_model    = s->motion_model;
    config->rolling_shutter = s->rolling_shutter;
    config->interpolation   = s->interpolation;
    config->output_size     = s->output_size;
    config->border          = s->border;
    config->fill_frames     = s->fill_frames;
    config->threads         = av_clip(ff_filter_get_nb_threads(ctx), 1, MAX_THREADS);
    config->frame_rate      = frame_rate(ctx->inputs[0]);
}

static void config_from_frame(L1L2StabConfig *config, const AVFrame *frame)
{
    config->format       = find_format(frame->format);
    config->width        = frame->width;
    config->height       = frame->height;
    config->chroma_site  = chroma_site(frame->chroma_location);
    config->pixel_aspect = pixel_aspect(frame->sample_aspect_ratio);
}

/* The region in parts of the frame, whose size the config has. The library checks whether it lies in the frame. */
static int set_region(AVFilterContext *ctx, L1L2StabConfig *config)
{
    const L1L2StabContext *s = ctx->priv;
    const char *text = s->region;

    if (!text || !*text)
        return 0;
    for (int i = 0; i < 4; i++) {
        char *end;
        const double value = av_strtod(text, &end), side = i % 2 ? config->height : config->width;
        const int is_number = end != text, is_percent = *end == '%';

        config->region[i] = value / (is_percent ? 100 : side);
        end += is_percent;
        if (!is_number || *end != (i < 3 ? ',' : '\0')) {
            av_log(ctx, AV_LOG_ERROR, "region is \"%s\": give x,y,width,height as four numbers, in pixels of the frame "
                   "or with %% signs in parts of it, such as region='10%%,0,80%%,50%%'.\n", s->region);
            return AVERROR(EINVAL);
        }
        text = end + 1;
    }
    return 0;
}

static int fits(const L1L2StabContext *s, const AVFrame *frame)
{
    L1L2StabConfig other = s->config;

    config_from_frame(&other, frame);
    return other.format == s->config.format && other.width == s->config.width && other.height == s->config.height &&
           other.chroma_site == s->config.chroma_site && other.pixel_aspect == s->config.pixel_aspect;
}

/* Starts a new instance for frames like this one. */
static int start(AVFilterContext *ctx, const AVFrame *frame)
{
    L1L2StabContext *s = ctx->priv;
    L1L2StabResult result;
    int ret;

    l1l2stab_free(&s->stab);
    config_from_options(&s->config, ctx);
    config_from_frame(&s->config, frame);
    ret = set_region(ctx, &s->config);
    if (ret < 0)
        return ret;
    result = l1l2stab_config_output_size(&s->config, &s->width, &s->height);
    if (result == L1L2STAB_OK)
        result = l1l2stab_create(&s->stab, &s->config);
    if (result == L1L2STAB_OK)
        result = l1l2stab_set_bypass(s->stab, s->bypass);
    return error_code(result);
}

static void release_frame(void *opaque)
{
    AVFrame *frame = opaque;

    av_frame_free(&frame);
}

static void set_planes(L1L2StabFrame *planes, const AVFrame *frame)
{
    for (int i = 0; i < FF_ARRAY_ELEMS(planes->data); i++) {
        planes->data[i]   = frame->data[i];
        planes->stride[i] = frame->linesize[i];
    }
}

/* Hands the frame to the library, which keeps it until it has been rendered. Takes the frame. */
static int push(AVFilterContext *ctx, AVFrame *frame)
{
    const AVFilterLink *inlink = ctx->inputs[0];
    L1L2StabContext *s = ctx->priv;
    L1L2StabFrame in = { 0 };
    L1L2StabResult result;

    set_planes(&in, frame);
    in.pts = L1L2STAB_NO_PTS;
    if (frame->pts != AV_NOPTS_VALUE)
        in.pts = av_rescale_q(frame->pts, inlink->time_base, nanoseconds);
    in.opaque  = frame;
    in.release = release_frame;
    result = l1l2stab_push(s->stab, &in);
    if (result != L1L2STAB_OK) {
        av_frame_free(&frame);
        return result < 0 ? error_code(result) : AVERROR_BUG;
    }
    return error_code(l1l2stab_take_error(s->stab));
}

static void warn_interlaced(AVFilterContext *ctx, const AVFrame *frame)
{
    L1L2StabContext *s = ctx->priv;
#ifdef AV_FRAME_FLAG_INTERLACED
    const int interlaced = frame->flags & AV_FRAME_FLAG_INTERLACED;
#else
    const int interlaced = frame->interlaced_frame;
#endif

    if (interlaced && !s->warned) {
        av_log(ctx, AV_LOG_WARNING, "The frames are marked as interlaced. One motion cannot fit two fields: "
               "use bwdif or yadif before this filter, if they really are.\n");
        s->warned = 1;
    }
}

/* A frame from the input. If it needs another instance it is kept, and the present instance ends. Takes the frame. */
static int take_frame(AVFilterContext *ctx, AVFrame *frame)
{
    L1L2StabContext *s = ctx->priv;

    if (frame->format != ctx->inputs[0]->format) {
        av_log(ctx, AV_LOG_ERROR, "The pixel format changes to %s within the graph: use the format filter before.\n",
               av_get_pix_fmt_name(frame->format));
        av_frame_free(&frame);
        return AVERROR(EINVAL);
    }
    warn_interlaced(ctx, frame);
    if (s->stab && fits(s, frame))
        return push(ctx, frame);
    s->next = frame;
    l1l2stab_finish(s->stab);
    return 0;
}

/* The present instance is empty: the frame that waits starts the next one. */
static int start_next(AVFilterContext *ctx)
{
    L1L2StabContext *s = ctx->priv;
    AVFrame *frame = s->next;
    int ret = start(ctx, frame);

    s->next = NULL;
    if (ret >= 0)
        return push(ctx, frame);
    av_frame_free(&frame);
    return ret;
}

/* The link to the next filter keeps the size that it was configured with: scale and buffersink compare it with that of
 * each frame. */
static int emit(AVFilterContext *ctx, const AVFrame *source)
{
    AVFilterLink *outlink = ctx->outputs[0];
    L1L2StabContext *s = ctx->priv;
    L1L2StabFrame planes = { 0 };
    AVFrame *out = ff_get_video_buffer(outlink, s->width, s->height);
    int ret;

    if (!out)
        return AVERROR(ENOMEM);
    ret = av_frame_copy_props(out, source);
    if (ret >= 0) {
        set_planes(&planes, out);
        ret = error_code(l1l2stab_pull(s->stab, &planes, NULL));
    }
    if (ret < 0) {
        av_frame_free(&out);
        return ret;
    }
    outlink->sample_aspect_ratio = out->sample_aspect_ratio;
    return ff_filter_frame(outlink, out);
}

/* The frame that can be rendered next, or NULL. */
static const AVFrame *ready_frame(const L1L2StabContext *s)
{
    void *frame = NULL;

    if (s->stab)
        l1l2stab_peek(s->stab, NULL, &frame);
    return frame;
}

static void drop_all(L1L2StabContext *s)
{
    av_frame_free(&s->next);
    l1l2stab_free(&s->stab);
}

static int activate(AVFilterContext *ctx)
{
    AVFilterLink *inlink = ctx->inputs[0], *outlink = ctx->outputs[0];
    L1L2StabContext *s = ctx->priv;
    AVFrame *frame = NULL;
    int ret = ff_outlink_get_status(outlink);

    if (ret) {
        drop_all(s);
        ff_inlink_set_status(inlink, ret);
        return 0;
    }
    for (;;) {
        const AVFrame *source = ready_frame(s);

        if (source)
            return ff_outlink_frame_wanted(outlink) ? emit(ctx, source) : FFERROR_NOT_READY;
        if (s->next) {
            ret = start_next(ctx);
        } else if (s->status) {
            ff_outlink_set_status(outlink, s->status, s->status_pts);
            return 0;
        } else if ((ret = ff_inlink_consume_frame(inlink, &frame)) > 0) {
            ret = take_frame(ctx, frame);
        } else if (ret == 0 && ff_inlink_acknowledge_status(inlink, &s->status, &s->status_pts)) {
            l1l2stab_finish(s->stab);
        } else if (ret == 0) {
            FF_FILTER_FORWARD_WANTED(outlink, inlink);
            return FFERROR_NOT_READY;
        }
        if (ret < 0)
            return ret;
    }
}

/* Also checks the options, before the first frame comes. */
static int config_output(AVFilterLink *outlink)
{
    AVFilterContext *ctx = outlink->src;
    const AVFilterLink *inlink = ctx->inputs[0];
    L1L2StabConfig config;

    config_from_options(&config, ctx);
    config.format = find_format(inlink->format);
    config.width  = inlink->w;
    config.height = inlink->h;
    return error_code(l1l2stab_config_output_size(&config, &outlink->w, &outlink->h));
}

static int process_command(AVFilterContext *ctx, const char *cmd, const char *args, char *res, int res_len, int flags)
{
    L1L2StabContext *s = ctx->priv;
    L1L2StabResult result = L1L2STAB_OK;
    int ret = ff_filter_process_command(ctx, cmd, args, res, res_len, flags);

    if (ret < 0 || !s->stab)
        return ret;
    result = l1l2stab_set_lambda(s->stab, s->lambda);
    if (result == L1L2STAB_OK)
        result = l1l2stab_set_crop_ratio(s->stab, s->crop_ratio);
    if (result == L1L2STAB_OK)
        result = l1l2stab_set_bypass(s->stab, s->bypass);
    return error_code(result);
}

static av_cold void uninit(AVFilterContext *ctx)
{
    drop_all(ctx->priv);
}

static const AVFilterPad inputs[] = {
    {
        .name = "default",
        .type = AVMEDIA_TYPE_VIDEO,
    },
};

static const AVFilterPad outputs[] = {
    {
        .name         = "default",
        .type         = AVMEDIA_TYPE_VIDEO,
        .config_props = config_output,
    },
};

const AVFilter ff_vf_l1l2stab = {
    .name            = "l1l2stab",
    .description     = NULL_IF_CONFIG_SMALL("Stabilize video in one pass with L1-L2 optimal camera paths."),
    .priv_size       = sizeof(L1L2StabContext),
    .priv_class      = &l1l2stab_class,
    .uninit          = uninit,
    .activate        = activate,
    .process_command = process_command,
    /* The library has threads of its own. The flag says that their number follows the options for threads. */
    .flags           = AVFILTER_FLAG_SLICE_THREADS,
    FILTER_INPUTS(inputs),
    FILTER_OUTPUTS(outputs),
    FILTER_QUERY_FUNC(query_formats),
};
