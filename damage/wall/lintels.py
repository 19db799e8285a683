"""Lintels over openings: beams and arches of bricks, bodies of their own; and courses whose joints
stay elastic.

A beam is a chain of rigid segments, half a brick long, in place of the courses that its height
takes.  Its cuts stay elastic: of two segments whose centres lie d apart, two Gauss points over the
height h give

    axial E b h / d,  bending E b h^3 / (12 d),  shear 5/6 G b h / d

as of Timoshenko's beam.  Bricks below, above and beside it meet it in mortar joints like any other.
Across its height it is rigid; the compliance of these joints is that of joints between bricks.

An arch is a course of bricks on end with upright joints, which fail as all others do: it carries by
its bond until that fails, and by thrust as long as its abutments hold.  The inclined faces of a
flat arch are none of rectangles: what they bear is left to the bearing of the outermost bricks.

Both solvers take either as the bodies and contact points that it is.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from damage.checks import check_range
from damage.errors import InputError
from damage.fields import MODULI, check_fields, choice, quantity
from damage.wall.kinds import TINY

SHEAR_SHARE = 5 / 6  # of a rectangle's area
_GAUSS = np.array([-1.0, 1.0]) / np.sqrt(12)  # of the height, from its middle


class Usual(NamedTuple):
    """What a kind of lintel has where nothing is given: height [m], Young's modulus [Pa], its ratio
    to the shear modulus [-], density [kg/m3], and where these come from."""

    height: float | None
    modulus: float | None
    shear_ratio: float
    density: float | None
    source: str


USUAL = {
    "concrete": Usual(
        0.15,
        30e9,
        2.4,
        2500.0,
        "C20/25, EN 1992-1-1, Table 3.1; reinforced, EN 1991-1-1, Table A.1",
    ),
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

    kind: a beam of "concrete", "steel", "timber" or "stone", an "arch" of bricks on end, or the
    "courses" above the opening, of which `ModelOptions.lintel` says whether their joints stay
    elastic.
    height [m]: of the beam's section, or of the arch, by default a brick's length; bearing [m]: on
    each side, laid to quarters of a brick; modulus [Pa]; density [kg/m3]; width [m]: of the beam's
    section, by default the wall's thickness.  None: as `USUAL` and `BEARING` say, the bearing of an
    arch a brick's height.

    >>> from damage.wall.parameters import Brick
    >>> lintel = Lintel("timber", bearing=0.2)
    >>> lintel.built(Brick()), lintel.courses(Brick()), lintel.is_body  # [m], courses
    ((0.15, 0.1025, 0.2), 2, True)
    >>> lintel.value_of("modulus"), lintel.as_dict()  # [Pa]
    (11000000000.0, {'kind': 'timber', 'bearing': 0.2})
    """

    kind: str = choice(KINDS_OF_LINTELS, default="concrete")
    height: float | None = quantity(
        "m", 1e-3, 10.0, (0.01, 3), "a steel plate; a transfer beam", default=None
    )
    bearing: float | None = quantity(
        "m",
        0.0,
        10.0,
        (0.02, 5),
        "a steel angle; a beam to the next opening",
        zero=True,
        default=None,
    )
    modulus: float | None = quantity(
        "Pa", 1e-3, 1e13, (1e8, 1e12), "soft wood; steel has 2.1e11", others=MODULI, default=None
    )
    density: float | None = quantity(
        "kg/m3", 1e-3, 1e5, (100, 2e4), "soft wood; steel has 7850", default=None
    )
    width: float | None = quantity(
        "m", 1e-3, 10.0, (0.001, 3), "the web of a section; a historical wall", default=None
    )

    def __post_init__(self):
        check_fields(self)
        if self.bearing is not None and self.kind != "arch":
            check_range("Lintel.bearing", self.bearing, 0.01, 10.0)
        of_beams = [
            name for name in ("modulus", "density", "width") if getattr(self, name) is not None
        ]
        if self.kind in ("arch", "courses") and of_beams:
            raise InputError(
                f"Lintel({self.kind!r}, {of_beams[0]}=...): expected of a beam alone; leave it out"
            )
        if self.kind == "stone" and self.modulus is None:
            raise InputError(
                'Lintel("stone"): expected the stone\'s modulus [Pa]; give modulus=..., as 2e10'
            )

    @property
    def is_body(self) -> bool:
        """Whether it is bodies of its own."""
        return self.kind != "courses"

    def value_of(self, name: str) -> float:
        """A value, or the usual one of its kind."""
        given = getattr(self, name)
        return getattr(USUAL[self.kind], name) if given is None else given

    def built(self, brick) -> tuple[float, float, float]:
        """Height, width and bearing [m] in a wall of these bricks."""
        height = self.value_of("height") or brick.length
        bearing = (
            self.bearing
            if self.bearing is not None
            else brick.height
            if self.kind == "arch"
            else BEARING
        )
        return height, self.width or brick.thickness, bearing

    def courses(self, brick) -> int:
        """Number of courses whose place it takes."""
        return max(1, round(self.built(brick)[0] / brick.height))

    def as_dict(self) -> dict:
        """What is given, for files."""
        return {name: value for name, value in vars(self).items() if value is not None}


