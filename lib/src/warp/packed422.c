/* SPDX-License-Identifier: MIT */
/* Splits and merges rows, one pair of functions for each of the four layouts. */
#include "warp/packed422.h"

#include "common/mem.h"

enum { BAND_ROWS = 16 };

/* Defines split_*() and merge_*() for one row. The components' places in a pair are constants, so that the compiler
 * vectorizes the loops. */
#define DEFINE_LAYOUT(name, Y, U, V)                                                                                  \
    static void split_##name(const uint8_t *row, int width, uint8_t *restrict y, uint8_t *restrict u,                 \
                             uint8_t *restrict v)                                                                     \
    {                                                                                                                 \
        for (int i = 0; i < width; i++)                                                                               \
            y[i] = row[2 * i + (Y)];                                                                                  \
        for (int i = 0; i < (width + 1) / 2; i++) {                                                                   \
            u[i] = row[4 * i + (U)];                                                                                  \
            v[i] = row[4 * i + (V)];                                                                                  \
        }                                                                                                             \
    }                                                                                                                 \
    static void merge_##name(uint8_t *restrict row, int width, const uint8_t *y, const uint8_t *u, const uint8_t *v)  \
    {                                                                                                                 \
        for (int i = 0; i < (width + 1) / 2; i++) {                                                                   \
            row[4 * i + (Y)] = y[2 * i];                                                                              \
            row[4 * i + (Y) + 2] = y[2 * i + 1];                                                                      \
            row[4 * i + (U)] = u[i];                                                                                  \
            row[4 * i + (V)] = v[i];                                                                                  \
        }                                                                                                             \
    }

DEFINE_LAYOUT(yuyv, 0, 1, 3)
DEFINE_LAYOUT(uyvy, 1, 0, 2)
DEFINE_LAYOUT(yvyu, 0, 3, 1)
DEFINE_LAYOUT(vyuy, 1, 2, 0)

static const struct Layout {
    L1L2StabFormat format;
    void (*split)(const uint8_t *row, int width, uint8_t *y, uint8_t *u, uint8_t *v);
    void (*merge)(uint8_t *row, int width, const uint8_t *y, const uint8_t *u, const uint8_t *v);
} layouts[] = {
    {L1L2STAB_FORMAT_YUY2, split_yuyv, merge_yuyv},
    {L1L2STAB_FORMAT_UYVY, split_uyvy, merge_uyvy},
    {L1L2STAB_FORMAT_YVYU, split_yvyu, merge_yvyu},
    {L1L2STAB_FORMAT_VYUY, split_vyuy, merge_vyuy},
};

static const struct Layout *find_layout(const L1L2FormatInfo *format)
{
    for (size_t i = 0; i < sizeof layouts / sizeof layouts[0]; i++)
        if (layouts[i].format == format->format)
            return &layouts[i];
    return NULL;
}

bool l1l2_warp_packed422_is(const L1L2FormatInfo *format)
{
    return find_layout(format) != NULL;
}

bool l1l2_warp_packed422_new(L1L2WarpPlanes *planes, int width, int height)
{
    const size_t pairs = (size_t)(width + 1) / 2, rows = (size_t)height;
    *planes = (L1L2WarpPlanes){.width = width, .height = height};
    for (int i = 0; i < 3; i++) {
        planes->stride[i] = (ptrdiff_t)(i == 0 ? 2 * pairs : pairs);
        planes->data[i] = l1l2_mem_new(rows, (size_t)planes->stride[i]);
        if (!planes->data[i]) {
            l1l2_warp_packed422_free(planes);
            return false;
        }
    }
    return true;
}

void l1l2_warp_packed422_free(L1L2WarpPlanes *planes)
{
    for (int i = 0; i < 3; i++)
        l1l2_mem_free(planes->data[i]);
    *planes = (L1L2WarpPlanes){.width = 0};
}

typedef struct Job {
    const struct Layout *layout;
    const L1L2WarpPlanes *planes;
    const uint8_t *from; /* the packed frame to split, or NULL */
    uint8_t *to;         /* the one to merge into, or NULL */
    ptrdiff_t stride;
} Job;

static void do_band(void *context, int index)
{
    const Job *job = context;
    const L1L2WarpPlanes *planes = job->planes;
    for (int r = index * BAND_ROWS; r < (index + 1) * BAND_ROWS && r < planes->height; r++) {
        uint8_t *y = planes->data[0] + r * planes->stride[0];
        uint8_t *u = planes->data[1] + r * planes->stride[1], *v = planes->data[2] + r * planes->stride[2];
        if (job->from)
            job->layout->split(job->from + r * job->stride, planes->width, y, u, v);
        else
            job->layout->merge(job->to + r * job->stride, planes->width, y, u, v);
    }
}

void l1l2_warp_packed422_split(L1L2Pool *pool, const L1L2FormatInfo *packed, const uint8_t *data, ptrdiff_t stride,
                               const L1L2WarpPlanes *planes)
{
    Job job = {find_layout(packed), planes, data, NULL, stride};
    l1l2_pool_run(pool, (planes->height + BAND_ROWS - 1) / BAND_ROWS, do_band, &job);
}

void l1l2_warp_packed422_merge(L1L2Pool *pool, const L1L2FormatInfo *packed, const L1L2WarpPlanes *planes,
                               uint8_t *data, ptrdiff_t stride)
{
    Job job = {find_layout(packed), planes, NULL, data, stride};
    l1l2_pool_run(pool, (planes->height + BAND_ROWS - 1) / BAND_ROWS, do_band, &job);
}
