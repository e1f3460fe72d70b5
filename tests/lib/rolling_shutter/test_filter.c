/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "path/constraints.h"
#include "rolling_shutter/filter.h"
#include "rolling_shutter/mesh.h"

enum { WIDTH = 640, HEIGHT = 360, WINDOW = 60 };
static const double pi = 3.14159265358979;
static const double diagonal_px = 734.30239;
static const L1L2ShutterSource source = {WIDTH, HEIGHT, 1.0, false};

/* The records of the filter's frames. A test has only one filter at a time. */
static L1L2Mat motions[WINDOW + L1L2_SHUTTER_FILTER_PAST];
static L1L2ShutterFrame frames_of_filter[WINDOW + L1L2_SHUTTER_FILTER_PAST];

static L1L2ShutterFilterConfig config(L1L2StabRollingShutter model)
{
    enum { ROWS = WINDOW + L1L2_SHUTTER_FILTER_PAST };
    return (L1L2ShutterFilterConfig){
        .model = model, .in_width = WIDTH, .in_height = HEIGHT, .out_width = WIDTH, .out_height = HEIGHT,
        .capacity = WINDOW, .motions = {motions, sizeof *motions, ROWS},
        .frames = {frames_of_filter, sizeof *frames_of_filter, ROWS},
    };
}

static L1L2ShutterFilter *filter_new(L1L2StabRollingShutter model)
{
    const L1L2ShutterFilterConfig cfg = config(model);
    L1L2ShutterFilter *filter;
    ck_assert_int_eq(l1l2_shutter_filter_create(&filter, &cfg), L1L2STAB_OK);
    return filter;
}

/* Frame t. */
static void push(L1L2ShutterFilter *filter, int t, const L1L2Mat *F, const L1L2ShutterMeasurement *measurement,
                 bool starts_path)
{
    motions[t % (WINDOW + L1L2_SHUTTER_FILTER_PAST)] = starts_path ? l1l2_mat_identity() : *F;
    l1l2_shutter_filter_push(filter, measurement, starts_path);
}

/* A camera that swings sideways. */
typedef struct Swing {
    double amplitude, frequency; /* diagonals; turns a frame */
    double readout;              /* frames */
} Swing;

static double camera_at(const Swing *s, double time)
{
    return s->amplitude * sin(2.0 * pi * s->frequency * time);
}

/* The exact motion of the bands from frame t to frame t-1, and F, which is their mean. */
static L1L2ShutterMeasurement measurement_of(const Swing *s, int t, L1L2Mat *F)
{
    L1L2ShutterMeasurement measurement = {.explained = {1.0, 1.0, 1.0, 1.0}, .all = {1.0, 1.0, 1.0, 1.0}};
    double mean = 0.0, x[L1L2_SHUTTER_BANDS];
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
        const double at = s->readout * l1l2_shutter_band_row(k);
        x[k] = camera_at(s, t + at) - camera_at(s, t - 1 + at);
        mean += x[k] / L1L2_SHUTTER_BANDS;
    }
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
        measurement.r.p[L1L2_SHUTTER_X + k] = x[k] - mean;
    *F = l1l2_mat_translation(mean, 0.0);
    return measurement;
}

/* Filters a swing. Returns the rms error of the bands' residual, px; *without: the rms of that residual itself. */
static double run_swing(const Swing *s, int frames, double *readout, double *without)
{
    L1L2ShutterFilter *filter = filter_new(L1L2STAB_ROLLING_SHUTTER_MIXTURE);
    double sum = 0.0, all = 0.0;
    int count = 0;
    for (int t = 0, out = 0; out < frames; t++) {
        L1L2Mat F;
        const L1L2ShutterMeasurement measurement = measurement_of(s, t, &F);
        if (t < frames)
            push(filter, t, &F, t > 0 ? &measurement : NULL, t == 0);
        if (t < WINDOW - 1)
            continue;
        const L1L2ShutterResidual *e = l1l2_shutter_filter_pull(filter);
        double mean = 0.0;
        for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
            mean += camera_at(s, out + s->readout * l1l2_shutter_band_row(k)) / L1L2_SHUTTER_BANDS;
        for (int k = 0; k < L1L2_SHUTTER_BANDS && out >= 40; k++, count++) {
            const double truth = camera_at(s, out + s->readout * l1l2_shutter_band_row(k)) - mean;
            sum += (e->p[L1L2_SHUTTER_X + k] - truth) * (e->p[L1L2_SHUTTER_X + k] - truth);
            all += truth * truth;
        }
        out++;
    }
    *readout = l1l2_shutter_filter_readout(filter);
    *without = sqrt(all / count) * diagonal_px;
    l1l2_shutter_filter_free(filter);
    return sqrt(sum / count) * diagonal_px;
}

