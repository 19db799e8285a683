"""Dry-joint stone walls of a test, pushed at a top fixed against rotation: friction alone, and its
deviation.

    python3 -m verification.lourenco [--markdown FILE] [--picture FILE.png]
    python3 -m verification.lourenco --strengths MPA ...

Walls SW.30 and SW.200 of P. B. Lourenço, D. V. Oliveira, P. Roca, A. Orduña (2005), J. Struct. Eng.
131(11), 1665-1673, doi:10.1061/(ASCE)0733-9445(2005)131:11(1665): 1.0 x 1.0 x 0.2 m, sawn stones
0.2 x 0.1 x 0.2 m, no mortar, a constant vertical load of 30 and 200 kN, two walls each.  Friction
0.62: shear tests of such dry joints, P. B. Lourenço, L. F. Ramos (2004), J. Struct. Eng. 130(5),
779-786, doi:10.1061/(ASCE)0733-9445(2004)130:5(779).
"""

import argparse
import math
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from scipy.optimize import brentq

from damage.draw.style import BLACK, BLUE, COLUMN_WIDTH, MEDIUM, VERMILLION, legend_below, styled
from damage.units import GRAVITY, MILLIMETRE
from damage.wall.kinds import HEAD
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Wall
from verification.collapse import settled_wall
from verification.limit_analysis import collapse_load, top_load

DATA = Path(__file__).with_name("data") / "lourenco2005"
LOADS_N = {"SW.30": 30e3, "SW.200": 200e3}
FRICTION = 0.62
# [m]
LENGTH = 1.0
HEIGHT = 1.0
THICKNESS = 0.2
STONE = Brick(
    length=0.2,
    height=0.1,
    thickness=THICKNESS,
    density=2500.0,
    young_modulus=15.5e9,
    shear_modulus=15.5e9 / 2.4,
)
"""E = 15.5 GPa, Poisson's ratio 0.2: the stone of the tests.  The density is assumed: the top
course, all that it adds to the load on the weakest joint, weighs 1.6 % of 30 kN."""
STIFFNESS = 5e9
"""Normal stiffness of the dry joints [Pa/m], set to the first slope of the measured curves; in
shear 0.4 of it."""
CRUSHING = 57.1e6
"""Compressive strength of prisms of the same stone [Pa], from the same tests."""
SPLITTING = 3e6
"""Tensile strength of the stone [Pa], assumed: a twentieth of the compressive one, at the low end
of what is usual for sandstone; docs/validation/dry-joints.md varies it."""
PUSH_M_S = 2e-3
FARTHEST_M = 0.025
AVERAGED_M = 0.25e-3
FAR_M = 0.02
"""Displacement at which a force after the peak is read."""
SPLITTING_PUSH_M_S = 5e-3
"""Stiff cuts make the time step four times shorter; at 0.002 m/s the peak of SW.200 is 0.5 %
lower."""


def measured(name):
    """Both tests of a wall: list of DataFrames with displacement_m and force_n."""
    paths = sorted(DATA.glob(f"FD_{name.replace('.', '')}[12]_*.csv"))
    tables = [
        pd.read_csv(
            path,
            skiprows=4,
            usecols=[0, 1],
            names=["displacement_m", "force_n"],
            encoding="latin-1",
        )
        for path in paths
    ]
    return [table.dropna() * [1e-3, 1e3] for table in tables]


def measured_peak(name):
    """Mean of both tests' largest forces [N]."""
    return float(np.mean([test.force_n.max() for test in measured(name)]))


def measured_far(name):
    """Mean of both tests' forces at `FAR_M` [N]."""
    return float(
        np.mean(
            [
                far_force(*test[["displacement_m", "force_n"]].to_numpy().T)
                for test in measured(name)
            ]
        )
    )


def far_force(displacement, force):
    """Mean force within 1 mm of `FAR_M` [N]; displacement [m], force [N]: (n,) each."""
    return float(force[np.abs(displacement - FAR_M) < 1e-3].mean())


def lay(name, *, friction=FRICTION, stiffness=STIFFNESS, base_course="half", cells=4, stone=STONE):
    """The Layout of a wall; its load is a rigid beam on top, glued to the top course."""
    wall = Wall(
        name.replace(".", ""),
        LENGTH,
        HEIGHT,
        precompression=LOADS_N[name] / (LENGTH * THICKNESS),
        base_course=base_course,
        brick=stone,
        joint=Joint(stiffness, 0.4 * stiffness, math.atan(friction), 0.0, 0.0),
    )
    return lay_out(wall, ModelOptions(lintel="none", contacts="corners", top="beam", cells=cells))


