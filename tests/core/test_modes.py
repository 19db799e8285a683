"""Natural modes against closed forms, and the periods of the three walls."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_with, rigid_turn
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.sparse.linalg import eigsh, splu

from damage import ModelOptions, Opening, Wall
from damage.linear.modes import (
    first_mode,
    mass_vector,
    natural_modes,
    static_displacement,
    stiffness_matrix,
)
from damage.units import GRAVITY
from damage.wall.kinematics import ContactKinematics
from damage.wall.layout import lay_out
from damage.wall.restraints import Restraint

PERIODS_S = {"solid": 0.0637, "symmetric": 0.2003, "asymmetric": 0.1745}
"""First periods, which both solvers vibrate with (README.md); the paper's are 0.06 and about 0.2
s."""


def test_first_period_is_the_one_that_the_solvers_show(shipped_wall):
    period_s = natural_modes(lay_out(shipped_wall)).period_s[0]
    assert period_s == pytest.approx(PERIODS_S[shipped_wall.name], abs=5e-5)


def test_critical_step_of_the_shipped_walls(shipped_wall):
    # 4.666e-5 s by an independent eigenvalue analysis, here down to three digits.
    assert natural_modes(lay_out(shipped_wall)).critical_time_step_s == 4.66e-5


HALF_BRICK_PIER = Wall("half", 2.025, 1.2, (Opening(0.1125, 0.9, 0.75),), lintel="courses")


def test_a_cap_on_a_hinge_has_no_period_even_where_rounding_gives_it_one():
    layout = lay_out(HALF_BRICK_PIER, ModelOptions(contacts="corners"))
    glue = layout.contacts.second == layout.n_bricks  # of the cap on half a brick
    middle = np.where(glue, layout.bodies.x[layout.n_bricks], layout.contacts.x)
    refused_with(
        "can move freely",
        natural_modes,
        replace(layout, contacts=replace(layout.contacts, x=middle)),
    )


def test_modes_are_those_of_lapack(symmetric_wall):
    layout = lay_out(symmetric_wall)
    modes = natural_modes(layout, 3)
    squares, vectors = eigh(
        stiffness_matrix(layout).toarray(), np.diag(mass_vector(layout)), subset_by_index=[0, 2]
    )
    assert_allclose(modes.period_s, 2 * np.pi / np.sqrt(squares), rtol=2.0**-26)
    for found, exact in zip(modes.shape, vectors.T.reshape(3, -1, 3)):
        assert_allclose(
            found,
            np.vdot(found, exact) / np.vdot(exact, exact) * exact,
            atol=1e-8 * np.abs(found).max(),
        )


def restrained(restraints, options):
    """The Layout of a wall with a window."""
    window = (Opening(0.45, 0.9, 0.75),)
    wall = Wall("w", 2.025, 1.2, window, precompression=1e5, restraints=restraints)
    return lay_out(wall, options)


@pytest.mark.parametrize(
    "options", [ModelOptions(), ModelOptions(contacts="gauss", bricks="deformable")]
)
@pytest.mark.parametrize("restraints", [(), (Restraint("top"), Restraint("left"))])
def test_free_vibration_begins_with_the_first_mode(options, restraints):
    layout = restrained(restraints, options)
    wanted = natural_modes(layout).shape[0]
    assert_allclose(first_mode(layout), wanted, atol=1e-8 * np.abs(wanted).max())


def test_modes_do_not_know_the_last_bits_of_libraries(symmetric_wall, monkeypatch):
    """Squared frequencies off by more than what separates libraries, vectors of other signs."""
    layout = lay_out(symmetric_wall)
    wanted = natural_modes(layout)
    # one moves up and down
    assert np.any(np.abs(wanted.shape[:, layout.drift_bodies, 0].mean(axis=1)) < 1e-3)

    def otherwise(matrix, **how):
        found = eigsh(matrix, **how)
        if not how.get("return_eigenvectors", True):
            return found * (1 + 1e-10)
        return found[0] * (1 + 1e-12), -found[1]

    monkeypatch.setattr("damage.linear.modes.eigsh", otherwise)
    monkeypatch.setattr("damage.linear.modes._CACHE", {})
    found = natural_modes(layout)
    assert np.array_equal(found.shape, wanted.shape) and np.array_equal(
        found.period_s, wanted.period_s
    )
    assert found.critical_time_step_s == wanted.critical_time_step_s


def test_large_rigid_rotation_opens_no_joint_between_bricks(symmetric_wall):
    layout = lay_out(symmetric_wall)
    opening, shear = ContactKinematics(layout).displacements(rigid_turn(layout.bodies, 0.3))
    inner = layout.contacts.first >= 0
    assert_allclose(opening[inner], 0.0, atol=1e-12)
    assert_allclose(shear[inner], 0.0, atol=1e-12)


@pytest.mark.parametrize(
    "options",
    [
        ModelOptions(),
        ModelOptions(contacts="gauss", bricks="deformable"),
    ],
)
@pytest.mark.parametrize("restraints", [(), (Restraint("top"), Restraint("left"))])
def test_static_displacements_are_those_of_a_sparse_solver(options, restraints):
    layout = restrained(restraints, options)
    free = mass_vector(layout) > 0
    weight = np.zeros((len(layout.bodies), 3 + (layout.strain.n_modes if layout.strain else 0)))
    weight[:, 1] = -GRAVITY * layout.weighing
    expected = np.zeros(len(free))
    expected[free] = splu(stiffness_matrix(layout).tocsc()[free][:, free]).solve(
        weight.ravel()[free]
    )
    assert_allclose(
        static_displacement(layout).ravel(), expected, atol=1e-9 * np.abs(expected).max()
    )


def test_modes_are_kept_for_walls_that_differ_by_strengths_alone(symmetric_wall):
    wanted = natural_modes(lay_out(symmetric_wall, ModelOptions(strength_cov=0.3, strength_seed=1)))
    shape = wanted.shape.copy()
    wanted.shape[:] = 0  # what is handed out is its owner's
    again = natural_modes(lay_out(symmetric_wall, ModelOptions(strength_cov=0.3, strength_seed=2)))
    assert again.shape.tobytes() == shape.tobytes()
    assert again.critical_time_step_s == wanted.critical_time_step_s
    stiffer = replace(symmetric_wall, joint=replace(symmetric_wall.joint, shear_stiffness=5e11))
    assert natural_modes(lay_out(stiffer)).period_s[0] < again.period_s[0]
    assert len(natural_modes(lay_out(symmetric_wall), 2).period_s) == 2
