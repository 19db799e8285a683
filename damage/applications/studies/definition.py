"""Studies: files that list runs as data, for batches.

A study is a TOML file:

    name = "quick"
    title = "one line for people"      # optional
    pictures = "none"                  # optional: no pictures of single runs; the default is "all"

    [[runs]]
    wall = "walls/symmetric.py"
    options = { harmonic = [0.2, 0.05], rest = 1.0 }

In `options` true stands for an option without a value.  Paths are looked for beside the study file,
then in the repository, then among what ships, by name, too (wall = "symmetric"); a list of paths
means the first that is there.  A table [[grid]] has `vary` or `rows`, too, and stands for many
runs: `damage.applications.studies.grid`.

Every run is a point of the study.  In the reference solver a point can be an ensemble, by one of
the keys members (only one where the first breaks no joint), samples and lives (`ENTRY_KEYS`).  YADE
runs a point once, without scatter. `docs/reference/studies.md` describes all keys.
"""

import hashlib
import re
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np

from damage.applications.studies.grid import expand, read_rows
from damage.applications.studies.states import STUDY_FILE, choices_in
from damage.checks import check_path, check_whole
from damage.errors import InputError, did_you_mean
from damage.files import is_there, shipped_path
from damage.motion.formats import shipped_records
from damage.run.options import SOLVERS, names_file, settings_of, words_of
from damage.run.settings import SCATTER
from damage.toml_file import read_toml
from damage.wall.file import shipped_walls

RESERVED_OPTIONS = (
    "members",
    "out",
    "overwrite",
    "pictures",
    "no-pictures",
    "quiet",
    "view",
    "console",
    "checkpoint",
    "resume",
    "help",
)
"""Options of a run that the batch sets by itself, or that mean nothing in one."""

PICTURES = ("all", "none")
CONCLUSION = re.compile(r"python3 -m (damage|paper) ([a-z][a-z-]*)")
"""A command of this software; it gets the study's folder and `--markdown tables/NAME.md`."""
MOST_MEMBERS = 10_000
"""Runs of an ensemble."""
HEAVY = 0.1
"""Range of the first members' values over their median from which as many again are run: the median
of five is then uncertain by some percent, and a sixth member lies outside of their range in one
case out of three."""
LEAST_MEMBERS = 5
"""Least number of members by which `tails_are_heavy` can judge."""
LIVES_A_POINT = 48
"""Largest number of lives of a point."""
KEYS = {
    "name": "names the folder of the results: letters, digits, '.', '_' or '-'",
    "title": "one line for people",
    "pictures": "of single runs: all (default) or none",
    "conclusion": "the command that sums the whole study up, as python3 -m damage lives",
    "states": (
        'damage states of fragility curves, as ["moderate: max_psi > 2"]: columns of summary.csv'
        " and levels"
    ),
    "intensity": "column of summary.csv that fragility curves are fitted against",
    "runs": "points of the study, one table [[runs]] each",
    "grid": "points of the study, every combination of the values in `vary` in a table [[grid]]",
}
ENTRY_KEYS = {
    "id": "name of the point; without it, one is made of wall and options",
    "wall": "wall file, beside the study or in the repository, like walls/symmetric.py",
    "options": (
        "the run's command-line options without their dashes, or the list of words of a command"
        " line"
    ),
    "solvers": "which solvers the point is for (default both)",
    "members": (
        "an ensemble in the reference solver: how many runs, whose joints' strengths scatter a"
        " little"
    ),
    "scatter": f"of members: coefficient of variation of the strengths (default {SCATTER:g})",
    "samples": (
        "an ensemble in the reference solver: draws of the joints' strengths and of the inputs of"
        " the wall; needs strength-cov or inputs"
    ),
    "lives": "an ensemble in the reference solver: lives 1, 2, ... at the address of the options",
}
GRID_KEYS = {
    "vary": "of a grid: lists of values by name; {name} in a string stands for the value",
    "rows": (
        "of a grid: a CSV table of values that belong together, as records and windows; its columns"
        " are names"
    ),
}
"""The keys of a study file and their meanings; `damage.applications.studies.schema` passes them to
editors."""

ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
LONGEST_ID = 120  # characters; file names end at 255 and tables add theirs


