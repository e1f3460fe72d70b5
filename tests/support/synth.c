/* SPDX-License-Identifier: MIT */
/*
 * The renderer. A sample is a bilinear lookup in a tile at a position that steps evenly along the row; positions are
 * 32 bit fixed-point numbers whose overflow is the tile's repetition. Every row has the camera of its own time.
 */
#include "synth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "synth_path.h"
#include "synth_scene.h"

enum {
    NOISE_SIZE = 1 << 16,
    CHUNK = 256 /* samples that are rendered at once into the stack */
};

static const double two_pi = 6.283185307179586;

struct Synth {
    SynthConfig cfg;
    SynthScene scene;
    int8_t *noise; /* NULL without noise */
};

/* A plane's place among the frame's pixels: sample i lies at pixel i * step + offset. */
typedef struct Axis {
    double step, offset;
} Axis;

typedef struct View {
    const Synth *s;
    double M[9];       /* of the row that is rendered */
    int width, height; /* pixels */
    int t;             /* frame; -1: at M throughout, neither noise nor foreground */
    double object_x, object_y, object_radius; /* the foreground's disc, px; the radius is 0 without it */
} View;

SynthConfig synth_defaults(void)
{
    return (SynthConfig){.width = 640, .height = 360, .fps = 30.0, .shake = 4.0, .roll = 0.005, .seed = 1};
}

Synth *synth_new(const SynthConfig *cfg)
{
    Synth *s = synth_alloc(1, sizeof *s);
    s->cfg = *cfg;
    synth_scene_init(&s->scene, cfg->seed);
    if (cfg->noise > 0.0) {
        s->noise = synth_alloc(NOISE_SIZE, 1);
        for (uint64_t i = 0; i < NOISE_SIZE; i++) { /* Box and Muller */
            const double radius = sqrt(-2.0 * log(1.0 - synth_fraction(cfg->seed + 2 * i)));
            const double v = cfg->noise * radius * cos(two_pi * synth_fraction(cfg->seed + 2 * i + 1));
            s->noise[i] = (int8_t)lrint(fmin(fmax(v, -127.0), 127.0));
        }
    }
    return s;
}

void synth_free(Synth *s)
{
    if (!s)
        return;
    synth_scene_clear(&s->scene);
    free(s->noise);
    free(s);
}

void synth_camera_at(const Synth *s, double frames, double M[9])
{
    synth_path_pose(&s->cfg, frames, M);
}

void synth_camera(const Synth *s, int t, double M[9])
{
    synth_camera_at(s, t, M);
}

double synth_row_time(const Synth *s, int t, double y)
{
    return t + s->cfg.readout * s->cfg.fps * y / s->cfg.height;
}

void synth_motion(const Synth *s, int t, double F[9])
{
    double M[9], N[9];
    synth_camera(s, t, M);
    synth_camera(s, t > 0 ? t - 1 : 0, N);
    const double norm = N[0] * N[0] + N[3] * N[3];
    const double c = N[0] / norm, d = -N[3] / norm; /* the inverse's rotation and scale */
    const double x = M[2] - N[2], y = M[5] - N[5];
    const double a = c * M[0] - d * M[3], b = d * M[0] + c * M[3];
    memcpy(F, (double[9]){a, -b, c * x - d * y, b, a, d * x + c * y, 0.0, 0.0, 1.0}, 9 * sizeof *F);
}

