/* SPDX-License-Identifier: MIT */
/* What every L1L2StabInfo has to fulfill, whatever was pushed. */
#ifndef FUZZ_INFO_H
#define FUZZ_INFO_H

#include <l1l2stab/l1l2stab.h>

#include "fuzz_input.h"

static inline void fuzz_check_matrix(const double m[9], const char *name)
{
    for (int i = 0; i < 9; i++)
        FUZZ_CHECK(isfinite(m[i]), "%s[%d] is %g", name, i, m[i]);
}

/* The corners of the picture that is rendered lie within the source. */
static inline void fuzz_check_inside(const L1L2StabInfo *info, const L1L2StabConfig *cfg)
{
    int width, height;
    FUZZ_CHECK(l1l2stab_config_output_size(cfg, &width, &height) == L1L2STAB_OK, "the config was accepted before");
    for (int corner = 0; corner < 4; corner++) {
        const double x = (corner & 1 ? 0.5 : -0.5) * width, y = (corner & 2 ? 0.5 : -0.5) * height;
        const double *w = info->warp;
        const double u = w[0] * x + w[1] * y + w[2], v = w[3] * x + w[4] * y + w[5];
        FUZZ_CHECK(fabs(u) <= 0.5 * cfg->width * (1 + 1e-9) && fabs(v) <= 0.5 * cfg->height * (1 + 1e-9),
                   "corner %d of %dx%d at %.17g, %.17g", corner, cfg->width, cfg->height, u, v);
    }
}

static inline void fuzz_check_info(const L1L2StabInfo *info, const L1L2StabConfig *cfg)
{
    fuzz_check_matrix(info->F, "F");
    fuzz_check_matrix(info->B, "B");
    fuzz_check_matrix(info->S, "S");
    fuzz_check_matrix(info->C, "C");
    fuzz_check_matrix(info->P, "P");
    fuzz_check_matrix(info->warp, "warp");
    if (cfg->border == L1L2STAB_BORDER_CROP)
        fuzz_check_inside(info, cfg);
    FUZZ_CHECK(info->filled >= 0 && info->extended >= 0 && info->filled + info->extended <= 1 + 1e-9, "%g, %g",
               info->filled, info->extended);
    FUZZ_CHECK(info->crop_ratio >= 0.5 && info->crop_ratio <= 0.99, "%g", info->crop_ratio);
    FUZZ_CHECK(info->inliers >= 0 && info->inliers <= info->tracks, "%d of %d", info->inliers, info->tracks);
    FUZZ_CHECK(info->quality >= 0 && info->quality <= 1, "%g", info->quality);
    FUZZ_CHECK(info->bypass >= 0 && info->bypass <= 1, "%g", info->bypass);
    FUZZ_CHECK(info->residual >= 0 && isfinite(info->residual), "%g", info->residual);
    FUZZ_CHECK(isfinite(info->readout), "%g", info->readout);
    FUZZ_CHECK(info->solver_bound >= 0, "%g", info->solver_bound);
    FUZZ_CHECK(isfinite(info->solver_residual[0]) && isfinite(info->solver_residual[1]), "%g, %g",
               info->solver_residual[0], info->solver_residual[1]);
    FUZZ_CHECK(info->path_index <= info->index, "frame %llu of its path", (unsigned long long)info->path_index);
    for (size_t i = 0; i < sizeof info->stage_ns / sizeof info->stage_ns[0]; i++)
        FUZZ_CHECK(info->stage_ns[i] >= 0, "stage %zu", i);
    for (size_t i = 0; i < sizeof info->reserved; i++)
        FUZZ_CHECK(info->reserved[i] == 0, "reserved[%zu]", i);
}

#endif
