/* SPDX-License-Identifier: MIT */
#include "frame_check.h"

#include <math.h>
#include <string.h>

#include "common/geom.h"
#include "common/log.h"
#include "common/struct_size.h"

/* The layout of version 0.2, in which `motion` is the last field. */
static const size_t size_of_0_2 = offsetof(L1L2StabFrame, motion) + sizeof(const double *);

L1L2StabResult l1l2_frame_read(const L1L2StabFrame *in, L1L2StabFrame *out, const L1L2StabLogger *log)
{
    const size_t size = in->struct_size ? in->struct_size : size_of_0_2;
    *out = (L1L2StabFrame){0};
    const L1L2StabResult result = l1l2_struct_read(out, sizeof *out, in, size, size_of_0_2);
    if (result == L1L2STAB_ERR_UNSUPPORTED)
        l1l2_log(log, L1L2STAB_LOG_ERROR,
                 "a frame of %zu bytes uses a field that came after version %s: leave it 0, or update the library",
                 size, l1l2stab_version());
    else if (result != L1L2STAB_OK)
        l1l2_log(log, L1L2STAB_LOG_ERROR, "struct_size of a frame is %zu: set it to sizeof(L1L2StabFrame) or 0", size);
    return result;
}

bool l1l2_frame_has_planes(const L1L2StabFrame *frame, const L1L2FormatInfo *format, const L1L2StabLogger *log)
{
    for (int i = 0; i < format->planes; i++) {
        if (!frame->data[i]) {
            l1l2_log(log, L1L2STAB_LOG_ERROR, "plane %d of a %s frame is NULL: set data[%d]", i, format->name, i);
            return false;
        }
        if (l1l2_image_format_bytes(format) == 2 && (((uintptr_t)frame->data[i] | (uintptr_t)frame->stride[i]) & 1)) {
            l1l2_log(log, L1L2STAB_LOG_ERROR,
                     "plane %d of a %s frame lies at an odd address or has an odd stride of %td: both must be even,"
                     " since a component takes two bytes", i, format->name, frame->stride[i]);
            return false;
        }
    }
    return true;
}

static bool is_of_model(const L1L2Mat *F, L1L2StabMotionModel model)
{
    L1L2Mat inverse;
    const L1L2Mat reduced = l1l2_mat_reduce(F, l1l2_mat_dim(model));
    for (int i = 0; i < 9; i++)
        if (F->m[i] != reduced.m[i]) /* true for NaN */
            return false;
    return l1l2_mat_is_finite(F) && l1l2_mat_inverse(*F, &inverse);
}

static bool is_plausible(const L1L2Mat *F, double diagonal_px)
{
    double most, least;
    l1l2_mat_stretch(F, &most, &least);
    return hypot(F->m[2], F->m[5]) <= L1L2_MAX_STEP * diagonal_px && most <= L1L2_MAX_STRETCH &&
           least >= 1.0 / L1L2_MAX_STRETCH;
}

bool l1l2_frame_has_motion(const L1L2StabFrame *frame, const L1L2StabConfig *cfg)
{
    static const char *const shapes[] = {"translation [1 0 x; 0 1 y; 0 0 1]", "similarity [a -b x; b a y; 0 0 1]",
                                         "affine map [a b x; c d y; 0 0 1]"};
    L1L2Mat F;
    memcpy(F.m, frame->motion, sizeof F.m);
    if (!is_of_model(&F, cfg->motion_model)) {
        l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR,
                 "the motion of a frame must be an invertible %s of finite numbers, as motion_model says",
                 shapes[cfg->motion_model]);
        return false;
    }
    if (!is_plausible(&F, hypot(cfg->width, cfg->height))) {
        l1l2_log(&cfg->logger, L1L2STAB_LOG_ERROR,
                 "the motion [%g %g %g; %g %g %g] of a frame is none that a camera makes: it must move by at most %g"
                 " diagonals, stretch by %g to %g, and not mirror", F.m[0], F.m[1], F.m[2], F.m[3], F.m[4], F.m[5],
                 L1L2_MAX_STEP, 1.0 / L1L2_MAX_STRETCH, L1L2_MAX_STRETCH);
        return false;
    }
    return true;
}
