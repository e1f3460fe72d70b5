/* SPDX-License-Identifier: MIT */
/* Synthetic clips of 320x180 pixels. Errors are the root mean square over the frame's four corners, in pixels of a
 * picture 640 wide. */
#include <string.h>

#include "checkx.h"
#include "common/mem.h"
#include "motion/direct_alignment.h"
#include "synth_hard.h"

enum { WIDTH = 320, HEIGHT = 180, BLURRED = 3 };

static const double to_640 = 640.0 / WIDTH;
static SynthHard *clip;
static L1L2DirectAlignment *aligner;
static L1L2FloatPyramid *now, *other;
static uint8_t picture[HEIGHT * WIDTH];

static void open_clip(void)
{
    const SynthHardConfig cfg = synth_hard_case_at(synth_hard_case_named("plain"), WIDTH);
    clip = synth_hard_new(&cfg);
    aligner = l1l2_motion_align_new(WIDTH, HEIGHT, WIDTH, HEIGHT);
    now = l1l2_image_float_pyramid_new(WIDTH, HEIGHT);
    other = l1l2_image_float_pyramid_new(WIDTH, HEIGHT);
}

static void close_clip(void)
{
    synth_hard_free(clip);
    l1l2_motion_align_free(aligner);
    l1l2_image_float_pyramid_free(now);
    l1l2_image_float_pyramid_free(other);
}

static SynthHardConfig change_to(const char *name, double noise)
{
    SynthHardConfig cfg = synth_hard_case_at(synth_hard_case_named(name), WIDTH);
    cfg.noise = noise;
    synth_hard_change(clip, &cfg);
    return cfg;
}

static void show(L1L2FloatPyramid *p, int t)
{
    synth_hard_render(clip, t, picture, WIDTH);
    l1l2_image_float_pyramid_build(p, picture, WIDTH);
}

static L1L2Alignment align(const L1L2AlignmentGuide *guide)
{
    static const L1L2AlignmentGuide none;
    L1L2Alignment r;
    l1l2_motion_align(aligner, now, other, guide ? guide : &none, &r);
    ck_assert(l1l2_mat_is_finite(&r.F));
    return r;
}

static double distance(const L1L2Mat *A, const L1L2Mat *B)
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {(k & 1 ? 0.5 : -0.5) * WIDTH, (k & 2 ? 0.5 : -0.5) * HEIGHT};
        const L1L2Point p = l1l2_mat_apply(A, u), q = l1l2_mat_apply(B, u);
        sum += (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
    }
    return to_640 * sqrt(0.25 * sum);
}

/* Of an alignment of frame t with the frame `back` frames before it. */
static double error_of(const L1L2Alignment *r, int t, int back)
{
    const L1L2Mat F = l1l2_mat_rescale(r->F, hypot(WIDTH, HEIGHT));
    L1L2Mat true_F;
    synth_hard_motion(clip, t, back, true_F.m);
    return distance(&F, &true_F);
}

static L1L2Alignment align_frames(int t, int back)
{
    show(now, t);
    show(other, t - back);
    return align(NULL);
}

/* The rms error of some frames; all of them are accepted. */
static double rms_error(const char *name, double noise)
{
    enum { FROM = 1, FRAMES = 4 };
    double sum = 0.0;
    change_to(name, noise);
    for (int t = FROM; t < FROM + FRAMES; t++) {
        const L1L2Alignment r = align_frames(t, 1);
        ck_assert_msg(l1l2_motion_align_accepts(&r.evidence), "%s, frame %d is refused", name, t);
        sum += error_of(&r, t, 1) * error_of(&r, t, 1) / FRAMES;
    }
    return sqrt(sum);
}

START_TEST(sharp_pictures_are_aligned_to_a_tenth_of_a_pixel)
{
    ck_assert_double_lt(rms_error("plain", 0.0), 0.15);
    ck_assert_double_lt(rms_error("plain", 10.0), 0.2);
}
END_TEST

START_TEST(low_contrast_thermal_cameras_rain_snow_and_text_are_no_obstacle)
{
    ck_assert_double_lt(rms_error("low texture", 2.0), 0.3);
    ck_assert_double_lt(rms_error("thermal", 0.0), 0.3);
    ck_assert_double_lt(rms_error("rain", 5.0), 0.3);
    ck_assert_double_lt(rms_error("snow", 5.0), 0.3);
    ck_assert_double_lt(rms_error("specks", 5.0), 0.3);
    ck_assert_double_lt(rms_error("labels", 5.0), 0.3);
}
END_TEST

START_TEST(zoom_and_a_step_of_the_exposure_are_no_obstacle)
{
    ck_assert_double_lt(rms_error("fast zoom", 2.0), 0.3);
    ck_assert_double_lt(rms_error("exposure step", 2.0), 0.5);
}
END_TEST

START_TEST(a_sky_of_stars_is_aligned)
{
    ck_assert_double_lt(rms_error("stars", 0.0), 0.5);
}
END_TEST

