/* SPDX-License-Identifier: MIT */
/*
 * The frame's planes, cut into bands of rows that threads take in any order. A band goes run by run: the generator
 * (warp_coords.h) writes positions, a renderer with its kernel (warp_kernel.h) weighs the samples around them: along
 * lines (warp_line.h), if they are of 8 bits and the map turns little; else one by one (warp_u8.h, warp_u16.h). Planes
 * that a map moves by whole samples are copied.
 */
#include "warp/warp.h"

#include <string.h>

#include "common/mem.h"
#include "warp/coords.h"
#include "warp/direct_u16.h"
#include "warp/direct_u8.h"
#include "warp/kernel.h"
#include "warp/packed422.h"
#include "warp/scanline_u8.h"

enum {
    CACHE_LINE = 64,
    ROWS_AHEAD = 6, /* below a position: more than the taps of this run and the next reach */
    TILE_RUNS = 2,
    BAND_ROWS = 32 /* enough work to be worth a thread's while, few enough to share a frame out evenly */
};

struct L1L2Warp {
    L1L2WarpConfig cfg;
    L1L2WarpKernel kernel;
    const L1L2FormatInfo *packed; /* if frames are packed 4:2:2; then cfg.format is that of their planes */
    L1L2WarpPlanes in, out;
};

/* One plane of one frame. */
typedef struct PlaneJob {
    const L1L2WarpGenerators *generators;
    L1L2WarpAffine affine;
    L1L2WarpMeshPlane mesh; /* in place of `affine`, if it has a mesh */
    L1L2WarpPlane src;
    uint8_t *dst;
    ptrdiff_t dst_stride;
    int width, height; /* of dst, samples */
    int sample_bytes;  /* of all its components */
    L1L2WarpScanlineRun *line_run; /* for what goes by lines, or NULL */
    L1L2WarpRun *run;
    int bands;
    bool copies;        /* whole steps, without a mesh: sample (u, v) is the source's (u + step_x, v + step_y) */
    int step_x, step_y;
} PlaneJob;

typedef struct FrameJob {
    const L1L2WarpKernel *kernel;
    PlaneJob plane[L1L2_MAX_PLANES];
} FrameJob;

static bool prepare_packed(L1L2Warp *w)
{
    if (!l1l2_warp_packed422_is(w->cfg.format))
        return true;
    w->packed = w->cfg.format;
    w->cfg.format = l1l2_image_format_info(L1L2STAB_FORMAT_Y42B);
    return l1l2_warp_packed422_new(&w->in, w->cfg.in_width, w->cfg.in_height) &&
           l1l2_warp_packed422_new(&w->out, w->cfg.out_width, w->cfg.out_height);
}

L1L2StabResult l1l2_warp_create(L1L2Warp **out, const L1L2WarpConfig *cfg)
{
    *out = NULL;
    if (!cfg->format || cfg->in_width <= 0 || cfg->in_height <= 0 || cfg->out_width <= 0 || cfg->out_height <= 0)
        return L1L2STAB_ERR_ARGUMENT;
    L1L2Warp *w = l1l2_mem_new(1, sizeof *w);
    if (!w)
        return L1L2STAB_ERR_NOMEM;
    w->cfg = *cfg;
    l1l2_warp_kernel_init(&w->kernel, cfg->interpolation);
    if (!prepare_packed(w)) {
        l1l2_warp_free(w);
        return L1L2STAB_ERR_NOMEM;
    }
    *out = w;
    return L1L2STAB_OK;
}

void l1l2_warp_free(L1L2Warp *w)
{
    if (!w)
        return;
    l1l2_warp_packed422_free(&w->in);
    l1l2_warp_packed422_free(&w->out);
    l1l2_mem_free(w);
}

const char *l1l2_warp_simd(void)
{
    return l1l2_warp_scanline_run(2, 1) == l1l2_warp_scanline_run_plain(2, 1) ? "none" : "avx2";
}

/* The sample type's function for one plane. */
static L1L2WarpRun *find_run(const L1L2WarpConfig *cfg, int taps, int components)
{
    if (cfg->format->depth > 8)
        return (cfg->plain ? l1l2_warp_direct_u16_run_plain : l1l2_warp_direct_u16_run)(taps, components,
                                                                                        cfg->format->depth);
    return l1l2_warp_direct_u8_run(components);
}

static L1L2WarpScanlineRun *find_line_run(const L1L2WarpConfig *cfg, int taps, int components)
{
    if (cfg->format->depth > 8)
        return NULL;
    return (cfg->plain ? l1l2_warp_scanline_run_plain : l1l2_warp_scanline_run)(taps, components);
}

/* Whether the positions of all samples are whole steps. They are if those of the corners are: along a row the distance
 * to a step is a line cut to a phase, down a column it only grows or only shrinks. */
