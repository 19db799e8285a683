"""Deformable bricks as cells glued elastically, against beams, waves and the strain modes of the
reference solver."""

import numpy as np
import pytest
from conftest import SHORT, one_line_error, wall_file
from numpy.testing import assert_allclose
from test_deformable import lay

import damage
from damage.law.modes import natural_modes
from damage.measure.energy import energy_error
from damage.measure.summary import summarise
from damage.run.banner import describe_brick
from damage.run.options import parse_run
from damage.run.settings import RunSettings
from damage.wall.file import load_wall
from damage.wall.kinds import CUT
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Opening, Wall

BRICK = Brick()
LENGTH, HEIGHT, THICKNESS = BRICK.length, BRICK.height, BRICK.thickness
CELLS = {"bricks": "deformable", "brick_cells": 4, "contacts": "gauss", "lintel": "none"}


def wall_with_cut_bricks(**brick):
    return Wall("w", 1.53, 0.975, [Opening(0.63, 0.4, 0.6)], brick=Brick(**brick), lintel="courses")


@pytest.mark.parametrize("number", [2, 8])
def test_a_cut_has_the_stiffness_of_the_brick_between_the_centres_of_its_cells(number):
    """Axial E t h / d, bending E t h^3 / (12 d), and half of the shear compliance of G t h / d."""
    layout = lay(1, 1, **(CELLS | {"brick_cells": number}))
    contacts, bodies = layout.contacts, layout.bodies
    cuts = np.flatnonzero(contacts.kind == CUT)
    assert len(bodies) == number and len(cuts) == 2 * (number - 1)
    distance, area = LENGTH / number, HEIGHT * THICKNESS
    for first in range(number - 1):
        of_cut = cuts[2 * first : 2 * first + 2]
        assert_allclose(
            bodies.x[contacts.second[of_cut]] - bodies.x[contacts.first[of_cut]], distance
        )
        normal, shear = (
            (stiffness * contacts.area)[of_cut]
            for stiffness in (contacts.normal_stiffness, contacts.shear_stiffness)
        )
        arm = contacts.z[of_cut] - HEIGHT / 2
        assert_allclose(normal.sum(), BRICK.young_modulus * area / distance)
        assert_allclose(normal @ arm**2, BRICK.young_modulus * area * HEIGHT**2 / 12 / distance)
        assert_allclose(shear.sum(), 2 * BRICK.shear_modulus * area / distance)


@pytest.mark.parametrize("contacts", ["interior", "corners", "gauss"])
def test_cells_are_the_parts_of_their_bricks(contacts):
    wall, options = wall_with_cut_bricks(), ModelOptions(contacts=contacts, lintel="none")
    rigid = lay_out(wall, options)
    cells = lay_out(wall, ModelOptions(**(CELLS | {"contacts": contacts})))
    assert_allclose(
        [cells.total_mass, cells.total_joint_length, cells.drift_height],
        [rigid.total_mass, rigid.total_joint_length, rigid.drift_height],
    )
    bodies, points = cells.bodies, cells.contacts
    assert_allclose(
        bodies.mass[: cells.n_bricks] / bodies.length[: cells.n_bricks], 1900 * HEIGHT * THICKNESS
    )
    assert_allclose(
        bodies.length @ (bodies.x * (bodies.course == 0)),
        rigid.bodies.length @ (rigid.bodies.x * (rigid.bodies.course == 0)),
    )
    for body in (points.first, points.second):
        on = np.flatnonzero(body >= 0)
        inside = np.abs(points.x[on] - bodies.x[body[on]]) <= bodies.length[body[on]] / 2 + 1e-9
        assert inside.all()
    lengths = np.sort(bodies.length[: cells.n_bricks])
    assert lengths[0] >= LENGTH / 8 - 1e-9 and lengths[-1] <= 3 * LENGTH / 8 + 1e-9
    per_brick = np.bincount(points.first[points.kind == CUT])
    assert per_brick.max() == 2  # a cut has two points, a cell one cut on its right


def test_the_middle_of_a_splitting_brick_alone_can_fail():
    layout = lay_out(wall_with_cut_bricks(tensile_strength=1.6e6), ModelOptions(**CELLS))
    contacts = layout.contacts
    weak = (contacts.kind == CUT) & ~contacts.elastic
    whole = lay_out(wall_with_cut_bricks(), ModelOptions()).bodies.length
    assert weak.sum() == 4 * np.isclose(whole[whole < 0.3], LENGTH).sum()
    assert_allclose(contacts.tensile_strength[weak], 0.8 * 1.6e6)
    assert np.isinf(contacts.tensile_strength[(contacts.kind == CUT) & contacts.elastic]).all()


def test_the_first_period_is_near_that_of_strain_modes():
    found = [
        natural_modes(
            lay_out(
                load_wall("walls/symmetric.py"),
                ModelOptions(bricks="deformable", contacts="gauss", brick_cells=cells),
            ),
            1,
        ).period_s[0]
        for cells in (4, 0)
    ]
    assert found == pytest.approx([0.2046, 0.2009], abs=6e-5)


def test_yade_makes_deformable_bricks_of_four_cells():
    from yade_scripts.run import BRICK_CELLS

    settings = parse_run(["--bricks", "deformable"], "test", "yade")
    assert BRICK_CELLS == 4 and settings.for_bricks(BRICK_CELLS).model.brick_cells == 4
    assert settings.for_bricks(0).model.has_modes
    for words, cells in ((["--bricks", "deformable", "--brick-cells", "2"], 2), ([], 0)):
        asked = parse_run(words, "test", "yade")
        assert isinstance(asked, RunSettings) and asked.for_bricks(4).model.brick_cells == cells
    assert describe_brick(BRICK, settings.for_bricks(4).model).endswith(
        ", 4 rigid cells glued elastically, never splitting"
    )
    order = parse_run(["--bricks", "deformable", "--brick-order", "3"], "test", "yade")
    assert "--brick-order = 3 with bricks of glued cells" in one_line_error(order.for_bricks, 4)


@pytest.mark.yade
def test_cells_vibrate_in_yade_as_the_eigenvalue_says(yade_command, tmp_path):
    wall = wall_file(tmp_path / "pier.py", "Wall('pier', 0.3375, 0.3, precompression=0.3e6)")
    yade_command(
        *SHORT,
        wall,
        "--bricks",
        "deformable",
        "--free-vibration",
        "--rest",
        0.1,
        "--out",
        tmp_path / "pier.h5",
        "--no-pictures",
        status=0,
    )
    history = damage.read_history(tmp_path / "pier.h5")
    assert history.model.brick_cells == 4 and len(history.bodies) == 4 * 3 * 2 + 1
    layout = lay_out(load_wall(wall), history.model)
    assert summarise(history)["period_s"] == pytest.approx(
        natural_modes(layout).period_s[0], rel=5e-3
    )
    assert energy_error(history.series) < 5e-3
