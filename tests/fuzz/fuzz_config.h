/* SPDX-License-Identifier: MIT */
/* A config by choice: mostly a valid one of a small size, sometimes with one field spoiled. */
#ifndef FUZZ_CONFIG_H
#define FUZZ_CONFIG_H

#include <l1l2stab/l1l2stab.h>

#include "fuzz_input.h"

static inline double fuzz_frame_rate(FuzzInput *in)
{
    static const double rates[] = {30, 0, 25, 1000, 1e-3, 1e-300, 59.94};
    return rates[fuzz_below(in, 7)];
}

static inline void fuzz_config_path(L1L2StabConfig *cfg, FuzzInput *in, int longest_window)
{
    cfg->window = fuzz_between(in, 4, longest_window);
    cfg->join = (L1L2StabJoin)fuzz_below(in, 2);
    if (cfg->join == L1L2STAB_JOIN_BLEND && cfg->window < 6)
        cfg->window = 6;
    if (fuzz_below(in, 2))
        cfg->overlap = fuzz_between(in, 3, cfg->join == L1L2STAB_JOIN_BLEND ? cfg->window / 2 : cfg->window - 1);
    cfg->lambda = fuzz_below(in, 4) ? 3.0 * fuzz_part(in) : 1000.0 * fuzz_below(in, 2);
    cfg->crop_ratio = 0.5 + 0.49 * fuzz_part(in);
    cfg->motion_model = (L1L2StabMotionModel)fuzz_below(in, 3);
    cfg->solver = fuzz_chance(in, 4) ? (L1L2StabSolver)fuzz_below(in, 4) : L1L2STAB_SOLVER_AUTO;
    cfg->frame_rate = fuzz_frame_rate(in);
    cfg->pixel_aspect = fuzz_chance(in, 4) ? 0.1 + 9.9 * fuzz_part(in) : 1.0;
    for (int i = 0; i < 3; i++)
        if (fuzz_chance(in, 8))
            cfg->weights[i] = fuzz_below(in, 2) ? 1000.0 * fuzz_part(in) + 1e-300 : pow(10.0, -fuzz_below(in, 250));
}

static inline void fuzz_config_picture(L1L2StabConfig *cfg, FuzzInput *in)
{
    cfg->format = (L1L2StabFormat)fuzz_between(in, 1, 54);
    cfg->width = fuzz_between(in, 16, 120);
    cfg->height = fuzz_between(in, 16, 90);
    if (fuzz_chance(in, 64))
        cfg->width = 16384, cfg->height = 16;
    cfg->chroma_site = (L1L2StabChromaSite)fuzz_below(in, 3);
    cfg->interpolation = (L1L2StabInterpolation)fuzz_below(in, 3);
    cfg->output_size = (L1L2StabOutputSize)fuzz_below(in, 2);
    if (cfg->output_size == L1L2STAB_OUTPUT_SIZE_INPUT)
        cfg->border = (L1L2StabBorder)fuzz_below(in, 3);
    cfg->fill_frames = fuzz_between(in, 0, 12);
    cfg->rolling_shutter = (L1L2StabRollingShutter)fuzz_below(in, 3);
    cfg->analysis_size = fuzz_between(in, 128, 160);
    cfg->seed = fuzz_bits(in, 2);
}

static inline void fuzz_config_region(L1L2StabConfig *cfg, FuzzInput *in)
{
    if (!fuzz_chance(in, 4))
        return;
    cfg->region[0] = fuzz_part(in) * 0.8;
    cfg->region[1] = fuzz_part(in) * 0.8;
    cfg->region[2] = 0.125 + fuzz_part(in) * (0.875 - cfg->region[0]);
    cfg->region[3] = 0.125 + fuzz_part(in) * (0.875 - cfg->region[1]);
}

/* The mask is read during create only. */
static inline void fuzz_config_mask(L1L2StabConfig *cfg, FuzzInput *in, uint8_t pixels[256])
{
    if (!fuzz_chance(in, 4))
        return;
    for (int i = 0; i < 256; i++)
        pixels[i] = (uint8_t)(i * fuzz_below(in, 2));
    cfg->mask = pixels;
    cfg->mask_width = fuzz_between(in, 1, 16);
    cfg->mask_height = fuzz_between(in, 1, 16);
    cfg->mask_stride = fuzz_between(in, cfg->mask_width, 16);
}

/* Sets one field to a value that is probably not allowed. */
static inline void fuzz_config_spoil(L1L2StabConfig *cfg, FuzzInput *in)
{
    int *const ints[] = {&cfg->width, &cfg->height, &cfg->window, &cfg->fill_frames, &cfg->analysis_size,
                         &cfg->threads, &cfg->mask_width, &cfg->mask_height};
    double *const doubles[] = {&cfg->frame_rate, &cfg->lambda, &cfg->crop_ratio, &cfg->weights[1], &cfg->pixel_aspect,
                               &cfg->region[0], &cfg->region[2]};
    void *const enums[] = {&cfg->format, &cfg->chroma_site, &cfg->join, &cfg->interpolation, &cfg->output_size,
                           &cfg->solver, &cfg->motion_model, &cfg->rolling_shutter, &cfg->border};
    const int field = fuzz_below(in, 25);
    const int32_t value = (int32_t)fuzz_bits(in, 4);
    if (field < 2)
        *ints[field] = value > 64 ? 16385 : value; /* no large frames here: they take long */
    else if (field < 6)
        *ints[field] = value;
    else if (field < 8)
        *ints[field] = value > 0 ? 16385 : value; /* a larger mask than there is would be the caller's fault */
    else if (field < 15)
        *doubles[field - 8] = fuzz_any_double(in);
    else if (field < 24)
        memcpy(enums[field - 15], &value, sizeof value);
    else
        cfg->mask_stride = value > 0 ? -value : value;
}

#endif
