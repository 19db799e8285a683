"""Natural modes against closed forms, and the periods of the three walls."""

import json
from dataclasses import replace

import numpy as np
import pytest
from conftest import REPOSITORY, refused_with
from numpy.testing import assert_allclose

from damage.law.modes import contact_normals, kinematic_matrix, mass_vector, natural_modes, stiffness_matrix
from damage.wall.kinematics import ContactKinematics
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Opening, Wall

PERIODS_S = {"solid": 0.0637, "symmetric": 0.2003, "asymmetric": 0.1745}
"""First periods, which both solvers vibrate with (README.md); the paper's are 0.06 and about 0.2 s."""


def test_first_period_is_the_one_that_the_solvers_show(shipped_wall):
    period_s = natural_modes(lay_out(shipped_wall)).period_s[0]
    assert period_s == pytest.approx(PERIODS_S[shipped_wall.name], abs=5e-5)


def test_critical_step_of_the_shipped_walls(shipped_wall):
    # 4.666e-5 s by an independent eigenvalue analysis; 0.1 % is its last digit.
    assert natural_modes(lay_out(shipped_wall)).critical_time_step_s == pytest.approx(4.666e-5, rel=1e-3)


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
    omega = np.sqrt(np.append(np.linalg.eigvalsh(np.linalg.solve(root, matrix) @ np.linalg.inv(root)),
                              k_n * area / mass))
    full = stiffness_matrix(layout).toarray() / np.sqrt(np.outer(*[mass_vector(layout)] * 2))
    assert_allclose(np.sqrt(np.linalg.eigvalsh(full)), np.sort(omega), rtol=1e-10)


HALF_BRICK_PIER = Wall("half", 2.025, 1.2, (Opening(0.1125, 0.9, 0.75),), lintel="courses")


@pytest.mark.parametrize("options", [{}, {"cells": 3}, {"contacts": "corners"}, {"contacts": "corners", "cells": 1}])
def test_a_half_brick_pier_with_its_cap_vibrates(options):
    period_s = natural_modes(lay_out(HALF_BRICK_PIER, ModelOptions(**options))).period_s
    assert period_s[0] == pytest.approx(0.067, rel=0.04)  # 0.0647 to 0.0682 s; with the cap on a hinge 1e6 s


def test_the_command_tells_periods_and_stress_as_json(output_of):
    printed = json.loads(output_of("modes", REPOSITORY / "walls/symmetric.py", "--json", "--load", "piers"))
    assert printed["pier_stress_pa"] == pytest.approx(0.3e6)
    assert printed["period_s"][0] == pytest.approx(0.1436, abs=5e-5)  # about 1 / sqrt(2) of 0.2003 s: half of the mass


def test_half_bricks_have_two_contact_points_each_and_so_cannot_turn():
    """With one contact point a half brick's length they turned, and were refused; now the pier is that of two, but for
    the glue of its cap, which is at the ends of a single cell."""
    one, two = (natural_modes(lay_out(HALF_BRICK_PIER, ModelOptions(cells=cells))).period_s for cells in (1, 2))
    assert_allclose(one[0], two[0], rtol=5e-3)


def test_a_cap_on_a_hinge_has_no_period_even_where_rounding_gives_it_one():
    layout = lay_out(HALF_BRICK_PIER, ModelOptions(contacts="corners"))
    glue = layout.contacts.second == layout.n_bricks  # of the cap on half a brick
    middle = np.where(glue, layout.bodies.x[layout.n_bricks], layout.contacts.x)
    refused_with("can move freely", natural_modes, replace(layout, contacts=replace(layout.contacts, x=middle)))


def test_modes_solve_the_eigenproblem(symmetric_wall):
    layout = lay_out(symmetric_wall)
    modes = natural_modes(layout, 3)
    for period, shape in zip(modes.period_s, modes.shape):
        force = stiffness_matrix(layout) @ shape.ravel()
        inertia = (2 * np.pi / period) ** 2 * mass_vector(layout) * shape.ravel()
        assert_allclose(force, inertia, atol=1e-6 * np.abs(inertia).max())


def test_small_motion_of_exact_kinematics_is_the_linear_one(symmetric_wall):
    layout = lay_out(symmetric_wall)
    motion = np.random.default_rng(1).normal(0, 1e-7, (len(layout.bodies), 3))
    normals = contact_normals(layout.contacts)
    opening, shear = ContactKinematics(layout).displacements(motion)
    # Second order in rotations of 1e-7: 1e-14 m beside displacements of 1e-7 m.
    assert_allclose(opening, kinematic_matrix(layout, normals) @ motion.ravel(), atol=1e-13)
    assert_allclose(shear, kinematic_matrix(layout, normals[:, ::-1]) @ motion.ravel(), atol=1e-13)


def test_large_rigid_rotation_opens_no_joint_between_bricks(symmetric_wall):
    layout = lay_out(symmetric_wall)
    x, z, turn = layout.bodies.x, layout.bodies.z, 0.3
    cos, sin = np.cos(turn), np.sin(turn)
    motion = np.column_stack([cos * x - sin * z - x, sin * x + cos * z - z, np.full(len(x), turn)])
    opening, shear = ContactKinematics(layout).displacements(motion)
    inner = layout.contacts.first >= 0
    assert_allclose(opening[inner], 0.0, atol=1e-12)
    assert_allclose(shear[inner], 0.0, atol=1e-12)


def test_rotations_reach_the_cosine_without_gaps(monkeypatch, symmetric_wall):
    """Right behind a strided input numpy may take another cosine: two runs of one command would not be the same."""
    layout = lay_out(symmetric_wall)
    given = []
    cos = np.cos
    monkeypatch.setattr(np, "cos", lambda angle: given.append(angle.strides) or cos(angle))
    for select in (slice(None), np.array([5])):
        ContactKinematics(layout).displacements(np.zeros((len(layout.bodies), 3)), select)
    assert set(given) == {(8,)}


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
