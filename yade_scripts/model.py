"""A wall in YADE: rigid clumps, a bond for each contact point, and once it broke a point on a face.

A bond joins two massless members that lie symmetrically on either side of the contact point, on the joint's normal.
Its law is YADE's JCFpm (Scholtès & Donzé 2012, doi:10.1016/j.ijrmms.2012.03.011) without smooth joints, with the
stiffness, strength and area of the joint.  While it holds, what slides is the joint's elasticity, micrometres on the
75 mm between the members: so far the line between them is the face's normal.

When a bond breaks, a tip and a face take its place: a sphere of 0.5 mm that touches the contact point from inside one
brick, and the box of the other, by YADE's law of friction (Law2_ScGeom_FrictPhys_CundallStrack), whose forces act on
both bricks in one and the same point.  The normal is the face's own, turns with its brick, and stays when the joint
slides; the tip goes round a corner where it leaves the face.  Neighbouring contact points take turns in which brick
has the face.  Of a bond that softens, some fibres hold and some are dry (`bundles`); what crushes moves a bond's rest
position, or makes a tip smaller (`crushing`).
"""

from collections import Counter
from dataclasses import dataclass
from itertools import starmap

import numpy as np
import yade
from yade import O, Vector3, utils

from damage.wall.joint_law import friction_left, material_of
from damage.wall.kinds import GROUND
from damage.wall.supports import rows
from yade_scripts.friction_work import FrictionWork
from yade_scripts.shapes import HAS_POLYHEDRA, brick_shape

UNBREAKABLE = 1e300  # [N], strength of joints that stay elastic
TIP = 5e-4  # [m], radius: a tip that is pressed in deeper than this, by 33 MPa, would not know its face
_DEEP = 1.5  # [-], radius over the depth at which its joint crushes below which a tip is exchanged for another
_POINT = 1e-3  # [m], radius of bond members, which plays no part
_CORNER = 1e-3  # [m], radius of the spheres in the corners, by which loose bricks meet
_INSET = 5e-4  # [m], their distance from the faces: bricks that are held by joints do not touch by them
_CRUSHED_INSET = 5e-3  # [m], the same where joints can crush: two bricks may come so much closer
_NEAR = 5e-5  # [m], opening from which on a tip needs no look until the next time: at 0.3 m/s
_MARGIN = 1e-2  # [m], a contact point closer to the end of a face than this has its tip on that brick
_REACH = 3e-2  # [m], how far a face goes on where the contact point lies at the ends of both
_COLLISION = 2e8  # [N/m], normal stiffness of loose bricks' contacts
_COLLISION_SHEAR = 0.4  # [-], shear stiffness over the normal
_GROUND = 10.0  # [m], how far the ground reaches beyond the wall
_SEEN, _FACE = 1, 2  # bits of masks: what the collider sees; faces do not meet faces


