/* SPDX-License-Identifier: MIT */
/* The grids of planes, the cells of runs, and the generators of positions in plain C. */
#include "warp/coords.h"

#include "warp/coords_impl.h"

L1L2WarpGrid l1l2_warp_grid(const L1L2FormatInfo *format, int plane, L1L2StabChromaSite site, int width, int height)
{
    const int sub_x = 1 << format->plane[plane].log2_sub_x;
    const int sub_y = 1 << format->plane[plane].log2_sub_y;
    return (L1L2WarpGrid){
        .size_x = width,
        .size_y = height,
        .first_x = site == L1L2STAB_CHROMA_SITE_CENTER ? 0.5 * sub_x : 0.5,
        .first_y = site == L1L2STAB_CHROMA_SITE_TOP_LEFT ? 0.5 : 0.5 * sub_y,
        .step_x = sub_x,
        .step_y = sub_y,
    };
}

/* A sample to its frame position, to coordinates around the center, through the map, and back. This is the map between
 * two other bases, but not a product of matrices: evaluated in this order, with offsets that are multiples of 1/2, the
 * identity and whole steps come out exact. */
L1L2WarpAffine l1l2_warp_affine(const L1L2Mat *map, const L1L2WarpGrid *dst, const L1L2WarpGrid *src)
{
    const double *m = map->m;
    const double u = dst->first_x - dst->size_x / 2.0;
    const double v = dst->first_y - dst->size_y / 2.0;
    const double x = m[0] * u + m[1] * v + m[2] + src->size_x / 2.0 - src->first_x;
    const double y = m[3] * u + m[4] * v + m[5] + src->size_y / 2.0 - src->first_y;
    return (L1L2WarpAffine){
        .x = {m[0] * dst->step_x / src->step_x, m[1] * dst->step_y / src->step_x, x / src->step_x},
        .y = {m[3] * dst->step_x / src->step_y, m[4] * dst->step_y / src->step_y, y / src->step_y},
    };
}

L1L2WarpCells l1l2_warp_mesh_cells(const L1L2WarpMeshPlane *plane, int u, int count)
{
    const int last = plane->mesh->columns - 2;
    const double width = plane->dst.size_x / (plane->mesh->columns - 1) / plane->dst.step_x; /* samples */
    const double origin = plane->dst.first_x / plane->dst.step_x; /* from the frame's left border to sample 0 */
    const int guess = (int)((origin + u) / width);
    L1L2WarpCells cells = {.column = guess < last ? guess : last, .slope = 1.0 / width};
    cells.column -= cells.column > 0 && width * cells.column - origin > u;
    for (int k = 0; cells.count == k; k++) {
        const double border = width * (cells.column + k) - origin;
        const int first = (int)border + ((int)border < border); /* rounded up, and not by ceil(): it is a call */
        cells.offset[k] = first - border;
        cells.from[k] = k == 0 ? 0 : first - u;
        if (k == 0)
            cells.skipped = u - first;
        cells.count += cells.from[k] < count && cells.column + k <= last;
    }
    cells.from[cells.count] = count;
    return cells;
}

L1L2_INLINE void run_fixed(uint64_t at, uint64_t step, int count, int32_t *out)
{
    for (int i = 0; i < count; i++, at += step)
        out[i] = (int32_t)(uint32_t)(at >> POSITION_SHIFT);
}

DEFINE_GENERATORS(l1l2_warp_coords_init)
