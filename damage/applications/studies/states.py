"""Damage states and intensities of fragility curves: those that ship, and a user's own, columns of
summary.csv.

A damage state is a column and the level that it exceeds, as "moderate: max_psi > 2"; an intensity
is a column with a number above zero in every run.
"""

import math
import re
from difflib import get_close_matches
from typing import NamedTuple

import pandas as pd

from damage.errors import InputError
from damage.history.schema import each
from damage.measure.columns import MADE_BY, PARAMETERS, RUN
from damage.measure.summary import MEASURES

LEVELS = {"max_DI": (0.02, 0.05, 0.1), "max_crack_width_mm": (0.1, 1.0), "max_psi": (1.0, 2.0)}
"""Default levels by measure, a column of summary.csv: index [-], crack width [mm], Korswagen's Psi
[-]."""
INTENSITIES = {
    "sa_eigen_period_g": r"S$_\mathrm{a}$(T$_1$, 5 %) [g]",
    "avg_sa_g": "AvgSa [g]",
    "sa_0.2_s_g": r"S$_\mathrm{a}$(0.2 s, 5 %) [g]",
    "pgv_m_s": "PGV [m/s]",
    "record_pga_g": "PGA [g]",
    "pga_g": "PGA, as applied [g]",
    "pgv_rotd100_m_s": "PGV, largest of all directions [m/s]",
    "arias_m_s": "Arias intensity [m/s]",
}
"""Intensities that are compared with one another; the first that a study has is the default.  What
an axis says."""
OF_MEASURES = {name: column for table in MEASURES.values() for name, column in each(table).items()}
COLUMNS = each(PARAMETERS | RUN | MADE_BY) | OF_MEASURES
"""Columns of summary.csv, {name: Column}."""
STUDY_FILE = "a study file (.toml)", 10
"""What is expected of one, and its largest size [MB]."""
_STATE = re.compile(r"(?:(?P<name>[^:<>]+):)?(?P<measure>[^:<>]+)>(?P<level>[^:<>]+)")


class State(NamedTuple):
    """A damage state: column of summary.csv, level that it exceeds in the column's unit, its
    name."""

    measure: str
    level: float
    name: str = ""

    @property
    def title(self):
        """Its name, or the condition.

        >>> State("max_psi", 2.0).title
        'max_psi > 2'
        """
        return self.name or f"{self.measure} > {self.level:g}"


STATES = tuple(State(measure, level) for measure, levels in LEVELS.items() for level in levels)


def parse_state(text):
    """The State of "NAME: COLUMN > LEVEL"; the name may be left out.  InputError for other text.

    >>> parse_state("moderate: max_psi > 2")
    State(measure='max_psi', level=2.0, name='moderate')
    """
    match = _STATE.fullmatch(text.strip())
    if not match:
        raise InputError(
            f"damage state {text!r}: expected COLUMN > LEVEL or NAME: COLUMN > LEVEL, as "
            '"moderate: max_psi > 2"; correct it'
        )
    name, measure, level = ((match[key] or "").strip() for key in ("name", "measure", "level"))
    try:
        number = float(level)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise InputError(
            f"damage state {text!r}: level {level!r}; expected a finite number, as 2; correct it"
        )
    return State(measure, number, name)


def choices_in(table, path):
    """(tuple of State, intensity or None) of keys `states` and `intensity` of the table of a study
    file at a path; InputError where they are no text, or no condition."""
    states = table.get("states", [])
    intensity = table.get("intensity")
    if not isinstance(states, list) or not all(isinstance(state, str) for state in states):
        raise InputError(
            f'{path}: states = {states!r}; expected a list of texts, as ["moderate: max_psi > 2"]; '
            "correct it"
        )
    if not isinstance(intensity, str | None):
        raise InputError(
            f"{path}: intensity = {intensity!r}; expected the name of a column of summary.csv, as "
            '"pgv_m_s"; correct it'
        )
    return tuple(map(parse_state, states)), intensity


