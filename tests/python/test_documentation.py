# SPDX-License-Identifier: MIT
"""Each example of docs/python.md and README.md is run as it is printed, in a folder with a shaky video, in.mp4."""
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import conftest
import pytest

TOP = Path(__file__).resolve().parents[2]


def examples(document):
    """The indented blocks that import l1l2stab."""
    text = (TOP / document).read_text(encoding='utf-8')
    blocks = re.findall(r'(?:^(?: {4}.*)?\n)+', text, flags=re.MULTILINE)
    return [textwrap.dedent(block) for block in blocks if re.search(r'^    import .*\bl1l2stab\b', block, re.MULTILINE)]


@pytest.mark.parametrize('document, number', [('README.md', 0), *[('docs/python.md', i) for i in range(3)]])
def test_a_documented_example_runs(document, number, tmp_path):
    pytest.importorskip('cv2', reason='OpenCV for Python is not installed')
    code = examples(document)[number]
    video = tmp_path / 'in.mp4'
    import cv2
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter_fourcc(*'mp4v'), conftest.FPS,
                             (conftest.WIDTH, conftest.HEIGHT))
    for frame in conftest.color_clip(40):
        writer.write(frame)
    writer.release()
    run = subprocess.run([sys.executable, '-c', code], cwd=tmp_path, timeout=100, check=False,
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert run.returncode == 0, run.stdout + code


def test_all_examples_are_run():
    assert len(examples('README.md')) == 1 and len(examples('docs/python.md')) == 3
