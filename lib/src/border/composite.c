/* SPDX-License-Identifier: MIT */
#include "border/composite.h"

#include <math.h>
#include <string.h>

enum {
    RUN = L1L2_WARP_RUN_SAMPLES,
    BAND_ROWS = 16,
    OFFSET_STEP = 2,     /* of each second sample in each second row, offsets are measured */
    SOFTEST = 3          /* samples: the radius of the mean that the extension takes */
};

/* The band in which offsets are measured, in seams. */
static const double offset_band = 3.0;
/* The samples with no difference that are assumed around each node. */
static const double offset_prior = 1.0;
/* Larger differences, in parts of the range, are not of light but of things. */
static const double largest_offset = 0.12;
/* Sources that cover a sample by this weight are better than an extension. */
static const float least_weight = 0.1f;
/* Where sources agree with the frame by this weight, one that does not agree hardly shows. */
static const float doubt_weight = 0.1f;
/* The outermost pixel of a frame is often darker, or black. */
static const double rim_px = 1.0;

/* One plane of all layers. */
typedef struct Plane {
    const L1L2BorderComposite *composite;
    int index, components, bytes, shift, most; /* most: the largest level */
    int first_component;                        /* of all planes' components: the number of this plane's first */
    int width, height;                          /* samples */
    int log2_sub_x, log2_sub_y;
    L1L2WarpGrid grid;
    L1L2WarpAffine affine;
} Plane;

static Plane plane_of(const L1L2BorderComposite *c, int index)
{
    const L1L2FormatInfo *format = c->format;
    const L1L2WarpGrid grid = l1l2_warp_grid(format, index, c->chroma_site, c->width, c->height);
    Plane plane = {
        .composite = c,
        .index = index,
        .components = format->plane[index].components,
        .bytes = l1l2_image_format_bytes(format),
        .shift = format->shift,
        .most = (1 << format->depth) - 1,
        .width = l1l2_image_plane_size(c->width, format->plane[index].log2_sub_x),
        .height = l1l2_image_plane_size(c->height, format->plane[index].log2_sub_y),
        .log2_sub_x = format->plane[index].log2_sub_x,
        .log2_sub_y = format->plane[index].log2_sub_y,
        .grid = grid,
        .affine = l1l2_warp_affine(&c->own.affine, &grid, &grid),
    };
    for (int i = 0; i < index; i++)
        plane.first_component += format->plane[i].components;
    return plane;
}

static int read_component(const Plane *plane, const uint8_t *row, int u, int component)
{
    const uint8_t *p = row + (u * plane->components + component) * plane->bytes;
    return plane->bytes == 1 ? *p : (p[0] | p[1] << 8) >> plane->shift;
}

static void write_component(const Plane *plane, uint8_t *row, int u, int component, float value)
{
    uint8_t *p = row + (u * plane->components + component) * plane->bytes;
    const int level = (int)(value + 0.5f), cut = level < 0 ? 0 : level > plane->most ? plane->most : level;
    if (plane->bytes == 1) {
        *p = (uint8_t)cut;
        return;
    }
    const int stored = cut << plane->shift;
    p[0] = (uint8_t)stored;
    p[1] = (uint8_t)(stored >> 8);
}

/* Positions of a run in a layer's plane, in phases, and how deep inside the layer's frame they are, in pixels. */
typedef struct Positions {
    int32_t x[RUN + L1L2_WARP_RUN_SLACK], y[RUN + L1L2_WARP_RUN_SLACK];
    float depth[RUN];
} Positions;

