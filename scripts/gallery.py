"""The pictures of docs/guides/gallery.md: runs its commands by the reference solver and draws a picture of each.

    python3 scripts/gallery.py [NAME ...] [--runs DIR]        # by default all, and results/gallery
"""

import argparse
import shlex
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
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
        ax.plot(other.index()["time_s"], other.index()["DI"], color=style.MEDIUM, lw=1.3, label="DI, brittle")
    draw_index(ax, history, at_s)


def force(ax, at_s, history, other):
    """Draw base shear against drift ratio, with a mark at a time [s]; of another history in grey."""
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
    """A run of the gallery: words of its command behind `reference`, what is drawn beside the wall, what its title adds
    to wall and motion, and the entry that it is drawn with."""

    words: str
    beside: Callable
    adds: str = ""
    other: str | None = None


GALLERY = {
    "harmonic": Entry("walls/symmetric.py --harmonic 0.2 0.1 --rest 1", index),
    "softening": Entry("walls/variants/symmetric_softening.py --harmonic 0.2 0.1 --rest 1", index, ", joints soften",
                       "harmonic"),
    "sequence": Entry("walls/symmetric.py --harmonic 0.2 0.05 --sequence 1,1,1,1 --rest 1", index),
    "recorded": Entry(f"walls/symmetric.py --record {RECORD} --window 17 27 --scale 4", index),
    "lintel": Entry("walls/asymmetric.py --harmonic 0.2 0.1 --lintel 2 --rest 1", index, ", lintel of two courses"),
    "pushover": Entry("walls/comp2_4.py --pushover 0.3 --boundary fixed", force),
    "split-and-crush": Entry("walls/variants/comp2_4_split_and_crush.py --pushover 0.3 --boundary fixed", force,
                             ", bricks split, joints soften and crush", "pushover"),
    "cyclic": Entry("walls/squat.py --cyclic 0.025,0.05,0.1,0.2 --cycles 1", force),
}
"""{name of the picture: Entry}."""


def run(name, folder):
    """The History of an entry, run where the folder does not hold it."""
    path = folder / f"{name}.h5"
    if not (path.exists() and read_history(path).complete):
        words = [*shlex.split(GALLERY[name].words), "--out", str(path), "--overwrite", "--no-pictures", "--quiet"]
        if status := run_reference(words):
            raise SystemExit(status)
    return read_history(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(GALLERY)} (default: all)")
    parser.add_argument("--runs", type=Path, default=ROOT / "results" / "gallery", metavar="DIR")
    asked = parser.parse_args()
    PICTURES.mkdir(exist_ok=True)
    for name in asked.names or GALLERY:
        entry = GALLERY[name]
        history, other = run(name, asked.runs), run(entry.other, asked.runs) if entry.other else None
        figure = picture(history, partial(entry.beside, history=history, other=other), run_title(history) + entry.adds)
        path = PICTURES / f"{name}.png"
        save(figure, path)
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e3:.0f} kB")


if __name__ == "__main__":
    main()
