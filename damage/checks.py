"""Checks of input: messages name what was given, what was expected and how to correct it; records
from tables."""

import math
import os
import stat
import unicodedata
from dataclasses import fields
from numbers import Integral, Real
from pathlib import Path

from damage.errors import InputError, of_locale, warn
from damage.retired import retired


def check_number(what, value, wanted="a finite number", fits=lambda value: True):
    """Raise InputError unless `value` is a finite number that `fits`; what: its name; wanted: what
    fits, in words."""
    if (
        isinstance(value, bool)
        or not isinstance(value, Real)
        or not is_finite(value)
        or not fits(value)
    ):
        raise _unlike(what, value, wanted)


def _unlike(what, value, wanted, cure="correct it"):
    """The InputError of a value that is not what is wanted, or that is missing, None."""
    if value is None:
        return InputError(f"{what} is missing: expected {wanted}; give it")
    return InputError(f"{what} = {value!r}: expected {wanted}; {cure}")


def is_finite(value):
    """Whether a number is finite, and no whole number beyond all others."""
    try:
        return math.isfinite(value)
    except OverflowError:
        return False


def check_positive(what, value):
    """Raise InputError unless `value` is finite and above zero."""
    check_number(what, value, "a positive number", lambda value: value > 0)


def check_not_negative(what, value):
    """Raise InputError unless `value` is finite and zero or above."""
    check_number(what, value, "a zero or positive number", lambda value: value >= 0)


def check_range(what, value, least, most):
    """Raise InputError unless `value` is a number from `least` to `most`."""
    check_number(
        what, value, f"a number from {least:g} to {most:g}", lambda value: least <= value <= most
    )


def check_whole(what, value, least=0, most=math.inf):
    """Raise InputError unless `value` is a whole number within bounds."""
    if not isinstance(value, Integral) or isinstance(value, bool) or not least <= value <= most:
        upper = "or more" if most == math.inf else f"to {most}"
        raise _unlike(what, value, f"a whole number, {least} {upper}")


def check_choice(what, value, choices):
    """Raise InputError unless `value` is one of `choices`."""
    if value not in choices:
        raise _unlike(what, value, f"one of {', '.join(choices)}", "choose one of them")


LONGEST_NAME = 255
"""Bytes that a file's name may have."""


def is_plain_name(word):
    """Whether a name may be part of a file's name, of XML and of a line: no slash, no control or
    unassigned character.

    >>> [is_plain_name(word) for word in ("solid", "a <b> & c", "../solid", "a" + chr(10))]
    [True, True, False, False]
    """
    return "/" not in word and not any(unicodedata.category(c).startswith("C") for c in word)


def check_path(path):
    """The Path of a word; InputError where no file can be called so, or its name would garble what
    is printed."""
    path = Path(path)
    name = ""
    odd = any(unicodedata.category(c) in ("Cc", "Cs") for c in str(path))
    try:
        name = os.fsencode(path).decode("utf-8")
    except UnicodeEncodeError:  # named in a file
        odd = True
        name = str(path)
    except UnicodeDecodeError:
        pass
    if odd and name and name.isprintable():
        raise InputError(of_locale(name))
    if odd:
        raise InputError(
            f"path {str(path)!r}: expected a name without control characters and in UTF-8;"
            " rename it"
        )
    longest = max(path.parts, key=lambda part: len(os.fsencode(part)), default="")
    if len(os.fsencode(longest)) > LONGEST_NAME:
        raise InputError(
            f"path {str(path)!r}: a name of {len(os.fsencode(longest))} bytes, expected up to "
            f"{LONGEST_NAME}; give a shorter one"
        )
    return path


def check_file(path, wanted, most_mb=math.inf):
    """The Path of a file that can be read; InputError where it is missing, no regular file, or
    larger than that.

    wanted: what is expected of it, in words.
    """
    path = check_path(path)
    try:
        status = path.stat()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; expected {wanted}, check the path") from error
    if not stat.S_ISREG(status.st_mode):
        kind = "a directory" if stat.S_ISDIR(status.st_mode) else "no regular file"
        raise InputError(f"{path}: {kind}; expected {wanted}")
    if status.st_size > most_mb * 1e6:
        raise InputError(
            f"{path}: {status.st_size / 1e6:.6g} MB; expected {wanted} of up to {most_mb} MB, make"
            " it smaller"
        )
    return path


def record_from(kind, table, derived=()):
    """The frozen record `kind` of a table {field: value} from a file; fields that an older file
    lacks take defaults; retired fields (`damage.retired`) are left out, with a warning where they
    had another value than the default.

    derived: keys that follow from the others and are no fields.  Raises InputError for any other
    that is no field: a choice of a later version, unknown to this one.
    """
    names = [field.name for field in fields(kind)]
    unknown = []
    for name in sorted(set(table) - {*names, *derived}):
        gone = retired(name)
        if gone is None:
            unknown.append(name)
        elif table[name] != gone.default:
            warn(f"made with {name} = {table[name]!r} by an older version: {gone.sentence}")
    if unknown:
        raise InputError(
            f"{kind.__name__} with {unknown[0]} = {table[unknown[0]]!r}: expected no other than "
            f"{', '.join(names)}; a later version wrote it, update the software"
        )
    values = {
        name: tuple(table[name]) if isinstance(table[name], list) else table[name]
        for name in names
        if name in table
    }
    try:
        return kind(**values)
    except TypeError as error:
        raise InputError(
            f"{kind.__name__} of {table!r}: {error}; expected a table that a run wrote"
        ) from error
