"""Observed orders of convergence: contact points per half brick, and polynomials of the strain modes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from test_deformable import finite_elements
from test_soil import periods

from damage.law.modes import natural_modes
from damage.reference.solver import ReferenceSolver
from damage.units import GRAVITY
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Wall
from damage.wall.strain import brick_modes

LENGTH, HEIGHT, WIDTH = 0.4, 0.8, 0.2
DRY = Joint(12e10, 4e10, tensile_strength=0.0, cohesion=0.0)
CELLS = 4, 8, 16


def block(contacts, cells):
    """The Layout of a rigid block on a dry base."""
    wall = Wall("block", LENGTH, HEIGHT, precompression=0.0, brick=Brick(LENGTH, HEIGHT, WIDTH), joint=DRY)
    return lay_out(wall, ModelOptions(contacts=contacts, cells=cells))


def segments(contacts, cells):
    """Parts of the base between contact points, or around each."""
    return 2 * (cells - 1 if contacts == "corners" else cells)


def orders(numbers, errors):
    """Between neighbours: minus the slope of ln |error| over ln number."""
    return -np.diff(np.log(np.abs(errors))) / np.diff(np.log(numbers))


@pytest.mark.parametrize("contacts", ["interior", "corners", "gauss"])
def test_the_rocking_period_of_an_intact_base_is_of_second_order_in_the_cells(contacts):
    """The stiffness is the integral of x^2 over the base: points in the middle of cells miss 1 / n^2 of it, those at
    their ends have 2 / n^2 too much, two Gauss points have it all."""
    layouts = [block(contacts, cells) for cells in CELLS]
    exact = periods(layouts[0], weight=False).max()
    errors = [natural_modes(layout, 1).period_s[0] / exact - 1 for layout in layouts]
    if contacts == "gauss":
        assert_allclose(errors, 0.0, atol=2.0**-26)  # to which periods are rounded
    else:
        assert_allclose(orders([segments(contacts, cells) for cells in CELLS], errors), 2.0, atol=0.1)
        assert all(error > 0 for error in errors) == (contacts == "interior")


def tilt(layout, closed):
    """Rotation of the block at rest under a horizontal acceleration by which `closed` of its base's length bears, over
    that of Navier's triangle of stresses, of length c: 2 N / (k c^2)."""
    weight, c = GRAVITY * layout.total_mass, closed * LENGTH
    solver = ReferenceSolver(layout, 0.5 * natural_modes(layout, 1).critical_time_step_s)
    solver.damp(adaptive=1.0)
    along = (LENGTH / 2 - c / 3) / (HEIGHT / 2) * GRAVITY
    solver.start(np.tile([along, 0.0], (20_002, 1)))
    solver.run(20_000)
    assert solver.kinetic_energy() < 1e-12
    return abs(solver.displacement[0, 2]) * layout.contacts.normal_stiffness[0] * WIDTH * c**2 / (2 * weight)


@pytest.mark.parametrize("contacts", ["interior", "corners", "gauss"])
def test_the_tilt_of_a_base_that_gapes_is_of_second_order_in_the_cells(contacts):
    """Stresses have a kink where the base opens, anywhere in a cell: of second order in the mean over eleven places,
    Gauss points included."""
    errors = [np.sqrt(np.mean([(tilt(block(contacts, cells), closed) - 1)**2 for closed in np.linspace(0.4, 0.9, 11)]))
              for cells in CELLS]
    assert_allclose(orders([segments(contacts, cells) for cells in CELLS], errors), 2.0, atol=0.3)


def test_strain_modes_converge_by_their_order():
    """The two lowest frequencies of a free brick by polynomials of order p, over those of order 12 and, near these, of
    finite elements.  One stretches the brick along its length and is smooth: its error falls exponentially, so that
    the order of convergence in p doubles with p.  The other bends it, and leaves displacements of r^2.74 at the free
    corners (M. L. Williams, 1952): its order grows to 4 times that, 11 (I. Babuska, M. Suri, 1987).  Bending gains
    nothing from odd p, stretching nothing from even p.
    """
    brick, p = Brick(), np.array([2, 4, 8])
    found = {order: brick_modes(brick, brick.length, order, "stress").frequency[:2] for order in (*p, 3, 12)}
    assert_allclose(finite_elements(8, 4, 2), found[12], rtol=1e-3)
    bending, stretching = (orders(p, [found[order][mode] / found[12][mode] - 1 for order in p]) for mode in range(2))
    assert 4 < bending[0] < 5 and 7 < bending[1] < 11
    assert 8 < stretching[0] < 9 and stretching[1] == pytest.approx(2 * stretching[0], rel=0.1)
    assert_allclose([found[3][0], found[3][1]], [found[2][0], found[4][1]], rtol=1e-6)
