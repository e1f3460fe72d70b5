/* SPDX-License-Identifier: MIT */
/*
 * Where a neighbor's picture has to be taken from, so that it continues the frame that is filled.
 *
 * The chained motions say it up to some pixels: they drift, and they are the motion of one depth. What is left is
 * measured where both pictures are seen, in a band along the border, and carried outward. Both are compared in the
 * output's geometry. At each node of a grid of L1L2_BORDER_NODE_PX pixels, Lucas-Kanade finds the displacement u of a
 * patch (Lucas & Kanade, "An iterative image registration technique", 1981): the minimum of
 *
 *     sum_x r(x) (N(x + u) - O(x) - c)^2,
 *
 * where O is the frame's own picture, N the neighbor's, c the difference of the patches' brightness, and r a robust
 * weight. Near the minimum that is a quadratic form (u - u_n)' H_n (u - u_n), with H_n the sum of the products of O's
 * slopes. So each place takes the displacement that minimizes
 *
 *     sum_n w_n ((u - u_n)' H_n (u - u_n) + prior |u|^2),     w_n falls with the distance of node n.
 *
 * Along an edge, H_n says nothing, and other nodes decide. Beyond the border the same sum carries the displacement of
 * the nearest nodes outward.
 */
#ifndef L1L2_BORDER_REGISTRATION_H
#define L1L2_BORDER_REGISTRATION_H

#include "border/gray_pictures.h"
#include "border/neighbors.h"
#include "common/geom.h"
#include "warp/mesh.h"

/* From node to node, pixels of the gray picture. */
enum { L1L2_BORDER_NODE_PX = 16 };

/* A grid of nodes over the output: the first and last ones lie on its border. Unit: pixels of the gray picture. */
typedef struct L1L2BorderField {
    int columns, rows;
    L1L2Point *shift;   /* the neighbor is read this much farther right and down */
    float *agreement;   /* [0, 1]: 0 where the pictures beside the border do not show the same */
} L1L2BorderField;

/* A picture in the output's geometry, whose size is that of the gray pictures. */
typedef struct L1L2BorderView {
    int width, height;
    float *level; /* [height * width]; < 0: outside the source */
    float *half;  /* the same at half the size, rounded up */
} L1L2BorderView;

/* False when out of memory. */
bool l1l2_border_view_init(L1L2BorderView *view, int width, int height);

/* A zeroed view is allowed. */
void l1l2_border_view_clear(L1L2BorderView *view);

/* Memory for one registration. */
typedef struct L1L2BorderRegistration L1L2BorderRegistration;

/* For gray pictures of width x height. NULL when out of memory. */
L1L2BorderRegistration *l1l2_border_registration_new(int width, int height);
void l1l2_border_registration_free(L1L2BorderRegistration *registration);

/* The parts of the output that are looked at: rectangles, in pixels of the gray picture. They may overlap. */
typedef struct L1L2BorderBand {
    int count;
    L1L2WarpRect rect[L1L2_BORDER_STRIPS];
} L1L2BorderBand;

/* The weight w_n of a node that is so many columns and rows away. */
static inline double l1l2_border_nearness(int columns, int rows)
{
    const double farther = 1.0 + columns * columns + rows * rows;
    return 1.0 / (farther * farther);
}

/* How many nodes lie along a side of the gray picture. */
int l1l2_border_nodes(int size);

/* Renders a gray picture into the output's geometry: mesh takes output pixels to positions of the frame. Outside
 * the band nothing is known. */
void l1l2_border_view(const L1L2BorderView *view, const L1L2BorderGray *gray, const L1L2WarpMesh *mesh,
                      const L1L2BorderBand *band);

/* Makes a view's half from its levels, in the band. l1l2_border_view() does so, too. */
void l1l2_border_view_halve(const L1L2BorderView *view, const L1L2BorderBand *band);

/* Registers a neighbor in the band, which both views have to hold. Outside the band the field is undefined. The field's
 * arrays are the caller's. */
void l1l2_border_register(L1L2BorderRegistration *registration, const L1L2BorderView *own,
                          const L1L2BorderView *neighbor, const L1L2BorderBand *band, L1L2BorderField *field);

#endif