static void find_positions(const Plane *plane, const L1L2WarpMesh *mesh, int u, int v, int count, Positions *at)
{
    const L1L2WarpGenerators *generators = &plane->composite->generators;
    if (mesh) {
        const L1L2WarpMeshPlane mesh_plane = {mesh, plane->grid, plane->grid};
        const L1L2WarpCells cells = l1l2_warp_mesh_cells(&mesh_plane, u, count);
        generators->mesh(&mesh_plane, &cells, v, at->x, at->y);
    } else {
        generators->affine(&plane->affine, u, v, count, at->x, at->y);
    }
    const float phase = 1.0f / L1L2_WARP_PHASES;
    const float to_x = (float)plane->grid.step_x * phase, to_y = (float)plane->grid.step_y * phase;
    const int32_t half = L1L2_WARP_PHASES / 2;
    const int32_t right = plane->width * L1L2_WARP_PHASES - half, bottom = plane->height * L1L2_WARP_PHASES - half;
    for (int i = 0; i < count; i++) {
        const int32_t x = at->x[i] + half < right - at->x[i] ? at->x[i] + half : right - at->x[i];
        const int32_t y = at->y[i] + half < bottom - at->y[i] ? at->y[i] + half : bottom - at->y[i];
        const float across = (float)x * to_x, down = (float)y * to_y;
        at->depth[i] = across < down ? across : down;
    }
}

static float weight_at(const Plane *plane, float depth)
{
    const float x = (depth - (float)rim_px) / (float)plane->composite->seam;
    return x <= 0.0f ? 0.0f : x >= 1.0f ? 1.0f : x * x * (3.0f - 2.0f * x);
}

/* The nearest node of the grid, or its fractional index. */
static double node_index(int sample, int samples, int nodes)
{
    return (sample + 0.5) / samples * (nodes - 1);
}

/* A row of the grid, interpolated to a row of samples. */
static void interpolate_row(const float *nodes, const L1L2BorderField *field, double at, float *row)
{
    const int above = at >= field->rows - 1 ? field->rows - 2 : (int)at;
    const float part = (float)(at - above), *a = nodes + above * field->columns, *b = a + field->columns;
    for (int i = 0; i < field->columns; i++)
        row[i] = a[i] + part * (b[i] - a[i]);
}

/* ---- Offsets ---- */

typedef struct OffsetJob {
    const L1L2BorderComposite *composite;
    Plane plane[L1L2_MAX_PLANES];
} OffsetJob;

typedef struct NodeSum {
    int64_t sum[L1L2_BORDER_COMPONENTS];
    int count;
} NodeSum;

enum { MAX_NODES = L1L2_BORDER_GRAY_SIDE / L1L2_BORDER_NODE_PX + 2 }; /* along an axis */

static void sum_run(const Plane *plane, const L1L2BorderSource *source, int u, int v, int count, NodeSum *sums)
{
    const L1L2BorderComposite *c = plane->composite;
    Positions own, other;
    const uint8_t *mine = c->dst[plane->index] + v * c->dst_stride[plane->index];
    const uint8_t *theirs = source->data[plane->index] + v * source->stride[plane->index];
    const int columns = source->field.columns, limit = (int)(largest_offset * plane->most);
    const int row = (int)(node_index(v, plane->height, source->field.rows) + 0.5);
    find_positions(plane, c->own.mesh, u, v, count, &own);
    find_positions(plane, source->mesh, u, v, count, &other);
    for (int i = 0; i < count; i += OFFSET_STEP) {
        if (own.depth[i] < rim_px || own.depth[i] > offset_band * c->seam || other.depth[i] < rim_px)
            continue;
        NodeSum *node = &sums[row * columns + (int)(node_index(u + i, plane->width, columns) + 0.5)];
        int difference[L1L2_BORDER_COMPONENTS], largest = 0;
        for (int k = 0; k < plane->components; k++) {
            difference[k] = read_component(plane, mine, u + i, k) - read_component(plane, theirs, u + i, k);
            const int size = difference[k] < 0 ? -difference[k] : difference[k];
            largest = size > largest ? size : largest;
        }
        if (largest > limit)
            continue;
        for (int k = 0; k < plane->components; k++)
            node->sum[k] += difference[k];
        node->count++;
    }
}

static void spread(const L1L2BorderField *field, const NodeSum *sums, int component, float *offset)
{
    const int reach = 4;
    for (int row = 0; row < field->rows; row++)
        for (int column = 0; column < field->columns; column++) {
            double sum = 0.0, count = offset_prior;
            for (int v = row - reach < 0 ? 0 : row - reach; v <= row + reach && v < field->rows; v++)
                for (int u = column - reach < 0 ? 0 : column - reach; u <= column + reach && u < field->columns; u++) {
                    const NodeSum *node = &sums[v * field->columns + u];
                    const double w = l1l2_border_nearness(u - column, v - row);
                    sum += w * (double)node->sum[component];
                    count += w * node->count;
                }
            offset[row * field->columns + column] = (float)(sum / count);
        }
}

