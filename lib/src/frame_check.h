/* SPDX-License-Identifier: MIT */
/* Whether a caller's frame can be taken. What is wrong with it is logged. */
#ifndef L1L2_FRAME_CHECK_H
#define L1L2_FRAME_CHECK_H

#include <stdbool.h>

#include "image/format.h"

/* All planes of the format are there. */
bool l1l2_frame_has_planes(const L1L2StabFrame *frame, const L1L2FormatInfo *format, const L1L2StabLogger *log);

/* frame->motion is a map of the motion model that can be inverted, as path.c needs it. */
bool l1l2_frame_has_motion(const L1L2StabFrame *frame, L1L2StabMotionModel model, const L1L2StabLogger *log);

#endif
