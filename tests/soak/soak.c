/* SPDX-License-Identifier: MIT */
/*
 * Weeks in minutes: what grows slowly is seen after many frames. It fails if something does.
 *
 * usage: soak frames COUNT    that many small frames with cuts, new sizes and changes of lambda: resident memory grows
 *                             by less than 1 MB after a tenth of them, threads and descriptors stay the same
 *        soak minutes COUNT   that many minutes of video at 30000/1001 frames/s with motions that drift: every
 *                             timestamp comes back exactly, and path coordinates stay within their documented range
 */
#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <l1l2stab/l1l2stab.h>

enum { MOST_WIDTH = 96, MOST_HEIGHT = 64, POOL = 40, CUT_EVERY = 700, SIZE_EVERY = 5000, LAMBDA_EVERY = 300 };

#define REQUIRE(condition, ...)                                                                                        \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition);                                            \
            fprintf(stderr, __VA_ARGS__);                                                                              \
            fputc('\n', stderr);                                                                                       \
            exit(EXIT_FAILURE);                                                                                        \
        }                                                                                                              \
    } while (0)

static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 16;
}

/* [-1, 1] */
static double random_part(uint32_t *state)
{
    return next_random(state) / 32767.5 - 1.0;
}

/* --- what a process holds --- */

typedef struct Holding {
    long resident_kb;
    int threads, descriptors;
} Holding;

static int count_entries(const char *path)
{
    DIR *folder = opendir(path);
    int entries = -2; /* . and .. */
    REQUIRE(folder, "this needs Linux");
    while (readdir(folder))
        entries++;
    closedir(folder);
    return entries;
}

static Holding measure_holding(void)
{
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    REQUIRE(file && fscanf(file, "%*d %ld", &pages) == 1, "this needs Linux");
    fclose(file);
    return (Holding){pages * (sysconf(_SC_PAGESIZE) / 1024), count_entries("/proc/self/task"),
                     count_entries("/proc/self/fd")};
}

/* --- many frames --- */

typedef struct Soak {
    L1L2Stab *s;
    int width, height;
    uint8_t pixels[POOL][MOST_WIDTH * MOST_HEIGHT * 3 / 2];
    uint8_t out[MOST_WIDTH * MOST_HEIGHT * 3 / 2];
    long pushed, pulled, released;
    uint32_t random, scene;
    int x, y;
} Soak;

static void count_release(void *opaque)
{
    ++*(long *)opaque;
}

/* Blocks with random levels, which move and have some noise. */
static void draw(Soak *soak, uint8_t *pixels)
{
    if (soak->pushed % CUT_EVERY == 0)
        soak->scene++;
    soak->x += (int)(next_random(&soak->random) % 5) - 2;
    soak->y += (int)(next_random(&soak->random) % 5) - 2;
    for (int y = 0; y < soak->height; y++)
        for (int x = 0; x < soak->width; x++) {
            uint32_t hash = (uint32_t)(x + soak->x + 100000) / 4 * 73856093u;
            hash = (hash ^ (uint32_t)(y + soak->y + 100000) / 4 * 19349663u ^ soak->scene * 83492791u) * 2246822519u;
            pixels[y * soak->width + x] = (uint8_t)((hash >> 24) / 2 + 40 + next_random(&soak->random) % 8);
        }
    memset(pixels + soak->width * soak->height, 128, (size_t)(soak->width * soak->height / 2));
}

static L1L2StabFrame frame_of(const Soak *soak, uint8_t *pixels)
{
    const int luma = soak->width * soak->height;
    return (L1L2StabFrame){.data = {pixels, pixels + luma, pixels + luma * 5 / 4},
                           .stride = {soak->width, soak->width / 2, soak->width / 2}};
}

static void pull_ready(Soak *soak)
{
    L1L2StabFrame out = frame_of(soak, soak->out);
    while (l1l2stab_pull(soak->s, &out, NULL) == L1L2STAB_OK) {
        REQUIRE(out.pts == soak->pulled, "frame %ld is %" PRId64, soak->pulled, out.pts);
        soak->pulled++;
    }
}

/* What the element does with new caps. */
static void change_size(Soak *soak)
{
    L1L2StabConfig cfg;
    if (soak->s) {
        l1l2stab_finish(soak->s);
        pull_ready(soak);
    }
    l1l2stab_free(&soak->s);
    soak->width = 48 + 16 * (int)(next_random(&soak->random) % 4);
    soak->height = 32 + 16 * (int)(next_random(&soak->random) % 3);
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_I420;
    cfg.width = soak->width, cfg.height = soak->height;
    cfg.frame_rate = 30;
    cfg.window = 30;
    cfg.threads = 2;
    REQUIRE(l1l2stab_create(&soak->s, &cfg) == L1L2STAB_OK, "create");
}

