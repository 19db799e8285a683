"""Geometry: lengths, bond, cells, masses, lintels, walls in larger units."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose
from pytest import approx

from damage import Brick, Joint, ModelOptions, Opening, Wall, run
from damage.house.coarser import coarser, in_units
from damage.house.house import House, Placed
from damage.linear.modes import natural_modes
from damage.wall.kinds import BED, CAP, GROUND, HEAD
from damage.wall.layout import lay_out

BRICK = 0.225

EVERY_OPTION = [
    ModelOptions(),
    ModelOptions(lintel="none", contacts="corners"),
    ModelOptions(top="uniform", cells=3),
    ModelOptions(top="beam", cells=3, contacts="corners"),
    ModelOptions(cells=4, contacts="gauss"),
]

# Walls whose openings ask for cut bricks, for windows, for several openings.
ODD_WALLS = [
    Wall("odd-length", 2.3, 0.6),
    Wall("cut-pier", 4.0, 1.2, (Opening(1.03, 2.0, 0.75),), lintel="courses"),
    Wall("sliver", 3.0, 0.9, (Opening(0.9 + 0.03, 1.0, 0.45, 0.15),), lintel="courses"),
    Wall(
        "two-windows",
        5.0,
        2.7,
        (Opening(0.7, 0.9, 1.2, 0.9), Opening(2.31, 1.0, 1.2, 0.9)),
        lintel="courses",
    ),
    Wall(
        "storeys",
        4.05,
        3.0,
        (Opening(1.0, 1.0, 0.9, 0.3), Opening(1.2, 1.0, 0.9, 1.8)),
        lintel="courses",
    ),
]


@pytest.mark.parametrize("options", EVERY_OPTION, ids=str)
def test_joint_length_is_the_settled_one_under_every_option(shipped_wall, options):
    """Joint length of the solid wall by hand: 37 bed joints with the base's, and 17 or 18 head
    joints in a course of whole or half start."""
    by_hand = 37 * 4.05 + (19 * 17 + 18 * 18) * 0.075
    expected = by_hand if shipped_wall.name == "solid" else 106.05
    assert_allclose(lay_out(shipped_wall, options).total_joint_length, expected, rtol=1e-12)


STOREYS = Wall(
    "door-below-window",
    4.0,
    5.4,
    (Opening(0.5, 1.5, 2.1), Opening(2.5, 1.0, 1.2, 3.0)),
    precompression=1e5,
)


@pytest.mark.parametrize(
    ("wall", "piers"),
    [
        (STOREYS, [(0.0, 2.5), (3.5, 4.0)]),  # above the door is a whole storey
        (
            Wall("low-window", 4.0, 5.4, (Opening(0.5, 1.5, 2.1), Opening(2.5, 1.0, 1.5, 2.1))),
            [(0.0, 0.5), (2.0, 2.5), (3.5, 4.0)],
        ),
        (Wall("door-in-tall-wall", 4.0, 5.4, (Opening(0.5, 1.5, 2.1),)), [(0.0, 0.5), (2.0, 4.0)]),
        (
            Wall("stacked", 4.0, 5.4, (Opening(0.5, 1.5, 2.1), Opening(0.6, 1.5, 1.2, 3.0))),
            [(0.0, 0.6), (2.1, 4.0)],
        ),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_the_top_storeys_piers_carry_the_top(wall, piers):
    layout = lay_out(wall)
    assert_allclose(layout.plan.piers, piers, atol=1e-12)
    caps = slice(layout.n_below_caps, None)
    assert_allclose(layout.bodies.x[caps], np.mean(piers, axis=1))
    assert_allclose(layout.bodies.length[caps], np.diff(piers).ravel())
    carried = layout.bodies.mass[caps] * 9.81 / (layout.bodies.length[caps] * 0.1025)
    assert_allclose(carried, wall.precompression * wall.length / np.diff(piers).sum())
    assert layout.pier_stress == approx(carried[0])


def test_inertia_is_that_of_points_of_mass_all_over_the_brick(symmetric_wall):
    """Midpoints of 400 x 400 parts: what is missing is a part's own inertia, 1 / 400^2 of the
    brick's."""
    layout = lay_out(symmetric_wall)
    square = np.mean(((np.arange(400) + 0.5) / 400 - 0.5) ** 2)
    length, height, mass, inertia = (
        getattr(layout.bodies, name)[: layout.n_bricks]
        for name in ("length", "height", "mass", "inertia")
    )
    assert_allclose(inertia, mass * square * (length**2 + height**2), rtol=1e-5)


