"""Cracks from displacement fields: closed forms, then the reference solver's walls measured with
noise."""

import json

import numpy as np
import pytest
from conftest import refused_with, run_here, wall_file, written

from damage.applications.cracks.crack_mapping import describe_level, map_cracks
from damage.applications.cracks.dic import (
    Field,
    field_warnings,
    measure,
    patterns_of_fields,
    points_of_bricks,
    read_field,
    report,
    rigid_motion,
    stuck_points,
    turned,
)
from damage.measure.cracks import cracks_at
from damage.wall.file import load_wall
from damage.wall.kinds import HEAD
from damage.wall.layout import lay_out
from paper.dic_field import sampled_field

NOISE = 1e-5
"""Noise of a point [m]: a hundredth of a pixel of 1 mm, usual for DIC of a wall."""
WALL = (
    "Wall('panel', 0.9, {height}, precompression=0.05e6, joint=Joint("
    "tensile_strength=0.02e6, cohesion=0.03e6, friction_angle=math.radians({friction})))"
)


def write_field(path, fields):
    rows = [
        f"{field.level},{x:.4f},{z:.4f},{ux:.7g},{uz:.7g}"
        for field in fields
        for (x, z), (ux, uz) in zip(field.points, field.displacement)
    ]
    path.write_text("# synthetic\nload_level,x_m,z_m,ux_m,uz_m\n" + "\n".join(rows) + "\n")


@pytest.fixture(scope="module")
def panel(tmp_path_factory):
    """A function that pushes a panel in the reference solver: its Layout, its History and its wall
    file."""

    def push(height, friction, *words):
        folder = tmp_path_factory.mktemp("panel")
        wall = wall_file(folder / "panel.py", WALL.format(height=height, friction=friction))
        return lay_out(load_wall(wall)), run_here(folder / "panel.h5", wall, *words), wall

    return push


@pytest.fixture(scope="module")
def rocking(panel):
    return panel(0.75, 32, "--pushover", "0.12")


def fields_of(layout, history, chosen, noise=NOISE):
    """Fields of snapshots (indices) of a History, each with noise of its own, and their samples."""
    samples = [
        int(np.argmin(np.abs(history.series["time_s"] - history.snapshot_time_s[k])))
        for k in chosen
    ]
    return [
        sampled_field(layout, history.displacement[k].astype(float), number, noise=noise, seed=k)
        for number, k in enumerate(chosen, start=1)
    ], samples


# --- closed forms ---------------------------------------------------------------------------------


@pytest.mark.parametrize("turn", [1e-5, 0.3, -2.0])
def test_a_rigid_motion_is_found_exactly(turn):
    points = np.random.default_rng(2).uniform(-1, 1, (30, 2))
    moved = [0.2, -0.1] + turned(points - points.mean(axis=0), turn)
    mean, found = rigid_motion(points, moved)
    assert found == pytest.approx(turn, rel=1e-10) and mean == pytest.approx([0.2, -0.1])


def half_moved(tmp_path, noise=NOISE, upwards=True):
    """A wall whose upper half has moved 0.5 mm up, or along: its Layout and a Field."""
    wall = wall_file(tmp_path / "panel.py", WALL.format(height=0.45, friction=32))
    layout = lay_out(load_wall(wall))
    motion = np.zeros((len(layout.bodies), 3))
    motion[layout.bodies.z > 0.225, int(upwards)] = 0.5e-3
    return layout, sampled_field(layout, motion, noise=noise, drift_ratio=0.0)


@pytest.mark.parametrize("upwards", [True, False])
def test_half_a_wall_that_moves_opens_or_slips_one_joint(tmp_path, upwards):
    """The bed joint below the upper half opens or slips over its whole length."""
    layout, field = half_moved(tmp_path, upwards=upwards)
    (measured,) = fields = measure([field], layout)
    part = measured.opening if upwards else measured.slip
    joints = np.isclose(layout.contacts.z[: layout.n_joints], 0.225) & (
        layout.contacts.kind[: layout.n_joints] != HEAD
    )
    assert part[joints] == pytest.approx(0.5e-3, abs=2e-5)
    assert np.abs(part[~joints]).max() < 2e-5
    (pattern,) = patterns_of_fields([Field(1, 0.0, None, None)], fields, layout)
    level = describe_level(pattern, map_cracks(pattern, layout), layout)
    assert level["DI_open" if upwards else "DI_slip"][1] == pytest.approx(
        0.9 / layout.total_joint_length
    )
    assert level["DI_slip" if upwards else "DI_open"] == (0, 0)
    assert (level["cracks"], level["crack_length_m"]) == (1, pytest.approx(0.9))
    assert set(pattern.stretches["mode"]) == {"tension" if upwards else "shear"}


