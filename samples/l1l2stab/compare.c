/* SPDX-License-Identifier: MIT */
#include "compare.h"

#include <gst/video/video.h>
#include <string.h>

#define FLIP_NS GST_SECOND

typedef struct Comparison {
    Compare kind;
    GMutex lock;
    GQueue sources;          /* of GstBuffer, in their order */
    GstVideoInfo in, out;    /* of the stabilizer's frames, and of what is made of them */
} Comparison;

static void free_comparison(gpointer data)
{
    Comparison *comparison = data;
    g_queue_clear_full(&comparison->sources, (GDestroyNotify)gst_buffer_unref);
    g_mutex_clear(&comparison->lock);
    g_free(comparison);
}

static GstPadProbeReturn keep_source(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    Comparison *comparison = data;
    g_mutex_lock(&comparison->lock);
    g_queue_push_tail(&comparison->sources, gst_buffer_ref(GST_PAD_PROBE_INFO_BUFFER(info)));
    g_mutex_unlock(&comparison->lock);
    return GST_PAD_PROBE_OK;
}

/* The source frame of a stabilized one: frames come out in the order in which they go in. NULL: it has been dropped. */
static GstBuffer *take_source(Comparison *comparison, GstClockTime pts)
{
    GstBuffer *source;
    g_mutex_lock(&comparison->lock);
    while ((source = g_queue_pop_head(&comparison->sources)) && GST_BUFFER_PTS(source) != pts)
        gst_buffer_unref(source);
    g_mutex_unlock(&comparison->lock);
    return source;
}

/* Bytes from the start of a plane's row to a column. */
static gsize column_offset(const GstVideoFrame *frame, guint plane, int x)
{
    gint components[GST_VIDEO_MAX_COMPONENTS];
    gst_video_format_info_component(frame->info.finfo, plane, components);
    const int sample = GST_VIDEO_FORMAT_INFO_SCALE_WIDTH(frame->info.finfo, components[0], x);
    return (gsize)(sample * GST_VIDEO_FRAME_COMP_PSTRIDE(frame, components[0]));
}

/* Copies the columns [from, to) of a picture to column `at` of another one of the same format and height. */
static void copy_columns(GstVideoFrame *out, int at, const GstVideoFrame *in, int from, int to)
{
    for (guint plane = 0; plane < GST_VIDEO_FRAME_N_PLANES(in); plane++) {
        gint components[GST_VIDEO_MAX_COMPONENTS];
        gst_video_format_info_component(in->info.finfo, plane, components);
        const gsize begin = column_offset(in, plane, from), end = column_offset(in, plane, to);
        guint8 *target = (guint8 *)GST_VIDEO_FRAME_PLANE_DATA(out, plane) + column_offset(out, plane, at);
        const guint8 *source = (const guint8 *)GST_VIDEO_FRAME_PLANE_DATA(in, plane) + begin;
        for (int row = 0; row < GST_VIDEO_FRAME_COMP_HEIGHT(in, components[0]); row++) {
            memcpy(target, source, end - begin);
            target += GST_VIDEO_FRAME_PLANE_STRIDE(out, plane);
            source += GST_VIDEO_FRAME_PLANE_STRIDE(in, plane);
        }
    }
}

/* The first column from x on at which every plane has a sample. */
static int column_from(const GstVideoInfo *info, int x)
{
    int step = 1;
    for (guint i = 0; i < GST_VIDEO_INFO_N_COMPONENTS(info); i++)
        step = MAX(step, 1 << GST_VIDEO_FORMAT_INFO_W_SUB(info->finfo, i));
    return (x + step - 1) / step * step;
}

static void compose(Comparison *comparison, GstBuffer *target, GstBuffer *source, GstBuffer *stabilized)
{
    GstVideoFrame to, before, after;
    const int width = comparison->in.width, middle = column_from(&comparison->in, width / 2);
    const gboolean side = comparison->kind == COMPARE_SIDE;
    if (!gst_video_frame_map(&to, &comparison->out, target, GST_MAP_WRITE))
        return;
    if (gst_video_frame_map(&before, &comparison->in, source, GST_MAP_READ)) {
        copy_columns(&to, 0, &before, 0, side ? width : middle);
        gst_video_frame_unmap(&before);
    }
    if (gst_video_frame_map(&after, &comparison->in, stabilized, GST_MAP_READ)) {
        copy_columns(&to, side ? column_from(&comparison->in, width) : middle, &after, side ? 0 : middle, width);
        gst_video_frame_unmap(&after);
    }
    gst_video_frame_unmap(&to);
}

static GstBuffer *make(Comparison *comparison, GstBuffer *source, GstBuffer *stabilized)
{
    if (comparison->kind == COMPARE_FLIP) {
        const gboolean after = GST_BUFFER_PTS(stabilized) / FLIP_NS % 2;
        return gst_buffer_ref(after ? stabilized : source);
    }
    GstBuffer *target = gst_buffer_new_allocate(NULL, comparison->out.size, NULL);
    gst_buffer_copy_into(target, stabilized, GST_BUFFER_COPY_FLAGS | GST_BUFFER_COPY_TIMESTAMPS, 0, -1);
    gst_buffer_memset(target, 0, 0, comparison->out.size);
    compose(comparison, target, source, stabilized);
    return target;
}

/* The caps of what is made. The width of a doubled picture begins at a sample of every plane. */
static GstEvent *new_caps(Comparison *comparison, GstEvent *event)
{
    GstCaps *caps;
    gst_event_parse_caps(event, &caps);
    if (!gst_video_info_from_caps(&comparison->in, caps))
        return event;
    comparison->out = comparison->in;
    if (comparison->kind != COMPARE_SIDE)
        return event;
    caps = gst_caps_copy(caps);
    gst_caps_set_simple(caps, "width", G_TYPE_INT, column_from(&comparison->in,
                                                               comparison->in.width) + comparison->in.width, NULL);
    gst_video_info_from_caps(&comparison->out, caps);
    GstEvent *wider = gst_event_new_caps(caps);
    gst_event_set_seqnum(wider, gst_event_get_seqnum(event));
    gst_caps_unref(caps);
    gst_event_unref(event);
    return wider;
}

static GstPadProbeReturn compare(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    Comparison *comparison = data;
    if (info->type & GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM) {
        GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
        if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS)
            GST_PAD_PROBE_INFO_DATA(info) = new_caps(comparison, event);
        return GST_PAD_PROBE_OK;
    }
    GstBuffer *stabilized = GST_PAD_PROBE_INFO_BUFFER(info);
    GstBuffer *source = take_source(comparison, GST_BUFFER_PTS(stabilized));
    if (source) {
        GST_PAD_PROBE_INFO_DATA(info) = make(comparison, source, stabilized);
        gst_buffer_unref(stabilized);
        gst_buffer_unref(source);
    }
    return GST_PAD_PROBE_OK;
}

void compare_install(GstElement *stabilizer, Compare kind)
{
    if (kind == COMPARE_NONE)
        return;
    Comparison *comparison = g_new0(Comparison, 1);
    comparison->kind = kind;
    g_mutex_init(&comparison->lock);
    g_queue_init(&comparison->sources);
    GstPad *sink = gst_element_get_static_pad(stabilizer, "sink"), *src = gst_element_get_static_pad(stabilizer, "src");
    gst_pad_add_probe(sink, GST_PAD_PROBE_TYPE_BUFFER, keep_source, comparison, NULL);
    gst_pad_add_probe(src, GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, compare, comparison,
                      free_comparison);
    gst_object_unref(sink);
    gst_object_unref(src);
}
