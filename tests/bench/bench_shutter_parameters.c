/* SPDX-License-Identifier: MIT */
/*
 * What each parameter of rolling_shutter/parameters.h does: each is halved and doubled in turn, on simulated tracks.
 *
 * A simulated clip has a handheld camera with a rolling shutter (tests/support/synth.h), 200 tracks a frame at random
 * places with 0.15 px of noise, and one track in ten that is wrong by up to 20 px. The tracks go through the fit, the
 * camera gate and the filter. No picture is rendered, so a clip takes a fraction of a second.
 *
 *   wobble  change from frame to frame of what no similarity explains of the corrected frame, rms over the frame, px
 *   skew    the same in each frame, px
 *   reach   longest correction, px: with a global shutter, or a subject that moves slowly by itself, it should be 0
 *   edge    where the mesh crosses the border: part of the correction that the compression takes away, and the least
 *           local scale of the mesh
 *   rows    frames of 100 that similarity_by_rows.c accepts: all should be of a strong vibration, none of two surfaces
 *
 * With a clip as input, its tracks are fitted once by motion.c, and the camera gate and the filter run again for each
 * value of their parameters. Printed is by how much the residual changes, rms over the frames, px, and the default's
 * rms.
 *
 * usage: bench_shutter_parameters [PARAMETER]    All parameters, or one. Prints the results that differ by 3 % or more
 *        from those of the defaults, and names the parameters without such a result.
 *        gst-launch-1.0 -q filesrc location=CLIP ! decodebin ! videoconvert ! video/x-raw,format=GRAY8 ! fdsink |
 *        bench_shutter_parameters WIDTH HEIGHT      (WIDTH a multiple of 4: rows without padding)
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/rng.h"
#include "fit/least_squares.h"
#include "motion/motion.h"
#include "rolling_shutter/camera_gate.h"
#include "rolling_shutter/filter.h"
#include "rolling_shutter/fit.h"
#include "rolling_shutter/mesh.h"
#include "rolling_shutter/similarity_by_rows.h"
#include "synth.h"

enum { WIDTH = 640, HEIGHT = 360, TRACKS = 200, FRAMES = 120, WINDOW = 60, SETTLED = 40, COLUMNS = 7, ROWS = 9 };
enum { POINTS = COLUMNS * ROWS };
static const double noise_px = 0.15, wrong_px = 20.0, threshold_px = 1.5;

typedef struct Clip {
    const char *name;
    double readout_ms, vibration_px, vibration_hz, pan_px;
    L1L2StabRollingShutter model;
    double mover_px;   /* a subject at the left 40 % of the frame: amplitude of its own motion, px/frame */
    int unmeasured;    /* every so many frames there are no tracks; 0: never */
    bool start;        /* a short clip with little look-ahead, measured from its first frame */
    int seed;          /* of the camera's shake, and the phase of the subject's motion */
} Clip;

static const Clip clips[] = {
    {"20 ms, 10 Hz", 20.0, 2.0, 10.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.0, 0, false, 1},
    {"33 ms, 20 Hz", 33.0, 2.0, 20.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.0, 0, false, 1},
    {"27 ms, gaps", 27.0, 1.0, 6.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.0, 7, false, 1},
    {"33 ms, fast pan", 33.0, 0.0, 0.0, 35.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.0, 0, false, 1},
    {"homography", 27.0, 1.0, 6.0, 0.0, L1L2STAB_ROLLING_SHUTTER_HOMOGRAPHY, 0.0, 0, false, 1},
    {"global shutter", 0.0, 1.0, 10.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.0, 0, false, 1},
    {"slow subject", 0.0, 0.0, 0.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 1.2, 0, false, 1},
    {"start", 27.0, 0.0, 0.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.0, 0, true, 1},
    {"start, subject 1", 0.0, 0.0, 0.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 1.2, 0, true, 2},
    {"start, subject 2", 0.0, 0.0, 0.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 1.2, 0, true, 5},
    {"start, subject 3", 0.0, 0.0, 0.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 1.2, 0, true, 9},
    {"shutter and subject", 27.0, 0.0, 0.0, 0.0, L1L2STAB_ROLLING_SHUTTER_MIXTURE, 1.0, 0, false, 1},
};
enum { CLIPS = sizeof clips / sizeof *clips, RESULTS = 3 * CLIPS + 4 };

