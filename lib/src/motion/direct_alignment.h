/* SPDX-License-Identifier: MIT */
/*
 * Direct alignment: the similarity between two pictures, from their brightness instead of from tracked points.
 *
 * It serves where no corners can be followed: motion blur, fog, night, thermal cameras, repeated texture. Several first
 * guesses are refined from coarse to fine by Gauss-Newton (Lucas & Kanade, 1981) in the inverse compositional form
 * (Baker & Matthews, "Lucas-Kanade 20 years on", IJCV 2004, section 3.2), with robust weights and with the contrast and
 * the brightness of the other picture as two further unknowns. Of the refined guesses, the one with the smallest
 * clipped difference wins.
 *
 * The result carries its evidence, and l1l2_motion_align_accepts() judges it. Nothing is remembered between calls.
 */
#ifndef L1L2_MOTION_DIRECT_ALIGNMENT_H
#define L1L2_MOTION_DIRECT_ALIGNMENT_H

#include <stdbool.h>

#include "common/geom.h"
#include "image/float_pyramid.h"
#include "motion/vision.h"

/* First guesses that a caller may give, and cells of the picture that are judged one by one. */
enum {
    L1L2_ALIGN_MAX_STARTS = 6,
    L1L2_ALIGN_CELLS_X = 6,
    L1L2_ALIGN_CELLS_Y = 4,
    L1L2_ALIGN_CELLS = L1L2_ALIGN_CELLS_X * L1L2_ALIGN_CELLS_Y
};

typedef struct L1L2DirectAlignment L1L2DirectAlignment;

/* Why a motion can be believed. Lengths are pixels of the pyramids' picture, residuals are grey levels. */
typedef struct L1L2AlignmentEvidence {
    /* Normalized correlation of the two pictures where they overlap, [-1, 1]: as aligned, as they lie, and by the
     * rival: the best refined guess that is another motion. A rival that does not exist has correlation -1. */
    double correlation, identity_correlation, rival_correlation;
    /* Mean difference, clipped at half the picture's contrast. A rival that does not exist has INFINITY. */
    double residual, identity_residual, rival_residual;
    /* Of the caller's first guesses as they are, in the winner's gain and offset. A measurement of another kind whose
     * residual is about the winner's is as good. */
    double start_residual[L1L2_ALIGN_MAX_STARTS];
    double rival_distance; /* of the rival's motion from the winner's: rms at the frame's corners */
    double overlap;        /* part of the frame that lies in the other picture, [0, 1] */
    double gain, offset;   /* other picture to this one: brightness * gain + offset */
    /* Of the cells with detail: the part whose residual is clearly smaller by the winner than by the identity and by
     * the rival, and the part where one of these is clearly better. */
    double support, opposition;
    double detail;         /* part of the cells that have detail */
    double agreement;      /* part of these cells that agree with one similarity, the winner's or the one that it was
                            * before it was refined by these cells alone */
    double local_shift;    /* median over the cells with detail: how far each by itself would still move */
    /* Standard deviation of the motion along each principal direction of its four parameters, as it moves the frame's
     * corners; the smallest first. What is large is not determined: one edge, a flat picture. */
    double deviation[4];
    double scatter;        /* robust deviation of the residual */
} L1L2AlignmentEvidence;

/* What a caller knows before. */
typedef struct L1L2AlignmentGuide {
    /* First guesses of F besides those that are always tried: the identity and the peaks of the phase correlation. Of
     * guesses that fit equally well, as where texture repeats, the one that comes from the first of these wins. */
    L1L2Mat start[L1L2_ALIGN_MAX_STARTS]; /* the first is what is expected, usually the motion of the frame before */
    int starts;
    const L1L2Mat *layer; /* the motion of something that lies over the scene, such as text: what moves with it does not
                           * count; NULL: there is none */
    L1L2Mask mask;      /* places of either picture that do not count: static overlays */
    const float *trust; /* how much each cell of frame `now` counts, row by row, [0, 1]; NULL: all the same */
    /* Where the cells part into two motions, follow the one of the more trusted cells and name the other one the rival;
     * else the winner may lie between two that are close to each other. For callers whose trust remembers which part
     * was followed before: without memory, the choice flickers where depth varies. */
    bool split;
} L1L2AlignmentGuide;

typedef struct L1L2Alignment {
    L1L2Mat F; /* frame `now` to frame `other`; unit: the frame's diagonal */
    /* About the same, from the two pictures alone, without the caller's guesses and trust: good to a few pixels. Where
     * it serves as the next frame's expected motion, no result depends on more than three pictures. */
    L1L2Mat blind;
    L1L2AlignmentEvidence evidence;
} L1L2Alignment;

/* width, height: of the pictures, pixels. frame_width, frame_height: of the frames that they show, any unit in which
 * these are square. NULL: no memory. */
L1L2DirectAlignment *l1l2_motion_align_new(int width, int height, double frame_width, double frame_height);
void l1l2_motion_align_free(L1L2DirectAlignment *d);

/* The motion F from frame `now` to frame `other`, which is usually the one before it. Allocates nothing. */
void l1l2_motion_align(L1L2DirectAlignment *d, const L1L2FloatPyramid *now, const L1L2FloatPyramid *other,
                       const L1L2AlignmentGuide *guide, L1L2Alignment *out);

/* What whole pictures say of a motion that was measured otherwise. */
typedef struct L1L2AlignmentCheck {
    /* Parts of the cells with detail: where it fits clearly better than the best motion found from it and from the
     * expected one, and where that one does. */
    double support, against;
} L1L2AlignmentCheck;

/* Compares F with what a few steps of refinement make of it and of `expected`, at level 0. With small pictures that
 * takes a small part of an alignment's time. */
void l1l2_motion_align_check(L1L2DirectAlignment *d, const L1L2FloatPyramid *now, const L1L2FloatPyramid *other,
                             const L1L2Mat *F, const L1L2Mat *expected, L1L2Mask mask, L1L2AlignmentCheck *out);

/* True if the evidence is that of a right motion. A caller that has another measurement may ask for more. */
bool l1l2_motion_align_accepts(const L1L2AlignmentEvidence *e);

#endif
