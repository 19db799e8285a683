"""Bodies of a wall in YADE's scene: bricks as clumps of boxes, members of bonds, the tips and faces
of contact points that have failed, corners, and supports.

Bodies are built in the wall's plane, those of a house (`HouseParts`) in that of its walls
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
from yade_scripts.scene import SceneReader
from yade_scripts.space import SpaceReader

TIP = 5e-4  # [m], radius: beyond this depth, at 33 MPa, a tip would be assigned to another face
_POINT = 1e-3  # [m], radius of bond members, without effect
CORNER = 1e-3  # [m], radius of the spheres in the corners, the contacts of loose bricks
INSET = 5e-4  # [m], of corners from the faces, so that they do not touch while joints hold
# [m], a contact point closer to the end of a face than this has its tip on that brick
_MARGIN = 1e-2
REACH = 3e-2  # [m], extension of a face where the contact point lies at the ends of both faces
_COLLISION = 2e8  # [N/m], normal stiffness of loose bricks' contacts
_COLLISION_SHEAR = 0.4  # [-], shear stiffness over the normal
_GROUND = 10.0  # [m], extension of the ground beyond the wall
# bits of masks: seen by the collider; faces do not collide with faces
SEEN = 1
FACE = 2


def parts_of(layout):
    """The Parts of a Layout, or the HouseParts of a HouseLayout."""
    return (HouseParts if layout.IN_SPACE else Parts)(layout)


class Parts:
    """Bodies of a plane wall in YADE's scene, added by the constructor.

    clumps, members, ground: as in YadeWall; ends: ids of the members that each bond joins
    (n_contacts, 2); tips: {contact point: Tip} of those that may fail; faces: {(body, kind): id}
    of the boxes; tip: material; waiting, corners: of a house, as in YadeWall; reader: class of what
    reads them.
    """

    AXES = 0, 2  # along which a contact point may be near the end of a face
    ACROSS = 0  # [m], extension of bed and head faces across the wall
    IN_A_ROW = 1  # contact points through the thickness
    reader = SceneReader

    def __init__(self, layout):
        self.layout = layout
        self.waiting = {}
        self.corners = []
        self._places, self._normals, self._reach = layout.places
        self._add_materials()
        self.ends = [[None, None] for _ in range(len(layout.contacts))]
        self.tips = self._tips()
        self.clumps = []
        self.members = []
        self.ground = []
        self.faces = {}
        self._points = self._plan_points()
        for body in range(len(layout.bodies)):
            self._add_brick(body)
        for support in range(len(layout.supports)):
            self._add_support(support)

    def _add_materials(self):
        brick = self.layout.wall.brick
        joint = self.layout.wall.joint
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
            O.materials[O.materials.append(material)] for material in materials
        )

    def _plan_points(self):
        """Bond members of each body, the supports last: {(x, y, z, number): [(contact, side),
        ...]}.

        A bond has two members on the normal of the joint, at equal distances from it; bonds share
        coincident members.
        """
        contacts = self.layout.contacts
        n_bodies = len(self.layout.bodies)
        wanted = [{} for _ in range(n_bodies + len(self.layout.supports))]
        alike = Counter()
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
        centre, size = self.layout.box(body)
        half = size / 2
        color = _brick_color(self.layout, body)
        kinds = [
            "box",
            *sorted({tip.face[1] for tip in self.tips.values() if tip.face[0] == body} - {"box"}),
        ]
        reach = {
            "box": (0, 0, 0),
            "bed": (REACH, self.ACROSS, 0),
            "head": (0, self.ACROSS, REACH),
            "side": (REACH, 0, REACH),
        }
        boxes = [
            self._box(centre, np.add(half, reach[kind]), color, seen=kind == "box")
            for kind in kinds
        ]
        points = self._add_points(body)
        later = self._later(body, boxes[0])
        clump, ids = O.bodies.appendClumped([*boxes, *points, *later])
        self.faces.update({(body, kind): identity for kind, identity in zip(kinds, ids)})
        self._note(body, ids[len(boxes) :])
        self.clumps.append(clump)
        self.members.append(list(ids[: len(boxes) + len(points)]))
        self._free(body, O.bodies[clump], ids[len(boxes) + len(points) :])

    def _later(self, body, box):
        """Parts of a body that come into use later."""
        return []

    def _free(self, body, clump, later):
        """Give a clump its mass and its freedoms; later: ids of the parts of `_later`."""
        bodies = self.layout.bodies
        _set_clump(
            clump.state, bodies.mass[body], bodies.inertia[body], self.layout.restrained[body]
        )

    def place(self, newton):
        """Move the bodies from where they were built to their places, those of a plane wall."""

    def _add_support(self, support):
        """Add a support: a box of the height of a brick."""
        low, high = (np.array(end) for end in self._support_in_plan(support))
        height = self.layout.wall.brick.height
        row = len(self.layout.bodies) + support
        centre = (low + high) / 2
        half = (high - low) / 2
        box = self._box((*centre, -height / 2), (*half, height / 2), (0.4, 0.4, 0.4))
        parts = [box, *self._add_points(row)]
        for part in parts:
            part.state.blockedDOFs = "xyzXYZ"
        ids = [O.bodies.append(part) for part in parts]
        self.ground.append(ids)
        self.faces[GROUND - support, "box"] = ids[0]
        self._note(row, ids[1:])

    def _support_in_plan(self, support):
        """Opposite corners (x, y) of a support [m]: up to halfway to its neighbours, or beyond the
        wall."""
        all_of = self.layout.supports
        across = self.layout.wall.brick.thickness / 2
        edges = [
            all_of.left[0] - _GROUND,
            *((all_of.right[:-1] + all_of.left[1:]) / 2),
            all_of.right[-1] + _GROUND,
        ]
        return (edges[support], -across), (edges[support + 1], across)

    def _tips(self):
        """{contact point: Tip} of all that may fail."""
        layout = self.layout
        contacts = layout.contacts
        places = self._places
        normals = self._normals
        tips = {}
        for index in range(layout.n_joints):
            if np.isinf(contacts.tensile_strength[index]) and np.isinf(contacts.cohesion[index]):
                continue
            bodies = int(contacts.first[index]), int(contacts.second[index])
            margins = [
                self._margin(body, place[index], normal[index])
                for body, place, normal in zip(bodies, places, normals)
            ]
            if min(margins) > _MARGIN or abs(margins[0] - margins[1]) < 1e-6:
                # those through the thickness together
                side = index // self.IN_A_ROW % 2 if bodies[0] >= 0 else 1
            else:
                side = int(margins[0] > margins[1])  # the tip is on the side whose face ends nearer
            kind = ("head", "side", "bed")[np.abs(normals[1 - side][index]).argmax()]
            if max(margins) > _MARGIN or bodies[1 - side] < 0:
                kind = "box"
            inwards = 1.0 if side else -1.0
            tips[index] = Tip(
                tuple(places[side][index].tolist()),
                tuple((inwards * normals[side][index]).tolist()),
                bodies[side],
                bool(side),
                (bodies[1 - side], kind),
            )
        return tips

    def _margin(self, body, place, normal):
        """Distance of a contact point from the nearest end of a body's face, (x, y, z) in its wall
        [m]."""
        if body < 0:
            return _GROUND
        centre, size = self.layout.box(body)
        half = size / 2
        return min(half[k] - abs(place[k] - centre[k]) for k in self.AXES if abs(normal[k]) < 0.5)


class HouseParts(Parts):
    """Bodies of a house, which move in space."""

    AXES = 0, 1, 2
    ACROSS = REACH
    IN_A_ROW = 3
    reader = SpaceReader

    def _later(self, body, box):
        # distinct, so that YADE takes the axes of the box for those of the clump
        mass = self.layout.bodies.mass[body]
        box.state.mass = mass
        box.state.inertia = mass * Vector3(1, 2, 3)
        tips = [self._waiting_tip(tip) for tip in self._tips_of(body).values()]
        inset = CORNER + INSET
        corners = corner_places(self.layout, body, inset, across=(-1, 1))
        return tips + [ball(place, CORNER, self.tip) for place in corners]

    def _tips_of(self, body):
        return {joint: tip for joint, tip in self.tips.items() if tip.body == body}

    def _free(self, body, clump, later):
        tips = self._tips_of(body)
        bodies = self.layout.bodies
        self.waiting.update(zip(tips, later))
        self.corners.append(later[len(tips) :])
        along, up = bodies.across_inertia[body]
        _set_free(clump, bodies.mass[body], (along, bodies.inertia[body], up))

    def _waiting_tip(self, tip):
        """The tip of a contact point that has not failed yet."""
        place = [x + TIP * by for x, by in zip(tip.place, tip.inwards)]
        return ball(place, TIP, self.tip)

    def place(self, newton):
        """Move the bodies from where they were built to their places."""
        layout = self.layout
        for clump, centre, number in zip(self.clumps, layout.centres, layout.bodies.wall):
            state = O.bodies[clump].state
            turn = Quaternion((0, 0, 1), np.radians(layout.house.walls[number].direction))
            state.pos = Vector3(*centre)
            state.ori = turn * state.ori
            state.refPos = state.pos
            state.refOri = state.ori
        newton()  # members follow

    def _support_in_plan(self, support):
        """Opposite corners (x, y) of a support [m]: around the contact points on it, or beyond all
        walls."""
        layout = self.layout
        places = layout.contacts.place[:, :2]
        beyond = _GROUND
        if len(layout.supports) > 1:  # below one brick, or where a corner took it away
            own_places = places[layout.contacts.first == GROUND - support]
            places, beyond = (own_places, REACH) if len(own_places) else (places[:1], 0.0)
        beyond += TIP
        return places.min(axis=0) - beyond, places.max(axis=0) + beyond


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


def corner_places(layout, body, inset, across=(0,)):
    """Places of the spheres in the corners of a body (x, y, z) [m], at these shares of half the
    thickness."""
    (x, y, z), size = layout.box(body)
    half = size / 2 - inset
    return [
        (x + right * half[0], y + through * half[1], z + up * half[2])
        for right in (-1, 1)
        for up in (-1, 1)
        for through in across
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


def _set_clump(state, mass, inertia, restrained):
    """Set mass and inertia of a clump, and restrict it to motion in the plane, and where restraints
    hold it.

    All three inertias are I_yy, since YADE permutes the axes of a clump.
    """
    state.mass = mass
    state.inertia = Vector3(inertia, inertia, inertia)
    state.blockedDOFs = "yXZ" + "".join(name for name, fixed in zip("xzY", restrained) if fixed)
    state.refPos = state.pos
    state.refOri = state.ori


def _set_free(body, mass, inertia):
    """Set the mass of a clump that moves in space, and its inertia about the axes along, across and
    upwards (3,): YADE has chosen the order of the clump's own."""
    turn = body.state.ori.toRotationMatrix()
    order = [max(range(3), key=lambda row: abs(turn[row, axis])) for axis in range(3)]
    body.state.mass = mass
    body.state.inertia = Vector3(*(float(inertia[row]) for row in order))
    body.aspherical = True


def _brick_color(layout, body):
    """Colour (red, green, blue) [-]: bricks alternate, so that neighbours differ; top masses are
    grey."""
    colors = ((0.75, 0.42, 0.32), (0.66, 0.35, 0.27), (0.82, 0.50, 0.38))
    return colors[body % len(colors)] if layout.bodies.course[body] >= 0 else (0.6, 0.6, 0.6)
