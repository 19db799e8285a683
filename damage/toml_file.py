"""TOML files of users: walls, studies, addresses."""

import tomllib

from damage.checks import check_file
from damage.errors import InputError

DRAFT = "http://json-schema.org/draft-07/schema#"
"""The newest that Taplo, which editors use for TOML, knows."""
DEEPEST = 20
"""Tables and lists in each other; a study has five."""


def read_toml(path, wanted, most_mb):
    """The table {key: value} of a TOML file in UTF-8, with or without a byte order mark.

    wanted: what is expected, in words, like "a study file (.toml)"; most_mb: its size.  Raises
    InputError for a file that cannot be read, is no TOML, or nests more deeply than DEEPEST.
    """
    return toml_table(path, toml_text(path, wanted, most_mb), wanted)


def toml_text(path, wanted, most_mb):
    """The text of a TOML file; arguments and errors as of `read_toml`."""
    path = check_file(path, wanted, most_mb)
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; expected {wanted}, check the path") from error
    except UnicodeDecodeError as error:
        raise _none(path, error, wanted) from error


def toml_table(path, text, wanted):
    """The table of a TOML file's text; arguments and errors as of `read_toml`."""
    try:
        table = tomllib.loads(text)
        _refuse_depth(table)
    except (ValueError, RecursionError) as error:
        raise _none(path, error, wanted) from error
    return table


def _none(path, error, wanted):
    return InputError(f"{path} is no TOML in UTF-8 ({error}); expected {wanted}, correct it")


def _refuse_depth(table):
    """Raise ValueError for tables and lists nested more deeply than Python can follow."""
    parts = [table]
    for _ in range(DEEPEST):
        parts = [
            part
            for branch in parts
            for part in (branch.values() if isinstance(branch, dict) else branch)
            if isinstance(part, (dict, list))
        ]
    if parts:
        raise ValueError(f"tables or lists more than {DEEPEST} deep in each other")
