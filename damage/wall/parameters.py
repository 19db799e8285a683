"""Frozen records that describe a wall and its material; each is checked once, when it is made.

All values are SI (m, kg, s, Pa, Pa/m) and radians.  Defaults are those of Sarhosis et al. (2021),
Engineering Structures 243, 112529, doi:10.1016/j.engstruct.2021.112529, Tables 1 and 2, where the
paper gives a value; `docs/model/model.md` gives the source of every other one.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from typing import ClassVar

from damage.checks import check_range, record_from
from damage.elementary import power, tan
from damage.errors import InputError
from damage.fields import MODULI, MOST_BRICKS, check_fields, choice, implausible_fields, quantity
from damage.units import GRAVITY
from damage.wall.floors import Floor, check_floors
from damage.wall.lintels import KINDS_OF_LINTELS, Lintel, lintel_of
from damage.wall.plan import check_bearing, check_outline, plan_of
from damage.wall.restraints import Restraint, check_restraints

LONGEST_M = 1000.0
"""Largest length and height of a wall [m]."""
LONGEST_NAME = 100
"""Largest number of characters of a wall's name."""
MOST_PARTS = 1000
"""Largest number of openings, floors, or points of the outline: each is compared with all
others."""


NO_COHESION = (
    "bricks have a cohesion no longer; expected their tensile strength f_t alone, with which they"
    " bear diagonal tension, too: leave the cohesion out, and give fracture_energy"
)
"""Message about a wall of an older version."""


RULE = "rule"
"""In place of a fracture energy: what its rule makes of the strength."""


def _energy(usual, why):
    """A field of a fracture energy, a number or RULE."""
    return quantity("J/m2", 0, 1e9, usual, why, zero=True, words=(RULE,), default=None)


@dataclass(frozen=True)
class Brick:
    """A masonry unit with its share of mortar (joints have no thickness).

    length, height, thickness [m]: along x, z and y.
    density [kg/m3]: not in the paper; 1900 is usual for calcium silicate and clay brickwork.
    young_modulus, shear_modulus [Pa]: Table 2.
    tensile_strength [Pa]: at which whole bricks split in the middle, in bending and in diagonal
        tension (`damage.wall.split`); None for bricks that do not split, as in the paper.
    fracture_energy [J/m2]: what the cut takes until it has split; None or 0 for a brittle one;
        "rule": by `splitting_energy`.

    >>> Brick().splits, Brick(tensile_strength=1e6).splits
    (False, True)
    """

    length: float = quantity(
        "m",
        1e-3,
        100.0,
        (0.02, 2),
        "a brick of a scale model; calcium silicate elements have 1 m",
        default=0.225,
    )
    height: float = quantity(
        "m",
        1e-3,
        100.0,
        (0.01, 2),
        "a brick of a scale model; calcium silicate elements have 0.65 m",
        default=0.075,
    )
    thickness: float = quantity(
        "m", 1e-3, 100.0, (0.01, 3), "a brick of a scale model; a historical wall", default=0.1025
    )
    density: float = quantity(
        "kg/m3",
        1.0,
        1e5,
        (300, 4000),
        "autoclaved aerated concrete has 300 or more, EN 771-4; dense stone has 3000",
        default=1900.0,
    )
    young_modulus: float = quantity(
        "Pa",
        1.0,
        1e20,
        (1e8, 1e12),
        "adobe; stone has up to 1e11, a brick of `brick_of_masonry` may have more",
        others=MODULI,
        default=5.2e9,
    )
    shear_modulus: float = quantity(
        "Pa",
        1.0,
        1e20,
        (3e7, 1e12),
        "0.4 of Young's modulus, EN 1996-1-1, 3.7.3",
        others=MODULI,
        default=2.16e9,
    )
    tensile_strength: float | None = quantity(
        "Pa", 0.0, 1e20, (1e4, 1e8), "adobe; clay bricks have some 1e6", zero=True, default=None
    )
    fracture_energy: float | str | None = _energy(
        (1, 1e3), "clay bricks had 47 and 58 (Mohammed, Hughes, Danraka)"
    )

    @property
    def splits(self) -> bool:
        """Whether whole bricks can split."""
        return self.tensile_strength is not None

    def __post_init__(self):
        check_fields(self)
        if self.fracture_energy and not self.tensile_strength:
            raise InputError(
                f"Brick.fracture_energy = {self.fracture_energy!r} of bricks without a tensile"
                " strength: expected one beside it; give Brick(tensile_strength=...), or leave it"
                " out"
            )
        if self.fracture_energy == RULE:
            vars(self)["fracture_energy"] = splitting_energy(self.tensile_strength)


