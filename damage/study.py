"""Studies: files that list runs as data, for batches.

A study is a TOML file:

    name = "quick"
    title = "one line for people"      # optional

    [[runs]]
    wall = "walls/symmetric.py"
    options = { harmonic = [0.2, 0.05], rest = 1.0 }

`options` is a table of the run's command-line options without their dashes (true stands for an
option without a value), or the list of words of a command line.  A run may have an `id` of its own;
otherwise one is made of its wall and options.  Paths are looked for beside the study file, then in
the repository.
"""

import hashlib
import re
import tomllib
from dataclasses import dataclass
from pathlib import Path

from damage.errors import InputError
from damage.options import parse_run

PATH_OPTIONS = ("--record", "--vertical")
RESERVED_OPTIONS = ("--out", "--overwrite", "--no-pictures", "--view", "--help", "-h")
"""Options of a run that the batch sets by itself, or that mean nothing in one."""

REPOSITORY = Path(__file__).resolve().parents[1]
_ID = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
_LONGEST_ID = 120  # characters; file names end at 255 and tables add theirs


@dataclass(frozen=True)
class StudyRun:
    """One run of a study.

    id: unique in the study, fit for file names, ends with the solver's name.
    wall: the wall file; words: the rest of its command line.  Paths within the repository are
    relative to it, others absolute.
    """

    id: str
    wall: str
    words: tuple[str, ...]
    solver: str = "yade"

    def __post_init__(self):
        if not _ID.fullmatch(self.id) or len(self.id) > _LONGEST_ID:
            raise InputError(f"run id {self.id!r}: expected at most {_LONGEST_ID} letters, digits, '.', '_' "
                             "or '-', since it names files; mend it")

    def digests(self, root=REPOSITORY):
        """SHA-256 of every file that the run reads, in a fixed order: what changes when they do."""
        paths = [self.wall] + [word for option, word in zip(self.words, self.words[1:])
                               if option in PATH_OPTIONS]
        return [hashlib.sha256((root / path).read_bytes()).hexdigest() for path in paths]


@dataclass(frozen=True)
class Study:
    """A study: its name, one line about it, its file and its runs."""

    name: str
    title: str
    path: Path
    runs: tuple[StudyRun, ...]

    def __post_init__(self):
        if not isinstance(self.name, str) or not _ID.fullmatch(self.name):
            raise InputError(f"{self.path}: name = {self.name!r}; expected letters, digits, '.', '_' or '-', "
                             "since it names a folder; rename the study")
        if not self.runs:
            raise InputError(f"{self.path}: no runs; expected at least one table [[runs]]; add one")
        _check_ids_differ(self)


def _check_ids_differ(study):
    first = {}
    for number, run in enumerate(study.runs, start=1):
        if run.id in first:
            raise InputError(f"{study.path}: runs {first[run.id]} and {number} are both {run.id}; "
                             "expected different runs; take one out, or give them an id each")
        first[run.id] = number


def load_study(path, solver="yade", root=REPOSITORY):
    """Read and check the study file at `path`; every run's options are tried now, not after hours.

    solver: "yade", "reference", or "both", which makes every run twice.
    Raises InputError, which says what came, what was expected and how to mend it.
    """
    path = Path(path).absolute()
    table = _read_toml(path)
    _check_keys(table, {"name", "title", "runs"}, f"{path}")
    runs = table.get("runs", [])
    if not isinstance(runs, list) or not all(isinstance(run, dict) for run in runs):
        raise InputError(f"{path}: runs is no list of tables; write one [[runs]] for each run")
    return Study(name=table.get("name"), title=str(table.get("title", "")), path=path,
                 runs=tuple(_load_run(run, f"{path}, run {number}", path.parent, name, root)
                            for number, run in enumerate(runs, start=1)
                            for name in (("yade", "reference") if solver == "both" else (solver,))))


