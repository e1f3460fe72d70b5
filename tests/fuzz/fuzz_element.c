/* SPDX-License-Identifier: MIT */
/* The element between two pads: any caps, events, buffers and queries, a downstream that fails, allocators without
 * memory, changes of state, and another thread that changes and reads properties meanwhile. Frames come out in their
 * order; none is lost or comes twice unless something was done that drops frames; all buffers are freed at the end.
 * Whoever runs this watches the time. */
#include <gst/check/gstharness.h>
#include <gst/check/gsttestclock.h>
#include <gst/video/video.h>

#include "fuzz_gst.h"

enum { MAX_ACTIONS = 80, NO_FLOW = 99 };

typedef struct Play {
    FuzzInput in;
    GstHarness *h;
    GstElement *element;
    GstTestClock *clock;
    GMutex lock;            /* for the numbers of frames: the element pushes from two threads */
    guint64 next;           /* number of the frame that is pushed next */
    gint created, freed;    /* buffers that were pushed; atomic */
    guint64 oldest;         /* number of the oldest frame that has not come out */
    int errors;             /* that the element posted */
    bool may_drop[2 * MAX_ACTIONS]; /* by number: something happened that may drop the frame */
    GstFlowReturn answer;   /* what downstream returns; OK mostly */
    gint failing;           /* downstream's allocator has no memory; atomic */
    gint stop;              /* of the thread that changes properties; atomic */
    uint64_t thread_seed;
} Play;

/* --- what comes out --- */

static bool has_error(Play *play)
{
    play->errors += fuzz_count_errors(play->element);
    return play->errors > 0;
}

static void take_frame(Play *play, guint64 number)
{
    g_mutex_lock(&play->lock);
    FUZZ_CHECK(number >= play->oldest && number < play->next, "frame %d came twice, or out of order", (int)number);
    for (; play->oldest < number; play->oldest++)
        FUZZ_CHECK(play->may_drop[play->oldest] || has_error(play), "frame %d was lost, %d came out",
                   (int)play->oldest, (int)number);
    play->oldest++;
    g_mutex_unlock(&play->lock);
}

/* Something happened that may drop the frames that are inside. */
static void allow_drop(Play *play)
{
    g_mutex_lock(&play->lock);
    for (guint64 i = play->oldest; i < play->next; i++)
        play->may_drop[i] = true;
    g_mutex_unlock(&play->lock);
}

static GstPadProbeReturn on_output(GstPad *pad, GstPadProbeInfo *info, gpointer user_data)
{
    Play *play = user_data;
    if (!(GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER))
        return GST_PAD_PROBE_OK;
    take_frame(play, GST_BUFFER_OFFSET(GST_PAD_PROBE_INFO_BUFFER(info)));
    GST_PAD_PROBE_INFO_FLOW_RETURN(info) = play->answer;
    gst_buffer_unref(GST_PAD_PROBE_INFO_BUFFER(info));
    GST_PAD_PROBE_INFO_DATA(info) = NULL;
    return GST_PAD_PROBE_HANDLED;
}

/* --- an allocator that has no memory when it is told so --- */

typedef GstAllocator FuzzAllocator;
typedef GstAllocatorClass FuzzAllocatorClass;
static GType fuzz_allocator_get_type(void);
G_DEFINE_TYPE(FuzzAllocator, fuzz_allocator, GST_TYPE_ALLOCATOR)

static Play *played; /* the allocator has no place for it */

static GstMemory *allocate(GstAllocator *allocator, gsize size, GstAllocationParams *params)
{
    if (g_atomic_int_get(&played->failing))
        return NULL;
    return gst_allocator_alloc(NULL, size, params);
}

static void fuzz_allocator_class_init(FuzzAllocatorClass *klass)
{
    klass->alloc = allocate;
}

static void fuzz_allocator_init(FuzzAllocator *allocator)
{
    allocator->mem_type = "fuzz";
}

/* --- buffers --- */

static void on_freed(gpointer user_data, GstMiniObject *buffer)
{
    Play *play = user_data;
    g_atomic_int_inc(&play->freed);
}

/* GStreamer itself reports a meta of another format or of a smaller size than the caps; any offset and stride may come.
 */
