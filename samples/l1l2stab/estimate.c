/* SPDX-License-Identifier: MIT */
#include "estimate.h"

#include "fault.h"
#include "job.h"
#include "say.h"

#include <l1l2stab/l1l2stab.h>
#include <math.h>
#include <string.h>

#define ANALYSIS_WINDOW 16     /* frames: the measured motion does not depend on it, the memory does */
#define REFERENCE_WIDTH 640.0  /* the shake is told in pixels of a picture of this width, as measure-shake tells it */
#define WIDEST_CROP 0.98       /* the range in which --crop auto looks */
#define NARROWEST_CROP 0.7
#define CROP_STEP 0.01
#define POOR_QUALITY 0.3

static const double shown_crops[] = {0.98, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7};
static const double shown_lambdas[] = {0.1, 0.25, 0.5, 1, 2};

/* A frame's measured motion. */
typedef struct Motion {
    double F[9];
    gint64 time_ns;
    gboolean path_start, lost;
    double quality;
} Motion;

typedef struct Analysis {
    Input *input;
    GArray *motions;        /* of Motion */
    int cuts, lost, poor;
    double quality, readout; /* mean and last */
    L1L2StabConfig config;  /* of the runs without pictures */
    double shake;           /* px at REFERENCE_WIDTH */
} Analysis;

/* ---- measuring ---- */

static void read_matrix(const GstStructure *message, const char *name, double matrix[9])
{
    const GValue *array = gst_structure_get_value(message, name);
    for (guint i = 0; array && i < MIN(9, gst_value_array_get_size(array)); i++)
        matrix[i] = g_value_get_double(gst_value_array_get_value(array, i));
}

