"""The tables of docs/validation/after-the-peak.md: laws of the joint one at a time and together,
beside tested walls.

    python3 -m paper after_peak [--out DIR] [TABLE ...]

TABLE: laws, prediction, cycles, unseen, elsewhere, about 35 minutes on one core; scatter,
consequences, tail, as many again; all by default, in the reference solver.  Histories that are
already in DIR are not run again.
"""

import math
from dataclasses import replace
from functools import partial
from typing import NamedTuple
from unittest import mock

import numpy as np
import pandas as pd

from damage import Joint, Wall, brick_of_masonry
from damage.applications.cracks import capacity
from damage.applications.cracks.pushed import FIGURES, SPECIMENS, read_test
from damage.linear.modes import natural_modes
from damage.measure.energy import DISSIPATED
from damage.measure.pushed import hand_capacities
from damage.measure.summary import summarise
from damage.wall import layout as layouts
from damage.wall.file import load_wall
from damage.wall.kinds import GROUND, HEAD
from damage.wall.layout import lay_out
from damage.wall.materials import MATERIALS
from damage.wall.parameters import ENERGIES, RULE, crushing_energy, softening_energies
from paper.bench import BGAR, FIXED, of_test, print_row, print_table, print_tables, wall_file
from paper.softening import softened, stiffer

SLIDES = ("squat_tested", "comp2_4")
"""The walls whose tests failed in shear; the others rocked."""
FARTHEST = {"squat_tested": 0.3, "comp2_4": 0.3, "comp2_1": 4.0, "comp2_3": 2.0}
"""Walls, and to which drift each is pushed [%]."""
SPEED = {True: 4e-3, False: 2e-2}
"""Speed of the top of a wall that slides, and of one that rocks [m/s]."""
SLIDING = ("0.005,0.01,0.025,0.05,0.1,0.15,0.2,0.25,0.3", 8e-3)
ROCKING_SPEED = 8e-2
CYCLES = {
    "squat_tested": SLIDING,
    "comp2_4": SLIDING,
    "comp2_1": ("0.5,1,2,3,3.5", ROCKING_SPEED),
    "comp2_3": ("0.25,0.5,0.75,1,1.5,2", ROCKING_SPEED),
}
"""Amplitudes [%], one cycle each, and speed [m/s]."""
UNSEEN = ("comp1_1", "comp2_2")
"""Walls of the same tests in whose view nothing was chosen, made and pushed as
docs/guides/tested-wall.md says."""
ELSEWHERE = ("mi1", "mi2", "isp1", "isp3", "abrams_w1", "abrams_w3")
"""Walls of other laboratories, made and pushed likewise."""
BEYOND = 1.4
"""Drift to which a wall that rocks is pushed, over that at which a crushed toe carries no load
[-]."""
ON = 0.6
"""Drift to which a wall is pushed that slides and has kept its force [%]."""
SCATTER = 0.35
"""Coefficient of variation of the joints' strengths."""
ALONG_COURSES = 0.4
"""Correlation of the strengths of neighbouring bed joints of a course (Heffler, Stewart, Masia,
Corrêa 2008)."""
MODULUS = MATERIALS["sarhosis-2021"].young_modulus


class Law(NamedTuple):
    """bond: a case of `softened`; crushes: by the tested strength and the rule for its fracture
    energy; modulus: of the masonry [Pa], None as tested; scatter: coefficient of variation; of:
    function of the wall and what `layouts.scattered` takes, in its place."""

    bond: str = "rule"
    crushes: bool = False
    modulus: float | None = None
    scatter: float = 0.0
    of: object = None


def weaker_heads(wall, contacts, *scatters, share=0.3, usual=layouts.scattered):
    """Contacts whose head joints have 0.3 of the strengths."""
    contacts = usual(contacts, *scatters)
    factor = np.where(contacts.kind == HEAD, share, 1.0)
    return replace(
        contacts,
        tensile_strength=contacts.tensile_strength * factor,
        cohesion=contacts.cohesion * factor,
    )


