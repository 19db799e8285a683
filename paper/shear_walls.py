"""The table docs/tables/walls_elsewhere_prediction.csv: tested shear walls by the rules of
docs/guides/tested-wall.md, sealed before their results were seen.

    python3 -m paper shear_walls INPUTS.csv [--out DIR] [WALL ...]

INPUTS has a row a wall, with the columns that `wall_of` reads; damage/data/eucentre/tests.csv has
others, which are renamed.  Medians of pushes of DRAWS; the table in DIR grows by each wall that is
done, at some 100 s of one core.  A shear span that no boundary gives leaves all but the hand
formulas empty.
"""

import re
from dataclasses import replace
from math import atan, sqrt
from pathlib import Path
from statistics import median, mode
from unittest.mock import patch

import numpy as np
import pandas as pd

from damage import Joint, Wall, brick_of_masonry
from damage.applications.cracks.capacity import capacity
from damage.measure.pushed import first_loading
from damage.run import prepare
from damage.wall.kinds import HEAD
from damage.wall.parameters import ENERGIES, RULE, nearest
from paper.bench import Bench, arguments, option, wall_file

SHARES = {
    ("clay", True): 0.030,
    ("clay", False): 0.040,
    ("calcium silicate", True): 0.035,
    ("calcium silicate", False): 0.063,
}
"""Mean tensile strength along units, over their strength across the bed joints, by material and
whether they are perforated: JCSS Probabilistic Model Code, part 3."""
LEAST = 2 / 3
"""5 % quantile over the mean of a strength that scatters by 24 %, log-normally."""
OF_MASONRY = 0.12
"""Tensile strength of units over the compressive strength of masonry, by the other candidate."""
DRAWS = 1, 2
BOUNDARIES = {0.5: "fixed", 1.0: "cantilever"}
"""Shear span over height, and the boundary that gives it."""
FRICTION = 0.42
"""Coefficient where none was tested: that of EUCENTRE's joints of calcium silicate."""
POCKET = 0.4
"""Share of a head joint that a mortar pocket fills, at least (EN 1996-1-1, 8.1.5)."""
CRACKED = 0.5
"""Share of the modulus that cracked walls have (EN 1998-1, 4.3.1); it is 1000 f_k where it was not
tested (EN 1996-1-1, 3.7.2), with f_k = f_c / 1.2 (EN 1052-1)."""
SLIDES = ["--pushover", 0.3, "--speed", 0.004]
BEYOND = 1.4
"""How far a wall that rocks is pushed, in drifts at which a crushed toe carries no load."""


def read_inputs(path):
    """The rows of a file of inputs."""
    table = pd.read_csv(path)
    if "Specimen" not in table:
        return list(table.itertuples())
    names = {
        "Specimen": "wall",
        "N courses": "courses",
        "H_m": "height_m",
        "L_m": "length_m",
        "t_m": "thickness_m",
        "Void": "void_ratio",
        "fb_perp_MPa": "unit_strength_vertical_mpa",
        "fm_c_MPa": "compressive_strength_mpa",
        "fv0_MPa": "cohesion_mpa",
        "mu": "friction",
        "H0_over_H": "h0_over_h",
        "sigma0_MPa": "precompression_mpa",
    }
    table = table.rename(columns=names)
    # Half of it is taken, for all walls, as in docs/validation/after-the-peak.md.
    table["masonry_modulus_tested_gpa"] = 9.8
    table["unit_length_m"] = table["lb_mm"] / 1e3
    table["unit_type"] = np.where(table["Unit type"] == "SB-CS", "calcium silicate", "solid clay")
    return list(table.itertuples())


def voids(row):
    """Void ratio of the units [-], the middle of a range in per cent; 0 of solid ones."""
    given = [float(number) for number in re.findall(r"[\d.]+", str(row.void_ratio))]
    return np.mean(given or [0.0]) / (100 if "%" in str(row.void_ratio) else 1)


def strengths(row):
    """{name of a rule: tensile strength of the units [Pa], None where they do not split}."""
    material = "clay" if "clay" in row.unit_type else row.unit_type
    usual = SHARES[material, voids(row) > 0] * 1e6 * row.unit_strength_vertical_mpa
    other = OF_MASONRY * 1e6 * row.compressive_strength_mpa
    return {"": usual, "least_": LEAST * usual, "most_": None, "other_": other}


def wall_of(row, strength):
    """The wall of a row of the inputs, whose units have this tensile strength [Pa]."""
    cohesion = 1e6 * row.cohesion_mpa
    joint = Joint(
        tensile_strength=0.875 * cohesion,
        cohesion=cohesion,
        friction_angle=atan(friction_of(row)),
        compressive_strength=1e6 * row.compressive_strength_mpa,
        **dict.fromkeys(ENERGIES, RULE),
    )
    tested = row.masonry_modulus_tested_gpa
    shear = getattr(row, "masonry_shear_modulus_tested_gpa", np.nan) / tested
    brick = brick_of_masonry(
        CRACKED * 1e9 * (row.compressive_strength_mpa / 1.2 if np.isnan(tested) else tested),
        joint,
        shear_ratio=0.4 if np.isnan(shear) else shear,
        length=2 * row.length_m / nearest(2 * row.length_m / (row.unit_length_m + 0.01)),
        height=row.height_m / row.courses,
        thickness=row.thickness_m,
        density=1900 * (1 - voids(row)),
        tensile_strength=strength,
        fracture_energy=strength and RULE,
    )
    name = re.sub(r"\W", "_", row.wall.lower())
    return Wall(
        name,
        row.length_m,
        row.height_m,
        precompression=1e6 * row.precompression_mpa,
        brick=brick,
        joint=joint,
    )