def nearest(number: float) -> int:
    """The nearest whole number, halves up; rounding errors do not decide.

    >>> nearest(2.5), nearest(3.5), nearest(4.4999999999), nearest(0.3 / 0.2 + 1)
    (3, 4, 5, 3)
    """
    return math.floor(number + 0.5 + 1e-9)


@dataclass(frozen=True)
class Joint:
    """A zero-thickness mortar joint, Table 1; its law is `damage.law.joint_law`.

    normal_stiffness, shear_stiffness [Pa/m]; tensile_strength, cohesion [Pa];
    friction_angle [rad], the same before and after the bond breaks; dilation is zero.
    mode_i_fracture_energy, mode_ii_fracture_energy [J/m2]: what opening and sliding take until the
        bond fails; None or 0, both of them, for a brittle bond as in the paper.  Clay brickwork:
        5.6 to 19 and 102 to 353 (Korswagen, dissertation, TU Delft, 2022); "rule": by
        `softening_energies`.
    compressive_strength [Pa]: at which the joint and its bricks crush; None for joints that do not,
    as in the paper.
    compressive_fracture_energy [J/m2]: what crushing takes until no strength is left; None or 0
        where the strength stays; "rule": by `crushing_energy`.

    >>> joint = Joint(mode_i_fracture_energy="rule", mode_ii_fracture_energy="rule")
    >>> round(joint.mode_i_fracture_energy, 1), joint.softens, joint.is_beyond_apex
    (13.6, True, False)
    """

    normal_stiffness: float = quantity(
        "Pa/m",
        1.0,
        1e20,
        (1e8, 1e13),
        "dry joints of tests have some 1e9; a glued joint of 1 mm and 5e9 Pa has 5e12",
        default=12e11,
    )
    shear_stiffness: float = quantity(
        "Pa/m", 1.0, 1e20, (3e7, 1e13), "0.4 of the normal stiffness", default=4e11
    )
    friction_angle: float = quantity(
        "rad",
        0.0,
        math.inf,
        (0.05, 1.2),
        "friction coefficients of 0.05 and 2.6; EN 1996-1-1, 3.6.2, has 0.4",
        zero=True,
        default=math.radians(32.0),
    )
    tensile_strength: float = quantity(
        "Pa",
        0.0,
        1e20,
        (1e3, 1e7),
        "lime mortar; thin glued joints have some 1e6",
        zero=True,
        default=0.21e6,
    )
    cohesion: float = quantity(
        "Pa", 0.0, 1e20, (1e3, 1e7), "EN 1996-1-1, 3.6.2, has 1e5 to 4e5", zero=True, default=0.24e6
    )
    mode_i_fracture_energy: float | str | None = _energy(
        (0.5, 1e4), "clay brickwork has 5.6 to 19 (Korswagen, 2022)"
    )
    mode_ii_fracture_energy: float | str | None = _energy(
        (1, 1e5), "clay brickwork has 102 to 353 (Korswagen, 2022)"
    )
    compressive_strength: float | None = quantity(
        "Pa", 0.0, 1e20, (1e5, 1e9), "adobe; the strongest bricks have some 1e8", default=None
    )
    compressive_fracture_energy: float | str | None = _energy(
        (100, 1e6), "masonry has 0.33 to 1.6 mm times its strength (Lourenço, 2009)"
    )

    def __post_init__(self):
        check_fields(self)
        if self.compressive_strength == 0:
            raise InputError(
                "Joint.compressive_strength = 0 Pa: expected above zero, or None for joints that do"
                " not crush; correct it"
            )
        for name, energy in _energies_by_rule(self).items():
            vars(self)[name] = energy
        if self.compressive_fracture_energy and self.compressive_strength is None:
            raise InputError(
                f"Joint.compressive_fracture_energy = {self.compressive_fracture_energy:g} J/m2 of"
                " joints that do not crush: expected a compressive strength beside it; give"
                " Joint(compressive_strength=...), or leave it out"
            )
        if self.friction_angle >= math.pi / 2:
            raise InputError(
                f"Joint.friction_angle = {self.friction_angle:g} rad: expected less than "
                "pi/2; give radians, for example math.radians(32)"
            )
        _check_fracture_energies(self)

    @property
    def softens(self) -> bool:
        """Whether its bond has fracture energies."""
        return bool(self.mode_i_fracture_energy)

    @property
    def is_beyond_apex(self) -> bool:
        """Whether the tensile strength lies beyond cohesion / tan(friction angle), the tension at
        which no shear strength is left: bonds fail there, in shear."""
        return self.tensile_strength * tan(self.friction_angle) > self.cohesion


