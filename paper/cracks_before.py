"""Cracks before an earthquake: P(Psi >= 1) by the Psi that settlement left
(docs/paper/settled-walls.md).

    python3 -m paper cracks_before DIR            # runs what DIR lacks, writes
                                                  # docs/tables/cracks_before.csv
    python3 -m paper cracks_before DIR --windows  # a few runs again with whole windows,
                                                  # cracks_before_windows.csv
    python3 -m paper cracks_before --tables       # tables of the page, of the CSV files

WALLS draws of the joints' strengths of the symmetric wall with softening joints settle by hogging
until each class of CLASSES is reached; each settled wall is then shaken by each component, scaled
to PGV_MM_S (`--continue`).  Components: the ten strongest of
damage/data/zeerijp_20180108/components.csv, cut to their strong part.  DIR keeps histories of the
settlements and a row a run, and what is there is not run again.
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

from damage.history.in_memory import HistoryInMemory
from damage.history.reader import read_history
from damage.measure.cracks import psi_history
from damage.motion.formats import read_record
from damage.reference.rest_cache import RestCache
from damage.reference.session import run_references
from damage.units import MILLIMETRE
from paper.bench import EXPLICIT, REPOSITORY, arguments, option, show

WALL = REPOSITORY / "walls" / "variants" / "symmetric_softening.py"
DATA = REPOSITORY / "damage" / "data" / "zeerijp_20180108"
TABLE = REPOSITORY / "docs" / "tables" / "cracks_before.csv"
WINDOWS = TABLE.with_name("cracks_before_windows.csv")
WALLS, COMPONENTS, PGV_MM_S, LEAST_PSI = 25, 10, 10.0, 1.0
ARIAS = 0.02, 0.80
"""Shares of the Arias intensity between which the strong part lies."""
MARGIN_S = 0.15
CLASSES = {
    "undisturbed": None,
    "invisible": (0.0, 1e-9),
    "about 0.5": (0.25, 0.75),
    "about 1": (0.75, 1.25),
}
"""Psi after the settlement, from and below; None: no settlement."""
BINS = 0.6, 0.7, 0.75, 0.85, 0.9, 0.95, 1.0, 1.25
FIRST = {
    "invisible": (1 / 5000, 1 / 5000),
    "about 0.5": (1 / 4000, 1 / 4000),
    "about 1": (1 / 3700, 1 / 2400),
}
"""Distortions of the first and the last wall of each class, the others evenly between; walls that
miss their class settle again by 2 % more or less."""
TRIES = 4
CHECKED = (1,), 8, ("undisturbed", "about 1")
"""Components, by their order, number of walls, and classes that are shaken by whole windows,
too."""
LONGEST_S = 5.0
"""Of a strong part; components with longer ones are left out."""


def common(seed):
    return [
        str(WALL),
        "--lintel",
        "2",
        "--strength-cov",
        "0.3",
        "--strength-seed",
        str(seed),
        "--quiet",
        "--no-pictures",
        *EXPLICIT,
    ]


def components():
    """The strongest components, a DataFrame; strong_s, strong_e_s: their strong part [s] of the
    file."""
    table = pd.read_csv(DATA / "components.csv", comment="#").sort_values(
        "pgv_mm_s", ascending=False
    )
    begin, end = map(np.array, zip(*map(strong_part, table.itertuples())))
    table = table.assign(strong_s=begin, strong_e_s=end, scale=PGV_MM_S / table["pgv_mm_s"])
    return table[end - begin <= LONGEST_S].head(COMPONENTS).reset_index(drop=True)


def strong_part(row):
    """Begin and end [s] of the part of a component's window between ARIAS of its intensity, with
    MARGIN_S."""
    record = read_record(DATA / f"{row.record}_acc_m_s2.csv")
    time_s = np.arange(len(record.acceleration_m_s2)) * record.time_step_s
    inside = (time_s >= row.start_s) & (time_s <= row.end_s)
    share = np.cumsum(record.acceleration_m_s2[inside] ** 2)
    found = [float(time_s[inside][np.searchsorted(share, q * share[-1])]) for q in ARIAS]
    return max(row.start_s, round(found[0] - MARGIN_S, 2)), min(
        row.end_s, round(found[1] + MARGIN_S, 2)
    )


# --- settlement -----------------------------------------------------------------------------------


def settle(folder):
    """{(class, seed): path of the history of a settled wall, whose Psi is in its class}."""
    wanted = {
        (name, seed): value
        for name, ends in FIRST.items()
        for seed, value in enumerate(map(float, np.linspace(*ends, WALLS)), 1)
    }
    paths = {key: folder / f"settled_{key[0].replace(' ', '_')}_{key[1]}.h5" for key in wanted}
    settled = RestCache()
    for attempt in range(TRIES):
        lines = [
            (
                key,
                [
                    *common(key[1]),
                    "--settle",
                    "hogging",
                    "--distortion",
                    repr(wanted[key]),
                    "--out",
                    str(path),
                    "--overwrite",
                ],
            )
            for key, path in paths.items()
            if not path.is_file()
        ]
        for key, status in run_references(iter(lines), settled=settled):
            check(status, key)
        again = {}
        for key, path in paths.items():
            (low, high), psi = (
                CLASSES[key[0]],
                float(psi_history(read_history(path))["psi"].iloc[-1]),
            )
            if not low <= psi < high:
                again[key] = 1.02 if psi < low else 0.98
        if not again:
            return paths
        print(f"settled again: {sorted(again)}", flush=True)
        for key, factor in again.items():
            if attempt + 1 < TRIES:
                wanted[key] *= factor
                paths[key].unlink()
    for key in again:  # of no use
        print(f"left out: {key}", flush=True)
        paths.pop(key)
    return paths


def check(status, what):
    if status:
        sys.exit(f"{what}: exit status {status}")


# --- shaking --------------------------------------------------------------------------------------


def shake(cases, path):
    """Run the cases that the table at `path` lacks; cases: list of (row, words), the row with a
    run's name."""
    done = set(pd.read_csv(path)["run"]) if path.is_file() else set()
    lines = [(row["run"], words) for row, words in cases if row["run"] not in done]
    rows, histories = (
        {row["run"]: row for row, _ in cases},
        {name: HistoryInMemory for name, _ in lines},
    )
    for name, status in run_references(iter(lines), histories):
        check(status, name)
        row = rows[name] | results(histories.pop(name).history())
        pd.DataFrame([row]).to_csv(path, mode="a", header=not path.is_file(), index=False)


