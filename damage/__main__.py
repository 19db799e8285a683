# PYTHON_ARGCOMPLETE_OK
"""`python3 -m damage COMMAND`: run a wall in the reference solver; read histories, records,
studies, without YADE."""

import os
import sys

from damage.start import begin, leave, reported

if __name__ == "__main__":
    # runs side by side use the processors, not linear algebra, whose threads no fork survives
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    begin()  # before what takes its time to import

import logging
from contextlib import nullcontext, redirect_stdout
from pathlib import Path

import damage.applications  # noqa: F401, each adds what it has
import damage.commands  # noqa: F401, fills the table
from damage.applications import GROUPS
from damage.arguments import OneLineParser
from damage.commands.table import COMMANDS, PROGRAMS, Silence, examples_of
from damage.errors import InputError, did_you_mean
from damage.memory import hold_buffers
from damage.provenance import commit, shown_path
from damage.run.options import make_parser
from damage.version import VERSION

# where no folder takes its cache it warns at length
logging.getLogger("matplotlib").setLevel(logging.ERROR)

HELP = "the options of a command, with examples: help index"


def main(arguments=None):
    """Run one command; returns the exit status: 0 done, 1 out of memory, or `check` found a file
    without an end, 2 bad input, 3 a library is missing."""
    arguments = sys.argv[1:] if arguments is None else list(arguments)
    quiet = "--quiet" in arguments and not {"-h", "--help", "help"} & set(arguments)
    arguments = [word for word in arguments if word != "--quiet"]
    if "_ARGCOMPLETE" in os.environ:
        import argcomplete

        # completes the line for a shell, then exits
        argcomplete.autocomplete(command_parser(whole=True))
    with redirect_stdout(Silence()) if quiet else nullcontext():
        return reported(lambda: _run(arguments, quiet))


def _run(arguments, quiet):
    if arguments[:1] == ["help"]:
        arguments = [*(name for name in arguments[1:2] if name != "help"), "--help"]
    if arguments and arguments[0] in PROGRAMS:
        return PROGRAMS[arguments[0]].function(arguments[1:], quiet)
    if arguments == ["--version"]:
        print(f"masonry-damage {VERSION}, commit {commit()}")
        return 0
    hold_buffers()
    if arguments and not arguments[0].startswith("-") and arguments[0] not in COMMANDS:
        known = sorted({*COMMANDS, *PROGRAMS, "help"})
        raise InputError(
            f"no command {arguments[0]!r}: expected one of {', '.join(known)}"
            f"{did_you_mean(arguments[0], known)}"
        )
    parser = command_parser()
    asked = parser.parse_args(arguments)
    _keep_sources(parser._subparsers._group_actions[0].choices[arguments[0]], asked)
    if getattr(asked, "style", None):
        from damage.draw.style import printed  # matplotlib starts slowly

        with printed(asked.style):
            return asked.command(asked) or 0
    return asked.command(asked) or 0


def _keep_sources(parser, asked):
    """Raise InputError where a command would overwrite a file that it reads; asked: its options,
    as its parser returns them."""
    written = {
        action.dest
        for group in parser._action_groups
        if group.title == "output"
        for action in group._group_actions
    }
    paths = {True: set(), False: set()}
    for name, value in vars(asked).items():
        for entry in value if isinstance(value, list) else [value]:
            if isinstance(entry, Path) and entry.is_file():
                paths[name in written].add(entry.resolve())
    for path in paths[True] & paths[False]:
        raise InputError(
            f"{shown_path(path)} is read by this command and would be overwritten; expected another"
            " file for the output; choose another name"
        )


class _Parser(OneLineParser):
    """The parser of all commands, whose help lists them in groups."""

    def format_help(self):
        formatter = self._get_formatter()
        formatter.add_usage(self.usage, self._actions, self._mutually_exclusive_groups)
        formatter.add_text(self.description)
        listed = {
            action.dest: action for action in self._subparsers._group_actions[0]._choices_actions
        }
        others = [name for name in listed if not any(name in names for names in GROUPS.values())]
        for title, names in {**GROUPS, "other commands": others}.items():
            formatter.start_section(title)
            formatter.add_arguments([listed[name] for name in names])
            formatter.end_section()
        formatter.start_section("options")
        formatter.add_arguments(self._optionals._group_actions)
        formatter.end_section()
        formatter.add_text(self.epilog)
        return formatter.format_help()


def command_parser(whole=False):
    """The parser of all commands; whole: with the options of `reference`, which has a parser of its
    own."""
    parser = _Parser(
        prog="python3 -m damage",
        allow_abbrev=False,
        examples=["python3 -m damage demo", "python3 -m damage help reference"],
        description=(
            f"Damage of masonry walls under induced seismicity: masonry-damage {VERSION}. Installed"
            " by pip, it is also the command damage, or masonry-damage."
        ),
    )
    parser.add_argument(
        "--version", action="store_true", help="print the version and the commit, and end"
    )
    parser.add_argument(
        "--quiet", action="store_true", help="anywhere: print warnings and errors only"
    )
    commands = parser.add_subparsers(
        title="commands", required=True, metavar="COMMAND", parser_class=OneLineParser
    )
    run = {"reference": [make_parser("reference", "reference")]} if whole else {}
    for name, command in PROGRAMS.items():
        commands.add_parser(
            name, help=command.purpose, parents=run.get(name, []), conflict_handler="resolve"
        )
    commands.add_parser("help", help=HELP)
    add_commands(commands, COMMANDS)
    return parser


def add_commands(commands, table):
    """Add a parser for each command of a table to the subparsers of a program."""
    for name, entry in table.items():
        command = commands.add_parser(
            name,
            help=entry.purpose,
            description=entry.purpose,
            allow_abbrev=False,
            examples=examples_of(name, table),
        )
        command.set_defaults(command=entry.function)
        for add in entry.arguments:
            add(command)


if __name__ == "__main__":
    leave(main())
