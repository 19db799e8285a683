"""Supports are bodies whose velocity is prescribed: what they do to a wall, and the work that it takes."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from conftest import REPOSITORY
from numpy.testing import assert_allclose
from yade_checks.settling_support import MOTION, pier, settle

from damage.draw.wall import wall_shape
from damage.history.reader import read_history
from damage.law.modes import natural_modes
from damage.mechanics.tables import INPUT
from damage.motion import loading
from damage.motion.loading import Drive, Harmonic, Loading
from damage.reference.session import BACKEND
from damage.reference.solver import ReferenceSolver
from damage.reference.wall import ReferenceWall
from damage.run.session import prepare, simulate
from damage.run.settings import RunSettings
from damage.run.turns import take_turns
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Joint, Opening, Wall

STRONG = Joint(tensile_strength=1e9, cohesion=1e9)
SETTLEMENT = 1e-3


@pytest.fixture
def wall():
    """A small wall with an opening, at rest under its weight."""
    layout = lay_out(Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses", joint=STRONG))
    found = ReferenceWall(layout, 0.6 * natural_modes(layout).critical_time_step_s)
    come_to_rest(found)
    return found


def come_to_rest(wall, steps=6000):
    wall.adaptive_damping = 1.0
    wall.run(steps)
    wall.adaptive_damping = 0.0
    assert_allclose(wall.force[:len(wall.layout.bodies), 1], weights(wall), rtol=1e-9)


def weights(wall):
    return GRAVITY * wall.layout.bodies.mass


def test_a_settlement_at_constant_velocity_moves_the_wall_as_a_rigid_body(wall):
    """And its work is the weight times the settlement: the wall and its support begin together."""
    before, steps = wall.displacement, 20_000
    velocity = np.array([0.0, -SETTLEMENT / (steps * wall.time_step), 0.0])
    wall.velocity = velocity
    wall.move_supports(velocity)
    wall.energy[:] = 0.0
    wall.run(steps)
    assert_allclose(wall.displacement - before, np.tile([0, -SETTLEMENT, 0], (len(before), 1)), rtol=0, atol=1e-9)
    work = weights(wall).sum() * SETTLEMENT
    assert wall.energy[INPUT] == pytest.approx(-work, abs=1e-9 * work)


def test_work_of_a_support_that_rotates_closes_the_balance(wall):
    """Suddenly and about its edge, so that the wall vibrates: what came in is kinetic, elastic and of gravity."""
    def stored():
        return (wall.kinetic_energy() + wall.elastic_energy()
                + float(weights(wall) @ wall.displacement[:, 1]))

    wall.energy[:] = 0.0
    before = stored()
    wall.move_supports((0.01, -0.02, 0.1))
    wall.run(3000)
    change = stored() - before
    assert abs(change) > 0.1
    # Central differences take the work of a step by the force at its beginning: exact but for a share of (omega dt)^2.
    assert wall.energy[INPUT] == pytest.approx(change, rel=1e-3)


def test_reactions_on_tilted_ground_are_those_of_statics(wall):
    """The whole weight, no thrust, and its moment about the support's reference point, about which it rotates."""
    tilt, steps = 0.02, 4000
    wall.local_damping = 0.7
    wall.move_supports((0.0, 0.0, tilt / (steps * wall.time_step)))
    wall.run(steps)
    wall.move_supports(0.0)
    wall.local_damping = 0.0
    come_to_rest(wall, 20_000)
    (fx, fz, moment), = wall.support_force
    middle = wall.layout.supports.x[0]
    weight, x = weights(wall), wall.layout.bodies.x - middle + wall.displacement[:, 0]
    assert_allclose((fx, fz), (0.0, -weight.sum()), rtol=1e-9, atol=1e-9 * weight.sum())
    assert_allclose(moment, -weight @ x, rtol=1e-9)
    x, z = wall.layout.bodies.x - middle, wall.layout.bodies.z
    assert_allclose(wall.displacement[:, 0], -math.sin(tilt) * z + (math.cos(tilt) - 1) * x, atol=1e-4)


# --- several supports -------------------------------------------------------------------------------

@pytest.fixture(scope="module")
def settled():
    """What the reference solver says of the pier whose left support settles."""
    layout, time_step = pier()
    return layout, settle(ReferenceSolver(layout, time_step))


def test_a_support_goes_where_it_is_moved_and_the_other_rests(settled):
    _, found = settled
    assert_allclose(found["supports"], [MOTION, (0, 0, 0)], rtol=1e-9, atol=1e-15)


def test_reactions_of_all_supports_balance_the_weight_and_its_moment(settled):
    """About the base's left end; the pier is at rest, on supports that pull where it bridges them."""
    layout, found = settled
    weight = GRAVITY * layout.bodies.mass
    force, moved = found["reactions"], found["moved"]
    assert_allclose(force[:, 0].sum(), 0.0, atol=1e-6 * weight.sum())
    assert_allclose(-force[:, 1].sum(), weight.sum(), rtol=1e-6)
    x, z = layout.supports.x + found["supports"][:, 0], found["supports"][:, 1]
    moments = force[:, 2] + x * force[:, 1] - z * force[:, 0]
    # The pier's place before is that under its weight: micrometres, which the tolerance covers.
    assert_allclose(-moments.sum(), weight @ (layout.bodies.x + moved[:, 0]), rtol=1e-5)


