/* SPDX-License-Identifier: MIT */
/*
 * The shake that remains on measured camera paths, by crop ratio. A larger crop ratio keeps more of the picture, and
 * more shake. The default of crop-ratio was chosen by this table.
 *
 * usage: bench_crop MOTION...     files as in tests/reference/motion
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "path/path.h"

static const double ratios[] = {0.7, 0.75, 0.8, 0.85, 0.9, 0.95};
enum { RATIOS = 6 };

/* RMS of the corners' second difference, px at 640 wide. */
typedef struct Shake {
    double last[8], sum;
    int count;
} Shake;

static void add_step(Shake *shake, const L1L2Mat *m, int width, int height)
{
    const double diagonal = hypot(width, height), px = diagonal * 640.0 / width;
    for (int k = 0; k < 4; k++) {
        const L1L2Point u = {(k & 1 ? 0.5 : -0.5) * width / diagonal, (k & 2 ? 0.5 : -0.5) * height / diagonal};
        const L1L2Point p = l1l2_mat_apply(m, u);
        const double v[2] = {(p.x - u.x) * px, (p.y - u.y) * px};
        for (int a = 0; a < 2; a++) {
            const double d = v[a] - shake->last[2 * k + a];
            if (shake->count >= 4)
                shake->sum += d * d;
            shake->last[2 * k + a] = v[a];
        }
        shake->count++;
    }
}

static double rms(const Shake *shake)
{
    return sqrt(shake->sum / (shake->count - 4));
}

static void drain(L1L2Path *path, const L1L2PathConfig *cfg, Shake *before, Shake *after)
{
    for (const L1L2PathFrame *f; (f = l1l2_path_pull(path)) != NULL;)
        if (f->path_index > 0) {
            add_step(before, &f->F, cfg->width, cfg->height);
            add_step(after, &f->S, cfg->width, cfg->height);
        }
}

static void smooth(FILE *file, double ratio, Shake *before, Shake *after)
{
    enum { WINDOW = 150, ROWS = WINDOW + L1L2_PATH_PAST };
    static L1L2PathFrame rows[ROWS];
    L1L2PathConfig cfg = {.weights = {1, 1, 1}, .window = WINDOW, .overlap = 100,
                          .model = L1L2STAB_MOTION_MODEL_SIMILARITY, .frames = {rows, sizeof *rows, ROWS}};
    L1L2Path *path;
    rewind(file);
    if (fscanf(file, "# %lf %lf", &cfg.width, &cfg.height) != 2 || l1l2_path_create(&path, &cfg) != L1L2STAB_OK)
        exit(EXIT_FAILURE);
    for (double a, b, x, y; fscanf(file, "%lf %lf %lf %lf", &a, &b, &x, &y) == 4;) {
        const L1L2Mat F = l1l2_mat_similarity(a, b, x, y);
        l1l2_path_push(path, &(L1L2PathInput){.F = &F, .lambda = 0.5, .crop_ratio = ratio});
        drain(path, &cfg, before, after);
    }
    l1l2_path_finish(path);
    drain(path, &cfg, before, after);
    l1l2_path_free(path);
}

int main(int argc, char **argv)
{
    double logs[RATIOS] = {0.0};
    printf("%-22s shake, px", "crop-ratio");
    for (int i = 0; i < RATIOS; i++)
        printf("  %6.2f", ratios[i]);
    for (int k = 1; k < argc; k++) {
        FILE *file = fopen(argv[k], "r");
        if (!file)
            return EXIT_FAILURE;
        const char *name = strrchr(argv[k], '/');
        for (int i = 0; i < RATIOS; i++) {
            Shake before = {{0}, 0, 0}, after = {{0}, 0, 0};
            smooth(file, ratios[i], &before, &after);
            if (i == 0)
                printf("\n%-22s   %7.2f", name ? name + 1 : argv[k], rms(&before));
            printf("  %6.3f", rms(&after));
            logs[i] += log(rms(&after) / rms(&before)) / (argc - 1);
        }
        fclose(file);
    }
    printf("\n%-32s", "left of it, geometric mean");
    for (int i = 0; i < RATIOS; i++)
        printf("  %6.3f", exp(logs[i]));
    printf("\n");
    return EXIT_SUCCESS;
}