def results(history):
    """Measures before, during and after the motion of a History; a collapsed wall has those of its
    last sample."""
    psi, index = psi_history(history), history.index()["DI"]
    return {
        "psi_0": round(float(psi["psi"].iloc[0]), 4),
        "DI_0": round(float(index.iloc[0]), 5),
        "width_0_mm": round(float(psi["max_width_m"].iloc[0]) / MILLIMETRE, 4),
        "psi_max": round(float(psi["psi"].max()), 4),
        "DI_max": round(float(index.max()), 5),
        "psi_end": round(float(psi["psi"].iloc[-1]), 4),
        "DI_end": round(float(index.iloc[-1]), 5),
        "width_end_mm": round(float(psi["max_width_m"].iloc[-1]) / MILLIMETRE, 4),
        "drift_max": round(float(history.series["drift_ratio"].abs().max()), 7),
        "collapsed": int(history.collapsed_at_s is not None),
    }


def cases_of(folder, settled, whole=False):
    """Cases of `shake`, component by component; whole: the few with whole windows."""
    found, names = [], CHECKED[2] if whole else CLASSES
    for number, part in enumerate(components().itertuples()):
        window = (part.start_s, part.end_s) if whole else (part.strong_s, part.strong_e_s)
        of_window = not whole or number in CHECKED[0]
        keys = [
            (name, seed)
            for name in names
            for seed in range(1, (CHECKED[1] if whole else WALLS) + 1)
        ]
        found += [
            case(folder, part, window, name, seed, settled.get((name, seed)))
            for name, seed in keys
            if of_window and (name == "undisturbed" or (name, seed) in settled)
        ]
    return found


def case(folder, part, window, name, seed, before):
    """(row, words) of a wall shaken by a component; before: history of its settlement, None where
    undisturbed."""
    run = f"{name.replace(' ', '_')}_{seed}_{part.record}"
    words = [
        *common(seed),
        "--supports",
        "bricks",
        "--record",
        str(DATA / f"{part.record}_acc_m_s2.csv"),
        "--scale",
        f"{part.scale:.6g}",
        "--window",
        *map(str, window),
        "--rest",
        "0.2",
        "--overwrite",
        "--out",
        str(folder / f"{run}.h5"),
        *(["--continue", str(before)] if before else []),
    ]
    distortion = read_history(before).parameters["settlement"]["distortion"] if before else 0.0
    return {
        "run": run,
        "class": name,
        "wall": seed,
        "record": part.record,
        "distortion": f"{distortion:.6g}",
    }, words


