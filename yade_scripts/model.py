"""A wall in YADE: rigid clumps, a bond for each contact point, and a dry contact once it has
failed.

A bond joins two massless members that lie symmetrically on either side of the contact point, on the
joint's normal. Its law is YADE's JCFpm (Scholtès & Donzé 2012, doi:10.1016/j.ijrmms.2012.03.011)
without smooth joints, with the stiffness, strength and area of the joint.  While it is intact, its
shear displacement is elastic, micrometres over the 75 mm between the members, so that the line
between them is the normal of the face.

A failed bond is replaced by a tip and a face: a sphere of 0.5 mm that touches the contact point
from inside one brick, and the box of the other, with YADE's law of friction
(Law2_ScGeom_FrictPhys_CundallStrack), whose forces act on both bricks in the same point.  The
normal is that of the face.  It rotates with its brick, and does not change as the joint slides; the
tip moves round a corner where it leaves the face.  The face belongs to either brick alternately
along a joint.  A softening bond has intact and failed parallel elements (`bundles`).  Crushing
moves the rest position of a bond, or reduces the radius of a tip (`crushing`).

Bodies are built in the wall's plane, those of a house (`damage.wall.space`) in that of its walls
unfolded, and then placed.  A house has all six freedoms.  There all tips and corners are parts of
the clumps from the start: YADE finds the principal axes of a clump anew when parts are added, as
eigenvectors that may be a left-handed set, and then turns it wrongly.
"""

from collections import Counter
from dataclasses import dataclass
from itertools import starmap
from types import SimpleNamespace

import numpy as np
import yade
from yade import O, Quaternion, Vector3, utils

from damage.law.joint_law import friction_left, material_of
from damage.units import GRAVITY
from damage.wall.kinds import CUT, GROUND, rows
from damage.wall.kinematics import places_of
from yade_scripts.friction_work import FrictionWork
from yade_scripts.joint_tracker import frictions

UNBREAKABLE = 1e300  # [N], strength of joints that stay elastic
# [N], of joints without tensile strength: YADE's law takes zero for one that it need not check
LEAST_STRENGTH = 1e-6
TIP = 5e-4  # [m], radius: beyond this depth, at 33 MPa, a tip would be assigned to another face
# [-], least radius of a tip over the depth at which its joint crushes, below which it is replaced
_DEEP = 1.5
_POINT = 1e-3  # [m], radius of bond members, without effect
_CORNER = 1e-3  # [m], radius of the spheres in the corners, the contacts of loose bricks
_ON_SOIL = 4.0  # [-], largest depth of a tip on soil over the mean static one
_INSET = 5e-4  # [m], their distance from the faces, so that they do not touch while joints hold
_CRUSHED_INSET = 5e-3  # [m], the same where joints can crush, which brings bricks closer
# [m], a contact point closer to the end of a face than this has its tip on that brick
_MARGIN = 1e-2
_REACH = 3e-2  # [m], extension of a face where the contact point lies at the ends of both faces
_COLLISION = 2e8  # [N/m], normal stiffness of loose bricks' contacts
_COLLISION_SHEAR = 0.4  # [-], shear stiffness over the normal
_IMPACT_DAMPING = 0.2  # [-], of loose bricks' contacts over the critical, once a brick has fallen
_GROUND = 10.0  # [m], extension of the ground beyond the wall
_SEEN, _FACE = 1, 2  # bits of masks: seen by the collider; faces do not collide with faces


