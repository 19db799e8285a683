"""Arrays from YADE's scene, read between the interaction loop and the integration of a step: the
positions and forces of one instant, and the velocities half a step earlier."""

import numpy as np
from yade import O

from damage.units import GRAVITY


class SceneReader:
    """Reads the bodies and bonds of a YadeWall in the layout's order."""

    def __init__(self, model):
        contacts, bodies = model.layout.contacts, model.layout.bodies
        self.model = model
        # YADE sums the forces of a clump's cells only in its integrator, after these are read.
        self.members = [[*O.bodies[clump].shape.members] for clump in model.clumps]
        self.states = [O.bodies[clump].state for clump in model.clumps]
        self.geometries = [bond.geom for bond in model.bonds]
        self.physics = [bond.phys for bond in model.bonds]
        self.area, self.signs = contacts.area, model.signs
        self.normal_stiffness = contacts.normal_stiffness * contacts.area
        self.shear_stiffness = contacts.shear_stiffness * contacts.area
        self.mass = np.column_stack([bodies.mass, bodies.mass, bodies.inertia])
        self.follows = np.ones_like(self.mass)  # 0 where a velocity is prescribed, whatever the force
        self.start = np.column_stack([bodies.x, bodies.z])
        self.first_orientation = np.array([tuple(state.ori) for state in self.states])
        self.vertical = contacts.kind == 1  # head joints slip along z, others along x

    def motion(self, select=None):
        """Displacement and rotation (x towards z) since the wall was built: (n_bodies, 3).

        select: indices of the bodies to read, all others stay zero; None for all.
        """
        select = range(len(self.states)) if select is None else select
        raw = np.array([(p[0], p[2], q[0], q[1], q[2], q[3]) for p, q in
                        ((self.states[i].pos, self.states[i].ori) for i in select)]).reshape(-1, 6)
        x, y, z, w = raw[:, 2:].T
        x0, y0, z0, w0 = self.first_orientation[select].T
        # Quaternion now times the inverse of the first one: YADE's clumps start on permuted axes.
        real = w * w0 + x * x0 + y * y0 + z * z0
        about_y = w0 * y - w * y0 - z * x0 + x * z0
        turn = -2 * np.arctan2(np.copysign(1.0, real) * about_y, np.abs(real))
        motion = np.zeros((len(self.states), 3))
        motion[select] = np.column_stack([raw[:, :2] - self.start[select], turn])
        return motion

    def velocities(self):
        """Velocities half a step ago (n_bodies, 3) [m/s, m/s, rad/s]."""
        return np.array([(vel[0], vel[2], -turn[1])
                         for vel, turn in ((s.vel, s.angVel) for s in self.states)])

    def synchronous_velocities(self, half_step, base_acceleration):
        """Velocities at the instant of the positions: v(t - dt/2) + dt/2 a(t)."""
        field = (-base_acceleration[0], -GRAVITY - base_acceleration[1], 0.0)
        return self.velocities() + half_step * self.follows * (self.resultants() / self.mass + field)

    def resultants(self):
        """Forces and moment of the contacts on every body: (n_bodies, 3) [N, N, N m]."""
        return np.array([self._resultant(members, state.pos[0]) for members, state in zip(self.members, self.states)])

    def contact_forces(self):
        """Size of the force in every contact (n_contacts,) [N]."""
        return np.array([(bond.normalForce + bond.shearForce).norm() for bond in self.physics])

    def _resultant(self, members, x_centre):
        """Force along x and z [N] and moment [N m] of the contacts on a clump; rotations are small."""
        along = upward = moment = 0.0
        for cell in members:
            force = O.forces.f(cell, True)
            along += force[0]
            upward += force[2]
            moment += (O.bodies[cell].state.pos[0] - x_centre) * force[2] - O.forces.t(cell, True)[1]
        return along, upward, moment

    def openings(self):
        """Normal opening of every contact [m], tension positive: (n_contacts,)."""
        return np.array([p.initD - g.penetrationDepth for g, p in zip(self.geometries, self.physics)])

    def opening_of(self, index):
        """Normal opening of one contact [m]."""
        return self.physics[index].initD - self.geometries[index].penetrationDepth

    def shear_stresses(self, select):
        """Shear stress on the second body's side [Pa] of the contacts `select`, signed like the
        shear displacement: (m,)."""
        forces = [self.physics[i].shearForce for i in select]
        along = np.array([f[2] if v else f[0] for f, v in zip(forces, self.vertical[select])])
        return -along * self.signs[select] / self.area[select]

    def elastic_energy(self, broken):
        """Elastic energy of all bonds and of the dry contacts that they leave [J].

        broken: (n_joints,) of bool.
        """
        opening = self.openings()
        acting = opening < 0
        acting[:len(broken)] |= ~broken
        acting[len(broken):] = True
        shear = np.array([p.shearForce.norm() for p in self.physics])
        return 0.5 * float(np.sum(np.where(acting, self.normal_stiffness * opening**2, 0.0))
                           + np.sum(shear**2 / self.shear_stiffness))

    def still_bonded(self):
        """Whether each joint's bond holds: (n_joints,)."""
        return np.array([p.isCohesive for p in self.physics[:self.model.layout.n_joints]])

    def base_shear(self):
        """Horizontal force of the wall on the ground [N]."""
        return sum(O.forces.f(cell, True)[0] for cell in self.model.ground)

    def base_reaction(self):
        """Vertical force of the wall on the ground, downwards positive [N]."""
        return -sum(O.forces.f(cell, True)[2] for cell in self.model.ground)
