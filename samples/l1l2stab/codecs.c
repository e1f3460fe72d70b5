/* SPDX-License-Identifier: MIT */
#include "codecs.h"

#include <gst/video/video.h>
#include <libavcodec/bsf.h>
#include <libavutil/mastering_display_metadata.h>
#include <libavutil/pixdesc.h>
#include <string.h>

#define MAX_FRAME_RATE 1000 /* Hz: some files state the clock of their timestamps, such as 90000, as their frame rate */
#define MAX_RATE_TERM 65535

#define PLUGINS_GOOD "gstreamer1.0-plugins-good"
#define PLUGINS_BAD "gstreamer1.0-plugins-bad"
#define PLUGINS_LIBAV "gstreamer1.0-libav"

/* Codecs that have caps of their own. Any other is called video/x-gst-av-NAME, as gst-libav names it. */
static const struct {
    enum AVCodecID id;
    const char *caps;
    const char *package;
} known[] = {
    {AV_CODEC_ID_H264, "video/x-h264", PLUGINS_LIBAV},
    {AV_CODEC_ID_HEVC, "video/x-h265", PLUGINS_LIBAV},
    {AV_CODEC_ID_AV1, "video/x-av1, stream-format=obu-stream, alignment=tu", PLUGINS_BAD},
    {AV_CODEC_ID_VP8, "video/x-vp8", PLUGINS_GOOD},
    {AV_CODEC_ID_VP9, "video/x-vp9", PLUGINS_GOOD},
    {AV_CODEC_ID_MPEG1VIDEO, "video/mpeg, mpegversion=1, systemstream=false", PLUGINS_LIBAV},
    {AV_CODEC_ID_MPEG2VIDEO, "video/mpeg, mpegversion=2, systemstream=false", PLUGINS_LIBAV},
    {AV_CODEC_ID_MPEG4, "video/mpeg, mpegversion=4, systemstream=false", PLUGINS_LIBAV},
    {AV_CODEC_ID_MSMPEG4V1, "video/x-msmpeg, msmpegversion=41", PLUGINS_LIBAV},
    {AV_CODEC_ID_MSMPEG4V2, "video/x-msmpeg, msmpegversion=42", PLUGINS_LIBAV},
    {AV_CODEC_ID_MSMPEG4V3, "video/x-msmpeg, msmpegversion=43", PLUGINS_LIBAV},
    {AV_CODEC_ID_H261, "video/x-h261", PLUGINS_LIBAV},
    {AV_CODEC_ID_H263, "video/x-h263, variant=itu", PLUGINS_LIBAV},
    {AV_CODEC_ID_H263P, "video/x-h263, variant=itu, h263version=h263p", PLUGINS_LIBAV},
    {AV_CODEC_ID_FLV1, "video/x-flash-video, flvversion=1", PLUGINS_LIBAV},
    {AV_CODEC_ID_WMV1, "video/x-wmv, wmvversion=1", PLUGINS_LIBAV},
    {AV_CODEC_ID_WMV2, "video/x-wmv, wmvversion=2", PLUGINS_LIBAV},
    {AV_CODEC_ID_WMV3, "video/x-wmv, wmvversion=3, format=WMV3", PLUGINS_LIBAV},
    {AV_CODEC_ID_VC1, "video/x-wmv, wmvversion=3, format=WVC1", PLUGINS_LIBAV},
    {AV_CODEC_ID_MJPEG, "image/jpeg, parsed=true", PLUGINS_GOOD},
    {AV_CODEC_ID_DVVIDEO, "video/x-dv, systemstream=false", PLUGINS_LIBAV},
    {AV_CODEC_ID_PRORES, "video/x-prores", PLUGINS_LIBAV},
    {AV_CODEC_ID_DNXHD, "video/x-dnxhd", PLUGINS_LIBAV},
    {AV_CODEC_ID_CFHD, "video/x-cineform", PLUGINS_LIBAV},
    {AV_CODEC_ID_FFV1, "video/x-ffv, ffvversion=1", PLUGINS_LIBAV},
    {AV_CODEC_ID_HUFFYUV, "video/x-huffyuv", PLUGINS_LIBAV},
    {AV_CODEC_ID_LAGARITH, "video/x-lagarith", PLUGINS_LIBAV},
    {AV_CODEC_ID_CINEPAK, "video/x-cinepak", PLUGINS_LIBAV},
    {AV_CODEC_ID_SVQ1, "video/x-svq, svqversion=1", PLUGINS_LIBAV},
    {AV_CODEC_ID_SVQ3, "video/x-svq, svqversion=3", PLUGINS_LIBAV},
    {AV_CODEC_ID_VP6F, "video/x-vp6-flash", PLUGINS_LIBAV},
    {AV_CODEC_ID_GIF, "image/gst-libav-gif, parsed=true", PLUGINS_LIBAV},
    {AV_CODEC_ID_PNG, "image/png", PLUGINS_GOOD},
    {AV_CODEC_ID_JPEG2000, "image/x-jpc", PLUGINS_LIBAV},
    {AV_CODEC_ID_QTRLE, "video/x-rle, layout=quicktime", PLUGINS_LIBAV},
    {AV_CODEC_ID_FLASHSV, "video/x-flash-screen", PLUGINS_LIBAV},
    {AV_CODEC_ID_ZMBV, "video/x-zmbv", PLUGINS_LIBAV},
};

