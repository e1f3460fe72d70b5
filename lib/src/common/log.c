/* SPDX-License-Identifier: MIT */
#include "common/log.h"

#include <stdarg.h>
#include <stdio.h>

void l1l2_log(const L1L2StabLogger *log, L1L2StabLogLevel level, const char *format, ...)
{
    if (!log || !log->write || level > log->max_level)
        return;
    char message[500];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    log->write(log->cookie, level, message);
}
