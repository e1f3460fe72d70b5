/* SPDX-License-Identifier: MIT */
#include "frame.h"

#include <string.h>

#include "geom.h"
#include "log.h"

bool l1l2_frame_has_planes(const L1L2StabFrame *frame, const L1L2FormatInfo *format, const L1L2StabLogger *log)
{
    for (int i = 0; i < format->planes; i++)
        if (!frame->data[i]) {
            l1l2_log(log, L1L2STAB_LOG_ERROR, "plane %d of a %s frame is NULL", i, format->name);
            return false;
        }
    return true;
}

bool l1l2_frame_has_motion(const L1L2StabFrame *frame, const L1L2StabLogger *log)
{
    L1L2Mat F, inverse;
    memcpy(F.m, frame->motion, sizeof F.m);
    const bool valid = l1l2_mat_is_finite(&F) && l1l2_mat_inverse(F, &inverse) && F.m[6] == 0.0 && F.m[7] == 0.0 &&
                       F.m[8] == 1.0 && F.m[0] == F.m[4] && F.m[1] == -F.m[3];
    if (!valid)
        l1l2_log(log, L1L2STAB_LOG_ERROR,
                 "motion is not an invertible similarity [a -b x; b a y; 0 0 1] of finite numbers");
    return valid;
}
