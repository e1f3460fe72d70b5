/* SPDX-License-Identifier: MIT */
#include "path/window_schedule.h"

#include <assert.h>

L1L2PathSchedule l1l2_path_schedule_start(int window, int overlap)
{
    return (L1L2PathSchedule){.window = window, .overlap = overlap};
}

bool l1l2_path_schedule_next(L1L2PathSchedule *schedule, int64_t length, bool ended, L1L2PathWindow *step)
{
    const int64_t left = length - schedule->next;
    const bool full = left >= schedule->window;
    if (left <= 0 || (!full && !ended))
        return false;
    step->first = schedule->next;
    step->count = full ? schedule->window : (int)left;
    step->emit = full ? schedule->window - schedule->overlap : (int)left;
    step->shared = schedule->next > 0 && !schedule->early ? schedule->overlap : 0;
    step->early = false;
    schedule->next += step->emit;
    schedule->early = false;
    return true;
}

bool l1l2_path_schedule_early(L1L2PathSchedule *schedule, int64_t length, int64_t emit, L1L2PathWindow *step)
{
    const int64_t left = length - schedule->next;
    if (left <= 0 || emit <= 0)
        return false;
    assert(left < schedule->window);
    step->first = schedule->next;
    step->count = (int)left;
    step->emit = (int)(emit < left ? emit : left);
    step->shared = 0;
    step->early = true;
    schedule->next += step->emit;
    schedule->early = true;
    return true;
}
