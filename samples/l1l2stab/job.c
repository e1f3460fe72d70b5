/* SPDX-License-Identifier: MIT */
#include "job.h"

#include "fault.h"
#include "interrupt.h"
#include "output.h"
#include "output_file.h"
#include "report.h"
#include "say.h"

#include <signal.h>

#define PROGRESS_MS 200

typedef struct Job {
    const Options *options;
    Input *input;
    Picture *picture;
    Output *output;            /* NULL: the picture is shown or analyzed */
    GMainLoop *loop;
    GThread *reader;
    gint64 started_us;
    gint stopping;             /* atomic: the reader ends as if the input ended here */
    gboolean interrupted, at_once;
    GError *error;
    Report *report;            /* or NULL */
    JobMessage on_message;     /* or NULL */
    void *cookie;
} Job;

/* ---- the reader's thread ---- */

/* Past the end of the wanted part. Other streams may be ahead of the picture, so it alone decides. */
static gboolean is_past_end(const Job *job, const AVPacket *packet)
{
    const AVStream *video = job->input->video;
    const gint64 end_us = job->options->end_us, dts = input_ticks(job->input, video, packet->dts);
    return end_us >= 0 && packet->stream_index == video->index && dts != AV_NOPTS_VALUE &&
           av_rescale_q(dts, video->time_base, AV_TIME_BASE_Q) >= end_us;
}

static gpointer read_input(gpointer data)
{
    Job *job = data;
    AVPacket *packet = av_packet_alloc();
    gboolean more = TRUE;
    while (more && !g_atomic_int_get(&job->stopping) && input_read(job->input, packet)) {
        if (is_past_end(job, packet))
            more = FALSE;
        else if (packet->stream_index == job->input->video->index)
            more = picture_push(job->picture, packet);
        else if (job->output)
            output_copy(job->output, packet);
        av_packet_unref(packet);
    }
    av_packet_free(&packet);
    if (job->output)
        output_copy_end(job->output);
    picture_push_end(job->picture);
    return NULL;
}

/* ---- the main loop ---- */

static gboolean on_encoded(void *cookie, GstBuffer *buffer, const GstCaps *encoded, const GstCaps *raw, gint64 pts,
                           gint64 dts)
{
    Job *job = cookie;
    return output_picture(job->output, buffer, encoded, raw, pts, dts);
}

static gboolean on_bus(GstBus *bus, GstMessage *message, gpointer data)
{
    Job *job = data;
    switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_EOS:
        g_main_loop_quit(job->loop);
        break;
    case GST_MESSAGE_ERROR:
        /* What the output refuses ends the pipeline as well, and is the cause. */
        if (!job->output || !output_fault(job->output, &job->error))
            picture_explain(job->picture, message, job->error ? NULL : &job->error);
        g_main_loop_quit(job->loop);
        break;
    case GST_MESSAGE_WARNING: {
        GError *warning = NULL;
        gst_message_parse_warning(message, &warning, NULL);
        if (GST_MESSAGE_SRC(message) == GST_OBJECT(picture_stabilizer(job->picture)))
            say_note("%s: %s", job->input->name, warning->message);
        else
            say_detail("%s: %s", job->input->name, warning->message);
        g_clear_error(&warning);
        break;
    }
    case GST_MESSAGE_ELEMENT:
        picture_note_missing(job->picture, message);
        if (job->report)
            report_add(job->report, gst_message_get_structure(message));
        if (job->on_message)
            job->on_message(job->cookie, gst_message_get_structure(message));
        break;
    default:
        break;
    }
    return G_SOURCE_CONTINUE;
}

static void on_interrupt(void *cookie, gboolean at_once)
{
    Job *job = cookie;
    job->interrupted = TRUE;
    g_atomic_int_set(&job->stopping, 1);
    input_cancel(job->input);
    picture_cut(job->picture);
    if (at_once || !job->output) {
        job->at_once = TRUE;
        g_main_loop_quit(job->loop);
    } else
        say_note("interrupted: the frames so far are written (once more: end at once)");
}

/* Of the wanted part, in seconds; 0: not known. */
static double duration_of(const Job *job)
{
    const double end = job->options->end_us >= 0 ? (double)job->options->end_us / 1e6 : G_MAXDOUBLE;
    return MAX(0, MIN(end, (double)input_duration_ns(job->input) / 1e9) - (double)job->options->start_us / 1e6);
}

static Progress progress_of(const Job *job)
{
    gint64 decoded;
    Progress progress = {.file = job->input->name, .duration = duration_of(job),
                         .elapsed = (double)(g_get_monotonic_time() - job->started_us) / G_USEC_PER_SEC,
                         .bytes = job->output ? output_bytes(job->output) : 0};
    picture_progress(job->picture, &decoded, &progress.frames, &progress.seconds);
    return progress;
}

static gboolean on_tick(gpointer data)
{
    const Progress progress = progress_of(data);
    say_progress(&progress);
    return G_SOURCE_CONTINUE;
}

