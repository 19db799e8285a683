"""Crack files: what is refused, what the joints of a wall make of them, and the way back to the
index."""

import json
from dataclasses import replace
from math import nan, sqrt

import numpy as np
import pytest
from conftest import REPOSITORY, refused_with, wall_file, written
from small_history import make_history, small_layout

from damage.applications.cracks.crack_file import (
    complete_sizes,
    read_cracks,
)
from damage.applications.cracks.crack_mapping import (
    describe_level,
    largest,
    largest_index,
    least_index,
    map_cracks,
)
from damage.index import COMPONENTS, combine
from damage.measure.cracks import PSI_FROM, cracks_at, psi
from damage.wall.kinds import CUT, HEAD
from damage.wall.layout import lay_out

HEADER = "load_level,drift_pct,crack,point,x_m,z_m,opening_mm,slip_mm,width_mm,mode\n"
WALL = "Wall('small', 0.9, 0.45)"
BED = 0.15  # [m] height of a bed joint of the small wall


def patterns(tmp_path, text, header=HEADER):
    path = written(tmp_path / "cracks.csv", header + text)
    return read_cracks(path)


def figures(pattern, layout=None, **options):
    layout = layout or small_layout()
    return describe_level(pattern, map_cracks(pattern, layout), layout, **options)


# --- reading --------------------------------------------------------------------------------------


def test_levels_polylines_and_sizes(tmp_path):
    """Two levels, the second without cracks; a crack of two polylines; comments and blank lines
    between."""
    first, second = patterns(
        tmp_path,
        "# a comment\n1,-0.1,A,1,0,0.15,0.3,-0.4,,mixed\n1,,A,2,0.1,0.15,,,0.2,unknown\n"
        "\n1,,A,3,0.2,0.2,,,,\n1,,A,1,0,0,,,0.5,shear\n1,,A,2,0.1,0,,,,\n2,0.2,,,,,,,,\n",
    )
    assert (first.level, first.drift_ratio, second.drift_ratio) == (1, -0.001, 0.002)
    assert first.stretches["line"].tolist() == [1, 1, 2] and len(second.stretches) == 0
    assert first.stretches["width_m"].to_numpy() == pytest.approx([0.5e-3, 0.2e-3, 0.5e-3])
    assert first.stretches["slip_m"].to_numpy() == pytest.approx(
        [-0.4e-3, nan, 0.5e-3], nan_ok=True
    )
    assert first.stretches["length_m"].to_numpy() == pytest.approx(
        [0.1, sqrt(0.1**2 + 0.05**2), 0.1]
    )


@pytest.mark.parametrize(
    "given, mode, expected",
    [
        ((0.3, 0.4, nan), "unknown", (0.3, 0.4, 0.5)),
        ((nan, nan, 0.5), "tension", (0.5, 0, 0.5)),
        ((nan, nan, 0.5), "shear", (0, 0.5, 0.5)),
        ((0.3, nan, nan), "tension", (0.3, 0, 0.3)),
        ((0.3, nan, 0.5), "mixed", (0.3, 0.4, 0.5)),
        ((nan, nan, 0.5), "mixed", (nan, nan, 0.5)),
    ],
)
def test_what_is_left_out_follows(given, mode, expected):
    sizes = complete_sizes(*(value * 1e-3 for value in given), mode)
    assert sizes == pytest.approx([value * 1e-3 for value in expected], nan_ok=True)


POINTS = "1,0,1,1,0,0.15,,,0.2,tension\n"
BAD = {
    "empty": ("", "", "is empty: expected a header"),
    "no-column": ("crack,point,x_m\n", "1,1,0\n", "line 1: no column z_m"),
    "mode": (
        HEADER,
        POINTS.replace("tension", "flexure"),
        "line 2: mode = 'flexure': expected one of tension",
    ),
    "one-point": (HEADER, "# comment\n" + POINTS, "line 3: crack 1 has a polyline of one point"),
    "no-width": (
        HEADER,
        "1,0,1,1,0,0.15,0.1,,,\n1,0,1,2,1,0.15,,,,\n",
        "line 2: the width is unknown",
    ),
    "widths-differ": (
        HEADER,
        "1,0,1,1,0,0.15,3,4,6,\n1,0,1,2,1,0.15,,,,\n",
        "width_mm = 6, but .* give 5",
    ),
    "offset-and-slip": (
        "crack,point,x_m,z_m,opening_mm,slip_mm,offset\n",
        "1,1,0,0.15,0.3,0.5,no\n1,2,1,0.15,,,\n",
        "line 2: offset = no with a slip of 0.5 mm: expected none",
    ),
    "two-drifts": (
        HEADER,
        POINTS + "1,0.5,1,2,1,0.15,,,,\n",
        "line 3: drift_pct = 0.5, but 0 in line 2",
    ),
}


