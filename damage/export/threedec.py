"""A wall as a deck for 3DEC 7 or newer: rigid blocks and the properties of their joints.

3DEC finds by itself which blocks touch, and puts subcontacts at the corners of every overlap, where `--contacts
corners` has contact points, too.  Its joint model `mohr` is this project's brittle law: beyond the peak cohesion and
tensile strength are zero and friction stays, by default.  The deck names every block, and gives the most common joint's
properties to all, then to each pair of blocks that differs its own.

Commands: https://docs.itascacg.com/3dec700 (block create, block contact property, range, Mohr-Coulomb joint model).
"""

import math
from collections import Counter
from typing import NamedTuple

import numpy as np

from damage.export.rigid import check_rigid, made_by, number
from damage.files import write_text
from damage.units import GRAVITY
from damage.wall.kinds import CAP_HEIGHT

NO_STIFFNESS = 1.0
"""Of blocks that touch in 3DEC and not here [Pa/m]."""
_TINY = 1e-6  # [m]
_DECK = """; {made}
; Units: m, kg, s, Pa, degrees; x along the wall, y across it, z up. Not run in 3DEC by those who wrote it.
model new
model large-strain on
{blocks}
{densities}
block contact generate-subcontacts
{joints}
block contact material-table default property {dry}
model gravity 0 0 -{gravity}
block mechanical damping local 0.8
model solve ratio-local 1e-6
"""


class Joint(NamedTuple):
    """What a pair of blocks has: stiffnesses [Pa/m], strengths [Pa], infinite where the joint stays elastic."""

    normal_stiffness: float
    shear_stiffness: float
    tensile_strength: float
    cohesion: float

    @property
    def model(self):
        """3DEC's joint model: one that cannot fail is elastic."""
        return "elastic" if math.isinf(self.cohesion) else "mohr"


def write_3dec(layout, path):
    """Write a damage.wall.layout.Layout of rigid, whole bricks as a deck; returns the path, and warnings, a list.

    Raises InputError for bricks, joints or soil that it cannot have, and where the path cannot be written.
    """
    check_rigid(layout, "--3dec", cuts=False)
    joints, split = _joints(layout)
    brittle = [joint for joint in joints.values() if joint.model == "mohr"]
    usual = Counter(brittle or joints.values()).most_common(1)[0][0]
    own = {pair: joint for pair, joint in joints.items() if joint != usual}
    own |= {pair: Joint(NO_STIFFNESS, NO_STIFFNESS, 0.0, 0.0) for pair in touching(layout) if pair not in joints}
    friction = f"friction {number(math.degrees(layout.wall.joint.friction_angle))}"
    lines = _assigned(usual, None, friction, "")
    for (first, second), joint in own.items():
        lines += _assigned(joint, usual, friction, f" range group-intersection '{_name(first)}' '{_name(second)}'")
    fixed = (f"block fix range group '{_name(-k - 1)}'" for k in range(len(layout.supports)))
    bodies = layout.bodies
    density = bodies.mass / (bodies.length * bodies.height * layout.wall.brick.thickness)
    densities = (f"block property density {number(one)} range group '{_name(k)}'" for k, one in enumerate(density))
    write_text(path, _DECK.format(
        made=made_by(layout), gravity=GRAVITY, joints="\n".join(lines), blocks="\n".join(_blocks(layout)),
        densities="\n".join((*densities, *fixed)),
        dry=_properties(usual._replace(tensile_strength=0.0, cohesion=0.0), friction)))
    return path, [f"--3dec: {split} joints at the end of an elastic lintel are elastic in part, and as a whole in the "
                  "deck"] * (split > 0)


def _name(body):
    """Group of one block: b1, b2, ... of bodies, s1, s2, ... of the ground's supports.

    >>> _name(0), _name(-1)
    ('b1', 's1')
    """
    return f"b{body + 1}" if body >= 0 else f"s{-body}"


def _blocks(layout):
    """Commands that create the bodies and the ground below them."""
    bodies, supports, thickness = layout.bodies, layout.supports, layout.wall.brick.thickness
    half, size = bodies.length / 2, bodies.height / 2
    boxes = [(k, *edges) for k, edges in enumerate(zip(
        bodies.x - half, bodies.x + half, bodies.z - size, bodies.z + size))]
    boxes += [(-k - 1, left, right, -CAP_HEIGHT, 0.0) for k, (left, right) in enumerate(zip(
        supports.left, supports.right))]
    return [f"block create brick {' '.join(map(number, (left, right, 0.0, thickness, bottom, top)))} "
            f"group '{_name(body)}'" for body, left, right, bottom, top in boxes]


def _joints(layout):
    """{(first body, second body): Joint}, and how many of them were elastic in part only; -1, -2, ... is the ground."""
    contacts, found, split = layout.contacts, {}, set()
    for row in zip(contacts.first.tolist(), contacts.second.tolist(), *(getattr(contacts, name) for name in (
            "normal_stiffness", "shear_stiffness", "tensile_strength", "cohesion"))):
        pair, joint = row[:2], Joint(*(float(f"{value:.12g}") for value in row[2:]))
        other = found.setdefault(pair, joint)
        if joint != other:
            split |= {pair}
            found[pair] = max(joint, other, key=lambda one: one.cohesion)
    return found, len(split)


def touching(layout):
    """Pairs of bodies, the lower or left one first, whose faces share a part: the pairs between which 3DEC finds a
    contact."""
    bodies = layout.bodies
    left, right = bodies.x - bodies.length / 2, bodies.x + bodies.length / 2
    bottom, top = bodies.z - bodies.height / 2, bodies.z + bodies.height / 2
    for one in range(len(bodies)):
        for here, there, start, end in ((top[one], bottom, left, right), (right[one], left, bottom, top)):
            shared = np.minimum(end, end[one]) - np.maximum(start, start[one])
            for other in np.flatnonzero((np.abs(there - here) < _TINY) & (shared > _TINY)):
                yield one, int(other)


def _assigned(joint, usual, friction, to):
    """Commands that give joints their model, where the usual joint's, which all have, is another, and properties;
    to: the range."""
    model = [f"block contact jmodel assign {joint.model}{to}"] * (usual is None or joint.model != usual.model)
    return [*model, f"block contact property {_properties(joint, friction)}{to}"]


def _properties(joint, friction):
    stiffnesses = (f"stiffness-normal {number(joint.normal_stiffness)} stiffness-shear "
                   f"{number(joint.shear_stiffness)}")
    return stiffnesses if joint.model == "elastic" else (
        f"{stiffnesses} {friction} cohesion {number(joint.cohesion)} tension {number(joint.tensile_strength)}")