def along_courses(wall, contacts, scatter, _):
    """Contacts whose strengths are correlated along courses, and independent between them."""
    variation, seed = scatter
    table = pd.DataFrame(
        {
            "first": np.maximum(contacts.first, GROUND),
            "second": contacts.second,
            "x": contacts.x,
            "z": contacts.z.round(4),
            "head": contacts.kind == HEAD,
        }
    )
    number = table.groupby(["first", "second"], sort=False).ngroup()
    joints = table.groupby(number)[["x", "z", "head"]].mean()
    random = np.random.default_rng(seed)
    normal = np.zeros(len(joints))
    for _, rows in joints.groupby(["head", "z"]):
        apart = np.abs(np.subtract.outer(rows.x.to_numpy(), rows.x.to_numpy())) / (
            wall.brick.length / 2
        )
        normal[rows.index] = np.linalg.cholesky(ALONG_COURSES**apart) @ random.standard_normal(
            len(rows)
        )
    spread = np.sqrt(np.log1p(variation**2))
    factor = np.exp(spread * normal - spread**2 / 2)[number]
    return replace(
        contacts,
        **{
            name: np.where(contacts.elastic, np.inf, getattr(wall.joint, name) * factor)
            for name in ("tensile_strength", "cohesion")
        },
    )


LAWS = {
    "rule": Law(),
    "clay strong, 19/353 J/m²": Law("19/353"),
    "head joints at 0.3": Law(of=weaker_heads),
    "strengths scatter by 0.35": Law(scatter=SCATTER),
    "... correlated along courses": Law(scatter=SCATTER, of=along_courses),
    "crushing softens": Law(crushes=True),
}
ROCKING = ("crushing softens",)
"""Laws of walls that rock."""
PREDICTION = Law(crushes=True, modulus=MODULUS, scatter=SCATTER)
SEEDS = (1, 2)


def tested_wall(specimen):
    """The wall of a test by the prediction, from its row in the table of tests alone."""
    row = of_test(specimen)
    cohesion = 1e6 * row["fv0_MPa"]
    halves = round(2 * row["L_m"] / (row["lb_mm"] / 1e3 + 0.010))
    joint = Joint(
        tensile_strength=0.875 * cohesion,
        cohesion=cohesion,
        friction_angle=math.atan(row["mu"]),
        compressive_strength=1e6 * row["fm_c_MPa"],
        **dict.fromkeys(ENERGIES, RULE),
    )
    brick = brick_of_masonry(
        MODULUS,
        joint,
        length=2 * row["L_m"] / halves,
        height=row["H_m"] / row["N courses"],
        thickness=row["t_m"],
    )
    return Wall(
        specimen.lower(),
        row["L_m"],
        row["H_m"],
        precompression=1e6 * row["sigma0_MPa"],
        brick=brick,
        joint=joint,
    )


def toe_drift(wall):
    """Drift [-] at which a crushed toe cannot carry the load on the top: G_c / (precompression x
    length)."""
    return wall.joint.compressive_fracture_energy / (wall.precompression * wall.length)


def wall_by(name, law):
    """The wall of a shipped file by a Law; an unseen one by the prediction."""
    if name in UNSEEN + ELSEWHERE:
        return tested_wall(SPECIMENS[name])
    wall = softened(load_wall(name), law.bond)
    energies = {}
    if law.crushes:
        energies["compressive_strength"] = strength = 1e6 * float(
            of_test(SPECIMENS[name])["fm_c_MPa"]
        )
        energies["compressive_fracture_energy"] = crushing_energy(strength)
    wall = replace(wall, joint=replace(wall.joint, **energies))
    return stiffer(wall, law.modulus) if law.modulus else wall


def run(bench, name, label, law, words, seed=1):
    """The History of a wall by a Law."""
    words = [*words, *held(name)]
    if law.scatter:
        words += ["--strength-cov", law.scatter, "--strength-seed", seed]
    wall = wall_by(name, law)
    scattered = partial(law.of, wall) if law.of else layouts.scattered
    with mock.patch.object(layouts, "scattered", scattered):
        return bench.run(wall, words, name, label)


