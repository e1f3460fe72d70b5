/* SPDX-License-Identifier: MIT */
/* Meshes: their nodes, their positions, and pictures warped by them against a floating-point warp. */
#include "warp/coords.h"
#include "warp/warp_reference.h"
#include "warp/warp_tables.h"

enum { PHASES = L1L2_WARP_PHASES, SLACK = L1L2_WARP_RUN_SLACK };

static L1L2WarpMesh mesh_of(int width, int height, const L1L2Mat *map)
{
    L1L2WarpMesh mesh;
    ck_assert(l1l2_warp_mesh_init(&mesh, width, height));
    l1l2_warp_mesh_set(&mesh, map);
    return mesh;
}

static L1L2WarpMeshPlane luma_of(const L1L2WarpMesh *mesh, int in_width, int in_height)
{
    const L1L2FormatInfo *gray = l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8);
    return (L1L2WarpMeshPlane){mesh, l1l2_warp_grid(gray, 0, 0, mesh->width, mesh->height),
                               l1l2_warp_grid(gray, 0, 0, in_width, in_height)};
}

/* Positions of several runs. x and y have SLACK entries more than count. */
static void run_by(const L1L2WarpGenerators *generators, const L1L2WarpMeshPlane *plane, int u, int v, int count,
                   int32_t *x, int32_t *y)
{
    for (int i = 0; i < count; i += L1L2_WARP_RUN_SAMPLES) {
        const int part = count - i < L1L2_WARP_RUN_SAMPLES ? count - i : L1L2_WARP_RUN_SAMPLES;
        const L1L2WarpCells cells = l1l2_warp_mesh_cells(plane, u + i, part);
        generators->mesh(plane, &cells, v, x + i, y + i);
    }
}

static void run(const L1L2WarpMeshPlane *plane, int u, int v, int count, int32_t *x, int32_t *y)
{
    const L1L2WarpFunctions functions = fast_functions();
    run_by(&functions.generators, plane, u, v, count, x, y);
}

/* A mesh as for rolling shutter: each row of nodes follows a homography of its own. */
static L1L2WarpMesh random_mesh(L1L2Rng *rng, int width, int height)
{
    L1L2WarpMesh mesh;
    ck_assert(l1l2_warp_mesh_init(&mesh, width, height));
    for (int row = 0; row < mesh.rows; row++) {
        L1L2Mat map = random_similarity(rng);
        map.m[6] = uniform(rng, -1e-3, 1e-3);
        map.m[7] = uniform(rng, -1e-3, 1e-3);
        for (int column = 0; column < mesh.columns; column++)
            mesh.node[row * mesh.columns + column] =
                l1l2_mat_apply(&map, l1l2_warp_mesh_position(&mesh, column, row));
    }
    return mesh;
}

START_TEST(nodes_cover_the_frame_in_cells_of_at_most_64_by_16_px)
{
    static const int sizes[][3] = {{16, 16, 16}, {17, 33, 16}, {1920, 1080, 64},
                                   {640, 360, 32}, {99, 64, 16}, {1, 1, 16}};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        L1L2WarpMesh mesh;
        ck_assert(l1l2_warp_mesh_init(&mesh, sizes[k][0], sizes[k][1]));
        ck_assert_int_eq(mesh.columns, (sizes[k][0] + sizes[k][2] - 1) / sizes[k][2] + 1);
        ck_assert_int_eq(mesh.rows, (sizes[k][1] + 15) / 16 + 1);
        const L1L2Point first = l1l2_warp_mesh_position(&mesh, 0, 0);
        const L1L2Point last = l1l2_warp_mesh_position(&mesh, mesh.columns - 1, mesh.rows - 1);
        ck_assert_double_eq(first.x, -0.5 * sizes[k][0]);
        ck_assert_double_eq(first.y, -0.5 * sizes[k][1]);
        ck_assert_double_eq(last.x, 0.5 * sizes[k][0]);
        ck_assert_double_eq(last.y, 0.5 * sizes[k][1]);
        l1l2_warp_mesh_clear(&mesh);
    }
}
END_TEST