@dataclass(frozen=True)
class StudyRun:
    """One point of a study in one solver: a run, or an ensemble of them.

    point: unique in the study, fit for file names.
    wall: the wall file; options: (name, value) of each option of its run, as of
    `damage.run.options.settings_of`. Paths within the repository are relative to it, others
    absolute.
    varied: name of the option that has the number 1, 2, ... of each member; empty for a single run.
    members: their number; adaptive: one only where no joint fails in the first; offset: the
    option's value is so much larger.
    entry: id of the entry of the study that it comes from, which several points of lives share.
    """

    point: str
    wall: str
    options: tuple[tuple[str, object], ...]
    solver: str = "yade"
    varied: str = ""
    members: int = 1
    adaptive: bool = False
    offset: int = 0
    entry: str = ""

    def __post_init__(self):
        if not ID.fullmatch(self.id) or len(self.id) > LONGEST_ID:
            raise InputError(
                f"run id {self.id!r}: expected at most {LONGEST_ID} letters, digits, '.', '_' "
                "or '-', since it names files; correct it"
            )

    @property
    def id(self):
        """The point with the solver's name: unique in every batch, names files."""
        return f"{self.point}_{self.solver}"

    @property
    def most_members(self):
        """How many runs an ensemble may come to, twice `members` where their tails are heavy; 1 of
        a single run."""
        return 2 * self.members if self.adaptive and self.members >= LEAST_MEMBERS else self.members

    def runs_needed(self, records):
        """Number of runs that it needs, from the results so far.

        records: {number from 1: record (`damage.applications.studies.records`)} of its runs so far.
        Of an adaptive ensemble the first is the only one where it breaks no joint: the wall was
        linear, and strengths change nothing; and there are as many again where the first spread
        widely.
        """
        if not self.adaptive:
            return self.members
        first = [
            records[number]["row"] for number in range(1, self.members + 1) if number in records
        ]
        if 1 not in records or records[1]["intact"]:
            return 1
        is_heavy = len(first) == self.members and tails_are_heavy(first)
        return self.most_members if is_heavy else self.members

    def runs_at_most(self, records):
        """Number of runs that it may come to, from the results so far, as of `runs_needed`."""
        needed = self.runs_needed(records)
        is_settled = 1 in records and (needed == 1 or len(records) >= self.members)
        return needed if is_settled or not self.adaptive else self.most_members

    def name(self, number):
        """Name of the run with this number, from 1."""
        return f"{self.id}_s{number}" if self.varied else self.id

    def options_of(self, number, root=Path()):
        """{name: value} of the options of the run with this number; root: the repository, which
        relative paths start from, where that is not the working folder."""
        options = with_paths(dict(self.options), lambda path: str(root / path))
        return options | ({self.varied: self.offset + number} if self.varied else {})

    def settings(self, root=Path(), number=1, prog="study", more=MappingProxyType({})):
        """RunSettings of the run with this number; prog: what stands before its options in their
        `command`; more: further options.  Raises InputError where the options or a record are not
        accepted."""
        return settings_of(self.options_of(number, root) | more, prog, self.solver)


def tails_are_heavy(rows):
    """Whether the rows of an ensemble's members (of `damage.measure.tables.summary_row`), at least
    LEAST_MEMBERS, spread so much.

    >>> drifts = [1.00e-3, 1.01e-3, 1.02e-3, 1.03e-3, 1.05e-3]
    >>> rows = [{"max_DI": 0.1, "max_drift_ratio": drift} for drift in drifts]
    >>> tails_are_heavy(rows)
    False
    >>> tails_are_heavy([rows[0] | {"max_drift_ratio": 0.9e-3}, *rows[1:]])
    True
    """
    return any(
        np.ptp(values) > HEAVY * abs(np.median(values))
        for values in ([row[name] for row in rows] for name in ("max_DI", "max_drift_ratio"))
    )


