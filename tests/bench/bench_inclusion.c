/* SPDX-License-Identifier: MIT */
/*
 * Inclusion: whether a sample is ever taken from outside the source picture. Looks at every node of the mesh of every
 * frame of a clip, for crop ratios from 0.5 to 0.99, without step 4 and with it. Cells are bilinear: if all nodes are
 * inside, all samples are.
 *
 * usage: gst-launch-1.0 -q filesrc location=CLIP ! decodebin ! videoconvert ! video/x-raw,format=GRAY8 ! fdsink |
 *        bench_inclusion WIDTH HEIGHT [FRAMES_PER_SECOND]      (WIDTH a multiple of 4: rows without padding)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "motion/motion.h"
#include "path/path.h"
#include "rolling_shutter/filter.h"

enum { MODELS = 3, MAX_FRAMES = 10000, WINDOW = 150 };
static const double ratios[] = {0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99};
enum { RATIOS = sizeof ratios / sizeof *ratios };

typedef struct Clip {
    int width, height, frames;
    double frame_rate;
    L1L2MotionResult *motion[MODELS]; /* of each frame */
} Clip;

typedef struct Count {
    long frames, corrected, nodes, outside;
    double farthest; /* distance by which step 4 moved a node, px */
} Count;

static void *must(void *memory)
{
    if (!memory)
        exit(EXIT_FAILURE);
    return memory;
}

static void analyze(Clip *clip, FILE *in)
{
    const L1L2StabLogger log = {0};
    const size_t size = (size_t)clip->width * (size_t)clip->height;
    uint8_t *picture = must(malloc(size));
    L1L2Motion *motion[MODELS];
    for (int model = 0; model < MODELS; model++) {
        const L1L2MotionConfig cfg = {
            .format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .width = clip->width, .height = clip->height,
            .analysis_size = 640, .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .seed = 1, .log = &log,
            .rolling_shutter = (L1L2StabRollingShutter)model,
        };
        clip->motion[model] = must(calloc(MAX_FRAMES, sizeof *clip->motion[model]));
        if (l1l2_motion_create(&motion[model], &cfg) != L1L2STAB_OK)
            exit(EXIT_FAILURE);
    }
    for (; clip->frames < MAX_FRAMES && fread(picture, 1, size, in) == size; clip->frames++)
        for (int model = 0; model < MODELS; model++)
            if (l1l2_motion_push(motion[model], picture, clip->width, clip->frames == 0,
                                 &clip->motion[model][clip->frames]) != L1L2STAB_OK)
                exit(EXIT_FAILURE);
    for (int model = 0; model < MODELS; model++)
        l1l2_motion_free(motion[model]);
    free(picture);
}

static void check(const L1L2WarpMesh *mesh, double half_w, double half_h, Count *count)
{
    for (int i = 0; i < mesh->columns * mesh->rows; i++)
        count->outside += !(fabs(mesh->node[i].x) <= half_w && fabs(mesh->node[i].y) <= half_h);
    count->nodes += mesh->columns * mesh->rows;
}

static void run(const Clip *clip, int model, double ratio, Count *count)
{
    const L1L2StabLogger log = {0};
    const double diagonal_px = hypot(clip->width, clip->height), rounding_px = 1e-6;
    enum { ROWS = WINDOW + L1L2_SHUTTER_FILTER_PAST };
    static L1L2PathFrame rows[ROWS];
    static L1L2ShutterFrame filter_rows[ROWS];
    const L1L2PathConfig path_cfg = {
        .width = clip->width, .height = clip->height, .frame_rate = clip->frame_rate,
        .weights = {1, 1, 1}, .window = WINDOW, .overlap = 2 * WINDOW / 3, .log = &log,
        .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .frames = {rows, sizeof *rows, ROWS},
    };
    const L1L2ShutterFilterConfig filter_cfg = {(L1L2StabRollingShutter)model, clip->width, clip->height, clip->width,
                                                clip->height, WINDOW, NULL, {&rows[0].F, sizeof *rows, ROWS},
                                                {filter_rows, sizeof *filter_rows, ROWS}, 1.0, false};
    L1L2Path *path;
    L1L2ShutterFilter *filter;
    L1L2WarpMesh plain;
    if (l1l2_path_create(&path, &path_cfg) != L1L2STAB_OK ||
        l1l2_shutter_filter_create(&filter, &filter_cfg) != L1L2STAB_OK ||
        !l1l2_warp_mesh_init(&plain, clip->width, clip->height))
        exit(EXIT_FAILURE);
    for (int t = 0; t <= clip->frames; t++) {
        const L1L2MotionResult *m = &clip->motion[model][t < clip->frames ? t : 0];
        const bool starts_path = m->model == L1L2STAB_MOTION_SOURCE_NONE;
        if (t < clip->frames) {
            l1l2_path_push(path, &(L1L2PathInput){.F = &m->F, .starts_path = starts_path, .lambda = 0.5,
                                                  .crop_ratio = ratio});
            l1l2_shutter_filter_push(filter, m->has_residual ? &m->residual : NULL, starts_path);
        } else {
            l1l2_path_finish(path);
        }
        for (const L1L2PathFrame *f; (f = l1l2_path_pull(path)) != NULL; count->frames++) {
            const L1L2Mat map = l1l2_mat_mul(l1l2_mat_rescale(f->B, diagonal_px), l1l2_mat_diagonal(ratio, ratio));
            double reach;
            l1l2_shutter_filter_pull(filter);
            const L1L2WarpMesh *mesh = l1l2_shutter_filter_mesh(filter, &map, 1.0, &reach);
            l1l2_warp_mesh_set(&plain, &map);
            check(mesh ? mesh : &plain, 0.5 * clip->width + (mesh ? 0.0 : rounding_px),
                  0.5 * clip->height + (mesh ? 0.0 : rounding_px), count);
            count->corrected += mesh != NULL;
            count->farthest = fmax(count->farthest, reach);
        }
    }
    l1l2_path_free(path);
    l1l2_shutter_filter_free(filter);
    l1l2_warp_mesh_clear(&plain);
}

int main(int argc, char **argv)
{
    static const char *const names[MODELS] = {"none", "homography", "mixture"};
    if (argc < 3) {
        printf("usage: bench_inclusion WIDTH HEIGHT [FRAMES_PER_SECOND] < rows of gray bytes\n");
        return EXIT_SUCCESS;
    }
    Clip clip = {.width = atoi(argv[1]), .height = atoi(argv[2]), .frame_rate = argc > 3 ? atof(argv[3]) : 30.0};
    analyze(&clip, stdin);
    for (int model = 0; model < MODELS; model++) {
        Count count = {0};
        for (int r = 0; r < RATIOS; r++)
            run(&clip, model, ratios[r], &count);
        printf("%-10s  %6ld frames, %6ld with a residual, of %6.2f px at most: %ld of %ld nodes outside\n",
               names[model], count.frames, count.corrected, count.farthest, count.outside, count.nodes);
        free(clip.motion[model]);
    }
    return EXIT_SUCCESS;
}
