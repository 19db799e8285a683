"""Limit analysis of a wall of rigid blocks on dry joints, as a linear programme.

The static theorem: of all contact forces that balance the dead load and `multiplier` times the live
load, without tension and with |T| <= mu N, the largest multiplier.  Its dual is the mechanism with
associated flow: where a joint slides it dilates by tan(psi) = mu.  Contact forces act at the
corners of the joints (`ModelOptions(contacts="corners")`), so that a joint hinges about its very
end.
R. K. Livesley (1978), Int. J. Numer. Methods Eng. 12, 1853-1871, doi:10.1002/nme.1620121207.

What it bounds.  Real joints slide with little dilation.  Every state in which a wall with dilation
psi < phi stands or just fails is statically admissible too, so that its collapse multiplier is
never above this one: associated friction gives an upper bound, D. C. Drucker (1954), J. Appl. Mech.
21, 71-74.  How far below it
the wall falls the programme cannot say; M. C. Ferris, F. Tin-Loi (2001), Int. J. Mech. Sci. 43,
209-224, doi:10.1016/S0020-7403(99)00111-3, and M. Gilbert, C. Casapulla, H. M. Ahmed (2006),
Comput. Struct. 84, 873-887, doi:10.1016/j.compstruc.2006.02.005, look for the least multiplier
without dilation.
It holds for the undeformed geometry, and for joints that do not give.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix, csr_matrix, hstack, vstack

from damage.errors import InputError
from damage.units import GRAVITY

# of scipy.optimize.linprog
_INFEASIBLE = 2
_UNBOUNDED = 3


def kinematic_matrix(layout, direction):
    """Sparse (n_contacts, coordinates n_bodies) of `Layout.directions`: 0 across, 1 along the
    joint."""
    rows = layout.directions[direction]
    contacts = layout.contacts
    size = rows.shape[2]
    ends = np.stack([contacts.first, contacts.second])
    side, contact, coordinate = np.nonzero(rows)
    return coo_matrix(
        (rows[side, contact, coordinate], (contact, size * ends[side, contact] + coordinate)),
        shape=(len(contacts), size * len(layout.bodies)),
    ).tocsr()


@dataclass(frozen=True)
class Collapse:
    """multiplier [-]: of the live load; motion (n_bodies, 3) [m, m, rad]: the mechanism, with
    live load times motion = 1 J; normal (compression positive), shear (n_contacts,) [N]."""

    multiplier: float
    motion: np.ndarray
    normal: np.ndarray
    shear: np.ndarray


def collapse_load(layout, friction=None, *, load=None, held=(), crushing=np.inf):
    """The largest multiplier of `load` beside the dead load, and its mechanism.

    layout: damage.wall.layout.Layout; joints have their tensile strength and cohesion, zero when
    dry.
    friction [-]: tan(phi) of all joints, by default the wall's.
    load: (n_bodies, 3) [N, N, N m], by default each body's weight in the direction +x.
    held: bodies that are kept from rotating.
    crushing [Pa]: largest compression of a contact point on its tributary area.
    Raises InputError when the wall cannot carry its own weight, or any multiple of the load.
    """
    weight = GRAVITY * layout.bodies.mass
    load = body_load(layout) if load is None else np.asarray(load, float)
    dead = np.zeros(load.shape)
    dead[:, 1] = -weight
    unit = weight.sum()  # forces are counted in it
    friction = np.tan(layout.wall.joint.friction_angle) if friction is None else friction
    program = _program(
        layout, friction, dead / unit, load / unit, np.asarray(held, int), crushing, unit
    )
    solution = linprog(**program, method="highs")
    if solution.status == _INFEASIBLE:
        raise InputError(
            f"wall {layout.wall.name} cannot carry its own weight; correct its bond, or its"
            " friction"
        )
    if solution.status == _UNBOUNDED:
        raise InputError(
            f"wall {layout.wall.name} carries any multiple of the load; correct the load or what is"
            " held"
        )
    if solution.status != 0:
        raise RuntimeError(f"the linear programme was not solved: {solution.message}")
    n = len(layout.contacts)
    forces = solution.x[: 2 * n] * unit
    motion = -solution.eqlin.marginals.reshape(-1, 3) / unit
    return Collapse(float(solution.x[2 * n]), motion, forces[:n], forces[n:])


def body_load(layout):
    """Each body's weight in the direction +x: (n_bodies, 3) [N, N, N m]."""
    load = np.zeros((len(layout.bodies), 3))
    load[:, 0] = GRAVITY * layout.bodies.mass
    return load


def top_load(layout):
    """1 N in the direction +x, shared equally by the bodies that a quasi-static loading pushes."""
    load = np.zeros((len(layout.bodies), 3))
    load[layout.pushed_bodies, 0] = 1 / len(layout.pushed_bodies)
    return load


def balance(layout):
    """Sparse (3 n_bodies, 2 n_contacts): forces and moments on the bodies of unit contact forces,
    first the normal ones (compression), then the shear ones."""
    return hstack([kinematic_matrix(layout, direction).T for direction in (0, 1)]).tocsr()


def flow(layout, motion):
    """Opening and slip of every contact in a mechanism: (n_contacts,) each [m]."""
    return np.split(balance(layout).T @ np.asarray(motion).ravel(), 2)


def _program(layout, friction, dead, load, held, crushing, unit):
    """Arguments of linprog; unknown are N, T of every contact, the multiplier, the moments on held
    bodies."""
    contacts = layout.contacts
    n = len(layout.contacts)
    moments = csr_matrix(
        (np.ones(len(held)), (3 * held + 2, np.arange(len(held)))), shape=(dead.size, len(held))
    )
    equal = hstack([balance(layout), csr_matrix(load.reshape(-1, 1)), moments]).tocsr()
    slides = np.flatnonzero(np.isfinite(contacts.cohesion))
    rows = np.arange(len(slides))

    def limit(sign):
        """sign T - mu N <= cohesion of the contacts that can slide."""
        values = np.concatenate([-np.broadcast_to(friction, n)[slides], np.full(len(slides), sign)])
        return coo_matrix(
            (values, (np.tile(rows, 2), np.concatenate([slides, n + slides]))),
            shape=(len(slides), equal.shape[1]),
        )

    bounds = np.full((equal.shape[1], 2), [-np.inf, np.inf])
    bounds[:n, 0] = -contacts.tensile_strength * contacts.area / unit
    dry = np.isfinite(contacts.tensile_strength)
    bounds[:n, 1][dry] = crushing * contacts.area[dry] / unit
    cost = np.zeros(equal.shape[1])
    cost[2 * n] = -1.0
    cohesion = np.tile(contacts.cohesion[slides] * contacts.area[slides] / unit, 2)
    return {
        "c": cost,
        "A_ub": vstack([limit(1.0), limit(-1.0)]).tocsr(),
        "b_ub": cohesion,
        "A_eq": equal,
        "b_eq": -dead.ravel(),
        "bounds": bounds,
    }
