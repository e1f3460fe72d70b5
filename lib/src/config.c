/* SPDX-License-Identifier: MIT */
#include "config.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "border/neighbors.h"
#include "common/log.h"
#include "common/struct_size.h"

/* The overlap that 0 stands for. The window must have been checked. blend: the paper's. continuous: |DP| pulls the open
 * end of a window flat for some 40 frames; with K = 100 of N = 150 that does not reach emitted frames (docs/path.md has
 * the table). */
static int default_overlap(L1L2StabJoin join, int window)
{
    const int overlap = join == L1L2STAB_JOIN_BLEND ? window / 5 : window * 2 / 3;
    const int most = join == L1L2STAB_JOIN_BLEND ? window / 2 : window - 1;
    const int wanted = overlap < 3 ? 3 : overlap;
    return wanted < most ? wanted : most;
}

void l1l2stab_config_init(L1L2StabConfig *cfg, size_t struct_size)
{
    const L1L2StabConfig defaults = {
        .struct_size = struct_size,
        .lambda = 0.5,
        .crop_ratio = 0.9,
        .window = 150,
        .join = L1L2STAB_JOIN_CONTINUOUS,
        .interpolation = L1L2STAB_INTERPOLATION_BICUBIC,
        .output_size = L1L2STAB_OUTPUT_SIZE_INPUT,
        .analysis_size = 640,
        .seed = 1,
        .logger = {.max_level = L1L2STAB_LOG_INFO},
        .weights = {1.0, 1.0, 1.0},
        .motion_model = L1L2STAB_MOTION_MODEL_SIMILARITY,
        .rolling_shutter = L1L2STAB_ROLLING_SHUTTER_MIXTURE,
        .pixel_aspect = 1.0,
        .region = {0.0, 0.0, 1.0, 1.0},
        .fill_frames = 30,
    };
    if (!cfg || struct_size < sizeof cfg->struct_size)
        return;
    memset(cfg, 0, struct_size);
    memcpy(cfg, &defaults, struct_size < sizeof defaults ? struct_size : sizeof defaults);
}

static bool in_range(const L1L2StabConfig *cfg, const char *name, double value, double least, double most)
{
    if (value >= least && value <= most) /* false for NaN */
        return true;
    l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR, "%s is %g: choose a value from %g to %g", name, value, least, most);
    return false;
}

static bool weights_fit(const L1L2StabConfig *cfg)
{
    for (int i = 0; i < 3; i++)
        if (!(cfg->weights[i] > 0.0 && cfg->weights[i] <= 1000.0)) {
            l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR, "weights[%d] is %g: choose a value above 0, up to 1000", i,
                     cfg->weights[i]);
            return false;
        }
    return true;
}

static bool overlap_fits(const L1L2StabConfig *cfg)
{
    const bool blend = cfg->join == L1L2STAB_JOIN_BLEND;
    const int most = blend ? cfg->window / 2 : cfg->window - 1;
    if (cfg->overlap >= 3 && cfg->overlap <= most)
        return true;
    if (most < 3)
        l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR,
                 "window is %d: join=blend needs at least 6 frames, since the overlap is at least 3 and at most half",
                 cfg->window);
    else
        l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR,
                 "overlap is %d: with window=%d and join=%s choose from 3 to %d, or 0 for the default", cfg->overlap,
                 cfg->window, blend ? "blend" : "continuous", most);
    return false;
}

bool l1l2_config_check_live(const L1L2StabConfig *cfg)
{
    return in_range(cfg, "lambda", cfg->lambda, 0, 1000) && in_range(cfg, "crop_ratio", cfg->crop_ratio, 0.5, 0.99);
}

