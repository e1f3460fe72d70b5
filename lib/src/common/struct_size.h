/* SPDX-License-Identifier: MIT */
/* Public structs that carry their size: a program may have been built against an older or a newer header. */
#ifndef L1L2_COMMON_STRUCT_SIZE_H
#define L1L2_COMMON_STRUCT_SIZE_H

#include <string.h>

#include <l1l2stab/l1l2stab.h>

enum { L1L2_STRUCT_SIZE_MAX = 4096 }; /* bytes; no public struct comes near it: a larger size is garbage */

/* Copies a caller's struct of `size` bytes over *out, which holds `known` bytes of defaults. `least`: bytes of the
 * shortest layout that is accepted.
 * ERR_ARGUMENT: no version has this size. ERR_UNSUPPORTED: bytes are set that this version does not know, and ignoring
 * them would ignore a setting of the caller. On error *out is unchanged. */
static inline L1L2StabResult l1l2_struct_read(void *out, size_t known, const void *in, size_t size, size_t least)
{
    if (size < least || size > L1L2_STRUCT_SIZE_MAX)
        return L1L2STAB_ERR_ARGUMENT;
    for (size_t i = known; i < size; i++)
        if (((const unsigned char *)in)[i] != 0)
            return L1L2STAB_ERR_UNSUPPORTED;
    memcpy(out, in, size < known ? size : known);
    return L1L2STAB_OK;
}

#endif
