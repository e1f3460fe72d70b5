# SPDX-License-Identifier: MIT
"""Shaky clips as numpy arrays, and what all tests of the Python package share.

meson runs each file as a test of its own. If all of its tests are skipped, the exit code is 77, which meson counts as
skipped.
"""
import numpy as np
import pytest

WIDTH, HEIGHT, FPS = 320, 240, 30
SHAKE = 6  # pixels


def scene(seed=1):
    """A picture of soft random tiles, larger than the frames: (rows, columns) of uint8."""
    dice = np.random.default_rng(seed)
    size = HEIGHT + 16 * SHAKE, WIDTH + 16 * SHAKE
    picture = np.zeros(size)
    for tile in (8, 16, 32):
        coarse = dice.uniform(0, 80, (size[0] // tile + 1, size[1] // tile + 1))
        picture += np.kron(coarse, np.ones((tile, tile)))[:size[0], :size[1]]
    return picture.astype(np.uint8)


def positions(count, seed=2):
    """(x, y) of the camera for each frame, whole pixels: a random shake."""
    return np.random.default_rng(seed).integers(-SHAKE, SHAKE + 1, (count, 2))


def gray_clip(count, seed=1):
    """Frames (HEIGHT, WIDTH) that show the scene from these positions. Each is an array of its own."""
    whole, middle = scene(seed), 8 * SHAKE
    return [whole[middle + y:middle + y + HEIGHT, middle + x:middle + x + WIDTH].copy() for x, y in positions(count)]


def color_clip(count):
    """Frames (HEIGHT, WIDTH, 3): three different pictures that move together."""
    return [np.stack(channels, axis=2) for channels in zip(*(gray_clip(count, seed) for seed in (1, 3, 4)))]


def shake(motions):
    """The rms change of the move from frame to frame, pixels: 0 for a still camera and for a steady pan."""
    moves = np.array([motion.matrix[:2, 2] for motion in motions])[1:]
    return float(np.sqrt(np.mean(np.diff(moves, axis=0) ** 2)))


@pytest.fixture
def clip():
    return color_clip(40)


def pytest_sessionfinish(session, exitstatus):
    reporter = session.config.pluginmanager.get_plugin('terminalreporter')
    if exitstatus == 0 and reporter and not reporter.stats.get('passed') and reporter.stats.get('skipped'):
        session.exitstatus = 77
