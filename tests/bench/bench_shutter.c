/* SPDX-License-Identifier: MIT */
/*
 * What remains of a rolling shutter after stabilization, measured against the truth: synthetic clips whose rows are
 * taken at their own times, handheld, with a vibration of several frequencies. docs/rolling-shutter.md has the table.
 *
 *   wobble  where the scene lies in two successive outputs, less the smooth path's step: rms over the picture, px
 *   skew    where the scene lies in an output, less the nearest similarity: rms over the picture, px
 *
 * Then clips with a global shutter in which a subject that moves by itself covers 40 % of the picture:
 *
 *   reach   how far the residual moves a sample, at most, px; it should be 0
 *
 * usage: bench_shutter [FRAMES [AMPLITUDE_PX [PICTURE]]]
 *        PICTURE: where to write a PPM of a slow subject at a side, with the mesh of the mixture
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion/motion.h"
#include "path/path.h"
#include "rolling_shutter/filter.h"
#include "synth.h"

enum { WIDTH = 640, HEIGHT = 360, COLUMNS = 9, ROWS = 13, POINTS = COLUMNS * ROWS, WINDOW = 90 };
static const double crop_ratio = 0.9;

typedef struct Errors {
    double wobble, skew; /* sums of squares */
    int wobbles, skews;
    double readout;
    double reach;        /* longest, px */
} Errors;

static const char *picture_path; /* where to draw frame PICTURE_FRAME of this run; NULL: nowhere */
enum { PICTURE_FRAME = 60 };

static L1L2Mat from_px(const double m[9])
{
    L1L2Mat mat;
    for (int i = 0; i < 9; i++)
        mat.m[i] = m[i];
    return mat;
}

/* The source position of an output point; beyond the border, the nearest cell is extrapolated. */
static L1L2Point look_up(const L1L2WarpMesh *mesh, L1L2Point u)
{
    const double x = (u.x / mesh->width + 0.5) * (mesh->columns - 1), y = (u.y / mesh->height + 0.5) * (mesh->rows - 1);
    const int column = (int)fmin(fmax(floor(x), 0.0), mesh->columns - 2);
    const int row = (int)fmin(fmax(floor(y), 0.0), mesh->rows - 2);
    const L1L2Point *n = &mesh->node[row * mesh->columns + column], *below = n + mesh->columns;
    const double a = x - column, b = y - row;
    return (L1L2Point){
        (1 - b) * ((1 - a) * n[0].x + a * n[1].x) + b * ((1 - a) * below[0].x + a * below[1].x),
        (1 - b) * ((1 - a) * n[0].y + a * n[1].y) + b * ((1 - a) * below[0].y + a * below[1].y),
    };
}

/* The point of the scene that an output point shows. */
static L1L2Point shown(const Synth *synth, int t, const L1L2WarpMesh *mesh, L1L2Point u)
{
    const L1L2Point p = look_up(mesh, u);
    double M[9];
    synth_camera_at(synth, synth_row_time(synth, t, p.y), M);
    const L1L2Mat camera = from_px(M);
    return l1l2_mat_apply(&camera, p);
}

static L1L2Point output_point(int i)
{
    return (L1L2Point){(i % COLUMNS / (COLUMNS - 1.0) - 0.5) * WIDTH, (i / COLUMNS / (ROWS - 1.0) - 0.5) * HEIGHT};
}

/* Adds what the nearest similarity of the output points does not explain. The mean of the output points is 0. */
static void add_skew(const L1L2Point at[POINTS], Errors *errors)
{
    double a = 0.0, b = 0.0, x = 0.0, y = 0.0, norm = 0.0;
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point u = output_point(i);
        a += u.x * at[i].x + u.y * at[i].y;
        b += u.x * at[i].y - u.y * at[i].x;
        x += at[i].x / POINTS, y += at[i].y / POINTS;
        norm += u.x * u.x + u.y * u.y;
    }
    a /= norm, b /= norm;
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point u = output_point(i);
        const double dx = at[i].x - (a * u.x - b * u.y + x), dy = at[i].y - (b * u.x + a * u.y + y);
        errors->skew += dx * dx + dy * dy;
        errors->skews++;
    }
}