START_TEST(the_skew_of_each_frame_is_found_and_not_only_its_changes)
{
    const double frequencies[] = {0.02, 0.05, 0.1, 0.17, 0.33, 0.66};
    for (int i = 0; i < 6; i++) {
        const Swing swing = {4.0 / diagonal_px, frequencies[i], 0.7};
        double readout, without;
        const double error = run_swing(&swing, 240, &readout, &without);
        ck_assert_msg(error < 0.1 * without, "%g turns a frame: %g px of %g", frequencies[i], error, without);
    }
}
END_TEST

START_TEST(the_readout_is_found_in_either_direction)
{
    const double readouts[] = {-0.9, -0.4, 0.0, 0.3, 0.6, 0.95};
    for (int i = 0; i < 6; i++) {
        const Swing swing = {4.0 / diagonal_px, 0.06, readouts[i]};
        double readout, without;
        run_swing(&swing, 240, &readout, &without);
        ck_assert_near(readout, readouts[i], 0.05);
    }
}
END_TEST

START_TEST(frames_that_were_not_measured_and_cuts_leave_the_residual_bounded)
{
    L1L2ShutterFilter *filter = filter_new(L1L2STAB_ROLLING_SHUTTER_MIXTURE);
    const Swing swing = {4.0 / diagonal_px, 0.1, 0.7};
    for (int t = 0, out = 0; out < 200; t++) {
        L1L2Mat F;
        const L1L2ShutterMeasurement measurement = measurement_of(&swing, t, &F);
        const bool cut = t == 0 || t == 100;
        if (t < 200)
            push(filter, t, &F, cut || t % 17 == 0 ? NULL : &measurement, cut);
        if (t < WINDOW - 1)
            continue;
        const L1L2ShutterResidual *e = l1l2_shutter_filter_pull(filter);
        for (int k = 0; k < L1L2_SHUTTER_SIZE; k++)
            ck_assert_double_lt(fabs(e->p[k]), 10.0 / diagonal_px);
        out++;
    }
    l1l2_shutter_filter_free(filter);
}
END_TEST

/* All validation tests but one pass. */
START_TEST(a_residual_that_fails_one_validation_test_is_not_used)
{
    const int silent[] = {L1L2_SPLIT_HALVES, L1L2_SPLIT_COLUMNS, L1L2_VALIDATION_CAMERA};
    for (int i = 0; i < 3; i++) {
        L1L2ShutterFilter *filter = filter_new(L1L2STAB_ROLLING_SHUTTER_MIXTURE);
        const L1L2Mat F = l1l2_mat_translation(0.01, 0.0);
        L1L2ShutterMeasurement measurement = {
            {{0.001, 0.002, 0.003, 0.001}}, {0.9, 0.9, 0.9, 0.9}, {1.0, 1.0, 1.0, 1.0},
        };
        measurement.explained[silent[i]] = 0.0;
        for (int t = 0; t < WINDOW; t++)
            push(filter, t, &F, &measurement, t == 0);
        for (int t = 0; t < WINDOW; t++) {
            const L1L2ShutterResidual *e = l1l2_shutter_filter_pull(filter);
            for (int k = 0; k < L1L2_SHUTTER_SIZE; k++)
                ck_assert_double_eq(e->p[k], 0.0);
        }
        l1l2_shutter_filter_free(filter);
    }
}
END_TEST