class YadeWall:
    """A wall at rest, unloaded and bonded; all in the order of the layout.

    clumps: body ids (n_bodies,); members: [ids of the members that feel contacts] of each clump; bonds: YADE
    interactions (n_contacts,); signs: +1 where YADE's second body is the layout's second (n_contacts,);
    ground: [ids of the bodies] of each support, whose motion is prescribed; bonded: whether the interaction is still
    the first one (n_contacts,); frayed: {joint: dry contact beside a bond that holds in part}; closure: by how much
    contact points are crushed (n_joints,) [m]; turning: states that show how the bodies have turned; tips: a _Tip for
    each contact point that may break; faces: {(body, kind): id} of the boxes.
    """

    def __init__(self, layout, parts, bonds, newton, law, work):
        self.layout, self.bonds, self.newton, self.law = layout, bonds, newton, law
        self.clumps, self.members, self.ground = parts.clumps, parts.members, parts.ground
        self.signs = np.array([1.0 if bond.id2 == second else -1.0
                               for bond, (_, second) in zip(bonds, parts.ends)])
        self.bonded, self.frayed = np.ones(len(bonds), dtype=bool), {}
        self.tips, self.faces = parts.tips, parts.faces
        self.turning = [O.bodies[parts.faces[body, "box"]].state for body in range(len(layout.bodies))]
        self.friction = friction_left(True, material_of(layout.wall.joint))
        self._material, self._work = parts.tip, work
        contacts, n = layout.contacts, layout.n_joints
        # Depth at which contact points crush, none where they do not [m]; {joint: its tip's id}.
        self._depth = np.where(np.isinf(contacts.compressive_strength), 0.0,
                               contacts.compressive_strength / contacts.normal_stiffness)[:n]
        self.closure, self._tip_of = np.zeros(n), {}
        self.corners = set()  # ids of the spheres in the bricks' corners

    def loosen(self, joint):
        """A tip on a face, with the shear force that the broken bond had left."""
        bond, tip = self.bonds[joint], self.tips[joint]
        sign = 1.0 if tip.is_second else -1.0
        shear = self.signs[joint] * sign * bond.phys.shearForce
        stiffness = bond.phys.kn, bond.phys.ks
        O.interactions.erase(bond.id1, bond.id2)
        contact = self._touch(joint, *stiffness)
        contact.phys.shearForce = shear
        self.bonds[joint], self.signs[joint], self.bonded[joint] = contact, sign, False
        self._work.add(contact, self.friction * contact.phys.kn * max(contact.geom.penetrationDepth, 0.0))

    def friction_work(self):
        """What friction has taken [J]."""
        return self._work.total

    def follow(self, anew):
        """After every step; anew: choose anew which joints may close or slide until the next time."""
        if anew:
            self._work.choose(_NEAR)
        self._work.step()

    def fray(self, joint):
        """A tip on a face beside a bond that holds, without stiffness so far: the contact of the fibres that break."""
        self.frayed[joint] = self._touch(joint, 0.0, 0.0)

    def rub(self, joint):
        """What rubs beside a bond that holds has another stiffness and shear force from now on."""
        self._work.renew(self.frayed[joint])

    def part(self, joint):
        """The last fibre of a bond has gone: the contact of the broken ones takes its place."""
        bond = self.bonds[joint]
        O.interactions.erase(bond.id1, bond.id2)
        self.bonds[joint], self.bonded[joint] = self.frayed.pop(joint), False
        self.signs[joint] = 1.0 if self.tips[joint].is_second else -1.0

    def crush(self, joint, more):
        """Move the rest position of a contact point by a closure [m]; whether what rubs there is another interaction
        now."""
        self.closure[joint] += more
        _ease(self.bonds[joint], more)
        if self.bonded[joint]:
            self.bonds[joint].phys.initD += more
            if joint not in self.frayed:
                return False
            _ease(self.frayed[joint], more)
        shape = O.bodies[self._tip_of[joint]].shape
        if shape.radius - more > _DEEP * self._depth[joint]:
            shape.radius -= more
            return False
        self._exchange(joint)
        return True

    def end(self, joint, stored):
        """Take the contact of a joint whose faces no longer overlap away, with the elastic energy [J] that it has."""
        contact = self.bonds[joint]
        self._work.end(contact, stored)
        if contact.isReal:
            O.interactions.erase(contact.id1, contact.id2)

    def _exchange(self, joint):
        """Another tip in the place of one that crushing has made too small, farther inside its brick."""
        place = self.frayed if joint in self.frayed else self.bonds
        old = place[joint]
        stiffness, shear = (old.phys.kn, old.phys.ks), Vector3(old.phys.shearForce)
        self._work.forget(old)
        gone = self._tip_of[joint]
        force, torque, there = O.forces.f(gone, True), O.forces.t(gone, True), Vector3(O.bodies[gone].state.pos)
        self.members[self.tips[joint].body].remove(gone)
        O.bodies.erase(gone)  # left where it is it would meet the face again
        place[joint] = contact = self._touch(joint, *stiffness)
        point = self._tip_of[joint]
        O.forces.addF(point, force)
        O.forces.addT(point, torque + (there - O.bodies[point].state.pos).cross(force))
        contact.phys.shearForce = shear
        self._work.renew(contact)

    def _touch(self, joint, normal_stiffness, shear_stiffness):
        """The dry contact of a tip, which it makes where the joint's closure has left it, and its face."""
        tip, radius = self.tips[joint], max(TIP, 2 * _DEEP * self._depth[joint])
        inwards = radius + self.closure[joint]
        place = tip.x + inwards * tip.inwards[0], tip.z + inwards * tip.inwards[1]
        point, = self._attach(tip.body, [_ball(place, radius, self._material)])
        self._tip_of[joint] = point
        contact = utils.createInteraction(self.faces[tip.face], point)
        contact.phys.kn, contact.phys.ks = normal_stiffness, shear_stiffness
        contact.phys.tangensOfFrictionAngle = self.friction
        return contact

    def arm(self):
        """From now on any two bricks that meet collide, and any brick with the ground: by spheres in the corners of all
        bricks and caps, which meet faces and each other."""
        if self.corners:
            return
        bodies, inset = self.layout.bodies, _CORNER + (_CRUSHED_INSET if self._depth.any() else _INSET)
        for body in range(len(bodies)):
            half = bodies.length[body] / 2 - inset, bodies.height[body] / 2 - inset
            balls = [_ball((bodies.x[body] + right * half[0], bodies.z[body] + up * half[1]), _CORNER, self._material)
                     for right in (-1, 1) for up in (-1, 1)]
            for ball in balls:
                ball.bounded, ball.mask = True, _SEEN
            self.corners.update(self._attach(body, balls))

    def tidy(self):
        """Forget what need not be looked at any more: collisions that are over, joints out of reach."""
        for contact in self.collisions():
            if contact.geom.penetrationDepth < 0:
                O.interactions.erase(contact.id1, contact.id2)
        for joint in np.flatnonzero(~self.bonded):
            contact = self.bonds[joint]
            # A face that goes on beyond its brick must not be met by one that comes back another way.
            if self.tips[joint].face[1] != "box" and contact.isReal and contact.geom.penetrationDepth < -_REACH / 10:
                O.interactions.erase(contact.id1, contact.id2)

    def collisions(self):
        """Contacts of loose bricks, in the making or over, too: YADE's interactions."""
        if not self.corners:
            return []
        return [i for i in O.interactions if i.isReal and (i.id1 in self.corners or i.id2 in self.corners)]

    def _attach(self, body, parts):
        """Make parts, at their places in the wall as it was built, members of a brick wherever it is; their ids."""
        bodies, brick = self.layout.bodies, self.turning[body]
        start = Vector3(bodies.x[body], 0, bodies.z[body])
        for part in parts:
            part.state.pos = brick.pos + brick.ori * (part.state.pos - start)
            part.state.ori = brick.ori
        ids = [O.bodies.append(part) for part in parts]
        state = O.bodies[self.clumps[body]].state
        velocities = Vector3(state.vel), Vector3(state.angVel)
        O.bodies.addToClump(ids, self.clumps[body])
        # YADE has stopped the clump and reckoned mass and axes anew; axes play no part where all inertias are one.
        state.vel, state.angVel = velocities
        state.mass, state.inertia = bodies.mass[body], Vector3(1, 1, 1) * bodies.inertia[body]
        self.members[body] += ids
        return ids


