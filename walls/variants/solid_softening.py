"""The solid wall with joints that soften, by the rule of docs/model/model.md
(docs/paper/thirty-years.md).

    yade walls/variants/solid_softening.py --harmonic 0.2 0.05
"""

import sys
from pathlib import Path

# YADE does not look here by itself, and gives its own program as __file__
sys.path[:0] = [str(Path(path).resolve().parent / "../..") for path in (__file__, sys.argv[0])]

from walls.variants.changed import softening


def wall():
    return softening("solid")


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