START_TEST(the_shear_of_a_fast_pan_is_limited_to_3_percent)
{
    const L1L2ShutterModel model = {L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.5 * WIDTH / diagonal_px,
                                     0.5 * HEIGHT / diagonal_px, NULL};
    const Swing swing = {4.0 / diagonal_px, 0.06, 0.7};
    L1L2ShutterFilter *filter = filter_new(L1L2STAB_ROLLING_SHUTTER_MIXTURE);
    double most = 0.0;
    for (int t = 0, out = 0; out < 240; t++) {
        L1L2Mat F;
        const L1L2ShutterMeasurement measurement = measurement_of(&swing, t, &F);
        F.m[2] += 40.0 / diagonal_px; /* a shear of 28 px, 8 % */
        if (t < 240)
            push(filter, t, &F, t > 0 ? &measurement : NULL, t == 0);
        if (t < WINDOW - 1)
            continue;
        most = fmax(most, l1l2_shutter_residual_stretch(&model, l1l2_shutter_filter_pull(filter)));
        out++;
    }
    ck_assert_near(most, 0.03, 1e-9);
    l1l2_shutter_filter_free(filter);
}
END_TEST

START_TEST(a_residual_that_explains_nothing_is_not_used)
{
    L1L2ShutterFilter *filter = filter_new(L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY);
    const L1L2Mat F = l1l2_mat_translation(0.01, 0.0), map = l1l2_mat_similarity(0.9, 0.01, 3.0, 2.0);
    double reach;
    for (int t = 0; t < WINDOW; t++) {
        const L1L2ShutterMeasurement measurement = {
            {{0.001, 0.002, 0.003, 0.001}}, {-0.1, -0.1, -0.1, -0.1}, {1.0, 1.0, 1.0, 1.0},
        };
        push(filter, t, &F, &measurement, t == 0);
    }
    for (int t = 0; t < WINDOW; t++) {
        l1l2_shutter_filter_pull(filter);
        ck_assert_ptr_null(l1l2_shutter_filter_mesh(filter, &map, 1.0, &reach));
        ck_assert_double_eq(reach, 0.0);
    }
    l1l2_shutter_filter_free(filter);
}
END_TEST

START_TEST(a_filter_that_was_reset_is_as_good_as_new)
{
    const Swing swing = {4.0 / diagonal_px, 0.1, 0.7};
    L1L2ShutterFilter *filter = filter_new(L1L2STAB_ROLLING_SHUTTER_MIXTURE);
    L1L2ShutterResidual first[2];
    for (int run = 0; run < 2; run++) {
        for (int t = 0; t < WINDOW; t++) {
            L1L2Mat F;
            const L1L2ShutterMeasurement measurement = measurement_of(&swing, t, &F);
            push(filter, t, &F, &measurement, t == 0);
        }
        for (int t = 0; t < 30; t++)
            first[run] = *l1l2_shutter_filter_pull(filter);
        l1l2_shutter_filter_reset(filter);
    }
    ck_assert_mem_eq(&first[0], &first[1], sizeof first[0]);
    l1l2_shutter_filter_free(filter);
}
END_TEST

START_TEST(with_model_none_there_is_no_filter_and_all_functions_take_null)
{
    const L1L2ShutterFilterConfig cfg = config(L1L2STAB_ROLLING_SHUTTER_NONE);
    const L1L2Mat map = l1l2_mat_identity();
    L1L2ShutterFilter *filter;
    double reach = 1.0;
    ck_assert_int_eq(l1l2_shutter_filter_create(&filter, &cfg), L1L2STAB_OK);
    ck_assert_ptr_null(filter);
    l1l2_shutter_filter_reset(filter);
    l1l2_shutter_filter_push(filter, NULL, true);
    ck_assert_ptr_null(l1l2_shutter_filter_pull(filter));
    ck_assert_ptr_null(l1l2_shutter_filter_mesh(filter, &map, 1.0, &reach));
    ck_assert_double_eq(reach, 0.0);
    ck_assert_double_eq(l1l2_shutter_filter_readout(filter), 0.0);
    l1l2_shutter_filter_free(filter);
}
END_TEST

static double uniform(L1L2Rng *rng, double least, double most)
{
    return least + (most - least) * (l1l2_rng_below(rng, 1u << 30) / (double)(1u << 30));
}

static L1L2ShutterResidual random_residual(L1L2Rng *rng, double size)
{
    L1L2ShutterResidual r;
    for (int i = 0; i < L1L2_SHUTTER_SIZE; i++)
        r.p[i] = uniform(rng, -size, size);
    return r;
}

