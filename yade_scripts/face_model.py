"""Joints by face: rigid clumps, a bond for each contact point, and once it broke a point on a face.

A bond joins two massless members that lie symmetrically on either side of the contact point, on the joint's normal.
Its law is YADE's JCFpm (Scholtès & Donzé 2012, doi:10.1016/j.ijrmms.2012.03.011) without smooth joints, with the
stiffness, strength and area of the joint.  While it holds, what slides is the joint's elasticity, micrometres on the
75 mm between the members: so far the line between them is the face's normal.

When a bond breaks, a tip and a face take its place: a sphere of 0.5 mm that touches the contact point from inside one
brick, and the box of the other, by YADE's law of friction (Law2_ScGeom_FrictPhys_CundallStrack), whose forces act on
both bricks in one and the same point.  The normal is the face's own, turns with its brick, and stays when the joint
slides; the tip goes round a corner where it leaves the face.  Neighbouring contact points take turns in which brick
has the face.
"""

from collections import Counter

import numpy as np
import yade
from yade import O, Vector3, utils

from damage.wall.joint_law import friction_left, material_of
from damage.wall.layout import GROUND, HEAD
from yade_scripts.model import YadeWall, brick_color, joint_law, set_bond, set_clump
from yade_scripts.shapes import HAS_POLYHEDRA, brick_shape

TIP = 5e-4  # [m], radius: a tip that is pressed in deeper than this, by 33 MPa, would not know its face
_POINT = 1e-3  # [m], radius of bond members, which plays no part
_CORNER = 5e-3  # [m], radius of the spheres in the corners, by which loose bricks meet
_INSET = 1e-3  # [m], their distance from the faces: bricks that are held by joints do not touch by them
_MARGIN = 1e-2  # [m], a contact point closer to the end of a face than this has its tip on that brick
_REACH = 3e-2  # [m], how far a face goes on where the contact point lies at the ends of both
_COLLISION = 2e8  # [N/m], normal stiffness of loose bricks' contacts
_COLLISION_SHEAR = 0.4  # [-], shear stiffness over the normal
_GROUND = 10.0  # [m], how far the ground reaches beyond the wall
_SEEN, _FACE = 1, 2  # bits of masks: what the collider sees; faces do not meet faces


class FaceWall(YadeWall):
    """A YadeWall that knows the tip and the face of each contact point that may break."""

    def __init__(self, layout, parts, bonds, newton, law):
        signs = np.array([1.0 if bond.id2 == second else -1.0
                          for bond, (_, second) in zip(bonds, parts.ends)])
        super().__init__(layout, parts.clumps, parts.members, bonds, signs, parts.ground, newton, law)
        self.tips, self.corners = parts.tips, parts.corners
        self.friction = friction_left(True, material_of(layout.wall.joint))

    def loosen(self, joint):
        """A tip on a face, with the shear force that the broken bond had left."""
        bond, (tip, face, body, tip_is_second) = self.bonds[joint], self.tips[joint]
        sign = 1.0 if tip_is_second else -1.0
        shear = self.signs[joint] * sign * bond.phys.shearForce
        stiffness = bond.phys.kn, bond.phys.ks
        O.interactions.erase(bond.id1, bond.id2)
        contact = utils.createInteraction(face, tip)
        contact.phys.kn, contact.phys.ks = stiffness
        contact.phys.tangensOfFrictionAngle = self.friction
        contact.phys.shearForce = shear
        self.bonds[joint], self.signs[joint], self.bonded[joint] = contact, sign, False
        self.members[body].append(tip)


def build_faces(layout):
    """Build the model in YADE's empty scene; returns a FaceWall."""
    ig2 = yade.Ig2_Sphere_Sphere_ScGeom(avoidGranularRatcheting=False)
    bonding = yade.Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)
    law = joint_law()
    friction = yade.Law2_ScGeom_FrictPhys_CundallStrack(neverErase=True, sphericalBodies=False)
    newton = yade.NewtonIntegrator(damping=0.0, gravity=(0, 0, 0), label="newton")
    collider = yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Box_Aabb()], verletDist=1e-4,
                                          avoidSelfInteractionMask=_FACE)
    loop = yade.InteractionLoop([ig2, yade.Ig2_Box_Sphere_ScGeom()], [bonding, yade.Ip2_FrictMat_FrictMat_FrictPhys()],
                                [law, friction])
    O.engines = [yade.ForceResetter(), collider, loop, newton]
    parts = _Parts(layout)
    bonds = [utils.createInteraction(*ends) for ends in parts.ends]
    for index, bond in enumerate(bonds):
        set_bond(bond.phys, layout, index)
    bonding.cohesiveTresholdIteration = 0
    return FaceWall(layout, parts, bonds, newton, law)


