"""Walls of houses: those that ship, one façade under five lintels, two walls in both solvers.

    python3 -m paper houses ships            # modes, a push, BGAR x 1: a row a wall (5 minutes)
    python3 -m paper houses facade           # lintels of an ordinary façade under BGAR x 3 (10
                                             # minutes)
    python3 -m paper houses codes --out DIR  # YADE beside the reference solver under BGAR x 1.5 (an
                                             # hour)

DIR keeps the histories of `codes`; those that are there already are not made again.
"""

from dataclasses import replace
from pathlib import Path

import damage
from damage.applications.cracks.compare import compare
from damage.linear.modes import natural_modes
from damage.measure.summary import summarise
from damage.wall.layout import lay_out
from damage.wall.materials import MATERIALS
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Joint, Opening, Wall
from paper.bench import BGAR, REPOSITORY, Bench, arguments, option, print_row, print_table

SHIPPED = ("terrace_end", "two_storeys", "shop_front", "calcium_silicate")
SHAKEN = {"window": (18.2, 20.2), "scatter": 0.001}
STRONG = (18.7, 19.5)
"""The strongest part of BGAR [s]."""
MEMBERS = 5
IN_YADE = {"terrace_end": (18.2, 20.2), "two_storeys": STRONG}
"""{wall that both solvers run: part of the record [s]}."""
PUSH_PCT = 0.02
FACADE = Wall(
    "facade",
    6.0,
    3.0,
    precompression=0.1e6,
    openings=(
        Opening(1.8, 0.9, 2.025),
        *(Opening(left, 0.675, 1.425, 0.6) for left in (0.675, 3.15, 4.5)),
    ),
    joint=Joint(tensile_strength=0.1e6, cohesion=0.15e6),
    lintel="courses",
)
LINTELS = {  # words: (lintel of the wall, option)
    "all courses elastic": ("courses", "elastic"),
    "one course elastic": ("courses", 1),
    "timber beam": ("timber", "elastic"),
    "concrete beam": ("concrete", "elastic"),
    "flat arch": ("arch", "elastic"),
}
FIGURES = {  # of damage.applications.cracks.compare.TOLERANCES: label, factor, decimals
    "max_drift_ratio": ("maximum drift ratio [%]", 100, 4),
    "peak_base_shear_n": ("peak base shear [kN]", 1e-3, 1),
    "DI": ("maximum DI", 1, 4),
    "cycle_length_s": ("length of the free cycles [s]", 1, 4),
}


def ships():
    """Table of the walls that ship as data."""
    print_table(
        "wall",
        "bricks",
        "first period [s]",
        f"base shear at {PUSH_PCT:g} % [kN]",
        "BGAR x 1: max DI",
        "drift ratio [%]",
        "base shear [kN]",
        "widest crack [mm]",
    )
    for name in SHIPPED:
        path = REPOSITORY / "walls" / f"{name}.toml"
        layout = lay_out(damage.load_wall(path))
        pushed = damage.run(str(path), pushover=PUSH_PCT)
        shaken = summarise(damage.run(str(path), BGAR, rest=0.3, window=STRONG))
        print_row(
            f"`{name}`",
            layout.n_bricks,
            f"{natural_modes(layout).period_s[0]:.4f}",
            f"{pushed.series['base_shear_n'].abs().max() / 1e3:.1f}",
            f"{shaken['max']['DI']:.4f}",
            f"{100 * shaken['max_drift_ratio']:.4f}",
            f"{shaken['peak_base_shear_n'] / 1e3:.1f}",
            f"{shaken['max_crack_width_mm']:.3f}",
        )


