/* SPDX-License-Identifier: MIT */
/* What every Check program here needs: a comparison of numbers that prints both values, and main(). */
#ifndef CHECKX_H
#define CHECKX_H

#include <check.h>
#include <math.h>
#include <stdlib.h>

#define ck_assert_near(actual, expected, tolerance) \
    ck_assert_msg(fabs((double)(actual) - (double)(expected)) <= (double)(tolerance), \
                  "%s = %.9g, expected %s = %.9g within %.3g", #actual, (double)(actual), #expected, \
                  (double)(expected), (double)(tolerance))

/* Runs one suite. Check's last line of output has the totals. */
static inline int checkx_run(Suite *suite)
{
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

#endif