def held(name):
    """How a wall is held, by the table of tests."""
    return [] if of_test(SPECIMENS[name])["H0_over_H"] == 1 else FIXED


def push_to(farthest, speed):
    """The words of a push to a drift [%]."""
    return ["--pushover", farthest, "--speed", speed]


def push(name):
    """The words of a push of a wall."""
    return push_to(FARTHEST[name], SPEED[name in SLIDES])


HEADS = (
    "wall",
    "law",
    "peak [kN]",
    "test",
    "secant [kN/mm]",
    "test",
    "bilinear [kN]",
    "test",
    "mean force to the test's ultimate drift [kN]",
    "test",
    "left there [kN]",
    "test",
    "ultimate drift [%]",
    "test",
    "friction [J]",
    "fracture [J]",
    "failure (on stairs)",
    "test",
)


def capacity_of(name, history):
    """`capacity.capacity` of a run to the ultimate drift of its test, and the test's figures."""
    tested = read_test(SPECIMENS[name]).figures
    return capacity.capacity(history, tested["ultimate_drift"]), tested


def row(label, name, history):
    """A run beside its test, both as means over the directions of loading."""
    found, tested = capacity_of(name, history)
    lost = history.series[list(DISSIPATED[:2])].iloc[-1]
    cells = []
    for key in ("peak_force_n", "stiffness_n_per_m", "force_n", "mean_force_n", "left_n"):
        cells += [
            "-" if one[key] is None else f"{one[key] / FIGURES[key][2]:.1f}"
            for one in (found, tested)
        ]
    ultimate = 100 * found["ultimate_drift"]
    shares = found["failure"]
    print_row(
        SPECIMENS[name],
        label,
        *cells,
        f"{ultimate:.3f}" if found["ended"] else f"over {ultimate:.2f}",
        f"{100 * tested['ultimate_drift']:.2f}",
        f"{lost.iloc[0]:.0f}",
        f"{lost.iloc[1]:.0f}",
        f"{shares['mode']} ({100 * shares['stair_share']:.0f} %)",
        read_test(SPECIMENS[name]).mode,
    )


def laws(bench):
    """Pushes by one law at a time."""
    print_table(*HEADS)
    for name in FARTHEST:
        for label, law in LAWS.items():
            if (name in SLIDES) != (label in ROCKING):
                row(label, name, run(bench, name, label, law, push(name)))


def draws(bench, name, words):
    """Print a row for each draw of a wall by the prediction."""
    for seed in SEEDS:
        row(f"seed {seed}", name, run(bench, name, "prediction", PREDICTION, words, seed))


def prediction(bench):
    """Pushes by the prediction, with several draws of the strengths."""
    print_table(*HEADS)
    for name in FARTHEST:
        draws(bench, name, push(name))


def cycles(bench):
    """Cycles by the prediction, and of the first wall by the rule."""
    print_table(*HEADS)
    for name, (amplitudes, speed) in CYCLES.items():
        words = ["--cyclic", amplitudes, "--cycles", 1, "--speed", speed]
        for label, law in {
            "prediction": PREDICTION,
            **({"rule": LAWS["rule"]} if name == SLIDES[0] else {}),
        }.items():
            row(label, name, run(bench, name, label, law, words))


def push_unseen(bench, name):
    """The words of a push of a wall of which only the table is known."""
    words = push_to(FARTHEST[SLIDES[0]], SPEED[True])
    history = run(bench, name, "prediction", PREDICTION, words)
    by_hand = hand_capacities(history.masonry_wall, history.loading.boundary)
    if by_hand["rocking"] < min(by_hand["sliding_top"], by_hand["sliding_base"]):
        return push_to(
            f"{100 * BEYOND * toe_drift(tested_wall(SPECIMENS[name])):.3g}", SPEED[False]
        )
    return words if capacity.capacity(history)["ended"] else push_to(ON, SPEED[True])


def drawn(bench, name):
    """Print a row for each of two draws of such a wall; returns the words of its push."""
    words = push_unseen(bench, name)
    draws(bench, name, words)
    return words


