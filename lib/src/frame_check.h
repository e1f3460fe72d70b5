/* SPDX-License-Identifier: MIT */
/* Whether a caller's frame can be used. What is wrong with it is logged. */
#ifndef L1L2_FRAME_CHECK_H
#define L1L2_FRAME_CHECK_H

#include <stdbool.h>

#include "image/format.h"

/* Copies a frame of any version's layout into *out; fields that its layout lacks are zero. */
L1L2StabResult l1l2_frame_read(const L1L2StabFrame *in, L1L2StabFrame *out, const L1L2StabLogger *log);

/* Every plane of the format is there. Where components take two bytes, addresses and strides are even: the kernels read
 * such components as 16-bit numbers. */
bool l1l2_frame_has_planes(const L1L2StabFrame *frame, const L1L2FormatInfo *format, const L1L2StabLogger *log);

/* frame->motion is a map of cfg->motion_model, and a motion that a camera can make: not mirrored, at most L1L2_MAX_STEP
 * diagonals long, and stretching no direction by more than L1L2_MAX_STRETCH or less than its inverse. Measured motions
 * stay far within (0.8 to 1.25, and they need overlapping pictures). The limits keep products of motions over the
 * longest window of 900 frames within the range of a double: 2^900 is near 10^271. */
#define L1L2_MAX_STEP 10.0
#define L1L2_MAX_STRETCH 2.0
bool l1l2_frame_has_motion(const L1L2StabFrame *frame, const L1L2StabConfig *cfg);

#endif
