"""Histories as VTKHDF: the layout of one made by hand, and what VTK's readers make of it (long)."""

import json

import h5py
import numpy as np
import pytest
from environments import environment, run_in
from numpy.testing import assert_allclose, assert_array_equal
from small_history import make_history, small_layout

from damage.applications.report.vtkhdf import HEXAHEDRON, LINE, Cells, write_vtkhdf
from damage.history.moments import JOINT_STATES

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
        cells = Cells(history)
        brick = history.masonry_wall.brick
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
        cells = Cells(history)
        joints = history.joints
        ends = cells.points[8 * len(history.bodies) :].reshape(-1, 2, 3)
        assert_allclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1), joints.length_m)
        assert np.all(ends[..., 1] == -history.masonry_wall.brick.thickness / 2)

    def test_corners_turn_with_their_brick(self, history):
        cells = Cells(history)
        last = int(np.flatnonzero(history.bodies.course >= 0)[-1])
        moved = cells.displacement(1)[8 * last : 8 * last + 8]
        corner = cells.points[8 * last + 2] - np.mean(cells.points[8 * last : 8 * last + 8], axis=0)
        x = corner[0]
        z = corner[2]
        there = (2e-3 + np.cos(TURN) * x - np.sin(TURN) * z, np.sin(TURN) * x + np.cos(TURN) * z)
        assert_allclose(moved[2], (there[0] - x, 0.0, there[1] - z), rtol=1e-5)
        assert_allclose(cells.rotation(1)[last], TURN, rtol=1e-6)
        assert np.all(cells.displacement(0) == 0) and np.all(cells.displacement(None) == 0)

    def test_joints_have_their_state_and_bodies_have_none(self, history):
        fields = Cells(history).joint_fields(15)
        first = len(history.bodies)
        assert fields["state"][first + 3] == JOINT_STATES.index("opened")
        assert fields["state"][first + 5] == JOINT_STATES.index("slipped")
        assert set(fields["state"][:first]) == {-1}
        assert_allclose(fields["opening_m"][first + 3], 5e-4, rtol=1e-6)
        assert_allclose(fields["crack_width_m"][first + 5], 3e-4, rtol=1e-6)


class TestVtkhdf:
    def test_a_step_finds_its_own_values_by_its_offsets(self, history, tmp_path):
        write_vtkhdf(history, tmp_path / "small.vtkhdf")
        cells = Cells(history)
        with h5py.File(tmp_path / "small.vtkhdf") as file:
            root = file["VTKHDF"]
            steps = file["VTKHDF/Steps"]
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


@pytest.mark.long
def test_vtk_reads_what_the_history_holds(vtk_python, history, tmp_path):
    path = tmp_path / "small.vtkhdf"
    write_vtkhdf(history, path)
    sample = 15
    cells = Cells(history)
    found = json.loads(run_in(vtk_python, "read_vtk.py", path, str(sample)))
    n_bodies = len(history.bodies)
    n_joints = len(history.joints)
    assert found["types"] == {str(HEXAHEDRON): n_bodies, str(LINE): n_joints}
    assert_array_equal(found["times"], history.series.time_s)
    assert found["field"]["DI"] == [history.index().DI[sample]]
    assert_array_equal(found["cell"]["opening_m"], cells.joint_fields(sample)["opening_m"])
    moved = cells.displacement(cells.snapshot_of[sample])
    assert_array_equal(found["point"]["displacement_m"], moved)