@pytest.mark.parametrize("header, text, complaint", BAD.values(), ids=BAD)
def test_bad_files_are_refused_with_their_line(tmp_path, header, text, complaint):
    refused_with(complaint, patterns, tmp_path, text, header)


def test_the_largest_of_levels_without_a_drift_is_not_known():
    one = dict.fromkeys(COMPONENTS, (0.1, 0.2)) | {"DI_drift": None, "psi": 1.0}
    other = dict.fromkeys(COMPONENTS, (0.0, 0.3)) | {"DI_drift": None, "psi": 2.0}
    found = largest([one, other])
    assert (found["DI"], found["DI_drift"], found["psi"]) == ((0.1, 0.3), None, 2.0)


# --- on the joints --------------------------------------------------------------------------------


def test_a_crack_along_a_bed_joint_counts_with_its_length(tmp_path):
    """0.3 m of 0.2 mm of tension, drawn 5 mm off a bed joint whose T-junctions do not disturb."""
    (pattern,) = patterns(
        tmp_path, f"1,0.4,1,1,0.2,{BED + 0.005},,,0.2,tension\n1,,1,2,0.5,{BED + 0.005},,,,\n"
    )
    layout = small_layout()
    level = figures(pattern, layout)
    total = layout.total_joint_length
    assert level["unmapped_m"] == 0 and level["cracks"] == 1
    assert level["crack_length_m"] == pytest.approx(0.3)
    assert level["DI_open"] == pytest.approx((0.3 / total,) * 2)
    assert level["DI"] == pytest.approx((combine(0.2, 0.3 / total, 0),) * 2)
    assert level["psi"] == level["psi_drawn"] == pytest.approx(2 * 0.2**0.3)


def test_a_crack_through_a_brick_or_beside_the_wall_is_on_no_joint(tmp_path):
    """Through the middle of a brick from bed to bed, and a metre above the wall."""
    (pattern,) = patterns(
        tmp_path,
        "1,,1,1,0.17,0.155,,,0.2,\n1,,1,2,0.17,0.22,,,,\n"
        "1,,2,1,0.2,1.45,,,0.2,\n1,,2,2,0.4,1.45,,,,\n",
    )
    level = figures(pattern)
    assert level["unmapped_m"] == pytest.approx(0.265) and level["psi"] == level["DI"][1] == 0
    assert level["psi_drawn"] == pytest.approx(2 * 2**0.15 * 0.2**0.3)
    assert level["drift_pct"] is None and level["DI_drift"] is None


@pytest.mark.parametrize("splits, cracks, on_joints", [(False, 1, 0.075), (True, 1, 0.0)])
def test_a_crack_through_a_bricks_middle(tmp_path, splits, cracks, on_joints):
    """Half on the head joint above and half on that below; in a wall whose bricks split on the
    brick's own middle, which is a crack but no part of the index."""
    layout = small_layout()
    if splits:
        layout = lay_out(
            replace(layout.wall, brick=replace(layout.wall.brick, tensile_strength=2e6))
        )
    (pattern,) = patterns(tmp_path, "1,,1,1,0.3375,0.15,,,0.2,tension\n1,,1,2,0.3375,0.225,,,,\n")
    mapped = map_cracks(pattern, layout)
    assert set(layout.contacts.kind[mapped.table["joint"]]) == {CUT if splits else HEAD}
    level = figures(pattern, layout)
    # the middle piece
    assert (level["unmapped_m"], level["cracks"]) == (pytest.approx(0, abs=1e-3), cracks)
    assert level["crack_length_m"] == pytest.approx(0.075, abs=1e-3)
    assert level["DI_open"][0] * layout.total_joint_length == pytest.approx(on_joints, abs=1e-3)


# --- bounds ---------------------------------------------------------------------------------------