class YadeWall:
    """A wall in YADE, initially at rest, unloaded and intact; arrays are in the order of the
    layout.

    clumps: body ids (n_bodies,); members: [ids of the members that have contacts] of each clump;
    bonds: YADE interactions (n_contacts,); geometries, physics: their geom and phys, which outlast
    them; signs: +1 where YADE's second body is the layout's second (n_contacts,); ground: [ids of
    the bodies] of each support, whose motion is prescribed; bonded: whether the interaction is
    still the bond (n_contacts,); frayed: {joint: dry contact beside a partly failed bond}; closure:
    plastic closure of contact points (n_joints,) [m]; turning: states with the rotations of the
    bodies; tips: {contact point: _Tip} of those that may fail; faces: {(body, kind): id} of the
    boxes; work: FrictionWork; handed: +1 where a positive shear follows the tangent, the normal
    rotated by a right angle, else -1 (n_contacts,).
    """

    def __init__(self, layout, parts, bonds, newton, law, work, corner_depth):
        self.layout, self.bonds, self.newton, self.law = layout, bonds, newton, law
        self.geometries, self.physics = [bond.geom for bond in bonds], [bond.phys for bond in bonds]
        self.clumps, self.members, self.ground = parts.clumps, parts.members, parts.ground
        self.signs = np.array(
            [1.0 if bond.id2 == second else -1.0 for bond, (_, second) in zip(bonds, parts.ends)]
        )
        self.bonded, self.frayed = np.ones(len(bonds), dtype=bool), {}
        self.tips, self.faces = parts.tips, parts.faces
        # of a house: ids of the tips that are not in use yet, and of the corners
        self._waiting, self._corners_waiting = parts.waiting, parts.corners
        self.turning = [
            O.bodies[parts.faces[body, "box"]].state for body in range(len(layout.bodies))
        ]
        material = material_of(layout.wall.joint)
        # share of its friction that a bond leaves
        intact, self._kept = friction_left(False, material), 1.0
        if intact:
            self._kept = friction_left(True, material) / intact
        self._material, self.work = parts.tip, work
        # A head joint's shear is positive along z, where its normal lies along x; a bed joint's the
        # other way round.
        self.handed = np.where(layout.contacts.upright, -1.0, 1.0)
        contacts, n = layout.contacts, layout.n_joints
        # Depth at which contact points crush, or to which soil gives way, else none [m]; {joint:
        # its tip's id}.
        self._depth = np.where(
            np.isinf(contacts.compressive_strength),
            0.0,
            contacts.compressive_strength / contacts.normal_stiffness,
        )[:n]
        if layout.options.soil != "rigid":
            base = contacts.first[:n] < 0
            stiffness = np.sum((contacts.normal_stiffness * contacts.area)[:n][base])
            self._depth[base] += _ON_SOIL * layout.total_mass * GRAVITY / stiffness
        self.closure, self._tip_of = np.zeros(n), {}
        inset = _CRUSHED_INSET if self._depth.any() else _INSET
        # of the faces' overlap [m], from which corners touch
        self._corner_depth = max(corner_depth, inset)
        self.corners = set()  # ids of the spheres in the bricks' corners
        self.gone = set()  # joints whose dry contact is out of reach

    def friction_of(self, joint):
        """Coefficient of friction of a dry joint, or of the one that a bond leaves, which a script
        may have set."""
        phys = self.physics[joint]
        return (
            phys.tanFrictionAngle * self._kept
            if self.bonded[joint]
            else phys.tangensOfFrictionAngle
        )

    def tensile_strengths(self, joints):
        """Of bonds (m,) [Pa], none where one towards a face of the wall has failed (`loosen`)."""
        found, space = self.layout.contacts.tensile_strength[joints], self.layout.space
        if space:
            failed = np.flatnonzero(~self.bonded[: self.layout.n_joints])
            found[np.isin(joints, space.inner[failed])] = 0.0
        return found

    def loosen(self, joint):
        """Replace a failed bond by a tip on a face, with the shear force of the bond after its
        failure.

        In a house the bond beside it, towards the middle of the wall, has no tensile strength from
        then on: a crack has its tip there.
        """
        bond, tip = self.bonds[joint], self.tips[joint]
        sign = 1.0 if tip.is_second else -1.0
        shear = self.signs[joint] * sign * bond.phys.shearForce
        stiffness = bond.phys.kn, bond.phys.ks
        O.interactions.erase(bond.id1, bond.id2)
        contact = self._touch(joint, *stiffness)
        contact.phys.shearForce = shear
        self._put(joint, contact)
        self.work.add(
            joint,
            contact,
            self.friction_of(joint) * contact.phys.kn * max(contact.geom.penetrationDepth, 0.0),
        )
        for inner in self.layout.space.inner[joint] if self.layout.space else ():
            if self.bonded[inner]:
                self.physics[inner].FnMax = LEAST_STRENGTH

    def fray(self, joint):
        """Add a dry contact without stiffness beside a bond, for its failed parallel elements."""
        self.frayed[joint] = self._touch(joint, 0.0, 0.0)

    def part(self, joint):
        """Replace a bond by its dry contact after its last parallel element has failed."""
        bond = self.bonds[joint]
        O.interactions.erase(bond.id1, bond.id2)
        self._put(joint, self.frayed.pop(joint))

    def _put(self, joint, contact):
        """Have a dry contact stand in place of a bond, or of a dry contact."""
        self.bonds[joint], self.geometries[joint], self.physics[joint] = (
            contact,
            contact.geom,
            contact.phys,
        )
        self.bonded[joint], self.signs[joint] = False, 1.0 if self.tips[joint].is_second else -1.0

    def crush(self, joint, more):
        """Move the rest position of a contact point by an increment of plastic closure [m]."""
        self.closure[joint] += more
        _ease(self.bonds[joint], more)
        if self.bonded[joint]:
            self.bonds[joint].phys.initD += more
            if joint not in self.frayed:
                return
            _ease(self.frayed[joint], more)
        shape = O.bodies[self._tip_of[joint]].shape
        if shape.radius - more > _DEEP * self._depth[joint]:
            shape.radius -= more
        else:
            self._exchange(joint)

    def end(self, joint):
        """Remove the contact of a joint whose faces no longer overlap; its elastic energy
        dissipates."""
        phys = self.physics[joint]
        depth = max(self.geometries[joint].penetrationDepth, 0.0)
        self.work.end(joint, (phys.kn * depth**2 + phys.shearForce.squaredNorm() / phys.ks) / 2)
        self.remove(joint)

    def remove(self, joint):
        """Remove the interaction of a contact point, which has no force and no depth from then
        on."""
        contact, phys = self.bonds[joint], self.physics[joint]
        if contact.isReal:
            O.interactions.erase(contact.id1, contact.id2)
        self.geometries[joint] = SimpleNamespace(penetrationDepth=0.0)
        phys.normalForce = phys.shearForce = Vector3.Zero
        self.bonded[joint] = False

    def contacts_of(self, joint):
        """Interactions of a joint: the bond, or the dry contact that replaced it; of one that
        failed in part both."""
        dry = self.frayed.get(joint)
        return [self.bonds[joint]] if dry is None else [self.bonds[joint], dry]

    def force_on(self, joint, geom, normal, shear):
        """Force vector of an interaction on its second member in YADE's order; normal (tension
        positive), shear [N]."""
        n, along = geom.normal, -float(self.handed[joint] * shear)
        return -float(normal) * n + along * Vector3(n[2], 0, -n[0])

    def _exchange(self, joint):
        """Replace a tip that crushing has made too small by one farther inside its brick."""
        old = self.contacts_of(joint)[-1]
        stiffness, shear = (old.phys.kn, old.phys.ks), Vector3(old.phys.shearForce)
        self.work.forget(joint)
        worn = self._tip_of[joint]
        force, torque, there = (
            O.forces.f(worn, True),
            O.forces.t(worn, True),
            Vector3(O.bodies[worn].state.pos),
        )
        self.members[self.tips[joint].body].remove(worn)
        O.bodies.erase(worn)  # else it would touch the face again
        contact = self._touch(joint, *stiffness)
        if joint in self.frayed:
            self.frayed[joint] = contact
        else:
            self._put(joint, contact)
        point = self._tip_of[joint]
        O.forces.addF(point, force)
        O.forces.addT(point, torque + (there - O.bodies[point].state.pos).cross(force))
        contact.phys.shearForce = shear
        self.work.renew(joint, contact)

    def _touch(self, joint, normal_stiffness, shear_stiffness):
        """Create the tip of a joint, moved by its plastic closure, and return its contact with the
        face."""
        tip, radius = self.tips[joint], max(TIP, 2 * _DEEP * self._depth[joint])
        inwards = radius + self.closure[joint]
        point = self._waiting.get(joint)
        if point is not None:
            self.members[tip.body].append(point)
        else:
            place = [x + inwards * by for x, by in zip(tip.place, tip.inwards)]
            (point,) = self._attach(tip.body, [_ball(place, radius, self._material)])
        self._tip_of[joint] = point
        contact = utils.createInteraction(self.faces[tip.face], point)
        contact.phys.kn, contact.phys.ks = normal_stiffness, shear_stiffness
        contact.phys.tangensOfFrictionAngle = self.friction_of(joint)
        return contact

    def arm(self):
        """Enable collisions of all bricks with each other and with the ground from now on.

        They are contacts of spheres in the corners of all bricks and top masses with faces and with
        each other.
        """
        if self.corners:
            return
        for members, corners in zip(self.members, self._corners_waiting):
            for corner in corners:
                O.bodies[corner].bounded, O.bodies[corner].mask = True, _SEEN
            members.extend(corners)
            self.corners.update(corners)
        inset = _CORNER + self._corner_depth
        for body in range(0 if self.layout.space else len(self.layout.bodies)):
            balls = [
                _ball(place, _CORNER, self._material)
                for place in _corner_places(self.layout, body, inset)
            ]
            for ball in balls:
                ball.bounded, ball.mask = True, _SEEN
            self.corners.update(self._attach(body, balls))

    def damp_impacts(self):
        """Give all collisions dashpots from now on; the shear forces of those that exist begin from
        zero."""
        self.arm()
        soft = O.materials[
            O.materials.append(
                yade.FrictViscoMat(
                    density=0.0, betan=_IMPACT_DAMPING, **_collision(self.layout.wall.joint)
                )
            )
        ]
        for contact in self.collisions():
            O.interactions.erase(contact.id1, contact.id2)
        for members, mass in zip(self.members, self.layout.bodies.mass):
            for part in (O.bodies[member] for member in members):
                if part.id in self.corners:
                    part.mat = soft
                # YADE takes the critical damping from the masses of the two members
                if part.bounded:
                    part.state.mass = mass

    def tidy(self):
        """Delete collisions that are over and contacts of joints that are out of reach."""
        for contact in self.collisions():
            if contact.geom.penetrationDepth < 0:
                O.interactions.erase(contact.id1, contact.id2)
        for joint in np.flatnonzero(~self.bonded[: self.layout.n_joints]):
            contact = self.bonds[joint]
            # A face that extends beyond its brick must not be touched by a tip that returns another
            # way.
            if (
                self.tips[joint].face[1] != "box"
                and contact.isReal
                and contact.geom.penetrationDepth < -_REACH / 10
            ):
                O.interactions.erase(contact.id1, contact.id2)
                self.gone.add(int(joint))

    def regain(self):
        """Give YADE's contact of a tip that was out of reach and touches its face again the
        stiffnesses and friction of the one before."""
        found = [joint for joint in self.gone if self.bonds[joint].isReal]
        for joint in found:
            contact, old = self.bonds[joint], self.physics[joint]
            contact.phys.kn, contact.phys.ks = old.kn, old.ks
            contact.phys.tangensOfFrictionAngle = old.tangensOfFrictionAngle
            self._put(joint, contact)
            self.work.renew(joint, contact)
        self.gone.difference_update(found)

    def collisions(self):
        """YADE's interactions between loose bricks, also those that only begin or are over."""
        if not self.corners:
            return []
        return [
            i
            for i in O.interactions
            if i.isReal and (i.id1 in self.corners or i.id2 in self.corners)
        ]

    def _attach(self, body, parts):
        """Add parts, with positions in the undeformed wall, to a brick at its present position;
        returns their ids."""
        bodies, brick = self.layout.bodies, self.turning[body]
        start = Vector3(bodies.x[body], 0, bodies.z[body])
        for part in parts:
            part.state.pos = brick.pos + brick.ori * (part.state.pos - start)
            part.state.ori = brick.ori
        ids = [O.bodies.append(part) for part in parts]
        state = O.bodies[self.clumps[body]].state
        velocities = Vector3(state.vel), Vector3(state.angVel)
        O.bodies.addToClump(ids, self.clumps[body])
        # YADE has stopped the clump and recomputed mass and axes; axes do not matter where all
        # inertias are equal.
        state.vel, state.angVel = velocities
        state.mass, state.inertia = bodies.mass[body], Vector3(1, 1, 1) * bodies.inertia[body]
        self.members[body] += ids
        return ids


