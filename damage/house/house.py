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

    [[floors]]
    level = 2.6                     # of its top [m], as of a wall's own
    kind = "concrete"               # one slab in all its walls; or "timber", mass on parallel ones
    walls = ["front", "left"]
    mass_per_area = 400             # with its weight [kg/m2]

    [roof]                          # mass on the tops of these walls
    walls = ["left", "right"]
    mass_per_area = 80

    [[ties]]                        # across the cavity between two leaves, parallel walls
    walls = ["front", "veneer"]
    per_area = 4                    # [1/m2]
    stiffness = 1e6                 # of one [N/m], and forces at which it fails [N]
    tension = 1500
    compression = 1000

Its runs are YADE's: `./yade HOUSE.toml`.  `damage.house.layout` lays it out.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from damage.errors import InputError
from damage.fields import check_fields, choice, quantity
from damage.house.limits import OF_RUNS, OF_SOLVERS, OF_WALLS, refuse
from damage.house.ties import Ties, spans_between
from damage.toml_file import read_toml
from damage.wall.file import (
    MOST_MB,
    load_wall,
    read_wall,
    user_record,
    user_records,
    wall_of,
    wall_path,
)
from damage.wall.floors import KINDS_OF_FLOORS, Floor
from damage.wall.kinds import TINY
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
        if not np.isfinite([x, y]).all():
            raise InputError(
                f"wall {self.wall.name}: origin = {self.origin!r}: expected [x, y] in m, of its"
                " left end in plan; correct it"
            )
        vars(self)["origin"] = (x, y)
        check_fields(self)

    @property
    def axes(self):
        """Unit vectors along the wall, across it and upwards, the rows of (3, 3)."""
        turn = np.radians(self.direction)
        # so that right angles are exact
        cos, sin = np.round([np.cos(turn), np.sin(turn)], 15)
        return np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])

    @property
    def ends(self):
        """Its left and right end in plan, in the middle of its thickness (2, 2) [m]."""
        return self.origin + np.outer([0.0, self.wall.length], self.axes[0, :2])

    @property
    def corners(self):
        """Its rectangle in plan, in turn (4, 2) [m]."""
        half = self.wall.brick.thickness / 2 * self.axes[1, :2]
        return np.concatenate([self.ends - half, self.ends[::-1] + half])


@dataclass(frozen=True)
class Corner:
    """Two walls, by name, that meet: toothed, whose end bricks take turns by courses, or butted, an
    end against a face."""

    walls: tuple[str, str]
    kind: str = choice(KINDS_OF_CORNERS, default="butted")

    def __post_init__(self):
        check_fields(self)


@dataclass(frozen=True)
class Diaphragm:
    """A floor or roof of a house, carried by the walls of these names.

    level [m]: of its top; mass_per_area [kg/m2]: of all that it brings, with its weight; kind:
    "concrete", one rigid slab, `depth` [m] deep, in place of the courses of all its walls, or
    "timber": each of its walls, which are parallel, bears half of the span on either side;
    anchor_spacing [m]: of joists that are anchored in both walls, None without anchors: then they
    tie nothing.
    """

    level: float = quantity("m", 1e-3, 1000.0, (0.03, 50), "on the base course; a tower")
    walls: tuple[str, ...]
    mass_per_area: float = quantity("kg/m2", 1e-2, 1e5, (10, 3000), "boards; a store")
    kind: str = choice(KINDS_OF_FLOORS, default="timber")
    depth: float = quantity("m", 1e-3, 10.0, (0.01, 2), "a screed; a transfer slab", default=0.15)
    anchor_spacing: float | None = quantity("m", 0.1, 100.0, default=None)

    def __post_init__(self):
        check_fields(self)
        if self.anchor_spacing and self.kind == "concrete":
            raise InputError(
                f"floor at {self.level:g} m, of concrete, with anchor_spacing: expected it of"
                " timber; leave it out"
            )

    def spans(self, walls):
        """The Spans between these Placed walls, those that carry it, of timber."""
        return spans_between(walls, f"floor at {self.level:g} m")

    def on_walls(self, walls):
        """{name of a wall: [Floor, ...]} of these Placed walls, those that carry it."""
        if self.kind == "concrete":
            size = np.ptp(outline(walls), axis=0)
            mass = self.mass_per_area * float(size.prod()) / len(walls)
            floor = Floor(self.level, mass, kind=self.kind, depth=self.depth)
            return {placed.wall.name: [floor] for placed in walls}
        floors = {placed.wall.name: [] for placed in walls}
        for span in self.spans(walls):
            for one, (left, right) in ((span.one, span.along), (span.other, span.other_along)):
                mass = self.mass_per_area * span.apart / 2 * (right - left)
                floors[one.wall.name].append(Floor(self.level, mass, left, right))
        return floors


