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
along a joint.  A bond that softens follows the joint law (`bonds`).  Crushing moves the rest
position of a bond, or reduces the radius of a tip (`crushing`).
"""

from itertools import starmap
from types import SimpleNamespace

import numpy as np
import yade
from yade import O, Vector3, utils

from damage.law.joint_law import friction_left, material_of
from damage.units import GRAVITY
from yade_scripts.bodies import (
    CORNER,
    FACE,
    INSET,
    REACH,
    SEEN,
    TIP,
    ball,
    collision_material,
    corner_places,
    parts_of,
)
from yade_scripts.friction_work import FrictionWork
from yade_scripts.joint_tracker import frictions

UNBREAKABLE = 1e300  # [N], strength of joints that stay elastic
# [N], of joints without tensile strength: YADE's law takes zero for one that it need not check
LEAST_STRENGTH = 1e-6
# [-], least radius of a tip over the depth at which its joint crushes, below which it is replaced
_DEEP = 1.5
_ON_SOIL = 4.0  # [-], largest depth of a tip on soil over the mean static one
_CRUSHED_INSET = 5e-3  # [m], the same where joints can crush, which brings bricks closer
_IMPACT_DAMPING = 0.2  # [-], of loose bricks' contacts over the critical, once a brick has fallen


class YadeWall:
    """A wall in YADE, initially at rest, unloaded and intact; arrays are in the order of the
    layout.

    clumps: body ids (n_bodies,); members: [ids of the members that have contacts] of each clump;
    bonds: YADE interactions (n_contacts,); geometries, physics: their geom and phys, which outlast
    them; signs: +1 where YADE's second body is the layout's second (n_contacts,); ground: [ids of
    the bodies] of each support, whose motion is prescribed; bonded: whether the interaction is
    still the bond (n_contacts,); closure:
    plastic closure of contact points (n_joints,) [m]; turning: states with the rotations of the
    bodies; tips: {contact point: Tip} of those that may fail; faces: {(body, kind): id} of the
    boxes; work: FrictionWork; handed: +1 where a positive shear follows the tangent, the normal
    rotated by a right angle, else -1 (n_contacts,).
    """

    def __init__(self, layout, parts, bonds, newton, law, work):
        self.layout = layout
        self.bonds = bonds
        self.newton = newton
        self.law = law
        self.geometries = [bond.geom for bond in bonds]
        self.physics = [bond.phys for bond in bonds]
        self.clumps = parts.clumps
        self.members = parts.members
        self.ground = parts.ground
        self.reader = parts.reader
        self.signs = np.array(
            [1.0 if bond.id2 == second else -1.0 for bond, (_, second) in zip(bonds, parts.ends)]
        )
        self.bonded = np.ones(len(bonds), dtype=bool)
        self.tips = parts.tips
        self.faces = parts.faces
        # of a house: ids of the tips that are not in use yet, and of the corners
        self._waiting = parts.waiting
        self._corners_waiting = parts.corners
        self.turning = [
            O.bodies[parts.faces[body, "box"]].state for body in range(len(layout.bodies))
        ]
        material = material_of(layout.wall.joint)
        # share of its friction that a bond leaves
        intact = friction_left(False, material)
        self._friction_left = 1.0
        if intact:
            self._friction_left = friction_left(True, material) / intact
        self._material = parts.tip
        self.work = work
        # A head joint's shear is positive along z, where its normal lies along x; a bed joint's the
        # other way round.
        self.handed = np.where(layout.contacts.upright, -1.0, 1.0)
        contacts = layout.contacts
        n = layout.n_joints
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
        self.closure = np.zeros(n)
        self._tip_of = {}
        self._corners_inset = _CRUSHED_INSET if self._depth.any() else INSET
        self.corners = set()  # ids of the spheres in the bricks' corners
        self.gone = set()  # joints whose dry contact is out of reach

    def friction_of(self, joint):
        """Coefficient of friction of a dry joint, or of the one that a bond leaves, which a script
        may have set."""
        phys = self.physics[joint]
        return (
            phys.tanFrictionAngle * self._friction_left
            if self.bonded[joint]
            else phys.tangensOfFrictionAngle
        )

    def tensile_strengths(self, joints):
        """Tensile strengths of bonds (m,) [Pa], zero where one towards a face of the wall has
        failed (`loosen`)."""
        strengths = self.layout.contacts.tensile_strength[joints]
        failed = np.flatnonzero(~self.bonded[: self.layout.n_joints])
        strengths[np.isin(joints, self.layout.inner(failed))] = 0.0
        return strengths

    def loosen(self, joint):
        """Replace a failed bond by a tip on a face, with the shear force of the bond after its
        failure.

        In a house the bond beside it, towards the middle of the wall, has no tensile strength from
        then on: a crack has its tip there.
        """
        bond = self.bonds[joint]
        tip = self.tips[joint]
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
        for inner in self.layout.inner(joint):
            if self.bonded[inner]:
                self.physics[inner].FnMax = LEAST_STRENGTH

    def _put(self, joint, contact):
        """Have a dry contact stand in place of a bond, or of a dry contact."""
        self.bonds[joint] = contact
        self.geometries[joint] = contact.geom
        self.physics[joint] = contact.phys
        self.bonded[joint] = False
        self.signs[joint] = 1.0 if self.tips[joint].is_second else -1.0

    def crush(self, joint, more):
        """Move the rest position of a contact point by an increment of plastic closure [m]."""
        self.closure[joint] += more
        _ease(self.bonds[joint], more)
        if self.bonded[joint]:
            self.bonds[joint].phys.initD += more
            return
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
        contact = self.bonds[joint]
        phys = self.physics[joint]
        if contact.isReal:
            O.interactions.erase(contact.id1, contact.id2)
        self.geometries[joint] = SimpleNamespace(penetrationDepth=0.0)
        phys.normalForce = phys.shearForce = Vector3.Zero
        self.bonded[joint] = False

    def _exchange(self, joint):
        """Replace a tip that crushing has made too small by one farther inside its brick."""
        old = self.bonds[joint]
        stiffness = (old.phys.kn, old.phys.ks)
        shear = Vector3(old.phys.shearForce)
        self.work.forget(joint)
        worn = self._tip_of[joint]
        force = O.forces.f(worn, True)
        torque = O.forces.t(worn, True)
        place = Vector3(O.bodies[worn].state.pos)
        self.members[self.tips[joint].body].remove(worn)
        O.bodies.erase(worn)  # else it would touch the face again
        contact = self._touch(joint, *stiffness)
        self._put(joint, contact)
        point = self._tip_of[joint]
        O.forces.addF(point, force)
        O.forces.addT(point, torque + (place - O.bodies[point].state.pos).cross(force))
        contact.phys.shearForce = shear
        self.work.renew(joint, contact)

    def _touch(self, joint, normal_stiffness, shear_stiffness):
        """Create the tip of a joint, moved by its plastic closure, and return its contact with the
        face."""
        tip = self.tips[joint]
        radius = max(TIP, 2 * _DEEP * self._depth[joint])
        inwards = radius + self.closure[joint]
        point = self._waiting.get(joint)
        if point is not None:
            self.members[tip.body].append(point)
        else:
            place = [x + inwards * by for x, by in zip(tip.place, tip.inwards)]
            (point,) = self._attach(tip.body, [ball(place, radius, self._material)])
        self._tip_of[joint] = point
        contact = utils.createInteraction(self.faces[tip.face], point)
        contact.phys.kn = normal_stiffness
        contact.phys.ks = shear_stiffness
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
                O.bodies[corner].bounded = True
                O.bodies[corner].mask = SEEN
            members.extend(corners)
            self.corners.update(corners)
        inset = CORNER + self._corners_inset
        for body in range(len(self._corners_waiting), len(self.layout.bodies)):
            balls = [
                ball(place, CORNER, self._material)
                for place in corner_places(self.layout, body, inset)
            ]
            for tip in balls:
                tip.bounded = True
                tip.mask = SEEN
            self.corners.update(self._attach(body, balls))

    def damp_impacts(self):
        """Give all collisions dashpots from now on; the shear forces of those that exist begin from
        zero."""
        self.arm()
        soft = O.materials[
            O.materials.append(
                yade.FrictViscoMat(
                    density=0.0, betan=_IMPACT_DAMPING, **collision_material(self.layout.wall.joint)
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
                and contact.geom.penetrationDepth < -REACH / 10
            ):
                O.interactions.erase(contact.id1, contact.id2)
                self.gone.add(int(joint))

    def regain(self):
        """Give YADE's contact of a tip that was out of reach and touches its face again the
        stiffnesses and friction of the one before."""
        again = [joint for joint in self.gone if self.bonds[joint].isReal]
        for joint in again:
            contact = self.bonds[joint]
            old = self.physics[joint]
            contact.phys.kn = old.kn
            contact.phys.ks = old.ks
            contact.phys.tangensOfFrictionAngle = old.tangensOfFrictionAngle
            self._put(joint, contact)
            self.work.renew(joint, contact)
        self.gone.difference_update(again)

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
        bodies = self.layout.bodies
        brick = self.turning[body]
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
        state.mass = bodies.mass[body]
        state.inertia = Vector3(1, 1, 1) * bodies.inertia[body]
        self.members[body] += ids
        return ids


def _ease(contact, closure):
    """Reduce the force of a contact on both bodies by its increment of plastic closure [m], before
    the bodies move."""
    geom = contact.geom
    force = contact.phys.kn * closure * contact.geom.normal
    contact.phys.normalForce -= force
    for body, on_it in ((contact.id1, force), (contact.id2, -force)):
        O.forces.addF(body, on_it)
        O.forces.addT(body, (geom.contactPoint - O.bodies[body].state.pos).cross(on_it))


def build(layout, dt):
    """Build a wall in YADE's scene, which is cleared; returns a YadeWall.

    dt: time step [s].
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
        avoidSelfInteractionMask=FACE,
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
    parts = parts_of(layout)
    parts.place(newton)
    bonds = list(starmap(utils.createInteraction, parts.ends))
    for index, (bond, slope) in enumerate(zip(bonds, frictions(layout, False).tolist())):
        _set_bond(bond.phys, layout, index, slope)
    bonding.cohesiveTresholdIteration = 0
    work = FrictionWork(friction)
    return YadeWall(
        layout=layout,
        parts=parts,
        bonds=bonds,
        newton=newton,
        law=law,
        work=work,
    )


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
    if index >= layout.n_joints:
        phys.FnMax = phys.FsMax = UNBREAKABLE  # they fail by `ties`, or not at all
    phys.tanFrictionAngle = friction