def main():
    given = arguments(
        __doc__,
        option("folder", nargs="?", type=Path),
        option("--windows", action="store_true"),
        option("--tables", action="store_true"),
    )
    if given.tables:
        print_tables()
        return
    given.folder.mkdir(parents=True, exist_ok=True)
    shake(
        cases_of(given.folder, settle(given.folder), given.windows),
        WINDOWS if given.windows else TABLE,
    )


# --- tables ---------------------------------------------------------------------------------------


def print_tables():
    """The tables of the page in Markdown: probabilities by class, and by bins of Psi; settlement
    and earthquake alone and together; windows."""
    table = pd.read_csv(TABLE)
    alone = table[table["class"] == "undisturbed"].set_index(["wall", "record"])
    show(
        [
            "class of Ψ₀",
            "hogging by",
            "walls x components",
            "Ψ₀",
            "P(Ψ ≥ 1) [%]",
            "by component [%]",
            "published [%]",
        ],
        [
            by_class(name, table[table["class"] == name])
            for name in CLASSES
            if (table["class"] == name).any()
        ],
    )
    show(["Ψ₀", "walls", "runs", "Ψ at rest", "P(Ψ ≥ 1) [%]"], by_start(table))
    show(
        [
            "class of Ψ₀",
            "settlement alone: Ψ, DI",
            "earthquake alone",
            "both",
            "largest in both",
            "runs where Ψ grew",
        ],
        [
            together(name, table[table["class"] == name], alone)
            for name in CLASSES
            if (table["class"] == name).any()
        ],
    )
    if WINDOWS.is_file():
        whole = pd.read_csv(WINDOWS).merge(table, on="run", suffixes=("_whole", ""))
        show(
            [
                "class of Ψ₀",
                "component",
                "walls",
                "whole window: Ψ",
                "strong part: Ψ",
                "largest difference of Ψ",
            ],
            [
                (
                    name,
                    record,
                    len(of),
                    spread(of["psi_end_whole"]),
                    spread(of["psi_end"]),
                    f"{(of['psi_end_whole'] - of['psi_end']).abs().max():.2f}",
                )
                for (name, record), of in whole.groupby(["class", "record"])
            ],
        )


def by_class(name, rows):
    """A row of the first table."""
    visible, walls = rows["psi_end"] >= LEAST_PSI, rows.groupby("record")["wall"].nunique()
    number = f"{walls.min()} to {walls.max()}" if walls.min() < walls.max() else walls.max()
    by_component = 100 * visible.groupby(rows["record"]).mean()
    ground = sorted({round(1 / value) for value in rows["distortion"] if value})
    published = {"undisturbed": "5", "invisible": "5", "about 0.5": "20"}.get(name, "")
    return (
        name,
        "" if not ground else f"1/{ground[-1]}" + (f" to 1/{ground[0]}" if len(ground) > 1 else ""),
        f"{number} x {len(walls)}, {len(rows)} runs",
        spread(rows["psi_0"]),
        f"{100 * visible.mean():.0f}",
        f"{by_component.min():.0f} to {by_component.max():.0f}",
        published,
    )


def by_start(table):
    """Rows of the second table: probabilities by bins of the Psi that the settlement left."""
    for low, high in zip(BINS, BINS[1:]):
        rows = table[(table["psi_0"] >= low) & (table["psi_0"] < high)]
        yield (
            f"{low:g} to {high:g}",
            rows["wall"].nunique(),
            len(rows),
            spread(rows["psi_end"]),
            f"{100 * (rows['psi_end'] >= LEAST_PSI).mean():.0f}",
        )


def together(name, rows, alone):
    """A row of the third table: medians of Psi and DI at rest, after the settlement and after the
    earthquake."""
    same = alone.loc[[key for key in zip(rows["wall"], rows["record"]) if key in alone.index]]
    grew = (rows["psi_end"] - rows["psi_0"] > 0.01).mean()
    return (
        name,
        *(
            f"{of[f'psi_{when}'].median():.2f}, {of[f'DI_{when}'].median():.4f}"
            for of, when in ((rows, "0"), (same, "end"), (rows, "end"), (rows, "max"))
        ),
        f"{100 * grew:.0f} %",
    )


def spread(values):
    """Median and range of values, in words."""
    least, median, most = (
        f"{value:.2f}" for value in (values.min(), values.median(), values.max())
    )
    return median if least == most else f"{median} ({least} to {most})"
