"""Results of studies in their folders: a row for each point, its runs, their histories.

A study's folder holds `tables/points.csv`, a row for each point and solver, with the median of its
members, runs that differ in their perturbation alone, under a measure's NAME and their range under
NAME_min and NAME_max; `tables/summary.csv`, a row for each run; `tables/RUN_index.csv` and
`runs/RUN.h5`.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import pandas as pd

from damage.applications.studies.read import check_names, read_table
from damage.errors import InputError
from damage.history.reader import read_history
from damage.measure.tables import index_table
from damage.wall.model_options import USUAL_MODEL

NEEDED = ("point", "solver", "wall", "members")
RUN = ("run", "point", "solver")
MODEL = USUAL_MODEL | {"cycles": None}
"""Columns that say how a point was modelled, whichever solver did it, and what an empty cell stands
for."""
REFERENCE = "reference"
YADE = "yade"


class Missing(Exception):
    """A picture cannot be made from these results; the message says what they lack."""


@dataclass(frozen=True)
class Results:
    """Points and runs of all studies below a folder, each row with its study's folder.

    points, runs: DataFrames with the columns of points.csv and summary.csv, and `folder`.
    records: the folder where users put records that do not ship.
    """

    points: pd.DataFrame
    runs: pd.DataFrame
    records: Path = Path("records")

    def of_studies(self, names, chosen):
        """The chosen points (a mask) of the studies called so, or of all where none has them.

        A study is called by its folder: harmonic, harmonic_yade and yade/harmonic are all harmonic.
        What one solver did for several of them counts once, for the name that stands first.
        """
        points = self.points[chosen]
        rank = points["folder"].map(
            lambda folder: next(
                (place for place, name in enumerate(names) if folder.name.startswith(name)),
                len(names),
            )
        )
        if (called := rank < len(names)).any():
            points = points[called]
            rank = rank[called]
        first = rank.sort_values(kind="stable").index
        return points.drop(
            points.loc[first][points.loc[first].duplicated(["point", "solver"])].index
        )

    def ended(self):
        """These results with only the points whose runs came to their end, a collapse included."""
        if "status" not in self.points:
            return self
        return replace(self, points=self.points[self.points["status"] == "complete"])

    def members(self, point):
        """Names of a point's runs (a row of `points`), in the order of the summary."""
        same = (
            (self.runs["folder"] == point["folder"])
            & (self.runs["point"] == point["point"])
            & (self.runs["solver"] == point["solver"])
        )
        return list(self.runs.loc[same, "run"])

    def first(self, point):
        """Name of a point's first run."""
        names = self.members(point)
        if not names:
            raise Missing(
                f"no summary.csv has a run of point {point['point']}; it needs the study's own"
                " folder"
            )
        return names[0]

    def history(self, point):
        """History of a point's first run."""
        path = point["folder"] / "runs" / f"{self.first(point)}.h5"
        if not path.is_file():
            raise Missing(f"no history {path.name} in {path.parent}")
        return read_history(path)

    def histories(self, point):
        """Histories of those of a point's runs whose files are there."""
        paths = [point["folder"] / "runs" / f"{name}.h5" for name in self.members(point)]
        return [read_history(path) for path in paths if path.is_file()]

    def index(self, point):
        """The damage index over time of a point's first run, from its table or else its history."""
        path = point["folder"] / "tables" / f"{self.first(point)}_index.csv"
        return read_table(path) if path.is_file() else index_table(self.history(point))


@dataclass(frozen=True)
class Variant:
    """Points of one wall modelled in one way: those of the reference solver, those of YADE.

    differs: {column: value} that distinguishes it from the wall's main variant, the one with most
    points.
    """

    wall: str
    differs: dict
    reference: pd.DataFrame = field(repr=False)
    yade: pd.DataFrame = field(repr=False)

    @property
    def points(self):
        """All points, the reference solver's first."""
        return pd.concat([self.reference, self.yade])

    @property
    def title(self):
        """The variant in words, as "symmetric wall, lintel none"."""
        return ", ".join(
            [f"{self.wall} wall", *(f"{name} {value}" for name, value in self.differs.items())]
        )

    @property
    def file_part(self):
        """The variant in a file's name, as "symmetric_lintel-none"."""
        return "_".join(
            [str(self.wall), *(f"{name}-{value}" for name, value in self.differs.items())]
        )


def load_results(folder, records=Path("records")):
    """Read the tables of every study below a folder, itself included, or else those that are kept
    in it as STUDY_points.csv, of points alone, as in docs/tables; records: of `Results`."""
    folder = Path(folder)
    paths = {path.parents[1]: path for path in sorted(folder.rglob("tables/points.csv"))}
    kept = (
        {}
        if paths
        else {
            path.with_name(path.name.removesuffix("_points.csv")): path
            for path in sorted(folder.glob("*_points.csv"))
        }
    )
    if not (paths or kept):
        raise InputError(
            f"{folder} holds no */tables/points.csv; expected a folder with the results of studies,"
            " run one with ./run_all.sh"
        )
    points = [
        read_table(path, NEEDED).assign(folder=study) for study, path in (paths | kept).items()
    ]
    runs = [
        read_table(path.with_name("summary.csv"), RUN).assign(folder=study)
        for study, path in paths.items()
    ]
    tables = [
        pd.concat(some, ignore_index=True)
        for some in (points, runs or [pd.DataFrame(columns=[*RUN, "folder"])])
    ]
    for table in tables:
        check_names(table, folder)
    return Results(*tables, Path(records))


def variants(points):
    """The points of each wall by the way they were modelled, the main variant of each wall first.

    The reference solver's damping distinguishes variants, too; YADE's points match every damping.
    """
    shared = [name for name in MODEL if name in points]
    keys = points[[*shared, "beta_s"]] if "beta_s" in points else points[shared]
    keys = keys.astype(object).where(keys.notna(), None)  # None equals None, as NaN does not
    keys = keys.apply(
        lambda column: column.map(lambda value: MODEL.get(column.name) if value is None else value)
    )
    key_of = pd.Series(list(keys.itertuples(index=False, name=None)), keys.index)
    model_of = key_of.map(lambda key: key[: len(shared)])
    found = []
    for wall, of_wall in points.groupby("wall", sort=False):
        reference, yade = (of_wall[of_wall["solver"] == solver] for solver in (REFERENCE, YADE))
        by_model = dict(list(yade.groupby(model_of, sort=False)))
        groups = [
            (key, rows, by_model.get(key[: len(shared)], yade.iloc[:0]))
            for key, rows in reference.groupby(key_of, sort=False)
        ]
        alone = by_model.keys() - {key[: len(shared)] for key, *_ in groups}
        groups += [
            ((*model, None), reference.iloc[:0], rows)
            for model, rows in by_model.items()
            if model in alone
        ]
        groups.sort(key=lambda group: -len(group[1]) - len(group[2]))
        for key, *rows in groups:
            differs = {
                name: value
                for name, value, usual in zip(keys, key, groups[0][0])
                if value not in (None, usual)
            }
            found.append(Variant(wall, differs, *rows))
    return found