/* Adds the errors of frame t, whose mesh is `now`. before: the mesh of the frame before it. */
static void compare(const Synth *synth, int t, const L1L2PathFrame *f, const L1L2WarpMesh *before,
                    const L1L2WarpMesh *now, Errors *errors)
{
    L1L2Point at[POINTS];
    const L1L2Mat step = l1l2_mat_rescale(f->S, hypot(WIDTH, HEIGHT) / crop_ratio);
    for (int i = 0; i < POINTS; i++) {
        const L1L2Point u = output_point(i), earlier = l1l2_mat_apply(&step, u);
        at[i] = shown(synth, t, now, u);
        if (t < 2 || fabs(earlier.x) > 0.5 * WIDTH || fabs(earlier.y) > 0.5 * HEIGHT)
            continue;
        const L1L2Point then = shown(synth, t - 1, before, earlier);
        errors->wobble += (at[i].x - then.x) * (at[i].x - then.x) + (at[i].y - then.y) * (at[i].y - then.y);
        errors->wobbles++;
    }
    add_skew(at, errors);
}

static void draw(const SynthPicture *source, const L1L2WarpMesh *mesh)
{
    FILE *file = fopen(picture_path, "wb");
    uint8_t(*rgb)[3] = calloc(WIDTH * HEIGHT, sizeof *rgb);
    if (!file || !rgb)
        exit(EXIT_FAILURE);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        rgb[i][0] = rgb[i][1] = rgb[i][2] = (uint8_t)(source->data[0][i / WIDTH * source->stride[0] + i % WIDTH] / 2);
    for (int i = 0; i < 20000 * 10; i++) {
        /* Ten lines in each direction, in fine steps. */
        const double along = (i % 10000 / 10000.0 - 0.5), across = i / 10000 % 10 / 9.0 - 0.5;
        const L1L2Point u = i < 100000 ? (L1L2Point){along * WIDTH, across * HEIGHT}
                                       : (L1L2Point){across * WIDTH, along * HEIGHT};
        const L1L2Point at = look_up(mesh, u);
        const int x = (int)floor(at.x + 0.5 * WIDTH), y = (int)floor(at.y + 0.5 * HEIGHT);
        if (x >= 0 && x < WIDTH && y >= 0 && y < HEIGHT)
            rgb[y * WIDTH + x][0] = rgb[y * WIDTH + x][1] = 255;
    }
    fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
    fwrite(rgb, sizeof *rgb, WIDTH * HEIGHT, file);
    fclose(file);
    free(rgb);
}

/* Takes the next frame's warp as a mesh. */
static void take(L1L2ShutterFilter *filter, const L1L2PathFrame *f, L1L2WarpMesh *mesh, Errors *errors)
{
    const L1L2Mat map = l1l2_mat_mul(l1l2_mat_rescale(f->B, hypot(WIDTH, HEIGHT)),
                                     l1l2_mat_diagonal(crop_ratio, crop_ratio));
    double reach;
    l1l2_shutter_filter_pull(filter);
    const L1L2WarpMesh *corrected = l1l2_shutter_filter_mesh(filter, &map, 1.0, &reach);
    if (corrected)
        memcpy(mesh->node, corrected->node, (size_t)(corrected->columns * corrected->rows) * sizeof *corrected->node);
    else
        l1l2_warp_mesh_set(mesh, &map);
    errors->reach = fmax(errors->reach, reach);
}

