"""The small wall of walls/variants/small.py with joints that soften, by the rule of
docs/model/model.md: for tests.

    yade walls/variants/small_softening.py --harmonic 0.1 0.4 --cycles 1
"""

import sys
from pathlib import Path

# YADE does not look here by itself, and gives its own program as __file__
sys.path[:0] = [str(Path(path).resolve().parent / "../..") for path in (__file__, sys.argv[0])]

from dataclasses import replace

from walls.variants.changed import softening


def wall():
    return replace(softening("variants/small"), name="small_softening")


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
