/* SPDX-License-Identifier: MIT */
/* Runs a fuzz target without libFuzzer: over every file of the given folders, then over random inputs with fixed seeds.
 * So any compiler, valgrind and the usual tests can run it.
 * usage: fuzz_NAME [--random COUNT] [FILE_OR_FOLDER...] */
#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

#include "fuzz_input.h"

enum { MOST_BYTES = 1 << 16, SECONDS_PER_INPUT = 60 };

static int run_count;

/* An input that takes too long ends the program by SIGALRM. */
static void run_input(const uint8_t *data, size_t size)
{
    alarm(SECONDS_PER_INPUT);
    LLVMFuzzerTestOneInput(data, size);
    alarm(0);
    run_count++;
}

static void run_file(const char *name)
{
    static uint8_t data[MOST_BYTES];
    FILE *file = fopen(name, "rb");
    FUZZ_CHECK(file, "cannot open %s", name);
    const size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    /* A copy of the exact size, so that reading beyond it is seen. */
    uint8_t *copy = malloc(size ? size : 1);
    FUZZ_CHECK(copy, "out of memory");
    memcpy(copy, data, size);
    run_input(copy, size);
    free(copy);
}

static void run_path(const char *path)
{
    struct stat status;
    FUZZ_CHECK(stat(path, &status) == 0, "no file or folder %s", path);
    if (!S_ISDIR(status.st_mode)) {
        run_file(path);
        return;
    }
    DIR *folder = opendir(path);
    FUZZ_CHECK(folder, "cannot read the folder %s", path);
    for (struct dirent *entry; (entry = readdir(folder));) {
        char name[4096];
        if (entry->d_name[0] == '.')
            continue;
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        run_file(name);
    }
    closedir(folder);
}

/* Random bytes, of which runs repeat: purely random ones seldom make the same choice twice. */
static void run_random(uint64_t seed)
{
    uint64_t state = seed * 0x9e3779b97f4a7c15u + 1;
    uint8_t data[1024];
    size_t size = 0;
    while (size < sizeof data) {
        state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        if (state % 64 == 0)
            break;
        data[size] = size >= 8 && state % 4 == 0 ? data[size - 8] : (uint8_t)(state >> 32);
        size++;
    }
    run_input(data, size);
}

int main(int argc, char **argv)
{
    long count = 0;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--random") == 0 && i + 1 < argc)
            count = strtol(argv[++i], NULL, 10);
        else
            run_path(argv[i]);
    }
    for (long seed = 0; seed < count; seed++)
        run_random((uint64_t)seed);
    printf("%d inputs\n", run_count);
    return run_count > 0 ? 0 : 1;
}
