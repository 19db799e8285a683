"""The picture at the top of README.md: a cracked wall beside its damage index over time.

    python3 -m damage reference walls/symmetric.py --harmonic 0.2 0.1 --lintel 2 --rest 1 --out FILE.h5
    python3 scripts/readme_picture.py FILE.h5 docs/pictures/readme.png
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from damage import read_history
from damage.draw import style
from damage.draw.run import draw_wall, joint_handles
from damage.draw.wall import wall_shape

LINES = {"DI": style.BLACK, "DI_drift": style.GREEN, "DI_open": style.ORANGE, "DI_slip": style.BLUE}


@style.styled
def picture(history):
    """A Figure of the wall at its maximum damage index and of the index over time."""
    figure = Figure(figsize=(8.0, 3.0), layout="constrained")
    wall, time = figure.subplots(1, 2, width_ratios=(1.35, 1))
    shape, index = wall_shape(history), history.index()
    draw_wall(wall, shape)
    wall.legend(handles=joint_handles(shape), loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=4, frameon=False,
                fontsize=6)
    worst = index["time_s"][index["DI"].idxmax()]
    wall.set_title(f"at {worst:.2f} s, displacements x {shape.magnification:g}")
    for name, colour in LINES.items():
        time.plot(index["time_s"], index[name], color=colour, lw=1.3 if name == "DI" else 0.9, label=name)
    time.axvline(worst, color=style.MEDIUM, lw=0.8, ls=":")
    time.set(xlabel="time [s]", ylabel="damage index", title="damage index over time", ylim=(0, None))
    time.legend(frameon=False, fontsize=7)
    return figure


def main(arguments):
    """Draw the picture of a history; returns 0."""
    source, target = arguments
    picture(read_history(source)).savefig(target, dpi=140)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
