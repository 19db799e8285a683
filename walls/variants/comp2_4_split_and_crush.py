"""EUCENTRE's clay wall COMP2_4 with joints that soften and crush, and bricks that split:
docs/validation/laboratory.md.

Joints crush at the tested compressive strength of the masonry, 11.22 MPa (Graziotti et al. 2016,
damage/data/eucentre). By the rules of docs/model/model.md, since not tested: the bricks' tensile
strength, 0.032 of their normalised compressive strength of 46.8 MPa; fracture energies of joints
and bricks.

    yade walls/variants/comp2_4_split_and_crush.py --pushover 0.3 --boundary fixed
"""

import sys
from dataclasses import replace
from pathlib import Path

# YADE does not look here by itself, and gives its own program as __file__
sys.path[:0] = [str(Path(path).resolve().parent / "../..") for path in (__file__, sys.argv[0])]

from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies


def wall():
    base = load_wall(Path(__file__).resolve().parents[1] / "comp2_4.py")
    energies = softening_energies(base.joint.tensile_strength)
    return replace(
        base,
        brick=replace(base.brick, tensile_strength=1.5e6, fracture_energy="rule"),
        joint=replace(base.joint, **energies, compressive_strength=11.22e6),
    )


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
