"""Façade wall with a door front in the middle: two piers of 4.5 bricks, a spandrel of 4 courses.

Sarhosis et al. (2021), Fig. 3b, doi:10.1016/j.engstruct.2021.112529: nominally 4.00 x 2.75 m with
an opening of 2.0 x 2.5 m; built of 18 bricks by 37 courses, the opening 9 bricks by 33 courses.

    yade walls/symmetric.py                   a harmonic motion, 0.2 s, 0.05 g
    yade walls/symmetric.py --record FILE     a recorded ground motion
    yade walls/symmetric.py --help            every option
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))  # YADE does not look here by itself

from damage import Brick, Joint, Opening, Wall


def wall():
    brick = Brick(length=0.225, height=0.075, thickness=0.1025)
    return Wall(
        name="symmetric",
        length=18 * brick.length,
        height=37 * brick.height,
        openings=[
            Opening(left=4.5 * brick.length, width=9 * brick.length, height=33 * brick.height)
        ],
        precompression=0.3e6,
        brick=brick,
        joint=Joint(tensile_strength=0.21e6, cohesion=0.24e6),
        lintel="courses",
    )


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
