/* SPDX-License-Identifier: MIT */
/* What the caller gets to know of a frame: L1L2StabInfo, in pixels. */
#ifndef L1L2_INFO_H
#define L1L2_INFO_H

#include "frame_queue.h"

/* Fills in all that the frame's record says; the rest is 0. */
void l1l2_info_describe(L1L2StabInfo *info, const L1L2QueuedFrame *record, double diagonal_px);

#endif
