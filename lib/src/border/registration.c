/* SPDX-License-Identifier: MIT */
#include "border/registration.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/mem.h"

enum {
    LEVELS = 2,          /* the picture, and half its size */
    PATCH = 10,          /* a patch reaches this far from its node, pixels of its level */
    PIXELS = (2 * PATCH + 1) * (2 * PATCH + 1),
    ITERATIONS = 5,
    REACH = 8            /* a displacement is at most so many pixels of its level */
};

static const double prior = 20.0;         /* squared levels: as the slopes of a nearly flat patch */
static const double settled_px = 0.05;
static const double agrees = 0.6, disagrees = 0.9; /* what is left of a patch's contrast: is trusted, is not shown */
static const double noise_levels = 3.0;

typedef struct Node {
    bool known;
    double xx, xy, yy;   /* H_n */
    L1L2Point shift;     /* u_n */
    double left;         /* of the patch's contrast, after it was registered */
} Node;

/* One level of the two pictures. */
typedef struct Level {
    int width, height;
    const float *own, *neighbor;
} Level;

struct L1L2BorderRegistration {
    int width, height, columns, rows;
    Node *node;
};

int l1l2_border_nodes(int size)
{
    const int nodes = (size + L1L2_BORDER_NODE_PX / 2) / L1L2_BORDER_NODE_PX + 1;
    return nodes < 2 ? 2 : nodes;
}

static int halved(int size)
{
    return (size + 1) / 2;
}

L1L2BorderRegistration *l1l2_border_registration_new(int width, int height)
{
    L1L2BorderRegistration *r = l1l2_mem_new(1, sizeof *r);
    if (!r)
        return NULL;
    r->width = width;
    r->height = height;
    r->columns = l1l2_border_nodes(width);
    r->rows = l1l2_border_nodes(height);
    r->node = l1l2_mem_new((size_t)r->columns * (size_t)r->rows, sizeof *r->node);
    if (r->node)
        return r;
    l1l2_border_registration_free(r);
    return NULL;
}

void l1l2_border_registration_free(L1L2BorderRegistration *r)
{
    if (!r)
        return;
    l1l2_mem_free(r->node);
    l1l2_mem_free(r);
}

/* Bilinear, with the edge repeated within half a pixel; < 0 outside. */
static inline float gray_at(const L1L2BorderGray *gray, int width, int height, float x, float y)
{
    if (!(x >= -0.5f && y >= -0.5f && x <= (float)width - 0.5f && y <= (float)height - 0.5f))
        return -1.0f;
    x = x < 0.0f ? 0.0f : x;
    y = y < 0.0f ? 0.0f : y;
    const int left = x >= (float)(width - 1) ? width - 2 : (int)x, top = y >= (float)(height - 1) ? height - 2 : (int)y;
    const float over_x = x - (float)left, over_y = y - (float)top;
    const float fx = over_x > 1.0f ? 1.0f : over_x, fy = over_y > 1.0f ? 1.0f : over_y;
    const uint8_t *p = gray->level + top * width + left;
    const float above = p[0] + fx * (float)(p[1] - p[0]), below = p[width] + fx * (float)(p[width + 1] - p[width]);
    return above + fy * (below - above);
}

typedef struct MeshRow {
    L1L2Point from, step; /* position at a cell's left side, and per mesh column */
} MeshRow;

static MeshRow mesh_cell(const L1L2WarpMesh *mesh, int column, double row)
{
    const int above = row >= mesh->rows - 1 ? mesh->rows - 2 : row < 0.0 ? 0 : (int)row;
    const double part = row - above;
    const L1L2Point *a = mesh->node + above * mesh->columns + column, *b = a + mesh->columns;
    const L1L2Point left = {a[0].x + part * (b[0].x - a[0].x), a[0].y + part * (b[0].y - a[0].y)};
    const L1L2Point right = {a[1].x + part * (b[1].x - a[1].x), a[1].y + part * (b[1].y - a[1].y)};
    return (MeshRow){left, {right.x - left.x, right.y - left.y}};
}

