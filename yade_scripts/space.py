"""Arrays from the scene of a house, whose bodies move in space."""

import numpy as np
from scipy.spatial.transform import Rotation
from yade import O, Vector3

from damage.units import GRAVITY
from damage.wall.kinds import rows
from yade_scripts.scene import SceneReader


class SpaceReader(SceneReader):
    """As SceneReader; a body's six coordinates are those of its wall, as of
    `damage.wall.space.Space.rows`: along it, upwards, rotation from x towards z, across, rotations
    about the axes along and upwards."""

    def __init__(self, model):
        super().__init__(model)
        layout = model.layout
        space, bodies, contacts = layout.space, layout.bodies, layout.contacts
        self.start, self._of_body = space.centres(bodies), space.of_body
        self._first = Rotation.from_quat(self.first_orientation).inv()
        self._ends = [rows(end, len(bodies)) for end in (contacts.first, contacts.second)]
        centres = np.vstack([self.start, np.zeros(3)])  # the ground last
        self._arms = [space.place - centres[end] for end in self._ends]
        turn = np.radians(space.house.heading)
        self._heading = np.round([np.cos(turn), np.sin(turn)], 15)
        # about the axes of a body: along, across and upwards
        self._inertia = np.insert(space.across_inertia, 1, bodies.inertia, axis=1)

    def turned_by_heading(self, along, up, across):
        """Along x, z and y of the house what is along its heading, upwards and across."""
        cos, sin = self._heading
        return cos * along - sin * across, up, sin * along + cos * across

    def support_forces(self, displacement):
        """As of SceneReader: along the heading and upwards, and the moment from the one towards the
        other about the origin of the plan."""
        cos, sin = self._heading
        force, moment = Vector3.Zero, Vector3.Zero
        for member in self.model.ground[0]:
            on_it = O.forces.f(member, True)
            force += on_it
            moment += O.bodies[member].state.pos.cross(on_it) + O.forces.t(member, True)
        return np.array(
            [[cos * force[0] + sin * force[1], force[2], sin * moment[0] - cos * moment[1]]]
        )

    def _turned(self):
        """Rotations of all bodies since the wall was built."""
        return Rotation.from_quat([tuple(one.ori) for one in self.model.turning]) * self._first

    def motion(self, select=None):
        """Coordinates of all bodies since the wall was built, (n_bodies, 6) [m, m, rad, m, rad,
        rad]."""
        moved = np.array([tuple(state.pos) for state in self.states]) - self.start
        moved = np.einsum("nij,nj->ni", self._of_body, moved)
        turned = np.einsum("nij,nj->ni", self._of_body, self._turned().as_rotvec())
        return np.column_stack(
            [moved[:, 0], moved[:, 2], -turned[:, 1], moved[:, 1], turned[:, 0], turned[:, 2]]
        )

    def displacements(self, joints):
        """Opening and (complex) shear displacement of contact points (m,) [m], along the axes of
        the joint turned by the mean rotation of its bodies."""
        place = np.vstack([[tuple(state.pos) for state in self.states], np.zeros(3)])
        turned = np.concatenate([self._turned().as_matrix(), np.eye(3)[np.newaxis]])
        ends = [end[joints] for end in self._ends]
        first, second = (
            place[end] + np.einsum("nij,nj->ni", turned[end], arms[joints])
            for end, arms in zip(ends, self._arms)
        )
        axes = np.einsum(
            "nij,nkj->nki", (turned[ends[0]] + turned[ends[1]]) / 2, self._axes[joints]
        )
        across, along, through = np.einsum("nki,ni->kn", axes, second - first)
        return across, along + 1j * through

    @property
    def _axes(self):
        return self.model.layout.space.axes

    def shear_stresses(self, select):
        """As of SceneReader, complex."""
        force = np.array([tuple(self.physics[joint].shearForce) for joint in select])
        sign = np.array([-self.model.signs[joint] for joint in select])
        _, along, through = np.einsum("nki,ni->kn", self._axes[select], force)
        return sign * (along + 1j * through) / self.area[select]

    def force_of(self, joint):
        """As of SceneReader; the shear force is a size."""
        (contact,) = self.model.contacts_of(joint)
        if not contact.isReal:
            return 0.0, 0.0
        normal = -contact.phys.normalForce.dot(contact.geom.normal)
        return float(normal), float(contact.phys.shearForce.norm())

    def resultants(self):
        """Forces and moments of the contacts on each body, (n_bodies, 6) along x, y and z of the
        house [N, N m]."""
        found = np.zeros((len(self.states), 6))
        for row, members, state in zip(found, self.members, self.states):
            force, moment = Vector3.Zero, Vector3.Zero
            for member in members:
                on_it = O.forces.f(member, True)
                force += on_it
                moment += (O.bodies[member].state.pos - state.pos).cross(on_it)
                moment += O.forces.t(member, True)
            row[:] = (*force, *moment)
        return found

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
        turned = self._turned().as_matrix() @ self._of_body.transpose(0, 2, 1)
        spin = np.einsum("nji,nj->ni", turned, spin)
        return 0.5 * float(np.sum(mass * speed**2) + np.sum(spin**2 / self._inertia))

    def set_velocities(self, velocities):
        """By coordinates (n_bodies, 6) [m/s, rad/s]; of three, those of the plane."""
        velocities = np.pad(velocities, ((0, 0), (0, 6 - velocities.shape[1])))
        ux, uz, turning, uy, about_x, about_z = velocities.T
        for state, axes, inertia, vel, spin in zip(
            self.states,
            self._of_body,
            self._inertia,
            np.column_stack([ux, uy, uz]),
            np.column_stack([about_x, -turning, about_z]),
        ):
            state.vel, state.angVel = Vector3(*(vel @ axes)), Vector3(*(spin @ axes))
            state.angMom = Vector3(*((spin * inertia) @ axes))