/* index: of a source's plane. */
static void measure_offsets(void *context, int index)
{
    const OffsetJob *job = context;
    const L1L2BorderComposite *c = job->composite;
    const Plane *plane = &job->plane[index % c->format->planes];
    const L1L2BorderSource *source = &c->source[index / c->format->planes];
    const int nodes = source->field.columns * source->field.rows;
    NodeSum sums[MAX_NODES * MAX_NODES];
    memset(sums, 0, (size_t)nodes * sizeof *sums);
    for (int k = 0; k < L1L2_BORDER_STRIPS; k++) {
        const L1L2WarpRect strip = l1l2_warp_rect_samples(&source->part.rect[k], plane->log2_sub_x, plane->log2_sub_y);
        for (int v = strip.top; v < strip.bottom; v += OFFSET_STEP)
            for (int u = strip.left; u < strip.right; u += RUN)
                sum_run(plane, source, u, v, strip.right - u < RUN ? strip.right - u : RUN, sums);
    }
    for (int k = 0; k < plane->components; k++)
        spread(&source->field, sums, k, source->offset + (plane->first_component + k) * nodes);
}

/* ---- Painting ---- */

/* A row of samples, with what the grids say along it. */
typedef struct Row {
    const Plane *plane;
    int v, strip;
    int from[L1L2_BORDER_MAX_SOURCES], end[L1L2_BORDER_MAX_SOURCES]; /* of the run: where each source is rendered */
    float agreement[L1L2_BORDER_MAX_SOURCES][MAX_NODES];
    float offset[L1L2_BORDER_MAX_SOURCES][L1L2_BORDER_COMPONENTS][MAX_NODES];
} Row;

static void begin_row(Row *row, const Plane *plane, int v)
{
    const L1L2BorderComposite *c = plane->composite;
    row->plane = plane;
    row->v = v;
    for (int s = 0; s < c->sources; s++) {
        const L1L2BorderSource *source = &c->source[s];
        const int nodes = source->field.columns * source->field.rows;
        const double at = node_index(v, plane->height, source->field.rows);
        interpolate_row(source->field.agreement, &source->field, at, row->agreement[s]);
        for (int k = 0; k < plane->components; k++)
            interpolate_row(source->offset + (plane->first_component + k) * nodes, &source->field, at,
                            row->offset[s][k]);
    }
}

static int reflect(int index, int size)
{
    index = index < 0 ? -1 - index : index >= size ? 2 * size - 1 - index : index;
    return index < 0 ? 0 : index < size ? index : size - 1;
}

/* The mean of the mirrored frame around a position, in phases. depth: pixels, negative outside. */
static void extend(const Plane *plane, int32_t x, int32_t y, float depth, float *value)
{
    const L1L2BorderComposite *c = plane->composite;
    const int p = plane->index, cx = (x + L1L2_WARP_PHASES / 2) >> L1L2_WARP_PHASE_BITS;
    const int cy = (y + L1L2_WARP_PHASES / 2) >> L1L2_WARP_PHASE_BITS;
    const int wanted = (int)(-depth / 4.0f), radius = wanted < 0 ? 0 : wanted < SOFTEST ? wanted : SOFTEST;
    int64_t sum[L1L2_BORDER_COMPONENTS] = {0};
    for (int dy = -radius; dy <= radius; dy++) {
        const uint8_t *row = c->src[p] + reflect(cy + dy, plane->height) * c->src_stride[p];
        for (int dx = -radius; dx <= radius; dx++)
            for (int k = 0; k < plane->components; k++)
                sum[k] += read_component(plane, row, reflect(cx + dx, plane->width), k);
    }
    for (int k = 0; k < plane->components; k++)
        value[k] = (float)sum[k] / (float)((2 * radius + 1) * (2 * radius + 1));
}

