/* SPDX-License-Identifier: MIT */
#include "plan.h"

L1L2Plan l1l2_plan_start(int window, int overlap)
{
    return (L1L2Plan){.window = window, .overlap = overlap, .next = 0};
}

bool l1l2_plan_next(L1L2Plan *plan, int64_t length, bool ended, L1L2PlanStep *step)
{
    const int64_t left = length - plan->next;
    const bool full = left >= plan->window;
    if (left <= 0 || (!full && !ended))
        return false;
    step->first = plan->next;
    step->count = full ? plan->window : (int)left;
    step->give = full ? plan->window - plan->overlap : (int)left;
    step->shared = plan->next > 0 ? plan->overlap : 0;
    plan->next += step->give;
    return true;
}
