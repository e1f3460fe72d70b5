/* SPDX-License-Identifier: MIT */
#include "encoder.h"

#include "fault.h"

#include <gst/video/video.h>
#include <libavutil/pixdesc.h>
#include <math.h>
#include <string.h>

/*
 * The defaults of `crf` make a picture that is not told from the stabilized one: its luma has an SSIM of 0.988 to 0.995
 * with it, on 3 s each of two handheld clips of 360 and 480 columns. `preset` is a compromise between time and size.
 */
#define MAX_DEPTH 12 /* bits; no encoder has more */

typedef struct Kind {
    const char *name;      /* of the codec */
    enum AVCodecID codec;
    const char *element;
    const char *parser;    /* also repacks for the container; or NULL */
    const char *preset;    /* default; NULL: it has none */
    double crf;            /* default */
    int max_depth;         /* bits */
    gboolean keeps_chroma; /* made for editing: 4:2:2 and 4:4:4 stay. The others get 4:2:0, which every player shows */
    gboolean odd_sizes;
    gboolean bitrate;      /* takes --bitrate; those that have neither crf nor bitrate have their own rule */
} Kind;

/* What the containers want. libavformat turns it into what MPEG-TS wants. */
#define H264_PARSER "h264parse ! video/x-h264, stream-format=avc, alignment=au"
#define H265_PARSER "h265parse ! video/x-h265, stream-format=hvc1, alignment=au"

static const Kind kinds[] = {
    {"h264", AV_CODEC_ID_H264, "x264enc", H264_PARSER, "faster", 17, 10, FALSE, FALSE, TRUE},
    {"hevc", AV_CODEC_ID_HEVC, "x265enc", H265_PARSER, "faster", 18, 12, FALSE, FALSE, TRUE},
    {"av1", AV_CODEC_ID_AV1, "av1enc", "av1parse", "6", 20, 8, FALSE, TRUE, TRUE},
    {"vp9", AV_CODEC_ID_VP9, "vp9enc", "vp9parse", "4", 32, 12, FALSE, TRUE, TRUE},
    {"prores", AV_CODEC_ID_PRORES, "avenc_prores_ks", NULL, "hq", -1, 10, TRUE, FALSE, FALSE},
    {"ffv1", AV_CODEC_ID_FFV1, "avenc_ffv1", NULL, NULL, -1, 12, TRUE, TRUE, FALSE},
};

static const Container containers[] = {
    {".mp4", "mp4", "h264 hevc av1 vp9", TRUE},
    {".m4v", "mp4", "h264 hevc av1 vp9", TRUE},
    {".mov", "mov", "h264 hevc prores", TRUE},
    {".mkv", "matroska", "h264 hevc av1 vp9 ffv1 prores", FALSE},
    {".webm", "webm", "vp9 av1", FALSE},
    {".ts", "mpegts", "h264 hevc", FALSE},
    {".m2ts", "mpegts", "h264 hevc", FALSE},
    {".mts", "mpegts", "h264 hevc", FALSE},
    {".avi", "avi", "h264 ffv1", FALSE},
};

const Container *container_of(const char *name)
{
    const char *suffix = strrchr(name, '.');
    for (size_t i = 0; suffix && i < G_N_ELEMENTS(containers); i++)
        if (g_ascii_strcasecmp(suffix, containers[i].suffix) == 0)
            return &containers[i];
    return NULL;
}

static gboolean is_installed(const char *element)
{
    GstElementFactory *factory = gst_element_factory_find(element);
    const gboolean installed = factory != NULL;
    g_clear_object(&factory);
    return installed;
}

static const Kind *kind_by_name(const char *name)
{
    for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++)
        if (g_ascii_strcasecmp(name, kinds[i].name) == 0 || strcmp(name, kinds[i].element) == 0)
            return &kinds[i];
    return NULL;
}

/* The container's first installed codec that satisfies a condition. */
static const Kind *first_kind(const Container *container, enum AVCodecID codec, int depth)
{
    char **names = g_strsplit(container->codecs, " ", -1);
    const Kind *found = NULL;
    for (int i = 0; names[i] && !found; i++) {
        const Kind *kind = kind_by_name(names[i]);
        if ((codec == AV_CODEC_ID_NONE || kind->codec == codec) && kind->max_depth >= depth &&
            is_installed(kind->element))
            found = kind;
    }
    g_strfreev(names);
    return found;
}