def check_states(runs, states):
    """Raise InputError for a State whose column runs (rows of a table) lack, or have no numbers in,
    and for two of one name."""
    for state in states:
        where = f"damage state {state.title!r}"
        missing = _numbers(runs, state.measure, where).isna() & runs["collapsed_at_s"].isna()
        if missing.any():
            raise InputError(
                f"{where}: {missing.sum()} of {len(runs)} runs have no {state.measure}; expected a"
                " number in each run that did not collapse; choose another column"
            )
    names = [state.title for state in states]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(
            f"damage state {twice!r}: given twice; expected names that differ; name one otherwise"
        )


def check_intensity(runs, name):
    """Raise InputError unless every run (row of summary.csv) has a number above zero in this
    column."""
    where = f"--intensity {name}"
    values = _numbers(runs, name, where)
    for bad, what in ((values.isna(), "no value"), (values <= 0, "zero or less")):
        if bad.any():
            raise InputError(
                f"{where}: {bad.sum()} of {len(runs)} runs have {what} there; expected a number"
                " above zero in every run; choose another, as"
                f" {' or '.join(intensities_of(runs) or INTENSITIES)}"
            )


def _numbers(runs, name, where):
    numeric = [
        column
        for column in runs
        if pd.api.types.is_numeric_dtype(runs[column]) and runs[column].notna().any()
    ]
    if name not in runs:
        near = get_close_matches(name, numeric, 3, 0.5)
        raise InputError(
            f"{where}: summary.csv has no column {name}; expected one with numbers"
            + (f", perhaps {' or '.join(near)}" if near else "")
            + "; correct it"
        )
    if name not in numeric:
        raise InputError(
            f"{where}: column {name} of summary.csv holds no numbers; expected a column with"
            f" numbers, as {next(iter(LEVELS))}; choose another"
        )
    return runs[name].astype(float)


def intensities_of(runs):
    """Names of the INTENSITIES that every one of the runs has."""
    return [
        name
        for name in INTENSITIES
        if name in runs and runs[name].notna().all() and pd.api.types.is_numeric_dtype(runs[name])
    ]


def leading(runs):
    """The intensity that curves are fitted against by default: the first of INTENSITIES that every
    run has."""
    column = intensities_of(runs)
    if not column:
        raise InputError(
            f"no intensity in every run; expected {' or '.join(INTENSITIES)} in the tables of a"
            " study of recorded motions; choose another study, or a column with --intensity"
        )
    return column[0]


def unit_of(column):
    """The unit of a column of summary.csv, "1" of one without, of text and of an unknown column.

    >>> unit_of("pgv_m_s"), unit_of("max_DI"), unit_of("wall")
    ('m/s', '1', '1')
    """
    return (COLUMNS[column].unit if column in COLUMNS else "") or "1"


def in_unit(name, column):
    """A column's name for a value in the unit of another column.

    >>> in_unit("median", "pgv_m_s"), in_unit("median", "max_DI")
    ('median_m_s', 'median')
    """
    unit = unit_of(column)
    return name if unit == "1" else f"{name}_{unit.replace('/', '_')}"


def label(column):
    """The label of an axis of an intensity, or the title of a panel of a measure: words, unit ("-"
    of a number without one).

    >>> label("max_drift_ratio"), label("initial_stiffness_n_per_m")
    ('maximum drift ratio [-]', 'initial stiffness [N/m]')
    """
    unit = unit_of(column)
    text = re.sub(f"_{unit.lower().replace('/', '_(per_)?')}$", "", column).replace("_", " ")
    text = re.sub(r"^max ", "maximum ", text).replace("psi", r"$\Psi$")
    return INTENSITIES.get(column, f"{text} [{'-' if unit == '1' else unit}]")


def column_words(name):
    """A column's name in words, with its unit.

    >>> column_words("max_crack_width_mm"), column_words("pgv_m_s"), column_words("wall")
    ('maximum crack width [mm]', 'PGV [m/s]', 'wall')
    """
    return re.sub(r"[$_{}\\]|mathrm", "", label(name)).replace(" [-]", "")
