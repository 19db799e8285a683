"""The table of commands, and what they share: arguments, and how they print and save what they found."""

import io
import sys

from damage.errors import one_line
from damage.files import json_text
from damage.run.options import file_path, number_from

COMMANDS = {}
"""Name -> (function of the parsed options, what it is for, functions that add an argument to its parser)."""


class Silence(io.StringIO):
    """A stream that discards its output."""


def command(purpose, *arguments, table=COMMANDS):
    """Make a function the command of its name, in this table."""
    def keep(function):
        table[function.__name__.strip("_").replace("_", "-")] = function, purpose, arguments
        return function
    return keep


def arg(*names, **options):
    """A function that adds this argument to a parser, as `add_argument` takes it."""
    return lambda command: command.add_argument(*names, **options)


def group(title, *arguments):
    """A function that adds these arguments to the group of a parser with this title."""
    def add(command):
        named = (one for one in command._action_groups if one.title == title)
        titled = next(named, None) or command.add_argument_group(title)
        for one in arguments:
            one(titled)
    return add


def file_arg(name, metavar, help_=None, **options):
    """The same of a path."""
    return arg(name, type=file_path, metavar=metavar, help=help_, **options)


def output(*arguments):
    """The same of what a command writes."""
    return group("output", *arguments)


def out(help_, metavar="DIR", required=True):
    """The option --out."""
    return output(file_arg("--out", metavar, help_, required=required))


HISTORY = file_arg("history", "FILE.h5")


HISTORIES = file_arg("histories", "FILE.h5", nargs="+")


JSON = output(arg("--json", action="store_true", help="as JSON"))


DAMAGE = "what counts as damage"


DRIFT_LIMIT = group(DAMAGE, arg("--drift-limit-pct", type=number_from(1e-6, 100), default=2.0, metavar="PCT",
                                help="drift limit (default 2)"))


def threshold(of):
    """The option --threshold-mm; of: what exceeds it."""
    return group(DAMAGE, arg("--threshold-mm", type=number_from(1e-6, 1000), default=0.1, metavar="MM",
                             help=f"of {of} (default 0.1)"))


PSI_FROM = group(DAMAGE, arg("--psi-from-mm", type=number_from(1e-6, 1000), default=0.02, metavar="MM",
                             help="width from which a crack counts in Psi (default 0.02; 0.1 is what an eye sees)"))


def show(asked, found, describe):
    """Print what a command found, as JSON where that was asked for; describe(found): text."""
    print(json_text(found, indent=2) if asked.json else "\n".join(map(one_line, describe(found).split("\n"))))


def save(figures, folder, made=""):
    """Write figures, pairs (name, Figure), with the command that made them; print their paths to stderr, because stdout
    may be JSON."""
    from damage.draw.style import save_figures

    for path in save_figures(figures, folder, made):
        if not isinstance(sys.stdout, Silence):
            print(f"picture: {path}", file=sys.stderr)
