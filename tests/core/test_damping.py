"""Damping of the reference solver: Rayleigh's ratio at two frequencies, adaptive for static
solutions."""

import numpy as np
from numpy.testing import assert_allclose

from damage import Joint, Wall
from damage.linear.modes import natural_modes
from damage.reference.solver import ReferenceSolver
from damage.reference.wall import ReferenceWall
from damage.run.monitor import unbalanced_force
from damage.run.schedule import STEP_FACTOR
from damage.run.settings import ADAPTIVE_DAMPING, LOCAL_DAMPING, rayleigh_factors
from damage.units import GRAVITY
from damage.wall.layout import lay_out

STRONG = Joint(tensile_strength=1e12, cohesion=1e12)


def slender():
    """A wall of 20 courses: {layout, modes}."""
    layout = lay_out(Wall("slender", 0.9, 1.5, joint=STRONG))
    return layout, natural_modes(layout)


def decay_ratio(solver, shape, period):
    """Damping ratio from the logarithmic decrement of the motion in one mode's shape over ten
    cycles."""
    mass = np.column_stack([solver.layout.bodies.mass] * 2 + [solver.layout.bodies.inertia])
    solver.velocity = 1e-3 * shape
    steps = round(period / solver.time_step)
    amplitudes = []
    for _ in range(10):
        track = []
        for _ in range(20):
            solver.run(steps // 20)
            track.append(np.sum(mass * shape * solver.displacement))
        amplitudes.append(np.ptp(track))
    decrement = np.log(amplitudes[1] / amplitudes[9]) / 8
    return decrement / np.hypot(2 * np.pi, decrement)


def test_rayleigh_damping_has_its_ratio_at_both_frequencies():
    layout, modes = slender()
    frequencies = 1 / modes.period_s[[0, 3]]
    alpha, beta = rayleigh_factors(0.03, *frequencies)
    for mode in (0, 3):
        solver = ReferenceWall(layout, 0.3 * modes.critical_time_step_s, alpha=alpha, beta=beta)
        solver.gravity = np.zeros(1)
        assert_allclose(
            decay_ratio(solver, modes.shape[mode], modes.period_s[mode]), 0.03, rtol=0.02
        )


def relaxed(**damping):
    """(unbalanced force, settlement of the top course) 12 000 steps after gravity came all at
    once."""
    layout, modes = slender()
    solver = ReferenceSolver(layout, STEP_FACTOR * modes.critical_time_step_s)
    for name, value in damping.items():
        setattr(solver, name, value)
    solver.run(12_000)
    return (
        unbalanced_force(layout, *solver.forces()),
        solver.displacement[layout.drift_bodies, 1].mean(),
    )


def test_adaptive_damping_finds_the_static_solution_sooner_than_local():
    adaptive, here = relaxed(adaptive_damping=ADAPTIVE_DAMPING)
    local, there = relaxed(local_damping=LOCAL_DAMPING)
    assert adaptive < 1e-9 and adaptive < local
    # Springs in series: every bed joint settles by the weight above it over its stiffness.
    layout, _ = slender()
    contacts, bodies = layout.contacts, layout.bodies
    settlement = 0.0
    for course in range(20):
        above = GRAVITY * bodies.mass[(bodies.course >= course) | (bodies.course < 0)].sum()
        below = np.isclose(contacts.z, 0.075 * course) & (contacts.kind == 0)
        settlement -= above / (contacts.normal_stiffness * contacts.area)[below].sum()
    assert_allclose([here, there], settlement, rtol=2e-3)