def outline(walls):
    """Corners of the rectangle around Placed walls at right angles, in the axes of the first: the
    lowest and the highest ones, (2, 2) [m]."""
    corners = np.concatenate([wall.corners for wall in walls]) @ walls[0].axes[:2, :2].T
    return np.array([corners.min(axis=0), corners.max(axis=0)])


@dataclass(frozen=True)
class House:
    """Placed walls of bricks of one size, their corners, floors and ties; heading: of the first
    horizontal component of the motion in plan, from x towards y [deg]."""

    KIND: ClassVar = "house"
    line_loads: ClassVar = ()

    name: str
    walls: tuple[Placed, ...]
    corners: tuple[Corner, ...] = ()
    floors: tuple[Diaphragm, ...] = ()
    ties: tuple[Ties, ...] = ()
    heading: float = quantity("deg", -360, 360, default=0.0)

    def __post_init__(self):
        check_fields(self)
        if not self.walls:
            raise InputError(f"house {self.name} has no [[walls]]: expected one or more; add them")
        _check_origins(self)
        names = self.names
        for name in names:
            if names.count(name) > 1:
                raise InputError(
                    f"house {self.name}: two walls named {name}: expected a name of each; give one"
                    " of them another"
                )
        for corner in self.corners:
            _check_corner(self, corner)
        for wall in (placed.wall for placed in self.walls):
            _check_masonry(self, wall)
        for floor in self.floors:
            _check_floor(self, floor)
        for ties in self.ties:
            ties.span(self)

    @property
    def names(self):
        """Names of the walls."""
        return [placed.wall.name for placed in self.walls]

    @property
    def records(self):
        """The records in it beside those of its walls."""
        return *self.floors, *self.ties

    @property
    def lone_walls(self):
        """Names of its walls that no corner, floor or tie joins to another, none of one wall."""
        parts = [part.walls for part in (*self.corners, *self.floors, *self.ties)]
        joined = {name for names in parts if len(names) > 1 for name in names}
        return [name for name in self.names if name not in joined] if len(self.walls) > 1 else []

    @property
    def each_wall(self):
        """Its damage.Walls."""
        return tuple(placed.wall for placed in self.walls)

    def with_each(self, change):
        """The House with each of its walls changed by a function."""
        walls = [replace(placed, wall=change(placed.wall)) for placed in self.walls]
        return replace(self, walls=walls)

    def check_run(self, settings, solver):
        """Raise InputError of RunSettings, and of a solver by its name, for what houses cannot do
        yet."""
        place = f"house {self.name}"
        alone = "a motion of the base, a push, settlement, or free vibration, alone; leave it out"
        refuse(place, OF_SOLVERS, solver, "YADE; give ./yade FILE.toml, or a study --solver yade")
        refuse(place, OF_RUNS, settings, alone)

    @cached_property
    def masonry(self):
        """The first wall under the name of the house, for what all walls share, as the size of
        bricks."""
        return replace(self.walls[0].wall, name=self.name)

    def carrying(self, floor):
        """The Placed walls of a Diaphragm, in the order of the house."""
        return [placed for placed in self.walls if placed.wall.name in floor.walls]

    @cached_property
    def bearing(self):
        """The Placed walls with what floors bring to each."""
        more = {name: [] for name in self.names}
        for floor in self.floors:
            for name, floors in floor.on_walls(self.carrying(floor)).items():
                more[name] += floors
        return tuple(
            replace(
                placed,
                wall=replace(placed.wall, floors=(*placed.wall.floors, *more[placed.wall.name])),
            )
            for placed in self.walls
        )

    def as_dict(self):
        """All parameters as a plain dictionary, for files; its walls have what floors bring."""
        return {
            "name": self.name,
            "heading": self.heading,
            "walls": [
                {
                    "wall": placed.wall.as_dict(),
                    "origin": list(placed.origin),
                    "direction": placed.direction,
                }
                for placed in self.bearing
            ],
            **{
                name: [vars(one) | {"walls": list(one.walls)} for one in getattr(self, name)]
                for name in _PARTS
            },
        }


