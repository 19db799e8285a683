"""Walls in YADE.  Importing this package does not import YADE."""

from damage.files import YADE as COMMAND  # noqa: F401


def open_scene(wall, engines=(), **options):
    """A wall in YADE's scene, for scripts that YADE runs: a `yade_scripts.opened.Scene`, weightless
    at first.

    wall: a damage.Wall, its file, or the name of one that ships; engines: of YADE, called at the
    end of each step; options: those of `./yade WALL --help` by name, as of `damage.run`;
    out="FILE.h5" writes the history.
    """
    from yade_scripts.run import open_wall

    return open_wall(wall, engines, options)


def current_scene():
    """The Scene that was built last, by `open_scene` or by a run; None before."""
    from yade_scripts.opened import Scene

    return Scene.current
