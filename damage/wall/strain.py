"""Deformable bricks: strain modes of a free brick, and their displacements at every contact point.

A point r of a brick is at x = c + R(rotation) (r + sum_k Phi_k(r) q_k): a rigid motion, and the
free vibration modes Phi_k of the brick (floating frame).  The modes are those of all polynomial
displacements up to an order in plane stress, by K v = omega^2 M v with v' M v = 1, without the
three rigid ones: of order 2 nine, whose strains are linear.  Mass and stiffness are then diagonal,
and neither weight nor the motion of the base excites q, for the modes are orthogonal to rigid
motion.

Whole polynomial spaces alone bend as bricks do in a bond: constant strain, and a selection of modes
by frequency, make walls several times too stiff.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from damage.eigen import eigen, rotate
from damage.errors import InputError
from damage.rounded import to_bits

ORDER = 2
"""Order of the polynomials: the least that bends bricks; of order 3, which doubles the modes, walls
of stiff joints are softer by 0.4 %."""
MASS_FACTOR = 9.0
"""On the mass of strain modes: the critical time step grows from 4.2 to 8.6 us, and first periods
of walls, to which the modes give stiffness alone, keep five digits."""


@dataclass(frozen=True)
class BrickModes:
    """Strain modes of a brick of a length and height [m].

    degrees: (n, 2) along x and z of each product of Legendre polynomials; frequency: (n_modes,)
    [rad/s]; coefficients: (2, n, n_modes) of the displacement along x and z [1/sqrt(kg)], in
    coordinates that go from -1 to 1.
    """

    length: float
    height: float
    degrees: np.ndarray
    frequency: np.ndarray
    coefficients: np.ndarray

    def displacement(self, x, z):
        """Along x and z by a unit of each mode, (n, 2, n_modes) [1/sqrt(kg)], at points (n,) [m]
        from the centre."""
        terms = _polynomials(self.degrees, 2 * x / self.length, 2 * z / self.height)
        return sum(
            terms[:, k, None, None] * self.coefficients[:, k] for k in range(len(self.degrees))
        )


@dataclass(frozen=True)
class Strain:
    """Strain modes of all bodies of a Layout, and their displacements at its contact points.

    mass, stiffness, damping: (n_bodies, n_modes) of each mode, the first times `MASS_FACTOR` [1,
    1/s2, 1/s], zero of caps; shapes: (n_shapes, 2, n_modes)
    displacement along the normal and the tangent of a contact point by a unit of each mode
    [1/sqrt(kg)], the first zero, of bodies that do not deform; first, second: (n_contacts,) rows of
    these.
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
def brick_modes(brick, length, order=ORDER):
    """BrickModes of a damage.wall.parameters.Brick cut to a length [m]; order: of the polynomials.

    Modes are odd or even in x and in z: each of the four classes has its own problem, so that equal
    frequencies of a square brick belong to different ones and their modes are none of any mixture.
    """
    degrees = np.array([(i, j) for i in range(order + 1) for j in range(order + 1 - i)])
    height = brick.height
    n = len(degrees)
    matrix = _stiffness(degrees, length, height, elasticity_of(brick))
    density = to_bits(brick.density)
    matrix /= density
    # Rigid are the constants, and what the linear terms make of the brick's rotation; beside that
    # they make a shear.
    constant = 0
    along_z = 1
    along_x = n + order + 1
    diagonal = math.sqrt(length * length + height * height)
    turn = along_z, along_x, length / diagonal, height / diagonal
    rotate(matrix, *turn)
    rotate(matrix.T, *turn)
    parity = (np.vstack([degrees, degrees + 1]) % 2).tolist()
    strains = [k for k in range(2 * n) if k not in (constant, n + constant, along_x)]
    squares = []
    vectors = []
    for parities in ((0, 0), (0, 1), (1, 0), (1, 1)):
        group = [k for k in strains if tuple(parity[k]) == parities]
        eigenvalues, of_own = eigen(matrix[np.ix_(group, group)])
        whole = np.zeros((2 * n, len(group)))
        whole[group] = of_own
        whole[along_x], whole[along_z] = turn[3] * whole[along_z], turn[2] * whole[along_z]
        squares.append(eigenvalues)
        vectors.append(whole)
    frequency = np.sqrt(np.concatenate(squares))
    vectors = np.hstack(vectors)
    order = np.argsort(to_bits(frequency), kind="stable")  # of equal ones by their classes
    mass = density * length * height * brick.thickness
    vectors = np.stack([_with_sign(vector) for vector in vectors.T[order]], axis=1) / math.sqrt(
        mass
    )
    return BrickModes(
        length=length,
        height=height,
        degrees=degrees,
        frequency=frequency[order],
        coefficients=vectors.reshape(2, n, -1),
    )


def _with_sign(vector):
    """A vector, or its negative: the first element of at least half the largest is positive, so
    that no tie decides."""
    size = np.abs(vector)
    return vector * np.sign(vector[np.argmax(size >= size.max() / 2)])


