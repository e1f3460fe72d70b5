/* SPDX-License-Identifier: MIT */
/* The generators for AVX2: eight positions at a time. */
#include "common/intrinsics.h"

#include "warp/coords_impl.h"

L1L2_INLINE void run_fixed(uint64_t at, uint64_t step, int count, int32_t *out)
{
    const __m256i one = _mm256_set1_epi64x((long long)step), two = _mm256_add_epi64(one, one);
    const __m256i four = _mm256_add_epi64(two, two), eight = _mm256_add_epi64(four, four);
    /* 0, 1, 2, 3 steps */
    const __m256i steps = _mm256_add_epi64(_mm256_and_si256(one, _mm256_setr_epi64x(0, -1, 0, -1)),
                                           _mm256_and_si256(two, _mm256_setr_epi64x(0, 0, -1, -1)));
    __m256i low = _mm256_add_epi64(_mm256_set1_epi64x((long long)at), steps), high = _mm256_add_epi64(low, four);
    for (int i = 0; i < count; i += 8) {
        const __m256 a = _mm256_castsi256_ps(_mm256_srli_epi64(low, POSITION_SHIFT));
        const __m256 b = _mm256_castsi256_ps(_mm256_srli_epi64(high, POSITION_SHIFT));
        const __m256i mixed = _mm256_castps_si256(_mm256_shuffle_ps(a, b, _MM_SHUFFLE(2, 0, 2, 0)));
        _mm256_storeu_si256((void *)(out + i), _mm256_permute4x64_epi64(mixed, _MM_SHUFFLE(3, 1, 2, 0)));
        low = _mm256_add_epi64(low, eight);
        high = _mm256_add_epi64(high, eight);
    }
}

DEFINE_GENERATORS(l1l2_warp_coords_init_avx2)
