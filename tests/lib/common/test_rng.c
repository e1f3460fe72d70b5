/* SPDX-License-Identifier: MIT */
#include "checkx.h"
#include "common/rng.h"

START_TEST(the_numbers_are_those_of_pcg32)
{
    /* From the definition, in another language's integers; also the first of PCG's own check of "oneseq", seed 42. */
    static const uint32_t expected[] = {0xc2f57bd6, 0x6b07c4a9, 0x72b7b29b, 0x44215383, 0xf5af5ead};
    L1L2Rng rng = l1l2_rng_seeded(42);
    for (int i = 0; i < 5; i++)
        ck_assert_uint_eq(l1l2_rng_next(&rng), expected[i]);
}
END_TEST

START_TEST(neighboring_seeds_give_different_numbers)
{
    L1L2Rng a = l1l2_rng_seeded(1), b = l1l2_rng_seeded(2);
    int equal = 0;
    for (int i = 0; i < 1000; i++)
        equal += l1l2_rng_next(&a) == l1l2_rng_next(&b);
    ck_assert_int_le(equal, 1);
}
END_TEST

START_TEST(below_gives_each_number_below_its_bound_equally_often)
{
    enum { BOUND = 7, DRAWS = 70000 };
    L1L2Rng rng = l1l2_rng_seeded(3);
    int count[BOUND] = {0};
    for (int i = 0; i < DRAWS; i++) {
        const uint32_t v = l1l2_rng_below(&rng, BOUND);
        ck_assert_uint_lt(v, BOUND);
        count[v]++;
    }
    for (int i = 0; i < BOUND; i++)
        ck_assert_near(count[i], DRAWS / BOUND, 500); /* five standard deviations */
}
END_TEST

START_TEST(below_one_is_zero)
{
    L1L2Rng rng = l1l2_rng_seeded(4);
    for (int i = 0; i < 100; i++)
        ck_assert_uint_eq(l1l2_rng_below(&rng, 1), 0);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("rng");
    TCase *tc = tcase_create("rng");
    tcase_add_test(tc, the_numbers_are_those_of_pcg32);
    tcase_add_test(tc, neighboring_seeds_give_different_numbers);
    tcase_add_test(tc, below_gives_each_number_below_its_bound_equally_often);
    tcase_add_test(tc, below_one_is_zero);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
