/* SPDX-License-Identifier: MIT */
#include "frame_check.h"

#include <string.h>

#include "common/geom.h"
#include "common/log.h"

bool l1l2_frame_has_planes(const L1L2StabFrame *frame, const L1L2FormatInfo *format, const L1L2StabLogger *log)
{
    for (int i = 0; i < format->planes; i++)
        if (!frame->data[i]) {
            l1l2_log(log, L1L2STAB_LOG_ERROR, "plane %d of a %s frame is NULL", i, format->name);
            return false;
        }
    return true;
}

bool l1l2_frame_has_motion(const L1L2StabFrame *frame, L1L2StabMotionModel model, const L1L2StabLogger *log)
{
    static const char *const shapes[] = {"translation [1 0 x; 0 1 y; 0 0 1]", "similarity [a -b x; b a y; 0 0 1]",
                                         "affine map [a b x; c d y; 0 0 1]"};
    L1L2Mat F, inverse;
    memcpy(F.m, frame->motion, sizeof F.m);
    const L1L2Mat of_model = l1l2_mat_reduce(&F, l1l2_mat_dim(model));
    bool valid = l1l2_mat_is_finite(&F) && l1l2_mat_inverse(F, &inverse);
    for (int i = 0; i < 9; i++)
        valid = valid && F.m[i] == of_model.m[i];
    if (!valid)
        l1l2_log(log, L1L2STAB_LOG_ERROR, "motion is not an invertible %s of finite numbers", shapes[model]);
    return valid;
}
