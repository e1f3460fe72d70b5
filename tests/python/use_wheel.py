# SPDX-License-Identifier: MIT
"""Uses an installed wheel: stabilizes frames, and checks that no library of the system's OpenCV is loaded."""
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

begin = time.perf_counter()
import l1l2stab  # noqa: E402
seconds = time.perf_counter() - begin

FRAMES = 30
dice = np.random.default_rng(1)
scene = np.kron(dice.integers(0, 255, (40, 50, 3), np.uint8), np.ones((8, 8, 1), np.uint8))
shaky = [scene[y:y + 240, x:x + 320].copy() for x, y in dice.integers(30, 42, (FRAMES, 2))]
steady = list(l1l2stab.stabilize(shaky, fps=30, window=16))
assert len(steady) == FRAMES and steady[0].shape == (240, 320, 3)


def rms(frames):
    moves = np.array([motion.matrix[:2, 2] for motion in l1l2stab.measure(frames, fps=30)])[1:]
    return float(np.sqrt(np.mean(np.diff(moves, axis=0) ** 2)))


before, after = rms(shaky), rms(steady)
assert after < before / 5, (before, after)

if Path('/proc/self/maps').exists():  # /proc is not mounted in a new root
    maps = Path('/proc/self/maps').read_text(encoding='ascii').splitlines()
    loaded = {line.split()[-1] for line in maps if '.so' in line}
    opencv = [path for path in loaded if 'opencv' in path]
    assert opencv and all('l1l2stab.libs' in path for path in opencv), opencv
    assert not [path for path in loaded if 'libX11' in path or 'libGL' in path]
imports = [float(subprocess.run([sys.executable, '-c', 'import numpy, time; t = time.perf_counter(); import l1l2stab; '
                                 'print(time.perf_counter() - t)'], stdout=subprocess.PIPE, check=True).stdout)
           for _ in range(5)]
print(f'shake {before:.2f} -> {after:.2f} px; import l1l2stab takes {1e3 * min(imports):.0f} ms after numpy, '
      f'{1e3 * seconds:.0f} ms the first time')
