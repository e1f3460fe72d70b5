/* SPDX-License-Identifier: MIT */
/* The public API as a state machine: any calls in any order, with any config, pictures, strides, timestamps and
 * motions. A model of what the header promises predicts each result. The input is played with one thread and with
 * three, which have to give the same bytes. */
#include "fuzz_config.h"
#include "fuzz_info.h"
#include "fuzz_picture.h"

enum { MAX_CALLS = 60 };

/* A frame that was accepted. */
typedef struct Held {
    FuzzPicture *picture; /* NULL: it was pushed without pixels, or they are released */
    bool has_pixels;
    int64_t pts;
    double lambda;
    int released;
} Held;

/* One run over an input: the instance, and the model of its state. */
typedef struct Play {
    FuzzInput in;
    L1L2StabConfig cfg;
    const L1L2FormatInfo *format;
    L1L2Stab *s;
    FuzzCamera camera;
    Held frames[MAX_CALLS]; /* all that were accepted */
    int begin, end;         /* of those that are held */
    int start;              /* the first since the last reset */
    int hurried;
    bool finished;
    double lambda;
    uint64_t hash;
} Play;

static void hash_result(Play *play, int64_t result)
{
    play->hash = fuzz_hash(play->hash, &result, sizeof result);
}

static void release(void *opaque)
{
    Held *held = opaque;
    held->released++;
    fuzz_picture_free(held->picture); /* a later access is seen */
    held->picture = NULL;
}

static L1L2StabResult expected_readiness(const Play *play)
{
    const int held = play->end - play->begin;
    if (held > 0 && (play->finished || play->hurried > 0 || held == play->cfg.window))
        return L1L2STAB_OK;
    return play->finished ? L1L2STAB_EOS : L1L2STAB_AGAIN;
}

static int64_t choose_pts(Play *play)
{
    const int64_t regular = (int64_t)play->end * 33333333;
    switch (fuzz_below(&play->in, 12)) {
    case 8: return L1L2STAB_NO_PTS;
    case 9: return -regular;
    case 10: return regular + fuzz_below(&play->in, 1 << 20) * INT64_C(1000);
    case 11: return (int64_t)fuzz_bits(&play->in, 8);
    default: return regular;
    }
}

/* True if a motion was chosen. */
static bool choose_motion(Play *play, double F[9])
{
    const int kind = fuzz_below(&play->in, 16);
    if (kind < 12)
        return false;
    const double angle = (fuzz_part(&play->in) - 0.5) * 0.2;
    const bool turns = play->cfg.motion_model != L1L2STAB_MOTION_MODEL_TRANSLATION && kind != 13;
    F[0] = F[4] = turns ? cos(angle) : 1.0;
    F[3] = turns ? sin(angle) : 0.0;
    F[1] = -F[3];
    F[2] = fuzz_part(&play->in) * 20 - 10;
    F[5] = fuzz_part(&play->in) * 20 - 10;
    F[6] = F[7] = 0.0, F[8] = 1.0;
    if (kind == 15)
        F[fuzz_below(&play->in, 9)] = fuzz_any_double(&play->in);
    return true;
}

static void set_planes(L1L2StabFrame *frame, const FuzzPicture *picture)
{
    memcpy(frame->data, picture->data, sizeof frame->data);
    memcpy(frame->stride, picture->stride, sizeof frame->stride);
}

/* Sometimes the caller makes a mistake, and the frame must be refused. */
static bool spoil_frame(Play *play, L1L2StabFrame *frame)
{
    switch (fuzz_below(&play->in, 48)) {
    case 45: frame->data[fuzz_below(&play->in, play->format->planes)] = NULL; return true;
    case 46: frame->struct_size = 1; return true;
    case 47: frame->struct_size = SIZE_MAX; return true;
    default: return false;
    }
}

static void push(Play *play)
{
    double F[9];
    Held *held = &play->frames[play->end];
    L1L2StabFrame frame = {.pts = choose_pts(play), .opaque = held, .release = release};
    const bool has_motion = choose_motion(play, F);
    const bool without_pixels = has_motion && fuzz_below(&play->in, 2);
    if (fuzz_chance(&play->in, 16))
        frame.flags = L1L2STAB_FRAME_DISCONT;
    frame.motion = has_motion ? F : NULL;
    *held = (Held){.has_pixels = !without_pixels, .pts = frame.pts, .lambda = play->lambda};
    if (!without_pixels) {
        held->picture = fuzz_picture_new(&play->in, play->format, play->cfg.width, play->cfg.height);
        fuzz_picture_fill(held->picture, &play->in, &play->camera);
        set_planes(&frame, held->picture);
    }
    const bool spoiled = !without_pixels && !has_motion && spoil_frame(play, &frame);
    const L1L2StabResult result = l1l2stab_push(play->s, &frame);
    hash_result(play, result);
    FUZZ_CHECK(held->released == 0, "released by its own push");
    if (spoiled)
        FUZZ_CHECK(result == L1L2STAB_ERR_ARGUMENT || result == L1L2STAB_ERR_UNSUPPORTED, "%d", result);
    else if (!has_motion)
        FUZZ_CHECK(result == (play->finished                                      ? L1L2STAB_ERR_STATE
                              : play->end - play->begin == play->cfg.window ? L1L2STAB_AGAIN
                                                                            : L1L2STAB_OK),
                   "%d", result);
    if (result == L1L2STAB_OK)
        play->end++;
    else
        fuzz_picture_free(held->picture);
}

