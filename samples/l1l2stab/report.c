/* SPDX-License-Identifier: MIT */
#include "report.h"

#include "analysis.h"
#include "fault.h"
#include "report_pairs.h"
#include "say.h"

#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define PAGE "/l1l2stab/page.html"
#define CHART "/l1l2stab/chart.js"
#define PLACE "/*@insert@*/" /* in the page: first the plotting library goes here, then the data */

/* What other settings would leave is computed from the first frames of a long video. A frame takes about 0.1 ms in each
 * of the 30 runs. */
#define OTHER_FRAMES 3000
static const double other_crops[] = {0.98, 0.95, 0.9, 0.85, 0.8, 0.7};
static const double other_lambdas[] = {0.1, 0.25, 0.5, 1, 2};
enum { CROPS = G_N_ELEMENTS(other_crops), LAMBDAS = G_N_ELEMENTS(other_lambdas) };

/* Where the camera is, or would be: x and y in pixels, turn in degrees, zoom in percent. */
enum { X, Y, TURN, ZOOM, PLACES };
static const char *const place_names[PLACES] = {"x", "y", "turn", "zoom"};

typedef struct Sample {
    double camera[PLACES], path[PLACES]; /* as filmed and as stabilized, from the first frame of a shot */
    double seconds, quality, crop;
    const char *event;                   /* or NULL */
} Sample;

struct Report {
    const Options *options;
    const char *orientation;
    Analysis analysis;
    GArray *samples;
    GstClockTime first_time;
    double crop, lambda;                 /* of the last frame */
    gboolean is_whole;                   /* the border is not cropped */
    double filled, extended;             /* sums of the frames' parts */
    ReportPairs *pairs;
};

/* The files of report/report.gresource.xml, compiled into the program by glib-compile-resources. */
#ifdef HAVE_CHART
GResource *report_get_resource(void);
#else
static GResource *report_get_resource(void)
{
    return NULL;
}
#endif

gboolean report_check(const char *folder, GError **error)
{
    if (!report_get_resource())
        return fault(error, EXIT_OTHER, "--report: this program was built without Chart.js, which draws the report. "
                     "Install it (Debian's package libjs-chart.js) and build again");
    if (g_mkdir_with_parents(folder, 0777) == 0)
        return TRUE;
    char *shown = printable(folder);
    fault(error, EXIT_OUTPUT, "--report: the folder %s cannot be made: %s", shown, g_strerror(errno));
    g_free(shown);
    return FALSE;
}

/* ---- watching ---- */

Report *report_new(const Options *options, Input *input, GstElement *stabilizer, const char *orientation,
                   gint64 duration)
{
    Report *report = g_new0(Report, 1);
    int border = L1L2STAB_BORDER_CROP;
    report->options = options;
    report->orientation = orientation ? orientation : "identity";
    report->samples = g_array_new(FALSE, TRUE, sizeof(Sample));
    analysis_begin(&report->analysis, options, input);
    report->pairs = report_pairs_new(stabilizer, duration);
    g_object_get(stabilizer, "border", &border, NULL);
    report->is_whole = border != L1L2STAB_BORDER_CROP;
    g_object_set(stabilizer, "post-messages", TRUE, NULL);
    return report;
}

void report_free(Report *report)
{
    if (!report)
        return;
    report_pairs_free(report->pairs);
    analysis_clear(&report->analysis);
    g_array_unref(report->samples);
    g_free(report);
}

/* A matrix maps a point of this frame to the first frame of the shot. So it shrinks if the camera zooms in. The turn
 * does not jump by a full turn against that of the frame before. */
static void read_place(const GstStructure *message, const char *name, double turn_before, double place[PLACES])
{
    double matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    analysis_read_matrix(message, name, matrix);
    place[X] = matrix[2];
    place[Y] = matrix[5];
    place[TURN] = turn_before + remainder(atan2(matrix[3], matrix[0]) * 180 / G_PI - turn_before, 360);
    place[ZOOM] = 100 / hypot(matrix[0], matrix[3]);
}