def test_a_field_whose_z_points_down_is_named(tmp_path):
    layout, field = half_moved(tmp_path)
    assert field_warnings([field], measure([field], layout), layout) == []
    down = Field(1, 0.0, field.points * (1, -1) + (0, 0.45), field.displacement * (1, -1))
    (said,) = field_warnings([down], measure([down], layout), layout)
    assert "z up from a base at rest" in said


def camera_turned(points, angle=5e-4):
    return turned(points - [0.45, 0.2], angle)


def test_a_camera_that_turned_is_named_unless_the_base_was_measured(tmp_path):
    """The wall's own crack is in the middle; half the length of the base opens by up to 0.0005 x
    0.45 m beside it, and does not where points of the base are there."""
    layout, field = half_moved(tmp_path, noise=0.0)
    by_camera = Field(1, 0.0, field.points, field.displacement + camera_turned(field.points))
    (level,) = measured = measure([by_camera], layout)
    base = np.isclose(layout.contacts.z[: layout.n_joints], 0.0)
    assert level.opening[base].max() == pytest.approx(5e-4 * 0.45, rel=0.1)
    (said,) = field_warnings([by_camera], measured, layout)
    assert "moves as one rigid body, by up to 0.187 mm and 0.0005 rad" in said
    below = np.column_stack([np.arange(0.05, 0.9, 0.05), np.full(17, -0.03)])
    whole = Field(
        1,
        0.0,
        np.vstack([field.points, below]),
        np.vstack([by_camera.displacement, camera_turned(below)]),
    )
    (level,) = measured = measure([whole], layout)
    assert level.opening[base].max() < 1e-6
    assert field_warnings([whole], measured, layout) == []


@pytest.mark.parametrize(
    "size, says", [(2.0, "% of the points above the base, x = 0"), (0.5, "% of the joints lie at")]
)
def test_a_field_at_another_scale_is_named(tmp_path, size, says):
    layout, field = half_moved(tmp_path)
    other = Field(1, 0.0, field.points * size, field.displacement)
    said = field_warnings([other], measure([other], layout, 0.0), layout, 0.0)
    assert any(says in text for text in said)


@pytest.mark.parametrize("noise", [NOISE, 0.0])
def test_points_that_were_lost_and_kept_as_zero_are_named(tmp_path, noise):
    """Not those of the half at rest, and not a point about which a brick turns."""
    layout, field = half_moved(tmp_path, noise)
    lost = np.arange(len(field.points)) % 20 == 0
    stuck = Field(1, 0.0, field.points, np.where(lost[:, np.newaxis], 0.0, field.displacement))
    inside = [k for _, points in points_of_bricks(field.points, layout, 0.01) for k in points]
    moving = np.isin(np.arange(len(lost)), inside) & lost & (field.points[:, 1] > 0.225)
    assert (
        stuck_points(stuck, layout).tolist() == np.flatnonzero(moving).tolist()
        and moving.sum() > 10
    )
    (said,) = field_warnings([stuck], measure([stuck], layout), layout)
    assert f"{moving.sum()} of {len(lost)} points" in said
    middle = field.points[inside[0]]  # of rotation
    turning = Field(1, 0.0, field.points, turned(field.points - middle, 1e-3))
    assert len(stuck_points(turning, layout)) == 0


# --- walls of the reference solver ----------------------------------------------------------------


