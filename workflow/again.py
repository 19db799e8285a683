"""One run of a study made again, whose history was not kept: to the values that the table has, or it says otherwise."""

import subprocess
import sys

import pandas as pd
from shared import MARK, ROOT, environment
from stale import changes
from versions import CODE

from damage.errors import InputError
from damage.history.reader import read_history
from damage.measure.columns import MADE_BY
from damage.measure.register import names
from damage.measure.tables import summary_row
from damage.provenance import measures_digest, model_digest
from damage.studies.inputs import inputs_of
from damage.studies.members import most_members

_NAMED = 5  # columns that a message names


def make_again(name, study, folder):
    """Make the history of one run of a study, which is not there; returns the exit status: 1 where the run fails, or
    its values are not those of the table.  Raises InputError where it would not be the same run."""
    run, number = _find(name, study)
    history = folder / "runs" / f"{name}.h5"
    if history.is_file():
        raise InputError(f"--run {name}: {history} is there; expected one that is not, delete it first")
    changed = changes(run, inputs_of(run, ROOT), folder)
    if changed:
        raise InputError(f"--run {name}: its inputs are not those that the table was made from: "
                         f"{', '.join(changed[:_NAMED])}; expected the same, restore them, or run the study again")
    row = row_in_table(name, folder)
    for warning in other_versions(row, run.solver):
        print(f"warning: --run {name}: {warning}", file=sys.stderr, flush=True)
    status = _simulate(run, number, history, folder)
    if status != 0 or row is None:
        return status
    differing = differing_columns(row, summary_row(read_history(history), run=name, point=run.point))
    if not differing:
        print(f"{name}: the values are those of {folder / 'tables' / 'summary.csv'}")
        return 0
    aside = history.with_name(f"{name}.differs.h5")
    history.rename(aside)
    more = f" and {len(differing) - _NAMED} more" if len(differing) > _NAMED else ""
    print(f"error: --run {name}: {len(differing)} columns are not those of {folder / 'tables' / 'summary.csv'}: "
          f"{', '.join(differing[:_NAMED])}{more}; the history is {aside}", file=sys.stderr)
    return 1


def _find(name, study):
    """(StudyRun, number) of a run by its name."""
    found = [(run, number) for run in study.runs for number in range(1, most_members(run) + 1)
             if run.name(number) == name]
    if not found:
        raise InputError(f"--run {name}: no run of the study {study.name} with this solver; expected a name from the "
                         "column run of tables/summary.csv")
    return found[0]


def _simulate(run, number, history, folder):
    """Run the solver; returns the exit status."""
    name = run.name(number)
    done = subprocess.run(
        [sys.executable, ROOT / "workflow" / "simulate.py", name, "--solver", run.solver, "--out", history, "--log",
         folder / "logs" / f"{name}.log", "--", *run.command(number)],
        env=environment(), stderr=subprocess.PIPE, text=True)
    print(done.stderr.replace(MARK, ""), end="", flush=True)
    return done.returncode


def row_in_table(name, folder):
    """{column: word} of a run in summary.csv; None, with a warning, where there is none."""
    path = folder / "tables" / "summary.csv"
    table = pd.read_csv(path, dtype=str, keep_default_na=False) if path.is_file() else pd.DataFrame({"run": []})
    rows = table[table["run"] == name].to_dict("records")
    if not rows:
        print(f"warning: --run {name}: no row of it in {path}: its values are not compared", file=sys.stderr,
              flush=True)
    return rows[0] if rows else None


def other_versions(row, solver):
    """Versions that made the row of a table and differ from these: a list of str."""
    today = {"model_digest": ("the model", model_digest(CODE[solver])),
             "measures_digest": ("index and measures", measures_digest())}
    return [f"another version of {what} made the table's row ({row.get(name) or 'unknown'}, now {digest}): its values "
            "may differ" for name, (what, digest) in today.items() if row and row.get(name, "") != digest]


def differing_columns(row, new):
    """The columns in which a row of summary.csv, in words, and a new one differ, a list of "NAME 0.94 -> 1"; those that
    say what made them do not count."""
    return [f"{name} {row[name] or 'empty'} -> {_word(value) or 'empty'}" for name, value in new.items()
            if name in row and name not in names(MADE_BY) and _canonical(row[name]) != _canonical(_word(value))]


def _word(value):
    """A value as `damage.measure.tables.write_table` writes it."""
    return "" if pd.isna(value) else f"{value:.9g}" if isinstance(value, float) else str(value)


def _canonical(word):
    """A word by which equal values are equal, whether their column had whole numbers alone or not."""
    try:
        return f"{float(word):.9g}"
    except ValueError:
        return word