static void add_video_meta(Play *play, GstBuffer *buffer, const GstVideoInfo *info)
{
    gsize offset[GST_VIDEO_MAX_PLANES];
    gint stride[GST_VIDEO_MAX_PLANES];
    for (guint i = 0; i < GST_VIDEO_INFO_N_PLANES(info); i++) {
        offset[i] = GST_VIDEO_INFO_PLANE_OFFSET(info, i) + (gsize)fuzz_below(&play->in, 2) * fuzz_bits(&play->in, 2);
        stride[i] = GST_VIDEO_INFO_PLANE_STRIDE(info, i) + fuzz_below(&play->in, 3) - 1;
    }
    gst_buffer_add_video_meta_full(buffer, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_INFO_FORMAT(info),
                                   (guint)GST_VIDEO_INFO_WIDTH(info) + (guint)fuzz_below(&play->in, 3),
                                   (guint)GST_VIDEO_INFO_HEIGHT(info) + (guint)fuzz_below(&play->in, 3),
                                   GST_VIDEO_INFO_N_PLANES(info), offset, stride);
}

static GstBuffer *make_pixels(Play *play)
{
    GstCaps *caps = gst_pad_get_current_caps(play->h->srcpad);
    GstVideoInfo info;
    const bool is_video = caps && gst_video_info_from_caps(&info, caps);
    gsize size = is_video ? GST_VIDEO_INFO_SIZE(&info) : 64;
    gst_clear_caps(&caps);
    const int kind = fuzz_below(&play->in, 24);
    if (kind == 22)
        size = size * fuzz_below(&play->in, 8) / 8; /* too small */
    if (kind == 23)
        return gst_buffer_new();
    GstBuffer *buffer = gst_buffer_new_allocate(NULL, size / 2, NULL);
    gst_buffer_append_memory(buffer, gst_allocator_alloc(NULL, size - size / 2, NULL));
    gst_buffer_memset(buffer, 0, (guint8)fuzz_byte(&play->in), size);
    if (is_video && fuzz_chance(&play->in, 8))
        add_video_meta(play, buffer, &info);
    return buffer;
}

static GstClockTime choose_time(Play *play, GstClockTime regular)
{
    switch (fuzz_below(&play->in, 16)) {
    case 12: return GST_CLOCK_TIME_NONE;
    case 13: return 0;
    case 14: return regular + fuzz_bits(&play->in, 4);
    case 15: return fuzz_bits(&play->in, 8);
    default: return regular;
    }
}

static void push_frame(Play *play)
{
    GstBuffer *buffer = make_pixels(play);
    GST_BUFFER_PTS(buffer) = choose_time(play, play->next * 40 * GST_MSECOND);
    GST_BUFFER_DURATION(buffer) = choose_time(play, 40 * GST_MSECOND);
    GST_BUFFER_OFFSET(buffer) = play->next;
    if (fuzz_chance(&play->in, 16))
        GST_BUFFER_FLAG_SET(buffer, 1u << fuzz_between(&play->in, 4, 15));
    gst_mini_object_weak_ref(GST_MINI_OBJECT_CAST(buffer), on_freed, play);
    play->created++;
    g_mutex_lock(&play->lock);
    play->next++;
    g_mutex_unlock(&play->lock);
    if (gst_harness_push(play->h, buffer) != GST_FLOW_OK || play->answer != GST_FLOW_OK)
        allow_drop(play); /* an event that drains tries each frame once */
}

/* --- events and queries --- */

static const char *const caps_texts[] = {
    "video/x-raw,format=I420,width=32,height=24,framerate=25/1",
    "video/x-raw,format=GRAY8,width=33,height=17,framerate=30/1",
    "video/x-raw,format=P010_10LE,width=32,height=16,framerate=0/1,max-framerate=60/1",
    "video/x-raw,format=YUY2,width=31,height=16,framerate=2147483647/1",
    "video/x-raw,format=RGBA,width=16,height=16,framerate=1/2147483647,pixel-aspect-ratio=1/100",
    "video/x-raw,format=NV12,width=32,height=24,framerate=25/1,interlace-mode=interleaved",
    "video/x-raw,format=I420,width=8,height=8,framerate=25/1",
    "video/x-raw,format=NV12,width=32,height=24,framerate=25/1,chroma-site=jpeg,pixel-aspect-ratio=16/15",
    "audio/x-raw,format=S16LE,rate=48000,channels=2",
    "video/x-raw(memory:DMABuf),format=I420,width=32,height=24,framerate=25/1",
};

