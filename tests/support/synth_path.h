/* SPDX-License-Identifier: MIT */
/* The camera's path in closed form, for any time: a steady pan and roll, the shake of whoever holds it, a vibration. */
#ifndef SYNTH_PATH_H
#define SYNTH_PATH_H

#include "synth.h"

/* M: frame to scene, at a time in frames. */
void synth_path_pose(const SynthConfig *cfg, double frames, double M[9]);

#endif