/* What is the same in all runs of a clip. */
typedef struct Recording {
    Synth *synth;
    L1L2Pair pair[FRAMES][TRACKS];
    bool inlier[FRAMES][TRACKS];
    L1L2Mat F[FRAMES];
} Recording;

typedef struct Swept {
    const char *name;
    size_t offset;
    int numbers; /* 2: both ends of a ramp, which are swept together so that it stays a ramp */
} Swept;

#define REAL(field) {#field, offsetof(L1L2ShutterParameters, field), 1}
#define RAMP(field) {#field, offsetof(L1L2ShutterParameters, field), 2}
static const Swept table[] = {
    REAL(bend_weight), REAL(translation_weight), REAL(linear_weight), REAL(wide_scale), REAL(narrow_scale),
    REAL(min_coverage), REAL(gate_ridge), REAL(gate_arm), REAL(leak), REAL(unmeasured_weight),
    REAL(confidence_fade), RAMP(halves), RAMP(columns), RAMP(camera), REAL(max_reach), REAL(max_stretch),
    RAMP(readout_agreement), REAL(max_readout), RAMP(readout_too_long), REAL(compress_zone),
    REAL(rows_unexplained), REAL(rows_cap), REAL(rows_max_jump),
};
enum { SWEPT = sizeof table / sizeof *table };

static double diagonal_px(void)
{
    return hypot(WIDTH, HEIGHT);
}

static double uniform(L1L2Rng *rng, double least, double most)
{
    return least + (most - least) * (l1l2_rng_below(rng, 1u << 30) / (double)(1u << 30));
}

static double noise(L1L2Rng *rng)
{
    return noise_px * (uniform(rng, -1, 1) + uniform(rng, -1, 1) + uniform(rng, -1, 1));
}

static L1L2Mat camera_at(const Synth *synth, double time)
{
    double M[9];
    L1L2Mat camera;
    synth_camera_at(synth, time, M);
    memcpy(camera.m, M, sizeof M);
    return camera;
}

/* The scene's point that frame t shows at p, px. */
static L1L2Point seen(const Synth *synth, int t, L1L2Point p)
{
    const L1L2Mat camera = camera_at(synth, synth_row_time(synth, t, p.y));
    return l1l2_mat_apply(&camera, p);
}

/* Where frame t shows a point of the scene, px: by fixed-point iteration over the row. */
static L1L2Point place(const Synth *synth, int t, L1L2Point scene, L1L2Point p)
{
    for (int k = 0; k < 8; k++) {
        L1L2Mat inverse;
        if (!l1l2_mat_inverse(camera_at(synth, synth_row_time(synth, t, p.y)), &inverse))
            exit(EXIT_FAILURE);
        p = l1l2_mat_apply(&inverse, scene);
    }
    return p;
}

/* The tracks from frame t to frame t-1, in diagonals; those of the subject and the wrong ones are not `good`. */
static void make_tracks(const Synth *synth, const Clip *clip, int t, L1L2Rng *rng, L1L2Pair *pair, bool *good)
{
    const double unit = 1.0 / diagonal_px(), own = clip->mover_px * sin(t / 9.0 + clip->seed);
    for (int i = 0; i < TRACKS; i++) {
        const L1L2Point p = {uniform(rng, -0.5, 0.5) * WIDTH, uniform(rng, -0.5, 0.5) * HEIGHT};
        L1L2Point q = place(synth, t - 1, seen(synth, t, p), p);
        const bool wrong = i % 10 == 3, subject = clip->mover_px > 0.0 && p.x < -0.1 * WIDTH;
        q.x += noise(rng) + (wrong ? uniform(rng, -wrong_px, wrong_px) : 0.0) + (subject ? own : 0.0);
        q.y += noise(rng);
        pair[i] = (L1L2Pair){{p.x * unit, p.y * unit}, {q.x * unit, q.y * unit}};
        good[i] = !wrong && !subject;
    }
}

