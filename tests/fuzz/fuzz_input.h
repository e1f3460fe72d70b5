/* SPDX-License-Identifier: MIT */
/* The bytes of a fuzzer as a source of choices, and the check that every invariant uses. Where the bytes end, every
 * choice is the first one, so that a short input is a short run. */
#ifndef FUZZ_INPUT_H
#define FUZZ_INPUT_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The entry point that libFuzzer and fuzz_replay.c call. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define FUZZ_CHECK(condition, ...)                                                                                     \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition);                                            \
            fprintf(stderr, __VA_ARGS__);                                                                              \
            fputc('\n', stderr);                                                                                       \
            abort();                                                                                                   \
        }                                                                                                              \
    } while (0)

typedef struct FuzzInput {
    const uint8_t *at, *end;
} FuzzInput;

static inline bool fuzz_has_more(const FuzzInput *in)
{
    return in->at < in->end;
}

static inline unsigned fuzz_byte(FuzzInput *in)
{
    return fuzz_has_more(in) ? *in->at++ : 0;
}

static inline uint64_t fuzz_bits(FuzzInput *in, int bytes)
{
    uint64_t bits = 0;
    for (int i = 0; i < bytes; i++)
        bits = bits << 8 | fuzz_byte(in);
    return bits;
}

/* One of 0, ..., count - 1. */
static inline int fuzz_below(FuzzInput *in, int count)
{
    return (int)(fuzz_bits(in, count > 256 ? 3 : 1) % (uint64_t)count);
}

static inline int fuzz_between(FuzzInput *in, int least, int most)
{
    return least + fuzz_below(in, most - least + 1);
}

/* True for one byte of `count`. */
static inline bool fuzz_chance(FuzzInput *in, int count)
{
    return fuzz_below(in, count) == count - 1;
}

/* [0, 1] */
static inline double fuzz_part(FuzzInput *in)
{
    return (double)fuzz_bits(in, 2) / 65535.0;
}

/* Any number, also one that is none. */
static inline double fuzz_any_double(FuzzInput *in)
{
    static const double special[] = {0.0, -0.0, 1.0, -1.0, 0.5, 2.0, 1e-300, 5e-324, 1e30, 1e300, 1e308, -1e308};
    const int kind = fuzz_below(in, 16);
    if (kind < 12)
        return special[kind];
    if (kind == 12)
        return NAN;
    if (kind == 13)
        return fuzz_below(in, 2) ? INFINITY : -INFINITY;
    const uint64_t bits = fuzz_bits(in, 8);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
