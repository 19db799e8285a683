"""Interface of `damage.run.solver` for a wall in YADE's scene.

A step integrates first and then computes the forces, so that at its end positions and forces are of
the same time. There a Python engine logs failures, updates the failed joints, takes samples and
sets the field of the next step. Engines of a user follow it.
"""

import builtins

import numpy as np
from yade import O, PyRunner, Vector3

from damage.elementary import total
from damage.errors import RunError
from damage.index import THRESHOLD
from damage.law.joint_law import SHEAR, TENSION
from damage.run.schedule import JOINT_STEPS
from damage.run.solver import NO_MOTION, Instants, Solver
from damage.wall.restraints import top_of
from yade_scripts import checkpoint
from yade_scripts.bonds import Bonds
from yade_scripts.crushing import Crushing
from yade_scripts.devices import Bearing, DrivenBodies, SpreaderBeam
from yade_scripts.joint_tracker import JointTracker, signed
from yade_scripts.model import build
from yade_scripts.ties import Ties

FOLLOW_STEPS = JOINT_STEPS // 2
"""Steps between two updates of the failed joints; slip that reverses in between is not recorded."""
TIDY_STEPS = 500
"""Steps between two deletions of contacts that are over."""
LOOSE = 0.4e-3
"""Opening or offset of a joint [m] from which collisions are enabled: corner spheres and faces are
0.5 mm apart."""
LOOK = """
if hasattr(__builtins__, "masonry_solver"):
    masonry_solver.look()
else:
    masonry_look.dead = True
    print("a saved wall: YADE's own laws continue; no failed bond becomes a dry joint from now on")
"""
"""Command of the engine at the end of each step; of a scene that O.load brought into another
process."""
_KINDS = {TENSION: "tension", SHEAR: "shear"}
ON_FACE = 1e-2
"""Shear displacement of a joint [m] up to which all its tips are on their faces."""


