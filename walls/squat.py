"""EUCENTRE's squat wall COMP1_3 with the joints and bricks of the paper that is validated against
it.

Calcium silicate bricks of 212 x 102 x 71 mm with joints of 10 mm, 4.0 x 2.75 m, 0.30 MPa,
cantilever (Graziotti et al. 2016, damage/data/eucentre); joints and moduli of Sarhosis et al.
(2021), Tables 1 and 2.

    yade walls/squat.py --cyclic 0.025,0.05,0.1,0.2,0.3 --cycles 1
    yade walls/squat.py --help             every option
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))  # YADE does not look here by itself

from damage import Brick, Joint, Wall


def wall():
    brick = Brick(length=0.222, height=0.081, thickness=0.102)
    return Wall(
        name="squat",
        length=18 * brick.length,
        height=34 * brick.height,
        precompression=0.30e6,
        brick=brick,
        joint=Joint(tensile_strength=0.21e6, cohesion=0.24e6),
    )


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
