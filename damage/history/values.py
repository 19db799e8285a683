"""Checks of the values of a history: finite numbers, existing joints, increasing time."""

import numpy as np

from damage.checks import check_number
from damage.errors import InputError
from damage.wall.restraints import SIDE_COURSE

_HUGE = 1e30
"""No quantity of a wall comes near this number of its unit."""
_UNITS = ("_s", "_g", "_m", "_pa")
"""With which the names of parameters end that are numbers."""


def check_parameters(parameters):
    """Raise InputError unless the parameters of a run consist of tables, numbers and text, as a run writes them."""
    optional = dict.fromkeys(("settlement", "cracked", "life"), (dict, type(None)))
    kinds = optional | {"loading": dict, "wall": dict, "model": dict, "wall_file": dict, "sequence": list,
                        "events": list, "motions": list}
    numbers = (float, int)
    if not isinstance(parameters, dict):
        raise InputError("its parameters are no table")
    for name, value in parameters.items():
        words = () if name.endswith(_UNITS) else (str,)
        if not isinstance(value, kinds.get(name, (*words, *numbers, type(None)))):
            wanted = "a number" if name.endswith(_UNITS) else "what a run writes there"
            raise InputError(f"parameter {name} is {value!r:.80}, expected {wanted}")
        if isinstance(value, numbers) and not abs(value) < _HUGE:
            raise InputError(f"parameter {name} is {value!r:.80}, expected a number that can be")
    for factor in parameters.get("sequence", [1.0]) or [None]:
        check_number("a factor of parameter sequence", factor, "a number that can be", lambda value: abs(value) < _HUGE)
    _check_events(parameters)


def _check_events(parameters):
    """Raise InputError unless each event of a sequence of records has one of its motions."""
    motions, events = parameters.get("motions", []), parameters.get("events", [])
    known = all(isinstance(event, dict) and event.get("motion") in range(len(motions)) for event in events)
    if not known or not all(isinstance(motion, dict) for motion in motions) or (
            (motions or events) and len(events) != len(parameters.get("sequence", []))):
        raise InputError(f"parameters motions and events are {len(motions)} and {len(events)}, expected a motion for "
                         "each factor of parameter sequence")


def check_values(history):
    """Raise InputError for impossible values of a History: not finite, unknown joints, time that does not increase."""
    joints, bodies, events, series = history.joints, history.bodies, history.events, history.series
    for name, value in history.static.items():
        if abs(value) >= _HUGE:
            raise InputError(f"static/{name} is {value:g}, expected a number that can be")
    _check_columns("joints", joints, infinite=("tensile_strength_pa", "cohesion_pa"))
    _check_columns("bodies", bodies)
    _check_columns("events", events)
    # A column that a solver does not provide is empty: it has all its values or none.
    empty = [name for name, values in series.items() if values.dtype.kind == "f" and np.isnan(values.to_numpy()).all()
             and name not in ("time_s", "drift_ratio")]
    _check_columns("series", series.drop(columns=empty))
    for table, names in ((joints, ("length_m", "area_m2")), (bodies, ("length_m", "height_m", "mass_kg"))):
        for name in names:
            values = table[name].to_numpy()
            wrong = ~(values > 0)
            if name == "mass_kg":  # party walls have none
                wrong &= table["course"].to_numpy() != SIDE_COURSE
            _refuse(wrong, name, "a number above zero", values)
    n_supports = 1 if history.supports is None else len(history.supports)
    for table, name, least, end in ((joints, "first_body", -n_supports, len(bodies)),
                                    (joints, "second_body", 0, len(bodies)), (events, "joint", 0, len(joints))):
        values = table[name].to_numpy()
        _refuse((values < least) | (values >= end), name, f"{least} to {end - 1}", values)
    time_s = series["time_s"].to_numpy()
    _refuse(np.diff(time_s, prepend=-np.inf) <= 0, "time_s", "a later time than before", time_s)
    for name, frames in (*((name, getattr(history.active, name)) for name in ("opening_m", "slip_m", "offset_m")),
                         ("displacement", history.displacement), ("stress_pa", history.stress_pa),
                         ("ground/displacement", history.support_displacement)):
        # Of the extremes first, which takes no memory: of what is no number both are none, too.
        if frames is None or (-_HUGE < frames.min(initial=0.0) and frames.max(initial=0.0) < _HUGE):
            continue
        fine = (np.abs(frames) < _HUGE).all(axis=tuple(range(1, frames.ndim)))
        if not fine.all():
            raise InputError(f"{name} is no number that can be in row {int(np.argmin(fine))}: its run "
                             "blew up, give it a smaller --dt")


def _check_columns(table, frame, infinite=()):
    """Raise InputError for numbers that are not finite; those of the columns `infinite` may be infinite."""
    for name, column in frame.items():
        if column.dtype.kind == "f":
            values = column.to_numpy()
            allowed = np.abs(values) < _HUGE
            if name in infinite:
                allowed |= values == np.inf
            _refuse(~allowed, f"{table}/{name}", "a number that can be", values)


def _refuse(wrong, name, expected, values):
    """Raise InputError that names the first row where `wrong`; both (n,)."""
    if wrong.any():
        row = int(np.argmax(wrong))
        raise InputError(f"{name} is {values[row]:g} in row {row}, expected {expected}")