/* n samples of a tile from scene position (x, y) px on, in steps of (dx, dy) px. */
static void lookup(const SynthTile *tile, double x, double y, double dx, double dy, int n, uint8_t *out)
{
    const int bits = tile->log2_size, shift = 32 - bits;
    const uint32_t mask = (1u << bits) - 1u;
    const double turn = 0x1p32 / SYNTH_SCENE_PX; /* the tile's width is 2^32 */
    const double centre = (double)(1u << (shift - 1)); /* texel centres are at half-integers too */
    uint32_t u = (uint32_t)(int64_t)floor(fmod(x, SYNTH_SCENE_PX) * turn - centre);
    uint32_t v = (uint32_t)(int64_t)floor(fmod(y, SYNTH_SCENE_PX) * turn - centre);
    const uint32_t du = (uint32_t)(int64_t)floor(dx * turn + 0.5), dv = (uint32_t)(int64_t)floor(dy * turn + 0.5);
    for (int i = 0; i < n; i++, u += du, v += dv) {
        const uint32_t x0 = u >> shift, x1 = (x0 + 1u) & mask, fx = (u >> (shift - 11)) & 2047u;
        const uint32_t y0 = v >> shift, y1 = (y0 + 1u) & mask, fy = (v >> (shift - 11)) & 2047u;
        const uint16_t *r0 = tile->texel + ((size_t)y0 << bits), *r1 = tile->texel + ((size_t)y1 << bits);
        const uint32_t top = (r0[x0] * (2048u - fx) + r0[x1] * fx) >> 7;
        const uint32_t bottom = (r1[x0] * (2048u - fx) + r1[x1] * fx) >> 7;
        out[i] = (uint8_t)((top * (2048u - fy) + bottom * fy + (1u << 21)) >> 22);
    }
}

/* Set the camera for row j. */
static void aim(View *view, Axis ay, int j)
{
    const Synth *s = view->s;
    if (view->t >= 0 && s->cfg.readout > 0.0)
        synth_camera_at(s, synth_row_time(s, view->t, j * ay.step + ay.offset - 0.5 * view->height), view->M);
}

/* Samples [i0, i1) of row j, all of the camera's scene or all of the object. */
static void render_part(const View *view, const SynthTile *tile, Axis ax, Axis ay, int j, int i0, int i1, int object,
                        uint8_t *out)
{
    const double x = i0 * ax.step + ax.offset - 0.5 * view->width;
    const double y = j * ay.step + ay.offset - 0.5 * view->height;
    if (object)
        lookup(tile, x - view->object_x + 300.0, y - view->object_y + 500.0, ax.step, 0.0, i1 - i0, out);
    else
        lookup(tile, view->M[0] * x + view->M[1] * y + view->M[2], view->M[3] * x + view->M[4] * y + view->M[5],
               view->M[0] * ax.step, view->M[3] * ax.step, i1 - i0, out);
}

static int clamp(int v, int low, int high)
{
    return v < low ? low : v > high ? high : v;
}

/* Samples [i0, i1) of row j of one of the three components: 0 luma, 1 and 2 chroma. */
static void render_run(const View *view, int component, Axis ax, Axis ay, int j, int i0, int i1, uint8_t *out)
{
    const SynthTile *tile = component ? &view->s->scene.chroma[component - 1] : &view->s->scene.luma;
    const double y = j * ay.step + ay.offset - 0.5 * view->height - view->object_y;
    const double chord = view->object_radius * view->object_radius - y * y;
    int from = i1, to = i1; /* the object's part */
    if (chord > 0.0) {
        const double middle = 0.5 * view->width + view->object_x - ax.offset;
        from = clamp((int)ceil((middle - sqrt(chord)) / ax.step), i0, i1);
        to = clamp((int)ceil((middle + sqrt(chord)) / ax.step), i0, i1);
    }
    render_part(view, tile, ax, ay, j, i0, from, 0, out);
    render_part(view, tile, ax, ay, j, from, to, 1, out + (from - i0));
    render_part(view, tile, ax, ay, j, to, i1, 0, out + (to - i0));
    if (component || !view->s->noise || view->t < 0)
        return;
    const uint64_t start = synth_hash(((uint64_t)view->t << 20) + (uint64_t)j) + (uint64_t)i0;
    for (int i = 0; i < i1 - i0; i++)
        out[i] = (uint8_t)clamp(out[i] + view->s->noise[(start + (uint64_t)i) % NOISE_SIZE], 0, 255);
}

