"""Damage of masonry walls under induced seismicity: walls, joint law, histories, damage index."""

from damage.version import VERSION as __version__

_HOMES = {"InputError": "damage.errors", **dict.fromkeys(("History", "read_history"), "damage.history.reader"),
          **dict.fromkeys(("Brick", "Joint", "ModelOptions", "Opening", "Wall", "brick_of_masonry"),
                          "damage.wall.parameters"), "check_plausible": "damage.wall.plausible"}
__all__ = ["Brick", "History", "InputError", "Joint", "ModelOptions", "Opening", "Wall", "brick_of_masonry",
           "check_plausible", "read_history", "__version__"]


def __getattr__(name):
    """A name of __all__, imported when it is first asked for: a command is there before its libraries are."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    try:
        return getattr(import_module(_HOMES[name]), name)
    except ModuleNotFoundError as error:
        from damage.start import missing_library

        raise ImportError(missing_library(error) or str(error), name=error.name) from None
