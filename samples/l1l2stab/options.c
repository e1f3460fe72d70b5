/* SPDX-License-Identifier: MIT */
#include "options.h"

#include "encoder.h"
#include "fault.h"
#include "input.h"
#include "report.h"

#include <l1l2stab/l1l2stab.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

typedef enum Type {
    TYPE_FLAG,    /* gboolean */
    TYPE_TEXT,    /* char *, owned */
    TYPE_COUNT,   /* int, at least 0 */
    TYPE_NUMBER,  /* double, at least 0 */
    TYPE_TIME,    /* gint64, microseconds */
    TYPE_COMPARE, /* Compare */
    TYPE_CROP,    /* "auto", or a value of the property crop-ratio */
    TYPE_SHOW,    /* prints something and ends */
} Type;

typedef struct Option {
    const char *name;
    char letter;         /* or 0 */
    Type type;
    size_t offset;       /* in Options */
    gboolean per_file;   /* a batch hands it to the process of each file */
    const char *value;   /* what --help calls its value; NULL: it has none */
    const char *help;    /* NULL: --help shows it in one line with the next option */
} Option;

#define AT(field) offsetof(Options, field)

static const Option table[] = {
    {"output", 'o', TYPE_TEXT, AT(out), FALSE, "FILE", "default: IN-stabilized beside IN"},
    {"stream", 0, TYPE_COUNT, AT(stream), TRUE, "N", "which video stream of several"},
    {"start", 0, TYPE_TIME, AT(start_us), TRUE, "TIME", NULL},
    {"end", 0, TYPE_TIME, AT(end_us), TRUE, "TIME", "a part: 90, 1:30.5 or 0:01:30"},
    {"encoder", 0, TYPE_TEXT, AT(encoder), TRUE, "NAME[:KEY=VALUE...]", "h264, hevc ...; list shows all"},
    {"crf", 0, TYPE_NUMBER, AT(crf), TRUE, "N", NULL},
    {"bitrate", 0, TYPE_COUNT, AT(bitrate), TRUE, "KBIT/S", NULL},
    {"preset", 0, TYPE_TEXT, AT(preset), TRUE, "NAME", "quality or size; speed"},
    {"crop", 0, TYPE_CROP, AT(crop_auto), TRUE, "auto", NULL},
    {"keep", 0, TYPE_NUMBER, AT(keep), TRUE, "SHARE", "least crop for 0.95 of the effect"},
    {"compare", 0, TYPE_COMPARE, AT(compare), TRUE, "side|split|flip", "before and after in one video"},
    {"report", 0, TYPE_TEXT, AT(report), TRUE, "DIR", "a page with paths, numbers, pictures"},
    {"preview", 0, TYPE_FLAG, AT(preview), FALSE, NULL, NULL},
    {"estimate", 0, TYPE_FLAG, AT(estimate), TRUE, NULL, "show it; only tell how shaky it is"},
    {"batch", 0, TYPE_FLAG, AT(batch), FALSE, NULL, NULL},
    {"jobs", 'j', TYPE_COUNT, AT(jobs), FALSE, "N", NULL},
    {"skip-existing", 0, TYPE_FLAG, AT(skip_existing), FALSE, NULL, "many files and folders"},
    {"out-dir", 0, TYPE_TEXT, AT(out_dir), FALSE, "DIR", NULL},
    {"suffix", 0, TYPE_TEXT, AT(suffix), FALSE, "TEXT", NULL},
    {"format", 0, TYPE_TEXT, AT(format), FALSE, "EXT", "their names"},
    {"json", 0, TYPE_FLAG, AT(json), TRUE, NULL, NULL},
    {"quiet", 'q', TYPE_FLAG, AT(quiet), TRUE, NULL, NULL},
    {"verbose", 'v', TYPE_FLAG, AT(verbose), TRUE, NULL, "what is printed"},
    {"version", 0, TYPE_SHOW, 0, FALSE, NULL, NULL},
    {"help", 'h', TYPE_SHOW, 0, FALSE, NULL, "man l1l2stab has the details"},
    {"complete", 0, TYPE_SHOW, 0, FALSE, NULL, NULL}, /* for the shells; not in --help */
};

