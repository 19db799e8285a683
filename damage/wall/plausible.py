"""Which values masonry can have: a range for each field of a wall, which finds numbers in a wrong unit.

`damage.wall.parameters` refuses what cannot be computed; these ranges are narrower.  A command checks them where it
loads a wall (`check_plausible`); a Wall that is made in Python is not checked, since histories, closed forms and
benchmarks have joints as stiff, strong or weak as they need.  Zero is plausible wherever it can be computed, as of dry
joints or without precompression: no wrong unit turns another value into zero.
"""

import math
from typing import NamedTuple

import numpy as np

from damage.checks import check_fields
from damage.errors import InputError

ACCEPT = "--accept-implausible"
"""The option by which a command accepts all values as given."""

LENGTHS = {"mm": 1e-3, "cm": 1e-2}
STRESSES = {"MPa": 1e6, "kPa": 1e3}
MODULI = {"GPa": 1e9, "MPa": 1e6}
STIFFNESSES = {"N/mm3": 1e9, "MPa/m": 1e6}
_PARTS = 20  # of a straight part of a crack
ENERGIES = {"N/mm": 1e3}
DENSITIES = {"t/m3": 1e3, "kN/m3": 1e3 / 9.81, "N/m3": 1 / 9.81}


class Range(NamedTuple):
    """Plausible values of a field in its SI unit; others: {unit that may have been meant: its size in the SI unit};
    why: what has values near the limits, with the source where there is one; zero: whether that is plausible, too."""

    least: float
    most: float
    unit: str
    others: dict
    why: str
    zero: bool = False


PER_LENGTH = "Floor.mass over its length"
RANGES = {
    "Wall.length": Range(0.1, 200, "m", LENGTHS, "a pier of half a brick; a terrace of houses"),
    "Wall.height": Range(0.03, 50, "m", LENGTHS, "one course; a tower"),
    "Wall.precompression": Range(1e3, 2e7, "Pa", STRESSES, "a light roof; the strength of strong masonry", zero=True),
    "Opening.width": Range(0.03, 50, "m", LENGTHS, "a vent; the gate of a hall"),
    "Opening.height": Range(0.03, 50, "m", LENGTHS, "a vent; the gate of a hall"),
    "Lintel.height": Range(0.01, 3, "m", LENGTHS, "a steel plate; a transfer beam"),
    "Lintel.bearing": Range(0.02, 5, "m", LENGTHS, "a steel angle; a beam to the next opening", zero=True),
    "Lintel.width": Range(0.001, 3, "m", LENGTHS, "the web of a section; a historical wall"),
    "Lintel.modulus": Range(1e8, 1e12, "Pa", MODULI, "soft wood; steel has 2.1e11"),
    "Lintel.density": Range(100, 2e4, "kg/m3", DENSITIES, "soft wood; steel has 7850"),
    "Floor.level": Range(0.03, 50, "m", LENGTHS, "on the base course; a tower"),
    "Floor.mass": Range(1, 1e6, "kg", {"t": 1e3}, "a shelf; the floor of a hall"),
    PER_LENGTH: Range(20, 1e5, "kg/m", {"t/m": 1e3}, "a light roof on a short span; several concrete floors"),
    "Floor.depth": Range(0.01, 2, "m", LENGTHS, "a screed; a transfer slab"),
    "Brick.length": Range(0.02, 2, "m", LENGTHS, "a brick of a scale model; calcium silicate elements have 1 m"),
    "Brick.height": Range(0.01, 2, "m", LENGTHS, "a brick of a scale model; calcium silicate elements have 0.65 m"),
    "Brick.thickness": Range(0.01, 3, "m", LENGTHS, "a brick of a scale model; a historical wall"),
    "Brick.density": Range(300, 4000, "kg/m3", DENSITIES, "autoclaved aerated concrete has 300 or more, EN 771-4; "
                           "dense stone has 3000"),
    "Brick.young_modulus": Range(1e8, 1e12, "Pa", MODULI, "adobe; stone has up to 1e11, a brick of "
                                 "`brick_of_masonry` may have more"),
    "Brick.shear_modulus": Range(3e7, 1e12, "Pa", MODULI, "0.4 of Young's modulus, EN 1996-1-1, 3.7.3"),
    "Brick.tensile_strength": Range(1e4, 1e8, "Pa", STRESSES, "adobe; clay bricks have some 1e6", zero=True),
    "Brick.cohesion": Range(1e4, 1e8, "Pa", STRESSES, "as the tensile strength, or some times that", zero=True),
    "Joint.normal_stiffness": Range(1e8, 1e14, "Pa/m", STIFFNESSES, "dry joints of tests have some 1e9; the paper's "
                                    "Table 1 has 12e11"),
    "Joint.shear_stiffness": Range(3e7, 1e14, "Pa/m", STIFFNESSES, "0.4 of the normal stiffness"),
    "Joint.friction_angle": Range(0.05, 1.2, "rad", {}, "friction coefficients of 0.05 and 2.6; EN 1996-1-1, 3.6.2, "
                                  "has 0.4", zero=True),
    "Joint.tensile_strength": Range(1e3, 1e7, "Pa", STRESSES, "lime mortar; thin glued joints have some 1e6",
                                    zero=True),
    "Joint.cohesion": Range(1e3, 1e7, "Pa", STRESSES, "EN 1996-1-1, 3.6.2, has 1e5 to 4e5", zero=True),
    "Joint.mode_i_fracture_energy": Range(0.5, 1e4, "J/m2", ENERGIES, "clay brickwork has 5.6 to 19 (Korswagen, "
                                          "2022)", zero=True),
    "Joint.mode_ii_fracture_energy": Range(1, 1e5, "J/m2", ENERGIES, "clay brickwork has 102 to 353 (Korswagen, "
                                           "2022)", zero=True),
    "Joint.compressive_strength": Range(1e5, 1e9, "Pa", STRESSES, "adobe; the strongest bricks have some 1e8"),
    "Joint.compressive_fracture_energy": Range(100, 1e6, "J/m2", ENERGIES, "masonry has 0.33 to 1.6 mm times its "
                                               "strength (Lourenço, 2009)", zero=True),
}
"""{record and field, or what follows from fields: Range}."""