/* The blurred frame within 3 px; the frame behind it, by a bridge to the sharp frame before, within 0.5 px. */
START_TEST(a_blurred_frame_is_aligned_and_the_one_behind_it_with_the_one_before)
{
    static const char *const names[] = {"blur 10 px", "blur 20 px", "blur 40 px", "blur 60 px"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        change_to(names[k], 5.0);
        L1L2Alignment r = align_frames(BLURRED, 1);
        ck_assert_double_lt(error_of(&r, BLURRED, 1), 3.0);
        r = align_frames(BLURRED + 1, 2);
        ck_assert_double_lt(error_of(&r, BLURRED + 1, 2), 0.5);
        ck_assert(l1l2_motion_align_accepts(&r.evidence));
    }
}
END_TEST

START_TEST(a_motion_of_15_percent_of_the_width_is_found)
{
    SynthHardConfig cfg = change_to("plain", 2.0);
    cfg.jerk_from = BLURRED, cfg.jerks = 1, cfg.jerk_px = 0.09 * WIDTH;
    synth_hard_change(clip, &cfg);
    const L1L2Alignment r = align_frames(BLURRED + 1, 2);
    L1L2Mat F;
    synth_hard_motion(clip, BLURRED + 1, 2, F.m);
    ck_assert_double_gt(hypot(F.m[2], F.m[5]), 0.14 * WIDTH);
    ck_assert_double_lt(error_of(&r, BLURRED + 1, 2), 0.5);
}
END_TEST

/* Of two motions, one is followed and not their mean: whichever has the more trusted cells. */
START_TEST(of_two_motions_the_more_trusted_is_followed)
{
    float trust[L1L2_ALIGN_CELLS];
    change_to("water 55 %", 2.0);
    show(now, 2);
    show(other, 1);
    L1L2AlignmentGuide guide = {.trust = trust, .split = true};
    for (int i = 0; i < L1L2_ALIGN_CELLS; i++)
        trust[i] = i / L1L2_ALIGN_CELLS_X < 2 ? 1.0f : 0.2f;
    const L1L2Alignment bank = align(&guide);
    for (int i = 0; i < L1L2_ALIGN_CELLS; i++)
        trust[i] = i / L1L2_ALIGN_CELLS_X < 2 ? 0.2f : 1.0f;
    const L1L2Alignment water = align(&guide);
    ck_assert_double_lt(error_of(&bank, 2, 1), 0.3);
    ck_assert_double_gt(error_of(&water, 2, 1), 4.0); /* it drifts by 2.6 px of 320 */
}
END_TEST

START_TEST(what_has_no_motion_is_refused)
{
    /* Another scene. */
    SynthHardConfig cfg = synth_hard_case_at(synth_hard_case_named("plain"), WIDTH);
    cfg.seed = 77;
    SynthHard *another = synth_hard_new(&cfg);
    change_to("plain", 0.0);
    show(now, 1);
    synth_hard_render(another, 1, picture, WIDTH);
    l1l2_image_float_pyramid_build(other, picture, WIDTH);
    synth_hard_free(another);
    L1L2Alignment r = align(NULL);
    ck_assert(!l1l2_motion_align_accepts(&r.evidence));
    /* Nothing but noise. */
    cfg = change_to("plain", 5.0);
    cfg.contrast = 1e-12;
    synth_hard_change(clip, &cfg);
    r = align_frames(2, 1);
    ck_assert(!l1l2_motion_align_accepts(&r.evidence));
    /* Black. */
    memset(picture, 16, sizeof picture);
    l1l2_image_float_pyramid_build(now, picture, WIDTH);
    r = align(NULL);
    ck_assert(!l1l2_motion_align_accepts(&r.evidence));
    l1l2_image_float_pyramid_build(other, picture, WIDTH);
    r = align(NULL);
    ck_assert(!l1l2_motion_align_accepts(&r.evidence));
}
END_TEST

START_TEST(one_edge_does_not_determine_a_motion)
{
    for (int moved = 0; moved < 2; moved++) {
        for (int i = 0; i < HEIGHT * WIDTH; i++)
            picture[i] = i % WIDTH < WIDTH / 2 + 3 * moved ? 60 : 180;
        l1l2_image_float_pyramid_build(moved ? now : other, picture, WIDTH);
    }
    const L1L2Alignment r = align(NULL);
    ck_assert_near(r.F.m[2] * hypot(WIDTH, HEIGHT), -3.0, 0.5);
    ck_assert_double_gt(r.evidence.deviation[3], 1.0);
    ck_assert(!l1l2_motion_align_accepts(&r.evidence));
}
END_TEST

START_TEST(equal_calls_give_equal_bytes)
{
    change_to("plain", 5.0);
    const L1L2Alignment first = align_frames(2, 1);
    change_to("labels", 0.0);
    align_frames(4, 1);
    change_to("plain", 5.0);
    const L1L2Alignment again = align_frames(2, 1);
    ck_assert_mem_eq(&first, &again, sizeof first);
}
END_TEST

