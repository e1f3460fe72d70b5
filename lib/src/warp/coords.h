/* SPDX-License-Identifier: MIT */
/*
 * The warp's coordinate generators: they turn a map between frames into source positions, for runs of samples of one
 * row of one output plane.
 *
 * Two coordinate systems are used. Frame positions are in luma pixels, in [0, W] x [0, H], with pixel centers at
 * half-integers. Plane positions are in samples: sample j is at j, and at frame position `first + step * j` along each
 * axis (L1L2WarpGrid, which has the chroma site in it).
 *
 * There are generators for affine maps and for meshes (mesh.h). Each has two forms:
 *
 *   positions  of every sample, for the direct sample types. Fixed point with L1L2_WARP_PHASE_BITS fractional bits.
 *   scanline   the straight pieces that the run follows through the source, for the scanline sample types. Fixed point
 *              with L1L2_WARP_STEP_BITS fractional bits. Only for maps that turn by at most 26.5 degrees (a slope
 *              of 1/2) and zoom out by at most 4/3.
 *
 * Errors. A position is rounded to half a phase, 1/2048 sample, which costs an 8-bit picture at most half a level
 * (tests/lib/warp/warp_reference.h). The step of a positions' run has 32 fractional bits: over 16384 samples its
 * rounding adds up to 2^14 * 2^-33 = 2^-19 sample. The step of a scanline has 27: over a run of 256 samples, 2^-20.
 */
#ifndef L1L2_WARP_COORDS_H
#define L1L2_WARP_COORDS_H

#include <stdbool.h>
#include <stdint.h>

#include "common/geom.h"
#include "image/format.h"
#include "warp/mesh.h"

enum {
    L1L2_WARP_PHASE_BITS = 10,
    L1L2_WARP_PHASES = 1 << L1L2_WARP_PHASE_BITS,
    L1L2_WARP_RUN_SAMPLES = 256,      /* the longest run: its positions stay in the first-level cache */
    L1L2_WARP_RUN_SLACK = 7,          /* entries after a run that a generator may overwrite */
    L1L2_WARP_STEP_BITS = 27,         /* 16 steps of a scanline, of 4/3 sample at most, fit 32 bits without a sign */
    L1L2_WARP_SCANLINE_COLUMNS = 352  /* of the longest scanline: 255 steps of 4/3 sample, and 6 taps */
};

/* Where a plane's samples lie in its frame. */
typedef struct L1L2WarpGrid {
    double size_x, size_y;   /* of the frame, pixels */
    double first_x, first_y; /* frame position of sample 0 */
    double step_x, step_y;   /* pixels from sample to sample: 1, 2 or 4 */
} L1L2WarpGrid;

/* plane: 0 .. format->planes - 1; width and height: the frame's, pixels. */
L1L2WarpGrid l1l2_warp_grid(const L1L2FormatInfo *format, int plane, L1L2StabChromaSite site, int width, int height);

/* An affine map between two planes: output sample (u, v) reads the source plane at column x[0] u + x[1] v + x[2], and
 * at the row that y gives in the same way. */
typedef struct L1L2WarpAffine {
    double x[3], y[3];
} L1L2WarpAffine;

/* map: output pixel -> source pixel, both with the origin at their frame's center. */
L1L2WarpAffine l1l2_warp_affine(const L1L2Mat *map, const L1L2WarpGrid *dst, const L1L2WarpGrid *src);

/* A mesh between two planes: output samples are at `dst`, positions are samples of `src`. */
typedef struct L1L2WarpMeshPlane {
    const L1L2WarpMesh *mesh;
    L1L2WarpGrid dst, src;
} L1L2WarpMeshPlane;

/* Cells that a run can touch. In a plane of quarter width the narrowest cell has 16 / 4 samples. */
enum { L1L2_WARP_MAX_CELLS = L1L2_WARP_RUN_SAMPLES / (L1L2_WARP_MESH_CELL_PX / 4) + 2 };

/* The cells of a run. In each, positions lie on a straight line, which starts at the cell's first sample wherever the
 * run begins. So positions do not depend on the run. */
typedef struct L1L2WarpCells {
    int column, count;                      /* the first cell, and how many */
    int skipped;                            /* samples of the first cell before the run */
    int from[L1L2_WARP_MAX_CELLS + 1];      /* the sample of the run at which each cell begins; then the run's length */
    double offset[L1L2_WARP_MAX_CELLS + 1]; /* from a cell's left side to its first sample, samples */
    double slope;                           /* 1 / the width of a cell in samples */
} L1L2WarpCells;

/* The cells of samples u .. u + count - 1: the same for all rows. count <= L1L2_WARP_RUN_SAMPLES. */
L1L2WarpCells l1l2_warp_mesh_cells(const L1L2WarpMeshPlane *plane, int u, int count);

/* Evenly spaced positions, L1L2_WARP_STEP_BITS fractional bits. From entry `from` on, entry i is at
 * `at + (i - from) * step`. `at` includes half a phase, so that cutting to phases rounds. */
typedef struct L1L2WarpPiece {
    int64_t at;
    int32_t step, from;
} L1L2WarpPiece;

/* Its entry i in phases. */
static inline int32_t l1l2_warp_piece_position(const L1L2WarpPiece *piece, int i)
{
    return (int32_t)((piece->at + (int64_t)(i - piece->from) * piece->step) >>
                     (L1L2_WARP_STEP_BITS - L1L2_WARP_PHASE_BITS));
}

/*
 * The scanline that a run follows through the source.
 *
 * `along` says at which column each sample of the run is, counted from column `first`. `down` says at which row the
 * scanline crosses each column from `first` on; for two taps, at which row each sample is. Both have one piece for an
 * affine map and up to one for each cell of a mesh. Steps along are in (0, 4/3] columns a sample, steps down at most
 * 1/2 row a column.
 */
typedef struct L1L2WarpScanline {
    int count;          /* samples of the run */
    int first, columns; /* source columns first .. first + columns - 1 have all taps; some may lie outside the plane */
    int along_pieces, down_pieces;
    L1L2WarpPiece along[L1L2_WARP_MAX_CELLS], down[L1L2_WARP_MAX_CELLS];
} L1L2WarpScanline;

/* The run of samples u .. u + count - 1 of row v, or of the cells, as a scanline with all columns of its taps. False:
 * the map turns or zooms out too far. */
bool l1l2_warp_affine_scanline(const L1L2WarpAffine *affine, int taps, int u, int v, int count,
                               L1L2WarpScanline *scanline);
bool l1l2_warp_mesh_scanline(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int taps, int v,
                             L1L2WarpScanline *scanline);

/* They write the positions of the same runs, and undefined values to the L1L2_WARP_RUN_SLACK entries after them.
 * Positions do not depend on where a run begins. Far outside they saturate, some 500000 samples from the plane's
 * corner. */
typedef struct L1L2WarpGenerators {
    void (*affine)(const L1L2WarpAffine *affine, int u, int v, int count, int32_t *x, int32_t *y);
    void (*mesh)(const L1L2WarpMeshPlane *plane, const L1L2WarpCells *cells, int v, int32_t *x, int32_t *y);
} L1L2WarpGenerators;

#endif
