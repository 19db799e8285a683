"""Natural modes of a wall with intact joints, and the critical time step of central differences.

Every body has three degrees of freedom, (u_x, u_z, rotation), the rotation turning x towards z.
A contact at the offset r from a body's centre moves by (u_x - rotation r_z, u_z + rotation r_x).
"""

from copy import deepcopy
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import eigsh

from damage.errors import InputError

_ROUNDING = 100 * np.finfo(float).eps
"""A squared frequency below this share of the highest is rounding, of a part that can move freely."""
_MOST_KEPT = 4
_KEPT = {}  # {all that modes depend on: Modes}


@dataclass(frozen=True)
class Modes:
    """period_s (n_modes,), longest first; shape (n_modes, n_bodies, 3) in [m, m, rad], scaled to a
    mean top-course displacement of 1 m where that is not zero; critical_time_step_s."""

    period_s: np.ndarray
    shape: np.ndarray
    critical_time_step_s: float


def contact_normals(contacts):
    """Unit normals (n_contacts, 2) from first to second: +x across head joints, +z else."""
    head = contacts.upright
    return np.column_stack([head, ~head]).astype(float)


def kinematic_matrix(layout, directions):
    """Sparse (n_contacts, 3 n_bodies): relative displacement of second to first along `directions`."""
    contacts, bodies = layout.contacts, layout.bodies
    rows, columns, values = [], [], []
    for body, sign in ((contacts.second, 1.0), (contacts.first, -1.0)):
        moving = np.flatnonzero(body >= 0)
        index = body[moving]
        rx, rz = contacts.x[moving] - bodies.x[index], contacts.z[moving] - bodies.z[index]
        dx, dz = directions[moving].T
        for dof, value in enumerate((dx, dz, dz * rx - dx * rz)):
            rows.append(moving)
            columns.append(3 * index + dof)
            values.append(sign * value)
    return coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
                      shape=(len(contacts), 3 * len(bodies))).tocsr()


def stiffness_matrix(layout):
    """Sparse stiffness (3 n_bodies, 3 n_bodies) of the intact wall [N/m, N, N m]."""
    contacts = layout.contacts
    normals = contact_normals(contacts)
    across = kinematic_matrix(layout, normals)
    along = kinematic_matrix(layout, normals[:, ::-1])
    return (across.T @ diags(contacts.normal_stiffness * contacts.area) @ across
            + along.T @ diags(contacts.shear_stiffness * contacts.area) @ along)


def mass_vector(layout):
    """Masses and inertias (3 n_bodies,) in the order of the degrees of freedom."""
    bodies = layout.bodies
    return np.column_stack([bodies.mass, bodies.mass, bodies.inertia]).ravel()


def natural_modes(layout, n_modes=6):
    """The `n_modes` longest natural periods, their shapes, and 2 / omega_max.

    Those of the last walls are kept: members of an ensemble differ by their strengths alone, which modes do not know.
    Raises InputError of a wall that has none in the numbers of this machine.
    """
    bodies, contacts = layout.bodies, layout.contacts
    asked = n_modes, *(values.tobytes() for values in (
        bodies.x, bodies.z, bodies.mass, bodies.inertia, contacts.kind, contacts.first, contacts.second, contacts.x,
        contacts.z, contacts.area, contacts.normal_stiffness, contacts.shear_stiffness, layout.drift_bodies))
    if asked not in _KEPT:
        while len(_KEPT) >= _MOST_KEPT:
            del _KEPT[next(iter(_KEPT))]
        _KEPT[asked] = _natural_modes(layout, n_modes)
    return deepcopy(_KEPT[asked])


def _natural_modes(layout, n_modes):
    scale = 1 / np.sqrt(mass_vector(layout))
    matrix = (diags(scale) @ stiffness_matrix(layout) @ diags(scale)).tocsc()
    start = np.ones(matrix.shape[0])  # a fixed start makes the result the same every time
    n_modes = min(n_modes, matrix.shape[0] - 2)
    try:
        values, vectors = eigsh(matrix, k=n_modes, sigma=0.0, v0=start)
        highest = eigsh(matrix, k=1, which="LA", return_eigenvectors=False, tol=1e-6, v0=start)[0]
    except (ArithmeticError, RuntimeError, ValueError) as error:  # ARPACK's and SuperLU's
        if "alloc" in str(error).lower():
            raise MemoryError(f"for the modes of {layout.n_bricks} bricks") from error
        raise _no_modes(layout, error) from error
    if not (values.min() > _ROUNDING * highest and np.isfinite(highest)):
        raise _no_modes(layout, f"squared frequency {values.min():.3g}")
    order = np.argsort(values)
    shapes = (vectors * scale[:, None]).T[order].reshape(n_modes, -1, 3)
    top = shapes[:, layout.drift_bodies, 0].mean(axis=1)
    largest = np.abs(shapes[:, :, :2]).max(axis=(1, 2))
    shapes /= np.where(np.abs(top) > 1e-6 * largest, top, largest)[:, None, None]
    return Modes(2 * np.pi / np.sqrt(values[order]), shapes, float(2 / np.sqrt(highest)))


def _no_modes(layout, problem):
    return InputError(f"wall {layout.wall.name} has no natural modes ({problem}): expected stiffnesses and masses of "
                      "masonry, and no part that can move freely, as bricks do that stand on one contact point each; "
                      "correct the wall, or give more --cells")
