/* SPDX-License-Identifier: MIT */
#include "path/window_schedule.h"

#include <assert.h>

L1L2PathSchedule l1l2_path_schedule_start(int window, int overlap)
{
    return (L1L2PathSchedule){.window = window, .overlap = overlap};
}

bool l1l2_path_schedule_next(L1L2PathSchedule *plan, int64_t length, bool ended, L1L2PathWindow *step)
{
    const int64_t left = length - plan->next;
    const bool full = left >= plan->window;
    if (left <= 0 || (!full && !ended))
        return false;
    step->first = plan->next;
    step->count = full ? plan->window : (int)left;
    step->give = full ? plan->window - plan->overlap : (int)left;
    step->shared = plan->next > 0 && !plan->early ? plan->overlap : 0;
    step->early = false;
    plan->next += step->give;
    plan->early = false;
    return true;
}

bool l1l2_path_schedule_early(L1L2PathSchedule *plan, int64_t length, int64_t give, L1L2PathWindow *step)
{
    const int64_t left = length - plan->next;
    if (left <= 0 || give <= 0)
        return false;
    assert(left < plan->window);
    step->first = plan->next;
    step->count = (int)left;
    step->give = (int)(give < left ? give : left);
    step->shared = 0;
    step->early = true;
    plan->next += step->give;
    plan->early = true;
    return true;
}