@dataclass(frozen=True)
class Study:
    """A study: name, title, file, runs of a solver ("yade", "reference" or "both"), runs of both
    solvers, and whether pictures of runs are made."""

    name: str
    title: str
    path: Path
    solver: str
    runs: tuple[StudyRun, ...]
    of_both: tuple[StudyRun, ...] = ()
    pictures: str = "all"
    conclusion: str | None = None

    def __post_init__(self):
        if not isinstance(self.name, str) or not ID.fullmatch(self.name):
            raise InputError(
                f"{self.path}: name = {self.name!r}; expected letters, digits, '.', '_' or '-', "
                "since it names a folder; rename the study"
            )
        if self.pictures not in PICTURES:
            raise InputError(
                f"{self.path}: pictures = {self.pictures!r}; expected {' or '.join(PICTURES)};"
                " correct it"
            )
        if self.conclusion is not None and not CONCLUSION.fullmatch(str(self.conclusion)):
            raise InputError(
                f"{self.path}: conclusion = {self.conclusion!r}; expected a command of this"
                " software, as python3 -m damage lives; correct it, or leave it out"
            )
        if not self.of_both:
            raise InputError(
                f"{self.path}: no runs; expected at least one table [[runs]] or [[grid]]; add one"
            )
        if not self.runs:
            raise InputError(
                f"{self.path}: no run is for this solver; expected --solver "
                f"{self.of_both[0].solver}; choose it"
            )
        first = {}
        for number, run in enumerate(self.runs, start=1):
            if first.setdefault(run.id, number) != number:
                raise InputError(
                    f"{self.path}: runs {first[run.id]} and {number} are both {run.id}; "
                    "expected different runs; take one out, or give them an id each"
                )


def load_study(path, solver="reference", root=None):
    """Read and check the study file at `path`, with the options of every run.

    solver: "yade", "reference", or "both", which makes every run twice; root: the repository, where
    walls and records are that do not lie beside the study file, None for the working folder.
    Raises InputError where a key, option or file is not valid.
    """
    return study_of(read_toml(path, *STUDY_FILE), path, solver, root)


def study_of(table, path, solver="reference", root=None):
    """The Study of a table as a study file has it; path: of that file, beside which files are
    looked for; otherwise as `load_study`."""
    path = Path(path).absolute()
    root = Path(root or ".").resolve()
    find = partial(_find, path.parent, root)
    with _named(path):
        _check_keys(table, KEYS)
    choices_in(table, path)
    runs = []
    for where, entry, is_grid in _entries(table, path):
        with _named(where):
            _check_keys(entry, ENTRY_KEYS | GRID_KEYS if is_grid else ENTRY_KEYS)
            points = _points(entry, find, root) if is_grid else [entry]
            runs += [(run, where) for point in points for run in _load_entry(point, find)]
    chosen = [(run, where) for run, where in runs if solver in ("both", run.solver)]
    study = Study(
        name=table.get("name"),
        title=str(table.get("title", "")),
        path=path,
        solver=solver,
        runs=tuple(run for run, _ in chosen),
        of_both=tuple(run for run, _ in runs),
        pictures=table.get("pictures", "all"),
        conclusion=table.get("conclusion"),
    )
    for run, where in chosen:  # last, as each may read a record
        with _named(where):
            _try_options(run, root)
    return study