static void note_provider(const Row *row, int u, int provider)
{
    const Plane *plane = row->plane;
    const L1L2BorderComposite *c = plane->composite;
    if (plane->index != 0)
        return;
    for (int x = u << plane->log2_sub_x; x < (u + 1) << plane->log2_sub_x && x < c->width; x++)
        c->provider[row->v * c->width + x] = (uint8_t)provider;
}

/* A sample that is being put together. */
typedef struct Blend {
    float value[L1L2_BORDER_COMPONENTS]; /* of the layers so far, without the frame itself */
    float rest;                          /* what they have left */
    float most;                          /* the largest weight of them */
    int provider;                        /* whose weight it is */
    struct {                             /* the same as if all sources agreed with the frame */
        float value[L1L2_BORDER_COMPONENTS], rest;
        int provider;                    /* the nearest one */
    } trusting;
} Blend;

/* Adds a source that has `weight` at a sample. */
static void add_source(const Row *row, int index, int sample, float weight, Blend *blend)
{
    if (weight == 0.0f)
        return;
    const Plane *plane = row->plane;
    const L1L2BorderSource *source = &plane->composite->source[index];
    const float at = (float)node_index(sample, plane->width, source->field.columns);
    const int node = (int)at;
    const float part = at - (float)node, *agreement = row->agreement[index] + node;
    const uint8_t *picture = source->data[plane->index] + row->v * source->stride[plane->index];
    const float trusting = weight * blend->trusting.rest;
    weight *= blend->rest * (agreement[0] + part * (agreement[1] - agreement[0]));
    for (int k = 0; k < plane->components; k++) {
        const float *offset = row->offset[index][k] + node, add = offset[0] + part * (offset[1] - offset[0]);
        const float value = (float)read_component(plane, picture, sample, k) + add;
        blend->value[k] += weight * value;
        blend->trusting.value[k] += trusting * value;
    }
    blend->rest -= weight;
    if (blend->trusting.rest == 1.0f)
        blend->trusting.provider = L1L2_BORDER_NEIGHBOR + source->distance;
    blend->trusting.rest -= trusting;
    if (weight > blend->most) {
        blend->most = weight;
        blend->provider = L1L2_BORDER_NEIGHBOR + source->distance;
    }
}

/* Outside the frame, the sources share what they left. Where hardly any agrees with the frame, the nearest is shown all
 * the same: something real, if perhaps at the wrong place. Where there is none, it is extended. */
static void fill_rest(const Plane *plane, const Positions *own, int i, Blend *blend)
{
    if (blend->rest == 0.0f)
        return;
    const float agreed = 1.0f - blend->rest, covered = 1.0f - blend->trusting.rest, doubt = doubt_weight * blend->rest;
    if (covered >= least_weight) {
        for (int k = 0; k < plane->components; k++)
            blend->value[k] = (blend->value[k] + doubt * blend->trusting.value[k] / covered) / (agreed + doubt);
        if (agreed < doubt)
            blend->provider = blend->trusting.provider;
        return;
    }
    float extension[L1L2_BORDER_COMPONENTS];
    extend(plane, own->x[i], own->y[i], own->depth[i], extension);
    for (int k = 0; k < plane->components; k++)
        blend->value[k] += blend->rest * extension[k];
    blend->provider = L1L2_BORDER_EXTENDED;
}

/* Paints sample u + i of the run. Inside the frame, the frame takes what the sources leave. */
static void paint(const Row *row, int u, int i, const Positions *own, const Positions *other)
{
    const Plane *plane = row->plane;
    const L1L2BorderComposite *c = plane->composite;
    const int sample = u + i;
    uint8_t *out = c->dst[plane->index] + row->v * c->dst_stride[plane->index];
    const float mine = weight_at(plane, own->depth[i]);
    Blend blend = {.rest = 1.0f - mine, .most = mine, .provider = L1L2_BORDER_OWN, .trusting = {.rest = 1.0f}};
    for (int s = 0; s < c->sources && blend.rest > 0.0f; s++)
        if (i >= row->from[s] && i < row->end[s])
            add_source(row, s, sample, weight_at(plane, other[s].depth[i - row->from[s]]), &blend);
    float keeps = 0.0f;
    if (own->depth[i] < 0.0f) {
        fill_rest(plane, own, i, &blend);
    } else {
        keeps = mine + blend.rest;
        if (keeps > blend.most)
            blend.provider = L1L2_BORDER_OWN;
    }
    for (int k = 0; k < plane->components; k++)
        write_component(plane, out, sample, k,
                        blend.value[k] + keeps * (float)read_component(plane, out, sample, k));
    note_provider(row, sample, blend.provider);
}

