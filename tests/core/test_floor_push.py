"""A push of several floors by a spreader beam, whose forces keep their ratio: closed forms of a
column of two storeys, in the elastic range and as it rocks past its peak."""

import numpy as np
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose

import damage
from damage import Brick, Floor, Joint, Wall
from damage.applications.cracks.capacity import cycle_edges
from damage.measure.energy import energy_error_of
from damage.units import GRAVITY
from damage.wall.layout import lay_out

LEVELS, COURSE = (0.6, 1.2), 0.1


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
    points, heights = layout.contacts, np.array(LEVELS) - COURSE / 2
    found = np.zeros(2)
    for z in np.unique(points.z):
        joint, arms = points.z == z, np.maximum(heights - z, 0)
        along = np.sum((points.shear_stiffness * points.area)[joint])
        turns = np.sum((points.normal_stiffness * points.area * (points.x - 0.15) ** 2)[joint])
        found += np.sum(shares * (arms > 0)) / along * (arms > 0) + shares @ arms / turns * arms
    return found


@pytest.mark.parametrize("shares", [(0.3, 0.7), (1 / 3, 2 / 3)])
def test_an_elastic_cantilever(tmp_path, shares):
    """Base shear, its moment, and the displacement of each floor."""
    wall = column(400.0, 200.0)
    history = damage.run(
        wall, pushover=0.002, speed=1e-4, floor_share=[*zip(LEVELS, shares)], out=tmp_path / "a.h5"
    )
    shares, heights = np.array(shares), np.array(LEVELS) - COURSE / 2
    floors, last = history.displacement[-1, [5, 11], 0], history.series.iloc[-1]
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
    history = damage.run(
        wall,
        pushover=2,
        speed=5e-3,
        floor_share=[(0.6, 0.5), (1.2, 0.5)],
        out=tmp_path / "a.h5",
        **options,
    )
    layout, moved = lay_out(wall), history.displacement
    shares = layout.push_shares(history.loading.floor_shares)
    arms = layout.contacts.x[layout.contacts.z == 0].max() - layout.bodies.x - moved[:, :, 0]
    weight, lever = GRAVITY * layout.bodies.mass, (layout.bodies.z + moved[:, :, 1]) @ shares
    expected = arms @ weight / lever
    time_s, s = history.snapshot_time_s, history.series
    force = [s["base_shear_n"][np.abs(s["time_s"] - now) < 0.08].mean() for now in time_s]
    rocks = (time_s > 0.5) & (time_s < time_s[-1] - 0.2)
    assert expected[rocks][-1] < 0.83 * expected[0]
    assert_allclose(np.array(force)[rocks], expected[rocks], rtol=0.03)
    assert energy_error_of(history) < 1e-5


def test_to_and_fro_its_cycles_are_those_of_the_beam(tmp_path):
    history = damage.run(
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
    refused_with(words, damage.run, wall, pushover=0.1, floor_share=shares, **more)
    refused_with("belongs to --pushover", damage.run, wall, floor_share=[(1.2, 1.0)])