/* H.264 with 10 bits is played by few devices; HEVC with 10 bits by most. */
static const Kind *choose_kind(const Container *container, enum AVCodecID codec, int picture_bits)
{
    const int depth = MIN(picture_bits, MAX_DEPTH);
    const Kind *kind = first_kind(container, codec, depth);
    if (!kind && depth > 8)
        kind = first_kind(container, AV_CODEC_ID_HEVC, depth);
    if (!kind && depth > 8)
        kind = first_kind(container, AV_CODEC_ID_VP9, depth);
    if (!kind)
        kind = first_kind(container, AV_CODEC_ID_NONE, depth);
    return kind ? kind : first_kind(container, AV_CODEC_ID_NONE, 8);
}

/* ---- the settings ---- */

static char *launch_of(const Kind *kind, const Options *options)
{
    const double crf = options->crf >= 0 ? options->crf : kind->crf;
    const char *preset = options->preset ? options->preset : kind->preset;
    const int bitrate = options->bitrate, level = (int)lrint(crf);
    const guint threads = g_get_num_processors();

    switch (kind->codec) {
    case AV_CODEC_ID_H264:
        return bitrate ? g_strdup_printf("speed-preset=%s pass=cbr bitrate=%d", preset, bitrate)
                       /* Without vbv-buf-capacity=0, `bitrate`, 2048 kbit/s, limits this one too. */
                       : g_strdup_printf("speed-preset=%s pass=qual quantizer=%d vbv-buf-capacity=0", preset, level);
    case AV_CODEC_ID_HEVC:
        return bitrate ? g_strdup_printf("speed-preset=%s bitrate=%d", preset, bitrate)
                       : g_strdup_printf("speed-preset=%s option-string=crf=%d", preset, level);
    case AV_CODEC_ID_AV1:
        return bitrate ? g_strdup_printf("cpu-used=%s row-mt=true threads=%u target-bitrate=%d", preset, threads,
                                         bitrate)
                       : g_strdup_printf("cpu-used=%s row-mt=true threads=%u end-usage=q min-quantizer=%d "
                                         "max-quantizer=%d", preset, threads, level, MIN(63, level + 10));
    case AV_CODEC_ID_VP9:
        /* With a look-ahead, vp9enc 1.22 loses frames at the end: on a test clip 3 of 40. The quality of cq holds as
         * long as its target rate is not reached: hence the large rate. */
        return bitrate ? g_strdup_printf("deadline=1000000 lag-in-frames=0 cpu-used=%s row-mt=true threads=%u "
                                         "target-bitrate=%d", preset, threads, bitrate * 1000)
                       : g_strdup_printf("deadline=1000000 lag-in-frames=0 cpu-used=%s row-mt=true threads=%u "
                                         "end-usage=cq cq-level=%d target-bitrate=400000000", preset, threads, level);
    case AV_CODEC_ID_PRORES:
        return g_strdup_printf("profile=%s", preset);
    default:
        return g_strdup("");
    }
}

static gboolean check_settings(const Kind *kind, const Options *options, GError **error)
{
    if (options->bitrate && !kind->bitrate)
        return fault(error, EXIT_USAGE, "--bitrate: %s has none", kind->name);
    if (options->crf >= 0 && kind->crf < 0)
        return fault(error, EXIT_USAGE, "--crf: %s has none", kind->name);
    if (options->preset && !kind->preset)
        return fault(error, EXIT_USAGE, "--preset: %s has none", kind->name);
    /* The preset becomes a part of a pipeline's text. */
    for (const char *c = options->preset; c && *c; c++)
        if (!g_ascii_isalnum(*c))
            return fault(error, EXIT_USAGE, "--preset: %s is not a preset", options->preset);
    return TRUE;
}

/* ---- the raw picture ---- */

/* Formats by depth, and in each by chroma: 4:2:0, 4:2:2, 4:4:4. */
static const struct {
    int depth;
    const char *chroma[3];
} raw[] = {
    {8, {"I420", "Y42B", "Y444"}},
    {10, {"I420_10LE", "I422_10LE", "Y444_10LE"}},
    {12, {"I420_12LE", "I422_12LE", "Y444_12LE"}},
};