ENERGIES = "mode_i_fracture_energy", "mode_ii_fracture_energy", "compressive_fracture_energy"


def _energies_by_rule(joint):
    """{name: J/m2} of the fracture energies that a Joint is given as RULE; InputError where it
    lacks the strength."""
    asked = [name for name in ENERGIES if getattr(joint, name) == RULE]
    for name in asked:
        strength = "tensile_strength" if name in ENERGIES[:2] else "compressive_strength"
        if not getattr(joint, strength):
            raise InputError(
                f"Joint.{name} = {RULE!r} with {strength} = {getattr(joint, strength)}: expected a"
                " strength above zero, of which the rule makes the energy; give"
                f" Joint({strength}=...) [Pa]"
            )
    made = softening_energies(joint.tensile_strength)
    made[ENERGIES[2]] = crushing_energy(joint.compressive_strength or 0.0)
    return {name: made[name] for name in asked}


def _check_fracture_energies(joint):
    """Refuse one fracture energy without the other, and strengths that a softening bond cannot
    have."""
    given = [getattr(joint, name) or 0.0 for name in ENERGIES[:2]]
    if (given[0] > 0) != (given[1] > 0):
        raise InputError(
            f"Joint with fracture energies {given[0]:g} and {given[1]:g} J/m2 in modes I and II:"
            " expected both above zero, or neither for a brittle bond; give the other, about ten"
            " times in mode II"
        )
    bonded = joint.tensile_strength > 0 and joint.cohesion > 0
    if given[0] > 0 and (joint.is_beyond_apex or not bonded):
        raise InputError(
            f"Joint with fracture energies, tensile strength {joint.tensile_strength:g} and"
            f" cohesion {joint.cohesion:g} Pa: expected both above zero, and no tension beyond"
            " cohesion / tan(friction angle), where shear strength ends; give other strengths, or"
            " no energies"
        )


def softening_energies(tensile_strength: float) -> dict[str, float]:
    """{name: J/m2} of a Joint's fracture energies by a rule in use, from its tensile strength [Pa]
    alone:
    G_I = 0.025 (2 f_t)^0.7 N/mm with f_t in MPa, G_II = 10 G_I.  Its power of 0.7 is that of G_F =
    G_F0 (f_cm/10)^0.7, CEB-FIP Model Code 1990 for concrete; who first used it for joints is not
    known here.

    >>> {name: round(value, 1) for name, value in softening_energies(0.18375e6).items()}
    {'mode_i_fracture_energy': 12.4, 'mode_ii_fracture_energy': 124.1}
    """
    energy = 25.0 * float(power(2e-6 * tensile_strength, 0.7))
    return {"mode_i_fracture_energy": energy, "mode_ii_fracture_energy": 10 * energy}