static void push_frame(Soak *soak)
{
    if (soak->pushed % SIZE_EVERY == 0)
        change_size(soak);
    if (soak->pushed % LAMBDA_EVERY == 0)
        REQUIRE(l1l2stab_set_lambda(soak->s, 1.0 + random_part(&soak->random)) == L1L2STAB_OK, "lambda");
    uint8_t *pixels = soak->pixels[soak->pushed % POOL];
    draw(soak, pixels);
    L1L2StabFrame in = frame_of(soak, pixels);
    in.pts = soak->pushed;
    in.opaque = &soak->released;
    in.release = count_release;
    REQUIRE(l1l2stab_push(soak->s, &in) == L1L2STAB_OK, "frame %ld", soak->pushed);
    soak->pushed++;
    pull_ready(soak);
}

static void soak_frames(long count)
{
    static Soak soak = {.random = 1};
    Holding before = {0};
    for (long t = 0; t < count; t++) {
        push_frame(&soak);
        if (t == count / 10)
            before = measure_holding();
    }
    const Holding after = measure_holding();
    l1l2stab_finish(soak.s);
    pull_ready(&soak);
    l1l2stab_free(&soak.s);
    printf("%ld frames: resident %ld kB after a tenth, %ld kB at the end; %d and %d threads, %d and %d descriptors\n",
           count, before.resident_kb, after.resident_kb, before.threads, after.threads, before.descriptors,
           after.descriptors);
    REQUIRE(soak.pulled == count && soak.released == count, "%ld out, %ld released", soak.pulled, soak.released);
#ifndef MEMORY_OF_OTHERS /* a sanitizer keeps freed memory, and an emulator the code that it translates */
    REQUIRE(after.resident_kb - before.resident_kb < 1024, "memory grows");
#endif
    REQUIRE(after.threads == before.threads && after.descriptors == before.descriptors, "threads or descriptors leak");
}

/* --- many minutes --- */

static int64_t time_of(int64_t frame)
{
    return frame * 1001 * 1000000 / 30 + 500000 * (frame % 2); /* to the nanosecond; half a millisecond of jitter */
}

/* A steady pan and zoom for some minutes, then another; with shake. */
static void choose_motion(uint32_t *random, int64_t frame, double drift[3], double F[9])
{
    if (frame % 7200 == 0)
        for (int i = 0; i < 3; i++)
            drift[i] = random_part(random);
    const double zoom = exp(1e-3 * drift[2] + 1e-4 * random_part(random)), angle = 1e-3 * random_part(random);
    const double G[9] = {zoom * cos(angle), -zoom * sin(angle), 20 * drift[0] + 3 * random_part(random),
                         zoom * sin(angle), zoom * cos(angle), 10 * drift[1] + 3 * random_part(random), 0, 0, 1};
    memcpy(F, G, sizeof G);
}

static double check_info(const L1L2StabInfo *info, const L1L2StabConfig *cfg)
{
    double largest = 0;
    for (int i = 0; i < 9; i++) {
        REQUIRE(isfinite(info->B[i]) && isfinite(info->S[i]) && isfinite(info->P[i]), "frame %" PRIu64, info->index);
        largest = fmax(largest, fabs(info->C[i]));
    }
    REQUIRE(largest <= 1e6 * hypot(cfg->width, cfg->height), "C has %g", largest);
    return largest;
}

static void soak_minutes(long minutes)
{
    L1L2StabConfig cfg;
    L1L2Stab *s;
    L1L2StabInfo info;
    uint32_t random = 1;
    double drift[3] = {0}, largest = 0;
    int64_t pulled = 0;
    const int64_t count = minutes * 60 * 30000 / 1001;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = 1920, cfg.height = 1080;
    cfg.frame_rate = 30000.0 / 1001;
    cfg.threads = 1;
    REQUIRE(l1l2stab_create(&s, &cfg) == L1L2STAB_OK, "create");
    for (int64_t t = 0; t <= count; t++) {
        double F[9];
        choose_motion(&random, t, drift, F);
        const L1L2StabFrame in = {.motion = F, .pts = time_of(t)};
        if (t < count)
            REQUIRE(l1l2stab_push(s, &in) == L1L2STAB_OK, "frame %" PRId64, t);
        else
            l1l2stab_finish(s);
        for (int64_t pts; l1l2stab_peek(s, &pts, NULL) == L1L2STAB_OK; pulled++) {
            REQUIRE(pts == time_of(pulled), "frame %" PRId64 " has the time %" PRId64, pulled, pts);
            REQUIRE(l1l2stab_pull(s, NULL, &info) == L1L2STAB_OK && info.index == (uint64_t)pulled, "pull");
            largest = fmax(largest, check_info(&info, &cfg));
        }
    }
    l1l2stab_free(&s);
    REQUIRE(pulled == count, "%" PRId64 " of %" PRId64, pulled, count);
    printf("%ld minutes, %" PRId64 " frames: all timestamps exact, largest path coordinate %.3g px\n", minutes, count,
           largest);
}

int main(int argc, char **argv)
{
    const long count = argc == 3 ? strtol(argv[2], NULL, 10) : 0;
    if (count > 0 && strcmp(argv[1], "frames") == 0)
        soak_frames(count);
    else if (count > 0 && strcmp(argv[1], "minutes") == 0)
        soak_minutes(count);
    else
        REQUIRE(0, "usage: soak frames COUNT | soak minutes COUNT");
    return EXIT_SUCCESS;
}