@pytest.mark.parametrize("top", ["piers", "uniform", "beam"])
def test_the_load_on_piers_is_the_precompression_in_them(symmetric_wall, top):
    on_length, on_piers = (
        lay_out(symmetric_wall, ModelOptions(top=top, load=load)) for load in ("length", "piers")
    )
    assert (on_length.pier_stress, on_piers.pier_stress) == (
        approx(0.6e6),
        approx(0.3e6),
    )
    bricks = sum(lay_out(Wall(**{**vars(symmetric_wall), "precompression": 0.0})).bodies.mass)
    area = 2 * 4.5 * BRICK * 0.1025  # of the piers, half of the wall's
    assert_allclose((on_piers.total_mass - bricks) * 9.81, 0.3e6 * area, rtol=2.0**-25)
    assert_allclose((on_length.total_mass - bricks) * 9.81, 0.6e6 * area, rtol=2.0**-25)


def test_a_cap_on_half_a_brick_stands_on_two_points():
    wall = Wall("half", 2.025, 1.2, (Opening(BRICK / 2, 0.9, 0.75),))
    layout = lay_out(wall, ModelOptions(contacts="corners"))
    under = (layout.contacts.kind == CAP) & (layout.contacts.second == layout.n_below_caps)
    assert_allclose(layout.contacts.x[under], [0.0, BRICK / 2])
    assert_allclose(layout.contacts.length[under], BRICK / 4)


@pytest.mark.parametrize("wall", ODD_WALLS, ids=lambda w: w.name)
class TestOddWall:
    """What they cover, and how: `test_any_wall.py`."""

    def test_no_brick_is_longer_than_a_whole_one_or_shorter_than_a_quarter(self, wall):
        length = lay_out(wall).bodies.length[: lay_out(wall).n_bricks]
        assert length.min() > BRICK / 4 - 1e-6
        assert length.max() < BRICK * 1.25 + 1e-6

    def test_cells_face_each_other(self, wall):
        """Half a contact point's length beside it lies on both bodies."""
        layout = lay_out(wall)
        bodies = layout.bodies
        contacts = layout.contacts
        flat = ~contacts.upright
        for place, size, of in ((bodies.x, bodies.length, flat), (bodies.z, bodies.height, ~flat)):
            middle = np.where(flat, contacts.x, contacts.z)[of]
            half = contacts.length[of] / 2
            for body in (contacts.first[of], contacts.second[of]):
                moves = body >= 0
                away = np.abs(middle - place[body]) + half
                assert np.all(away[moves] < size[body][moves] / 2 + 1e-7)

    def test_head_joints_of_neighbouring_courses_are_not_in_line(self, wall):
        contacts = lay_out(wall).contacts
        heads = contacts.kind == HEAD
        x = contacts.x[heads]
        z = contacts.z[heads]
        neighbours = np.isclose(np.abs(z[:, None] - z), 0.075)
        assert np.abs(x[:, None] - x)[neighbours].min() > BRICK / 8


@pytest.mark.parametrize("contacts", ["interior", "corners", "gauss"])
def test_a_lintel_of_n_courses_holds_their_joints_and_the_beds_between_them(
    symmetric_wall, contacts
):
    # a brick of a bed has four points with either
    per_head = {"interior": 1, "corners": 2, "gauss": 2}[contacts]
    for courses, beds, heads in (
        (0, 0, 0),
        (1, 0, 10),
        (2, 44, 21),
        (3, 88, 31),
        (4, 132, 42),
        (99, 132, 42),
    ):
        layout = lay_out(symmetric_wall, ModelOptions(lintel=courses, contacts=contacts))
        inside = layout.contacts.elastic & (layout.contacts.kind != CAP)
        kind = layout.contacts.kind[inside]
        # The courses over the opening have 10 and 11 head joints between the ends of the bearing,
        # in turns.
        assert (np.sum(kind == BED), np.sum(kind == HEAD)) == (beds, heads * per_head)
        top = (33 + min(courses, 4)) * 0.075
        assert np.all(layout.contacts.z[inside] < top + 1e-9)
        assert np.all(layout.contacts.z[inside & (layout.contacts.kind == BED)] < top - 1e-9)


def test_a_lintel_ends_below_the_next_opening_whatever_is_asked_for():
    wall = ODD_WALLS[-1]
    elastic, many = (
        lay_out(wall, ModelOptions(lintel=lintel)).contacts.elastic for lintel in ("elastic", 8)
    )
    # Eight courses from z = 1.2 reach the sill at 1.8, and four of them from 2.7 the top at 3.0.
    assert np.array_equal(elastic, many)
    few = lay_out(wall, ModelOptions(lintel=2)).contacts
    heights = few.z[few.elastic & (few.kind == BED)]
    assert_allclose(np.unique(np.round(heights, 6)), [1.275, 2.775])


