/* SPDX-License-Identifier: MIT */
/*
 * The area scaler's pass across a row: every output is a weighted sum of neighboring samples.
 *
 * Output x sums `taps` samples, a multiple of 4, from samples[first[x]] on. Weights lie in blocks of 4 outputs x 4
 * taps: the weights of four outputs' first four taps, of their next four taps, and so on; then those of the next four
 * outputs. Sums are exact as long as each fits 32 bits; area_scale.c sees to that.
 */
#ifndef L1L2_IMAGE_AREA_SCALE_ROW_H
#define L1L2_IMAGE_AREA_SCALE_ROW_H

#include <stdint.h>

enum { L1L2_AREA_SCALE_BLOCK = 4 };

/* count: of outputs, a multiple of 4. */
typedef void L1L2AreaScaleRow(const int16_t *samples, const int32_t *first, const int16_t *weight, int taps, int count,
                              int32_t *sum);

typedef struct L1L2AreaScaleFunctions {
    L1L2AreaScaleRow *row;
} L1L2AreaScaleFunctions;

/* cpu: the instruction sets to use, flags of common/cpu.h. All give the same sums. */
void l1l2_image_scale_functions_init(L1L2AreaScaleFunctions *functions, unsigned cpu);

/* Called by the function above, on processors that have the instruction set. */
void l1l2_image_scale_functions_init_sse2(L1L2AreaScaleFunctions *functions);

#endif
