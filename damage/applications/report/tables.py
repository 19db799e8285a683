"""Tables of the file: measures with their meaning, run beside run; the energy balance;
parameters."""

import math
from numbers import Number

from damage.applications.studies.states import COLUMNS
from damage.history.info import flat, given
from damage.history.schema import each
from damage.measure.columns import MADE_BY, PARAMETERS, RUN
from damage.measure.damage_index import CRITERIA
from damage.measure.energy import imbalance, known_energies
from damage.measure.summary import MEASURES
from damage.units import rounded
from damage.wall.as_built import describe_cap

SECTIONS = {**MEASURES, "Run and parameters": RUN | PARAMETERS, "Provenance": MADE_BY}
DIGITS = 3
"""Significant digits of results, as on the screen."""
GIVEN_DIGITS = 5
"""Significant digits of what a run was given."""
ENERGIES = {
    "input_energy_j": "supplied",
    "kinetic_energy_j": "kinetic, stored",
    "elastic_energy_j": "elastic, stored",
    "gravity_energy_j": "potential, stored",
    "friction_energy_j": "dissipated by friction",
    "fracture_energy_j": "dissipated by fracture",
    "damping_energy_j": "dissipated by damping, that of settling included",
}
OTHER_CRITERIA = tuple(
    f"{kind}_{prefix}" for kind in ("max", "residual") for prefix in filter(None, CRITERIA.values())
)
"""Beginnings of columns by other criteria of slip than that of the run's results."""
_GIVEN = each(RUN | PARAMETERS | MADE_BY)


def digits_of(name):
    """Number of significant digits of a column."""
    return GIVEN_DIGITS if name in _GIVEN else DIGITS


def in_short(value, digits=DIGITS):
    """A number with so many significant digits, what was given without zeros at its end, a word as
    it is, nothing as a dash.

    >>> [in_short(value) for value in (0.0940123456, 1234567.0, None, "complete", 3)]
    ['0.0940', '1.23e+06', '–', 'complete', '3']
    >>> in_short(0.5, GIVEN_DIGITS)
    '0.5'
    """
    if value is None or (isinstance(value, Number) and not math.isfinite(value)):
        return "–"
    if isinstance(value, int) or not isinstance(value, Number):
        return str(value) or "–"
    # without an exponent
    plain = digits == DIGITS and (1e-4 <= abs(value) < 1e6 or value == 0)
    return rounded(value, digits) if plain else f"{value:.{digits}g}"


def measures(parts):
    """[(section, [row])] of all measures that a run has.

    A row is {"name", "unit", "meaning", "cells": [cell of each run], "differences": [cell of each
    but the first]}, a cell (text, the whole number or None).
    """
    rows = [part["row"] for part in parts]
    sections = [
        (
            section,
            [
                _row(name, [row.get(name) for row in rows])
                for name in each(columns)
                if not name.startswith(OTHER_CRITERIA)
                and any(row.get(name) is not None for row in rows)
            ],
        )
        for section, columns in SECTIONS.items()
    ]
    return [(section, rows) for section, rows in sections if rows]


def meaning_of(name):
    """What a column of summary.csv is, in words."""
    return COLUMNS[name].meaning.replace("`", "")


def _row(name, values):
    unit = COLUMNS[name].unit
    return {
        "name": name,
        "unit": "" if unit == "1" else unit,
        "meaning": meaning_of(name),
        "cells": [cell(value, digits_of(name)) for value in values],
        "differences": [_difference(values[0], value) for value in values[1:]],
    }


def cell(value, digits=DIGITS):
    """(text, number or None) of a value, with so many significant digits."""
    is_number = isinstance(value, Number) and not isinstance(value, bool) and math.isfinite(value)
    return in_short(value, digits), repr(float(value)) if is_number else None


def _difference(first, other):
    """Difference of another value from the first, as a cell: numbers as difference and per cent,
    texts as "differs"."""
    if cell(first)[1] is None or cell(other)[1] is None:
        return ("", None) if first == other else ("differs", None)
    change = other - first
    share = f" ({100 * change / abs(first):+.3g} %)" if first and change else ""
    sign = "+" if change > 0 else ""
    return f"{sign}{in_short(change)}{share}" if change else "0", repr(float(change))


def energy_balance(parts):
    """Rows (label, [cell of each run]) of the energies at the end [J], their imbalance, and its
    largest share."""
    ends = [part["history"].series.iloc[-1] for part in parts]
    errors = [part["summary"]["energy_error_fraction"] for part in parts]
    return [
        *((label, [cell(float(end[name])) for end in ends]) for name, label in ENERGIES.items()),
        (
            "stored and dissipated, less supplied",
            [cell(float(imbalance(known_energies(part["history"].series))[-1])) for part in parts],
        ),
        (
            "largest imbalance before settling, % of the energy supplied",
            [cell(error if error is None else 100 * error) for error in errors],
        ),
    ]


def parameters(content):
    """(name, text) of the caps of a run, its static stage, the results that precede the motion, and
    every parameter; content: `damage.history.info.info`."""
    return [
        *(
            (f"cap {number}", describe_cap(cap))
            for number, cap in enumerate(content["caps"], start=1)
        ),
        *((f"static.{name}", value) for name, value in content["static"].items()),
        *flat(content["results"]),
        *flat(given(content)),
    ]


def versions(content):
    """(software, version) of what made a run; content: `damage.history.info.info`."""
    others = sorted(set(content["versions"]) - {"masonry-damage", "commit", "model"})
    return [
        ("masonry-damage", content["software"]),
        ("commit", content["commit"]),
        ("digest of the model", content["model_digest"]),
        *((name, content["versions"][name]) for name in others),
        ("machine", content["machine"]),
        ("made", content["created_utc"]),
    ]
