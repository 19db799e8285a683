"""Natural modes of a wall with intact joints, and the critical time step of central differences.

Every body has three degrees of freedom, (u_x, u_z, rotation), the rotation turning x towards z, and behind them the
strain modes where bricks deform.  A contact at the offset r from a body's centre moves by (u_x - rotation r_z, u_z +
rotation r_x), and by the strain modes' displacements there.
"""

from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import eigsh, splu

from damage.errors import InputError
from damage.units import GRAVITY
from damage.wall.kinds import CAP_COURSE
from damage.wall.restraints import top_of

_ROUNDING = 100 * np.finfo(float).eps
"""A squared frequency below this share of the highest is rounding, of a part that can move freely."""
_MOST_KEPT = 4
_KEPT = {}  # {all that modes depend on: Modes}


@dataclass(frozen=True)
class Modes:
    """period_s (n_modes,), longest first; shape (n_modes, n_bodies, coordinates) in [m, m, rad, m sqrt(kg) ...],
    scaled to a mean top-course displacement of 1 m where that is not zero; critical_time_step_s."""

    period_s: np.ndarray
    shape: np.ndarray
    critical_time_step_s: float


def contact_normals(contacts):
    """Unit normals (n_contacts, 2) from first to second: +x across head joints, +z else."""
    head = contacts.upright
    return np.column_stack([head, ~head]).astype(float)


def kinematic_matrix(layout, directions):
    """Sparse (n_contacts, coordinates n_bodies): relative displacement of second to first along `directions`, which
    are the normals or the tangents where bricks deform."""
    contacts, bodies, strain = layout.contacts, layout.bodies, layout.strain
    coordinates = 3 + (strain.n_modes if strain else 0)
    rows, columns, values = [], [], []
    for body, shape, sign in ((contacts.second, strain and strain.second, 1.0),
                              (contacts.first, strain and strain.first, -1.0)):
        moving = np.flatnonzero(body >= 0)
        index = body[moving]
        rx, rz = contacts.x[moving] - bodies.x[index], contacts.z[moving] - bodies.z[index]
        dx, dz = directions[moving].T
        by_modes = () if strain is None else np.where(
            np.any(directions * contact_normals(contacts), axis=1)[moving, None],
            strain.shapes[shape[moving], 0], strain.shapes[shape[moving], 1]).T
        for dof, value in enumerate((dx, dz, dz * rx - dx * rz, *by_modes)):
            rows.append(moving)
            columns.append(coordinates * index + dof)
            values.append(sign * value)
    return coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                      shape=(len(contacts), coordinates * len(bodies))).tocsr()


def joint_stiffness(layout, factors=(1.0, 1.0)):
    """Sparse stiffness of all contact points [N/m, N, N m], times factors across and along each."""
    contacts = layout.contacts
    normals = contact_normals(contacts)
    across = kinematic_matrix(layout, normals)
    along = kinematic_matrix(layout, normals[:, ::-1])
    return (across.T @ diags(factors[0] * (contacts.normal_stiffness * contacts.area)) @ across
            + along.T @ diags(factors[1] * (contacts.shear_stiffness * contacts.area)) @ along)


def stiffness_matrix(layout):
    """Sparse stiffness (coordinates n_bodies, the same) of the intact wall [N/m, N, N m, 1/s2]."""
    joints = joint_stiffness(layout)
    if layout.wall.restraints:
        top = top_of(layout.wall)
        joints = joints + _of_bearing(layout, top.at_rest if top and top.stiffness else 0.0)
    if layout.strain is None:
        return joints
    return joints + diags(np.hstack([np.zeros((len(layout.bodies), 3)), layout.strain.stiffness]).ravel())


def _of_bearing(layout, stiffness):
    """Diagonal matrix of a stiffness against the horizontal motion of the beam of a restraint [N/m]."""
    coordinates = 3 + (layout.strain.n_modes if layout.strain else 0)
    values = np.zeros((len(layout.bodies), coordinates))
    values[layout.bodies.course == CAP_COURSE, 0] = stiffness
    return diags(values.ravel())


def mass_vector(layout):
    """Masses and inertias (coordinates n_bodies,) in the order of the degrees of freedom; zero of strain modes that a
    body does not have, and of coordinates that restraints hold."""
    bodies, strain = layout.bodies, layout.strain
    rigid = np.where(layout.held, 0.0, np.column_stack([bodies.mass, bodies.mass, bodies.inertia]))
    return (rigid if strain is None else np.hstack([rigid, strain.mass])).ravel()


