/* SPDX-License-Identifier: MIT */
/*
 * What each tunable parameter does: it is halved and doubled, and the measured motion is compared with the truth of
 * synthetic clips, and with the motion at the defaults.
 *
 * For each value: how many of the clips have another motion or quality; the root mean square error of F_t as a part of
 * the default's, the geometric mean over the clips (0.001 px is added to each error); the worst single frame, px;
 * frames without a measured motion and paths started, and the mean quality, less the default's; and the clip whose
 * error changes most. Clips given as raw gray files have no truth: for them the error is the distance from the motion
 * at the defaults.
 *
 * To add a module, give it a table of rows (name, value, unit, effect, evidence) and a struct of doubles in the same
 * order. Add the table to `tables` and, if it is not a part of the motion's configuration, to measure().
 *
 * usage: bench_parameters [PART_OF_A_NAME [FILE WIDTH HEIGHT]...]      default: all parameters, synthetic clips
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion/motion.h"
#include "synth_cases.h"

/* The synthetic clips: one of each kind of difficulty, short. Events begin at frames 60 and 70. */
static const char *const names[] = {
    "tripod", "shake 10 px", "pan 60 px a frame", "walking, some depth", "shake 20 px, shutter open",
    "walking, rolling shutter", "engine 20 Hz, rolling shutter", "mover on 40 %, slow", "mover on 60 %",
    "walkers on 50 %", "cut through black", "dissolve of 10", "flash", "dark throughout", "logo and timecode, dark",
    "letterbox",
};
enum { FIRST = 50, FRAMES = 36, WIDTH = 640, SYNTHETIC = sizeof names / sizeof *names, MAX_CLIPS = SYNTHETIC + 8 };

typedef struct Clip {
    const char *name;
    int width, height, frames;
    uint8_t *gray;    /* frames one after the other */
    L1L2Mat *truth;   /* of each F_t, px; NULL: not known */
    L1L2Mat *usual;   /* F_t at the defaults, px */
    double *quality;  /* of these */
} Clip;

typedef struct Row {
    const char *name, *unit, *effect;
} Row;

#define ROW(name, value, unit, effect, evidence) {#name, unit, effect},
static const Row motion_rows[] = {L1L2_MOTION_PARAMETERS(ROW)};
static L1L2MotionParameters motion;

typedef struct Table {
    const char *module;
    const Row *rows;
    size_t count;
    double *values; /* the struct of doubles that is varied */
} Table;

static const Table tables[] = {
    {"motion", motion_rows, sizeof motion_rows / sizeof *motion_rows, &motion.max_points},
};

static void *allocate(size_t count, size_t size)
{
    void *p = calloc(count, size);
    if (!p)
        abort();
    return p;
}

static Clip clip_new(const char *name, int width, int height, int frames)
{
    const size_t pixels = (size_t)width * (size_t)height, count = (size_t)frames;
    return (Clip){.name = name, .width = width, .height = height, .frames = frames,
                  .gray = allocate(count, pixels), .usual = allocate(count, sizeof(L1L2Mat)),
                  .quality = allocate(count, sizeof(double))};
}

static Clip synthetic_clip(const char *name)
{
    const SynthConfig cfg = synth_case_at(synth_case_named(name), WIDTH);
    Clip clip = clip_new(name, cfg.width, cfg.height, FRAMES);
    Synth *synth = synth_new(&cfg);
    clip.truth = allocate(FRAMES, sizeof *clip.truth);
    for (int t = 0; t < FRAMES; t++) {
        synth_render_gray(synth, FIRST + t, clip.gray + (size_t)t * (size_t)(cfg.width * cfg.height), cfg.width);
        synth_motion(synth, FIRST + t, clip.truth[t].m);
    }
    synth_free(synth);
    return clip;
}

static Clip raw_clip(char **argv)
{
    const int width = atoi(argv[1]), height = atoi(argv[2]);
    FILE *file = fopen(argv[0], "rb");
    if (!file || width < 64 || height < 64 || fseek(file, 0, SEEK_END) != 0)
        exit(EXIT_FAILURE);
    Clip clip = clip_new(argv[0], width, height, (int)(ftell(file) / ((long)width * height)));
    rewind(file);
    if (fread(clip.gray, (size_t)width * (size_t)height, (size_t)clip.frames, file) != (size_t)clip.frames)
        exit(EXIT_FAILURE);
    fclose(file);
    return clip;
}

typedef struct Outcome {
    double rms, worst; /* of the error, px: root mean square over the frame's corners */
    int lost, starts;
    double quality;    /* mean */
    bool changed;      /* a motion or its quality is not the default's */
} Outcome;

static double distance(const Clip *clip, const L1L2Mat *A, const L1L2Mat *B)
{
    double sum = 0.0;
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {(k & 1 ? 0.5 : -0.5) * clip->width, (k & 2 ? 0.5 : -0.5) * clip->height};
        const L1L2Point p = l1l2_mat_apply(A, u), q = l1l2_mat_apply(B, u);
        sum += (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y);
    }
    return sqrt(0.25 * sum);
}