@dataclass(frozen=True)
class _Tip:
    """Tip of a contact point: its place (x, y, z) in the undeformed wall of its body [m]; inwards:
    unit vector from there into the body of the tip; is_second: whether that is the layout's second
    body; face: (body, kind) of the other side."""

    place: tuple
    inwards: tuple
    body: int
    is_second: bool
    face: tuple


def _collision(joint):
    """{parameter: value} of the materials of loose bricks' contacts; joint:
    damage.wall.parameters.Joint.

    YADE gives a contact of radius R and modulus E the stiffness E R.
    """
    return {
        "young": _COLLISION / _CORNER,
        "poisson": _COLLISION_SHEAR,
        "frictionAngle": joint.friction_angle,
    }


def _ball(place, radius, material):
    """A sphere at (x, y, z) [m] that the collider does not see."""
    ball = utils.sphere(tuple(map(float, place)), radius, material=material, color=(0.3, 0.3, 0.3))
    ball.bounded = False
    return ball


def _box_of(layout, body):
    """Centre (x, y, z) and size of a body, as unfolded (3,) [m]."""
    bodies, space = layout.bodies, layout.space
    y, depth = 0.0, layout.wall.brick.thickness
    if space:
        y, depth = float(space.offset[body]), space.depth[body]
    centre = float(bodies.x[body]), y, float(bodies.z[body])
    return centre, np.array([bodies.length[body], depth, bodies.height[body]])


