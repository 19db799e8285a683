"""A wall of 5 by 8 bricks with a window, for checks that should take seconds.

python3 -m damage reference walls/variants/small.py --harmonic 0.1 0.4 --sequence 1,0.6
yade walls/variants/small.py --harmonic 0.1 0.4 --sequence 1,0.6
"""

import sys
from pathlib import Path

# YADE does not look here by itself, and gives its own program as __file__
sys.path[:0] = [str(Path(path).resolve().parent / "../..") for path in (__file__, sys.argv[0])]

from damage import Brick, Joint, Opening, Wall


def wall():
    brick = Brick(length=0.225, height=0.075, thickness=0.1025)
    return Wall(
        name="small",
        length=5 * brick.length,
        height=8 * brick.height,
        openings=[
            Opening(
                left=1.5 * brick.length,
                width=2 * brick.length,
                height=4 * brick.height,
                sill=2 * brick.height,
            )
        ],
        precompression=0.3e6,
        brick=brick,
        joint=Joint(tensile_strength=0.21e6, cohesion=0.24e6),
        lintel="courses",
    )


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
