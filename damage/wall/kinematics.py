"""Opening and shear displacement of contact points from the rigid motion of the bodies.

Exact for any rotation: a contact point belongs to both bodies and rotates with each; opening and
shear are measured along the joint's axes turned by the mean rotation of the two.
"""

import numpy as np

from damage.elementary import cos, sin
from damage.wall.kinds import rows

CORNER_RADIUS = 0.01
"""Radius of a loose brick's corners over the length of a whole brick [-]."""


def rigid_displacement(ux, uz, turn, x, z):
    """Displacement along x and z of points of a rigid body, exact for any rotation.

    ux, uz [m], turn [rad, x towards z]: of the body's centre; x, z [m]: of the points from the
    centre at rest.
    """
    less, along = cos(turn) - 1, sin(turn)
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


def places_of(layout):
    """Places and normals of the contact points in the plane of the wall of each of their two bodies
    (2, n_contacts, 3), x along it, y through its thickness and z upwards [m], of a house as
    unfolded; and the distance (n_contacts,) [m] from there to the inside of both bodies."""
    contacts, bodies, cells, space = layout.contacts, layout.bodies, layout.cells, layout.space
    if space is None:
        nothing, upright = np.zeros(len(contacts)), contacts.upright
        place = np.column_stack([contacts.x, nothing, contacts.z])
        normal = np.column_stack([upright, nothing, ~upright]).astype(float)
        width = cells.right - cells.left
        narrow = np.minimum(width[contacts.first_cell], width[contacts.second_cell])
        reach = np.where(upright, narrow, layout.wall.brick.height) / 2
        return np.stack([place] * 2), np.stack([normal] * 2), reach
    places, normals = [], []
    for body in (contacts.first, contacts.second):
        of = np.maximum(body, 0)
        centre = space.unfolded(bodies)[of]
        ground = (body < 0)[:, None]
        places.append(np.where(ground, space.place, centre + space.arms(bodies, of)))
        turned = np.einsum("nij,nj->ni", space.of_body[of], space.axes[:, 0])
        normals.append(np.where(ground, space.axes[:, 0], turned))
    return np.stack(places), np.stack(normals), space.reach


class ContactKinematics:
    """Opening and shear of the contacts of a layout, all of them or those of `select`."""

    def __init__(self, layout):
        contacts, bodies = layout.contacts, layout.bodies
        self.at_rest = np.zeros((len(layout.supports), 3))
        self.ends = [rows(body, len(bodies)) for body in (contacts.first, contacts.second)]
        x, z = np.append(bodies.x, layout.supports.x), np.append(bodies.z, self.at_rest[:, 1])
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
            rigid_displacement(*of, rx[select], rz[select])
            for of, (rx, rz) in zip(motions, self.arms)
        )
        dx, dz = second[0] - first[0], second[1] - first[1]
        turn = (motions[0][2] + motions[1][2]) / 2
        across, along = cos(turn), sin(turn)
        along_x, along_z = across * dx + along * dz, across * dz - along * dx
        head = self.head[select]
        return np.where(head, along_x, along_z), np.where(head, along_z, along_x)
