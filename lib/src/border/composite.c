/* SPDX-License-Identifier: MIT */
#include "border/composite.h"

#include <math.h>
#include <string.h>

enum {
    RUN = L1L2_WARP_RUN_SAMPLES,
    BAND_ROWS = 16,
    OFFSET_STEP = 2,     /* of each second sample in some rows, offsets are measured */
    OFFSET_ROWS = 16,    /* as many rows from node to node, but every second one at most */
    SOFTEST = 3          /* samples: the radius of the mean that the extension takes */
};

/* The band in which offsets are measured, in seams. */
static const double offset_band = 2.0;
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

/* A run of samples of one row. */
typedef struct Run {
    const Plane *plane;
    int u, v, count;    /* its first sample, its row, and how many */
} Run;

static void read_run(const Run *run, const uint8_t *data, ptrdiff_t stride, int component, float *level)
{
    const Plane *plane = run->plane;
    const uint8_t *row = data + run->v * stride;
    if (plane->bytes == 1) {
        const uint8_t *p = row + run->u * plane->components + component;
        if (plane->components == 1)
            for (int i = 0; i < run->count; i++)
                level[i] = (float)p[i];
        else
            for (int i = 0; i < run->count; i++)
                level[i] = (float)p[i * plane->components];
        return;
    }
    for (int i = 0; i < run->count; i++)
        level[i] = (float)read_component(plane, row, run->u + i, component);
}