def crushing_energy(compressive_strength: float) -> float:
    """Compressive fracture energy [J/m2] of a Joint from the compressive strength f_c of the
    masonry [Pa] alone.

    G_c = 15 + 0.43 f_c - 0.0036 f_c^2 N/mm with f_c in MPa from 12 to 80; below, G_c / f_c = 1.6
    mm, above 0.33 mm: the ductility index that P. B. Lourenço recommends (Recent advances in
    masonry structures, 2009; M. Angelillo, P. B. Lourenço, G. Milani, Masonry behaviour and
    modelling, CISM 551, 2014), after Model Code 1990 for concrete.

    >>> crushing_energy(11.22e6), round(crushing_energy(20e6))
    (17952.0, 22160)
    """
    strength = compressive_strength / 1e6
    if strength < 12:
        return 1.6 * 1e3 * strength
    return 1e3 * (
        0.33 * strength if strength > 80 else 15 + 0.43 * strength - 0.0036 * strength * strength
    )


def splitting_energy(tensile_strength: float) -> float:
    """Fracture energy [J/m2] of a Brick from its tensile strength [Pa] alone: 0.029 mm times that,
    assumed (docs/model/model.md#splitting).

    >>> splitting_energy(1e6)
    29.0
    """
    return 0.029e-3 * tensile_strength


def brick_of_masonry(
    young_modulus: float, joint: Joint, *, shear_ratio: float = 0.4, **sizes: float
) -> Brick:
    """A Brick so stiff that, with its bed joints, the masonry has this modulus across them [Pa].

    1/E = 1/E_brick + 1/(k_n h), and with G = shear_ratio E (EN 1996-1-1, 3.7.3: 0.4) and k_s in
    shear; sizes: the brick's other parameters.

    >>> round(brick_of_masonry(4e9, Joint()).young_modulus / 1e9, 2)
    4.19
    """
    brick = Brick(**sizes)
    check_range("young_modulus of masonry [Pa]", young_modulus, 1.0, 1e20)
    moduli = [
        1 / (1 / modulus - 1 / (stiffness * brick.height))
        for modulus, stiffness in (
            (young_modulus, joint.normal_stiffness),
            (shear_ratio * young_modulus, joint.shear_stiffness),
        )
    ]
    if min(moduli) <= 0:
        most = brick.height * min(joint.normal_stiffness, joint.shear_stiffness / shear_ratio)
        raise InputError(
            f"masonry of {young_modulus:g} Pa: its bed joints alone are softer; expected less than "
            f"{most:.3g} Pa; give stiffer joints"
        )
    return replace(brick, young_modulus=moduli[0], shear_modulus=moduli[1])


@dataclass(frozen=True)
class Opening:
    """A rectangular opening: left edge and sill [m] from the wall's lower left corner, width and
    height [m].  Height and level are laid to whole courses (`Wall.opening_courses`); in length its
    edges stay as given.  lintel: a damage.wall.lintels.Lintel or its kind, None for that of the
    wall.
    """

    left: float = quantity("m", 0.0, LONGEST_M)
    width: float = quantity("m", 1e-3, LONGEST_M, (0.03, 50), "a vent; the gate of a hall")
    height: float = quantity("m", 1e-3, LONGEST_M, (0.03, 50), "a vent; the gate of a hall")
    sill: float = quantity("m", 0.0, LONGEST_M, default=0.0)
    lintel: Lintel | None = None

    def __post_init__(self):
        if self.lintel is not None:
            vars(self)["lintel"] = lintel_of(self.lintel)
        check_fields(self)

    @property
    def right(self) -> float:
        return self.left + self.width


