/* SPDX-License-Identifier: MIT */
/* The path from arbitrary motions: numbers of any size, in any order. A motion is refused exactly where the header says
 * so; every matrix of an accepted one is finite, the picture stays inside the source, and the motions that are reported
 * make the same path again, bit for bit. */
#include "fuzz_config.h"
#include "fuzz_info.h"

enum { MAX_FRAMES = 60 };

typedef struct Step {
    double F[9];
    int64_t pts;
    unsigned flags;
    int hurry;
} Step;

static Step steps[MAX_FRAMES];
static L1L2StabInfo infos[2][MAX_FRAMES];

static void set_similarity(double F[9], double zoom, double angle)
{
    F[0] = F[4] = zoom * cos(angle);
    F[3] = zoom * sin(angle);
    F[1] = -F[3];
}

/* A number from -1 to 1: mostly small. */
static double signed_part(FuzzInput *in)
{
    const double part = 2.0 * fuzz_part(in) - 1.0;
    return part * part * part;
}

static void choose_motion(FuzzInput *in, const L1L2StabConfig *cfg, double F[9])
{
    const double diagonal = hypot(cfg->width * cfg->pixel_aspect, cfg->height);
    const double F0[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int kind = fuzz_below(in, 16);
    memcpy(F, F0, sizeof F0);
    F[2] = (kind < 8 ? 0.05 : 10.5) * diagonal * signed_part(in);
    F[5] = (kind < 8 ? 0.05 : 10.5) * diagonal * signed_part(in);
    if (cfg->motion_model != L1L2STAB_MOTION_MODEL_TRANSLATION)
        set_similarity(F, kind < 8 ? 1.0 : pow(2.05, signed_part(in)), (kind < 8 ? 0.1 : 3.2) * signed_part(in));
    if (cfg->motion_model == L1L2STAB_MOTION_MODEL_AFFINE && kind % 2)
        F[1] += signed_part(in);
    if (kind == 12)
        F[fuzz_below(in, 9)] = fuzz_any_double(in);
    if (kind == 13 && cfg->motion_model != L1L2STAB_MOTION_MODEL_TRANSLATION)
        set_similarity(F, fuzz_below(in, 2) ? 1.999 : 0.501, 0.0);
    if (kind == 14)
        F[2] = (fuzz_below(in, 2) ? 7.07 : -7.07) * diagonal;
}

/* The longest and the shortest image of a unit vector. */
static void stretches(const double F[9], double *most, double *least)
{
    const double p = hypot(F[0] + F[4], F[3] - F[1]), q = hypot(F[0] - F[4], F[3] + F[1]);
    *most = 0.5 * (p + q);
    *least = 0.5 * (p - q); /* < 0: mirrored */
}

static bool is_of_model(const double F[9], L1L2StabMotionModel model)
{
    for (int i = 0; i < 9; i++)
        if (!isfinite(F[i]))
            return false;
    if (F[6] != 0.0 || F[7] != 0.0 || F[8] != 1.0)
        return false;
    if (model == L1L2STAB_MOTION_MODEL_TRANSLATION)
        return F[0] == 1.0 && F[1] == 0.0 && F[3] == 0.0 && F[4] == 1.0;
    return model == L1L2STAB_MOTION_MODEL_AFFINE || (F[0] == F[4] && F[1] == -F[3]);
}

/* 1: must be accepted, 0: must be refused, -1: within rounding of the limit. */
static int is_allowed(const double F[9], const L1L2StabConfig *cfg)
{
    const double rounding = 1e-9, diagonal = hypot(cfg->width, cfg->height);
    double most, least;
    if (!is_of_model(F, cfg->motion_model))
        return 0;
    stretches(F, &most, &least);
    const double moved = hypot(F[2], F[5]) / diagonal;
    if (moved > 10 + rounding || most > 2 + rounding || least < 0.5 - rounding)
        return 0;
    return moved < 10 - rounding && most < 2 - rounding && least > 0.5 + rounding ? 1 : -1;
}

/* Pulls what is ready. Returns the number of frames that have come out so far. */
static int pull_ready(L1L2Stab *s, const L1L2StabConfig *cfg, L1L2StabInfo *info, int pulled)
{
    while (l1l2stab_pull(s, NULL, &info[pulled]) == L1L2STAB_OK) {
        fuzz_check_info(&info[pulled], cfg);
        FUZZ_CHECK(info[pulled].index == (uint64_t)pulled, "frame %d", pulled);
        pulled++;
    }
    return pulled;
}

static void push_step(L1L2Stab *s, const Step *step, const double F[9])
{
    const L1L2StabFrame frame = {.motion = F, .pts = step->pts, .flags = step->flags};
    FUZZ_CHECK(l1l2stab_push(s, &frame) == L1L2STAB_OK, "an accepted motion was refused");
    l1l2stab_hurry(s, step->hurry);
}

/* The motions that were reported, instead of those that were chosen. */
static void run_again(const L1L2StabConfig *cfg, int frames)
{
    L1L2Stab *s;
    int pulled = 0;
    FUZZ_CHECK(l1l2stab_create(&s, cfg) == L1L2STAB_OK, "create");
    for (int t = 0; t < frames; t++) {
        push_step(s, &steps[t], infos[0][t].F);
        pulled = pull_ready(s, cfg, infos[1], pulled);
    }
    l1l2stab_finish(s);
    pulled = pull_ready(s, cfg, infos[1], pulled);
    FUZZ_CHECK(pulled == frames, "%d of %d", pulled, frames);
    l1l2stab_free(&s);
    for (int t = 0; t < frames; t++)
        FUZZ_CHECK(memcmp(infos[0][t].B, infos[1][t].B, sizeof infos[0][t].B) == 0, "frame %d has another path", t);
}

static Step choose_step(FuzzInput *in, const L1L2StabConfig *cfg, int t)
{
    Step step = {.pts = (int64_t)t * 33333333};
    if (fuzz_chance(in, 8))
        step.pts = fuzz_below(in, 2) ? (int64_t)fuzz_bits(in, 8) : (int64_t)fuzz_bits(in, 4);
    if (fuzz_chance(in, 32))
        step.flags = L1L2STAB_FRAME_DISCONT;
    if (fuzz_chance(in, 16))
        step.hurry = fuzz_below(in, 10);
    choose_motion(in, cfg, step.F);
    return step;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FuzzInput in = {data, data + size};
    L1L2StabConfig cfg;
    L1L2Stab *s;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = fuzz_between(&in, 16, 2000);
    cfg.height = fuzz_between(&in, 16, 2000);
    cfg.threads = 1;
    fuzz_config_path(&cfg, &in, fuzz_chance(&in, 16) ? 40 : 12);
    FUZZ_CHECK(l1l2stab_create(&s, &cfg) == L1L2STAB_OK, "the config is valid");
    const int repeats = fuzz_chance(&in, 4) ? 2 + fuzz_below(&in, 30) : 1;
    int frames = 0, pulled = 0;
    while (fuzz_has_more(&in) && frames + repeats <= MAX_FRAMES - 1) {
        const Step step = choose_step(&in, &cfg, frames);
        const int allowed = is_allowed(step.F, &cfg);
        for (int i = 0; i < repeats; i++) {
            const L1L2StabFrame frame = {.motion = step.F, .pts = step.pts, .flags = step.flags};
            const L1L2StabResult result = l1l2stab_push(s, &frame);
            FUZZ_CHECK(result == L1L2STAB_OK ? allowed != 0 : result == L1L2STAB_ERR_ARGUMENT && allowed != 1,
                       "%d: [%g %g %g; %g %g %g]", result, step.F[0], step.F[1], step.F[2], step.F[3], step.F[4],
                       step.F[5]);
            if (result != L1L2STAB_OK)
                break;
            l1l2stab_hurry(s, step.hurry);
            steps[frames++] = step;
            pulled = pull_ready(s, &cfg, infos[0], pulled);
        }
    }
    l1l2stab_finish(s);
    pulled = pull_ready(s, &cfg, infos[0], pulled);
    FUZZ_CHECK(pulled == frames, "%d of %d", pulled, frames);
    l1l2stab_free(&s);
    run_again(&cfg, frames);
    return 0;
}
