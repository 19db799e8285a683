"""Bodies of a wall in YADE's scene: bricks as clumps of boxes, members of bonds, the tips and faces
of contact points that have failed, corners, and supports.

Bodies are built in the wall's plane, those of a house (`damage.house.space`) in that of its walls
unfolded, and then placed.  A house has all six freedoms.  There all tips and corners are parts of
the clumps from the start: YADE finds the principal axes of a clump anew when parts are added, as
eigenvectors that may be a left-handed set, and then turns it wrongly.
"""

from collections import Counter
from dataclasses import dataclass

import numpy as np
import yade
from yade import O, Quaternion, Vector3, utils

from damage.wall.kinds import GROUND, rows
from damage.wall.kinematics import places_of

TIP = 5e-4  # [m], radius: beyond this depth, at 33 MPa, a tip would be assigned to another face
_POINT = 1e-3  # [m], radius of bond members, without effect
CORNER = 1e-3  # [m], radius of the spheres in the corners, the contacts of loose bricks
# [m], a contact point closer to the end of a face than this has its tip on that brick
_MARGIN = 1e-2
REACH = 3e-2  # [m], extension of a face where the contact point lies at the ends of both faces
_COLLISION = 2e8  # [N/m], normal stiffness of loose bricks' contacts
_COLLISION_SHEAR = 0.4  # [-], shear stiffness over the normal
_GROUND = 10.0  # [m], extension of the ground beyond the wall
SEEN, FACE = 1, 2  # bits of masks: seen by the collider; faces do not collide with faces


