"""The symmetric façade wall with 0.85 of the mass on its top (docs/paper/readings.md).

yade walls/variants/symmetric_mass85.py --harmonic 0.2 0.05
"""

import sys
from pathlib import Path

# YADE does not look here by itself, and gives its own program as __file__
sys.path[:0] = [str(Path(path).resolve().parent / "../..") for path in (__file__, sys.argv[0])]

from walls.variants.changed import lighter


def wall():
    return lighter("symmetric", 0.85)


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
