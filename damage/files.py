"""Files: where the package keeps its data, and writing whole or not at all."""

import os
from contextlib import contextmanager
from pathlib import Path

DATA = Path(__file__).parent / "data"
"""Records and tests that ship with the package; each folder's README says what they are."""


@contextmanager
def whole_or_nothing(path):
    """A temporary name beside `path`, renamed to it at the end or removed after an error."""
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        yield unfinished
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)