@dataclass(frozen=True)
class Wall:
    """A wall in running bond, its openings, what it is built of and what it carries.

    name: short, used in file names.
    length, height [m]: the height is built in whole courses (the nearest number of them).
    precompression [Pa]: vertical stress at the top, carried as mass and its weight; over the whole
        length, or in the piers alone, as `ModelOptions.load` says.
    base_course: the base course starts on the left with a "whole" or a "half" brick.
    outline: points (x, z) [m] of its top edge from (0, z) to (length, z), its highest at the
        height; none for a rectangular wall.  `damage.wall.plan` says how bricks follow it.
    floors: of `damage.wall.floors.Floor`.
    lintel: of openings that have none of their own, a `damage.wall.lintels.Lintel` or its kind;
        "courses" in the paper's walls, where `ModelOptions.lintel` says which joints stay elastic.
    restraints: of `damage.wall.restraints.Restraint`: floors that hold the top, party walls.

    A strip of a wall in one-way bending between floors, out of its plane, is a plane problem, too:
    a column of courses whose `length` is the wall's thickness, `brick.length` twice that and
    `brick.thickness` the width of the strip, under a restraint of its top
    (docs/guides/own-wall.md).

    >>> door = Opening(left=0.6, width=0.8, height=1.0, lintel="timber")
    >>> wall = Wall("shed", length=2.0, height=1.52, openings=[door], precompression=0.1e6)
    >>> wall.courses, round(wall.built_height, 3), wall.opening_courses(door)  # courses, [m]
    (20, 1.5, (0, 13))
    >>> round(wall.top_mass), wall.lintel_of(door).kind  # [kg]
    (2090, 'timber')
    """

    KIND: ClassVar = "wall"
    lone_walls: ClassVar = ()

    name: str
    length: float = quantity(
        "m", 1e-3, LONGEST_M, (0.1, 200), "a pier of half a brick; a terrace of houses"
    )
    height: float = quantity("m", 1e-3, LONGEST_M, (0.03, 50), "one course; a tower")
    openings: tuple[Opening, ...] = ()
    precompression: float = quantity(
        "Pa",
        0.0,
        1e9,
        (1e3, 2e7),
        "a light roof; the strength of strong masonry",
        zero=True,
        default=0.3e6,
    )
    base_course: str = choice(("whole", "half"), default="whole")
    brick: Brick = field(default_factory=Brick)
    joint: Joint = field(default_factory=Joint)
    outline: tuple[tuple[float, float], ...] = ()
    floors: tuple[Floor, ...] = ()
    lintel: Lintel = field(default_factory=Lintel)
    restraints: tuple[Restraint, ...] = ()

    @property
    def masonry(self) -> "Wall":
        """The wall itself, as of a `damage.house.house.House` the wall of what all its walls
        share."""
        return self

    @property
    def records(self) -> tuple:
        """The wall and the records in it."""
        lintels = [opening.lintel for opening in self.openings if opening.lintel]
        inside = *self.openings, *self.floors, self.brick, self.joint, self.lintel
        return self, *inside, *lintels

    @property
    def line_loads(self) -> list[float]:
        """Mass of each floor over its length, a list [kg/m]."""
        spans = [(floor.mass, *floor.span(self)) for floor in self.floors]
        return [mass / (right - left) for mass, left, right in spans if mass]

    @property
    def each_wall(self) -> "tuple[Wall, ...]":
        """The wall alone, as of a House its walls."""
        return (self,)

    def with_each(self, change: Callable) -> "Wall":
        """What a function makes of the wall, as of a House that with each wall changed."""
        return change(self)

    def check_run(self, settings, solver: str) -> None:
        """Nothing, as of a House what its runs cannot do."""

    def __post_init__(self):
        vars(self)["lintel"] = lintel_of(self.lintel)
        named = isinstance(self.name, str) and 0 < len(self.name) <= LONGEST_NAME
        if not named or not all(c.isalnum() or c in "-_" for c in self.name):
            raise InputError(
                f"Wall.name = {self.name!r}: expected up to {LONGEST_NAME} letters, digits, '-' or"
                " '_', since it names files; rename the wall"
            )
        for name, kind in LISTS.items():
            vars(self)[name] = _records(f"Wall.{name}", getattr(self, name), kind)
        vars(self)["outline"] = _points("Wall.outline", self.outline)
        check_fields(self)
        vars(self)["floors"] = tuple(floor.on(self) for floor in self.floors)
        if self.courses < 1 or self.length < self.brick.length / 2:
            raise InputError(
                f"wall {self.name}: {self.length:g} x {self.height:g} m is smaller than "
                "half a brick by one course; make it larger"
            )
        _check_count(self)
        if self.outline:
            check_outline(self)
        _check_openings(self)
        check_floors(self)
        check_restraints(self)
        check_bearing(plan_of(self))

    @property
    def courses(self) -> int:
        """Number of courses."""
        return round(self.height / self.brick.height)

    @property
    def built_height(self) -> float:
        """Height of the whole courses [m]."""
        return self.courses * self.brick.height

    @property
    def top_mass(self) -> float:
        """Mass of the precompression over the whole length [kg]: sigma * length * thickness / g."""
        return self.precompression * self.length * self.brick.thickness / GRAVITY

    def opening_courses(self, opening: Opening) -> tuple[int, int]:
        """First course of an opening and the first above it.

        Its height is laid to the nearest number of courses, and these to the level at which its
        middle is nearest to where it is given, halves up: both edges by themselves would make three
        courses two or four.  It stays below the wall's top where it is given so.

        >>> wall = Wall("door", 2.0, 1.5, openings=(Opening(0.6, 0.8, 1.0),))
        >>> wall.opening_courses(wall.openings[0])
        (0, 13)
        """
        course = self.brick.height
        top = opening.sill + opening.height
        count = nearest(opening.height / course)
        first = nearest((opening.sill + top) / (2 * course) - count / 2)
        if round(top / course) <= self.courses:
            first = max(min(first, self.courses - count), 0)
        return first, first + count

    def lintel_of(self, opening: Opening) -> Lintel:
        """The Lintel of one of its openings."""
        return opening.lintel or self.lintel

    def with_lintels(self, option: str) -> "Wall":
        """The wall that `ModelOptions.lintel` makes of it: its own lintels where that is "elastic",
        else those of a kind over all openings, or courses.

        >>> Wall("pier", 0.9, 1.5).with_lintels("none").lintel.kind
        'courses'
        """
        if option == "elastic":
            return self
        return replace(
            self,
            lintel=Lintel(option if option in KINDS_OF_LINTELS else "courses"),
            openings=tuple(replace(opening, lintel=None) for opening in self.openings),
        )

    def as_dict(self) -> dict:
        """All parameters as a plain dictionary, for files and tables; without outline, floors,
        restraints and lintels of its own where it has none.

        >>> Wall("pier", 0.9, 1.5).as_dict()["length"]
        0.9
        """
        optional = "outline", "floors", "restraints"
        table = {
            name: value for name, value in asdict(self).items() if value or name not in optional
        }
        for floor in table.get("floors", ()):
            for name in ("mass_per_area", "tributary_width"):  # older versions do not know them
                if floor[name] is None:
                    del floor[name]
        if table.pop("lintel") and self.openings and self.lintel.is_body:
            table["lintel"] = self.lintel.as_dict()
        for part, opening in zip(table["openings"], self.openings):
            del part["lintel"]
            if opening.lintel is not None:
                part["lintel"] = opening.lintel.as_dict()
        return table

    @classmethod
    def from_dict(cls, table: dict) -> "Wall":
        """The wall of which `as_dict` made the table; one with openings and without a lintel has
        "courses".

        >>> Wall.from_dict(Wall("pier", 0.9, 1.5).as_dict()) == Wall("pier", 0.9, 1.5)
        True
        """
        brick = dict(table.get("brick", {}))
        if brick.pop("cohesion", None) is not None:  # None in all walls of older versions
            raise InputError(f"Brick with cohesion: {NO_COHESION}")
        parts = {"brick": record_from(Brick, brick)}
        parts["joint"] = record_from(Joint, table.get("joint", {}))
        parts["lintel"] = table.get("lintel", "courses" if table.get("openings") else "concrete")
        for name, kind in LISTS.items():
            parts[name] = [record_from(kind, entry) for entry in table.get(name, ())]
        return record_from(cls, table | parts)