static void find_step(PlaneJob *job)
{
    for (int corner = 0; corner < 4; corner++) {
        const int u = corner % 2 ? job->width - 1 : 0, v = corner / 2 ? job->height - 1 : 0;
        int32_t x[1 + L1L2_WARP_RUN_SLACK], y[1 + L1L2_WARP_RUN_SLACK];
        job->generators->affine(&job->affine, u, v, 1, x, y);
        const int step_x = (x[0] >> L1L2_WARP_PHASE_BITS) - u, step_y = (y[0] >> L1L2_WARP_PHASE_BITS) - v;
        if (((x[0] | y[0]) & (L1L2_WARP_PHASES - 1)) || (corner && (step_x != job->step_x || step_y != job->step_y)))
            return;
        job->step_x = step_x;
        job->step_y = step_y;
    }
    job->copies = true;
}

static int clamp(int value, int low, int high)
{
    return value < low ? low : value > high ? high : value;
}

static void repeat(uint8_t *dst, const uint8_t *sample, int count, int sample_bytes)
{
    for (int i = 0; i < count; i++)
        memcpy(dst + i * sample_bytes, sample, (size_t)sample_bytes);
}

/* What weighing in phase 0 gives. Bits beside a component's depth, of which weighing knows nothing, are copied too. */
static void copy_band(const PlaneJob *job, int band)
{
    const L1L2WarpPlane *src = &job->src;
    const int bytes = job->sample_bytes;
    const int left = clamp(-job->step_x, 0, job->width), right = clamp(src->width - job->step_x, left, job->width);
    for (int v = band * BAND_ROWS; v < job->height && v < (band + 1) * BAND_ROWS; v++) {
        const uint8_t *from = src->data + clamp(v + job->step_y, 0, src->height - 1) * src->stride;
        uint8_t *to = job->dst + v * job->dst_stride;
        repeat(to, from, left, bytes);
        if (right > left)
            memcpy(to + left * bytes, from + (left + job->step_x) * bytes, (size_t)((right - left) * bytes));
        repeat(to + right * bytes, from + (src->width - 1) * bytes, job->width - right, bytes);
    }
}

/* Source and output of some rows further down are fetched while a run is rendered: tiles are too narrow for the
 * processor to guess them. */
static void fetch(const PlaneJob *job, int column, int row)
{
#if defined(__GNUC__)
    /* It may lie outside: nothing is read. */
    const ptrdiff_t from = (row + ROWS_AHEAD) * job->src.stride + (ptrdiff_t)column * job->sample_bytes;
    __builtin_prefetch((const void *)((uintptr_t)job->src.data + (uintptr_t)from));
#endif
}

static void fetch_output(const PlaneJob *job, int u, int v, int count)
{
#if defined(__GNUC__)
    if (v + ROWS_AHEAD < job->height)
        for (int i = 0; i < count * job->sample_bytes; i += CACHE_LINE)
            __builtin_prefetch(job->dst + (v + ROWS_AHEAD) * job->dst_stride + u * job->sample_bytes + i, 1);
#endif
}

/* Every cache line of the source, that of the last column too. */
static void fetch_line(const PlaneJob *job, const L1L2WarpScanline *line, int taps)
{
    const int step = CACHE_LINE / job->sample_bytes;
    for (int k = 0; k < line->down_pieces; k++) {
        const L1L2WarpPiece *piece = &line->down[k];
        const int end = k + 1 < line->down_pieces ? piece[1].from : line->columns + step - 1;
        for (int i = piece->from; i < end; i += step) {
            const int column = taps > 2 ? i : l1l2_warp_piece_position(&line->along[k], i) >> L1L2_WARP_PHASE_BITS;
            fetch(job, line->first + column, l1l2_warp_piece_position(piece, i) >> L1L2_WARP_PHASE_BITS);
        }
    }
}

/* A run of row v, from u on; cells: the mesh's, if the map is one. */
static void render_run(const PlaneJob *job, const L1L2WarpKernel *kernel, const L1L2WarpCells *cells, int u, int v,
                       int count)
{
    uint8_t *dst = job->dst + v * job->dst_stride + u * job->sample_bytes;
    L1L2WarpScanline line;
    fetch_output(job, u, v, count);
    if (job->line_run && (job->mesh.mesh ? l1l2_warp_mesh_scanline(&job->mesh, cells, kernel->taps, v, &line)
                                         : l1l2_warp_affine_scanline(&job->affine, kernel->taps, u, v, count, &line))) {
        fetch_line(job, &line, kernel->taps);
        job->line_run(&job->src, kernel, &line, dst);
        return;
    }
    int32_t x[L1L2_WARP_RUN_SAMPLES + L1L2_WARP_RUN_SLACK], y[L1L2_WARP_RUN_SAMPLES + L1L2_WARP_RUN_SLACK];
    if (job->mesh.mesh)
        job->generators->mesh(&job->mesh, cells, v, x, y);
    else
        job->generators->affine(&job->affine, u, v, count, x, y);
    for (int i = 0; i < count; i += CACHE_LINE / job->sample_bytes)
        fetch(job, x[i] >> L1L2_WARP_PHASE_BITS, y[i] >> L1L2_WARP_PHASE_BITS);
    job->run(&job->src, kernel, x, y, count, dst);
}

