/* SPDX-License-Identifier: MIT */
/* The reader of motion files: any bytes are refused with one error, or give motions within their documented ranges.
 * What was read is written again, and that file has to be readable. The first bytes of the input choose the frames that
 * are asked for, the rest is the file. */
#include <gst/video/video.h>

#include "fuzz_gst.h"
#include "gstl1l2stabmotionfiles.h"

enum { ASKED = 16 };

static void check_motion(const GstL1L2StabMotion *motion)
{
    FUZZ_CHECK(motion->quality >= 0 && motion->quality <= 1, "quality %g", motion->quality);
    FUZZ_CHECK(motion->inliers >= 0 && motion->inliers <= motion->tracks, "%d of %d", motion->inliers, motion->tracks);
    for (int i = 0; i < 9; i++)
        FUZZ_CHECK(isfinite(motion->F[i]), "F[%d] is %g", i, motion->F[i]);
    FUZZ_CHECK(motion->F[0] * motion->F[4] - motion->F[1] * motion->F[3] > 0, "the motion cannot be inverted");
}

static void write_motion(GstL1L2StabMotionWriter *out, GstClockTime time, const GstL1L2StabMotion *motion)
{
    L1L2StabInfo info = {
        .flags = motion->starts_path ? L1L2STAB_INFO_PATH_START : 0,
        .model = motion->model,
        .quality = motion->quality,
        .tracks = motion->tracks,
        .inliers = motion->inliers,
    };
    memcpy(info.F, motion->F, sizeof info.F);
    FUZZ_CHECK(gst_l1l2_stab_motion_writer_write(out, time, &info), "cannot write");
}

/* Asks for frames at chosen times, and writes their motions. Returns their number. */
static int copy_motions(FuzzInput *choices, GstL1L2StabMotionReader *in, GstL1L2StabMotionWriter *out)
{
    GstClockTime time = 0;
    int written = 0;
    for (int i = 0; i < ASKED; i++) {
        GstL1L2StabMotion motion;
        const int kind = fuzz_below(choices, 8);
        if (kind < 5)
            time += 40 * GST_MSECOND * (GstClockTime)kind;
        else
            time = kind == 5 ? GST_CLOCK_TIME_NONE : fuzz_bits(choices, kind == 6 ? 8 : 4);
        if (fuzz_chance(choices, 16))
            gst_l1l2_stab_motion_reader_flush(in);
        if (!gst_l1l2_stab_motion_reader_next(in, time, &motion))
            continue;
        check_motion(&motion);
        write_motion(out, time, &motion);
        written++;
    }
    return written;
}

static void read_frames(FuzzInput *choices, GstElement *element, GstL1L2StabMotionReader *in)
{
    GstVideoInfo video;
    FuzzFile copy = fuzz_file_new(NULL, 0);
    gst_video_info_set_format(&video, GST_VIDEO_FORMAT_I420, 64, 48);
    video.fps_n = 25, video.fps_d = 1;
    gst_l1l2_stab_motion_reader_check(in, &video);
    GstL1L2StabMotionWriter *out = gst_l1l2_stab_motion_writer_open(element, copy.name);
    FUZZ_CHECK(out, "cannot open");
    gst_l1l2_stab_motion_writer_begin(out, &video);
    const int written = copy_motions(choices, in, out);
    FUZZ_CHECK(gst_l1l2_stab_motion_writer_close(out), "cannot close");
    if (written > 0) {
        GstL1L2StabMotionReader *again = gst_l1l2_stab_motion_reader_open(element, copy.name);
        FUZZ_CHECK(again, "a file that was written cannot be read");
        gst_l1l2_stab_motion_reader_close(again);
    }
    fuzz_file_free(&copy);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const size_t choice_bytes = size < 2 * ASKED ? size : 2 * ASKED;
    FuzzInput choices = {data, data + choice_bytes};
    fuzz_gst_init();
    GstElement *element = fuzz_element_new();
    FuzzFile file = fuzz_file_new(data + choice_bytes, size - choice_bytes);
    GstL1L2StabMotionReader *in = gst_l1l2_stab_motion_reader_open(element, file.name);
    FUZZ_CHECK(fuzz_count_errors(element) == (in ? 0 : 1), "not one error for a faulty file");
    if (in) {
        read_frames(&choices, element, in);
        gst_l1l2_stab_motion_reader_close(in);
    }
    fuzz_file_free(&file);
    fuzz_element_free(element);
    return 0;
}