static gboolean accepts(const char *element, const char *format)
{
    GstElementFactory *factory = gst_element_factory_find(element);
    if (!factory)
        return FALSE;
    GstCaps *caps = gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING, format, NULL);
    const gboolean can = gst_element_factory_can_sink_any_caps(factory, caps);
    gst_caps_unref(caps);
    gst_object_unref(factory);
    return can;
}

static int picture_depth(const AVStream *video)
{
    const AVPixFmtDescriptor *pixels = av_pix_fmt_desc_get(video->codecpar->format);
    return pixels ? pixels->comp[0].depth : 8;
}

static int picture_chroma(const AVStream *video)
{
    const AVPixFmtDescriptor *pixels = av_pix_fmt_desc_get(video->codecpar->format);
    if (!pixels || pixels->nb_components < 3 || (pixels->flags & AV_PIX_FMT_FLAG_RGB))
        return 0;
    return pixels->log2_chroma_h ? 0 : pixels->log2_chroma_w ? 1 : 2;
}

/* The format with the least loss: enough bits before enough chroma. */
static char *raw_formats_of(const char *element, const AVStream *video, gboolean keeps_chroma)
{
    const int depth = picture_depth(video), chroma = keeps_chroma ? picture_chroma(video) : 0;
    const char *best = NULL;
    for (size_t i = 0; i < G_N_ELEMENTS(raw) && (!best || raw[i - 1].depth < depth); i++) {
        const char *closest = NULL; /* the smallest chroma that is enough, or else the largest */
        for (int c = 0; c < 3; c++)
            if (accepts(element, raw[i].chroma[c]) && (!closest || c <= chroma))
                closest = raw[i].chroma[c];
        best = closest ? closest : best;
    }
    if (best)
        return g_strdup(best);
    /* Hardware encoders take these. */
    return g_strdup(depth > 8 ? "{ P010_10LE, NV12 }" : "{ NV12, I420 }");
}

/* ---- the choice ---- */

static gboolean split_name(const Options *options, char **name, char ***properties, GError **error)
{
    char **parts = g_strsplit(options->encoder, ":", -1);
    GPtrArray *pairs = g_ptr_array_new();
    *name = g_strdup(parts[0]);
    for (int i = 1; parts[0] && parts[i]; i++) {
        char *equals = strchr(parts[i], '=');
        if (!equals)
            fault(error, EXIT_USAGE, "--encoder: '%s' is not key=value", parts[i]);
        g_ptr_array_add(pairs, equals ? g_strndup(parts[i], (gsize)(equals - parts[i])) : g_strdup(parts[i]));
        g_ptr_array_add(pairs, g_strdup(equals ? equals + 1 : ""));
    }
    g_ptr_array_add(pairs, NULL);
    *properties = (char **)g_ptr_array_free(pairs, FALSE);
    g_strfreev(parts);
    return !*error;
}

static gboolean is_video_encoder(const char *element)
{
    GstElementFactory *factory = gst_element_factory_find(element);
    const gboolean is = factory && gst_element_factory_list_is_type(factory, GST_ELEMENT_FACTORY_TYPE_VIDEO_ENCODER);
    g_clear_object(&factory);
    return is;
}

static void use_kind(Encoder *encoder, const Kind *kind, const Options *options, const AVStream *video)
{
    char *settings = launch_of(kind, options);
    const gboolean keeps_chroma = kind->keeps_chroma || video->codecpar->codec_id == kind->codec;
    /* av1enc 1.22 multiplies the terms of the frame rate and overflows, except where the second one is 1. It only uses
     * the rate to count time: hence milliseconds. */
    const char *before = kind->codec == AV_CODEC_ID_AV1 ? "capssetter caps=\"video/x-raw, framerate=1000/1\" ! " : "";
    encoder->launch = g_strdup_printf("%s%s name=encoder %s %s %s", before, kind->element, settings, kind->parser
                                      ? "!" : "",
                                      kind->parser ? kind->parser : "");
    encoder->raw_formats = raw_formats_of(kind->element, video, keeps_chroma);
    encoder->even_size = !kind->odd_sizes;
    encoder->summary = g_strdup_printf("%s by %s %s", kind->name, kind->element, settings);
    g_strstrip(encoder->summary);
    g_free(settings);
}

