"""EUCENTRE's squat wall COMP1_3 with what was measured on its own material.

Cohesion 0.21 MPa, friction 0.42, masonry modulus 3256 MPa (Graziotti et al. 2016,
damage/data/eucentre). Not measured, so as in the paper: joint stiffness, and tensile strength over
cohesion (0.21 / 0.24).

    yade walls/squat_tested.py --cyclic 0.025,0.05,0.1,0.2,0.3 --cycles 1
    yade walls/squat_tested.py --help      every option
"""

import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))  # YADE does not look here by itself

from damage import Joint, Wall, brick_of_masonry


def wall():
    joint = Joint(
        tensile_strength=0.21 / 0.24 * 0.21e6, cohesion=0.21e6, friction_angle=math.atan(0.42)
    )
    brick = brick_of_masonry(3256e6, joint, length=0.222, height=0.081, thickness=0.102)
    return Wall(
        name="squat_tested",
        length=18 * brick.length,
        height=34 * brick.height,
        precompression=0.30e6,
        brick=brick,
        joint=joint,
    )


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
