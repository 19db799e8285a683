"""The gallery of docs/guides/first-wall.md: texts, commands and pictures, drawn from runs of the
reference solver.

    python3 scripts/gallery.py [NAME ...] [--runs DIR]        # by default all, and results/gallery
"""

import argparse
import shlex
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from textwrap import fill, indent
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage import read_history
from damage.draw import style
from damage.draw.words import run_title
from damage.reference.session import run_reference
from scripts.readme_picture import draw_index, picture, save

PICTURES = ROOT / "docs" / "pictures" / "gallery"
RECORD = "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv"


def index(ax, at_s, history, other):
    """Draw the damage index over time; of another history DI alone."""
    if other is not None:
        ax.plot(
            other.index()["time_s"],
            other.index()["DI"],
            color=style.MEDIUM,
            lw=1.3,
            label="DI, brittle",
        )
    draw_index(ax, history, at_s)


def force(ax, at_s, history, other):
    """Draw base shear against drift ratio, with a mark at a time [s]; of another history in
    grey."""
    if other is not None:
        ax.plot(*pushed(other), color=style.MEDIUM, lw=0.9, label="brittle")
        ax.plot([], [], color=style.BLUE, label="this run")
        ax.legend()
    drift_pct, force_kn = pushed(history)
    ax.plot(drift_pct, force_kn, color=style.BLUE, lw=0.9)
    at = (history.series["time_s"] - at_s).abs().idxmin()
    ax.plot(drift_pct[at], force_kn[at], "o", color=style.BLACK, ms=4)
    ax.set(xlabel="drift ratio [%]", ylabel="base shear [kN]")


def pushed(history):
    """(drift ratio [%], base shear [kN]) of a pushed wall, Series over its samples."""
    moving = history.series[history.series["stage"] == "motion"]
    return 100 * moving["drift_ratio"], moving["base_shear_n"] / 1e3


class Entry(NamedTuple):
    """A run of the gallery: its heading, what to see, and the picture's alternative text; words of
    its command behind `reference`, what is drawn beside the wall, what the picture's title adds to
    wall and motion, and the entry that it is drawn with."""

    heading: str
    see: str
    alt: str
    words: str
    beside: Callable
    adds: str = ""
    other: str | None = None


GALLERY = {
    "harmonic": Entry(
        "Harmonic motion at the wall's period",
        "Both piers rock: bed joints at their feet open by up to 1.1 mm and close again in every"
        " cycle. DI reaches 0.127, of which 0.015 remains.",
        "symmetric wall and its damage index",
        "walls/symmetric.py --harmonic 0.2 0.1 --rest 1",
        index,
    ),
    "softening": Entry(
        "The same motion, softening joints",
        "With fracture energies 36 contact points fail instead of 213. The drift is as large, but"
        " only 0.001 of DI remains. Grey is the brittle wall above.",
        "softening wall and both damage indices",
        "walls/variants/symmetric_softening.py --harmonic 0.2 0.1 --rest 1",
        index,
        ", joints soften",
        "harmonic",
    ),
    "sequence": Entry(
        "Four equal motions",
        "Each motion reaches 0.14 to 0.15 % of drift. Slip adds up from one to the next, and with"
        " it the residual DI, to 0.026.",
        "symmetric wall and its damage index in a sequence",
        "walls/symmetric.py --harmonic 0.2 0.05 --sequence 1,1,1,1 --rest 1",
        index,
    ),
    "recorded": Entry(
        "Recorded motion",
        "Zeerijp 2018, station BGAR, four times as strong. Drift peaks with the strong second of"
        " the record; slip grows for another seven seconds, and most of it remains.",
        "symmetric wall and its damage index in an earthquake",
        f"walls/symmetric.py --record {RECORD} --window 17 27 --scale 4",
        index,
    ),
    "lintel": Entry(
        "Lintel of two courses",
        "The green joints cannot fail. The spandrel's courses above them slide on each other; the"
        " wide pier cracks in stairs, the narrow one opens at its foot only.",
        "asymmetric wall and its damage index",
        "walls/asymmetric.py --harmonic 0.2 0.1 --lintel 2 --rest 1",
        index,
        ", lintel of two courses",
    ),
    "pushover": Entry(
        "Pushover",
        "EUCENTRE's wall COMP2_4 with brittle joints. The top bed joint slides at friction times"
        " load, 94 kN; the test reached 126 kN in one direction and 137 kN in the other,"
        " 132 kN in the mean.",
        "pushed wall, base shear and drift",
        "walls/comp2_4.py --pushover 0.3 --boundary fixed",
        force,
    ),
    "split-and-crush": Entry(
        "The same push, bricks split, joints soften and crush",
        "The peak is 132 kN (test 126 and 137) at 0.03 % of drift. Stairs and split bricks form one"
        " diagonal. Upright cracks at its ends cut off pillars, and the force falls to 25 kN, too"
        " far ([why](../validation/laboratory.md)). Grey: brittle.",
        "pushed wall whose bricks split, base shear and drift",
        "walls/variants/comp2_4_split_and_crush.py --pushover 0.3 --boundary fixed",
        force,
        ", bricks split, joints soften and crush",
        "pushover",
    ),
    "cyclic": Entry(
        "Cyclic push",
        "One cycle each at four drifts. Two diagonals cross, and the loops are wide, with a plateau"
        " that rises from 68 to 77 kN: sliding.",
        "pushed wall, base shear and drift in cycles",
        "walls/squat.py --cyclic 0.025,0.05,0.1,0.2 --cycles 1",
        force,
    ),
}
"""{name of the picture: Entry}."""


def markdown():
    """The runs as Markdown: heading, what to see, command, picture."""
    return "\n\n".join(
        f"### {entry.heading}\n\n{fill(entry.see, 120)}\n\n{_command(entry.words)}\n\n"
        f"![{entry.alt}](../pictures/gallery/{name}.png)"
        for name, entry in GALLERY.items()
    )


def _command(words):
    """A command as an indented block, its longest options on a second line."""
    line = f"python3 -m damage reference {words}"
    return indent(
        line.replace(" --record ", " \\\n    --record ") if len(line) > 110 else line, "    "
    )


def run(name, folder):
    """The History of an entry, run where the folder does not hold it."""
    path = folder / f"{name}.h5"
    if not (path.exists() and read_history(path).complete):
        words = [
            *shlex.split(GALLERY[name].words),
            "--out",
            str(path),
            "--overwrite",
            "--no-pictures",
            "--quiet",
        ]
        if status := run_reference(words):
            raise SystemExit(status)
    return read_history(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"of {', '.join(GALLERY)} (default: all)"
    )
    parser.add_argument("--runs", type=Path, default=ROOT / "results" / "gallery", metavar="DIR")
    asked = parser.parse_args()
    PICTURES.mkdir(exist_ok=True)
    for name in asked.names or GALLERY:
        entry = GALLERY[name]
        history = run(name, asked.runs)
        other = run(entry.other, asked.runs) if entry.other else None
        figure = picture(
            history,
            partial(entry.beside, history=history, other=other),
            run_title(history) + entry.adds,
        )
        path = PICTURES / f"{name}.png"
        save(figure, path)
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
