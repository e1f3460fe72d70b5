/* SPDX-License-Identifier: MIT */
/* The configuration: its defaults, its checks, and the values that follow from it. */
#ifndef L1L2_CONFIG_H
#define L1L2_CONFIG_H

#include <stdbool.h>

#include "image/format.h"

/* Copies *in (of any struct_size) over the defaults into *out, and replaces an overlap of 0 by the join's default.
 * Checks every field; the reason of a refusal is logged to in's logger. */
L1L2StabResult l1l2_config_resolve(const L1L2StabConfig *in, L1L2StabConfig *out);

/* Whether lambda and crop_ratio, which can be set live, are in range; a refusal is logged. */
bool l1l2_config_check_live(const L1L2StabConfig *cfg);

/* Size of the rendered picture. */
void l1l2_config_output_size(const L1L2StabConfig *resolved, int *width, int *height);

#endif
