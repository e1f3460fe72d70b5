/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <string.h>

void l1l2_info_export(const L1L2Mat *m, double diagonal_px, double px[9])
{
    const L1L2Mat scaled = l1l2_mat_rescale(*m, diagonal_px);
    memcpy(px, scaled.m, sizeof scaled.m);
}

void l1l2_info_describe(L1L2StabInfo *info, const L1L2QueuedFrame *held, const L1L2PathFrame *f, double diagonal_px)
{
    *info = (L1L2StabInfo){
        .path_index = f->path_index,
        .lambda = f->lambda,
        .crop_ratio = f->crop_ratio,
        .tracks = held->motion.tracks,
        .inliers = held->motion.inliers,
        .quality = held->motion.quality,
        .solver_iterations = f->report.predictor_iterations + f->report.osqp_iterations,
        .solver = f->report.decided_by,
        .solver_bound = f->report.bound,
        .solver_residual = {f->report.osqp_primal_residual, f->report.osqp_dual_residual},
        .model = held->motion.model,
        .stage_ns = {held->motion.scale_ns, held->motion.track_ns, held->motion.fit_ns, held->solve_ns, 0},
    };
    memcpy(info->F, held->F_px, sizeof held->F_px);
    l1l2_info_export(&f->B, diagonal_px, info->B);
    l1l2_info_export(&f->S, diagonal_px, info->S);
    if (f->path_index == 0)
        info->flags |= L1L2STAB_INFO_PATH_START;
    if (info->model == L1L2STAB_MOTION_SOURCE_IDENTITY || info->model == L1L2STAB_MOTION_SOURCE_PREDICTED)
        info->flags |= L1L2STAB_INFO_MOTION_LOST;
    if (held->failed)
        info->flags |= L1L2STAB_INFO_MOTION_FAILED | L1L2STAB_INFO_MOTION_LOST;
    if (f->fallback)
        info->flags |= L1L2STAB_INFO_PATH_FALLBACK;
    if (f->early)
        info->flags |= L1L2STAB_INFO_EARLY;
}
