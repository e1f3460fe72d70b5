/* SPDX-License-Identifier: MIT */
/*
 * A map from the output frame to the source frame, given by its values at evenly spaced nodes and bilinear in the cells
 * between them.
 *
 * Any map can be approximated by a mesh, a homography or one map for each row, and all cost the same. A position in a
 * cell is a convex combination of the cell's nodes. So if all nodes lie in a convex region, such as the source frame,
 * all positions do.
 */
#ifndef L1L2_WARP_MESH_H
#define L1L2_WARP_MESH_H

#include <stdbool.h>

#include "common/geom.h"

/* Cells are at most 16 px high. They are up to 64 px wide, since a rolling-shutter residual changes less along a row
 * than from row to row, and each cell of a row costs time. A small frame has about sixteen cells in a row. */
enum { L1L2_WARP_MESH_CELL_PX = 16, L1L2_WARP_MESH_WIDEST_PX = 64 };

/* The nodes cover the output frame exactly: the first and last row and column of them lie on its border. */
typedef struct L1L2WarpMesh {
    int width, height; /* of the output frame, pixels */
    int columns, rows; /* of nodes, each >= 2 */
    L1L2Point *node;   /* [rows * columns], row by row: source positions, px from the source frame's center, finite */
} L1L2WarpMesh;

/* A mesh for frames of this size, with all nodes at the center. False when out of memory: then node is NULL. */
bool l1l2_warp_mesh_init(L1L2WarpMesh *mesh, int width, int height);

/* Frees the nodes. A zeroed mesh is allowed. */
void l1l2_warp_mesh_clear(L1L2WarpMesh *mesh);

/* Where a node lies in the output frame: pixels from its center. */
static inline L1L2Point l1l2_warp_mesh_position(const L1L2WarpMesh *mesh, int column, int row)
{
    return (L1L2Point){((double)column / (mesh->columns - 1) - 0.5) * mesh->width,
                       ((double)row / (mesh->rows - 1) - 0.5) * mesh->height};
}

/* Sets all nodes to a map's values. The map must be finite on the output frame. */
void l1l2_warp_mesh_set(L1L2WarpMesh *mesh, const L1L2Mat *map);

#endif