START_TEST(the_mesh_of_an_affine_map_has_its_positions)
{
    enum { WIDTH = 1333, HEIGHT = 70 };
    static int32_t x[WIDTH + SLACK], y[WIDTH + SLACK], mesh_x[WIDTH + SLACK], mesh_y[WIDTH + SLACK];
    L1L2Rng rng = l1l2_rng_seeded(3);
    for (int round = 0; round < 20; round++) {
        const L1L2Mat map = random_similarity(&rng);
        L1L2WarpMesh mesh = mesh_of(WIDTH, HEIGHT, &map);
        const L1L2WarpMeshPlane plane = luma_of(&mesh, 1280, 720);
        const L1L2WarpAffine affine = l1l2_warp_affine(&map, &plane.dst, &plane.src);
        int differing = 0, furthest = 0;
        for (int v = 0; v < HEIGHT; v++) {
            fast_functions().generators.affine(&affine, 0, v, WIDTH, x, y);
            run(&plane, 0, v, WIDTH, mesh_x, mesh_y);
            for (int u = 0; u < WIDTH; u++) {
                const int off = abs(mesh_x[u] - x[u]) | abs(mesh_y[u] - y[u]);
                furthest = off > furthest ? off : furthest;
                differing += off != 0;
            }
        }
        ck_assert_int_le(furthest, 1);
        /* Only if the unrounded position lies half way between two phases, to about 2^-17 px. */
        ck_assert_int_le(differing, WIDTH * HEIGHT / 20);
        l1l2_warp_mesh_clear(&mesh);
    }
}
END_TEST

/* g bends a cell of 64 px by about 2 g * 64^2 / 8 px: for a shake of 0.1 degrees, where g is some 2e-6, two phases. */
START_TEST(the_mesh_of_a_homography_has_its_positions)
{
    enum { WIDTH = 1280, HEIGHT = 720 };
    static int32_t x[WIDTH + SLACK], y[WIDTH + SLACK];
    const double g = 2e-5;
    const L1L2Mat map = {{0.9, -0.02, 3.3, 0.01, 0.91, -2.7, g, -g, 1}};
    L1L2WarpMesh mesh = mesh_of(WIDTH, HEIGHT, &map);
    const L1L2WarpMeshPlane plane = luma_of(&mesh, WIDTH, HEIGHT);
    double worst = 0.0;
    for (int v = 0; v < HEIGHT; v++) {
        run(&plane, 0, v, WIDTH, x, y);
        for (int u = 0; u < WIDTH; u++) {
            const L1L2Point at = l1l2_mat_apply(&map, (L1L2Point){u + 0.5 - WIDTH / 2.0, v + 0.5 - HEIGHT / 2.0});
            worst = fmax(worst, fabs((double)x[u] / PHASES - (at.x + WIDTH / 2.0 - 0.5)));
            worst = fmax(worst, fabs((double)y[u] / PHASES - (at.y + HEIGHT / 2.0 - 0.5)));
        }
    }
    ck_assert_double_le(worst, 0.5 / PHASES + 1024 * g);
    l1l2_warp_mesh_clear(&mesh);
}
END_TEST

START_TEST(positions_depend_neither_on_where_a_run_begins_nor_on_the_processor)
{
    static const int widths[] = {16, 37, 1000, 999};
    static int32_t x[1000 + SLACK], y[1000 + SLACK], part_x[1000 + SLACK], part_y[1000 + SLACK];
    L1L2Rng rng = l1l2_rng_seeded(5);
    for (size_t k = 0; k < sizeof widths / sizeof widths[0]; k++) {
        L1L2WarpMesh mesh = random_mesh(&rng, widths[k], 40);
        const L1L2WarpMeshPlane plane = luma_of(&mesh, 500, 300);
        const L1L2WarpFunctions plain = plain_functions();
        for (int v = 0; v < 40; v += 13) {
            run_by(&plain.generators, &plane, 0, v, widths[k], part_x, part_y);
            run(&plane, 0, v, widths[k], x, y);
            ck_assert_mem_eq(part_x, x, (size_t)widths[k] * sizeof *x);
            ck_assert_mem_eq(part_y, y, (size_t)widths[k] * sizeof *y);
            for (int u = 0; u < widths[k]; u++) {
                const int count = 1 + (int)l1l2_rng_below(&rng, (uint32_t)(widths[k] - u));
                run(&plane, u, v, count, part_x, part_y);
                ck_assert_mem_eq(part_x, x + u, (size_t)count * sizeof *x);
                ck_assert_mem_eq(part_y, y + u, (size_t)count * sizeof *y);
            }
        }
        l1l2_warp_mesh_clear(&mesh);
    }
}
END_TEST

