"""Deformable bricks: strain modes of a free brick, and their displacements at every contact point.

A point r of a brick is at x = c + R(rotation) (r + sum_k Phi_k(r) q_k): a rigid motion, and the free vibration modes
Phi_k of the brick (floating frame).  The modes are those of all polynomial displacements up to an order in the plane,
by K v = omega^2 M v with v' M v = 1, without the three rigid ones: of order 2 nine, whose strains are linear.  Mass and
stiffness are then diagonal, and neither weight nor the motion of the base excites q, for the modes are orthogonal to
rigid motion.

Whole polynomial spaces alone bend as bricks do in a bond: constant strain, and a selection of modes by frequency, make
walls several times too stiff.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import eigh

from damage.errors import InputError

RIGID_MODES = 3


@dataclass(frozen=True)
class BrickModes:
    """Strain modes of a brick of a length and height [m].

    powers: (n, 2) of x and z in each polynomial; frequency: (n_modes,) [rad/s]; coefficients: (2, n, n_modes) of the
    displacement along x and z [1/sqrt(kg)], in coordinates that go from -1 to 1; elasticity: (3, 3) stress by strain
    [Pa].
    """

    length: float
    height: float
    powers: np.ndarray
    frequency: np.ndarray
    coefficients: np.ndarray
    elasticity: np.ndarray

    def displacement(self, x, z):
        """Along x and z by a unit of each mode, (n, 2, n_modes) [1/sqrt(kg)], at points (n,) [m] from the centre."""
        terms, _, _ = _polynomials(self.powers, 2 * x / self.length, 2 * z / self.height)
        return np.einsum("pi,cim->pcm", terms, self.coefficients)

    def stress(self, x, z):
        """Normal stress along x and z, tension positive, and shear stress by a unit of each mode, (n, 3, n_modes)
        [Pa/(m sqrt(kg))], at points x, z (n,) [m] from the centre."""
        _, along_x, along_z = _polynomials(self.powers, 2 * x / self.length, 2 * z / self.height)
        dx, dz = (np.einsum("pi,cim->cpm", 2 / size * terms, self.coefficients)
                  for size, terms in ((self.length, along_x), (self.height, along_z)))
        return np.einsum("ij,jpm->pim", self.elasticity, np.stack([dx[0], dz[1], dz[0] + dx[1]]))


@dataclass(frozen=True)
class Strain:
    """Strain modes of all bodies of a Layout, and their displacements at its contact points.

    mass, stiffness, damping: (n_bodies, n_modes) of each mode, the first with the scaling of `ModelOptions.brick_mass`
    [1, 1/s2, 1/s], zero of caps; shapes: (n_shapes, 2, n_modes) displacement along the normal and the tangent of a
    contact point by a unit of each mode [1/sqrt(kg)], the first zero, of bodies that do not deform; first, second:
    (n_contacts,) rows of these.
    """

    mass: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    shapes: np.ndarray
    first: np.ndarray
    second: np.ndarray

    @property
    def n_modes(self):
        """Number of modes of a brick."""
        return self.mass.shape[1]


@lru_cache(maxsize=64)
def brick_modes(brick, length, order, plane):
    """BrickModes of a damage.wall.parameters.Brick cut to a length [m]; order: of the polynomials; plane: "stress" or
    "strain"."""
    powers = np.array([(i, j) for i in range(order + 1) for j in range(order + 1 - i)])
    elasticity, n = elasticity_of(brick, plane), len(powers)
    place, weight = np.polynomial.legendre.leggauss(order + 1)  # exact of the products of two polynomials
    x, z = (axis.ravel() for axis in np.meshgrid(place, place))
    volume = np.outer(weight, weight).ravel() * length * brick.height * brick.thickness / 4
    terms, along_x, along_z = _polynomials(powers, x, z)
    strains = np.zeros((len(x), 3, 2 * n))
    strains[:, 0, :n] = strains[:, 2, n:] = 2 / length * along_x
    strains[:, 1, n:] = strains[:, 2, :n] = 2 / brick.height * along_z
    mass = np.kron(np.eye(2), np.einsum("p,pi,pj->ij", brick.density * volume, terms, terms))
    stiffness = np.einsum("p,psi,st,ptj->ij", volume, strains, elasticity, strains)
    squares, vectors = (found[..., RIGID_MODES:] for found in eigh(stiffness, mass))
    largest = np.take_along_axis(vectors, np.abs(vectors).argmax(axis=0)[None], axis=0)
    return BrickModes(length, brick.height, powers, np.sqrt(squares),
                      (vectors * np.sign(largest)).reshape(2, n, -1), elasticity)


def stress_by_modes(layout):
    """Stress along x, along z and shear in all bodies of a Layout, at the centre and at the corners, counter-clockwise
    from the lower left, by a unit of each mode: (n_bodies, 5, 3, n_modes) [Pa/(m sqrt(kg))], zero of caps."""
    places = np.array([(0.0, 0.0), (-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)])
    found = np.zeros((len(layout.bodies), len(places), 3, layout.strain.n_modes))
    for brick in range(layout.n_bricks):
        modes = modes_of(layout, brick)
        found[brick] = modes.stress(*(places * (modes.length, modes.height)).T)
    return found


def modes_of(layout, brick):
    """BrickModes of a brick of a Layout."""
    length, options = round(float(layout.bodies.length[brick]), 12), layout.options
    return brick_modes(layout.wall.brick, length, options.brick_order, options.plane)


def elasticity_of(brick, plane):
    """Stress by strain (3, 3) [Pa]: sigma_x, sigma_z, tau of epsilon_x, epsilon_z, gamma, in plane "stress" or
    "strain".  Raises InputError where the moduli are of no isotropic material."""
    young, shear = brick.young_modulus, brick.shear_modulus
    poisson = young / (2 * shear) - 1
    most = 1.0 if plane == "stress" else 0.5
    if not -1 < poisson < most:
        raise InputError(f"--bricks deformable: moduli of {young:g} and {shear:g} Pa make Poisson's ratio E / 2 G - 1 "
                         f"= {poisson:.3g}: expected less than {most:g} in plane {plane}; correct Brick.shear_modulus")
    ratio = poisson if plane == "stress" else poisson / (1 - poisson)
    normal = (young if plane == "stress" else young / (1 - poisson**2)) / (1 - ratio**2)
    return np.array([[normal, ratio * normal, 0.0], [ratio * normal, normal, 0.0], [0.0, 0.0, shear]])


def strain_of(brick, options, bodies, contacts, n_bricks):
    """The Strain of bricks of a damage.Brick by ModelOptions; bodies, contacts: tables of a Layout.

    Bricks with a tensile strength stay whole; `damage.measure.brick_stress` tells where they would split.
    """
    modes = [brick_modes(brick, round(float(length), 12), options.brick_order, options.plane)
             for length in bodies.length[:n_bricks]]
    frequency = np.zeros((len(bodies), len(modes[0].frequency)))
    frequency[:n_bricks] = [of.frequency for of in modes]
    own_mass = brick.density * brick.thickness * bodies.length * bodies.height
    # Where the top course carries mass, all of a brick is heavier alike: the modes stay, at lower frequencies.
    mass = np.where(frequency > 0, options.brick_mass * (bodies.mass / own_mass)[:, None], 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        damping = np.where(mass > 0, 2 * options.brick_damping * frequency / np.sqrt(mass), 0.0)
    shapes, (first, second) = _shapes(modes, bodies, contacts)
    return Strain(mass, frequency**2, damping, shapes, first, second)


def _shapes(modes, bodies, contacts):
    """Shapes of a Strain, and their rows on both sides of every contact point; modes: BrickModes of each brick."""
    shapes, numbers, sides = [np.zeros((2, len(modes[0].frequency)))], {}, []
    for side in (contacts.first, contacts.second):
        rows = np.zeros(len(contacts), int)
        for k in np.flatnonzero((side >= 0) & (side < len(modes))):
            brick, upright = side[k], bool(contacts.upright[k])
            place = contacts.x[k] - bodies.x[brick], contacts.z[k] - bodies.z[brick]
            key = modes[brick].length, *np.round(place, 9).tolist(), upright
            if key not in numbers:
                numbers[key] = len(shapes)
                moved, = modes[brick].displacement(*np.array(place)[:, None])
                shapes.append(moved if upright else moved[::-1])
            rows[k] = numbers[key]
        sides.append(rows)
    return np.array(shapes), sides


def _polynomials(powers, x, z):
    """Polynomials (n_points, n) at points of -1 to 1, and their derivatives by these coordinates."""
    x, z = np.asarray(x)[:, None], np.asarray(z)[:, None]
    i, j = powers.T
    return (x**i * z**j, i * x**np.maximum(i - 1, 0) * z**j, j * x**i * z**np.maximum(j - 1, 0))
