/* SPDX-License-Identifier: MIT */
/*
 * The filled border against the truth: a clip is cropped by 8 % at each side, stabilized with border=fill, and each
 * pixel that a neighbor gave is compared with the uncropped frame under the same map.
 *
 *   all                     PSNR (dB) of the luma on all pixels that the frame itself does not show
 *   fill, nearest, mirror   the same on those that a neighbor gave: as filled; from the nearest frame that shows the
 *                           pixel by the chained motions; and the frame mirrored at its sides
 *   SSIM                    as filled, mirrored: structural similarity around these pixels (Wang et al., 2004; 7x7)
 *   filled, extended        parts of the output, %: mean, and the worst frame's extended part
 *   flicker                 temporal change of pixels that are filled in two frames in a row, by the truth's
 *   slopes                  gradient energy of filled pixels, by the truth's
 *   seam                    the change from pixel to pixel where the frame ends, by that 4 pixels beside it
 *   CPU                     of one frame, with tracking, ms: border=crop and border=fill
 *
 * usage: gst-launch-1.0 -q filesrc location=CLIP ! decodebin ! videoconvert ! video/x-raw,format=I420 ! fdsink |
 *        bench_border WIDTH HEIGHT [FRAMES]             (WIDTH a multiple of 8: rows without padding)
 *        bench_border planar | depth | movers           a rendered scene, 640x360, 90 frames, noise 5: one plane;
 *                                                       nearer layers that move up to 1.5 times as far; walkers
 */
#include <l1l2stab/l1l2stab.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "synth.h"
#include "warp/warp.h"

static const double held_out = 0.08, crop_ratio = 0.85;

typedef struct Clip {
    int width, height, frames;   /* as filmed */
    int left, top, in_width, in_height; /* what the stabilizer sees */
    size_t size;
    uint8_t *data;
} Clip;

typedef struct Planes {
    uint8_t *data[4];
    ptrdiff_t stride[4];
} Planes;

/* What came out for one frame. */
typedef struct Output {
    uint8_t *fill, *provider;
    L1L2StabInfo info;
} Output;

static void *must(void *memory)
{
    if (!memory)
        exit(EXIT_FAILURE);
    return memory;
}

static Planes planes_of(uint8_t *data, int width, int height)
{
    const size_t luma = (size_t)width * (size_t)height;
    return (Planes){{data, data + luma, data + luma + luma / 4}, {width, width / 2, width / 2}};
}

static Planes cropped(const Clip *clip, int t)
{
    Planes p = planes_of(clip->data + (size_t)t * clip->size, clip->width, clip->height);
    p.data[0] += clip->top * p.stride[0] + clip->left;
    p.data[1] += clip->top / 2 * p.stride[1] + clip->left / 2;
    p.data[2] += clip->top / 2 * p.stride[2] + clip->left / 2;
    return p;
}

static void hold_out(Clip *clip)
{
    clip->left = (int)(clip->width * held_out) / 4 * 4;
    clip->top = (int)(clip->height * held_out) / 4 * 4;
    clip->in_width = clip->width - 2 * clip->left;
    clip->in_height = clip->height - 2 * clip->top;
}

static void read_clip(Clip *clip, int most, FILE *in)
{
    clip->size = (size_t)clip->width * (size_t)clip->height * 3 / 2;
    clip->data = must(malloc(clip->size * (size_t)most));
    for (uint8_t *to = clip->data; clip->frames < most && fread(to, 1, clip->size, in) == clip->size; to += clip->size)
        clip->frames++;
    hold_out(clip);
}

static void render_clip(Clip *clip, const char *scene)
{
    SynthConfig cfg = synth_defaults();
    cfg.width = clip->width = 640;
    cfg.height = clip->height = 360;
    cfg.noise = 5.0;
    cfg.shake = 8.0;
    if (!strcmp(scene, "depth")) {
        cfg.parallax = 0.5;
    } else if (!strcmp(scene, "movers")) {
        cfg.movers = 4;
        cfg.foreground = 0.2;
        cfg.mover_speed = 4.0;
    } else if (strcmp(scene, "planar") != 0) {
        fprintf(stderr, "there is no scene \"%s\": planar, depth or movers\n", scene);
        exit(EXIT_FAILURE);
    }
    Synth *synth = synth_new(&cfg);
    clip->frames = 90;
    clip->size = (size_t)clip->width * (size_t)clip->height * 3 / 2;
    clip->data = must(malloc(clip->size * (size_t)clip->frames));
    for (int t = 0; t < clip->frames; t++) {
        const Planes p = planes_of(clip->data + (size_t)t * clip->size, clip->width, clip->height);
        synth_render(synth, t, L1L2STAB_FORMAT_I420, p.data, p.stride);
    }
    synth_free(synth);
    hold_out(clip);
}

