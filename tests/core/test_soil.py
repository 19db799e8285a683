"""Soil: springs below the base without tension, and a rotational spring at the top, against closed
forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_with
from scipy.linalg import eigh

import damage
from damage import Brick, ModelOptions, Wall
from damage.linear.modes import mass_vector, natural_modes, stiffness_matrix
from damage.measure.cycles import natural_period, upward_crossings
from damage.measure.energy import energy_error_of
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.soil import fastest_decay, radiation_times

SOIL, FOOTING = 1e8, 0.4


def block(length, height):
    """A rigid block on soil, on Gauss points, which integrate its springs exactly."""
    return Wall("block", length, height, precompression=0.0, brick=Brick(length, height, 0.2))


def stiffness(layout):
    """Vertical and horizontal springs per length [N/m2], of soil and base joint in series."""
    contacts, thickness = layout.contacts, layout.wall.brick.thickness
    assert np.ptp(contacts.normal_stiffness) == 0
    return contacts.normal_stiffness[0] * thickness, contacts.shear_stiffness[0] * thickness


def test_springs_are_soil_and_base_joint_in_series_over_the_footing():
    options = {"contacts": "gauss", "footing": FOOTING, "soil_shear": 0.3}
    soft, rigid = (
        lay_out(block(1.0, 1.0), ModelOptions(soil=soil, **more))
        for soil, more in ((SOIL, options), ("rigid", {"contacts": "gauss"}))
    )
    for found, hard, soil in zip(stiffness(soft), stiffness(rigid), (SOIL, 0.3 * SOIL)):
        assert 1 / found == pytest.approx(1 / hard + 1 / (soil * FOOTING), rel=1e-12)
    assert not soft.contacts.tensile_strength.any() and np.all(
        soft.contacts.cohesion == rigid.contacts.cohesion
    )


def periods(layout, weight=True):
    """Closed form: periods [s] of sway and rocking of a rigid block on a bed of springs, with the
    weight's moment."""
    return (
        2
        * math.pi
        / np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(*matrices(layout, weight)))))
    )


def matrices(layout, weight=True, times=(1.0, 1.0)):
    """Mass and stiffness (2, 2) of the centre's displacement and the rotation; times: factors on
    the springs up and along."""
    wall = layout.wall
    up, along = np.array(stiffness(layout)) * times
    mass, half = layout.total_mass, wall.height / 2
    inertia = mass * (wall.length**2 + wall.height**2) / 12
    sway = along * wall.length
    rock = up * wall.length**3 / 12 - (mass * GRAVITY * half if weight else 0.0)
    # Of the centre's displacement and the rotation, which moves the base by half the height.
    k = np.array([[sway, sway * half], [sway * half, sway * half**2 + rock]])
    return np.diag([mass, inertia]), k


@pytest.mark.parametrize(
    "length, height, share", [(0.6, 1.8, 1.0), (1.8, 0.3, 0.05)], ids=["rocks", "slides"]
)
def test_the_period_of_a_block_is_that_of_the_closed_form(length, height, share):
    """A slender block rocks and a flat one on soft shear springs sways in its first mode."""
    options = {"contacts": "gauss", "soil": SOIL, "footing": FOOTING, "soil_shear": share}
    layout = lay_out(block(length, height), ModelOptions(**options))
    expected = periods(layout, weight=False).max()
    assert natural_modes(layout).period_s[0] == pytest.approx(expected, rel=1e-6)
    history = damage.run(layout.wall, free_vibration=True, rest=0.6, **options)
    assert not history.opening_m.any()  # it does not lift off
    assert not history.series["drift_ratio"].any()  # of a rigid block, which only moves as its base
    found = natural_period(
        *(history.moving[name].to_numpy() for name in ("time_s", "top_displacement_m"))
    )
    assert found == pytest.approx(periods(layout).max(), rel=5e-3)


