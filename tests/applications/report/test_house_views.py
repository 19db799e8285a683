"""Measures, places in space and pictures of a house whose history is made by hand."""

import json
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, written
from matplotlib.colors import to_rgb
from numpy.testing import assert_allclose
from small_history import make_history

from damage.applications.report.vtkhdf import Cells
from damage.applications.studies.definition import load_study
from damage.applications.studies.inputs import inputs_of
from damage.applications.studies.read import read_table
from damage.applications.studies.records import NAME, line_of, record_of
from damage.applications.studies.tables import write_study_tables
from damage.draw import style
from damage.draw.house import PICTURES, Eye, Perspective, elevation_picture
from damage.draw.run import JOINT_COLOURS
from damage.draw.style import new_figure
from damage.history.in_space import InSpace
from damage.history.reader import read_history
from damage.house.house import Corner, House, Placed, read_house
from damage.house.layout import lay_out_house
from damage.measure.house import corner_joints, corners_table, walls_table
from damage.measure.summary import summarise
from damage.measure.tables import summary_table, write_run_tables
from damage.wall.kinds import SLAB_COURSE
from damage.wall.parameters import Brick, Wall

BRICKS = {"height": 0.4, "precompression": 0, "brick": Brick(0.4, 0.2, 0.2)}
"""Walls of two courses."""


def layout():
    """A front along x, and a side wall along y that is toothed into its left end: outside is at -y
    of the front, and at +y of the side wall, which is towards -x of the house."""
    front = Wall("front", 1.2, **BRICKS)
    side = Wall("side", 1.2, base_course="half", **BRICKS)
    placed = Placed(front), Placed(side, (0.1, -0.1), 90)
    return lay_out_house(House("small", placed, [Corner(("front", "side"), "toothed")]))


@pytest.fixture(scope="module")
def house(tmp_path_factory):
    """A crack of 1 mm outside the front and of 0.25 mm inside, 0.5 mm between the walls; the front
    moves by 4 mm across it."""
    lay = layout()
    of_front = np.flatnonzero(lay.contacts.wall[: lay.n_joints] == 0)
    between = np.flatnonzero(lay.contacts.wall[: lay.n_joints] == -1)
    outside, _, inside = of_front[:3]  # from -y to +y
    motion = np.zeros((len(lay.bodies), 6))
    motion[lay.bodies.wall == 0, 3] = 0.004
    return make_history(
        tmp_path_factory.mktemp("house") / "house.h5",
        lay,
        opening={outside: 1e-3, inside: 0.25e-3, between[0]: 0.5e-3},
        snapshots={0.0: motion},
        house={"top_across_m": [0.004, 0], "across_m": [0.004, 0]},
    )


def test_each_face_has_its_own_cracks_and_psi(house):
    front, side = map(summarise, house.parts)
    assert_allclose([front["max_psi_outside"], front["max_crack_width_outside_mm"]], [2, 1])
    assert_allclose(front["max_psi_inside"], 2 * 0.25**0.3)
    assert_allclose(front["max_psi"], 2 * ((1 + 0.25**2) / (1 + 0.25)) ** 0.3)  # c_w of one crack
    assert side["max_psi_outside"] == side["max_psi_inside"] == 0
    height = house.parts[0].attributes["drift_height_m"]
    assert_allclose(front["max_drift_across_ratio"], 0.004 / height)
    assert_allclose(front["max_across_mm"], 4)
    assert front["evidence"]["corners with other walls"]["value"] == 1
    assert front["evidence"]["drift across the wall"]["inside"] is False


def test_a_face_is_read_as_a_plane_wall(house):
    name = house.path.with_name("house:front:outside.h5")
    face = read_history(name)
    assert face.path == name
    assert_allclose(face.opening_m[-1].max(), 1e-3)
    assert_allclose(face.joint_length_m.sum(), house.parts[0].joint_length_m.sum())
    assert summarise(face)["max_psi_outside"] is None


def test_corners_open_by_themselves(house):
    table = corners_table(house)
    assert list(table["corner"].unique()) == ["front / side"]
    assert_allclose(table["opening_m"].max(), 0.5e-3)
    (joints,) = corner_joints(house).values()
    assert_allclose(table["failed_share"].iloc[-1], 1 / len(joints))
    walls = walls_table(house)
    assert list(walls["wall"].unique()) == ["front", "side"]
    assert_allclose(walls["psi_outside"].max(), 2)


def test_index_tables_and_summary_have_all_walls(house, tmp_path, output_of):
    found = json.loads(output_of("index", house.path, "--json"))
    assert list(found["walls"]) == ["front", "side"]
    assert_allclose(found["corners"]["front / side"]["max_opening_mm"], 0.5)
    names = {path.name for path in write_run_tables(house, tmp_path / "run")}
    assert {"run_walls.csv", "run_corners.csv", "run_front_joints.csv"} <= names
    assert list(summary_table([house.path])["wall"]) == ["front", "side"]


def test_a_study_has_a_row_for_each_wall_of_a_house(house, tmp_path):
    text = 'name = "s"\n[[runs]]\nid = "a"\nwall = "houses/box.toml"\n'
    file = written(tmp_path / "s.toml", text)
    study = load_study(file, "yade", REPOSITORY)
    assert inputs_of(study.runs[0], REPOSITORY).wall == read_house(REPOSITORY / "houses/box.toml")
    (tmp_path / NAME).write_text(line_of(record_of(house, "a_yade", "a")))
    write_study_tables(study, tmp_path)
    for name in ("summary", "points"):
        table = read_table(tmp_path / f"tables/{name}.csv")
        assert list(table["point"]) == ["a:front", "a:side"]
        assert list(table["wall"]) == ["small:front", "small:side"]
    assert_allclose(read_table(tmp_path / "tables/summary.csv")["max_psi_outside"], [2, 0])
    (run,) = load_study(file, "reference", REPOSITORY).runs
    assert "house box with the reference solver" in one_line_error(inputs_of, run, REPOSITORY)


