"""Histories as VTKHDF: the layout, of one made by hand; what VTK's readers make of both solvers'
(long)."""

import json
import sys

import h5py
import numpy as np
import pytest
from conftest import run_command, wall_file
from environments import environment, run_in
from numpy.testing import assert_allclose, assert_array_equal
from small_history import make_history, small_layout
from test_yade_run import PIER

from damage.applications.report.vtkhdf import HEXAHEDRON, LINE, WallCells, write_vtkhdf
from damage.history.moments import JOINT_STATES
from damage.history.reader import read_history
from yade_scripts import COMMAND

TURN = 0.2  # [rad] of the last brick in the second snapshot


@pytest.fixture(scope="module")
def history(tmp_path_factory):
    """Contact point 3 opens by 0.5 mm at sample 12; the last brick moves by 2 mm and turns."""
    layout = small_layout()
    moved = np.zeros((len(layout.bodies), 3))
    moved[layout.n_bricks - 1] = 2e-3, 0.0, TURN
    opening = np.where(np.arange(21) >= 12, 5e-4, 0.0)
    return make_history(
        tmp_path_factory.mktemp("paraview") / "small.h5",
        layout,
        opening={3: opening},
        slip={5: 3e-4},
        drift=np.linspace(0, 1e-3, 21),
        loading="record",
        snapshots={0.0: 0 * moved, 0.1: moved, 0.2: moved},
    )


class TestCells:
    def test_a_brick_is_a_hexahedron_of_its_own_size(self, history):
        cells, brick = WallCells(history), history.masonry_wall.brick
        bodies = history.bodies
        assert list(cells.types) == [HEXAHEDRON] * len(bodies) + [LINE] * len(history.joints)
        corners = cells.points[:8]
        assert_allclose(
            np.ptp(corners, axis=0), (bodies.length_m[0], brick.thickness, bodies.height_m[0])
        )
        a, b, d, e = (corners[k] for k in (0, 1, 3, 4))
        volume = np.dot(np.cross(b - a, d - a), e - a)  # positive: in the order that VTK asks for
        assert_allclose(volume, bodies.length_m[0] * brick.thickness * bodies.height_m[0])

    def test_a_joint_is_a_line_of_its_tributary_length_on_the_front_face(self, history):
        cells, joints = WallCells(history), history.joints
        ends = cells.points[8 * len(history.bodies) :].reshape(-1, 2, 3)
        assert_allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), joints.length_m)
        assert np.all(ends[..., 1] == -history.masonry_wall.brick.thickness / 2)

    def test_corners_turn_with_their_brick(self, history):
        cells, last = WallCells(history), int(np.flatnonzero(history.bodies.course >= 0)[-1])
        moved = cells.displacement(1)[8 * last : 8 * last + 8]
        corner = cells.points[8 * last + 2] - np.mean(cells.points[8 * last : 8 * last + 8], axis=0)
        x, z = corner[0], corner[2]
        there = (2e-3 + np.cos(TURN) * x - np.sin(TURN) * z, np.sin(TURN) * x + np.cos(TURN) * z)
        assert_allclose(moved[2], (there[0] - x, 0.0, there[1] - z), rtol=1e-5)
        assert_allclose(cells.rotation(1)[last], TURN, rtol=1e-6)
        assert np.all(cells.displacement(0) == 0) and np.all(cells.displacement(-1) == 0)

    def test_joints_have_their_state_and_bodies_have_none(self, history):
        fields, first = WallCells(history).joint_fields(15), len(history.bodies)
        assert fields["state"][first + 3] == JOINT_STATES.index("opened")
        assert fields["state"][first + 5] == JOINT_STATES.index("slipped")
        assert set(fields["state"][:first]) == {-1}
        assert_allclose(fields["opening_m"][first + 3], 5e-4, rtol=1e-6)
        assert_allclose(fields["crack_width_m"][first + 5], 3e-4, rtol=1e-6)


