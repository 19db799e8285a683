"""Provenance of a result: version and commit of this software, and digests of the code that decides
its values."""

import ast
import hashlib
import os
import subprocess
from functools import cache
from pathlib import Path

from damage.version import VERSION

HERE = Path(__file__).parent
RANGES = "data/ranges/ranges.csv"
MODEL = [
    "*.py",
    "house/**/*.py",
    "law/**/*.py",
    "linear/**/*.py",
    "mechanics/**/*.py",
    "motion/**/*.py",
    "run/**/*.py",
    "wall/**/*.py",
    "measure/energy.py",
    RANGES,
]
"""Patterns of the files in this package that decide the values of a run in any solver: modules, and
a table.  Applications add what decides the runs that they make possible, as the motions that they
draw."""
MEASURES = [
    "*.py",
    "history/**/*.py",
    "measure/**/*.py",
    "motion/intensity.py",
    "wall/geometry.py",
]
"""Patterns of the modules that make the numbers of tables out of a history."""
_WITHOUT_EFFECT = "__main__.py", "version.py"  # of the modules beside this one
_SAYING = ("Column", "quantity", "choice", "text")
UNKNOWN = "unknown"


@cache
def commit():
    """The commit that the package is in, "changed" behind it where tracked files differ; "unknown"
    outside git, or where git does not answer."""

    def git(*words):
        return subprocess.run(
            ["git", "-C", HERE, *words],
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
            env=os.environ | {"GIT_OPTIONAL_LOCKS": "0"},
        ).stdout

    try:
        # an installed copy may lie in another repository
        git("ls-files", "--error-unmatch", "__init__.py")
        commit_id = git("rev-parse", "HEAD").strip()
        # `describe --dirty` would write the index, and leave a lock where it may not.
        changed = git("status", "--porcelain", "--untracked-files=no", ":/")
    except (OSError, subprocess.SubprocessError):
        return UNKNOWN
    return f"{commit_id} changed" if changed else commit_id


def versions(solver_folder):
    """{software: version} of this software and of its model in one solver, for a history."""
    return {"masonry-damage": VERSION, "commit": commit(), "model": model_digest(solver_folder)}


def shown_path(path):
    """A path as a file that may be sent keeps it: relative below the working folder, otherwise the
    name alone.

    Where a home folder lies is nobody's business.
    """
    path = Path(path)
    if path.is_relative_to(Path.cwd()):
        path = path.relative_to(Path.cwd())
    return path.name if path.is_absolute() or ".." in path.parts else path.as_posix()


def shown_command(words):
    """The words of a command line in one line, every path as `shown_path` has it.

    >>> words = ["--record", "/elsewhere/a.csv", "--out=/elsewhere/b.h5", "--window", "1", "2"]
    >>> shown_command(words)
    '--record a.csv --out=b.h5 --window 1 2'
    """
    parts = [word.rpartition("=") if word.startswith("--") else ("", "", word) for word in words]
    return " ".join(
        f"{option}{sign}{shown_path(word) if '/' in word else word}" for option, sign, word in parts
    )


def file_origin(path):
    """{"file": name without its folder, which differs by machine, "sha256"} of a file that a run is
    made from."""
    try:
        return {
            "file": Path(path).name,
            "sha256": hashlib.sha256(Path(path).read_bytes()).hexdigest(),
        }
    except OSError:  # a wall that no file made
        return {"file": Path(path).name, "sha256": UNKNOWN}


@cache
def model_digest(solver_folder):
    """Twelve hexadecimal digits of the code of the model in one solver; comments and docstrings do
    not count.

    solver_folder: path of the solver's package, whose modules all count, as do those of `MODEL`.
    """
    return _digest_of([*_modules(MODEL), *sorted(Path(solver_folder).rglob("*.py"))])


@cache
def measures_digest():
    """Twelve hexadecimal digits of the code of index, measures and patterns at rest; comments,
    docstrings and the words of columns do not count."""
    return _digest_of(_modules(MEASURES))


def _digest_of(paths):
    """Twelve hexadecimal digits of the code of these modules, in their order."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(f"{path.name}\0{code_of(path)}\0".encode())
    return digest.hexdigest()[:12]


def _modules(patterns):
    """Paths of the files of this package that match patterns, a list in one order."""
    paths = {path for pattern in patterns for path in HERE.glob(pattern)}
    paths -= {HERE / name for name in _WITHOUT_EFFECT}
    return sorted(paths, key=lambda path: path.relative_to(HERE).parts)


def code_of(path):
    """A module's code without comments, layout and docstrings; a table as it is."""
    text = path.read_text(encoding="utf-8")
    return _code_of_text(text) if path.suffix == ".py" else text


@cache  # digests of two solvers have most modules in common
def _code_of_text(text):
    return ast.dump(_Code().visit(ast.parse(text)))


class _Code(ast.NodeTransformer):
    """Takes out of a module the constants that stand alone and, of columns and fields, what these
    only say: unit, limits, words."""

    def visit_Expr(self, node):
        return None if isinstance(node.value, ast.Constant) else self.generic_visit(node)

    def visit_Call(self, node):
        if getattr(node.func, "id", None) in _SAYING:
            node.args = []
            node.keywords = [keyword for keyword in node.keywords if keyword.arg == "default"]
        return self.generic_visit(node)
