/* SPDX-License-Identifier: MIT */
/*
 * All tunable parameters of the motion module, in one table.
 *
 * Each row has a name, the default, its unit, what it does, and why it has this value. A unit of "threshold" means a
 * multiple of inlier_distance; "px" are pixels of the downscaled picture that is tracked. The benchmark
 * tests/bench/bench_parameters.c halves and doubles each one and prints what changes; "sweep" in the last column stands
 * for a run of it (320 px wide clips of 60 frames): the change of the root mean square error of F_t, over all cases
 * that change by 5 % or more, for half the value and for twice the value.
 *
 * Constants of the tracker's inner loop are in lucas_kanade.c, those of thumbnails in image/thumbnail.c, and the fixed
 * sizes of grids and buffers are where they are used.
 */
#ifndef L1L2_MOTION_PARAMETERS_H
#define L1L2_MOTION_PARAMETERS_H

/* clang-format off */
#define L1L2_MOTION_PARAMETERS(ROW) \
    /* Points and tracks: motion.c, vision_opencv.cpp */ \
    ROW(max_points, 200, "points", "tracked at a time, 512 at most", \
        "ten real clips: 150 are as good, 250 no better") \
    ROW(min_points_share, 0.5, "of max_points", "fewer left: new corners are selected at once", "@") \
    ROW(reselect_frames, 10, "frames", "new corners are selected this often", "Qu & Song, section 4.3") \
    ROW(point_distance, 12, "px", "minimum distance between points", \
        "Qu & Song, section 4.3, ask for one; at 20 px low-contrast frames have too few points") \
    ROW(point_grid, 0.4, "of a square grid's spacing", "ditto in pictures too small for that", "@") \
    ROW(min_point_distance, 3, "px", "same for tiny pictures", "@") \
    ROW(max_return_distance, 0.5, "px", "backward check: a track has to come back this close", "@") \
    ROW(backward_levels, 1, "pyramid levels", "above the picture, for the way back", \
        "a fifth faster than all levels, and half as many points more pass in fast pans") \
    ROW(corner_quality, 0.003, "of the strongest", "weaker corners are left out", \
        "at 0.01 a dark thing on snow leaves no point but its own") \
    ROW(same_contrast, 0.08, "log ratio", "smaller changes of contrast are left to the tracker", "@") \
    ROW(same_mean, 6, "gray levels", "ditto of the mean", "@") \
    ROW(flat_picture, 2, "gray levels", "standard deviation below which brightness is not matched", "@") \
    ROW(brightness_gain, 0.7, "of the difference", "matched pictures have to be nearer than this", "@") \
    ROW(bar_level, 40, "gray levels", "letterbox bars are no brighter", "@") \
    ROW(bar_range, 10, "gray levels", "and no less flat: compression noise", "@") \
    /* Consensus: ransac.c, model_selection.c */ \
    ROW(inlier_distance, 1.5, "px", "tracks this close to the motion are inliers", \
        "at 1 px parallax makes the fit flicker between surfaces, at 2 px slow subjects are let in") \
    ROW(min_scale, 0.8, "ratio", "a camera does not zoom by more in a frame", "MediaPipe's limit") \
    ROW(max_scale, 1.25, "ratio", "ditto", "MediaPipe's limit") \
    ROW(max_rotation, 0.25, "rad", "nor roll by more", "MediaPipe's limit") \
    ROW(min_inliers, 30, "tracks", "a similarity or affine map has to have", "MediaPipe's limit") \
    ROW(min_inlier_share, 0.2, "of the tracks", "ditto", "MediaPipe's limit") \
    ROW(translation_threshold, 2, "threshold", "inliers of a translation", "@") \
    ROW(translation_min_inliers, 8, "tracks", "a translation has to have", "@") \
    ROW(translation_min_share, 0.5, "of the tracks", "ditto", "@") \
    ROW(translation_max_spread, 0.5, "of its threshold", "rms residual of a translation's inliers", \
        "noise alone fills the circle evenly, which gives 0.71") \
    ROW(rows_max_inlier_share, 0.7, "of the tracks", "a similarity by rows is tried below it", "@") \
    ROW(return_inlier_factor, 1.5, "min_inliers", "a higher model is taken again at once with this many", "@") \
    ROW(return_frames, 3, "frames", "or after this many acceptable frames in a row", "@") \
    ROW(prediction_fade, 0.8, "a frame", "decay of the last motion while none is measured", "@") \
    ROW(max_predicted_frames, 15, "frames", "after them the camera is taken as still", "@") \
    /* Two motions among the tracks: model_selection.c */ \
    ROW(core_threshold, 0.3, "threshold", "inliers may be of two motions, each this tight", "@") \
    ROW(core_min_share, 0.5, "of the inliers", "the first of the two has to have, by weight", "@") \
    ROW(core_min_rest, 0.05, "of the inliers", "has to be left for the second", "@") \
    ROW(second_min_share, 0.8, "of the rest", "the second has to have", "@") \
    ROW(second_min_distance, 0.5, "threshold", "the two have to be apart", \
        "nearer, the fit flickers between surfaces of different depth") \
    ROW(rival_min_share, 0.1, "of the weight", "outliers with it are searched for another motion", "@") \
    ROW(rival_min_inliers, 8, "tracks", "another motion has to have", "@") \
    ROW(rival_distance, 4, "threshold", "nearer motions are other depths of one scene", "@") \
    ROW(min_quality, 0.12, "[0, 1]", "below it neither of two motions is followed", "@") \
    ROW(full_coverage, 0.3, "of the cells", "with inliers in them the frame counts as covered", "MediaPipe's 30 %") \
    /* Noise: model_selection.c */ \
    ROW(negligible_error, 0.035, "threshold", "standard errors below it do not matter", \
        "200 good tracks have 0.01") \
    ROW(significance, 3, "standard errors", "noise that a motion has to exceed", "@") \
    ROW(max_truncation, 3, "ratio", "most by which the error is raised for inliers beyond the threshold", "@") \
    ROW(still_frames, 15, "frames", "a camera without significant motion is held still after", "@") \
    ROW(still_significance, 4, "standard errors", "of the summed motion that end it", "@") \
    ROW(still_memory, 0.98, "a frame", "decay of that sum", "@") \
    /* Background and subject: track_weights.c, static_overlay.c */ \
    ROW(rim_weight, 8, "ratio", "extra weight of cells at the left, right and upper rim", "@") \
    ROW(age_weight, 3, "ratio", "weight of a track of age_frames against a new one", "@") \
    ROW(age_frames, 10, "frames", "with the camera until a track has full weight", "@") \
    ROW(min_cell_weight, 0.2, "ratio", "weight of cells in which no track agreed lately", "@") \
    ROW(learning_rate, 0.15, "a frame", "of the cells' agreement", "@") \
    ROW(overlay_max_motion, 0.15, "px", "a track that moves less stands still", "@") \
    ROW(overlay_min_camera, 2, "px", "camera motion from which that is evidence of an overlay", "@") \
    ROW(overlay_hits, 5, "tracks", "standing still in a cell make an overlay of it", "@") \
    ROW(overlay_max_hits, 20, "tracks", "remembered: selections of corners until it is forgotten", "@") \
    ROW(overlay_miss, 2, "tracks", "one that follows the camera counts against it", "@") \
    /* Dissolves: shot_dissolve.c */ \
    ROW(dissolve_same_shot, 0.5, "correlation", "pictures that are more alike are of one shot", "@") \
    ROW(dissolve_explained, 0.9, "of the variance", "of the picture between that the two explain", "@") \
    ROW(dissolve_min_part, 0.2, "of the picture", "each of the two has to have in it", "@") \
    ROW(dissolve_min_sum, 0.8, "of the picture", "both have to have together", "@") \
    ROW(dissolve_max_sum, 1.1, "of the picture", "ditto", \
        "a turning camera's picture keeps its contrast: 1.17 or more at this correlation") \
    ROW(dissolve_min_overlap, 0.5, "of the picture", "the three have to share", "@") \
    /* Which residuals of the rolling shutter are adopted: motion.c */ \
    ROW(residual_min_agreement, 0.8, "[0, 1]", "cells with less are left out of the residual's fit", "@") \
    ROW(residual_explained, 0.8, "of the residual", "validation has to explain in each split", \
        "a rolling shutter alone explains 0.97, parallax and slow subjects up to 0.77") \
    ROW(residual_explained_camera, 0.5, "of the residual", "ditto where the camera predicts residuals", "@") \
    ROW(camera_share, 0.3, "[0, 1]", "of the residuals that the camera has to predict for that", "@") \
    ROW(adopt_min_share, 0.85, "of the tracks", "that agree with the residual: it may replace the similarity", "@") \
    ROW(adopt_max_similarity, 0.7, "of these", "that agree with the similarity: else it stays", "@")
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
