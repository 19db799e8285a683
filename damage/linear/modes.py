"""Natural modes of a wall with intact joints, and the critical time step of central differences.

Every body has three degrees of freedom, (u_x, u_z, rotation), the rotation turning x towards z, and
behind them the strain modes where bricks deform, or those out of the plane
(`HouseLayout`).  A contact at the offset r from a body's centre moves by (u_x - rotation r_z, u_z +
rotation r_x), and by the strain modes' displacements there.
"""

import hashlib
from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, diags
from scipy.sparse.linalg import eigsh

from damage.errors import InputError
from damage.linear.blocks import Blocks, factorised, sum_of_products
from damage.rounded import down_to_three_digits, to_bits
from damage.units import GRAVITY
from damage.wall.kinds import CAP_COURSE, LINTEL_COURSE
from damage.wall.layout import Layout
from damage.wall.restraints import top_of

_ROUNDING = 100 * np.finfo(float).eps
"""A squared frequency below this share of the highest is rounding, of a part that can move
freely."""
_OF_HIGHEST = 1e-9
"""Tolerance of the highest squared frequency, which is rounded to three digits."""
_MOST_ITERATIONS = 1000
"""Largest number of iterations for the first mode."""
_CONVERGED = 1e-10
"""Error of the first mode [-], which falls by the ratio of the two lowest squared frequencies in
each iteration."""
_MOST_CACHED = 16
_CACHE = {}  # {all that modes, static displacements or scaled masses depend on: these}


@dataclass(frozen=True)
class Modes:
    """period_s (n_modes,), longest first; shape (n_modes, n_bodies, coordinates) in [m, m, rad, m
    sqrt(kg) ...], scaled to a mean top-course displacement of 1 m, or, where that is zero, to a
    largest one of 1 m; critical_time_step_s, and masonry_time_step_s where the inside of lintels'
    beams does not limit it.  All are rounded (`damage.rounded`), so that the last bits of libraries
    end here."""

    period_s: np.ndarray
    shape: np.ndarray
    critical_time_step_s: float
    masonry_time_step_s: float


def inside_lintels(layout: Layout) -> np.ndarray:
    """Which contact points join two segments of a lintel's beam, which stay elastic: (n_contacts,)
    of bool."""
    first = layout.contacts.first
    second = layout.contacts.second
    is_segment = layout.bodies.course == LINTEL_COURSE
    return (first >= 0) & (second >= 0) & is_segment[first] & is_segment[second]


def joint_stiffness(
    layout: Layout, factor: float = 1.0, points: slice | np.ndarray = slice(None)
) -> Blocks:
    """Return the stiffness of contact points [N/m, N, N m] times a factor, as Blocks; points:
    which, all by default."""
    contacts = layout.contacts
    rows = layout.directions
    ends = np.stack([contacts.first, contacts.second])
    across = contacts.normal_stiffness
    along = contacts.shear_stiffness
    weights = [
        (factor * (stiffness * contacts.area))[points]
        for stiffness in (across, along, along)[: len(rows)]
    ]
    return sum_of_products(
        layout.n_bodies,
        np.hstack([ends[:, points]] * len(rows)),
        np.hstack([row[:, points] for row in rows]),
        np.hstack(weights),
    )


def stiffness_matrix(layout: Layout, points: slice | np.ndarray = slice(None)) -> csc_array:
    """Sparse stiffness (coordinates n_bodies, the same) of the intact wall [N/m, N, N m, 1/s2];
    points: which contact points count, all by default.

    >>> from damage.wall.layout import lay_out
    >>> from damage.wall.parameters import Wall
    >>> stiffness_matrix(lay_out(Wall("pier", 0.9, 1.5))).shape
    (273, 273)
    """
    return _stiffness(layout, True, points=points).sparse()


