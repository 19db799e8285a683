"""Bonds that soften, and cuts through bricks, by the joint law itself in place of YADE's.

YADE's law is their elastic predictor: it is linear up to the strengths that are left, and tells
when a bond passes them.  In that step the joint law replaces the bond's forces before the bodies
move, and the bond keeps the stiffness and the strengths that are left.

The line between the two members of a bond tilts as the joint slides, and they move apart by the
square of the slip: the law's force has the axes of the face, and the bond's rest position follows.
"""

from typing import Any, NamedTuple

import numpy as np
from yade import O, Vector3

from damage.elementary import total
from damage.law.joint_law import (
    INTACT,
    ContactState,
    diagonal_tension,
    material_of,
    strength_left,
    tension_stiffness,
)
from damage.mechanics.bonds import PLACE, AdvancedBond, BondTables, advance_bonds, law_of
from damage.wall.split import CUT_POINTS, beside_cuts

LEAST = 1e-6  # [N], of a bond's cohesion: YADE takes zero for one without limit
COHESION = 3
"""Column of `BondTables.laws`."""
KAPPA, GAP, SLIP = map(ContactState._fields.index, ("kappa", "gap", "slip"))


class Gaping(NamedTuple):
    """A bond that has opened beyond its elastic range: YADE's geom and phys of it, and whether it
    is closed."""

    geometry: Any
    physics: Any
    closed: bool


def bonds_by_law(layout):
    """Whether the bond of each joint follows the joint law itself, (n_joints,) bool: it softens, or
    is a cut through a brick.  Bonds without tensile strength are brittle in either solver."""
    contacts = layout.contacts
    strength = contacts.tensile_strength[: layout.n_joints]
    softens = contacts.mortar[: layout.n_joints] & (strength > 0) & np.isfinite(strength)
    chosen = softens & layout.wall.joint.softens
    chosen[points_of_cuts(layout)] = True
    return chosen


def points_of_cuts(layout):
    """Contact points of all cuts through bricks, (n,) int."""
    cuts, _ = beside_cuts(layout.contacts)
    return (cuts[:, None] + np.arange(CUT_POINTS)).ravel()