static void write_run(const Run *run, uint8_t *data, ptrdiff_t stride, int component, const float *level)
{
    const Plane *plane = run->plane;
    const float most = (float)plane->most;
    uint8_t *p = data + run->v * stride + (run->u * plane->components + component) * plane->bytes;
    const int step = plane->components * plane->bytes, shift = plane->shift;
    int32_t stored[RUN];
    for (int i = 0; i < run->count; i++) {
        const float cut = level[i] < 0.0f ? 0.0f : level[i] > most ? most : level[i];
        stored[i] = (int32_t)(cut + 0.5f) << shift;
    }
    if (step == 1) {
        for (int i = 0; i < run->count; i++)
            p[i] = (uint8_t)stored[i];
        return;
    }
    for (int i = 0; i < run->count; i++) {
        p[i * step] = (uint8_t)stored[i];
        if (plane->bytes == 2)
            p[i * step + 1] = (uint8_t)(stored[i] >> 8);
    }
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

/* Adds the differences of a run to those of a row of nodes. */
static void sum_run(const Run *run, const L1L2BorderSource *source, NodeSum *nodes)
{
    const Plane *plane = run->plane;
    const L1L2BorderComposite *c = plane->composite;
    const float rim = (float)rim_px, inner = (float)(offset_band * c->seam);
    const float scale = (float)(source->field.columns - 1) / (float)plane->width;
    const int limit = (int)(largest_offset * plane->most);
    const uint8_t *mine = c->dst[plane->index] + run->v * c->dst_stride[plane->index];
    const uint8_t *theirs = source->data[plane->index] + run->v * source->stride[plane->index];
    Positions own, other;
    int near = 0;
    find_positions(plane, c->own.mesh, run->u, run->v, run->count, &own);
    for (int i = 0; i < run->count; i++)
        near += (own.depth[i] >= rim) & (own.depth[i] <= inner);
    if (near == 0)
        return;
    find_positions(plane, source->mesh, run->u, run->v, run->count, &other);
    for (int i = 0; i < run->count; i += OFFSET_STEP) {
        if (own.depth[i] < rim || own.depth[i] > inner || other.depth[i] < rim)
            continue;
        const int u = run->u + i;
        NodeSum *node = &nodes[(int)(((float)u + 0.5f) * scale + 0.5f)];
        int difference[L1L2_BORDER_COMPONENTS], largest = 0;
        for (int k = 0; k < plane->components; k++) {
            difference[k] = read_component(plane, mine, u, k) - read_component(plane, theirs, u, k);
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
    const int from_node_to_node = plane->height / (source->field.rows - 1) / OFFSET_ROWS;
    const int step = from_node_to_node > OFFSET_STEP ? from_node_to_node : OFFSET_STEP;
    NodeSum sums[MAX_NODES * MAX_NODES];
    memset(sums, 0, (size_t)nodes * sizeof *sums);
    for (int k = 0; k < L1L2_BORDER_STRIPS; k++) {
        const L1L2WarpRect strip = l1l2_warp_rect_samples(&source->part.rect[k], plane->log2_sub_x, plane->log2_sub_y);
        for (int v = strip.top; v < strip.bottom; v += step) {
            const int row = (int)(node_index(v, plane->height, source->field.rows) + 0.5);
            for (int u = strip.left; u < strip.right; u += RUN) {
                const Run run = {plane, u, v, strip.right - u < RUN ? strip.right - u : RUN};
                sum_run(&run, source, sums + row * source->field.columns);
            }
        }
    }
    for (int k = 0; k < plane->components; k++)
        spread(&source->field, sums, k, source->offset + (plane->first_component + k) * nodes);
}

/* ---- Painting ---- */

/* A run of samples of one row that is put together, from the front to the back. All arrays are one entry a sample. */
typedef struct Blend {
    float mine[RUN];                         /* the weight of the frame itself */
    float value[L1L2_BORDER_COMPONENTS][RUN]; /* of the layers so far, without the frame itself */
    float rest[RUN];                         /* what they have left */
    float most[RUN];                         /* the largest weight of them */
    int32_t provider[RUN];                   /* whose weight it is */
    struct {                                 /* the same as if all sources agreed with the frame */
        float value[L1L2_BORDER_COMPONENTS][RUN], rest[RUN];
        int32_t provider[RUN];               /* the nearest one */
    } trusting;
} Blend;

/* What a row of nodes says at each sample: linear from node to node. */
static void interpolate_run(const float *nodes, int columns, const Run *run, float *out)
{
    const float scale = (float)(columns - 1) / (float)run->plane->width;
    for (int i = 0; i < run->count;) {
        const int node = (int)(((float)(run->u + i) + 0.5f) * scale);
        const float from = nodes[node], step = nodes[node + 1] - from;
        const int beyond = (int)ceilf((float)(node + 1) / scale - 0.5f) - run->u;
        const int end = beyond <= i ? i + 1 : beyond < run->count ? beyond : run->count;
        for (; i < end; i++)
            out[i] = from + (((float)(run->u + i) + 0.5f) * scale - (float)node) * step;
    }
}

static void weights_of(const Plane *plane, const float *depth, int count, float *weight)
{
    const float rim = (float)rim_px, seam = (float)plane->composite->seam;
    for (int i = 0; i < count; i++) {
        const float x = (depth[i] - rim) / seam, cut = x < 0.0f ? 0.0f : x > 1.0f ? 1.0f : x;
        weight[i] = cut * cut * (3.0f - 2.0f * cut);
    }
}

static void begin(Blend *blend, const Run *run, const float *depth)
{
    weights_of(run->plane, depth, run->count, blend->mine);
    memset(blend->value, 0, (size_t)run->plane->components * sizeof blend->value[0]);
    memset(blend->trusting.value, 0, (size_t)run->plane->components * sizeof blend->trusting.value[0]);
    for (int i = 0; i < run->count; i++) {
        blend->rest[i] = 1.0f - blend->mine[i];
        blend->most[i] = blend->mine[i];
        blend->provider[i] = L1L2_BORDER_OWN;
        blend->trusting.rest[i] = 1.0f;
        blend->trusting.provider[i] = L1L2_BORDER_OWN;
    }
}

/* Adds a source to the samples from blend's `first` on. agreement, offset: rows of the grid at the run's row. */
static void add_source(Blend *blend, int first, const Run *run, const L1L2BorderSource *source, const float *depth,
                       const float *agreement, float offset[][MAX_NODES])
{
    const Plane *plane = run->plane;
    const int count = run->count, columns = source->field.columns;
    const int32_t provider = L1L2_BORDER_NEIGHBOR + source->distance;
    float weight[RUN], trusted[RUN], part[RUN], level[RUN];
    weights_of(plane, depth, count, trusted);
    interpolate_run(agreement, columns, run, weight);
    float *rest = blend->rest + first, *most = blend->most + first, *trusting = blend->trusting.rest + first;
    int32_t *whose = blend->provider + first, *nearest = blend->trusting.provider + first;
    for (int i = 0; i < count; i++)
        nearest[i] = ((nearest[i] == L1L2_BORDER_OWN) & (trusted[i] > 0.0f)) ? provider : nearest[i];
    for (int i = 0; i < count; i++) {
        weight[i] *= trusted[i] * rest[i];
        trusted[i] *= trusting[i];
        rest[i] -= weight[i];
        trusting[i] -= trusted[i];
    }
    for (int i = 0; i < count; i++)
        whose[i] = weight[i] > most[i] ? provider : whose[i];
    for (int i = 0; i < count; i++)
        most[i] = weight[i] > most[i] ? weight[i] : most[i];
    for (int k = 0; k < plane->components; k++) {
        read_run(run, source->data[plane->index], source->stride[plane->index], k, level);
        interpolate_run(offset[k], columns, run, part);
        float *value = blend->value[k] + first, *trusting_value = blend->trusting.value[k] + first;
        for (int i = 0; i < count; i++) {
            const float shown = level[i] + part[i];
            value[i] += weight[i] * shown;
            trusting_value[i] += trusted[i] * shown;
        }
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

/* Outside the frame, the sources share what they left. Where hardly any agrees with the frame, the nearest is shown all
 * the same: something real, if perhaps at the wrong place. Where there is none, it is extended. */
static void fill_rest(Blend *blend, const Run *run, const Positions *own, int first)
{
    const Plane *plane = run->plane;
    for (int k = 0; k < plane->components; k++) {
        float *value = blend->value[k];
        const float *trusting = blend->trusting.value[k];
        for (int i = 0; i < run->count; i++) {
            const float rest = blend->rest[i], covered = 1.0f - blend->trusting.rest[i], doubt = doubt_weight * rest;
            const float divisor = covered > least_weight ? covered : least_weight;
            const float shared = (value[i] + doubt * trusting[i] / divisor) / (1.0f - rest + doubt);
            value[i] = own->depth[first + i] < 0.0f && covered >= least_weight ? shared : value[i];
        }
    }
    for (int i = 0; i < run->count; i++) {
        const float rest = blend->rest[i];
        if (own->depth[first + i] >= 0.0f || rest == 0.0f)
            continue;
        if (1.0f - blend->trusting.rest[i] >= least_weight) {
            if (1.0f - rest < doubt_weight * rest)
                blend->provider[i] = blend->trusting.provider[i];
            continue;
        }
        float extension[L1L2_BORDER_COMPONENTS];
        extend(plane, own->x[first + i], own->y[first + i], own->depth[first + i], extension);
        for (int k = 0; k < plane->components; k++)
            blend->value[k][i] += rest * extension[k];
        blend->provider[i] = L1L2_BORDER_EXTENDED;
    }
}

/* The part that the frame itself has of a sample. Inside, it takes what the sources leave. */
static inline float own_part(const Blend *blend, const float *depth, int i)
{
    return depth[i] < 0.0f ? 0.0f : blend->mine[i] + blend->rest[i];
}

/* Adds the frame itself, which is in the output. */
static void add_own(Blend *blend, const Run *run, const float *depth)
{
    const Plane *plane = run->plane;
    const L1L2BorderComposite *c = plane->composite;
    float level[RUN];
    for (int i = 0; i < run->count; i++)
        blend->provider[i] = own_part(blend, depth, i) > blend->most[i] ? L1L2_BORDER_OWN : blend->provider[i];
    for (int k = 0; k < plane->components; k++) {
        read_run(run, c->dst[plane->index], c->dst_stride[plane->index], k, level);
        for (int i = 0; i < run->count; i++)
            level[i] = blend->value[k][i] + own_part(blend, depth, i) * level[i];
        write_run(run, c->dst[plane->index], c->dst_stride[plane->index], k, level);
    }
}

static void note_providers(const Blend *blend, const Run *run)
{
    const Plane *plane = run->plane;
    const L1L2BorderComposite *c = plane->composite;
    if (plane->index != 0)
        return;
    uint8_t *row = c->provider + run->v * c->width;
    if (plane->log2_sub_x == 0) {
        for (int i = 0; i < run->count; i++)
            row[run->u + i] = (uint8_t)blend->provider[i];
        return;
    }
    for (int i = 0; i < run->count; i++)
        for (int x = (run->u + i) << plane->log2_sub_x; x < (run->u + i + 1) << plane->log2_sub_x && x < c->width; x++)
            row[x] = (uint8_t)blend->provider[i];
}

/* What the grids say along a row of samples. */
typedef struct GridRow {
    float agreement[L1L2_BORDER_MAX_SOURCES][MAX_NODES];
    float offset[L1L2_BORDER_MAX_SOURCES][L1L2_BORDER_COMPONENTS][MAX_NODES];
} GridRow;

static void begin_row(GridRow *row, const Plane *plane, int v)
{
    const L1L2BorderComposite *c = plane->composite;
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

/* Paints a run of a strip, but for its ends that are farther inside the frame than the seam. */
static void paint_run(GridRow *row, const Run *whole, int strip)
{
    const Plane *plane = whole->plane;
    const L1L2BorderComposite *c = plane->composite;
    const float inside = (float)(rim_px + c->seam);
    Positions own, other;
    find_positions(plane, c->own.mesh, whole->u, whole->v, whole->count, &own);
    int first = 0, end = whole->count;
    for (; first < end && own.depth[first] >= inside; first++) {}
    for (; first < end && own.depth[end - 1] >= inside; end--) {}
    if (first == end)
        return;
    const Run part = {plane, whole->u + first, whole->v, end - first};
    Blend blend;
    begin(&blend, &part, own.depth + first);
    for (int s = 0; s < c->sources; s++) {
        const L1L2WarpRect *pixels = &c->source[s].part.rect[strip];
        const L1L2WarpRect shown = l1l2_warp_rect_samples(pixels, plane->log2_sub_x, plane->log2_sub_y);
        const int left = shown.left > part.u ? shown.left : part.u;
        const int right = shown.right < part.u + part.count ? shown.right : part.u + part.count;
        if (left >= right || part.v < shown.top || part.v >= shown.bottom)
            continue;
        const Run run = {plane, left, part.v, right - left};
        find_positions(plane, c->source[s].mesh, run.u, run.v, run.count, &other);
        add_source(&blend, left - part.u, &run, &c->source[s], other.depth, row->agreement[s], row->offset[s]);
    }
    fill_rest(&blend, &part, &own, first);
    add_own(&blend, &part, own.depth + first);
    note_providers(&blend, &part);
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
    const Plane *plane = &job->plane[job->piece[piece].plane];
    GridRow row;
    for (int v = top; v < part->bottom && v < top + BAND_ROWS; v++) {
        begin_row(&row, plane, v);
        for (int u = part->left; u < part->right; u += RUN) {
            const Run run = {plane, u, v, part->right - u < RUN ? part->right - u : RUN};
            paint_run(&row, &run, piece % L1L2_BORDER_STRIPS);
        }
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