static Errors run(const SynthConfig *scene, int frames, L1L2StabRollingShutter model)
{
    const L1L2StabLogger log = {0};
    Synth *synth = synth_new(scene);
    SynthPicture picture = synth_picture_new(L1L2STAB_FORMAT_GRAY8, WIDTH, HEIGHT);
    const L1L2MotionConfig motion_cfg = {
        .format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .width = WIDTH, .height = HEIGHT, .analysis_size = 640,
        .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .seed = 1, .log = &log, .rolling_shutter = model,
    };
    enum { RECORDS = WINDOW + L1L2_SHUTTER_FILTER_PAST };
    static L1L2PathFrame rows[RECORDS];
    static L1L2ShutterFrame filter_rows[RECORDS];
    const L1L2PathConfig path_cfg = {
        .width = WIDTH, .height = HEIGHT, .frame_rate = scene->fps,
        .weights = {1, 1, 1}, .window = WINDOW, .overlap = 2 * WINDOW / 3, .log = &log,
        .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .frames = {rows, sizeof *rows, RECORDS},
    };
    const L1L2ShutterFilterConfig filter_cfg = {model, WIDTH, HEIGHT, WIDTH, HEIGHT, WINDOW, NULL,
                                                {&rows[0].F, sizeof *rows, RECORDS},
                                                {filter_rows, sizeof *filter_rows, RECORDS}, 1.0, false};
    L1L2Motion *motion = NULL;
    L1L2Path *path = NULL;
    L1L2ShutterFilter *filter = NULL;
    L1L2WarpMesh mesh[2];
    if (l1l2_motion_create(&motion, &motion_cfg) != L1L2STAB_OK || l1l2_path_create(&path, &path_cfg) != L1L2STAB_OK ||
        l1l2_shutter_filter_create(&filter, &filter_cfg) != L1L2STAB_OK ||
        !l1l2_warp_mesh_init(&mesh[0], WIDTH, HEIGHT) || !l1l2_warp_mesh_init(&mesh[1], WIDTH, HEIGHT))
        exit(EXIT_FAILURE);
    Errors errors = {0};
    int out = 0;
    for (int t = 0; t <= frames; t++) {
        L1L2MotionResult m;
        if (t < frames) {
            synth_render_gray(synth, t, picture.data[0], picture.stride[0]);
            if (l1l2_motion_push(motion, picture.data[0], picture.stride[0], t == 0, &m) != L1L2STAB_OK)
                exit(EXIT_FAILURE);
            l1l2_path_push(path, &(L1L2PathInput){.F = &m.F, .starts_path = t == 0, .lambda = 0.5,
                                                  .crop_ratio = crop_ratio});
            l1l2_shutter_filter_push(filter, m.has_residual ? &m.residual : NULL, t == 0);
        } else {
            l1l2_path_finish(path);
        }
        for (const L1L2PathFrame *f; (f = l1l2_path_pull(path)) != NULL; out++) {
            take(filter, f, &mesh[out % 2], &errors);
            compare(synth, out, f, &mesh[(out + 1) % 2], &mesh[out % 2], &errors);
            if (picture_path && out == PICTURE_FRAME) {
                synth_render_gray(synth, out, picture.data[0], picture.stride[0]);
                draw(&picture, &mesh[out % 2]);
            }
        }
    }
    errors.readout = l1l2_shutter_filter_readout(filter);
    l1l2_motion_free(motion);
    l1l2_path_free(path);
    l1l2_shutter_filter_free(filter);
    l1l2_warp_mesh_clear(&mesh[0]);
    l1l2_warp_mesh_clear(&mesh[1]);
    synth_picture_free(&picture);
    synth_free(synth);
    return errors;
}

static void run_movers(int frames, double x, const char *picture)
{
    static const double speeds[] = {2, 5, 15};
    printf("\n40 %% of the picture moves by itself, %g widths from the center; wobble / reach, px\n", x);
    printf("px/frame    none            homography      mixture\n");
    for (int v = 0; v < 3; v++) {
        SynthConfig scene = synth_defaults();
        scene.width = WIDTH, scene.height = HEIGHT;
        scene.noise = 2.0;
        scene.foreground = 0.4, scene.movers = 1, scene.mover_speed = speeds[v], scene.mover_x = x;
        printf("%6.0f  ", speeds[v]);
        picture_path = v == 0 ? picture : NULL;
        for (int model = 0; model < 3; model++) {
            const Errors e = run(&scene, frames, (L1L2StabRollingShutter)model);
            printf("  %6.3f / %-6.3f", sqrt(e.wobble / e.wobbles), e.reach);
        }
        printf("\n");
        fflush(stdout);
    }
}

int main(int argc, char **argv)
{
    static const double readout_ms[] = {0, 20, 27, 33}, hz[] = {0, 5, 10, 20, 30};
    const int frames = argc > 1 ? atoi(argv[1]) : 180;
    const double amplitude = argc > 2 ? atof(argv[2]) : 2.0;
    printf("%dx%d, 30 frames/s, %d frames, handheld; wobble / skew, px\n", WIDTH, HEIGHT, frames);
    printf("readout ms  vibration    none            homography      mixture         readout estimated, ms\n");
    for (int r = 0; r < 4; r++)
        for (int v = 0; v < 5; v++) {
            SynthConfig scene = synth_defaults();
            scene.width = WIDTH, scene.height = HEIGHT;
            scene.noise = 2.0;
            scene.readout = readout_ms[r] / 1000.0;
            scene.vibration = hz[v] > 0.0 ? amplitude : 0.0, scene.vibration_hz = hz[v];
            printf("%6.0f %9.0f Hz  ", readout_ms[r], hz[v]);
            double found = 0.0;
            for (int model = 0; model < 3; model++) {
                const Errors e = run(&scene, frames, (L1L2StabRollingShutter)model);
                printf("  %6.3f / %-6.3f", sqrt(e.wobble / e.wobbles), sqrt(e.skew / e.skews));
                found = e.readout;
            }
            printf("  %5.1f\n", found * 1000.0 / scene.fps);
            fflush(stdout);
        }
    run_movers(frames, 0.0, NULL);
    run_movers(frames, 0.2, argc > 3 ? argv[3] : NULL);
    return EXIT_SUCCESS;
}
