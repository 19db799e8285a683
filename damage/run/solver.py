"""Interface of a solver: the methods that a run calls, and the instants that it returns."""

from typing import NamedTuple, Protocol

import numpy as np

NO_MOTION = np.zeros((0, 2))
"""Acceleration of a base that stands still."""


LOOK_STEPS = 500
"""Steps between two looks at the static criterion, at progress and interrupts; a solver whose
forces depend, in their last digits, on where it stops, stops there."""
MOST_WORK = 2 * 10**6
"""Steps between two looks, times contact points, at most: a tenth of a second or, where joints
crack, half a second of eight walls."""


class Instants(NamedTuple):
    """A wall at some instants, one after the other; positions and forces are of the same time.

    clock: (n,) steps since `start`; displacement: (n, n_bodies, 3) since the wall was built [m, m,
    rad]; support_displacement: (n, n_supports, 3) the same of the supports; support_force: (n,
    n_supports, 3) of the wall on them [N, N, N m], the moments about their reference points;
    joints: (n_active,) indices of the active contact points, or a slice; contacts: {column of the
    history's FRAMES: (n, n_active)} of these, zero in all others; a solver leaves out a column that
    it does not know; top_force_n: (n,) [N], NaN where nothing is held; energies, (n,) [J]: kinetic
    and elastic, and those that came in or were dissipated since `start`;
    damping_j: None where the solver does not compute it: the run then infers it from the balance;
    joint_stress_pa: (n, n_joints, 2) normal stress, tension positive, and shear stress of all
    contact points, signed as their slip, None of a solver without `with_stresses`;
    out_of_plane: (n, n_bodies, 3) of a house, displacement across its wall and rotations about the
    axes along it and upwards [m, rad, rad], None of a plane wall;
    failed_ties: (n,) number of a house's ties that have failed.
    """

    clock: np.ndarray
    displacement: np.ndarray
    support_displacement: np.ndarray
    support_force: np.ndarray
    joints: np.ndarray | slice
    contacts: dict[str, np.ndarray]
    top_force_n: np.ndarray
    kinetic_j: np.ndarray
    elastic_j: np.ndarray
    input_j: np.ndarray
    friction_j: np.ndarray
    fracture_j: np.ndarray
    damping_j: np.ndarray | None
    joint_stress_pa: np.ndarray | None = None
    out_of_plane: np.ndarray | None = None
    failed_ties: np.ndarray | None = None

    @classmethod
    def single(cls, **values):
        """Instants of the values of a single one, and `joints`."""

        def along(value):
            if isinstance(value, dict):
                return {name: along(value_) for name, value_ in value.items()}
            return np.asarray(value)[np.newaxis]

        return cls(
            **{
                name: value if name == "joints" or value is None else along(value)
                for name, value in values.items()
            }
        )


class Solver(Protocol):
    """One wall at rest, unloaded; steps are counted by `clock` from the last `start`."""

    time_step: float
    clock: int
    with_stresses = False
    """Whether Instants hold the stresses of the joints; a run sets it."""
    stretch_samples = 0
    """Samples for which a run asks at once; none: up to its next look."""

    def start(self, base, gravity):
        """From this step on move the base by `base` (k, 2), of a house (k, 3) along its heading, up
        and across, under `gravity` (k,) [m/s2], whose last value stays."""

    def damp(self, *, local=0.0, adaptive=0.0, alpha=0.0, beta=0.0, mean_1_s=0.0):
        """From now on damp so, and in no other way: Cundall's local damping, the share that
        adaptive damping takes [-], damping proportional to mass [1/s] and to stiffness [s].  That
        by mass leaves out running means of the velocities, which follow them at the rate mean_1_s
        [1/s]: those of a push that takes long; none at zero."""

    def add_static_displacement(self):
        """Move by the linear static solution of the intact wall under its weight; of solvers with
        deformable bricks."""

    def set_velocities(self, velocities):
        """(n_bodies, 3) [m/s, m/s, rad/s], or with those of the strain modes of deformable
        bricks."""

    def hold(self, bodies, rotation, stiffness=0.0):
        """From now on prescribe the horizontal velocity of bodies, and no rotation if `rotation`,
        or a rotational spring of this stiffness on each [N m/rad], whose work is input."""

    def spread(self, shares):
        """From now on move bodies by a spreader beam: by forces in the ratio of shares (n_bodies,),
        whose sum is 1, so that the mean displacement of the bodies by these shares follows
        `push`."""

    def push(self, velocity):
        """Prescribe the horizontal velocity of the held bodies, or of the spreader beam [m/s]."""

    def move_supports(self, velocities):
        """Prescribe the velocities of the supports (n_supports, 3) [m/s, m/s, rad/s]."""

    def prescribe_no_more(self):
        """Velocities stay as they are from here: samples may be taken several at once again."""

    def advance(self, n_steps, sample_steps=None, on_samples=None, since=None):
        """Take steps, or hand them out: returns an iterable of (self, *numbers of steps), of which
        at least the first is to be taken by `run` before the next is asked for.  A solver that
        moves by itself takes all at once and returns ().  since: step from which looks are counted,
        that of now without it.

        `on_samples(Instants)` is called of time zero and of every `sample_steps` steps, of one or
        of several at once, until it returns False: late, then, but not where a velocity is
        prescribed, which it may change.
        """

    def run(self, *steps):
        """Take steps that were handed out; a solver that moves by itself has none."""

    def instants(self):
        """The Instants of now, of which there is one."""

    def forces(self):
        """Forces of the contacts on each body, (n_bodies, 3) [N, N, N m], and in each contact,
        (n_contacts,) [N]."""

    def damp_impacts(self):
        """From now on dissipate energy where loose bricks collide; of a solver whose collisions are
        elastic until then."""

    def base_reaction(self):
        """Vertical force of the wall on the ground [N], downwards positive."""

    def saved_state(self):
        """Everything that the next steps depend on, {name: array}; None of a solver that cannot say
        it."""

    def resume(self, state):
        """Take over what `saved_state` returned of a solver of the same layout; steps count from
        the last `start`."""

    def checkpoint(self):
        """Everything that the next steps depend on, {name: array}, those that were asked for before
        included."""

    def restore(self, tables):
        """Go back to where `checkpoint` was taken of a solver of the same layout, after a `start`,
        and a `hold` where there was one, with the same arguments.  Raises InputError where the
        tables cannot be right."""

    def drain_events(self):
        """Events since the last call, tuples (step since `start`, joint, kind, normal stress, shear
        stress, opening, slip) as `Buffer.event` of a history takes them."""
