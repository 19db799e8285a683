"""The symmetric façade wall with one thing changed, for the wall files beside this one."""

from dataclasses import replace
from pathlib import Path

from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies


def symmetric(stiffer=1.0, softens=False, **changes):
    """walls/symmetric.py with bricks of `stiffer` times the moduli, joints that soften by the rule, other values."""
    wall = load_wall(Path(__file__).resolve().parents[1] / "symmetric.py")
    brick = replace(wall.brick, young_modulus=stiffer * wall.brick.young_modulus,
                    shear_modulus=stiffer * wall.brick.shear_modulus)
    joint = replace(wall.joint, **softening_energies(wall.joint.tensile_strength)) if softens else wall.joint
    return replace(wall, brick=brick, joint=joint, **changes)
