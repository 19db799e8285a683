"""Fields of records, each with all that is said of it: unit, limits, plausible values, choices,
words of an option.

From them follow the check of a record (`check_fields`), what of it is implausible
(`implausible_fields`), the JSON Schema of walls, the options of the command line with their help,
and the page of ranges.
"""

import math
from dataclasses import MISSING, field, fields
from numbers import Integral, Real
from typing import NamedTuple

from damage.checks import check_choice, check_not_negative, check_range, check_whole, is_finite
from damage.errors import InputError

MOST_BRICKS = 20_000
"""Largest number of bricks of a wall."""
MOST_SEED = 2**32 - 1
MODULI = {"GPa": 1e9, "MPa": 1e6}
_OTHERS = {
    "m": {"mm": 1e-3, "cm": 1e-2},
    "Pa": {"MPa": 1e6, "kPa": 1e3},
    "Pa/m": {"N/mm3": 1e9, "MPa/m": 1e6},
    "J/m2": {"N/mm": 1e3},
    "kg/m3": {"t/m3": 1e3, "kN/m3": 1e3 / 9.81, "N/m3": 1 / 9.81},
    "kg": {"t": 1e3},
    "kg/m": {"t/m": 1e3},
    "kg/m2": {"kN/m2": 1e3 / 9.81, "t/m2": 1e3},
}
"""{unit: {unit that may have been meant: its size}}."""


class Column(NamedTuple):
    """A column of a table or a dataset of a file.

    unit: "1" of a ratio, "" of words; meaning: what it holds; dtype: kind of number in the file, of
    any size, U of words; least, most: limits of a number that is read.
    """

    unit: str
    meaning: str
    dtype: str = "f8"
    least: float = -math.inf
    most: float = math.inf


class Range(NamedTuple):
    """Plausible values of a field in its SI unit; others: {unit that may have been meant: its size
    in the SI unit}; why: what has values near the limits, with the source where there is one; zero:
    whether that is plausible, too."""

    least: float
    most: float
    unit: str
    others: dict
    why: str
    zero: bool = False


def plausible(least, most, unit, why, zero=False, others=None):
    """A Range with the units that are usual beside its own."""
    others = _OTHERS.get(unit, {}) if others is None else others
    return Range(least, most, unit, others=others, why=why, zero=zero)


def quantity(
    unit,
    least,
    most,
    usual=None,
    why="",
    *,
    zero=False,
    others=None,
    whole=False,
    words=(),
    default=MISSING,
    **more,
):
    """A field of a number in this unit from `least` to `most`; None is none, where it is the
    default.

    usual, why, zero, others: plausible values (least, most) and the rest of their Range; whole:
    without a fraction; words: what may stand in place of a number; more: of an option, as of
    `text`.
    """
    return text(
        default=default,
        unit=unit,
        least=least,
        most=most,
        whole=whole,
        words=words,
        usual=usual and plausible(*usual, unit, why, zero, others),
        **more,
    )


def choice(choices, *, default=MISSING, **more):
    """A field that is one of these words; more: as of `text`."""
    return text(default=default, choices=choices, **more)


def text(*, default=MISSING, **more):
    """A field of a word that its record checks.

    more: called: its name in messages, where that is not RECORD.FIELD; of an option, which messages
    call by its own, its help, for people; metavar; option: its name, where that is not the field's;
    tag: what a history's file is called where the option is not the default, a template of the
    options; seed: it only draws one of many alike.
    """
    return field(
        default=default,
        metadata={
            "help": "",
            "metavar": None,
            "choices": None,
            "tag": None,
            "seed": False,
            "unit": None,
            "words": (),
            "usual": None,
            "called": None,
            "option": None,
            **more,
        },
    )


def option_of(attribute, unit=False):
    """The option of a field, without its unit or with it where it has one."""
    name = attribute.metadata["option"] or attribute.name.replace("_", "-")
    shown = unit and attribute.metadata["unit"] not in (None, "1")
    return f"--{name}" + (f" [{attribute.metadata['unit']}]" if shown else "")