def _corner_places(layout, body, inset):
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


def _ease(contact, closure):
    """Reduce the force of a contact on both bodies by its increment of plastic closure [m], before
    the bodies move."""
    geom, force = contact.geom, contact.phys.kn * closure * contact.geom.normal
    contact.phys.normalForce -= force
    for body, on_it in ((contact.id1, force), (contact.id2, -force)):
        O.forces.addF(body, on_it)
        O.forces.addT(body, (geom.contactPoint - O.bodies[body].state.pos).cross(on_it))


def build(layout, dt, corner_depth=0.0):
    """Build a wall in YADE's scene, which is cleared; returns a YadeWall.

    dt: time step [s]; corner_depth: overlap with a face from which a loose brick's corner touches
    it [m], at least that of YadeWall.
    """
    O.reset()
    O.dt = dt
    ig2 = yade.Ig2_Sphere_Sphere_ScGeom(avoidGranularRatcheting=False)
    bonding = yade.Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)
    law = yade.Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM(
        neverErase=True, smoothJoint=False, label="jointLaw"
    )
    friction = yade.Law2_ScGeom_FrictPhys_CundallStrack(
        neverErase=True, sphericalBodies=False, traceEnergy=True
    )
    newton = yade.NewtonIntegrator(damping=0.0, gravity=(0, 0, 0), label="newton")
    collider = yade.InsertionSortCollider(
        [yade.Bo1_Sphere_Aabb(), yade.Bo1_Box_Aabb()],
        verletDist=1e-4,
        avoidSelfInteractionMask=_FACE,
    )
    damped = yade.Law2_ScGeom_FrictViscoPhys_CundallStrackVisco(sphericalBodies=False)
    loop = yade.InteractionLoop(
        [ig2, yade.Ig2_Box_Sphere_ScGeom()],
        [
            bonding,
            yade.Ip2_FrictMat_FrictMat_FrictPhys(),
            yade.Ip2_FrictMat_FrictViscoMat_FrictViscoPhys(),
            yade.Ip2_FrictViscoMat_FrictViscoMat_FrictViscoPhys(),
        ],
        [law, friction, damped],
    )
    O.engines = [yade.ForceResetter(), collider, loop, newton]
    parts = _Parts(layout, max(corner_depth, _INSET))
    if layout.space:
        parts.place(newton)
    bonds = list(starmap(utils.createInteraction, parts.ends))
    for index, (bond, slope) in enumerate(zip(bonds, frictions(layout, False).tolist())):
        _set_bond(bond.phys, layout, index, slope)
    bonding.cohesiveTresholdIteration = 0
    work = FrictionWork(friction, layout.n_joints)
    return YadeWall(layout, parts, bonds, newton, law, work, corner_depth)