CRACK_WIDTH_MM = 0.01, 200.0
"""Plausible largest widths of the cracks of a file [mm]: visible by a lens; a wall that is about to fall."""
OFF_WALL, ON_WALL = 0.2, 0.02
"""Share of the length of a file's cracks off the wall above which its places are implausible, and up to which those in
another unit or with another z are named."""
SMALL = 0.05
"""Share of the wall's length or height that cracks in another unit take at least."""
_FRAMES = {"z up": (0, 1), "z down from the top": (1, -1), "negative z down from the top": (1, 1)}
"""{what may have been meant by z: its shift in heights of the wall, its factor}."""


def check_plausible(wall):
    """Raise InputError, in one line, where a damage.Wall has values that masonry does not have."""
    found = implausible(wall)
    if found:
        raise InputError(f"wall {wall.name}: {'; '.join(found)}. Correct the unit, or accept all values as given: "
                         f"{ACCEPT}")


def implausible(wall):
    """Implausible values of a damage.Wall: a list of str, each with the unit that was probably meant.

    >>> from damage.wall.parameters import Joint, Wall
    >>> implausible(Wall("w", 2.0, 1.0, joint=Joint(tensile_strength=0.1, cohesion=0.0)))
    ['Joint.tensile_strength = 0.1 Pa, expected 1000 to 1e7 Pa, or 0: 0.1 MPa is 0.1e6 Pa']
    """
    records = wall, *wall.openings, *wall.floors, wall.brick, wall.joint, wall.lintel, *(
        opening.lintel for opening in wall.openings if opening.lintel)
    spans = [(floor.mass, *floor.span(wall)) for floor in wall.floors]
    return _messages(_fields(*records) + [(PER_LENGTH, mass / (right - left)) for mass, left, right in spans])


def implausible_places(ends, wall):
    """What is implausible of the places of cracks on a damage.Wall, in words: many lie beside it or in its openings;
    None where nothing is.  ends: (n, 2, 2) x, z of both ends of straight parts of cracks [m]."""
    ends = np.asarray(ends, float)
    if len(ends) == 0 or _share_off(ends, wall) <= OFF_WALL:
        return None
    fits = next((words for words, moved in _other_frames(ends, wall) if _share_off(moved, wall) <= ON_WALL), None)
    low, high = ends.min(axis=(0, 1)), ends.max(axis=(0, 1))
    return (f"{100 * _share_off(ends, wall):.0f} % of the cracks' length, x = {low[0]:.4g} to {high[0]:.4g} m, z = "
            f"{low[1]:.4g} to {high[1]:.4g} m, lies beside wall {wall.name} of {wall.length:.4g} x "
            f"{wall.built_height:.4g} m or in its openings: expected m, x from its left end and z up from its base"
            + (f"; as {fits} they fit" if fits else ""))