def test_dashpots_of_the_soil_take_energy_as_by_the_closed_form():
    """Decay of a rocking block by the complex eigenvalues of its two equations of motion with
    dashpots."""
    velocity = 50.0
    options = {
        "contacts": "gauss",
        "soil": SOIL,
        "footing": FOOTING,
        "soil_shear": 1.0,
        "soil_velocity": velocity,
    }
    layout = lay_out(block(0.6, 1.8), ModelOptions(**options))
    times = radiation_times(layout.options)
    assert times == pytest.approx(
        (1800 * 3.4 * velocity / (math.pi * 0.6) / SOIL, 1800 * velocity / SOIL)
    )
    mass, k = matrices(layout)
    damping = matrices(layout, weight=False, times=times)[1]
    inverse, none = np.linalg.inv(mass), np.zeros((2, 2))
    roots = np.linalg.eigvals(np.block([[none, np.eye(2)], [-inverse @ k, -inverse @ damping]]))
    first = roots[np.argmin(np.abs(roots))]
    history = damage.run(layout.wall, free_vibration=True, rest=1.0, dt=1e-4, **options)
    assert not history.opening_m.any()
    time_s, top = (history.moving[name].to_numpy() for name in ("time_s", "top_displacement_m"))
    crossings = upward_crossings(time_s, top)
    period = np.diff(crossings)[:3].mean()
    assert period == pytest.approx(2 * math.pi / abs(first.imag), rel=5e-3)
    peaks = [
        np.abs(top[(time_s >= begin) & (time_s < begin + period)]).max() for begin in crossings[:4]
    ]
    assert np.log(peaks[0] / peaks[3]) / (3 * period) == pytest.approx(-first.real, rel=0.02)
    assert energy_error_of(history) < 1e-3
    expected = history.series["kinetic_energy_j"].iloc[0] * (
        1 - math.exp(2 * first.real * time_s[-1])
    )
    assert history.moving["damping_energy_j"].iloc[-1] == pytest.approx(expected, rel=0.03)


def test_the_fastest_decay_is_that_of_the_stiffest_base_by_lapack():
    """Dashpots are springs of the soil times their times."""
    wall = Wall("w", 1.0, 0.6, precompression=0.0)
    layout = lay_out(wall, ModelOptions(soil=SOIL, soil_velocity=100.0))
    contacts, (up, along) = layout.contacts, radiation_times(layout.options)
    ground = contacts.first < 0
    dashpots = replace(
        contacts,
        normal_stiffness=up * ground * contacts.normal_stiffness,
        shear_stiffness=along * ground * contacts.shear_stiffness,
    )
    damping = stiffness_matrix(replace(layout, contacts=dashpots)).toarray()
    rates = eigh(damping, np.diag(mass_vector(layout)), eigvals_only=True)
    assert fastest_decay(layout) == pytest.approx(rates[-1], rel=1e-9)


def test_the_base_lifts_off_at_the_exact_moment():
    """Stress by weight and moment is zero at the outermost point: M = W L^2 / (12 x)."""
    options = {"contacts": "gauss", "soil": SOIL, "footing": FOOTING}
    wall = block(0.6, 1.2)
    history = damage.run(wall, pushover=0.06, speed=1e-4, **options)
    weight = GRAVITY * history.bodies["mass_kg"].sum()
    reach = wall.length / 2 - history.joints["x_m"].min()
    sample = int(np.argmax(history.opening_m.max(axis=1) > 0))
    lifted = history.joints["x_m"][history.opening_m[sample] > 0]
    assert len(lifted) == 1 and abs(lifted.iloc[0] - wall.length / 2) == pytest.approx(reach)
    moment = (
        history.series["top_force_n"] * wall.height / 2
        + weight * history.series["top_displacement_m"]
    )[sample]
    assert moment == pytest.approx(weight * wall.length**2 / (12 * reach), rel=5e-3)


def test_drift_leaves_the_rocking_of_the_base_out(run_of):
    """Most of the top's motion on soft soil is that of the base, whose rotation and translation
    have columns."""
    shaken = run_of("on soil")
    series = shaken.series
    assert energy_error_of(shaken) < 1e-4
    by_top = series["top_displacement_m"].abs().max() / shaken.attributes["drift_height_m"]
    assert series["drift_ratio"].abs().max() < 0.5 * by_top
    rebuilt = (
        series["drift_ratio"] * shaken.attributes["drift_height_m"]
        + series["base_translation_m"]
        - np.sin(series["base_rotation_rad"])
        * (shaken.attributes["drift_height_m"] - shaken.masonry_wall.brick.height / 2)
    )
    assert np.allclose(rebuilt, series["top_displacement_m"], atol=1e-12)


def test_a_rotational_spring_at_the_top_carries_its_share(tmp_path):
    """A block on soil that is pushed at its centre: springs of sway and rocking, the top's, and the
    weight's moment."""
    options, wall, spring = (
        {"contacts": "gauss", "soil": SOIL, "footing": FOOTING},
        block(0.6, 1.2),
        2e6,
    )
    layout = lay_out(wall, ModelOptions(**options))
    up, along = stiffness(layout)
    history = damage.run(wall, pushover=0.01, speed=1e-4, top_rotation=spring, dt=5e-5, **options)
    rock = up * wall.length**3 / 12 + spring - GRAVITY * layout.total_mass * wall.height / 2
    expected = 1 / (1 / (along * wall.length) + (wall.height / 2) ** 2 / rock)
    last = history.series.iloc[-1]
    assert last["top_force_n"] / last["top_displacement_m"] == pytest.approx(expected, rel=5e-3)
    assert energy_error_of(history) < 1e-3
    refused_with(
        "is too stiff for time steps of",
        damage.run,
        wall,
        pushover=0.01,
        top_rotation=1e12,
        **options,
    )
