"""Opening and shear displacement of contact points from the rigid motion of the bodies.

Exact for any rotation: a contact point belongs to both bodies and rotates with each; opening and
shear are measured along the joint's axes turned by the mean rotation of the two.
"""

import numpy as np

from damage.elementary import cos, sin
from damage.wall.kinds import rows


def rigid_displacement(ux, uz, turn, x, z):
    """Displacement along x and z of points of a rigid body, exact for any rotation.

    ux, uz [m], turn [rad, x towards z]: of the body's centre; x, z [m]: of the points from the
    centre at rest.
    """
    less = cos(turn) - 1
    along = sin(turn)
    return ux + less * x - along * z, uz + along * x + less * z


def slide_limits(first, second, upright, bodies):
    """Shear displacements of `second` along `first` between which the faces of their joint overlap:
    least and most (n,) [m], infinite on supports, which have no end.

    first, second: (n,) indices of bodies; upright: (n,) bool, of head joints and cuts; bodies: x,
    z, length and height (n_bodies,) [m].
    """
    on_ground = first < 0
    ends = []
    for body in (np.where(on_ground, second, first), second):
        middle = np.where(upright, bodies.z[body], bodies.x[body])
        half = np.where(upright, bodies.height[body], bodies.length[body]) / 2
        ends.append((middle - half, middle + half))
    (start, end), (other_start, other_end) = ends
    return np.where(on_ground, -np.inf, start - other_end), np.where(
        on_ground, np.inf, end - other_start
    )


class ContactKinematics:
    """Opening and shear of the contacts of a layout, all of them or those of `select`."""

    def __init__(self, layout):
        contacts = layout.contacts
        bodies = layout.bodies
        self.at_rest = np.zeros((len(layout.supports), 3))
        self.ends = [rows(body, len(bodies)) for body in (contacts.first, contacts.second)]
        x = np.append(bodies.x, layout.supports.x)
        z = np.append(bodies.z, self.at_rest[:, 1])
        self.arms = [(contacts.x - x[body], contacts.z - z[body]) for body in self.ends]
        self.head = contacts.upright

    def displacements(self, motion, select=slice(None), supports=None):
        """Opening u_n and shear u_s [m], each (n_selected,).

        motion: (n_bodies, 3) displacement of the centres [m] and rotation x towards z [rad];
        supports: (n_supports, 3) the same of the supports, None where they rest.
        """
        moved = np.vstack([motion, self.at_rest if supports is None else supports])
        motions = [moved[end[select]].T for end in self.ends]
        first, second = (
            rigid_displacement(*moves, rx[select], rz[select])
            for moves, (rx, rz) in zip(motions, self.arms)
        )
        dx = second[0] - first[0]
        dz = second[1] - first[1]
        turn = (motions[0][2] + motions[1][2]) / 2
        across = cos(turn)
        along = sin(turn)
        along_x = across * dx + along * dz
        along_z = across * dz - along * dx
        head = self.head[select]
        return np.where(head, along_x, along_z), np.where(head, along_z, along_x)
