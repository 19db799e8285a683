"""Damage of masonry walls under induced seismicity: walls, joint law, runs, histories, damage
index.

`dir(damage)` lists what scripts use: a wall is a `Wall` of `Brick`, `Joint` and `Opening`, or a
file that `load_wall` reads; `run` shakes or pushes it and returns a `History`; `read_history` reads
one from a file, `read_record` a ground motion; what cannot be is an `InputError`, what is doubtful
a `RunWarning`.  `plot_wall` draws a History into axes of yours, `warnings_of` and `evidence_of` say
how far its results can be trusted.
"""

from damage.version import VERSION as __version__

_HOMES = {
    **dict.fromkeys(("InputError", "RunWarning"), "damage.errors"),
    **dict.fromkeys(("History", "read_history"), "damage.history.reader"),
    **dict.fromkeys(
        ("Brick", "Joint", "Opening", "Wall", "brick_of_masonry"), "damage.wall.parameters"
    ),
    "ModelOptions": "damage.wall.model_options",
    "check_plausible": "damage.house.plausible",
    "Floor": "damage.wall.floors",
    "Lintel": "damage.wall.lintels",
    "masonry": "damage.wall.materials",
    "evidence_of": "damage.measure.summary",
    "warnings_of": "damage.measure.warnings",
    "plot_wall": "damage.draw.run",
    "load_wall": "damage.wall.file",
    "read_record": "damage.motion.formats",
}
__all__ = [*_HOMES, "run", "__version__"]  # noqa: PLE0604, all are names


def __dir__():
    return sorted(__all__)


def __getattr__(name):
    """A name of __all__, imported when it is first asked for: a command is there before its
    libraries are."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    try:
        # run is a package that can be called
        return (
            import_module("damage.run")
            if name == "run"
            else getattr(import_module(_HOMES[name]), name)
        )
    except ModuleNotFoundError as error:
        from damage.start import missing_library

        raise ImportError(missing_library(error) or str(error), name=error.name) from None
