/* SPDX-License-Identifier: MIT */
#include "info.h"

#include <string.h>

#include "units.h"

static unsigned flags_of(const L1L2QueuedFrame *record)
{
    unsigned flags = 0;
    if (record->path.path_index == 0)
        flags |= L1L2STAB_INFO_PATH_START;
    if (record->source == L1L2STAB_MOTION_SOURCE_IDENTITY || record->source == L1L2STAB_MOTION_SOURCE_PREDICTED)
        flags |= L1L2STAB_INFO_MOTION_LOST;
    if (record->failed)
        flags |= L1L2STAB_INFO_MOTION_FAILED | L1L2STAB_INFO_MOTION_LOST;
    if (record->bridged)
        flags |= L1L2STAB_INFO_BRIDGED;
    if (record->path.fallback)
        flags |= L1L2STAB_INFO_PATH_FALLBACK;
    if (record->path.early)
        flags |= L1L2STAB_INFO_EARLY;
    return flags;
}

void l1l2_info_describe(L1L2StabInfo *info, const L1L2QueuedFrame *record, double diagonal_px)
{
    const L1L2PathFrame *path = &record->path;
    *info = (L1L2StabInfo){
        .path_index = path->path_index,
        .lambda = path->lambda,
        .crop_ratio = path->crop_ratio,
        .tracks = record->tracks,
        .inliers = record->inliers,
        .quality = record->quality,
        .solver_iterations = path->report.predictor_iterations + path->report.osqp_iterations,
        .solver = path->report.decided_by,
        .solver_bound = path->report.bound,
        .solver_residual = {path->report.osqp_primal_residual, path->report.osqp_dual_residual},
        .model = record->source,
        .flags = flags_of(record),
        .stage_ns = {record->scale_ns, record->track_ns, record->fit_ns, record->solve_ns},
    };
    memcpy(info->F, record->F_px, sizeof info->F);
    l1l2_units_export(&path->B, diagonal_px, info->B);
    l1l2_units_export(&path->S, diagonal_px, info->S);
}