def facade(seeds):
    """Table of the façade's lintels: range over so many scatters of the strengths by 0.1 %."""
    print_table(
        "lintel",
        "first period [s]",
        "maximum DI",
        "drift ratio [%]",
        "base shear [kN]",
        "widest crack [mm]",
        "failed contact points",
        "ended",
    )
    for words, (lintel, elastic) in LINTELS.items():
        wall = replace(FACADE, lintel=lintel)
        runs = [
            damage.run(wall, BGAR, scale=3, rest=0.3, lintel=elastic, **SHAKEN, seed=seed)
            for seed in range(1, seeds + 1)
        ]
        found = [summarise(history) for history in runs]
        fell = [one["collapsed_at_s"] for one in found]
        period_s = natural_modes(lay_out(wall, ModelOptions(lintel=elastic))).period_s[0]
        print_row(
            words,
            f"{period_s:.4f}",
            _range([one["max"]["DI"] for one in found], 2),
            _range([100 * one["max_drift_ratio"] for one in found], 3),
            _range([one["peak_base_shear_n"] / 1e3 for one in found], 0),
            _range([one["max_crack_width_mm"] for one in found], 1),
            _range([int(history.broken[-1].sum()) for history in runs], 0),
            "stands" if not any(fell) else f"falls at {_range([one for one in fell if one], 1)} s",
        )


def codes(folder):
    """Table of both solvers on the gable and the two storeys that ship, as `coarse` makes them."""
    bench = Bench(folder)
    print_table(
        "wall", "quantity", "YADE", "reference: median (range)", "allowed difference", "verdict"
    )
    for name, window in IN_YADE.items():
        words = ["--record", BGAR, "--window", *window, "--scale", "1.5", "--rest", "1"]
        result = in_both(bench, coarse(name), words, name)
        for key, (label, factor, digits) in FIGURES.items():
            if row := result["figures"].get(key):
                yade, median, allowed, low, high = (
                    f"{factor * value:.{digits}f}"
                    for value in (row["first"], row["median"], row["allowed"], *row["range"])
                )
                verdict = in_words(row["agrees"])
                print_row(name, label, yade, f"{median} ({low} to {high})", allowed, verdict)
        drift = result["drift"]
        joints = result["joints"]
        print_row(
            name,
            "drift up to the first failure, RMS of the difference",
            "",
            f"{100 * drift['rms_before_failure']:.2f} %",
            f"{100 * drift['allowed']:.2g} %",
            in_words(drift["agrees"]),
        )
        print_row(
            name,
            "contact points failed in either, in both",
            "",
            f"{joints['broke_in_either']}, {joints['broke_in_both']}",
            "",
            "",
        )
        for what in ("broken", "visible"):
            scores = result["patterns"][what]
            if scores["fss"] is not None:
                print_row(
                    name,
                    f"FSS of joints: {what} (shuffled)",
                    "",
                    f"{scores['fss']:.2f} ({scores['shuffled']:.2f})",
                    "0.8",
                    in_words(scores["fss"] >= 0.8),
                )


def in_both(bench, wall, words, name):
    """`compare` of a wall called so in YADE and MEMBERS of the reference solver, whose strengths
    scatter by 0.1 %."""
    return compare(
        bench.run_in_yade(wall, words, name),
        [
            bench.run(wall, [*words, "--scatter", "0.001", "--seed", seed], name)
            for seed in range(1, MEMBERS + 1)
        ],
    )


def in_words(agrees):
    """The verdict of a row."""
    return "holds" if agrees else "DIFFERS"


def coarse(name):
    """A shipped wall that YADE runs in minutes.

    Bricks are twice as long and high, joints brittle with the strengths of clay-strong, lintels of
    concrete: brittle arches of so few bricks fall by the floor's weight, in both solvers.
    """
    wall = damage.load_wall(REPOSITORY / "walls" / f"{name}.toml")
    brick = replace(wall.brick, length=2 * wall.brick.length, height=2 * wall.brick.height)
    strong = MATERIALS["clay-strong"]
    joint = replace(
        wall.joint,
        mode_i_fracture_energy=None,
        mode_ii_fracture_energy=None,
        tensile_strength=strong.tensile_strength,
        cohesion=strong.cohesion,
    )
    return replace(wall, brick=brick, joint=joint, lintel="concrete")


def _range(values, digits):
    low, high = (f"{value:.{digits}f}" for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def main():
    asked = arguments(
        __doc__,
        option("what", choices=("ships", "facade", "codes")),
        option("--seeds", type=int, default=3),
        option("--out", type=Path, default=Path("houses")),
    )
    {"ships": ships, "facade": lambda: facade(asked.seeds), "codes": lambda: codes(asked.out)}[
        asked.what
    ]()