static bool region_fits(const L1L2StabConfig *cfg)
{
    const double *r = cfg->region, least = 1.0 / 8.0, rounding = 1e-9;
    if (r[0] >= 0.0 && r[1] >= 0.0 && r[2] >= least - rounding && r[3] >= least - rounding &&
        r[0] + r[2] <= 1.0 + rounding && r[1] + r[3] <= 1.0 + rounding) /* false for NaN */
        return true;
    l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR,
             "region is %g, %g, %g, %g: give x, y, width and height in parts of the frame's sides, within the frame, "
             "and width and height at least 1/8",
             r[0], r[1], r[2], r[3]);
    return false;
}

static bool mask_fits(const L1L2StabConfig *cfg)
{
    if (!cfg->mask)
        return true;
    if (!in_range(cfg, "mask_width", cfg->mask_width, 1, 16384) ||
        !in_range(cfg, "mask_height", cfg->mask_height, 1, 16384))
        return false;
    if (cfg->mask_stride >= cfg->mask_width)
        return true;
    l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR, "mask_stride is %td: it must be at least mask_width, which is %d",
             cfg->mask_stride, cfg->mask_width);
    return false;
}

static bool border_fits(const L1L2StabConfig *cfg)
{
    if (cfg->border == L1L2STAB_BORDER_CROP || cfg->output_size == L1L2STAB_OUTPUT_SIZE_INPUT)
        return true;
    l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR,
             "border=%s shows the whole frame, and output_size=crop a part of it: choose one of them",
             cfg->border == L1L2STAB_BORDER_FILL ? "fill" : "extend");
    return false;
}

/* Every range that does not depend on another field. What does depend is computed and checked after these. */
static bool ranges_fit(const L1L2StabConfig *cfg)
{
    return in_range(cfg, "width", cfg->width, 16, 16384) && in_range(cfg, "height", cfg->height, 16, 16384) &&
           in_range(cfg, "frame_rate", cfg->frame_rate, 0, 1000) &&
           in_range(cfg, "chroma_site", cfg->chroma_site, L1L2STAB_CHROMA_SITE_LEFT, L1L2STAB_CHROMA_SITE_TOP_LEFT) &&
           l1l2_config_check_live(cfg) && in_range(cfg, "window", cfg->window, 4, 900) &&
           in_range(cfg, "join", cfg->join, L1L2STAB_JOIN_CONTINUOUS, L1L2STAB_JOIN_BLEND) &&
           in_range(cfg, "interpolation", cfg->interpolation, L1L2STAB_INTERPOLATION_BILINEAR,
                    L1L2STAB_INTERPOLATION_LANCZOS) &&
           in_range(cfg, "output_size", cfg->output_size, L1L2STAB_OUTPUT_SIZE_INPUT, L1L2STAB_OUTPUT_SIZE_CROP) &&
           in_range(cfg, "analysis_size", cfg->analysis_size, 128, 4096) &&
           in_range(cfg, "threads", cfg->threads, 0, 64) &&
           in_range(cfg, "solver", cfg->solver, L1L2STAB_SOLVER_AUTO, L1L2STAB_SOLVER_OSQP) &&
           in_range(cfg, "motion_model", cfg->motion_model, L1L2STAB_MOTION_MODEL_TRANSLATION,
                    L1L2STAB_MOTION_MODEL_AFFINE) &&
           in_range(cfg, "rolling_shutter", cfg->rolling_shutter, L1L2STAB_ROLLING_SHUTTER_NONE,
                    L1L2STAB_ROLLING_SHUTTER_MIXTURE) &&
           in_range(cfg, "pixel_aspect", cfg->pixel_aspect, 0.1, 10) && weights_fit(cfg) && region_fits(cfg) &&
           mask_fits(cfg) && in_range(cfg, "border", cfg->border, L1L2STAB_BORDER_CROP, L1L2STAB_BORDER_EXTEND) &&
           in_range(cfg, "fill_frames", cfg->fill_frames, 0, L1L2_BORDER_MAX_FRAMES) && border_fits(cfg);
}

