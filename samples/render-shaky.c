/* SPDX-License-Identifier: MIT */
/*
 * Renders a shaky clip with known camera motion: the test scene, filmed by hand in a slow pan, with a quiet tone. The
 * pixels are the same in every run. Shows how an application feeds frames that it makes into a pipeline.
 *
 *     render-shaky OUT.mp4 [TRUTH.txt]
 *
 *     appsrc ! videoconvert ! x264enc ! h264parse ! mp4mux ! filesink
 *     audiotestsrc ! avenc_aac ! mp4mux
 *
 * TRUTH.txt has a line for each frame t: t and F_t (frame t to frame t-1), nine numbers, row-major, in pixels with the
 * origin at the frame's center.
 */
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>
#include <gst/video/video.h>
#include <stdio.h>
#include <stdlib.h>

#include "synth.h"

#define WIDTH 640
#define HEIGHT 360
#define FPS 30
#define FRAMES 300 /* ten seconds, and as many buffers of the tone */

/* 1600 samples at 48 kHz last as long as a frame. */
#define PIPELINE \
    "appsrc name=frames format=time ! videoconvert ! " \
    "x264enc pass=qual quantizer=20 speed-preset=faster ! h264parse ! queue ! mp4mux name=mux ! filesink name=file " \
    "audiotestsrc freq=330 volume=0.02 samplesperbuffer=1600 num-buffers=" G_STRINGIFY(FRAMES) " ! " \
    "audio/x-raw, rate=48000, channels=1 ! audioconvert ! avenc_aac ! queue ! mux."

/* A walk along a wall: hand shake, a slow pan and a little sensor noise. */
static Synth *film_scene(void)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = WIDTH;
    cfg.height = HEIGHT;
    cfg.fps = FPS;
    cfg.pan_x = 0.8;
    cfg.shake = 6.0;
    cfg.roll = 0.008;
    cfg.zoom = 0.004;
    cfg.noise = 1.5;
    return synth_new(&cfg);
}

typedef struct Film {
    Synth *synth;
    GstVideoInfo info;
    int t; /* the next frame */
} Film;

static GstBuffer *render_frame(const Synth *synth, const GstVideoInfo *info, int t)
{
    GstBuffer *buffer = gst_buffer_new_allocate(NULL, GST_VIDEO_INFO_SIZE(info), NULL);
    GstVideoFrame frame;
    uint8_t *data[4] = {NULL};
    ptrdiff_t stride[4] = {0};

    if (!gst_video_frame_map(&frame, info, buffer, GST_MAP_WRITE)) {
        gst_buffer_unref(buffer);
        return NULL;
    }
    for (guint i = 0; i < GST_VIDEO_FRAME_N_PLANES(&frame); i++) {
        data[i] = GST_VIDEO_FRAME_PLANE_DATA(&frame, i);
        stride[i] = GST_VIDEO_FRAME_PLANE_STRIDE(&frame, i);
    }
    synth_render(synth, t, L1L2STAB_FORMAT_I420, data, stride);
    gst_video_frame_unmap(&frame);

    GST_BUFFER_PTS(buffer) = gst_util_uint64_scale((guint64)t, GST_SECOND, FPS);
    GST_BUFFER_DURATION(buffer) = gst_util_uint64_scale((guint64)t + 1, GST_SECOND, FPS) - GST_BUFFER_PTS(buffer);
    return buffer;
}

/* The pipeline asks for the next frame. This runs in a streaming thread. */
static void on_need_data(GstAppSrc *source, guint bytes, gpointer data)
{
    Film *film = data;
    GstBuffer *buffer = film->t < FRAMES ? render_frame(film->synth, &film->info, film->t++) : NULL;
    (void)bytes;
    if (buffer)
        gst_app_src_push_buffer(source, buffer);
    else
        gst_app_src_end_of_stream(source);
}

static void connect_film(GstElement *pipeline, Film *film)
{
    gst_video_info_set_format(&film->info, GST_VIDEO_FORMAT_I420, WIDTH, HEIGHT);
    film->info.fps_n = FPS;
    film->info.fps_d = 1;

    GstElement *source = gst_bin_get_by_name(GST_BIN(pipeline), "frames");
    GstCaps *caps = gst_video_info_to_caps(&film->info);
    GstAppSrcCallbacks callbacks = {.need_data = on_need_data};
    gst_app_src_set_caps(GST_APP_SRC(source), caps);
    gst_app_src_set_callbacks(GST_APP_SRC(source), &callbacks, film, NULL);
    gst_caps_unref(caps);
    gst_object_unref(source);
}

/* Waits for the end. Returns FALSE if that was an error. */
static gboolean wait_for_end(GstElement *pipeline)
{
    GstBus *bus = gst_element_get_bus(pipeline);
    GstMessage *message = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_EOS | GST_MESSAGE_ERROR);
    const gboolean ok = GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS;
    if (!ok) {
        GError *error = NULL;
        gst_message_parse_error(message, &error, NULL);
        g_printerr("render-shaky: %s\n", error->message);
        g_clear_error(&error);
    }
    gst_message_unref(message);
    gst_object_unref(bus);
    return ok;
}

static gboolean render_clip(Synth *synth, const char *out)
{
    Film film = {.synth = synth};
    GError *error = NULL;
    GstElement *pipeline = gst_parse_launch_full(PIPELINE, NULL, GST_PARSE_FLAG_FATAL_ERRORS, &error);
    if (!pipeline) {
        g_printerr("render-shaky: %s (are the packages in .ci/packages installed?)\n", error->message);
        g_clear_error(&error);
        return FALSE;
    }
    connect_film(pipeline, &film);
    GstElement *file = gst_bin_get_by_name(GST_BIN(pipeline), "file");
    g_object_set(file, "location", out, NULL);
    gst_object_unref(file);

    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    const gboolean ok = wait_for_end(pipeline);
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
    if (!ok)
        remove(out);
    return ok;
}

static gboolean write_truth(const Synth *synth, const char *path)
{
    FILE *file = fopen(path, "w");
    if (!file) {
        perror(path);
        return FALSE;
    }
    fprintf(file, "# t, F_t: frame t to frame t-1, row-major, pixels, origin at the center of %dx%d\n", WIDTH, HEIGHT);
    for (int t = 0; t < FRAMES; t++) {
        double F[9];
        synth_motion(synth, t, F);
        fprintf(file, "%d", t);
        for (int i = 0; i < 9; i++)
            fprintf(file, " %.12g", F[i]);
        fputc('\n', file);
    }
    const gboolean written = !ferror(file);
    if (fclose(file) != 0 || !written) {
        perror(path);
        return FALSE;
    }
    return TRUE;
}

int main(int argc, char **argv)
{
    gst_init(&argc, &argv);
    if (argc < 2 || argc > 3) {
        g_printerr("usage: render-shaky OUT.mp4 [TRUTH.txt]\n");
        return 2;
    }
    Synth *synth = film_scene();
    const gboolean ok = render_clip(synth, argv[1]) && (argc < 3 || write_truth(synth, argv[2]));
    synth_free(synth);
    return ok ? EXIT_SUCCESS : EXIT_FAILURE;
}
