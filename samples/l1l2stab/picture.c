/* SPDX-License-Identifier: MIT */
#include "picture.h"

#include "codecs.h"
#include "compare.h"
#include "fault.h"
#include "say.h"

#include <gst/app/gstappsink.h>
#include <gst/app/gstappsrc.h>
#include <gst/pbutils/missing-plugins.h>
#include <gst/video/video.h>
#include <libavutil/display.h>
#include <math.h>
#include <string.h>

#define NANOSECONDS ((AVRational){1, 1000000000})
#define QUEUE_BYTES (8 << 20) /* compressed video in front of the decoder */
#define QUEUE_PACKETS 30
#define LEAD_NS GST_SECOND    /* room for frames that come before one with a negative time */

/* fields=top: one frame for each frame, so that the number of the frames and their times stay. */
#define FRONT \
    "appsrc name=packets format=time block=true ! decodebin name=decoder " \
    "queue name=decoded max-size-buffers=4 max-size-bytes=0 max-size-time=0 ! videoconvert ! " \
    "deinterlace name=deinterlace fields=top method=yadif ! videoconvert ! capsfilter name=format ! " \
    "l1l2stab name=stabilizer"
#define BACK \
    "videoscale name=fit add-borders=true ! capsfilter name=size ! videocrop name=even ! " \
    "queue max-size-buffers=4 max-size-bytes=0 max-size-time=0 ! "

struct Picture {
    const Input *input;
    const Options *options;
    GstElement *pipeline;
    GstElement *source, *stabilizer, *sink, *encoder; /* the pipeline's; encoder and sink may be NULL */
    PictureSink to;
    gboolean even_size;
    GstCaps *raw;             /* of the picture that is encoded; set before the first packet comes out */
    gint64 lead_ns;           /* added to all times: GStreamer has none below 0 */
    gboolean has_lead;
    gint64 last_pts;          /* of the decoded frames; GStreamer's time */
    gint cut;                 /* atomic */
    GMutex lock;              /* for what follows */
    GSequence *times;         /* gint64: of the packets whose frames have not been decoded yet */
    GQueue fields;            /* gint64 *: of the frames that are in the deinterlacer */
    GHashTable *discarded;    /* times of packets that are decoded but not shown, because of an edit list */
    gint64 decoded, encoded;
    gint64 reached_ns;
    char *missing;            /* what GStreamer has no plugin for */
    int width, height;        /* of the first frame that was encoded; 0: none yet */
};

static void say_caps(const Picture *picture, const char *what, const GstCaps *caps)
{
    char *text = gst_caps_to_string(caps);
    say_detail("%s: %s %s", picture->input->name, what, text);
    g_free(text);
}

static gint64 *new_time(GstClockTime time)
{
    gint64 *copy = g_new(gint64, 1);
    *copy = (gint64)time;
    return copy;
}

static gint by_time(gconstpointer a, gconstpointer b, gpointer data)
{
    const gint64 x = *(const gint64 *)a, y = *(const gint64 *)b;
    return (x > y) - (x < y);
}

/* ---- packets ---- */

static GstBuffer *buffer_of(Picture *picture, const AVPacket *packet)
{
    const AVStream *stream = picture->input->video;
    const gint64 shown = packet->pts != AV_NOPTS_VALUE ? packet->pts : packet->dts;
    const gint64 ticks = input_ticks(picture->input, stream, shown);
    GstBuffer *buffer = gst_buffer_new_memdup(packet->data, (gsize)packet->size);
    if (shown != AV_NOPTS_VALUE) {
        const gint64 time = av_rescale_q(ticks, stream->time_base, NANOSECONDS);
        if (!picture->has_lead && time < 0)
            picture->lead_ns = LEAD_NS - time;
        picture->has_lead = TRUE;
        /* Containers such as AVI only have decoding times. The n-th frame that is shown has the n-th of them. */
        if (packet->pts == AV_NOPTS_VALUE)
            g_sequence_insert_sorted(picture->times, new_time((GstClockTime)MAX(0, time + picture->lead_ns)), by_time,
                                     NULL);
        else
            GST_BUFFER_PTS(buffer) = (GstClockTime)MAX(0, time + picture->lead_ns);
    }
    if (packet->duration > 0)
        GST_BUFFER_DURATION(buffer) = (GstClockTime)av_rescale_q(packet->duration, stream->time_base, NANOSECONDS);
    if (!(packet->flags & AV_PKT_FLAG_KEY))
        GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_DELTA_UNIT);
    return buffer;
}

