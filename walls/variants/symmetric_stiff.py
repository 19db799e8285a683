"""The symmetric façade wall with stiffer bricks: a first period of 0.174 instead of 0.200 s (docs/paper/readings.md).

    yade walls/variants/symmetric_stiff.py --harmonic 0.2 0.05
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))  # YADE does not look here by itself

from walls.variants.changed import symmetric


def wall():
    return symmetric(stiffer=7.0 / 5.2)


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