class Parts:
    """Bodies of a wall in YADE's scene, added by the constructor.

    clumps, members, ground: as in YadeWall; ends: ids of the members that each bond joins
    (n_contacts, 2); tips: {contact point: Tip} of those that may fail; faces: {(body, kind): id}
    of the boxes; tip: material; waiting, corners: of a house, as in YadeWall.
    """

    def __init__(self, layout, corner_depth):
        self.layout, self._corner_depth = layout, corner_depth
        self.waiting, self.corners = {}, []
        self._places, self._normals, self._reach = places_of(layout)
        self._add_materials()
        self.ends = [[None, None] for _ in range(len(layout.contacts))]
        self.tips = _tips(layout, self._places, self._normals)
        self.clumps, self.members, self.ground, self.faces = [], [], [], {}
        self._points = self._plan_points()
        for body in range(len(layout.bodies)):
            self._add_brick(body)
        for support in range(len(layout.supports)):
            self._add_support(support)

    def _add_materials(self):
        brick, joint = self.layout.wall.brick, self.layout.wall.joint
        common = collision_material(joint)
        materials = (
            yade.FrictMat(density=brick.density, label="brick", **common),
            yade.FrictMat(density=0.0, label="tip", **common),
            yade.JCFpmMat(
                density=0.0,
                young=1e9,
                poisson=0.3,
                frictionAngle=joint.friction_angle,
                label="bond",
            ),
        )
        self._solid, self.tip, self._bond = (
            O.materials[O.materials.append(one)] for one in materials
        )

    def _plan_points(self):
        """Bond members of each body, the supports last: {(x, y, z, number): [(contact, side),
        ...]}.

        A bond has two members on the normal of the joint, at equal distances from it; bonds share
        coincident members.
        """
        contacts = self.layout.contacts
        n_bodies = len(self.layout.bodies)
        wanted, alike = [{} for _ in range(n_bodies + len(self.layout.supports))], Counter()
        ends = np.column_stack([rows(contacts.first, n_bodies), contacts.second])
        for index in range(len(contacts)):
            # At corners two overlaps may end in one point; YADE allows one bond between two
            # members.
            twin = (
                contacts.first[index],
                contacts.second[index],
                *np.round(self._places[1][index], 7),
            )
            alike[twin] += 1
            for side, body in enumerate(ends[index]):
                by = (2 * side - 1) * self._reach[index] * self._normals[side][index]
                key = (*np.round(self._places[side][index] + by, 7), alike[twin])
                wanted[body].setdefault(key, []).append((index, side))
        return wanted

    def _add_points(self, body):
        """Bond members (spheres) of the body in this row."""
        return [ball(place[:3], _POINT, self._bond) for place in self._points[body]]

    def _note(self, body, ids):
        """Assign the ids of the bond members of the body in this row to their contact points."""
        for identity, users in zip(ids, self._points[body].values()):
            for index, side in users:
                self.ends[index][side] = identity

    def _box(self, centre, extents, color, seen=True):
        box = utils.box(
            centre, extents, material=self._solid if seen else self.tip, color=color, wire=not seen
        )
        box.bounded = seen
        box.mask = SEEN | FACE
        return box

    def _add_brick(self, body):
        bodies, (centre, size) = self.layout.bodies, _box_of(self.layout, body)
        half = size / 2
        color = _brick_color(self.layout, body)
        kinds = [
            "box",
            *sorted({tip.face[1] for tip in self.tips.values() if tip.face[0] == body} - {"box"}),
        ]
        across = REACH if self.layout.space else 0
        reach = {
            "box": (0, 0, 0),
            "bed": (REACH, across, 0),
            "head": (0, across, REACH),
            "side": (REACH, 0, REACH),
        }
        boxes = [
            self._box(centre, np.add(half, reach[kind]), color, seen=kind == "box")
            for kind in kinds
        ]
        points = self._add_points(body)
        mass, space = bodies.mass[body], self.layout.space
        tips = [one for one, tip in self.tips.items() if space and tip.body == body]
        later = [self._waiting_tip(self.tips[one]) for one in tips]
        if space:
            later += [
                ball(place, CORNER, self.tip)
                for place in corner_places(self.layout, body, CORNER + self._corner_depth)
            ]
            # distinct, so that YADE takes the axes of the box for those of the clump
            boxes[0].state.mass, boxes[0].state.inertia = mass, mass * Vector3(1, 2, 3)
        clump, ids = O.bodies.appendClumped([*boxes, *points, *later])
        self.faces.update({(body, kind): identity for kind, identity in zip(kinds, ids)})
        self._note(body, ids[len(boxes) :])
        self.clumps.append(clump)
        self.members.append(list(ids[: len(boxes) + len(points)]))
        if not space:
            _set_clump(O.bodies[clump].state, mass, bodies.inertia[body], self.layout.held[body])
            return
        ids = ids[len(ids) - len(later) :]
        self.waiting.update(zip(tips, ids))
        self.corners.append(ids[len(tips) :])
        along, up = space.across_inertia[body]
        _set_free(O.bodies[clump], mass, (along, bodies.inertia[body], up))

    def _waiting_tip(self, tip):
        """The tip of a contact point that has not failed yet."""
        place = [x + TIP * by for x, by in zip(tip.place, tip.inwards)]
        return ball(place, TIP, self.tip)

    def place(self, newton):
        """Move the bodies of a house from where they were built to their places."""
        space = self.layout.space
        centres = space.centres(self.layout.bodies)
        for clump, centre, number in zip(self.clumps, centres, space.wall):
            state = O.bodies[clump].state
            turn = Quaternion((0, 0, 1), np.radians(space.house.walls[number].direction))
            state.pos, state.ori = Vector3(*centre), turn * state.ori
            state.refPos, state.refOri = state.pos, state.ori
        newton()  # members follow

    def _add_support(self, support):
        """Add a support: a box of the height of a brick, up to halfway to its neighbours, or beyond
        the wall."""
        brick, all_of = self.layout.wall.brick, self.layout.supports
        edges = [
            all_of.left[0] - _GROUND,
            *((all_of.right[:-1] + all_of.left[1:]) / 2),
            all_of.right[-1] + _GROUND,
        ]
        left, right, row = edges[support], edges[support + 1], len(self.layout.bodies) + support
        across, y = brick.thickness / 2, 0.0
        if self.layout.space:
            places, beyond = self.layout.space.place[:, :2], _GROUND
            if len(all_of) > 1:  # below one brick, or where a corner took it away
                own = places[self.layout.contacts.first == GROUND - support]
                places, beyond = (own, REACH) if len(own) else (places[:1], 0.0)
            (left, front), (right, back) = (
                pick(places, axis=0) + sign * (beyond + TIP)
                for pick, sign in ((np.min, -1), (np.max, 1))
            )
            across, y = (back - front) / 2, (front + back) / 2
        box = self._box(
            ((left + right) / 2, y, -brick.height / 2),
            ((right - left) / 2, across, brick.height / 2),
            (0.4, 0.4, 0.4),
        )
        parts = [box, *self._add_points(row)]
        for part in parts:
            part.state.blockedDOFs = "xyzXYZ"
        ids = [O.bodies.append(part) for part in parts]
        self.ground.append(ids)
        self.faces[GROUND - support, "box"] = ids[0]
        self._note(row, ids[1:])


@dataclass(frozen=True)
class Tip:
    """Tip of a contact point: its place (x, y, z) in the undeformed wall of its body [m]; inwards:
    unit vector from there into the body of the tip; is_second: whether that is the layout's second
    body; face: (body, kind) of the other side."""

    place: tuple
    inwards: tuple
    body: int
    is_second: bool
    face: tuple


