"""Dry-joint walls under horizontal body load: the solver against limit analysis and a published
benchmark.

    python3 -m verification.dry_walls [--only NAME ...] [--markdown FILE] [--pictures DIR]
        [--witnesses PYTHON]

PYTHON: an interpreter with the programs of `verification/witnesses.py`, which are put beside.
"""

import argparse
import json
import math
import subprocess
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from damage.draw.style import BRICK_COLOUR, CAP_COLOUR, COLUMN_WIDTH, DARK, MEDIUM, styled
from damage.errors import InputError
from damage.wall.kinds import HEAD
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Opening, Wall
from verification.collapse import (
    LEVELS,
    REACH_M,
    Bracket,
    collapse_multiplier,
    falls_of,
    find_by_falls,
)
from verification.limit_analysis import Collapse, collapse_load

FRICTION = 0.65
BLOCK = Brick(length=0.4, height=0.175, thickness=0.2, density=2000.0)
"""Length, height and friction of Ferris and Tin-Loi (2001); the multiplier depends on neither
thickness nor density."""
STIFF = 1e10
"""Normal stiffness of the joints [Pa/m]: hard enough for the limit of rigid joints
(docs/validation/dry-joints.md)."""
OPTIONS = ModelOptions(lintel="none", contacts="corners")
PUBLISHED = {"benchmark": 0.643, "high": 0.564}
"""Multipliers of walls 1 and 2 of M. C. Ferris, F. Tin-Loi (2001),
doi:10.1016/S0020-7403(99)00111-3, without dilation; the second as HybriDFEM's example quotes it."""
GOVERNS = 0.02
"""Friction governs where 0.05 more or less of its coefficient moves the bound by more than this
part of it."""


@dataclass(frozen=True)
class Result:
    """Results of one wall: the programme's bound; the same at friction +-0.05, as parts of it; the
    bound with smooth head joints; the solver's bracket, and its multiplier by falls; what `ask`
    gives."""

    layout: object
    bound: Collapse
    sensitivity: float
    smooth_heads: float
    solver: Bracket
    by_falls: float | None
    witnesses: dict | None = None

    @property
    def ratio(self):
        """The solver's multiplier over the bound."""
        return self.solver.multiplier / self.bound.multiplier

    @property
    def friction_governs(self):
        return self.sensitivity > GOVERNS

    @property
    def tipping(self):
        """Multiplier at which what falls in the solver tips about the wall's toe by its weight
        alone, None where it does not fall as one body about it."""
        bodies = self.layout.bodies
        motion = self.solver.motion
        falls = np.abs(motion[:, 2]) > 0.5 * np.abs(motion[:, 2]).max()
        x = bodies.x[falls] - self.layout.wall.length
        z = bodies.z[falls]
        mass = bodies.mass[falls]
        turn = motion[falls, 2].mean() * np.column_stack([-z, x])
        if np.abs(motion[falls, :2] - turn).max() > 0.01 * np.abs(turn).max():
            return None
        return np.sum(mass * -x) / np.sum(mass * z)


def make_wall(
    name, blocks, courses, openings=(), base_course="half", *, friction=FRICTION, stiffness=STIFF
):
    """A wall without mortar and top mass, `blocks` long; openings: (first block, blocks, course,
    courses)."""
    size = BLOCK.length, BLOCK.height
    return Wall(
        name,
        blocks * size[0],
        courses * size[1],
        precompression=0.0,
        base_course=base_course,
        openings=tuple(
            Opening(left * size[0], width * size[0], height * size[1], sill * size[1])
            for left, width, sill, height in openings
        ),
        brick=BLOCK,
        joint=Joint(stiffness, 0.4 * stiffness, math.atan(friction), 0.0, 0.0),
    )


