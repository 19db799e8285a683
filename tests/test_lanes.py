"""Walls that advance together: each has the same bits as alone, whatever the others do."""

import gc
import weakref

import numpy as np
import pytest

from damage.mechanics import tables
from damage.motion.loading import Harmonic
from damage.reference.lanes import MOST_LANES, run_together
from damage.reference.solver import ReferenceSolver
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.modes import natural_modes
from damage.wall.parameters import Joint, Opening, Wall

WALL = Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses",
            joint=Joint(tensile_strength=3e4, cohesion=8e4))
SAMPLE = 40


def make(seed=0, wall=WALL, **options):
    """A wall with strengths scattered by a seed, at rest and without weight."""
    layout = lay_out(wall, ModelOptions(strength_cov=0.3 if seed else 0.0, strength_seed=seed, **options))
    return ReferenceSolver(layout, 0.3 * natural_modes(layout).critical_time_step_s)


def shake(wall, pga_g, period_s=0.02, vertical=0.0, **damping):
    """Start a harmonic base motion."""
    wall.damp(**damping)
    time_s = np.arange(600) * wall.time_step
    base = Harmonic(period_s, pga_g).base_acceleration(time_s)
    base[:, 1] = vertical * np.cos(2 * np.pi * time_s / period_s)
    wall.start(base)


def everything(wall):
    """State and samples of a wall, as bytes."""
    system, events = wall.system, wall.drain_events()
    instant = wall.instants()
    rows = system.states, system.contacts, system.interfaces
    parts = [np.ascontiguousarray(table[name]) for table in rows for name in table.dtype.names]
    parts += [system.place, system.velocity, system.force, system.trig]
    logged = system.readings, system.energy, np.array(events, dtype=object).astype(str)
    return [part.tobytes() for part in (*parts, *logged)], \
        [np.asarray(value).tobytes() for value in (*instant.contacts.values(), *instant)
         if value is not None and value is not instant.contacts]


CASES = [
    {"pga_g": 2.0}, {"pga_g": 3.0, "period_s": 0.03}, {"pga_g": 0.01}, {"pga_g": 2.0, "vertical": 8.0},
    {"pga_g": 2.0, "beta": 1e-6}, {"pga_g": 2.0, "alpha": 5.0}, {"pga_g": 0.0, "adaptive": 1.0},
    {"pga_g": 0.0, "local": 0.7}, {"pga_g": 2.5}, {"pga_g": 1.0, "beta": 2e-6, "alpha": 2.0},
]


def members():
    """Ten walls with different strengths, motions and damping: more than one batch."""
    walls = [make(seed) for seed in range(len(CASES))]
    walls[3].shift(np.random.default_rng(3).normal(0, 1e-7, (len(walls[3].layout.bodies), 2)))
    for wall in walls:
        wall.damp(local=0.7)
    return walls


@pytest.fixture(scope="module")
def alone():
    walls = members()
    for wall, case in zip(walls, CASES):
        wall.run(200)
        shake(wall, **case)
        for _ in range(12):
            wall.run(SAMPLE)
    return walls


def test_a_wall_has_the_same_bits_alone_and_as_any_member_of_a_batch(alone):
    assert len(CASES) > MOST_LANES
    assert any(wall.state.any() for wall in alone) and not all(wall.state.any() for wall in alone)
    expected = [everything(wall) for wall in alone]
    for order in (np.arange(10), np.arange(10)[::-1], np.array([4, 0, 2])):
        walls = members()
        run_together([walls[k] for k in order], 200)
        for k in order:
            shake(walls[k], **CASES[k])
        for _ in range(12):
            assert run_together([walls[k] for k in order], SAMPLE) == [None] * len(order)
        for k in order:
            assert everything(walls[k]) == expected[k], (k, order)


