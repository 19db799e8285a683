"""Which values masonry can have: the ranges that the fields of a wall say find numbers in a wrong
unit.

`damage.wall.parameters` refuses what cannot be computed; these ranges are narrower.  A command
checks them where it loads a wall (`check_plausible`); a Wall that is made in Python is not checked,
since histories, closed forms and benchmarks have joints as stiff, strong or weak as they need.
Zero is plausible wherever it can be computed, as of dry joints or without precompression: no wrong
unit turns another value into zero.
"""

from damage.errors import InputError
from damage.fields import implausible_fields, message_of, plausible, ranges_of
from damage.house.house import Diaphragm
from damage.house.ties import Ties
from damage.wall.floors import Floor
from damage.wall.lintels import Lintel
from damage.wall.parameters import Brick, Joint, Opening, Wall

ACCEPT = "--accept-implausible"
"""The option by which a command accepts all values as given."""
PER_LENGTH = "Floor.mass over its length"
_PER_LENGTH = plausible(20, 1e5, "kg/m", "a light roof on a short span; several concrete floors")
RANGES = {
    name: of
    for kind in (Wall, Opening, Lintel, Floor, Brick, Joint, Diaphragm, Ties)
    for name, of in ranges_of(kind).items()
} | {PER_LENGTH: _PER_LENGTH}
"""{record and field, or what follows from fields: Range}."""


def check_plausible(wall):
    """Raise InputError, in one line, where a damage.Wall, or House, has values that masonry does
    not have."""
    for part in (*wall.each_wall, wall):
        if problems := implausible(part):
            raise InputError(
                f"{part.KIND} {part.name}: {'; '.join(problems)}. Correct the unit, or accept all"
                f" values as given: {ACCEPT}"
            )


def implausible(wall):
    """Implausible values of a damage.Wall, or of a House without its walls: a list of str, each
    with the unit that was probably meant.

    >>> implausible(Wall("w", 2.0, 1.0, joint=Joint(tensile_strength=0.1, cohesion=0.0)))
    ['Joint.tensile_strength = 0.1 Pa, expected 1000 to 1e7 Pa, or 0: 0.1 MPa is 0.1e6 Pa']
    """
    loads = (message_of(PER_LENGTH, load, _PER_LENGTH) for load in wall.line_loads)
    return list(dict.fromkeys([*implausible_fields(*wall.records), *filter(None, loads)]))