/* All nodes lie in the source frame, many on its border: no position of any plane leaves the frame, at any site. */
START_TEST(nodes_inside_the_source_keep_all_positions_inside)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_GRAY8, L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_Y42B};
    enum { WIDTH = 111, HEIGHT = 75, IN_WIDTH = 97, IN_HEIGHT = 83 };
    int32_t x[WIDTH + SLACK], y[WIDTH + SLACK];
    L1L2Rng rng = l1l2_rng_seeded(6);
    L1L2WarpMesh mesh;
    ck_assert(l1l2_warp_mesh_init(&mesh, WIDTH, HEIGHT));
    for (int k = 0; k < mesh.columns * mesh.rows; k++)
        mesh.node[k] = (L1L2Point){fmin(fmax(uniform(&rng, -1.0, 1.0), -0.5), 0.5) * IN_WIDTH,
                                   fmin(fmax(uniform(&rng, -1.0, 1.0), -0.5), 0.5) * IN_HEIGHT};
    for (int f = 0; f < 3; f++)
        for (int site = 0; site < 3; site++) {
            const L1L2FormatInfo *format = l1l2_image_format_info(formats[f]);
            for (int i = 0; i < format->planes; i++) {
                const L1L2WarpMeshPlane plane = {
                    &mesh, l1l2_warp_grid(format, i, (L1L2StabChromaSite)site, WIDTH, HEIGHT),
                    l1l2_warp_grid(format, i, (L1L2StabChromaSite)site, IN_WIDTH, IN_HEIGHT)};
                const double tiny = 1.0 / PHASES;
                for (int v = 0; v < l1l2_image_plane_size(HEIGHT, format->plane[i].log2_sub_y); v++) {
                    const int count = l1l2_image_plane_size(WIDTH, format->plane[i].log2_sub_x);
                    run(&plane, 0, v, count, x, y);
                    for (int u = 0; u < count; u++) {
                        const double at_x = plane.src.first_x + plane.src.step_x * x[u] / PHASES;
                        const double at_y = plane.src.first_y + plane.src.step_y * y[u] / PHASES;
                        if (at_x < -tiny || at_x > IN_WIDTH + tiny || at_y < -tiny || at_y > IN_HEIGHT + tiny)
                            ck_abort_msg("%s plane %d (%d, %d) reads %f, %f", format->name, i, u, v, at_x, at_y);
                    }
                }
            }
        }
    l1l2_warp_mesh_clear(&mesh);
}
END_TEST

START_TEST(nodes_far_outside_stay_far_outside)
{
    int32_t x[64 + SLACK], y[64 + SLACK];
    L1L2WarpMesh mesh = mesh_of(64, 64, &(L1L2Mat){{1e12, 0, 1e15, 0, 1, -1e300, 0, 0, 1}});
    const L1L2WarpMeshPlane plane = luma_of(&mesh, 64, 64);
    run(&plane, 0, 63, 64, x, y);
    for (int u = 0; u < 64; u++) {
        ck_assert_int_gt(x[u] / PHASES, 500000);
        ck_assert_int_lt(y[u] / PHASES, -500000);
    }
    l1l2_warp_mesh_clear(&mesh);
}
END_TEST

