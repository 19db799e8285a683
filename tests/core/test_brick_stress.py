"""Stresses in deformable bricks: principal stresses, the middle sections, and where they are
shown."""

from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from short_runs import solver_of
from small_history import make_history

from damage import Brick, Joint, ModelOptions, Wall
from damage.applications.studies.records import record_of
from damage.measure.brick_stress import (
    bricks_table,
    principal_stresses,
    stress_measures,
    warn_of_splitting,
)
from damage.measure.tables import write_run_tables
from damage.units import GRAVITY
from damage.wall.kinds import CAP
from damage.wall.layout import lay_out
from damage.wall.strain import strain_of, stress_by_modes

DEFORMABLE = ModelOptions(bricks="deformable", contacts="gauss")


@pytest.mark.parametrize(
    ("stress", "principal", "angle"),
    [
        ((2.0, 0.0, 0.0), (2.0, 0.0), 0.0),
        ((0.0, 2.0, 0.0), (2.0, 0.0), np.pi / 2),
        ((0.0, 0.0, 3.0), (3.0, -3.0), np.pi / 4),
        ((-1.0, -5.0, 0.0), (-1.0, -5.0), 0.0),
        ((5.0, -1.0, -4.0), (7.0, -3.0), -np.arctan2(4, 3) / 2),
    ],
)
def test_principal_stresses(stress, principal, angle):
    found, direction = principal_stresses(stress)
    assert_allclose(found, principal)
    assert direction == pytest.approx(angle)
    # the normal stress in that direction is the largest one
    cosine, sine = np.cos(direction), np.sin(direction)
    assert np.dot(stress, [cosine**2, sine**2, 2 * sine * cosine]) == pytest.approx(principal[0])


def test_a_bent_brick_has_the_mean_moment_of_beam_theory():
    """On supports an eighth of the length L from its ends, under a load Q on points an eighth from
    its middle: the moment's mean over the length is half its maximum, Q L / 8; the brick's own
    weight is left out."""
    brick = Brick(density=1.0)
    wall = Wall(
        "beam",
        brick.length,
        brick.height,
        brick=brick,
        joint=Joint(tensile_strength=1e15, cohesion=1e15),
        precompression=1e4,
    )
    layout = lay_out(wall, ModelOptions(top="beam", bricks="deformable"))
    contacts = layout.contacts
    outer = np.abs(contacts.x - brick.length / 2) > brick.length / 4
    used = np.flatnonzero(outer != (contacts.kind == CAP))
    kept = replace(
        contacts, **{one.name: getattr(contacts, one.name)[used] for one in fields(contacts)}
    )
    kept = replace(kept, shear_stiffness=1e-6 * kept.shear_stiffness)  # next to no membrane force
    layout = replace(
        layout,
        contacts=kept,
        n_joints=int(np.sum(kept.kind != CAP)),
        strain=strain_of(wall.brick, layout.options, layout.bodies, kept, layout.n_bricks),
    )
    solver = solver_of(layout, 0.1)
    solver.add_static_displacement()
    (stress, _), load = (
        np.einsum("bpsm,bm->bps", stress_by_modes(layout), solver.system.place[:-1, 3:]),
        GRAVITY * layout.bodies.mass[1],
    )
    bending = (stress[1:3, 0].mean() - stress[3:5, 0].mean()) / 2  # lower edge, upper edge
    assert bending == pytest.approx(
        0.5 * load * brick.length / 8 / (brick.thickness * brick.height**2 / 6), rel=5e-3
    )


@pytest.fixture
def stressed(tmp_path):
    """stressed(strength): a history of two bricks on two at two snapshots, brick 1 bent in the
    second by 2 MPa at its lower edge."""

    def make(strength=None):
        wall = Wall("small", 0.45, 0.15, brick=Brick(tensile_strength=strength), precompression=0.0)
        layout = lay_out(wall, DEFORMABLE)
        # none is cut
        assert layout.n_bricks == len(lay_out(replace(wall, brick=Brick()), DEFORMABLE).bodies)
        history = make_history(tmp_path / f"{strength}.h5", layout)
        stress = np.full((2, len(layout.bodies), 5, 3), 0.0, np.float32)
        stress[:, :, :, 1] = -3e5
        stress[1, 1, :, 0] = [0.0, 1e6, 3e6, -1e6, -3e6]
        return replace(
            history,
            stress_pa=stress,
            displacement=history.displacement[:1].repeat(2, axis=0),
            snapshot_time_s=np.array([0.1, 0.3]),
        )

    return make


def test_table_of_the_middle_sections(stressed, tmp_path):
    history = stressed(strength=1.5e6)
    table = bricks_table(history).set_index("brick")
    bent = table.loc[1]
    assert (bent["place"], bent["time_s"], bent["splits_at_s"]) == ("lower edge", 0.3, 0.3)
    assert_allclose([bent["max_tension_pa"], bent["max_compression_pa"]], [2e6, -2e6])
    others = table.drop(index=1)
    assert_allclose(others[["max_tension_pa", "max_compression_pa"]], [[0.0, -3e5]] * len(others))
    assert others["splits_at_s"].isna().all()
    assert stress_measures(history) == {
        "max_brick_tension_pa": 2e6,
        "max_brick_compression_pa": -2e6,
        "bricks_above_strength": 1,
    }
    # a study takes it
    assert record_of(history, "run", "point")["row"]["max_brick_compression_pa"] == -2e6
    (line,) = warn_of_splitting(history)
    assert "1 brick would split at 1.5 MPa" in line and "t = 0.30 s" in line
    assert tmp_path / "run_bricks.csv" in write_run_tables(history, tmp_path / "run")


def test_bricks_below_their_strength_or_without_one(stressed):
    strong, none = stressed(strength=2.1e6), stressed()
    assert warn_of_splitting(strong) == warn_of_splitting(none) == []
    assert [stress_measures(one)["bricks_above_strength"] for one in (strong, none)] == [0, None]
