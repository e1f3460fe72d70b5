/* SPDX-License-Identifier: MIT */
/* Describes a frame to the caller: fills in L1L2StabInfo, in pixels. */
#ifndef L1L2_INFO_H
#define L1L2_INFO_H

#include "frame_queue.h"

/* Fills in what is in the frame's record; the rest is 0. */
void l1l2_info_describe(L1L2StabInfo *info, const L1L2QueuedFrame *record, double diagonal_px);

#endif
