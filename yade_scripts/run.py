"""Run of one wall in YADE by the command line `./yade walls/NAME.py`."""

from damage.memory import YADE
from damage.start import begin

begin(YADE)  # before the slow imports

import sys
from pathlib import Path

from damage.errors import InputError
from damage.start import EXIT_MISSING, missing_library, reported


def main(make_wall, engines=()):
    """Run the wall that `make_wall()` returns with this command line's options, then leave YADE.

    engines: of YADE, called at the end of each step after those that O.engines has beside a new
    scene's.
    """
    path = Path(sys.argv[0])
    try:
        from yade_scripts.leaving import run_and_leave
    except ImportError as error:
        if error.name != "yade":
            raise
        print(
            f"error: {path} is run by YADE, not by {sys.executable}: expected yade {path}"
            f" [OPTIONS], or in the built-in solver python3 -m damage reference {path} [OPTIONS]",
            file=sys.stderr,
        )
        sys.exit(EXIT_MISSING)
    run_and_leave(lambda: _run(make_wall, path, engines))


def _run(make_wall, path, engines):
    """Exit status of a run of the wall of the file at `path`.

    Libraries are imported here, so that a missing one gives a message instead of a traceback.
    """
    try:
        import yade

        import damage.applications  # noqa: F401, each adds its options
        from damage.house.house import House
        from damage.provenance import shown_path
        from damage.run.session import run_session
        from damage.wall.file import wall_of
        from damage.wall.parameters import Wall
        from yade_scripts.backend import backend_with
        from yade_scripts.opened import Scene, engines_beside, name_of, prompt
    except ImportError as error:
        if not missing_library(error):
            raise
        print(f"error: {missing_library(error)}", file=sys.stderr)
        return EXIT_MISSING
    if "--quiet" not in sys.argv:
        print(f"YADE {yade.config.version}", flush=True)

    def run():
        beside = engines_beside(engines)
        if beside and "--quiet" not in sys.argv:
            print(f"engines beside the wall's own: {', '.join(map(name_of, beside))}", flush=True)
        return run_session(
            backend_with(beside),
            path,
            lambda: wall_of(make_wall, path, (Wall, House)),
            sys.argv[1:],
            prog=f"yade {shown_path(path)}",
        )

    status = reported(run)
    scene = Scene.current
    if scene and scene.console == "after" and scene.run:
        prompt(scene, "after", history=scene.history)
    return status


def open_wall(wall, engines, options):
    """Implementation of `yade_scripts.open_scene`."""
    import damage.applications  # noqa: F401, each adds its options
    from damage.house.house import load_wall_or_house
    from damage.provenance import shown_path
    from damage.run.options import settings_of
    from damage.wall.file import wall_path
    from yade_scripts.backend import backend_with
    from yade_scripts.leaving import close_with_a_word
    from yade_scripts.opened import engines_beside, open_scene

    close_with_a_word()
    file = wall_path(wall) if isinstance(wall, str | Path) else ""
    given = {"pictures": False, "quiet": True} | options
    settings = settings_of(
        given, f"yade, open_scene of {shown_path(file) if file else wall.name}:", "yade"
    )
    if settings.members > 1 or settings.console or settings.view or settings.pictures:
        raise InputError(
            "open_scene with members, console, view or pictures: expected options of the wall and"
            " its motion; leave them out: YADE's prompt follows the script"
        )
    return open_scene(
        backend_with(engines_beside(engines)),
        settings,
        file,
        load_wall_or_house(file) if file else wall,
    )
