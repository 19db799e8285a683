"""The table of docs/validation/two-solvers.md: YADE against an ensemble of the reference solver,
motion by motion.

    python3 -m paper two_solvers --out DIR

DIR keeps the histories; those that are there already are not made again.  About an hour on one
core, almost all of it YADE's.
"""

from pathlib import Path

from damage.applications.cracks.compare import compare
from paper.bench import BGAR, Bench, arguments, option, print_row, print_table

RECORD = ["--record", BGAR, "--window", "17", "23", "--rest", "1"]
MOTIONS = {
    "0.2 s, 0.025 g": ["--harmonic", "0.2", "0.025"],
    "0.2 s, 0.05 g": ["--harmonic", "0.2", "0.05"],
    "0.2 s, 0.1 g": ["--harmonic", "0.2", "0.1"],
    "BGAR x 1": RECORD,
    "BGAR x 2": [*RECORD, "--scale", "2"],
}
ELASTIC = {
    "free vibration, 2 s": ["--free-vibration"],
    "0.2 s, 0.004 g": ["--harmonic", "0.2", "0.004", "--rest", "1"],
}
WALLS = ("solid", "symmetric", "asymmetric")
MEMBERS = 5
LEAST_FSS = 0.8
FIGURES = {  # of cracks.compare.TOLERANCES: label, factor, decimals, what is allowed
    "max_drift_ratio": ("maximum drift ratio [%]", 100, 4, "2 %"),
    "cycle_length_s": ("length of the free cycles [s]", 1, 4, "2 %"),
    "peak_base_shear_n": ("peak base shear [kN]", 1e-3, 1, "6 %"),
    "DI": ("max DI", 1, 4, "10 % or 0.003"),
    "DI_open": ("max DI_open", 1, 4, "30 % or 0.001"),
    "DI_slip_shear_limit": ("shear-limit DI_slip", 1, 4, "20 % or 0.003"),
    "Psi": ("max Psi", 1, 2, "15 % or 0.1"),
}


def main():
    bench = Bench(arguments(__doc__, option("--out", type=Path, required=True)).out)
    print_table(
        "motion", "quantity", "YADE", "reference: median (range)", "allowed difference", "verdict"
    )
    for motion, words in MOTIONS.items():
        nonlinear_rows(bench, motion, words)
    print_table("wall", "motion", "drift, RMS of the difference", "allowed")
    for wall in WALLS:
        for motion, words in ELASTIC.items():
            result = compare(bench.run_in_yade(wall, words, wall), [bench.run(wall, words, wall)])[
                "drift"
            ]
            rms, allowed = 100 * result["rms_before_failure"], 100 * result["allowed"]
            print_row(wall, motion, f"{rms:.2f} %", f"{allowed:.1f} %")


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


def figures_in_words(result, figures):
    """(key, label, YADE's value, the members' median, its range, what may be allowed, verdict) in
    words of FIGURES."""
    for key, (label, factor, digits, *_) in figures.items():
        if row := result["figures"].get(key):
            first, median, allowed, *ends = (
                f"{factor * value:.{digits}f}"
                for value in (row["first"], row["median"], row["allowed"], *row["range"])
            )
            yield key, label, first, median, ends, allowed, in_words(row["agrees"])


def in_words(agrees):
    return "holds" if agrees else "DIFFERS"


def nonlinear_rows(bench, motion, words):
    """Print the rows of the table for one motion of the symmetric wall."""
    result = in_both(bench, "symmetric", words, "symmetric")
    for key, label, yade, median, (low, high), _, verdict in figures_in_words(result, FIGURES):
        print_row(
            motion if key == "max_drift_ratio" else "",
            label,
            yade,
            median if low == high else f"{median} ({low} to {high})",
            FIGURES[key][-1],
            verdict,
        )
    drift, joints = result["drift"], result["joints"]
    diverged = "never" if drift["diverged_at_s"] is None else f"{drift['diverged_at_s']:.3f} s"
    print_row(
        "",
        f"drift to the first failure at {drift['first_failure_s']:.4f} s, RMS",
        "",
        f"{100 * drift['rms_before_failure']:.3f} %",
        "0.5 %",
        in_words(drift["agrees"]),
    )
    print_row(
        "",
        "diverged by 1 % of the peak; kappa of the contact points",
        "",
        f"{diverged}; {joints['kappa']:.2f}",
        "",
        "",
    )
    for what, words in (("broken", "broken joints"), ("visible", "joints over 0.1 mm")):
        scores = result["patterns"][what]
        lacking = "" if scores["tells_sides"] else ", does not distinguish sides"
        holds = scores["fss"] >= LEAST_FSS and scores["fss"] > scores["shuffled"]
        print_row(
            "",
            f"FSS of {words} (shuffled, mirrored)",
            "",
            f"{scores['fss']:.2f} ({scores['shuffled']:.2f}, {scores['mirrored']:.2f}{lacking})",
            LEAST_FSS,
            in_words(holds),
        )