/* `components` of the three, interleaved; first, second: which. */
static void render_plane(View *view, int first, int second, Axis ax, Axis ay, int columns, int rows,
                         uint8_t *data, ptrdiff_t stride)
{
    uint8_t a[CHUNK], b[CHUNK];
    for (int j = 0; j < rows; j++) {
        uint8_t *row = data + j * stride;
        aim(view, ay, j);
        for (int i0 = 0; i0 < columns; i0 += CHUNK) {
            const int i1 = i0 + CHUNK < columns ? i0 + CHUNK : columns;
            if (second < 0) {
                render_run(view, first, ax, ay, j, i0, i1, row + i0);
                continue;
            }
            render_run(view, first, ax, ay, j, i0, i1, a);
            render_run(view, second, ax, ay, j, i0, i1, b);
            for (int i = 0; i < i1 - i0; i++) {
                row[2 * (i0 + i)] = a[i];
                row[2 * (i0 + i) + 1] = b[i];
            }
        }
    }
}

/* Full-range BT.601: the grey of R, G, B is the luma again. */
static void render_packed(View *view, int bytes, int red, uint8_t *data, ptrdiff_t stride)
{
    const Axis unit = {1.0, 0.5};
    uint8_t yuv[3][CHUNK];
    for (int j = 0; j < view->height; j++) {
        aim(view, unit, j);
        for (int i0 = 0; i0 < view->width; i0 += CHUNK) {
            const int i1 = i0 + CHUNK < view->width ? i0 + CHUNK : view->width;
            for (int c = 0; c < 3; c++)
                render_run(view, c, unit, unit, j, i0, i1, yuv[c]);
            uint8_t *p = data + j * stride + (ptrdiff_t)bytes * i0;
            for (int i = 0; i < i1 - i0; i++, p += bytes) {
                const int y = yuv[0][i] * 1000 + 500, u = yuv[1][i] - 128, v = yuv[2][i] - 128;
                p[red] = (uint8_t)(clamp(y + 1402 * v, 0, 255999) / 1000);
                p[1] = (uint8_t)(clamp(y - 344 * u - 714 * v, 0, 255999) / 1000);
                p[2 - red] = (uint8_t)(clamp(y + 1772 * u, 0, 255999) / 1000);
                if (bytes == 4)
                    p[3] = 255;
            }
        }
    }
}

/* One row a format: bytes a pixel of a packed one and where its red is; else the chroma planes. */
typedef struct Layout {
    int planes;
    int packed, red;      /* packed: bytes a pixel, 0 = planar */
    int first[3], second[3]; /* components of each plane, second -1 = not interleaved */
    int sub_x, sub_y;     /* log2, of the chroma */
} Layout;

static Layout layout_of(L1L2StabFormat format)
{
    switch (format) {
    case L1L2STAB_FORMAT_GRAY8: return (Layout){1, 0, 0, {0}, {-1}, 0, 0};
    case L1L2STAB_FORMAT_I420: return (Layout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 1};
    case L1L2STAB_FORMAT_YV12: return (Layout){3, 0, 0, {0, 2, 1}, {-1, -1, -1}, 1, 1};
    case L1L2STAB_FORMAT_NV12: return (Layout){2, 0, 0, {0, 1}, {-1, 2}, 1, 1};
    case L1L2STAB_FORMAT_NV21: return (Layout){2, 0, 0, {0, 2}, {-1, 1}, 1, 1};
    case L1L2STAB_FORMAT_Y42B: return (Layout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 1, 0};
    case L1L2STAB_FORMAT_Y444: return (Layout){3, 0, 0, {0, 1, 2}, {-1, -1, -1}, 0, 0};
    case L1L2STAB_FORMAT_BGRX:
    case L1L2STAB_FORMAT_BGRA: return (Layout){1, 4, 2, {0}, {-1}, 0, 0};
    case L1L2STAB_FORMAT_RGBX:
    case L1L2STAB_FORMAT_RGBA: return (Layout){1, 4, 0, {0}, {-1}, 0, 0};
    case L1L2STAB_FORMAT_BGR: return (Layout){1, 3, 2, {0}, {-1}, 0, 0};
    case L1L2STAB_FORMAT_RGB: return (Layout){1, 3, 0, {0}, {-1}, 0, 0};
    case L1L2STAB_FORMAT_UNKNOWN: break;
    }
    abort();
}

