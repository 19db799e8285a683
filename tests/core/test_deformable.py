"""Deformable bricks and Gauss points, against theory: patch test, beams, waves, free vibration,
energy.

E = 5.2 GPa, G = 2.16 GPa, so that Poisson's ratio is 0.204; 1900 kg/m3.  In plane stress waves
travel at
sqrt(E / (1 - nu^2) / rho) = 1690 and sqrt(G / rho) = 1066 m/s; across bed joints in series, 1/E +
1/(k_n h) and 1/G + 1/(k_s h), at 1643 and 1030 m/s.
"""

from dataclasses import replace

import numpy as np
import pytest
from conftest import one_line_error, total_energy
from numpy.testing import assert_allclose
from pytest import approx
from scipy.sparse.linalg import splu
from short_runs import solver_of

from damage import Brick, Joint, ModelOptions, Wall, load_wall
from damage.eigen import eigen
from damage.linear.modes import (
    mass_vector,
    natural_modes,
    static_displacement,
    stiffness_matrix,
)
from damage.measure.energy import energy_error
from damage.mechanics.tables import RIGID
from damage.reference.solver import ReferenceSolver
from damage.run.banner import describe_brick
from damage.run.schedule import deformable_warnings
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.strain import MASS_FACTOR, brick_modes, elasticity_of
from verification.triangles import Mesh

BRICK = Brick()
JOINT = Joint()
LENGTH = BRICK.length
HEIGHT = BRICK.height
THICKNESS = BRICK.thickness
ELASTIC = {"tensile_strength": 1e12, "cohesion": 1e12}
DEFORMABLE = {"bricks": "deformable", "contacts": "gauss", "lintel": "none"}


def lay(length, courses, joint=JOINT, precompression=0.0, **options):
    wall = Wall("w", length * LENGTH, courses * HEIGHT, precompression=precompression, joint=joint)
    return lay_out(wall, ModelOptions(**(DEFORMABLE | options)))


def stiffer(factor):
    return Joint(factor * JOINT.normal_stiffness, factor * JOINT.shear_stiffness)


def displacement(layout, force):
    """Linear displacement (n_bodies, coordinates) by forces of the same shape."""
    free = mass_vector(layout) > 0
    moved = np.zeros(free.size)
    moved[free] = splu(stiffness_matrix(layout).tocsc()[free][:, free]).solve(force.ravel()[free])
    return moved.reshape(force.shape)


def forces(layout):
    return np.zeros((len(layout.bodies), RIGID + layout.strain.n_modes))


# --- one brick ----------------------------------------------------------------------------------


@pytest.mark.parametrize(("order", "number"), [(2, 9), (3, 17)])
def test_modes_are_orthonormal_and_free_of_rigid_motion(order, number):
    modes = brick_modes(BRICK, LENGTH, order)
    assert len(modes.frequency) == number
    place, weight = np.polynomial.legendre.leggauss(8)
    x, z = (axis.ravel() for axis in np.meshgrid(place * LENGTH / 2, place * HEIGHT / 2))
    mass = np.outer(weight, weight).ravel() / 4 * BRICK.density * LENGTH * HEIGHT * THICKNESS
    moved = modes.displacement(x, z)
    assert_allclose(np.einsum("p,pcm,pcn->mn", mass, moved, moved), np.eye(number), atol=1e-12)
    rigid = np.stack([[0 * x + 1, 0 * x], [0 * x, 0 * x + 1], [-z, x]])
    assert_allclose(np.einsum("p,rcp,pcm->rm", mass, rigid, moved), 0, atol=1e-13)


def strain_at(modes, x, z, step=1e-6):
    """Strain along x, along z and shear by a unit of each mode at points (n,) [m]: (n, 3, modes),
    by central differences, exact of polynomials of order 2."""
    dx, dz = (
        (
            modes.displacement(x + i * step, z + j * step)
            - modes.displacement(x - i * step, z - j * step)
        )
        / (2 * step)
        for i, j in ((1, 0), (0, 1))
    )
    return np.stack([dx[:, 0], dz[:, 1], dz[:, 0] + dx[:, 1]], axis=1)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("length", [LENGTH, 0.1])
