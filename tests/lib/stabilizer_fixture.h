/* SPDX-License-Identifier: MIT */
/* A small shaky clip, and the public header's loop over it, which checks everything that the header promises. */
#ifndef STABILIZER_FIXTURE_H
#define STABILIZER_FIXTURE_H

#include <string.h>

#include <l1l2stab/l1l2stab.h>

#include "checkx.h"
#include "common/geom.h"
#include "synth.h"

enum { WIDTH = 160, HEIGHT = 96, MAX_FRAMES = 128 };

/* A small clip, and how often each of its frames was released. */
typedef struct Clip {
    SynthPicture picture[MAX_FRAMES];
    int released[MAX_FRAMES];
    int frames;
} Clip;

/* A slow pan with a shake. It is made once per process, because preparing the scene takes most of the time. */
static inline Synth *the_scene(void)
{
    static Synth *scene;
    if (!scene) {
        SynthConfig cfg = synth_defaults();
        cfg.width = WIDTH, cfg.height = HEIGHT;
        cfg.shake = 2.0, cfg.roll = 0.002, cfg.pan_x = 0.4;
        scene = synth_new(&cfg);
    }
    return scene;
}

static inline void count_release(void *opaque)
{
    ++*(int *)opaque;
}

static inline Clip *new_clip(int frames, L1L2StabFormat format)
{
    Synth *synth = the_scene();
    Clip *clip = calloc(1, sizeof *clip);
    clip->frames = frames;
    for (int t = 0; t < frames; t++) {
        clip->picture[t] = synth_picture_new(format, WIDTH, HEIGHT);
        synth_render(synth, t, format, clip->picture[t].data, clip->picture[t].stride);
    }
    return clip;
}

static inline void free_clip(Clip *clip)
{
    for (int t = 0; t < clip->frames; t++)
        synth_picture_free(&clip->picture[t]);
    free(clip);
}

static inline L1L2StabFrame frame_of(Clip *clip, int t)
{
    L1L2StabFrame frame = {.pts = 1000 + 33 * t, .opaque = &clip->released[t], .release = count_release};
    memcpy(frame.data, clip->picture[t].data, sizeof frame.data);
    memcpy(frame.stride, clip->picture[t].stride, sizeof frame.stride);
    return frame;
}

static inline L1L2StabConfig small_config(int window)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = WIDTH, cfg.height = HEIGHT;
    cfg.frame_rate = 30;
    cfg.window = window;
    cfg.crop_ratio = 0.8;
    cfg.threads = 1;
    return cfg;
}

static inline L1L2Stab *create(const L1L2StabConfig *cfg)
{
    L1L2Stab *s;
    ck_assert_int_eq(l1l2stab_create(&s, cfg), L1L2STAB_OK);
    return s;
}

/* The public header's loop over a clip. Returns the frames that came out, with their infos and, if wanted, pictures. */
static inline int stabilize(L1L2Stab *s, Clip *clip, L1L2StabInfo *info, SynthPicture *out)
{
    int pulled = 0;
    L1L2StabResult r = L1L2STAB_OK;
    for (int t = 0; t <= clip->frames; t++) {
        if (t < clip->frames) {
            const L1L2StabFrame in = frame_of(clip, t);
            ck_assert_int_eq(l1l2stab_push(s, &in), L1L2STAB_OK);
        } else {
            ck_assert_int_eq(l1l2stab_finish(s), L1L2STAB_OK);
        }
        for (;;) {
            L1L2StabFrame picture = {0};
            int64_t pts = -1;
            void *opaque = NULL;
            const L1L2StabResult ready = l1l2stab_peek(s, &pts, &opaque);
            if (ready == L1L2STAB_OK) {
                ck_assert_int_eq(pts, 1000 + 33 * pulled); /* frames come in order, with their own opaque */
                ck_assert_ptr_eq(opaque, &clip->released[pulled]);
                ck_assert_int_eq(clip->released[pulled], 0);
            }
            if (out && pulled < clip->frames) { /* the end of the caller's array */
                memcpy(picture.data, out[pulled].data, sizeof picture.data);
                memcpy(picture.stride, out[pulled].stride, sizeof picture.stride);
            }
            r = l1l2stab_pull(s, out ? &picture : NULL, info ? &info[pulled] : NULL);
            ck_assert_int_eq(r, ready);
            if (r != L1L2STAB_OK)
                break;
            if (out)
                ck_assert_int_eq(picture.pts, 1000 + 33 * pulled);
            ck_assert_int_eq(clip->released[pulled], 1);
            pulled++;
        }
        ck_assert_int_eq(r, t < clip->frames ? L1L2STAB_AGAIN : L1L2STAB_EOS);
    }
    return pulled;
}

static inline L1L2Mat mat_of(const double m[9])
{
    L1L2Mat out;
    memcpy(out.m, m, sizeof out.m);
    return out;
}

#endif
