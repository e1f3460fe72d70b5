/* SPDX-License-Identifier: MIT */
/* The area scaler against means in floating point and exact integers, and SIMD against plain C. */
#include <math.h>
#include <string.h>

#include "checkx.h"
#include "common/cpu.h"
#include "common/rng.h"
#include "formats.h"
#include "image/area_scale.h"
#include "image/area_scale_row.h"

enum { PAD = 24, GUARD = 0xA5 };

/* A plane of noise with PAD bytes between its rows, and the scaler's output with guard bytes on its right. */
typedef struct Trial {
    const L1L2FormatInfo *format;
    int width, height, out_width, out_height;
    uint8_t *data, *out;
    ptrdiff_t stride, out_stride;
} Trial;

static Trial trial_new(L1L2StabFormat format, int width, int height, int out_width, int out_height)
{
    Trial t = {l1l2_image_format_info(format), width, height, out_width, out_height, NULL, NULL, 0, out_width + 3};
    t.stride =
        (ptrdiff_t)width * l1l2_image_format_pixel_components(t.format) * l1l2_image_format_bytes(t.format) + PAD;
    t.data = malloc((size_t)t.stride * (size_t)height);
    t.out = malloc((size_t)t.out_stride * (size_t)out_height);
    ck_assert(t.data && t.out);
    L1L2Rng rng = l1l2_rng_seeded((uint64_t)(width * height));
    const uint32_t highest = (1u << t.format->depth) - 1;
    for (ptrdiff_t i = 0; i < t.stride * height / l1l2_image_format_bytes(t.format); i++) {
        /* a third of the levels is dark, a third bright, and a third anything */
        const uint32_t any = l1l2_rng_below(&rng, highest + 1), kind = l1l2_rng_below(&rng, 3);
        const uint32_t level = (kind == 0 ? any & 3 : kind == 1 ? highest - (any & 3) : any) << t.format->shift;
        if (l1l2_image_format_bytes(t.format) == 1)
            t.data[i] = (uint8_t)level;
        else
            ((uint16_t *)(void *)t.data)[i] = (uint16_t)level;
    }
    memset(t.out, GUARD, (size_t)t.out_stride * (size_t)out_height);
    return t;
}

static void run(Trial *t)
{
    L1L2AreaScaler *s = l1l2_image_scale_new(t->format, t->width, t->height, t->out_width, t->out_height);
    ck_assert_ptr_nonnull(s);
    l1l2_image_scale_run(s, t->data, t->stride, t->out, t->out_stride);
    l1l2_image_scale_free(s);
}

static void trial_free(Trial *t)
{
    free(t->data);
    free(t->out);
}

static uint32_t sample(const Trial *t, int x, int y, int component)
{
    const uint8_t *row = t->data + t->stride * y;
    const int i = x * l1l2_image_format_pixel_components(t->format) + component;
    return l1l2_image_format_bytes(t->format) == 1 ? row[i] : ((const uint16_t *)(const void *)row)[i];
}

/* A pixel's gray level, in units of 8 bits. */
static double gray(const Trial *t, int x, int y)
{
    double sum = 0.0;
    for (int c = 0; c < l1l2_image_format_pixel_components(t->format); c++)
        sum += (l1l2_image_format_pixel_components(t->format) == 1 ? 1.0 : t->format->gray[c]) * sample(t, x, y, c);
    return ldexp(sum, 8 - t->format->depth - t->format->shift);
}

/* How much of [j, j + 1) lies in [low, high). */
static double overlap(double low, double high, int j)
{
    return fmax(fmin(high, j + 1.0) - fmax(low, j), 0.0);
}

static double mean(const Trial *t, int x, int y)
{
    const double wide = (double)t->width / t->out_width, high = (double)t->height / t->out_height;
    double sum = 0.0;
    for (int j = (int)(y * high); j < t->height && j < (y + 1) * high; j++)
        for (int i = (int)(x * wide); i < t->width && i < (x + 1) * wide; i++)
            sum += overlap(y * high, (y + 1) * high, j) * overlap(x * wide, (x + 1) * wide, i) * gray(t, i, j);
    return sum / (wide * high);
}

/* The largest distance of an output from the mean in floating point; a mean above 255 counts as 255. */
static double worst(const Trial *t)
{
    double most = 0.0;
    for (int y = 0; y < t->out_height; y++) {
        for (int x = 0; x < t->out_width; x++)
            most = fmax(most, fabs(t->out[t->out_stride * y + x] - fmin(mean(t, x, y), 255.0)));
        for (int x = t->out_width; x < t->out_stride; x++)
            ck_assert_uint_eq(t->out[t->out_stride * y + x], GUARD);
    }
    return most;
}

