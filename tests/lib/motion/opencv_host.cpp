/* SPDX-License-Identifier: MIT */
/*
 * The library inside an application that uses OpenCV itself: it never enters one of OpenCV's parallel regions, so the
 * application's parallel loops stay parallel, and its results do not depend on cv::setNumThreads(). Where OpenCV runs
 * out of memory, that is reported, and the library goes on.
 */
#include <atomic>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <thread>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/core/parallel/parallel_backend.hpp>

extern "C" {
#include "synth.h"
}

namespace {

constexpr int kFrames = 12;

/* Counts the parallel regions that OpenCV enters. A loop inside another region does not get here. */
class CountingBackend : public cv::parallel::ParallelForAPI {
public:
    std::atomic<int> regions{0};

    void parallel_for(int tasks, FN_parallel_for_body_cb_t body, void *data) override
    {
        regions++;
        body(0, tasks, data);
    }
    int getThreadNum() const override { return 0; }
    int getNumThreads() const override { return threads; }
    int setNumThreads(int count) override { return threads = count; }
    const char *getName() const override { return "counting"; }

private:
    int threads = 4;
};

/* A clip with a flash, so that brightness is matched as well. */
std::vector<SynthPicture> make_clip()
{
    SynthConfig cfg = synth_defaults();
    cfg.width = 1280, cfg.height = 720;
    cfg.event[0] = {SYNTH_FLASH, 6, 2, 0.3};
    Synth *synth = synth_new(&cfg);
    std::vector<SynthPicture> clip;
    for (int t = 0; t < kFrames; t++) {
        clip.push_back(synth_picture_new(L1L2STAB_FORMAT_GRAY8, cfg.width, cfg.height));
        synth_render_gray(synth, t, clip.back().data[0], clip.back().stride[0]);
    }
    synth_free(synth);
    return clip;
}

/* OpenCV's own allocator, but for one allocation that fails. */
class FailingAllocator : public cv::MatAllocator {
public:
    int failing = -1; /* number of the allocation that fails, from 0 */
    mutable int count = 0;

    cv::UMatData *allocate(int dims, const int *sizes, int type, void *data, size_t *step, cv::AccessFlag flags,
                           cv::UMatUsageFlags usage) const override
    {
        if (count++ == failing)
            throw std::bad_alloc();
        return standard->allocate(dims, sizes, type, data, step, flags, usage);
    }
    bool allocate(cv::UMatData *data, cv::AccessFlag flags, cv::UMatUsageFlags usage) const override
    {
        return standard->allocate(data, flags, usage);
    }
    void deallocate(cv::UMatData *data) const override { standard->deallocate(data); }

private:
    cv::MatAllocator *standard = cv::Mat::getStdAllocator();
};

/* The motions of the clip, nine numbers a frame. error: of a frame that could not be measured, if there was one. */
std::vector<double> motions_of(const std::vector<SynthPicture> &clip, L1L2StabResult *error = nullptr)
{
    std::vector<double> motions;
    L1L2StabConfig cfg;
    L1L2Stab *stab;
    L1L2StabInfo info;
    l1l2stab_config_init(&cfg, sizeof cfg);
    cfg.format = L1L2STAB_FORMAT_GRAY8;
    cfg.width = clip[0].width, cfg.height = clip[0].height;
    cfg.threads = 1;
    if (l1l2stab_create(&stab, &cfg) != L1L2STAB_OK)
        return motions;
    for (const SynthPicture &picture : clip) {
        L1L2StabFrame frame = {};
        frame.struct_size = sizeof frame;
        frame.data[0] = picture.data[0];
        frame.stride[0] = picture.stride[0];
        if (l1l2stab_push(stab, &frame) != L1L2STAB_OK)
            break;
    }
    if (l1l2stab_finish(stab) != L1L2STAB_OK)
        motions.clear();
    while (l1l2stab_pull(stab, nullptr, &info) == L1L2STAB_OK)
        motions.insert(motions.end(), info.F, info.F + 9);
    if (error)
        *error = l1l2stab_take_error(stab);
    l1l2stab_free(&stab);
    return motions;
}

/* Fails each of OpenCV's allocations in turn. True if each is reported and all frames come out. */
bool survives_failed_allocations(const std::vector<SynthPicture> &clip)
{
    FailingAllocator allocator;
    bool ok = true;
    cv::Mat::setDefaultAllocator(&allocator);
    for (allocator.failing = 0; allocator.count >= allocator.failing; allocator.failing++) {
        L1L2StabResult error = L1L2STAB_OK;
        allocator.count = 0;
        ok = ok && motions_of(clip, &error).size() == 9 * clip.size();
        ok = ok && error == (allocator.count > allocator.failing ? L1L2STAB_ERR_NOMEM : L1L2STAB_OK);
    }
    cv::Mat::setDefaultAllocator(nullptr);
    return ok && allocator.failing > 5;
}

bool check(bool holds, const char *what)
{
    std::printf("%s: %s\n", holds ? "ok" : "FAILED", what);
    return holds;
}

} // namespace

int main()
{
    auto backend = std::make_shared<CountingBackend>();
    cv::parallel::setParallelForBackend(backend, false);
    const std::vector<SynthPicture> clip = make_clip();

    const std::vector<double> motions = motions_of(clip);
    bool ok = check(motions.size() == 9 * kFrames, "the clip is measured");
    ok &= check(backend->regions == 0, "the library enters no parallel region of OpenCV");

    cv::setNumThreads(1);
    const std::vector<double> serial = motions_of(clip);
    ok &= check(serial == motions, "cv::setNumThreads() changes no motion");
    cv::setNumThreads(4);

    std::atomic<bool> done{false};
    std::thread library([&] {
        motions_of(clip);
        done = true;
    });
    int loops = 0;
    backend->regions = 0;
    do {
        cv::parallel_for_(cv::Range(0, 4), [](const cv::Range &) {});
        loops++;
    } while (!done);
    library.join();
    ok &= check(backend->regions == loops, "the application's loops stay parallel while the library works");
    ok &= check(survives_failed_allocations(clip), "a failed allocation is reported, and all frames come out");
    for (SynthPicture picture : clip)
        synth_picture_free(&picture);
    return ok ? 0 : 1;
}