def _set_bond(phys, layout, index, friction):
    """Set area, stiffness, strength and friction of a JCFpm bond to those of its contact point."""
    contacts = layout.contacts
    area = float(contacts.area[index])
    phys.isCohesive = True
    phys.crossSection = area
    phys.kn = float(contacts.normal_stiffness[index]) * area
    phys.ks = float(contacts.shear_stiffness[index]) * area
    phys.FnMax = min(
        UNBREAKABLE, max(LEAST_STRENGTH, float(contacts.tensile_strength[index]) * area)
    )
    phys.FsMax = min(UNBREAKABLE, float(contacts.cohesion[index]) * area)
    if contacts.kind[index] == CUT or index >= layout.n_joints:
        phys.FnMax = phys.FsMax = UNBREAKABLE  # they fail by `splitting` and `ties`, or not at all
    phys.tanFrictionAngle = friction


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


class _Parts:
    """Bodies of a wall in YADE's scene, added by the constructor.

    clumps, members, ground: as in YadeWall; ends: ids of the members that each bond joins
    (n_contacts, 2); tips: {contact point: _Tip} of those that may fail; faces: {(body, kind): id}
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
        common = _collision(joint)
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
        return [_ball(place[:3], _POINT, self._bond) for place in self._points[body]]

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
        box.mask = _SEEN | _FACE
        return box

    def _add_brick(self, body):
        bodies, (centre, size) = self.layout.bodies, _box_of(self.layout, body)
        half = size / 2
        color = _brick_color(self.layout, body)
        kinds = [
            "box",
            *sorted({tip.face[1] for tip in self.tips.values() if tip.face[0] == body} - {"box"}),
        ]
        across = _REACH if self.layout.space else 0
        reach = {
            "box": (0, 0, 0),
            "bed": (_REACH, across, 0),
            "head": (0, across, _REACH),
            "side": (_REACH, 0, _REACH),
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
                _ball(place, _CORNER, self.tip)
                for place in _corner_places(self.layout, body, _CORNER + self._corner_depth)
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
        return _ball(place, TIP, self.tip)

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
                places, beyond = (own, _REACH) if len(own) else (places[:1], 0.0)
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


def _tips(layout, places, normals):
    """{contact point: _Tip} of all that may fail; places, normals: of each contact point in the
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
        found[index] = _Tip(
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
