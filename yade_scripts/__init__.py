"""Walls in YADE.  Importing this package does not import YADE."""

from pathlib import Path

COMMAND = (str(Path(__file__).resolve().parents[1] / "yade"), "-n", "-j1")
"""Command that runs a script in YADE without a screen, on one core, and without YADE's network servers."""
