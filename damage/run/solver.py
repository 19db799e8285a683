"""What a run asks of a solver: a few verbs, and instants."""

from typing import NamedTuple, Protocol

import numpy as np

NO_MOTION = np.zeros((0, 2))
"""Acceleration of a base that stands still."""


class Instant(NamedTuple):
    """A wall at one instant, positions and forces of the same time.

    displacement: (n_bodies, 3) since the wall was built [m, m, rad]; opening, slip, offset: (n_joints,) [m];
    state: (n_joints,) bits BROKEN, AT_LIMIT and CRUSHED; base_shear_n [N]; top_force_n [N], NaN where nothing is held;
    energies [J]: kinetic and elastic, and those that came in or were dissipated since `start`;
    damping_j: None where the solver cannot tell it: then the run infers it from the balance.
    """

    displacement: np.ndarray
    opening: np.ndarray
    slip: np.ndarray
    offset: np.ndarray
    state: np.ndarray
    base_shear_n: float
    top_force_n: float
    kinetic_j: float
    elastic_j: float
    input_j: float
    friction_j: float
    fracture_j: float
    damping_j: float | None


class Solver(Protocol):
    """One wall at rest, unloaded; steps are counted by `clock` from the last `start`."""

    time_step: float
    clock: int

    def start(self, base, gravity):
        """From this step on move the base by `base` (k, 2) under `gravity` (k,) [m/s2], whose last value stays."""

    def damp(self, *, local=0.0, adaptive=0.0, alpha=0.0, beta=0.0):
        """From now on damp so, and in no other way: Cundall's local damping, the share that adaptive damping takes
        [-], damping proportional to mass [1/s] and to stiffness [s]."""

    def shift(self, offsets):
        """Move the bodies by (n_bodies, 2) [m]."""

    def set_velocities(self, velocities):
        """(n_bodies, 3) [m/s, m/s, rad/s]."""

    def hold(self, bodies, rotation):
        """From now on prescribe the horizontal velocity of bodies, and no rotation if `rotation`."""

    def push(self, velocity):
        """Prescribe the horizontal velocity of the held bodies [m/s]."""

    def advance(self, n_steps, sample_steps=None, on_sample=None):
        """Take steps, or hand them out: returns an iterable of (self, number of steps), each to be taken by `run`
        before the next is asked for.  A solver that moves by itself takes all at once and returns ().

        `on_sample()` is called at time zero and after every `sample_steps` steps, where instants and forces can be
        read, until it returns False.
        """

    def run(self, n_steps):
        """Take steps that were handed out; a solver that moves by itself has none."""

    def instant(self, base_acceleration):
        """The Instant now; base_acceleration: (2,) of this step [m/s2]."""

    def forces(self):
        """Of the contacts on each body, (n_bodies, 3) [N, N, N m], and in each contact, (n_contacts,) [N]."""

    def base_reaction(self):
        """Vertical force of the wall on the ground [N], downwards positive."""

    def drain_events(self):
        """Events since the last call, tuples (step since `start`, joint, kind, normal stress, shear stress, opening,
        slip) as `HistoryWriter.event` takes them."""