static const int sizes[][4] = {{854, 32, 640, 24},  {1280, 24, 640, 12}, {1920, 24, 640, 8},   {3840, 24, 640, 4},
                               {721, 1283, 35, 64}, {33, 17, 33, 17},    {33, 17, 32, 17},     {33, 17, 33, 16},
                               {720, 27, 640, 24},  {64, 36, 32, 18},    {640, 181, 32, 9},   {5, 3, 1, 1},
                               {4099, 20, 639, 3},  {257, 2049, 3, 2},   {1366, 40, 640, 19},  {2, 2, 1, 2}};
enum { SIZES = sizeof sizes / sizeof *sizes };

static double worst_of(L1L2StabFormat format, const int *size)
{
    Trial t = trial_new(format, size[0], size[1], size[2], size[3]);
    run(&t);
    const double most = worst(&t);
    trial_free(&t);
    return most;
}

START_TEST(one_component_is_the_mean_of_its_area_rounded_once)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420, L1L2STAB_FORMAT_I420_10LE,
                                             L1L2STAB_FORMAT_I420_12LE, L1L2STAB_FORMAT_P010_10LE,
                                             L1L2STAB_FORMAT_GRAY16_LE};
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++)
        if (!format_left_out(formats[k]))
            ck_assert_double_le(worst_of(formats[k], sizes[_i]), 0.5 + 1.0 / 128);
}
END_TEST

START_TEST(packed_components_are_mixed_as_well)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_BGR,  L1L2STAB_FORMAT_RGBA,      L1L2STAB_FORMAT_XRGB,
                                             L1L2STAB_FORMAT_YUY2, L1L2STAB_FORMAT_UYVY,      L1L2STAB_FORMAT_VUYA,
                                             L1L2STAB_FORMAT_AYUV, L1L2STAB_FORMAT_RGBA64_LE, L1L2STAB_FORMAT_AYUV64};
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++)
        if (!format_left_out(formats[k]))
            ck_assert_double_le(worst_of(formats[k], sizes[_i]), 0.5 + 1.0 / 32);
}
END_TEST

/* Stretched, all levels of the source from low to high lie within the range, so nothing is cut off. */
START_TEST(a_stretched_picture_is_the_mean_of_its_area)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_GRAY16_LE, L1L2STAB_FORMAT_I420_12LE,
                                             L1L2STAB_FORMAT_P010_10LE, L1L2STAB_FORMAT_RGBA64_LE};
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++) {
        if (format_left_out(formats[k]))
            continue;
        Trial t = trial_new(formats[k], sizes[_i][0], sizes[_i][1], sizes[_i][2], sizes[_i][3]);
        const int depth = t.format->depth, shift = t.format->shift, span = 1 << (depth - 5);
        const int low = 3 << (depth - 3), count = (int)(t.stride * t.height / 2);
        uint16_t *sample = (uint16_t *)(void *)t.data;
        for (int i = 0; i < count; i++)
            sample[i] = (uint16_t)((low + (sample[i] >> shift) % span) << shift);
        const L1L2Levels levels = {low << shift, (low + span) << shift};
        L1L2AreaScaler *s = l1l2_image_scale_new(t.format, t.width, t.height, t.out_width, t.out_height);
        ck_assert_ptr_nonnull(s);
        l1l2_image_scale_set_levels(s, levels);
        l1l2_image_scale_run(s, t.data, t.stride, t.out, t.out_stride);
        /* Mixed colors keep the precision of the full range: 15 bits for a column. */
        const double bound = 0.5 + (l1l2_image_format_pixel_components(t.format) == 1 ? 1.0 / 128 : 1.0);
        const double from = levels.low * ldexp(1.0, 8 - depth - shift);
        for (int y = 0; y < t.out_height; y++)
            for (int x = 0; x < t.out_width; x++) {
                const double expected = fmin((mean(&t, x, y) - from) * 32.0, 255.0);
                ck_assert_double_le(fabs(t.out[t.out_stride * y + x] - expected), bound);
            }
        l1l2_image_scale_free(s);
        trial_free(&t);
    }
}
END_TEST