def _read_toml(path):
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; give the path of a study file (.toml)") from error
    except ValueError as error:  # of TOML or of UTF-8
        raise InputError(f"{path} is no TOML ({error}); mend the file") from error


def _check_keys(table, known, where):
    unknown = sorted(set(table) - known)
    if unknown:
        raise InputError(f"{where}: unknown key {unknown[0]!r}; expected {', '.join(sorted(known))}; "
                         "take it out or mend its spelling")


def _load_run(table, where, folder, solver, root):
    _check_keys(table, {"id", "wall", "options"}, where)
    if not isinstance(table.get("wall"), str):
        raise InputError(f"{where}: wall = {table.get('wall')!r}; expected a path like "
                         '"walls/symmetric.py"; give one')
    words = option_words(table.get("options", {}), where)
    wall = _find(table["wall"], where, folder, root)
    words = [_find(word, where, folder, root) if option in PATH_OPTIONS else word
             for option, word in zip(["", *words], words)]
    _try_options(words, where, solver)
    wall, *words = (_shorten(word, root) for word in (wall, *words))
    name = table.get("id", None if "id" in table else run_name(wall, words))
    try:
        return StudyRun(id=f"{name}_{solver}", wall=wall, words=tuple(words), solver=solver)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def option_words(options, where="options"):
    """The words of a command line from a table of options or a list of words.

    >>> option_words({"harmonic": [0.2, 0.05], "rest": 1.0})
    ['--harmonic', '0.2', '0.05', '--rest', '1.0']
    """
    if isinstance(options, dict):
        return [word for name, value in options.items() for word in _option(name, value, where)]
    if not isinstance(options, list):
        raise InputError(f"{where}: options = {options!r}; expected a table or a list of words; write "
                         "options = { rest = 1 }")
    words = [_word(value, "options", where) for value in options]
    return [part for word in words for part in (word.split("=", 1) if word.startswith("--") else [word])]


def _option(name, value, where):
    if value is False:
        return []
    values = [] if value is True else value if isinstance(value, list) else [value]
    return [f"--{name}", *(_word(one, name, where) for one in values)]


def _word(value, name, where):
    if isinstance(value, bool) or not isinstance(value, (str, int, float)):
        raise InputError(f"{where}: {name} holds {value!r}; expected numbers and strings; mend it")
    return str(value)


def _find(path, where, folder, root):
    """The absolute path of a file named beside the study or in the repository."""
    for candidate in (folder / path, root / path):
        if candidate.is_file():
            return str(candidate.resolve())
    raise InputError(f"{where}: no file {path} beside the study or in the repository; mend the path")


def _shorten(word, root):
    """A path within the repository relative to it; any other word as it is."""
    inside = Path(word).is_absolute() and Path(word).is_relative_to(root)
    return str(Path(word).relative_to(root)) if inside else word


def _try_options(words, where, solver):
    reserved = [word for word in words if word in RESERVED_OPTIONS]
    if reserved:
        raise InputError(f"{where}: {reserved[0]} is set by the batch itself; take it out")
    try:
        parse_run(words, prog="study", solver=solver)
    except InputError as error:
        raise InputError(f"{where}: {error}") from error


def run_name(wall, words):
    """A name of a run fit for a file name: its wall, then each option with its values.

    >>> run_name("walls/solid.py", ["--record", "data/BGAR.csv", "--scale", "2"])
    'solid_record-BGAR_scale-2'
    """
    parts = [Path(wall).stem]
    for option, word in zip(["", *words], words):
        if word.startswith("--"):
            parts.append(word[2:])
        else:
            parts[-1] += "-" + (Path(word).stem if option in PATH_OPTIONS else word)
    name = "_".join(re.sub(r"[^A-Za-z0-9._-]+", "-", part) for part in parts)
    if len(name) <= _LONGEST_ID - 12:
        return name
    digest = hashlib.sha256("\0".join((wall, *words)).encode()).hexdigest()[:8]
    return f"{name[:_LONGEST_ID - 24]}_{digest}"