def _other_frames(ends, wall):
    """Yield (what may have been meant, the cracks moved by it), but for cracks that become so small that all would fit
    into a corner."""
    for unit, size in {"m": 1.0, "cm": 1e-2, "mm": 1e-3}.items():
        if max(size * np.ptp(ends, axis=(0, 1)) / (wall.length, wall.built_height)) > SMALL:
            for words, (shift, factor) in _FRAMES.items():
                yield f"in {unit}, {words}", ends * (size, factor * size) + (0.0, shift * wall.built_height)


def _share_off(ends, wall):
    """Share of the length of cracks that lies beside a wall, above its outline or in its openings, by more than a
    course."""
    length, reach = np.hypot(*(ends[:, 1] - ends[:, 0]).T), wall.brick.height
    share = (np.arange(_PARTS) + 0.5) / _PARTS
    x, z = np.moveaxis(ends[:, :1] + share[:, None] * (ends[:, 1:] - ends[:, :1]), -1, 0)
    top = np.interp(x, *zip(*wall.outline)) if wall.outline else wall.built_height
    off = (x < -reach) | (x > wall.length + reach) | (z < -reach) | (z > top + reach)
    for opening in wall.openings:
        low, high = (wall.brick.height * course for course in wall.opening_courses(opening))
        off |= ((x > opening.left + reach) & (x < opening.right - reach) & (z > low + reach) & (z < high - reach))
    return float(length @ off.mean(axis=1) / length.sum())


def implausible_sizes(wall):
    """Implausible sizes of a damage.Wall and its bricks, as of `implausible`."""
    return _messages(one for one in _fields(wall, wall.brick) if one[0] in RANGES and RANGES[one[0]].unit == "m")


def _fields(*records):
    """(record and field, value) of all fields of records."""
    return [(f"{type(record).__name__}.{name}", value) for record in records for name, value in vars(record).items()]


def _messages(given):
    """Messages about what is implausible of pairs (name, value), each once: several openings may have one fault."""
    found = (message_of(name, value, RANGES[name]) for name, value in given if name in RANGES and value)
    return list(dict.fromkeys(filter(None, found)))


def check_record(record, **ranges):
    """`damage.checks.check_fields`, whose message says in which units a value would be plausible."""
    for name, limits in ranges.items():
        try:
            check_fields(record, **{name: limits})
        except InputError as error:
            raise InputError(f"{error}{_meant(getattr(record, name), RANGES.get(f'{type(record).__name__}.{name}'))}") \
                from None


def message_of(name, value, of):
    """Of an implausible value what was expected by a Range, and in which units it would be plausible; None of a
    plausible one.  The sign does not count.

    >>> message_of("--scale", -250.0, Range(0.01, 100, "", {"%": 0.01}, ""))
    '--scale = -250, expected 0.01 to 100: -250 % is -250e-2'
    """
    least, most, unit, *_, zero = of
    if least <= abs(value) <= most or (zero and value == 0):
        return None
    space = " " * bool(unit)
    return (f"{name} = {short(value)}{space}{unit}, expected {short(least)} to {short(most)}{space}{unit}"
            f"{', or 0' * zero}{_meant(value, of)}")


def _meant(value, of):
    """The end of a message about a value: in which units it would be plausible by a Range, or nothing."""
    if of is None or not isinstance(value, int | float):
        return ""
    meant = [f"{short(value)} {other} is {_in_si(value, size)}{' ' * bool(of.unit)}{of.unit}"
             for other, size in of.others.items() if of.least <= abs(value) * size <= of.most]
    return f": {', '.join(meant)}" if meant else ""


def short(number):
    """A number with up to six digits.

    >>> short(1e7), short(5.0), short(2.5e-05)
    ('1e7', '5', '2.5e-5')
    """
    return f"{number:g}".replace("e+0", "e").replace("e+", "e").replace("e-0", "e-")


def _in_si(value, size):
    """A value in a unit of that size, as it is typed: with an exponent where the size is a power of ten."""
    exponent = round(math.log10(size))
    if math.isclose(size, 10.0**exponent) and "e" not in short(value):
        return f"{short(value)}e{exponent}"
    return f"{value * size:.4g}"


def markdown():
    """The ranges as a table of the documents."""
    return rows("field", RANGES)


def rows(what, ranges):
    """{name: Range} as a table of the documents; what: the heading of the names."""
    lines = (f"| `{name}` | {short(one.least)} | {short(one.most)} | {one.unit} | {'yes' * one.zero} | {one.why} |"
             for name, one in ranges.items())
    return "\n".join([f"| {what} | from | to | unit | or 0 | near the limits |",
                      "| --- | --- | --- | --- | --- | --- |", *lines])