def test_modes_solve_the_eigenproblem_by_gauss_points(length, order):
    """Stresses of modes times strains of modes, over the brick, are the squares of their
    frequencies."""
    modes = brick_modes(BRICK, length, order)
    place, weight = np.polynomial.legendre.leggauss(5)
    x, z = (axis.ravel() for axis in np.meshgrid(place * length / 2, place * HEIGHT / 2))
    volume = np.outer(weight, weight).ravel() / 4 * length * HEIGHT * THICKNESS
    strain = strain_at(modes, x, z)
    stress = np.einsum("ij,pjm->pim", elasticity_of(BRICK), strain)
    squares = np.einsum("p,pim,pin->mn", volume, stress, strain)
    assert_allclose(squares, np.diag(modes.frequency**2), atol=1e-7 * modes.frequency[-1] ** 2)


@pytest.mark.parametrize("n", [1, 2, 3, 12])
def test_eigenvalues_are_those_of_lapack(n):
    root = np.random.default_rng(n).normal(size=(n, n)) * 10.0 ** -np.arange(n)
    for matrix in (root @ root.T, root[:, :1] @ root[:, :1].T, np.zeros((n, n))):
        squares, vectors = eigen(matrix)
        assert_allclose(
            np.sort(squares), np.linalg.eigvalsh(matrix), atol=1e-14 * np.abs(matrix).max()
        )
        assert_allclose(vectors.T @ vectors, np.eye(n), atol=1e-14)
        assert_allclose((vectors * squares) @ vectors.T, matrix, atol=1e-14 * np.abs(matrix).max())


def test_elasticity_in_plane_stress():
    ratio = 0.2037
    normal = 5.2e9 / (1 - ratio**2)
    assert_allclose(
        elasticity_of(BRICK),
        [[normal, ratio * normal, 0], [ratio * normal, normal, 0], [0, 0, 2.16e9]],
        rtol=2e-4,
    )


def orders(numbers, errors):
    """Between neighbours: minus the slope of ln |error| over ln number."""
    return -np.diff(np.log(np.abs(errors))) / np.diff(np.log(numbers))


def test_strain_modes_converge_by_their_order():
    """The two lowest frequencies of a free brick by polynomials of order p, over those of order 12.
    One stretches the brick along its length and is smooth: its error falls exponentially, so that
    the order of convergence in p doubles with p.  The other bends it, and leaves displacements of
    r^2.74 at the free corners (M. L. Williams, 1952): its order grows to 4 times that, 11
    (I. Babuska, M. Suri, 1987).  Bending gains nothing from odd p, stretching nothing from even p.
    """
    p = np.array([2, 4, 8])
    found = {order: brick_modes(BRICK, LENGTH, order).frequency[:2] for order in (*p, 3, 12)}
    assert_allclose(
        [found[2] / found[12] - 1, found[3] / found[12] - 1],
        [[0.183, 0.102], [0.183, 0.0003]],
        atol=2e-3,
    )
    bending, stretching = (
        orders(p, [found[order][mode] / found[12][mode] - 1 for order in p]) for mode in range(2)
    )
    assert 4 < bending[0] < 5 and 7 < bending[1] < 11
    assert 8 < stretching[0] < 9 and stretching[1] == approx(2 * stretching[0], rel=0.1)
    assert_allclose([found[3][0], found[3][1]], [found[2][0], found[4][1]], rtol=1e-6)


# --- statics ------------------------------------------------------------------------------------


def test_patch():
    """Uniform pressure on top of a wall on a base without friction: every stress in every brick is
    that pressure."""
    pressure = 1e6
    layout = lay(4, 6, Joint(**ELASTIC))
    contacts = layout.contacts
    base = np.flatnonzero(contacts.first < 0)
    shear = contacts.shear_stiffness.copy()
    shear[base[1:]] = 0.0  # one point holds the wall
    layout = replace(layout, contacts=replace(contacts, shear_stiffness=shear))
    load = forces(layout)
    (place, weight) = np.polynomial.legendre.leggauss(4)
    for brick in np.flatnonzero(layout.bodies.course == 5):
        length = layout.bodies.length[brick]
        modes = brick_modes(layout.wall.brick, length)
        moved = modes.displacement(place * length / 2, np.full(4, HEIGHT / 2))
        load[brick, 1] = -pressure * length * THICKNESS
        load[brick, RIGID:] = -pressure * length * THICKNESS * weight / 2 @ moved[:, 1]
    found = displacement(layout, load)
    for brick in range(layout.n_bricks):
        x, z = (axis.ravel() for axis in np.meshgrid([-0.5, 0.1, 0.5], [-0.5, 0.2, 0.5]))
        length = layout.bodies.length[brick]
        strain = strain_at(brick_modes(layout.wall.brick, length), x * length, z * HEIGHT)
        stress = strain @ found[brick, RIGID:] @ elasticity_of(layout.wall.brick)
        assert_allclose(stress / pressure, np.tile([0.0, -1.0, 0.0], (9, 1)), atol=1e-7)


