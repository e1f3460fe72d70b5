/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "common/rng.h"
#include "rolling_shutter/camera_gate.h"

enum { FRAMES = 300 };
static const double pi = 3.14159265358979;
static const double px = 1.0 / 734.0; /* of 640x360 */
static const L1L2ShutterModel mixture = {L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.436, 0.245, NULL};

/* A hand's shake: position along one axis at a time in frames, px. */
static double hand(int axis, double time)
{
    return 3.0 * sin(0.13 * time + axis) + 2.0 * sin(0.4 * time + 2.0 * axis) + sin(0.9 * time + 3.0 * axis);
}

static L1L2Mat motion_at(double time, double strength)
{
    return l1l2_mat_translation(strength * px * (hand(0, time) - hand(0, time - 1.0)),
                                strength * px * (hand(1, time) - hand(1, time - 1.0)));
}

/* The residual of a rolling shutter: each row moves as the camera did when it was read, at t + readout * row. */
static L1L2ShutterResidual rows_at(int t, double readout)
{
    const L1L2Mat mean = motion_at(t, 1.0);
    L1L2ShutterResidual r = {{0.0}};
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++) {
        const L1L2Mat own = motion_at(t + readout * l1l2_shutter_band_row(k), 1.0);
        r.p[L1L2_SHUTTER_X + k] = own.m[2] - mean.m[2];
        r.p[L1L2_SHUTTER_Y + k] = own.m[5] - mean.m[5];
    }
    return r;
}

/* The residual of a subject that sways at the left side: 1 px of zoom and perspective. */
static L1L2ShutterResidual mover_at(int t)
{
    L1L2ShutterResidual r = {{0.0}};
    r.p[L1L2_SHUTTER_ZOOM] = 2.0 * px * sin(2.0 * pi * t / 70.0);
    r.p[L1L2_SHUTTER_PERSPECTIVE] = -2.0 * px * sin(2.0 * pi * t / 70.0);
    return r;
}

START_TEST(a_rolling_shutter_is_predicted_from_the_camera_in_either_readout_direction)
{
    const double readouts[] = {-0.9, 0.3, 1.0};
    for (int i = 0; i < 3; i++) {
        L1L2ShutterGate gate = {.known = 0};
        for (int t = 0; t < FRAMES; t++) {
            L1L2ShutterMeasurement measurement = {.r = rows_at(t, readouts[i])};
            const L1L2Mat F = motion_at(t, 1.0);
            l1l2_shutter_gate_push(&gate, &mixture, &F, &measurement);
        }
        ck_assert_double_gt(l1l2_shutter_gate_share(&gate), 0.9);
        ck_assert_double_le(l1l2_shutter_gate_share(&gate), 1.0);
    }
}
END_TEST

START_TEST(a_subject_that_moves_by_itself_is_not_predicted_from_the_camera)
{
    const double strengths[] = {1.0, 0.1, 0.0}; /* handheld, on a tripod, without motion */
    for (int i = 0; i < 3; i++) {
        L1L2ShutterGate gate = {.known = 0};
        double explained = 0.0, all = 0.0;
        for (int t = 0; t < FRAMES; t++) {
            L1L2ShutterMeasurement measurement = {.r = mover_at(t)};
            const L1L2Mat F = motion_at(t, strengths[i]);
            l1l2_shutter_gate_push(&gate, &mixture, &F, &measurement);
            explained += measurement.explained[L1L2_VALIDATION_CAMERA], all += measurement.all[L1L2_VALIDATION_CAMERA];
            /* A part of it may be predicted by chance for a while, but never enough for full confidence. */
            ck_assert_double_lt(l1l2_shutter_gate_share(&gate), 0.3);
        }
        ck_assert_double_lt(explained, 0.02 * all);
    }
}
END_TEST