def test_a_member_that_ends_or_fails_does_not_disturb_the_others(alone):
    """One is left out after a while, one becomes unstable by too large a time step, one is run alone in between."""
    walls = [make(seed) for seed in (0, 1, 2, 0)]
    for wall in walls:
        wall.damp(local=0.7)
    run_together(walls, 200)
    for wall, case in zip(walls, [*CASES[:3], CASES[0]]):
        shake(wall, **case)
    walls[3].time_step *= 20
    ended = None
    for sample in range(12):
        running = [walls[0], walls[3]] + ([walls[1]] if sample < 5 else [])
        failures = run_together(running, SAMPLE)
        assert failures[0] is None and all(failure is None for failure in failures[2:])
        if sample == 4:
            ended = walls[1].system.place.copy()
        walls[2].run(SAMPLE)
    assert isinstance(failures[1], FloatingPointError) and "too large" in str(failures[1])
    assert np.array_equal(walls[1].system.place, ended)
    reference = make(0)
    reference.damp(local=0.7)
    reference.run(200)
    shake(reference, **CASES[0])
    for _ in range(12):
        reference.run(SAMPLE)
    assert everything(walls[0]) == everything(reference)


def test_a_member_is_a_wall_like_any_other():
    """It is read, changed directly and run alone between two steps of all, and has its own events."""
    walls = [make(1), make(1)]
    for wall in walls:
        wall.damp(local=0.7)
    run_together(walls, 50)
    walls[0].displacement += 1e-6 * np.array([1, 0, 0])
    one = make(1)
    one.damp(local=0.7)
    one.run(50)
    one.displacement += 1e-6 * np.array([1, 0, 0])
    run_together(walls, 50)
    one.run(50)
    assert everything(walls[0]) == everything(one)
    assert not np.array_equal(walls[0].displacement, walls[1].displacement)


def test_pushed_walls_and_softening_ones_step_together():
    soft = Wall("soft", 0.9, 0.45, joint=Joint(tensile_strength=5e4, cohesion=5e4, mode_i_fracture_energy=5.0,
                                               mode_ii_fracture_energy=50.0))

    def pushed(speed):
        wall = make(wall=soft)
        wall.hold(wall.layout.pushed_bodies, rotation=True)
        wall.push(speed)
        wall.damp(adaptive=1.0, beta=2e-6)
        return wall

    speeds = (0.1, 0.5, 1.0)
    together, apart = [pushed(speed) for speed in speeds], [pushed(speed) for speed in speeds]
    for _ in range(10):
        run_together(together, SAMPLE)
        for wall in apart:
            wall.run(SAMPLE)
    assert all(everything(one) == everything(other) for one, other in zip(together, apart))
    assert together[-1].system.states["kappa"].max() > 0


@pytest.mark.parametrize(("table", "field"), [("contacts", "offset"), ("contacts", "kn"), ("contacts", "area")])
def test_walls_whose_pairs_are_alike_and_contacts_are_not_are_reported(table, field):
    """Columns that a batch takes from its first wall are equal in all walls."""
    one, other = make(), make()
    getattr(other.system, table)[field][0] *= 1.5
    with pytest.raises(ValueError, match="other bricks, stiffnesses or friction"):
        run_together([one, other], 1)


def test_walls_of_other_bricks_or_friction_are_reported():
    for other in (make(cells=3), make(wall=Wall(WALL.name, WALL.length, WALL.height, WALL.openings,
                                                joint=Joint(tensile_strength=3e4, cohesion=8e4, friction_angle=0.5)))):
        with pytest.raises(ValueError, match="other bricks, stiffnesses or friction"):
            run_together([make(), other], 10)


def test_the_tables_of_a_member_are_views_of_those_of_the_batch():
    walls = [make(seed) for seed in range(3)]
    run_together(walls, 5)
    for lane, wall in enumerate(walls):
        for name in tables.System._fields:
            one, of_batch = getattr(wall.system, name), getattr(wall.lanes.tables, name)[lane]
            assert one.size == 0 or np.shares_memory(one, of_batch)


@pytest.mark.parametrize("n_walls, options", [(3, {}), (1, {}), (1, {"bricks": "deformable", "contacts": "gauss"})])
def test_tables_are_freed_with_the_walls_without_the_garbage_collector(n_walls, options):
    """A study runs thousands of walls in a process, whose few objects hold megabytes and hardly ever start it."""
    walls = [make(seed, **options) for seed in range(1, n_walls + 1)]
    run_together(walls, 1)
    left = [weakref.ref(one) for one in (*walls, walls[0].lanes)]
    gc.disable()
    try:
        del walls
        assert [one() for one in left] == [None] * (n_walls + 1)
    finally:
        gc.enable()