def _stiffness(layout, free, massless=0.0, points=slice(None)):
    """Stiffness of the intact wall as Blocks: of coordinates that are `free`, others with this on
    the diagonal; points: which contact points count."""
    joints = joint_stiffness(layout, points=points)
    diagonal = np.zeros(layout.rigid_mass.shape)
    free = np.broadcast_to(free, (layout.n_bodies, joints.values.shape[1]))
    if layout.wall.restraints:
        top = top_of(layout.wall)
        diagonal[:, 0] = _of_bearing(layout, top.at_rest if top and top.stiffness else 0.0)
    if layout.strain is not None:
        diagonal = np.hstack([diagonal, layout.strain.stiffness])
    return joints.bounded(free, np.where(free, diagonal, massless))


def _of_bearing(layout, stiffness):
    """Stiffness against the horizontal motion of each body (n_bodies,), which the beam of a
    restraint has [N/m]."""
    return np.where(layout.bodies.course == CAP_COURSE, stiffness, 0.0)


def mass_vector(layout: Layout) -> np.ndarray:
    """Masses and inertias (coordinates n_bodies,) in the order of the degrees of freedom; zero of
    strain modes that a body does not have, and of coordinates that restraints hold.

    >>> from damage.wall.layout import lay_out
    >>> from damage.wall.parameters import Wall
    >>> mass_vector(lay_out(Wall("pier", 0.9, 1.5))).shape
    (273,)
    """
    rigid = layout.rigid_mass
    strain = layout.strain
    return (rigid if strain is None else np.hstack([rigid, strain.mass])).ravel()


def static_displacement(layout: Layout) -> np.ndarray:
    """Displacement (n_bodies, coordinates) [m, m, rad, m sqrt(kg) ...] of the intact wall under its
    weight, linear; those of the last walls are kept.

    >>> from damage.wall.layout import lay_out
    >>> from damage.wall.parameters import Wall
    >>> rises_m = static_displacement(lay_out(Wall("pier", 0.9, 1.5)))[:, 1]
    >>> round(1e6 * float(rises_m.min()), 1)  # [1e-6 m]
    -98.2
    """
    return _cached(_static_displacement, layout, layout.weighing.tobytes())


def _static_displacement(layout, weighing):
    # Joints carry differences of displacements, which rounding would spoil: the bits have to be
    # those of the solution.
    free = mass_vector(layout).reshape(layout.n_bodies, -1) > 0
    weight = np.zeros(free.shape)
    weight[:, 1] = -GRAVITY * np.frombuffer(weighing)
    return factorised(_stiffness(layout, free, massless=1.0)).solve(np.where(free, weight, 0.0))


def elastic_key(layout: Layout) -> bytes:
    """Digest of all that masses and stiffnesses of a layout's intact wall depend on."""
    bodies = layout.bodies
    contacts = layout.contacts
    arrays = (
        *vars(bodies).values(),
        contacts.kind,
        contacts.first,
        contacts.second,
        contacts.x,
        contacts.z,
        contacts.area,
        contacts.normal_stiffness,
        contacts.shear_stiffness,
        layout.drift_bodies,
        *layout.elastic_arrays,
    )
    return hashlib.sha256(b"|".join(values.tobytes() for values in arrays)).digest()


def natural_modes(layout: Layout, n_modes: int = 6) -> Modes:
    """The `n_modes` longest natural periods, their shapes, and 2 / omega_max.

    Those of the last walls are kept: members of an ensemble differ by their strengths alone, which
    modes do not know. Raises InputError of a wall that has none in the numbers of this machine.

    >>> from damage.wall.layout import lay_out
    >>> from damage.wall.parameters import Wall
    >>> natural_modes(lay_out(Wall("pier", 0.9, 1.5))).period_s[:1].round(4).tolist()
    [0.0815]
    """
    return _cached(_natural_modes, layout, n_modes)


def _cached(function, layout, argument):
    """A copy of what a function returns for this argument and a layout as stiff and as heavy."""
    key = function, argument, layout.wall.restraints, elastic_key(layout)
    return deepcopy(cached(key, lambda: function(layout, argument)))


def cached(key, make):
    """What `make()` returned for this key, should it be among the last ones used."""
    value = _CACHE.pop(key, None)
    _CACHE[key] = make() if value is None else value
    if len(_CACHE) > _MOST_CACHED:
        del _CACHE[next(iter(_CACHE))]
    return _CACHE[key]