/* F, and which tracks agree with it: as motion.c does, within three thresholds where few agree within one. */
static L1L2Mat fit_motion(const L1L2Pair *pair, const bool *good, bool *inlier)
{
    double weights[TRACKS];
    L1L2Mat F;
    for (int i = 0; i < TRACKS; i++)
        weights[i] = good[i];
    if (!l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, pair, weights, TRACKS, &F))
        exit(EXIT_FAILURE);
    for (int wide = 1, agreeing = 0; wide <= 3 && agreeing < 0.7 * TRACKS; wide += 2) {
        agreeing = 0;
        for (int i = 0; i < TRACKS; i++) {
            const L1L2Point at = l1l2_mat_apply(&F, pair[i].from);
            inlier[i] = hypot(at.x - pair[i].to.x, at.y - pair[i].to.y) * diagonal_px() <= wide * threshold_px;
            agreeing += inlier[i];
        }
    }
    return F;
}

static L1L2Point grid_point(int i)
{
    return (L1L2Point){(i % COLUMNS / (COLUMNS - 1.0) - 0.5) * 0.9 * WIDTH,
                       (i / COLUMNS / (ROWS - 1.0) - 0.5) * 0.9 * HEIGHT};
}

/* What no similarity explains of the frame after its correction: error[i] at grid point i, px. */
static void skew_of(const Synth *synth, int t, const L1L2ShutterModel *model, const L1L2ShutterResidual *e,
                    L1L2Point error[POINTS])
{
    const double unit = 1.0 / diagonal_px();
    L1L2Pair pairs[POINTS];
    L1L2Mat nearest;
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point u = grid_point(i);
        L1L2Point p = {u.x * unit, u.y * unit};
        for (int k = 0; k < 4; k++) {
            const L1L2Point d = l1l2_shutter_residual_at(model, e, p);
            p = (L1L2Point){u.x * unit - d.x, u.y * unit - d.y};
        }
        pairs[i] = (L1L2Pair){u, seen(synth, t, (L1L2Point){p.x / unit, p.y / unit})};
    }
    if (!l1l2_fit(L1L2STAB_MOTION_MODEL_SIMILARITY, pairs, NULL, POINTS, &nearest))
        exit(EXIT_FAILURE);
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point at = l1l2_mat_apply(&nearest, pairs[i].from);
        error[i] = (L1L2Point){pairs[i].to.x - at.x, pairs[i].to.y - at.y};
    }
}

static Recording *record(const Clip *clip)
{
    SynthConfig scene = synth_defaults();
    scene.width = WIDTH, scene.height = HEIGHT;
    scene.readout = clip->readout_ms / 1000.0;
    scene.vibration = clip->vibration_px, scene.vibration_hz = clip->vibration_hz;
    scene.pan_x = clip->pan_px;
    scene.seed = (uint64_t)clip->seed;
    Recording *recording = calloc(1, sizeof *recording);
    if (!recording)
        exit(EXIT_FAILURE);
    recording->synth = synth_new(&scene);
    L1L2Rng rng = l1l2_rng_seeded(11);
    for (int t = 0; t < FRAMES; t++) {
        bool good[TRACKS];
        make_tracks(recording->synth, clip, t, &rng, recording->pair[t], good);
        recording->F[t] = fit_motion(recording->pair[t], good, recording->inlier[t]);
    }
    return recording;
}

