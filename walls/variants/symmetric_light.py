"""The symmetric façade wall with 0.12 MPa in its piers: its period is 0.094 s
(docs/paper/published-fragility.md).

    yade walls/variants/symmetric_light.py --harmonic 0.2 0.05
"""

import sys
from pathlib import Path

# YADE does not look here by itself, and gives its own program as __file__
sys.path[:0] = [str(Path(path).resolve().parent / "../..") for path in (__file__, sys.argv[0])]

from walls.variants.changed import symmetric


def wall():
    return symmetric(name="symmetric_light", precompression=0.06e6)


if __name__ == "__main__":
    from yade_scripts.run import main

    main(wall)