static void view_row(const L1L2BorderView *view, const L1L2BorderGray *gray, const L1L2WarpMesh *mesh, int j, int first,
                     int end)
{
    const double to_x = (double)view->width / mesh->width, to_y = (double)view->height / mesh->height;
    const double row = (j + 0.5) / view->height * (mesh->rows - 1);
    const double columns = (double)(mesh->columns - 1) / view->width;
    int cell = -1;
    float from_x = 0.0f, from_y = 0.0f, step_x = 0.0f, step_y = 0.0f;
    for (int i = first; i < end; i++) {
        const float at = (float)((i + 0.5) * columns);
        if ((int)at != cell) {
            cell = (int)at < mesh->columns - 1 ? (int)at : mesh->columns - 2;
            const MeshRow run = mesh_cell(mesh, cell, row);
            from_x = (float)(run.from.x * to_x + 0.5 * view->width - 0.5), step_x = (float)(run.step.x * to_x);
            from_y = (float)(run.from.y * to_y + 0.5 * view->height - 0.5), step_y = (float)(run.step.y * to_y);
        }
        const float part = at - (float)cell;
        view->level[j * view->width + i] = gray_at(gray, view->width, view->height, from_x + part * step_x,
                                                   from_y + part * step_y);
    }
}

bool l1l2_border_view_init(L1L2BorderView *view, int width, int height)
{
    *view = (L1L2BorderView){
        .width = width,
        .height = height,
        .level = l1l2_mem_new((size_t)width * (size_t)height, sizeof(float)),
        .half = l1l2_mem_new((size_t)halved(width) * (size_t)halved(height), sizeof(float)),
    };
    return view->level && view->half;
}

void l1l2_border_view_clear(L1L2BorderView *view)
{
    l1l2_mem_free(view->level);
    l1l2_mem_free(view->half);
    *view = (L1L2BorderView){0};
}

/* Halves the rows of a rectangle of the picture. */
static void halve(const L1L2BorderView *view, const L1L2WarpRect *rect)
{
    const int width = view->width, half_width = halved(width);
    for (int j = rect->top / 2; j < halved(rect->bottom); j++)
        for (int i = rect->left / 2; i < halved(rect->right); i++) {
            const int right = 2 * i + 1 < width ? 1 : 0, below = 2 * j + 1 < view->height ? width : 0;
            const float *p = view->level + 2 * j * width + 2 * i;
            const bool known = p[0] >= 0.0f && p[right] >= 0.0f && p[below] >= 0.0f && p[below + right] >= 0.0f;
            view->half[j * half_width + i] =
                known ? 0.25f * (p[0] + p[right] + p[below] + p[below + right]) : -1.0f;
        }
}

void l1l2_border_view_halve(const L1L2BorderView *view, const L1L2BorderBand *band)
{
    for (int i = 0; i < halved(view->width) * halved(view->height); i++)
        view->half[i] = -1.0f;
    for (int k = 0; k < band->count; k++)
        halve(view, &band->rect[k]);
}

void l1l2_border_view(const L1L2BorderView *view, const L1L2BorderGray *gray, const L1L2WarpMesh *mesh,
                      const L1L2BorderBand *band)
{
    for (int i = 0; i < view->width * view->height; i++)
        view->level[i] = -1.0f;
    for (int k = 0; k < band->count; k++)
        for (int j = band->rect[k].top; j < band->rect[k].bottom; j++)
            view_row(view, gray, mesh, j, band->rect[k].left, band->rect[k].right);
    l1l2_border_view_halve(view, band);
}

/* One patch of the own picture: its levels and slopes, row by row. */
typedef struct Patch {
    int count;
    float level[PIXELS];
    float slope_x[PIXELS];
    float slope_y[PIXELS];
    int16_t x[PIXELS], y[PIXELS];
    double contrast; /* mean distance from the mean level */
} Patch;

/* Takes every second pixel, as on a chessboard: all of them give the same displacements in twice the time. */
static void take_patch(const Level *level, double center_x, double center_y, Patch *patch)
{
    const int cx = (int)lround(center_x), cy = (int)lround(center_y), width = level->width;
    patch->count = 0;
    double sum = 0.0;
    for (int y = cy - PATCH; y <= cy + PATCH; y++)
        for (int x = cx - PATCH; x <= cx + PATCH; x++) {
            if (((x + y) & 1) || x < 1 || y < 1 || x > width - 2 || y > level->height - 2)
                continue;
            const float *p = level->own + y * width + x;
            if (p[0] < 0.0f || p[-1] < 0.0f || p[1] < 0.0f || p[-width] < 0.0f || p[width] < 0.0f)
                continue;
            const int n = patch->count++;
            patch->level[n] = p[0];
            patch->slope_x[n] = 0.5f * (p[1] - p[-1]);
            patch->slope_y[n] = 0.5f * (p[width] - p[-width]);
            patch->x[n] = (int16_t)x;
            patch->y[n] = (int16_t)y;
            sum += p[0];
        }
    const double mean = patch->count ? sum / patch->count : 0.0;
    patch->contrast = 0.0;
    for (int n = 0; n < patch->count; n++)
        patch->contrast += fabs(patch->level[n] - mean);
    patch->contrast /= patch->count ? patch->count : 1;
}