/* Returns the CPU time of all threads, ms a frame. */
static double stabilize(const Clip *clip, L1L2StabBorder border, Output *outputs)
{
    const size_t pixels = (size_t)clip->in_width * (size_t)clip->in_height;
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = clip->in_width;
    cfg.height = clip->in_height;
    cfg.crop_ratio = crop_ratio;
    cfg.rolling_shutter = L1L2STAB_ROLLING_SHUTTER_NONE;
    cfg.border = border;
    L1L2Stab *s;
    if (l1l2stab_create(&s, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    const clock_t start = clock();
    int pulled = 0;
    for (int t = 0; t <= clip->frames; t++) {
        if (t < clip->frames) {
            const Planes in = cropped(clip, t);
            L1L2StabFrame frame = {.pts = L1L2STAB_NO_PTS};
            memcpy(frame.data, in.data, sizeof in.data);
            memcpy(frame.stride, in.stride, sizeof in.stride);
            if (l1l2stab_push(s, &frame) != L1L2STAB_OK)
                exit(EXIT_FAILURE);
        } else {
            l1l2stab_finish(s);
        }
        for (;;) {
            if (pulled >= clip->frames)
                break;
            Output *o = &outputs[pulled];
            uint8_t *picture = must(malloc(pixels * 3 / 2));
            const Planes out = planes_of(picture, clip->in_width, clip->in_height);
            L1L2StabFrame frame = {0};
            memcpy(frame.data, out.data, sizeof out.data);
            memcpy(frame.stride, out.stride, sizeof out.stride);
            if (l1l2stab_pull(s, &frame, &o->info) != L1L2STAB_OK) {
                free(picture);
                break;
            }
            if (border == L1L2STAB_BORDER_CROP) {
                free(picture);
            } else {
                o->fill = picture;
                o->provider = must(malloc(pixels));
                l1l2stab_border_map(s, o->provider, clip->in_width);
            }
            pulled++;
        }
    }
    l1l2stab_free(&s);
    return 1e3 * (double)(clock() - start) / CLOCKS_PER_SEC / clip->frames;
}

typedef struct Sums {
    double fill, nearest, mirror, all; /* squared errors */
    double ssim[2];                    /* as filled, mirrored */
    long judged, nearest_judged, all_judged;
    double flicker[2], slopes[2], seam[2];
    double filled, extended, worst;
} Sums;

static L1L2Mat to_mat(const double m[9])
{
    L1L2Mat mat;
    memcpy(mat.m, m, sizeof mat.m);
    return mat;
}

static void warp_luma(L1L2Warp *warp, L1L2Mat map, const uint8_t *src, int stride, uint8_t *dst, int width)
{
    const L1L2WarpMap how = {.affine = map};
    const uint8_t *const from[4] = {src};
    const ptrdiff_t from_stride[4] = {stride}, to_stride[4] = {width};
    uint8_t *const to[4] = {dst};
    l1l2_warp_render(warp, &how, from, from_stride, to, to_stride);
}

static L1L2Warp *luma_warp(int in_width, int in_height, int out_width, int out_height)
{
    const L1L2WarpConfig cfg = {
        .format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .in_width = in_width, .in_height = in_height,
        .out_width = out_width, .out_height = out_height, .interpolation = L1L2STAB_INTERPOLATION_BICUBIC,
    };
    L1L2Warp *warp;
    if (l1l2_warp_create(&warp, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    return warp;
}

static int inside(L1L2Mat map, int x, int y, int out_width, int out_height, double half_w, double half_h)
{
    const L1L2Point p = l1l2_mat_apply(&map, (L1L2Point){x + 0.5 - 0.5 * out_width, y + 0.5 - 0.5 * out_height});
    return fabs(p.x) <= half_w && fabs(p.y) <= half_h;
}

/* The pixels that a neighbor gave, from the nearest frame that shows them by the chained motions; 1 in `known` where
 * there is one. */
static void fill_nearest(const Clip *clip, const Output *outputs, int t, L1L2Warp *warp, uint8_t *dst, uint8_t *known)
{
    const int w = clip->in_width, h = clip->in_height;
    uint8_t *layer = must(malloc((size_t)w * (size_t)h));
    L1L2Mat chain[2] = {l1l2_mat_identity(), l1l2_mat_identity()}, inverse;
    const L1L2Mat own = to_mat(outputs[t].info.warp);
    memset(known, 0, (size_t)w * (size_t)h);
    int broken[2] = {0, 0};
    long left = 1;
    for (int d = 1; d <= 30 && left > 0; d++)
        for (int ahead = 0; ahead < 2; ahead++) {
            const int k = ahead ? t + d : t - d, link = ahead ? k : k + 1;
            if (k < 0 || k >= clip->frames || broken[ahead])
                continue;
            broken[ahead] = outputs[link].info.path_index == 0;
            const L1L2Mat F = to_mat(outputs[link].info.F);
            if (ahead)
                l1l2_mat_inverse(F, &inverse);
            chain[ahead] = l1l2_mat_mul(ahead ? inverse : F, chain[ahead]);
            const L1L2Mat map = l1l2_mat_mul(chain[ahead], own);
            const Planes p = cropped(clip, k);
            warp_luma(warp, map, p.data[0], clip->width, layer, w);
            left = 0;
            for (int y = 0; y < h; y++)
                for (int x = 0; x < w; x++) {
                    const int i = y * w + x;
                    if (known[i] || outputs[t].provider[i] == 0)
                        continue;
                    if (inside(map, x, y, w, h, 0.5 * w, 0.5 * h)) {
                        dst[i] = layer[i];
                        known[i] = 1;
                    } else {
                        left++;
                    }
                }
        }
    free(layer);
}

static double square(double x)
{
    return x * x;
}

/* Adds what changes across the border between the frame and a neighbor, if it is between pixel i and the next one, and
 * what changes 4 pixels on both sides of it. step: from pixel to pixel, along a row or a column. */
static void add_seam(const Output *o, int i, int step, Sums *sums)
{
    const uint8_t *p = o->fill + i;
    if ((o->provider[i] == 0) == (o->provider[i + step] == 0) || o->provider[i] == 255 || o->provider[i + step] == 255)
        return;
    sums->seam[0] += abs(p[step] - p[0]);
    sums->seam[1] += 0.5 * (abs(p[-3 * step] - p[-4 * step]) + abs(p[5 * step] - p[4 * step]));
}

static int reflected(int at, int size)
{
    at = at < 0 ? -1 - at : at >= size ? 2 * size - 1 - at : at;
    return at < 0 ? 0 : at < size ? at : size - 1;
}

/* The picture as filled, with the cropped frame mirrored at its sides in place of what neighbors gave. */
static void mirror(const Clip *clip, const Output *o, int t, uint8_t *dst)
{
    const int w = clip->in_width, h = clip->in_height;
    const L1L2Mat map = to_mat(o->info.warp);
    const Planes in = cropped(clip, t);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            const L1L2Point p = l1l2_mat_apply(&map, (L1L2Point){x + 0.5 - 0.5 * w, y + 0.5 - 0.5 * h});
            const int u = reflected((int)floor(p.x + 0.5 * w), w), v = reflected((int)floor(p.y + 0.5 * h), h);
            dst[y * w + x] = o->provider[y * w + x] == 0 ? o->fill[y * w + x] : in.data[0][v * in.stride[0] + u];
        }
}

/* The structural similarity of two pictures around a pixel. */
static double ssim_at(const uint8_t *a, const uint8_t *b, int width)
{
    const double c1 = square(0.01 * 255.0), c2 = square(0.03 * 255.0), n = 49.0;
    double sa = 0.0, sb = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
    for (int y = -3; y <= 3; y++)
        for (int x = -3; x <= 3; x++) {
            const double p = a[y * width + x], q = b[y * width + x];
            sa += p, sb += q, aa += p * p, bb += q * q, ab += p * q;
        }
    const double ma = sa / n, mb = sb / n, va = aa / n - ma * ma, vb = bb / n - mb * mb, cov = ab / n - ma * mb;
    return (2.0 * ma * mb + c1) * (2.0 * cov + c2) / ((ma * ma + mb * mb + c1) * (va + vb + c2));
}

static void judge(const Clip *clip, const Output *outputs, Sums *sums)
{
    const int w = clip->in_width, h = clip->in_height;
    const size_t pixels = (size_t)w * (size_t)h;
    uint8_t *truth[2] = {must(malloc(pixels)), must(malloc(pixels))}, *nearest = must(malloc(pixels));
    uint8_t *known = must(malloc(pixels)), *mirrored = must(malloc(pixels));
    L1L2Warp *from_all = luma_warp(clip->width, clip->height, w, h), *from_cropped = luma_warp(w, h, w, h);
    for (int t = 0; t < clip->frames; t++) {
        const Output *o = &outputs[t];
        const L1L2Mat map = to_mat(o->info.warp);
        uint8_t *now = truth[t % 2], *before = truth[(t + 1) % 2];
        warp_luma(from_all, map, clip->data + (size_t)t * clip->size, clip->width, now, w);
        fill_nearest(clip, outputs, t, from_cropped, nearest, known);
        mirror(clip, o, t, mirrored);
        sums->filled += o->info.filled;
        sums->extended += o->info.extended;
        sums->worst = fmax(sums->worst, o->info.extended);
        for (int y = 4; y + 5 < h; y++)
            for (int x = 4; x + 5 < w; x++) {
                add_seam(o, y * w + x, 1, sums);
                add_seam(o, y * w + x, w, sums);
            }
        for (int y = 3; y + 3 < h; y++)
            for (int x = 3; x + 3 < w; x++) {
                const int i = y * w + x;
                if (o->provider[i] == 0 || !inside(map, x, y, w, h, 0.5 * clip->width, 0.5 * clip->height))
                    continue;
                sums->all += square(o->fill[i] - now[i]);
                sums->all_judged++;
                if (o->provider[i] == 255)
                    continue;
                sums->judged++;
                sums->fill += square(o->fill[i] - now[i]);
                sums->mirror += square(mirrored[i] - now[i]);
                sums->ssim[0] += ssim_at(o->fill + i, now + i, w);
                sums->ssim[1] += ssim_at(mirrored + i, now + i, w);
                if (known[i]) {
                    sums->nearest += square(nearest[i] - now[i]);
                    sums->nearest_judged++;
                }
                sums->slopes[0] += square(o->fill[i + 1] - o->fill[i - 1]) + square(o->fill[i + w] - o->fill[i - w]);
                sums->slopes[1] += square(now[i + 1] - now[i - 1]) + square(now[i + w] - now[i - w]);
                if (t > 0 && outputs[t - 1].provider[i] != 0 && outputs[t - 1].provider[i] != 255) {
                    sums->flicker[0] += abs(o->fill[i] - outputs[t - 1].fill[i]);
                    sums->flicker[1] += abs(now[i] - before[i]);
                }
            }
    }
    l1l2_warp_free(from_all);
    l1l2_warp_free(from_cropped);
    free(truth[0]);
    free(truth[1]);
    free(nearest);
    free(known);
    free(mirrored);
}

static double psnr(double squares, long count)
{
    return count > 0 ? 10.0 * log10(255.0 * 255.0 * (double)count / squares) : 0.0;
}

int main(int argc, char **argv)
{
    Clip clip = {0};
    Sums sums = {0};
    if (argc < 2) {
        printf("usage: ... raw I420 on standard input ... | %s WIDTH HEIGHT [FRAMES]\n"
               "       %s planar | depth | movers\n", argv[0], argv[0]);
        return EXIT_FAILURE;
    }
    if (argc == 2) {
        render_clip(&clip, argv[1]);
    } else {
        clip.width = atoi(argv[1]);
        clip.height = atoi(argv[2]);
        read_clip(&clip, argc > 3 ? atoi(argv[3]) : 200, stdin);
    }
    Output *outputs = must(calloc((size_t)clip.frames, sizeof *outputs));
    const double cropping = stabilize(&clip, L1L2STAB_BORDER_CROP, outputs);
    const double filling = stabilize(&clip, L1L2STAB_BORDER_FILL, outputs);
    judge(&clip, outputs, &sums);
    printf("all %.2f  fill %.2f  nearest %.2f  mirror %.2f dB | SSIM %.3f %.3f | filled %.2f  extended %.3f  "
           "worst %.2f %% | flicker %.2f  slopes %.2f  seam %.2f | judged %.2f Mpx | CPU %.1f and %.1f ms\n",
           psnr(sums.all, sums.all_judged), psnr(sums.fill, sums.judged),
           psnr(sums.nearest, sums.nearest_judged), psnr(sums.mirror, sums.judged),
           sums.ssim[0] / (double)sums.judged, sums.ssim[1] / (double)sums.judged,
           100.0 * sums.filled / clip.frames, 100.0 * sums.extended / clip.frames, 100.0 * sums.worst,
           sums.flicker[0] / fmax(sums.flicker[1], 1.0), sums.slopes[0] / fmax(sums.slopes[1], 1.0),
           sums.seam[0] / fmax(sums.seam[1], 1.0),
           (double)sums.judged * 1e-6, cropping, filling);
    for (int t = 0; t < clip.frames; t++) {
        free(outputs[t].fill);
        free(outputs[t].provider);
    }
    free(outputs);
    free(clip.data);
    return EXIT_SUCCESS;
}
