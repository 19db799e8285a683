"""Which columns of summary.csv a function makes: `measure`, which stands on it."""

from functools import wraps
from inspect import signature


def names(columns):
    """Single names of {"name, name": Column}, a list of str."""
    return [name for several in columns for name in several.split(", ")]


def measure(columns):
    """Decorator of a function that makes the measures {"name, name": Column} of a run, units at the names' ends.

    The function returns their values, a tuple where they are several, or None where none of them applies; what becomes
    of it returns {name: value}.  Its arguments are called `history`, as those of `damage.measure.summary.summarise`, or
    as a measure of a section before its own, and get that.
    """
    named = names(columns)

    def with_names(function):
        @wraps(function)
        def values(*given, **more):
            found = function(*given, **more)
            found = (None,) * len(named) if found is None else found if len(named) > 1 else (found,)
            return dict(zip(named, found, strict=True))

        values.columns, values.arguments = columns, tuple(signature(function).parameters)
        return values

    return with_names


def measures_in(module):
    """The functions with `measure` of a module, in their order."""
    return [one for one in vars(module).values() if hasattr(one, "columns") and one.__module__ == module.__name__]