@pytest.mark.parametrize("kind", ["opening", "slip"])
def test_what_a_panel_does_is_measured(rocking, panel, kind):
    """A panel that rocks and one that slides, through noise, export and reading back: each
    joint's opening and slip within five deviations and the elastic part of an intact joint, so that
    the index differs only by joints that near the threshold."""
    layout, history, _ = (
        rocking
        if kind == "opening"
        else panel(0.45, 15, "--pushover", "0.1", "--boundary", "fixed")
    )
    fields, samples = fields_of(layout, history, range(0, len(history.snapshot_time_s), 4))
    levels = measure(fields, layout)
    limits = report(levels, layout)
    assert limits["opening_deviation_m"] < 3e-6 and limits["unseen_m"] == 0
    assert limits["noise_m"] == pytest.approx(NOISE, rel=0.1)
    index = history.index()
    length = history.joints["length_m"].to_numpy()
    for pattern, level, sample in zip(patterns_of_fields(fields, levels, layout), levels, samples):
        found = describe_level(pattern, map_cracks(pattern, layout), layout)
        assert found["DI_drift"][0] == pytest.approx(index["DI_drift"].iloc[sample], abs=1e-3)
        for column, measured, simulated, allowed in (
            (
                "DI_open",
                level.opening,
                history.opening_m[sample].astype(float),
                5 * level.deviation + limits["elastic_opening_m"],
            ),
            (
                "DI_slip",
                level.slip,
                history.offset_m[sample].astype(float),
                5 * level.deviation * np.sqrt(2) + 2 * limits["elastic_slip_m"],
            ),
        ):
            assert np.all(np.abs(measured - simulated) < allowed)
            unsure = length[np.abs(np.abs(simulated) - 1e-4) < allowed].sum() / length.sum()
            assert found[column][0] == pytest.approx(index[column].iloc[sample], abs=unsure + 1e-6)
    assert index["DI_open" if kind == "opening" else "DI_slip"].iloc[samples[-1]] > 0.05
    assert found["cracks"] == cracks_at(history, samples[-1])["crack"].nunique()


# --- file and command -----------------------------------------------------------------------------


def test_the_command_turns_a_field_into_a_crack_file(rocking, tmp_path, output_of):
    layout, history, wall = rocking
    fields, samples = fields_of(layout, history, [0, len(history.snapshot_time_s) - 1])
    write_field(tmp_path / "field.csv", fields)
    words = ["cracks", "--dic", str(tmp_path / "field.csv"), "--wall", str(wall)]
    found = json.loads(output_of(*words, "--export", tmp_path / "cracks.csv", "--json"))
    assert found["levels"][0]["DI"] == [pytest.approx(0, abs=1e-3)] * 2
    assert found["levels"][1]["DI_open"][0] == pytest.approx(
        history.index()["DI_open"].iloc[samples[1]], abs=0.01
    )
    again = json.loads(output_of("cracks", tmp_path / "cracks.csv", "--wall", wall, "--json"))
    assert again["max"]["DI"] == pytest.approx(found["max"]["DI"], abs=1e-6)


def test_lost_points_and_unseen_bricks(rocking, tmp_path):
    """Empty displacements are left out; bricks without points leave their joints unmeasured, and it
    says so."""
    layout, history, _ = rocking
    field = sampled_field(layout, history.displacement[-1].astype(float))
    lost = field.points[:, 0] < 0.1
    field.displacement[lost] = np.nan
    write_field(path := tmp_path / "field.csv", [field])
    path.write_text(path.read_text().replace("nan", ""))
    (seen,) = read_field(path)
    assert len(seen.points) == np.sum(~lost) < len(lost)
    seen = Field(
        1, np.nan, *(part[seen.points[:, 0] > 0.2] for part in (seen.points, seen.displacement))
    )
    levels = measure([seen], layout)
    hidden = np.isnan(levels[0].opening)
    assert 0 < hidden.mean() < 0.5
    assert report(levels, layout)["unseen_m"] == pytest.approx(
        layout.contacts.length[: layout.n_joints][hidden].sum()
    )


@pytest.mark.parametrize(
    "text, complaint",
    [
        ("x_m,z_m,ux_m,uz_m\n0,,0,0\n", "line 2: no z_m"),
        ("x_m,z_m,ux_m,uz_m\n0,0,0,\n", "line 2: one displacement of two"),
        ("load_level,x_m,z_m,ux_m,uz_m\n,0,0,0,0\n", "line 2: no load_level"),
        (
            "x_m,z_m,ux_m,uz_m\n0,0,0.2,0.1\n0,0.1,0.2,0.75\n",
            "line 3: uz_m = 0.75: expected -0.5 to 0.5; look at the unit",
        ),
        ("x_m,z_m,ux_m,uz_m\n10,10,0,0\n", "no brick of wall panel has 4 points"),
        (
            "drift_pct,x_m,z_m,ux_m,uz_m\n0,0,0,0,0\n1,0,0,0,0\n",
            "load level 1 has 2 values of drift_pct",
        ),
    ],
)
def test_bad_fields_are_refused(text, complaint, rocking, tmp_path):
    path = written(tmp_path / "field.csv", text)
    refused_with(complaint, lambda: measure(read_field(path), rocking[0]))