/* result: wobble, skew, reach. */
static void run_clip(const Clip *clip, const Recording *recording, const L1L2ShutterParameters *parameters,
                     double result[3])
{
    const L1L2ShutterModel model = {clip->model, 0.5 * WIDTH / diagonal_px(), 0.5 * HEIGHT / diagonal_px(), parameters};
    const int frames = clip->start ? 48 : FRAMES, settled = clip->start ? 1 : SETTLED;
    const int window = clip->start ? 24 : WINDOW;
    enum { RECORDS = WINDOW + L1L2_SHUTTER_FILTER_PAST };
    static L1L2Mat motions[RECORDS];
    static L1L2ShutterFrame rows[RECORDS];
    const L1L2ShutterFilterConfig cfg = {clip->model, WIDTH, HEIGHT, WIDTH, HEIGHT, window, parameters,
                                         {motions, sizeof *motions, RECORDS}, {rows, sizeof *rows, RECORDS}, 1.0,
                                         false};
    L1L2ShutterFilter *filter;
    if (l1l2_shutter_filter_create(&filter, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    static L1L2ShutterGate gate;
    memset(&gate, 0, sizeof gate);
    L1L2Point error[2][POINTS];
    double wobble = 0.0, skew = 0.0, reach = 0.0;
    for (int t = 0, out = 0; out < frames; t++) {
        if (t < frames) {
            bool inlier[TRACKS];
            L1L2ShutterMeasurement measurement;
            const L1L2Mat F = recording->F[t];
            memcpy(inlier, recording->inlier[t], sizeof inlier);
            const bool measured = t > 0 && !(clip->unmeasured && t % clip->unmeasured == 0) &&
                                  l1l2_shutter_fit(&model, recording->pair[t], TRACKS, threshold_px / diagonal_px(),
                                                   inlier, &F, &measurement) > 0;
            if (measured)
                l1l2_shutter_gate_push(&gate, &model, &F, &measurement);
            else
                l1l2_shutter_gate_break(&gate);
            motions[t % RECORDS] = t > 0 ? F : l1l2_mat_identity();
            l1l2_shutter_filter_push(filter, measured ? &measurement : NULL, t == 0);
        }
        if (t < window - 1)
            continue;
        const L1L2ShutterResidual *e = l1l2_shutter_filter_pull(filter);
        skew_of(recording->synth, out, &model, e, error[out % 2]);
        for (int i = 0; i < POINTS && out >= settled; i++) {
            const L1L2Point now = error[out % 2][i], before = error[(out + 1) % 2][i];
            wobble += (now.x - before.x) * (now.x - before.x) + (now.y - before.y) * (now.y - before.y);
            skew += now.x * now.x + now.y * now.y;
        }
        reach = fmax(reach, l1l2_shutter_residual_reach(&model, e) * diagonal_px());
        out++;
    }
    result[0] = sqrt(wobble / (POINTS * (frames - settled)));
    result[1] = sqrt(skew / (POINTS * (frames - settled)));
    result[2] = reach;
    l1l2_shutter_filter_free(filter);
}

/* A residual of 10 px at the frame's edge, where the crop window touches the left border: result[0] is the part of the
 * correction that the compression takes away, rms over the nodes; result[1] the least local scale. */
static void run_edge(const L1L2ShutterParameters *parameters, double result[2])
{
    const double unit = 1.0 / diagonal_px(), crop = 0.9;
    const L1L2ShutterModel model = {L1L2STAB_ROLLING_SHUTTER_MIXTURE, 0.5 * WIDTH * unit, 0.5 * HEIGHT * unit,
                                    parameters};
    const L1L2Mat map = l1l2_mat_mul(l1l2_mat_translation(-0.05 * WIDTH, 0.0), l1l2_mat_diagonal(crop, crop));
    L1L2ShutterResidual residual = {{0.0}};
    L1L2WarpMesh mesh, plain;
    for (int k = 0; k < L1L2_SHUTTER_BANDS; k++)
        residual.p[L1L2_SHUTTER_X + k] = 20.0 * unit * l1l2_shutter_band_row(k);
    if (!l1l2_warp_mesh_init(&mesh, WIDTH, HEIGHT) || !l1l2_warp_mesh_init(&plain, WIDTH, HEIGHT))
        exit(EXIT_FAILURE);
    l1l2_warp_mesh_set(&plain, &map);
    l1l2_shutter_mesh_set(&mesh, &map, &model, &residual, &(L1L2ShutterSource){WIDTH, HEIGHT, 1.0, false});
    double lost = 0.0, all = 0.0, compression = 1.0;
    for (int i = 0; i < mesh.columns * mesh.rows; i++) {
        const L1L2Point u = {plain.node[i].x * unit, plain.node[i].y * unit};
        const L1L2Point d = l1l2_shutter_residual_at(&model, &residual, u);
        const double x = plain.node[i].x - d.x / unit;
        lost += (mesh.node[i].x - x) * (mesh.node[i].x - x), all += (d.x / unit) * (d.x / unit);
        if (i % mesh.columns > 0)
            compression = fmin(compression, (mesh.node[i].x - mesh.node[i - 1].x) /
                                                (plain.node[i].x - plain.node[i - 1].x));
    }
    result[0] = sqrt(lost / all);
    result[1] = compression;
    l1l2_warp_mesh_clear(&mesh);
    l1l2_warp_mesh_clear(&plain);
}

/* Frames of 100 that are accepted: of a vibration that no similarity follows, and of two surfaces 6 px apart. */
static void run_rows(const Recording *recording, const L1L2ShutterParameters *parameters, double result[2])
{
    L1L2Rng rng = l1l2_rng_seeded(12);
    double consensus_weights[TRACKS];
    for (int i = 0; i < TRACKS; i++)
        consensus_weights[i] = 1.0;
    result[0] = result[1] = 0.0;
    for (int t = 1; t <= 100; t++)
        for (int surfaces = 0; surfaces < 2; surfaces++) {
            L1L2Pair pair[TRACKS];
            bool inlier[TRACKS];
            L1L2Mat fit;
            memcpy(pair, recording->pair[t], sizeof pair);
            for (int i = 0; i < TRACKS && surfaces; i++)
                pair[i].to = (L1L2Point){pair[i].from.x + (6.0 * (i % 2) + noise(&rng)) / diagonal_px(),
                                         pair[i].from.y + noise(&rng) / diagonal_px()};
            const L1L2ShutterRowTracks tracks = {pair, consensus_weights, TRACKS, 0.5 * HEIGHT / diagonal_px(),
                                                 threshold_px / diagonal_px(), parameters};
            result[surfaces] += l1l2_shutter_similarity_by_rows(&tracks, inlier, &fit) >= 0.7 * TRACKS;
        }
}

/* recording: of each clip, then of a vibration that no similarity follows. */
static void run_all(Recording *const recording[CLIPS + 1], const L1L2ShutterParameters *parameters,
                    double result[RESULTS])
{
    for (int c = 0; c < CLIPS; c++)
        run_clip(&clips[c], recording[c], parameters, result + 3 * c);
    run_edge(parameters, result + 3 * CLIPS);
    run_rows(recording[CLIPS], parameters, result + 3 * CLIPS + 2);
}

static const char *result_name(int i, char name[64])
{
    static const char *const kinds[] = {"wobble", "skew", "reach"};
    static const char *const others[] = {"edge lost", "edge compression", "rows, vibration", "rows, two surfaces"};
    if (i >= 3 * CLIPS)
        return others[i - 3 * CLIPS];
    snprintf(name, 64, "%s, %s", clips[i / 3].name, kinds[i % 3]);
    return name;
}

static void scale(L1L2ShutterParameters *parameters, const Swept *swept, double factor)
{
    for (int i = 0; i < swept->numbers; i++) {
        char *field = (char *)parameters + swept->offset + (size_t)i * sizeof(double);
        double value;
        memcpy(&value, field, sizeof value);
        /* A factor per frame just below 1 is swept by its memory, 1 / (1 - factor). */
        value = value >= 0.9 && value < 1.0 ? 1.0 - (1.0 - value) / factor : value * factor;
        memcpy(field, &value, sizeof value);
    }
}

/* A real clip: the motion of each frame, with its residual. */
enum { MAX_FRAMES = 600, SAMPLES = 9 };

typedef struct RealClip {
    int width, height, frames;
    L1L2MotionResult motion[MAX_FRAMES];
} RealClip;

static void analyze(RealClip *clip, FILE *in)
{
    const L1L2StabLogger log = {0};
    const size_t size = (size_t)clip->width * (size_t)clip->height;
    const L1L2MotionConfig cfg = {
        .format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .width = clip->width, .height = clip->height,
        .analysis_size = 640, .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .seed = 1, .log = &log,
        .rolling_shutter = L1L2STAB_ROLLING_SHUTTER_MIXTURE,
    };
    L1L2Motion *motion;
    uint8_t *picture = malloc(size);
    if (!picture || l1l2_motion_create(&motion, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    for (; clip->frames < MAX_FRAMES && fread(picture, 1, size, in) == size; clip->frames++)
        if (l1l2_motion_push(motion, picture, clip->width, clip->frames == 0, &clip->motion[clip->frames]) !=
            L1L2STAB_OK)
            exit(EXIT_FAILURE);
    l1l2_motion_free(motion);
    free(picture);
}

/* The displacements of SAMPLES points of each frame, px. */
static void filter_clip(const RealClip *clip, const L1L2ShutterParameters *parameters,
                        L1L2Point moved[MAX_FRAMES][SAMPLES])
{
    const double diagonal = hypot(clip->width, clip->height);
    const L1L2StabRollingShutter kind = L1L2STAB_ROLLING_SHUTTER_MIXTURE;
    const L1L2ShutterModel model = {kind, 0.5 * clip->width / diagonal, 0.5 * clip->height / diagonal, parameters};
    enum { RECORDS = WINDOW + L1L2_SHUTTER_FILTER_PAST };
    static L1L2Mat motions[RECORDS];
    static L1L2ShutterFrame rows[RECORDS];
    const L1L2ShutterFilterConfig cfg = {kind, clip->width, clip->height, clip->width, clip->height, WINDOW, parameters,
                                         {motions, sizeof *motions, RECORDS}, {rows, sizeof *rows, RECORDS}, 1.0,
                                         false};
    static L1L2ShutterGate gate;
    L1L2ShutterFilter *filter;
    if (l1l2_shutter_filter_create(&filter, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    memset(&gate, 0, sizeof gate);
    for (int t = 0, out = 0; out < clip->frames; t++) {
        if (t < clip->frames) {
            const L1L2MotionResult *m = &clip->motion[t];
            const bool starts = m->model == L1L2STAB_MOTION_SOURCE_NONE;
            L1L2ShutterMeasurement measurement = m->residual;
            if (m->has_residual && !starts)
                l1l2_shutter_gate_push(&gate, &model, &m->F, &measurement);
            else
                l1l2_shutter_gate_break(&gate);
            motions[t % RECORDS] = starts ? l1l2_mat_identity() : m->F;
            l1l2_shutter_filter_push(filter, m->has_residual ? &measurement : NULL, starts);
        }
        if (t < WINDOW - 1 && t < clip->frames - 1)
            continue;
        const L1L2ShutterResidual *e = l1l2_shutter_filter_pull(filter);
        for (int i = 0; i < SAMPLES; i++) {
            const L1L2Point p = {(i % 3 - 1) * 0.8 * model.half_w, (i / 3 - 1) * 0.8 * model.half_h};
            const L1L2Point d = l1l2_shutter_residual_at(&model, e, p);
            moved[out][i] = (L1L2Point){d.x * diagonal, d.y * diagonal};
        }
        out++;
    }
    l1l2_shutter_filter_free(filter);
}

static double rms(const RealClip *clip, L1L2Point a[MAX_FRAMES][SAMPLES], L1L2Point b[MAX_FRAMES][SAMPLES])
{
    double sum = 0.0;
    for (int t = 0; t < clip->frames; t++)
        for (int i = 0; i < SAMPLES; i++) {
            const double x = a[t][i].x - (b ? b[t][i].x : 0.0), y = a[t][i].y - (b ? b[t][i].y : 0.0);
            sum += x * x + y * y;
        }
    return sqrt(sum / (SAMPLES * clip->frames));
}

static int sweep_clip(int width, int height)
{
    static RealClip clip;
    static L1L2Point usual[MAX_FRAMES][SAMPLES], moved[MAX_FRAMES][SAMPLES];
    clip.width = width, clip.height = height;
    analyze(&clip, stdin);
    if (clip.frames == 0)
        return EXIT_FAILURE;
    filter_clip(&clip, &l1l2_shutter_default_parameters, usual);
    printf("%d frames, residual %.3f px; change when halved, doubled, px\n", clip.frames, rms(&clip, usual, NULL));
    for (int s = 0; s < SWEPT; s++) {
        double change[2];
        for (int doubled = 0; doubled < 2; doubled++) {
            L1L2ShutterParameters parameters = l1l2_shutter_default_parameters;
            scale(&parameters, &table[s], doubled ? 2.0 : 0.5);
            filter_clip(&clip, &parameters, moved);
            change[doubled] = rms(&clip, moved, usual);
        }
        if (change[0] > 0.0 || change[1] > 0.0)
            printf("%-26s %7.3f %7.3f\n", table[s].name, change[0], change[1]);
    }
    return EXIT_SUCCESS;
}

int main(int argc, char **argv)
{
    if (argc > 2)
        return sweep_clip(atoi(argv[1]), atoi(argv[2]));
    double usual[RESULTS], result[RESULTS];
    char name[64];
    const Clip strong = {.name = "rows", .readout_ms = 33.0, .vibration_px = 3.0, .vibration_hz = 20.0, .seed = 1};
    Recording *recording[CLIPS + 1];
    for (int c = 0; c < CLIPS + 1; c++)
        recording[c] = record(c < CLIPS ? &clips[c] : &strong);
    run_all(recording, &l1l2_shutter_default_parameters, usual);
    printf("defaults\n");
    for (int i = 0; i < RESULTS; i++)
        printf("    %-34s %9.3f\n", result_name(i, name), usual[i]);
    fflush(stdout);
    for (int s = 0; s < SWEPT; s++) {
        int changed = 0;
        if (argc > 1 && strcmp(argv[1], table[s].name) != 0)
            continue;
        for (int doubled = 0; doubled < 2; doubled++) {
            L1L2ShutterParameters parameters = l1l2_shutter_default_parameters;
            scale(&parameters, &table[s], doubled ? 2.0 : 0.5);
            run_all(recording, &parameters, result);
            for (int i = 0; i < RESULTS; i++) {
                const bool differs = fabs(result[i] - usual[i]) >= 0.03 * fmax(fabs(usual[i]), 0.01);
                changed += differs;
                if (differs)
                    printf("%-26s %s  %-34s %9.3f -> %9.3f\n", table[s].name, doubled ? "doubled" : "halved ",
                           result_name(i, name), usual[i], result[i]);
            }
        }
        if (changed == 0)
            printf("%-26s changes nothing\n", table[s].name);
        fflush(stdout);
    }
    for (int c = 0; c < CLIPS + 1; c++) {
        synth_free(recording[c]->synth);
        free(recording[c]);
    }
    return EXIT_SUCCESS;
}
