/* SPDX-License-Identifier: MIT */
#include "border/registration.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/mem.h"

enum {
    LEVELS = 2,          /* the picture, and half its size */
    PATCH = 10,          /* a patch reaches this far from its node, pixels of its level */
    SIDE = 2 * PATCH + 1,
    LANES = 24,          /* of a row of a patch: its pixels, and some that are never known, for the vectors' sake */
    ROWS = PATCH + 1,    /* every second row is taken: all of them give the same displacements in twice the time */
    ENOUGH = ROWS * SIDE / 4,
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

/* Bilinear, at a position with all four pixels around it. */
static inline float level_at(const uint8_t *level, int width, float x, float y)
{
    const int left = (int)x, top = (int)y;
    const float fx = x - (float)left, fy = y - (float)top;
    const uint8_t *p = level + top * width + left;
    const float above = p[0] + fx * (float)(p[1] - p[0]), below = p[width] + fx * (float)(p[width + 1] - p[width]);
    return above + fy * (below - above);
}

/* Bilinear, with the edge repeated within half a pixel; < 0 outside. */
static inline float gray_at(const L1L2BorderGray *gray, int width, int height, float x, float y)
{
    if (!(x >= -0.5f && y >= -0.5f && x <= (float)width - 0.5f && y <= (float)height - 0.5f))
        return -1.0f;
    /* Short of the last pixel by less than a float can tell from it at 480 pixels, so that there is one after it. */
    const float right = (float)(width - 1) * (1.0f - 1e-6f), bottom = (float)(height - 1) * (1.0f - 1e-6f);
    x = x < 0.0f ? 0.0f : x > right ? right : x;
    y = y < 0.0f ? 0.0f : y > bottom ? bottom : y;
    return level_at(gray->level, width, x, y);
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

/* A straight piece of a row of a view: pixel i is at from + ((i + 0.5) columns - cell) step of the gray picture. */
typedef struct Piece {
    int first, end, cell;
    double columns;
    float from_x, from_y, step_x, step_y;
} Piece;

static bool is_well_inside(const Piece *piece, int i, int width, int height)
{
    const float part = (float)((i + 0.5) * piece->columns) - (float)piece->cell;
    const float x = piece->from_x + part * piece->step_x, y = piece->from_y + part * piece->step_y;
    return x >= 0.0f && y >= 0.0f && x < (float)(width - 1) && y < (float)(height - 1);
}

static void view_piece(const L1L2BorderView *view, const L1L2BorderGray *gray, const Piece *piece, float *row)
{
    const int width = view->width, height = view->height;
    const bool inside = is_well_inside(piece, piece->first, width, height) &&
                        is_well_inside(piece, piece->end - 1, width, height);
    for (int i = piece->first; i < piece->end; i++) {
        const float part = (float)((i + 0.5) * piece->columns) - (float)piece->cell;
        const float x = piece->from_x + part * piece->step_x, y = piece->from_y + part * piece->step_y;
        row[i] = inside ? level_at(gray->level, width, x, y) : gray_at(gray, width, height, x, y);
    }
}

static void view_row(const L1L2BorderView *view, const L1L2BorderGray *gray, const L1L2WarpMesh *mesh, int j, int first,
                     int end)
{
    const double to_x = (double)view->width / mesh->width, to_y = (double)view->height / mesh->height;
    const double row = (j + 0.5) / view->height * (mesh->rows - 1);
    Piece piece = {.columns = (double)(mesh->columns - 1) / view->width};
    for (piece.first = first; piece.first < end; piece.first = piece.end) {
        const int at = (int)((piece.first + 0.5) * piece.columns);
        piece.cell = at < mesh->columns - 1 ? at : mesh->columns - 2;
        const int beyond = (int)ceil((piece.cell + 1) / piece.columns - 0.5);
        piece.end = beyond <= piece.first ? piece.first + 1 : beyond < end ? beyond : end;
        const MeshRow run = mesh_cell(mesh, piece.cell, row);
        piece.from_x = (float)(run.from.x * to_x + 0.5 * view->width - 0.5);
        piece.from_y = (float)(run.from.y * to_y + 0.5 * view->height - 0.5);
        piece.step_x = (float)(run.step.x * to_x);
        piece.step_y = (float)(run.step.y * to_y);
        view_piece(view, gray, &piece, view->level + j * view->width);
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

/* One patch of the own picture. Pixels of which something is not known have known = 0, others 1. */
typedef struct Patch {
    int left, top;       /* of its pixels, in the level */
    int count;           /* known ones */
    float known[ROWS][LANES], level[ROWS][LANES], slope_x[ROWS][LANES], slope_y[ROWS][LANES];
    double contrast;     /* mean distance from the mean level */
} Patch;

/* What the neighbor shows at a patch's pixels, compared with it. */
typedef struct Differences {
    int count;           /* pixels that both show */
    float seen[ROWS][LANES]; /* 1 for those, 0 for others */
    float e[ROWS][LANES];    /* N(x + u) - O(x) without their mean; 0 where not seen */
    double left;         /* the mean size of e */
} Differences;

static float sum_of(const float *lane)
{
    float sum = 0.0f;
    for (int i = 0; i < LANES; i++)
        sum += lane[i];
    return sum;
}

enum { BLOCK_COLUMNS = LANES + 2, BLOCK_ROWS = SIDE + 2 };

/* A part of a picture that can reach beyond it, where nothing is known. */
typedef struct Block {
    const float *at;     /* its first pixel */
    ptrdiff_t stride;
    float copy[BLOCK_ROWS * BLOCK_COLUMNS];
} Block;

static void take_block(const Level *level, const float *picture, int left, int top, Block *block)
{
    const int width = level->width, height = level->height;
    if (left >= 0 && top >= 0 && left + BLOCK_COLUMNS <= width && top + BLOCK_ROWS <= height) {
        block->at = picture + (ptrdiff_t)top * width + left;
        block->stride = width;
        return;
    }
    for (int y = 0; y < BLOCK_ROWS; y++)
        for (int x = 0; x < BLOCK_COLUMNS; x++) {
            const bool inside = left + x >= 0 && left + x < width && top + y >= 0 && top + y < height;
            block->copy[y * BLOCK_COLUMNS + x] = inside ? picture[(ptrdiff_t)(top + y) * width + left + x] : -1.0f;
        }
    block->at = block->copy;
    block->stride = BLOCK_COLUMNS;
}

static void take_patch(const Level *level, double center_x, double center_y, Patch *patch)
{
    Block block;
    float count[LANES] = {0}, sum[LANES] = {0}, contrast[LANES] = {0};
    patch->left = (int)lround(center_x) - PATCH;
    patch->top = (int)lround(center_y) - PATCH;
    take_block(level, level->own, patch->left - 1, patch->top - 1, &block);
    for (int row = 0; row < ROWS; row++) {
        const float *p = block.at + (2 * row + 1) * block.stride + 1;
        const float *above = p - block.stride, *below = p + block.stride;
        for (int i = 0; i < LANES; i++) {
            const int all = (p[i] >= 0.0f) & (p[i - 1] >= 0.0f) & (p[i + 1] >= 0.0f) & (above[i] >= 0.0f) &
                            (below[i] >= 0.0f) & (i < SIDE);
            const float known = all ? 1.0f : 0.0f;
            patch->known[row][i] = known;
            patch->level[row][i] = p[i];
            patch->slope_x[row][i] = 0.5f * (p[i + 1] - p[i - 1]);
            patch->slope_y[row][i] = 0.5f * (below[i] - above[i]);
            count[i] += known;
            sum[i] += known * p[i];
        }
    }
    patch->count = (int)sum_of(count);
    const float mean = patch->count ? sum_of(sum) / (float)patch->count : 0.0f;
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < LANES; i++)
            contrast[i] += patch->known[row][i] * fabsf(patch->level[row][i] - mean);
    patch->contrast = (double)sum_of(contrast) / (patch->count ? patch->count : 1);
}

/* The differences at a displacement. All pixels of a patch are displaced alike, so they share the weights of their
 * bilinear samples. False: too few pixels are seen. */
static bool compare(const Level *level, const Patch *patch, L1L2Point shift, Differences *found)
{
    const int dx = (int)floor(shift.x), dy = (int)floor(shift.y);
    const float fx = (float)(shift.x - dx), fy = (float)(shift.y - dy);
    Block block;
    float count[LANES] = {0}, sum[LANES] = {0}, size[LANES] = {0};
    take_block(level, level->neighbor, patch->left + dx, patch->top + dy, &block);
    for (int row = 0; row < ROWS; row++) {
        const float *p = block.at + 2 * row * block.stride, *q = p + block.stride;
        for (int i = 0; i < LANES; i++) {
            const int all = (p[i] >= 0.0f) & (p[i + 1] >= 0.0f) & (q[i] >= 0.0f) & (q[i + 1] >= 0.0f);
            const float both = all ? 1.0f : 0.0f;
            const float above = p[i] + fx * (p[i + 1] - p[i]), below = q[i] + fx * (q[i + 1] - q[i]);
            const float seen = both * patch->known[row][i];
            const float e = seen * (above + fy * (below - above) - patch->level[row][i]);
            found->seen[row][i] = seen;
            found->e[row][i] = e;
            count[i] += seen;
            sum[i] += e;
        }
    }
    found->count = (int)sum_of(count);
    const float mean = found->count ? sum_of(sum) / (float)found->count : 0.0f;
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < LANES; i++) {
            found->e[row][i] -= found->seen[row][i] * mean;
            size[i] += fabsf(found->e[row][i]);
        }
    found->left = found->count ? (double)sum_of(size) / found->count : 0.0;
    return found->count >= ENOUGH;
}

/* One step of Gauss-Newton with weights 1 / (1 + (e / s)^2), s half more than the mean difference. False: the patch has
 * no slopes. */
static bool step(const Patch *patch, const Differences *found, Node *node, L1L2Point *by)
{
    const float scale = 1.0f / (float)fmax(1.5 * found->left, 1.0);
    float xx[LANES] = {0}, xy[LANES] = {0}, yy[LANES] = {0}, xe[LANES] = {0}, ye[LANES] = {0};
    for (int row = 0; row < ROWS; row++)
        for (int i = 0; i < LANES; i++) {
            const float e = found->e[row][i], z = e * scale, w = found->seen[row][i] / (1.0f + z * z);
            const float slope_x = patch->slope_x[row][i], slope_y = patch->slope_y[row][i];
            const float gx = w * slope_x, gy = w * slope_y;
            xx[i] += gx * slope_x;
            xy[i] += gx * slope_y;
            yy[i] += gy * slope_y;
            xe[i] += gx * e;
            ye[i] += gy * e;
        }
    node->xx = sum_of(xx), node->xy = sum_of(xy), node->yy = sum_of(yy);
    const double a = node->xx + prior, c = node->yy + prior, det = a * c - node->xy * node->xy;
    const double bx = sum_of(xe), by_ = sum_of(ye);
    *by = (L1L2Point){-(c * bx - node->xy * by_) / det, -(a * by_ - node->xy * bx) / det};
    return det > 0.0;
}

static bool is_beyond_reach(L1L2Point shift, L1L2Point start)
{
    return fabs(shift.x - start.x) > REACH || fabs(shift.y - start.y) > REACH;
}

/* Registers the patch around a node, from node->shift on. */
static void register_patch(const Level *level, double x, double y, Node *node)
{
    Patch patch;
    Differences found;
    const L1L2Point start = node->shift;
    L1L2Point by;
    node->known = false;
    take_patch(level, x, y, &patch);
    if (patch.count < ENOUGH || !compare(level, &patch, start, &found))
        return;
    const double left_at_start = found.left;
    for (int i = 0; i < ITERATIONS; i++) {
        if (!step(&patch, &found, node, &by))
            return;
        node->shift.x += by.x;
        node->shift.y += by.y;
        if (is_beyond_reach(node->shift, start) || !compare(level, &patch, node->shift, &found) ||
            hypot(by.x, by.y) < settled_px)
            break;
    }
    if (!(found.left < left_at_start) || is_beyond_reach(node->shift, start)) {
        node->shift = start;
        compare(level, &patch, start, &found);
    }
    node->left = found.left / (patch.contrast + noise_levels);
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