gboolean picture_push(Picture *picture, const AVPacket *packet)
{
    if (packet->size <= 0)
        return TRUE;
    g_mutex_lock(&picture->lock);
    GstBuffer *buffer = buffer_of(picture, packet);
    if (packet->flags & AV_PKT_FLAG_DISCARD)
        g_hash_table_add(picture->discarded, new_time(GST_BUFFER_PTS(buffer)));
    else if (GST_BUFFER_PTS_IS_VALID(buffer))
        g_sequence_insert_sorted(picture->times, new_time(GST_BUFFER_PTS(buffer)), by_time, NULL);
    g_mutex_unlock(&picture->lock);
    return gst_app_src_push_buffer(GST_APP_SRC(picture->source), buffer) == GST_FLOW_OK;
}

void picture_push_end(Picture *picture)
{
    gst_app_src_end_of_stream(GST_APP_SRC(picture->source));
}

void picture_cut(Picture *picture)
{
    g_atomic_int_set(&picture->cut, 1);
}

/* ---- decoded frames ---- */

/* The time of a decoded frame from the input's origin, in microseconds. */
static gint64 input_time_us(const Picture *picture, gint64 pts)
{
    return (pts - picture->lead_ns) / 1000;
}

static gboolean is_wanted(Picture *picture, gint64 pts)
{
    const gint64 time = input_time_us(picture, pts), end = picture->options->end_us;
    return (picture->options->start_us == 0 || time >= picture->options->start_us) && (end < 0 || time < end);
}

/*
 * The time of a frame. Some decoders give none, or that of an earlier frame (avdec_gif of 1.22): such a frame has the
 * earliest time that a packet had and no frame. Some files give two frames the same time, which no container takes: the
 * second one is moved by a tick.
 */
static gint64 frame_time(Picture *picture, const GstBuffer *buffer)
{
    const gint64 tick = MAX(1000, av_rescale_q(1, picture->input->video->time_base, NANOSECONDS) + 1);
    gint64 pts = GST_BUFFER_PTS_IS_VALID(buffer) ? (gint64)GST_BUFFER_PTS(buffer) : -1;
    GSequenceIter *first;
    while (!g_sequence_iter_is_end(first = g_sequence_get_begin_iter(picture->times))) {
        const gint64 earliest = *(gint64 *)g_sequence_get(first);
        if (pts <= picture->last_pts && earliest > picture->last_pts)
            pts = earliest;
        if (earliest > pts)
            break;
        g_sequence_remove(first);
    }
    return pts > picture->last_pts ? pts : picture->last_pts + tick;
}

static void set_time(GstPadProbeInfo *info, gint64 pts)
{
    GstBuffer *buffer = GST_PAD_PROBE_INFO_BUFFER(info);
    if (GST_BUFFER_PTS_IS_VALID(buffer) && pts == (gint64)GST_BUFFER_PTS(buffer))
        return;
    buffer = gst_buffer_make_writable(buffer);
    GST_BUFFER_PTS(buffer) = (GstClockTime)pts;
    GST_PAD_PROBE_INFO_DATA(info) = buffer;
}

/* Gives each frame its time, and drops those that are not wanted. */
static GstPadProbeReturn on_decoded(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    Picture *picture = data;
    g_mutex_lock(&picture->lock);
    const gint64 given = (gint64)GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info));
    const gboolean discarded = g_hash_table_contains(picture->discarded, &given);
    const gint64 pts = discarded ? given : frame_time(picture, GST_PAD_PROBE_INFO_BUFFER(info));
    const gboolean wanted = !discarded && !g_atomic_int_get(&picture->cut) && is_wanted(picture, pts);
    picture->decoded += wanted;
    if (!discarded)
        picture->last_pts = pts;
    g_mutex_unlock(&picture->lock);
    if (!wanted)
        return GST_PAD_PROBE_DROP;
    set_time(info, pts);
    return GST_PAD_PROBE_OK;
}

/* The deinterlacer gives a wrong time to some frames,
    and doubles the last one. But its n-th frame is made of the n-th. */
