/* SPDX-License-Identifier: MIT */
#include "analysis.h"

#include <math.h>
#include <string.h>

/* ---- measuring ---- */

void analysis_read_matrix(const GstStructure *message, const char *name, double matrix[9])
{
    const GValue *array = gst_structure_get_value(message, name);
    for (guint i = 0; array && i < MIN(9, gst_value_array_get_size(array)); i++)
        matrix[i] = g_value_get_double(gst_value_array_get_value(array, i));
}

void analysis_add(Analysis *analysis, const GstStructure *message)
{
    Motion motion = {.F = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    guint64 time = 0;
    if (!gst_structure_has_name(message, "l1l2stab-frame"))
        return;
    analysis_read_matrix(message, "motion", motion.F);
    gst_structure_get_boolean(message, "path-start", &motion.path_start);
    gst_structure_get_boolean(message, "motion-lost", &motion.lost);
    gst_structure_get_double(message, "quality", &motion.quality);
    gst_structure_get_double(message, "readout", &analysis->readout);
    gst_structure_get_uint64(message, "timestamp", &time);
    motion.time_ns = (gint64)time;
    analysis->cuts += motion.path_start && analysis->motions->len > 0;
    analysis->lost += motion.lost && !motion.path_start;
    analysis->poor += !motion.lost && !motion.path_start && motion.quality < POOR_QUALITY;
    analysis->quality += motion.quality;
    g_array_append_val(analysis->motions, motion);
}

/* The settings of the path that the user gave, without those of the picture. */
static void read_setting(L1L2StabConfig *config, const char *name, const char *text)
{
    if (g_str_equal(name, "lambda"))
        config->lambda = g_ascii_strtod(text, NULL);
    else if (g_str_equal(name, "crop-ratio"))
        config->crop_ratio = g_ascii_strtod(text, NULL);
    else if (g_str_equal(name, "window"))
        config->window = (int)g_ascii_strtoll(text, NULL, 10);
    else if (g_str_equal(name, "overlap"))
        config->overlap = (int)g_ascii_strtoll(text, NULL, 10);
    else if (g_str_equal(name, "join") && g_str_equal(text, "blend"))
        config->join = L1L2STAB_JOIN_BLEND;
    else if (g_str_equal(name, "motion-model"))
        config->motion_model = g_str_equal(text, "translation") ? L1L2STAB_MOTION_MODEL_TRANSLATION
                               : g_str_equal(text, "affine")    ? L1L2STAB_MOTION_MODEL_AFFINE
                                                                : L1L2STAB_MOTION_MODEL_SIMILARITY;
}

static void configure(Analysis *analysis, const Options *options)
{
    const AVStream *video = analysis->input->video;
    const double rate = av_q2d(video->avg_frame_rate);
    const AVRational pixel = av_guess_sample_aspect_ratio(analysis->input->format, (AVStream *)video, NULL);
    l1l2stab_config_init(&analysis->config, sizeof analysis->config);
    analysis->config.format = L1L2STAB_FORMAT_GRAY8;
    analysis->config.width = video->codecpar->width;
    analysis->config.height = video->codecpar->height;
    analysis->config.frame_rate = rate > 0 && rate <= 1000 ? rate : 0;
    analysis->config.pixel_aspect = pixel.num > 0 && pixel.den > 0 ? av_q2d(pixel) : 1;
    for (guint i = 0; i + 1 < options->settings->len; i += 2)
        read_setting(&analysis->config, options->settings->pdata[i], options->settings->pdata[i + 1]);
}

/* ---- the shake ---- */

/* analysis.h says what it is. */
typedef struct Shake {
    double width, height, last[8], sum;
    gint64 count;
    gboolean moving;
} Shake;

static void shake_add(Shake *shake, const double motion[9], gboolean path_start)
{
    if (path_start) {
        shake->moving = FALSE;
        return;
    }
    for (int i = 0; i < 4; i++) {
        const double x = (i & 1 ? 0.5 : -0.5) * shake->width, y = (i & 2 ? 0.5 : -0.5) * shake->height;
        const double w = motion[6] * x + motion[7] * y + motion[8];
        const double vx = (motion[0] * x + motion[1] * y + motion[2]) / w - x;
        const double vy = (motion[3] * x + motion[4] * y + motion[5]) / w - y;
        if (shake->moving) {
            shake->sum += pow(vx - shake->last[2 * i], 2) + pow(vy - shake->last[2 * i + 1], 2);
            shake->count++;
        }
        shake->last[2 * i] = vx;
        shake->last[2 * i + 1] = vy;
    }
    shake->moving = TRUE;
}

static double shake_px(const Shake *shake)
{
    return shake->count ? sqrt(shake->sum / (double)shake->count) * SHAKE_WIDTH / shake->width : 0;
}

static Shake new_shake(const Analysis *analysis)
{
    return (Shake){.width = analysis->config.width * analysis->config.pixel_aspect, .height = analysis->config.height};
}

static void pull_steps(L1L2Stab *stab, Shake *shake)
{
    L1L2StabInfo info;
    while (l1l2stab_pull(stab, NULL, &info) == L1L2STAB_OK)
        shake_add(shake, info.S, (info.flags & L1L2STAB_INFO_PATH_START) != 0);
}

double analysis_share_left(const Analysis *analysis, double crop, double lambda, guint frames)
{
    L1L2StabConfig config = analysis->config;
    Shake filmed = new_shake(analysis), left = filmed;
    L1L2Stab *stab;
    config.crop_ratio = crop;
    config.lambda = lambda;
    config.threads = 1; /* there is nothing to render */
    if (l1l2stab_create(&stab, &config) != L1L2STAB_OK)
        return 1;
    L1L2StabResult result = L1L2STAB_OK;
    for (guint i = 0; i < MIN(frames, analysis->motions->len) && result == L1L2STAB_OK; i++) {
        const Motion *motion = &g_array_index(analysis->motions, Motion, i);
        const L1L2StabFrame frame = {.motion = motion->F, .pts = motion->time_ns,
                                     .flags = motion->path_start ? L1L2STAB_FRAME_DISCONT : 0};
        shake_add(&filmed, motion->F, motion->path_start || motion->lost);
        result = l1l2stab_push(stab, &frame);
        pull_steps(stab, &left);
    }
    if (result == L1L2STAB_OK)
        result = l1l2stab_finish(stab);
    pull_steps(stab, &left);
    l1l2stab_free(&stab);
    const double before = shake_px(&filmed);
    return result != L1L2STAB_OK ? 1 : before > 0 ? shake_px(&left) / before : 0;
}

void analysis_begin(Analysis *analysis, const Options *options, Input *input)
{
    *analysis = (Analysis){.input = input, .motions = g_array_new(FALSE, FALSE, sizeof(Motion))};
    configure(analysis, options);
}

void analysis_clear(Analysis *analysis)
{
    g_clear_pointer(&analysis->motions, g_array_unref);
}

void analysis_end(Analysis *analysis)
{
    Shake shake = new_shake(analysis);
    for (guint i = 0; i < analysis->motions->len; i++) {
        const Motion *motion = &g_array_index(analysis->motions, Motion, i);
        shake_add(&shake, motion->F, motion->path_start || motion->lost);
    }
    analysis->shake = shake_px(&shake);
    analysis->quality /= MAX(1, analysis->motions->len);
}
