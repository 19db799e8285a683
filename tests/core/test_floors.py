"""Floors: masses on courses and slabs that tie piers, reactions, periods; a push of several floors,
whose forces keep their ratio, in the elastic range and as a column rocks past its peak."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from damage import Brick, Floor, Joint, ModelOptions, Opening, Wall, run
from damage.applications.cracks.capacity import cycle_edges
from damage.linear.modes import natural_modes, static_displacement
from damage.measure.damage_index import storey_drifts, storeys_table
from damage.measure.energy import energy_error_of
from damage.measure.tables import write_run_tables
from damage.units import GRAVITY
from damage.wall.as_built import describe_floors
from damage.wall.kinds import BED, CAP, HEAD, SLAB_COURSE
from damage.wall.layout import lay_out
from damage.wall.plan import plan_of
from verification.elastic import running_bond
from verification.limit_analysis import kinematic_matrix

BRICK = Brick(length=0.2, height=0.1, thickness=0.1, density=2000.0)
TIMBER = Floor(1.0, 800.0, 0.4, 1.6)
SLAB = Floor(2.0, 1500.0, kind="concrete", depth=0.2)
DOOR = (Opening(0.8, 0.6, 1.6),)
LOW_DOOR = (Opening(0.8, 0.6, 0.7),)
HIGHER_DOOR = (Opening(0.8, 0.6, 0.8),)


def wall(*floors, length=2.0, height=2.4, openings=(), **more):
    return Wall(
        "w",
        length,
        height,
        openings,
        precompression=0.0,
        brick=BRICK,
        floors=floors,
        **{"lintel": "courses", **more},
    )


def base_reaction(layout):
    """Vertical force [N] and its moment about x = 0 [N m] on the base, of the intact wall at
    rest."""
    contacts = layout.contacts
    opening = kinematic_matrix(layout, 0) @ static_displacement(layout).ravel()
    force = -contacts.normal_stiffness * contacts.area * opening
    base = contacts.first < 0
    return force[base].sum(), (force[base] * contacts.x[base]).sum()


@pytest.mark.parametrize(
    ("floors", "more"),
    [
        ((TIMBER, SLAB), {}),
        ((Floor(2.4, 500.0, 1.0),), {}),
        ((TIMBER, SLAB), {"openings": LOW_DOOR}),
        ((Floor(0.9, 500.0, 1.0, 1.8),), {"openings": HIGHER_DOOR, "lintel": "concrete"}),
    ],
    ids=["both", "timber", "door", "on a lintel"],
)
def test_reactions_carry_every_floor_where_it_rests(floors, more):
    """The weight, and its moment by the middles of the floors, beside those of the wall
    with floors of 1 kg."""
    layout, light = (
        lay_out(wall(*those, **more), ModelOptions(contacts="gauss"))
        for those in (floors, [replace(floor, mass=1.0) for floor in floors])
    )
    spans = [(floor.mass - 1.0, *floor.span(layout.wall)) for floor in floors]
    weight = GRAVITY * (light.total_mass + sum(mass for mass, _, _ in spans))
    moment = GRAVITY * (
        light.bodies.mass @ light.bodies.x
        + sum(mass * (left + right) / 2 for mass, left, right in spans)
    )
    assert_allclose(base_reaction(layout), (weight, moment), rtol=2.0**-26)


def test_a_timber_floor_is_mass_on_the_course_below_it():
    bare, laden = (lay_out(wall(*floors)) for floors in ((), (TIMBER,)))
    more = laden.bodies.mass - bare.bodies.mass
    assert_allclose(more.sum(), 800.0)
    on = bare.bodies.course == 9
    left = bare.bodies.x - bare.bodies.length / 2
    right = bare.bodies.x + bare.bodies.length / 2
    covered = np.maximum(np.minimum(right, 1.6) - np.maximum(left, 0.4), 0.0) * on
    assert_allclose(more, 800.0 * covered / 1.2, atol=1e-9)  # as long a half of a brick at each end
    assert_allclose(
        laden.bodies.inertia / laden.bodies.mass, bare.bodies.inertia / bare.bodies.mass
    )
    assert laden.total_joint_length == bare.total_joint_length


def test_a_timber_floor_beside_an_opening_rests_on_what_is_there():
    """0.4 m left and 0.2 m right of the door: the resultant is at (0.4 x 0.6 + 0.2 x 1.5) / 0.6
    m."""
    bare, laden = (lay_out(wall(*floors, openings=DOOR)) for floors in ((), (TIMBER,)))
    more = laden.bodies.mass - bare.bodies.mass
    assert more.min() >= 0
    assert_allclose((more.sum(), more @ bare.bodies.x), (800.0, 800.0 * 0.9))


def test_a_slab_takes_the_place_of_courses_and_is_joined_above_and_below():
    """Two courses of 2 m go, with two and a half bed joints' worth of heads; the slab has one bed
    below, one above."""
    bare, layout = (lay_out(wall(*floors)) for floors in ((), (SLAB,)))
    slab = layout.n_bricks
    assert len(layout.plan.slabs) == 1 and len(layout.bodies) == slab + 1
    assert layout.n_bricks == bare.n_bricks - (10 + 11)
    assert_allclose(
        [layout.bodies.z[slab], layout.bodies.height[slab], layout.bodies.mass[slab]],
        [1.9, 0.2, 1500.0],
    )
    contacts = layout.contacts
    beside = (contacts.first == slab) | (contacts.second == slab)
    assert (
        set(contacts.kind[beside]) == {BED} and HEAD in contacts.kind and CAP not in contacts.kind
    )
    assert_allclose(contacts.length[contacts.first == slab].sum(), 2.0)
    assert_allclose(contacts.length[contacts.second == slab].sum(), 2.0)
    assert_allclose(layout.total_joint_length, bare.total_joint_length - 2.0 - 0.1 * (9 + 10))


def test_two_storeys_have_the_periods_of_a_shear_cantilever():
    """Light storeys ten times as long as high, between heavy slabs: two masses on two springs k = G
    A / h, G of the running bond (verification/elastic.py), h with all twelve bed joints of a storey
    of eleven courses."""
    length = 12.0
    storey = 1.2
    mass = 40e3
    depth = 0.1
    brick = Brick(length=0.2, height=0.1, thickness=0.1, density=20.0)
    joint = Joint()
    _, shear = running_bond(brick, joint)
    spring = shear * length * brick.thickness / storey
    squares, vectors = eigh([[2 * spring, -spring], [-spring, spring]], mass * np.eye(2))
    floors = [Floor(level, mass, kind="concrete", depth=depth) for level in (storey, 2 * storey)]
    layout = lay_out(
        Wall("w", length, 2 * storey, precompression=0.0, brick=brick, joint=joint, floors=floors),
        ModelOptions(contacts="gauss"),
    )
    modes = natural_modes(layout, 8)
    bodies = layout.bodies
    for square, vector in zip(squares, vectors.T):
        sway = np.interp(
            bodies.z, (0.0, storey - depth / 2, 2 * storey - depth / 2), (0.0, *vector)
        )
        alike = [
            (bodies.mass * sway @ shape[:, 0]) ** 2
            / (bodies.mass @ sway**2)
            # modal assurance
            / np.sum(bodies.mass[:, None] * shape[:, :2] ** 2)
            for shape in modes.shape
        ]
        assert max(alike) > 0.99
        assert_allclose(
            modes.period_s[int(np.argmax(alike))], 2 * math.pi / math.sqrt(square), rtol=0.05
        )


def test_storey_drifts_are_differences_of_the_floors_and_add_up_to_the_wall(run_of, tmp_path):
    """By hand: the slab has a course of its own, the timber floor lies on the 14th course."""
    shaken = run_of("house")
    heights, drift = storey_drifts(shaken)
    assert_allclose(heights, [0.0, 0.75, 1.35, shaken.attributes["drift_height_m"]])
    course = shaken.bodies["course"].to_numpy()
    along = shaken.displacement[:, :, 0].astype(float)
    slab = along[:, course == SLAB_COURSE][:, 0]
    floor = along[:, course == 13].mean(axis=1)
    assert np.abs(slab).max() > 1e-6
    assert_allclose(drift[:, 0], slab / 0.75, rtol=1e-6, atol=1e-12)
    assert_allclose(drift[:, 1], (floor - slab) / 0.6, rtol=1e-5, atol=1e-10)
    times = shaken.series["time_s"].to_numpy()
    at = [int(np.argmin(np.abs(times - time))) for time in shaken.snapshot_time_s]
    assert_allclose(
        drift @ np.diff(heights), shaken.series["top_displacement_m"].to_numpy()[at], atol=1e-12
    )
    assert_allclose(storeys_table(shaken)["max_drift_ratio"], np.abs(drift).max(axis=0))
    assert tmp_path / "run_storeys.csv" in write_run_tables(shaken, tmp_path / "run")


# --- mass per area --------------------------------------------------------------------------------


def test_a_floor_per_area_is_the_mass_of_what_bears_on_the_wall():
    """60 kg/m2 over half of a span of 4.2 m, on 1.2 m of the wall."""
    floor = wall(Floor(1.0, left=0.4, right=1.6, mass_per_area=60.0, tributary_width=2.1)).floors[0]
    assert floor.mass == pytest.approx(60 * 2.1 * 1.2)
    whole = wall(Floor(1.0, mass_per_area=60.0, tributary_width=2.1))
    assert whole.floors[0].mass == pytest.approx(60 * 2.1 * 2.0)
    given = lay_out(wall(Floor(1.0, 60 * 2.1 * 2.0)))
    assert np.array_equal(lay_out(whole).bodies.mass, given.bodies.mass)
    assert "(60 kg/m2 over 2.1 m)" in describe_floors(plan_of(whole))[0]
    assert Wall.from_dict(whole.as_dict()).floors == whole.floors
    assert "mass_per_area" not in given.wall.as_dict()["floors"][0]


# --- a push of several floors by a spreader beam --------------------------------------------------

LEVELS = (0.6, 1.2)
COURSE = 0.1


def column(*masses, **joint):
    """Half bricks on each other, with a floor on course 6 and one on the last."""
    floors = tuple(map(Floor, LEVELS, masses))
    brick = Brick(length=0.6, height=COURSE)
    return Wall(
        "column", 0.3, 1.2, precompression=0, brick=brick, floors=floors, joint=Joint(**joint)
    )


def elastic_by_hand(layout, shares):
    """Displacements of the floors (2,) by a unit of force [m/N]: shear and rotation of the bed
    joints below."""
    points = layout.contacts
    heights = np.array(LEVELS) - COURSE / 2
    found = np.zeros(2)
    for z in np.unique(points.z):
        joint = points.z == z
        arms = np.maximum(heights - z, 0)
        along = np.sum((points.shear_stiffness * points.area)[joint])
        turns = np.sum((points.normal_stiffness * points.area * (points.x - 0.15) ** 2)[joint])
        found += np.sum(shares * (arms > 0)) / along * (arms > 0) + shares @ arms / turns * arms
    return found


@pytest.mark.parametrize("shares", [(0.3, 0.7), (1 / 3, 2 / 3)])
def test_an_elastic_cantilever(tmp_path, shares):
    """Base shear, its moment, and the displacement of each floor."""
    wall = column(400.0, 200.0)
    history = run(
        wall, pushover=0.002, speed=1e-4, floor_share=[*zip(LEVELS, shares)], out=tmp_path / "a.h5"
    )
    shares = np.array(shares)
    heights = np.array(LEVELS) - COURSE / 2
    floors = history.displacement[-1, [5, 11], 0]
    last = history.series.iloc[-1]
    by_unit = elastic_by_hand(lay_out(wall), shares)
    assert_allclose(shares @ floors, 2e-5 * shares @ heights, rtol=1e-4)  # what was asked for
    force = shares @ floors / (shares @ by_unit)
    assert_allclose(floors, force * by_unit, rtol=2e-3)
    # the weights that have moved take 0.2 % of the force
    assert_allclose([last["top_force_n"], last["base_shear_n"]], force, rtol=4e-3)
    moment = -history.support_force[-1, 0, 2] - _moment_of_weights(history)
    assert_allclose(moment, force * (shares @ heights), rtol=4e-3)
    assert energy_error_of(history) < 1e-5


def _moment_of_weights(history, snapshot=-1):
    mass = history.bodies["mass_kg"].to_numpy()
    return GRAVITY * mass @ history.displacement[snapshot, :, 0]


@pytest.mark.parametrize("options", [{}, {"relaxation": "local"}])
def test_forces_keep_their_ratio_past_the_peak(tmp_path, options):
    """The column rocks about a contact point of its base: the more it leans, the smaller the
    force."""
    wall = column(200.0, 400.0, tensile_strength=1e3, normal_stiffness=1e10, shear_stiffness=5e9)
    history = run(
        wall,
        pushover=2,
        speed=5e-3,
        floor_share=[(0.6, 0.5), (1.2, 0.5)],
        out=tmp_path / "a.h5",
        **options,
    )
    layout = lay_out(wall)
    moved = history.displacement
    shares = layout.push_shares(history.loading.floor_shares)
    arms = layout.contacts.x[layout.contacts.z == 0].max() - layout.bodies.x - moved[:, :, 0]
    weight = GRAVITY * layout.bodies.mass
    lever = (layout.bodies.z + moved[:, :, 1]) @ shares
    expected = arms @ weight / lever
    time_s = history.snapshot_time_s
    s = history.series
    force = [s["base_shear_n"][np.abs(s["time_s"] - now) < 0.08].mean() for now in time_s]
    end_s = history.loading.length_s(layout.height_of_push(history.loading.floor_shares))
    rocks = (time_s > 0.5) & (time_s < end_s - 0.2)  # it comes to rest then
    assert expected[rocks][-1] < 0.83 * expected[0]
    assert_allclose(np.array(force)[rocks], expected[rocks], rtol=0.03)
    assert energy_error_of(history) < 1e-5


def test_to_and_fro_its_cycles_are_those_of_the_beam(tmp_path):
    history = run(
        column(400.0, 200.0),
        cyclic=(0.002, 0.004),
        cycles=1,
        speed=5e-4,
        floor_share=[(0.6, 0.3), (1.2, 0.7)],
        out=tmp_path / "a.h5",
    )
    assert len(cycle_edges(history)) == 3
    assert_allclose(history.series["drift_ratio"].agg(["min", "max"]), [-4.25e-5, 4.25e-5], 0.01)
    assert history.loading.name.endswith("cantilever_0.3-at-0.6m_0.7-at-1.2m")


@pytest.mark.parametrize(
    ("shares", "more", "words"),
    [
        ([(0.6, 0.5), (1.2, 0.6)], {}, "sum is 1.1: expected 1"),
        ([(0.6, -0.5), (1.2, 1.5)], {}, "at 0.6 m = -0.5: expected a positive number"),
        ([(0.9, 0.5), (1.2, 0.5)], {}, "no floor there, expected one of 0.6, 1.2 m"),
        ([(1.2, 1.0)], {"boundary": "fixed"}, "floors that may rotate"),
        ([(1.2, 1.0)], {"mass_scaling": "selective"}, "expected true masses"),
        ([(1.2,)], {}, "LEVEL_M SHARE"),
    ],
)
def test_shares_that_cannot_be(shares, more, words):
    wall = column(400.0, 200.0)
    refused_with(words, run, wall, pushover=0.1, floor_share=shares, **more)
    refused_with("belongs to --pushover", run, wall, floor_share=[(1.2, 1.0)])