static GstPadProbeReturn on_interlaced(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    Picture *picture = data;
    g_mutex_lock(&picture->lock);
    g_queue_push_tail(&picture->fields, new_time(GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info))));
    g_mutex_unlock(&picture->lock);
    return GST_PAD_PROBE_OK;
}

static GstPadProbeReturn on_deinterlaced(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    Picture *picture = data;
    g_mutex_lock(&picture->lock);
    gint64 *time = g_queue_pop_head(&picture->fields);
    g_mutex_unlock(&picture->lock);
    if (!time)
        return GST_PAD_PROBE_DROP;
    set_time(info, *time);
    g_free(time);
    return GST_PAD_PROBE_OK;
}

static void on_decoder_pad(GstElement *decoder, GstPad *pad, gpointer data)
{
    Picture *picture = data;
    GstElement *decoded = gst_bin_get_by_name(GST_BIN(picture->pipeline), "decoded");
    GstPad *sink = gst_element_get_static_pad(decoded, "sink");
    if (!gst_pad_is_linked(sink)) {
        gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_decoded, picture, NULL);
        gst_pad_link(pad, sink);
    }
    gst_object_unref(sink);
    gst_object_unref(decoded);
}

/* ---- the size ---- */

static void set_caps(Picture *picture, const char *name, GstCaps *caps)
{
    GstElement *filter = gst_bin_get_by_name(GST_BIN(picture->pipeline), name);
    g_object_set(filter, "caps", caps, NULL);
    gst_object_unref(filter);
    gst_caps_unref(caps);
}

/* Most encoders take even sizes only. The last column or row is cut off, which is less than the crop window does. */
static void cut_odd(Picture *picture)
{
    const int right = picture->width & 1, bottom = picture->height & 1;
    if (!picture->even_size || (!right && !bottom))
        return;
    GstElement *even = gst_bin_get_by_name(GST_BIN(picture->pipeline), "even");
    g_object_set(even, "right", right, "bottom", bottom, NULL);
    gst_object_unref(even);
    say_note("%s: the picture has %dx%d pixels, and the encoder takes even sizes only: the last %s cut off",
             picture->input->name, picture->width, picture->height,
             right && bottom ? "column and row are" : right ? "column is" : "row is");
}

/* A container has one size. A film whose size changes is scaled to the first one, with borders if the shape changes. */
static GstPadProbeReturn on_size(GstPad *pad, GstPadProbeInfo *probe, gpointer data)
{
    Picture *picture = data;
    GstEvent *event = GST_PAD_PROBE_INFO_EVENT(probe);
    GstCaps *caps;
    GstVideoInfo info;
    if (GST_EVENT_TYPE(event) != GST_EVENT_CAPS)
        return GST_PAD_PROBE_OK;
    gst_event_parse_caps(event, &caps);
    if (!gst_video_info_from_caps(&info, caps))
        return GST_PAD_PROBE_OK;
    if (picture->width == 0) {
        picture->width = info.width;
        picture->height = info.height;
        set_caps(picture, "size", gst_caps_new_simple("video/x-raw", "width", G_TYPE_INT, info.width, "height",
                                                      G_TYPE_INT,
                                                      info.height, "pixel-aspect-ratio", GST_TYPE_FRACTION, info.par_n,
                                                      info.par_d, NULL));
        cut_odd(picture);
    } else if (info.width != picture->width || info.height != picture->height)
        say_note("%s: the picture's size changes to %dx%d: it is scaled to %dx%d, as the container has one size",
                 picture->input->name, info.width, info.height, picture->width, picture->height);
    return GST_PAD_PROBE_OK;
}

/* ---- encoded packets ---- */

static GstPadProbeReturn on_raw_caps(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    Picture *picture = data;
    GstEvent *event = GST_PAD_PROBE_INFO_EVENT(info);
    if (GST_EVENT_TYPE(event) == GST_EVENT_CAPS && !picture->raw) {
        GstCaps *caps;
        gst_event_parse_caps(event, &caps);
        picture->raw = gst_caps_ref(caps);
        say_caps(picture, "encoded from", caps);
    }
    return GST_PAD_PROBE_OK;
}

/* A time of the encoder's stream, which may begin anywhere, from the start of the output. */
static gint64 output_time(const Picture *picture, const GstSegment *segment, GstClockTime time)
{
    guint64 stream_time = 0;
    const int sign = gst_segment_to_stream_time_full(segment, GST_FORMAT_TIME, time, &stream_time);
    return (sign < 0
            ? -(gint64)stream_time : (gint64)stream_time) - picture->lead_ns - picture->options->start_us * 1000;
}

