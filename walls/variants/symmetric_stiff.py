"""The symmetric façade wall with bricks a third stiffer: a first period of 0.174 instead of 0.200 s (docs/readings.md).

    yade walls/variants/symmetric_stiff.py --harmonic 0.2 0.05
"""

import sys
from dataclasses import replace
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))  # YADE does not look here by itself

from damage.wall.file import load_wall


def wall():
    symmetric = load_wall(HERE.parent / "symmetric.py")
    stiffer = 7.0e9 / 5.2e9
    brick = replace(symmetric.brick, young_modulus=stiffer * symmetric.brick.young_modulus,
                    shear_modulus=stiffer * symmetric.brick.shear_modulus)
    return replace(symmetric, brick=brick)


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
