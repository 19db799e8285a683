"""Which values masonry can have: a range for each field of a wall, which finds numbers in a wrong unit.

`damage.wall.parameters` refuses what cannot be computed; these ranges are narrower.  A command checks them where it
loads a wall (`check_plausible`); a Wall that is made in Python is not checked, since histories, closed forms and
benchmarks have joints as stiff, strong or weak as they need.  Zero is plausible wherever it can be computed, as of dry
joints or without precompression: no wrong unit turns another value into zero.
"""

import math
from typing import NamedTuple

from damage.checks import check_fields
from damage.errors import InputError

ACCEPT = "--accept-implausible"
"""The option by which a command accepts all values as given."""

LENGTHS = {"mm": 1e-3, "cm": 1e-2}
STRESSES = {"MPa": 1e6, "kPa": 1e3}
MODULI = {"GPa": 1e9, "MPa": 1e6}
STIFFNESSES = {"N/mm3": 1e9, "MPa/m": 1e6}
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
"""{record and field: Range}."""


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
    return _messages(records)


def implausible_sizes(wall):
    """Implausible sizes of a damage.Wall and its bricks, as of `implausible`."""
    return _messages((wall, wall.brick), "m")


def _messages(records, units=None):
    """Implausible values of records; units: only those of fields in this unit."""
    given = [(f"{type(record).__name__}.{name}", value) for record in records
             for name, value in vars(record).items() if value]
    found = [_message_of(name, value) for name, value in given
             if name in RANGES and units in (None, RANGES[name].unit) and not RANGES[name].least <= value
             <= RANGES[name].most]
    return list(dict.fromkeys(found))  # several openings may have the same fault


def check_record(record, **ranges):
    """`damage.checks.check_fields`, whose message says in which units a value would be plausible."""
    for name, limits in ranges.items():
        try:
            check_fields(record, **{name: limits})
        except InputError as error:
            raise InputError(f"{error}{_meant(f'{type(record).__name__}.{name}', getattr(record, name))}") from None


def _message_of(name, value):
    """An implausible value, what was expected, and in which units it would be plausible."""
    least, most, unit, _, _, zero = RANGES[name]
    return (f"{name} = {short(value)} {unit}, expected {short(least)} to {short(most)} {unit}{', or 0' * zero}"
            f"{_meant(name, value)}")


def _meant(name, value):
    """The end of a message about a value: in which units it would be plausible, or nothing."""
    if name not in RANGES or not isinstance(value, int | float):
        return ""
    least, most, unit, others, *_ = RANGES[name]
    meant = [f"{short(value)} {other} is {_in_si(value, size)} {unit}" for other, size in others.items()
             if least <= value * size <= most]
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
    rows = (f"| `{name}` | {short(one.least)} | {short(one.most)} | {one.unit} | {'yes' * one.zero} | {one.why} |"
            for name, one in RANGES.items())
    return "\n".join(["| field | from | to | unit | or 0 | near the limits |", "| --- | --- | --- | --- | --- | --- |",
                      *rows])
