/* SPDX-License-Identifier: MIT */
/*
 * Implements vision.h with OpenCV. This is the only C++ file of the library and the only one that includes OpenCV.
 *
 * No exception leaves this file. None of OpenCV's process-wide state (threads, parallel regions, random numbers) is
 * touched: cv::parallel_for_() marks the whole process as being inside a parallel region, so that parallel loops of the
 * application would run serially meanwhile. Only OpenCV functions that never call cv::parallel_for_() are used here;
 * tests/lib/motion/opencv_host.cpp checks that. What would call it (the pyramid, the choice of corners) is our own
 * code.
 */
#include "motion/vision.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/log.h"
#include "common/cpu.h"
#include "image/area_scale.h"
#include "image/level_range.h"
#include "motion/pyramid.h"

namespace {

/* Cells in which no corner was selected are searched again by themselves, relative to their own strongest corner: else
 * a burnt-in clock would leave a dark scene without corners. */
constexpr int kCellsX = 4, kCellsY = 3;
/* Changes of contrast by less than 8 % (a log ratio) are left to the tracker. Half and twice of it change no clip. */
constexpr double kSameContrast = 0.08;
/* A long strip keeps this many pixels of its short side, if it has them, because tracking windows have to fit in. */
constexpr int kMinSide = 32;

using Scaler = std::unique_ptr<L1L2AreaScaler, decltype(&l1l2_image_scale_free)>;
using Pyramid = std::unique_ptr<L1L2Pyramid, decltype(&l1l2_motion_pyramid_free)>;

} // namespace

struct L1L2Vision {
    L1L2VisionConfig cfg;
    cv::Size size;
    L1L2LkFunctions lucas_kanade{};
    Scaler to_gray{nullptr, l1l2_image_scale_free}, to_thumbnail{nullptr, l1l2_image_scale_free};
    Pyramid pyramid{nullptr, l1l2_motion_pyramid_free}, previous_pyramid{nullptr, l1l2_motion_pyramid_free};
    L1L2LevelRange range{};                  /* of levels that the frames use */
    L1L2Levels levels{};                     /* to which the current picture is stretched */
    bool stretched = false;                  /* it was logged */
    int pictures = 0;                        /* taken since reset, at most 2 matter */
    cv::Rect active;                         /* the picture without its bars, of the downscaled size */
    cv::Mat mask;                            /* of corners: 0 where none is wanted */
};

