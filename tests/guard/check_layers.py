#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The layers, by #include: check_layers.py TREE | check_layers.py --self-test

    plugin, samples -> public header -> stabilizer -> motion, path, warp -> seams (vision, qp) and leaves

An arrow may skip layers and never points back. The imaging library, the solver and GStreamer are each known in one
place. A new file of lib/src has to be named here.
"""
import re
import sys
from pathlib import Path

PUBLIC = 'l1l2stab/l1l2stab.h'
LEAF = {'clock', 'cut', 'dissolve', 'fade', 'flow', 'format', 'geom', 'log', 'mem', 'pool', 'residual',
        'rng', 'scale'}

# A group's modules, and the groups that it may include besides itself and the leaves. path_qp.c is of module path.
GROUPS = {
    'stabilizer': ({'stabilizer', 'analysis', 'config', 'frame', 'info', 'ring'}, {'motion', 'path', 'warp', 'wobble'}),
    'motion': ({'motion', 'ransac'}, {'vision'}),
    'path': ({'path', 'plan', 'crop'}, {'qp'}),
    'warp': ({'warp'}, set()),
    'wobble': ({'wobble'}, {'warp'}),
    'vision': ({'vision'}, set()),
    'qp': ({'qp'}, set()),
    'leaf': (LEAF, set()),
}

# The directories whose headers a directory's files may name in quotes.
QUOTED = {
    'plugin': ['plugin'],
    'samples': ['samples', 'tests/support'],
    'tests/bench': ['tests/bench', 'tests/support', 'lib/src'],
    'tests/clients': ['tests/clients'],
    'tests/lib': ['tests/lib', 'tests/support', 'lib/src'],
    'tests/plugin': ['tests/plugin', 'tests/support'],
    'tests/support': ['tests/support'],
    'lib/src': ['lib/src'],
    'lib/include/l1l2stab': [],
}

# What a header outside this tree is called, and who alone may include it.
FOREIGN = [
    (r'opencv', r'lib/src/vision_opencv\.cpp|tests/bench/bench_opencv_.*|tests/clients/opencv_.*'),
    (r'(osqp|qdldl|amd)\b', r'lib/src/qp_osqp\.c'),
    (r'(gst|glib|gio|gobject|gmodule)\b', r'(plugin|tests/plugin|samples)/.*'),
    (r'check\.h', r'tests/.*'),
]


def group_of(stem):
    module = stem.split('_')[0]
    for name, (modules, _) in GROUPS.items():
        if module in modules:
            return name
    return None


def layer_fault(path, header):
    """What is wrong with a lib/src file that includes a lib/src header, or None."""
    source, target = group_of(path.stem), group_of(Path(header).stem)
    if source is None or target is None:
        return f'{path.stem if source is None else header} has no layer: name it in {Path(__file__).name}'
    if target in ('leaf', source) or target in GROUPS[source][1]:
        return None
    return f'{source} must not know {target}'


def fault(path, header, quoted, exists):
    """What is wrong with `path` including `header`, or None. exists(file): whether the tree has it."""
    folder = path.parent.as_posix()
    if folder not in QUOTED:
        return f'{folder} is not a place for C files: name it in {Path(__file__).name}'
    if not quoted:
        for pattern, owner in FOREIGN:
            if re.match(pattern, header) and not re.fullmatch(owner, path.as_posix()):
                return 'may be included in ' + owner.replace('\\', '') + ' alone'
        return None
    if header == PUBLIC:
        return 'the public header is included with <>'
    if not any(exists(f'{place}/{header}') for place in QUOTED[folder]):
        return 'is not a header of ' + (' or '.join(QUOTED[folder]) or 'the system')
    return layer_fault(path, header) if folder == 'lib/src' else None


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
    """Planted includes: the first kind has to be found, the second has to pass."""
    wrong = [
        ('lib/src/path.c', 'stabilizer.h', True), ('lib/src/path.c', 'warp.h', True), ('lib/src/warp.c', 'qp.h', True),
        ('lib/src/geom.h', 'path.h', True), ('lib/src/qp.c', 'path.h', True), ('lib/src/motion.c', 'path.h', True),
        ('lib/src/novel.c', 'geom.h', True), ('lib/src/path.c', 'osqp.h', False), ('lib/src/vision.h', 'osqp.h', False),
        ('lib/src/motion.c', 'opencv2/core.hpp', False), ('lib/src/log.c', 'glib.h', False),
        ('lib/src/log.c', 'gst/gst.h', False), ('tests/lib/test_log.c', 'gst/gst.h', False),
        ('plugin/plugin.c', 'geom.h', True), ('samples/sample.c', 'geom.h', True), ('lib/src/log.c', 'check.h', False),
        ('tests/support/synth.c', 'geom.h', True), ('elsewhere/a.c', 'stdio.h', False),
    ]
    right = [
        ('lib/src/stabilizer.c', 'path.h', True), ('lib/src/path_qp.c', 'qp.h', True),
        ('lib/src/qp_osqp.c', 'osqp.h', False), ('lib/src/vision_opencv.cpp', 'opencv2/core.hpp', False),
        ('plugin/plugin.c', 'gst/gst.h', False), ('tests/lib/test_geom.c', 'geom.h', True),
        ('lib/src/path.c', 'math.h', False), ('lib/src/geom.c', PUBLIC, False),
    ]

    def exists(name):
        return name.startswith('lib/src/')

    missed = [case for case in wrong if not fault(Path(case[0]), case[1], case[2], exists)]
    false_alarms = [case for case in right if fault(Path(case[0]), case[1], case[2], exists)]
    print(f'missed: {missed}, false alarms: {false_alarms}')
    return 1 if missed or false_alarms else 0


if __name__ == '__main__':
    sys.exit(self_test() if sys.argv[1] == '--self-test' else check(Path(sys.argv[1]).resolve()))
