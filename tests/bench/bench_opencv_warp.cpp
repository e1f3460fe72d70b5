/* SPDX-License-Identifier: MIT */
/*
 * Informational: this library's warp compared with OpenCV's warpAffine (three planes) and a memcpy, on the same 1080p
 * I420 frames and one core, in ms of CPU time per frame. Best and median of many frames. The candidates take turns, so
 * that all run under the same load. A ring of frames larger than the caches is used, as in a stabilizer.
 *
 * usage: bench_opencv_warp
 */
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

extern "C" {
#include "warp/warp.h"
}

namespace {

constexpr int kWidth = 1920, kHeight = 1080, kHeld = 24, kRounds = 60;
constexpr size_t kBytes = size_t(kWidth) * kHeight * 3 / 2;

/* Band-limited noise, with about the detail of a picture. */
std::vector<uint8_t> make_frame(int number)
{
    std::vector<uint8_t> frame(kBytes);
    cv::Mat picture(kHeight * 3 / 2, kWidth, CV_8U, frame.data());
    cv::RNG rng(uint64_t(number + 1));
    rng.fill(picture, cv::RNG::UNIFORM, 0, 256);
    cv::GaussianBlur(picture, picture, cv::Size(5, 5), 1.0);
    return frame;
}

struct Planes {
    uint8_t *data[4];
    ptrdiff_t stride[4];
};

Planes planes_of(std::vector<uint8_t> &frame)
{
    uint8_t *y = frame.data(), *u = y + kWidth * kHeight, *v = u + kWidth * kHeight / 4;
    return {{y, u, v, nullptr}, {kWidth, kWidth / 2, kWidth / 2, 0}};
}

L1L2Mat map_of(int number)
{
    const double angle = 0.0174 * std::sin(0.7 * number), zoom = 0.9;
    return l1l2_mat_similarity(zoom * std::cos(angle), zoom * std::sin(angle), 5.0 * std::sin(number),
                               5.0 * std::cos(number));
}

void warp_by_opencv(const L1L2Mat &map, const Planes &src, const Planes &dst, int interpolation)
{
    for (int i = 0; i < 3; i++) {
        const int scale = i == 0 ? 1 : 2, w = kWidth / scale, h = kHeight / scale;
        cv::Matx23d m(map.m[0], map.m[1], map.m[2] / scale, map.m[3], map.m[4], map.m[5] / scale);
        m(0, 2) += 0.5 * (w - 1) - m(0, 0) * 0.5 * (w - 1) - m(0, 1) * 0.5 * (h - 1);
        m(1, 2) += 0.5 * (h - 1) - m(1, 0) * 0.5 * (w - 1) - m(1, 1) * 0.5 * (h - 1);
        const cv::Mat from(h, w, CV_8U, src.data[i], size_t(src.stride[i]));
        cv::Mat to(h, w, CV_8U, dst.data[i], size_t(dst.stride[i]));
        cv::warpAffine(from, to, m, to.size(), interpolation | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    }
}

/* CPU time of this thread, which does all the work. */
double cpu_ms()
{
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) * 1e3 + double(now.tv_nsec) * 1e-6;
}

struct Way {
    const char *name;
    L1L2Warp *ours;
    bool mesh;
    int opencv;
    std::vector<double> ms;
};

L1L2Warp *new_warp(L1L2StabInterpolation interpolation)
{
    L1L2WarpConfig cfg = {};
    L1L2Warp *warp;
    cfg.format = l1l2_image_format_info(L1L2STAB_FORMAT_I420);
    cfg.in_width = cfg.out_width = kWidth;
    cfg.in_height = cfg.out_height = kHeight;
    cfg.interpolation = interpolation;
    if (l1l2_warp_create(&warp, &cfg) != L1L2STAB_OK)
        std::exit(EXIT_FAILURE);
    return warp;
}

void render(Way &way, const L1L2Mat &map, L1L2WarpMesh &mesh, std::vector<uint8_t> &from, std::vector<uint8_t> &to)
{
    const Planes src = planes_of(from), dst = planes_of(to);
    const double start = cpu_ms();
    if (way.ours) {
        const L1L2WarpMap to_source = {map, way.mesh ? &mesh : nullptr};
        l1l2_warp_render(way.ours, &to_source, src.data, src.stride, dst.data, dst.stride);
    } else if (way.opencv >= 0) {
        warp_by_opencv(map, src, dst, way.opencv);
    } else {
        std::memcpy(to.data(), from.data(), kBytes);
    }
    way.ms.push_back(cpu_ms() - start);
}

} // namespace

int main()
{
    cv::setNumThreads(1);
    std::vector<std::vector<uint8_t>> held, shown;
    for (int k = 0; k < kHeld; k++) {
        held.push_back(make_frame(k));
        shown.emplace_back(kBytes);
    }
    L1L2Warp *const bilinear = new_warp(L1L2STAB_INTERPOLATION_BILINEAR);
    L1L2Warp *const bicubic = new_warp(L1L2STAB_INTERPOLATION_BICUBIC);
    L1L2Warp *const lanczos = new_warp(L1L2STAB_INTERPOLATION_LANCZOS);
    std::vector<Way> ways = {
        {"memcpy", nullptr, false, -1, {}},
        {"bilinear", bilinear, false, 0, {}},
        {"bilinear through a mesh", bilinear, true, 0, {}},
        {"OpenCV INTER_LINEAR", nullptr, false, cv::INTER_LINEAR, {}},
        {"bicubic", bicubic, false, 0, {}},
        {"bicubic through a mesh", bicubic, true, 0, {}},
        {"OpenCV INTER_CUBIC", nullptr, false, cv::INTER_CUBIC, {}},
        {"Lanczos, 6 taps", lanczos, false, 0, {}},
        {"Lanczos, 6 taps, through a mesh", lanczos, true, 0, {}},
        {"OpenCV INTER_LANCZOS4, 8 taps", nullptr, false, cv::INTER_LANCZOS4, {}},
    };
    L1L2WarpMesh mesh;
    if (!l1l2_warp_mesh_init(&mesh, kWidth, kHeight))
        return EXIT_FAILURE;
    int frame = 0;
    for (int round = 0; round < kRounds; round++)
        for (Way &way : ways) {
            const L1L2Mat map = map_of(round);
            l1l2_warp_mesh_set(&mesh, &map);
            frame = (frame + 1) % kHeld;
            render(way, map, mesh, held[size_t(frame)], shown[size_t(frame)]);
        }
    std::printf("1080p I420, one core, %d frames: ms per frame     best     median   of memcpy\n", kRounds);
    for (Way &way : ways) {
        std::sort(way.ms.begin(), way.ms.end());
        const double copy = ways[0].ms[kRounds / 2], ms = way.ms[kRounds / 2];
        std::printf("  %-42s %9.2f %10.2f %11.1f\n", way.name, way.ms[0], ms, ms / copy);
    }
    l1l2_warp_mesh_clear(&mesh);
    l1l2_warp_free(bilinear);
    l1l2_warp_free(bicubic);
    l1l2_warp_free(lanczos);
    return EXIT_SUCCESS;
}
