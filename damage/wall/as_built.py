"""What of a wall is built otherwise than given, since courses are whole: its height, openings, levels of floors."""

from typing import NamedTuple

_SAME = 1e-4  # [m], sizes and places closer than this are as given
WARN_COURSE, WARN_HEIGHT = 0.25, 0.05
"""Distance of an edge from its place, in courses, and share of a height, above which a run warns."""


class Part(NamedTuple):
    """A part of a wall: its name; z [m] of its lower and upper edge as given and as built; length [m], None where it
    is as given or of no interest."""

    what: str
    given: tuple[float, float]
    built: tuple[float, float]
    length: float | None = None

    @property
    def differs(self):
        """Whether it is built otherwise."""
        return any(abs(one - other) > _SAME for one, other in zip(self.given, self.built))

    def far(self, course):
        """Whether it is built far from what is given, in a wall of courses of this height [m]."""
        height, built = (high - low for low, high in (self.given, self.built))
        return (any(abs(one - other) > WARN_COURSE * course + _SAME for one, other in zip(self.given, self.built))
                or abs(built - height) > WARN_HEIGHT * height + _SAME)

    def describe(self):
        """It in a line."""
        return f"{self.what} built {_sized(self.built, self.length)}; given {_sized(self.given, self.length)}"


def _sized(edges, length):
    low, high = edges
    size = f"{length:.4g} x {high - low:.4g} m" if length else f"{high - low:.4g} m high"
    return f"{size}, z = {low:.4g} to {high:.4g} m"


def openings_as_built(wall):
    """The openings of a damage.Wall, a list of Part in their order."""
    course = wall.brick.height
    return [Part(f"opening {number}", (one.sill, one.sill + one.height),
                 tuple(course * edge for edge in wall.opening_courses(one)), one.width)
            for number, one in enumerate(wall.openings, start=1)]


def describe_openings(wall):
    """Lines on the openings of a wall that are built otherwise than given."""
    return [one.describe() for one in openings_as_built(wall) if one.differs]


def warn_of_courses(wall):
    """Warnings of parts of a wall that are built far from what is given: a list of at most one line."""
    course = wall.brick.height
    levels = [Part(f"floor {number}", (0.0, one.level), (0.0, course * one.courses(wall)[1]))
              for number, one in enumerate(wall.floors, start=1)]
    whole = Part("wall", (0.0, wall.height), (0.0, wall.built_height))
    far = [one.describe() for one in (whole, *openings_as_built(wall), *levels) if one.far(course)]
    return [f"whole courses of {course:.4g} m leave differences above {WARN_COURSE:g} of a course or "
            f"{100 * WARN_HEIGHT:g} %: {'. '.join(far)}. Give multiples of a course, or look at the picture of "
            "python3 -m damage draw"] if far else []
