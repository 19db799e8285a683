"""EUCENTRE's clay wall COMP2_3 with what was measured on its own material: COMP2_1 under more load,
flexure and shear.

Clay bricks of 208 x 50 mm with joints of 10 mm, 1.2 x 2.71 x 0.208 m, 0.86 MPa, double fixed
(Graziotti et al. 2016, damage/data/eucentre): cohesion 0.15 MPa, friction 0.55, masonry modulus
9833 MPa. Not measured, so as in Sarhosis et al. (2021): joint stiffness, and tensile strength over
cohesion (0.21 / 0.24).

    yade walls/comp2_3.py --pushover 0.2 --boundary fixed
    yade walls/comp2_3.py --help           every option
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))  # YADE does not look here by itself

from damage import Joint, Wall, brick_of_masonry


def wall():
    joint = Joint(
        tensile_strength=0.21 / 0.24 * 0.15e6, cohesion=0.15e6, friction_angle=math.atan(0.55)
    )
    brick = brick_of_masonry(9833e6, joint, length=0.218, height=2.71 / 45, thickness=0.208)
    return Wall(
        name="comp2_3",
        length=5.5 * brick.length,
        height=45 * brick.height,
        precompression=0.86e6,
        brick=brick,
        joint=joint,
    )


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
