/* SPDX-License-Identifier: MIT */
/* Which frames fill a border: near ones first, and together all that any of them shows. */
#include "border/neighbors.h"
#include "checkx.h"

enum { WIDTH = 400, HEIGHT = 200, MOST = 8 };

/* A frame whose output lies 20 px too far left: the left 20 columns are missing. */
static const double missing_px = 20.0;

static L1L2BorderNeed need_of(const L1L2Mat *map)
{
    return (L1L2BorderNeed){.t = 100, .map = map, .width = WIDTH, .height = HEIGHT,
                            .strips = {4, {{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 40, HEIGHT}, {0, 0, 0, 0}}}};
}

/* A neighbor whose frame lies `left` pixels farther left. */
static L1L2BorderNeighbor neighbor(int64_t t, double left)
{
    return (L1L2BorderNeighbor){.t = t, .map = l1l2_mat_translation(left, 0.0)};
}

static L1L2BorderChoice choose(const L1L2BorderNeed *need, const L1L2BorderNeighbor *neighbors, int count)
{
    L1L2BorderMissing *missing = l1l2_border_missing_new();
    const L1L2BorderChoice choice = l1l2_border_choose(missing, need, neighbors, count);
    l1l2_border_missing_free(missing);
    return choice;
}

START_TEST(the_nearest_neighbor_that_shows_all_is_the_only_source)
{
    const L1L2Mat map = l1l2_mat_translation(-missing_px, 0.0);
    const L1L2BorderNeed need = need_of(&map);
    const L1L2BorderNeighbor neighbors[] = {neighbor(80, 60.0), neighbor(97, 30.0), neighbor(99, 0.0),
                                            neighbor(105, 50.0)};
    const L1L2BorderChoice choice = choose(&need, neighbors, 4);
    ck_assert_int_eq(choice.count, 1);
    ck_assert_int_eq(choice.neighbor[0], 1);
}
END_TEST

START_TEST(near_neighbors_come_first_and_far_ones_show_the_rest)
{
    const L1L2Mat map = l1l2_mat_translation(-missing_px, 0.0);
    const L1L2BorderNeed need = need_of(&map);
    const L1L2BorderNeighbor neighbors[] = {neighbor(80, 60.0), neighbor(101, 12.0)};
    const L1L2BorderChoice choice = choose(&need, neighbors, 2);
    ck_assert_int_eq(choice.count, 2);
    ck_assert_int_eq(choice.neighbor[0], 1);
    ck_assert_int_eq(choice.neighbor[1], 0);
}
END_TEST

/* The left 100 columns are missing. The nearest five show more and more of them. Of what is left, frame 72 shows all,
 * and frame 88, which has drifted much less, all but some columns. */
START_TEST(what_near_neighbors_leave_is_shown_by_the_next_ones)
{
    const L1L2Mat map = l1l2_mat_translation(-100.0, 0.0);
    const L1L2BorderNeed need = need_of(&map);
    const L1L2BorderNeighbor neighbors[] = {neighbor(72, 120.0), neighbor(88, 96.5), neighbor(95, 64.5),
                                            neighbor(96, 52.0), neighbor(97, 39.0), neighbor(98, 26.5),
                                            neighbor(99, 14.0)};
    const L1L2BorderChoice choice = choose(&need, neighbors, 7);
    bool chosen = false;
    for (int i = 0; i < choice.count; i++)
        chosen = chosen || choice.neighbor[i] == 1;
    ck_assert(chosen);
}
END_TEST

START_TEST(a_source_is_rendered_around_what_it_shows_and_only_in_strips)
{
    const L1L2Mat map = l1l2_mat_translation(-missing_px, 0.0);
    const L1L2BorderNeed need = need_of(&map);
    const L1L2BorderNeighbor neighbors[] = {neighbor(99, 30.0)};
    const L1L2BorderChoice choice = choose(&need, neighbors, 1);
    const L1L2WarpRect *part = choice.part[0].rect;
    ck_assert_int_eq(part[2].left, 0);
    ck_assert_int_ge(part[2].right, (int)missing_px);
    ck_assert_int_le(part[2].right, 40);
    ck_assert_int_eq(part[2].bottom - part[2].top, HEIGHT);
    for (int k = 0; k < L1L2_BORDER_STRIPS; k++)
        ck_assert(k == 2 || l1l2_border_is_empty(&part[k]));
}
END_TEST

START_TEST(what_no_neighbor_shows_stays_without_a_source)
{
    const L1L2Mat map = l1l2_mat_translation(-missing_px, 0.0);
    const L1L2BorderNeed need = need_of(&map);
    const L1L2BorderNeighbor neighbors[] = {neighbor(99, 0.0), neighbor(101, -5.0)};
    ck_assert_int_eq(choose(&need, neighbors, 2).count, 0);
    ck_assert_int_eq(choose(&need, NULL, 0).count, 0);
}
END_TEST

/* Each neighbor shows one more column, so that all would be of some use. */
START_TEST(the_number_of_sources_is_bounded)
{
    const L1L2Mat map = l1l2_mat_translation(-missing_px, 0.0);
    const L1L2BorderNeed need = need_of(&map);
    L1L2BorderNeighbor neighbors[40];
    for (int i = 0; i < 40; i++)
        neighbors[i] = neighbor(99 - i, 3.0 + i);
    const L1L2BorderChoice choice = choose(&need, neighbors, 40);
    ck_assert_int_le(choice.count, L1L2_BORDER_MAX_SOURCES);
    const L1L2BorderNeighbor *last = &neighbors[choice.neighbor[choice.count - 1]];
    ck_assert_double_ge(last->map.m[2], missing_px); /* the rest is shown by one that shows all */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("neighbors");
    TCase *tcase = tcase_create("neighbors");
    tcase_add_test(tcase, the_nearest_neighbor_that_shows_all_is_the_only_source);
    tcase_add_test(tcase, near_neighbors_come_first_and_far_ones_show_the_rest);
    tcase_add_test(tcase, what_near_neighbors_leave_is_shown_by_the_next_ones);
    tcase_add_test(tcase, a_source_is_rendered_around_what_it_shows_and_only_in_strips);
    tcase_add_test(tcase, what_no_neighbor_shows_stays_without_a_source);
    tcase_add_test(tcase, the_number_of_sources_is_bounded);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