static void push_caps(Play *play)
{
    const int choice = fuzz_chance(&play->in, 3) ? fuzz_below(&play->in, G_N_ELEMENTS(caps_texts)) : 0;
    GstCaps *caps = gst_caps_from_string(caps_texts[choice]);
    /* If they are refused, the frames before them are still inside, and frames after them are refused. */
    if (!gst_harness_push_event(play->h, gst_event_new_caps(caps)))
        allow_drop(play);
    gst_caps_unref(caps);
}

static void push_segment(Play *play)
{
    GstSegment segment;
    gst_segment_init(&segment, fuzz_chance(&play->in, 16) ? GST_FORMAT_BYTES : GST_FORMAT_TIME);
    if (fuzz_chance(&play->in, 4)) {
        segment.rate = (double[]){2, 0.5, -1, 1e-3, 1e6}[fuzz_below(&play->in, 5)];
        segment.start = fuzz_bits(&play->in, 5);
        segment.time = fuzz_bits(&play->in, 5);
        segment.base = fuzz_bits(&play->in, fuzz_below(&play->in, 9));
    }
    if (fuzz_chance(&play->in, 8))
        segment.flags = GST_SEGMENT_FLAG_TRICKMODE_KEY_UNITS;
    if (segment.rate < 0 || fuzz_chance(&play->in, 4))
        segment.stop = segment.start + fuzz_bits(&play->in, 6);
    gst_harness_push_event(play->h, gst_event_new_segment(&segment));
}

static void begin_stream(Play *play)
{
    gst_harness_push_event(play->h, gst_event_new_stream_start("fuzz"));
    push_caps(play);
    push_segment(play);
}

static void flush(Play *play)
{
    gst_harness_push_event(play->h, gst_event_new_flush_start());
    if (fuzz_chance(&play->in, 4))
        push_frame(play);
    gst_harness_push_event(play->h, gst_event_new_flush_stop(fuzz_below(&play->in, 2)));
    allow_drop(play);
    if (fuzz_below(&play->in, 4))
        push_segment(play);
}

static void push_event(Play *play)
{
    const GstClockTime time = choose_time(play, play->next * 40 * GST_MSECOND);
    GstEvent *event;
    switch (fuzz_below(&play->in, 8)) {
    case 0: event = gst_event_new_gap(GST_CLOCK_TIME_IS_VALID(time) ? time : 0, GST_CLOCK_TIME_NONE); break;
    case 1: event = gst_event_new_eos(); break;
    case 2: event = gst_event_new_segment_done(GST_FORMAT_TIME, (gint64)time); break;
    case 3: event = gst_event_new_stream_group_done(1); break;
    case 4: event = gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_OOB, gst_structure_new_empty("fuzz")); break;
    case 5: event = gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst_structure_new_empty("fuzz")); break;
    default: event = gst_event_new_tag(gst_tag_list_new(GST_TAG_TITLE, "title", NULL)); break;
    }
    gst_harness_push_event(play->h, event);
}

static void push_upstream(Play *play)
{
    GstEvent *event;
    switch (fuzz_below(&play->in, 4)) {
    case 0: event = gst_event_new_latency(fuzz_bits(&play->in, 8)); break;
    case 1: event = gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 2.0, 1000, fuzz_bits(&play->in, 6)); break;
    case 2: event = gst_event_new_reconfigure(); break;
    default:
        event = gst_event_new_seek(fuzz_below(&play->in, 2) ? 1.0 : -1.0, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                                   GST_SEEK_TYPE_SET, (gint64)fuzz_bits(&play->in, 7), GST_SEEK_TYPE_NONE, -1);
        break;
    }
    gst_harness_push_upstream_event(play->h, event);
}

static GstQuery *choose_query(Play *play)
{
    GstCaps *caps = gst_caps_from_string(caps_texts[fuzz_below(&play->in, G_N_ELEMENTS(caps_texts))]);
    GstQuery *query;
    switch (fuzz_below(&play->in, 10)) {
    case 0: query = gst_query_new_latency(); break;
    case 1: query = gst_query_new_position(fuzz_below(&play->in, 2) ? GST_FORMAT_TIME : GST_FORMAT_BYTES); break;
    case 2: query = gst_query_new_duration(GST_FORMAT_TIME); break;
    case 3: query = gst_query_new_caps(fuzz_below(&play->in, 2) ? caps : NULL); break;
    case 4: query = gst_query_new_accept_caps(caps); break;
    case 5: query = gst_query_new_allocation(fuzz_below(&play->in, 4) ? caps : NULL, fuzz_below(&play->in, 2)); break;
    case 6: query = gst_query_new_seeking(GST_FORMAT_TIME); break;
    case 7: query = gst_query_new_convert(GST_FORMAT_TIME, (gint64)fuzz_bits(&play->in, 8), GST_FORMAT_BYTES); break;
    case 8: query = gst_query_new_segment(GST_FORMAT_TIME); break;
    default: query = gst_query_new_drain(); break;
    }
    gst_caps_unref(caps);
    return query;
}

