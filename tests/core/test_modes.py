"""Natural modes against closed forms, and the periods of the three walls."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.sparse.linalg import eigsh, splu

from damage.law.blocks import factorised
from damage.law.modes import (
    contact_normals,
    first_mode,
    joint_stiffness,
    mass_vector,
    natural_modes,
    static_displacement,
    stiffness_matrix,
)
from damage.units import GRAVITY
from damage.wall.kinematics import ContactKinematics
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Opening, Wall
from damage.wall.restraints import Restraint
from verification.limit_analysis import kinematic_matrix

PERIODS_S = {"solid": 0.0637, "symmetric": 0.2003, "asymmetric": 0.1745}
"""First periods, which both solvers vibrate with (README.md); the paper's are 0.06 and about 0.2
s."""


def test_first_period_is_the_one_that_the_solvers_show(shipped_wall):
    period_s = natural_modes(lay_out(shipped_wall)).period_s[0]
    assert period_s == pytest.approx(PERIODS_S[shipped_wall.name], abs=5e-5)


def test_critical_step_of_the_shipped_walls(shipped_wall):
    # 4.666e-5 s by an independent eigenvalue analysis, here down to three digits.
    assert natural_modes(lay_out(shipped_wall)).critical_time_step_s == 4.66e-5


def test_rigid_motion_gives_no_force(shipped_wall):
    layout = lay_out(shipped_wall)
    inner = layout.contacts.first >= 0  # the ground does not move along
    bodies, turn = layout.bodies, 1e-3
    motion = np.column_stack([1 - turn * bodies.z, 2 + turn * bodies.x, np.full(len(bodies), turn)])
    normals = contact_normals(layout.contacts)
    for directions in (normals, normals[:, ::-1]):
        moved = kinematic_matrix(layout, directions) @ motion.ravel()
        assert_allclose(moved[inner], 0.0, atol=1e-12)


def test_a_stack_of_one_brick_vibrates_as_by_hand():
    """One brick on its base joint: two bed springs under its cells, rocking and sliding coupled."""
    wall = Wall("brick", 0.225, 0.075, precompression=0.0)
    layout = lay_out(wall, ModelOptions(cells=1))
    contacts, bodies = layout.contacts, layout.bodies
    k_n, k_s = contacts.normal_stiffness[0], contacts.shear_stiffness[0]
    area, arm, half = contacts.area.sum(), np.abs(contacts.x - bodies.x[0]).max(), 0.0375
    mass, inertia = bodies.mass[0], bodies.inertia[0]
    shear, rocking = k_s * area, k_n * area * arm**2
    matrix = np.array([[shear, shear * half], [shear * half, rocking + shear * half**2]])
    root = np.diag([mass, inertia]) ** 0.5
    omega = np.sqrt(
        np.append(
            np.linalg.eigvalsh(np.linalg.solve(root, matrix) @ np.linalg.inv(root)),
            k_n * area / mass,
        )
    )
    full = stiffness_matrix(layout).toarray() / np.sqrt(np.outer(*[mass_vector(layout)] * 2))
    assert_allclose(np.sqrt(np.linalg.eigvalsh(full)), np.sort(omega), rtol=1e-10)


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


@pytest.mark.parametrize(
    "options", [ModelOptions(), ModelOptions(contacts="gauss", bricks="deformable")]
)
@pytest.mark.parametrize("restraints", [(), (Restraint("top"), Restraint("left"))])
def test_free_vibration_begins_with_the_first_mode(options, restraints):
    layout = lay_out(
        Wall(
            "w", 2.025, 1.2, (Opening(0.45, 0.9, 0.75),), precompression=1e5, restraints=restraints
        ),
        options,
    )
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

    monkeypatch.setattr("damage.law.modes.eigsh", otherwise)
    monkeypatch.setattr("damage.law.modes._KEPT", {})
    found = natural_modes(layout)
    assert np.array_equal(found.shape, wanted.shape) and np.array_equal(
        found.period_s, wanted.period_s
    )
    assert found.critical_time_step_s == wanted.critical_time_step_s


def test_large_rigid_rotation_opens_no_joint_between_bricks(symmetric_wall):
    layout = lay_out(symmetric_wall)
    x, z, turn = layout.bodies.x, layout.bodies.z, 0.3
    cos, sin = np.cos(turn), np.sin(turn)
    motion = np.column_stack([cos * x - sin * z - x, sin * x + cos * z - z, np.full(len(x), turn)])
    opening, shear = ContactKinematics(layout).displacements(motion)
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
    layout = lay_out(
        Wall(
            "w", 2.025, 1.2, (Opening(0.45, 0.9, 0.75),), precompression=1e5, restraints=restraints
        ),
        options,
    )
    free, weight = (
        mass_vector(layout) > 0,
        np.zeros((len(layout.bodies), 3 + (layout.strain.n_modes if layout.strain else 0))),
    )
    weight[:, 1] = -GRAVITY * layout.weighing
    expected = np.zeros(len(free))
    expected[free] = splu(stiffness_matrix(layout).tocsc()[free][:, free]).solve(
        weight.ravel()[free]
    )
    assert_allclose(
        static_displacement(layout).ravel(), expected, atol=1e-9 * np.abs(expected).max()
    )


def test_a_factor_makes_up_its_matrix(symmetric_wall):
    """L D L' of the stiffness of rigid bricks, in the order of elimination."""
    blocks = joint_stiffness(lay_out(symmetric_wall))
    factor, whole = factorised(blocks), blocks.sparse().toarray()
    n = len(factor.order)
    lower, diagonal = (np.zeros((n, 3, n, 3)) for _ in range(2))
    column = np.repeat(np.arange(n), np.diff(factor.start))
    lower[factor.below, :, column], diagonal[range(n), :, range(n)] = factor.lower, factor.diagonal
    lower, diagonal = (of.reshape(3 * n, 3 * n) for of in (lower, diagonal))
    unit = lower + np.eye(3 * n)
    order = (3 * factor.order[:, None] + np.arange(3)).ravel()
    assert (whole == whole.T).all()
    assert_allclose(
        unit @ diagonal @ unit.T, whole[np.ix_(order, order)], atol=1e-13 * np.abs(whole).max()
    )
    assert_allclose(factor.inverse @ factor.diagonal, np.tile(np.eye(3), (n, 1, 1)), atol=1e-9)


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