def lintel_of(given: str | dict | Lintel) -> Lintel:
    """The Lintel of a name, of a table {field: value} or of a Lintel; InputError for anything
    else.

    >>> lintel_of("concrete").kind
    'concrete'
    """
    if isinstance(given, str):
        return Lintel(given)
    if isinstance(given, dict):
        try:
            return Lintel(**given)
        except TypeError as error:
            raise InputError(
                f"lintel = {given!r}: {error}; expected {', '.join(vars(Lintel()))}"
            ) from error
    if not isinstance(given, Lintel):
        raise InputError(
            f"lintel = {given!r}: expected Lintel(...), or one of {', '.join(KINDS_OF_LINTELS)}; "
            "correct it"
        )
    return given


class LintelPlace(NamedTuple):
    """A lintel in a wall: the part of its length [m], its first course and the first above it, the
    edges (n + 1,) of its segments or bricks, and the height and width of its section [m]."""

    lintel: Lintel
    left: float
    right: float
    first: int
    above: int
    edges: tuple[float, ...]
    height: float
    width: float

    @property
    def parts(self) -> int:
        """Number of its bodies."""
        return len(self.edges) - 1


def edges_of(
    lintel: Lintel, brick, left: float, right: float, near: np.ndarray
) -> tuple[float, ...]:
    """Edges of the parts of a lintel from left to right [m]: on the bond's half bricks in a beam; a
    brick's height apart in an arch, on joints of the bond and on the places `near` by where these
    are closer than 8 mm."""
    if lintel.kind != "arch":
        half = brick.length / 2
        first = np.ceil((left + half / 2 - TINY) / half)
        last = np.floor((right - half / 2 + TINY) / half)
        return (left, *(float(k * half) for k in range(int(first), int(last) + 1)), right)
    quarter = brick.length / 4
    count = max(2, round((right - left) / brick.height))
    inner = []
    for x in (left + (right - left) * k / count for k in range(1, count)):
        beside = min((*near, round(x / quarter) * quarter), key=lambda place: abs(place - x))
        inner.append(float(beside if abs(beside - x) < min(8e-3, quarter / 4) else x))
    return (left, *inner, right)


def mass_per_length(brick, place: LintelPlace) -> float:
    """Mass of a lintel along its length [kg/m], in a wall of these bricks."""
    if place.lintel.kind == "arch":
        return brick.density * brick.thickness * ((place.above - place.first) * brick.height)
    return place.lintel.value_of("density") * place.width * place.height


def cut_places(place: LintelPlace) -> tuple[np.ndarray, float]:
    """Heights (2,) [m] of the contact points of a beam's cut from its middle, and the length of
    each [m]."""
    return _GAUSS * place.height, place.height / 2


