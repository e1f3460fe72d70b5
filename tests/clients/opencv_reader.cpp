// SPDX-License-Identifier: MIT
// An OpenCV application that takes its frames from a pipeline, as its users write it.
//
//     opencv_reader PIPELINE [FRAMES]
//
// Reads FRAMES frames, or all, and closes. To stdout: each frame's width and height, in a line, and then its luma.
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

int main(int argc, char **argv)
{
    if (argc < 2)
        return 2;
    const int most = argc > 2 ? std::atoi(argv[2]) : -1;

    cv::VideoCapture capture(argv[1], cv::CAP_GSTREAMER);
    if (!capture.isOpened())
        return 1;
    cv::Mat picture, luma;
    for (int i = 0; i != most && capture.read(picture); i++) {
        cv::cvtColor(picture, luma, cv::COLOR_BGR2GRAY);
        std::printf("%d %d\n", luma.cols, luma.rows);
        std::fwrite(luma.data, 1, luma.total(), stdout);
    }
    return 0;
}