@contextmanager
def _named(where):
    """Begin the message of every InputError with where the mistake is, while this lasts."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def _check_keys(table, known):
    if unknown := sorted(set(table) - set(known)):
        raise InputError(
            f"unknown key {unknown[0]!r}; expected {', '.join(sorted(known))}; take it out or"
            f" correct its spelling{did_you_mean(unknown[0], known)}"
        )


def _entries(table, path):
    """Yield (position in the file, table, whether it is a grid) of runs, then of grids."""
    for kind, what in (("runs", "run"), ("grid", "grid")):
        tables = table.get(kind, [])
        if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
            raise InputError(
                f"{path}: {kind} is no list of tables; expected one [[{kind}]] for each; write them"
            )
        for number, entry in enumerate(tables, start=1):
            yield f"{path}, {what} {number}", entry, kind == "grid"


def _points(grid, find, root):
    """Tables of the points that a grid stands for."""
    if "rows" not in grid:
        return expand(grid)
    if not isinstance(grid["rows"], str):
        raise InputError(f"rows = {grid['rows']!r}; expected the path of a CSV table; correct it")
    path = root / find(grid["rows"])
    with _named("rows"):
        rows = read_rows(path)
    return expand(grid, rows)


def _load_entry(table, find):
    """The StudyRuns of one point, in each of its solvers."""
    if not isinstance(table.get("wall"), str):
        raise InputError(
            f'wall = {table.get("wall")!r}; expected a path like "walls/symmetric.py"; give one'
        )
    solvers = table.get("solvers", list(SOLVERS))
    if not isinstance(solvers, list) or not solvers or not set(solvers) <= set(SOLVERS):
        raise InputError(
            f"solvers = {solvers!r}; expected a list of {' and '.join(SOLVERS)}; correct it"
        )
    options = option_table(table.get("options", {}))
    if reserved := [name for name in options if name in RESERVED_OPTIONS]:
        raise InputError(f"--{reserved[0]} is set by the batch itself; take it out")
    wall = find(table["wall"])
    options = with_paths(options, find)
    name = table.get("id", run_name(wall, options))
    drawn = {"samples", "lives"} & set(table)
    solvers = [
        solver for solver in SOLVERS if solver in solvers and not (solver == "yade" and drawn)
    ]
    if not solvers:
        raise InputError(
            "solvers = ['yade'] with samples or lives, which the reference solver runs; take"
            " solvers out"
        )
    given = tuple(options.items())
    runs = [StudyRun(name, wall, given, solver, entry=name) for solver in solvers]
    return [part for run in runs for part in _ensemble(table, run)]


def _ensemble(table, run):
    """The StudyRuns that a StudyRun without scatter becomes by `members`, `samples` or `lives`; of
    lives several, so that a shard need not have all of them."""
    given = [name for name in ("members", "samples", "lives") if name in table]
    if len(given) > 1:
        raise InputError(
            f"{given[0]} and {given[1]} given together; expected one kind of ensemble, leave the"
            " other out"
        )
    if "scatter" in table and "members" not in table:
        raise InputError("scatter without members; expected both; add members = 5")
    for name in given:
        check_whole(name, table[name], 1, MOST_MEMBERS)
    size = table.get("scatter", SCATTER)
    if type(size) not in (int, float) or not size > 0:
        raise InputError(
            f"scatter = {size!r}; expected a number above zero, like 0.001; correct it"
        )
    if run.solver == "yade" or not given:
        return [run]
    count = table[given[0]]
    if "members" in table:
        options = (*run.options, ("scatter", size))
        return [replace(run, options=options, varied="seed", members=count, adaptive=True)]
    if "samples" in table:
        return [replace(run, varied="strength_seed", members=count)]
    return [
        replace(
            run,
            point=f"{run.point}_from{first}",
            varied="life",
            members=min(LIVES_A_POINT, count + 1 - first),
            offset=first - 1,
        )
        for first in range(1, count + 1, LIVES_A_POINT)
    ]


def option_table(options):
    """{name: value} of the options of a run from a table, or from a list of words; lists become
    tuples.

    >>> option_table({"harmonic": [0.2, 0.05], "rest": 1.0})
    {'harmonic': (0.2, 0.05), 'rest': 1.0}
    >>> option_table(["--harmonic", 0.2, 0.05, "--free-vibration"])
    {'harmonic': (0.2, 0.05), 'free-vibration': True}
    """
    if isinstance(options, list):
        options = _of_words(options)
    if not isinstance(options, dict):
        raise InputError(
            f"options = {options!r}; expected a table or a list of words; write "
            "options = { rest = 1 }"
        )
    table = {
        name: tuple(value) if isinstance(value, list) else value for name, value in options.items()
    }
    for name, value in table.items():
        for item in (
            value if isinstance(value, tuple) else () if isinstance(value, bool) else (value,)
        ):
            if isinstance(item, bool) or not isinstance(item, (str, int, float)):
                raise InputError(f"{name} holds {item!r}; expected numbers and strings; correct it")
    return table


def _of_words(words):
    """The table of options that a list of words stands for."""
    table = {}
    for word in words:
        if isinstance(word, str) and word.startswith("--"):
            name, _, value = word[2:].partition("=")
            table[name] = [*table.get(name, ()), *filter(None, [value])]
        elif table:
            table[name].append(word)
        else:
            raise InputError(
                f"options begin with {word!r}; expected an option like --rest; correct it"
            )
    return {
        name: values[0] if len(values) == 1 else values or True for name, values in table.items()
    }


def _candidates(path, folder, root):
    """Possible paths of a file: beside the study, in the repository, among shipped files by path or
    by name."""
    yield from (folder / path, root / path)
    yield from filter(
        None, (shipped_path(path), shipped_walls().get(path), shipped_records().get(path))
    )


def _find(folder, root, paths):
    """The path of a file, or of the first of several (a tuple), that is beside the study, in the
    repository or among what ships: relative within the repository, else absolute."""
    paths = paths if isinstance(paths, tuple) else (paths,)
    for path in paths:
        check_path(path)
        for candidate in _candidates(path, folder, root):
            if is_there(candidate):
                whole = candidate.resolve()
                return str(whole.relative_to(root) if whole.is_relative_to(root) else whole)
    known = [*shipped_walls(), *shipped_records()]
    raise InputError(
        f"no file {' or '.join(paths)}; expected one beside the study or in the"
        " repository, or the name of a wall or record that ships"
        f"{did_you_mean(Path(*paths[:1]).stem, known)}"
    )


def _try_options(run, root):
    """Check the options by the parser of a run, those of the first member included."""
    if taken := [name for name, _ in run.options if name.replace("-", "_") == run.varied]:
        raise InputError(f"--{taken[0]} is set by members, samples or lives; take it out")
    settings = run.settings(root)
    if run.varied == "strength_seed" and not settings.model.draws:
        raise InputError(
            "samples of walls that do not differ; expected strength-cov = 0.3, or inputs ="
            ' "typical", among the options; add one of them'
        )


def with_paths(options, change):
    """The options of a run, {name: value}, with each that names a file replaced by
    change(value)."""
    return {
        name: change(value) if names_file(name, value) else value for name, value in options.items()
    }


def run_name(wall, options):
    """A name of a run fit for a file name: its wall, then each option with its values.

    >>> run_name("walls/solid.py", {"record": "data/BGAR.csv", "scale": 2})
    'solid_record-BGAR_scale-2'
    """
    shown = words_of(
        {
            name: Path(value).stem if names_file(name, value) else value
            for name, value in options.items()
        }
    )
    parts = [Path(wall).stem]
    for word in shown:
        if word.startswith("--"):
            parts.append(word[2:])
        else:
            parts[-1] += f"-{word}"
    name = "_".join(re.sub(r"[^A-Za-z0-9._-]+", "-", part) for part in parts)
    if len(name) <= LONGEST_ID - 12:
        return name
    digest = hashlib.sha256("\0".join((wall, *words_of(options))).encode()).hexdigest()[:8]
    return f"{name[: LONGEST_ID - 24]}_{digest}"
