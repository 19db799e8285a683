"""Lintels of their own over openings: beams, and arches of bricks; `damage.wall.lintel` has those of elastic courses.

A beam is a chain of rigid segments, half a brick long, in place of the courses that its height takes.  Its cuts stay
elastic: of two segments whose centres lie d apart, two Gauss points over the height h give

    axial E b h / d,  bending E b h^3 / (12 d),  shear 5/6 G b h / d

as of Timoshenko's beam.  Bricks below, above and beside it meet it in mortar joints like any other.  Across its height
it is rigid; the compliance of these joints is that of joints between bricks.

An arch is a course of bricks on end with upright joints, which fail as all others do: it carries by its bond until
that fails, and by thrust as long as its abutments hold.  The inclined faces of a flat arch are none of rectangles: what
they bear is left to the bearing of the outermost bricks.

Both solvers take either as the bodies and contact points that it is.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from damage.checks import check_range
from damage.errors import InputError
from damage.wall.fields import MODULI, check_fields, choice, quantity

LINTEL_COURSE, ARCH_COURSE = -3, -4
"""`course` of the segments of a beam and of the bricks of an arch, beside -1 of a top mass and -2 of a slab."""
SHEAR_SHARE = 5 / 6  # of a rectangle's area
_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(12)  # of the height, from its middle
_TINY = 1e-6  # [m], two positions closer than this are the same


class Usual(NamedTuple):
    """What a kind of lintel has where nothing is given: height [m], Young's modulus [Pa], its ratio to the shear
    modulus [-], density [kg/m3], and where these come from."""

    height: float | None
    modulus: float | None
    shear_ratio: float
    density: float | None
    source: str


USUAL = {
    "concrete": Usual(0.15, 30e9, 2.4, 2500.0, "C20/25, EN 1992-1-1, Table 3.1; reinforced, EN 1991-1-1, Table A.1"),
    "steel": Usual(0.10, 210e9, 2.6, 7850.0, "EN 1993-1-1, 3.2.6; EN 1991-1-1, Table A.4"),
    "timber": Usual(0.15, 11e9, 16.0, 420.0, "C24, EN 338"),
    "stone": Usual(0.20, None, 2.4, 2700.0, "no modulus without the stone"),
    "arch": Usual(None, None, 1.0, None, "the wall's bricks, on end"),
}
"""{kind: Usual} of lintels that are bodies."""
KINDS_OF_LINTELS = (*USUAL, "courses")
BEARING = 0.10
"""Bearing of a beam on each side [m]: at least 100 mm, EN 845-2."""


@dataclass(frozen=True)
class Lintel:
    """A lintel.

    kind: a beam of "concrete", "steel", "timber" or "stone", an "arch" of bricks on end, or the "courses" above the
    opening, of which `ModelOptions.lintel` says whether their joints stay elastic.
    height [m]: of the beam's section, or of the arch, by default a brick's length; bearing [m]: on each side, laid to
    quarters of a brick; modulus [Pa]; density [kg/m3]; width [m]: of the beam's section, by default the wall's
    thickness.  None: as `USUAL` and `BEARING` say, the bearing of an arch a brick's height.
    """

    kind: str = choice(KINDS_OF_LINTELS, default="concrete")
    height: float | None = quantity("m", 1e-3, 10.0, (0.01, 3), "a steel plate; a transfer beam", default=None)
    bearing: float | None = quantity("m", 0.0, 10.0, (0.02, 5), "a steel angle; a beam to the next opening", zero=True,
                                     default=None)
    modulus: float | None = quantity("Pa", 1e-3, 1e13, (1e8, 1e12), "soft wood; steel has 2.1e11", others=MODULI,
                                     default=None)
    density: float | None = quantity("kg/m3", 1e-3, 1e5, (100, 2e4), "soft wood; steel has 7850", default=None)
    width: float | None = quantity("m", 1e-3, 10.0, (0.001, 3), "the web of a section; a historical wall", default=None)

    def __post_init__(self):
        check_fields(self)
        if self.bearing is not None and self.kind != "arch":
            check_range("Lintel.bearing", self.bearing, 0.01, 10.0)
        of_beams = [name for name in ("modulus", "density", "width") if getattr(self, name) is not None]
        if self.kind in ("arch", "courses") and of_beams:
            raise InputError(f"Lintel({self.kind!r}, {of_beams[0]}=...): expected of a beam alone; leave it out")
        if self.kind == "stone" and self.modulus is None:
            raise InputError('Lintel("stone"): expected the stone\'s modulus [Pa]; give modulus=..., as 2e10')

    @property
    def is_body(self):
        """Whether it is bodies of its own."""
        return self.kind != "courses"

    def of(self, name):
        """A value, or the usual one of its kind."""
        given = getattr(self, name)
        return getattr(USUAL[self.kind], name) if given is None else given

    def built(self, brick):
        """Height, width and bearing [m] in a wall of these bricks."""
        height = self.of("height") or brick.length
        bearing = self.bearing if self.bearing is not None else brick.height if self.kind == "arch" else BEARING
        return height, self.width or brick.thickness, bearing

    def courses(self, brick):
        """Number of courses whose place it takes."""
        return max(1, round(self.built(brick)[0] / brick.height))

    def as_dict(self):
        """What is given, for files."""
        return {name: value for name, value in vars(self).items() if value is not None}


def lintel_of(given):
    """The Lintel of a name, of a table {field: value} or of a Lintel; InputError for anything else."""
    if isinstance(given, str):
        return Lintel(given)
    if isinstance(given, dict):
        try:
            return Lintel(**given)
        except TypeError as error:
            raise InputError(f"lintel = {given!r}: {error}; expected {', '.join(vars(Lintel()))}") from error
    if not isinstance(given, Lintel):
        raise InputError(f"lintel = {given!r}: expected Lintel(...), or one of {', '.join(KINDS_OF_LINTELS)}; "
                         "correct it")
    return given


class Place(NamedTuple):
    """A lintel in a wall: the part of its length [m], its first course and the first above it, the edges (n + 1,) of
    its segments or bricks, and the height and width of its section [m]."""

    lintel: Lintel
    left: float
    right: float
    first: int
    above: int
    edges: tuple[float, ...]
    height: float
    width: float

    @property
    def parts(self):
        """Number of its bodies."""
        return len(self.edges) - 1


def edges_of(lintel, brick, left, right, near):
    """Edges of the parts of a lintel from left to right [m]: on the bond's half bricks in a beam; a brick's height
    apart in an arch, on joints of the bond and on the places `near` by where these are closer than 8 mm."""
    if lintel.kind != "arch":
        half = brick.length / 2
        first, last = np.ceil((left + half / 2 - _TINY) / half), np.floor((right - half / 2 + _TINY) / half)
        return (left, *(float(k * half) for k in range(int(first), int(last) + 1)), right)
    quarter, count = brick.length / 4, max(2, round((right - left) / brick.height))
    inner = []
    for x in (left + (right - left) * k / count for k in range(1, count)):
        beside = min((*near, round(x / quarter) * quarter), key=lambda place: abs(place - x))
        inner.append(float(beside if abs(beside - x) < min(8e-3, quarter / 4) else x))
    return (left, *inner, right)


def lintel_bodies(wall, places):
    """{field: values} of all parts of lintels as bodies, place by place, left to right."""
    brick = wall.brick
    rows = []
    for place in places:
        z, height = (place.first + place.above) / 2 * brick.height, (place.above - place.first) * brick.height
        arch = place.lintel.kind == "arch"
        per_length = brick.density * brick.thickness * height if arch else (
            place.lintel.of("density") * place.width * place.height)
        for left, right in zip(place.edges[:-1], place.edges[1:]):
            mass = per_length * (right - left)
            rows.append(((left + right) / 2, z, right - left, height, mass, mass * ((right - left)**2 + height**2) / 12,
                         ARCH_COURSE if arch else LINTEL_COURSE))
    columns = np.array(rows, dtype=float).reshape(-1, 7).T
    names = ("x", "z", "length", "height", "mass", "inertia", "course")
    return dict(zip(names, columns)) | {"course": columns[6].astype(int)}


def cut_places(place):
    """Heights (2,) [m] of the contact points of a beam's cut from its middle, and the length of each [m]."""
    return _GAUSS * place.height, place.height / 2


def cut_stiffness(wall, place, x):
    """Normal and shear stiffness [Pa/m] of the cut at x [m] through a beam, of contact points as wide as the wall."""
    cut = int(np.abs(np.array(place.edges) - x).argmin())
    distance = (place.edges[cut + 1] - place.edges[cut - 1]) / 2
    modulus = place.lintel.of("modulus") * place.width / wall.brick.thickness
    return modulus / distance, SHEAR_SHARE * modulus / USUAL[place.lintel.kind].shear_ratio / distance


def describe_place(wall, place):
    """A lintel in a line: kind, place as laid, and section or number of bricks."""
    what = f"{place.parts} bricks on end, {place.height:.3g} m high" if place.lintel.kind == "arch" else (
        f"{place.width:.3g} x {place.height:.3g} m, modulus {place.lintel.of('modulus') / 1e9:.3g} GPa")
    return (f"{place.lintel.kind} lintel at {place.first * wall.brick.height:.4g} m, x = {place.left:.4g} to "
            f"{place.right:.4g} m: {what}")