WALLS = {
    "benchmark": (5, 6),
    "high": (5, 10),
    "tower": (2, 16, (), "whole"),
    "door": (3, 14, ((1, 1, 0, 12),)),
    "wide-door": (5, 14, ((2, 1, 0, 12),)),
    "two-doors": (7, 12, ((2, 1, 0, 8), (4, 1, 0, 8))),
    "two-windows": (7, 12, ((2, 1, 4, 4), (4, 1, 4, 4))),
    "ferris-3": (4, 11, ((1.5, 1, 3, 5),), "whole"),
    "ferris-4": (5, 11, ((1, 1, 3, 5), (3, 1, 3, 5))),
    "ferris-5": (3, 19, ((1, 1, 3, 5), (1, 1, 11, 5))),
    "ferris-6": (7, 21, tuple((left, 1, sill, 5) for left in (1.5, 4.5) for sill in (4, 12))),
}
"""Arguments of `make_wall` by name.  benchmark, high and ferris-N are walls 1 to 6 of Ferris and
Tin-Loi (2001); the openings of 3 to 6 are as in the examples of HybriDFEM
(github.com/thlgrs/HybriDFEM-4, Legacy/Examples, 6795dce; no licence stated, the bond alone)."""


def lay(name, **options):
    """The Layout of a wall of `WALLS`; options as of `make_wall`."""
    return lay_out(make_wall(name, *WALLS[name], **options), OPTIONS)


def examine(name, **options):
    """Limit analysis and collapse in the solver of a wall of `WALLS`; options of
    `collapse_multiplier`."""
    layout = lay(name)
    bound = collapse_load(layout)
    sides = [collapse_load(layout, FRICTION + change).multiplier for change in (-0.05, 0.05)]
    smooth = np.where(layout.contacts.kind == HEAD, 0.0, FRICTION)
    solver = collapse_multiplier(layout, 1.05 * bound.multiplier, **options)
    return Result(
        layout,
        bound,
        max(abs(side / bound.multiplier - 1) for side in sides),
        collapse_load(layout, smooth).multiplier,
        solver,
        find_by_falls(falls_of(layout, solver.multiplier)),
    )


def ask(python, result):
    """What `verification/witnesses.py` finds of a Result, in another interpreter: {program:
    multiplier}, LMGC90's by falls."""
    bodies = result.layout.bodies
    wall = {
        "friction": FRICTION,
        "thickness": BLOCK.thickness,
        "levels": [level * result.solver.multiplier for level in LEVELS],
        "reach": REACH_M,
        "blocks": np.column_stack([bodies.x, bodies.z, bodies.length, bodies.height]).tolist(),
    }
    script = Path(__file__).with_name("witnesses.py")
    done = subprocess.run([python, script], input=json.dumps(wall), capture_output=True, text=True)
    if done.returncode:
        raise InputError(
            f"{python} {script.name} failed: {done.stderr.splitlines()[-1:]}; install what its"
            " docstring names"
        )
    found = json.loads(done.stdout.splitlines()[-1])
    falls = [(level, np.array(time_s), np.array(x)) for level, time_s, x in found["lmgc90"]]
    return found | {"lmgc90": find_by_falls(falls)}


def table(results):
    """Markdown table of {name: Result}."""
    rows = [
        (
            "| wall | blocks | bound (LP) | at friction ±0.05 | with smooth head joints | solver |"
            " of the bound | by falls | tips by hand | LMGC90, by falls | to the solver |"
            " compas_cra, bound |"
        ),
        "|" + " --- |" * 12,
    ]
    for name, result in results.items():
        note = f", published {PUBLISHED[name]:g}" if name in PUBLISHED else ""
        governs = ": governs" if result.friction_governs else ""
        rows.append(
            f"| {name}{note} | {result.layout.n_bricks} | {result.bound.multiplier:.4f} |"
            f" ±{100 * result.sensitivity:.1f} %{governs} | {result.smooth_heads:.4f} |"
            f" {result.solver.stable:.4f} to {result.solver.unstable:.4f} |"
            f" {100 * result.ratio:.1f} % | {_cell(result.by_falls)} | {_cell(result.tipping)} |"
            + _witnesses(result)
        )
    return "\n".join(rows)


def _witnesses(result):
    """Cells of the witnesses, empty where they were not asked."""
    if not result.witnesses:
        return "  |  |  |"
    lmgc90 = result.witnesses["lmgc90"]
    apart = "" if lmgc90 is None else f"{100 * (lmgc90 / result.solver.multiplier - 1):+z.1f} %"
    return f" {_cell(lmgc90)} | {apart} | {result.witnesses['compas_cra']:.4f} |"


