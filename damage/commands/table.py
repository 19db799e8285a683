"""What applications and the core register for `python3 -m damage`, and what commands share:
arguments and printing."""

import io
import sys
from typing import Any, NamedTuple

from damage.arguments import WALLS_ARE_CODE, arg, file_arg, flag, group, number_from
from damage.errors import one_line
from damage.files import json_text


class Command(NamedTuple):
    """A command: function of the parsed options, what it is for, functions that add an argument to
    its parser, and what follows its name in the examples of its help."""

    function: Any
    purpose: str
    arguments: tuple = ()
    examples: tuple = ()


COMMANDS = {}
"""Name -> Command."""
PROGRAMS = {}
"""Name -> Command whose function takes the words behind its name, and whether all is quiet, and
parses them itself."""
DICTIONARY = []
"""Functions that return tables of an application for the data dictionary, as
`damage.measure.dictionary.TABLES` is."""


class Silence(io.StringIO):
    """A stream that discards its output."""


def command(purpose, *arguments, examples=(), table=COMMANDS):
    """Make a function the command of its name, in this table."""

    def keep(function):
        table[_name_of(function)] = Command(function, purpose, arguments, examples)
        return function

    return keep


def program(purpose):
    """Make a function the command of its name that parses its own words."""

    def keep(function):
        PROGRAMS[_name_of(function)] = Command(function, purpose)
        return function

    return keep


def tables(function):
    """Let a function say which tables of an application the data dictionary has."""
    DICTIONARY.append(function)
    return function


def all_tables():
    """The tables of the core and of the applications: {tables, as their files are called: {column:
    Column}}."""
    from damage.measure.dictionary import TABLES

    tables = dict(TABLES)
    for function in DICTIONARY:
        tables |= function()
    return tables


def _name_of(function):
    return function.__name__.strip("_").replace("_", "-")


def output(*arguments):
    """A function that adds these arguments to the group of what a command writes."""
    return group("output", *arguments)


def out(help_, metavar="DIR", required=True):
    """The option --out."""
    return output(file_arg("--out", metavar, help_, required=required))


WALL = file_arg("wall", "WALL", f"a wall file, or the name of a wall that ships. {WALLS_ARE_CODE}")
HISTORY = file_arg("history", "FILE.h5")
HISTORIES = file_arg("histories", "FILE.h5", nargs="+")
JSON = output(flag("--json", "as JSON"))
STYLE = output(
    arg(
        "--style",
        "pictures for print, without titles: in 8 pt, or in a matplotlib style of yours",
        "paper|FILE.mplstyle",
    )
)
"""The option --style of a command that draws; `printed` of `damage.draw.style` follows it."""
DAMAGE = "what counts as damage"


def _limit(option, default, most, metavar, help_):
    """An option of what counts as damage, a number up to the most."""
    type_ = number_from(1e-6, most)
    return group(DAMAGE, arg(option, help_, metavar, type_, default=default))


DRIFT_LIMIT = _limit("--drift-limit-pct", 2.0, 100, "PCT", "drift limit (default 2)")
PSI_FROM = _limit(
    "--psi-from-mm",
    0.02,
    1000,
    "MM",
    "width from which a crack counts in Psi (default 0.02; 0.1 is what an eye sees)",
)


def threshold(what):
    """The option --threshold-mm; of: what exceeds it."""
    return _limit("--threshold-mm", 0.1, 1000, "MM", f"of {what} (default 0.1)")


def show(asked, table, describe):
    """Print what a command found, as JSON where that was asked for; describe(found): text."""
    print(
        json_text(table, indent=2)
        if asked.json
        else "\n".join(map(one_line, describe(table).split("\n")))
    )


def save(figures, folder, made=""):
    """Write figures, pairs (name, Figure), with the command that made them; print their paths to
    stderr, because stdout may be JSON."""
    from damage.draw.style import save_figures

    for path in save_figures(figures, folder, made):
        if not isinstance(sys.stdout, Silence):
            print(f"picture: {path}", file=sys.stderr)


def examples_of(name, table=COMMANDS):
    """Lines of the examples of a command in a table, for its help."""
    return [f"python3 -m damage {name} {line}".rstrip() for line in table[name].examples]
