/* SPDX-License-Identifier: MIT */
/*
 * All tunable parameters of the motion module, in one table.
 *
 * Each row has a name, the default, its unit, what it does, and why it has this value. A unit of "threshold" means a
 * multiple of inlier_distance; "px" are pixels of the downscaled picture that is tracked.
 *
 * "sweep" in the last column stands for the benchmark tests/bench/bench_parameters.c, which halves and doubles the
 * value: by how much the error of F_t grows, as the geometric mean over its 16 synthetic clips; how many more motions
 * are lost and paths started; and the clip that changes most. "same" means that no motion of any clip changes. A value
 * that is near an optimum for most clips and matters for one shows as a factor near 1.
 *
 * Constants of the tracker's inner loop are in lucas_kanade.c, those of thumbnails in image/thumbnail.c. A value whose
 * half and double change no clip is a constant of its file.
 */
#ifndef L1L2_MOTION_PARAMETERS_H
#define L1L2_MOTION_PARAMETERS_H

/* clang-format off */
#define L1L2_MOTION_PARAMETERS(ROW) \
    /* Points and tracks: motion.c, vision_opencv.cpp */ \
    ROW(max_points, 200, "points", "tracked at a time, 512 at most", \
        "ten real clips: 150 are as good, 250 no better") \
    ROW(min_points_share, 0.5, "of max_points", "fewer left: new corners are selected at once", \
        "sweep: half x1.06 lost +1, double x0.92 lost -1; most: shake 20 px, shutter open") \
    ROW(reselect_frames, 10, "frames", "new corners are selected this often", "Qu & Song, section 4.3") \
    ROW(point_distance, 12, "px", "minimum distance between points", \
        "Qu & Song, section 4.3, ask for one; at 20 px low-contrast frames have too few points") \
    ROW(point_grid, 0.4, "of a square grid's spacing", "ditto in pictures too small for that", \
        "sweep: half x0.98 lost -1, double same; most: logo and timecode, dark") \
    ROW(max_return_distance, 0.5, "px", "backward check: a track has to come back this close", \
        "sweep: half x1.12 lost +6, double x0.98 lost -1; most: shake 20 px, shutter open") \
    ROW(backward_levels, 1, "pyramid levels", "above the picture, for the way back", \
        "a fifth faster than all levels, and half as many points more pass in fast pans") \
    ROW(corner_quality, 0.003, "of the strongest", "weaker corners are left out", \
        "at 0.01 a dark thing on snow leaves no point but its own") \
    ROW(same_mean, 6, "gray levels", "smaller changes of the mean are left to the tracker", \
        "half same, double on clips with flicker and fades: error x1.02") \
    ROW(flat_picture, 2, "gray levels", "standard deviation below which brightness is not matched", \
        "half same, double on clips with flicker and fades: 2 more motions lost") \
    ROW(brightness_gain, 0.7, "of the difference", "matched pictures have to be nearer than this", \
        "half on clips with flicker and fades: error x1.12") \
    ROW(bar_level, 40, "gray levels", "letterbox bars are no brighter", \
        "sweep: half x1.00, double same; most: letterbox") \
    ROW(bar_range, 10, "gray levels", "and no less flat: compression noise", \
        "sweep: half x1.00, double x1.00; most: logo and timecode, dark") \
    /* Consensus: ransac.c, model_selection.c */ \
    ROW(inlier_distance, 1.5, "px", "tracks this close to the motion are inliers", \
        "at 1 px parallax makes the fit flicker between surfaces, at 2 px slow subjects are let in") \
    ROW(min_scale, 0.8, "ratio", "a camera does not zoom by more in a frame", "MediaPipe's limit") \
    ROW(max_scale, 1.25, "ratio", "ditto", "MediaPipe's limit") \
    ROW(max_rotation, 0.25, "rad", "nor roll by more", \
        "MediaPipe's limit; sweep: same, no clip rolls by so much") \
    ROW(min_inliers, 30, "tracks", "a similarity or affine map has to have", "MediaPipe's limit") \
    ROW(min_inlier_share, 0.2, "of the tracks", "ditto", "MediaPipe's limit") \
    ROW(translation_threshold, 2, "threshold", "inliers of a translation", \
        "sweep: half x1.00 lost +1, double x0.99 lost -3; most: shake 20 px, shutter open") \
    ROW(translation_min_inliers, 8, "tracks", "a translation has to have", \
        "sweep: same; half on a covered lens: 3 fewer motions lost, none more exact") \
    ROW(translation_min_share, 0.5, "of the tracks", "ditto", \
        "sweep: half same, double x1.00 lost +1; most: shake 20 px, shutter open") \
    ROW(translation_max_spread, 0.5, "of its threshold", "rms residual of a translation's inliers", \
        "noise alone fills the circle evenly, which gives 0.71") \
    ROW(rows_max_inlier_share, 0.7, "of the tracks", "a similarity by rows is tried below it", \
        "sweep: half x1.02, double x0.92; most: walking, rolling shutter") \
    ROW(return_inlier_factor, 1.5, "min_inliers", "a higher model is taken again at once with this many", \
        "sweep: half same, double x1.00; most: shake 20 px, shutter open") \
    ROW(return_frames, 3, "frames", "or after this many acceptable frames in a row", \
        "test_model_selection: at 1 the model would change from frame to frame; sweep: same") \
    ROW(prediction_fade, 0.8, "a frame", "decay of the last motion while none is measured", \
        "sweep: half x0.99, double x1.24; most: cut through black") \
    ROW(max_predicted_frames, 15, "frames", "after them the camera is taken as still", \
        "sweep: half x1.00, double same; most: cut through black") \
    /* Two motions among the tracks: model_selection.c */ \
    ROW(core_threshold, 0.3, "threshold", "inliers may be of two motions, each this tight", \
        "sweep: half x1.09, double x0.99; most: mover on 60 %") \
    ROW(core_min_share, 0.5, "of the inliers", "the first of the two has to have, by weight", \
        "sweep: half x1.01, double x1.27; most: mover on 60 %") \
    ROW(core_min_rest, 0.05, "of the inliers", "has to be left for the second", \
        "sweep: half x0.98, double x1.01; most: mover on 60 %") \
    ROW(second_min_share, 0.8, "of the rest", "the second has to have", \
        "sweep: half x0.93, double x1.10; most: mover on 60 %") \
    ROW(second_min_distance, 0.5, "threshold", "the two have to be apart", \
        "nearer, the fit flickers between surfaces of different depth") \
    ROW(rival_min_share, 0.1, "of the weight", "outliers with it are searched for another motion", \
        "sweep: half x1.00, double x1.00; most: logo and timecode, dark") \
    ROW(rival_distance, 4, "threshold", "nearer motions are other depths of one scene", \
        "sweep: motions same, mean quality -0.012 for half, +0.007 for double") \
    ROW(rival_memory, 0.965, "a frame", "decay of what another motion had", \
        "test_motion_movers: a subject on 60 % is as fast as the camera now and then") \
    ROW(min_quality, 0.12, "[0, 1]", "below it neither of two motions is followed", \
        "test_model_selection: two motions of equal weight have less; sweep: same") \
    ROW(many_tracks, 80, "tracks", "with so many, the likelier of two motions is followed", \
        "a walk down steps: 174 sharp tracks were given up, which left a step of 20 px") \
    ROW(full_coverage, 0.3, "of the cells", "with inliers in them the frame counts as covered", \
        "MediaPipe's 30 %") \
    /* Whole pictures: motion.c, whole_picture.c */ \
    ROW(align_max_quality, 0.4, "[0, 1]", "of a motion from whole pictures", \
        "test_motion_movers: a subject on 60 % must not be followed with confidence") \
    ROW(align_below_quality, 0.4, "[0, 1]", "of the tracks' motion: below it whole pictures are asked", \
        "blurred pan: jitter 2.0 px without, 1.5 with; staying with whole pictures up to 0.7 is no better") \
    ROW(align_max_inlier_share, 0.7, "of the tracks", "that agree: with more, whole pictures are not asked", \
        "whole pictures in every frame: two walks 0.31 to 0.54 and 0.64 to 0.83 px of jitter") \
    ROW(align_better, 0.97, "of the difference", "that the tracks' motion leaves: whole pictures have to beat it", \
        "blurred pan, a run: jitter 1.41, 0.60 px; at 0.9 1.65, 0.64, at 1 1.41, 0.66") \
    ROW(contradicted_better, 0.85, "of the difference", "ditto, where the tracks may be on an overlay", \
        "24 texts over a film: 0.40 px off; at 0.7 0.46, at 0.95 same; mover and tripod: shakes at 0.97") \
    ROW(uniform_motion, 0.2, "threshold", "a motion that repeats changes by less", \
        "24 texts over a film: half same, double 0.38 in place of 0.40 px") \
    ROW(align_max_gain, 0.4, "log ratio", "of contrast between two whole pictures: else one is covered", \
        "test_never_worse: lens covered 2 s") \
    /* Noise: model_selection.c */ \
    ROW(negligible_error, 0.035, "threshold", "standard errors below it do not matter", \
        "200 good tracks have 0.01") \
    ROW(significance, 3, "standard errors", "noise that a motion has to exceed", \
        "sweep: half x0.99, double x1.05; most: logo and timecode, dark") \
    ROW(max_truncation, 3, "ratio", "most by which the error is raised for inliers beyond the threshold", \
        "sweep: half x0.99, double x1.01; most: mover on 60 %") \
    ROW(still_frames, 15, "frames", "a camera without significant motion is held still after", \
        "sweep: half x0.99, double x1.01; most: tripod") \
    ROW(still_significance, 4, "standard errors", "of the summed motion that end it", \
        "test_motion_truth: a tripod stays in place for 1000 frames; sweep: same") \
    ROW(still_memory, 0.98, "a frame", "decay of that sum", \
        "sweep: half same, double x1.02; most: tripod") \
    /* Background and subject: track_weights.c, static_overlay.c */ \
    ROW(rim_weight, 8, "ratio", "extra weight of cells at the left, right and upper rim", \
        "sweep: half x0.97, double x0.98; most: walking, some depth") \
    ROW(age_weight, 3, "ratio", "weight of a track of age_frames against a new one", \
        "sweep: half x0.98, double x0.98; most: mover on 60 %") \
    ROW(age_frames, 10, "frames", "with the camera until a track has full weight", \
        "sweep: half x1.00, double x1.12; most: mover on 60 %") \
    ROW(min_cell_weight, 0.2, "ratio", "weight of cells in which no track agreed lately", \
        "sweep: half x0.98, double x1.10; most: mover on 60 %") \
    ROW(learning_rate, 0.15, "a frame", "of the cells' agreement", \
        "sweep: half x1.12, double x0.99; most: mover on 60 %") \
    ROW(overlay_min_camera, 0.5, "px", "camera motion from which that is evidence of an overlay", \
        "24 texts over a film: half 0.39, double 0.58 px, against 0.40") \
    ROW(overlay_hits, 5, "frames", "in which a pixel stood still make an overlay of it", \
        "24 texts, specks, credits: 0.40, 0.12, 0.62 px off; 3: 0.35, 0.09, 0.33, but test_shutter fails; 10: 0.54") \
    ROW(overlay_noise, 4, "gray levels", "what stands still changes by less, what moves by more than twice of it", \
        "24 texts, 250 specks, credits: half 0.37, 0.12, 0.71 px, double 0.40, 0.16, 0.44, against 0.40, 0.12, 0.62") \
    /* Dissolves: shot_dissolve.c */ \
    ROW(dissolve_same_shot, 0.5, "correlation", "pictures that are more alike are of one shot", \
        "sweep: half x1.00, double same; most: dissolve of 10") \
    ROW(dissolve_explained, 0.9, "of the variance", "of the picture between that the two explain", \
        "sweep: half same, double x1.01 starts -1; most: dissolve of 10") \
    ROW(dissolve_min_sum, 0.8, "of the picture", "both have to have together", \
        "sweep: half same, double x1.01 starts -1; most: dissolve of 10") \
    ROW(dissolve_max_sum, 1.1, "of the picture", "ditto", \
        "a turning camera's picture keeps its contrast: 1.17 or more at this correlation") \
    /* Which residuals of the rolling shutter are adopted: motion.c */ \
    ROW(residual_min_agreement, 0.8, "[0, 1]", "cells with less are left out of the residual's fit", \
        "sweep: half same, double x1.00; most: engine 20 Hz, rolling shutter") \
    ROW(residual_explained, 0.8, "of the residual", "validation has to explain in each split", \
        "a rolling shutter alone explains 0.97, parallax and slow subjects up to 0.77") \
    ROW(residual_explained_camera, 0.5, "of the residual", "ditto where the camera predicts residuals", \
        "sweep: half same, double x1.00; most: engine 20 Hz, rolling shutter") \
    ROW(camera_share, 0.3, "[0, 1]", "of the residuals that the camera has to predict for that", \
        "sweep: half x1.00, double same; most: walking, some depth") \
    ROW(adopt_min_share, 0.85, "of the tracks", "that agree with the residual: it may replace the similarity", \
        "sweep: half same, double x1.00; most: engine 20 Hz, rolling shutter") \
    ROW(adopt_max_similarity, 0.7, "of these", "that agree with the similarity: else it stays", \
        "sweep: half x1.00, double x1.03; most: engine 20 Hz, rolling shutter")
/* clang-format on */

#define L1L2_MOTION_FIELD(name, value, unit, effect, evidence) double name;
typedef struct L1L2MotionParameters {
    L1L2_MOTION_PARAMETERS(L1L2_MOTION_FIELD)
} L1L2MotionParameters;
#undef L1L2_MOTION_FIELD

#ifdef __cplusplus
extern "C" {
#endif

/* The defaults: the table's values. */
extern const L1L2MotionParameters l1l2_motion_defaults;

#ifdef __cplusplus
}
#endif

#endif