def static_displacement(layout):
    """Displacement (n_bodies, coordinates) [m, m, rad, m sqrt(kg) ...] of the intact wall under its weight, linear."""
    mass = mass_vector(layout)
    free, weight = mass > 0, np.zeros((len(layout.bodies), len(mass) // len(layout.bodies)))
    weight[:, 1] = -GRAVITY * layout.weighing
    moved = np.zeros(len(mass))
    moved[free] = splu(stiffness_matrix(layout).tocsc()[free][:, free]).solve(weight.ravel()[free])
    return moved.reshape(weight.shape)


def elastic_key(layout):
    """All that masses and stiffnesses of a layout's intact wall depend on, a tuple of bytes."""
    bodies, contacts = layout.bodies, layout.contacts
    strain = () if layout.strain is None else (layout.strain.mass, layout.strain.stiffness, layout.strain.shapes)
    return tuple(values.tobytes() for values in (
        bodies.x, bodies.z, bodies.mass, bodies.inertia, contacts.kind, contacts.first, contacts.second, contacts.x,
        contacts.z, contacts.area, contacts.normal_stiffness, contacts.shear_stiffness, layout.drift_bodies,
        *strain))


def natural_modes(layout, n_modes=6):
    """The `n_modes` longest natural periods, their shapes, and 2 / omega_max.

    Those of the last walls are kept: members of an ensemble differ by their strengths alone, which modes do not know.
    Raises InputError of a wall that has none in the numbers of this machine.
    """
    asked = n_modes, layout.wall.restraints, *elastic_key(layout)
    if asked not in _KEPT:
        while len(_KEPT) >= _MOST_KEPT:
            del _KEPT[next(iter(_KEPT))]
        _KEPT[asked] = _natural_modes(layout, n_modes)
    return deepcopy(_KEPT[asked])


def _natural_modes(layout, n_modes):
    mass = mass_vector(layout)
    free = np.flatnonzero(mass > 0)
    scale = 1 / np.sqrt(mass[free])
    stiffness, top = stiffness_matrix(layout), top_of(layout.wall)
    if len(free) < len(mass):
        stiffness = stiffness[free][:, free]
    matrix = stiffest = (diags(scale) @ stiffness @ diags(scale)).tocsc()
    if top and top.stiffness and not top.at_rest:  # beyond its play
        stiffest = matrix + diags(_of_bearing(layout, top.stiffness).diagonal()[free] * scale**2)
    start = np.ones(matrix.shape[0])  # a fixed start makes the result the same every time
    n_modes = min(n_modes, matrix.shape[0] - 2)
    try:
        values, vectors = eigsh(matrix, k=n_modes, sigma=0.0, v0=start)
        highest = eigsh(stiffest, k=1, which="LA", return_eigenvectors=False, tol=1e-6, v0=start)[0]
    except (ArithmeticError, RuntimeError, ValueError) as error:  # ARPACK's and SuperLU's
        if "alloc" in str(error).lower():
            raise MemoryError(f"for the modes of {layout.n_bricks} bricks") from error
        raise _no_modes(layout, error) from error
    if not (values.min() > _ROUNDING * highest and np.isfinite(highest)):
        raise _no_modes(layout, f"squared frequency {values.min():.3g}")
    order = np.argsort(values)
    shapes = np.zeros((n_modes, len(mass)))
    shapes[:, free] = (vectors * scale[:, None]).T[order]
    shapes = shapes.reshape(n_modes, len(layout.bodies), -1)
    top = shapes[:, layout.drift_bodies, 0].mean(axis=1)
    largest = np.abs(shapes[:, :, :2]).max(axis=(1, 2))
    shapes /= np.where(np.abs(top) > 1e-6 * largest, top, largest)[:, None, None]
    return Modes(2 * np.pi / np.sqrt(values[order]), shapes, float(2 / np.sqrt(highest)))


def _no_modes(layout, problem):
    return InputError(f"wall {layout.wall.name} has no natural modes ({problem}): expected stiffnesses and masses of "
                      "masonry, and no part that can move freely, as bricks do that stand on one contact point each; "
                      "correct the wall, or give more --cells")