def friction_of(row):
    return FRICTION if np.isnan(row.friction) else row.friction


def by_hand(row):
    """{formula: force [kN]}: rocking about a crushed toe (EN 1998-3); friction; stepped cracks
    through joints or units (Mann and Müller); diagonal tension (Turnšek and Čačovič), with 0.0345
    f_c of the masonry and with its diagonal tensile strength where that was tested."""
    stress = row.precompression_mpa
    friction = friction_of(row)
    area = 1e3 * row.length_m * row.thickness_m
    span = row.h0_over_h * row.height_m
    sheared = area / np.clip(row.height_m / row.length_m, 1.0, 1.5)
    slope = 2 * friction * row.height_m / row.courses / (row.unit_length_m + 0.01)
    unit = strengths(row)[""] / 1e6
    crushed = 1 - stress / (0.85 * row.compressive_strength_mpa)
    tensions = {
        "turnsek_cacovic": 0.0345 * row.compressive_strength_mpa,
        "turnsek_cacovic_tested": getattr(row, "diagonal_tensile_strength_mpa", np.nan),
    }
    return {
        "rocking_kn": area * stress * row.length_m / (2 * span) * crushed,
        "sliding_kn": area * friction * stress,
        "mann_mueller_joints_kn": sheared * (row.cohesion_mpa + friction * stress) / (1 + slope),
        "mann_mueller_units_kn": sheared * unit / 2.3 * sqrt(1 + stress / unit),
        **{f"{name}_kn": sheared * f * sqrt(1 + stress / f) for name, f in tensions.items()},
    }


def push_of(row, wall):
    """The words of a push: where rocking is the least force by hand, up to the end of the toes."""
    words = [*SLIDES, "--boundary", BOUNDARIES[row.h0_over_h], "--strength-cov", 0.35]
    hand = by_hand(row)
    if hand["rocking_kn"] <= np.nanmin(list(hand.values())):
        end = wall.joint.compressive_fracture_energy / (wall.precompression * wall.length)
        words[1:4:2] = f"{max(0.3, 100 * BEYOND * end):.3g}", 0.02
    return words


def pockets(lay_out):
    """A function as `lay_out` whose head joints have the strengths of mortar pockets."""

    def lay_out_with_pockets(*given, **options):
        layout = lay_out(*given, **options)
        contacts = layout.contacts
        share = np.where(contacts.kind == HEAD, POCKET, 1.0)
        weaker = {n: share * getattr(contacts, n) for n in ("tensile_strength", "cohesion")}
        return replace(layout, contacts=replace(contacts, **weaker))

    return lay_out_with_pockets


def pushed(bench, row):
    """{name of a rule: histories of its draws}."""
    runs = {rule: {} for rule in strengths(row)}
    for rule, strength in strengths(row).items():
        wall = wall_of(row, strength)
        file = wall_file(bench.path(row.wall, rule, ending=".toml"), wall)
        for seed in DRAWS:
            words = [file, *push_of(row, wall), "--strength-seed", seed]
            runs[rule][f"{row.wall}_{rule}{seed}"] = words
    usual = prepare.lay_out_building
    laid = pockets(usual) if "pocket" in getattr(row, "head_joints", "") else usual
    together = {name: words for draws in runs.values() for name, words in draws.items()}
    with patch.object(prepare, "lay_out_building", laid):
        histories = bench.together(together)
    return {rule: [histories[name] for name in draws] for rule, draws in runs.items()}


def predicted(bench, row):
    """One wall's row of the table."""
    if row.h0_over_h not in BOUNDARIES:
        return {"wall": row.wall} | by_hand(row)
    histories = pushed(bench, row)
    capacities = {rule: [capacity(draw) for draw in draws] for rule, draws in histories.items()}
    usual = capacities[""]
    drifts = [draw["ultimate_drift"] if draw["ended"] else np.nan for draw in usual]
    stiffness = [first_loading(draw)["secant_stiffness_n_per_m"] for draw in histories[""]]
    return {
        "wall": row.wall,
        **{
            f"peak_{rule}kn": median(draw["peak_force_n"] for draw in draws) / 1e3
            for rule, draws in capacities.items()
        },
        "ultimate_drift_pct": 100 * np.mean(drifts),
        "mode": mode(draw["failure"]["mode"] for draw in usual),
        "secant_stiffness_kn_per_mm": median(stiffness) / 1e6,
        **by_hand(row),
    }


def main():
    parsed = arguments(
        __doc__,
        option("inputs", type=Path),
        option("walls", nargs="*", metavar="WALL"),
        option("--out", type=Path, default=Path("results/shear_walls")),
    )
    bench = Bench(parsed.out)
    made = []
    for row in read_inputs(parsed.inputs):
        if not parsed.walls or row.wall in parsed.walls:
            made.append(predicted(bench, row))
            print(made[-1], flush=True)
            pd.DataFrame(made).to_csv(
                parsed.out / "prediction.csv", index=False, float_format="%.3g"
            )
