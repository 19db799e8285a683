"""Damage of masonry walls under induced seismicity: walls, joint law, histories, damage index."""

import sys

from damage.errors import InputError
from damage.provenance import VERSION as __version__
from damage.wall.parameters import Brick, Joint, ModelOptions, Opening, Wall, brick_of_masonry

try:
    from damage.history.reader import History, read_history
except ModuleNotFoundError as error:
    raise ImportError(f"{sys.executable} has no {error.name}: on Debian use /usr/bin/python3, which has the "
                      "packages after ./run_all.sh or tests/run.sh; elsewhere: pip install .") from None

__all__ = ["Brick", "History", "InputError", "Joint", "ModelOptions", "Opening", "Wall", "brick_of_masonry",
           "read_history", "__version__"]