/* ---- the element's properties ---- */

/* An element to ask for properties and to check values with. NULL and *error: it is not installed. */
static GstElement *new_stabilizer(GError **error)
{
    GstElement *element = gst_element_factory_make("l1l2stab", NULL);
    if (!element)
        fault(error, EXIT_PLUGIN,
              "GStreamer does not find the element l1l2stab. Is GST_PLUGIN_PATH set to its folder?");
    return element ? gst_object_ref_sink(element) : NULL;
}

static gboolean is_setting(const GstElement *element, const GParamSpec *spec)
{
    return spec->owner_type == G_OBJECT_TYPE(element) && (spec->flags & G_PARAM_WRITABLE) &&
           !g_str_equal(spec->name, "post-messages") && !g_str_equal(spec->name, "border-map");
}

static GParamSpec *find_setting(GstElement *element, const char *name)
{
    GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), name);
    return spec && is_setting(element, spec) ? spec : NULL;
}

static gboolean apply_setting(GstElement *element, const char *name, const char *text, GError **error)
{
    GParamSpec *spec = find_setting(element, name);
    GValue value = G_VALUE_INIT;
    g_value_init(&value, spec->value_type);
    gboolean ok = TRUE;
    if (G_VALUE_HOLDS_STRING(&value))
        g_value_set_string(&value, text); /* a file name, not to be parsed */
    else if (!gst_value_deserialize_with_pspec(&value, text, spec))
        ok = fault(error, EXIT_USAGE, "--%s: '%s' is not a valid value", name, text);
    else if (g_param_value_validate(spec, &value))
        ok = fault(error, EXIT_USAGE, "--%s: %s is out of range (gst-inspect-1.0 l1l2stab lists the ranges)", name,
                   text);
    if (ok)
        g_object_set_property(G_OBJECT(element), name, &value);
    g_value_unset(&value);
    return ok;
}

static void keep_message(void *cookie, L1L2StabLogLevel level, const char *message)
{
    (void)level;
    g_free(*(char **)cookie);
    *(char **)cookie = g_strdup(message);
}

/* Settings that are valid alone may exclude each other: the library says so, for frames of any size. */
static gboolean settings_fit(GstElement *stabilizer, GError **error)
{
    L1L2StabConfig config;
    char *reason = NULL;
    int join, border, output_size;
    gboolean ok = TRUE;
    l1l2stab_config_init(&config, sizeof config);
    g_object_get(stabilizer, "window", &config.window, "overlap", &config.overlap, "join", &join, "border", &border,
                 "output-size", &output_size, NULL);
    config.format = L1L2STAB_FORMAT_GRAY8;
    config.width = config.height = 640;
    config.join = (L1L2StabJoin)join;
    config.border = (L1L2StabBorder)border;
    config.output_size = (L1L2StabOutputSize)output_size;
    config.logger = (L1L2StabLogger){.write = keep_message, .cookie = &reason, .max_level = L1L2STAB_LOG_ERROR};
    if (l1l2stab_config_delay(&config) < 0)
        ok = fault(error, EXIT_USAGE, "%s", reason ? reason : "these settings exclude each other");
    g_free(reason);
    return ok;
}

gboolean options_apply(const Options *options, GstElement *stabilizer, GError **error)
{
    for (guint i = 0; i + 1 < options->settings->len; i += 2)
        if (!apply_setting(stabilizer, options->settings->pdata[i], options->settings->pdata[i + 1], error))
            return FALSE;
    return settings_fit(stabilizer, error);
}

static void add_setting(Options *options, const char *name, const char *text)
{
    g_ptr_array_add(options->settings, g_strdup(name));
    g_ptr_array_add(options->settings, g_strdup(text));
}

/* ---- --help, --version, --complete ---- */

