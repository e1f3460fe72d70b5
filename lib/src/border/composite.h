/* SPDX-License-Identifier: MIT */
/*
 * Puts the filled frame together: the frame itself where it is seen, the sources in their order where it is not, and an
 * extension where no source is.
 *
 * Each layer has a weight that rises from 0 at the sides of its own frame to 1 at `seam` pixels inside. From front to
 * back, each layer takes its weight's part of what the layers before it left:
 *
 *     output = sum_k a_k v_k,   a_k = w_k (1 - a_0 - ... - a_{k-1}).
 *
 * So there is no hard edge, and a pixel of the frame that is farther inside than the seam is not touched. A source is
 * weighed by its agreement (registration.h) as well. Where hardly any agrees, as with a pillar that is walked past, the
 * sum without agreements is shown: the nearest source. It is closer to the truth than an extension is, by 19 to 24 dB
 * on such a walk (tests/bench/bench_border), and it has no ragged edge.
 *
 * Exposure, white balance and vignetting differ from frame to frame. Beside the border, where both the frame and a
 * source are seen, their mean difference is taken around each node of the grid, for each component. The source gets the
 * weighted mean of the nodes around a place, so what is measured beside the border is carried outward.
 *
 * The extension is the frame mirrored at its sides, softer with the distance.
 */
#ifndef L1L2_BORDER_COMPOSITE_H
#define L1L2_BORDER_COMPOSITE_H

#include "border/neighbors.h"
#include "border/registration.h"
#include "common/pool.h"
#include "warp/coords.h"
#include "warp/warp.h"

/* Who gave a pixel: 0 the frame itself, L1L2_BORDER_NEIGHBOR + k the frame k frames later, 255 the extension. */
enum { L1L2_BORDER_OWN = 0, L1L2_BORDER_NEIGHBOR = 128, L1L2_BORDER_EXTENDED = 255 };

typedef struct L1L2BorderSource {
    int distance;                /* frames from the frame that is filled, its number minus that one's */
    const L1L2WarpMesh *mesh;    /* output -> source positions */
    L1L2WarpParts part;       /* of the strips: where it may be shown */
    uint8_t *data[4];            /* the source in the output's geometry, rendered there */
    ptrdiff_t stride[4];
    L1L2BorderField field;
    float *offset;               /* [L1L2_BORDER_COMPONENTS * nodes], component by component: what is added to it */
} L1L2BorderSource;

/* Components of all planes, at most. */
enum { L1L2_BORDER_COMPONENTS = 4 };

typedef struct L1L2BorderComposite {
    const L1L2FormatInfo *format;
    L1L2StabChromaSite chroma_site;
    int width, height;           /* of output and source frames, pixels */
    double seam;                 /* pixels */
    L1L2WarpGenerators generators;
    L1L2Pool *pool;
    uint8_t *provider;           /* [height * width]: who gave each pixel; 0 before */

    /* Of the frame: */
    L1L2WarpMap own;             /* as it was rendered */
    const uint8_t *const *src;   /* its planes */
    const ptrdiff_t *src_stride;
    uint8_t *const *dst;         /* the output, with the frame rendered into it */
    const ptrdiff_t *dst_stride;
    L1L2WarpParts strips;
    int sources;
    L1L2BorderSource *source;
} L1L2BorderComposite;

/* Measures the offsets of all sources, and paints the strips. */
void l1l2_border_composite(L1L2BorderComposite *composite);

#endif
