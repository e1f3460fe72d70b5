/* SPDX-License-Identifier: MIT */
/* Camera paths that are known exactly, run through path.h as the stabilizer does. */
#ifndef PATH_FIXTURE_H
#define PATH_FIXTURE_H

#include <stdio.h>
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "path/constraints.h"
#include "path/path.h"

enum { MAX_FRAMES = 1600 };

static const double diagonal_px = 734.3023900274327; /* of 640x360 */

typedef struct Run {
    int frames;
    L1L2Mat F[MAX_FRAMES];
    bool starts[MAX_FRAMES], lost[MAX_FRAMES];
    double step[MAX_FRAMES]; /* 0: one frame */
    int hurry[MAX_FRAMES]; /* how many of the held frames are hurried after frame t was pushed */
    L1L2PathFrame out[MAX_FRAMES]; /* the path's rows: frame t is in row t */
} Run;

/* The config of a path, and the values with which each frame is pushed. */
typedef struct Setup {
    int width, height;
    double frame_rate, weights[3];
    int window, overlap;
    L1L2StabJoin join;
    L1L2StabMotionModel model;
    L1L2StabSolver solver;
    double lambda, crop_ratio;
    int fill_reach;
} Setup;

static inline Setup defaults(void)
{
    return (Setup){.width = 640, .height = 360, .lambda = 0.5, .frame_rate = 30, .crop_ratio = 0.9,
                   .weights = {1, 1, 1}, .window = 150, .overlap = 100,
                   .join = L1L2STAB_JOIN_CONTINUOUS, .model = L1L2STAB_MOTION_MODEL_SIMILARITY};
}

/* A path whose rows are r->out. */
static inline L1L2Path *new_path(const Setup *setup, Run *r)
{
    const L1L2PathConfig cfg = {
        .width = setup->width, .height = setup->height, .frame_rate = setup->frame_rate,
        .weights = {setup->weights[0], setup->weights[1], setup->weights[2]},
        .window = setup->window, .overlap = setup->overlap, .join = setup->join, .model = setup->model,
        .solver = setup->solver, .fill_reach = setup->fill_reach, .frames = {r->out, sizeof *r->out, MAX_FRAMES},
    };
    L1L2Path *path;
    ck_assert_int_eq(l1l2_path_create(&path, &cfg), L1L2STAB_OK);
    return path;
}

static inline void push(L1L2Path *path, const Setup *setup, const L1L2Mat *F, bool starts_path)
{
    l1l2_path_push(path, &(L1L2PathInput){.F = F, .starts_path = starts_path, .lambda = setup->lambda,
                                          .crop_ratio = setup->crop_ratio});
}

static inline void push_frame(L1L2Path *path, const Setup *setup, const Run *r, int t)
{
    l1l2_path_push(path, &(L1L2PathInput){.F = &r->F[t], .starts_path = r->starts[t], .lambda = setup->lambda,
                                          .crop_ratio = setup->crop_ratio, .step = r->step[t],
                                          .lost = r->lost[t]});
}

/* True if the next frame of the path is frame t and is decided. */
static inline bool pull(L1L2Path *path, const Run *r, int t)
{
    const L1L2PathFrame *frame = l1l2_path_pull(path);
    ck_assert(!frame || frame == &r->out[t]);
    return frame != NULL;
}

/* Pushes all frames, pulling as the stabilizer does: frame t when frame t + N - 1 was pushed, or when it is hurried. */
static inline void run(const Setup *setup, Run *r)
{
    L1L2Path *path = new_path(setup, r);
    int pulled = 0;
    for (int t = 0; t < r->frames; t++) {
        push_frame(path, setup, r, t);
        if (t - pulled + 1 == setup->window)
            ck_assert_msg(pull(path, r, pulled++), "frame %d was not decided in time", pulled - 1);
        if (r->hurry[t] > 0)
            l1l2_path_hurry(path, r->hurry[t]);
        for (int i = 0; i < r->hurry[t] && pulled <= t; i++)
            ck_assert_msg(pull(path, r, pulled++), "frame %d was hurried in vain", pulled - 1);
    }
    l1l2_path_finish(path);
    while (pulled < r->frames)
        ck_assert(pull(path, r, pulled++));
    ck_assert_ptr_null(l1l2_path_pull(path));
    l1l2_path_free(path);
}

static inline Run *new_run(int frames)
{
    Run *r = calloc(1, sizeof *r);
    r->frames = frames;
    for (int t = 0; t < frames; t++)
        r->F[t] = l1l2_mat_identity();
    return r;
}

static inline double uniform(L1L2Rng *rng, double low, double high)
{
    return low + (high - low) * (l1l2_rng_next(rng) / 4294967296.0);
}

/* A pan that drifts, with a shake: each frame's pose is that of the pan plus noise. F is from pose to pose. Unit of the
 * arguments: pixels at 640x360. */
static inline Run *drifting_run(int frames, double pan_px, double drift_px, double shake_px, uint64_t seed)
{
    Run *r = new_run(frames);
    L1L2Rng rng = l1l2_rng_seeded(seed);
    L1L2Mat before = l1l2_mat_identity();
    for (int t = 0; t < frames; t++) {
        /* One draw a statement: within an expression C leaves their order to the compiler. */
        const double roll = uniform(&rng, -0.002, 0.002) * shake_px;
        const double shake_y = uniform(&rng, -shake_px, shake_px);
        const double shake_x = uniform(&rng, -shake_px, shake_px);
        const L1L2Mat pose = l1l2_mat_similarity(cos(roll), sin(roll),
                                                 (pan_px * t + drift_px * sin(t / 23.0) + shake_x) / diagonal_px,
                                                 (drift_px * sin(t / 37.0) + shake_y) / diagonal_px);
        L1L2Mat inverse;
        l1l2_mat_inverse(before, &inverse);
        r->F[t] = l1l2_mat_mul(inverse, pose);
        before = pose;
    }
    return r;
}

static inline Run *shaky_run(int frames, double pan_px, double shake_px, uint64_t seed)
{
    return drifting_run(frames, pan_px, 0.0, shake_px, seed);
}

/* A camera path that was measured on real video (tests/reference/motion). Sets the size in *cfg. */
static inline Run *measured_run(const char *name, Setup *cfg)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s.txt", REFERENCE_MOTION, name);
    FILE *file = fopen(path, "r");
    ck_assert_msg(file != NULL, "%s cannot be read", path);
    ck_assert_int_eq(fscanf(file, "# %d %d", &cfg->width, &cfg->height), 2);
    Run *r = new_run(0);
    for (double a, b, x, y; fscanf(file, "%lf %lf %lf %lf", &a, &b, &x, &y) == 4; r->frames++)
        r->F[r->frames] = l1l2_mat_similarity(a, b, x, y);
    fclose(file);
    ck_assert_int_gt(r->frames, 150);
    return r;
}

/* Every frame was solved, and its update transform meets the constraints. */
static inline void assert_all_inside(const Setup *setup, const Run *r)
{
    const L1L2PathCropWindow crop =
        l1l2_path_crop_window(setup->width, setup->height, setup->crop_ratio, l1l2_mat_dim(setup->model));
    for (int t = 0; t < r->frames; t++) {
        ck_assert_double_le(l1l2_path_constraint_excess(&crop, &r->out[t].B), 1e-12);
        ck_assert(!r->out[t].fallback);
    }
}

static inline double speed_px(const Run *r, int t)
{
    return r->out[t].S.m[2] * diagonal_px;
}

#endif