static char *property_default(const GParamSpec *spec)
{
    const GValue *value = g_param_spec_get_default_value((GParamSpec *)spec);
    if (G_IS_PARAM_SPEC_ENUM(spec)) {
        const GEnumClass *values = ((const GParamSpecEnum *)spec)->enum_class;
        return g_strdup(g_enum_get_value((GEnumClass *)values, g_value_get_enum(value))->value_nick);
    }
    if (G_IS_PARAM_SPEC_STRING(spec))
        return g_strdup("FILE");
    if (G_IS_PARAM_SPEC_DOUBLE(spec)) {
        char number[G_ASCII_DTOSTR_BUF_SIZE];
        return g_strdup(g_ascii_formatd(number, sizeof number, "%g", g_value_get_double(value)));
    }
    return G_IS_PARAM_SPEC_BOOLEAN(spec) ? g_strdup("") : gst_value_serialize(value);
}

static void show_properties(GstElement *element)
{
    guint count = 0;
    GParamSpec **specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
    int column = 0; /* of three */
    for (guint i = 0; i < count; i++) {
        if (!is_setting(element, specs[i]))
            continue;
        char *value = property_default(specs[i]);
        char *text = g_strdup_printf("--%s%s%s", specs[i]->name, *value ? " " : "", value);
        column = (column + 1) % 3;
        g_print(column ? "  %-23s" : "  %s\n", text);
        g_free(text);
        g_free(value);
    }
    g_print(column ? "\n" : "");
    g_free(specs);
}

static void show_help(void)
{
    g_print("Usage: l1l2stab [OPTION...] IN... [-o OUT]\n"
            "Stabilizes videos. Sound, subtitles, chapters, tags and frame times are kept.\n\n");
    GString *line = g_string_new(NULL);
    for (size_t i = 0; i + 1 < G_N_ELEMENTS(table); i++) {
        const Option *option = &table[i];
        g_string_append(line, line->len ? ", " : "  ");
        if (option->letter)
            g_string_append_printf(line, "-%c, ", option->letter);
        g_string_append_printf(line, "--%s%s%s", option->name, option->value ? " " : "", option->value
                               ? option->value : "");
        if (option->help) {
            g_print("%-42s %s\n", line->str, option->help);
            g_string_truncate(line, 0);
        }
    }
    g_string_free(line, TRUE);
    GstElement *element = new_stabilizer(NULL);
    if (!element)
        return;
    g_print("\nThe stabilizer's own, and their defaults:\n");
    show_properties(element);
    gst_object_unref(element);
}

/* For the completion of shells: a line for each option with its possible values, if they are words. */
static void show_completions(void)
{
    for (size_t i = 0; i + 1 < G_N_ELEMENTS(table); i++) {
        const Option *option = &table[i];
        const char *values = option->type == TYPE_COMPARE                 ? "side split flip"
                             : g_str_equal(option->name, "encoder")       ? "h264 hevc av1 vp9 prores ffv1 list"
                             : option->value && g_str_equal(option->value, "DIR") ? "DIR"
                             : option->value && g_str_equal(option->value, "FILE") ? "FILE"
                             : option->type == TYPE_CROP                  ? "auto"
                             : option->value                              ? "VALUE"
                                                                          : "";
        g_print("--%s %s\n", option->name, values);
    }
    GstElement *element = new_stabilizer(NULL);
    if (!element)
        return;
    guint count = 0;
    GParamSpec **specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(element), &count);
    for (guint i = 0; i < count; i++) {
        if (!is_setting(element, specs[i]))
            continue;
        g_print("--%s", specs[i]->name);
        if (G_IS_PARAM_SPEC_ENUM(specs[i])) {
            const GEnumClass *values = ((const GParamSpecEnum *)specs[i])->enum_class;
            for (guint n = 0; n < values->n_values; n++)
                g_print(" %s", values->values[n].value_nick);
        } else if (!G_IS_PARAM_SPEC_BOOLEAN(specs[i]))
            g_print(" %s", G_IS_PARAM_SPEC_STRING(specs[i]) ? "FILE" : "VALUE");
        g_print("\n");
    }
    g_free(specs);
    gst_object_unref(element);
}

static void show(const Option *option)
{
    if (g_str_equal(option->name, "version"))
        g_print("l1l2stab %s\n", l1l2stab_version());
    else if (g_str_equal(option->name, "help"))
        show_help();
    else
        show_completions();
}