const char *codecs_package(enum AVCodecID id)
{
    for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
        if (known[i].id == id)
            return known[i].package;
    return NULL;
}

/* ---- from the container to caps ---- */

static GstCaps *named_caps(enum AVCodecID id)
{
    for (size_t i = 0; i < G_N_ELEMENTS(known); i++)
        if (known[i].id == id)
            return gst_caps_from_string(known[i].caps);
    char *name = g_strdup_printf("video/x-gst-av-%s", avcodec_get_name(id));
    GstCaps *caps = gst_caps_new_empty_simple(name);
    g_free(name);
    return caps;
}

/* Formats of raw pictures that both know. */
static const struct {
    enum AVPixelFormat av;
    GstVideoFormat gst;
} formats[] = {
    {AV_PIX_FMT_YUV420P, GST_VIDEO_FORMAT_I420},
    {AV_PIX_FMT_YUV422P, GST_VIDEO_FORMAT_Y42B},
    {AV_PIX_FMT_YUV444P, GST_VIDEO_FORMAT_Y444},
    {AV_PIX_FMT_NV12, GST_VIDEO_FORMAT_NV12},
    {AV_PIX_FMT_YUYV422, GST_VIDEO_FORMAT_YUY2},
    {AV_PIX_FMT_UYVY422, GST_VIDEO_FORMAT_UYVY},
    {AV_PIX_FMT_BGR24, GST_VIDEO_FORMAT_BGR},
    {AV_PIX_FMT_RGB24, GST_VIDEO_FORMAT_RGB},
    {AV_PIX_FMT_BGRA, GST_VIDEO_FORMAT_BGRA},
    {AV_PIX_FMT_BGR0, GST_VIDEO_FORMAT_BGRx},
    {AV_PIX_FMT_GRAY8, GST_VIDEO_FORMAT_GRAY8},
    {AV_PIX_FMT_YUV420P10LE, GST_VIDEO_FORMAT_I420_10LE},
    {AV_PIX_FMT_YUV422P10LE, GST_VIDEO_FORMAT_I422_10LE},
    {AV_PIX_FMT_YUV444P10LE, GST_VIDEO_FORMAT_Y444_10LE},
    {AV_PIX_FMT_P010LE, GST_VIDEO_FORMAT_P010_10LE},
    {AV_PIX_FMT_YUV420P12LE, GST_VIDEO_FORMAT_I420_12LE},
    {AV_PIX_FMT_YUV422P12LE, GST_VIDEO_FORMAT_I422_12LE},
    {AV_PIX_FMT_YUV444P12LE, GST_VIDEO_FORMAT_Y444_12LE},
};

static enum AVPixelFormat pixel_format(GstVideoFormat format)
{
    for (size_t i = 0; i < G_N_ELEMENTS(formats); i++)
        if (formats[i].gst == format)
            return formats[i].av;
    return AV_PIX_FMT_YUV420P;
}

/* The layout of uncompressed frames; a frame of libavformat has no padding between its lines. */
static GstCaps *raw_caps(const AVCodecParameters *par)
{
    for (size_t i = 0; i < G_N_ELEMENTS(formats); i++)
        if (formats[i].av == par->format)
            return gst_caps_new_simple("video/x-raw", "format", G_TYPE_STRING,
                                       gst_video_format_to_string(formats[i].gst), NULL);
    return NULL;
}