namespace {

template <class Body>
L1L2StabResult guard(const L1L2StabLogger *log, Body &&body) noexcept
{
    try {
        body();
        return L1L2STAB_OK;
    } catch (const std::bad_alloc &) {
        return L1L2STAB_ERR_NOMEM;
    } catch (const cv::Exception &e) {
        if (e.code == cv::Error::StsNoMem)
            return L1L2STAB_ERR_NOMEM;
        l1l2_log(log, L1L2STAB_LOG_ERROR, "OpenCV: %s", e.what());
    } catch (const std::exception &e) {
        l1l2_log(log, L1L2STAB_LOG_ERROR, "OpenCV: %s", e.what());
    } catch (...) {
        l1l2_log(log, L1L2STAB_LOG_ERROR, "OpenCV: unknown exception");
    }
    return L1L2STAB_ERR_BACKEND;
}

int scaled_side(const L1L2VisionConfig &cfg, int side)
{
    const double scale = std::min(1.0, double(cfg.analysis_size) / std::max(cfg.width, cfg.height));
    return std::max(cvRound(side * scale), std::min(side, kMinSide));
}

Scaler scaler(const L1L2FormatInfo *format, cv::Size from, cv::Size to)
{
    Scaler made(l1l2_image_scale_new(format, from.width, from.height, to.width, to.height), l1l2_image_scale_free);
    if (!made)
        throw std::bad_alloc();
    return made;
}

/* A level of a pyramid without its border. The memory is the pyramid's. */
cv::Mat picture_of(const Pyramid &pyramid, int level)
{
    const L1L2LkLevel &l = pyramid->level[level];
    return {l.height, l.width, CV_8U, pyramid->grey[level], size_t(l.stride)};
}

Pyramid pyramid(cv::Size size)
{
    Pyramid made(l1l2_motion_pyramid_new(size.width, size.height), l1l2_motion_pyramid_free);
    if (!made)
        throw std::bad_alloc();
    return made;
}

bool inside(const L1L2Vision *v, cv::Point2f p)
{
    return p.x >= v->active.x && p.y >= v->active.y && p.x <= v->active.x + v->active.width - 1 &&
           p.y <= v->active.y + v->active.height - 1;
}

/* A deep picture is stretched to the levels that the frames use, so that raw counts that span a small part of their
 * range can be tracked. Two pictures are compared at one stretch: if it changes, the previous picture is converted. */
void stretch_levels(L1L2Vision *v, const uint8_t *data, ptrdiff_t stride)
{
    const L1L2FormatInfo *format = v->cfg.format;
    const L1L2Levels old = v->levels;
    v->levels = l1l2_image_levels_push(&v->range, format, data, stride, v->cfg.width, v->cfg.height);
    if (l1l2_image_levels_equal(old, v->levels))
        return;
    l1l2_image_scale_set_levels(v->to_gray.get(), v->levels);
    if (!v->stretched && !l1l2_image_levels_equal(v->levels, l1l2_image_levels_full(format))) {
        v->stretched = true;
        l1l2_log(v->cfg.log, L1L2STAB_LOG_INFO,
                 "motion: the frames use few of their levels; the tracked picture is stretched to %d to %d of %d",
                 v->levels.low, v->levels.high, l1l2_image_levels_full(format).high);
    }
    if (v->pictures == 0)
        return;
    const double unit = v->levels.high - v->levels.low, gain = (old.high - old.low) / unit;
    cv::Mat base = picture_of(v->previous_pyramid, 0);
    base.convertTo(base, CV_8U, gain, 256.0 * (old.low - v->levels.low) / unit);
    l1l2_motion_pyramid_build(v->previous_pyramid.get());
}

/* Lucas-Kanade assumes that a point keeps its brightness. If a flash, a lamp or the camera's exposure changed the whole
 * picture, the previous one is given the current one's mean and contrast, unless that does not make them more alike. */
void match_brightness(L1L2Vision *v)
{
    const L1L2MotionParameters *p = v->cfg.parameters;
    const int level = std::min(2, v->pyramid->levels - 1);
    const cv::Mat before = picture_of(v->previous_pyramid, level), now = picture_of(v->pyramid, level);
    cv::Scalar mean[2], deviation[2];
    cv::meanStdDev(before, mean[0], deviation[0]);
    cv::meanStdDev(now, mean[1], deviation[1]);
    if (deviation[0][0] < p->flat_picture || deviation[1][0] < p->flat_picture)
        return;
    const double gain = deviation[1][0] / deviation[0][0], offset = mean[1][0] - gain * mean[0][0];
    if (std::abs(std::log(gain)) < kSameContrast && std::abs(mean[1][0] - mean[0][0]) < p->same_mean)
        return;
    cv::Mat matched;
    before.convertTo(matched, CV_8U, gain, offset);
    if (cv::norm(now, matched, cv::NORM_L1) > p->brightness_gain * cv::norm(now, before, cv::NORM_L1))
        return;
    cv::Mat base = picture_of(v->previous_pyramid, 0);
    base.convertTo(base, CV_8U, gain, offset);
    l1l2_motion_pyramid_build(v->previous_pyramid.get());
}

bool is_dark_and_flat(const L1L2MotionParameters *parameters, const cv::Mat &line)
{
    int low = 255, high = 0;
    for (int i = 0; i < int(line.total()); i++) {
        const int level = line.at<uchar>(i);
        low = std::min(low, level);
        high = std::max(high, level);
    }
    return high <= parameters->bar_level && high - low <= parameters->bar_range;
}

/* The thickness of the bar at one edge: rows from the top or bottom, or columns from the left or right, that are dark
 * and flat; at most 45 % of the picture. */
int bar_thickness(const L1L2MotionParameters *parameters, const cv::Mat &picture, bool columns, bool from_end)
{
    const int lines = columns ? picture.cols : picture.rows, most = lines * 45 / 100;
    int bar = 0;
    while (bar < most) {
        const int i = from_end ? lines - 1 - bar : bar;
        if (!is_dark_and_flat(parameters, columns ? picture.col(i) : picture.row(i)))
            break;
        bar++;
    }
    return bar;
}

/* The picture within letterbox or pillarbox bars. At the edge of a bar, a corner between bar and scene moves with
 * neither, so a margin of half a window is left out there. */
cv::Rect active_area(const L1L2MotionParameters *parameters, const cv::Mat &picture)
{
    int bar[4]; /* top, bottom, left, right */
    for (int side = 0; side < 4; side++) {
        bar[side] = bar_thickness(parameters, picture, side >= 2, side % 2 == 1);
        if (bar[side] > 0)
            bar[side] += L1L2_LK_WINDOW / 2 + 1;
    }
    const cv::Rect inner(bar[2], bar[0], picture.cols - bar[2] - bar[3], picture.rows - bar[0] - bar[1]);
    return inner.width > 0 && inner.height > 0 ? inner : cv::Rect(cv::Point(), picture.size());
}

void block(cv::Mat &area, const L1L2Mask *mask)
{
    if (!mask || !mask->blocked)
        return;
    for (int y = 0; y < area.rows; y++) {
        const uint8_t *blocked = mask->blocked + ptrdiff_t(y * mask->height / area.rows) * mask->width;
        uchar *row = area.ptr<uchar>(y);
        for (int x = 0; x < area.cols; x++)
            if (blocked[x * mask->width / area.cols])
                row[x] = 0;
    }
}

/* An area of a picture that is `factor` times smaller; what reaches that picture's far edge reaches this one's. */
cv::Rect scaled(cv::Rect area, int factor, cv::Size small, cv::Size size)
{
    const int right = area.br().x == small.width ? size.width : area.br().x * factor;
    const int bottom = area.br().y == small.height ? size.height : area.br().y * factor;
    return {area.x * factor, area.y * factor, right - area.x * factor, bottom - area.y * factor};
}

/* Cell by cell from left to right, row by row. */
cv::Rect cell_area(cv::Size size, int cell)
{
    const int x = cell % kCellsX, y = cell / kCellsX;
    const int left = size.width * x / kCellsX, top = size.height * y / kCellsY;
    return {left, top, size.width * (x + 1) / kCellsX - left, size.height * (y + 1) / kCellsY - top};
}

int cell_of(const L1L2Vision *v, L1L2Pixel p)
{
    const int x = int(p.x) * kCellsX / v->size.width, y = int(p.y) * kCellsY / v->size.height;
    return std::clamp(y, 0, kCellsY - 1) * kCellsX + std::clamp(x, 0, kCellsX - 1);
}

/* Pixels of a corner map that are above `least`, no smaller than their eight neighbors, and wanted by the mask; the
 * strongest first. Equal ones are taken from the last row and column on, so that the order is always the same. */
std::vector<cv::Point> local_maxima(const cv::Mat &strength, float least, const cv::Mat &mask)
{
    std::vector<cv::Point> found;
    const auto kept = [least](float value) { return value > least ? value : 0.0f; };
    for (int y = 1; y < strength.rows - 1; y++) {
        const float *above = strength.ptr<float>(y - 1), *here = strength.ptr<float>(y);
        const float *below = strength.ptr<float>(y + 1);
        const uchar *wanted = mask.ptr<uchar>(y);
        for (int x = 1; x < strength.cols - 1; x++) {
            const float value = here[x];
            if (!(value > least) || value == 0.0f || !wanted[x])
                continue;
            bool largest = true;
            for (int i = x - 1; i <= x + 1 && largest; i++)
                largest = value >= kept(above[i]) && value >= kept(here[i]) && value >= kept(below[i]);
            if (largest)
                found.emplace_back(x, y);
        }
    }
    std::sort(found.begin(), found.end(), [&strength](cv::Point a, cv::Point b) {
        const float u = strength.at<float>(a), v = strength.at<float>(b);
        return u != v ? u > v : a.y != b.y ? a.y > b.y : a.x > b.x;
    });
    return found;
}

/* Takes `maxima` in their order, leaving out what is nearer than `distance` to one already taken, up to `quota`. The
 * points taken are kept in square cells of that size, so that only nine cells are searched for a neighbor. */
std::vector<cv::Point> spread_out(const std::vector<cv::Point> &maxima, cv::Size size, double distance, int quota)
{
    std::vector<cv::Point> taken;
    const int side = std::max(1, cvRound(distance));
    const cv::Size cells((size.width + side - 1) / side, (size.height + side - 1) / side);
    std::vector<std::vector<cv::Point>> cell(size_t(cells.area()));
    for (const cv::Point p : maxima) {
        const cv::Rect around = cv::Rect(p.x / side - 1, p.y / side - 1, 3, 3) & cv::Rect(cv::Point(), cells);
        bool near = false;
        for (int y = around.y; y < around.br().y && !near; y++)
            for (int x = around.x; x < around.br().x && !near; x++)
                for (const cv::Point q : cell[size_t(y * cells.width + x)])
                    near = near || (p - q).dot(p - q) < distance * distance;
        if (near)
            continue;
        cell[size_t(p.y / side * cells.width + p.x / side)].push_back(p);
        taken.push_back(p);
        if (int(taken.size()) == quota)
            break;
    }
    return taken;
}

/* Shi & Tomasi's corners of one area: the smaller eigenvalue of the structure tensor over 3x3 pixels, its local maxima
 * down to a part `quality` of the strongest. The result is that of cv::goodFeaturesToTrack(), which calls
 * cv::parallel_for_(). */
std::vector<cv::Point> corners_of(const cv::Mat &picture, const cv::Mat &mask, double quality, int quota,
                                  double distance)
{
    cv::Mat strength;
    double strongest = 0.0;
    cv::cornerMinEigenVal(picture, strength, 3, 3);
    cv::minMaxLoc(strength, nullptr, &strongest, nullptr, nullptr, mask);
    return spread_out(local_maxima(strength, float(strongest * quality), mask), picture.size(), distance, quota);
}

/* Up to `quota` corners of an area, in pixels of the downscaled picture; those found are masked for the areas to come.
 * Returns how many. */
int corners_in(L1L2Vision *v, const cv::Mat &picture, cv::Rect area, int quota, double distance, float scale,
               L1L2Pixel *corners)
{
    int found = 0;
    const double quality = v->cfg.parameters->corner_quality;
    for (const cv::Point corner : corners_of(picture(area), v->mask(area), quality, quota, distance)) {
        const cv::Point p = corner + area.tl();
        cv::circle(v->mask, p, cvCeil(distance), cv::Scalar(0), cv::FILLED);
        corners[found++] = {float(p.x) * scale, float(p.y) * scale};
    }
    return found;
}

} // namespace