static void on_message(void *cookie, const GstStructure *message)
{
    Analysis *analysis = cookie;
    Motion motion = {.F = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    guint64 time = 0;
    if (!gst_structure_has_name(message, "l1l2stab-frame"))
        return;
    read_matrix(message, "motion", motion.F);
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

/*
 * The root mean square of the second difference of the frame's corners: the distance of a corner from the place that
 * its motion in the two frames before predicts. A steady pan has none. Nothing is measured across a cut.
 */
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
    return shake->count ? sqrt(shake->sum / (double)shake->count) * REFERENCE_WIDTH / shake->width : 0;
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

/* The share of the shake that is left with these settings: the path is solved, and nothing is rendered. */
static double share_left(const Analysis *analysis, double crop, double lambda)
{
    L1L2StabConfig config = analysis->config;
    Shake left = new_shake(analysis);
    L1L2Stab *stab;
    config.crop_ratio = crop;
    config.lambda = lambda;
    if (l1l2stab_create(&stab, &config) != L1L2STAB_OK)
        return 1;
    L1L2StabResult result = L1L2STAB_OK;
    for (guint i = 0; i < analysis->motions->len && result == L1L2STAB_OK; i++) {
        const Motion *motion = &g_array_index(analysis->motions, Motion, i);
        const L1L2StabFrame frame = {.motion = motion->F, .pts = motion->time_ns,
                                     .flags = motion->path_start ? L1L2STAB_FRAME_DISCONT : 0};
        result = l1l2stab_push(stab, &frame);
        pull_steps(stab, &left);
    }
    if (result == L1L2STAB_OK)
        result = l1l2stab_finish(stab);
    pull_steps(stab, &left);
    l1l2stab_free(&stab);
    return result != L1L2STAB_OK ? 1 : analysis->shake > 0 ? shake_px(&left) / analysis->shake : 0;
}

/* ---- suggestions: as little as is needed ---- */

/* The widest crop window that removes this share of what the narrowest one removes. */
static double widest_crop(const Analysis *analysis, double keep)
{
    const double wanted = keep * (1 - share_left(analysis, NARROWEST_CROP, analysis->config.lambda));
    int low = 0, high = (int)lrint((WIDEST_CROP - NARROWEST_CROP) / CROP_STEP); /* low is narrow enough */
    while (low < high) {
        const int middle = (low + high + 1) / 2;
        const double crop = NARROWEST_CROP + middle * CROP_STEP;
        if (1 - share_left(analysis, crop, analysis->config.lambda) >= wanted)
            low = middle;
        else
            high = middle - 1;
    }
    return NARROWEST_CROP + low * CROP_STEP;
}

/* The largest lambda, which follows the camera most closely, that removes this share of what the smallest removes. */
static double largest_lambda(const Analysis *analysis, double crop, double keep)
{
    const double wanted = keep * (1 - share_left(analysis, crop, shown_lambdas[0]));
    double best = shown_lambdas[0];
    for (size_t i = 1; i < G_N_ELEMENTS(shown_lambdas); i++)
        if (1 - share_left(analysis, crop, shown_lambdas[i]) >= wanted)
            best = shown_lambdas[i];
    return best;
}

static gboolean analyze(Analysis *analysis, const Options *options, const char *in, GError **error)
{
    analysis->input = job_open(options, in, error);
    if (!analysis->input)
        return FALSE;
    analysis->motions = g_array_new(FALSE, FALSE, sizeof(Motion));
    configure(analysis, options);
    Options fast = *options;
    fast.settings = g_ptr_array_new();
    /* Whole frames are not rendered, and the picture is not needed. */
    static char *const settings[] = {(char *)"bypass", (char *)"true", (char *)"window",
                                     (char *)G_STRINGIFY(ANALYSIS_WINDOW)};
    for (size_t i = 0; i < G_N_ELEMENTS(settings); i++)
        g_ptr_array_add(fast.settings, settings[i]);
    const gboolean ok = job_analyze(&fast, analysis->input, on_message, analysis, error);
    g_ptr_array_unref(fast.settings);
    if (!ok)
        return FALSE;
    if (analysis->motions->len == 0)
        return fault(error, EXIT_INPUT, "%s: no frame of it could be decoded", analysis->input->name);
    Shake shake = new_shake(analysis);
    for (guint i = 0; i < analysis->motions->len; i++) {
        const Motion *motion = &g_array_index(analysis->motions, Motion, i);
        shake_add(&shake, motion->F, motion->path_start || motion->lost);
    }
    analysis->shake = shake_px(&shake);
    analysis->quality /= analysis->motions->len;
    return TRUE;
}

static void clear(Analysis *analysis)
{
    if (analysis->motions)
        g_array_unref(analysis->motions);
    input_close(analysis->input);
}

/* ---- what is printed ---- */

static const char *degree_of(double shake)
{
    return shake < 0.3 ? "steady" : shake < 1 ? "slight" : shake < 4 ? "shaky" : "very shaky";
}

static char *number(double value, const char *format)
{
    char text[G_ASCII_DTOSTR_BUF_SIZE];
    return g_strdup(g_ascii_formatd(text, sizeof text, format, value));
}

/* Adds text with numbers in the C locale: %s for each. */
static void add_number(GString *text, const char *before, double value, const char *format, const char *after)
{
    char *shown = number(value, format);
    g_string_append_printf(text, "%s%s%s", before, shown, after);
    g_free(shown);
}

static void describe_obstacles(const Analysis *analysis, GString *text)
{
    const gsize begin = text->len;
    if (analysis->cuts)
        g_string_append_printf(text, "%d cuts, each begins a new path; ", analysis->cuts);
    if (analysis->lost)
        g_string_append_printf(text, "%d frames whose motion could not be measured; ", analysis->lost);
    if (analysis->poor)
        g_string_append_printf(text, "%d frames with little to track; ", analysis->poor);
    if (fabs(analysis->readout) > 0.05)
        add_number(text, "rolling shutter, ", fabs(analysis->readout), "%.2f", " of a frame's duration; ");
    if (analysis->input->damage)
        g_string_append_printf(text, "the file is truncated or damaged (%s); ", analysis->input->damage);
    if (text->len == begin)
        g_string_append(text, "nothing; ");
    g_string_truncate(text, text->len - 2);
}

static void print(const Analysis *analysis, double keep)
{
    const double crop = widest_crop(analysis, keep), lambda = largest_lambda(analysis, crop, keep);
    GString *text = g_string_new(NULL), *json = g_string_new(NULL), *crops = g_string_new(NULL);
    char *name = say_json_string(analysis->input->name);
    g_string_append_printf(text, "%s: %u frames\n", analysis->input->name, analysis->motions->len);
    add_number(text, "shake           ", analysis->shake, "%.2f",
               " px (rms jump of a frame's corner, at 640 px width): ");
    g_string_append_printf(text, "%s\nin the way      ", degree_of(analysis->shake));
    describe_obstacles(analysis, text);
    g_string_append(text, "\ncrop-ratio     ");
    for (size_t i = 0; i < G_N_ELEMENTS(shown_crops); i++)
        add_number(text, " ", shown_crops[i], "%6.2f", "");
    g_string_append(text, "\nshake left     ");
    for (size_t i = 0; i < G_N_ELEMENTS(shown_crops); i++) {
        const double left = share_left(analysis, shown_crops[i], analysis->config.lambda);
        add_number(text, " ", 100 * left, "%5.1f", "%");
        add_number(crops, i ? ", {\"crop-ratio\": " : "{\"crop-ratio\": ", shown_crops[i], "%.2f", ", ");
        add_number(crops, "\"left\": ", left, "%.4f", "}");
    }
    add_number(text, "\nsuggested       --crop-ratio ", crop, "%.2f", "");
    add_number(text, " --lambda ", lambda, "%g", "\n");

    g_string_append_printf(json, "{\"type\": \"estimate\", \"file\": %s, \"frames\": %u", name, analysis->motions->len);
    add_number(json, ", \"shake\": ", analysis->shake, "%.4f", "");
    g_string_append_printf(json, ", \"degree\": \"%s\", \"cuts\": %d, \"lost\": %d, \"poor\": %d",
                           degree_of(analysis->shake), analysis->cuts, analysis->lost, analysis->poor);
    add_number(json, ", \"quality\": ", analysis->quality, "%.3f", "");
    add_number(json, ", \"readout\": ", analysis->readout, "%.3f", "");
    g_string_append_printf(json, ", \"crops\": [%s]", crops->str);
    add_number(json, ", \"suggested\": {\"crop-ratio\": ", crop, "%.2f", "");
    add_number(json, ", \"lambda\": ", lambda, "%g", "}}");
    say_result(json->str, text->str);
    g_free(name);
    g_string_free(crops, TRUE);
    g_string_free(json, TRUE);
    g_string_free(text, TRUE);
}

static int say_failure(GError *error)
{
    const int code = error->code;
    say_error(error->message);
    g_error_free(error);
    return code;
}

int estimate_run(const Options *options, const char *in)
{
    Analysis analysis = {0};
    GError *error = NULL;
    int code = EXIT_DONE;
    if (analyze(&analysis, options, in, &error)) {
        print(&analysis, options->keep);
        code = analysis.input->damage ? EXIT_DAMAGED : EXIT_DONE;
    } else
        code = say_failure(error);
    clear(&analysis);
    return code;
}

int estimate_choose_crop(Options *options, const char *in)
{
    Analysis analysis = {0};
    GError *error = NULL;
    int code = EXIT_DONE;
    if (analyze(&analysis, options, in, &error)) {
        const double crop = widest_crop(&analysis, options->keep);
        char *text = number(crop, "%.2f"), *share = number(100 * options->keep, "%g");
        say_note("%s: crop-ratio %s keeps %s %% of the effect", analysis.input->name, text, share);
        g_ptr_array_add(options->settings, g_strdup("crop-ratio"));
        g_ptr_array_add(options->settings, text);
        g_free(share);
    } else
        code = say_failure(error);
    clear(&analysis);
    return code;
}