class YadeSolver(Solver):
    """A wall in YADE as Solver of a Run; methods without a docstring:
    `damage.run.solver.Solver`."""

    def __init__(self, layout, time_step):
        self.layout = layout
        self.time_step = time_step
        self.model = build(layout, time_step)
        self.scene = self.model.reader(self.model)
        self.tracker = JointTracker(layout, THRESHOLD)
        self.crushing = Crushing(self.scene)
        self.bonds = Bonds(self.scene, self.tracker)
        self.ties = Ties(self.scene)
        self._base = NO_MOTION
        self._gravity = np.zeros(1)
        # Displacement and velocity of the supports' reference points [m, m, rad, and per second].
        self._supports, self._support_velocity = np.zeros((2, len(layout.supports), 3))
        # by which a machine pushes the top; under a restrained one
        self.machine = None
        top = top_of(layout.wall)
        self.bearing = top and Bearing(self, top)
        self._sample_steps = self._on_samples = self._raised = None
        self._events = []
        self._armed = False
        self._input_power = 0.0
        self._input_time = 0.0
        self._input_energy = 0.0
        self.clock = 0  # steps since `start`
        # of this scene, which O.load and O.reset replace
        self._tags = O.tags
        self._advancing = False
        builtins.masonry_solver = self  # for the command of the engine
        O.engines = [
            self.model.newton,
            *O.engines[:-1],
            PyRunner(command=LOOK, iterPeriod=1, label="masonry_look"),
        ]
        self.model.newton.warnNoForceReset = False  # forces are reset, but after their integration
        O.step()  # computes the initial forces; without a field nothing moves

    # --- loading and time steps -----------------------------------------------------------------

    def start(self, base, gravity):
        self._base = base
        self._gravity = gravity
        self.clock = 0
        self._input_time = 0.0
        self._set_field()

    def damp(self, *, local=0.0, adaptive=0.0, alpha=0.0, beta=0.0):
        """Set the damping; raises NotImplementedError for all but local damping, the only one of
        YADE."""
        if adaptive or alpha or beta:
            raise NotImplementedError(
                f"adaptive {adaptive}, alpha {alpha}, beta {beta}: YADE damps locally alone"
            )
        self.model.newton.damping = local

    def damp_impacts(self):
        self._armed = True
        self.model.damp_impacts()

    def set_velocities(self, velocities):
        self.scene.set_velocities(velocities)

    def hold(self, bodies, rotation, stiffness=0.0):
        self.machine = DrivenBodies(self, bodies, rotation, stiffness)

    def spread(self, shares):
        self.machine = SpreaderBeam(self, shares)

    def push(self, velocity):
        """Prescribe the horizontal velocity of the held bodies [m/s]; the change of kinetic energy
        is input."""
        self._input_energy += self.machine.push(velocity)
        self._input_power = self._power()

    def move_supports(self, velocities):
        self._support_velocity[:] = velocities
        self._set_support_velocities()
        self._input_power = self._power()

    def _set_support_velocities(self):
        """Set the velocities of all bodies of the supports to those of the supports' rigid
        motion."""
        axis = self.scene.push_axis
        upright = Vector3(0, 0, 1)
        for bodies, x, (ux, uz, _), (vx, vz, rotating) in zip(
            self.model.ground, self.scene.ground_at, self._supports, self._support_velocity
        ):
            for state in (O.bodies[body].state for body in bodies):
                along = state.pos.dot(axis) - x - ux
                up = state.pos[2] - uz
                state.vel = (vx - rotating * up) * axis + (vz + rotating * along) * upright
                state.angVel = rotating * axis.cross(upright)

    def advance(self, n_steps, sample_steps=None, on_samples=None, since=None):
        self._sample_steps = sample_steps
        self._on_samples = on_samples
        if on_samples and self.clock == 0:
            self._observe()
        self._check_scene()
        self._advancing = True
        try:
            O.run(n_steps, True)
        finally:
            self._advancing = False
        if self._raised:
            raise self._raised
        return ()

    def _check_scene(self):
        """Raise RunError where this wall's scene was replaced."""
        self._tags["masonry"] = f"{id(self)} {self.clock}"
        if not O.tags.has_key("masonry") or O.tags["masonry"] != self._tags["masonry"]:
            raise RunError(
                "the wall's scene was replaced, by O.load or O.reset: expected it as it was built;"
                " start again, and load saved scenes in another process"
            )

    # --- one step -------------------------------------------------------------------------------

    def look(self):
        """Command of the engine at the end of each step: log failures, update joints, take samples,
        set the field."""
        self.clock += 1
        if not self._advancing:
            self._check_scene()
        if self._support_velocity.any():
            self._supports += self.time_step * self._support_velocity
            self._set_support_velocities()
        self._set_field()
        for device in filter(None, (self.bearing, self.machine)):
            device.add_forces()
        try:
            self.model.work.step(anew=self.clock % FOLLOW_STEPS == 0)
            failed, passed = self.scene.beyond_strength()
            self._log_breaks(np.array(failed, int))
            for joint, _, work in self.crushing.step(self.clock % FOLLOW_STEPS == 0):
                self.tracker.crushes(joint, work)
            self._soften(passed)
            self.tracker.fracture_energy += self.ties.step()
            if self._armed and self.clock % TIDY_STEPS == 0:
                self.model.tidy()
            if self._on_samples:
                self._observe()
        except Exception as error:  # YADE would print all of it, and raise another
            self._raised = error
            O.pause()
            if not self._advancing:  # by O.run of a script, which sees nothing else
                raise

    def _set_field(self):
        """Set the acceleration of all masses in the next step, in the frame of the base."""
        ax, az, ay = self.base_now()
        gravity = self._gravity[min(self.clock, len(self._gravity) - 1)]
        self.model.newton.gravity = (-float(ax), -float(ay), -float(gravity) - float(az))

    def base_now(self):
        """Acceleration of the base along x and z now, and in a house along y [m/s2]."""
        if self.clock >= len(self._base):
            return 0.0, 0.0, 0.0
        return self.scene.turned_by_heading(*self._base[self.clock])

    def _observe(self):
        """Update the failed joints and the input energy, and take a sample where one is due."""
        if self.clock % FOLLOW_STEPS == 0:
            self._follow_joints()
            self._integrate_input()
        if self.clock % self._sample_steps == 0 and not self._on_samples(self.instants()):
            self._on_samples = None

    def _log_breaks(self, new):
        """Log joints whose bond failed in this step, (m,) indices, and replace their bonds."""
        if len(new) == 0:
            return
        tracker = self.tracker
        _, shear = self._displacements(new)
        for joint, slip, strength in zip(new, shear, self.model.tensile_strengths(new)):
            opening = self.scene.opening_of(joint)
            sigma = tracker.normal_stiffness[joint] * opening
            tau = tracker.shear_stiffness[joint] * slip
            kind = "tension" if sigma > strength else "shear"
            tracker.friction[joint] = self.model.friction_of(joint)
            tracker.breaks(joint, kind, sigma, tau)
            self.model.loosen(joint)
            self._events.append((self.clock, int(joint), kind, sigma, signed(tau)))

    def _displacements(self, joints):
        """Opening and shear displacement of contact points, by the motion of their bodies (m,)
        [m]."""
        return self.scene.displacements(joints, self._supports)

    def _soften(self, passed):
        """Apply the joint law to bonds that passed their strengths, and log those that failed."""
        for joint, event, sigma, tau in self.bonds.step(passed):
            kind = _KINDS[event]
            self.tracker.breaks(joint, kind, sigma, tau)
            self.model.loosen(joint)
            self.scene.let_go(joint)
            self._events.append((self.clock, joint, kind, sigma, tau))
        if self.clock % FOLLOW_STEPS == 0:
            self.bonds.sample()
        if self.clock % JOINT_STEPS == 0:
            self.bonds.confine()

    def _follow_joints(self):
        """Update the state of the failed joints; enable collisions where bricks come loose."""
        broken = self.tracker.followed
        if len(broken) == 0:
            return
        self.model.regain()
        across, shear = self._displacements(broken)
        opening = self.scene.openings(broken)
        apart = across + self.model.closure[broken]
        if self.model.gone:
            opening = np.where(np.isin(broken, list(self.model.gone)), apart, opening)
        if not self._armed and max(opening.max(), np.abs(self.tracker.offset).max()) > LOOSE:
            self._armed = True
            self.model.arm()
        tau = self.scene.shear_stresses(broken)
        # A tip that has left its face has its opening from the end of the face.
        slid = np.abs(shear) > ON_FACE
        gap = np.where(slid, np.minimum(opening, apart), opening) if slid.any() else None
        self._log_passings(self.tracker.sample(broken, opening, shear, tau, gap))
        for joint in broken[self.tracker.ended[broken]]:
            self.model.end(joint)

    def _log_passings(self, passings):
        for joint, kind in passings:
            self._events.append(
                (
                    self.clock,
                    joint,
                    kind,
                    0.0,
                    0.0,
                    self.tracker.opening[joint],
                    signed(self.tracker.slip[joint]),
                )
            )

    def _integrate_input(self):
        """Add the work of all prescribed motions since the last call to the input, by the
        trapezoidal rule."""
        power = self._power()
        time = self.clock * self.time_step
        self._input_energy += (power + self._input_power) / 2 * (time - self._input_time)
        self._input_power = power
        self._input_time = time

    def _power(self):
        """Power of the pushed top, of the supports, and of the inertia forces in the frame of the
        base [W]."""
        base = self.base_now()
        power = -sum(
            float(base[axis]) * self._momentum(axis) for axis in range(3) if base[axis] != 0
        )
        if self.machine:
            power += self.machine.force * self.machine.velocity
        if self._support_velocity.any():
            power -= float(
                np.sum(self.scene.support_forces(self._supports) * self._support_velocity)
            )
        return power

    def _momentum(self, axis):
        """Momentum of all bodies at the time of the positions along x (0), z (1) or y (2)
        [kg m/s]."""
        scene = self.scene
        coordinate = (0, 2, 1)[axis]
        mass = scene.mass[:, 0] * scene.follows[:, axis % 2]
        gravity = self.model.newton.gravity[coordinate]
        if self.layout.wall.restraints:
            force = total(scene.follows[:, axis] * scene.resultants()[:, axis])
        else:
            force = scene.base_reaction() if axis == 1 else -scene.base_shear(coordinate)
        velocities = np.array([state.vel[coordinate] for state in scene.states])
        return float(total(mass * velocities) + self.time_step / 2 * (force + mass.sum() * gravity))

    # --- results --------------------------------------------------------------------------------

    def instants(self):
        """The Instants of the present time.

        damping_j is None: YADE's sum of the work of local damping takes the contact forces without
        the weights that balance them, so that the run computes it from the energy balance.
        """
        tracker = self.tracker
        friction = self.model.work.total + tracker.breaking_energy
        elastic = self.scene.elastic_energy(tracker.broken)
        if self.bearing:
            friction += self.bearing.friction_j
            elastic += self.bearing.elastic_j
        kinetic = self.scene.kinetic_energy(self.time_step / 2, self.base_now())
        motion = self.scene.motion()
        return Instants.single(
            clock=self.clock,
            displacement=motion[:, :3],
            out_of_plane=self.scene.out_of_plane(motion),
            failed_ties=self.ties.failed,
            support_displacement=self._supports.copy(),
            support_force=self.scene.support_forces(self._supports),
            joints=slice(None),
            contacts=tracker.contact_data(),
            top_force_n=self.machine.force if self.machine else np.nan,
            kinetic_j=kinetic,
            elastic_j=elastic,
            # what springs hold, the machine did not put into the wall
            input_j=self._input_energy - (self.machine.elastic_j if self.machine else 0.0),
            friction_j=friction,
            fracture_j=tracker.fracture_energy,
            damping_j=None,
            joint_stress_pa=(
                self.scene.joint_stresses(self.layout.n_joints) if self.with_stresses else None
            ),
        )

    def forces(self):
        scene = self.scene
        return scene.plane_resultants(), scene.contact_forces()

    def base_reaction(self):
        return self.scene.base_reaction()

    def resume(self, state):
        blocked = [body.blockedDOFs for body in self.scene.states]
        checkpoint.restore(self, state)
        self.clock = 0
        self._input_time = 0.0
        self.scene.follows[...] = np.where(self.layout.restrained, 0.0, 1.0)
        if not self.bearing:
            self.scene.on_top[...] = 0.0
        for body, dofs in zip(self.scene.states, blocked):
            body.blockedDOFs = dofs

    def checkpoint(self):
        return checkpoint.tables_of(self)

    def restore(self, tables):
        checkpoint.restore(self, tables)

    def drain_events(self):
        events = self._events
        self._events = []
        return events