def lay_splitting(name, strength=SPLITTING, **options):
    """A wall whose stones split in the middle at their tensile strength [Pa], in bending and in
    diagonal tension."""
    return lay(name, stone=replace(STONE, tensile_strength=strength), **options)


# --- by hand and by limit analysis ----------------------------------------------------------------


def sliding_by_hand(name):
    """Friction times what lies on the joint below the top course, the weakest of all [N]."""
    course = STONE.density * GRAVITY * LENGTH * STONE.height * THICKNESS
    return FRICTION * (LOADS_N[name] + course)


def toe_length(layout):
    """Shortest toe that carries load and weight at the stone's strength [m]."""
    return layout.total_mass * GRAVITY / (CRUSHING * THICKNESS)


def bound(layout, **options):
    """The largest force at the top [N], kept from rotating unless `held` says otherwise; options of
    `collapse_load`."""
    return collapse_load(
        layout, load=top_load(layout), **{"held": layout.pushed_bodies, **options}
    ).multiplier


def crushing_needed(layout, force):
    """The strength at which crushing alone brings the bound down to a force [Pa]."""
    mean = layout.total_mass * GRAVITY / (LENGTH * THICKNESS)
    return brentq(
        lambda strength: bound(layout, crushing=strength) - force,
        1.05 * mean,
        50 * mean,
        xtol=1e-3 * mean,
    )


# --- the solver -----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Push:
    """displacement of the top [m], its force [N], largest `stone_tension` [Pa]: (n,) each."""

    displacement: np.ndarray
    force: np.ndarray
    tension: np.ndarray

    @property
    def peak(self):
        """The largest force [N]."""
        return float(self.force.max())

    def tension_at(self, force):
        """Tension when the force is first reached [Pa]; NaN where it never is."""
        reached = np.flatnonzero(self.force >= force)
        return float(self.tension[reached[0]]) if len(reached) else math.nan


def push(layout, *, speed=PUSH_M_S, farthest=FARTHEST_M, top=None):
    """Push the top at `speed` [m/s] without letting it rotate, or on a rotational spring, top [N
    m/rad].

    A value of the curve is the mean of samples, 1 ms apart, over `AVERAGED_M`: blocks that slide
    rattle.
    """
    wall = settled_wall(layout)
    caps = layout.pushed_bodies
    steps = max(1, round(1e-3 / wall.time_step))
    averaged = max(1, round(AVERAGED_M / speed / (steps * wall.time_step)))
    wall.start(np.zeros((0, 2)))
    wall.hold(caps, top is None, top or 0.0)
    wall.push(speed)
    start = wall.displacement[caps, 0].mean()
    rows = [(0.0, 0.0, 0.0)]
    samples = []
    while rows[-1][0] < farthest:
        wall.run(steps)
        samples.append((wall.displacement[caps, 0].mean() - start, wall.push_force()))
        if len(samples) == averaged:
            rows.append((*np.mean(samples, axis=0), stone_tension(wall).max(initial=0.0)))
            samples = []
    return Push(*np.array(rows).T)


def stone_tension(wall):
    """Tension in the middle section of each whole stone [Pa], by beam theory: (n_stones,).

    The larger of that at its edge, N / A + |M| / W, and the diagonal one in its middle, from N / A
    and
    1.5 |V| / A.  The stone's vertical compression, which helps against the latter, is left out.
    """
    bodies = wall.layout.bodies
    stones = np.flatnonzero((bodies.course >= 0) & (bodies.length > STONE.length - 1e-6))
    area = STONE.height * THICKNESS
    modulus = STONE.height**2 * THICKNESS / 6
    push, shear, moment = (
        np.array([_on_left_half(wall, stone) for stone in stones]).reshape(-1, 3).T
    )
    along = -push / area
    across = 1.5 * shear / area
    return np.maximum(along + np.abs(moment) / modulus, along / 2 + np.hypot(along / 2, across))


