/* SPDX-License-Identifier: MIT */
/* PCG32 (O'Neill 2014, XSH-RR): a small seeded generator per instance, so that equal seeds give equal output. */
#ifndef L1L2_COMMON_RNG_H
#define L1L2_COMMON_RNG_H

#include <stdint.h>

typedef struct L1L2Rng {
    uint64_t state;
} L1L2Rng;

static inline uint32_t l1l2_rng_next(L1L2Rng *rng)
{
    const uint64_t old = rng->state;
    rng->state = old * 6364136223846793005u + 1442695040888963407u;
    const uint32_t x = (uint32_t)(((old >> 18) ^ old) >> 27);
    const unsigned rot = (unsigned)(old >> 59);
    return (x >> rot) | (x << ((32u - rot) & 31u));
}

static inline L1L2Rng l1l2_rng_seeded(uint64_t seed)
{
    L1L2Rng rng = {seed + 1442695040888963407u};
    l1l2_rng_next(&rng);
    return rng;
}

/* Uniform in [0, bound), bound > 0; the bias of at most bound / 2^32 does not matter here. */
static inline uint32_t l1l2_rng_below(L1L2Rng *rng, uint32_t bound)
{
    return (uint32_t)(((uint64_t)l1l2_rng_next(rng) * bound) >> 32);
}

#endif
