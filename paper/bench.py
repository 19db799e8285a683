"""What the programs that make tables share: walls as files, runs that a folder keeps, arguments,
tables in Markdown."""

import argparse
import contextlib
import io
import os
import subprocess
import sys
from pathlib import Path

import pandas as pd

from damage.applications.cracks.pushed import TESTS
from damage.files import write_text
from damage.history.reader import read_history
from damage.reference.session import BACKEND, run_references
from damage.run.session import run_session
from damage.start import reported
from damage.wall.file import load_wall, wall_path
from damage.wall.new import as_toml
from damage.wall.parameters import Wall
from yade_scripts import COMMAND

REPOSITORY = Path(__file__).resolve().parents[1]
BGAR = str(REPOSITORY / "damage" / "data" / "zeerijp_20180108" / "BGAR_HGE_acc_m_s2.csv")
FIXED = ["--boundary", "fixed"]
HELD = {"squat_tested": [], "comp2_1": FIXED, "comp2_3": FIXED, "comp2_4": FIXED}
"""Tested wall -> how it is held."""
EXPLICIT = ["--mass-scaling", "none"]
"""Options by which all runs have explicit steps, as those in YADE have."""


def wall_file(path, wall):
    """Write a wall as data (TOML), which both solvers run; returns its path."""
    return write_text(path, as_toml(wall.as_dict() | {"lintel": wall.lintel.as_dict()}))


class Bench:
    """Runs of walls, each kept in a folder: one that is there and complete is not made again."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir(parents=True, exist_ok=True)

    def path(self, *label, ending=".h5"):
        """A file of the folder, called by these words."""
        name = "_".join(str(word).strip("-") for word in label)
        return (
            self.folder
            / f"{''.join(c if c.isalnum() or c in '._-' else '-' for c in name)}{ending}"
        )

    def run(self, wall, words, *label):
        """The History of a wall, a Wall or what `load_wall` takes, in the reference solver; words:
        of the command line; label: by what its file is called beside them."""
        out = self.path(*label, *words)
        source = __file__ if isinstance(wall, Wall) else wall_path(wall)
        if not is_complete(out):
            with silenced() as said:
                status = reported(
                    lambda: run_session(
                        BACKEND,
                        source,
                        lambda: wall if isinstance(wall, Wall) else load_wall(wall),
                        self._words([*EXPLICIT, *words], out),
                        prog="paper",
                    )
                )
            self._check(status, out, said.getvalue())
        return read_history(out)

    def run_in_yade(self, wall, words, *label):
        """Run a wall in YADE."""
        out = self.path("yade", *label, *words)
        if not is_complete(out):
            file = (
                wall_file(out.with_suffix(".toml"), wall)
                if isinstance(wall, Wall)
                else wall_path(wall)
            )
            done = subprocess.run(
                [*COMMAND, file, *self._words(words, out)],
                capture_output=True,
                text=True,
                cwd=REPOSITORY,
                env={**os.environ, "PYTHONPATH": str(REPOSITORY)},
            )
            self._check(done.returncode, out, done.stderr)
        return read_history(out)

    def together(self, runs):
        """Histories of runs that advance eight at a time; runs: {name: [wall file, words, ...]}."""
        paths = {name: self.path(name) for name in runs}
        lines = [
            (name, [str(words[0]), *self._words([*EXPLICIT, *words[1:], "--quiet"], paths[name])])
            for name, words in runs.items()
            if not is_complete(paths[name])
        ]
        with silenced() as said:
            failed = [name for name, status in run_references(iter(lines)) if status != 0]
        self._check(len(failed), ", ".join(failed), said.getvalue())
        return {name: read_history(path) for name, path in paths.items()}

    @staticmethod
    def _words(words, out):
        return [*map(str, words), "--out", str(out.resolve()), "--overwrite", "--no-pictures"]

    @staticmethod
    def _check(status, what, said):
        if status != 0:
            sys.exit(f"{what} failed\n{said[-2000:]}")


def of_test(specimen):
    """The row of a specimen in the table of tests."""
    return pd.read_csv(TESTS).set_index("Specimen").loc[specimen]


def is_complete(path):
    """Whether the history of a whole run is there."""
    return path.exists() and read_history(path).complete


@contextlib.contextmanager
def silenced():
    """Keep what is printed; yields a StringIO that has it."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        yield said


# --- the command line -----------------------------------------------------------------------------


def option(*names, **given):
    """An argument of `arguments`, as argparse takes it."""
    return names, given


def arguments(description, *options):
    """What a command line says of some options; description: the docstring of a program."""
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    for names, given in options:
        parser.add_argument(*names, **given)
    return parser.parse_args()


def chosen(asked, known, what):
    """What was asked for, all that is known where nothing was; ends the program where something is
    unknown."""
    if unknown := [one for one in asked if one not in known]:
        sys.exit(f"error: no {what} {unknown[0]}; expected one of {', '.join(known)}")
    return asked or list(known)


def print_tables(tables, usual, folder, description):
    """Print the tables, {name: function of a Bench}, that a command line asks for; usual: those of
    one that asks for none."""
    parsed = arguments(
        description,
        option("tables", nargs="*", metavar="TABLE", help=", ".join(tables)),
        option("--out", type=Path, default=Path(folder)),
    )
    for name in chosen(parsed.tables, tables, "table") if parsed.tables else usual:
        tables[name](Bench(parsed.out))


# --- tables in Markdown ---------------------------------------------------------------------------


def print_table(*heads):
    print()
    print_row(*heads)
    print_row(*["---"] * len(heads))


def print_row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def show(heads, rows):
    """Print a table, each row once it is there."""
    print_table(*heads)
    for row in rows:
        print_row(*row)
