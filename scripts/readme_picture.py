"""The picture at the top of README.md: a cracked wall beside its damage index over time; on the
site's first page it moves.

python3 -m damage reference walls/symmetric.py --harmonic 0.2 0.1 --lintel 2 --rest 1
    --out FILE.h5
python3 scripts/readme_picture.py FILE.h5 docs/pictures/readme.png
python3 -m damage animate FILE.h5 --window 0 0.8 --out docs/pictures/cracking.webp
"""

import io
import sys
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from damage import read_history
from damage.draw import style
from damage.draw.run import draw_wall, joint_handles
from damage.draw.wall import wall_shape

LINES = {"DI": style.BLACK, "DI_drift": style.GREEN, "DI_open": style.ORANGE, "DI_slip": style.BLUE}


SIZE = 8.0, 2.9  # [inch], without the legend
WALL_PT = 290, 190
"""Width and height that the wall fills at most."""


@style.styled
def picture(history, beside, title=None):
    """A Figure of a History's wall at its maximum damage index, beside(axes, time of that [s]) to
    its right."""
    figure = Figure(figsize=SIZE, layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.35, 1))
    shape = wall_shape(history).on_page(WALL_PT)
    draw_wall(left, shape)
    left.set_title(f"at {shape.time_s:.2f} s, displacements × {shape.magnification:g}", fontsize=7)
    beside(right, shape.time_s)
    if title:
        figure.suptitle(title)
    style.legend_below(figure, joint_handles(shape), columns=5)
    return figure


def draw_index(ax, history, at_s):
    """Draw the damage index and its components over time, with a mark at a time [s]."""
    index = history.index()
    for name, colour in LINES.items():
        ax.plot(
            index["time_s"], index[name], color=colour, lw=1.3 if name == "DI" else 0.9, label=name
        )
    ax.axvline(at_s, color=style.MEDIUM, lw=0.8, ls=":")
    ax.set(xlabel="time [s]", ylabel="damage index", ylim=(0, None))
    ax.legend(loc="lower left", bbox_to_anchor=(-0.02, 1), ncols=5, handlelength=1.2)


def save(figure, path):
    """Write a Figure as a small PNG, of 256 colours."""
    whole = io.BytesIO()
    figure.savefig(whole, dpi=130)
    Image.open(whole).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        path, optimize=True
    )


def main(arguments):
    """Draw the picture of a history; returns 0."""
    source, target = arguments
    history = read_history(source)
    save(picture(history, lambda ax, at_s: draw_index(ax, history, at_s)), target)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