static void paint_run(Row *row, int u, int count)
{
    const Plane *plane = row->plane;
    const L1L2BorderComposite *c = plane->composite;
    Positions own, other[L1L2_BORDER_MAX_SOURCES];
    int first = count, end = 0;
    find_positions(plane, c->own.mesh, u, row->v, count, &own);
    for (int i = 0; i < count; i++)
        if (own.depth[i] < (float)(rim_px + c->seam)) {
            first = i < first ? i : first;
            end = i + 1;
        }
    if (first >= end)
        return;
    for (int s = 0; s < c->sources; s++) {
        const L1L2WarpRect *pixels = &c->source[s].part.rect[row->strip];
        const L1L2WarpRect part = l1l2_warp_rect_samples(pixels, plane->log2_sub_x, plane->log2_sub_y);
        const int from = part.left - u > first ? part.left - u : first;
        row->from[s] = from;
        row->end[s] = row->v < part.top || row->v >= part.bottom ? 0 : part.right - u < end ? part.right - u : end;
        if (from < row->end[s])
            find_positions(plane, c->source[s].mesh, u + from, row->v, row->end[s] - from, &other[s]);
    }
    for (int i = first; i < end; i++)
        if (own.depth[i] < (float)(rim_px + c->seam))
            paint(row, u, i, &own, other);
}

typedef struct PaintJob {
    Plane plane[L1L2_MAX_PLANES];
    struct {
        int plane;
        L1L2WarpRect part; /* samples */
        int bands;
    } piece[L1L2_MAX_PLANES * L1L2_BORDER_STRIPS];
} PaintJob;

static void paint_band(void *context, int index)
{
    const PaintJob *job = context;
    int piece = 0;
    for (; index >= job->piece[piece].bands; piece++)
        index -= job->piece[piece].bands;
    const L1L2WarpRect *part = &job->piece[piece].part;
    const int top = part->top + index * BAND_ROWS;
    Row row;
    for (int v = top; v < part->bottom && v < top + BAND_ROWS; v++) {
        begin_row(&row, &job->plane[job->piece[piece].plane], v);
        row.strip = piece % L1L2_BORDER_STRIPS;
        for (int u = part->left; u < part->right; u += RUN)
            paint_run(&row, u, part->right - u < RUN ? part->right - u : RUN);
    }
}

void l1l2_border_composite(L1L2BorderComposite *c)
{
    const int planes = c->format->planes;
    OffsetJob offsets = {.composite = c};
    PaintJob job;
    int bands = 0;
    for (int p = 0; p < planes; p++) {
        offsets.plane[p] = job.plane[p] = plane_of(c, p);
        for (int k = 0; k < L1L2_BORDER_STRIPS; k++) {
            const Plane *plane = &job.plane[p];
            const int piece = p * L1L2_BORDER_STRIPS + k;
            const L1L2WarpRect part = l1l2_warp_rect_samples(&c->strips.rect[k], plane->log2_sub_x, plane->log2_sub_y);
            job.piece[piece].plane = p;
            job.piece[piece].part = part;
            job.piece[piece].bands = part.right > part.left ? (part.bottom - part.top + BAND_ROWS - 1) / BAND_ROWS : 0;
            bands += job.piece[piece].bands;
        }
    }
    l1l2_pool_run(c->pool, c->sources * planes, measure_offsets, &offsets);
    l1l2_pool_run(c->pool, bands, paint_band, &job);
}