/* The loop tests' index is the format. */
START_TEST(every_format_and_kernel_follows_a_floating_point_warp)
{
    static const int sizes[][4] = {{33, 17, 33, 17}, {64, 48, 64, 48}, {65, 31, 40, 22}, {30, 34, 51, 41}};
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        Picture src = picture_new((L1L2StabFormat)_i, sizes[k][0], sizes[k][1]);
        Picture dst = picture_new((L1L2StabFormat)_i, sizes[k][2], sizes[k][3]);
        picture_randomize(&src, k);
        for (int kernel = 0; kernel < 3; kernel++)
            for (int site = 0; site < 3; site++) {
                L1L2WarpMesh mesh = random_mesh(&rng, dst.width, dst.height);
                const L1L2WarpMap map = {.mesh = &mesh};
                L1L2WarpConfig cfg = warp_config(&src, &dst);
                cfg.interpolation = (L1L2StabInterpolation)kernel;
                cfg.chroma_site = (L1L2StabChromaSite)site;
                assert_follows_reference(&cfg, &map, &src, &dst);
                l1l2_warp_mesh_clear(&mesh);
            }
        picture_free(&src);
        picture_free(&dst);
    }
}
END_TEST

START_TEST(the_mesh_of_the_identity_copies)
{
    Picture src = picture_new((L1L2StabFormat)_i, 45, 27), dst = picture_new((L1L2StabFormat)_i, 45, 27);
    picture_randomize(&src, 1);
    L1L2WarpMesh mesh = mesh_of(45, 27, &(L1L2Mat){{1, 0, 0, 0, 1, 0, 0, 0, 1}});
    const L1L2WarpConfig cfg = warp_config(&src, &dst);
    warp_picture_by(&cfg, &(L1L2WarpMap){.mesh = &mesh}, &src, &dst);
    assert_same_picture(&src, &dst);
    l1l2_warp_mesh_clear(&mesh);
    picture_free(&src);
    picture_free(&dst);
}
END_TEST

START_TEST(the_bytes_do_not_depend_on_threads_or_processor)
{
    L1L2Rng rng = l1l2_rng_seeded(8);
    Picture src = picture_new(L1L2STAB_FORMAT_I420, 333, 222);
    Picture one = picture_new(L1L2STAB_FORMAT_I420, 301, 201), other = picture_new(L1L2STAB_FORMAT_I420, 301, 201);
    picture_randomize(&src, 4);
    L1L2WarpMesh mesh = random_mesh(&rng, 301, 201);
    const L1L2WarpMap map = {.mesh = &mesh};
    L1L2WarpConfig cfg = warp_config(&src, &one);
    warp_picture_by(&cfg, &map, &src, &one);
    for (int way = 1; way < 4; way++) {
        cfg.pool = way % 2 ? l1l2_pool_create(3) : NULL;
        cfg.plain = way / 2;
        warp_picture_by(&cfg, &map, &src, &other);
        assert_same_picture(&one, &other);
        l1l2_pool_free(cfg.pool);
    }
    l1l2_warp_mesh_clear(&mesh);
    picture_free(&src);
    picture_free(&one);
    picture_free(&other);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("warp by a mesh");
    TCase *tc = tcase_create("positions");
    tcase_add_test(tc, nodes_cover_the_frame_in_cells_of_at_most_64_by_16_px);
    tcase_add_test(tc, the_mesh_of_an_affine_map_has_its_positions);
    tcase_add_test(tc, the_mesh_of_a_homography_has_its_positions);
    tcase_add_test(tc, positions_depend_neither_on_where_a_run_begins_nor_on_the_processor);
    tcase_add_test(tc, nodes_inside_the_source_keep_all_positions_inside);
    tcase_add_test(tc, nodes_far_outside_stay_far_outside);
    suite_add_tcase(suite, tc);
    tc = tcase_create("pictures");
    tcase_add_loop_test(tc, every_format_and_kernel_follows_a_floating_point_warp, L1L2STAB_FORMAT_GRAY8,
                        L1L2STAB_FORMAT_RGB + 1);
    tcase_add_loop_test(tc, the_mesh_of_the_identity_copies, FIRST_FORMAT, L1L2STAB_FORMAT_RGB + 1);
    tcase_add_test(tc, the_bytes_do_not_depend_on_threads_or_processor);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
