"""Arguments of command lines: a parser whose complaints are InputErrors, types of values, and
functions that add an argument to a parser or a group of one."""

import argparse
import re
import sys
from itertools import takewhile

from damage.checks import check_path
from damage.errors import InputError, did_you_mean

WALLS_ARE_CODE = (
    "A wall file is Python and is executed: read a file from someone else before you use it."
)
"""For the help of every command that takes one."""


class _Help(argparse.HelpFormatter):
    """Help whose texts of several lines, as examples are, stand as they are."""

    def _fill_text(self, text, width, indent):
        return text if "\n" in text else super()._fill_text(text, width, indent)


class OneLineParser(argparse.ArgumentParser):
    """An argument parser that raises its complaint as InputError instead of printing the usage.

    examples: command lines, which its help ends with; groups: {title: group of arguments} that
    `group` has added.
    """

    def __init__(self, *args, examples=(), **kwargs):
        self.examples = examples
        self.groups = {}
        more = {"epilog": "\n  ".join(["examples:", *examples])} if examples else {}
        super().__init__(*args, **{"formatter_class": _Help, **more, **kwargs})
        # argparse takes -1e-5 for an option; it is a number.
        self._negative_number_matcher = re.compile(r"^-(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$")

    def parse_known_args(self, args=None, namespace=None):
        """Refuse an unknown option first, since it may be the wrong name of one that is required;
        else argparse's."""
        args = sys.argv[1:] if args is None else list(args)
        # Behind a command they are the command's.
        mine = takewhile(
            lambda word: word.startswith("-") if self._subparsers else word != "--", args
        )
        for name in (word.partition("=")[0] for word in mine if word.startswith("--")):
            if name != "--" and name not in self._option_string_actions:
                self.error(
                    "unrecognized arguments:"
                    f" {name}{did_you_mean(name, self._option_string_actions)}"
                )
        return super().parse_known_args(args, namespace)

    def error(self, message):
        raise InputError(f"{message}{' ' if message.endswith('?') else '; '}see --help")


def file_path(word):
    """The type of an option that names a file or a folder."""
    try:
        return check_path(word)
    except InputError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def number_from(least, most, kind=float):
    """The type of an option that is a number from `least` to `most`; kind: int for a whole one."""

    def convert(word):
        value = kind(word)
        if not least <= value <= most:
            raise argparse.ArgumentTypeError(
                f"{word}: expected a number from {least:g} to {most:g}; correct it"
            )
        return value

    convert.__name__ = kind.__name__  # for what argparse says of a word that is none
    return convert


def arg(name, help_=None, metavar=None, type_=None, **options):
    """A function that adds this argument to a parser, or a group of one, as `add_argument` takes
    it."""
    more = {"help": help_, "metavar": metavar, "type": type_}
    return lambda parser: parser.add_argument(name, **more, **options)


def file_arg(name, metavar, help_=None, **options):
    """An `arg` that is a path."""
    return arg(name, help_, metavar, file_path, **options)


def flag(name, help_, action="store_true", **options):
    """An option without a value."""
    return lambda parser: parser.add_argument(name, help=help_, action=action, **options)


def group(title, *arguments):
    """A function that adds these arguments to the group of a OneLineParser with this title, and
    returns their actions."""

    def add(parser):
        if title not in parser.groups:
            parser.groups[title] = parser.add_argument_group(title)
        return [argument(parser.groups[title]) for argument in arguments]

    return add


class Rows(argparse.Action):
    """The action of an option of several numbers that may be repeated: their list."""

    def __call__(self, parser, namespace, values, option_string=None):
        """Add the numbers to those before."""
        setattr(namespace, self.dest, [*(getattr(namespace, self.dest) or []), values])


def fraction(word):
    """The type of an option that is a number, or two with a stroke between, like 1/500."""
    over, _, under = word.partition("/")
    try:
        return float(over) / (float(under) if under else 1.0)
    except (ValueError, ZeroDivisionError) as error:
        raise argparse.ArgumentTypeError(
            f"{word}: expected a number, or a fraction like 1/500; correct it"
        ) from error


def numbers(word):
    """The type of an option of several numbers with commas between them."""
    try:
        return tuple(map(float, word.split(",")))
    except ValueError as error:
        raise argparse.ArgumentTypeError(
            f"{word}: expected numbers with commas between, like 1,0.5,0.4; correct it"
        ) from error
