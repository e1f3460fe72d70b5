/* SPDX-License-Identifier: MIT */
#include "estimate.h"

#include "analysis.h"
#include "fault.h"
#include "job.h"
#include "say.h"

#include <math.h>
#include <string.h>

#define ANALYSIS_WINDOW 16     /* frames: the measured motion does not depend on it, the memory does */
#define WIDEST_CROP 0.98       /* the range in which --crop auto looks */
#define NARROWEST_CROP 0.7
#define CROP_STEP 0.01

static const double shown_crops[] = {0.98, 0.95, 0.9, 0.85, 0.8, 0.75, 0.7};
static const double shown_lambdas[] = {0.1, 0.25, 0.5, 1, 2};

/* ---- suggestions: as little as is needed ---- */

static double share_left(const Analysis *analysis, double crop, double lambda)
{
    return analysis_share_left(analysis, crop, lambda, ALL_FRAMES);
}

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

static void on_message(void *cookie, const GstStructure *message)
{
    analysis_add(cookie, message);
}

static gboolean analyze(Analysis *analysis, const Options *options, const char *in, GError **error)
{
    Input *input = job_open(options, in, error);
    if (!input)
        return FALSE;
    analysis_begin(analysis, options, input);
    Options fast = *options;
    fast.settings = g_ptr_array_new();
    /* Whole frames are not rendered, and the picture is not needed. */
    static char *const settings[] = {(char *)"bypass", (char *)"true", (char *)"window",
                                     (char *)G_STRINGIFY(ANALYSIS_WINDOW)};
    for (size_t i = 0; i < G_N_ELEMENTS(settings); i++)
        g_ptr_array_add(fast.settings, settings[i]);
    const gboolean ok = job_analyze(&fast, input, on_message, analysis, error);
    g_ptr_array_unref(fast.settings);
    if (!ok)
        return FALSE;
    if (analysis->motions->len == 0)
        return fault(error, EXIT_INPUT, "%s: no frame of it could be decoded", input->name);
    analysis_end(analysis);
    return TRUE;
}

static void clear(Analysis *analysis)
{
    analysis_clear(analysis);
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
