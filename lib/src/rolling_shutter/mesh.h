/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 4, in the picture: B_t and a frame's residual as one mesh of source positions, none of which is
 * outside the source frame.
 *
 * Where the residual would reach across a side of the source, the outer eighth of the picture along that side is
 * compressed until it ends on the side. So nothing jumps, for it is as smooth in time as B_t and the residual are, and
 * the rest of the picture keeps all of its correction; fading the residual would give it up all over the frame.
 */
#ifndef L1L2_ROLLING_SHUTTER_MESH_H
#define L1L2_ROLLING_SHUTTER_MESH_H

#include "rolling_shutter/model.h"
#include "warp/mesh.h"

/* map: output pixel -> source pixel without the residual. width, height: of the source, pixels. Returns the longest
 * way that a node was moved by the residual, pixels; negative where there is no finite mesh: use `map`. */
double l1l2_shutter_mesh_set(L1L2WarpMesh *mesh, const L1L2Mat *map, const L1L2ShutterModel *shape,
                            const L1L2ShutterResidual *residual, int width, int height);

#endif