/* The differences N(x + u) - O(x) without their mean. All pixels of a patch are displaced alike, so they share the
 * weights of their bilinear samples. A pixel that N does not show has no difference: `seen` says which ones have.
 * Returns how many there are; *left: their mean size. */
static int differences(const Level *level, const Patch *patch, L1L2Point shift, float *e, bool *seen, double *left)
{
    const int width = level->width, dx = (int)floor(shift.x), dy = (int)floor(shift.y);
    const float fx = (float)(shift.x - dx), fy = (float)(shift.y - dy);
    int count = 0;
    double sum = 0.0, size = 0.0;
    for (int n = 0; n < patch->count; n++) {
        const int x = patch->x[n] + dx, y = patch->y[n] + dy;
        seen[n] = x >= 0 && y >= 0 && x < width - 1 && y < level->height - 1;
        if (!seen[n])
            continue;
        const float *p = level->neighbor + y * width + x;
        seen[n] = p[0] >= 0.0f && p[1] >= 0.0f && p[width] >= 0.0f && p[width + 1] >= 0.0f;
        const float above = p[0] + fx * (p[1] - p[0]), below = p[width] + fx * (p[width + 1] - p[width]);
        e[n] = above + fy * (below - above) - patch->level[n];
        if (!seen[n])
            continue;
        sum += e[n];
        count++;
    }
    const float mean = count ? (float)(sum / count) : 0.0f;
    for (int n = 0; n < patch->count; n++)
        if (seen[n]) {
            e[n] -= mean;
            size += e[n] < 0.0f ? -e[n] : e[n];
        }
    *left = count ? size / count : 0.0;
    return count;
}

/* One step of Gauss-Newton with weights 1 / (1 + (e / s)^2), s half more than the mean difference. False: the patch has
 * no slopes. */
static bool step(const Patch *patch, const float *e, const bool *seen, double left, Node *node, L1L2Point *by)
{
    const float scale = 1.0f / (float)fmax(1.5 * left, 1.0);
    float xx = 0.0f, xy = 0.0f, yy = 0.0f, bx = 0.0f, by_ = 0.0f;
    for (int n = 0; n < patch->count; n++) {
        if (!seen[n])
            continue;
        const float z = e[n] * scale, w = 1.0f / (1.0f + z * z), gx = w * patch->slope_x[n], gy = w * patch->slope_y[n];
        xx += gx * patch->slope_x[n];
        xy += gx * patch->slope_y[n];
        yy += gy * patch->slope_y[n];
        bx += gx * e[n];
        by_ += gy * e[n];
    }
    node->xx = xx, node->xy = xy, node->yy = yy;
    const double a = xx + prior, c = yy + prior, det = a * c - node->xy * node->xy;
    *by = (L1L2Point){-(c * bx - node->xy * by_) / det, -(a * by_ - node->xy * bx) / det};
    return det > 0.0;
}

/* Registers the patch around a node, from node->shift on. */
static void register_patch(const Level *level, double x, double y, Node *node)
{
    Patch patch;
    float e[PIXELS];
    bool seen[PIXELS];
    const L1L2Point start = node->shift;
    L1L2Point by;
    double left, left_at_start;
    node->known = false;
    take_patch(level, x, y, &patch);
    const int enough = PIXELS / 8;
    if (patch.count < enough || differences(level, &patch, start, e, seen, &left_at_start) < enough)
        return;
    left = left_at_start;
    for (int i = 0; i < ITERATIONS; i++) {
        if (!step(&patch, e, seen, left, node, &by))
            return;
        node->shift.x += by.x;
        node->shift.y += by.y;
        if (fabs(node->shift.x - start.x) > REACH || fabs(node->shift.y - start.y) > REACH)
            break;
        if (differences(level, &patch, node->shift, e, seen, &left) < enough)
            break;
        if (hypot(by.x, by.y) < settled_px)
            break;
    }
    if (!(left < left_at_start) || fabs(node->shift.x - start.x) > REACH || fabs(node->shift.y - start.y) > REACH) {
        node->shift = start;
        differences(level, &patch, start, e, seen, &left);
    }
    node->left = left / (patch.contrast + noise_levels);
    /* What does not match after all says little. */
    const double trust = fmax(1.0 - node->left, 0.05);
    node->xx *= trust * trust;
    node->xy *= trust * trust;
    node->yy *= trust * trust;
    node->known = true;
}