def _natural_modes(layout, n_modes):
    mass = mass_vector(layout)
    free = np.flatnonzero(mass > 0)
    scale = 1 / np.sqrt(mass[free])
    top = top_of(layout.wall)
    inside = inside_lintels(layout)

    def over_mass(stiffness):
        if len(free) < len(mass):
            stiffness = stiffness[free][:, free]
        return (diags(scale) @ stiffness @ diags(scale)).tocsc()

    matrix = stiffest = over_mass(stiffness_matrix(layout))
    if top and top.stiffness and not top.at_rest:  # beyond its play
        bearing = np.zeros((layout.n_bodies, len(mass) // layout.n_bodies))
        bearing[:, 0] = _of_bearing(layout, top.stiffness)
        stiffest = matrix + diags(bearing.ravel()[free] * scale**2)
    start = np.ones(matrix.shape[0])  # a fixed start makes the result the same every time
    n_modes = min(n_modes, matrix.shape[0] - 2)
    try:
        values, vectors = eigsh(matrix, k=n_modes, sigma=0.0, v0=start)
        highest = _highest(stiffest, start)
        masonry = (
            _highest(over_mass(stiffness_matrix(layout, ~inside)), start)
            if inside.any()
            else highest
        )
    except (ArithmeticError, RuntimeError, ValueError) as error:  # ARPACK's and SuperLU's
        if "alloc" in str(error).lower():
            raise MemoryError(f"for the modes of {layout.n_bricks} bricks") from error
        raise _no_modes(layout, error) from error
    if not (values.min() > _ROUNDING * highest and np.isfinite(highest)):
        raise _no_modes(layout, f"squared frequency {values.min():.3g}")
    order = np.argsort(values)
    shapes = np.zeros((n_modes, len(mass)))
    shapes[:, free] = (vectors * scale[:, None]).T[order]
    return Modes(
        to_bits(2 * np.pi / np.sqrt(values[order])),
        np.stack(
            [_scaled(shape, layout) for shape in shapes.reshape(n_modes, layout.n_bodies, -1)]
        ),
        *(down_to_three_digits(2 / np.sqrt(rate)) for rate in (highest, masonry)),
    )


def _highest(matrix, start):
    """Highest squared frequency [1/s2] of a stiffness over mass, found from a start vector."""
    return eigsh(matrix, k=1, which="LA", return_eigenvectors=False, tol=_OF_HIGHEST, v0=start)[0]


def first_mode(layout: Layout) -> np.ndarray:
    """Shape (n_bodies, coordinates) of the mode of the longest period, scaled as of Modes, by
    inverse iteration: free vibration begins with it, so that its bits are those of sums and
    products alone.

    >>> from damage.wall.layout import lay_out
    >>> from damage.wall.parameters import Wall
    >>> first_mode(lay_out(Wall("pier", 0.9, 1.5))).shape
    (91, 3)
    """
    mass = mass_vector(layout).reshape(layout.n_bodies, -1)
    factor = factorised(_stiffness(layout, mass > 0, massless=1.0))
    shape = np.zeros(mass.shape)
    shape[:, layout.HORIZONTAL] = 1.0
    for _ in range(_MOST_ITERATIONS):
        before = shape
        shape = _scaled(factor.solve(mass * shape), layout)
        if np.abs(shape - before).max() <= _CONVERGED * np.abs(shape).max():
            break
    return shape


def _scaled(shape, layout):
    """The shape (n_bodies, coordinates) of a mode as of Modes."""
    moves = shape[:, layout.TRANSLATIONS]
    sizes = np.abs(moves)
    top = shape[layout.drift_bodies, 0].mean()
    # the sign is that of the first one, so that no tie decides
    large = moves[sizes >= sizes.max() / 2]
    return shape / (top if np.abs(top) > 1e-6 * sizes.max() else np.copysign(sizes.max(), large[0]))


def _no_modes(layout, problem):
    return InputError(
        f"wall {layout.wall.name} has no natural modes ({problem}): expected stiffnesses and masses"
        " of masonry, and no part that can move freely, as bricks do that stand on one contact"
        " point each; correct the wall, or give more --cells"
    )
