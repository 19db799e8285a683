"""The paper's façade walls with one thing changed, for the wall files beside this one."""

from dataclasses import replace
from pathlib import Path

from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies


def paper_wall(name):
    """The wall of walls/NAME.py."""
    return load_wall(Path(__file__).resolve().parents[1] / f"{name}.py")


def symmetric(stiffer=1.0, **changes):
    """walls/symmetric.py with bricks of `stiffer` times the moduli and other values."""
    wall = paper_wall("symmetric")
    brick = replace(
        wall.brick,
        young_modulus=stiffer * wall.brick.young_modulus,
        shear_modulus=stiffer * wall.brick.shear_modulus,
    )
    return replace(wall, brick=brick, **changes)


def softening(name):
    """walls/NAME.py with joints that soften by the rule."""
    wall = paper_wall(name)
    return replace(
        wall, joint=replace(wall.joint, **softening_energies(wall.joint.tensile_strength))
    )


def lighter(name, share):
    """walls/NAME.py with this share of the mass on top, and of its weight; its name says so, as
    symmetric_mass85."""
    wall = paper_wall(name)
    return replace(
        wall, name=f"{name}_mass{round(100 * share)}", precompression=share * wall.precompression
    )
