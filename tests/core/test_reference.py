"""The reference solver: conservation, symmetry, closed forms; damping by Rayleigh and for static
solutions."""

import numpy as np
import pytest
from conftest import rigid_turn
from numpy.testing import assert_allclose
from short_runs import solver_of

from damage import Joint, ModelOptions, Opening, Wall
from damage.linear.modes import natural_modes
from damage.measure.energy import energy_error
from damage.measure.summary import summarise
from damage.reference.solver import ReferenceSolver
from damage.reference.wall import ReferenceWall
from damage.run.monitor import unbalanced_force
from damage.run.schedule import STEP_FACTOR
from damage.run.settings import ADAPTIVE_DAMPING, LOCAL_DAMPING, rayleigh_factors
from damage.units import GRAVITY
from damage.wall.layout import lay_out

SMALL = Wall(
    name="small", length=1.35, height=0.9, openings=[Opening(0.45, 0.45, 0.6)], lintel="courses"
)
WEAK = Joint()
STRONG = Joint(tensile_strength=1e12, cohesion=1e12)


def small_solver(joint=WEAK, factor=0.35, wall=SMALL, **options):
    wall = Wall(wall.name, wall.length, wall.height, wall.openings, joint=joint)
    return solver_of(lay_out(wall, ModelOptions(**options)), factor)


def settle(solver, seconds=0.3):
    solver.local_damping = 0.7
    solver.run(round(seconds / solver.time_step))
    solver.local_damping = 0.0
    solver.velocity = 0.0
    solver.energy[:] = 0.0
    solver.start(np.zeros((0, 2)))


def test_free_fall_is_exact_in_central_differences():
    solver = small_solver()
    for name in ("normal_stiffness", "shear_stiffness"):
        solver.system.strengths[name] = 0.0  # no joint holds
    solver.refresh()
    n = 500
    solver.run(n)
    time = n * solver.time_step
    # The scheme starts half a step early: z = -g t (t + dt) / 2 exactly.
    expected = -9.81 / 2 * time * (time + solver.time_step)
    assert_allclose(solver.displacement[:, 1], expected, rtol=1e-10)
    assert_allclose(solver.displacement[:, [0, 2]], 0.0, atol=1e-15)


def test_forces_are_the_gradient_of_the_elastic_energy():
    """In any place of an intact wall, turned as a whole by 0.3 rad too: force = -dE/dq by
    differences.

    Neighbours turn by 3e-3 rad against each other: the kernel's axes, the mean of both bodies', are
    shorter than one by an eighth of its square, 1e-6."""
    solver = small_solver(STRONG)
    random = np.random.default_rng(3)
    places = random.normal(0, 1e-3, (len(solver.layout.bodies), 3)) * [1, 1, 2]
    places += rigid_turn(solver.layout.bodies, 0.3)

    def put(values):
        solver.displacement = values
        return solver.elastic_energy()

    put(places)
    force = solver.force[:-1]
    for body, dof in [(0, 0), (7, 1), (11, 2), (23, 2), (30, 0)]:
        step = np.zeros_like(places)
        step[body, dof] = 1e-6
        slope = (put(places + step) - put(places - step)) / 2e-6
        assert_allclose(force[body, dof], -slope, rtol=1e-5, atol=1e-6 * np.abs(force).max())


def test_forces_twice_at_the_same_places_change_nothing():
    solver = small_solver()
    settle(solver)
    solver.start(np.tile([8.0, 0.0], (20_000, 1)))
    solver.run(3000)
    assert solver.system.states["broken"].sum() > 0
    tables = (
        solver.system.states,
        solver.system.readings,
        solver.system.contacts,
        solver.system.place,
    )
    before = [table.copy() for table in tables]
    energy = solver.energy.copy()
    solver.refresh()
    for old, new in zip(before, tables):
        assert np.array_equal(old, new)
    assert np.array_equal(energy, solver.energy)


def test_a_mode_has_the_period_of_central_differences():
    """sin(omega' dt / 2) = omega dt / 2: of a brick, whose highest mode shows the step."""
    layout = lay_out(Wall("brick", 0.225, 0.075, precompression=0.0), ModelOptions(cells=1))
    modes = natural_modes(layout, 1)
    wall = ReferenceWall(layout, 0.4 * modes.critical_time_step_s)
    wall.start(np.zeros((0, 2)), np.zeros(1))
    exact = 2 * np.pi / modes.period_s[0]
    faster = 2 / wall.time_step * np.arcsin(wall.time_step / 2 * exact)
    shape = 1e-7 * modes.shape[0] / np.abs(modes.shape[0]).max()
    steps = round(9.75 * 2 * np.pi / faster / wall.time_step)
    wall.displacement = shape
    wall.velocity = shape * (1 - np.cos(faster * wall.time_step)) / wall.time_step
    wall.run(steps)
    place = wall.displacement[0, 0] / shape[0, 0]
    assert place == pytest.approx(np.cos(faster * steps * wall.time_step), abs=1e-4)
    assert abs(place - np.cos(exact * steps * wall.time_step)) > 0.01


def test_a_kicked_wall_vibrates_with_its_period_and_without_damage(run_of):
    """P-delta, which the eigenvalue does not know, softens the wall by some 0.1 %."""
    free = run_of("free")
    assert_allclose(summarise(free)["period_s"], free.parameters["eigen_period_s"], rtol=5e-3)
    assert energy_error(free.series) < 1e-4 and free.is_intact and len(free.events) == 0


def test_every_break_is_an_event_and_dissipation_never_decreases(run_of):
    shaken = run_of("shaken")
    breaks = shaken.events[shaken.events.kind.isin(["tension", "shear"])]
    assert (
        set(breaks.joint) == set(np.flatnonzero(shaken.broken[-1]))
        and not breaks.joint.duplicated().any()
    )
    for column in ("friction_energy_j", "fracture_energy_j"):
        assert np.all(np.diff(shaken.series[column]) >= 0) and shaken.series[column].iloc[-1] > 0


def test_a_whole_pair_as_one_spring_is_its_contacts_one_by_one():
    """From far below the strengths to beyond: the same forces, and the same joints break."""
    broke = set()
    for strain in (0.1, 0.5, 1.0, 2.0):
        shortcut, by_contact = (small_solver(cells=4) for _ in range(2))
        motion = np.random.default_rng(3).normal(
            0, strain * 2e-6, (len(shortcut.layout.bodies), 3)
        ) * [1, 1, 10]
        for solver, singly in ((shortcut, False), (by_contact, True)):
            solver.place_bodies(motion)
            solver.lanes.find_forces(singly)
        scale = np.abs(by_contact.force).max(axis=0)
        assert_allclose(shortcut.force / scale, by_contact.force / scale, rtol=0, atol=1e-9)
        assert np.array_equal(shortcut.system.states["broken"], by_contact.system.states["broken"])
        broke.add(bool(by_contact.system.states["broken"].any()))
    assert broke == {False, True}


# --- damping --------------------------------------------------------------------------------------


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
    contacts = layout.contacts
    bodies = layout.bodies
    settlement = 0.0
    for course in range(20):
        above = GRAVITY * bodies.mass[(bodies.course >= course) | (bodies.course < 0)].sum()
        below = np.isclose(contacts.z, 0.075 * course) & (contacts.kind == 0)
        settlement -= above / (contacts.normal_stiffness * contacts.area)[below].sum()
    assert_allclose([here, there], settlement, rtol=2e-3)