/* The first frame of the video starts a path, too, but there is no cut. */
static const char *event_of(const GstStructure *message)
{
    static const char *const fields[] = {"path-start", "motion-lost", "bridged", "path-fallback"};
    static const char *const names[] = {"cut", "lost", "bridged", "fallback"};
    gboolean happened = FALSE;
    for (size_t i = 0; i < G_N_ELEMENTS(fields); i++)
        if (gst_structure_get_boolean(message, fields[i], &happened) && happened)
            return names[i];
    return NULL;
}

void report_add(Report *report, const GstStructure *message)
{
    Sample sample = {0};
    guint64 time = 0;
    double filled, extended;
    if (!gst_structure_has_name(message, "l1l2stab-frame"))
        return;
    const guint count = report->samples->len;
    const Sample *before = count ? &g_array_index(report->samples, Sample, count - 1) : NULL;
    analysis_add(&report->analysis, message);
    sample.event = before ? event_of(message) : NULL;
    if (sample.event && g_str_equal(sample.event, "cut"))
        before = NULL; /* the path begins again at 0 */
    read_place(message, "camera", before ? before->camera[TURN] : 0, sample.camera);
    read_place(message, "path", before ? before->path[TURN] : 0, sample.path);
    gst_structure_get(message, "timestamp", G_TYPE_UINT64, &time, "quality", G_TYPE_DOUBLE, &sample.quality,
                      "crop-ratio", G_TYPE_DOUBLE, &sample.crop, "lambda", G_TYPE_DOUBLE, &report->lambda, NULL);
    report->crop = sample.crop;
    if (gst_structure_get(message, "filled", G_TYPE_DOUBLE, &filled, "extended", G_TYPE_DOUBLE, &extended, NULL)) {
        report->filled += filled;
        report->extended += extended;
    }
    if (count == 0)
        report->first_time = time;
    sample.seconds = (double)(gint64)(time - report->first_time) / GST_SECOND;
    g_array_append_val(report->samples, sample);
}

/* ---- JSON and CSV ---- */

static void add_number(GString *text, double value, int decimals)
{
    char format[8], shown[G_ASCII_DTOSTR_BUF_SIZE];
    g_snprintf(format, sizeof format, "%%.%df", decimals);
    g_string_append(text, g_ascii_formatd(shown, sizeof shown, format, isfinite(value) ? value : 0));
}

static void add_field(GString *json, const char *name, double value, int decimals)
{
    g_string_append_printf(json, ", \"%s\": ", name);
    add_number(json, value, decimals);
}

/* A number of each frame, which is `offset` bytes into its sample. */
static void add_column(GString *json, const GArray *samples, const char *name, size_t offset)
{
    g_string_append_printf(json, "\"%s\": [", name);
    for (guint i = 0; i < samples->len; i++) {
        g_string_append(json, i ? "," : "");
        add_number(json, *(const double *)(samples->data + i * sizeof(Sample) + offset), 3);
    }
    g_string_append(json, "]");
}

static void add_places(GString *json, const GArray *samples, const char *name, size_t offset)
{
    g_string_append_printf(json, ",\n\"%s\": {", name);
    for (size_t i = 0; i < PLACES; i++) {
        g_string_append(json, i ? ",\n" : "");
        add_column(json, samples, place_names[i], offset + i * sizeof(double));
    }
    g_string_append(json, "}");
}

static void add_events(GString *json, const GArray *samples)
{
    const char *separator = "";
    g_string_append(json, ",\n\"events\": [");
    for (guint i = 0; i < samples->len; i++) {
        const Sample *sample = &g_array_index(samples, Sample, i);
        if (!sample->event)
            continue;
        g_string_append_printf(json, "%s{\"frame\": %u, \"kind\": \"%s\"}", separator, i, sample->event);
        separator = ", ";
    }
    g_string_append(json, "]");
}