def _check_origins(house):
    """Refuse origins far from that of the plan: in map coordinates, or in another unit than m."""
    origins = np.array([placed.origin for placed in house.walls])
    if np.abs(origins).max() > LONGEST_M:
        x, y = origins[0]
        raise InputError(
            f"house {house.name}: origins up to {np.abs(origins).max():.9g} m from [0, 0]: expected"
            f" up to {LONGEST_M:g} m; "
            + (
                f"these are map coordinates: subtract [{x:.12g}, {y:.12g}] from each of them"
                if np.ptp(origins, axis=0).max() <= LONGEST_M
                else "these are no metres, or of two plans: give them in m (1 mm is 0.001 m)"
            )
        )


def _check_corner(house, corner):
    """Refuse a corner of walls that are not there."""
    if len(set(corner.walls)) != 2 or not set(corner.walls) <= set(house.names):
        raise InputError(
            f"house {house.name}, corner of {list(corner.walls)}: expected two of its walls,"
            f" {', '.join(house.names)}; correct it"
        )


def _check_masonry(house, wall):
    """Refuse walls of bricks of other sizes, and what a house cannot have yet."""
    size, first = (
        (brick.length, brick.height, brick.thickness) for brick in (wall.brick, house.masonry.brick)
    )
    if size != first:
        raise InputError(
            f"house {house.name}, wall {wall.name}: its bricks have the size {size} m, those of"
            f" {house.names[0]} {first} m: expected one size, so that courses meet; correct the"
            " [brick] of one"
        )
    alone = "none, as it runs in a plane; leave it out"
    refuse(f"house {house.name}, wall {wall.name}", OF_WALLS, wall, alone)


def _check_floor(house, floor):
    """Refuse a floor on walls that are not there, or do not lie as its kind needs."""
    what = f"house {house.name}, floor at {floor.level:g} m"
    walls = house.carrying(floor)
    names = ", ".join(house.names)
    if not set(floor.walls) <= set(house.names) or len(walls) < 1 + (floor.kind == "timber"):
        raise InputError(
            f"{what} on walls {list(floor.walls)}: expected"
            f" {'two or more' if floor.kind == 'timber' else 'some'} of its walls, {names}; correct"
            " them"
        )
    for placed in walls[1:]:
        turn = abs(walls[0].axes[0] @ placed.axes[0])
        if turn < 1 - TINY and (floor.kind == "timber" or turn > TINY):
            raise InputError(
                f"{what}: walls {walls[0].wall.name} and {placed.wall.name}: expected parallel ones"
                f"{'' if floor.kind == 'timber' else ', or right angles'}; correct its walls"
            )
    floor.on_walls(walls)


_PARTS = {"corners": Corner, "floors": Diaphragm, "ties": Ties}
"""{key of a file: record} of the parts of a house beside its walls."""


def read_house(path):
    """Return the House of a TOML file; raise InputError for anything that makes none."""
    path = Path(path)
    table = dict(read_toml(path, "a house as TOML", MOST_MB))
    tables = {name: _tables(path, table.pop(name, [])) for name in ("walls", *_PARTS)}
    walls = [_placed(path, number, dict(entry)) for number, entry in enumerate(tables["walls"], 1)]
    for roof in _tables(path, [table.pop("roof")] if "roof" in table else []):
        tops = [placed.wall.height for placed in walls if placed.wall.name in roof.get("walls", ())]
        tables["floors"] = [*tables["floors"], {"level": max(tops, default=1.0)} | roof]
    parts = {
        name: user_records(f"{path}, [[{name}]]", kind, tables[name])
        for name, kind in _PARTS.items()
    }
    return user_record(f"{path}", House, table | {"walls": walls} | parts)


def _tables(path, given):
    if not isinstance(given, list) or not all(isinstance(entry, dict) for entry in given):
        raise InputError(
            f"{path}: expected tables [[walls]], [[corners]], [[floors]], [[ties]]; correct them"
        )
    return given


def _placed(path, number, table):
    """The Placed wall of a table [[walls]]."""
    file = table.pop("file", None)
    name = table.pop("name", None)
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


def load_wall_or_house(given):
    """The House, or damage.Wall, of a file, or of the name of one that ships."""
    path = wall_path(given)
    if path.suffix != ".toml":
        return load_wall(path)
    return wall_of(lambda: read_wall_or_house(path), path, (Wall, House))