def cut_stiffness(brick, place: LintelPlace, x: float) -> tuple[float, float]:
    """Normal and shear stiffness [Pa/m] of the cut at x [m] through a beam, of contact points as
    wide as the wall."""
    cut = int(np.abs(np.array(place.edges) - x).argmin())
    distance = (place.edges[cut + 1] - place.edges[cut - 1]) / 2
    modulus = place.lintel.value_of("modulus") * place.width / brick.thickness
    return (
        modulus / distance,
        SHEAR_SHARE * modulus / USUAL[place.lintel.kind].shear_ratio / distance,
    )


LARGE_SHARE = 0.15
"""Share of the joint length that is elastic [-] above which a run is warned of: half as much again
as in the façades of the paper, 0.10, in which alone elastic lintels were compared with published
results."""


class ElasticShare(NamedTuple):
    """Length of joints that are elastic and cannot fail, over the length of all joints [-]; and the
    same of the courses above openings, along the whole wall, None of a wall without."""

    of_all: float
    above_openings: float | None


def in_lintel(plan, lintel: str, x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Which joints lie strictly inside a lintel of courses: in those over an opening, or the lowest
    of them, one brick of bearing on each side; the bed joints under the bearing and over the
    highest of these courses are not inside.

    lintel: as of ModelOptions, of which a number is of courses, and "none" none; x, z: middles of
    the joints' parts between two bricks [m].  Openings with a lintel of their own have none of
    these.
    """
    brick = plan.wall.brick
    inside = np.zeros(len(x), dtype=bool)
    most = 0 if lintel == "none" else int(lintel) if lintel.isdigit() else len(plan.runs)
    for place in (opening for opening in plan.openings if not opening.lintel.is_body):
        inside |= (
            (x > place.left - brick.length + TINY)
            & (x < place.right + brick.length - TINY)
            & _within(place.above, min(place.spandrel, place.above + most), brick.height, z)
        )
    return inside


def _within(first, above, course, z):
    """Which heights z [m] lie strictly inside the courses from the first up to the one above, by a
    course's height."""
    return (z > first * course + TINY) & (z < above * course - TINY)


def elastic_share(plan, joints, bodies) -> ElasticShare:
    """The ElasticShare of a damage.wall.plan.Plan; joints, bodies: as of a History, or of
    `damage.wall.geometry`."""
    kind = joints["kind"].to_numpy()
    length = np.where(kind == "brick", 0.0, joints["length_m"])
    elastic = length * joints["elastic"].to_numpy()
    # A contact point at the end of a head joint lies at the boundary of its course: the brick
    # beside it lies inside.
    z = np.where(kind == "head", bodies["z_m"].to_numpy()[joints["second_body"]], joints["z_m"])
    above = np.zeros(len(z), bool)
    for place in plan.openings:
        above |= _within(place.above, place.spandrel, plan.wall.brick.height, z)
    return ElasticShare(
        float(elastic.sum() / length.sum()),
        float(elastic[above].sum() / length[above].sum()) if length[above].any() else None,
    )


def describe_share(share: ElasticShare) -> str:
    """An ElasticShare in a line for people.

    >>> describe_share(ElasticShare(0.3312, 0.784))
    '33 % of the joint length (78 % above the openings) is elastic and cannot fail'
    >>> describe_share(ElasticShare(0.0, None))
    'no joint is elastic, all can fail'
    """
    if share.of_all == 0:
        return "no joint is elastic, all can fail"
    above = (
        ""
        if share.above_openings is None
        else f" ({100 * share.above_openings:.2g} % above the openings)"
    )
    return f"{100 * share.of_all:.2g} % of the joint length{above} is elastic and cannot fail"


def warn_of_share(share: ElasticShare) -> list[str]:
    """Warnings of an ElasticShare: a list of at most one line."""
    if share.of_all <= LARGE_SHARE:
        return []
    return [
        f"{describe_share(share)}: above {100 * LARGE_SHARE:g} % the choice of the lintel may"
        " decide the result; compare with --lintel 1 (docs/guides/own-wall.md)"
    ]
