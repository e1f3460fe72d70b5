/* SPDX-License-Identifier: MIT */
/*
 * A map of the output frame to the source frame by its values at evenly spaced nodes, bilinear in the cells between.
 *
 * Any map can be one (a homography, a map for each row), and all cost the same. A cell's positions are convex
 * combinations of its nodes': if all nodes lie in a convex region, such as the source frame, all positions do.
 */
#ifndef L1L2_WARP_MESH_H
#define L1L2_WARP_MESH_H

#include <stdbool.h>

#include "common/geom.h"

/* No cell is higher than 16 px. A residual changes less along a row than from row to row, and each cell of a row is a
 * piece of work: they are up to 64 px wide, some sixteen of them in a row of a small frame. */
enum { L1L2_WARP_MESH_CELL_PX = 16, L1L2_WARP_MESH_WIDEST_PX = 64 };

/* The nodes cover the output frame exactly: the first and last row and column of them lie on its border. */
typedef struct L1L2WarpMesh {
    int width, height; /* of the output frame, pixels */
    int columns, rows; /* of nodes, each >= 2 */
    L1L2Point *node;   /* [rows * columns], row by row: source positions, px from the source's centre, finite */
} L1L2WarpMesh;

/* A mesh for frames of this size, all its nodes at the centre. False when out of memory: then node is NULL. */
bool l1l2_warp_mesh_init(L1L2WarpMesh *mesh, int width, int height);

/* Fine on a zeroed mesh. */
void l1l2_warp_mesh_clear(L1L2WarpMesh *mesh);

/* Where a node lies in the output frame: pixels from its centre. */
static inline L1L2Point l1l2_warp_mesh_position(const L1L2WarpMesh *mesh, int column, int row)
{
    return (L1L2Point){((double)column / (mesh->columns - 1) - 0.5) * mesh->width,
                       ((double)row / (mesh->rows - 1) - 0.5) * mesh->height};
}

/* All nodes as a map has them. It must be finite on the output frame. */
void l1l2_warp_mesh_set(L1L2WarpMesh *mesh, const L1L2Mat *map);

#endif
