"""The tables of studies as evidence: runs picked by their parameters, medians over members of a
point."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import pandas as pd

from damage.applications.studies.read import read_table
from damage.errors import InputError
from damage.measure.damage_index import CRITERIA
from damage.wall.model_options import USUAL_MODEL
from paper.criteria import CONVERGED_SPEED_M_S

SHAPE = {name: value for name, value in USUAL_MODEL.items() if name != "lintel"} | {
    "shocks": 1,
    "alpha_1_s": 0.0,
    "vertical": 0,
}
"""Parameters of the runs that are compared with the paper; a table without one of these columns has
these values. Lintels are compared one by one."""
LEAST_STEP_S = 2e-5
"""Runs with smaller steps are studies of the step [s]."""
BETA_S = 1e-6
"""Largest stiffness-proportional damping of a run that still counts where there is none without
[s]; it damps the first mode by 1.6e-5."""
SOFTENS = "mode_i_fracture_energy_j_m2"
"""Column that is above zero where the joints are not the paper's, which are brittle."""
MEASURES = (
    *SHAPE,
    SOFTENS,
    "slip",
    "collapsed_at_s",
    "lintel",
    "beta_s",
    "time_step_s",
    "rest_s",
    "motion_period_s",
    "cycles",
    "speed_m_s",
    "amplitude_g",
    "record",
    "scale",
    "eigen_period_s",
    "input_energy_j",
    "damping_energy_j",
    "energy_error_fraction",
)
"""Columns that are looked up in every run; empty where an older table lacks one."""
OTHER_WALL = 1e-3
"""Share by which the period of an intact wall differs where it is another wall of the same name, as
a copy is."""
RECORDS = {"zeerijp": r"BGAR.*HGE", "huizinge": r"(?i:MID1|huizinge)"}
"""How the names of the paper's two records are recognised."""


class NotThere(Exception):
    """A claim cannot be judged for lack of runs; the message names them."""


class Fell(Exception):
    """A claim is about a wall that fell; the text says when."""


def load_runs(folder):
    """Every row of the tables */tables/summary.csv below `folder`, a DataFrame, with the column
    `tables`, their folder.

    Rows of runs that were not completed are left out.  Raises InputError where there is no table.
    """
    paths = sorted(folder.rglob("tables/summary.csv"))
    if not paths:
        raise InputError(
            f"{folder}: no tables/summary.csv below it; expected the results of studies, as "
            "./run_all.sh harmonic writes them"
        )
    needed = ("run", "wall", "solver", "status", "motion")
    runs = pd.concat(
        [read_table(path, needed).assign(tables=path.parent) for path in paths], ignore_index=True
    )
    runs = runs.reindex(columns=runs.columns.union(MEASURES, sort=False))
    return runs[runs["status"] == "complete"].reset_index(drop=True)


USUAL = {
    name: lambda column, value=value: column.isna() | (column == value)
    for name, value in SHAPE.items()
} | {
    "time_step_s": lambda step_s: ~(step_s < LEAST_STEP_S),
    "beta_s": lambda beta_s: ~(beta_s > BETA_S),
    SOFTENS: lambda energy: ~(energy > 0),
}
"""{column: function of it that says which runs are those of the paper's model, as it is read here
by default}."""


def exactly(**values):
    """{column: function of it that says which runs have this value}."""
    return {name: lambda column, value=value: column == value for name, value in values.items()}


ANY_STEP = {"time_step_s": lambda step_s: step_s > 0}
MODELS = {
    "": {},
    "contacts at the joints' ends": exactly(contacts="corners"),
    "deformable bricks, contacts at the joints' ends": (
        exactly(contacts="corners", bricks="deformable", brick_damping=0.0) | ANY_STEP
    ),
}
"""{words: changes of USUAL} of the models that the verdict judges: the default, and the one that
the paper's text describes (deformable bricks, contacts at their corners or edges, brittle and
undamped) in rigid and in its own form."""


