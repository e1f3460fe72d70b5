/* SPDX-License-Identifier: MIT */
/*
 * Before and after in one picture, for --compare.
 *
 *     side    the source frame on the left, the stabilized one on the right: twice as wide
 *     split   the left half of the source frame, the right half of the stabilized one
 *     flip    both in turn, a second each
 *
 * The source frames are kept until their stabilized ones come out. The stabilizer holds them anyway, so that costs no
 * memory.
 */
#ifndef COMPARE_H
#define COMPARE_H

#include "options.h"

void compare_install(GstElement *stabilizer, Compare compare);

#endif
