/* SPDX-License-Identifier: MIT */
/* The plugin "l1l2stab", which has one element, and the user documentation of that element. */
/**
 * SECTION:element-l1l2stab
 * @title: l1l2stab
 * @short_description: stabilizes shaky video while it plays
 *
 * l1l2stab measures the motion of the camera, computes a smooth path for it, and
 * renders each frame as a camera on the smooth path would have seen it. The path
 * is computed for a window of frames at a time, so frames are held back: the
 * latency is #l1l2stab:window frames. After that, one frame goes out for each
 * frame that comes in, with its timestamps, flags and metas.
 *
 * No frame is held for longer than the latency. If the source is slower than its
 * caps say, or stalls, a frame leaves when it has been held for the duration of a
 * window at the frame rate of the caps (25 frames per second if they have none).
 * Its path then has a shorter look-ahead. In trick modes with key frames alone,
 * frames are not held at all.
 *
 * The method is that of Qu and Song, "Video stabilization with L1-L2
 * optimization", ICIP 2013.
 *
 * #l1l2stab:lambda and #l1l2stab:crop-ratio can be changed while the stream runs,
 * and can be controlled by stream time. A change applies to the frames that come
 * in after it; the crop changes by at most 0.005 per frame. A change of
 * #l1l2stab:bypass applies to the frames that go out after it, with a smooth
 * transition. The other properties take effect with the next caps or when the
 * element is started again, and so does the output size that crop-ratio gives
 * with output-size=crop.
 *
 * #l1l2stab:region and #l1l2stab:mask say in which part of the frame the motion of
 * the camera is measured. The whole picture is stabilized by it.
 *
 * A discontinuity ends the path. In reverse playback it does not, because there
 * decoders mark every group of pictures as one.
 *
 * Interlaced video has to be deinterlaced before, and frames in the memory of a
 * GPU have to be downloaded.
 *
 * Every frame carries a custom meta "GstL1L2StabMeta" with the maps from its
 * picture to the source frame ("to-source") and back ("from-source"), in pixels
 * from the top left corner, as nine doubles each, row by row. With
 * #l1l2stab:post-messages the element posts a message "l1l2stab-frame" for each
 * frame. docs/control.md lists the fields of both and of #l1l2stab:stats.
 * docs/motion-file.md describes the files of #l1l2stab:motion-in and
 * #l1l2stab:motion-out.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 filesrc location=in.mp4 ! decodebin ! l1l2stab ! x264enc ! mp4mux ! filesink location=out.mp4
 * ]| Stabilizes a file that has no audio.
 * |[
 * gst-launch-1.0 filesrc location=in.mp4 ! decodebin name=in \
 *   in. ! queue ! l1l2stab ! x264enc ! queue ! mp4mux name=out ! filesink location=out.mp4 \
 *   in. ! queue max-size-time=0 max-size-bytes=0 max-size-buffers=0 ! audioconvert ! avenc_aac ! out.
 * ]| The same with audio. The queue of the audio branch must have room for the
 * whole window. By default a queue holds one second, and the pipeline can stall.
 * |[
 * gst-launch-1.0 v4l2src ! videoconvert ! l1l2stab window=30 ! videoconvert ! autovideosink
 * ]| A camera, with a delay of one second at 30 frames per second.
 * |[
 * gst-launch-1.0 rtspsrc location=rtsp://camera/stream latency=200 ! decodebin ! l1l2stab window=30 ! \
 *   videoconvert ! autovideosink
 * ]| A network camera.
 * |[
 * gst-launch-1.0 filesrc location=in.mp4 ! decodebin ! l1l2stab region=0,0,100%,45% ! x264enc ! mp4mux ! \
 *   filesink location=out.mp4
 * ]| The motion is measured above the water.
 * |[
 * gst-launch-1.0 filesrc location=in.mp4 ! decodebin ! tee name=in \
 *   compositor name=both sink_1::xpos=320 ! x264enc ! mp4mux ! filesink location=out.mp4 \
 *   in. ! queue max-size-time=0 max-size-bytes=0 max-size-buffers=0 ! both.sink_0 \
 *   in. ! queue ! l1l2stab ! both.sink_1
 * ]| Before and after, side by side, for video that is 320 pixels wide.
 * |[
 * gst-launch-1.0 filesrc location=in-10bit.mp4 ! decodebin ! l1l2stab ! x265enc ! h265parse ! mp4mux ! \
 *   filesink location=out.mp4
 * ]| 10-bit video stays 10-bit.
 */
#include "gstl1l2stab.h"

static gboolean
plugin_init (GstPlugin * plugin)
{
  return GST_ELEMENT_REGISTER (l1l2stab, plugin);
}

/* GStreamer 1.22 does not know this license by its SPDX name. */
GST_PLUGIN_DEFINE (GST_VERSION_MAJOR, GST_VERSION_MINOR, l1l2stab,
    "Video stabilization with L1-L2 optimal camera paths",
    plugin_init, VERSION, "MIT/X11", PACKAGE, PACKAGE_ORIGIN)
