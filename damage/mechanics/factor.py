"""The mass matrix of selective mass scaling, M + dt^2/2 K0 + dt/2 C0, and its factor
(`damage.mechanics.scaling`)."""

import hashlib

import numpy as np

from damage.linear.blocks import factorised
from damage.linear.modes import cached, elastic_key, joint_stiffness, mass_vector
from damage.mechanics.scaling import LOST
from damage.mechanics.tables import RIGID, ROW, Matrix, aligned_zeros

MASSLESS = 1e-30
"""What stands for the mass of a coordinate without one, whose velocity is prescribed [kg or kg
m2]."""


def scaled_mass(layout, time_step, beta, prescribed=(), points=slice(None)):
    """The ScaledMass of a layout for a time step and stiffness-proportional damping [s]; those of
    the last walls are kept.

    prescribed: numbers of the coordinates whose velocity is; points: contact points whose stiffness
    counts.
    """
    numbers = np.array([time_step, beta, *prescribed], float)
    damping = layout.strain.damping.tobytes() if layout.strain else b""
    counts = np.ones(len(layout.contacts), bool)[points].tobytes()
    parts = elastic_key(layout), mass_vector(layout).tobytes(), damping, numbers.tobytes(), counts
    key = hashlib.sha256(b"|".join(parts)).digest()

    def make():
        whole = _scaled(layout, time_step, beta, list(prescribed), points)
        return ScaledMass(key, layout, beta, points, whole)

    return cached(key, make)


def matrix_of(masses, width):
    """The Matrix of the ScaledMasses of walls that step together, with room for this width."""
    matrix = masses[0].matrix
    more = {"room": aligned_zeros(len(matrix.body), 2 * LOST, width)}
    if len({mass.key for mass in masses}) > 1:
        for name in ("lower", "diagonal", "inverse"):
            more[name] = aligned_zeros(*getattr(matrix, name).shape[:2], width)
            for w, mass in enumerate(masses):
                more[name][..., w] = getattr(mass.matrix, name)[..., 0]
    return matrix._replace(**more)


class ScaledMass:
    """Mass matrix of a wall with selective mass scaling; key: of all that it depends on; whole: of
    all bodies, as damage.linear.blocks.Blocks, in which prescribed velocities are coupled to no
    other; matrix: its Matrix, without room; beta, points: as of `scaled_mass`."""

    def __init__(self, key, layout, beta, points, whole):
        self.key = key
        self.beta = beta
        self.points = points
        self.whole = whole
        self.matrix = self._factor(layout)

    def _factor(self, layout):
        """The Matrix without room; nothing couples the supports, whose nodes are the last, nor
        bodies without these contact points, whose nodes are the first."""
        factor = factorised(self.whole)
        size = self.whole.values.shape[1]
        contacts = layout.contacts
        supports = len(layout.supports)
        scaled = np.isin(factor.order, [contacts.first[self.points], contacts.second[self.points]])
        nodes = size // RIGID
        bodies = len(factor.order)
        order = [*factor.order, *range(bodies, bodies + supports)]
        first = np.arange(0, size, RIGID)  # coordinate of each node of a body
        count = np.minimum(size - first, RIGID)
        start = np.append(factor.start, np.full(nodes * supports, factor.start[-1]))
        at_rest = np.tile(np.eye(RIGID), (nodes * supports, 1, 1))
        return Matrix(
            body=np.repeat(order, nodes),
            first=np.tile(first, len(order)),
            count=np.tile(count, len(order)),
            alone=nodes * int(np.argmax(scaled)),
            start=start.astype(ROW),
            below=factor.below.astype(ROW),
            lower=factor.lower.reshape(-1, 9, 1),
            diagonal=np.concatenate([factor.diagonal, MASSLESS * at_rest]).reshape(-1, 9, 1),
            inverse=np.concatenate([factor.inverse, at_rest / MASSLESS]).reshape(-1, 9, 1),
            room=np.zeros((0, 0, 1)),
        )


def _scaled(layout, time_step, beta, prescribed, points):
    """`whole` of a ScaledMass."""
    half = 0.5 * time_step
    strain = layout.strain
    mass = mass_vector(layout).reshape(len(layout.bodies), -1)
    inertia = np.where(mass > 0, mass, MASSLESS)
    free = mass > 0
    if strain:
        inertia[:, RIGID:] += half * (time_step * strain.stiffness + strain.damping * strain.mass)
    free.flat[prescribed] = False
    return joint_stiffness(layout, half * (time_step + beta), points).bounded(free, inertia)