static void set_extradata(GstCaps *caps, const AVCodecParameters *par)
{
    const gboolean has = par->extradata_size > 0;
    if (par->codec_id == AV_CODEC_ID_H264 || par->codec_id == AV_CODEC_ID_HEVC) {
        /* Extra data in the form of the ISO container begin with 1; otherwise they are NAL units with start codes. */
        if (!has || par->extradata[0] != 1) {
            gst_caps_set_simple(caps, "stream-format", G_TYPE_STRING, "byte-stream", NULL);
            return;
        }
        gst_caps_set_simple(caps, "stream-format", G_TYPE_STRING, par->codec_id == AV_CODEC_ID_H264 ? "avc" : "hvc1",
                            "alignment", G_TYPE_STRING, "au", NULL);
    }
    if (!has || par->codec_id == AV_CODEC_ID_VP9 || (par->codec_id == AV_CODEC_ID_AV1 && par->extradata[0] != 0x81))
        return;
    GstBuffer *data = gst_buffer_new_memdup(par->extradata, (gsize)par->extradata_size);
    gst_caps_set_simple(caps, "codec_data", GST_TYPE_BUFFER, data, NULL);
    gst_buffer_unref(data);
}

static void set_color(GstCaps *caps, const AVCodecParameters *par)
{
    GstVideoColorimetry color = {
        .range = par->color_range == AVCOL_RANGE_JPEG   ? GST_VIDEO_COLOR_RANGE_0_255
                 : par->color_range == AVCOL_RANGE_MPEG ? GST_VIDEO_COLOR_RANGE_16_235
                                                        : GST_VIDEO_COLOR_RANGE_UNKNOWN,
        .matrix = gst_video_color_matrix_from_iso((guint)par->color_space),
        .transfer = gst_video_transfer_function_from_iso((guint)par->color_trc),
        .primaries = gst_video_color_primaries_from_iso((guint)par->color_primaries),
    };
    /* Where the container says only a part, the decoder's own knowledge would be lost. */
    if (color.matrix == GST_VIDEO_COLOR_MATRIX_UNKNOWN || color.transfer == GST_VIDEO_TRANSFER_UNKNOWN ||
        color.primaries == GST_VIDEO_COLOR_PRIMARIES_UNKNOWN)
        return;
    if (color.range == GST_VIDEO_COLOR_RANGE_UNKNOWN)
        color.range = GST_VIDEO_COLOR_RANGE_16_235;
    char *text = gst_video_colorimetry_to_string(&color);
    gst_caps_set_simple(caps, "colorimetry", G_TYPE_STRING, text, NULL);
    g_free(text);
}

static guint scaled(AVRational q, int one)
{
    return (guint)av_rescale(q.num, one, q.den);
}

/* HDR10: GStreamer counts chromaticities in 0.00002 and luminance in 0.0001 cd/m2, and orders red, green, blue. */
static void set_hdr(GstCaps *caps, const AVStream *stream)
{
    const AVMasteringDisplayMetadata *display =
        (const void *)av_stream_get_side_data(stream, AV_PKT_DATA_MASTERING_DISPLAY_METADATA, NULL);
    const AVContentLightMetadata *light =
        (const void *)av_stream_get_side_data(stream, AV_PKT_DATA_CONTENT_LIGHT_LEVEL, NULL);
    if (display && display->has_primaries && display->has_luminance) {
        GstVideoMasteringDisplayInfo info;
        for (int i = 0; i < 3; i++) {
            info.display_primaries[i].x = (guint16)scaled(display->display_primaries[i][0], 50000);
            info.display_primaries[i].y = (guint16)scaled(display->display_primaries[i][1], 50000);
        }
        info.white_point.x = (guint16)scaled(display->white_point[0], 50000);
        info.white_point.y = (guint16)scaled(display->white_point[1], 50000);
        info.max_display_mastering_luminance = scaled(display->max_luminance, 10000);
        info.min_display_mastering_luminance = scaled(display->min_luminance, 10000);
        gst_video_mastering_display_info_add_to_caps(&info, caps);
    }
    if (light) {
        const GstVideoContentLightLevel level = {.max_content_light_level = (guint16)light->MaxCLL,
                                                 .max_frame_average_light_level = (guint16)light->MaxFALL};
        gst_video_content_light_level_add_to_caps(&level, caps);
    }
}

