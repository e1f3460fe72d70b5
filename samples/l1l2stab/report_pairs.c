/* SPDX-License-Identifier: MIT */
#include "report_pairs.h"

#include <gst/video/video.h>

#define PAIRS 6
#define LONGER_SIDE 960              /* pixels of a picture in the page */
#define FIRST_NS ((GstClockTime)GST_SECOND / 2) /* of a video whose duration is not known: 0.5 s, 1 s, 2 s ... */
#define CONVERT_TIMEOUT (10 * GST_SECOND)

typedef struct Pair {
    GstClockTime pts;
    char *before, *after; /* base64 of JPEG, or NULL */
} Pair;

struct ReportPairs {
    gint64 duration;
    GstClockTime first_pts; /* of the video */
    GMutex lock;            /* for what follows */
    Pair pairs[PAIRS];
    int before, after;      /* number of pairs that have the picture, or for which it could not be made */
};

/* When the next pair is wanted, from the first frame. */
static GstClockTime wanted_time(const ReportPairs *pairs)
{
    const guint i = (guint)pairs->before;
    return pairs->duration > 0 ? (GstClockTime)pairs->duration * (2 * i + 1) / (2 * PAIRS) : FIRST_NS << i;
}

/* The caps of the picture in the page: square pixels, and no larger than needed. */
static GstCaps *page_caps(const GstVideoInfo *info)
{
    const double width = (double)info->width * info->par_n / info->par_d, height = info->height;
    const double scale = MIN(1, LONGER_SIDE / MAX(width, height));
    return gst_caps_new_simple("image/jpeg", "width", G_TYPE_INT, MAX(16, (int)(width * scale)), "height", G_TYPE_INT,
                               MAX(16, (int)(height * scale)), "pixel-aspect-ratio", GST_TYPE_FRACTION, 1, 1, NULL);
}

static char *picture_of(GstPad *pad, GstBuffer *buffer)
{
    GstCaps *caps = gst_pad_get_current_caps(pad), *wanted;
    GstVideoInfo info;
    char *text = NULL;
    if (caps && gst_video_info_from_caps(&info, caps)) {
        GstSample *sample = gst_sample_new(buffer, caps, NULL, NULL);
        wanted = page_caps(&info);
        GstSample *jpeg = gst_video_convert_sample(sample, wanted, CONVERT_TIMEOUT, NULL);
        GstMapInfo map;
        if (jpeg && gst_buffer_map(gst_sample_get_buffer(jpeg), &map, GST_MAP_READ)) {
            text = g_base64_encode(map.data, map.size);
            gst_buffer_unmap(gst_sample_get_buffer(jpeg), &map);
        }
        g_clear_pointer(&jpeg, gst_sample_unref);
        gst_caps_unref(wanted);
        gst_sample_unref(sample);
    }
    g_clear_pointer(&caps, gst_caps_unref);
    return text;
}

static GstPadProbeReturn on_source(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    ReportPairs *pairs = data;
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    const GstClockTime pts = GST_BUFFER_PTS(buffer);
    if (pairs->first_pts == GST_CLOCK_TIME_NONE)
        pairs->first_pts = pts;
    if (pairs->before == PAIRS || pts < pairs->first_pts + wanted_time(pairs))
        return GST_PAD_PROBE_OK;
    char *picture = picture_of(pad, buffer);
    g_mutex_lock(&pairs->lock);
    pairs->pairs[pairs->before++] = (Pair){.pts = pts, .before = picture};
    g_mutex_unlock(&pairs->lock);
    return GST_PAD_PROBE_OK;
}

/* Frames come out in the order in which they go in. */
static GstPadProbeReturn on_stabilized(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    ReportPairs *pairs = data;
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    g_mutex_lock(&pairs->lock);
    Pair *pair = pairs->after < pairs->before ? &pairs->pairs[pairs->after] : NULL;
    g_mutex_unlock(&pairs->lock);
    if (pair && GST_BUFFER_PTS(buffer) >= pair->pts) {
        pair->after = GST_BUFFER_PTS(buffer) == pair->pts ? picture_of(pad, buffer) : NULL;
        pairs->after++;
    }
    return GST_PAD_PROBE_OK;
}

static void add_probe(GstElement *element, const char *name, GstPadProbeCallback probe, ReportPairs *pairs)
{
    GstPad *pad = gst_element_get_static_pad(element, name);
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, probe, pairs, NULL);
    gst_object_unref(pad);
}

ReportPairs *report_pairs_new(GstElement *stabilizer, gint64 duration)
{
    ReportPairs *pairs = g_new0(ReportPairs, 1);
    pairs->duration = duration;
    pairs->first_pts = GST_CLOCK_TIME_NONE;
    g_mutex_init(&pairs->lock);
    add_probe(stabilizer, "sink", on_source, pairs);
    add_probe(stabilizer, "src", on_stabilized, pairs);
    return pairs;
}

void report_pairs_free(ReportPairs *pairs)
{
    for (int i = 0; i < PAIRS; i++) {
        g_free(pairs->pairs[i].before);
        g_free(pairs->pairs[i].after);
    }
    g_mutex_clear(&pairs->lock);
    g_free(pairs);
}

void report_pairs_write(const ReportPairs *pairs, GString *json)
{
    const char *separator = "[";
    for (int i = 0; i < pairs->before; i++) {
        const Pair *pair = &pairs->pairs[i];
        char time[G_ASCII_DTOSTR_BUF_SIZE];
        if (!pair->before || !pair->after)
            continue;
        g_ascii_formatd(time, sizeof time, "%.3f", (double)(pair->pts - pairs->first_pts) / GST_SECOND);
        g_string_append_printf(json, "%s{\"time\": %s, \"before\": \"data:image/jpeg;base64,%s\", "
                                     "\"after\": \"data:image/jpeg;base64,%s\"}", separator, time, pair->before,
                               pair->after);
        separator = ", ";
    }
    g_string_append(json, *separator == '[' ? "[]" : "]");
}
