"""Opening and shear displacement of contact points from the rigid motion of the bodies.

Exact for any rotation: a contact point belongs to both bodies and rotates with each; opening and
shear are measured along the joint's axes turned by the mean rotation of the two.
"""

import numpy as np

from damage.wall.layout import GROUND, HEAD


class ContactKinematics:
    """Opening and shear of the contacts of a layout, all of them or those of `select`."""

    def __init__(self, layout):
        contacts, bodies = layout.contacts, layout.bodies
        # The ground is one more body at the end, at rest.
        self.ends = [np.where(body == GROUND, len(bodies), body)
                     for body in (contacts.first, contacts.second)]
        x, z = np.append(bodies.x, 0.0), np.append(bodies.z, 0.0)
        self.arms = [(contacts.x - x[body], contacts.z - z[body]) for body in self.ends]
        self.head = contacts.kind == HEAD

    def displacements(self, motion, select=slice(None)):
        """Opening u_n and shear u_s [m], each (n_selected,).

        motion: (n_bodies, 3) displacement of the centres [m] and rotation x towards z [rad].
        """
        motion = np.vstack([motion, np.zeros(3)])
        first, second = (self._point_motion(motion, end, select) for end in (0, 1))
        dx, dz = second[0] - first[0], second[1] - first[1]
        turn = (first[2] + second[2]) / 2
        cos, sin = np.cos(turn), np.sin(turn)
        along_x, along_z = cos * dx + sin * dz, cos * dz - sin * dx
        head = self.head[select]
        return np.where(head, along_x, along_z), np.where(head, along_z, along_x)

    def _point_motion(self, motion, end, select):
        # A copy, row by row: where an output happens to lie right behind a strided input numpy takes another cosine,
        # which may differ in its last bit, and two runs of one command would not be the same.
        ux, uz, turn = np.array(motion[self.ends[end][select]].T, order="C")
        rx, rz = self.arms[end][0][select], self.arms[end][1][select]
        cos, sin = np.cos(turn) - 1, np.sin(turn)
        return ux + cos * rx - sin * rz, uz + sin * rx + cos * rz, turn
