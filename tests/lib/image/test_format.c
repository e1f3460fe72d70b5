/* SPDX-License-Identifier: MIT */
/* The table of pixel formats against the public header and the sizes of their planes. */
#include <string.h>

#include "checkx.h"
#include "formats.h"
#include "image/format.h"

enum { FIRST = L1L2STAB_FORMAT_GRAY8, LAST = L1L2STAB_FORMAT_AYUV64 };

START_TEST(every_format_of_the_public_header_is_described)
{
    for (int id = FIRST; id < end_of_formats(); id++) {
        const L1L2FormatInfo *info = l1l2_image_format_info((L1L2StabFormat)id);
        ck_assert_ptr_nonnull(info);
        ck_assert_int_eq(info->format, id);
        ck_assert_int_ge(info->planes, 1);
        ck_assert_int_le(info->planes, L1L2_MAX_PLANES);
        ck_assert(info->depth == 8 || info->depth == 10 || info->depth == 12 || info->depth == 16);
        ck_assert(info->shift == 0 || info->shift == 16 - info->depth);
        for (int i = 0; i < info->planes; i++) {
            ck_assert_int_ge(info->plane[i].components, 1);
            ck_assert_int_le(info->plane[i].components, 4);
            ck_assert(info->depth == 8 || info->plane[i].components != 3); /* direct_u16.h has no such function */
        }
    }
}
END_TEST

START_TEST(an_unsupported_format_has_no_description)
{
    ck_assert_ptr_null(l1l2_image_format_info(L1L2STAB_FORMAT_UNKNOWN));
    for (int id = end_of_formats(); id <= LAST + 1; id++)
        ck_assert_ptr_null(l1l2_image_format_info((L1L2StabFormat)id));
    ck_assert_ptr_null(l1l2_image_format_info((L1L2StabFormat)-1));
}
END_TEST

START_TEST(no_name_is_used_twice)
{
    for (int a = FIRST; a < end_of_formats(); a++)
        for (int b = FIRST; b < a; b++)
            ck_assert_str_ne(l1l2_image_format_info((L1L2StabFormat)a)->name,
                             l1l2_image_format_info((L1L2StabFormat)b)->name);
}
END_TEST

/* Bytes of an 8x4 frame: a wrong subsampling, depth or number of components shows in one of these. */
START_TEST(planes_of_a_frame_have_the_right_number_of_bytes)
{
    static const struct {
        L1L2StabFormat format;
        int bytes[L1L2_MAX_PLANES];
    } cases[] = {
        {L1L2STAB_FORMAT_GRAY8, {32}},          {L1L2STAB_FORMAT_I420, {32, 8, 8}},
        {L1L2STAB_FORMAT_YV12, {32, 8, 8}},     {L1L2STAB_FORMAT_NV12, {32, 16}},
        {L1L2STAB_FORMAT_NV21, {32, 16}},       {L1L2STAB_FORMAT_Y42B, {32, 16, 16}},
        {L1L2STAB_FORMAT_Y444, {32, 32, 32}},   {L1L2STAB_FORMAT_BGRX, {128}},
        {L1L2STAB_FORMAT_BGR, {96}},            {L1L2STAB_FORMAT_A420, {32, 8, 8, 32}},
        {L1L2STAB_FORMAT_AV12, {32, 16, 32}},   {L1L2STAB_FORMAT_NV16, {32, 32}},
        {L1L2STAB_FORMAT_NV24, {32, 64}},       {L1L2STAB_FORMAT_Y41B, {32, 8, 8}},
        {L1L2STAB_FORMAT_GBR, {32, 32, 32}},    {L1L2STAB_FORMAT_GBRA, {32, 32, 32, 32}},
        {L1L2STAB_FORMAT_YUY2, {64}},           {L1L2STAB_FORMAT_GRAY16_LE, {64}},
        {L1L2STAB_FORMAT_I420_10LE, {64, 16, 16}}, {L1L2STAB_FORMAT_I422_12LE, {64, 32, 32}},
        {L1L2STAB_FORMAT_P010_10LE, {64, 32}},  {L1L2STAB_FORMAT_A420_10LE, {64, 16, 16, 64}},
        {L1L2STAB_FORMAT_ARGB64_LE, {256}},     {L1L2STAB_FORMAT_AYUV64, {256}},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        if (format_left_out(cases[k].format))
            continue;
        const L1L2FormatInfo *info = l1l2_image_format_info(cases[k].format);
        for (int i = 0; i < L1L2_MAX_PLANES; i++) {
            const int bytes = i < info->planes ? l1l2_image_plane_size(8, info->plane[i].log2_sub_x) *
                                                     l1l2_image_plane_size(4, info->plane[i].log2_sub_y) *
                                                     info->plane[i].components * l1l2_image_format_bytes(info)
                                               : 0;
            ck_assert_msg(bytes == cases[k].bytes[i], "%s plane %d: %d bytes", info->name, i, bytes);
        }
    }
}
END_TEST