/* The expected mean is computed in integers alone: sums of parts, halves rounded up. */
START_TEST(factors_of_few_parts_are_exact)
{
    static const int factors[][2] = {{2, 1}, {3, 1}, {4, 1}, {5, 1}, {6, 1}, {8, 1}, {12, 1}, {4, 3}, {9, 8}, {5, 2}};
    for (size_t k = 0; k < sizeof factors / sizeof *factors; k++) {
        const int total = factors[k][0], unit = factors[k][1];
        Trial t = trial_new(L1L2STAB_FORMAT_GRAY8, 10 * total, 6 * total, 10 * unit, 6 * unit);
        run(&t);
        for (int y = 0; y < t.out_height; y++)
            for (int x = 0; x < t.out_width; x++) {
                uint32_t sum = 0;
                for (int j = y * total; j < (y + 1) * total; j++)
                    for (int i = x * total; i < (x + 1) * total; i++)
                        sum += sample(&t, i / unit, j / unit, 0);
                const uint32_t area = (uint32_t)(total * total);
                ck_assert_uint_eq(t.out[t.out_stride * y + x], (2 * sum + area) / (2 * area));
            }
        trial_free(&t);
    }
}
END_TEST

START_TEST(flat_stays_flat)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_GRAY8, L1L2STAB_FORMAT_BGR, L1L2STAB_FORMAT_YUY2,
                                             L1L2STAB_FORMAT_GRAY16_LE, L1L2STAB_FORMAT_RGBA64_LE};
    static const uint8_t levels[] = {0, 1, 127, 254, 255};
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++) {
        if (format_left_out(formats[k]))
            continue;
        Trial t = trial_new(formats[k], sizes[_i][0], sizes[_i][1], sizes[_i][2], sizes[_i][3]);
        for (size_t l = 0; l < sizeof levels; l++) {
            memset(t.data, 0, (size_t)t.stride * (size_t)t.height);
            const int bytes = l1l2_image_format_bytes(t.format);
            for (ptrdiff_t i = bytes - 1; i < t.stride * t.height; i += bytes) /* the high byte comes last */
                t.data[i] = levels[l];
            run(&t);
            for (int y = 0; y < t.out_height; y++)
                for (int x = 0; x < t.out_width; x++)
                    ck_assert_uint_eq(t.out[t.out_stride * y + x], levels[l]);
        }
        trial_free(&t);
    }
}
END_TEST

START_TEST(bytes_and_the_same_levels_in_ten_bits_give_the_same_picture)
{
    static const L1L2StabFormat deep[] = {L1L2STAB_FORMAT_I420_10LE, L1L2STAB_FORMAT_P010_10LE};
    for (int k = 0; k < 2 && !format_left_out(deep[k]); k++) {
        Trial t = trial_new(L1L2STAB_FORMAT_GRAY8, 1920, 108, 640, 36), d = trial_new(deep[k], 1920, 108, 640, 36);
        for (int y = 0; y < t.height; y++)
            for (int x = 0; x < t.width; x++)
                ((uint16_t *)(void *)(d.data + d.stride * y))[x] =
                    (uint16_t)(sample(&t, x, y, 0) << (2 + d.format->shift));
        run(&t);
        run(&d);
        ck_assert_mem_eq(t.out, d.out, (size_t)t.out_stride * (size_t)t.out_height);
        trial_free(&t);
        trial_free(&d);
    }
}
END_TEST

START_TEST(samples_above_their_depth_saturate)
{
    if (format_left_out(L1L2STAB_FORMAT_I420_10LE))
        return;
    Trial t = trial_new(L1L2STAB_FORMAT_I420_10LE, 1921, 109, 640, 36);
    memset(t.data, 0xFF, (size_t)t.stride * (size_t)t.height);
    run(&t);
    for (int x = 0; x < t.out_width; x++)
        ck_assert_uint_eq(t.out[x], 255);
    trial_free(&t);
}
END_TEST

START_TEST(rows_may_run_bottom_up)
{
    Trial down = trial_new(L1L2STAB_FORMAT_GRAY8, 855, 481, 640, 360), up = down;
    up.data = malloc((size_t)down.stride * (size_t)down.height);
    up.out = malloc((size_t)down.out_stride * (size_t)down.out_height);
    ck_assert(up.data && up.out);
    memset(up.out, GUARD, (size_t)down.out_stride * (size_t)down.out_height);
    for (int y = 0; y < down.height; y++)
        memcpy(up.data + down.stride * (down.height - 1 - y), down.data + down.stride * y, (size_t)down.stride);
    run(&down);
    uint8_t *const first = up.data;
    up.data += down.stride * (down.height - 1);
    up.stride = -down.stride;
    run(&up);
    ck_assert_mem_eq(down.out, up.out, (size_t)down.out_stride * (size_t)down.out_height);
    up.data = first;
    trial_free(&up);
    trial_free(&down);
}
END_TEST