def _on_left_half(wall, stone):
    """Forces along x and z [N] and moment about the stone's centre [N m] of contacts and weight on
    its left half."""
    layout = wall.layout
    bodies = layout.bodies
    contacts = layout.contacts
    stresses = wall.stresses
    half = GRAVITY * bodies.mass[stone] / 2
    total = np.array([0.0, -half, half * bodies.length[stone] / 4])
    for side, sign in (("first", 1.0), ("second", -1.0)):
        mine = np.flatnonzero(getattr(contacts, side) == stone)
        away = contacts.x[mine] - bodies.x[stone]
        # of two points in the middle the first is at the end of the left cell
        in_the_middle = np.abs(away) < 1e-6
        is_left = np.where(in_the_middle, np.cumsum(in_the_middle) % 2 == 1, away < 0)
        mine = mine[is_left]
        normal, shear = (sign * stress[mine] * contacts.area[mine] for stress in stresses)
        head = contacts.kind[mine] == HEAD
        fx = np.where(head, normal, shear)
        fz = np.where(head, shear, normal)
        moment = (contacts.x[mine] - bodies.x[stone]) * fz - (
            contacts.z[mine] - bodies.z[stone]
        ) * fx
        total += fx.sum(), fz.sum(), moment.sum()
    return total


# --- the command ----------------------------------------------------------------------------------


def examine(name):
    """Push of the wall of rigid stones, and of the one whose stones split: (Push, Push)."""
    return push(lay(name)), push(lay_splitting(name), speed=SPLITTING_PUSH_M_S)


def table(pushes):
    """Markdown table of {name: (rigid, splitting)}."""
    rows = [["", *pushes]]
    for what, value in (
        (
            "measured, two walls [kN]",
            lambda name, *_: " and ".join(
                f"{test.force_n.max() / 1e3:.1f}" for test in measured(name)
            ),
        ),
        (
            "friction on the weakest bed joint, by hand [kN]",
            lambda name, *_: f"{sliding_by_hand(name) / 1e3:.1f}",
        ),
        ("bound by limit analysis [kN]", lambda name, *_: f"{bound(lay(name)) / 1e3:.1f}"),
        (
            "... with a top that is free to rotate [kN]",
            lambda name, *_: f"{bound(lay(name), held=()) / 1e3:.1f}",
        ),
        ("solver, rigid stones [kN]", lambda name, rigid, _: f"{rigid.peak / 1e3:.1f}"),
        ("... over the mean of the measured", lambda name, rigid, _: _ratio(rigid.peak, name)),
        (
            f"bound, stones crush at {CRUSHING / 1e6:g} MPa [kN]",
            lambda name, *_: f"{bound(lay(name), crushing=CRUSHING) / 1e3:.1f}",
        ),
        (
            "tension in a stone at the measured or own peak [MPa]",
            lambda name, rigid, _: (
                f"{rigid.tension_at(min(measured_peak(name), rigid.peak)) / 1e6:.1f}"
            ),
        ),
        (
            f"solver, stones split at {SPLITTING / 1e6:g} MPa [kN]",
            lambda name, _, split: f"{split.peak / 1e3:.1f}",
        ),
        ("... over the mean of the measured", lambda name, _, split: _ratio(split.peak, name)),
        (
            "... at the end of the push [kN]",
            lambda name, _, split: f"{split.force[-20:].mean() / 1e3:.1f}",
        ),
    ):
        rows.append([what, *(value(name, *both) for name, both in pushes.items())])
    rows.insert(1, ["---"] * len(rows[0]))
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def _ratio(force, name):
    return f"{100 * (force / measured_peak(name) - 1):+.1f} %"


@styled
def draw(pushes):
    """Figure of {name: (Push of rigid stones, Push of stones that split)} beside tests and limit
    analysis, a panel for each wall."""
    figure = Figure(figsize=(COLUMN_WIDTH, 1.15 * COLUMN_WIDTH), layout="constrained")
    axes = figure.subplots(len(pushes), 1, sharex=True)
    for ax, (name, (rigid, split)) in zip(axes, pushes.items()):
        for test, line, label in zip(measured(name), ("-", "--"), ("first test", "second test")):
            ax.plot(
                test.displacement_m / MILLIMETRE,
                test.force_n / 1e3,
                line,
                color=MEDIUM,
                label=label,
            )
        ax.axhline(
            bound(lay(name)) / 1e3, color=BLACK, linestyle=":", label="limit analysis, rigid stones"
        )
        for done, colour, line, label in (
            (rigid, BLUE, "-", "solver, rigid stones"),
            (split, VERMILLION, "-.", f"solver, stones split at {SPLITTING / 1e6:g} MPa"),
        ):
            ax.plot(
                done.displacement / MILLIMETRE, done.force / 1e3, line, color=colour, label=label
            )
        ax.set_ylabel("horizontal force [kN]")
        ax.set_ylim(bottom=0)
        ax.set_title(f"{name}: {LOADS_N[name] / 1e3:g} kN on top", fontsize=7, loc="left")
    axes[-1].set_xlabel("displacement of the top [mm]")
    legend_below(figure, axes[0].get_legend_handles_labels()[0], 2)
    return figure