static void add_list(GString *json, const char *before, const double *values, size_t count, int decimals)
{
    g_string_append(json, before);
    for (size_t i = 0; i < count; i++) {
        g_string_append(json, i ? ", " : "[");
        add_number(json, values[i], decimals);
    }
    g_string_append(json, "]");
}

/* A cell of the table. */
typedef struct Other {
    const Analysis *analysis;
    size_t crop, lambda;     /* which of the lists */
    double left;
} Other;

static void solve_other(gpointer data, gpointer unused)
{
    Other *other = data;
    other->left = analysis_share_left(other->analysis, other_crops[other->crop], other_lambdas[other->lambda],
                                      OTHER_FRAMES);
}

/* What other settings would leave of the shake: a row for each lambda, a column for each crop ratio. */
static void add_others(GString *json, const Analysis *analysis)
{
    Other others[LAMBDAS][CROPS];
    GThreadPool *pool = g_thread_pool_new(solve_other, NULL, (int)g_get_num_processors(), FALSE, NULL);
    for (size_t row = 0; row < LAMBDAS; row++)
        for (size_t i = 0; i < CROPS; i++) {
            others[row][i] = (Other){.analysis = analysis, .crop = i, .lambda = row};
            g_thread_pool_push(pool, &others[row][i], NULL);
        }
    g_thread_pool_free(pool, FALSE, TRUE);
    g_string_append_printf(json, ",\n\"others\": {\"frames\": %u", MIN(OTHER_FRAMES, analysis->motions->len));
    add_list(json, ", \"crop-ratios\": ", other_crops, CROPS, 2);
    add_list(json, ", \"lambdas\": ", other_lambdas, LAMBDAS, 2);
    for (size_t row = 0; row < LAMBDAS; row++) {
        double left[CROPS];
        for (size_t i = 0; i < CROPS; i++)
            left[i] = others[row][i].left;
        add_list(json, row ? ", " : ", \"left\": [", left, CROPS, 4);
    }
    g_string_append(json, "]}");
}

static GString *make_json(const Report *report)
{
    const Analysis *analysis = &report->analysis;
    const double left = analysis_share_left(analysis, report->crop, report->lambda, ALL_FRAMES);
    GString *json = g_string_new("{");
    char *name = say_json_string(analysis->input->name);
    g_string_append_printf(json, "\"file\": %s, \"version\": \"%s\", \"frames\": %u, \"width\": %d, \"height\": %d, "
                                 "\"orientation\": \"%s\", \"window\": %d, \"cuts\": %d, \"lost\": %d, \"poor\": %d",
                           name, l1l2stab_version(), report->samples->len, analysis->config.width,
                           analysis->config.height, report->orientation, analysis->config.window, analysis->cuts,
                           analysis->lost, analysis->poor);
    add_field(json, "frame-rate", analysis->config.frame_rate, 3);
    add_field(json, "crop-ratio", report->crop, 3);
    g_string_append_printf(json, ", \"whole\": %s", report->is_whole ? "true" : "false");
    add_field(json, "filled-mean", report->filled / MAX(report->samples->len, 1), 5);
    add_field(json, "extended-mean", report->extended / MAX(report->samples->len, 1), 5);
    add_field(json, "lambda", report->lambda, 3);
    add_field(json, "shake-before", analysis->shake, 4);
    add_field(json, "shake-after", analysis->shake * left, 4);
    add_field(json, "quality-mean", analysis->quality, 4);
    add_field(json, "readout", analysis->readout, 3);
    add_others(json, analysis);
    add_events(json, report->samples);
    g_string_append(json, ",\n");
    add_column(json, report->samples, "time", G_STRUCT_OFFSET(Sample, seconds));
    g_string_append(json, ",\n");
    add_column(json, report->samples, "quality", G_STRUCT_OFFSET(Sample, quality));
    add_places(json, report->samples, "camera", G_STRUCT_OFFSET(Sample, camera));
    add_places(json, report->samples, "path", G_STRUCT_OFFSET(Sample, path));
    g_free(name);
    return json; /* its last brace is missing */
}