GstCaps *codecs_caps(const AVFormatContext *format, AVStream *stream)
{
    const AVCodecParameters *par = stream->codecpar;
    GstCaps *caps = par->codec_id == AV_CODEC_ID_RAWVIDEO ? raw_caps(par) : NULL;
    if (!caps)
        caps = named_caps(par->codec_id);
    if (par->width > 0 && par->height > 0)
        gst_caps_set_simple(caps, "width", G_TYPE_INT, par->width, "height", G_TYPE_INT, par->height, NULL);

    /* The mean rate of a film with varying frame times is a fraction of large numbers. */
    AVRational rate = stream->avg_frame_rate;
    av_reduce(&rate.num, &rate.den, rate.num, rate.den, MAX_RATE_TERM);
    if (rate.num > 0 && rate.den > 0 && av_q2d(rate) <= MAX_FRAME_RATE)
        gst_caps_set_simple(caps, "framerate", GST_TYPE_FRACTION, rate.num, rate.den, NULL);
    else if (par->codec_id == AV_CODEC_ID_RAWVIDEO)
        gst_caps_set_simple(caps, "framerate", GST_TYPE_FRACTION, 0, 1, NULL);
    const AVRational pixel = av_guess_sample_aspect_ratio((AVFormatContext *)format, stream, NULL);
    if (pixel.num > 0 && pixel.den > 0)
        gst_caps_set_simple(caps, "pixel-aspect-ratio", GST_TYPE_FRACTION, pixel.num, pixel.den, NULL);
    if (par->bits_per_coded_sample > 0 && par->codec_id == AV_CODEC_ID_QTRLE)
        gst_caps_set_simple(caps, "depth", G_TYPE_INT, par->bits_per_coded_sample, NULL);
    if (par->bits_per_coded_sample > 0 && par->codec_id == AV_CODEC_ID_HUFFYUV)
        gst_caps_set_simple(caps, "bpp", G_TYPE_INT, par->bits_per_coded_sample, NULL);
    set_extradata(caps, par);
    set_color(caps, par);
    set_hdr(caps, stream);
    return caps;
}

/* ---- from an encoder's caps to the container ---- */

static enum AVCodecID encoded_codec(const GstStructure *encoded)
{
    const char *name = gst_structure_get_name(encoded);
    int version = 0;
    if (g_str_equal(name, "video/mpeg") && gst_structure_get_int(encoded, "mpegversion", &version))
        return version == 4 ? AV_CODEC_ID_MPEG4 : version == 2 ? AV_CODEC_ID_MPEG2VIDEO : AV_CODEC_ID_MPEG1VIDEO;
    for (size_t i = 0; i < G_N_ELEMENTS(known); i++) {
        const size_t length = strcspn(known[i].caps, ",");
        if (strlen(name) == length && strncmp(known[i].caps, name, length) == 0)
            return known[i].id;
    }
    return AV_CODEC_ID_NONE;
}

static uint32_t prores_tag(const GstStructure *encoded)
{
    static const struct {
        const char *variant;
        uint32_t tag;
    } variants[] = {{"proxy", MKTAG('a', 'p', 'c', 'o')}, {"lt", MKTAG('a', 'p', 'c', 's')},
                    {"standard", MKTAG('a', 'p', 'c', 'n')}, {"hq", MKTAG('a', 'p', 'c', 'h')},
                    {"4444", MKTAG('a', 'p', '4', 'h')}, {"4444xq", MKTAG('a', 'p', '4', 'x')}};
    const char *name = gst_structure_get_string(encoded, "variant");
    for (size_t i = 0; name && i < G_N_ELEMENTS(variants); i++)
        if (g_str_equal(variants[i].variant, name))
            return variants[i].tag;
    return 0;
}

static gboolean describe_extradata(const GstStructure *encoded, AVCodecParameters *par)
{
    const GValue *value = gst_structure_get_value(encoded, "codec_data");
    if (!value)
        return TRUE;
    GstBuffer *data = gst_value_get_buffer(value);
    const gsize size = gst_buffer_get_size(data);
    par->extradata = av_mallocz(size + AV_INPUT_BUFFER_PADDING_SIZE);
    if (!par->extradata)
        return FALSE;
    gst_buffer_extract(data, 0, par->extradata, size);
    par->extradata_size = (int)size;
    return TRUE;
}

void codecs_find_extradata(AVStream *stream, const AVPacket *first)
{
    const AVBitStreamFilter *filter = av_bsf_get_by_name("extract_extradata");
    AVBSFContext *context = NULL;
    AVCodecParameters *par = stream->codecpar;
    AVPacket *packet = av_packet_clone(first);
    size_t size = 0;
    if (par->extradata_size == 0 && filter && packet && av_bsf_alloc(filter, &context) >= 0 &&
        avcodec_parameters_copy(context->par_in, par) >= 0 && av_bsf_init(context) >= 0 &&
        av_bsf_send_packet(context, packet) >= 0 && av_bsf_receive_packet(context, packet) >= 0) {
        const uint8_t *data = av_packet_get_side_data(packet, AV_PKT_DATA_NEW_EXTRADATA, &size);
        par->extradata = data ? av_mallocz(size + AV_INPUT_BUFFER_PADDING_SIZE) : NULL;
        if (par->extradata) {
            memcpy(par->extradata, data, size);
            par->extradata_size = (int)size;
        }
    }
    av_bsf_free(&context);
    av_packet_free(&packet);
}