def of_timoshenko(layout):
    """Deflections of a cantilever two bricks wide by a unit force at its top, along x: of the
    layout, and of the beam, by bending and by shear, h^3 / 3 E I and h / (5/6 G A), moduli of
    bricks in series with the bed joints [m/N]."""
    wall = layout.wall
    n = RIGID + (layout.strain.n_modes if layout.strain else 0)
    brick = wall.brick
    joint = wall.joint
    top = np.flatnonzero(layout.bodies.course == wall.courses - 1)
    share = layout.bodies.length[top] / (2 * LENGTH)
    load = np.zeros((len(layout.bodies), n))
    load[top, 0] = share
    young = 1 / (1 / brick.young_modulus + 1 / (joint.normal_stiffness * HEIGHT))
    shear = 1 / (1 / brick.shear_modulus + 1 / (joint.shear_stiffness * HEIGHT))
    height = (wall.courses - 0.5) * HEIGHT
    area = 2 * LENGTH * THICKNESS
    inertia = THICKNESS * (2 * LENGTH) ** 3 / 12
    return (
        displacement(layout, load)[top, 0] @ share,
        height**3 / (3 * young * inertia),
        1.2 * height / (shear * area),
    )


@pytest.mark.parametrize(("factor", "share"), [(1, 0.999), (1000, 0.994)])
def test_a_bonded_cantilever_bends_as_timoshenkos_beam(factor, share):
    """A plate clamped over its whole width is stiffer by 0.15 % at 36 courses (0.9985 by 12 x 71
    elements of nine nodes), and strain modes with stiff joints by 0.4 % more: half as much at twice
    the height."""
    found, bending, sheared = of_timoshenko(lay(2, 36, stiffer(factor)))
    assert found / (bending + sheared) == approx(share, abs=1e-3)


def test_without_lateral_contraction_a_share_of_the_shear_deflection_is_lost():
    """At a Poisson's ratio of zero the clamped base restrains nothing.  Strain modes of order 2
    lose a constant share of the shear deflection, whose stress is a parabola over the width."""
    brick = Brick(shear_modulus=BRICK.young_modulus / 2)
    for courses in (18, 36):
        wall = Wall(
            "w", 2 * LENGTH, courses * HEIGHT, precompression=0.0, joint=stiffer(1000), brick=brick
        )
        found, bending, sheared = of_timoshenko(lay_out(wall, ModelOptions(**DEFORMABLE)))
        assert (bending + sheared - found) / sheared == approx(0.12, abs=0.015)


# --- waves and periods --------------------------------------------------------------------------


def test_the_first_period_is_that_of_a_triangle_mesh():
    """Four cells a brick, of four constant-strain triangles each, whose nodes are the unknowns; two
    points a cell."""
    by_modes, by_mesh = (
        lay_out(
            load_wall("walls/solid.py"),
            ModelOptions(contacts="gauss", cells=cells, bricks="deformable"),
        )
        for cells in (2, 4)
    )
    assert natural_modes(by_modes, 1).period_s[0] == approx(
        Mesh(by_mesh, 4).first_period(), rel=3e-3
    )


def test_mass_scaling_lengthens_the_step_and_leaves_the_period():
    layout = lay(2, 12, precompression=3e5)
    of_true_mass = replace(layout.strain, mass=layout.strain.mass / MASS_FACTOR)
    true, scaled = (natural_modes(one, 1) for one in (replace(layout, strain=of_true_mass), layout))
    assert_allclose(scaled.period_s, true.period_s, rtol=1e-3)
    assert 2 < scaled.critical_time_step_s / true.critical_time_step_s <= 3


# --- dynamics -----------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [0.0, 0.1])
def test_a_strain_mode_vibrates_at_its_frequency_and_decays_by_its_damping(ratio):
    """A brick on joints a millionth as stiff: q = exp(-zeta w t) sin(w_d t) / w_d, w its frequency
    over sqrt(mass)."""
    layout = lay(1, 1, stiffer(1e-6), brick_damping=ratio)
    frequency = brick_modes(BRICK, layout.bodies.length[0]).frequency[1] / np.sqrt(MASS_FACTOR)
    solver = ReferenceSolver(layout, 0.002 / frequency)
    solver.start(np.zeros((0, 2)), np.zeros(1))
    solver.system.velocity[0, RIGID + 1] = 1e-6
    damped = frequency * np.sqrt(1 - ratio**2)
    for _ in range(3):
        solver.run(1000)
        t = (solver.step + 0.5) * solver.time_step - solver.time_step / 2
        wanted = 1e-6 * np.exp(-ratio * frequency * t) * np.sin(damped * t) / damped
        assert_allclose(solver.system.place[0, RIGID + 1], wanted, atol=2e-3 * 1e-6 / frequency)


