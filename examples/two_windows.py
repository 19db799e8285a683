"""A wall with two windows, shaken by twice the strong phase of the record that ships; prints the
damage index.

    python3 -m examples.two_windows [FOLDER]  # from the repository; the history goes to FOLDER, or
                                              # to results
"""

import sys
from pathlib import Path

import damage
from damage.motion.formats import shipped_record_path
from damage.reference.session import run_reference


def wall():
    """2.7 x 1.5 m with two windows of 0.675 x 0.6 m; this file is a wall file like those in
    walls/."""
    brick = damage.Brick(length=0.225, height=0.075, thickness=0.1025)
    windows = [
        damage.Opening(
            left=left * brick.length,
            width=3 * brick.length,
            height=8 * brick.height,
            sill=6 * brick.height,
        )
        for left in (2, 7)
    ]
    return damage.Wall(
        "two-windows",
        length=12 * brick.length,
        height=20 * brick.height,
        openings=windows,
        precompression=0.3e6,
        brick=brick,
    )


def main(folder):
    """Run, read the history, print; returns the exit status of the run."""
    out = folder / "two_windows.h5"
    status = run_reference(
        [
            __file__,
            "--record",
            str(shipped_record_path("BGAR_HGE")),
            "--window",
            "17",
            "23",
            "--scale",
            "2",
            "--rest",
            "1",
            "--out",
            str(out),
            "--overwrite",
            "--no-pictures",
        ]
    )
    if status == 0:
        index = damage.read_history(out).index()
        print(f"maximum DI {index.DI.max():.3f}, left at the end {index.DI.iloc[-1]:.3f}")
    return status


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if sys.argv[1:] else "results")))