/* A color that GStreamer only assumes, because the input does not state one, is written like a stated one. */
static void describe_color(const GstVideoInfo *info, AVCodecParameters *par)
{
    const GstVideoColorimetry *color = &info->colorimetry;
    par->color_range = color->range == GST_VIDEO_COLOR_RANGE_0_255   ? AVCOL_RANGE_JPEG
                       : color->range == GST_VIDEO_COLOR_RANGE_16_235 ? AVCOL_RANGE_MPEG
                                                                      : AVCOL_RANGE_UNSPECIFIED;
    par->color_space = (enum AVColorSpace)gst_video_color_matrix_to_iso(color->matrix);
    par->color_trc = (enum AVColorTransferCharacteristic)gst_video_transfer_function_to_iso(color->transfer);
    par->color_primaries = (enum AVColorPrimaries)gst_video_color_primaries_to_iso(color->primaries);
    if (info->chroma_site == GST_VIDEO_CHROMA_SITE_MPEG2)
        par->chroma_location = AVCHROMA_LOC_LEFT;
    else if (info->chroma_site == GST_VIDEO_CHROMA_SITE_JPEG)
        par->chroma_location = AVCHROMA_LOC_CENTER;
}

static void describe_hdr(const GstCaps *raw, AVStream *stream)
{
    GstVideoMasteringDisplayInfo info;
    GstVideoContentLightLevel level;
    if (gst_video_mastering_display_info_from_caps(&info, raw)) {
        AVMasteringDisplayMetadata *display = av_mastering_display_metadata_alloc();
        for (int i = 0; i < 3; i++) {
            display->display_primaries[i][0] = av_make_q(info.display_primaries[i].x, 50000);
            display->display_primaries[i][1] = av_make_q(info.display_primaries[i].y, 50000);
        }
        display->white_point[0] = av_make_q(info.white_point.x, 50000);
        display->white_point[1] = av_make_q(info.white_point.y, 50000);
        display->max_luminance = av_make_q((int)info.max_display_mastering_luminance, 10000);
        display->min_luminance = av_make_q((int)info.min_display_mastering_luminance, 10000);
        display->has_primaries = display->has_luminance = 1;
        av_stream_add_side_data(stream, AV_PKT_DATA_MASTERING_DISPLAY_METADATA, (uint8_t *)display, sizeof *display);
    }
    if (gst_video_content_light_level_from_caps(&level, raw)) {
        size_t size;
        AVContentLightMetadata *light = av_content_light_metadata_alloc(&size);
        light->MaxCLL = level.max_content_light_level;
        light->MaxFALL = level.max_frame_average_light_level;
        av_stream_add_side_data(stream, AV_PKT_DATA_CONTENT_LIGHT_LEVEL, (uint8_t *)light, size);
    }
}

gboolean codecs_describe(const GstCaps *encoded_caps, const GstCaps *raw, AVStream *stream)
{
    const GstStructure *encoded = gst_caps_get_structure(encoded_caps, 0);
    AVCodecParameters *par = stream->codecpar;
    GstVideoInfo info;
    if (!gst_video_info_from_caps(&info, raw))
        return FALSE;
    par->codec_type = AVMEDIA_TYPE_VIDEO;
    par->codec_id = encoded_codec(encoded);
    par->codec_tag = par->codec_id == AV_CODEC_ID_PRORES ? prores_tag(encoded) : 0;
    par->width = info.width;
    par->height = info.height;
    par->field_order = AV_FIELD_PROGRESSIVE;
    par->sample_aspect_ratio = stream->sample_aspect_ratio = av_make_q(info.par_n, info.par_d);
    par->format = pixel_format(GST_VIDEO_INFO_FORMAT(&info));
    par->bits_per_raw_sample = (int)GST_VIDEO_INFO_COMP_DEPTH(&info, 0);
    describe_color(&info, par);
    describe_hdr(raw, stream);
    return par->codec_id != AV_CODEC_ID_NONE && describe_extradata(encoded, par);
}
