"""Arrays from YADE's scene, read between the interaction loop and the integration of a step.

Positions and forces are of one time, velocities half a step earlier.
"""

import numpy as np
from yade import O, Vector3

from damage.elementary import atan
from damage.units import GRAVITY
from damage.wall.kinematics import ContactKinematics
from yade_scripts.bonds import bonds_by_law


class SceneReader:
    """Reads the bodies and bonds of a YadeWall in the layout's order."""

    def __init__(self, model):
        contacts = model.layout.contacts
        bodies = model.layout.bodies
        self.model = model
        # YADE sums the forces of a clump's members only in its integrator, after these are read.
        self.members = model.members
        self.states = [O.bodies[clump].state for clump in model.clumps]
        self.geometries = model.geometries
        self.physics = model.physics
        self.area = contacts.area
        self.holding = list(range(model.layout.n_joints))  # joints whose bond has not failed
        self._breaks_seen = 0
        self._passed = []
        self.by_law = bonds_by_law(model.layout)
        self.normal_stiffness = contacts.normal_stiffness * contacts.area
        self.shear_stiffness = contacts.shear_stiffness * contacts.area
        self.mass = np.column_stack([bodies.mass, bodies.mass, bodies.inertia])
        # 0 where a velocity is prescribed, whatever the force
        self.follows = np.where(model.layout.restrained, 0.0, 1.0)
        # forces of the bearing and the constant load [N, N, N m]
        self.on_top = np.zeros_like(self.mass)
        self.start = np.column_stack([bodies.x, bodies.z])
        self.push_axis = Vector3(1, 0, 0)  # direction of a spreader beam, and of the ground's tilts
        self.ground_at = model.layout.supports.x  # along that
        self.first_orientation = np.array([tuple(state.ori) for state in self.model.turning])
        self._kinematics = ContactKinematics(model.layout)

    def pushed(self, bodies):
        """Displacement of these bodies along a spreader beam (m,) [m]."""
        return self.motion(bodies)[bodies, 0]

    def beyond_strength(self):
        """Bonds that YADE's law has flagged in this step as beyond their strengths: two lists of
        joints, those that failed, and those that follow the joint law."""
        breaks = self.model.law.nbTensCracks + self.model.law.nbShearCracks
        if breaks == self._breaks_seen:
            return [], []
        expected = breaks - self._breaks_seen
        self._breaks_seen = breaks
        # mostly those of the step before, which go on softening
        flagged = [joint for joint in self._passed if not self.physics[joint].isCohesive]
        if len(flagged) < expected:
            flagged = [joint for joint in self.holding if not self.physics[joint].isCohesive]
        failed = [joint for joint in flagged if not self.by_law[joint]]
        self._passed = [joint for joint in flagged if self.by_law[joint]]
        if failed:
            gone = set(failed)
            self.holding = [joint for joint in self.holding if joint not in gone]
        return failed, list(self._passed)

    def let_go(self, joint):
        """Note that a bond that follows the joint law has failed."""
        self.holding.remove(joint)
        self._passed.remove(joint)

    def motion(self, select=None):
        """Displacements and rotations (x towards z) since the wall was built, (n_bodies, 3) [m, m,
        rad].

        select: indices of the bodies to read, all others are zero; None for all.
        """
        select = range(len(self.states)) if select is None else select
        raw = np.array(
            [
                (p[0], p[2], q[0], q[1], q[2], q[3])
                for p, q in ((self.states[i].pos, self.model.turning[i].ori) for i in select)
            ]
        ).reshape(-1, 6)
        x, y, z, w = raw[:, 2:].T
        x0, y0, z0, w0 = self.first_orientation[select].T
        # Quaternion now times the inverse of the first one: YADE's clumps start on permuted axes.
        real = w * w0 + x * x0 + y * y0 + z * z0
        about_y = w0 * y - w * y0 - z * x0 + x * z0
        rotation = -2 * atan(about_y / real)
        motion = np.zeros((len(self.states), 3))
        motion[select] = np.column_stack([raw[:, :2] - self.start[select], rotation])
        return motion

    def synchronous_velocities(self, half_step, base_acceleration):
        """Velocities at the time of the positions, v(t - dt/2) + dt/2 a(t), (n_bodies, 3) [m/s,
        m/s, rad/s].

        half_step: dt/2 [s]; base_acceleration: along x and z [m/s2].
        """
        field = (-base_acceleration[0], -GRAVITY - base_acceleration[1], 0.0)
        half_a_step_ago = np.array(
            [
                (vel[0], vel[2], -rotating[1])
                for vel, rotating in ((s.vel, s.angVel) for s in self.states)
            ]
        )
        return half_a_step_ago + half_step * self.follows * (
            np.divide(
                self.resultants(), self.mass, where=self.mass > 0, out=np.zeros_like(self.mass)
            )
            + field
        )

    def kinetic_energy(self, half_step, base_acceleration):
        """At the time of the positions [J]; arguments as of `synchronous_velocities`."""
        speed = self.synchronous_velocities(half_step, base_acceleration)
        return 0.5 * float(np.sum(self.mass * speed**2))

    def set_velocities(self, velocities):
        """Set those of the bodies by their coordinates (n_bodies, 3) [m/s, m/s, rad/s]."""
        for state, (vx, vz, rotating) in zip(self.states, velocities):
            state.vel = Vector3(vx, 0, vz)
            state.angVel = Vector3(0, -rotating, 0)

    def turned_by_heading(self, along, up):
        """Along x, z and y what is along the wall and upwards."""
        return along, up, 0.0

    def displacements(self, joints, supports):
        """Opening and shear displacement of contact points, by the motion of their bodies (m,) [m];
        supports: (n_supports, 3) as of ContactKinematics."""
        sides = np.concatenate([side[joints] for side in self._kinematics.ends])
        motion = self.motion(np.unique(sides[sides < len(self.states)]))
        return self._kinematics.displacements(motion, joints, supports)

    def out_of_plane(self, motion):
        """Coordinates of a `motion` out of the plane of the walls, None of a plane wall."""
        return

    def plane_resultants(self):
        """`resultants` in the plane of the walls."""
        return self.resultants()

    def resultants(self):
        """Forces and moments of the contacts on each body, and of what is on a restrained top,
        (n_bodies, 3) [N, N, N m]."""
        return self.on_top + [
            self._resultant(members, state.pos[0], state.pos[2])
            for members, state in zip(self.members, self.states)
        ]

    def contact_forces(self):
        """Magnitudes of the forces in all contacts, (n_contacts,) [N]."""
        return np.array([(bond.normalForce + bond.shearForce).norm() for bond in self.physics])

    def _resultant(self, members, x_centre, z_centre):
        """Force along x and z [N] and moment from x towards z [N m] of the contacts on a clump."""
        along = upward = moment = 0.0
        for member in members:
            force = O.forces.f(member, True)
            if force[0] or force[2]:
                along += force[0]
                upward += force[2]
                place = O.bodies[member].state.pos
                moment += (
                    (place[0] - x_centre) * force[2]
                    - (place[2] - z_centre) * force[0]
                    - O.forces.t(member, True)[1]
                )
        return along, upward, moment

    def opening_of(self, index):
        """Normal opening of a contact point [m]."""
        rest = self.physics[index].initD if self.model.bonded[index] else 0.0
        return rest - self.geometries[index].penetrationDepth

    def openings(self, select):
        """`opening_of` contact points that failed, (m,) [m]."""
        return np.array([self.opening_of(index) for index in select])

    def shear_stresses(self, select):
        """Shear stresses of the contact points `select` (indices), (m,) [Pa].

        Signs are those of the shear displacement of the second body.
        """
        # The force lies in the plane: its component along the tangent, the normal rotated by a
        # right angle.
        along = np.array(
            [
                p.shearForce[0] * n[2] - p.shearForce[2] * n[0]
                for p, n in ((self.physics[k], self.geometries[k].normal) for k in select)
            ]
        )
        # The signs of normal and tangent change together, so that YADE's order of the bodies does
        # not matter.
        return -along * self.model.handed[select] / self.area[select]

    def joint_stresses(self, n_joints):
        """Normal stress, tension positive, and shear stress of the first contact points on their
        whole areas, signed as in `shear_stresses`, (n_joints, 2) [Pa]."""
        return (
            np.array([self.force_of(joint) for joint in range(n_joints)])
            / self.area[:n_joints, np.newaxis]
        )

    def force_of(self, joint):
        """Normal force of a contact point, tension positive, and shear force, signed as in
        `shear_stresses`, both along the present joint [N]."""
        normal = shear = 0.0
        contact = self.model.bonds[joint]
        if contact.isReal:  # not of one that has ended
            n = contact.geom.normal
            along = contact.phys.shearForce
            normal -= contact.phys.normalForce.dot(n)
            shear -= (along[0] * n[2] - along[2] * n[0]) * self.model.handed[joint]
        return float(normal), float(shear)

    def elastic_energy(self, broken):
        """Elastic energy of all bonds and dry contacts [J].

        broken: whether joints have failed, (n_joints,) bool.
        """
        opening = np.array(
            [
                (p.initD if bonded else 0.0) - g.penetrationDepth
                for g, p, bonded in zip(self.geometries, self.physics, self.model.bonded)
            ]
        )
        acting = opening < 0
        acting[: len(broken)] |= ~broken
        acting[len(broken) :] = True
        shear = np.array([p.shearForce.norm() for p in self.physics])
        colliding = sum(
            p.normalForce.squaredNorm() / p.kn + p.shearForce.squaredNorm() / p.ks
            for p in (contact.phys for contact in self.model.collisions())
        )
        return 0.5 * colliding + 0.5 * float(
            np.sum(np.where(acting, self.normal_stiffness * opening**2, 0.0))
            + np.sum(shear**2 / self.shear_stiffness)
        )

    def support_forces(self, displacement):
        """Forces and moments of the wall on the supports, (n_supports, 3) [N, N, N m].

        displacement: of their reference points, about which the moments are, (n_supports, 3) [m, m,
        rad].
        """
        return np.array(
            [
                self._resultant(members, x + ux, uz)
                for members, x, (ux, uz, _) in zip(
                    self.model.ground, self.model.layout.supports.x, displacement
                )
            ]
        )

    def base_shear(self, axis=0):
        """Horizontal force of the wall on all supports along x (0) or y (1) [N]."""
        return self._on_supports(axis)

    def base_reaction(self):
        """Vertical force of the wall on all supports, downwards positive [N]."""
        return -self._on_supports(2)

    def _on_supports(self, axis):
        return sum(
            O.forces.f(member, True)[axis] for members in self.model.ground for member in members
        )