def elasticity_of(brick):
    """Stress by strain (3, 3) [Pa]: sigma_x, sigma_z, tau of epsilon_x, epsilon_z, gamma, in plane
    stress.  Raises InputError where the moduli are of no isotropic material."""
    young = to_bits(brick.young_modulus)
    shear = to_bits(brick.shear_modulus)
    poisson = young / (2 * shear) - 1
    if not -1 < poisson < 1:
        raise InputError(
            f"--bricks deformable: moduli of {young:g} and {shear:g} Pa make Poisson's ratio E / 2"
            f" G - 1 = {poisson:.3g}: expected less than 1 in plane stress; correct"
            " Brick.shear_modulus"
        )
    normal = young / (1 - poisson * poisson)
    return np.array(
        [[normal, poisson * normal, 0.0], [poisson * normal, normal, 0.0], [0.0, 0.0, shear]]
    )


def strain_of(brick, options, bodies, contacts, n_bricks):
    """The Strain of bricks of a damage.Brick by ModelOptions; bodies, contacts: tables of a Layout.

    Bricks with a tensile strength stay whole.
    """
    # last bits do not distinguish lengths
    lengths = [round(float(length), 12) for length in bodies.length[:n_bricks]]
    modes = [brick_modes(brick, length) for length in lengths]
    frequency = np.zeros((len(bodies), len(modes[0].frequency)))
    frequency[:n_bricks] = [mode.frequency for mode in modes]
    own_mass = brick.density * brick.thickness * bodies.length * bodies.height
    # Where the top course carries mass, all of a brick is heavier alike: the modes stay, at lower
    # frequencies.
    mass = np.where(frequency > 0, MASS_FACTOR * to_bits(bodies.mass / own_mass)[:, None], 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        damping = np.where(mass > 0, 2 * options.brick_damping * frequency / np.sqrt(mass), 0.0)
    shapes, (first, second) = _shapes(modes, bodies, contacts)
    return Strain(
        mass=mass,
        stiffness=frequency**2,
        damping=damping,
        shapes=shapes,
        first=first,
        second=second,
    )


def _shapes(modes, bodies, contacts):
    """Shapes of a Strain, and their rows on both sides of every contact point; modes: BrickModes of
    each brick."""
    shapes = [np.zeros((2, len(modes[0].frequency)))]
    numbers = {}
    sides = []
    for side in (contacts.first, contacts.second):
        rows = np.zeros(len(contacts), int)
        for k in np.flatnonzero((side >= 0) & (side < len(modes))):
            brick = side[k]
            upright = bool(contacts.upright[k])
            place = contacts.x[k] - bodies.x[brick], contacts.z[k] - bodies.z[brick]
            key = modes[brick].length, *np.round(place, 9).tolist(), upright
            if key not in numbers:
                numbers[key] = len(shapes)
                (moved,) = modes[brick].displacement(*np.array(place)[:, None])
                shapes.append(moved if upright else moved[::-1])
            rows[k] = numbers[key]
        sides.append(rows)
    return np.array(shapes), sides


def _stiffness(degrees, length, height, elasticity):
    """Stiffness (2 n, 2 n) of a brick over its volume [Pa/m2]: twice the mean energy of
    displacements along x, then along z, by products of polynomials p of these degrees, sqrt(2 k +
    1) times Legendre's, the mean of whose squares is 1.  That of p_i' p_k' is half of m (m + 1)
    sqrt(2 i + 1) sqrt(2 k + 1), m the lower degree, where both are odd or even; that of p_i' p_k is
    the root where i > k and one of them is odd, the other even."""
    size = np.arange(degrees.max() + 1)
    root = np.sqrt((2.0 * size + 1) * (2.0 * size[:, None] + 1))
    low = np.minimum(size, size[:, None])
    alike = (size + size[:, None]) % 2 == 0
    same = np.eye(len(size))
    once = np.where(~alike & (size[:, None] > size), root, 0.0)
    twice = np.where(alike, root * (low * (low + 1) / 2), 0.0)
    i, j = (degree[:, None] for degree in degrees.T)
    k, m = degrees.T
    per_x = 2 / length
    per_z = 2 / height
    shear = elasticity[2, 2]
    along_x = per_x * per_x * (twice[i, k] * same[j, m])
    along_z = per_z * per_z * (same[i, k] * twice[j, m])
    mixed = (
        per_x
        * per_z
        * (elasticity[0, 1] * (once[i, k] * once[m, j]) + shear * (once[k, i] * once[j, m]))
    )
    return np.block(
        [
            [elasticity[0, 0] * along_x + shear * along_z, mixed],
            [mixed.T, elasticity[1, 1] * along_z + shear * along_x],
        ]
    )


def _polynomials(degrees, x, z):
    """Return products of polynomials as of `_stiffness`, (n_points, n), at points of -1 to 1."""
    of_x, of_z = (_legendre(np.asarray(place, float), degrees.max()) for place in (x, z))
    i, j = degrees.T
    return (of_x[i] * of_z[j]).T


def _legendre(x, most):
    """Return Legendre polynomials up to a degree at points (n,), times sqrt(2 k + 1): (degrees,
    n)."""
    values = [np.ones(len(x)), x]
    for k in range(1, most):
        values.append(((2 * k + 1) * x * values[k] - k * values[k - 1]) / (k + 1))
    root = np.sqrt(2.0 * np.arange(most + 1) + 1)[:, None]
    return root * np.array(values[: most + 1])