def _cell(multiplier):
    return "" if multiplier is None else f"{multiplier:.4f}"


REACH = 0.12  # of the wall's height: how far the largest displacement is drawn
MOVES = 0.02  # of the largest displacement: bodies that move more are drawn darker


@styled
def save_mechanisms(name, result, folder):
    """Write FOLDER/mechanism_NAME.png of a Result: the mechanism of limit analysis beside that of
    the solver, both magnified, over the wall's outline at rest; its path."""
    layout = result.layout
    wall = result.layout.wall
    height = min(80.0, 8 + 45 * wall.built_height / wall.length) / 25.4
    figure = Figure(figsize=(COLUMN_WIDTH, height), layout="constrained")
    outline = corners(layout, np.zeros_like(result.bound.motion))
    for ax, title, found in zip(
        figure.subplots(1, 2), ("limit analysis", "solver"), (result.bound, result.solver)
    ):
        scale = REACH * wall.built_height / np.abs(corners(layout, found.motion) - outline).max()
        motion = found.motion * scale
        ax.add_collection(
            PolyCollection(outline, facecolors="none", edgecolors=MEDIUM, linewidths=0.3)
        )
        moves = np.abs(motion[:, :2]).max(axis=1) > MOVES * np.abs(motion[:, :2]).max()
        colours = [CAP_COLOUR if move else BRICK_COLOUR for move in moves]
        ax.add_collection(
            PolyCollection(
                corners(layout, motion), facecolors=colours, edgecolors=DARK, linewidths=0.5
            )
        )
        ax.add_line(
            Line2D([-0.05 * wall.length, 1.05 * wall.length], [0, 0], color=DARK, linewidth=1.2)
        )
        ax.set_aspect("equal")
        ax.autoscale_view()
        ax.axis("off")
        ax.set_title(f"{title}: {found.multiplier:.3f}", fontsize=7)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"mechanism_{name}.png"
    figure.savefig(path)
    return path


def corners(layout, motion):
    """Corners (n_bodies, 4, 2) [m] of the bodies, displaced by small motions (n_bodies, 3)."""
    bodies = layout.bodies
    x = bodies.x[:, None] + 0.5 * bodies.length[:, None] * np.array([-1, 1, 1, -1])
    z = bodies.z[:, None] + 0.5 * bodies.height[:, None] * np.array([-1, -1, 1, 1])
    ux, uz, turn = motion.T[:, :, None]
    return np.stack(
        [x + ux - turn * (z - bodies.z[:, None]), z + uz + turn * (x - bodies.x[:, None])], axis=2
    )


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="python3 -m verification.dry_walls", description=__doc__.split("\n")[0]
    )
    parser.add_argument(
        "--only",
        nargs="+",
        choices=WALLS,
        default=list(WALLS),
        metavar="NAME",
        help=f"some of {', '.join(WALLS)}",
    )
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="also write the table there")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="draw the mechanisms there")
    parser.add_argument(
        "--witnesses", metavar="PYTHON", help="interpreter with compas-lmgc90 and compas_cra"
    )
    parser.add_argument(
        "--tolerance",
        type=float,
        default=1e-3,
        metavar="PART",
        help="width of the solver's bracket over the bound (default 0.001)",
    )
    parsed = parser.parse_args(arguments)
    results = {}
    for name in parsed.only:
        results[name] = examine(name, tolerance=parsed.tolerance)
        if parsed.witnesses:
            found = ask(parsed.witnesses, results[name])
            results[name] = replace(results[name], witnesses=found)
        print(
            f"{name}: bound {results[name].bound.multiplier:.4f}, solver"
            f" {results[name].solver.multiplier:.4f}",
            flush=True,
        )
        if parsed.pictures:
            print(save_mechanisms(name, results[name], parsed.pictures))
        if parsed.markdown:
            parsed.markdown.write_text(table(results) + "\n")
    print("\n" + table(results))
    return 0


if __name__ == "__main__":
    sys.exit(main())