def _called(record, attribute):
    """The name of a field in messages."""
    if attribute.metadata["help"]:
        return option_of(attribute, unit=True)
    return attribute.metadata["called"] or f"{type(record).__name__}.{attribute.name}"


def check_fields(record):
    """Raise InputError where a field of a record is not what it says.  Numbers of other kinds, as
    numpy's, become Python's, which files take, and lists tuples."""
    for attribute in fields(record):
        value = _plain(getattr(record, attribute.name))
        vars(record)[attribute.name] = value  # the record may be frozen
        if (
            attribute.metadata
            and not (value is None and attribute.default is None)
            and value not in attribute.metadata["words"]
        ):
            try:
                _check(_called(record, attribute), value, attribute.metadata)
            except InputError as error:
                raise InputError(f"{error}{_meant(value, attribute.metadata['usual'])}") from None


def _plain(value):
    """A number, or each of a tuple or list, as Python's int or float; any other value as it is."""
    if isinstance(value, (tuple, list)):
        return tuple(map(_plain, value))
    if not isinstance(value, Real) or isinstance(value, bool) or not is_finite(value):
        return value
    return int(value) if isinstance(value, Integral) else float(value)


def _check(what, value, expected):
    if expected["choices"]:
        check_choice(what, value, expected["choices"])
    elif expected["unit"] is None:
        return
    elif expected["whole"]:
        check_whole(what, value, expected["least"], expected["most"])
    elif expected["most"] == math.inf:
        check_not_negative(what, value)
    else:
        check_range(what, value, expected["least"], expected["most"])


def ranges_of(kind):
    """{record and field: Range} of a kind of record."""
    return {
        f"{kind.__name__}.{attribute.name}": attribute.metadata["usual"]
        for attribute in fields(kind)
        if attribute.metadata.get("usual")
    }


def implausible_fields(*records, unit=None):
    """Messages about the implausible values of records, of one unit where it is given; each once:
    several openings may have one fault."""
    given = (
        (name, vars(record)[name.partition(".")[2]], range_)
        for record in records
        for name, range_ in ranges_of(type(record)).items()
        if unit in (None, range_.unit)
    )
    return list(dict.fromkeys(filter(None, (message_of(*entry) for entry in given if entry[1]))))


def message_of(name, value, usual):
    """A message on an implausible value: what a Range expects, and in which units the value would
    be plausible; None of a plausible one.  The sign does not count.

    >>> message_of("--scale", -250.0, Range(0.01, 100, "", {"%": 0.01}, ""))
    '--scale = -250, expected 0.01 to 100: -250 % is -250e-2'
    """
    if usual.least <= abs(value) <= usual.most or (usual.zero and value == 0):
        return None
    unit = f" {usual.unit}" if usual.unit else ""
    return (
        f"{name} = {short(value)}{unit}, expected {short(usual.least)} to"
        f" {short(usual.most)}{unit}{', or 0' if usual.zero else ''}{_meant(value, usual)}"
    )


def _meant(value, usual):
    """The end of a message about a value: in which units it would be plausible by a Range, or
    nothing."""
    if (
        usual is None
        or isinstance(value, bool)
        or not isinstance(value, int | float)
        or not is_finite(value)
    ):
        return ""
    meant = [
        f"{short(value)} {other} is {_in_si(value, size)}{' ' * bool(usual.unit)}{usual.unit}"
        for other, size in usual.others.items()
        if usual.least <= abs(value) * size <= usual.most
    ]
    return f": {', '.join(meant)}" if meant else ""


def short(number):
    """A number with up to six digits.

    >>> short(1e7), short(5.0), short(2.5e-05)
    ('1e7', '5', '2.5e-5')
    """
    return f"{number:g}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-")


def _in_si(value, size):
    """A value in a unit of that size, as it is typed: with an exponent where the size is a power of
    ten."""
    exponent = round(math.log10(size))
    if math.isclose(size, 10.0**exponent) and "e" not in short(value):
        return f"{short(value)}e{exponent}"
    return f"{value * size:.4g}"
