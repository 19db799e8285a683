"""Where the package keeps its data."""

from pathlib import Path

DATA = Path(__file__).parent / "data"
"""Records and tests that ship with the package; each folder's README says what they are."""
