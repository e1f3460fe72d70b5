/* SPDX-License-Identifier: MIT */
/*
 * The warp's coordinate generators: from a map of frames to source positions for runs of output samples of one plane.
 *
 * Two coordinates are at play. In the frame: luma pixels in [0, W] x [0, H], pixel centres at half-integers. In a
 * plane: sample j is at j. It lies at the frame's `first + step * j`, by axis: L1L2WarpGrid.
 *
 * A generator writes positions for a kernel to read: fixed point, L1L2_WARP_PHASE_BITS fractional bits. There are two,
 * for affine maps and for meshes (warp_mesh.h).
 */
#ifndef L1L2_WARP_COORDS_H
#define L1L2_WARP_COORDS_H

#include <stdbool.h>
#include <stdint.h>

#include "common/geom.h"
#include "image/format.h"
#include "warp/mesh.h"

enum {
    L1L2_WARP_PHASE_BITS = 10, /* 1/1024 px: what rounding a position costs stays well under one grey level */
    L1L2_WARP_PHASES = 1 << L1L2_WARP_PHASE_BITS,
    L1L2_WARP_RUN_SAMPLES = 256, /* the positions of a run stay in the first-level cache */
    L1L2_WARP_RUN_SLACK = 7,
    L1L2_WARP_STEP_BITS = 27, /* 16 steps of a line fit 32 bits */
    L1L2_WARP_SCANLINE_COLUMNS = 352 /* of a run at the largest step, with its taps */
};

/* Where a plane's samples lie in the frame. */
typedef struct L1L2WarpGrid {
    double size_x, size_y;   /* of the frame, pixels */
    double first_x, first_y; /* frame position of sample 0 */
    double step_x, step_y;   /* pixels from sample to sample: 1 or 2 */
} L1L2WarpGrid;

/* plane: 0 .. format->planes - 1; width and height: the frame's, pixels. */
L1L2WarpGrid l1l2_warp_grid(const L1L2FormatInfo *format, int plane, L1L2StabChromaSite site, int width, int height);

/* Output sample (u, v) reads the source plane at x[0] u + x[1] v + x[2], likewise y. */
typedef struct L1L2WarpAffine {
    double x[3], y[3];
} L1L2WarpAffine;

/* map: output pixel -> source pixel, both with the origin at their frame's centre. */
L1L2WarpAffine l1l2_warp_affine(const L1L2Mat *map, const L1L2WarpGrid *dst, const L1L2WarpGrid *src);

/* A mesh, as two planes have it: output samples are at `dst`, positions are samples of `src`. */
typedef struct L1L2WarpMeshPlane {
    const L1L2WarpMesh *mesh;
    L1L2WarpGrid dst, src;
} L1L2WarpMeshPlane;

enum { L1L2_WARP_MAX_CELLS = L1L2_WARP_RUN_SAMPLES / (L1L2_WARP_MESH_CELL_PX / 4) + 2 }; /* of chroma, in a run */

/* The cells of a run. In each, positions are a line, which starts at the cell's first sample wherever the run does. */
typedef struct L1L2WarpCells {
    int column, count;
    int skipped;                          /* samples of the first cell that come before the run */
    int from[L1L2_WARP_MAX_CELLS + 1];    /* sample of the run with which each cell begins; then the run's length */
    double offset[L1L2_WARP_MAX_CELLS + 1]; /* of a cell's first sample from its left side, samples */
    double slope;                         /* 1 / a cell's width in samples */
} L1L2WarpCells;

/* They are the same for all rows. count <= L1L2_WARP_RUN_SAMPLES. */
L1L2WarpCells l1l2_warp_mesh_cells(const L1L2WarpMeshPlane *plane, int u, int count);

/* Positions at even steps, L1L2_WARP_STEP_BITS fractional bits: entry i, of those from `from` on, is at
 * `at + (i - from) * step`. Half a phase is added, so that a cut to phases rounds. */
typedef struct L1L2WarpPiece {
    int64_t at;
    int32_t step, from;
} L1L2WarpPiece;

/* Its entry i, cut to phases. */
static inline int32_t l1l2_warp_piece_position(const L1L2WarpPiece *piece, int i)
{
    return (int32_t)((piece->at + (int64_t)(i - piece->from) * piece->step) >>
                     (L1L2_WARP_STEP_BITS - L1L2_WARP_PHASE_BITS));
}

/* The way that a run takes through the source: where each of its samples lies across, and at which row the way crosses
 * each column around them. One piece for an affine map, one a cell for a mesh. Along, steps are 0 .. 4/3 columns a
 * sample, down at most 1/2 row a column. */
typedef struct L1L2WarpScanline {
    int count, first, columns; /* samples; the source columns first .. first + columns - 1, some of them outside */
    int along_pieces, down_pieces;
    L1L2WarpPiece along[L1L2_WARP_MAX_CELLS]; /* by sample of the run: columns from `first` on */
    L1L2WarpPiece down[L1L2_WARP_MAX_CELLS];  /* by column from `first` on: rows. With two taps, by sample */
} L1L2WarpScanline;

/* They write the positions of a run of output samples of row v: (u .. u + count - 1, v), or what the cells cover; and
 * anything at all to the L1L2_WARP_RUN_SLACK entries behind it. Positions do not depend on where a run begins; far
 * outside they saturate, at some 500000 samples from the plane's corner. */
typedef struct L1L2WarpGenerators {
    void (*affine)(const L1L2WarpAffine *affine, int u, int v, int count, int32_t *x, int32_t *y);
    void (*mesh)(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, int32_t *x, int32_t *y);
} L1L2WarpGenerators;

/* The same runs as lines with all columns of their taps. False: the map zooms out or turns too far for one. */
bool l1l2_warp_affine_scanline(const L1L2WarpAffine *affine, int taps, int u, int v, int count, L1L2WarpScanline *line);
bool l1l2_warp_mesh_scanline(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int taps, int v,
                         L1L2WarpScanline *line);

/* The fastest that this processor has; all give the same positions. */
const L1L2WarpGenerators *l1l2_warp_generators(void);

/* Plain C, for every processor. */
extern const L1L2WarpGenerators l1l2_warp_generators_plain;

/* There only where the build defines L1L2_WARP_AVX2, and for processors that have it. */
extern const L1L2WarpGenerators l1l2_warp_generators_avx2;

#endif