static GString *make_csv(const GArray *samples)
{
    GString *csv = g_string_new("frame,time,camera_x,camera_y,camera_turn,camera_zoom,"
                                "path_x,path_y,path_turn,path_zoom,quality,crop_ratio,event\n");
    for (guint i = 0; i < samples->len; i++) {
        const Sample *sample = &g_array_index(samples, Sample, i);
        g_string_append_printf(csv, "%u,", i);
        add_number(csv, sample->seconds, 6);
        for (int place = 0; place < 2 * PLACES; place++) {
            g_string_append_c(csv, ',');
            add_number(csv, place < PLACES ? sample->camera[place] : sample->path[place - PLACES], 4);
        }
        g_string_append_c(csv, ',');
        add_number(csv, sample->quality, 4);
        g_string_append_c(csv, ',');
        add_number(csv, sample->crop, 4);
        g_string_append_printf(csv, ",%s\n", sample->event ? sample->event : "");
    }
    return csv;
}

/* ---- the page ---- */

static char *resource_text(const char *path)
{
    GBytes *bytes = g_resource_lookup_data(report_get_resource(), path, G_RESOURCE_LOOKUP_FLAGS_NONE, NULL);
    gsize size = 0;
    const char *data = g_bytes_get_data(bytes, &size);
    char *text = g_strndup(data, size);
    g_bytes_unref(bytes);
    return text;
}

/* The data for the page, in which no text can end the element that holds it. */
static GString *page_data(const Report *report, const char *json, const char *stem)
{
    GString *data = g_string_new(json);
    char *quoted = say_json_string(stem);
    g_string_append_printf(data, ",\n\"stem\": %s,\n\"pairs\": ", quoted);
    report_pairs_write(report->pairs, data);
    g_string_append(data, "}");
    g_string_replace(data, "<", "\\u003c", 0);
    g_free(quoted);
    return data;
}

static char *make_page(const Report *report, const char *json, const char *stem)
{
    char *page = resource_text(PAGE), *chart = resource_text(CHART);
    char **parts = g_strsplit(page, PLACE, 3);
    GString *data = page_data(report, json, stem);
    char *text = g_strconcat(parts[0], chart, parts[1], data->str, parts[2], NULL);
    g_string_free(data, TRUE);
    g_strfreev(parts);
    g_free(chart);
    g_free(page);
    return text;
}

static gboolean write_file(const Report *report, const char *stem, const char *suffix, const char *text,
                           GError **error)
{
    GError *problem = NULL;
    char *name = g_strconcat(stem, suffix, NULL), *path = g_build_filename(report->options->report, name, NULL);
    if (!g_file_set_contents(path, text, -1, &problem))
        fault(error, EXIT_OUTPUT, "--report: %s", problem->message);
    else if (g_str_equal(suffix, ".html")) {
        char *shown = printable(path);
        say_note("the report is %s", shown);
        g_free(shown);
    }
    const gboolean ok = problem == NULL;
    g_clear_error(&problem);
    g_free(path);
    g_free(name);
    return ok;
}

gboolean report_write(Report *report, const char *output, GError **error)
{
    char *stem = g_path_get_basename(output), *dot = strrchr(stem, '.');
    if (dot && dot != stem)
        *dot = '\0';
    analysis_end(&report->analysis);
    GString *json = make_json(report), *csv = make_csv(report->samples);
    char *shown = printable(stem), *page = make_page(report, json->str, shown);
    g_string_append(json, "}\n");
    const gboolean ok = write_file(report, stem, ".json", json->str, error) &&
                        write_file(report, stem, ".csv", csv->str, error) &&
                        write_file(report, stem, ".html", page, error);
    g_free(page);
    g_free(shown);
    g_string_free(csv, TRUE);
    g_string_free(json, TRUE);
    g_free(stem);
    return ok;
}
