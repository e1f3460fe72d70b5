/* SPDX-License-Identifier: MIT */
#include "motion/whole_picture.h"

#include "common/mem.h"
#include "motion/motion_blur.h"

/* Of the slopes' energy that the reference has; less is blur. Two sharp pictures of a pan have 0.85 to 1.15 of each
 * other's. */
static const double sharp_share = 0.6;

/* An aligner with the two pictures that it compares, at one size. */
typedef struct PicturePair {
    L1L2DirectAlignment *aligner;
    L1L2GrayPicture gray[2];               /* previous, current */
    L1L2FloatPyramid *previous, *current;  /* built when they are needed */
    bool has_previous, has_current;        /* these are built */
} PicturePair;

struct L1L2WholePicture {
    PicturePair size[L1L2_WHOLE_PICTURE_SIZES];
    L1L2FloatPyramid *reference; /* the last picture that was kept */
};

static bool create_pair(PicturePair *pair, const L1L2GrayPicture *size, double frame_width, double frame_height)
{
    pair->aligner = l1l2_motion_align_new(size->width, size->height, frame_width, frame_height);
    pair->previous = l1l2_image_float_pyramid_new(size->width, size->height);
    pair->current = l1l2_image_float_pyramid_new(size->width, size->height);
    return pair->aligner && pair->previous && pair->current;
}

bool l1l2_motion_whole_picture_create(L1L2WholePicture **out, const L1L2GrayPicture size[L1L2_WHOLE_PICTURE_SIZES],
                                      double frame_width, double frame_height)
{
    *out = NULL;
    const L1L2GrayPicture *smallest = &size[L1L2_WHOLE_PICTURE_SMALL];
    if (smallest->width < L1L2_FLOAT_PYRAMID_MIN_SIDE || smallest->height < L1L2_FLOAT_PYRAMID_MIN_SIDE)
        return true;
    L1L2WholePicture *w = l1l2_mem_new(1, sizeof *w);
    if (!w)
        return false;
    for (int i = 0; i < L1L2_WHOLE_PICTURE_SIZES; i++)
        if (!create_pair(&w->size[i], &size[i], frame_width, frame_height)) {
            l1l2_motion_whole_picture_free(w);
            return false;
        }
    const L1L2GrayPicture *full = &size[L1L2_WHOLE_PICTURE_FULL];
    w->reference = l1l2_image_float_pyramid_new(full->width, full->height);
    if (!w->reference) {
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
    for (int i = 0; i < L1L2_WHOLE_PICTURE_SIZES; i++) {
        l1l2_motion_align_free(w->size[i].aligner);
        l1l2_image_float_pyramid_free(w->size[i].previous);
        l1l2_image_float_pyramid_free(w->size[i].current);
    }
    l1l2_image_float_pyramid_free(w->reference);
    l1l2_mem_free(w);
}

void l1l2_motion_whole_picture_reset(L1L2WholePicture *w)
{
    for (int i = 0; w && i < L1L2_WHOLE_PICTURE_SIZES; i++)
        w->size[i].has_previous = w->size[i].has_current = false;
}

static void advance(PicturePair *pair, const L1L2GrayPicture *previous, const L1L2GrayPicture *current)
{
    L1L2FloatPyramid *const kept = pair->previous;
    pair->previous = pair->current;
    pair->current = kept;
    pair->gray[0] = *previous;
    pair->gray[1] = *current;
    pair->has_previous = pair->has_current;
    pair->has_current = false;
}

void l1l2_motion_whole_picture_advance(L1L2WholePicture *w, const L1L2GrayPicture previous[L1L2_WHOLE_PICTURE_SIZES],
                                       const L1L2GrayPicture current[L1L2_WHOLE_PICTURE_SIZES])
{
    for (int i = 0; w && i < L1L2_WHOLE_PICTURE_SIZES; i++)
        advance(&w->size[i], &previous[i], &current[i]);
}

static void build(PicturePair *pair)
{
    if (!pair->has_previous)
        l1l2_image_float_pyramid_build(pair->previous, pair->gray[0].data, pair->gray[0].stride);
    if (!pair->has_current)
        l1l2_image_float_pyramid_build(pair->current, pair->gray[1].data, pair->gray[1].stride);
    pair->has_previous = pair->has_current = true;
}

void l1l2_motion_whole_picture_check(L1L2WholePicture *w, const L1L2Mat *F, const L1L2Mat *expected,
                                     L1L2Mask mask, L1L2AlignmentCheck *out)
{
    *out = (L1L2AlignmentCheck){0.0, 0.0};
    if (!w)
        return;
    PicturePair *pair = &w->size[L1L2_WHOLE_PICTURE_SMALL];
    build(pair);
    l1l2_motion_align_check(pair->aligner, pair->current, pair->previous, F, expected, mask, out);
}

/* Aligns the current picture with the previous one, or with the reference. */
static bool align(L1L2WholePicture *w, bool with_reference, const L1L2AlignmentGuide *guide, L1L2Alignment *out)
{
    *out = (L1L2Alignment){.F = l1l2_mat_identity(), .blind = l1l2_mat_identity()};
    if (!w)
        return false;
    PicturePair *pair = &w->size[L1L2_WHOLE_PICTURE_FULL];
    build(pair);
    l1l2_motion_align(pair->aligner, pair->current, with_reference ? w->reference : pair->previous, guide, out);
    return l1l2_motion_align_accepts(&out->evidence);
}

bool l1l2_motion_whole_picture_align(L1L2WholePicture *w, const L1L2AlignmentGuide *guide, L1L2Alignment *out)
{
    return align(w, false, guide, out);
}

void l1l2_motion_whole_picture_keep(L1L2WholePicture *w)
{
    if (!w)
        return;
    PicturePair *pair = &w->size[L1L2_WHOLE_PICTURE_FULL];
    build(pair);
    L1L2FloatPyramid *const kept = pair->previous;
    pair->previous = w->reference;
    w->reference = kept;
    pair->has_previous = false;
}

bool l1l2_motion_whole_picture_bridge(L1L2WholePicture *w, const L1L2AlignmentGuide *guide, L1L2Alignment *out)
{
    return align(w, true, guide, out);
}

bool l1l2_motion_whole_picture_is_sharp(L1L2WholePicture *w)
{
    if (!w)
        return true;
    PicturePair *pair = &w->size[L1L2_WHOLE_PICTURE_FULL];
    build(pair);
    const L1L2StructureTensor now = l1l2_motion_blur_tensor(pair->current);
    const L1L2StructureTensor then = l1l2_motion_blur_tensor(w->reference);
    return now.xx + now.yy >= sharp_share * (then.xx + then.yy);
}
