/* SPDX-License-Identifier: MIT */
/*
 * Motion blur: how far a picture is smeared, and in which direction, by its loss of slope against a sharp picture of
 * about the same scene.
 *
 * A blur of some length takes away most of the brightness' slope along its direction and none across it. The mean
 * outer product of the slopes (the structure tensor) of the blurred picture, T, and of the sharp one, T0, tell both:
 * the direction is the u for which u'T u / u'T0 u is smallest, the generalized eigenvector. The length is found by
 * smearing the sharp picture along u until it has lost as much. Neither needs the two to be aligned.
 */
#ifndef L1L2_MOTION_MOTION_BLUR_H
#define L1L2_MOTION_MOTION_BLUR_H

#include "image/float_pyramid.h"

/* The mean of (sx sx, sx sy, sy sy) over the pyramid's largest level, grey levels squared a sample squared. */
typedef struct L1L2StructureTensor {
    double xx, xy, yy;
} L1L2StructureTensor;

typedef struct L1L2MotionBlur {
    double length; /* pixels of the picture; 0: as sharp as the other one */
    double x, y;   /* the direction, a unit vector with x >= 0 */
    double along, across; /* part of the slope's energy that is left along the direction and across it */
} L1L2MotionBlur;

/* Cheap: what a caller keeps of each picture to find the sharp ones. */
L1L2StructureTensor l1l2_motion_blur_tensor(const L1L2FloatPyramid *p);

/* How much sharper picture a is than b: the smallest ratio of their slopes' energy in any direction. Above 1: sharper
 * in every direction. 0 where b has no slopes in some direction. */
double l1l2_motion_blur_sharper(const L1L2StructureTensor *a, const L1L2StructureTensor *b);

/* The blur of a picture against a sharp one of about the same scene. `noise`: of level 0, grey levels; slopes that it
 * makes are taken away from both. */
L1L2MotionBlur l1l2_motion_blur_measure(const L1L2FloatPyramid *picture, const L1L2FloatPyramid *sharp,
                                        double noise);

#endif