static GstFlowReturn on_encoded(GstAppSink *sink, gpointer data)
{
    Picture *picture = data;
    GstSample *sample = gst_app_sink_pull_sample(sink);
    if (!sample)
        return GST_FLOW_EOS;
    GstBuffer *buffer = gst_sample_get_buffer(sample);
    const GstSegment *segment = gst_sample_get_segment(sample);
    const gint64 pts = output_time(picture, segment, GST_BUFFER_PTS(buffer));
    const gint64 dts = GST_BUFFER_DTS_IS_VALID(buffer) ? output_time(picture, segment, GST_BUFFER_DTS(buffer)) : pts;
    const gboolean ok = picture->to.encoded(picture->to.cookie, buffer, gst_sample_get_caps(sample), picture->raw,
                                            pts, dts);
    g_mutex_lock(&picture->lock);
    picture->encoded++;
    picture->reached_ns = MAX(picture->reached_ns, pts);
    g_mutex_unlock(&picture->lock);
    gst_sample_unref(sample);
    return ok ? GST_FLOW_OK : GST_FLOW_ERROR;
}

/* Without an encoder, the stabilizer's frames are counted. */
static GstPadProbeReturn on_stabilized(GstPad *pad, GstPadProbeInfo *info, gpointer data)
{
    Picture *picture = data;
    const gint64 pts = (gint64)GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info));
    g_mutex_lock(&picture->lock);
    picture->encoded++;
    picture->reached_ns = pts - picture->lead_ns - picture->options->start_us * 1000;
    g_mutex_unlock(&picture->lock);
    return GST_PAD_PROBE_OK;
}

/* ---- building ---- */

/* How videoflip turns a picture upright that has this display matrix. NULL: it is upright. */
static const char *flip_method(const int32_t *matrix)
{
    static const char *const plain[] = {NULL, "90r", "180", "90l"};
    static const char *const mirrored[] = {"horiz", "ul-lr", "vert", "ur-ll"};
    int32_t turn[9];
    memcpy(turn, matrix, sizeof turn);
    const gboolean mirror = (double)turn[0] * turn[4] - (double)turn[1] * turn[3] < 0;
    if (mirror) /* what is left then is a rotation, which happens after the mirroring */
        av_display_matrix_flip(turn, 1, 0);
    const double angle = -av_display_rotation_get(turn);
    const int quarters = isnan(angle) ? 0 : ((int)lrint(angle / 90) % 4 + 4) % 4;
    return mirror ? mirrored[quarters] : plain[quarters];
}

const char *picture_flip_method(const Input *input)
{
    const int32_t *matrix = (const void *)av_stream_get_side_data(input->video, AV_PKT_DATA_DISPLAYMATRIX, NULL);
    return matrix ? flip_method(matrix) : NULL;
}

static char *flip_element(const Input *input, gboolean upright)
{
    const char *method = upright ? picture_flip_method(input) : NULL;
    return method ? g_strdup_printf("videoflip video-direction=%s ! ", method) : g_strdup("");
}

static char *launch_text(const Input *input, const Encoder *encoder, PictureEnd end, gboolean upright)
{
    if (end == PICTURE_ANALYZE)
        return g_strdup(FRONT " ! fakesink sync=false");
    char *flip = flip_element(input, upright), *text = NULL;
    if (end == PICTURE_SHOW)
        text = g_strconcat(FRONT " ! ", flip, BACK, "videoconvert ! autovideosink", NULL);
    else
        text = g_strconcat(FRONT " ! ", flip, BACK, encoder->launch,
                           " ! appsink name=sink sync=false max-buffers=16", NULL);
    g_free(flip);
    return text;
}

static GstElement *element_named(const Picture *picture, const char *name)
{
    GstElement *element = gst_bin_get_by_name(GST_BIN(picture->pipeline), name);
    gst_object_unref(element); /* the pipeline keeps it */
    return element;
}

static void add_probe(GstElement *element, const char *pad_name, GstPadProbeType type, GstPadProbeCallback probe,
                      Picture *picture)
{
    GstPad *pad = gst_element_get_static_pad(element, pad_name);
    gst_pad_add_probe(pad, type, probe, picture, NULL);
    gst_object_unref(pad);
}

