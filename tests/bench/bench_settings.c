/* SPDX-License-Identifier: MIT */
/*
 * The shake that remains on measured camera paths, by crop ratio, window and lambda: one table for each, with the other
 * two at their defaults. Nothing is rendered. docs/choosing.md has the tables.
 *
 * usage: bench_settings MOTION...     files as in tests/reference/motion
 */
#include <l1l2stab/l1l2stab.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_VALUES 8

static const double crops[] = {0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 0.98};
static const double windows[] = {4, 8, 15, 30, 60, 150, 300};
static const double lambdas[] = {0.05, 0.1, 0.25, 0.5, 1, 2, 5};

typedef enum Setting { CROP, WINDOW, LAMBDA } Setting;

/* The motion of a clip: similarities in units of the frame's diagonal, as its file has them. */
typedef struct Clip {
    const char *name;
    double width, height;
    double (*motions)[4];
    int count;
} Clip;

/* RMS of the corners' second difference, px at 640 wide; and of the distance by which the picture's center is moved, in
 * parts of the width. */
typedef struct Shake {
    double last[8], sum, moved;
    int steps, frames;
} Shake;

static void add_step(Shake *shake, const Clip *clip, const double m[9])
{
    for (int k = 0; k < 4; k++) {
        const double x = (k & 1 ? 0.5 : -0.5) * clip->width, y = (k & 2 ? 0.5 : -0.5) * clip->height;
        const double v[2] = {m[0] * x + m[1] * y + m[2] - x, m[3] * x + m[4] * y + m[5] - y};
        for (int a = 0; a < 2; a++) {
            if (shake->steps > 0)
                shake->sum += pow((v[a] - shake->last[2 * k + a]) * 640 / clip->width, 2);
            shake->last[2 * k + a] = v[a];
        }
    }
    shake->steps++;
}

static double rms(const Shake *shake)
{
    return sqrt(shake->sum / (4 * (shake->steps - 1)));
}

static double moved(const Shake *shake)
{
    return sqrt(shake->moved / shake->frames);
}

static void pull_all(L1L2Stab *s, const Clip *clip, Shake *before, Shake *after)
{
    L1L2StabInfo info;
    while (l1l2stab_pull(s, NULL, &info) == L1L2STAB_OK) {
        after->moved += pow(info.B[2] / clip->width, 2) + pow(info.B[5] / clip->width, 2);
        after->frames++;
        if (info.path_index > 0) {
            add_step(before, clip, info.F);
            add_step(after, clip, info.S);
        }
    }
}

static L1L2StabConfig config_of(const Clip *clip, Setting setting, double value)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = (int)clip->width;
    cfg.height = (int)clip->height;
    if (setting == CROP)
        cfg.crop_ratio = value;
    else if (setting == WINDOW)
        cfg.window = (int)value;
    else
        cfg.lambda = value;
    return cfg;
}

static void stabilize(const Clip *clip, const L1L2StabConfig *cfg, Shake *before, Shake *after)
{
    const double diagonal = hypot(clip->width, clip->height);
    L1L2Stab *s;
    if (l1l2stab_create(&s, cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    for (int i = 0; i < clip->count; i++) {
        const double *m = clip->motions[i];
        const double motion[9] = {m[0], -m[1], m[2] * diagonal, m[1], m[0], m[3] * diagonal, 0, 0, 1};
        if (l1l2stab_push(s, &(L1L2StabFrame){.motion = motion, .pts = L1L2STAB_NO_PTS}) != L1L2STAB_OK)
            exit(EXIT_FAILURE);
        pull_all(s, clip, before, after);
    }
    l1l2stab_finish(s);
    pull_all(s, clip, before, after);
    l1l2stab_free(&s);
}

static Clip read_clip(const char *path)
{
    const char *slash = strrchr(path, '/');
    Clip clip = {.name = slash ? slash + 1 : path};
    FILE *file = fopen(path, "r");
    double m[4];
    if (!file || fscanf(file, "# %lf %lf", &clip.width, &clip.height) != 2)
        exit(EXIT_FAILURE);
    while (fscanf(file, "%lf %lf %lf %lf", &m[0], &m[1], &m[2], &m[3]) == 4) {
        clip.motions = realloc(clip.motions, (size_t)(clip.count + 1) * sizeof *clip.motions);
        if (!clip.motions)
            exit(EXIT_FAILURE);
        memcpy(clip.motions[clip.count++], m, sizeof m);
    }
    fclose(file);
    return clip;
}

static void print_row(const char *name, const double *values, int count, int decimals)
{
    printf("%-32s", name);
    for (int i = 0; i < count; i++)
        printf("  %6.*f", decimals, values[i]);
    printf("\n");
}

static void print_table(const Clip *clips, int clip_count, Setting setting, const double *values, int count)
{
    static const char *const names[] = {"crop-ratio", "window, frames", "lambda"};
    double logs[MOST_VALUES] = {0}, mean[MOST_VALUES] = {0}, shift[MOST_VALUES] = {0};
    print_row(names[setting], values, count, setting == WINDOW ? 0 : 2);
    for (int k = 0; k < clip_count; k++) {
        double left[MOST_VALUES], filmed = 0;
        char name[64];
        for (int i = 0; i < count; i++) {
            Shake before = {0}, after = {0};
            const L1L2StabConfig cfg = config_of(&clips[k], setting, values[i]);
            stabilize(&clips[k], &cfg, &before, &after);
            filmed = rms(&before);
            left[i] = rms(&after);
            logs[i] += log(left[i] / filmed) / clip_count;
            mean[i] += left[i] / filmed / clip_count;
            shift[i] += 100 * moved(&after) / clip_count;
        }
        snprintf(name, sizeof name, "%-24.24s%5.2f px", clips[k].name, filmed);
        print_row(name, left, count, 3);
    }
    for (int i = 0; i < count; i++)
        logs[i] = exp(logs[i]);
    print_row("share left, mean", mean, count, 3);
    print_row("share left, geometric mean", logs, count, 3);
    print_row("picture moved, rms, % of width", shift, count, 2);
    printf("\n");
}

int main(int argc, char **argv)
{
    Clip clips[16] = {{0}};
    int count = 0;
    for (; count < argc - 1 && count < 16; count++)
        clips[count] = read_clip(argv[count + 1]);
    printf("The shake that is left, px at 640 wide, with one setting changed. Behind a name: the shake as filmed.\n\n");
    print_table(clips, count, CROP, crops, sizeof crops / sizeof *crops);
    print_table(clips, count, WINDOW, windows, sizeof windows / sizeof *windows);
    print_table(clips, count, LAMBDA, lambdas, sizeof lambdas / sizeof *lambdas);
    for (int i = 0; i < count; i++)
        free(clips[i].motions);
    return EXIT_SUCCESS;
}