def elsewhere(bench):
    """Pushes with two draws of walls of other laboratories by the prediction."""
    print_table(*HEADS)
    for name in ELSEWHERE:
        drawn(bench, name)


def unseen(bench):
    """Pushes with two draws, and cycles, of walls by the prediction in whose view nothing was
    chosen."""
    print_table(*HEADS)
    for name in UNSEEN:
        farthest = float(drawn(bench, name)[1])
        amplitudes = ",".join(
            f"{farthest * share / 6:.3g}" for share in (0.25, 0.5, 1, 2, 3, 4, 5, 6)
        )
        words = ["--cyclic", amplitudes, "--cycles", 1, "--speed", ROCKING_SPEED]
        row("cycles", name, run(bench, name, "prediction", PREDICTION, words))


# --- draws of the strengths -----------------------------------------------------------------------

DRAWS = 32
DRAWN_FAR = 0.26
"""Drift to which walls are pushed with drawn strengths [%]."""
DRAWN_SPEED = 8e-3
"""Speed of these pushes [m/s]."""
DRAWN_STEP = 0.6
"""Share of the critical step of these pushes: four times as fast as `prediction`, whose draws 1 and
2 are the same."""


def scatter(bench):
    """Pushes of the walls that slide by the prediction, over draws of the strengths."""
    print_table(
        "wall",
        "quantity",
        "test",
        "median",
        "5 % quantile",
        "95 % quantile",
        "smallest",
        "largest",
        "draws for the median within 5 %",
    )
    for name in SLIDES:
        wall = wall_by(name, PREDICTION)
        path = wall_file(bench.path(name, "prediction", ending=".toml"), wall)
        step = DRAWN_STEP * natural_modes(lay_out(wall), 1).critical_time_step_s
        histories = bench.together(
            {
                f"{name}_draw_{seed}": [
                    path,
                    "--pushover",
                    DRAWN_FAR,
                    "--speed",
                    DRAWN_SPEED,
                    "--dt",
                    f"{step:.4e}",
                    *held(name),
                    "--strength-cov",
                    SCATTER,
                    "--strength-seed",
                    seed,
                ]
                for seed in range(1, DRAWS + 1)
            }
        )
        draws = [capacity_of(name, history)[0] for history in histories.values()]
        tested = read_test(SPECIMENS[name]).figures
        for label, key, digits in (
            ("peak [kN]", "peak_force_n", 1),
            ("bilinear [kN]", "force_n", 1),
            ("mean force to the test's ultimate drift [kN]", "mean_force_n", 1),
            ("left there [kN]", "left_n", 1),
            ("ultimate drift [%]", "ultimate_drift", 3),
        ):
            unit = FIGURES[key][2]
            values = np.array([draw[key] for draw in draws]) / unit
            shown = [
                tested[key] / unit,
                *np.quantile(values, (0.5, 0.05, 0.95)),
                values.min(),
                values.max(),
            ]
            print_row(
                SPECIMENS[name],
                label,
                *(f"{value:.{digits}f}" for value in shown),
                capacity.draws_needed(values),
            )
        within = [
            [abs(draw[key] / tested[key] - 1) <= 0.15 for draw in draws]
            for key in ("peak_force_n", "force_n", "mean_force_n")
        ]
        for label, hits in (
            ("peak within 15 %", within[0]),
            ("bilinear force within 15 %", within[1]),
            ("mean force within 15 %", within[2]),
            (
                "last to two thirds of the test's drift",
                [draw["ultimate_drift"] > tested["ultimate_drift"] / 1.5 for draw in draws],
            ),
            ("keep 0.8 of the peak to the end", [not draw["ended"] for draw in draws]),
            ("fail on stairs", [draw["failure"]["mode"] == "shear, diagonal" for draw in draws]),
        ):
            print_row(SPECIMENS[name], label, "", f"{sum(hits)} of {DRAWS}", *[""] * 5)


# --- damage ---------------------------------------------------------------------------------------