static gboolean set_encoder_properties(GstElement *element, char **properties, GError **error)
{
    for (int i = 0; properties && properties[i]; i += 2) {
        GParamSpec *spec = g_object_class_find_property(G_OBJECT_GET_CLASS(element), properties[i]);
        GValue value = G_VALUE_INIT;
        if (!spec)
            return fault(error, EXIT_USAGE, "--encoder: it has no property '%s'", properties[i]);
        g_value_init(&value, spec->value_type);
        const gboolean ok = gst_value_deserialize_with_pspec(&value, properties[i + 1], spec) &&
                            !g_param_value_validate(spec, &value);
        if (ok)
            g_object_set_property(G_OBJECT(element), properties[i], &value);
        else
            fault(error, EXIT_USAGE, "--encoder: '%s' is not a valid value of %s", properties[i + 1], properties[i]);
        g_value_unset(&value);
        if (!ok)
            return FALSE;
    }
    return TRUE;
}

static void connect_ends(Picture *picture, PictureEnd end)
{
    GstCaps *caps = codecs_caps(picture->input->format, picture->input->video);
    say_caps(picture, "decoded from", caps);
    g_object_set(picture->source, "caps", caps, "max-bytes", (guint64)QUEUE_BYTES, "max-buffers",
                 (guint64)QUEUE_PACKETS, NULL);
    gst_caps_unref(caps);
    add_probe(element_named(picture, "deinterlace"), "sink", GST_PAD_PROBE_TYPE_BUFFER, on_interlaced, picture);
    add_probe(element_named(picture, "deinterlace"), "src", GST_PAD_PROBE_TYPE_BUFFER, on_deinterlaced, picture);
    g_signal_connect(element_named(picture, "decoder"), "pad-added", G_CALLBACK(on_decoder_pad), picture);
    if (end == PICTURE_ENCODE) {
        GstAppSinkCallbacks callbacks = {.new_sample = on_encoded};
        gst_app_sink_set_callbacks(GST_APP_SINK(picture->sink), &callbacks, picture, NULL);
        add_probe(picture->encoder, "sink", GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, on_raw_caps, picture);
    } else
        add_probe(picture->stabilizer, "src", GST_PAD_PROBE_TYPE_BUFFER, on_stabilized, picture);
    if (end != PICTURE_ANALYZE)
        add_probe(element_named(picture, "fit"), "sink", GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, on_size, picture);
}

static gboolean build(Picture *picture, const Encoder *encoder, PictureEnd end, gboolean upright, GError **error)
{
    GError *problem = NULL;
    char *text = launch_text(picture->input, encoder, end, upright);
    picture->pipeline = gst_parse_launch_full(text, NULL, GST_PARSE_FLAG_FATAL_ERRORS, &problem);
    g_free(text);
    if (!picture->pipeline) {
        fault(error, EXIT_PLUGIN, "%s (Debian's packages gstreamer1.0-plugins-base, -good, -bad, -ugly and "
              "gstreamer1.0-libav have what is needed)", problem->message);
        g_clear_error(&problem);
        return FALSE;
    }
    picture->source = element_named(picture, "packets");
    picture->stabilizer = element_named(picture, "stabilizer");
    if (end == PICTURE_ENCODE) {
        picture->sink = element_named(picture, "sink");
        picture->encoder = element_named(picture, "encoder");
        picture->even_size = encoder->even_size;
        char *format = g_strdup_printf("video/x-raw, format=(string)%s", encoder->raw_formats);
        set_caps(picture, "format", gst_caps_from_string(format));
        g_free(format);
        if (!set_encoder_properties(picture->encoder, encoder->properties, error))
            return FALSE;
    }
    connect_ends(picture, end);
    if (end == PICTURE_ENCODE || end == PICTURE_SHOW)
        compare_install(picture->stabilizer, picture->options->compare);
    return options_apply(picture->options, picture->stabilizer, error);
}

Picture *picture_new(const Options *options, const Input *input, const Encoder *encoder, PictureEnd end,
                     gboolean upright, PictureSink sink, GError **error)
{
    Picture *picture = g_new0(Picture, 1);
    picture->options = options;
    picture->input = input;
    picture->to = sink;
    picture->last_pts = -1;
    picture->times = g_sequence_new(g_free);
    g_queue_init(&picture->fields);
    picture->discarded = g_hash_table_new_full(g_int64_hash, g_int64_equal, g_free, NULL);
    g_mutex_init(&picture->lock);
    if (build(picture, encoder, end, upright, error))
        return picture;
    picture_free(picture);
    return NULL;
}

