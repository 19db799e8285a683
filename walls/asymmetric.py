"""Façade wall with a door front off the middle: piers of 2.5 and 6.5 bricks, a spandrel of 4
courses.

Sarhosis et al. (2021), Fig. 3c, doi:10.1016/j.engstruct.2021.112529, does not give the opening's
position; the size is that of the symmetric wall.

    yade walls/asymmetric.py                   a harmonic motion, 0.2 s, 0.05 g
    yade walls/asymmetric.py --record FILE     a recorded ground motion
    yade walls/asymmetric.py --help            every option
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))  # YADE does not look here by itself

from damage import Brick, Joint, Opening, Wall


def wall():
    brick = Brick(length=0.225, height=0.075, thickness=0.1025)
    return Wall(
        name="asymmetric",
        length=18 * brick.length,
        height=37 * brick.height,
        openings=[
            Opening(left=2.5 * brick.length, width=9 * brick.length, height=33 * brick.height)
        ],
        precompression=0.3e6,
        brick=brick,
        joint=Joint(tensile_strength=0.21e6, cohesion=0.24e6),
        lintel="courses",
    )


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