static void check_latency(GstQuery *query)
{
    GstClockTime least, most;
    gst_query_parse_latency(query, NULL, &least, &most);
    FUZZ_CHECK(GST_CLOCK_TIME_IS_VALID(least) && least <= most, "latency %llu, at most %llu",
               (unsigned long long)least, (unsigned long long)most);
}

static void ask(Play *play)
{
    GstQuery *query = choose_query(play);
    GstPad *from = fuzz_below(&play->in, 2) ? play->h->srcpad : play->h->sinkpad;
    if (GST_QUERY_TYPE(query) == GST_QUERY_LATENCY)
        from = play->h->sinkpad; /* downstream asks for the latency */
    if (gst_pad_peer_query(from, query) && GST_QUERY_TYPE(query) == GST_QUERY_LATENCY)
        check_latency(query);
    gst_query_unref(query);
}

/* --- properties --- */

static void set_property(GstElement *element, uint64_t value)
{
    const int choice = (int)(value % 14);
    const double part = (double)(value >> 8 & 0xff) / 255.0;
    static const char *const regions[] = {NULL, "10%,0,80%,50%", "0,0,16,16", "nonsense", "50%,50%,60%,60%"};
    switch (choice) {
    case 0: g_object_set(element, "lambda", part * 3, NULL); break;
    case 1: g_object_set(element, "crop-ratio", 0.5 + part * 0.49, NULL); break;
    case 2: g_object_set(element, "bypass", part > 0.5, NULL); break;
    case 3: g_object_set(element, "window", 4 + (int)(part * 6), NULL); break;
    case 4: g_object_set(element, "overlap", (int)(part * 8), NULL); break;
    case 5: g_object_set(element, "join", part > 0.8, NULL); break;
    case 6: g_object_set(element, "motion-model", (int)(part * 2.9), NULL); break;
    case 7: g_object_set(element, "rolling-shutter", (int)(part * 2.9), NULL); break;
    case 8: g_object_set(element, "interpolation", (int)(part * 2.9), NULL); break;
    case 9: g_object_set(element, "output-size", part > 0.5, "border", part < 0.3 ? 1 : 0, "fill-frames",
                         (int)(part * 20), NULL); break;
    case 10: g_object_set(element, "threads", 1 + (int)(part * 2), NULL); break;
    case 11: g_object_set(element, "post-messages", part > 0.5, NULL); break;
    case 12: g_object_set(element, "region", regions[(int)(part * 4.9)], NULL); break;
    default: g_object_set(element, "mask", part > 0.9 ? "/nonexistent" : NULL, NULL); break;
    }
}

static void get_properties(GstElement *element)
{
    GstStructure *stats;
    double lambda;
    char *region;
    g_object_get(element, "stats", &stats, "lambda", &lambda, "region", &region, NULL);
    FUZZ_CHECK(stats && gst_structure_has_name(stats, "l1l2stab-stats"), "no statistics");
    FUZZ_CHECK(lambda >= 0 && lambda <= 1000, "lambda %g", lambda);
    gst_structure_free(stats);
    g_free(region);
}

static gpointer change_properties(gpointer user_data)
{
    Play *play = user_data;
    uint64_t state = play->thread_seed * 0x9e3779b97f4a7c15u + 1;
    while (!g_atomic_int_get(&play->stop)) {
        state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        set_property(play->element, state >> 16);
        get_properties(play->element);
        g_usleep(100);
    }
    return NULL;
}

/* --- the run --- */

static void change_state(Play *play)
{
    static const GstState states[] = {GST_STATE_NULL, GST_STATE_READY, GST_STATE_PAUSED};
    const GstState state = states[fuzz_below(&play->in, 3)];
    gst_element_set_state(play->element, state);
    if (state < GST_STATE_PAUSED)
        allow_drop(play);
    gst_element_set_state(play->element, GST_STATE_PLAYING);
    if (state < GST_STATE_PAUSED && fuzz_below(&play->in, 8))
        begin_stream(play);
}