class TestVtkhdf:
    def test_a_step_finds_its_own_values_by_its_offsets(self, history, tmp_path):
        write_vtkhdf(history, tmp_path / "small.vtkhdf")
        cells = WallCells(history)
        with h5py.File(tmp_path / "small.vtkhdf") as file:
            root, steps = file["VTKHDF"], file["VTKHDF/Steps"]
            assert root.attrs["Type"] == b"UnstructuredGrid" and steps.attrs["NSteps"] == 21
            assert_array_equal(steps["Values"], history.series.time_s)
            for step in (0, 11, 12, 20):
                at = steps["CellDataOffsets/opening_m"][step]
                assert_array_equal(
                    root["CellData/opening_m"][at : at + len(cells.types)],
                    cells.joint_fields(step)["opening_m"],
                )
                at = steps["PointDataOffsets/displacement_m"][step]
                assert_array_equal(
                    root["PointData/displacement_m"][at : at + len(cells.points)],
                    cells.displacement(cells.snapshot_of[step]),
                )
            assert_array_equal(root["FieldData/DI"], history.index().DI)


# --- VTK's own readers ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def vtk_python():
    with environment("vtk", needs=("numpy",)) as python:
        yield python


@pytest.fixture(scope="module", params=["reference", pytest.param("yade", marks=pytest.mark.yade)])
def shaken(request, tmp_path_factory):
    """A small wall shaken hard, by either solver, and its export."""
    folder = tmp_path_factory.mktemp(request.param)
    wall_file(folder / "small.py", PIER)
    if request.param == "yade":
        request.getfixturevalue("yade_command")
    first = {"reference": (sys.executable, "-m", "damage", "reference"), "yade": COMMAND}[
        request.param
    ]
    run_command(
        *first,
        folder / "small.py",
        "--harmonic",
        0.03,
        1.5,
        "--rest",
        0.1,
        "--no-pictures",
        "--out",
        folder / "small.h5",
        status=0,
    )
    run_command(
        sys.executable,
        "-m",
        "damage",
        "export",
        folder / "small.h5",
        "--vtkhdf",
        folder / "small.vtkhdf",
        status=0,
    )
    return read_history(folder / "small.h5"), folder


@pytest.mark.long
def test_vtk_reads_what_the_history_holds(vtk_python, shaken):
    history, folder = shaken
    sample, n_bodies = len(history.series) // 2, len(history.bodies)
    found = json.loads(run_in(vtk_python, "read_vtk.py", folder / "small.vtkhdf", str(sample)))
    snapshot = WallCells(history).snapshot_of[sample]
    assert found["types"] == {str(HEXAHEDRON): n_bodies, str(LINE): len(history.joints)}
    assert_array_equal(found["times"], history.series.time_s)
    part = np.array(found["cell"]["part"])
    assert np.count_nonzero(part == 0) == np.count_nonzero(history.bodies.course >= 0)
    assert np.max(history.opening_m[sample]) > 1e-5  # there is something to be read
    assert_array_equal(np.array(found["cell"]["opening_m"])[n_bodies:], history.opening_m[sample])
    assert_array_equal(np.array(found["cell"]["offset_m"])[n_bodies:], history.offset_m[sample])
    assert found["field"]["DI"] == [history.index().DI[sample]]
    moved = np.array(found["point"]["displacement_m"])[: 8 * n_bodies].reshape(n_bodies, 8, 3)
    rotation = history.displacement[snapshot, :, 2]
    centres = history.displacement[snapshot, :, :2]
    # The mean over a brick's corners is its centre's, but for float32.
    assert_allclose(
        moved.mean(axis=1)[:, [0, 2]], centres, atol=1e-9 + 1e-6 * np.abs(centres).max()
    )
    assert_allclose(
        np.array(found["cell"]["rotation_rad"])[:n_bodies], rotation, rtol=1e-6, atol=1e-12
    )
