/* SPDX-License-Identifier: MIT */
/*
 * l1l2stab: stabilizes video files. An application of the l1l2stab element.
 *
 * libavformat reads the file and writes the new one; GStreamer decodes, stabilizes and encodes the picture between
 * them. Everything else is copied as it is. Why not GStreamer's demuxers and muxers? On the inputs of
 * tests/command/kinds.py they lose chapters, time code, date, location, HDR10's side data, frames at an edit list, and
 * the first and last packet of AAC; and this program would have to link every further stream. docs/command.md has the
 * table. One demuxer also means one clock for sound and picture.
 *
 *     main            this file: the command line's work, the exit code
 *     options         the command line: one table, and the element's properties
 *     job             one input, one output: threads, main loop, end
 *     input           reading, choice of the stream, what is wrong with a file
 *     truncation      is the end of a file missing?
 *     picture         the pipeline: decode, stabilize, encode
 *     codecs          libavformat's codecs <-> GStreamer's caps
 *     encoder         choice and settings of the encoder
 *     compare         before and after in one picture
 *     output          the new container: what is copied, in which order
 *     audio_convert, subtitle_convert    for containers that do not take the input's kind
 *     output_file     the file that has its name only when it is complete
 *     batch           many files, a process each
 *     analysis        the measured motion, and what other settings would make of it
 *     estimate        analysis alone, and --crop auto
 *     report, report_pairs, report/      --report: numbers, pictures, and the page that shows them
 *     interrupt, say, fault              signals; what is printed; errors and exit codes
 */
#include "batch.h"
#include "estimate.h"
#include "fault.h"
#include "input.h"
#include "job.h"
#include "options.h"
#include "say.h"

#include <gst/gst.h>
#include <locale.h>
#include <stdio.h>
#include <string.h>

/* A folder for plugins that GStreamer does not search, such as that of /usr/local, has to be shown to it. */
static void find_element(void)
{
    GstElementFactory *factory = gst_element_factory_find("l1l2stab");
    if (!factory)
        gst_registry_scan_path(gst_registry_get(), PLUGIN_DIR);
    g_clear_object(&factory);
}

static int run(const Options *options)
{
    if (options->out_dir)
        g_mkdir_with_parents(options->out_dir, 0777);
    if (options->batch || options->input_count > 1)
        return batch_run(options);
    const char *in = options->inputs[0];
    if (options->estimate)
        return estimate_run(options, in);
    if (options->preview)
        return job_run(options, in, NULL);
    char *out = batch_output_name(options, in);
    Options chosen = *options;
    int code = EXIT_DONE;
    if (options->crop_auto)
        code = estimate_choose_crop(&chosen, in);
    if (code == EXIT_DONE)
        code = job_run(&chosen, in, out);
    g_free(out);
    return code;
}

int main(int argc, char **argv)
{
    Options options;
    GError *error = NULL;
    int code = EXIT_DONE;

    setlocale(LC_ALL, "");
    gst_init(NULL, NULL);
    find_element();
    const OptionsResult result = options_parse(&options, argc, argv, &error);
    say_init(options.json, options.quiet, options.verbose);
    input_log_to(options.verbose);
    if (result == OPTIONS_RUN)
        code = run(&options);
    else if (result == OPTIONS_WRONG) {
        say_error(error->message);
        code = error->code;
    }
    if (fflush(stdout) != 0 && result == OPTIONS_SHOWN)
        code = EXIT_OTHER;
    g_clear_error(&error);
    options_clear(&options);
    gst_deinit();
    return code;
}