/* An element that is not in the table, such as a hardware encoder, with its own defaults. */
static gboolean use_element(Encoder *encoder, const char *element, const AVStream *video, const Options *options,
                            GError **error)
{
    if (!is_video_encoder(element))
        return fault(error, EXIT_USAGE, "--encoder: there is no encoder '%s' (--encoder list shows all)", element);
    if (options->crf >= 0 || options->bitrate || options->preset)
        return fault(error, EXIT_USAGE, "--crf, --bitrate and --preset are not known for %s: use "
                     "--encoder %s:property=value (gst-inspect-1.0 %s lists the properties)", element, element,
                         element);
    static const char *const parsers[][2] = {
        {"h264", H264_PARSER}, {"h265", H265_PARSER}, {"av1", "av1parse"}, {"vp9", "vp9parse"}};
    const char *parser = NULL;
    for (size_t i = 0; i < G_N_ELEMENTS(parsers) && !parser; i++)
        parser = strstr(element, parsers[i][0]) ? parsers[i][1] : NULL;
    encoder->launch = g_strdup_printf("%s name=encoder %s %s", element, parser ? "!" : "", parser ? parser : "");
    encoder->raw_formats = raw_formats_of(element, video, FALSE);
    encoder->even_size = TRUE;
    encoder->summary = g_strdup(element);
    return TRUE;
}

static gboolean choose(Encoder *encoder, const char *name, const Options *options, const Container *container,
                       const AVStream *video, GError **error)
{
    const Kind *kind = name ? kind_by_name(name) : choose_kind(container, video->codecpar->codec_id,
                                                               picture_depth(video));
    if (name && !kind)
        return use_element(encoder, name, video, options, error);
    if (!kind || !is_installed(kind->element))
        return fault(error, EXIT_PLUGIN, "no encoder for %s is installed. Debian's packages gstreamer1.0-plugins-ugly, "
                     "gstreamer1.0-plugins-bad, gstreamer1.0-plugins-good and gstreamer1.0-libav have them",
                     kind ? kind->name : container->suffix);
    if (name && first_kind(container, kind->codec, 0) != kind)
        return fault(error, EXIT_USAGE, "%s does not take %s: choose another --encoder or output name",
                     container->suffix, kind->name);
    if (!check_settings(kind, options, error))
        return FALSE;
    use_kind(encoder, kind, options, video);
    return TRUE;
}

/* AVI wants H.264 with start codes. It has no presentation times, so frames have to be in the order in which they are
 * shown. */
static void fit_avi(Encoder *encoder)
{
    GString *launch = g_string_new(encoder->launch);
    g_string_replace(launch, "stream-format=avc", "stream-format=byte-stream", 0);
    g_string_replace(launch, "x264enc name=encoder", "x264enc name=encoder bframes=0", 0);
    g_free(encoder->launch);
    encoder->launch = g_string_free(launch, FALSE);
}

gboolean encoder_choose(Encoder *encoder, const Options *options, const Container *container, const AVStream *video,
                        GError **error)
{
    char *name = NULL;
    gboolean ok = !options->encoder || split_name(options, &name, &encoder->properties, error);
    ok = ok && choose(encoder, name, options, container, video, error);
    if (ok && strcmp(container->muxer, "avi") == 0)
        fit_avi(encoder);
    g_free(name);
    return ok;
}

void encoder_clear(Encoder *encoder)
{
    g_free(encoder->launch);
    g_strfreev(encoder->properties);
    g_free(encoder->raw_formats);
    g_free(encoder->summary);
    *encoder = (Encoder){0};
}

void encoder_list(void)
{
    GList *factories = gst_element_factory_list_get_elements(GST_ELEMENT_FACTORY_TYPE_VIDEO_ENCODER, GST_RANK_NONE);
    for (size_t i = 0; i < G_N_ELEMENTS(kinds); i++)
        g_print("%-8s %-18s %s\n", kinds[i].name, kinds[i].element,
                is_installed(kinds[i].element) ? "installed" : "not installed");
    for (GList *item = factories; item; item = item->next) {
        GstElementFactory *factory = item->data;
        const char *class = gst_element_factory_get_metadata(factory, GST_ELEMENT_METADATA_KLASS);
        if (strstr(class, "Hardware"))
            g_print("%-8s %-18s hardware\n", "", GST_OBJECT_NAME(factory));
    }
    gst_plugin_feature_list_free(factories);
}
