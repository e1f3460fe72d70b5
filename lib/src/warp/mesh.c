/* SPDX-License-Identifier: MIT */
#include "warp/mesh.h"

#include "common/mem.h"

static int count_nodes(int size, int cell)
{
    return (size + cell - 1) / cell + 1;
}

static int cell_width(int width)
{
    const int sixteenth = width / 16 / L1L2_WARP_MESH_CELL_PX * L1L2_WARP_MESH_CELL_PX;
    return sixteenth < L1L2_WARP_MESH_CELL_PX ? L1L2_WARP_MESH_CELL_PX
         : sixteenth < L1L2_WARP_MESH_WIDEST_PX ? sixteenth : L1L2_WARP_MESH_WIDEST_PX;
}

bool l1l2_warp_mesh_init(L1L2WarpMesh *mesh, int width, int height)
{
    *mesh = (L1L2WarpMesh){width, height, count_nodes(width, cell_width(width)),
                           count_nodes(height, L1L2_WARP_MESH_CELL_PX), NULL};
    mesh->node = l1l2_mem_new((size_t)mesh->columns * (size_t)mesh->rows, sizeof *mesh->node);
    return mesh->node != NULL;
}

void l1l2_warp_mesh_clear(L1L2WarpMesh *mesh)
{
    l1l2_mem_free(mesh->node);
    *mesh = (L1L2WarpMesh){0};
}

void l1l2_warp_mesh_set(L1L2WarpMesh *mesh, const L1L2Mat *map)
{
    const bool affine = l1l2_mat_is_affine(map);
    for (int row = 0; row < mesh->rows; row++)
        for (int column = 0; column < mesh->columns; column++) {
            const L1L2Point at = l1l2_warp_mesh_position(mesh, column, row);
            mesh->node[row * mesh->columns + column] =
                affine ? l1l2_mat_apply_affine(map, at) : l1l2_mat_apply(map, at);
        }
}