def test_bodies_move_in_space_as_rigid_boxes(tmp_path):
    """The side wall stands along y: across it is -x; a turn about its length is one about y."""
    lay = layout()
    turn = 0.3
    motion = np.zeros((len(lay.bodies), 6))
    motion[lay.bodies.wall == 1, 3:5] = 0.01, turn
    space = InSpace(make_history(tmp_path / "a.h5", lay, snapshots={0.0: motion}))
    rest = space.boxes
    now = space.corners(0)
    of = lay.bodies.wall == 1
    assert_allclose(now[~of], rest[~of], atol=1e-15)
    assert_allclose(rest[of][:, 1, 1] - rest[of][:, 0, 1], lay.bodies.length[of])
    centre = rest[of].mean(axis=1, keepdims=True)
    about_y = np.array(
        [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    )
    assert_allclose(now[of], centre + (rest[of] - centre) @ about_y.T - [0.01, 0, 0], atol=1e-7)
    faces = lay.contacts.wall[: lay.n_joints] == 1
    assert_allclose(
        np.abs(space.joint_ends[faces][..., 0] - 0.1).max(), 0.1
    )  # its thickness is 0.2


def test_a_concrete_floor_is_a_box_over_its_walls(tmp_path):
    lay = lay_out_house(read_house(REPOSITORY / "houses/terraced.toml"))
    (slab,) = np.flatnonzero(lay.bodies.course == SLAB_COURSE)
    box = InSpace(make_history(tmp_path / "a.h5", lay, stages=("motion",))).boxes[slab]
    half = lay.wall.brick.thickness / 2  # front and back are 4.75 m apart, 4.5 m long
    assert_allclose(box.min(axis=0), [0, -half, 2.25], atol=1e-9)
    assert_allclose(box.max(axis=0), [4.5, 4.75 + half, 2.5], atol=1e-9)


def test_paraview_has_the_boxes_and_where_they_go(house):
    cells = Cells(house)
    space = InSpace(house)
    n = 8 * len(house.bodies)
    assert_allclose(cells.points[:n], space.boxes.reshape(-1, 3))
    moved = cells.displacement(0)[:n].reshape(-1, 8, 3)
    across = np.where(house.house.body_wall == 0, 0.004, 0.0)  # the front alone moves
    assert_allclose(moved, across[:, None, None] * [0, 1, 0] + 0 * moved, atol=1e-7)
    joint = np.flatnonzero(house.house.joint_wall == 0)[0]  # on the ground: half of its brick's way
    assert_allclose(cells.displacement(0)[n + 2 * joint], [0, 0.002, 0], atol=1e-7)
    assert cells.numbers["DI_front"].max() > 0 == cells.numbers["DI_side"].max()


def _are_opened(collection):
    """Which of the polygons of a picture are cracks that opened."""
    away = collection.get_facecolor()[:, :3] - to_rgb(JOINT_COLOURS["opened"])
    return np.abs(away).max(axis=1) < 1e-6


def test_unfolded_walls_show_the_crack_of_each_face(house):
    figure = elevation_picture(house, magnify=0)
    assert [ax.xaxis_inverted() for ax in figure.axes] == [False, True, True, False]
    drawn = [ax.collections[0] for ax in figure.axes]
    opened = [np.array(one.get_linewidths())[_are_opened(one)] for one in drawn]
    assert list(map(len, opened)) == [2, 1, 2, 1]  # its own, and the corner's, which both have
    assert max(opened[0]) > max(opened[2]) > 0


def test_one_sees_the_cracks_of_faces_that_look_at_the_eye(house):
    def cracks(azimuth):
        seen = Perspective(new_figure(3)[1], house)
        seen.show(0, 0, 1.0, azimuth)
        return _are_opened(seen.drawn).sum()

    assert [cracks(azimuth) for azimuth in (-90, 90)] == [1, 1]
    eye = Eye(-90, np.array([0.5, 0.0, 0.4]), 1.0)
    assert_allclose(eye.project(eye.middle), 0, atol=1e-12)
    right, near = eye.project(eye.middle + np.array([[0.1, 0, 0], [0.1, -0.5, 0]]))
    assert_allclose(right, [0.1, 0], atol=1e-12)
    assert near[0] > 0.1  # what is nearer is larger


def test_pictures_films_reports_and_paraview_take_a_house(house, tmp_path, output_of, monkeypatch):
    monkeypatch.setattr(style, "FORMATS", ("png",))
    drawn = output_of("plot", house.path, "--out", tmp_path).split()
    assert {Path(one).stem for one in drawn} == set(PICTURES)
    output_of("draw", REPOSITORY / "houses/box.toml", "--out", tmp_path / "a.svg")
    output_of("animate", house.path, "--out", tmp_path / "a.gif")
    output_of("export", house.path, "--vtkhdf", tmp_path / "a.vtkhdf")
    output_of("report", house.path, "--out", tmp_path / "a.html")
    assert "front / side" in (tmp_path / "a.html").read_text(encoding="utf-8")
