"""The paper's façade walls with one thing changed, for the wall files beside this one."""

from dataclasses import replace
from pathlib import Path

from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies


def paper_wall(name):
    """The wall of walls/NAME.py."""
    return load_wall(Path(__file__).resolve().parents[1] / f"{name}.py")


def symmetric(stiffer=1.0, softens=False, **changes):
    """walls/symmetric.py with bricks of `stiffer` times the moduli, joints that soften by the rule, other values."""
    wall = paper_wall("symmetric")
    brick = replace(wall.brick, young_modulus=stiffer * wall.brick.young_modulus,
                    shear_modulus=stiffer * wall.brick.shear_modulus)
    joint = replace(wall.joint, **softening_energies(wall.joint.tensile_strength)) if softens else wall.joint
    return replace(wall, brick=brick, joint=joint, **changes)


def lighter(name, share):
    """walls/NAME.py with this share of the mass on top, and of its weight; its name says so, as symmetric_mass85."""
    wall = paper_wall(name)
    return replace(wall, name=f"{name}_mass{round(100 * share)}", precompression=share * wall.precompression)