START_TEST(y42b_is_halved_across_and_not_down)
{
    const L1L2FormatInfo *info = l1l2_image_format_info(L1L2STAB_FORMAT_Y42B);
    ck_assert_int_eq(info->plane[1].log2_sub_x, 1);
    ck_assert_int_eq(info->plane[1].log2_sub_y, 0);
}
END_TEST

START_TEST(halved_planes_of_odd_sizes_are_rounded_up)
{
    ck_assert_int_eq(l1l2_image_plane_size(17, 0), 17);
    ck_assert_int_eq(l1l2_image_plane_size(16, 1), 8);
    ck_assert_int_eq(l1l2_image_plane_size(17, 1), 9);
    ck_assert_int_eq(l1l2_image_plane_size(17, 2), 5);
}
END_TEST

static double gray_weight(L1L2StabFormat format, int component)
{
    return l1l2_image_format_info(format)->gray[component];
}

static void check_gray(L1L2StabFormat format, int component, double weight)
{
    if (!format_left_out(format))
        ck_assert_double_eq(gray_weight(format, component), weight);
}

START_TEST(gray_is_made_of_the_right_components)
{
    static const L1L2StabFormat luma_first[] = {L1L2STAB_FORMAT_NV21, L1L2STAB_FORMAT_P010_10LE, L1L2STAB_FORMAT_YUY2};
    static const L1L2StabFormat luma_second[] = {L1L2STAB_FORMAT_UYVY, L1L2STAB_FORMAT_AYUV, L1L2STAB_FORMAT_AYUV64};
    static const L1L2StabFormat blue_first[] = {L1L2STAB_FORMAT_BGRX, L1L2STAB_FORMAT_BGRA, L1L2STAB_FORMAT_BGR};
    static const L1L2StabFormat red_first[] = {L1L2STAB_FORMAT_RGBX, L1L2STAB_FORMAT_RGBA, L1L2STAB_FORMAT_RGB};
    static const L1L2StabFormat x_then_red[] = {L1L2STAB_FORMAT_XRGB, L1L2STAB_FORMAT_ARGB, L1L2STAB_FORMAT_ARGB64_LE};
    for (int i = 0; i < 3; i++) {
        check_gray(luma_first[i], 0, 1.0);
        check_gray(luma_second[i], 1, 1.0);
        check_gray(x_then_red[i], 1, 0.299);
        check_gray(blue_first[i], 0, 0.114);
        check_gray(red_first[i], 0, 0.299);
    }
}
END_TEST

START_TEST(gray_of_white_is_white)
{
    for (int id = FIRST; id < end_of_formats(); id++) {
        double sum = 0.0;
        for (int i = 0; i < l1l2_image_format_pixel_components(l1l2_image_format_info((L1L2StabFormat)id)); i++)
            sum += gray_weight((L1L2StabFormat)id, i);
        ck_assert_near(sum, 1.0, 1e-12);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("format");
    TCase *tc = tcase_create("format");
    tcase_add_test(tc, every_format_of_the_public_header_is_described);
    tcase_add_test(tc, an_unsupported_format_has_no_description);
    tcase_add_test(tc, no_name_is_used_twice);
    tcase_add_test(tc, planes_of_a_frame_have_the_right_number_of_bytes);
    tcase_add_test(tc, y42b_is_halved_across_and_not_down);
    tcase_add_test(tc, halved_planes_of_odd_sizes_are_rounded_up);
    tcase_add_test(tc, gray_is_made_of_the_right_components);
    tcase_add_test(tc, gray_of_white_is_white);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
