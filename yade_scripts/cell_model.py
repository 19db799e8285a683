"""Joints between the centres of cells, as before version 0.2: rigid clumps of polyhedral cells, one bond for each pair
of facing cells.

The contact normal is the line between the two cell centres, so that a joint that slides leans.  Kept for one version,
so that results that were cited can be made again; it needs a YADE with polyhedra.
"""

import numpy as np
import yade
from yade import O, log, utils

from damage.errors import InputError
from damage.wall.layout import GROUND, HEAD
from yade_scripts.yade_wall import YadeWall, brick_color, joint_law, set_bond, set_clump

_BOX_FACTOR = 0.97  # a slightly smaller box keeps touching cells out of the narrow phase


def build_cells(layout):
    """Build the model in YADE's empty scene; returns a YadeWall."""
    if layout.wall.brick.splits or layout.wall.joint.compressive_strength:
        raise InputError("--joints centres: its bricks do not split and its joints do not crush; expected --joints "
                         "face where they shall, or leave out their strengths")
    log.setLevel("Polyhedra_support.cpp", 0)  # it warns at every cell of a legitimate shape
    ig2 = yade.Ig2_Polyhedra_Polyhedra_ScGeom(interactionDetectionFactor=1.02)
    ip2 = yade.Ip2_JCFpmMat_JCFpmMat_JCFpmPhys(cohesiveTresholdIteration=1)
    law = joint_law()
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
    members = [[*O.bodies[clump].shape.members] for clump in clumps]
    return YadeWall(layout, clumps, members, bonds, signs, sorted(ground.values()), newton, law)


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
        parts = [_box(cells.left[m], cells.right[m], bottom[index], top[index], thickness, material,
                      brick_color(layout, index)) for m in members]
        clump, member_ids = O.bodies.appendClumped(parts)
        ids[members] = member_ids
        clumps.append(clump)
        set_clump(O.bodies[clump].state, bodies.mass[index], bodies.inertia[index])
    ground = {}
    for member in np.flatnonzero(bodies.course[cells.body] == 0):
        cell = _box(cells.left[member], cells.right[member], -layout.wall.brick.height, 0.0, thickness,
                    material, (0.4, 0.4, 0.4))
        cell.state.blockedDOFs = "xyzXYZ"
        ground[member] = O.bodies.append(cell)
    return ids, clumps, ground


def _bond(layout, index, cells, ground):
    """Bond one pair of facing cells with the area, stiffness and strength of its joint."""
    contacts = layout.contacts
    second = contacts.second_cell[index]
    first = contacts.first_cell[index]
    first_id = ground[second] if first == GROUND else int(cells[first])
    bond = utils.createInteraction(first_id, int(cells[second]))
    # YADE finds the contact of unequal cells with their positions swapped: put it on the face.
    bond.geom.refR1, bond.geom.refR2 = _face_distances(layout, index, bond.id1 == first_id)
    set_bond(bond.phys, layout, index)
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
