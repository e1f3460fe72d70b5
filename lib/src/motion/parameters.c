/* SPDX-License-Identifier: MIT */
#include "motion/parameters.h"

#define VALUE(name, value, unit, effect, evidence) .name = (value),
const L1L2MotionParameters l1l2_motion_defaults = {L1L2_MOTION_PARAMETERS(VALUE)};
