/* SPDX-License-Identifier: MIT */
#include "common/fade.h"

double l1l2_fade_next(L1L2Fade *fade, bool at_once)
{
    const int end = fade->on ? fade->length : 0;
    if (at_once)
        fade->steps = end;
    else if (fade->steps != end)
        fade->steps += fade->on ? 1 : -1;
    const double part = (double)fade->steps / fade->length;
    return part * part * (3.0 - 2.0 * part);
}