/* Tile by tile: as wide as the first-level cache holds of a turned line's rows. Cells are the same for all rows. */
static void render_band(const PlaneJob *job, const L1L2WarpKernel *kernel, int band)
{
    const int first = band * BAND_ROWS;
    const int end = first + BAND_ROWS < job->height ? first + BAND_ROWS : job->height;
    for (int tile = 0; tile < job->width; tile += TILE_RUNS * L1L2_WARP_RUN_SAMPLES) {
        L1L2WarpCells cells[TILE_RUNS];
        int from[TILE_RUNS + 1] = {tile}, runs = 0;
        for (; runs < TILE_RUNS && from[runs] < job->width; runs++) {
            const int left = job->width - from[runs];
            from[runs + 1] = from[runs] + (left < L1L2_WARP_RUN_SAMPLES ? left : L1L2_WARP_RUN_SAMPLES);
            if (job->mesh.mesh)
                cells[runs] = l1l2_warp_mesh_cells(&job->mesh, from[runs], from[runs + 1] - from[runs]);
        }
        for (int v = first; v < end; v++)
            for (int k = 0; k < runs; k++)
                render_run(job, kernel, &cells[k], from[k], v, from[k + 1] - from[k]);
    }
}

/* Bands are counted through all planes. */
static void render_part(void *context, int index)
{
    const FrameJob *job = context;
    int plane = 0;
    for (; index >= job->plane[plane].bands; plane++)
        index -= job->plane[plane].bands;
    if (job->plane[plane].copies)
        copy_band(&job->plane[plane], index);
    else
        render_band(&job->plane[plane], job->kernel, index);
}

static void render_planes(L1L2Warp *w, const L1L2WarpMap *map, const uint8_t *const src[4],
                          const ptrdiff_t src_stride[4], uint8_t *const dst[4], const ptrdiff_t dst_stride[4])
{
    const L1L2WarpConfig *cfg = &w->cfg;
    const L1L2FormatInfo *format = cfg->format;
    FrameJob job = {.kernel = &w->kernel,};
    int bands = 0;
    for (int i = 0; i < format->planes; i++) {
        const int sub_x = format->plane[i].log2_sub_x, sub_y = format->plane[i].log2_sub_y;
        const int components = format->plane[i].components;
        const L1L2WarpGrid from = l1l2_warp_grid(format, i, cfg->chroma_site, cfg->in_width, cfg->in_height);
        const L1L2WarpGrid to = l1l2_warp_grid(format, i, cfg->chroma_site, cfg->out_width, cfg->out_height);
        PlaneJob *plane = &job.plane[i];
        *plane = (PlaneJob){
            .generators = cfg->plain ? &l1l2_warp_generators_plain : l1l2_warp_generators(),
            .affine = l1l2_warp_affine(&map->affine, &to, &from),
            .mesh = {map->mesh, to, from},
            .src = {src[i], src_stride[i], l1l2_image_plane_size(cfg->in_width, sub_x),
                    l1l2_image_plane_size(cfg->in_height, sub_y), format->depth, format->shift},
            .dst = dst[i],
            .dst_stride = dst_stride[i],
            .width = l1l2_image_plane_size(cfg->out_width, sub_x),
            .height = l1l2_image_plane_size(cfg->out_height, sub_y),
            .sample_bytes = components * l1l2_image_format_bytes(format),
            .line_run = find_line_run(cfg, w->kernel.taps, components),
            .run = find_run(cfg, w->kernel.taps, components),
        };
        if (!map->mesh)
            find_step(plane);
        plane->bands = (plane->height + BAND_ROWS - 1) / BAND_ROWS;
        bands += plane->bands;
    }
    l1l2_pool_run(cfg->pool, bands, render_part, &job);
}

void l1l2_warp_render(L1L2Warp *w, const L1L2WarpMap *map, const uint8_t *const src[4], const ptrdiff_t src_stride[4],
                      uint8_t *const dst[4], const ptrdiff_t dst_stride[4])
{
    if (!w->packed) {
        render_planes(w, map, src, src_stride, dst, dst_stride);
        return;
    }
    l1l2_warp_packed422_split(w->cfg.pool, w->packed, src[0], src_stride[0], &w->in);
    render_planes(w, map, (const uint8_t *const *)w->in.data, w->in.stride, w->out.data, w->out.stride);
    l1l2_warp_packed422_merge(w->cfg.pool, w->packed, &w->out, dst[0], dst_stride[0]);
}
