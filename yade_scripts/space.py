"""Arrays from the scene of a house, whose bodies move in space."""

from itertools import starmap

import numpy as np
from scipy.spatial.transform import Rotation
from yade import O, Vector3

from damage.units import GRAVITY
from damage.wall.kinds import rows
from yade_scripts.scene import SceneReader


class SpaceReader(SceneReader):
    """A SceneReader of a house; a body's six coordinates are those of its wall, as of
    `damage.house.space.HouseLayout`: along it, upwards, rotation from x towards z, across,
    rotations about the axes along and upwards."""

    def __init__(self, model):
        super().__init__(model)
        layout = model.layout
        bodies = layout.bodies
        contacts = layout.contacts
        self.start = layout.centres
        self._of_body = layout.of_body
        self._first = Rotation.from_quat(self.first_orientation).inv()
        self._ends = [rows(end, len(bodies)) for end in (contacts.first, contacts.second)]
        turn = np.radians(layout.house.heading)
        self._heading = np.round([np.cos(turn), np.sin(turn)], 15)
        self.push_axis = Vector3(*self._heading, 0)
        self.ground_at = (layout.ground_left + layout.ground_right) / 2
        centres = np.vstack([self.start, self._of_ground(self.ground_at, 0 * self.ground_at)])
        # the numbers of points last, which numpy takes at once
        self._arms = [(contacts.place - centres[end]).T for end in self._ends]
        self._axes = np.ascontiguousarray(contacts.axes.transpose(1, 2, 0))
        # about the axes of a body: along, across and upwards
        self._inertia = np.insert(bodies.across_inertia, 1, bodies.inertia, axis=1)

    def turned_by_heading(self, along, up, across):
        """Along x, z and y of the house what is along its heading, upwards and across."""
        cos, sin = self._heading
        return cos * along - sin * across, up, sin * along + cos * across

    def _of_ground(self, along, up):
        """Places of the ground (n, 3) [m] at these along the heading and upwards (n,) [m]."""
        return np.column_stack([np.outer(along, self._heading), up])

    def support_forces(self, displacement):
        """Forces on the supports along the heading and upwards, and the moment from the one towards
        the other, as of SceneReader."""
        along, up, _ = np.transpose(displacement)
        axis = self.push_axis
        forces = []
        about = axis.cross(Vector3(0, 0, 1))
        places = starmap(Vector3, self._of_ground(self.ground_at + along, up).tolist())
        for members, place in zip(self.model.ground, places):
            force = Vector3.Zero
            moment = Vector3.Zero
            for member in members:
                on_it = O.forces.f(member, True)
                force += on_it
                moment += (O.bodies[member].state.pos - place).cross(on_it) + O.forces.t(
                    member, True
                )
            forces.append([force.dot(axis), force[2], moment.dot(about)])
        return np.array(forces)

    def _now(self):
        """Centres (n_bodies, 3) [m] and rotations of all bodies since the wall was built."""
        now = np.array(
            [
                (p[0], p[1], p[2], q[0], q[1], q[2], q[3])
                for p, q in ((state.pos, state.ori) for state in self.model.turning)
            ]
        )
        return now[:, :3], Rotation.from_quat(now[:, 3:]) * self._first

    def motion(self, select=None):
        """Coordinates of all bodies since the wall was built, (n_bodies, 6) [m, m, rad, m, rad,
        rad]."""
        place, turned = self._now()
        moved = np.einsum("nij,nj->ni", self._of_body, place - self.start)
        turned = np.einsum("nij,nj->ni", self._of_body, turned.as_rotvec())
        return np.column_stack(
            [moved[:, 0], moved[:, 2], -turned[:, 1], moved[:, 1], turned[:, 0], turned[:, 2]]
        )

    def pushed(self, bodies):
        return ((self._now()[0] - self.start) @ [*self._heading, 0.0])[bodies]

    def displacements(self, joints, supports):
        """Opening and (complex) shear displacement of contact points (m,) [m], along the axes of
        the joint turned by the mean rotation of its bodies; supports: (n_supports, 3) as of
        `damage.wall.kinematics.ContactKinematics.displacements`."""
        place, turned = self._now()
        along, up, angle = supports.T
        place = np.vstack([place, self._of_ground(self.ground_at + along, up)]).T
        sin, cos = self._heading[::-1]
        tilted = Rotation.from_rotvec(np.outer(angle, [sin, -cos, 0.0]))
        turned = np.concatenate([turned.as_matrix(), tilted.as_matrix()]).transpose(1, 2, 0)
        (first, first_turned), (second, second_turned) = (
            (place[:, end] + _product(turned[:, :, end], arms[:, joints]), turned[:, :, end])
            for end, arms in ((end[joints], arms) for end, arms in zip(self._ends, self._arms))
        )
        apart = _product((first_turned + second_turned).transpose(1, 0, 2) / 2, second - first)
        across, along, through = _product(self._axes[:, :, joints], apart)
        return across, along + 1j * through

    def openings(self, select):
        return -np.array([self.geometries[joint].penetrationDepth for joint in select.tolist()])

    def shear_stresses(self, select):
        """Shear stresses as of SceneReader, complex."""
        shear = [self.physics[joint].shearForce for joint in select.tolist()]
        force = np.array([(on[0], on[1], on[2]) for on in shear]).T
        _, along, through = _product(self._axes[:, :, select], force)
        return -self.model.signs[select] * (along + 1j * through) / self.area[select]

    def force_of(self, joint):
        """Forces as of SceneReader; the shear force is a size."""
        contact = self.model.bonds[joint]
        if not contact.isReal:
            return 0.0, 0.0
        normal = -contact.phys.normalForce.dot(contact.geom.normal)
        return float(normal), float(contact.phys.shearForce.norm())

    def resultants(self):
        """Forces and moments of the contacts on each body, (n_bodies, 6) along x, y and z of the
        house [N, N m]."""
        forces = np.zeros((len(self.states), 6))
        for row, members, state in zip(forces, self.members, self.states):
            force = Vector3.Zero
            moment = Vector3.Zero
            for member in members:
                on_it = O.forces.f(member, True)
                force += on_it
                moment += (O.bodies[member].state.pos - state.pos).cross(on_it)
                moment += O.forces.t(member, True)
            row[:] = (*force, *moment)
        forces[:, :2] += self.on_top[:, :1] * self._heading
        return forces

    def out_of_plane(self, motion):
        return motion[:, 3:]

    def plane_resultants(self):
        """Sizes of the horizontal forces, and vertical ones, (n_bodies, 3) [N, N, nothing]."""
        force = self.resultants()
        return np.column_stack([np.hypot(force[:, 0], force[:, 1]), force[:, 2], 0 * force[:, 0]])

    def kinetic_energy(self, half_step, base_acceleration):
        loads = self.resultants()
        ax, az, ay = base_acceleration
        mass = self.mass[:, :1]
        speed = np.array([tuple(state.vel) for state in self.states])
        speed = speed + half_step * (loads[:, :3] / mass + [-ax, -ay, -GRAVITY - az])
        spin = np.array([tuple(state.angMom) for state in self.states]) + half_step * loads[:, 3:]
        turned = self._now()[1].as_matrix() @ self._of_body.transpose(0, 2, 1)
        spin = np.einsum("nji,nj->ni", turned, spin)
        return 0.5 * float(np.sum(mass * speed**2) + np.sum(spin**2 / self._inertia))

    def set_velocities(self, velocities):
        """Set velocities by coordinates (n_bodies, 6) [m/s, rad/s]; of three, those of the
        plane."""
        velocities = np.pad(velocities, ((0, 0), (0, 6 - velocities.shape[1])))
        ux, uz, turning, uy, about_x, about_z = velocities.T
        for state, axes, inertia, vel, spin in zip(
            self.states,
            self._of_body,
            self._inertia,
            np.column_stack([ux, uy, uz]),
            np.column_stack([about_x, -turning, about_z]),
        ):
            state.vel = Vector3(*(vel @ axes))
            state.angVel = Vector3(*(spin @ axes))
            state.angMom = Vector3(*((spin * inertia) @ axes))


def _product(matrices, vectors):
    """Products of matrices (3, 3, n) and vectors (3, n)."""
    return (matrices * vectors).sum(axis=1)