/* ---- values ---- */

/* A number in the C locale that is not negative, or NAN. */
static double number_of(const char *text)
{
    char *end = NULL;
    const double value = g_ascii_strtod(text, &end);
    return end == text || *end || !isfinite(value) || value < 0 ? NAN : value;
}

/* Seconds, minutes:seconds or hours:minutes:seconds; the seconds may have a fraction. NAN: it is none of these. */
static double seconds_of(const char *text)
{
    char **parts = g_strsplit(text, ":", 4);
    double seconds = 0;
    if (g_strv_length(parts) > 3 || g_strv_length(parts) < 1)
        seconds = NAN;
    for (int i = 0; parts[i]; i++)
        seconds = seconds * 60 + number_of(parts[i]);
    g_strfreev(parts);
    return seconds < 1e9 ? seconds : NAN;
}

static gboolean set_compare(Options *options, const char *text, GError **error)
{
    static const char *const names[] = {"", "side", "split", "flip"};
    for (int i = COMPARE_SIDE; i <= COMPARE_FLIP; i++)
        if (g_str_equal(text, names[i])) {
            options->compare = (Compare)i;
            return TRUE;
        }
    return fault(error, EXIT_USAGE, "--compare: '%s' is not side, split or flip", text);
}

static gboolean set_value(Options *options, const Option *option, const char *text, GError **error)
{
    void *field = (char *)options + option->offset;
    double number = NAN;
    switch (option->type) {
    case TYPE_FLAG:
        *(gboolean *)field = TRUE;
        return TRUE;
    case TYPE_TEXT:
        if (!*text)
            return fault(error, EXIT_USAGE, "--%s: its value is empty", option->name);
        g_free(*(char **)field);
        *(char **)field = g_strdup(text);
        return TRUE;
    case TYPE_COMPARE:
        return set_compare(options, text, error);
    case TYPE_CROP:
        options->crop_auto = g_str_equal(text, "auto");
        if (!options->crop_auto)
            add_setting(options, "crop-ratio", text);
        return TRUE;
    case TYPE_TIME:
        number = seconds_of(text);
        break;
    default:
        number = number_of(text);
        break;
    }
    if (isnan(number) || (option->type == TYPE_COUNT && (number != floor(number) || number > 1e9)))
        return fault(error, EXIT_USAGE, "--%s: '%s' is not %s", option->name, text,
                     option->type == TYPE_TIME ? "a time such as 90, 1:30.5 or 0:01:30"
                     : option->type == TYPE_COUNT ? "a whole number" : "a number from 0");
    if (option->type == TYPE_TIME)
        *(gint64 *)field = (gint64)llrint(number * 1e6);
    else if (option->type == TYPE_COUNT)
        *(int *)field = (int)number;
    else
        *(double *)field = number;
    return TRUE;
}

/* ---- the command line ---- */

typedef struct Parser {
    Options *options;
    GstElement *stabilizer;  /* its properties are options too */
    char **argv;
    int argc, next;          /* the argument that is read next */
    GPtrArray *inputs;
    gboolean shown;
    GError **error;
} Parser;

/* The value of an option: behind its = or the next argument. */
static const char *take_value(Parser *parser, const char *name, const char *given)
{
    if (given)
        return given;
    if (parser->next < parser->argc)
        return parser->argv[parser->next++];
    fault(parser->error, EXIT_USAGE, "--%s: its value is missing", name);
    return NULL;
}

static gboolean parse_setting(Parser *parser, const char *name, const char *given)
{
    GParamSpec *spec = parser->stabilizer ? find_setting(parser->stabilizer, name) : NULL;
    if (!spec)
        return fault(parser->error, EXIT_USAGE, "there is no option --%s (--help lists all)", name);
    const char *text = G_IS_PARAM_SPEC_BOOLEAN(spec) ? (given ? given : "true") : take_value(parser, name, given);
    if (!text || !apply_setting(parser->stabilizer, name, text, parser->error))
        return FALSE;
    add_setting(parser->options, name, text);
    return TRUE;
}

