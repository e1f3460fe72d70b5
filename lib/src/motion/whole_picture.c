/* SPDX-License-Identifier: MIT */
#include "motion/whole_picture.h"

#include "common/mem.h"

struct L1L2WholePicture {
    L1L2DirectAlignment *aligner;
    L1L2GrayPicture gray[2];                         /* previous, current */
    L1L2FloatPyramid *previous, *current;            /* built when they are needed */
    bool has_previous, has_current;                   /* these are built */
};

bool l1l2_motion_whole_picture_create(L1L2WholePicture **out, int width, int height, double frame_width,
                                      double frame_height)
{
    *out = NULL;
    if (width < L1L2_FLOAT_PYRAMID_MIN_SIDE || height < L1L2_FLOAT_PYRAMID_MIN_SIDE)
        return true;
    L1L2WholePicture *w = l1l2_mem_new(1, sizeof *w);
    if (!w)
        return false;
    w->aligner = l1l2_motion_align_new(width, height, frame_width, frame_height);
    w->previous = l1l2_image_float_pyramid_new(width, height);
    w->current = l1l2_image_float_pyramid_new(width, height);
    if (!w->aligner || !w->previous || !w->current) {
        l1l2_motion_whole_picture_free(w);
        return false;
    }
    *out = w;
    return true;
}

void l1l2_motion_whole_picture_free(L1L2WholePicture *w)
{
    if (!w)
        return;
    l1l2_motion_align_free(w->aligner);
    l1l2_image_float_pyramid_free(w->previous);
    l1l2_image_float_pyramid_free(w->current);
    l1l2_mem_free(w);
}

void l1l2_motion_whole_picture_reset(L1L2WholePicture *w)
{
    if (!w)
        return;
    w->has_previous = w->has_current = false;
}

static void swap(L1L2FloatPyramid **a, L1L2FloatPyramid **b)
{
    L1L2FloatPyramid *const kept = *a;
    *a = *b;
    *b = kept;
}

void l1l2_motion_whole_picture_advance(L1L2WholePicture *w, L1L2GrayPicture previous, L1L2GrayPicture current)
{
    if (!w)
        return;
    w->gray[0] = previous;
    w->gray[1] = current;
    swap(&w->previous, &w->current);
    w->has_previous = w->has_current;
    w->has_current = false;
}

static void build(L1L2WholePicture *w)
{
    if (!w->has_previous)
        l1l2_image_float_pyramid_build(w->previous, w->gray[0].data, w->gray[0].stride);
    if (!w->has_current)
        l1l2_image_float_pyramid_build(w->current, w->gray[1].data, w->gray[1].stride);
    w->has_previous = w->has_current = true;
}

bool l1l2_motion_whole_picture_align(L1L2WholePicture *w, const L1L2Mat *expected, const L1L2Mat *tracks,
                                     const float trust[L1L2_ALIGN_CELLS], L1L2Alignment *out)
{
    L1L2AlignmentGuide guide = {.starts = 1, .trust = trust, .split = true};
    *out = (L1L2Alignment){.F = l1l2_mat_identity(), .blind = l1l2_mat_identity()};
    if (!w)
        return false;
    build(w);
    guide.start[0] = *expected;
    if (tracks)
        guide.start[guide.starts++] = *tracks;
    l1l2_motion_align(w->aligner, w->current, w->previous, &guide, out);
    return l1l2_motion_align_accepts(&out->evidence);
}