static Axis chroma_axis(int log2_sub, int centred)
{
    if (!log2_sub)
        return (Axis){1.0, 0.5};
    return (Axis){2.0, centred ? 1.0 : 0.5};
}

static void render_view(View *view, L1L2StabFormat format, uint8_t *const data[4], const ptrdiff_t stride[4])
{
    const Layout layout = layout_of(format);
    const L1L2StabChromaSite site = view->s->cfg.chroma_site;
    if (layout.packed) {
        render_packed(view, layout.packed, layout.red, data[0], stride[0]);
        return;
    }
    for (int p = 0; p < layout.planes; p++) {
        const int sx = p ? layout.sub_x : 0, sy = p ? layout.sub_y : 0;
        render_plane(view, layout.first[p], layout.second[p], chroma_axis(sx, site == L1L2STAB_CHROMA_SITE_CENTER),
                     chroma_axis(sy, site != L1L2STAB_CHROMA_SITE_TOP_LEFT), (view->width + sx) >> sx,
                     (view->height + sy) >> sy, data[p], stride[p]);
    }
}

void synth_render(const Synth *s, int t, L1L2StabFormat format, uint8_t *const data[4], const ptrdiff_t stride[4])
{
    const SynthConfig *cfg = &s->cfg;
    const double size = sqrt((double)cfg->width * cfg->height);
    View view = {.s = s, .width = cfg->width, .height = cfg->height, .t = t};
    synth_camera(s, t, view.M);
    view.object_radius = size * sqrt(cfg->foreground * 2.0 / two_pi);
    view.object_x = 0.12 * size * sin(0.13 * t);
    view.object_y = 0.05 * size * cos(0.11 * t);
    render_view(&view, format, data, stride);
}

void synth_render_gray(const Synth *s, int t, uint8_t *data, ptrdiff_t stride)
{
    synth_render(s, t, L1L2STAB_FORMAT_GRAY8, (uint8_t *const[4]){data}, (const ptrdiff_t[4]){stride});
}

void synth_render_view(const Synth *s, const double M[9], int width, int height, L1L2StabFormat format,
                       uint8_t *const data[4], const ptrdiff_t stride[4])
{
    View view = {.s = s, .width = width, .height = height, .t = -1};
    memcpy(view.M, M, sizeof view.M);
    render_view(&view, format, data, stride);
}

SynthPicture synth_picture_new(L1L2StabFormat format, int width, int height)
{
    const Layout layout = layout_of(format);
    SynthPicture p = {.format = format, .width = width, .height = height, .planes = layout.planes};
    for (int i = 0; i < p.planes; i++) {
        const int sx = i ? layout.sub_x : 0, sy = i ? layout.sub_y : 0;
        const int bytes = layout.packed ? layout.packed : layout.second[i] < 0 ? 1 : 2;
        p.stride[i] = (ptrdiff_t)bytes * ((width + sx) >> sx);
        p.rows[i] = (height + sy) >> sy;
        p.size += (size_t)p.stride[i] * (size_t)p.rows[i];
    }
    uint8_t *at = synth_alloc(p.size, 1);
    for (int i = 0; i < p.planes; i++) {
        p.data[i] = at;
        at += p.stride[i] * p.rows[i];
    }
    return p;
}

void synth_picture_free(SynthPicture *p)
{
    free(p->data[0]);
    *p = (SynthPicture){0};
}