/* Planes of two bytes a component at odd addresses, in rows an odd number of bytes apart. The sanitizer sees a
 * misaligned load, which other processors could not do. */
START_TEST(deep_pictures_may_have_any_alignment)
{
    static const L1L2StabFormat formats[] = {L1L2STAB_FORMAT_I420_10LE, L1L2STAB_FORMAT_P010_10LE,
                                             L1L2STAB_FORMAT_GRAY16_LE, L1L2STAB_FORMAT_RGBA64_LE};
    for (size_t k = 0; k < sizeof formats / sizeof *formats; k++) {
        if (format_left_out(formats[k]))
            continue;
        Trial even = trial_new(formats[k], 101, 57, 40, 23), odd = even;
        uint8_t *const memory = malloc((size_t)(even.stride + 1) * (size_t)even.height + 1);
        odd.out = malloc((size_t)even.out_stride * (size_t)even.out_height);
        ck_assert(memory && odd.out);
        memset(odd.out, GUARD, (size_t)even.out_stride * (size_t)even.out_height);
        odd.data = memory + ((uintptr_t)memory % 2 == 0);
        odd.stride = even.stride + 1;
        for (int y = 0; y < even.height; y++)
            memcpy(odd.data + odd.stride * y, even.data + even.stride * y, (size_t)(even.stride - PAD));
        run(&even);
        run(&odd);
        ck_assert_mem_eq(even.out, odd.out, (size_t)even.out_stride * (size_t)even.out_height);
        odd.data = memory;
        trial_free(&odd);
        trial_free(&even);
    }
}
END_TEST

/* The extremes: samples of 15 bits, weights of up to 16 bits in sum. */
START_TEST(every_processor_gives_the_sums_of_plain_c)
{
    enum { SAMPLES = 200, TAPS = 28, COUNT = 40 };
    int16_t samples[SAMPLES + TAPS], weight[COUNT * TAPS];
    int32_t first[COUNT], plain_sums[COUNT], sums[COUNT];
    L1L2AreaScaleFunctions plain, functions;
    l1l2_image_scale_functions_init(&plain, L1L2_CPU_PLAIN);
    l1l2_image_scale_functions_init(&functions, l1l2_cpu_features());
    L1L2Rng rng = l1l2_rng_seeded(7);
    for (int i = 0; i < SAMPLES + TAPS; i++)
        samples[i] = (int16_t)(i % 3 == 0 ? INT16_MAX : (int)l1l2_rng_below(&rng, INT16_MAX + 1));
    for (int taps = 4; taps <= TAPS; taps += 4)
        for (int count = 4; count <= COUNT; count += 4) {
            for (int i = 0; i < count * taps; i++)
                weight[i] = (int16_t)l1l2_rng_below(&rng, UINT16_MAX / (uint32_t)taps);
            for (int i = 0; i < count; i++)
                first[i] = (int32_t)l1l2_rng_below(&rng, SAMPLES);
            plain.row(samples, first, weight, taps, count, plain_sums);
            functions.row(samples, first, weight, taps, count, sums);
            ck_assert_mem_eq(sums, plain_sums, (size_t)count * sizeof *sums);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("area scaler");
    TCase *tc = tcase_create("area scaler");
    tcase_set_timeout(tc, 60);
    tcase_add_loop_test(tc, one_component_is_the_mean_of_its_area_rounded_once, 0, SIZES);
    tcase_add_loop_test(tc, packed_components_are_mixed_as_well, 0, SIZES);
    tcase_add_loop_test(tc, a_stretched_picture_is_the_mean_of_its_area, 0, SIZES);
    tcase_add_test(tc, factors_of_few_parts_are_exact);
    tcase_add_loop_test(tc, flat_stays_flat, 0, SIZES);
    tcase_add_test(tc, bytes_and_the_same_levels_in_ten_bits_give_the_same_picture);
    tcase_add_test(tc, samples_above_their_depth_saturate);
    tcase_add_test(tc, rows_may_run_bottom_up);
    tcase_add_test(tc, deep_pictures_may_have_any_alignment);
    tcase_add_test(tc, every_processor_gives_the_sums_of_plain_c);
    suite_add_tcase(suite, tc);
    return checkx_run(suite);
}
