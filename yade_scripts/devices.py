"""Devices at the top of a wall in YADE: what a machine pushes by, driven bodies or a spreader beam,
and the bearing of a restrained top.

A device adds its forces to those of the next step (`add_forces`) and knows the elastic energy in it
(`elastic_j`).  A machine has a velocity, which `push` prescribes, and the force on the wall.
"""

import numpy as np
from yade import O, Vector3

from damage.units import GRAVITY
from damage.wall.kinds import CAP_COURSE


class DrivenBodies:
    """Bodies whose horizontal velocity [m/s] a machine prescribes, and a rotational spring between
    each and the machine.

    bodies: indices; rotation: whether it is prevented, too; stiffness: of the springs, from the
    present rotation on [N m/rad].
    """

    def __init__(self, solver, bodies, rotation, stiffness):
        self._solver = solver
        self._bodies = np.sort(bodies)
        self._stiffness = stiffness
        self.velocity = 0.0
        self.rest = self._rotations()
        scene = solver.scene
        for body in bodies:
            scene.states[body].blockedDOFs = "xyXYZ" if rotation else "xyXZ"
        scene.follows[np.ix_(bodies, [0, 2] if rotation else [0])] = 0.0

    def _rotations(self):
        return self._solver.scene.motion(self._bodies)[self._bodies, 2]

    def push(self, velocity):
        """Prescribe a velocity [m/s]; returns the change of kinetic energy [J], which is input."""
        old = self.velocity
        self.velocity = float(velocity)
        for body in self._bodies:
            state = self._solver.scene.states[body]
            state.vel = (self.velocity, state.vel[1], state.vel[2])
        mass = float(self._solver.layout.bodies.mass[self._bodies].sum())
        return 0.5 * mass * (self.velocity**2 - old**2)

    @property
    def force(self):
        """Force on the bodies by their prescribed motion [N]: minus that of the joints on them."""
        members = self._solver.scene.members
        return -sum(O.forces.f(cell, True)[0] for body in self._bodies for cell in members[body])

    @property
    def elastic_j(self):
        if not self._stiffness:
            return 0.0
        return 0.5 * self._stiffness * float(np.sum((self._rotations() - self.rest) ** 2))

    def add_forces(self):
        if self._stiffness:
            for body, angle in zip(self._bodies, self._rotations() - self.rest):
                torque = Vector3(0, self._stiffness * angle, 0)
                O.forces.addT(self._solver.model.clumps[body], torque)


class SpreaderBeam:
    """A beam of levers between a machine and bodies, by forces in the ratio of shares (n_bodies,);
    place: where the machine will be after the next step [m]."""

    elastic_j = 0.0

    def __init__(self, solver, shares):
        self._solver = solver
        self._bodies = np.flatnonzero(shares)
        self._shares = shares[self._bodies]
        self.velocity = 0.0
        self.place = float(self._shares @ solver.scene.pushed(self._bodies))

    def push(self, velocity):
        """Prescribe a velocity [m/s]; returns no energy, as the beam has no mass."""
        self.velocity = float(velocity)
        return 0.0

    @property
    def force(self):
        """Force on the wall [N]."""
        return float(self._solver.scene.on_top[self._bodies, 0].sum())

    def add_forces(self):
        """Add the force after which the mean displacement of the bodies by their shares is that of
        the machine.

        YADE's local damping takes or gives a share of each body's acceleration by its sign: a few
        iterations find it.
        """
        dt = self._solver.time_step
        bodies = self._bodies
        shares = self._shares
        scene = self._solver.scene
        model = self._solver.model
        mass = self._solver.layout.bodies.mass[bodies]
        place = scene.pushed(bodies)
        axis = scene.push_axis
        speed = np.array([scene.states[body].vel.dot(axis) for body in bodies])
        by_joints = np.array(
            [
                sum(O.forces.f(cell, True).dot(axis) for cell in scene.members[body])
                for body in bodies
            ]
        )
        force = self.force
        missing = (self.place - shares @ place) / dt - shares @ speed  # velocity to be added
        for _ in range(4):
            rate = (by_joints + shares * force) / mass
            undamped = 1 - model.newton.damping * np.sign(rate * (speed + dt / 2 * rate))
            force = (missing / dt - shares @ (undamped * by_joints / mass)) / (
                shares @ (undamped * shares / mass)
            )
        self.place += dt * self.velocity
        scene.on_top[bodies, 0] = shares * force
        for body, share in zip(bodies, shares):
            O.forces.addF(model.clumps[body], float(share * force) * axis)


class Bearing:
    """What a restrained top rests on: its bearing, if it has one, and the constant load on it.

    top: damage.wall.restraints.Restraint; slip: of the bearing [m]; friction_j: work of the slip.
    """

    def __init__(self, solver, top):
        self._solver = solver
        self._top = top
        self._beam = np.flatnonzero(solver.layout.bodies.course == CAP_COURSE)[-1]
        self.slip = 0.0
        self.friction_j = 0.0

    @property
    def elastic_j(self):
        if not self._top.stiffness:
            return 0.0
        return 0.5 * self._solver.scene.on_top[self._beam, 0] ** 2 / self._top.stiffness

    def add_forces(self):
        scene = self._solver.scene
        model = self._solver.model
        layout = self._solver.layout
        top = self._top
        force = np.zeros(3)
        weight = -model.newton.gravity[2] - self._solver.base_now()[1]
        force[1] = -weight * layout.load_mass[self._beam]
        if top.stiffness:
            before = scene.on_top[self._beam, 0]
            displacement = scene.states[self._beam].pos[0] - layout.bodies.x[self._beam]
            slip = top.slip(displacement, self.slip, GRAVITY * layout.top_mass)
            force[0] = -top.stiffness * (displacement - slip)
            self.friction_j -= 0.5 * (before + force[0]) * (slip - self.slip)
            self.slip = slip
        scene.on_top[self._beam] = force
        O.forces.addF(model.clumps[self._beam], Vector3(force[0], 0, force[1]))
