#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the layers by the #include lines: check_layers.py TREE | check_layers.py --self-test

    plugin, samples -> public header -> lib/src -> motion -> rolling_shutter -> fit, warp -> image -> common
                                            \\-> border -----------------------> warp
                                            \\-> path ---------------------------------------> common

Each folder of lib/src has one rule: the folders whose headers it may include. No rule points back. OpenCV, OSQP,
GStreamer and FFmpeg are each used in one place. A new folder has to be added here.
"""
import re
import sys
from pathlib import Path

PUBLIC = 'l1l2stab/l1l2stab.h'
SOURCE = 'lib/src'

# The rule of each folder of lib/src: the folders that it may include besides itself. '.' is lib/src, the stabilizer.
MAY_INCLUDE = {
    '.': {'border', 'motion', 'rolling_shutter', 'path', 'warp', 'image', 'common'},
    'motion': {'rolling_shutter', 'fit', 'image', 'common'},
    'rolling_shutter': {'fit', 'warp', 'common'},
    'path': {'common'},
    'border': {'warp', 'image', 'common'},
    'warp': {'image', 'common'},
    'fit': {'common'},
    'image': {'common'},
    'common': set(),
}

# For each folder outside lib/src: the folders that its files may include headers from, in quotes.
QUOTED = {
    'plugin/ffmpeg': [],
    'plugin/gstreamer': ['plugin/gstreamer'],
    'samples': ['samples', 'tests/support'],
    'samples/l1l2stab': ['samples/l1l2stab'],
    'tests/bench': ['tests/bench', 'tests/support', SOURCE],
    'tests/clients': ['tests/clients'],
    'tests/fuzz': ['tests/fuzz', 'plugin/gstreamer', SOURCE],
    'tests/gstreamer': ['tests/gstreamer', 'tests/support'],
    'tests/lib': ['tests/lib', 'tests/support', SOURCE],
    'tests/soak': [],
    'tests/support': ['tests/support'],
    'lib/include/l1l2stab': [],
    SOURCE: [SOURCE],
}

# The files of this folder are compiled within FFmpeg's source tree. FFmpeg's headers are included in quotes there.
FFMPEG = 'plugin/ffmpeg'
FFMPEG_HEADER = r'((libav|libsw)[a-z]+/)?[a-z_]+\.h'

# Headers from outside the tree, and the only files that may include them.
FOREIGN = [
    (r'opencv', r'lib/src/motion/vision_opencv\.cpp|tests/(bench/bench_|clients/|lib/motion/)opencv_.*'),
    (r'(osqp|qdldl|amd)\b', r'lib/src/path/qp_osqp\.c'),
    (r'(gst|glib|gio|gobject|gmodule)\b', r'(plugin/gstreamer|tests/gstreamer|tests/fuzz|samples)/.*'),
    (r'(libav|libsw)[a-z]+/', r'samples/(l1l2stab/.*|stabilize-libav\.c)'),
    (r'check\.h', r'tests/.*'),
    (r'.*intrin\.h|simde/', r'lib/src/common/(intrinsics|avx2_halves)\.h'),
]


def place_of(path):
    """The entry of QUOTED that applies to a file, or None."""
    return next((place for place in QUOTED if path.is_relative_to(place) and
                 (path.parent == Path(place) or place in (SOURCE, 'tests/lib'))), None)


def folder_of(path):
    """The folder of lib/src that a path below it belongs to."""
    return path.parts[0] if len(path.parts) > 1 else '.'


def layer_fault(path, header):
    """What is wrong with a file that includes a header, both relative to lib/src; or None."""
    folder, target = folder_of(path), folder_of(Path(header))
    for name in (folder, target):
        if name not in MAY_INCLUDE:
            return f'folder {name} has no rule: add it to {Path(__file__).name}'
    if target == folder or target in MAY_INCLUDE[folder]:
        return None
    return f'{folder} must not include {target}'


def fault(path, header, quoted, exists):
    """What is wrong with `path` including `header`, or None. exists(file): whether the tree has it."""
    place = place_of(path)
    if place is None:
        return f'{path.parent.as_posix()} is not a place for C files: add it to {Path(__file__).name}'
    if not quoted:
        for pattern, owner in FOREIGN:
            if re.match(pattern, header) and not re.fullmatch(owner, path.as_posix()):
                return 'may be included in ' + owner.replace('\\', '') + ' alone'
        return None
    if header == PUBLIC:
        return 'the public header is included with <>'
    if place == FFMPEG and re.fullmatch(FFMPEG_HEADER, header):
        return None
    if not any(exists(f'{folder}/{header}') for folder in QUOTED[place]):
        return 'is not a header of ' + (' or '.join(QUOTED[place]) or 'the system')
    return layer_fault(path.relative_to(SOURCE), header) if place == SOURCE else None


def check(tree):
    files = [p for top in ('lib', 'plugin', 'samples', 'tests') for p in (tree / top).rglob('*')
             if p.suffix in ('.c', '.cpp', '.h')]
    faults = 0
    for file in sorted(files):
        path = file.relative_to(tree)
        for number, line in enumerate(file.read_text(encoding='utf-8').splitlines(), 1):
            match = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
            reason = match and fault(path, match[2], match[1] == '"', lambda name: (tree / name).exists())
            if reason:
                faults += 1
                print(f'{path}:{number}: {match[2]}: {reason}')
    print(f'{len(files)} files, {faults} faults')
    return 1 if faults or not files else 0


def self_test():
    """Checks includes that must be reported (wrong) and includes that must not (right)."""
    wrong = [
        ('lib/src/path/path.c', 'config.h', True), ('lib/src/path/path.c', 'warp/warp.h', True),
        ('lib/src/warp/warp.c', 'path/qp.h', True), ('lib/src/common/geom.h', 'path/path.h', True),
        ('lib/src/fit/ransac.c', 'motion/motion.h', True), ('lib/src/motion/motion.c', 'path/path.h', True),
        ('lib/src/rolling_shutter/fit.c', 'motion/motion.h', True), ('lib/src/novel/a.c', 'common/geom.h', True),
        ('lib/src/path/path.c', 'novel/a.h', True), ('lib/src/warp/x86/avx2.h', 'motion/motion.h', True),
        ('lib/src/path/path.c', 'osqp.h', False), ('lib/src/motion/vision.h', 'osqp.h', False),
        ('lib/src/motion/motion.c', 'opencv2/core.hpp', False), ('lib/src/common/log.c', 'glib.h', False),
        ('lib/src/common/log.c', 'gst/gst.h', False), ('tests/lib/common/test_log.c', 'gst/gst.h', False),
        ('plugin/gstreamer/plugin.c', 'common/geom.h', True), ('samples/sample.c', 'common/geom.h', True),
        ('lib/src/common/log.c', 'check.h', False), ('tests/support/synth.c', 'common/geom.h', True),
        ('plugin/ffmpeg/vf.c', 'common/geom.h', True), ('plugin/ffmpeg/vf.c', 'gst/gst.h', False),
        ('plugin/gstreamer/plugin.c', 'libavutil/opt.h', False), ('samples/sample.c', 'libavcodec/avcodec.h', False),
        ('plugin/gstreamer/plugin.c', 'libavutil/opt.h', True), ('lib/src/common/log.c', 'libavutil/log.h', False),
        ('elsewhere/a.c', 'stdio.h', False), ('plugin/a.c', 'stdio.h', False),
        ('lib/src/warp/x86/avx2.h', 'immintrin.h', False), ('lib/src/warp/warp.c', 'simde/x86/sse4.1.h', False),
    ]
    right = [
        ('lib/src/stabilizer.c', 'path/path.h', True), ('lib/src/path/problem_as_qp.c', 'path/qp.h', True),
        ('lib/src/path/qp_osqp.c', 'osqp.h', False), ('lib/src/motion/vision_opencv.cpp', 'opencv2/core.hpp', False),
        ('plugin/gstreamer/plugin.c', 'gst/gst.h', False), ('tests/lib/common/test_geom.c', 'common/geom.h', True),
        ('lib/src/path/path.c', 'math.h', False), ('lib/src/common/geom.c', PUBLIC, False),
        ('lib/src/warp/x86/avx2.h', 'warp/sample.h', True), ('lib/src/motion/motion.c', 'fit/ransac.h', True),
        ('plugin/ffmpeg/vf.c', 'libavutil/opt.h', True), ('plugin/ffmpeg/vf.c', 'avfilter.h', True),
        ('lib/src/common/avx2_halves.h', 'simde/x86/sse4.1.h', False),
        ('plugin/ffmpeg/vf.c', PUBLIC, False), ('samples/stabilize-libav.c', 'libavcodec/avcodec.h', False),
    ]

    def exists(name):
        return name.startswith('lib/src/')

    missed = [case for case in wrong if not fault(Path(case[0]), case[1], case[2], exists)]
    false_alarms = [case for case in right if fault(Path(case[0]), case[1], case[2], exists)]
    print(f'missed: {missed}, false alarms: {false_alarms}')
    return 1 if missed or false_alarms else 0


if __name__ == '__main__':
    sys.exit(self_test() if sys.argv[1] == '--self-test' else check(Path(sys.argv[1]).resolve()))