def comparable(runs, changes=None):
    """The runs of the model of USUAL, or with `changes` of its functions, and the usual period of
    the wall."""
    kept = pd.Series(True, runs.index)
    for name, fits in (USUAL | (changes or {})).items():
        kept &= fits(runs[name])
    runs = runs[kept]
    usual = runs.groupby("wall")["eigen_period_s"].transform("median")
    return runs[~((runs["eigen_period_s"] - usual).abs() > OTHER_WALL * usual)]


@dataclass(frozen=True)
class Point:
    """The runs of one wall under one motion, which differ by their perturbation only; rows:
    DataFrame."""

    rows: pd.DataFrame
    label: str

    def stood(self):
        """Raises Fell if half of the runs or more fell."""
        fallen = self._known("collapsed_at_s")
        if 2 * len(fallen) >= len(self.rows):
            raise Fell(f"fell at {np.median(fallen):.2f} s ({self.label})")

    def value(self, name):
        """The median of a column; raises Fell if the wall fell, NotThere without a value."""
        self.stood()
        return self.plain(name)

    def plain(self, name):
        """The median of a column, whether the wall fell or not."""
        if name not in self.rows or not len(known := self._known(name)):
            raise NotThere(f"no {name} ({self.label})")
        return float(np.median(known))

    def spread(self, name):
        """Smallest and largest value of a column, None for a single run."""
        known = self._known(name)
        return None if len(known) < 2 else (float(known.min()), float(known.max()))

    def _known(self, name):
        """The values of a column that are not missing, an array: on the few rows of a point much
        faster than pandas."""
        values = self.rows[name].to_numpy(float)
        return values[~np.isnan(values)]

    def cycles(self, name):
        """A column of the cycle tables by driven cycle, (n_cycles,): the median over the
        members."""
        self.stood()
        tables = [
            table
            for run in zip(self.rows["tables"], self.rows["run"].astype(str))
            if len(table := _cycles(*run))
        ]
        if not tables:
            raise NotThere(f"no table of cycles ({self.label})")
        return np.median([table.loc[table["kind"] == "driven", name] for table in tables], axis=0)


def _cycles(folder, run):
    """The cycles of a run: of a table of its own, or of that of its study; empty where neither has
    them."""
    alone = folder / f"{run}_cycles.csv"
    together = folder / "cycles.csv"
    if alone.is_file():
        return read_table(alone)
    table = (
        _table_of(together, together.stat().st_mtime_ns)
        if together.is_file()
        else pd.DataFrame({"run": []})
    )
    return table[table["run"].astype(str) == run]


@lru_cache(maxsize=4)
def _table_of(path, time_ns):
    """A table that is asked for again and again; time_ns: of its last change."""
    return read_table(path)