static gboolean parse_option(Parser *parser, const Option *option, const char *given)
{
    const char *text = NULL;
    if (option->type == TYPE_SHOW) {
        parser->shown = TRUE;
        show(option);
        return TRUE;
    }
    if (option->value) {
        text = take_value(parser, option->name, given);
        if (!text)
            return FALSE;
    } else if (given)
        return fault(parser->error, EXIT_USAGE, "--%s takes no value", option->name);
    return set_value(parser->options, option, text, parser->error);
}

static gboolean parse_long(Parser *parser, const char *argument)
{
    const char *equals = strchr(argument, '=');
    char *name = equals ? g_strndup(argument, (gsize)(equals - argument)) : g_strdup(argument);
    const Option *option = NULL;
    for (size_t i = 0; i < G_N_ELEMENTS(table) && !option; i++)
        option = g_str_equal(table[i].name, name) ? &table[i] : NULL;
    const gboolean ok = option ? parse_option(parser, option, equals ? equals + 1 : NULL)
                               : parse_setting(parser, name, equals ? equals + 1 : NULL);
    g_free(name);
    return ok;
}

static gboolean parse_short(Parser *parser, const char *argument)
{
    for (size_t i = 0; i < G_N_ELEMENTS(table); i++)
        if (table[i].letter && table[i].letter == argument[0]) {
            if (argument[1] && !table[i].value)
                break;
            return parse_option(parser, &table[i], argument[1] ? argument + 1 : NULL);
        }
    return fault(parser->error, EXIT_USAGE, "there is no option -%s (a file of that name: ./-%s)", argument, argument);
}

static gboolean parse_all(Parser *parser)
{
    gboolean names_only = FALSE;
    while (parser->next < parser->argc && !parser->shown) {
        char *argument = parser->argv[parser->next++];
        gboolean ok = TRUE;
        if (names_only || argument[0] != '-' || !argument[1])
            g_ptr_array_add(parser->inputs, argument);
        else if (g_str_equal(argument, "--"))
            names_only = TRUE;
        else
            ok = argument[1] == '-' ? parse_long(parser, argument + 2) : parse_short(parser, argument + 1);
        if (!ok)
            return FALSE;
    }
    return TRUE;
}

static gboolean uses_setting(const Options *options, const char *name, const char *value)
{
    gboolean uses = FALSE;
    for (guint i = 0; i + 1 < options->settings->len; i += 2)
        if (g_str_equal(options->settings->pdata[i], name))
            uses = g_str_equal(options->settings->pdata[i + 1], value);
    return uses;
}

static gboolean check(const Options *options, GError **error)
{
    const gboolean many = options->batch || options->input_count > 1;
    if (options->input_count == 0)
        return fault(error, EXIT_USAGE,
                     "no input. Usage: l1l2stab [OPTION...] IN... [-o OUT] (--help lists the options)");
    if (many && options->out)
        return fault(error, EXIT_USAGE, "-o names one file, but there are several inputs: use --out-dir");
    if (options->compare && uses_setting(options, "output-size", "crop"))
        return fault(error, EXIT_USAGE, "--compare needs frames of one size: leave out --output-size=crop");
    if (options->report && (options->preview || options->estimate || options->compare))
        return fault(error, EXIT_USAGE, "--report needs a plain output: leave out --preview, --estimate and --compare");
    if (options->report && !report_check(options->report, error))
        return FALSE;
    if (many && options->preview)
        return fault(error, EXIT_USAGE, "--preview shows one file");
    if (options->end_us >= 0 && options->end_us <= options->start_us)
        return fault(error, EXIT_USAGE, "--end has to be later than --start");
    if (options->keep <= 0 || options->keep > 1)
        return fault(error, EXIT_USAGE, "--keep is a share from 0 to 1");
    if (options->bitrate && options->crf >= 0)
        return fault(error, EXIT_USAGE, "--crf and --bitrate exclude each other");
    if (options->format) {
        char *name = g_strconcat("x.", options->format, NULL);
        const gboolean known = container_of(name) != NULL;
        g_free(name);
        if (!known)
            return fault(error, EXIT_USAGE, "--format: '%s' is not one of " CONTAINER_SUFFIXES, options->format);
    }
    return TRUE;
}