/* So that a measurement can be made to depend on a bounded number of frames. */
START_TEST(the_blind_motion_does_not_depend_on_what_the_caller_knows)
{
    float trust[L1L2_ALIGN_CELLS] = {1.0f, 0.5f};
    change_to("blur 20 px", 5.0);
    const L1L2Alignment alone = align_frames(BLURRED, 1);
    const L1L2AlignmentGuide guide = {
        .start = {alone.F, l1l2_mat_translation(0.05, 0.0)}, .starts = 2, .trust = trust};
    const L1L2Alignment guided = align(&guide);
    ck_assert_mem_eq(&alone.blind, &guided.blind, sizeof alone.blind);
    const L1L2Mat F = l1l2_mat_rescale(alone.blind, hypot(WIDTH, HEIGHT));
    L1L2Mat true_F;
    synth_hard_motion(clip, BLURRED, 1, true_F.m);
    ck_assert_double_lt(distance(&F, &true_F), 6.0);
}
END_TEST

START_TEST(any_size_is_taken)
{
    static const int sizes[][2] = {{16, 16}, {17, 300}, {640, 33}, {90, 160}, {401, 401}, {83, 84}};
    static uint8_t grey[640 * 401];
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        const int w = sizes[k][0], h = sizes[k][1];
        L1L2FloatPyramid *p = l1l2_image_float_pyramid_new(w, h), *q = l1l2_image_float_pyramid_new(w, h);
        L1L2DirectAlignment *d = l1l2_motion_align_new(w, h, w, h);
        L1L2Alignment r;
        L1L2AlignmentGuide guide = {.start = {l1l2_mat_translation(0.9, -0.9), l1l2_mat_translation(1e9, 0.0)},
                                    .starts = 2};
        for (int i = 0; i < w * h; i++)
            grey[i] = (uint8_t)(128.0 + 60.0 * sin(i % w * 0.4) + 50.0 * cos(i / w * 0.3));
        l1l2_image_float_pyramid_build(p, grey, w);
        l1l2_image_float_pyramid_build(q, grey, w);
        l1l2_motion_align(d, p, q, &guide, &r);
        ck_assert(l1l2_mat_is_finite(&r.F));
        ck_assert_near(r.F.m[2], 0.0, 1e-6);
        ck_assert_near(r.evidence.residual, 0.0, 0.01);
        l1l2_motion_align_free(d);
        l1l2_image_float_pyramid_free(p);
        l1l2_image_float_pyramid_free(q);
    }
}
END_TEST

static int allocations_left;

static void *allocate(size_t count, size_t size)
{
    return allocations_left-- > 0 ? calloc(count, size) : NULL;
}

START_TEST(an_allocation_that_fails_leaves_nothing_behind)
{
    const L1L2MemHook hook = {allocate, free};
    bool made = false;
    l1l2_mem_set_hook(&hook);
    for (int most = 0; most < 20 && !made; most++) {
        allocations_left = most;
        L1L2DirectAlignment *d = l1l2_motion_align_new(WIDTH, HEIGHT, WIDTH, HEIGHT);
        L1L2FloatPyramid *p = l1l2_image_float_pyramid_new(WIDTH, HEIGHT);
        made = d && p;
        l1l2_motion_align_free(d);
        l1l2_image_float_pyramid_free(p);
    }
    l1l2_mem_set_hook(NULL);
    ck_assert(made);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("direct_alignment");
    TCase *tests = tcase_create("direct_alignment");
    tcase_add_unchecked_fixture(tests, open_clip, close_clip);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, sharp_pictures_are_aligned_to_a_tenth_of_a_pixel);
    tcase_add_test(tests, low_contrast_thermal_cameras_rain_snow_and_text_are_no_obstacle);
    tcase_add_test(tests, zoom_and_a_step_of_the_exposure_are_no_obstacle);
    tcase_add_test(tests, a_sky_of_stars_is_aligned);
    tcase_add_test(tests, a_blurred_frame_is_aligned_and_the_one_behind_it_with_the_one_before);
    tcase_add_test(tests, a_motion_of_15_percent_of_the_width_is_found);
    tcase_add_test(tests, of_two_motions_the_more_trusted_is_followed);
    tcase_add_test(tests, what_has_no_motion_is_refused);
    tcase_add_test(tests, one_edge_does_not_determine_a_motion);
    tcase_add_test(tests, equal_calls_give_equal_bytes);
    tcase_add_test(tests, the_blind_motion_does_not_depend_on_what_the_caller_knows);
    tcase_add_test(tests, any_size_is_taken);
    tcase_add_test(tests, an_allocation_that_fails_leaves_nothing_behind);
    suite_add_tcase(suite, tests);
    return checkx_run(suite);
}
