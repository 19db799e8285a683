"""Walls in YADE.  Importing this package does not import YADE."""

from damage.files import YADE as COMMAND  # noqa: F401
