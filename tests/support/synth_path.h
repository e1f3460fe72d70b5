/* SPDX-License-Identifier: MIT */
/* The camera's path in closed form, for any time: a steady pan and roll, the shake of the hold, and a vibration. */
#ifndef SYNTH_PATH_H
#define SYNTH_PATH_H

#include "synth.h"

/* M: frame to scene, at a time in frames. */
void synth_path_pose(const SynthConfig *cfg, double frames, double M[9]);

/* N^-1 M of two poses, which are similarities: the motion from the frame with pose M to the frame with pose N. */
void synth_path_motion(const double M[9], const double N[9], double F[9]);

#endif
