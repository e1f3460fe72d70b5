/* SPDX-License-Identifier: MIT */
/* The displacement that is measured beside a border and carried outward. */
#include "border/registration.h"

#include <math.h>
#include <stdlib.h>

#include "checkx.h"

enum { WIDTH = 320, HEIGHT = 180, MISSING = 24, BAND = 64 };

typedef struct Case {
    L1L2BorderView own, neighbor;
    L1L2BorderRegistration *registration;
    L1L2BorderField field;
    L1L2BorderBand band;
} Case;

static double texture(double x, double y)
{
    return 120.0 + 30.0 * sin(0.31 * x + 0.07 * y) + 25.0 * sin(0.11 * x - 0.23 * y) + 20.0 * sin(0.05 * x + 0.41 * y) +
           15.0 * sin(0.19 * x + 0.29 * y);
}

/* The own picture lacks its left MISSING columns. The neighbor shows all, displaced, and brighter. */
static Case make_case(double dx, double dy, double brighter)
{
    Case c = {.registration = l1l2_border_registration_new(WIDTH, HEIGHT),
              .band = {1, {{0, 0, BAND, HEIGHT}}}};
    ck_assert(l1l2_border_view_init(&c.own, WIDTH, HEIGHT) && l1l2_border_view_init(&c.neighbor, WIDTH, HEIGHT));
    c.field.columns = l1l2_border_nodes(WIDTH), c.field.rows = l1l2_border_nodes(HEIGHT);
    const size_t nodes = (size_t)(c.field.columns * c.field.rows);
    c.field.shift = calloc(nodes, sizeof *c.field.shift);
    c.field.agreement = calloc(nodes, sizeof *c.field.agreement);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            c.own.level[y * WIDTH + x] = x < MISSING || x >= BAND ? -1.0f : (float)texture(x, y);
            c.neighbor.level[y * WIDTH + x] = x >= BAND ? -1.0f : (float)(texture(x - dx, y - dy) + brighter);
        }
    return c;
}

static void register_case(Case *c)
{
    l1l2_border_view_halve(&c->own, &c->band);
    l1l2_border_view_halve(&c->neighbor, &c->band);
    l1l2_border_register(c->registration, &c->own, &c->neighbor, &c->band, &c->field);
}

static void free_case(Case *c)
{
    l1l2_border_view_clear(&c->own);
    l1l2_border_view_clear(&c->neighbor);
    free(c->field.shift);
    free(c->field.agreement);
    l1l2_border_registration_free(c->registration);
}

/* 0: none, to 3: several pixels. */
START_TEST(a_displacement_is_found_and_carried_outward)
{
    const double shifts[][2] = {{0.0, 0.0}, {0.4, -0.3}, {2.6, 1.7}, {-5.0, 3.0}};
    Case c = make_case(shifts[_i][0], shifts[_i][1], 9.0);
    register_case(&c);
    for (int row = 0; row < c.field.rows; row++) {
        const L1L2Point outermost = c.field.shift[row * c.field.columns];
        ck_assert_double_le(fabs(outermost.x - shifts[_i][0]), 0.05);
        ck_assert_double_le(fabs(outermost.y - shifts[_i][1]), 0.05);
        ck_assert_double_ge(c.field.agreement[row * c.field.columns], 0.99);
    }
    free_case(&c);
}
END_TEST

START_TEST(pictures_of_other_things_do_not_agree)
{
    Case c = make_case(0.0, 0.0, 0.0);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        if (c.neighbor.level[i] >= 0.0f)
            c.neighbor.level[i] = (float)texture(1.7 * (i / WIDTH) + 400.0, 1.3 * (i % WIDTH));
    register_case(&c);
    for (int row = 0; row < c.field.rows; row++)
        ck_assert_double_le(c.field.agreement[row * c.field.columns], 0.5);
    free_case(&c);
}
END_TEST

START_TEST(without_texture_nothing_is_moved)
{
    Case c = make_case(0.0, 0.0, 0.0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        c.own.level[i] = c.own.level[i] < 0.0f ? -1.0f : 90.0f;
        c.neighbor.level[i] = c.neighbor.level[i] < 0.0f ? -1.0f : 95.0f;
    }
    register_case(&c);
    for (int row = 0; row < c.field.rows; row++) {
        ck_assert_double_le(fabs(c.field.shift[row * c.field.columns].x), 1e-6);
        ck_assert_double_le(fabs(c.field.shift[row * c.field.columns].y), 1e-6);
        ck_assert_double_ge(c.field.agreement[row * c.field.columns], 0.99);
    }
    free_case(&c);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("registration");
    TCase *tcase = tcase_create("registration");
    tcase_add_loop_test(tcase, a_displacement_is_found_and_carried_outward, 0, 4);
    tcase_add_test(tcase, pictures_of_other_things_do_not_agree);
    tcase_add_test(tcase, without_texture_nothing_is_moved);
    suite_add_tcase(suite, tcase);
    return checkx_run(suite);
}
