"""A wall in larger units is as stiff, heavy and strong."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose

import damage
from damage import Brick, Joint, Opening, Wall
from damage.house.coarser import coarser, in_units
from damage.house.house import House, Placed
from damage.linear.modes import natural_modes
from damage.wall.kinds import BED, HEAD
from damage.wall.layout import lay_out

JOINT = Joint(normal_stiffness=5e10, shear_stiffness=2e10)
PANEL = Wall("panel", 2.64, 2.7, brick=Brick(0.22, 0.075), joint=JOINT)
DOOR = replace(PANEL, openings=(Opening(0.88, 0.88, 2.25),))


def compliance(layout, kind, name):
    """Of joints of whole units within the wall [m3/N]."""
    contacts, length = layout.contacts, layout.bodies.length
    whole = (contacts.kind == kind) & (contacts.first >= 0)
    whole &= length[contacts.first] + length[contacts.second] > 2 * length[0] - 1e-9
    return 1 / np.unique(getattr(contacts, name)[whole])


@pytest.mark.parametrize("units", [(2, 2), (2, 3), (3, 2)])
def test_rows_and_stacks_keep_their_compliance(units):
    fine, coarse = lay_out(PANEL), lay_out(coarser(PANEL, *units))
    for name in ("normal_stiffness", "shear_stiffness"):
        for kind, number in zip((HEAD, BED), units):
            given, made = (compliance(one, kind, name) for one in (fine, coarse))
            assert len(made) == len(given) == 1
            assert_allclose(made, number * given, rtol=1e-6)  # stiffnesses have fewer bits
    assert_allclose(coarse.total_mass, fine.total_mass)
    periods = [natural_modes(one, 1).period_s[0] for one in (fine, coarse)]
    assert_allclose(periods[1], periods[0], rtol=0.05)


def test_courses_fill_the_height_and_an_arch_stays_as_high():
    wall = replace(DOOR, height=2.775, openings=(replace(DOOR.openings[0], lintel="arch"),))
    coarse = coarser(wall, 2, 3)
    assert coarse.courses == 12
    assert_allclose(coarse.built_height, 2.775)
    (before,), (after,) = (lay_out(one).plan.lintels for one in (wall, coarse))
    assert (before.above - before.first, after.above - after.first) == (3, 1)


def test_a_run_keeps_its_units_and_a_house_has_them_in_each_wall(tmp_path):
    history = damage.run(PANEL, free_vibration=True, rest=0.002, units=(3, 4))
    assert history.masonry_wall == coarser(PANEL, 3, 4)
    assert history.parameters["units"] == [3, 4]
    assert lay_out(history.masonry_wall, history.model).n_bricks == history.plan.n_bricks
    found = in_units(House("house", (Placed(PANEL), Placed(replace(PANEL, name="b")))), (2, 3))
    assert [one.wall.brick.length for one in found.walls] == [0.44, 0.44]


def test_what_cannot_be_built_is_refused_with_its_place():
    refused_with(
        "units of 0.22 x 0.225 m: no normal stiffness.* longer than high", coarser, PANEL, 1, 3
    )
    pier = replace(DOOR, openings=(Opening(0.3, 0.5, 1.2),))
    refused_with(
        r"in units of 0.88.*opening 1 \(x 0.3 to.*half a brick \(0.44 m\)", coarser, pier, 4, 4
    )
    bare = replace(DOOR, lintel="courses")
    refused_with("opening 1 .*one course above it.* a lintel", coarser, bare, 6, 6)
