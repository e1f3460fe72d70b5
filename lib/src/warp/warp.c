/* SPDX-License-Identifier: MIT */
/*
 * Renders the planes of a frame. They are cut into bands of rows, which threads take in any order.
 *
 * A band is rendered run by run, a run being up to L1L2_WARP_RUN_SAMPLES samples of a row. 8-bit samples are weighed
 * along the scanline that the run follows through the source (scanline_u8.h, bilinear_u8.h). Runs that turn too far for
 * that, and samples of more bits, are weighed one by one around the positions that a generator writes (direct_u8.h,
 * direct_u16.h). Planes that the map moves by whole samples are copied.
 *
 * What does not change from frame to frame is decided at creation, the inner loops of each plane among it.
 */
#include "warp/warp.h"

#include <string.h>

#include "common/compiler.h"
#include "common/cpu.h"
#include "common/mem.h"
#include "warp/functions.h"
#include "warp/kernel.h"
#include "warp/packed422.h"

enum {
    CACHE_LINE = 64,
    ROWS_AHEAD = 6, /* rows from a position to what is prefetched: beyond the taps of this run and of the next one */
    TILE_RUNS = 2,
    BAND_ROWS = 32, /* enough work for a thread, few enough rows to share a frame evenly */
    FEWEST_ROWS = 4 /* of a band in a part of a frame */
};

/* One plane of all frames. */
typedef struct PlaneLayout {
    L1L2WarpGrid src_grid, dst_grid;
    int src_width, src_height; /* samples */
    int width, height;         /* of the output, samples */
    int sample_bytes;          /* of all components of a sample */
    L1L2WarpScanlineRun *scanline_run; /* NULL: samples of this depth are not weighed along scanlines */
    L1L2WarpDirectRun *direct_run;
} PlaneLayout;

struct L1L2Warp {
    L1L2WarpConfig cfg;
    L1L2WarpGenerators generators;
    L1L2WarpKernel kernel;
    const L1L2FormatInfo *packed; /* the frames' format if it is packed 4:2:2; then cfg.format is that of in and out */
    L1L2WarpPlanes in, out;
    PlaneLayout plane[L1L2_MAX_PLANES];
};

/* One plane of one frame. */
typedef struct PlaneJob {
    const PlaneLayout *layout;
    const L1L2WarpGenerators *generators;
    const L1L2WarpKernel *kernel;
    L1L2WarpAffine affine;
    L1L2WarpMeshPlane mesh; /* used in place of `affine` if it has a mesh */
    L1L2WarpPlane src;
    uint8_t *dst;
    ptrdiff_t dst_stride;
    L1L2WarpRect part;      /* samples to render */
    int bands, band_rows;
    bool copies;            /* output sample (u, v) is source sample (u + step_x, v + step_y) */
    int step_x, step_y;
} PlaneJob;