static void peek(Play *play)
{
    int64_t pts = 7;
    void *opaque = NULL;
    const L1L2StabResult result = l1l2stab_peek(play->s, &pts, &opaque);
    FUZZ_CHECK(result == expected_readiness(play), "%d", result);
    if (result == L1L2STAB_OK)
        FUZZ_CHECK(pts == play->frames[play->begin].pts && opaque == &play->frames[play->begin], "another frame");
}

static void check_pulled(Play *play, const L1L2StabInfo *info)
{
    const Held *held = &play->frames[play->begin];
    const int kept = play->cfg.border == L1L2STAB_BORDER_FILL ? play->cfg.fill_frames : 0;
    const bool ended = play->finished && play->begin + 1 == play->end;
    for (int k = play->start; k <= play->begin; k++)
        FUZZ_CHECK(play->frames[k].released == (k <= play->begin - kept || ended), "frame %d was released %d times", k,
                   play->frames[k].released);
    fuzz_check_info(info, &play->cfg);
    FUZZ_CHECK(info->index == (uint64_t)(play->begin - play->start), "index %llu", (unsigned long long)info->index);
    FUZZ_CHECK(info->lambda == held->lambda, "%g, not %g", info->lambda, held->lambda);
    L1L2StabInfo stable = *info;
    memset(stable.stage_ns, 0, sizeof stable.stage_ns); /* all else has to be the same in each run */
    play->hash = fuzz_hash(play->hash, stable.F, sizeof stable.F);
    play->hash = fuzz_hash(play->hash, stable.B, sizeof stable.B);
    play->hash = fuzz_hash(play->hash, stable.warp, sizeof stable.warp);
    hash_result(play, stable.flags);
    hash_result(play, stable.tracks);
    play->hash = fuzz_hash(play->hash, &stable.filled, sizeof stable.filled);
}

static L1L2StabResult pull(Play *play, bool with_picture)
{
    const Held *held = &play->frames[play->begin];
    L1L2StabResult expected = expected_readiness(play);
    FuzzPicture *picture = NULL;
    L1L2StabFrame out = {.pts = 7};
    L1L2StabInfo info;
    if (with_picture) {
        int width, height;
        FUZZ_CHECK(l1l2stab_config_output_size(&play->cfg, &width, &height) == L1L2STAB_OK, "no size");
        picture = fuzz_picture_new(&play->in, play->format, width, height);
        set_planes(&out, picture);
        if (expected == L1L2STAB_OK && !held->has_pixels)
            expected = L1L2STAB_ERR_ARGUMENT;
    }
    const L1L2StabResult result = l1l2stab_pull(play->s, with_picture ? &out : NULL, &info);
    hash_result(play, result);
    FUZZ_CHECK(result == expected, "%d, not %d", result, expected);
    if (result == L1L2STAB_OK) {
        if (with_picture)
            FUZZ_CHECK(out.pts == held->pts && out.opaque == held, "another frame");
        check_pulled(play, &info);
        play->begin++;
        play->hurried -= play->hurried > 0;
        if (with_picture)
            play->hash = fuzz_picture_hash(picture, play->hash);
    }
    fuzz_picture_free(picture);
    return result;
}

static void pull_badly(Play *play)
{
    L1L2StabFrame out = {0};
    const L1L2StabResult ready = expected_readiness(play), result = l1l2stab_pull(play->s, &out, NULL);
    FUZZ_CHECK(result == (ready == L1L2STAB_OK ? L1L2STAB_ERR_ARGUMENT : ready), "%d", result);
}

static void hurry(Play *play)
{
    const int frames = fuzz_between(&play->in, -1, 8), held = play->end - play->begin;
    const L1L2StabResult result = l1l2stab_hurry(play->s, frames);
    FUZZ_CHECK(result == (frames < 0 ? L1L2STAB_ERR_ARGUMENT : L1L2STAB_OK), "%d", result);
    const int reached = frames < held ? frames : held;
    if (reached > play->hurried)
        play->hurried = reached;
}