def test_bounds_of_an_unknown_mode_are_those_of_every_split():
    """The bounds enclose DI of 20 000 random splits of 0.1 mm < w, and are reached to 0.1 %."""
    random = np.random.default_rng(1)
    drift = 0.1
    opened = 0.05
    slipped = 0.2
    strong = 0.3
    weak = 0.1
    n = 20_000
    # shares of strong: opened alone, else slipped or both
    a = random.beta(0.3, 0.3, n)
    b = random.beta(0.3, 0.3, n)
    only_open = a * strong
    only_slip = (1 - a) * strong * b
    both = strong - only_open - only_slip
    weak_open = weak * random.beta(0.3, 0.3, n)
    weak_slip = (weak - weak_open) * random.beta(0.3, 0.3, n)
    split = combine(
        drift, opened + only_open + both + weak_open, slipped + only_slip + both + weak_slip
    )
    low = least_index(drift, opened, slipped, strong)
    high = largest_index(drift, opened, slipped, strong, weak)
    assert low <= split.min() < low + 0.005 and high - 0.005 < split.max() <= high


# --- round trip -----------------------------------------------------------------------------------


@pytest.fixture
def random_history(tmp_path):
    """Openings and slips of every size about the threshold, a drift, a last sample at rest."""
    random = np.random.default_rng(11)
    layout = small_layout()
    fade = np.append(np.ones(20), 0.0)
    joints = range(layout.n_joints)
    return make_history(
        tmp_path / "random.h5",
        layout,
        drift=0.002 * fade,
        opening={j: np.maximum(random.normal(0, 2e-4, 21), 0) * fade for j in joints},
        slip={j: random.normal(0, 1.5e-4, 21) * fade for j in joints},
    )


def test_the_command_exports_reads_and_draws(random_history, tmp_path, output_of):
    """What is read of the exported cracks has the index and Psi of the run."""
    wall = wall_file(tmp_path / "small.py", WALL)
    export = tmp_path / "out" / "cracks.csv"
    words = "cracks", random_history.path, "--at", "0.03,0.1,end", "--export", export, "--json"
    simulated = json.loads(output_of(*words))
    read = output_of("cracks", export, "--wall", wall, "--json", "--out", tmp_path / "png")
    index = random_history.index()
    samples = (3, 10, 20)
    found = json.loads(read)
    for level, run, sample in zip(found["levels"], simulated["levels"], samples, strict=True):
        assert run["time_s"] == random_history.series["time_s"].iloc[sample]
        for name in ("DI", "DI_drift", "DI_open", "DI_slip"):
            assert run[name] == [index[name].iloc[sample]] * 2
            assert level[name] == pytest.approx(run[name], abs=1e-6)
        assert run["psi"] == psi(cracks_at(random_history, sample, PSI_FROM))
        assert [level["psi"], level["psi_drawn"]] == pytest.approx([run["psi"]] * 2, abs=1e-5)
        assert level["unmapped_m"] < 1e-6
    assert index["DI"].iloc[20] == 0 < index["DI"].iloc[3]
    assert found["max"]["DI"] == pytest.approx(simulated["max"]["DI"], abs=1e-6)
    assert (tmp_path / "png/cracks_level_2.png").is_file()


def test_the_example_of_the_documentation(tmp_path, output_of):
    """Crack A's four joints by hand; B's mode is open."""
    text = (REPOSITORY / "docs" / "reference" / "crack-format.md").read_text()
    (tmp_path / "example.csv").write_text(text.split("```text\n")[1].split("```")[0])
    wall = str(REPOSITORY / "walls" / "solid.py")
    none, cracked = json.loads(
        output_of("cracks", tmp_path / "example.csv", "--wall", wall, "--json")
    )["levels"]
    assert none["DI"] == pytest.approx([0.025] * 2) and none["cracks"] == 0
    total = 198.375
    assert cracked["DI_open"] == pytest.approx(
        [(0.1125 + 0.075) / total, (0.1125 + 0.075 + 0.85) / total], abs=1e-5
    )
    assert cracked["DI_slip"] == pytest.approx([0.1125 / total, (0.1125 + 0.85) / total], abs=1e-5)
    assert (cracked["cracks"], cracked["undecided_m"]) == (2, pytest.approx(0.85, abs=1e-3))