def vary(strengths):
    """Print the peaks of both walls whose stones split at these tensile strengths [MPa]; the exit
    status."""
    print(
        "| tensile strength [MPa] | wall | peak [kN] | over the measured | at 10 and 20 mm [kN] |"
    )
    print("| --- " * 5 + "|")
    for strength in strengths:
        for name in LOADS_N:
            done = push(lay_splitting(name, 1e6 * strength), speed=SPLITTING_PUSH_M_S)
            later = [
                done.force[np.abs(done.displacement - far) < 1e-3].mean() / 1e3
                for far in (0.01, 0.02)
            ]
            print(
                f"| {strength:g} | {name} | {done.peak / 1e3:.1f} | {_ratio(done.peak, name)} | "
                f"{later[0]:.0f}, {later[1]:.0f} |",
                flush=True,
            )
    return 0


def vary_top(stiffnesses):
    """Print the peaks of both walls whose tops are on rotational springs of these stiffnesses [N
    m/rad], inf for tops that are held, and their forces at `FAR_M`; the exit status."""
    heads = (
        "spring at the top [N m/rad]",
        "wall",
        "peak [kN]",
        "test",
        "over the test",
        "at 20 mm [kN]",
        "test",
        "over it at 20 mm",
    )
    print("| " + " | ".join(heads) + " |")
    print("| --- " * 8 + "|")
    for stiffness in stiffnesses:
        for name in LOADS_N:
            done = push(lay(name), top=stiffness if math.isfinite(stiffness) else None)
            far = far_force(done.displacement, done.force)
            tested = measured_far(name)
            print(
                f"| {stiffness:g} | {name} | {done.peak / 1e3:.1f} |"
                f" {measured_peak(name) / 1e3:.1f} | {_ratio(done.peak, name)} | {far / 1e3:.1f} |"
                f" {tested / 1e3:.1f} | {100 * (far / tested - 1):+.1f} % |",
                flush=True,
            )
    return 0


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="python3 -m verification.lourenco", description=__doc__.split("\n")[0]
    )
    parser.add_argument("--markdown", type=Path, metavar="FILE", help="also write the table there")
    parser.add_argument(
        "--picture", type=Path, metavar="FILE", help="draw force against displacement there"
    )
    parser.add_argument(
        "--strengths",
        nargs="+",
        type=float,
        metavar="MPA",
        help="print the peaks of walls whose stones split at these tensile strengths instead",
    )
    parser.add_argument(
        "--top-rotations",
        nargs="+",
        type=float,
        metavar="N_M_RAD",
        help=(
            "print peaks, and forces at 20 mm, of walls with tops on rotational springs of these "
            "stiffnesses instead; inf: held"
        ),
    )
    parsed = parser.parse_args(arguments)
    if parsed.top_rotations:
        return vary_top(parsed.top_rotations)
    if parsed.strengths:
        return vary(parsed.strengths)
    pushes = {}
    for name in LOADS_N:
        pushes[name] = examine(name)
        print(f"{name}: {pushes[name][0].peak / 1e3:.1f} kN", flush=True)
    print("\n" + table(pushes))
    layout = lay("SW.200")
    print(
        f"\nSW.200: the shortest toe is {1e3 * toe_length(layout):.0f} mm; crushing alone would"
        f" explain the peak at {crushing_needed(layout, measured_peak('SW.200')) / 1e6:.2f} MPa"
    )
    if parsed.markdown:
        parsed.markdown.write_text(table(pushes) + "\n")
    if parsed.picture:
        draw(pushes).savefig(parsed.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())
