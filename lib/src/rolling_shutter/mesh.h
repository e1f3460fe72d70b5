/* SPDX-License-Identifier: MIT */
/*
 * Algorithm 1, step 4, in the picture: B_t and a frame's rolling-shutter residual as one mesh of source positions, none
 * of which is outside the source frame, unless they may be.
 *
 * Where the residual would reach across a side of the source, the outer eighth of the picture along that side is
 * compressed until it ends on the side. G2011 has no such step; fading the residual until it fits would give up the
 * correction of the whole picture. Convention: the mesh is in pixels from the frame's center, the residual as in
 * model.h.
 */
#ifndef L1L2_ROLLING_SHUTTER_MESH_H
#define L1L2_ROLLING_SHUTTER_MESH_H

#include "rolling_shutter/model.h"
#include "warp/mesh.h"

/* The source frames. */
typedef struct L1L2ShutterSource {
    int width, height;   /* pixels */
    double pixel_aspect; /* a pixel's width by its height as it is shown, > 0 */
    bool may_leave;      /* positions may be outside the source: they are not compressed */
} L1L2ShutterSource;

/* Sets the nodes of a mesh that was initialized for the output frame's size. map: output pixel -> source pixel without
 * the residual. residual: e_t of the frame. Returns the longest distance by which the residual moved a node before the
 * compression, in pixels of the frame's height. Returns a negative number if a node would not be finite: then the nodes
 * are undefined, and `map` has to be used. */
double l1l2_shutter_mesh_set(L1L2WarpMesh *mesh, const L1L2Mat *map, const L1L2ShutterModel *model,
                             const L1L2ShutterResidual *residual, const L1L2ShutterSource *source);

#endif