LISTS = {"openings": Opening, "floors": Floor, "restraints": Restraint}
"""{field of Wall that is a list: kind of its records}."""


def _records(what, given, kind):
    """A tuple of records; InputError for anything else."""
    records = tuple(given) if isinstance(given, (list, tuple)) else (given,)
    for record in records:
        if not isinstance(record, kind):
            raise InputError(
                f"{what} has {record!r}: expected {kind.__name__}(...) records in a list; correct"
                " it"
            )
    return records


def _points(what, given):
    """Points (x, z) as a tuple of pairs of numbers; InputError for anything else."""
    try:
        points = tuple((x, z) for x, z in given)
    except (TypeError, ValueError):
        raise InputError(
            f"{what} = {given!r}: expected points (x, z) in a list; correct it"
        ) from None
    for value in (number for point in points for number in point):
        check_range(what, value, -LONGEST_M, LONGEST_M)
    return tuple((float(x), float(z)) for x, z in points)


def _check_count(wall):
    """Refuse more bricks, openings, floors or points of the outline than can be computed; in
    another unit a wall may have too many bricks."""
    bricks = wall.courses * math.ceil(wall.length / wall.brick.length)
    if bricks > MOST_BRICKS:
        meant = implausible_fields(wall, wall.brick, unit="m")
        raise InputError(
            f"wall {wall.name}: {'; '.join(meant)}. Correct the unit: {bricks} bricks are more than"
            f" {MOST_BRICKS}"
            if meant
            else (
                f"wall {wall.name} has about {bricks} bricks: expected up to {MOST_BRICKS}; make it"
                " smaller, or of larger bricks"
            )
        )
    for name in ("openings", "floors", "outline"):
        if len(getattr(wall, name)) > MOST_PARTS:
            raise InputError(
                f"wall {wall.name}: {len(getattr(wall, name))} {name}: expected up to {MOST_PARTS};"
                " leave some out"
            )


