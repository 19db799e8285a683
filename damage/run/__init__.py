"""One run of a wall, whichever solver does it; called, `damage.run(wall, motion, **options)` runs a
wall.

    history = damage.run("symmetric", harmonic=(0.2, 0.05), rest=1)
    history = damage.run("my_wall.toml", "BGAR_HGE", window=(18.7, 22.1), scale=2, out="strong.h5")
    pier = damage.Wall("pier", length=0.9, height=0.9)
    history = damage.run(pier, pushover=0.5, boundary="fixed")

wall: a `damage.Wall`, the path of a wall file, or the name of a wall that ships.
motion: a record, by its path or the name of one that ships; a `damage.motion.loading.Loading`; or
None: the options say it, as `harmonic`, `pushover` or `free_vibration`, and without them it is
`harmonic=(0.2, 0.05)`.
options: those of `python3 -m damage reference --help` by their names without dashes, with _ for -
inside of them.  An option of several values takes a tuple or a list, one without a value takes
True.  Two have other defaults: `pictures=False` and `quiet=True`.

Returns the `damage.History`: with `out="FILE.h5"` that of the file, otherwise one in memory alone.
It is the reference solver that runs, with the step and to the same bits as on the command line.
What the command line warns of is given by `warnings.warn` as `damage.RunWarning` and is in
`damage.warnings_of(history)`, texts with a `code`; `damage.evidence_of(history)` has the range of
validity.  Raises InputError for what the command line would refuse, RunError for a run that fails,
KeyboardInterrupt where it is interrupted; a file keeps what there is by then.
"""

import sys
from importlib import import_module
from types import ModuleType


class _Callable(ModuleType):
    """This package as a function: its name is that of the function that users ask for."""

    def __call__(self, wall, motion=None, **options):
        # The solver, and the applications that add options, come after this package in the order of
        # imports.
        import_module("damage.applications")
        return import_module("damage.reference.python").run(wall, motion, **options)

    __call__.__doc__ = __doc__


sys.modules[__name__].__class__ = _Callable
