#!/bin/sh
# SPDX-License-Identifier: MIT
# Prints the folder opencv4 on the compiler's include path, the one that opencv2/core.hpp is in. Used by meson.
# usage: find_opencv.sh COMPILER [OPTION...]
set -eu

header=opencv2/core/version.hpp
# A preprocessor names the full path of each file that it includes: # 1 "/usr/include/opencv4/opencv2/core/version.hpp"
folder=$(echo "#include <opencv4/$header>" | "$@" -E -xc++ - | sed -n "s|^# 1 \"\(.*\)/$header\".*|\1|p" | head -n 1)
[ -n "$folder" ]
echo "$folder"