def _tips(layout, places, normals):
    """{contact point: Tip} of all that may fail; places, normals: of each contact point in the
    walls of both bodies, (2, n_contacts, 3)."""
    contacts = layout.contacts
    found = {}
    for index in range(layout.n_joints):
        if np.isinf(contacts.tensile_strength[index]) and np.isinf(contacts.cohesion[index]):
            continue
        bodies = int(contacts.first[index]), int(contacts.second[index])
        margins = [
            _margin(layout, body, place[index], normal[index])
            for body, place, normal in zip(bodies, places, normals)
        ]
        if min(margins) > _MARGIN or abs(margins[0] - margins[1]) < 1e-6:
            # of a house the three points through the thickness together
            side = (index // 3 if layout.space else index) % 2 if bodies[0] >= 0 else 1
        else:
            side = int(margins[0] > margins[1])  # the tip is on the side whose face ends nearer
        kind = ("head", "side", "bed")[np.abs(normals[1 - side][index]).argmax()]
        inwards = 1.0 if side else -1.0
        found[index] = Tip(
            tuple(places[side][index].tolist()),
            tuple((inwards * normals[side][index]).tolist()),
            bodies[side],
            bool(side),
            (bodies[1 - side], "box" if max(margins) > _MARGIN or bodies[1 - side] < 0 else kind),
        )
    return found


def _margin(layout, body, place, normal):
    """Distance of a contact point from the nearest end of a body's face, (x, y, z) in its wall [m];
    in a plane wall y does not matter."""
    if body < 0:
        return _GROUND
    centre, size = _box_of(layout, body)
    half = size / 2
    return min(
        half[k] - abs(place[k] - centre[k])
        for k in ((0, 1, 2) if layout.space else (0, 2))
        if abs(normal[k]) < 0.5
    )


def _box_of(layout, body):
    """Centre (x, y, z) and size of a body, as unfolded (3,) [m]."""
    bodies, space = layout.bodies, layout.space
    y, depth = 0.0, layout.wall.brick.thickness
    if space:
        y, depth = float(space.offset[body]), space.depth[body]
    centre = float(bodies.x[body]), y, float(bodies.z[body])
    return centre, np.array([bodies.length[body], depth, bodies.height[body]])


def corner_places(layout, body, inset):
    """Of the spheres in the corners of a body (x, y, z) [m], in the middle of the thickness in a
    plane wall."""
    (x, y, z), size = _box_of(layout, body)
    half = size / 2 - inset
    return [
        (x + right * half[0], y + through * half[1], z + up * half[2])
        for right in (-1, 1)
        for up in (-1, 1)
        for through in ((-1, 1) if layout.space else (0,))
    ]


def ball(place, radius, material):
    """A sphere at (x, y, z) [m] that the collider does not see."""
    ball = utils.sphere(tuple(map(float, place)), radius, material=material, color=(0.3, 0.3, 0.3))
    ball.bounded = False
    return ball


def collision_material(joint):
    """{parameter: value} of the materials of loose bricks' contacts; joint:
    damage.wall.parameters.Joint.

    YADE gives a contact of radius R and modulus E the stiffness E R.
    """
    return {
        "young": _COLLISION / CORNER,
        "poisson": _COLLISION_SHEAR,
        "frictionAngle": joint.friction_angle,
    }


def _set_clump(state, mass, inertia, held):
    """Set mass and inertia of a clump, and restrict it to motion in the plane, and where restraints
    hold it.

    All three inertias are I_yy, since YADE permutes the axes of a clump.
    """
    state.mass = mass
    state.inertia = Vector3(inertia, inertia, inertia)
    state.blockedDOFs = "yXZ" + "".join(name for name, fixed in zip("xzY", held) if fixed)
    state.refPos = state.pos
    state.refOri = state.ori


def _set_free(body, mass, inertia):
    """Set the mass of a clump that moves in space, and its inertia about the axes along, across and
    upwards (3,): YADE has chosen the order of the clump's own."""
    turn = body.state.ori.toRotationMatrix()
    order = [max(range(3), key=lambda row: abs(turn[row, axis])) for axis in range(3)]
    body.state.mass, body.state.inertia = mass, Vector3(*(float(inertia[row]) for row in order))
    body.aspherical = True


def _brick_color(layout, body):
    """Colour (red, green, blue) [-]: bricks alternate, so that neighbours differ; top masses are
    grey."""
    colors = ((0.75, 0.42, 0.32), (0.66, 0.35, 0.27), (0.82, 0.50, 0.38))
    return colors[body % len(colors)] if layout.bodies.course[body] >= 0 else (0.6, 0.6, 0.6)