def test_work_of_the_settlement_is_stored_or_lost_to_damping(settled):
    layout, found = settled
    gravity_j = GRAVITY * float(layout.bodies.mass @ found["moved"][:, 1])
    assert found["damping_j"] > 0
    assert_allclose(found["input_j"], found["elastic_j"] + gravity_j + found["damping_j"], rtol=1e-3)


@pytest.mark.yade
def test_yade_moves_a_support_as_the_reference_solver_does(settled, yade_command, tmp_path):
    yade_command(REPOSITORY / "tests/yade_checks/settling_support.py", tmp_path / "results.npz", status=0)
    found, (_, expected) = np.load(tmp_path / "results.npz"), settled
    assert_allclose(found["supports"], expected["supports"], rtol=1e-9, atol=1e-15)
    assert_allclose(found["moved"], expected["moved"], atol=0.01 * np.abs(expected["moved"]).max())
    assert_allclose(found["reactions"], expected["reactions"], atol=0.01 * np.abs(expected["reactions"]).max())
    assert_allclose(found["input_j"], expected["input_j"], rtol=0.02)


# --- in a run ---------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Sinking(Loading):
    """All supports sink by 1 mm in 0.1 s, the left end of the base by twice as much."""

    name: ClassVar[str] = "sinking"
    duration_s: ClassVar[float] = 0.1

    @property
    def drive(self):
        def displacement(time_s, x_m):
            found = np.zeros((len(time_s), len(x_m), 3))
            found[:, :, 1] = -np.outer(np.minimum(time_s / 0.1, 1.0), np.where(x_m < 0.2, 2e-3, 1e-3))
            return found

        return Drive(supports=displacement, local_damping=0.7)

    def as_dict(self):
        return {"kind": "sinking"}


def test_a_run_under_a_loading_that_moves_supports(monkeypatch, tmp_path):
    """The history holds where they are and what they carry, and its energies balance."""
    monkeypatch.setitem(loading._KINDS, "sinking", Sinking)
    settings = RunSettings(Sinking(), ModelOptions(supports="bricks"), accept_implausible=True,
                           out=tmp_path / "a.h5", pictures=False)
    prepared = prepare(BACKEND, __file__, lambda: Wall("pier", 0.45, 0.6, joint=STRONG), settings)
    assert take_turns([simulate(prepared, lambda run, time_s: True)]) == [0]
    history = read_history(tmp_path / "a.h5")
    sunk = history.support_displacement[:, :, 1]
    time_s = history.series["time_s"].to_numpy()
    assert_allclose(sunk[:, 1], -np.minimum(time_s / 0.1, 1) * 1e-3, atol=1e-9)
    assert_allclose(sunk[:, 0], 2 * sunk[:, 1], atol=1e-9)
    assert_allclose(history.supports[["left_m", "right_m"]], [[0, 0.225], [0.225, 0.45]])
    weight = history.static["weight_n"]
    assert_allclose(-history.support_force[0, :, 1].sum(), weight, rtol=1e-4)
    assert_allclose(history.support_force[:, :, 0].sum(axis=1), history.series["base_shear_n"], rtol=1e-5, atol=1e-2)
    last = history.series.iloc[-1]
    stored = last["kinetic_energy_j"] + last["elastic_energy_j"] + last["gravity_energy_j"]
    assert last["gravity_energy_j"] < -0.9e-3 * weight
    assert last["input_energy_j"] == pytest.approx(stored + last["damping_energy_j"], abs=1e-3 * abs(stored))
    shape = wall_shape(history, len(history.series) - 1, magnify=1.0)
    assert_allclose(shape.supports[:, 2:, 1], np.repeat(sunk[-1:].T, 2, axis=1), atol=1e-8)


def test_one_support_and_one_below_each_brick_give_the_same_wall():
    """Supports at rest are one ground, however many: to the last bit."""
    walls = []
    for kind in ("one", "bricks"):
        layout = lay_out(Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses"),
                         ModelOptions(supports=kind), scatter=0.3, seed=4)
        wall = ReferenceWall(layout, 0.6 * natural_modes(layout).critical_time_step_s)
        wall.start(Harmonic(0.02, 2.0).drive.base(np.arange(600) * wall.time_step))
        wall.run(600)
        walls.append(wall)
    one, bricks = walls
    assert np.array_equal(one.displacement, bricks.displacement) and one.state.any()
    assert_allclose(one.support_force[:, :2], [bricks.support_force[:, :2].sum(axis=0)], rtol=1e-12)
    assert len(bricks.support_force) == 4