extern "C" {

L1L2StabResult l1l2_vision_create(L1L2Vision **out, const L1L2VisionConfig *cfg)
{
    *out = nullptr;
    return guard(cfg->log, [&] {
        std::unique_ptr<L1L2Vision> v(new L1L2Vision);
        v->cfg = *cfg;
        l1l2_lk_functions_init(&v->lucas_kanade, l1l2_cpu_features());
        v->size = cv::Size(scaled_side(*cfg, cfg->width), scaled_side(*cfg, cfg->height));
        v->active = cv::Rect(cv::Point(), v->size);
        v->pyramid = pyramid(v->size);
        v->previous_pyramid = pyramid(v->size);
        v->to_gray = scaler(cfg->format, cv::Size(cfg->width, cfg->height), v->size);
        v->levels = l1l2_image_levels_full(cfg->format);
        v->to_thumbnail = scaler(l1l2_image_format_info(L1L2STAB_FORMAT_GRAY8), v->size,
                                 cv::Size(L1L2_THUMBNAIL_W, L1L2_THUMBNAIL_H));
        *out = v.release();
    });
}

void l1l2_vision_free(L1L2Vision *v)
{
    delete v;
}

void l1l2_vision_reset(L1L2Vision *v)
{
    v->pictures = 0;
    v->range = L1L2LevelRange{};
    v->active = cv::Rect(cv::Point(), v->size);
}

void l1l2_vision_size(const L1L2Vision *v, int *width, int *height)
{
    *width = v->size.width;
    *height = v->size.height;
}

L1L2StabResult l1l2_vision_advance(L1L2Vision *v, const uint8_t *data, ptrdiff_t stride)
{
    return guard(v->cfg.log, [&] {
        std::swap(v->pyramid, v->previous_pyramid);
        stretch_levels(v, data, stride);
        l1l2_image_scale_run(v->to_gray.get(), data, stride, v->pyramid->grey[0], v->pyramid->level[0].stride);
        l1l2_motion_pyramid_build(v->pyramid.get());
        v->pictures = std::min(v->pictures + 1, 2);
        if (v->pictures == 2)
            match_brightness(v);
    });
}

L1L2GrayPicture l1l2_vision_picture(const L1L2Vision *v, bool previous, int level)
{
    const L1L2Pyramid *p = previous ? v->previous_pyramid.get() : v->pyramid.get();
    const L1L2LkLevel &l = p->level[std::min(level, p->levels - 1)];
    return {l.grey, l.stride, l.width, l.height};
}

L1L2StabResult l1l2_vision_thumbnail(L1L2Vision *v, L1L2Thumbnail *thumbnail)
{
    return guard(v->cfg.log, [&] {
        l1l2_image_scale_run(v->to_thumbnail.get(), v->pyramid->grey[0], v->pyramid->level[0].stride,
                             thumbnail->level, L1L2_THUMBNAIL_W);
    });
}

L1L2StabResult l1l2_vision_corners(L1L2Vision *v, const L1L2Pixel *taken, int count, const L1L2Mask *mask,
                                   double min_distance, L1L2Pixel *corners, int capacity, int *found)
{
    *found = 0;
    if (v->pictures < 2 || capacity <= 0) /* OpenCV takes a capacity of 0 for none at all */
        return L1L2STAB_OK;
    return guard(v->cfg.log, [&] {
        /* Corners of the half-size level are as good to follow, for a quarter of the time. */
        const bool half = v->previous_pyramid->levels > 1;
        const cv::Mat picture = picture_of(v->previous_pyramid, half ? 1 : 0);
        const float scale = half ? 2.0f : 1.0f;
        const double distance = min_distance / double(scale);
        const cv::Rect active = active_area(v->cfg.parameters, picture);
        v->active = scaled(active, half ? 2 : 1, picture.size(), v->size);
        v->mask.create(picture.size(), CV_8U);
        v->mask.setTo(0);
        v->mask(active).setTo(255);
        block(v->mask, mask);
        for (int i = 0; i < count; i++) /* one pixel more, since center and rim are rounded */
            cv::circle(v->mask, cv::Point(cvRound(taken[i].x / scale), cvRound(taken[i].y / scale)),
                       cvCeil(distance) + 1, cv::Scalar(0), cv::FILLED);
        bool empty[kCellsX * kCellsY];
        std::fill(empty, empty + kCellsX * kCellsY, true);
        *found = corners_in(v, picture, cv::Rect(cv::Point(), picture.size()), capacity, distance, scale, corners);
        for (int i = 0; i < count + *found; i++)
            empty[cell_of(v, i < count ? taken[i] : corners[i - count])] = false;
        for (int cell = 0; cell < kCellsX * kCellsY; cell++) {
            const int quota = std::min(capacity / (kCellsX * kCellsY), capacity - *found);
            const cv::Rect area = cell_area(picture.size(), cell);
            if (empty[cell] && quota > 0 && !area.empty())
                *found += corners_in(v, picture, area, quota, distance, scale, corners + *found);
        }
    });
}

L1L2StabResult l1l2_vision_track(L1L2Vision *v, const L1L2Pixel *from, L1L2Pixel *to, bool *ok, int count,
                                 double max_return)
{
    std::fill(ok, ok + count, false);
    if (v->pictures < 2 || count <= 0)
        return L1L2STAB_OK;
    return guard(v->cfg.log, [&] {
        const L1L2LkLevel *before = v->previous_pyramid->level, *now = v->pyramid->level;
        const int all = v->pyramid->levels, back_levels = std::min(all, int(v->cfg.parameters->backward_levels) + 1);
        for (int i = 0; i < count; i++) {
            const L1L2LkPoint start = {from[i].x, from[i].y};
            L1L2LkPoint there = start, back = start;
            /* The way back starts at the point's origin: a point that was followed correctly is there at once, and one
             * that was not is drawn to where it matches. */
            const bool found = l1l2_lk_follow(&v->lucas_kanade, before, now, all, start, &there) &&
                               l1l2_lk_follow(&v->lucas_kanade, now, before, back_levels, there, &back);
            to[i] = {there.x, there.y};
            ok[i] = found && inside(v, {there.x, there.y}) &&
                    std::hypot(double(back.x - start.x), double(back.y - start.y)) <= max_return;
        }
    });
}

} // extern "C"
