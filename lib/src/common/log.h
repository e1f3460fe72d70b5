/* SPDX-License-Identifier: MIT */
/* Level-guarded messages to the caller's logger. */
#ifndef L1L2_COMMON_LOG_H
#define L1L2_COMMON_LOG_H

#include <l1l2stab/l1l2stab.h>

#ifdef __cplusplus
extern "C" {
#endif

/* log may be NULL. printf's format; messages over 500 bytes are cut. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
void l1l2_log(const L1L2StabLogger *log, L1L2StabLogLevel level, const char *format, ...);

#ifdef __cplusplus
}
#endif

#endif
