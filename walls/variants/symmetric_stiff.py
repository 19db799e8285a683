"""The symmetric façade wall with stiffer bricks: a first period of 0.174 instead of 0.200 s
(docs/paper/readings.md).

    yade walls/variants/symmetric_stiff.py --harmonic 0.2 0.05
"""

import sys
from pathlib import Path

# YADE does not look here by itself, and gives its own program as __file__
sys.path[:0] = [str(Path(path).resolve().parent / "../..") for path in (__file__, sys.argv[0])]

from walls.variants.changed import symmetric


def wall():
    return symmetric(stiffer=7.0 / 5.2)


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
