"""Walls with deformable bricks that advance together: each has the bits of the plain step, whatever the others do."""

import numpy as np
import pytest
from test_lanes import shake
from test_plain import SOFT, as_bytes, from_instants

from damage.mechanics.tables import ENDED, FAILED, RIGID
from damage.reference import ensembles
from damage.reference.lanes import DeformingLanes, run_together
from damage.reference.solver import ReferenceSolver
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.modes import natural_modes
from damage.wall.parameters import Brick, Joint, Opening, Wall

WEAK = {"tensile_strength": 1e3, "cohesion": 1e3}
OPTIONS = {"bricks": "deformable", "contacts": "gauss", "brick_mass": 25.0, "strength_cov": 0.3}
KINDS = {"brittle": (WEAK, {}), "parallel elements": (SOFT | WEAK, {"fibres": 4, "strength_cov": 0.0}),
         "softening": (SOFT | WEAK, {"brick_damping": 0.0}),
         "softening and crushing, order 3": (
             SOFT | WEAK | {"compressive_strength": 2e4, "compressive_fracture_energy": 0.1}, {"brick_order": 3})}
SPEEDS = 2.5, 0.1, -2.0, 1.9, 3.0
CASES = [
    {"pga_g": 5.0}, {"pga_g": 8.0, "period_s": 0.005}, {"pga_g": 0.01}, {"pga_g": 5.0, "vertical": 8.0},
    {"pga_g": 5.0, "beta": 1e-7}, {"pga_g": 5.0, "alpha": 5.0}, {"pga_g": 0.0, "adaptive": 1.0},
    {"pga_g": 0.0, "local": 0.7}, {"pga_g": 6.0}, {"pga_g": 4.0, "beta": 2e-7, "alpha": 2.0}]


def make(seed, kind, fast):
    """A small wall with an opening and scattered strengths, at rest and without weight."""
    joint, options = KINDS[kind]
    wall = Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses", joint=Joint(**joint))
    layout = lay_out(wall, ModelOptions(**OPTIONS | options, strength_seed=seed))
    return ReferenceSolver(layout, 0.3 * natural_modes(layout).critical_time_step_s, fast=fast)


def everything(wall):
    """State, events and sample of a wall, as bytes."""
    tables = wall.system._replace(relaxation=np.zeros(0), last=np.zeros(0))  # of no use without their damping
    fields = [table if table.dtype.names is None else table[name] for table in tables
              for name in table.dtype.names or ("",)]
    return as_bytes([*fields, *np.atleast_1d(wall.drain_events()), *from_instants(wall.instants())])


@pytest.mark.parametrize("kind", KINDS)
def test_a_wall_has_the_bits_of_the_plain_step_as_any_member_of_a_batch(kind):
    walls, plain = ([make(seed, kind, fast) for seed in range(len(CASES))] for fast in (True, False))
    assert all(wall.fast for wall in walls) and not any(wall.fast for wall in plain)
    for wall, other in zip(walls, plain):
        for one in (wall, other):
            one.damp(local=0.7)
        other.run(100)
    run_together(walls, 100)
    for wall, other, case in zip(walls, plain, CASES):
        for one in (wall, other):
            shake(one, **{"period_s": 0.004} | case)
    walls[5].time_step *= 0.9  # of one wall alone
    plain[5].time_step *= 0.9
    for sample in range(8):
        together = [wall for k, wall in enumerate(walls) if sample < 4 or k != 8]  # one leaves
        assert run_together(together, 30, 20) == [None] * len(together)
        assert isinstance(together[0].lanes, DeformingLanes)
        if sample > 3:
            walls[8].run(30, 20)
        for wall in plain:
            wall.run(30, 20)
    assert [everything(wall) for wall in walls] == [everything(wall) for wall in plain]
    failed = np.array([wall.system.states["broken"] + wall.system.states["kappa"] > 0 for wall in walls])
    assert (failed.any(axis=0) & ~failed.all(axis=0)).any()  # in some of the walls
    assert not failed.any(axis=0).all()


@pytest.mark.parametrize("damping", [{}, {"beta": 1e-7}], ids=["undamped", "damped"])
@pytest.mark.parametrize("dry", [True, False])
def test_joints_end_each_by_itself(dry, damping):
    strengths = {"tensile_strength": 0.0, "cohesion": 0.0} if dry else {"tensile_strength": 3e3, "cohesion": 3e3}
    wall = Wall("pair", 0.1125, 0.15, precompression=0.0, joint=Joint(**strengths))
    layout = lay_out(wall, ModelOptions(bricks="deformable", contacts="gauss", lintel="none"))
    assert len(layout.bodies) == 2
    walls = [[ReferenceSolver(layout, 4e-6, fast=fast) for _ in SPEEDS] for fast in (True, False)]
    for one, speed in zip([*walls[0], *walls[1]], SPEEDS * 2):
        one.damp(**damping)
        one.system.inverse_mass[0, :RIGID] = 0.0
        one.hold(np.array([1]), rotation=True)
        one.push(speed)
    together, alone = walls
    for _ in range(10):
        run_together(together, 3000, 50)
        for one, other in zip(together, alone):
            other.run(3000, 50)
            assert everything(one) == everything(other)
    assert [one.system.interfaces["failed"][-1] for one in together] == [ENDED, FAILED, ENDED, ENDED, ENDED]


def test_walls_of_other_strain_modes_are_not_in_one_batch():
    walls = [ReferenceSolver(lay_out(Wall("w", 0.9, 0.45, brick=Brick(young_modulus=young)),
                                     ModelOptions(bricks="deformable")), 1e-6) for young in (5.2e9, 5.0e9)]
    with pytest.raises(ValueError, match="other bricks, stiffnesses or friction"):
        run_together(walls, 1)
    assert ensembles.Ensemble().move([(wall, 1) for wall in walls]) == [None, None]
