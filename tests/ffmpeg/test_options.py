#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The options of the filter and the properties of the GStreamer element are the same table, and all are documented."""
import re
import shutil
import subprocess
import unittest
from pathlib import Path

import small_ffmpeg
import clip
from clip import Gst
from gi.repository import GObject

# `threads` is an option of every filter. Messages, statistics, metas and motion files belong to GStreamer: they are
# posted on its bus, and have its stream time. A mask is a file of its own.
ELEMENT_ALONE = {'threads', 'post_messages', 'stats', 'border_map', 'motion_in', 'motion_out', 'mask'}
COMMANDS = {'lambda', 'crop_ratio', 'bypass'}
PLUGIN = Path(__file__).parents[2] / 'plugin/ffmpeg'
CHANGED = ['configure', 'doc/filters.texi', 'libavfilter/Makefile', 'libavfilter/allfilters.c']
TYPES = {'<double>': float, '<int>': int, '<boolean>': bool, '<string>': str}

clip.begin()


def element_options():
    """{name: (least, most, default, [values by name])}"""
    base = {p.name for p in Gst.ElementFactory.make('identity').list_properties() if p.owner_type.name != 'GstIdentity'}
    element = Gst.ElementFactory.make('l1l2stab')
    options = {}
    for p in element.list_properties():
        name = p.name.replace('-', '_')
        if p.name in base or name in ELEMENT_ALONE:
            continue
        if isinstance(p, GObject.ParamSpecEnum) or hasattr(p, 'enum_class'):
            values = {v.value_nick: int(v) for v in p.enum_class.__enum_values__.values()}
            options[name] = (min(values.values()), max(values.values()), p.default_value.value_nick, values)
        elif hasattr(p, 'minimum'):
            options[name] = (p.minimum, p.maximum, p.default_value, {})
        else:
            options[name] = (None, None, p.default_value, {})
    return options


def filter_options():
    """The same, as ffmpeg -h prints it, and the names of those that are commands."""
    text = small_ffmpeg.run('-h', 'filter=l1l2stab')[0].decode()
    options, commands, name = {}, set(), None
    for line in text.splitlines():
        option = re.match(r'  +(\w+) +(<\w+>) +([.A-Z]+) ', line)
        value = re.match(r'     (\w+) +(-?\d+) +[.A-Z]+ ', line)
        if option and 'V' in option[3]:
            name = option[1]
            span = re.search(r'\(from (\S+) to (\S+)\)', line)
            default = (re.search(r'\(default (\S+)\)$', line) or [None, None])[1]
            if option[2] == '<string>':
                options[name] = (None, None, default, {})
            elif option[2] == '<boolean>':
                options[name] = (None, None, default == 'true', {})
            else:
                of = TYPES[option[2]]
                options[name] = (of(span[1]), of(span[2]), default, {})
            if 'T' in option[3]:
                commands.add(name)
        elif value:
            options[name][3][value[1]] = int(value[2])
    return options, commands


class Options(unittest.TestCase):
    def setUp(self):
        self.element = element_options()
        self.filter, self.commands = filter_options()

    def test_the_filter_and_the_element_have_the_same_names(self):
        self.assertEqual(set(self.filter), set(self.element))
        self.assertGreater(len(self.filter), 5)

    def test_every_range_default_and_value_is_that_of_the_element(self):
        for name, (least, most, default, values) in self.element.items():
            with self.subTest(option=name):
                ours = self.filter[name]
                self.assertEqual(ours[3], values)
                if least is not None:
                    self.assertAlmostEqual(ours[0], least)
                    self.assertAlmostEqual(ours[1], most)
                if default is None or isinstance(default, (bool, str)):
                    self.assertEqual(ours[2], default)
                else:
                    self.assertAlmostEqual(float(ours[2]), default)

    def test_lambda_crop_ratio_and_bypass_are_commands(self):
        self.assertEqual(self.commands, COMMANDS)

    def test_every_option_and_every_value_is_documented(self):
        text = (PLUGIN / 'filters.texi').read_text(encoding='utf-8')
        documented = set(re.findall(r'@item (\w+)|@samp\{(\w+)\}', text))
        documented = {a or b for a, b in documented}
        for name, (_, _, _, values) in self.filter.items():
            self.assertIn(name, documented)
            self.assertLessEqual(set(values), documented)

    def test_the_build_is_under_the_lgpl(self):
        self.assertIn('GNU Lesser General Public', small_ffmpeg.run('-L')[0].decode())


class Script(unittest.TestCase):
    """add-to-ffmpeg.sh, in a copy of the files of FFmpeg that it changes."""
    def setUp(self):
        self.tree = clip.folder()
        for name in CHANGED:
            (self.tree / name).parent.mkdir(exist_ok=True)
            shutil.copy(small_ffmpeg.FOLDER.parents[1] / 'tree' / name, self.tree / name)

    def add(self):
        return subprocess.run([PLUGIN / 'add-to-ffmpeg.sh', self.tree], capture_output=True, text=True, check=False)

    def contents(self):
        return {name: (self.tree / name).read_text(encoding='utf-8') for name in CHANGED}

    def test_run_again_it_changes_nothing(self):
        before = self.contents()
        self.assertEqual(self.add().returncode, 0)
        self.assertEqual(self.contents(), before)
        copied = self.tree / 'libavfilter/vf_l1l2stab.c'
        self.assertEqual(copied.read_bytes(), (PLUGIN / 'vf_l1l2stab.c').read_bytes())

    def test_older_documentation_is_replaced(self):
        text = self.contents()['doc/filters.texi']
        (self.tree / 'doc/filters.texi').write_text(text.replace('Stabilize video in one pass.', 'An older text.'))
        self.assertEqual(self.add().returncode, 0)
        self.assertEqual(self.contents()['doc/filters.texi'], text)

    def test_another_tree_is_refused_with_the_reason(self):
        configure = self.tree / 'configure'
        configure.write_text(re.sub('.*(libkvazaar|l1l2stab).*\n', '', configure.read_text()))
        refused = self.add()
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn('configure has no place for the filter', refused.stderr)
        configure.unlink()
        self.assertIn('it has no writable configure', self.add().stderr)


if __name__ == '__main__':
    unittest.main(verbosity=2)