typedef struct FrameJob {
    PlaneJob plane[L1L2_MAX_PLANES * L1L2_WARP_MAX_PARTS]; /* each plane's parts */
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

static PlaneLayout lay_out_plane(const L1L2WarpConfig *cfg, const L1L2WarpFunctions *functions, int taps, int plane)
{
    const L1L2FormatInfo *format = cfg->format;
    const int sub_x = format->plane[plane].log2_sub_x, sub_y = format->plane[plane].log2_sub_y;
    const int components = format->plane[plane].components;
    return (PlaneLayout){
        .src_grid = l1l2_warp_grid(format, plane, cfg->chroma_site, cfg->in_width, cfg->in_height),
        .dst_grid = l1l2_warp_grid(format, plane, cfg->chroma_site, cfg->out_width, cfg->out_height),
        .src_width = l1l2_image_plane_size(cfg->in_width, sub_x),
        .src_height = l1l2_image_plane_size(cfg->in_height, sub_y),
        .width = l1l2_image_plane_size(cfg->out_width, sub_x),
        .height = l1l2_image_plane_size(cfg->out_height, sub_y),
        .sample_bytes = components * l1l2_image_format_bytes(format),
        .scanline_run = format->depth == 8 ? l1l2_warp_scanline_run(functions, taps, components) : NULL,
        .direct_run = l1l2_warp_direct_run(functions, taps, components, format->depth),
    };
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
    if (!prepare_packed(w)) {
        l1l2_warp_free(w);
        return L1L2STAB_ERR_NOMEM;
    }
    L1L2WarpFunctions functions;
    l1l2_warp_functions_init(&functions, cfg->plain ? L1L2_CPU_PLAIN : l1l2_cpu_features());
    w->generators = functions.generators;
    l1l2_warp_kernel_init(&w->kernel, cfg->interpolation);
    for (int i = 0; i < w->cfg.format->planes; i++)
        w->plane[i] = lay_out_plane(&w->cfg, &functions, w->kernel.taps, i);
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
    const unsigned features = l1l2_cpu_features();
    return features & L1L2_CPU_AVX2 ? "avx2" : features & L1L2_CPU_NEON ? "neon" : "none";
}

/* Finds out whether the map moves all samples by the same whole step. It is enough to test the four corners: the
 * distance of a position from a whole step is linear along rows and columns before it is cut to phases, so it is
 * extreme at the corners. */
static void find_step(PlaneJob *job)
{
    for (int corner = 0; corner < 4; corner++) {
        const int u = corner % 2 ? job->layout->width - 1 : 0, v = corner / 2 ? job->layout->height - 1 : 0;
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

/* Copies samples. Weighing in phase 0 gives the same, except that it drops bits outside a component's depth. */
static void copy_band(const PlaneJob *job, int first, int end)
{
    const L1L2WarpPlane *src = &job->src;
    const int bytes = job->layout->sample_bytes, begin = job->part.left, stop = job->part.right;
    const int left = clamp(-job->step_x, begin, stop), right = clamp(src->width - job->step_x, left, stop);
    for (int v = first; v < end; v++) {
        const uint8_t *from = src->data + clamp(v + job->step_y, 0, src->height - 1) * src->stride;
        uint8_t *to = job->dst + v * job->dst_stride;
        repeat(to + begin * bytes, from, left - begin, bytes);
        if (right > left)
            memcpy(to + left * bytes, from + (left + job->step_x) * bytes, (size_t)((right - left) * bytes));
        repeat(to + right * bytes, from + (src->width - 1) * bytes, stop - right, bytes);
    }
}

/* While a run is rendered, source and output some rows further down are prefetched: tiles are too narrow for the
 * processor to predict these accesses. The address may lie outside the plane, so it is computed as a number. */
static void fetch(const PlaneJob *job, int column, int row)
{
    const ptrdiff_t offset = (row + ROWS_AHEAD) * job->src.stride + (ptrdiff_t)column * job->layout->sample_bytes;
    L1L2_PREFETCH((uintptr_t)job->src.data + (uintptr_t)offset, 0);
}

static void fetch_output(const PlaneJob *job, int u, int v, int count)
{
    if (v + ROWS_AHEAD < job->layout->height)
        for (int i = 0; i < count * job->layout->sample_bytes; i += CACHE_LINE)
            L1L2_PREFETCH(job->dst + (v + ROWS_AHEAD) * job->dst_stride + u * job->layout->sample_bytes + i, 1);
}

/* Fetches every cache line along the scanline, that of its last column too. */
static void fetch_scanline(const PlaneJob *job, const L1L2WarpScanline *scanline)
{
    const int step = CACHE_LINE / job->layout->sample_bytes;
    for (int k = 0; k < scanline->down_pieces; k++) {
        const L1L2WarpPiece *piece = &scanline->down[k];
        const int end = k + 1 < scanline->down_pieces ? piece[1].from : scanline->columns + step - 1;
        for (int i = piece->from; i < end; i += step) {
            const int column = job->kernel->taps > 2
                ? i : l1l2_warp_piece_position(&scanline->along[k], i) >> L1L2_WARP_PHASE_BITS;
            fetch(job, scanline->first + column, l1l2_warp_piece_position(piece, i) >> L1L2_WARP_PHASE_BITS);
        }
    }
}

/* Renders samples u .. u + count - 1 of row v. cells: those of the run, if the map is a mesh. */
static void render_run(const PlaneJob *job, const L1L2WarpCells *cells, int u, int v, int count)
{
    const PlaneLayout *layout = job->layout;
    const int taps = job->kernel->taps;
    uint8_t *dst = job->dst + v * job->dst_stride + u * layout->sample_bytes;
    L1L2WarpScanline scanline;
    fetch_output(job, u, v, count);
    if (layout->scanline_run &&
        (job->mesh.mesh ? l1l2_warp_mesh_scanline(&job->mesh, cells, taps, v, &scanline)
                        : l1l2_warp_affine_scanline(&job->affine, taps, u, v, count, &scanline))) {
        fetch_scanline(job, &scanline);
        layout->scanline_run(&job->src, job->kernel, &scanline, dst);
        return;
    }
    int32_t x[L1L2_WARP_RUN_SAMPLES + L1L2_WARP_RUN_SLACK], y[L1L2_WARP_RUN_SAMPLES + L1L2_WARP_RUN_SLACK];
    if (job->mesh.mesh)
        job->generators->mesh(&job->mesh, cells, v, x, y);
    else
        job->generators->affine(&job->affine, u, v, count, x, y);
    for (int i = 0; i < count; i += CACHE_LINE / layout->sample_bytes)
        fetch(job, x[i] >> L1L2_WARP_PHASE_BITS, y[i] >> L1L2_WARP_PHASE_BITS);
    layout->direct_run(&job->src, job->kernel, x, y, count, dst);
}

/* Renders a band tile by tile. A tile is only so wide that the source rows which a turned output row reads fit the
 * first-level cache. The cells of its runs are the same for all rows. */
static void render_band(const PlaneJob *job, int first, int end)
{
    for (int tile = job->part.left; tile < job->part.right; tile += TILE_RUNS * L1L2_WARP_RUN_SAMPLES) {
        L1L2WarpCells cells[TILE_RUNS];
        int from[TILE_RUNS + 1] = {tile}, runs = 0;
        for (; runs < TILE_RUNS && from[runs] < job->part.right; runs++) {
            const int left = job->part.right - from[runs];
            from[runs + 1] = from[runs] + (left < L1L2_WARP_RUN_SAMPLES ? left : L1L2_WARP_RUN_SAMPLES);
            if (job->mesh.mesh)
                cells[runs] = l1l2_warp_mesh_cells(&job->mesh, from[runs], from[runs + 1] - from[runs]);
        }
        for (int v = first; v < end; v++)
            for (int k = 0; k < runs; k++)
                render_run(job, &cells[k], from[k], v, from[k + 1] - from[k]);
    }
}

/* index: of a band, counted through all parts of all planes. */
static void render_band_of(void *context, int index)
{
    const FrameJob *job = context;
    const PlaneJob *plane = job->plane;
    for (; index >= plane->bands; plane++)
        index -= plane->bands;
    const int rows = plane->band_rows, first = plane->part.top + index * rows, bottom = plane->part.bottom;
    const int end = first + rows < bottom ? first + rows : bottom;
    if (plane->copies)
        copy_band(plane, first, end);
    else
        render_band(plane, first, end);
}

L1L2WarpRect l1l2_warp_rect_samples(const L1L2WarpRect *pixels, int log2_sub_x, int log2_sub_y)
{
    return (L1L2WarpRect){pixels->left >> log2_sub_x, pixels->top >> log2_sub_y,
                          l1l2_image_plane_size(pixels->right, log2_sub_x),
                          l1l2_image_plane_size(pixels->bottom, log2_sub_y)};
}

/* A part may have few rows: it has eight bands at least, as long as they are not too low. */
static void share_rows(PlaneJob *job)
{
    const int rows = job->part.bottom - job->part.top;
    job->band_rows = clamp((rows + 7) / 8, FEWEST_ROWS, BAND_ROWS);
    job->bands = rows > 0 && job->part.right > job->part.left ? (rows + job->band_rows - 1) / job->band_rows : 0;
}

static PlaneJob plane_job(const L1L2Warp *w, int plane, const L1L2WarpMap *map)
{
    const PlaneLayout *layout = &w->plane[plane];
    PlaneJob job = {
        .layout = layout,
        .generators = &w->generators,
        .kernel = &w->kernel,
        .affine = l1l2_warp_affine(&map->affine, &layout->dst_grid, &layout->src_grid),
        .mesh = {map->mesh, layout->dst_grid, layout->src_grid},
    };
    if (!map->mesh)
        find_step(&job);
    return job;
}

static void render_planes(L1L2Warp *w, const L1L2WarpMap *map, const L1L2WarpParts *parts,
                          const uint8_t *const src[4], const ptrdiff_t src_stride[4], uint8_t *const dst[4],
                          const ptrdiff_t dst_stride[4])
{
    const L1L2FormatInfo *format = w->cfg.format;
    FrameJob job;
    int bands = 0;
    for (int i = 0; i < format->planes; i++) {
        const PlaneLayout *layout = &w->plane[i];
        PlaneJob plane = plane_job(w, i, map);
        plane.src = (L1L2WarpPlane){src[i], src_stride[i], layout->src_width, layout->src_height, format->depth,
                                    format->shift};
        plane.dst = dst[i];
        plane.dst_stride = dst_stride[i];
        for (int k = 0; k < parts->count; k++) {
            plane.part = l1l2_warp_rect_samples(&parts->rect[k], format->plane[i].log2_sub_x,
                                                format->plane[i].log2_sub_y);
            share_rows(&plane);
            job.plane[i * parts->count + k] = plane;
            bands += plane.bands;
        }
    }
    l1l2_pool_run(w->cfg.pool, bands, render_band_of, &job);
}

void l1l2_warp_render_parts(L1L2Warp *w, const L1L2WarpMap *map, const L1L2WarpParts *parts,
                            const uint8_t *const src[4], const ptrdiff_t src_stride[4], uint8_t *const dst[4],
                            const ptrdiff_t dst_stride[4])
{
    if (!w->packed) {
        render_planes(w, map, parts, src, src_stride, dst, dst_stride);
        return;
    }
    l1l2_warp_packed422_split(w->cfg.pool, w->packed, src[0], src_stride[0], &w->in);
    render_planes(w, map, parts, (const uint8_t *const *)w->in.data, w->in.stride, w->out.data, w->out.stride);
    l1l2_warp_packed422_merge(w->cfg.pool, w->packed, &w->out, dst[0], dst_stride[0]);
}

void l1l2_warp_render(L1L2Warp *w, const L1L2WarpMap *map, const uint8_t *const src[4], const ptrdiff_t src_stride[4],
                      uint8_t *const dst[4], const ptrdiff_t dst_stride[4])
{
    const L1L2WarpParts all = {1, {{0, 0, w->cfg.out_width, w->cfg.out_height}}};
    l1l2_warp_render_parts(w, map, &all, src, src_stride, dst, dst_stride);
}