static void set_live(Play *play)
{
    const double value = fuzz_chance(&play->in, 3) ? fuzz_any_double(&play->in) : fuzz_part(&play->in);
    if (fuzz_below(&play->in, 2)) {
        const L1L2StabResult result = l1l2stab_set_lambda(play->s, value);
        FUZZ_CHECK((result == L1L2STAB_OK) == (value >= 0 && value <= 1000), "lambda %g: %d", value, result);
        if (result == L1L2STAB_OK)
            play->lambda = value;
    } else {
        const L1L2StabResult result = l1l2stab_set_crop_ratio(play->s, value);
        FUZZ_CHECK((result == L1L2STAB_OK) == (value >= 0.5 && value <= 0.99), "crop_ratio %g: %d", value, result);
    }
}

/* All that are held were released once, and none twice. */
static void forget_held(Play *play)
{
    for (int k = play->start; k < play->end; k++)
        FUZZ_CHECK(play->frames[k].released == 1, "frame %d: %d releases", k, play->frames[k].released);
    play->begin = play->end;
    play->start = play->end;
    play->hurried = 0;
    play->finished = false;
}

static void call(Play *play)
{
    switch (fuzz_below(&play->in, 32)) {
    case 18: peek(play); break;
    case 19: hurry(play); break;
    case 20: set_live(play); break;
    case 21: l1l2stab_set_bypass(play->s, fuzz_below(&play->in, 2)); break;
    case 22: pull_badly(play); break;
    case 23:
        if (fuzz_below(&play->in, 2)) {
            FUZZ_CHECK(l1l2stab_finish(play->s) == L1L2STAB_OK, "finish");
            play->finished = true;
        }
        break;
    case 24:
        if (fuzz_below(&play->in, 2)) {
            l1l2stab_reset(play->s);
            forget_held(play);
        }
        break;
    case 25: FUZZ_CHECK(l1l2stab_take_error(play->s) == L1L2STAB_OK, "an error was reported"); break;
    case 26:
    case 27:
    case 28:
    case 29: pull(play, true); break;
    case 30:
    case 31: pull(play, false); break;
    default: push(play); break;
    }
}

static void play_calls(Play *play)
{
    int calls = 0;
    while (fuzz_has_more(&play->in) && calls++ < MAX_CALLS - 1)
        call(play);
    if (fuzz_below(&play->in, 2)) { /* otherwise free() releases what is held */
        FUZZ_CHECK(l1l2stab_finish(play->s) == L1L2STAB_OK, "finish");
        play->finished = true;
        while (pull(play, play->frames[play->begin].has_pixels) == L1L2STAB_OK)
            continue;
        FUZZ_CHECK(play->begin == play->end, "%d frames were lost", play->end - play->begin);
    }
    l1l2stab_free(&play->s);
    forget_held(play);
}

/* The queries agree with create, which alone sees whether region and mask leave enough of the picture. True if the
 * instance was created. */
static bool create(Play *play)
{
    int width, height;
    const L1L2StabResult query = l1l2stab_config_output_size(&play->cfg, &width, &height);
    const L1L2StabResult result = l1l2stab_create(&play->s, &play->cfg);
    FUZZ_CHECK(result != L1L2STAB_ERR_NOMEM && result <= 0, "%d", result);
    FUZZ_CHECK((result == L1L2STAB_OK) == (play->s != NULL), "%d", result);
    const bool has_area = play->cfg.mask || play->cfg.region[2] * play->cfg.region[3] < 1.0;
    FUZZ_CHECK(query == result || (result == L1L2STAB_ERR_ARGUMENT && has_area), "%d, then %d", query, result);
    FUZZ_CHECK(l1l2stab_config_delay(&play->cfg) == (query < 0 ? (int)query : play->cfg.window), "the delay differs");
    return result == L1L2STAB_OK;
}

static uint64_t play(const uint8_t *data, size_t size, int threads)
{
    static Play state;
    uint8_t mask[256];
    Play *play = &state;
    *play = (Play){.in = {data, data + size}, .hash = 14695981039346656037u};
    l1l2stab_config_init(&play->cfg, sizeof play->cfg);
    fuzz_config_picture(&play->cfg, &play->in);
    fuzz_config_path(&play->cfg, &play->in, 16);
    fuzz_config_region(&play->cfg, &play->in);
    fuzz_config_mask(&play->cfg, &play->in, mask);
    play->cfg.threads = threads;
    if (fuzz_chance(&play->in, 16))
        fuzz_config_spoil(&play->cfg, &play->in);
    if (!create(play))
        return 0;
    play->format = l1l2_image_format_info(play->cfg.format);
    play->lambda = play->cfg.lambda;
    play_calls(play);
    return play->hash;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint64_t one = play(data, size, 1), three = play(data, size, 3);
    FUZZ_CHECK(one == three, "three threads give another result than one");
    return 0;
}
