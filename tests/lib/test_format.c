/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "checkx.h"
#include "format.h"

START_TEST(every_format_of_the_public_header_is_described)
{
    for (int id = L1L2STAB_FORMAT_GRAY8; id <= L1L2STAB_FORMAT_RGB; id++) {
        const L1L2FormatInfo *info = l1l2_format_info((L1L2StabFormat)id);
        ck_assert_ptr_nonnull(info);
        ck_assert_int_eq(info->format, id);
        ck_assert_int_ge(info->planes, 1);
        ck_assert_int_le(info->planes, 3);
        for (int i = 0; i < info->planes; i++) {
            ck_assert_int_ge(info->plane[i].components, 1);
            ck_assert_int_le(info->plane[i].components, 4);
        }
    }
}
END_TEST

START_TEST(a_format_that_is_not_offered_has_no_description)
{
    ck_assert_ptr_null(l1l2_format_info(L1L2STAB_FORMAT_UNKNOWN));
    ck_assert_ptr_null(l1l2_format_info((L1L2StabFormat)(L1L2STAB_FORMAT_RGB + 1)));
    ck_assert_ptr_null(l1l2_format_info((L1L2StabFormat)-1));
}
END_TEST

START_TEST(names_are_those_of_gstreamer)
{
    static const char *const names[] = {"GRAY8", "I420", "YV12", "NV12", "NV21", "Y42B", "Y444",
                                        "BGRx",  "RGBx", "BGRA", "RGBA", "BGR",  "RGB"};
    for (int i = 0; i < 13; i++)
        ck_assert_str_eq(l1l2_format_info((L1L2StabFormat)(L1L2STAB_FORMAT_GRAY8 + i))->name, names[i]);
}
END_TEST

/* Bytes of a 6x4 frame: a wrong subsampling or number of components shows in one of these. */
START_TEST(planes_of_a_frame_have_the_right_number_of_bytes)
{
    static const struct {
        L1L2StabFormat format;
        int bytes[3];
    } cases[] = {
        {L1L2STAB_FORMAT_GRAY8, {24}},       {L1L2STAB_FORMAT_I420, {24, 6, 6}},
        {L1L2STAB_FORMAT_YV12, {24, 6, 6}},  {L1L2STAB_FORMAT_NV12, {24, 12}},
        {L1L2STAB_FORMAT_NV21, {24, 12}},    {L1L2STAB_FORMAT_Y42B, {24, 12, 12}},
        {L1L2STAB_FORMAT_Y444, {24, 24, 24}}, {L1L2STAB_FORMAT_BGRX, {96}},
        {L1L2STAB_FORMAT_RGBX, {96}},        {L1L2STAB_FORMAT_BGRA, {96}},
        {L1L2STAB_FORMAT_RGBA, {96}},        {L1L2STAB_FORMAT_BGR, {72}},
        {L1L2STAB_FORMAT_RGB, {72}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        const L1L2FormatInfo *info = l1l2_format_info(cases[k].format);
        for (int i = 0; i < 3; i++) {
            const int bytes = i < info->planes ? l1l2_plane_size(6, info->plane[i].log2_sub_x) *
                                                     l1l2_plane_size(4, info->plane[i].log2_sub_y) *
                                                     info->plane[i].components
                                               : 0;
            ck_assert_msg(bytes == cases[k].bytes[i], "%s plane %d: %d bytes", info->name, i, bytes);
        }
    }
}
END_TEST

START_TEST(y42b_is_halved_across_and_not_down)
{
    const L1L2FormatInfo *info = l1l2_format_info(L1L2STAB_FORMAT_Y42B);
    ck_assert_int_eq(info->plane[1].log2_sub_x, 1);
    ck_assert_int_eq(info->plane[1].log2_sub_y, 0);
}
END_TEST

START_TEST(halved_planes_of_odd_sizes_are_rounded_up)
{
    ck_assert_int_eq(l1l2_plane_size(17, 0), 17);
    ck_assert_int_eq(l1l2_plane_size(16, 1), 8);
    ck_assert_int_eq(l1l2_plane_size(17, 1), 9);
}
END_TEST

static double grey_weight(L1L2StabFormat format, int component)
{
    return l1l2_format_info(format)->grey[component];
}

START_TEST(grey_is_made_of_the_right_components)
{
    ck_assert_double_eq(grey_weight(L1L2STAB_FORMAT_NV21, 0), 1.0);
    static const L1L2StabFormat blue_first[] = {L1L2STAB_FORMAT_BGRX, L1L2STAB_FORMAT_BGRA, L1L2STAB_FORMAT_BGR};
    static const L1L2StabFormat red_first[] = {L1L2STAB_FORMAT_RGBX, L1L2STAB_FORMAT_RGBA, L1L2STAB_FORMAT_RGB};
    for (int i = 0; i < 3; i++) {
        ck_assert_double_eq(grey_weight(blue_first[i], 0), 0.114);
        ck_assert_double_eq(grey_weight(red_first[i], 0), 0.299);
    }
}
END_TEST

START_TEST(grey_of_white_is_white)
{
    for (int id = L1L2STAB_FORMAT_GRAY8; id <= L1L2STAB_FORMAT_RGB; id++) {
        double sum = 0.0;
        for (int i = 0; i < l1l2_format_info((L1L2StabFormat)id)->plane[0].components; i++)
            sum += grey_weight((L1L2StabFormat)id, i);
        ck_assert_near(sum, 1.0, 1e-12);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("format");
    TCase *tc = tcase_create("format");
    tcase_add_test(tc, every_format_of_the_public_header_is_described);
    tcase_add_test(tc, a_format_that_is_not_offered_has_no_description);
    tcase_add_test(tc, names_are_those_of_gstreamer);
    tcase_add_test(tc, planes_of_a_frame_have_the_right_number_of_bytes);
    tcase_add_test(tc, y42b_is_halved_across_and_not_down);
    tcase_add_test(tc, halved_planes_of_odd_sizes_are_rounded_up);
    tcase_add_test(tc, grey_is_made_of_the_right_components);
    tcase_add_test(tc, grey_of_white_is_white);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