/* A random B_t whose crop window is inside the source, as a path's is. */
static L1L2Mat random_map(L1L2Rng *rng, double ratio)
{
    const L1L2PathCropWindow crop = l1l2_path_crop_window(WIDTH, HEIGHT, ratio, 4);
    /* One draw a statement: within a call C leaves their order to the compiler. */
    const double y = uniform(rng, -0.3, 0.3);
    const double x = uniform(rng, -0.3, 0.3);
    const double b = uniform(rng, -0.1, 0.1);
    const double a = uniform(rng, 0.9, 1.1);
    const L1L2Mat wild = l1l2_mat_similarity(a, b, x, y);
    const L1L2Mat B = l1l2_path_constraint_shrink(&crop, &wild);
    return l1l2_mat_mul(l1l2_mat_rescale(B, diagonal_px), l1l2_mat_diagonal(ratio, ratio));
}

/* Cells are bilinear, so it is enough to look at their nodes. */
START_TEST(no_sample_is_outside_the_source_for_10000_paths_and_residuals)
{
    L1L2Rng rng = l1l2_rng_seeded(3);
    L1L2WarpMesh mesh;
    ck_assert(l1l2_warp_mesh_init(&mesh, WIDTH, HEIGHT));
    for (int i = 0; i < 10000; i++) {
        const L1L2ShutterModel model = {i % 2 ? L1L2STAB_ROLLING_SHUTTER_MIXTURE : L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY,
                                         0.5 * WIDTH / diagonal_px, 0.5 * HEIGHT / diagonal_px, NULL};
        const double size = i % 5 == 0 ? 1.0 : i % 5 == 1 ? 0.05 : 0.005;
        const L1L2Mat map = random_map(&rng, uniform(&rng, 0.5, 0.99));
        const L1L2ShutterResidual r = random_residual(&rng, size);
        ck_assert_double_gt(l1l2_shutter_mesh_set(&mesh, &map, &model, &r, &source), 0.0);
        for (int k = 0; k < mesh.columns * mesh.rows; k++)
            if (!(fabs(mesh.node[k].x) <= 0.5 * WIDTH && fabs(mesh.node[k].y) <= 0.5 * HEIGHT))
                ck_abort_msg("case %d: node %d is at %.9g, %.9g", i, k, mesh.node[k].x, mesh.node[k].y);
    }
    l1l2_warp_mesh_clear(&mesh);
}
END_TEST

/* The residual moves over the border in small steps: no sample moves by more than that step. */
START_TEST(no_sample_jumps_where_the_residual_reaches_the_border)
{
    const L1L2ShutterModel model = {L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.5 * WIDTH / diagonal_px,
                                     0.5 * HEIGHT / diagonal_px, NULL};
    const L1L2Mat map = l1l2_mat_mul(l1l2_mat_translation(31.0, 0.0), l1l2_mat_diagonal(0.9, 0.9));
    L1L2WarpMesh mesh[2];
    double farthest = 0.0, inside = 0.0;
    ck_assert(l1l2_warp_mesh_init(&mesh[0], WIDTH, HEIGHT) && l1l2_warp_mesh_init(&mesh[1], WIDTH, HEIGHT));
    for (int i = 0; i <= 200; i++) {
        L1L2ShutterResidual r = {{0.0}};
        for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
            r.p[L1L2_SHUTTER_X + k] = -0.05 * i / diagonal_px; /* to the right, 0.05 px a step */
        r.p[L1L2_SHUTTER_PERSPECTIVE] = 1e-9;
        ck_assert_double_gt(l1l2_shutter_mesh_set(&mesh[i % 2], &map, &model, &r, &source), 0.0);
        for (int k = 0; i > 0 && k < mesh[0].columns * mesh[0].rows; k++) {
            const double way = fabs(mesh[1].node[k].x - mesh[0].node[k].x);
            farthest = fmax(farthest, way);
            if (mesh[0].node[k].x < 0.0)
                inside = fmax(inside, fabs(way - 0.05));
        }
    }
    ck_assert_double_lt(farthest, 0.0501);
    ck_assert_double_lt(inside, 1e-6);
    l1l2_warp_mesh_clear(&mesh[0]);
    l1l2_warp_mesh_clear(&mesh[1]);
}
END_TEST

