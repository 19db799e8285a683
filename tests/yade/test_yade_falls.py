"""A spandrel that falls in YADE with --after-fall: its bricks are followed until they rest."""

import re
from itertools import starmap

import numpy as np
import pytest
from conftest import written

from damage import read_history
from damage.draw.run import has_heap
from damage.wall.geometry import body_corners

pytestmark = [pytest.mark.yade, pytest.mark.long]

WALL = """name = "spandrel"
length = 2.925
height = 0.525
[[openings]]
left = 0.45
width = 2.025
height = 0.225
"""
MOST_OVERLAP_M = 2e-3
"""Largest overlap of two bricks, or of one and the ground [m]."""


def depth(one, other):
    """Overlap of two rectangles [m], the least along the normals of their sides, below zero where
    they are apart; corners: (4, 2) each."""
    shared = np.inf
    for corners in (one, other):
        for side in np.diff(corners[:3], axis=0):
            normal = np.array([-side[1], side[0]]) / np.hypot(*side)
            along_one = one @ normal
            along_other = other @ normal
            shared = min(
                shared,
                min(along_one.max(), along_other.max()) - max(along_one.min(), along_other.min()),
            )
    return shared


def test_bricks_fall_until_they_rest_apart_from_each_other(tmp_path, yade_command):
    """The opening is 0.225 m high: the lowest bricks fall for 0.2 s."""
    done = yade_command(
        "-j1",
        written(tmp_path / "spandrel.toml", WALL),
        "--lintel none --harmonic 0.05 0.5 --rest 0.5 --after-fall --no-pictures --out fall.h5",
        cwd=tmp_path,
        status=0,
    )
    history = read_history(tmp_path / "fall.h5")
    (rest_s,) = map(float, re.findall(r"at rest ([\d.]+) s after the first one", done.stdout))
    assert 0.2 < rest_s < 4.0
    assert history.complete and history.parameters["after_fall"] and has_heap(history)
    assert history.series["time_s"].iloc[-1] == pytest.approx(history.collapsed_at_s)
    assert history.snapshot_time_s[-1] > history.collapsed_at_s + rest_s
    assert history.displacement[-1][:, 1].min() < -0.2
    corners = body_corners(history.bodies, history.displacement[-1].astype(float))
    pairs = [(one, other) for k, one in enumerate(corners) for other in corners[:k]]
    assert max(starmap(depth, pairs)) < MOST_OVERLAP_M
    assert corners[..., 1].min() > -MOST_OVERLAP_M