def test_effective_stiffness_of_bed_head_and_base(symmetric_wall):
    contacts = lay_out(symmetric_wall).contacts
    base = contacts.first == GROUND
    for kind, normal, shear in ((BED, 6.56e10, 2.69e10), (HEAD, 2.27e10, 0.94e10)):
        inner = (contacts.kind == kind) & ~base
        # Head joints beside half bricks are stiffer; the settled values are whole against whole.
        assert_allclose(contacts.normal_stiffness[inner].min(), normal, rtol=2e-3)
        assert_allclose(contacts.shear_stiffness[inner].min(), shear, rtol=5e-3)
    assert_allclose(
        contacts.normal_stiffness[base], 1 / (1 / 12e11 + 0.0375 / 5.2e9), rtol=2.0**-26
    )


@pytest.mark.parametrize(
    "scattered",
    [
        lambda wall, seed: lay_out(wall, ModelOptions(strength_cov=0.4, strength_seed=seed)),
        lambda wall, seed: lay_out(wall, scatter=0.4, seed=seed),
    ],
    ids=["the wall's own", "of a member"],
)
def test_scattered_strengths_are_lognormal_of_mean_one_joint_by_joint(scattered):
    wall = Wall("big", 9.0, 6.0)
    samples = []
    for seed in range(5):
        layout = scattered(wall, seed)
        contacts = layout.contacts
        factor = contacts.tensile_strength[: layout.n_joints] / wall.joint.tensile_strength
        assert_allclose(contacts.cohesion[: layout.n_joints] / wall.joint.cohesion, factor)
        joints = {}
        for pair, value in zip(zip(contacts.first, contacts.second), factor):
            assert joints.setdefault(pair, value) == value
        samples += joints.values()
    logs = np.log(samples)
    assert_allclose(np.std(logs), np.sqrt(np.log(1.16)), rtol=3e-2)
    assert_allclose(np.mean(samples), 1.0, atol=4 * 0.4 / np.sqrt(len(samples)))


def test_scattered_strengths_do_not_depend_on_the_placing_of_contact_points():
    found = []
    for options in ({}, {"cells": 3}, {"contacts": "corners"}):
        layout = lay_out(
            Wall("small", 0.9, 0.45), ModelOptions(strength_cov=0.3, strength_seed=7, **options)
        )
        contacts = layout.contacts
        found.append(
            {
                (a, b): s
                for a, b, s in zip(contacts.first, contacts.second, contacts.tensile_strength)
            }
        )
    assert found[0] == found[1] == found[2]
    assert np.all(np.isinf(contacts.tensile_strength[contacts.kind == CAP]))


@pytest.mark.parametrize("brick", [Brick(), Brick(tensile_strength=2e6)])
def test_what_members_share_is_laid_out_once_and_is_of_each_its_own(brick, monkeypatch):
    """Bit by bit as if it were laid out anew, whatever is done to one that was laid out before."""

    def laid_out(seed, **options):
        layout = lay_out(
            Wall("members", 1.8, 0.9, brick=brick),
            ModelOptions(strength_cov=0.3, strength_seed=seed, **options),
            scatter=0.1,
            seed=seed,
        )
        return [
            *vars(layout.bodies).values(),
            *vars(layout.contacts).values(),
            layout.drift_bodies,
        ], layout

    first, _ = laid_out(1)
    wanted = [array.tobytes() for array in first]
    for array in first:
        array[:] = 0
    with monkeypatch.context() as done:
        done.setattr("damage.wall.layout.plan_of", None)  # what lays out anew would call it
        other, layout = laid_out(2)
        assert [array.tobytes() for array in laid_out(1)[0]] == wanted
    differ = [a.tobytes() != b for a, b in zip(other, wanted)]
    assert sum(differ) == 2 and layout.options.strength_seed == 2  # tensile strength and cohesion
    assert len(laid_out(1, cells=3)[1].contacts) > len(layout.contacts)


# --- larger units ---------------------------------------------------------------------------------

JOINT = Joint(normal_stiffness=5e10, shear_stiffness=2e10)
PANEL = Wall("panel", 2.64, 2.7, brick=Brick(0.22, 0.075), joint=JOINT)
DOOR = replace(PANEL, openings=(Opening(0.88, 0.88, 2.25),))


def compliance(layout, kind, name):
    """Compliance of joints of whole units within the wall [m3/N]."""
    contacts = layout.contacts
    length = layout.bodies.length
    whole = (contacts.kind == kind) & (contacts.first >= 0)
    whole &= length[contacts.first] + length[contacts.second] > 2 * length[0] - 1e-9
    return 1 / np.unique(getattr(contacts, name)[whole])


@pytest.mark.parametrize("units", [(2, 2), (2, 3), (3, 2)])
def test_rows_and_stacks_keep_their_compliance(units):
    fine = lay_out(PANEL)
    coarse = lay_out(coarser(PANEL, *units))
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
    history = run(PANEL, free_vibration=True, rest=0.002, units=(3, 4))
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
