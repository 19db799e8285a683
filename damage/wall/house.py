"""A house: plane walls placed in plan, each as by itself, and the corners at which they meet; TOML:

    name = "corner"
    heading = 0                     # of the horizontal motion in plan, from x towards y [deg]

    [[walls]]
    file = "front.toml"             # beside this file, or the name of a wall that ships
    origin = [0, 0]                 # (x, y) [m] of its left end, in the middle of its thickness
    direction = 0                   # of its length in plan, from x towards y [deg]

    [[walls]]
    file = "side.toml"
    name = "left"                   # where a file stands for several walls
    origin = [0.1, -0.1]
    direction = 90

    [[corners]]
    walls = ["front", "left"]
    kind = "toothed"                # or "butted"

Its runs are YADE's: `./yade HOUSE.toml`.  `damage.wall.space` lays it out.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from damage.errors import InputError
from damage.fields import check_fields, choice, quantity
from damage.toml_file import read_toml
from damage.wall.file import MOST_MB, load_wall, read_wall, user_record
from damage.wall.parameters import LONGEST_M, Wall

KINDS_OF_CORNERS = "toothed", "butted"


@dataclass(frozen=True)
class Placed:
    """A wall in plan: origin (x, y) [m] of its left end in the middle of its thickness, direction
    of its length from x towards y [deg]."""

    wall: Wall
    origin: tuple[float, float] = (0.0, 0.0)
    direction: float = quantity("deg", -360, 360, default=0.0)

    def __post_init__(self):
        try:
            x, y = (float(value) for value in self.origin)
        except (TypeError, ValueError):
            x = y = np.inf
        if not max(abs(x), abs(y)) <= LONGEST_M:
            raise InputError(
                f"wall {self.wall.name}: origin = {self.origin!r}: expected [x, y] in m, of its"
                " left end in plan; correct it"
            )
        object.__setattr__(self, "origin", (x, y))
        check_fields(self)

    @property
    def axes(self):
        """Unit vectors along the wall, across it and upwards, the rows of (3, 3)."""
        turn = np.radians(self.direction)
        # so that right angles are exact
        cos, sin = np.round([np.cos(turn), np.sin(turn)], 15)
        return np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Corner:
    """Two walls, by name, that meet: toothed, whose end bricks take turns by courses, or butted, an
    end against a face."""

    walls: tuple[str, str]
    kind: str = choice(KINDS_OF_CORNERS, default="butted")

    def __post_init__(self):
        check_fields(self)
        object.__setattr__(self, "walls", tuple(self.walls))


@dataclass(frozen=True)
class House:
    """Placed walls of one masonry and their corners; heading: of the first horizontal component of
    the motion in plan, from x towards y [deg]."""

    name: str
    walls: tuple[Placed, ...]
    corners: tuple[Corner, ...] = ()
    heading: float = quantity("deg", -360, 360, default=0.0)

    def __post_init__(self):
        check_fields(self)
        object.__setattr__(self, "walls", tuple(self.walls))
        object.__setattr__(self, "corners", tuple(self.corners))
        if not self.walls:
            raise InputError(f"house {self.name} has no [[walls]]: expected one or more; add them")
        names = self.names
        for name in names:
            if names.count(name) > 1:
                raise InputError(
                    f"house {self.name}: two walls named {name}: expected a name of each; give one"
                    " of them another"
                )
        for corner in self.corners:
            if len(set(corner.walls)) != 2 or not set(corner.walls) <= set(names):
                raise InputError(
                    f"house {self.name}, corner of {list(corner.walls)}: expected two of its walls,"
                    f" {', '.join(names)}; correct it"
                )
        for wall in (placed.wall for placed in self.walls):
            _check_masonry(self, wall)

    @property
    def names(self):
        """Of its walls."""
        return [placed.wall.name for placed in self.walls]

    @cached_property
    def masonry(self):
        """The first wall under the name of the house, for what all walls share."""
        return replace(self.walls[0].wall, name=self.name)

    def as_dict(self):
        """All parameters as a plain dictionary, for files."""
        return {
            "name": self.name,
            "heading": self.heading,
            "walls": [
                {
                    "wall": one.wall.as_dict(),
                    "origin": list(one.origin),
                    "direction": one.direction,
                }
                for one in self.walls
            ],
            "corners": [vars(one) | {"walls": list(one.walls)} for one in self.corners],
        }


def _check_masonry(house, wall):
    """Refuse what a house cannot have yet: walls of different masonry, and what runs in a plane
    alone."""
    joint, first = wall.joint, house.masonry
    if (wall.brick, joint) != (first.brick, first.joint):
        raise InputError(
            f"house {house.name}, wall {wall.name}: its bricks or joints differ from those of"
            f" {house.names[0]}: expected one masonry of all walls; give them the same [brick] and"
            " [joint]"
        )
    for what, given in (
        ("fracture energies of joints", joint.softens),
        ("a compressive strength of joints", joint.compressive_strength),
        ("bricks that split", wall.brick.splits),
        ("restraints", wall.restraints),
    ):
        if given:
            raise InputError(
                f"house {house.name}, wall {wall.name}: {what}: expected none, which runs in the"
                " plane of a wall alone; leave them out"
            )


def read_house(path):
    """The House of a TOML file; InputError for anything that makes none."""
    path = Path(path)
    table = dict(read_toml(path, "a house as TOML", MOST_MB))
    walls, corners = (_tables(path, table.pop(name, [])) for name in ("walls", "corners"))
    walls = [_placed(path, number, dict(one)) for number, one in enumerate(walls, 1)]
    corners = [
        user_record(f"{path}, [[corners]] {number}", Corner, one)
        for number, one in enumerate(corners, 1)
    ]
    return user_record(f"{path}", House, table | {"walls": walls, "corners": corners})


def _tables(path, given):
    if not isinstance(given, list) or not all(isinstance(one, dict) for one in given):
        raise InputError(f"{path}: expected tables [[walls]], [[corners]]; double the brackets")
    return given


def _placed(path, number, table):
    """The Placed wall of a table [[walls]]."""
    file, name = table.pop("file", None), table.pop("name", None)
    if not isinstance(file, str):
        raise InputError(
            f"{path}, [[walls]] {number}: file = {file!r}: expected a wall's file beside this one,"
            " or the name of a wall that ships; give one"
        )
    beside = path.parent / file
    wall = load_wall(beside if beside.is_file() else file)
    named = {"wall": wall if name is None else replace(wall, name=name)}
    return user_record(f"{path}, [[walls]] {number}", Placed, table | named)


def read_wall_or_house(path):
    """The House of a TOML file that places walls, else its damage.Wall."""
    table = read_toml(path, "a wall or a house as TOML", MOST_MB)
    return read_house(path) if "walls" in table else read_wall(path)


def masonry_of(wall):
    """A damage.Wall itself; of a House that of its walls' masonry."""
    return wall.masonry if isinstance(wall, House) else wall