class Bonds:
    """Bonds of a SceneReader's wall that follow the joint law, as its JointTracker records them;
    tables: their BondTables, of all joints."""

    def __init__(self, scene, tracker):
        self._scene = scene
        self._tracker = tracker
        layout = scene.model.layout
        n_joints = layout.n_joints
        contacts = layout.contacts
        self._brick = layout.wall.brick
        self._cuts, self._beside = beside_cuts(contacts)
        self._material = material_of(layout.wall.joint)
        self._sides = np.array(
            [
                [scene.model.faces[int(body), "box"] for body in (first, second)]
                for first, second in zip(contacts.first[:n_joints], contacts.second[:n_joints])
            ]
        )
        at_rest = self._places(range(n_joints))
        points = np.column_stack([contacts.x, contacts.z])[:n_joints, None]
        self.tables = BondTables(
            at_rest=at_rest,
            arms=points - at_rest[:, :, :2],
            upright=contacts.upright[:n_joints],
            laws=_laws(layout),
            states=np.tile(np.array(ContactState(), float), (n_joints, 1)),
            slid=np.zeros(n_joints),
        )
        self._gaping = {}  # {joint: Gaping}

    def gather(self):
        """Find the bonds that gape in a scene that was loaded."""
        scene = self._scene
        n_joints = len(self.tables.laws)
        stiffness = scene.area[:n_joints] * self.tables.laws[:, 0]
        gapes = (self.tables.states[:, GAP] > 0.0) & scene.model.bonded[:n_joints]
        for joint in np.flatnonzero(gapes).tolist():
            physics = scene.physics[joint]
            closed = physics.kn == stiffness[joint]
            self._gaping[joint] = Gaping(scene.geometries[joint], physics, closed)

    def confine(self):
        """Give all cuts what they bear in shear under the vertical stresses now."""
        scene = self._scene
        for cut, beside in zip(self._cuts, self._beside):
            stress = [scene.force_of(k)[0] / scene.area[k] for k in beside if k >= 0]
            bears = diagonal_tension(self._brick.tensile_strength, sum(stress) / 4)
            for joint in range(cut, cut + CUT_POINTS):
                self.tables.laws[joint, COHESION] = bears
                if scene.model.bonded[joint]:
                    kappa = self.tables.states[joint, KAPPA]
                    _, left = strength_left(False, self._law_of(joint), kappa)
                    scene.physics[joint].FsMax = float(scene.area[joint] * left)

    def step(self, passed):
        """Apply the joint law after a step of YADE's; passed: bonds beyond their strengths in it, a
        list.  Returns [(joint, event, normal stress, shear stress), ...] of those that failed."""
        for joint, (geometry, physics, closed) in self._gaping.items():
            closes = geometry.penetrationDepth > physics.initD
            if closes != closed and physics.isCohesive:
                self._turn(joint, closes)
        return self._advance(passed) if passed else []

    def sample(self):
        """Record the inelastic openings of the bonds that gape."""
        for joint, (geometry, physics, closed) in self._gaping.items():
            elastic = physics.kn / (self._scene.area[joint] * self.tables.laws[joint, 0])
            opening = max(physics.initD - geometry.penetrationDepth, 0.0)
            self._tracker.opening[joint] = 0.0 if closed else opening * (1 - elastic)

    def _places(self, joints):
        """Places of the bodies of joints, (m, 2, PLACE)."""
        rows = []
        for joint in joints:
            for side in self._sides[joint].tolist():
                state = O.bodies[side].state
                place = state.pos
                turned = state.ori
                rows.append((place[0], place[2], turned[0], turned[1], turned[2], turned[3]))
        return np.array(rows, float).reshape(-1, 2, PLACE)

    def _law_of(self, joint):
        return law_of(self.tables.laws[joint], self._material)

    def _advance(self, joints):
        """Advance bonds by the joint law, and correct their forces on the bodies; returns as
        `step`."""
        model = self._scene.model
        rows = np.array(joints)
        advanced = np.empty((len(joints), len(AdvancedBond._fields)))
        tables = self.tables._replace(states=self.tables.states[..., None])
        advance_bonds(
            rows,
            self._places(joints),
            np.array([self._slide(joint) for joint in joints]),
            model.closure,
            tables,
            self._material,
            advanced,
        )
        failed = []
        for joint, values in zip(joints, advanced.tolist()):
            bond = AdvancedBond(*values)
            self._correct(joint, bond)
            if bond.event == INTACT:
                self._rearm(joint, bond)
            else:
                self._gaping.pop(joint, None)
                failed.append((joint, int(bond.event), bond.normal_stress, bond.shear_stress))
        self._record(rows, AdvancedBond(*advanced.T))
        return failed

    def _slide(self, joint):
        """Shear displacement of a bond in the last step [m], along the tangent, the normal turned
        by a right angle in the wall's plane, or against it (`handed`)."""
        geometry = self._scene.geometries[joint]
        normal = geometry.normal
        moved = geometry.shearInc
        along_tangent = moved[0] * normal[2] - moved[2] * normal[0]
        return float(self._scene.model.handed[joint]) * along_tangent

    def _correct(self, joint, bond):
        """Replace the forces of a bond by those of an AdvancedBond."""
        scene = self._scene
        geometry = scene.geometries[joint]
        physics = scene.physics[joint]
        area = float(scene.area[joint])
        hand = float(scene.model.handed[joint])
        normal = geometry.normal
        nx = -bond.sine
        nz = bond.cosine
        if self.tables.upright[joint]:
            nx = bond.cosine
            nz = bond.sine
        if nx * normal[0] + nz * normal[2] < 0.0:
            nx = -nx
            nz = -nz
        pull = area * bond.normal_stress
        rub = hand * area * bond.shear_stress
        force = Vector3(-rub * nz - pull * nx, 0.0, rub * nx - pull * nz)
        along_line = -pull * normal
        more = force - physics.normalForce - physics.shearForce
        push(scene.model.bonds[joint], geometry, more)
        physics.normalForce = along_line
        physics.shearForce = force - along_line
        physics.kn = area * bond.stiffness

    def _rearm(self, joint, bond):
        """Give a bond that holds the strengths and the rest position of an AdvancedBond."""
        scene = self._scene
        geometry = scene.geometries[joint]
        physics = scene.physics[joint]
        area = float(scene.area[joint])
        tilted = abs(physics.shearForce.norm() - area * abs(bond.shear_stress))
        physics.isCohesive = True
        physics.FnMax = area * bond.strength
        physics.FsMax = max(area * bond.cohesion - 2 * tilted, LEAST)
        physics.initD = geometry.penetrationDepth + bond.opening
        if self.tables.states[joint, GAP] > 0.0:
            self._gaping[joint] = Gaping(geometry, physics, bond.opening <= 0.0)

    def _record(self, rows, bonds):
        """Have the tracker record bonds (rows) after a step; bonds: an AdvancedBond of arrays."""
        scene = self._scene
        tables = self.tables
        area = scene.area[rows]
        scene.normal_stiffness[rows] = area * bonds.stiffness
        opening = np.maximum(bonds.opening, 0.0) * (1 - bonds.stiffness / tables.laws[rows, 0])
        self._tracker.softens(
            rows,
            fracture=float(total(area * bonds.fracture)),
            friction=float(total(area * bonds.friction)),
            opening=opening,
            slip=tables.states[rows, SLIP],
            slid=tables.slid[rows],
        )

    def _turn(self, joint, closed):
        """Give a bond that gapes the stiffness of a closed or of an open one."""
        scene = self._scene
        law = self._law_of(joint)
        geometry, physics, _ = self._gaping[joint]
        kappa, gap = self.tables.states[joint, [KAPPA, GAP]].tolist()
        stiffness = law.normal_stiffness
        if not closed:
            strength, _ = strength_left(False, law, kappa)
            stiffness = tension_stiffness(strength, gap, stiffness)
        physics.kn = float(scene.area[joint] * stiffness)
        scene.normal_stiffness[joint] = physics.kn
        force = physics.kn * (geometry.penetrationDepth - physics.initD) * geometry.normal
        push(scene.model.bonds[joint], geometry, force - physics.normalForce)
        physics.normalForce = force
        self._gaping[joint] = Gaping(geometry, physics, closed)


def _laws(layout):
    """`BondTables.laws` of all joints of a layout."""
    contacts = layout.contacts
    joint = layout.wall.joint
    n_joints = layout.n_joints
    energies = joint.mode_i_fracture_energy or 0.0, joint.mode_ii_fracture_energy or 0.0
    laws = np.column_stack(
        [
            contacts.normal_stiffness[:n_joints],
            contacts.shear_stiffness[:n_joints],
            contacts.tensile_strength[:n_joints],
            contacts.cohesion[:n_joints],
            np.tile(energies, (n_joints, 1)),
        ]
    )
    laws[points_of_cuts(layout), 4:] = layout.wall.brick.fracture_energy or 0.0
    return laws


def push(bond, geometry, force):
    """Add a force [N] at the contact point to a bond's second member, and its opposite to the
    first, before the bodies move."""
    depth = geometry.penetrationDepth
    turn = force.cross(geometry.normal)
    O.forces.addF(bond.id1, -force)
    O.forces.addF(bond.id2, force)
    O.forces.addT(bond.id1, (geometry.refR1 - depth / 2) * turn)
    O.forces.addT(bond.id2, (geometry.refR2 - depth / 2) * turn)