def test_weight_and_base_do_not_excite_strain_in_free_bricks():
    solver = solver_of(lay(1, 1, stiffer(1e-11)))
    solver.start(np.full((50, 2), 3.0))
    solver.run(50)
    assert np.abs(solver.system.velocity[0, :2]).min() > 0
    assert (
        np.abs(solver.system.place[0, RIGID:]).max()
        < 1e-9 * np.abs(solver.system.place[0, :2]).max()
    )


def test_a_wall_begins_at_rest_and_on_its_weight():
    layout = lay(3, 6, precompression=3e5)
    solver = solver_of(layout)
    solver.add_static_displacement()
    force, _ = solver.forces()
    weight = GRAVITY * layout.bodies.mass
    assert_allclose(solver.base_reaction(), weight.sum(), rtol=1e-5)  # it is linear
    assert np.abs(force[:, 1] - weight).max() < 1e-4 * weight.sum()
    assert not solver.state.any()
    own = solver.strain.stiffness[:-1] * solver.system.place[:-1, RIGID:]
    assert_allclose(solver.system.force[:-1, RIGID:], own, atol=1e-4 * np.abs(own).max())
    assert_allclose(static_displacement(layout), solver.system.place[:-1])


@pytest.mark.parametrize("damping", [{"local": 0.7}, {"adaptive": 1.0}], ids=str)
def test_damping_of_static_solutions_acts_on_strain_modes(damping):
    solver = solver_of(lay(2, 4, Joint(**ELASTIC), precompression=3e5, brick_damping=0.0))
    solver.add_static_displacement()
    solver.start(np.zeros((0, 2)))
    strain = solver.system.velocity[:-1, RIGID:]
    strain[:] = np.where(solver.system.mass[:-1, RIGID:] > 0, 1e-5, 0.0)
    solver.run(1)
    began = total_energy(solver)
    kick = solver.kinetic_energy()
    solver.damp(**damping)
    solver.run(6000)
    assert np.abs(strain).max() < 1e-3 * 1e-5
    assert solver.kinetic_energy() < 1e-4 * kick
    assert_allclose(total_energy(solver), began, atol=0.05 * kick)  # what was taken is counted


def test_a_run_has_a_balanced_history(run_of):
    history = run_of("deformable")
    assert (history.model.bricks, history.model.contacts) == ("deformable", "gauss")
    assert energy_error(history.series) < 5e-3
    assert history.series["damping_energy_j"].iloc[-1] > 0
    assert set(history.events["kind"]) >= {"tension", "opened"}


# --- options ------------------------------------------------------------------------------------


def test_options_of_deformable_bricks_alone():
    assert "beside --bricks deformable" in one_line_error(ModelOptions, brick_damping=0.1)
    assert "even number" in one_line_error(ModelOptions, contacts="gauss", cells=3)
    soft = Wall("w", 0.9, 0.45, brick=Brick(shear_modulus=1e9))
    assert "Poisson's ratio" in one_line_error(lay_out, soft, ModelOptions(**DEFORMABLE))


def test_choices_that_do_not_suit_deformable_bricks_are_warned_of():
    suited = ModelOptions(**DEFORMABLE)
    plain = Wall("w", 2.0, 1.0)
    soft = replace(plain, joint=Joint(mode_i_fracture_energy=12, mode_ii_fracture_energy=120))
    assert deformable_warnings(suited, soft) == deformable_warnings(ModelOptions(), plain) == []
    (brittle,) = deformable_warnings(suited, plain)
    (corners,) = deformable_warnings(replace(suited, contacts="corners"), soft)
    assert "fracture energies" in brittle and "--contacts gauss" in corners
    splitting = replace(soft, brick=Brick(tensile_strength=2e6))
    (whole,) = deformable_warnings(suited, splitting)
    assert "a tensile strength of 2 MPa of the bricks: deformable bricks do not split" in whole
    assert describe_brick(BRICK, suited).endswith("modulus 5200 MPa, deformable")
