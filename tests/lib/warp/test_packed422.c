/* SPDX-License-Identifier: MIT */
/* Packed 4:2:2 is warped as its planes are, and nothing beside the frame is written. */
#include "warp/warp_fixture.h"

static const struct {
    L1L2StabFormat format;
    int y, u, v; /* places in a pair; the second luma is two on */
} layouts[] = {
    {L1L2STAB_FORMAT_YUY2, 0, 1, 3},
    {L1L2STAB_FORMAT_UYVY, 1, 0, 2},
    {L1L2STAB_FORMAT_YVYU, 0, 3, 1},
    {L1L2STAB_FORMAT_VYUY, 1, 2, 0},
};

/* Where sample (u, v) of a plane lies in a packed picture. */
static uint8_t *packed_sample(const Picture *packed, int layout, int plane, int u, int v)
{
    if (plane == 0)
        return sample(packed, 0, u / 2, v) + layouts[layout].y + 2 * (u % 2);
    return sample(packed, 0, u, v) + (plane == 1 ? layouts[layout].u : layouts[layout].v);
}

static void pack(const Picture *planes, Picture *packed, int layout)
{
    for (int i = 0; i < 3; i++)
        for (int v = 0; v < planes->plane[i].height; v++)
            for (int u = 0; u < planes->plane[i].width; u++)
                *packed_sample(packed, layout, i, u, v) = *sample(planes, i, u, v);
}

/* The loop test's index is the layout. */
START_TEST(packed_pictures_are_warped_as_their_planes)
{
    static const int sizes[][4] = {{64, 48, 64, 48}, {45, 27, 45, 27}, {45, 27, 40, 22}, {301, 33, 301, 33}};
    const L1L2StabFormat format = layouts[_i].format;
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)_i);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++)
        for (int site = 0; site < 3; site++) {
            Picture planes = picture_new(L1L2STAB_FORMAT_Y42B, sizes[k][0], sizes[k][1]);
            Picture expected = picture_new(L1L2STAB_FORMAT_Y42B, sizes[k][2], sizes[k][3]);
            Picture src = picture_new(format, sizes[k][0], sizes[k][1]);
            Picture dst = picture_new(format, sizes[k][2], sizes[k][3]);
            const L1L2Mat map = random_similarity(&rng);
            L1L2WarpConfig cfg = warp_config(&planes, &expected);
            cfg.chroma_site = (L1L2StabChromaSite)site;
            picture_randomize(&planes, k);
            pack(&planes, &src, _i);
            warp_picture(&cfg, &map, &planes, &expected);
            cfg.format = src.format;
            cfg.pool = l1l2_pool_create(2);
            warp_picture(&cfg, &map, &src, &dst);
            for (int i = 0; i < 3; i++)
                for (int v = 0; v < expected.plane[i].height; v++)
                    for (int u = 0; u < expected.plane[i].width; u++)
                        if (*packed_sample(&dst, _i, i, u, v) != *sample(&expected, i, u, v))
                            ck_abort_msg("%s plane %d (%d, %d)", src.format->name, i, u, v);
            assert_guards_untouched(&dst);
            l1l2_pool_free(cfg.pool);
            picture_free(&planes);
            picture_free(&expected);
            picture_free(&src);
            picture_free(&dst);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("warp, packed");
    TCase *tc = tcase_create("packed");
    tcase_add_loop_test(tc, packed_pictures_are_warped_as_their_planes, 0, 4);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