OptionsResult options_parse(Options *options, int argc, char **argv, GError **error)
{
    *options = (Options){.stream = ANY_STREAM, .crf = -1, .end_us = -1, .keep = 0.95,
                         .settings = g_ptr_array_new_with_free_func(g_free)};
    GError *missing = NULL;
    Parser parser = {.options = options, .stabilizer = new_stabilizer(&missing), .argv = argv, .argc = argc, .next = 1,
                     .inputs = g_ptr_array_new(), .error = error};
    gboolean ok = parse_all(&parser);
    g_ptr_array_add(parser.inputs, NULL);
    options->input_count = (int)parser.inputs->len - 1;
    options->inputs = (char **)g_ptr_array_free(parser.inputs, FALSE);
    if (ok && !parser.shown && options->encoder && g_str_equal(options->encoder, "list")) {
        encoder_list();
        parser.shown = TRUE;
    }
    if (missing && !parser.shown) {
        g_clear_error(error);
        g_propagate_error(error, missing);
        missing = NULL;
        ok = FALSE;
    }
    g_clear_error(&missing);
    g_clear_object(&parser.stabilizer);
    if (ok && !parser.shown)
        ok = check(options, error);
    return !ok ? OPTIONS_WRONG : parser.shown ? OPTIONS_SHOWN : OPTIONS_RUN;
}

void options_clear(Options *options)
{
    for (size_t i = 0; i < G_N_ELEMENTS(table); i++)
        if (table[i].type == TYPE_TEXT)
            g_clear_pointer((char **)((char *)options + table[i].offset), g_free);
    g_clear_pointer(&options->settings, g_ptr_array_unref);
    g_clear_pointer(&options->inputs, g_free);
}

/* ---- a process for one file of a batch ---- */

static char *value_text(const Options *options, const Option *option)
{
    static const char *const compares[] = {NULL, "side", "split", "flip"};
    const void *field = (const char *)options + option->offset;
    char number[G_ASCII_DTOSTR_BUF_SIZE];
    switch (option->type) {
    case TYPE_FLAG:
        return *(const gboolean *)field ? g_strdup("") : NULL;
    case TYPE_TEXT:
        return g_strdup(*(char *const *)field);
    case TYPE_COUNT:
        return *(const int *)field > 0 || (option->offset == AT(stream) && options->stream == 0)
                   ? g_strdup_printf("%d", *(const int *)field) : NULL;
    case TYPE_NUMBER:
        return *(const double *)field >= 0 ? g_strdup(g_ascii_dtostr(number, sizeof number,
                                                                     *(const double *)field)) : NULL;
    case TYPE_TIME:
        return *(const gint64 *)field > 0
                   ? g_strdup(g_ascii_formatd(number, sizeof number, "%.6f",
                                              (double)*(const gint64 *)field / 1e6)) : NULL;
    case TYPE_COMPARE:
        return g_strdup(compares[options->compare]);
    case TYPE_CROP:
        return options->crop_auto ? g_strdup("auto") : NULL;
    default:
        return NULL;
    }
}

GPtrArray *options_for_one_file(const Options *options)
{
    GPtrArray *arguments = g_ptr_array_new_with_free_func(g_free);
    for (size_t i = 0; i < G_N_ELEMENTS(table); i++) {
        const Option *option = &table[i];
        char *text = option->per_file ? value_text(options, option) : NULL;
        if (text)
            g_ptr_array_add(arguments, option->value ? g_strdup_printf("--%s=%s", option->name, text)
                                                     : g_strdup_printf("--%s", option->name));
        g_free(text);
    }
    for (guint i = 0; i + 1 < options->settings->len; i += 2)
        g_ptr_array_add(arguments, g_strdup_printf("--%s=%s", (char *)options->settings->pdata[i],
                                                   (char *)options->settings->pdata[i + 1]));
    return arguments;
}