@dataclass(frozen=True)
class _Tip:
    """Place x, z [m] of a contact point as the wall was built; inwards: unit vector from there into the body that has
    the tip, whether that is the layout's second; face: (body, kind) of the other side."""

    x: float
    z: float
    inwards: tuple
    body: int
    is_second: bool
    face: tuple


def _ball(place, radius, material):
    ball = utils.sphere((place[0], 0, place[1]), radius, material=material, color=(0.3, 0.3, 0.3))
    ball.bounded = False
    return ball


def _ease(contact, closure):
    """Take off both bodies what a contact that has closed for good [m] does not bear, before anything moves."""
    geom, force = contact.geom, contact.phys.kn * closure * contact.geom.normal
    contact.phys.normalForce -= force
    for body, on_it in ((contact.id1, force), (contact.id2, -force)):
        O.forces.addF(body, on_it)
        O.forces.addT(body, (geom.contactPoint - O.bodies[body].state.pos).cross(on_it))


def build(layout, dt):
    """Build the model in YADE's scene, emptied before, with this time step [s]; returns a YadeWall."""
    O.reset()
    O.dt = dt
    ig2 = yade.Ig2_Sphere_Sphere_ScGeom(avoidGranularRatcheting=False)
    bonding = yade.Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)
    law = yade.Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM(neverErase=True, smoothJoint=False,
                                                                 label="jointLaw")
    friction = yade.Law2_ScGeom_FrictPhys_CundallStrack(neverErase=True, sphericalBodies=False,
                                                        traceEnergy=True)
    newton = yade.NewtonIntegrator(damping=0.0, gravity=(0, 0, 0), label="newton")
    collider = yade.InsertionSortCollider([yade.Bo1_Sphere_Aabb(), yade.Bo1_Box_Aabb()], verletDist=1e-4,
                                          avoidSelfInteractionMask=_FACE)
    loop = yade.InteractionLoop([ig2, yade.Ig2_Box_Sphere_ScGeom()], [bonding, yade.Ip2_FrictMat_FrictMat_FrictPhys()],
                                [law, friction])
    O.engines = [yade.ForceResetter(), collider, loop, newton]
    parts = _Parts(layout)
    bonds = list(starmap(utils.createInteraction, parts.ends))
    for index, bond in enumerate(bonds):
        _set_bond(bond.phys, layout, index)
    bonding.cohesiveTresholdIteration = 0
    return YadeWall(layout, parts, bonds, newton, law, FrictionWork(friction))