def _check_openings(wall):
    """Refuse openings outside the wall, overlapping, or leaving too little beside or above them."""
    for number, opening in enumerate(wall.openings, start=1):
        what = (
            f"wall {wall.name}, opening {number} (x {opening.left:g} to {opening.right:g} m, "
            f"z {opening.sill:g} to {opening.sill + opening.height:g} m)"
        )
        _check_opening_inside(wall, opening, what)
        for other in wall.openings[: number - 1]:
            _check_opening_apart(wall, opening, other, what)


def _check_opening_inside(wall, opening, what):
    first, above = wall.opening_courses(opening)
    if opening.right > wall.length + 1e-9 or above > wall.courses:
        raise InputError(
            f"{what} reaches outside the wall: expected a place within {wall.length:g} x "
            f"{wall.built_height:g} m; move it or make it smaller"
        )
    if above - first < 1:
        raise InputError(
            f"{what} is less than one course of {wall.brick.height:g} m high; make it higher"
        )
    if above == wall.courses and first == 0:
        raise InputError(
            f"{what} reaches from the base to the top and cuts the wall in two: expected a course"
            " below or above it; give it a sill, or make two walls"
        )
    narrowest = min(opening.left, wall.length - opening.right)
    if narrowest < wall.brick.length / 2 - 1e-9:
        raise InputError(
            f"{what} cuts off a pier: {max(narrowest, 0.0):.4g} m are left beside it, at least half"
            f" a brick ({wall.brick.length / 2:g} m) is needed; move it or make it narrower"
        )


def _check_opening_apart(wall, opening, other, what):
    first, above = wall.opening_courses(opening)
    other_first, other_above = wall.opening_courses(other)
    gap = max(opening.left - other.right, other.left - opening.right)
    shared_courses = min(above, other_above) - max(first, other_first)
    if shared_courses >= 0 and gap < wall.brick.length / 2 - 1e-9:
        raise InputError(
            f"{what} leaves {gap:.4g} m to another opening beside it: at least half a brick "
            f"({wall.brick.length / 2:g} m) or one course must stay between; move one of them"
        )
