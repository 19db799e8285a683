"""Keeps a study's results among the documents: docs/tables/STUDY_points.csv and STUDY_cycles.csv.

    python3 scripts/keep_tables.py RESULTS STUDY [--some] [--to FOLDER]

RESULTS: folder of ./run_all.sh, with tables/points.csv.  Cycles: the driven ones of the harmonic
motions by which the paper is judged (`scripts/documents.py`), medians over the runs of a point, of
walls that stood.  --some: of a study that was run in part; what is kept of its other points stays.
"""

import argparse
import sys
from pathlib import Path

import pandas as pd

REPOSITORY = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(REPOSITORY))

from damage.applications.studies.read import read_table
from damage.errors import InputError
from damage.files import write_text
from damage.measure.damage_index import CRITERIA
from paper.evidence import MODELS, Fell, NotThere, Point, comparable, load_runs

KEY = ["point", "solver"]
CYCLES = [f"max_{slip}DI" for slip in CRITERIA.values()]


def keep(results, study, folder, some=False):
    """Writes the tables of the results into the folder, the second where there are cycles; returns
    their paths."""
    points = read_words(results / "tables" / "points.csv")
    paths = []
    for name, new in (("points", points), ("cycles", cycles_of(results))):
        path = folder / f"{study}_{name}.csv"
        table = replaced(read_words(path), new) if some and path.is_file() else new
        if len(table):
            paths.append(write_text(path, table.to_csv(index=False)))
    return paths


def read_words(path):
    """A table as it is written, every cell a str."""
    read_table(path, KEY)  # what is wrong with it
    return pd.read_csv(path, dtype=str, keep_default_na=False)


def replaced(old, new):
    """The rows of a table with those of the new one's points in their place, or behind them where
    they are not there.

    >>> old = pd.DataFrame({"point": ["a", "b"], "solver": "yade", "max_DI": ["0.1", "0.2"]})
    >>> new = pd.DataFrame({"point": ["c", "a"], "solver": "yade", "max_DI": ["0.4", "0.3"]})
    >>> print(replaced(old, new).to_csv(index=False))
    point,solver,max_DI
    a,yade,0.3
    b,yade,0.2
    c,yade,0.4
    <BLANKLINE>
    """
    keys = {
        key: None for table in (old, new) for key in table[KEY].itertuples(index=False, name=None)
    }
    place = {key: number for number, key in enumerate(keys)}
    again = old.set_index(KEY).index.isin(new.set_index(KEY).index)
    both = pd.concat([new, old[~again]], ignore_index=True)
    order = pd.Series([place[key] for key in both[KEY].itertuples(index=False, name=None)]).argsort(
        kind="stable"
    )
    return both.iloc[order]


def cycles_of(results):
    """Columns point, solver, kind and CYCLES, a row a cycle."""
    runs = load_runs(results)
    found = []
    runs = pd.concat([comparable(runs, changes) for changes in MODELS.values()])
    for (point, solver), rows in runs[runs["motion_period_s"].notna()].groupby(KEY, sort=False):
        try:
            columns = {name: Point(rows, point).cycles(name).round(9) for name in CYCLES}
        except (Fell, NotThere):  # judged without cycles
            continue
        found.append(pd.DataFrame({"point": point, "solver": solver, "kind": "driven", **columns}))
    return (
        pd.concat(found, ignore_index=True)
        if found
        else pd.DataFrame(columns=[*KEY, "kind", *CYCLES])
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("results", metavar="RESULTS", type=Path, help="folder of ./run_all.sh")
    parser.add_argument("study", metavar="STUDY", help="name under which its tables are kept")
    parser.add_argument(
        "--some", action="store_true", help="of a study that was run in part: other points stay"
    )
    parser.add_argument(
        "--to",
        metavar="FOLDER",
        type=Path,
        default=REPOSITORY / "docs" / "tables",
        help="where they are kept (default: docs/tables)",
    )
    asked = parser.parse_args()
    try:
        print(*keep(asked.results, asked.study, asked.to, asked.some), sep="\n")
    except InputError as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