/* Fields that the caller's config knows but this library does not: the logger is one that both know. */
static void log_unknown_field(const L1L2StabConfig *in)
{
    l1l2_log(&in->logger, L1L2STAB_LOG_ERROR,
             "a config of %zu bytes sets a field that came after version %s: leave it 0, or update the library",
             in->struct_size, l1l2stab_version());
}

L1L2StabResult l1l2_config_resolve(const L1L2StabConfig *in, L1L2StabConfig *out)
{
    if (!in)
        return L1L2STAB_ERR_ARGUMENT;
    l1l2stab_config_init(out, sizeof *out);
    const L1L2StabResult result =
        l1l2_struct_read(out, sizeof *out, in, in->struct_size, offsetof(L1L2StabConfig, format));
    if (result == L1L2STAB_ERR_UNSUPPORTED)
        log_unknown_field(in);
    if (result != L1L2STAB_OK)
        return result;
    out->struct_size = sizeof *out;
    if (!l1l2_image_format_info(out->format)) {
        l1l2_log(&out->logger, L1L2STAB_LOG_ERROR, "format %d is not supported: choose an L1L2STAB_FORMAT_*",
                 (int)out->format);
        return L1L2STAB_ERR_UNSUPPORTED;
    }
    if (!ranges_fit(out))
        return L1L2STAB_ERR_ARGUMENT;
    if (out->overlap == 0)
        out->overlap = default_overlap(out->join, out->window);
    return overlap_fits(out) ? L1L2STAB_OK : L1L2STAB_ERR_ARGUMENT;
}

static int even_part(double size)
{
    return 2 * (int)floor(size / 2.0);
}

void l1l2_config_output_size(const L1L2StabConfig *resolved, int *width, int *height)
{
    const bool crop = resolved->output_size == L1L2STAB_OUTPUT_SIZE_CROP;
    *width = crop ? even_part(resolved->width * resolved->crop_ratio) : resolved->width;
    *height = crop ? even_part(resolved->height * resolved->crop_ratio) : resolved->height;
}

L1L2StabResult l1l2stab_config_output_size(const L1L2StabConfig *cfg, int *width, int *height)
{
    L1L2StabConfig resolved;
    if (!width || !height)
        return L1L2STAB_ERR_ARGUMENT;
    *width = *height = 0;
    const L1L2StabResult result = l1l2_config_resolve(cfg, &resolved);
    if (result == L1L2STAB_OK)
        l1l2_config_output_size(&resolved, width, height);
    return result;
}

int l1l2stab_config_delay(const L1L2StabConfig *cfg)
{
    L1L2StabConfig resolved;
    const L1L2StabResult result = l1l2_config_resolve(cfg, &resolved);
    return result == L1L2STAB_OK ? resolved.window : (int)result;
}

const char *l1l2stab_strerror(L1L2StabResult result)
{
    switch (result) {
    case L1L2STAB_OK: return "no error";
    case L1L2STAB_AGAIN: return "not yet: push more frames before pulling, or pull before pushing more";
    case L1L2STAB_EOS: return "end of stream: every frame has been pulled";
    case L1L2STAB_ERR_ARGUMENT: return "the caller passed a value that is out of range: the log says which";
    case L1L2STAB_ERR_STATE: return "the caller made a call out of order: reset() after finish() before pushing again";
    case L1L2STAB_ERR_UNSUPPORTED: return "this is not supported: the log says what is";
    case L1L2STAB_ERR_NOMEM: return "out of memory: choose a shorter window or smaller frames";
    case L1L2STAB_ERR_BACKEND: return "the imaging or solver library failed: the log says how; please report it";
    }
    return "unknown result";
}

#define STRING_OF(x) #x
#define STRING(x) STRING_OF(x)

const char *l1l2stab_version(void)
{
    return STRING(L1L2STAB_VERSION_MAJOR) "." STRING(L1L2STAB_VERSION_MINOR) "." STRING(L1L2STAB_VERSION_PATCH);
}