MEMBERS = 4
RECORD = ["--record", BGAR, "--window", 17.5, 20.5, "--rest", 0.5]
MOTIONS = {
    "0.2 s, 0.05 g": ["--harmonic", 0.2, 0.05, "--rest", 0.5],
    "BGAR x 1": RECORD,
    "BGAR x 2": [*RECORD, "--scale", 2],
    "BGAR x 1, twice": [*RECORD, "--sequence", "1,1"],
}
HARD = ["--harmonic", 0.1, 0.3, "--cycles", 5, "--rest", 0.5]
EQUAL = 1e-3
"""Coefficient of variation of strengths that are as good as equal: chance alone."""
CRUSHES = 6.2e6
"""Strength of COMP1_3's masonry [Pa], the wall by which the paper validates this material."""
JOINTS = {
    "brittle": (False, EQUAL, False),
    "brittle, strengths scatter": (False, SCATTER, False),
    "softening": (True, EQUAL, False),
    "softening, strengths scatter, crushing": (True, SCATTER, True),
}
"""Name -> whether the bond softens, coefficient of variation of the strengths, whether toes crush
and soften."""


def members(bench, name, label, motions, number):
    """{motion: [summary of each member]} of a wall with some of JOINTS; motions: {name: words}."""
    softens, variation, crushes = JOINTS[label]
    wall = load_wall(name)
    changes = softening_energies(wall.joint.tensile_strength) if softens else {}
    if crushes:
        changes |= {
            "compressive_strength": CRUSHES,
            "compressive_fracture_energy": crushing_energy(CRUSHES),
        }
    path = wall_file(
        bench.path(name, label, ending=".toml"), replace(wall, joint=replace(wall.joint, **changes))
    )
    histories = bench.together(
        {
            f"{name}_{label}_{motion}_{seed}": [
                path,
                *words,
                "--strength-cov",
                variation,
                "--strength-seed",
                seed,
            ]
            for motion, words in motions.items()
            for seed in range(1, number + 1)
        }
    )
    found = [summarise(history) for history in histories.values()]
    return {motion: found[k * number : (k + 1) * number] for k, motion in enumerate(motions)}


def measures(found):
    """{name: values of the members} of summaries."""
    return {
        "max DI": [one["max"]["DI"] for one in found],
        "residual DI": [one["residual"]["DI"] for one in found],
        "largest offset [mm]": [one["max_offset_mm"] for one in found],
        "Psi": [one["max_psi"] for one in found],
        "max drift [%]": [100 * one["max_drift_ratio"] for one in found],
    }


def consequences(bench):
    """The symmetric wall shaken, by joint law: medians of members, and their range."""
    print_table("joints", "motion", *measures([]), "crushed [m]", "stand")
    for label in JOINTS:
        for motion, found in members(bench, "symmetric", label, MOTIONS, MEMBERS).items():
            crushed = np.median([one["crushed_length_m"] for one in found])
            standing = sum(one["collapsed_at_s"] is None for one in found)
            print_row(
                label,
                motion,
                *(
                    f"{np.median(of):.2g} ({min(of):.2g} to {max(of):.2g})"
                    for of in measures(found).values()
                ),
                f"{crushed:.2g}",
                f"{standing} of {MEMBERS}",
            )


def tail(bench):
    """The solid wall under a hard motion, equal strengths: quantiles of members."""
    print_table(
        "joints", "quantity", "median", "5 % quantile", "95 % quantile", "smallest", "largest"
    )
    for label in ("brittle", "softening"):
        (found,) = members(bench, "solid", label, {"hard": HARD}, DRAWS).values()
        for name, values in measures(found).items():
            shown = [*np.quantile(values, (0.5, 0.05, 0.95)), min(values), max(values)]
            print_row(label, name, *(f"{value:.2g}" for value in shown))


TABLES = {
    table.__name__: table
    for table in (laws, prediction, cycles, unseen, elsewhere, scatter, consequences, tail)
}


def main():
    print_tables(TABLES, TABLES, "results/after_peak", __doc__)
