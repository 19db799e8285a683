"""The symmetric façade wall with joints that soften: fracture energies by the rule of docs/softening.md.

    yade walls/variants/symmetric_softening.py --harmonic 0.2 0.05
"""

import sys
from dataclasses import replace
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1]))  # YADE does not look here by itself

from damage.wall.file import load_wall
from damage.wall.parameters import softening_energies


def wall():
    symmetric = load_wall(HERE.parent / "symmetric.py")
    joint = symmetric.joint
    return replace(symmetric, joint=replace(joint, **softening_energies(joint.tensile_strength)))


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
