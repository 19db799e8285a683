"""The table docs/tables/coverage.csv: how many tests of shear walls lie inside ranges of draws.

    python3 -m paper coverage FOLDER [WALL ...] [--out DIR]

Pushes by the guide *tested wall*, 19 draws of what its user does not know (`--inputs tested`, with
--strength-cov 0.35), and as many of the strengths alone: COMP2_4, whose twin is COMP2_5, SW and LW
of FOLDER (inputs.csv, results_sw_lw.csv).  The least and the largest of 19 draws hold a twentieth
in 90 of 100 cases.  About 20 minutes on one core by draws of all inputs.
"""

from itertools import product
from pathlib import Path
from statistics import median

import pandas as pd

from damage.applications.cracks.capacity import capacity
from damage.applications.cracks.pushed import FIGURES, read_test
from paper.after_peak import tested_wall
from paper.bench import FIXED, REPOSITORY, Bench, arguments, option, wall_file
from paper.shear_walls import read_inputs, strengths, wall_of

DRAWS = range(1, 20)
PUSH = ["--pushover", 0.3, *FIXED, "--speed", 0.004, "--strength-cov", 0.35]
DRAWN = {"all": ["--inputs", "tested"], "strengths": []}
MEASURES = "peak_force_n", "force_n", "stiffness_n_per_m", "ultimate_drift"
TWINS = "COMP2_4", "COMP2_5"


def cases(folder):
    """{wall: (Wall, {test: {of MEASURES: mean over both directions}})}."""
    inputs = {row.wall: row for row in read_inputs(folder / "inputs.csv")}
    found = {}
    results = pd.read_csv(folder / "results_sw_lw.csv").set_index("wall")
    for name, row in results.iterrows():
        peak, force, elastic, ultimate = (
            (row[f"{what}_plus"] + row[f"{what}_minus"]) / 2
            for what in ("peak_kn", "bilinear_kn", "effective_drift_pct", "ultimate_drift_pct")
        )
        test = {
            "peak_force_n": 1e3 * peak,
            "force_n": 1e3 * force,
            "stiffness_n_per_m": 1e5 * force / (elastic * inputs[name].height_m),
            "ultimate_drift": ultimate / 100,
        }
        usual = strengths(inputs[name])[""]
        found[name] = wall_of(inputs[name], usual), {name: test}
    twins = {name: read_test(name).figures for name in TWINS}
    return found | {TWINS[0]: (tested_wall(TWINS[0]), twins)}


def figures(history):
    """MEASURES of a push; an ultimate drift beyond its end is infinite."""
    found = capacity(history)
    return found if found["ended"] else found | {"ultimate_drift": float("inf")}


def main():
    parsed = arguments(
        __doc__,
        option("folder", type=Path),
        option("walls", nargs="*", metavar="WALL"),
        option("--drawn", nargs="+", choices=DRAWN, default=list(DRAWN)),
        option("--out", type=Path, default=Path("results/coverage")),
    )
    bench = Bench(parsed.out)
    rows = []
    for drawn, (name, (wall, tests)) in product(parsed.drawn, cases(parsed.folder).items()):
        if parsed.walls and name not in parsed.walls:
            continue
        file = wall_file(bench.path(name, ending=".toml"), wall)
        runs = {
            f"{name}_{drawn}_{seed}": [file, *PUSH, *DRAWN[drawn], "--strength-seed", seed]
            for seed in DRAWS
        }
        found = [figures(history) for history in bench.together(runs).values()]
        for test, measure in ((test, measure) for test in tests for measure in MEASURES):
            values = [one[measure] for one in found]
            size = FIGURES[measure][2]
            least = min(values)
            most = max(values)
            tested = tests[test][measure]
            rows.append(
                {
                    "wall": test,
                    "drawn": drawn,
                    "measure": f"{FIGURES[measure][0]}, {FIGURES[measure][1]}",
                    "test": tested / size,
                    "least": least / size,
                    "median": median(values) / size,
                    "most": most / size,
                    "inside": int(least <= tested <= most),
                }
            )
        pd.DataFrame(rows).to_csv(
            REPOSITORY / "docs" / "tables" / "coverage.csv", index=False, float_format="%.4g"
        )


if __name__ == "__main__":
    main()