class _Parts:
    """Adds the bodies to YADE's scene.

    clumps, members, ground: as in YadeWall; ends: ids of the members that each bond joins (n_contacts, 2);
    tips: (tip's id, face's id, body of the tip, whether that is the layout's second) of each contact point, None
    where it stays elastic; corners: [ids of the spheres in the corners] of each body.
    """

    def __init__(self, layout):
        self.layout, contacts = layout, layout.contacts
        n = len(contacts)
        self._add_materials()
        self.ends, self.tips = [[None, None] for _ in range(n)], [None] * n
        self.clumps, self.members, self.corners = [], [], []
        self._wanted = [([], []) for _ in range(len(layout.bodies) + 1)]  # of a body, the ground last: points, tips
        self._plan_bonds()
        self._plan_tips()
        self.faces = {}
        for body in range(len(layout.bodies)):
            self._add_brick(body)
        self._add_ground()
        for index in range(n):
            if self.tips[index]:
                tip, (body, kind), owner, second = self.tips[index]
                self.tips[index] = tip, self.faces[body, kind], owner, second

    def _add_materials(self):
        brick, joint = self.layout.wall.brick, self.layout.wall.joint
        # YADE gives such a contact of radius R and modulus E the stiffness E R.
        common = {"young": _COLLISION / _CORNER, "poisson": _COLLISION_SHEAR, "frictionAngle": joint.friction_angle}
        self._solid = O.materials[O.materials.append(yade.FrictMat(density=brick.density, label="brick", **common))]
        self._tip = O.materials[O.materials.append(yade.FrictMat(density=0.0, label="tip", **common))]
        self._point = O.materials[O.materials.append(yade.JCFpmMat(
            density=0.0, young=1e9, poisson=0.3, frictionAngle=joint.friction_angle, label="bond"))]

    def _plan_bonds(self):
        """Two points on the joint's normal, as far before it as behind; bonds share points where they fall together."""
        contacts, cells = self.layout.contacts, self.layout.cells
        width = cells.right - cells.left
        known, alike = {}, Counter()
        for index in range(len(contacts)):
            x, z = contacts.x[index], contacts.z[index]
            # At corners two overlaps may end in one place; YADE keeps one bond between two members.
            twin = contacts.first[index], contacts.second[index], round(x, 7), round(z, 7)
            alike[twin] += 1
            if contacts.kind[index] == HEAD:
                dx, dz = min(width[contacts.first_cell[index]], width[contacts.second_cell[index]]) / 2, 0.0
            else:
                dx, dz = 0.0, self.layout.wall.brick.height / 2
            for side, body in enumerate((contacts.first[index], contacts.second[index])):
                sign = 2 * side - 1
                place = (x + sign * dx, z + sign * dz)
                key = body, round(place[0], 7), round(place[1], 7), alike[twin]
                if key not in known:
                    known[key] = len(self._wanted[body][0])
                    self._wanted[body][0].append((place, []))
                self._wanted[body][0][known[key]][1].append((index, side))

    def _plan_tips(self):
        contacts = self.layout.contacts
        for index in range(self.layout.n_joints):
            if np.isinf(contacts.tensile_strength[index]) and np.isinf(contacts.cohesion[index]):
                continue
            first, second = int(contacts.first[index]), int(contacts.second[index])
            margins = self._margin(first, index), self._margin(second, index)
            by_turns = index % 2 == 0 if abs(margins[0] - margins[1]) < 1e-6 or min(margins) > _MARGIN else None
            face_is_first = margins[0] > margins[1] if by_turns is None else by_turns or first == GROUND
            face, owner = (first, second) if face_is_first else (second, first)
            kind = "box" if max(margins) > _MARGIN else ("head" if contacts.kind[index] == HEAD else "bed")
            inwards = TIP if face_is_first else -TIP
            x, z = contacts.x[index], contacts.z[index]
            place = (x + inwards, z) if contacts.kind[index] == HEAD else (x, z + inwards)
            self._wanted[owner][1].append((place, index))
            self.tips[index] = None, (face, kind), owner, face_is_first

    def _margin(self, body, index):
        """Distance of a contact point from the nearer end of the body's face [m]."""
        contacts, bodies = self.layout.contacts, self.layout.bodies
        if body == GROUND:
            return _GROUND
        if contacts.kind[index] == HEAD:
            return bodies.height[body] / 2 - abs(contacts.z[index] - bodies.z[body])
        return bodies.length[body] / 2 - abs(contacts.x[index] - bodies.x[body])

    def _ball(self, place, radius, material):
        ball = utils.sphere((place[0], 0, place[1]), radius, material=material, color=(0.3, 0.3, 0.3))
        ball.bounded = False
        return ball

    def _points(self, body):
        """Bodies of bond points and tips that the body shall have, and what of it each is."""
        points, tips = self._wanted[body]
        return ([self._ball(place, _POINT, self._point) for place, _ in points],
                [self._ball(place, TIP, self._tip) for place, _ in tips])

    def _box(self, centre, extents, color=(0.5, 0.5, 0.5), seen=True):
        box = utils.box(centre, extents, material=self._solid if seen else self._tip, color=color, wire=not seen)
        box.bounded = seen
        box.mask = _SEEN | _FACE
        return box

    def _add_brick(self, body):
        bodies, thickness = self.layout.bodies, self.layout.wall.brick.thickness
        x, z = float(bodies.x[body]), float(bodies.z[body])
        half = float(bodies.length[body]) / 2, thickness / 2, float(bodies.height[body]) / 2
        points, tips = self._points(body)
        box = self._box((x, 0, z), half, brick_color(self.layout, body))
        inset = _INSET + _CORNER
        corners = [self._ball((x + right * (half[0] - inset), z + up * (half[2] - inset)), _CORNER, self._tip)
                   for right in (-1, 1) for up in (-1, 1)]
        for corner in corners:
            corner.bounded = True
        kinds = ["box", *sorted({kind for _, (owner, kind), *_ in filter(None, self.tips)
                                 if owner == body and kind != "box"})]
        wide = [self._box((x, 0, z), (half[0] + _REACH * (kind == "bed"), half[1], half[2] + _REACH * (kind == "head")),
                          seen=False) for kind in kinds[1:]]
        looks = [brick_shape((x, 0, z), half, self._tip, brick_color(self.layout, body))] if HAS_POLYHEDRA else []
        if looks:
            box.shape.wire = True
        clump, ids = O.bodies.appendClumped([box, *wide, *points, *tips, *corners, *looks])
        n_faces, n_points = len(kinds), len(points)
        self.faces.update({(body, kind): ids[k] for k, kind in enumerate(kinds)})
        self._note(body, ids[n_faces:n_faces + n_points], ids[n_faces + n_points:])
        self.clumps.append(clump)
        self.members.append(list(ids[:n_faces + n_points]))
        first = n_faces + n_points + len(tips)
        self.corners.append(list(ids[first:first + len(corners)]))
        set_clump(O.bodies[clump].state, self.layout.bodies.mass[body], self.layout.bodies.inertia[body])

    def _note(self, body, points, tips):
        """Give the ids of a body's points and tips to the contact points that they belong to."""
        wanted_points, wanted_tips = self._wanted[body]
        for identity, (_, users) in zip(points, wanted_points):
            for index, side in users:
                self.ends[index][side] = identity
        for identity, (_, index) in zip(tips, wanted_tips):
            self.tips[index] = (identity, *self.tips[index][1:])

    def _add_ground(self):
        wall, height = self.layout.wall, self.layout.wall.brick.height
        points, _ = self._points(GROUND)
        box = self._box((wall.length / 2, 0, -height / 2),
                        (wall.length / 2 + _GROUND, wall.brick.thickness / 2, height / 2), (0.4, 0.4, 0.4))
        self.ground = []
        for fixed in [box, *points]:
            fixed.state.blockedDOFs = "xyzXYZ"
            self.ground.append(O.bodies.append(fixed))
        self.faces[GROUND, "box"] = self.ground[0]
        self._note(GROUND, self.ground[1:], [])