@dataclass(frozen=True)
class Evidence:
    """Evidence from one solver with one lintel and one slip criterion.

    runs: comparable runs of one solver, all lintels; points: theirs, of `gather`; records: {name:
    Record} of the paper's two; usual_cycles: of the harmonic motions, where a claim does not say.
    """

    runs: pd.DataFrame
    points: dict
    lintel: str
    slip: str
    records: dict
    usual_cycles: int = 3

    def column(self, kind, component):
        """Name of a column of the index, kind "max" or "residual", with this slip criterion."""
        return f"{kind}_{CRITERIA[self.slip]}{component}"

    def harmonic(self, wall, period_s, cycles=None):
        """{amplitude [g]: Point} of a wall's harmonic motions, rising."""
        return self.points.get(
            _harmonic_key(wall, self.lintel, period_s, cycles or self.usual_cycles), {}
        )

    def harmonic_at(self, wall, period_s, amplitudes_g, cycles=None):
        """Points at these amplitudes, in their order; raises Fell if one fell, NotThere if one is
        missing."""
        count = (
            f", {cycles or self.usual_cycles} cycles" if (cycles or self.usual_cycles) != 3 else ""
        )
        return _chosen(
            self.harmonic(wall, period_s, cycles),
            amplitudes_g,
            f"no run of the {wall} wall at {period_s:g} s{count}, amplitude [g]",
        )

    def shaken(self, record):
        """{scale: Point} of the symmetric wall shaken by one of RECORDS, rising."""
        return self.points.get(("symmetric", self.lintel, record), {})

    def shaken_at(self, record, scales):
        """Points at these scales; raises Fell if one fell, NotThere if one is missing."""
        return _chosen(self.shaken(record), scales, f"no run with the {record} record, scale")

    def period_s(self, wall):
        """First period of the intact wall, which no lintel changes [s]."""
        rows = self.runs[self.runs["wall"] == wall]
        if len(rows) == 0:
            raise NotThere(f"no run of the {wall} wall")
        return Point(rows, wall).plain("eigen_period_s")

    def pushed_slowly(self, wall):
        """The Point of a wall's runs pushed as a cantilever so slowly that its stiffness has
        converged."""
        rows = self._pushed(wall, "(?:cyclic|pushover)")
        rows = rows[rows["speed_m_s"] <= CONVERGED_SPEED_M_S]
        if len(rows) == 0:
            raise NotThere(
                f"no run of the {wall} wall pushed at {1e3 * CONVERGED_SPEED_M_S:g} mm/s or less,"
                " where its stiffness has converged"
            )
        return Point(rows, f"{wall} wall, pushed slowly")

    def cycled(self, wall):
        """The Point of a wall's runs pushed to and fro as a cantilever."""
        rows = self._pushed(wall, "cyclic")
        if len(rows) == 0:
            raise NotThere(f"no cyclic run of the {wall} wall")
        return Point(rows, f"{wall} wall, cyclic")

    def _pushed(self, wall, how):
        """The runs of a wall pushed as a cantilever; how: the beginning of their motion's name."""
        motion = self.runs["motion"].astype(str)
        return self.runs[(self.runs["wall"] == wall) & motion.str.contains(f"^{how}.*cantilever")]


def _harmonic_key(wall, lintel, period_s, cycles):
    """What runs of one wall share that differ in amplitude only; a wall without openings has no
    lintel."""
    return wall, "none" if wall == "solid" else lintel, round(float(period_s), 6), int(cycles)


def gather(runs):
    """The points of one solver's comparable runs: {key: {amplitude [g] or scale: Point}},
    rising."""
    found = {}
    shaken = runs[runs["motion_period_s"].notna()]
    for (wall, lintel, period, cycles, amplitude), rows in shaken.groupby(
        ["wall", "lintel", "motion_period_s", "cycles", "amplitude_g"]
    ):
        members = found.setdefault(_harmonic_key(wall, lintel, period, cycles), {})
        members[float(amplitude)] = Point(_least_damped(rows), f"{period:g} s, {amplitude:g} g")
    name = runs["motion"].astype(str) + " " + runs["record"].astype(str)
    for record, pattern in RECORDS.items():
        for (wall, lintel, scale), rows in runs[name.str.contains(pattern)].groupby(
            ["wall", "lintel", "scale"]
        ):
            found.setdefault((wall, lintel, record), {})[float(scale)] = Point(
                _least_damped(rows), f"{record} x{scale:g}"
            )
    return found


def _chosen(points, keys, complaint):
    """The points of these keys; a wall that fell contradicts the paper even where other runs are
    missing."""
    for key in keys:
        if key in points:
            points[key].stood()
    missing = [f"{key:g}" for key in keys if key not in points]
    if missing:
        raise NotThere(f"{complaint} {', '.join(missing)}")
    return [points[key] for key in keys]


def _least_damped(rows):
    """Runs of a point without viscous damping, or else all; of these those with the longest
    rest."""
    if len(rows) == 1:
        return rows
    undamped = rows[rows["beta_s"].fillna(0) == 0]
    rows = undamped if len(undamped) else rows
    longest = rows["rest_s"].fillna(0).max()
    return rows[rows["rest_s"].fillna(0) == longest]