def _set_bond(phys, layout, index):
    """Give a JCFpm bond the area, stiffness and strength of its contact point."""
    contacts = layout.contacts
    area = float(contacts.area[index])
    phys.isCohesive = True
    phys.crossSection = area
    phys.kn = float(contacts.normal_stiffness[index]) * area
    phys.ks = float(contacts.shear_stiffness[index]) * area
    phys.FnMax = min(UNBREAKABLE, float(contacts.tensile_strength[index]) * area)
    phys.FsMax = min(UNBREAKABLE, float(contacts.cohesion[index]) * area)
    phys.tanFrictionAngle = friction_left(False, material_of(layout.wall.joint))


def _set_clump(state, mass, inertia):
    """In-plane motion; YADE sorts a clump's inertia with permuted axes, so all three are I_yy."""
    state.mass = mass
    state.inertia = Vector3(inertia, inertia, inertia)
    state.blockedDOFs = "yXZ"
    state.refPos = state.pos
    state.refOri = state.ori


def _brick_color(layout, body):
    """Red, green, blue [-]: bricks in turns, so that they tell apart; caps grey."""
    colors = ((0.75, 0.42, 0.32), (0.66, 0.35, 0.27), (0.82, 0.50, 0.38))
    return colors[body % len(colors)] if layout.bodies.course[body] >= 0 else (0.6, 0.6, 0.6)


