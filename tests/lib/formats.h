/* SPDX-License-Identifier: MIT */
/* Formats of more than 8 bits come last in the header, and are not supported on big-endian processors. Tests leave them
 * out there, and say so. */
#ifndef FORMATS_H
#define FORMATS_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <l1l2stab/l1l2stab.h>

static inline bool format_left_out(L1L2StabFormat format)
{
    const uint16_t one = 1;
    const bool left_out = format >= L1L2STAB_FORMAT_GRAY16_LE && *(const uint8_t *)&one == 0;
    if (left_out)
        printf("left out on a big-endian processor: formats of more than 8 bits\n");
    return left_out;
}

/* The number after that of the last format which this processor has. */
static inline int end_of_formats(void)
{
    return format_left_out(L1L2STAB_FORMAT_AYUV64) ? L1L2STAB_FORMAT_GRAY16_LE : L1L2STAB_FORMAT_AYUV64 + 1;
}

#endif