static double node_position(int index, int nodes, int size)
{
    return (double)index / (nodes - 1) * size - 0.5;
}

static bool in_band(const L1L2BorderBand *band, double x, double y)
{
    for (int k = 0; k < band->count; k++)
        if (x >= band->rect[k].left - 1 && x <= band->rect[k].right && y >= band->rect[k].top - 1 &&
            y <= band->rect[k].bottom)
            return true;
    return false;
}

static void register_nodes(L1L2BorderRegistration *r, const Level *level, const L1L2BorderBand *band)
{
    const double scale = (double)level->width / r->width;
    for (int row = 0; row < r->rows; row++)
        for (int column = 0; column < r->columns; column++) {
            Node *node = &r->node[row * r->columns + column];
            const double x = node_position(column, r->columns, r->width);
            const double y = node_position(row, r->rows, r->height);
            node->known = false;
            if (!in_band(band, x, y))
                continue;
            node->shift = (L1L2Point){node->shift.x * scale, node->shift.y * scale};
            register_patch(level, (x + 0.5) * scale - 0.5, (y + 0.5) * scale - 0.5, node);
            node->shift = (L1L2Point){node->shift.x / scale, node->shift.y / scale};
        }
}

/* The displacement at a node by all nodes around it. reach: nodes. */
static L1L2Point smoothed(const L1L2BorderRegistration *r, int column, int row, int reach, float *agreement)
{
    double xx = 0.0, xy = 0.0, yy = 0.0, bx = 0.0, by = 0.0, left = 0.0, sum = 0.0;
    for (int v = row - reach < 0 ? 0 : row - reach; v <= row + reach && v < r->rows; v++)
        for (int u = column - reach < 0 ? 0 : column - reach; u <= column + reach && u < r->columns; u++) {
            const Node *node = &r->node[v * r->columns + u];
            if (!node->known)
                continue;
            const double w = l1l2_border_nearness(u - column, v - row);
            xx += w * (node->xx + prior);
            xy += w * node->xy;
            yy += w * (node->yy + prior);
            bx += w * (node->xx * node->shift.x + node->xy * node->shift.y);
            by += w * (node->xy * node->shift.x + node->yy * node->shift.y);
            left += w * node->left;
            sum += w;
        }
    const double det = xx * yy - xy * xy;
    const double share = sum > 0.0 ? left / sum : 1.0;
    *agreement = (float)fmin(fmax((disagrees - share) / (disagrees - agrees), 0.0), 1.0);
    if (!(sum > 0.0))
        return (L1L2Point){0.0, 0.0};
    return (L1L2Point){(yy * bx - xy * by) / det, (xx * by - xy * bx) / det};
}

static void smooth(const L1L2BorderRegistration *r, const L1L2BorderBand *band, int reach, L1L2BorderField *field)
{
    for (int row = 0; row < r->rows; row++)
        for (int column = 0; column < r->columns; column++) {
            const int i = row * r->columns + column;
            if (in_band(band, node_position(column, r->columns, r->width), node_position(row, r->rows, r->height)))
                field->shift[i] = smoothed(r, column, row, reach, &field->agreement[i]);
        }
}

void l1l2_border_register(L1L2BorderRegistration *r, const L1L2BorderView *own, const L1L2BorderView *neighbor,
                          const L1L2BorderBand *band, L1L2BorderField *field)
{
    const int count = r->columns * r->rows;
    memset(r->node, 0, (size_t)count * sizeof *r->node);
    memset(field->shift, 0, (size_t)count * sizeof *field->shift);
    memset(field->agreement, 0, (size_t)count * sizeof *field->agreement);
    const Level level[LEVELS] = {
        {r->width, r->height, own->level, neighbor->level},
        {halved(r->width), halved(r->height), own->half, neighbor->half},
    };
    for (int k = LEVELS - 1; k >= 0; k--) {
        register_nodes(r, &level[k], band);
        smooth(r, band, k > 0 ? 2 : 5, field);
        for (int i = 0; i < count; i++)
            r->node[i].shift = field->shift[i];
    }
}