/* Measures a clip with the values of the tables. usual: remember its motions as the default's. */
static Outcome measure(Clip *clip, bool usual)
{
    const L1L2MotionConfig cfg = {
        .format = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), .width = clip->width, .height = clip->height,
        .analysis_size = 640, .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .seed = 1,
        .rolling_shutter = L1L2STAB_ROLLING_SHUTTER_MIXTURE, .parameters = &motion};
    Outcome outcome = {0};
    L1L2Motion *m;
    double sum = 0.0;
    if (l1l2_motion_create(&m, &cfg) != L1L2STAB_OK)
        abort();
    for (int t = 0; t < clip->frames; t++) {
        L1L2MotionResult r;
        const uint8_t *gray = clip->gray + (size_t)t * (size_t)clip->width * (size_t)clip->height;
        if (l1l2_motion_push(m, gray, clip->width, t == 0, &r) != L1L2STAB_OK)
            abort();
        const L1L2Mat F = l1l2_mat_rescale(r.F, hypot(clip->width, clip->height));
        if (usual) {
            clip->usual[t] = F;
            clip->quality[t] = r.quality;
        }
        outcome.changed = outcome.changed || memcmp(&F, &clip->usual[t], sizeof F) != 0 ||
                          r.quality != clip->quality[t];
        outcome.quality += r.quality / clip->frames;
        outcome.starts += r.model == L1L2STAB_MOTION_SOURCE_NONE;
        outcome.lost += r.model == L1L2STAB_MOTION_SOURCE_IDENTITY || r.model == L1L2STAB_MOTION_SOURCE_PREDICTED;
        if (r.model == L1L2STAB_MOTION_SOURCE_NONE)
            continue;
        const double error = distance(clip, &F, clip->truth ? &clip->truth[t] : &clip->usual[t]);
        sum += error * error / clip->frames;
        outcome.worst = fmax(outcome.worst, error);
    }
    outcome.rms = sqrt(sum);
    l1l2_motion_free(m);
    return outcome;
}

static void print_change(Clip *clips, int count, const Outcome *usual)
{
    int changed = 0, lost = 0, starts = 0;
    double sum = 0.0, worst = 0.0, most = 0.0, quality = 0.0;
    const char *which = "";
    for (int i = 0; i < count; i++) {
        const Outcome o = measure(&clips[i], false);
        const double difference = fabs(o.rms - usual[i].rms);
        changed += o.changed;
        quality += (o.quality - usual[i].quality) / count;
        lost += o.lost - usual[i].lost;
        starts += o.starts - usual[i].starts;
        sum += log((o.rms + 0.001) / (usual[i].rms + 0.001));
        worst = fmax(worst, o.worst);
        if (difference > most) {
            most = difference;
            which = clips[i].name;
        }
    }
    if (changed == 0)
        printf("  nothing changes\n");
    else
        printf("  %2d clips, error x %.3f, worst %6.2f px, quality %+.3f, lost %+3d, starts %+2d, most: %s (%.3f px)\n",
               changed, exp(sum / count), worst, quality, lost, starts, which, most);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    static Clip clips[MAX_CLIPS];
    Outcome usual[MAX_CLIPS];
    int count = 0;
    motion = l1l2_motion_defaults;
    if (argc < 5)
        for (; count < SYNTHETIC; count++)
            clips[count] = synthetic_clip(names[count]);
    for (int i = 2; i + 2 < argc && count < MAX_CLIPS; i += 3)
        clips[count++] = raw_clip(argv + i);
    for (int i = 0; i < count; i++) {
        usual[i] = measure(&clips[i], true);
        printf("%-32s error %7.3f px, worst %7.3f, lost %3d, starts %d\n", clips[i].name, usual[i].rms,
               usual[i].worst, usual[i].lost, usual[i].starts);
    }
    for (size_t i = 0; i < sizeof tables / sizeof *tables; i++)
        for (size_t k = 0; k < tables[i].count; k++) {
            const Row *row = &tables[i].rows[k];
            double *value = &tables[i].values[k];
            const double standard = *value;
            if (argc > 1 && !strstr(row->name, argv[1]))
                continue;
            printf("%s.%s = %g %s: %s\n", tables[i].module, row->name, standard, row->unit, row->effect);
            for (int twice = 0; twice < 2; twice++) {
                *value = standard * (twice ? 2.0 : 0.5);
                printf("    %8g", *value);
                print_change(clips, count, usual);
            }
            *value = standard;
        }
    for (int i = 0; i < count; i++) {
        free(clips[i].gray);
        free(clips[i].truth);
        free(clips[i].usual);
        free(clips[i].quality);
    }
    return EXIT_SUCCESS;
}
