"""What the models for other programs share: what rigid blocks cannot have, the origin of a file, numbers as text."""

from damage.errors import InputError
from damage.provenance import commit
from damage.version import VERSION
from damage.wall.kinds import CUT


def check_rigid(layout, option, *, cuts=True):
    """Raise InputError where a Layout has what rigid blocks on brittle joints lack; cuts: whether bricks and lintels
    may be of glued parts."""
    joint, options = layout.wall.joint, layout.options
    problems = (
        (layout.strain is not None, "deformable bricks with strain modes", "rigid ones; leave --bricks deformable out"),
        (joint.softens, "joints that soften", "brittle ones; take the wall's fracture energies out"),
        (joint.compressive_strength is not None, "joints that crush", "none; take the compressive strength out"),
        (layout.wall.restraints, "restraints of its edges", "free ones; take the restraints out"),
        (options.soil_velocity > 0, "soil with radiation damping", "soil without it; leave --soil-velocity out"),
        (not cuts and (layout.contacts.kind == CUT).any(), "bricks or lintels of glued parts",
         "whole ones: a lintel of courses (--lintel elastic of a wall without beams), no --brick-cells, no brick that "
         "splits; change that"))
    for found, what, expected in problems:
        if found:
            raise InputError(f"{option} of wall {layout.wall.name} with {what}: expected {expected}")


def made_by(layout):
    """One line: the wall, its choices, and what wrote it."""
    return (f"Wall {layout.wall.name} ({', '.join(layout.options.tags()) or 'usual model'}), written by "
            f"masonry-damage {VERSION}, commit {commit()}.")


def number(value):
    """The shortest text of a number that is read back exactly; integers have no point.

    >>> number(0.1), number(3), number(float("inf"))
    ('0.1', '3', 'inf')
    """
    return repr(value.item() if hasattr(value, "item") else value)