class _Parts:
    """Adds the bodies to YADE's scene.

    clumps, members, ground: as in YadeWall; ends: ids of the members that each bond joins (n_contacts, 2);
    tips: a _Tip for each contact point that may break; faces: {(body, kind): id} of the boxes; tip: material.
    """

    def __init__(self, layout):
        self.layout = layout
        self._add_materials()
        self.ends = [[None, None] for _ in range(len(layout.contacts))]
        self.tips = _tips(layout)
        self.clumps, self.members, self.ground, self.faces = [], [], [], {}
        self._points = self._plan_points()
        for body in range(len(layout.bodies)):
            self._add_brick(body)
        for support in range(len(layout.supports)):
            self._add_support(support)

    def _add_materials(self):
        brick, joint = self.layout.wall.brick, self.layout.wall.joint
        # YADE gives such a contact of radius R and modulus E the stiffness E R.
        common = {"young": _COLLISION / _CORNER, "poisson": _COLLISION_SHEAR, "frictionAngle": joint.friction_angle}
        materials = (yade.FrictMat(density=brick.density, label="brick", **common),
                     yade.FrictMat(density=0.0, label="tip", **common),
                     yade.JCFpmMat(density=0.0, young=1e9, poisson=0.3, frictionAngle=joint.friction_angle,
                                   label="bond"))
        self._solid, self.tip, self._bond = (O.materials[O.materials.append(one)] for one in materials)

    def _plan_points(self):
        """Of every body, the supports last, {(x, z, number): [(contact, side), ...]}: two points to a bond on the
        joint's normal, as far before it as behind; bonds share points where they fall together."""
        contacts, cells = self.layout.contacts, self.layout.cells
        width = cells.right - cells.left
        n_bodies = len(self.layout.bodies)
        wanted, alike = [{} for _ in range(n_bodies + len(self.layout.supports))], Counter()
        ends = np.column_stack([rows(contacts.first, n_bodies), contacts.second])
        for index in range(len(contacts)):
            x, z = contacts.x[index], contacts.z[index]
            # At corners two overlaps may end in one place; YADE keeps one bond between two members.
            twin = contacts.first[index], contacts.second[index], round(x, 7), round(z, 7)
            alike[twin] += 1
            if contacts.upright[index]:
                dx, dz = min(width[contacts.first_cell[index]], width[contacts.second_cell[index]]) / 2, 0.0
            else:
                dx, dz = 0.0, self.layout.wall.brick.height / 2
            for side, body in enumerate(ends[index]):
                sign = 2 * side - 1
                key = round(x + sign * dx, 7), round(z + sign * dz, 7), alike[twin]
                wanted[body].setdefault(key, []).append((index, side))
        return wanted

    def _add_points(self, body):
        """Bond members of the body in this row."""
        return [_ball(place[:2], _POINT, self._bond) for place in self._points[body]]

    def _note(self, body, ids):
        """Give the ids of the bond members of the body in this row to the contact points that they belong to."""
        for identity, users in zip(ids, self._points[body].values()):
            for index, side in users:
                self.ends[index][side] = identity

    def _box(self, centre, extents, color=(0.5, 0.5, 0.5), seen=True):
        box = utils.box(centre, extents, material=self._solid if seen else self.tip, color=color, wire=not seen)
        box.bounded = seen
        box.mask = _SEEN | _FACE
        return box

    def _add_brick(self, body):
        bodies, thickness = self.layout.bodies, self.layout.wall.brick.thickness
        centre = float(bodies.x[body]), 0.0, float(bodies.z[body])
        half = float(bodies.length[body]) / 2, thickness / 2, float(bodies.height[body]) / 2
        color = _brick_color(self.layout, body)
        kinds = ["box", *sorted({tip.face[1] for tip in self.tips.values() if tip.face[0] == body} - {"box"})]
        reach = {"box": (0, 0, 0), "bed": (_REACH, 0, 0), "head": (0, 0, _REACH)}
        boxes = [self._box(centre, np.add(half, reach[kind]), color, seen=kind == "box") for kind in kinds]
        points = self._add_points(body)
        looks = [brick_shape(centre, half, self.tip, color)] if HAS_POLYHEDRA else []
        clump, ids = O.bodies.appendClumped([*boxes, *points, *looks])
        self.faces.update({(body, kind): identity for kind, identity in zip(kinds, ids)})
        self._note(body, ids[len(boxes):])
        self.clumps.append(clump)
        self.members.append(list(ids[:len(boxes) + len(points)]))
        _set_clump(O.bodies[clump].state, bodies.mass[body], bodies.inertia[body])

    def _add_support(self, support):
        """A box as high as a brick, up to the middle of the way to its neighbours, or beyond the wall where it has
        none."""
        brick, all_of = self.layout.wall.brick, self.layout.supports
        edges = [all_of.left[0] - _GROUND, *((all_of.right[:-1] + all_of.left[1:]) / 2), all_of.right[-1] + _GROUND]
        left, right, row = edges[support], edges[support + 1], len(self.layout.bodies) + support
        box = self._box(((left + right) / 2, 0, -brick.height / 2),
                        ((right - left) / 2, brick.thickness / 2, brick.height / 2), (0.4, 0.4, 0.4))
        parts = [box, *self._add_points(row)]
        for part in parts:
            part.state.blockedDOFs = "xyzXYZ"
        ids = [O.bodies.append(part) for part in parts]
        self.ground.append(ids)
        self.faces[GROUND - support, "box"] = ids[0]
        self._note(row, ids[1:])


def _tips(layout):
    """{contact point: _Tip} of all that may break."""
    contacts = layout.contacts
    found = {}
    for index in range(layout.n_joints):
        if np.isinf(contacts.tensile_strength[index]) and np.isinf(contacts.cohesion[index]):
            continue
        bodies = int(contacts.first[index]), int(contacts.second[index])
        margins = [_margin(layout, body, index) for body in bodies]
        if min(margins) > _MARGIN or abs(margins[0] - margins[1]) < 1e-6:
            side = index % 2 if bodies[0] >= 0 else 1
        else:
            side = int(margins[0] > margins[1])  # the tip is where the face is nearer to its end
        head = contacts.upright[index]
        kind = "box" if max(margins) > _MARGIN else "head" if head else "bed"
        inwards = 1.0 if side else -1.0
        found[index] = _Tip(float(contacts.x[index]), float(contacts.z[index]), (inwards * head, inwards * (not head)),
                            bodies[side], bool(side), (bodies[1 - side], kind))
    return found


def _margin(layout, body, index):
    """Distance of a contact point from the nearer end of the body's face [m]."""
    contacts, bodies = layout.contacts, layout.bodies
    if body < 0:
        return _GROUND
    if contacts.upright[index]:
        return bodies.height[body] / 2 - abs(contacts.z[index] - bodies.z[body])
    return bodies.length[body] / 2 - abs(contacts.x[index] - bodies.x[body])