START_TEST(the_result_of_a_frame_comes_two_frames_later)
{
    L1L2ShutterGate gate = {.known = 0};
    for (int t = 0; t < FRAMES; t++) {
        L1L2ShutterMeasurement measurement = {.r = rows_at(t, 0.7)};
        if (t < L1L2_SHUTTER_GATE_DELAY)
            memset(&measurement.r, 0, sizeof measurement.r);
        const L1L2Mat F = motion_at(t, 1.0);
        l1l2_shutter_gate_push(&gate, &mixture, &F, &measurement);
        ck_assert((measurement.all[L1L2_VALIDATION_CAMERA] > 0.0) == (t >= 2 * L1L2_SHUTTER_GATE_DELAY));
    }
}
END_TEST

START_TEST(the_regression_outlives_a_cut_but_no_frame_is_predicted_across_it)
{
    L1L2ShutterGate gate = {.known = 0};
    for (int t = 0; t < FRAMES; t++) {
        L1L2ShutterMeasurement measurement = {.r = rows_at(t, 0.7)};
        const L1L2Mat F = motion_at(t, 1.0);
        if (t == 200)
            l1l2_shutter_gate_break(&gate);
        l1l2_shutter_gate_push(&gate, &mixture, &F, &measurement);
        if (t >= 200 && t < 204)
            ck_assert_double_eq(l1l2_shutter_gate_share(&gate), 0.0);
        if (t >= 204)
            ck_assert_double_gt(l1l2_shutter_gate_share(&gate), 0.8);
    }
}
END_TEST

START_TEST(the_stretch_of_a_shear_is_its_tangent_and_of_a_similarity_zero)
{
    const L1L2ShutterModel homography = {L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY, 0.436, 0.245, NULL};
    const L1L2ShutterResidual shear = {{0.0, 0.03}}, longer = {{0.02, 0.0, 0.0, 0.0, -0.01}};
    const L1L2ShutterResidual similar = {{0.02, -0.01, 0.1, 0.01, 0.02, 0.2}};
    L1L2ShutterResidual rows = {{0.0}};
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
        rows.p[L1L2_SHUTTER_X + k] = 0.03 * l1l2_shutter_band_row(k) * 2.0 * mixture.half_h;
    ck_assert_near(l1l2_shutter_residual_stretch(&homography, &shear), 0.03, 1e-12);
    ck_assert_near(l1l2_shutter_residual_stretch(&homography, &longer), 0.03, 1e-12);
    ck_assert_near(l1l2_shutter_residual_stretch(&homography, &similar), 0.0, 1e-12);
    /* The Gaussian weights flatten the first and last rows. */
    ck_assert_near(l1l2_shutter_residual_stretch(&mixture, &rows), 0.03, 0.003);
}
END_TEST

/* One NaN would stay in the sums of the regression for good. */
START_TEST(a_frame_that_is_not_finite_is_a_discontinuity_and_spoils_nothing)
{
    for (int which = 0; which < 2; which++) {
        L1L2ShutterGate gate = {.known = 0};
        for (int t = 0; t < FRAMES; t++) {
            L1L2ShutterMeasurement measurement = {.r = rows_at(t, 0.7)};
            L1L2Mat F = motion_at(t, 1.0);
            if (t == 200 && which == 0)
                measurement.r.p[L1L2_SHUTTER_ZOOM] = NAN;
            if (t == 200 && which == 1)
                F.m[2] = INFINITY;
            l1l2_shutter_gate_push(&gate, &mixture, &F, &measurement);
            if (t >= 200 && t < 205)
                ck_assert_double_eq(l1l2_shutter_gate_share(&gate), 0.0);
            if (t >= 205)
                ck_assert_double_gt(l1l2_shutter_gate_share(&gate), 0.8);
        }
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("camera_gate");
    TCase *tcase = tcase_create("camera_gate");
    tcase_add_test(tcase, a_rolling_shutter_is_predicted_from_the_camera_in_either_readout_direction);
    tcase_add_test(tcase, a_subject_that_moves_by_itself_is_not_predicted_from_the_camera);
    tcase_add_test(tcase, the_result_of_a_frame_comes_two_frames_later);
    tcase_add_test(tcase, the_regression_outlives_a_cut_but_no_frame_is_predicted_across_it);
    tcase_add_test(tcase, the_stretch_of_a_shear_is_its_tangent_and_of_a_similarity_zero);
    tcase_add_test(tcase, a_frame_that_is_not_finite_is_a_discontinuity_and_spoils_nothing);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