static void let_time_pass(Play *play)
{
    if (gst_test_clock_peek_id_count(play->clock) > 0)
        gst_test_clock_crank(play->clock);
    else
        gst_test_clock_advance_time(play->clock, (GstClockTimeDiff)fuzz_bits(&play->in, 4));
}

static void choose_answer(Play *play)
{
    static const GstFlowReturn answers[] = {GST_FLOW_OK, GST_FLOW_OK, GST_FLOW_EOS, GST_FLOW_FLUSHING,
                                            GST_FLOW_NOT_LINKED, GST_FLOW_ERROR, GST_FLOW_CUSTOM_SUCCESS};
    GST_PAD_STREAM_LOCK(play->h->sinkpad);
    play->answer = answers[fuzz_below(&play->in, G_N_ELEMENTS(answers))];
    if (play->answer != GST_FLOW_OK) /* of the timer's task, whose result the next push tells */
        allow_drop(play);
    GST_PAD_STREAM_UNLOCK(play->h->sinkpad);
}

static void set_upstream_latency(Play *play)
{
    const GstClockTime latency = fuzz_bits(&play->in, 8);
    gst_harness_set_upstream_latency(play->h, GST_CLOCK_TIME_IS_VALID(latency) ? latency : latency - 1);
}

static void act(Play *play)
{
    switch (fuzz_below(&play->in, 32)) {
    case 20: push_caps(play); break;
    case 21: push_segment(play); break;
    case 22: flush(play); break;
    case 23: push_event(play); break;
    case 24: push_upstream(play); break;
    case 25: ask(play); break;
    case 26: set_property(play->element, fuzz_bits(&play->in, 2)); break;
    case 27: change_state(play); break;
    case 28: let_time_pass(play); break;
    case 29: choose_answer(play); break;
    case 30: g_atomic_int_set(&play->failing, fuzz_below(&play->in, 2)); break;
    case 31: set_upstream_latency(play); break;
    default: push_frame(play); break;
    }
}

static void open_play(Play *play)
{
    GstAllocator *allocator = gst_object_ref_sink(g_object_new(fuzz_allocator_get_type(), NULL));
    play->element = fuzz_element_new();
    g_object_set(play->element, "window", fuzz_between(&play->in, 4, 10), "threads", 1, NULL);
    play->h = gst_harness_new_with_element(play->element, "sink", "src");
    gst_harness_set_propose_allocator(play->h, allocator, NULL);
    gst_harness_set_live(play->h, fuzz_below(&play->in, 2));
    play->clock = gst_harness_get_testclock(play->h);
    gst_pad_add_probe(play->h->sinkpad, GST_PAD_PROBE_TYPE_BUFFER, on_output, play, NULL);
    play->thread_seed = fuzz_bits(&play->in, 1);
}

/* The end of the stream brings all that is inside. */
static void end_stream(Play *play)
{
    GST_PAD_STREAM_LOCK(play->h->sinkpad);
    play->answer = GST_FLOW_OK;
    GST_PAD_STREAM_UNLOCK(play->h->sinkpad);
    g_atomic_int_set(&play->failing, 0);
    gst_harness_push_event(play->h, gst_event_new_eos());
    for (; play->oldest < play->next; play->oldest++)
        FUZZ_CHECK(play->may_drop[play->oldest] || has_error(play), "frame %d did not come out", (int)play->oldest);
}

static void close_play(Play *play)
{
    gst_element_set_state(play->element, GST_STATE_NULL);
    gst_object_unref(play->clock);
    gst_harness_teardown(play->h);
    fuzz_element_free(play->element);
    FUZZ_CHECK(g_atomic_int_get(&play->freed) == play->created, "%d of %d buffers were freed", play->freed,
               play->created);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Play play = {.in = {data, data + size}};
    fuzz_gst_init();
    played = &play;
    open_play(&play);
    GThread *thread = fuzz_below(&play.in, 2) ? g_thread_new("properties", change_properties, &play) : NULL;
    begin_stream(&play);
    for (int i = 0; i < MAX_ACTIONS && fuzz_has_more(&play.in); i++)
        act(&play);
    g_atomic_int_set(&play.stop, 1);
    if (thread)
        g_thread_join(thread);
    if (fuzz_below(&play.in, 2)) /* otherwise frames are inside when the element is stopped */
        end_stream(&play);
    close_play(&play);
    return 0;
}
