"""Damage of masonry walls under induced seismicity: walls, joint law, histories, damage index."""

from damage.errors import InputError
from damage.parameters import Brick, Joint, ModelOptions, Opening, Wall
from damage.reading import History, read_history

__version__ = "0.1.0"

__all__ = ["Brick", "History", "InputError", "Joint", "ModelOptions", "Opening", "Wall", "read_history",
           "__version__"]