void picture_free(Picture *picture)
{
    if (!picture)
        return;
    if (picture->pipeline) {
        picture_stop(picture);
        gst_object_unref(picture->pipeline);
    }
    gst_clear_caps(&picture->raw);
    g_sequence_free(picture->times);
    g_queue_clear_full(&picture->fields, g_free);
    g_hash_table_unref(picture->discarded);
    g_mutex_clear(&picture->lock);
    g_free(picture->missing);
    g_free(picture);
}

GstElement *picture_stabilizer(Picture *picture)
{
    return picture->stabilizer;
}

GstBus *picture_bus(Picture *picture)
{
    return gst_element_get_bus(picture->pipeline);
}

gboolean picture_start(Picture *picture)
{
    return gst_element_set_state(picture->pipeline, GST_STATE_PLAYING) != GST_STATE_CHANGE_FAILURE;
}

void picture_stop(Picture *picture)
{
    gst_element_set_state(picture->pipeline, GST_STATE_NULL);
}

void picture_progress(Picture *picture, gint64 *decoded, gint64 *encoded, double *seconds)
{
    g_mutex_lock(&picture->lock);
    *decoded = picture->decoded;
    *encoded = picture->encoded;
    *seconds = (double)picture->reached_ns / 1e9;
    g_mutex_unlock(&picture->lock);
}

/* ---- errors ---- */

void picture_note_missing(Picture *picture, GstMessage *message)
{
    if (gst_is_missing_plugin_message(message) && !picture->missing)
        picture->missing = gst_missing_plugin_message_get_description(message);
}

/* Whether an element is the one of this name or inside it. */
static gboolean is_inside(const Picture *picture, GstObject *object, const char *name)
{
    GstElement *element = gst_bin_get_by_name(GST_BIN(picture->pipeline), name);
    const gboolean inside = element && gst_object_has_as_ancestor(object, GST_OBJECT(element));
    g_clear_object(&element);
    return inside;
}

static void explain_missing(const Picture *picture, GError **error)
{
    const enum AVCodecID codec = picture->input->video->codecpar->codec_id;
    const char *package = codecs_package(codec);
    fault(error, EXIT_PLUGIN, "%s: no decoder for its video (%s) is installed. %s%s%s", picture->input->name,
          package && picture->missing ? picture->missing : avcodec_get_name(codec),
          package ? "Debian's package " : "No decoder of GStreamer is known", package ? package : "",
          package ? " has it" : " for it");
}

void picture_explain(Picture *picture, GstMessage *message, GError **error)
{
    GError *problem = NULL;
    char *detail = NULL;
    const char *name = picture->input->name;
    const enum AVCodecID codec = picture->input->video->codecpar->codec_id;
    gst_message_parse_error(message, &problem, &detail);
    say_detail("%s: %s: %s", GST_MESSAGE_SRC_NAME(message), problem->message, detail ? detail : "");

    if (picture->missing || g_error_matches(problem, GST_CORE_ERROR, GST_CORE_ERROR_MISSING_PLUGIN))
        explain_missing(picture, error);
    else if (is_inside(picture, GST_MESSAGE_SRC(message), "stabilizer"))
        fault(error, problem->domain == GST_RESOURCE_ERROR ? EXIT_OTHER : EXIT_INPUT, "%s: %s", name, problem->message);
    else if (picture->encoder && GST_MESSAGE_SRC(message) == GST_OBJECT(picture->encoder))
        fault(error, EXIT_OTHER, "%s: the encoder refuses: %s", name, problem->message);
    else if (is_inside(picture, GST_MESSAGE_SRC(message), "decoder") ||
             GST_MESSAGE_SRC(message) == GST_OBJECT(picture->source))
        fault(error, EXIT_INPUT, "%s: its video (%s) cannot be decoded: %s", name, avcodec_get_name(codec),
              problem->message);
    else
        fault(error, EXIT_OTHER, "%s: %s: %s", name, GST_MESSAGE_SRC_NAME(message), problem->message);
    g_clear_error(&problem);
    g_free(detail);
}
