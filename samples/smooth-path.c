/* SPDX-License-Identifier: MIT */
/*
 * The path alone. Reads the measured motion of a camera, and prints the camera's path and the smooth path. There are no
 * pictures: each frame is pushed with its motion and without pixels.
 *
 *     smooth-path MOTION [lambda=L] [weights=W1,W2,W3] [crop-ratio=C] [window=N] [overlap=K] [join=blend] [rate=HZ]
 *
 *     build/samples/measure-shake --motion=motion.txt in.mp4
 *     build/samples/smooth-path motion.txt lambda=0.5 >path.txt
 *
 * MOTION: a line "# ... WIDTHxHEIGHT", then one line a frame: t and the nine numbers of F_t, row-major, in pixels, with
 * the origin at the center. Output, one line a frame: t, then x and y of the translations of C_t and P_t in pixels,
 * which say where the frame's center goes.
 */
#include <l1l2stab/l1l2stab.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void complain(void *cookie, L1L2StabLogLevel level, const char *message)
{
    fprintf(stderr, "smooth-path: %s\n", message);
}

/* Sets one NAME=VALUE. Returns 0 where the name is not known. */
static int set_option(L1L2StabConfig *cfg, const char *option)
{
    double *w = cfg->weights;
    if (strcmp(option, "join=blend") == 0) {
        cfg->join = L1L2STAB_JOIN_BLEND;
        return 1;
    }
    return sscanf(option, "lambda=%lf", &cfg->lambda) == 1 || sscanf(option, "crop-ratio=%lf", &cfg->crop_ratio) == 1 ||
           sscanf(option, "window=%d", &cfg->window) == 1 || sscanf(option, "overlap=%d", &cfg->overlap) == 1 ||
           sscanf(option, "rate=%lf", &cfg->frame_rate) == 1 ||
           sscanf(option, "weights=%lf,%lf,%lf", &w[0], &w[1], &w[2]) == 3;
}

/* Reads the size at the end of the first line, after its last blank. */
static int read_size(FILE *file, int *width, int *height)
{
    char line[256];
    const char *size = fgets(line, sizeof line, file) ? strrchr(line, ' ') : NULL;
    return size && line[0] == '#' && sscanf(size, "%dx%d", width, height) == 2;
}

static int read_motion(FILE *file, double F[9])
{
    int t;
    if (fscanf(file, "%d", &t) != 1)
        return 0;
    for (int i = 0; i < 9; i++)
        if (fscanf(file, "%lf", &F[i]) != 1)
            return 0;
    return 1;
}

static void print_ready(L1L2Stab *s)
{
    L1L2StabInfo info;
    while (l1l2stab_pull(s, NULL, &info) == L1L2STAB_OK)
        printf("%llu %.4f %.4f %.4f %.4f\n", (unsigned long long)info.index, info.C[2], info.C[5], info.P[2],
               info.P[5]);
}

static int run(FILE *file, const L1L2StabConfig *cfg)
{
    L1L2Stab *s;
    L1L2StabResult result = l1l2stab_create(&s, cfg);
    double F[9];
    while (result == L1L2STAB_OK && read_motion(file, F)) {
        const L1L2StabFrame frame = {.motion = F};
        result = l1l2stab_push(s, &frame);
        print_ready(s);
    }
    if (result == L1L2STAB_OK)
        result = l1l2stab_finish(s);
    if (result == L1L2STAB_OK && !feof(file)) {
        fputs("smooth-path: every line after the first must be t and nine numbers\n", stderr);
        result = L1L2STAB_ERR_ARGUMENT;
    }
    if (result == L1L2STAB_OK)
        print_ready(s);
    l1l2stab_free(&s);
    return result == L1L2STAB_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}

int main(int argc, char **argv)
{
    L1L2StabConfig cfg;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.logger = (L1L2StabLogger){.write = complain, .max_level = L1L2STAB_LOG_WARN};
    for (int i = 2; i < argc; i++)
        if (!set_option(&cfg, argv[i])) {
            fprintf(stderr, "smooth-path: %s is not a known NAME=VALUE, see the head of smooth-path.c\n", argv[i]);
            return EXIT_FAILURE;
        }
    FILE *file = argc > 1 ? fopen(argv[1], "r") : NULL;
    if (!file || !read_size(file, &cfg.width, &cfg.height)) {
        fprintf(stderr, "smooth-path: %s\n", argc < 2 ? "usage: smooth-path MOTION [NAME=VALUE...]"
                                             : file   ? "the first line of the motion file must end with WIDTHxHEIGHT"
                                                      : "the motion file cannot be read");
        if (file)
            fclose(file);
        return EXIT_FAILURE;
    }
    const int status = run(file, &cfg);
    fclose(file);
    return status;
}
