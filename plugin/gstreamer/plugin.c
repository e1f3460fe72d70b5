/* SPDX-License-Identifier: MIT */
/* What GStreamer loads: the plugin "l1l2stab" and the one element in it. */
/**
 * SECTION:element-l1l2stab
 * @title: l1l2stab
 * @short_description: steadies shaken video while it plays
 *
 * l1l2stab follows the motion of the camera, smooths its path, and renders
 * each frame as the smooth camera would have seen it. It looks at a window of
 * frames together and therefore holds them back: the latency is #l1l2stab:window
 * frames. After them, one frame comes out for each frame that comes in, with
 * its timestamps, flags and metas.
 *
 * The latency is kept, too: where the source is slower than its caps say, or
 * stalls, frames leave when they have been held for as long as a window lasts at
 * the rate of the caps (25 frames a second where they have none), with what
 * look-ahead there is. Key frames alone (trick modes) are not held at all.
 *
 * The method is that of Qu and Song, "Video stabilization with L1-L2
 * optimization", ICIP 2013.
 *
 * #l1l2stab:lambda and #l1l2stab:crop-ratio may be changed, or controlled by
 * stream time, while the stream runs: they apply to the frames that come in
 * from then on; the crop moves by at most 0.005 a frame. #l1l2stab:bypass
 * applies to the frames that go out, at once but softly. The other properties
 * take effect with the next caps, or when the element is started again; so does
 * the size that crop-ratio gives with output-size=crop.
 *
 * In reverse playback a window goes on over the discontinuities that decoders
 * mark at each group of pictures; forward, a discontinuity ends it.
 *
 * Interlaced video has to be deinterlaced first, and frames in the memory of a
 * GPU have to be downloaded.
 *
 * Every frame carries a custom meta "GstL1L2StabMeta" with the maps from its
 * picture to the source frame ("to-source") and back ("from-source"), in pixels
 * from the top left corner: nine doubles each, row by row. With
 * #l1l2stab:post-messages the element posts a message "l1l2stab-frame" for each
 * frame. docs/control.md describes all fields of these and of #l1l2stab:stats,
 * docs/motion-file.md the files of #l1l2stab:motion-in and #l1l2stab:motion-out.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 filesrc location=in.mp4 ! decodebin ! l1l2stab ! x264enc ! mp4mux ! filesink location=out.mp4
 * ]| Steadies a file that has no sound.
 * |[
 * gst-launch-1.0 filesrc location=in.mp4 ! decodebin name=in \
 *   in. ! queue ! l1l2stab ! x264enc ! queue ! mp4mux name=out ! filesink location=out.mp4 \
 *   in. ! queue max-size-time=0 max-size-bytes=0 max-size-buffers=0 ! audioconvert ! avenc_aac ! out.
 * ]| The same with sound. The queue of the other branch must have room for the
 * whole window: by default a queue ends at one second, and the pipeline may stall.
 * |[
 * gst-launch-1.0 v4l2src ! videoconvert ! l1l2stab window=30 ! videoconvert ! autovideosink
 * ]| A camera, with a delay of one second at 30 frames a second.
 * |[
 * gst-launch-1.0 rtspsrc location=rtsp://camera/stream latency=200 ! decodebin ! l1l2stab window=30 ! \
 *   videoconvert ! autovideosink
 * ]| A camera of the network.
 * |[
 * gst-launch-1.0 filesrc location=in.mp4 ! decodebin ! tee name=in \
 *   compositor name=both sink_1::xpos=320 ! x264enc ! mp4mux ! filesink location=out.mp4 \
 *   in. ! queue max-size-time=0 max-size-bytes=0 max-size-buffers=0 ! both.sink_0 \
 *   in. ! queue ! l1l2stab ! both.sink_1
 * ]| Before and after, side by side, for a picture that is 320 pixels wide.
 * |[
 * gst-launch-1.0 filesrc location=in-10bit.mp4 ! decodebin ! l1l2stab ! x265enc ! h265parse ! mp4mux ! \
 *   filesink location=out.mp4
 * ]| Ten bits stay ten bits, all the way.
 */
#include "gstl1l2stab.h"

static gboolean
plugin_init (GstPlugin * plugin)
{
  return GST_ELEMENT_REGISTER (l1l2stab, plugin);
}

/* 1.22 does not know the licence by its SPDX name. */
GST_PLUGIN_DEFINE (GST_VERSION_MAJOR, GST_VERSION_MINOR, l1l2stab,
    "Video stabilization with L1-L2 optimal camera paths",
    plugin_init, VERSION, "MIT/X11", PACKAGE, PACKAGE_ORIGIN)