START_TEST(a_residual_that_is_not_finite_gives_no_mesh)
{
    const L1L2ShutterModel model = {L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY, 0.4, 0.2, NULL};
    const L1L2Mat map = l1l2_mat_identity();
    L1L2ShutterResidual r = {{0.0}};
    L1L2WarpMesh mesh;
    ck_assert(l1l2_warp_mesh_init(&mesh, WIDTH, HEIGHT));
    r.p[2] = NAN;
    ck_assert_double_lt(l1l2_shutter_mesh_set(&mesh, &map, &model, &r, &source), 0.0);
    r.p[2] = 1e308;
    ck_assert_double_lt(l1l2_shutter_mesh_set(&mesh, &map, &model, &r, &source), 0.0);
    l1l2_warp_mesh_clear(&mesh);
}
END_TEST

/* A swing whose readout is known, then one frame that is not finite or has a huge motion, then the swing again. */
static double error_after(bool huge_motion, bool measurement_is_nan)
{
    const Swing swing = {4.0 / diagonal_px, 0.06, 0.7};
    L1L2ShutterFilter *filter = filter_new(L1L2STAB_ROLLING_SHUTTER_MIXTURE);
    double largest = 0.0;
    for (int t = 0, out = 0; out < 300; t++) {
        L1L2Mat F;
        L1L2ShutterMeasurement measurement = measurement_of(&swing, t, &F);
        const bool odd = t == 150;
        if (odd && huge_motion)
            F.m[2] = F.m[5] = 1e308;
        if (odd && measurement_is_nan)
            measurement.r.p[L1L2_SHUTTER_X + 3] = NAN;
        if (t < 300)
            push(filter, t, &F, t > 0 && !(odd && huge_motion) ? &measurement : NULL, t == 0);
        if (t < WINDOW - 1)
            continue;
        const L1L2ShutterResidual *e = l1l2_shutter_filter_pull(filter);
        double mean = 0.0;
        for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
            mean += camera_at(&swing, out + swing.readout * l1l2_shutter_band_row(k)) / L1L2_SHUTTER_BANDS;
        for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
            const double truth = camera_at(&swing, out + swing.readout * l1l2_shutter_band_row(k)) - mean;
            ck_assert(isfinite(e->p[L1L2_SHUTTER_X + k]));
            if (out >= 250)
                largest = fmax(largest, fabs(e->p[L1L2_SHUTTER_X + k] - truth));
        }
        out++;
    }
    l1l2_shutter_filter_free(filter);
    return largest * diagonal_px;
}

START_TEST(one_frame_of_huge_or_not_finite_numbers_is_forgotten)
{
    const double usual = error_after(false, false);
    ck_assert_double_lt(usual, 0.5);
    ck_assert_near(error_after(true, false), usual, 0.05);
    ck_assert_near(error_after(false, true), usual, 0.05);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("filter");
    TCase *tcase = tcase_create("filter");
    tcase_add_test(tcase, the_skew_of_each_frame_is_found_and_not_only_its_changes);
    tcase_add_test(tcase, the_readout_is_found_in_either_direction);
    tcase_add_test(tcase, frames_that_were_not_measured_and_cuts_leave_the_residual_bounded);
    tcase_add_test(tcase, a_residual_that_explains_nothing_is_not_used);
    tcase_add_test(tcase, a_residual_that_fails_one_validation_test_is_not_used);
    tcase_add_test(tcase, the_shear_of_a_fast_pan_is_limited_to_3_percent);
    tcase_add_test(tcase, a_filter_that_was_reset_is_as_good_as_new);
    tcase_add_test(tcase, with_model_none_there_is_no_filter_and_all_functions_take_null);
    tcase_add_test(tcase, no_sample_is_outside_the_source_for_10000_paths_and_residuals);
    tcase_add_test(tcase, no_sample_jumps_where_the_residual_reaches_the_border);
    tcase_add_test(tcase, a_residual_that_is_not_finite_gives_no_mesh);
    tcase_add_test(tcase, one_frame_of_huge_or_not_finite_numbers_is_forgotten);
    tcase_set_timeout(tcase, 60);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