/* Runs the pipeline until it ends, fails or is interrupted. */
static void run(Job *job)
{
    GstBus *bus = picture_bus(job->picture);
    job->loop = g_main_loop_new(NULL, FALSE);
    job->started_us = g_get_monotonic_time();
    const guint watch = gst_bus_add_watch(bus, on_bus, job), tick = g_timeout_add(PROGRESS_MS, on_tick, job);
    interrupt_watch(on_interrupt, job);
    if (job->options->start_us > 0)
        input_seek(job->input, job->options->start_us);
    picture_start(job->picture);
    job->reader = g_thread_new("reader", read_input, job);
    g_main_loop_run(job->loop);

    /* The reader may wait for the input or for the pipeline: both are told to let it go. */
    g_atomic_int_set(&job->stopping, 1);
    if (job->error || job->at_once)
        input_cancel(job->input);
    picture_stop(job->picture);
    g_thread_join(job->reader);
    interrupt_unwatch();
    g_source_remove(tick);
    g_source_remove(watch);
    g_main_loop_unref(job->loop);
    gst_object_unref(bus);
}

Input *job_open(const Options *options, const char *in, GError **error)
{
    Input *input = input_open(in, options->stream, error);
    if (input && input->videos > 1 && options->stream == ANY_STREAM)
        say_note("%s: has %d video streams. Stream %d (%dx%d) is stabilized, the others are copied; --stream chooses",
                 input->name, input->videos, input->video->index, input->video->codecpar->width,
                 input->video->codecpar->height);
    return input;
}

gboolean job_analyze(const Options *options, Input *input, JobMessage on_message, void *cookie, GError **error)
{
    Job job = {.options = options, .input = input, .on_message = on_message, .cookie = cookie};
    job.picture = picture_new(options, input, NULL, PICTURE_ANALYZE, FALSE, (PictureSink){0}, &job.error);
    if (job.picture) {
        g_object_set(picture_stabilizer(job.picture), "post-messages", TRUE, NULL);
        run(&job);
    }
    picture_free(job.picture);
    if (!job.error && job.interrupted)
        fault(&job.error, EXIT_SIGNAL + interrupt_signal(), "%s: interrupted", input->name);
    if (job.error)
        g_propagate_error(error, job.error);
    return !job.error;
}

/* ---- a file ---- */

static gboolean prepare(Job *job, const char *in, const char *out)
{
    const Container *container = out ? container_of(out) : NULL;
    Encoder encoder = {0};
    gboolean ok = TRUE;
    if (out && !container) {
        char *shown = printable(out);
        fault(&job->error, EXIT_USAGE, "%s: the name of an output has to end with " CONTAINER_SUFFIXES, shown);
        g_free(shown);
        return FALSE;
    }
    /* Without one, GStreamer's last resort is DirectFB, which crashes. */
    if (!out && !g_getenv("DISPLAY") && !g_getenv("WAYLAND_DISPLAY"))
        return fault(&job->error, EXIT_OTHER, "--preview: there is no display (DISPLAY is not set)");
    if (out && !output_file_check(out, in, &job->error))
        return FALSE;
    job->input = job_open(job->options, in, &job->error);
    if (!job->input)
        return FALSE;
    if (out) {
        ok = encoder_choose(&encoder, job->options, container, job->input->video, &job->error);
        job->output = ok ? output_new(job->options, job->input, out, container, &job->error) : NULL;
        ok = job->output != NULL;
        if (ok)
            say_detail("%s: %s", job->input->name, encoder.summary);
    }
    const PictureSink sink = {.encoded = on_encoded, .cookie = job};
    if (ok)
        job->picture = picture_new(job->options, job->input, &encoder, out ? PICTURE_ENCODE : PICTURE_SHOW,
                                   !out || output_needs_upright_picture(job->output), sink, &job->error);
    encoder_clear(&encoder);
    if (job->picture && job->options->report)
        job->report = report_new(job->options, job->input, picture_stabilizer(job->picture),
                                 picture_flip_method(job->input), (gint64)(duration_of(job) * GST_SECOND));
    return job->picture != NULL;
}

/* Names the output, or drops it. Returns the exit code. */
static int finish(Job *job)
{
    char *written = NULL;
    int code = EXIT_DONE;
    if (job->input->encrypted) {
        g_clear_error(&job->error);
        input_explain_encryption(job->input, &job->error);
    }
    if (job->interrupted && progress_of(job).frames == 0)
        job->at_once = TRUE; /* there is nothing to be written yet */
    if (job->output && !job->error && !job->at_once)
        output_finish(job->output, job->interrupted, &written, &job->error);
    if (job->report && written && !job->error)
        report_write(job->report, written, &job->error);
    if (job->error)
        code = job->error->code;
    else if (job->interrupted)
        code = EXIT_SIGNAL + interrupt_signal();
    else if (job->input->damage) {
        code = EXIT_DAMAGED;
        say_note("%s: is truncated or damaged (%s): the output has what could be read", job->input->name,
                 job->input->damage);
    } else if (job->output && output_left_out(job->output) > 0) {
        code = EXIT_DAMAGED;
        say_note("%s: is damaged: %d packets of sound or subtitles are left out", job->input->name,
                 output_left_out(job->output));
    }
    if (job->error)
        say_error(job->error->message);
    else if (job->at_once && job->output)
        say_error("interrupted: nothing was written");
    char *shown = written ? printable(written) : NULL;
    const Progress progress = progress_of(job);
    if (!job->error && !job->at_once)
        say_done(&progress, shown, code);
    g_free(shown);
    g_free(written);
    return code;
}

int job_run(const Options *options, const char *in, const char *out)
{
    Job job = {.options = options};
    int code;
    if (prepare(&job, in, out)) {
        run(&job);
        code = finish(&job);
    } else {
        say_error(job.error->message);
        code = job.error->code;
    }
    picture_free(job.picture);
    report_free(job.report);
    output_free(job.output);
    input_close(job.input);
    g_clear_error(&job.error);
    return code;
}
