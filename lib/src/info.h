/* SPDX-License-Identifier: MIT */
/* What the caller is told of a frame: L1L2StabInfo, in pixels. */
#ifndef L1L2_INFO_H
#define L1L2_INFO_H

#include "frame_queue.h"
#include "path/path.h"

/* A map in diagonals as the caller's, in pixels. */
void l1l2_info_export(const L1L2Mat *m, double diagonal_px, double px[9]);

/* All that the frame and its path tell by themselves; the rest is 0. */
void l1l2_info_describe(L1L2StabInfo *info, const L1L2QueuedFrame *held, const L1L2PathFrame *f, double diagonal_px);

#endif
