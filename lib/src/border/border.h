/* SPDX-License-Identifier: MIT */
/*
 * Renders a frame without loss of its border: what the frame does not show is taken from the frames before and after.
 *
 * The paper crops (Algorithm 1, step 5). Matsushita et al., "Full-frame video stabilization with motion inpainting"
 * (2006), fill the border from neighbors instead. As they do, this module carries motion outward from what both frames
 * show. It does so in a band along the border, and renders each neighbor's picture once:
 *
 *   1. warp.c           the frame itself
 *   2. neighbors.c      which frames fill what it lacks
 *   3. registration.c   where exactly their pictures have to be taken from
 *   4. warp.c           each of them, in the strips along the sides that need them
 *   5. composite.c      all of them in one picture; and an extension where no frame has anything to show
 *
 * The inside of the frame is the ordinary warp's, bit for bit. The result does not depend on the number of threads.
 */
#ifndef L1L2_BORDER_BORDER_H
#define L1L2_BORDER_BORDER_H

#include "border/neighbors.h"
#include "common/pool.h"
#include "warp/warp.h"

typedef struct L1L2Border L1L2Border;

typedef struct L1L2BorderConfig {
    const L1L2FormatInfo *format;
    int width, height;           /* of source and output frames, pixels */
    L1L2StabChromaSite chroma_site;
    int reach;                   /* neighbors are at most so many frames away; 0: there is only the extension */
    L1L2Warp *warp;              /* renders frames of this size; must outlive the object */
    L1L2Pool *pool;              /* ditto */
} L1L2BorderConfig;

/* A frame to render. */
typedef struct L1L2BorderJob {
    int64_t t;                   /* its number */
    const L1L2WarpMap *own;      /* as for l1l2_warp_render(); its affine map has to be set also if there is a mesh */
    const uint8_t *const *src;   /* its planes */
    const ptrdiff_t *src_stride;
    uint8_t *const *dst;
    const ptrdiff_t *dst_stride;
    const L1L2BorderNeighbor *neighbors; /* at most `reach` frames away, in any order */
    int count;
} L1L2BorderJob;

/* What was done, in parts of the output's pixels. */
typedef struct L1L2BorderShares {
    double filled;               /* from neighbors */
    double extended;             /* made up */
} L1L2BorderShares;

/* NULL when out of memory. */
L1L2Border *l1l2_border_new(const L1L2BorderConfig *cfg);
void l1l2_border_free(L1L2Border *border);

/* Forgets all frames. */
void l1l2_border_reset(L1L2Border *border);

L1L2BorderShares l1l2_border_render(L1L2Border *border, const L1L2BorderJob *job);

/* Who gave each pixel of the frame that was rendered last, row by row: 0 the frame itself, 128 + k the frame k frames
 * later (before, if negative), 255 the extension. */
const uint8_t *l1l2_border_providers(const L1L2Border *border);

#endif
