"""A wall as a YADE model: rigid clumps of polyhedral cells, one cohesive-frictional bond for each
pair of facing cells.

The law is YADE's JCFpm (Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM, Scholtès & Donzé 2012,
doi:10.1016/j.ijrmms.2012.03.011) without smooth joints; each bond gets the stiffness, strength and
area of its joint.  The contact normal is the line between the two cell centres.
"""

from dataclasses import dataclass

import numpy as np
import yade
from yade import O, Vector3, log, utils

from damage.wall.joint_law import friction_left, material_of
from damage.wall.layout import GROUND, HEAD

_UNBREAKABLE = 1e300  # [N], strength of joints that stay elastic
_BOX_FACTOR = 0.97  # a slightly smaller box keeps touching cells out of the narrow phase

_BRICK_COLORS = ((0.75, 0.42, 0.32), (0.66, 0.35, 0.27), (0.82, 0.50, 0.38))  # so that bricks tell apart


@dataclass(frozen=True)
class YadeWall:
    """What the solver needs of the model, in the order of the layout.

    clumps: body ids (n_bodies,); bonds: YADE interactions (n_contacts,); signs: +1 where YADE's
    second body is the layout's second (n_contacts,); ground: ids of the fixed cells below the base.
    """

    layout: object
    clumps: list
    bonds: list
    signs: np.ndarray
    ground: list
    newton: object
    law: object


def build(layout, dt):
    """Build the model in YADE's scene, at rest and unloaded, bonded; returns YadeWall."""
    log.setLevel("Polyhedra_support.cpp", 0)  # it warns at every cell of a legitimate shape
    O.reset()
    O.dt = dt
    ig2 = yade.Ig2_Polyhedra_Polyhedra_ScGeom(interactionDetectionFactor=1.02)
    ip2 = yade.Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)
    law = yade.Law2_ScGeom_JCFpmPhys_JointedCohesiveFrictionalPM(neverErase=True, smoothJoint=False, label="jointLaw")
    newton = yade.NewtonIntegrator(damping=0.0, gravity=(0, 0, 0), label="newton")
    collider = yade.InsertionSortCollider([yade.Bo1_Polyhedra_Aabb(aabbEnlargeFactor=_BOX_FACTOR)], verletDist=1e-4)
    O.engines = [yade.ForceResetter(), collider, yade.InteractionLoop([ig2], [ip2], [law]), newton]

    cells, clumps, ground = _add_bodies(layout)
    bonds = [_bond(layout, index, cells, ground) for index in range(len(layout.contacts))]
    signs = np.array([1.0 if _is_second(layout, index, cells, bond) else -1.0
                      for index, bond in enumerate(bonds)])
    # Bonding is over: from here on touching cells must not bond, nor be looked for at a distance.
    ip2.cohesiveTresholdIteration = 0
    ig2.interactionDetectionFactor = 1.0
    return YadeWall(layout, clumps, bonds, signs, sorted(ground.values()), newton, law)


def _material(layout):
    """Material of new contacts between loose bricks: about a bed joint's stiffness, friction only."""
    joint, brick = layout.wall.joint, layout.wall.brick
    return yade.JCFpmMat(young=9.4e9, poisson=0.41, frictionAngle=joint.friction_angle, density=brick.density,
                    tensileStrength=0.0, cohesion=0.0, label="brick")


def _box(left, right, bottom, top, thickness, material, color):
    corners = [(x, y, z) for x in (left, right) for y in (-thickness / 2, thickness / 2) for z in (bottom, top)]
    return utils.polyhedron(corners, material=material, color=color, wire=False)


def _add_bodies(layout):
    """Add clumps of cells and the fixed cells below the base; returns (cell ids, clump ids, ground)."""
    material = O.materials.append(_material(layout))
    material = O.materials[material]
    bodies, cells, thickness = layout.bodies, layout.cells, layout.wall.brick.thickness
    bottom, top = bodies.z - bodies.height / 2, bodies.z + bodies.height / 2
    ids = np.empty(len(cells.body), dtype=int)
    clumps = []
    for index in range(len(bodies)):
        members = np.flatnonzero(cells.body == index)
        color = _BRICK_COLORS[index % len(_BRICK_COLORS)] if bodies.course[index] >= 0 else (0.6, 0.6, 0.6)
        parts = [_box(cells.left[m], cells.right[m], bottom[index], top[index], thickness, material, color)
                 for m in members]
        clump, member_ids = O.bodies.appendClumped(parts)
        ids[members] = member_ids
        clumps.append(clump)
        _set_clump(O.bodies[clump].state, bodies.mass[index], bodies.inertia[index])
    ground = {}
    for member in np.flatnonzero(bodies.course[cells.body] == 0):
        cell = _box(cells.left[member], cells.right[member], -layout.wall.brick.height, 0.0, thickness,
                    material, (0.4, 0.4, 0.4))
        cell.state.blockedDOFs = "xyzXYZ"
        ground[member] = O.bodies.append(cell)
    return ids, clumps, ground


def _set_clump(state, mass, inertia):
    """In-plane motion; YADE sorts a clump's inertia with permuted axes, so all three are I_yy."""
    state.mass = mass
    state.inertia = Vector3(inertia, inertia, inertia)
    state.blockedDOFs = "yXZ"
    state.refPos = state.pos
    state.refOri = state.ori


def _bond(layout, index, cells, ground):
    """Bond one pair of facing cells with the area, stiffness and strength of its joint."""
    contacts, joint = layout.contacts, layout.wall.joint
    second = contacts.second_cell[index]
    first = contacts.first_cell[index]
    first_id = ground[second] if first == GROUND else int(cells[first])
    bond = utils.createInteraction(first_id, int(cells[second]))
    # YADE finds the contact of unequal cells with their positions swapped: put it on the face.
    bond.geom.refR1, bond.geom.refR2 = _face_distances(layout, index, bond.id1 == first_id)
    area = float(contacts.area[index])
    phys = bond.phys
    phys.isCohesive = True
    phys.crossSection = area
    phys.kn = float(contacts.normal_stiffness[index]) * area
    phys.ks = float(contacts.shear_stiffness[index]) * area
    phys.FnMax = min(_UNBREAKABLE, float(contacts.tensile_strength[index]) * area)
    phys.FsMax = min(_UNBREAKABLE, float(contacts.cohesion[index]) * area)
    phys.tanFrictionAngle = friction_left(False, material_of(joint))
    return bond


def _face_distances(layout, index, in_order):
    """Distances of the joint from the centres of the bond's first and second cell [m]."""
    contacts, cells, bodies = layout.contacts, layout.cells, layout.bodies
    first, second = contacts.first_cell[index], contacts.second_cell[index]
    if contacts.kind[index] == HEAD:
        size = [cells.right[cell] - cells.left[cell] for cell in (first, second)]
    else:
        below = layout.wall.brick.height if first == GROUND else bodies.height[cells.body[first]]
        size = [below, bodies.height[cells.body[second]]]
    distances = [float(length) / 2 for length in size]
    return distances if in_order else distances[::-1]


def _is_second(layout, index, cells, bond):
    return bond.id2 == cells[layout.contacts.second_cell[index]]
