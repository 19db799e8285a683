"""Runs in the reference solver from Python: implementation of `damage.run(wall, motion,
**options)`."""

import io
import sys
import warnings
from contextlib import nullcontext, redirect_stdout
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from damage.errors import InputError, RunWarning, heard
from damage.history.in_memory import HistoryInMemory
from damage.history.writer import HistoryWriter
from damage.house.house import load_wall_or_house
from damage.measure.warnings import warnings_of
from damage.mechanics.compiled import COMPILING, is_cached
from damage.motion.loading import Loading, Recorded
from damage.motion.record import Record
from damage.provenance import shown_path
from damage.reference.session import BACKEND, PROG
from damage.run.options import settings_of
from damage.run.paths import free_name, pictures_folder
from damage.run.prepare import prepare
from damage.run.session import history_of
from damage.wall.file import wall_path
from damage.wall.parameters import Wall

DEFAULTS = {"pictures": False, "quiet": True}
"""{option: default} where it differs from that of the command line."""


def run(wall, motion=None, **options):
    """History of one run; arguments, errors and warnings: `damage.run`."""
    with heard() as texts:
        try:
            history = replace(_run(wall, motion, options), heard=tuple(texts))
            texts[:] = warnings_of(history)
        finally:
            for text in texts:
                warnings.warn(text, RunWarning, stacklevel=3)  # where the user called damage.run
    return history


def _run(wall, motion, options):
    settings, wall_file, built = _asked(wall, motion, options)
    if settings.quiet and not is_cached():
        print(COMPILING, file=sys.stderr)  # a minute without any output looks like an error
    with (
        TemporaryDirectory(prefix="masonry-damage-") as folder,
        redirect_stdout(io.StringIO()) if settings.quiet else nullcontext(),
    ):
        write = HistoryWriter
        if settings.out is None:
            # A history that outgrows the memory continues in this file, which is read before its
            # folder is deleted.
            path = Path(folder) / free_name(built, settings, BACKEND.name).name
            write = HistoryInMemory
            settings = replace(settings, out=path)
        prepared = prepare(BACKEND, wall_file, lambda: built, settings, write)
        history = history_of(prepared)
    if settings.pictures:
        from damage.draw.house import save_all

        save_all(history, pictures_folder(settings.out))
    return history


def _asked(wall, motion, options):
    """(RunSettings, path of the wall's file or "", Wall) from the arguments of `run`; raises
    InputError."""
    is_record = isinstance(motion, (str, Path))
    is_loading = isinstance(motion, (Loading, Record))
    if not (motion is None or is_record or is_loading):
        raise InputError(
            f"motion = {motion!r}: expected a record's path or name, a Loading, or None with"
            " options like harmonic=(0.2, 0.05)"
        )
    file = "" if isinstance(wall, Wall) else wall_path(wall)
    # the command line is complete unless Python objects are among the arguments
    prog = (
        f"{PROG} {shown_path(wall)}"
        if file and not is_loading
        else f"damage.run, {getattr(wall, 'name', wall)}:"
    )
    given = DEFAULTS | options | ({"record": motion} if is_record else {})
    settings = settings_of(given, prog, BACKEND.name)
    if is_loading:
        settings = _driven_by(motion if isinstance(motion, Loading) else Recorded(motion), settings)
    if settings.members > 1:
        raise InputError(
            f"members = {settings.members}: expected 1, as damage.run makes one run; call it with "
            "scatter=0.001 and seed=1, 2, ..."
        )
    if settings.pictures and settings.out is None:
        raise InputError(
            'pictures=True of a run in memory: expected out="FILE.h5", beside which they go;'
            " give one"
        )
    return settings, file, load_wall_or_house(file) if file else wall


def _driven_by(loading, settings):
    """The settings with a Loading in place of their motion; raises InputError where the options
    name one, too."""
    if settings.loading != settings_of({}, "", BACKEND.name).loading:
        raise InputError(
            f"the motion {loading.name} and options of another: expected one of them; leave one out"
        )
    if settings.sequence != (1.0,) and loading.drive.base is None:
        raise InputError(
            f"sequence with the motion {loading.name}: expected a harmonic or recorded one; leave"
            " it out"
        )
    return replace(
        settings, loading=loading, command=f"{settings.command} driven by {loading.name}"
    )
