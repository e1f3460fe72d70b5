/* SPDX-License-Identifier: MIT */
/* A clip and the motion that is measured in it. Errors are the root mean square over the frame's four corners, in
 * pixels of the frame. */
#ifndef MOTION_FIXTURE_H
#define MOTION_FIXTURE_H

#include <string.h>

#include "checkx.h"
#include "motion/motion.h"
#include "synth.h"

static int warnings;

static inline void count_warning(void *cookie, L1L2StabLogLevel level, const char *message)
{
    warnings += level == L1L2STAB_LOG_WARN;
}

static const L1L2StabLogger logger = {count_warning, NULL, L1L2STAB_LOG_TRACE};

typedef struct Run {
    SynthConfig cfg;
    Synth *synth;
    SynthPicture picture;
    L1L2Motion *motion;
} Run;

static inline L1L2Motion *motion_new(int width, int height, L1L2StabFormat format)
{
    const L1L2MotionConfig cfg = {
        .format = l1l2_image_format_info(format), .width = width, .height = height, .analysis_size = 640,
        .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .seed = 1, .log = &logger,
        .rolling_shutter = L1L2STAB_ROLLING_SHUTTER_NONE};
    L1L2Motion *m;
    ck_assert_int_eq(l1l2_motion_create(&m, &cfg), L1L2STAB_OK);
    return m;
}

static inline Run run_new(const SynthConfig *cfg)
{
    warnings = 0;
    return (Run){*cfg, synth_new(cfg), synth_picture_new(L1L2STAB_FORMAT_GRAY8, cfg->width, cfg->height),
                 motion_new(cfg->width, cfg->height, L1L2STAB_FORMAT_GRAY8)};
}

static inline void run_free(Run *run)
{
    l1l2_motion_free(run->motion);
    synth_picture_free(&run->picture);
    synth_free(run->synth);
}

/* Every result is usable, whatever the picture. */
static inline L1L2MotionResult push(L1L2Motion *m, const SynthPicture *p, bool starts_path)
{
    L1L2MotionResult r;
    L1L2Mat inverse;
    ck_assert_int_eq(l1l2_motion_push(m, p->data[0], p->stride[0], starts_path, &r), L1L2STAB_OK);
    ck_assert(l1l2_mat_is_finite(&r.F));
    ck_assert(l1l2_mat_inverse(r.F, &inverse));
    ck_assert_int_le(r.inliers, r.tracks);
    ck_assert(r.scale_ns >= 0 && r.track_ns >= 0 && r.fit_ns >= 0);
    return r;
}

static inline L1L2MotionResult push_frame(Run *run, int t)
{
    synth_render_gray(run->synth, t, run->picture.data[0], run->picture.stride[0]);
    return push(run->motion, &run->picture, t == 0);
}

static inline L1L2MotionResult push_flat(Run *run, int level)
{
    memset(run->picture.data[0], level, run->picture.size);
    return push(run->motion, &run->picture, false);
}

static inline double corner_rms(const L1L2Mat *a, const L1L2Mat *b, const SynthConfig *cfg)
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {(k & 1 ? 0.5 : -0.5) * cfg->width, (k & 2 ? 0.5 : -0.5) * cfg->height};
        const L1L2Point p = l1l2_mat_apply(a, u), q = l1l2_mat_apply(b, u);
        sum += (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
    }
    return sqrt(0.25 * sum);
}

static inline L1L2Mat in_pixels(const Run *run, const L1L2Mat *F)
{
    return l1l2_mat_rescale(*F, hypot(run->cfg.width, run->cfg.height));
}

static inline L1L2Mat truth(const Run *run, int t)
{
    L1L2Mat F;
    synth_motion(run->synth, t, F.m);
    return F;
}

static inline double error_at(const Run *run, const L1L2MotionResult *r, int t)
{
    const L1L2Mat F = in_pixels(run, &r->F), true_F = truth(run, t);
    return corner_rms(&F, &true_F, &run->cfg);
}

/* Frame t is frame 0 turned and scaled t times about its center. */
static inline L1L2MotionResult push_turned(Run *run, int t, double angle, double scale)
{
    const double zoom = pow(scale, t), a = zoom * cos(angle * t), b = zoom * sin(angle * t);
    const double M[9] = {a, -b, 0.0, b, a, 0.0, 0.0, 0.0, 1.0};
    synth_render_view(run->synth, M, run->cfg.width, run->cfg.height, run->picture.format, run->picture.data,
                      run->picture.stride);
    return push(run->motion, &run->picture, t == 0);
}

#endif
