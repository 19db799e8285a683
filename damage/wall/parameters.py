"""Frozen records that describe a wall and its material; each is checked once, when it is made.

All values are SI (m, kg, s, Pa, Pa/m) and radians.  Defaults are those of Sarhosis et al. (2021),
Engineering Structures 243, 112529, doi:10.1016/j.engstruct.2021.112529, Tables 1 and 2, where the
paper gives a value; `docs/model/model.md` gives the source of every other one.
"""

import math
from dataclasses import asdict, dataclass, field, fields, replace

from damage.checks import check_choice, check_fields, check_not_negative, check_range, check_whole, record_from
from damage.errors import InputError
from damage.units import GRAVITY
from damage.wall.courses import check_bearing, check_outline
from damage.wall.floors import Floor, check_floors
from damage.wall.lintels import Lintel, lintel_of

LONGEST_M, LONGEST_NAME, MOST_BRICKS = 1000.0, 100, 20_000
"""What a wall may have: length and height [m], characters of its name, bricks; the shipped ones have up to 666."""
MOST_SEED = 2**32 - 1


@dataclass(frozen=True)
class Brick:
    """A masonry unit with its share of mortar (joints have no thickness).

    length, height, thickness [m]: along x, z and y.
    density [kg/m3]: not in the paper; 1900 is usual for calcium silicate and clay brickwork.
    young_modulus, shear_modulus [Pa]: Table 2.
    tensile_strength, cohesion [Pa]: at which whole bricks split in the middle, in bending and in shear
        (`damage.wall.split`); None, the first, for bricks that do not split, as in the paper; the second, for those
        that tension alone splits.
    """

    length: float = 0.225
    height: float = 0.075
    thickness: float = 0.1025
    density: float = 1900.0
    young_modulus: float = 5.2e9
    shear_modulus: float = 2.16e9
    tensile_strength: float | None = None
    cohesion: float | None = None

    @property
    def splits(self):
        """Whether whole bricks can split."""
        return self.tensile_strength is not None

    def __post_init__(self):
        check_fields(self, **dict.fromkeys(("length", "height", "thickness"), (1e-3, 100.0)), density=(1.0, 1e5),
                     **dict.fromkeys(("young_modulus", "shear_modulus"), (1.0, 1e20)),
                     **_given(self, "tensile_strength", "cohesion"))
        if self.cohesion is not None and not self.splits:
            raise InputError(f"Brick.cohesion = {self.cohesion:g} Pa of bricks that do not split: expected a tensile "
                             "strength beside it; give Brick(tensile_strength=...), or leave it out")


def _given(record, *names):
    """{name: (0, 1e20)} of strengths [Pa] that are given."""
    return dict.fromkeys((name for name in names if getattr(record, name) is not None), (0.0, 1e20))


@dataclass(frozen=True)
class Joint:
    """A zero-thickness mortar joint, Table 1; its law is `damage.wall.joint_law`.

    normal_stiffness, shear_stiffness [Pa/m]; tensile_strength, cohesion [Pa];
    friction_angle [rad], the same before and after the bond breaks; dilation is zero.
    mode_i_fracture_energy, mode_ii_fracture_energy [J/m2]: what opening and sliding take until the bond fails;
        None or 0, both of them, for a brittle bond as in the paper.  Clay brickwork: 5.6 to 19 and 102 to 353
        (Korswagen, dissertation, TU Delft, 2022); `softening_energies` gives a rule.
    compressive_strength [Pa]: at which the joint and its bricks crush; None for joints that do not, as in the paper.
    compressive_fracture_energy [J/m2]: what crushing takes until no strength is left; None or 0 where the strength
        stays; `crushing_energy` gives a rule.
    """

    normal_stiffness: float = 12e11
    shear_stiffness: float = 4e11
    friction_angle: float = math.radians(32.0)
    tensile_strength: float = 0.21e6
    cohesion: float = 0.24e6
    mode_i_fracture_energy: float | None = None
    mode_ii_fracture_energy: float | None = None
    compressive_strength: float | None = None
    compressive_fracture_energy: float | None = None

    def __post_init__(self):
        check_fields(self, **dict.fromkeys(("normal_stiffness", "shear_stiffness"), (1.0, 1e20)),
                     **dict.fromkeys(("tensile_strength", "cohesion"), (0.0, 1e20)),
                     **_given(self, "compressive_strength"))
        if self.compressive_strength == 0:
            raise InputError("Joint.compressive_strength = 0 Pa: expected above zero, or None for joints that do not "
                             "crush; correct it")
        if self.compressive_fracture_energy is not None:
            check_range("Joint.compressive_fracture_energy [J/m2]", self.compressive_fracture_energy, 0, 1e9)
        if self.compressive_fracture_energy and self.compressive_strength is None:
            raise InputError(f"Joint.compressive_fracture_energy = {self.compressive_fracture_energy:g} J/m2 of joints "
                             "that do not crush: expected a compressive strength beside it; give "
                             "Joint(compressive_strength=...), or leave it out")
        check_not_negative("Joint.friction_angle", self.friction_angle)
        if self.friction_angle >= math.pi / 2:
            raise InputError(f"Joint.friction_angle = {self.friction_angle:g} rad: expected less than "
                             "pi/2; give radians, for example math.radians(32)")
        _check_fracture_energies(self)

    @property
    def softens(self):
        """Whether its bond has fracture energies."""
        return bool(self.mode_i_fracture_energy)


def _check_fracture_energies(joint):
    """Refuse one fracture energy without the other, and strengths that a softening bond cannot have."""
    names = ("mode_i_fracture_energy", "mode_ii_fracture_energy")
    given = [getattr(joint, name) or 0.0 for name in names]
    for name, value in zip(names, given):
        check_range(f"Joint.{name} [J/m2]", value, 0, 1e9)
    if (given[0] > 0) != (given[1] > 0):
        raise InputError(f"Joint with fracture energies {given[0]:g} and {given[1]:g} J/m2 in modes I and II: expected "
                         "both above zero, or neither for a brittle bond; give the other, about ten times in mode II")
    apex = joint.tensile_strength * math.tan(joint.friction_angle)
    if given[0] > 0 and not (joint.tensile_strength > 0 and 0 < joint.cohesion >= apex):
        raise InputError(f"Joint with fracture energies, tensile strength {joint.tensile_strength:g} and cohesion "
                         f"{joint.cohesion:g} Pa: expected both above zero, and no tension beyond cohesion / "
                         "tan(friction angle), where shear strength ends; give other strengths, or no energies")


def softening_energies(tensile_strength):
    """{name: J/m2} of a Joint's fracture energies by a rule in use, from its tensile strength [Pa] alone:
    G_I = 0.025 (2 f_t)^0.7 N/mm with f_t in MPa, G_II = 10 G_I.  Its power of 0.7 is that of G_F = G_F0 (f_cm/10)^0.7,
    CEB-FIP Model Code 1990 for concrete; who first used it for joints is not known here.

    >>> {name: round(value, 1) for name, value in softening_energies(0.18375e6).items()}
    {'mode_i_fracture_energy': 12.4, 'mode_ii_fracture_energy': 124.1}
    """
    energy = 25.0 * (2e-6 * tensile_strength) ** 0.7
    return {"mode_i_fracture_energy": energy, "mode_ii_fracture_energy": 10 * energy}


def crushing_energy(compressive_strength):
    """Compressive fracture energy [J/m2] of a Joint from the compressive strength f_c of the masonry [Pa] alone.

    G_c = 15 + 0.43 f_c - 0.0036 f_c^2 N/mm with f_c in MPa from 12 to 80; below, G_c / f_c = 1.6 mm, above 0.33 mm: the
    ductility index that P. B. Lourenço recommends (Recent advances in masonry structures, 2009; M. Angelillo,
    P. B. Lourenço, G. Milani, Masonry behaviour and modelling, CISM 551, 2014), after Model Code 1990 for concrete.

    >>> crushing_energy(11.22e6), round(crushing_energy(20e6))
    (17952.0, 22160)
    """
    strength = compressive_strength / 1e6
    if strength < 12:
        return 1.6 * 1e3 * strength
    return 1e3 * (0.33 * strength if strength > 80 else 15 + 0.43 * strength - 0.0036 * strength**2)


def brick_of_masonry(young_modulus, joint, *, shear_ratio=0.4, **sizes):
    """A Brick so stiff that, with its bed joints, the masonry has this modulus across them [Pa].

    1/E = 1/E_brick + 1/(k_n h), and with G = shear_ratio E (EN 1996-1-1, 3.7.3: 0.4) and k_s in shear; sizes:
    the brick's other parameters.
    """
    brick = Brick(**sizes)
    moduli = [1 / (1 / modulus - 1 / (stiffness * brick.height)) for modulus, stiffness in
              ((young_modulus, joint.normal_stiffness), (shear_ratio * young_modulus, joint.shear_stiffness))]
    if min(moduli) <= 0:
        raise InputError(f"masonry of {young_modulus:g} Pa: its bed joints alone are softer; give stiffer joints")
    return replace(brick, young_modulus=moduli[0], shear_modulus=moduli[1])


@dataclass(frozen=True)
class Opening:
    """A rectangular opening: left edge and sill [m] from the wall's lower left corner, width and
    height [m].  Its edges are laid to whole courses in height; in length they stay as given.  lintel: a
    damage.wall.lintels.Lintel or its kind, None for that of the wall."""

    left: float
    width: float
    height: float
    sill: float = 0.0
    lintel: Lintel | None = None

    def __post_init__(self):
        if self.lintel is not None:
            object.__setattr__(self, "lintel", lintel_of(self.lintel))
        check_fields(self, **dict.fromkeys(("width", "height"), (1e-3, LONGEST_M)),
                     **dict.fromkeys(("left", "sill"), (0.0, LONGEST_M)))

    @property
    def right(self):
        return self.left + self.width


@dataclass(frozen=True)
class Wall:
    """A wall in running bond, its openings, what it is built of and what it carries.

    name: short, used in file names.
    length, height [m]: the height is built in whole courses (the nearest number of them).
    precompression [Pa]: vertical stress at the top, carried as mass and its weight; over the whole length, or in the
        piers alone, as `ModelOptions.load` says.
    base_course: the base course starts on the left with a "whole" or a "half" brick.
    outline: points (x, z) [m] of its top edge from (0, z) to (length, z), its highest at the height; none for a
        rectangular wall.  `damage.wall.courses` says how bricks follow it.
    floors: of `damage.wall.floors.Floor`.
    lintel: of openings that have none of their own, a `damage.wall.lintels.Lintel` or its kind; "courses" in the
        paper's walls, where `ModelOptions.lintel` says which joints stay elastic.
    """

    name: str
    length: float
    height: float
    openings: tuple[Opening, ...] = ()
    precompression: float = 0.3e6
    base_course: str = "whole"
    brick: Brick = field(default_factory=Brick)
    joint: Joint = field(default_factory=Joint)
    outline: tuple[tuple[float, float], ...] = ()
    floors: tuple[Floor, ...] = ()
    lintel: Lintel = field(default_factory=Lintel)

    def __post_init__(self):
        object.__setattr__(self, "lintel", lintel_of(self.lintel))
        named = isinstance(self.name, str) and 0 < len(self.name) <= LONGEST_NAME
        if not named or not all(c.isalnum() or c in "-_" for c in self.name):
            raise InputError(f"Wall.name = {self.name!r}: expected up to {LONGEST_NAME} letters, digits, '-' or '_', "
                             "since it names files; rename the wall")
        for name, kind in (("openings", Opening), ("floors", Floor)):
            object.__setattr__(self, name, _records(f"Wall.{name}", getattr(self, name), kind))
        object.__setattr__(self, "outline", _points("Wall.outline", self.outline))
        check_fields(self, **dict.fromkeys(("length", "height"), (1e-3, LONGEST_M)), precompression=(0.0, 1e9))
        check_choice("Wall.base_course", self.base_course, ("whole", "half"))
        if self.courses < 1 or self.length < self.brick.length / 2:
            raise InputError(f"wall {self.name}: {self.length:g} x {self.height:g} m is smaller than "
                             "half a brick by one course; make it larger")
        bricks = self.courses * math.ceil(self.length / self.brick.length)
        if bricks > MOST_BRICKS:
            raise InputError(f"wall {self.name} has about {bricks} bricks: expected up to {MOST_BRICKS}; make it "
                             "smaller, or of larger bricks")
        if self.outline:
            check_outline(self)
        _check_openings(self)
        check_floors(self)
        check_bearing(self)

    @property
    def courses(self):
        """Number of courses."""
        return round(self.height / self.brick.height)

    @property
    def built_height(self):
        """Height of the whole courses [m]."""
        return self.courses * self.brick.height

    @property
    def top_mass(self):
        """Mass of the precompression over the whole length [kg]: sigma * length * thickness / g."""
        return self.precompression * self.length * self.brick.thickness / GRAVITY

    def opening_courses(self, opening):
        """First course of an opening and the first above it."""
        height = self.brick.height
        return round(opening.sill / height), round((opening.sill + opening.height) / height)

    def lintel_of(self, opening):
        """The Lintel of one of its openings."""
        return opening.lintel or self.lintel

    def with_lintels(self, option):
        """The wall that `ModelOptions.lintel` makes of it: its own lintels where that is "elastic", else courses."""
        if option == "elastic":
            return self
        return replace(self, lintel="courses", openings=tuple(replace(one, lintel=None) for one in self.openings))

    def as_dict(self):
        """All parameters as a plain dictionary, for files and tables; without outline, floors and lintels of its own
        where it has none."""
        table = {name: value for name, value in asdict(self).items() if value or name not in ("outline", "floors")}
        for part, of in ((table, self), *zip(table["openings"], self.openings)):
            lintel = part.pop("lintel")
            if lintel is not None and (of is not self or (self.openings and self.lintel.is_body)):
                part["lintel"] = of.lintel.as_dict()
        return table

    @classmethod
    def from_dict(cls, table):
        """The wall of which `as_dict` made the table; one with openings and without a lintel has "courses"."""
        parts = {name: record_from(kind, table.get(name, {})) for name, kind in (("brick", Brick), ("joint", Joint))}
        parts["lintel"] = table.get("lintel", "courses" if table.get("openings") else "concrete")
        openings = tuple(record_from(Opening, one) for one in table.get("openings", ()))
        floors = tuple(record_from(Floor, one) for one in table.get("floors", ()))
        return record_from(cls, table | parts | {"openings": openings, "floors": floors})


def _records(what, given, kind):
    """A tuple of records; InputError for anything else."""
    found = tuple(given) if isinstance(given, (list, tuple)) else (given,)
    for one in found:
        if not isinstance(one, kind):
            raise InputError(f"{what} has {one!r}: expected {kind.__name__}(...) records in a list; correct it")
    return found


def _points(what, given):
    """Points (x, z) as a tuple of pairs of numbers; InputError for anything else."""
    try:
        found = tuple((x, z) for x, z in given)
    except (TypeError, ValueError):
        raise InputError(f"{what} = {given!r}: expected points (x, z) in a list; correct it") from None
    for value in (number for point in found for number in point):
        check_range(what, value, -LONGEST_M, LONGEST_M)
    return found


def _check_openings(wall):
    """Refuse openings outside the wall, overlapping, or leaving too little beside or above them."""
    for number, opening in enumerate(wall.openings, start=1):
        what = (f"wall {wall.name}, opening {number} (x {opening.left:g} to {opening.right:g} m, "
                f"z {opening.sill:g} to {opening.sill + opening.height:g} m)")
        _check_opening_inside(wall, opening, what)
        for other in wall.openings[:number - 1]:
            _check_opening_apart(wall, opening, other, what)


def _check_opening_inside(wall, opening, what):
    first, above = wall.opening_courses(opening)
    if opening.right > wall.length + 1e-9 or above > wall.courses:
        raise InputError(f"{what} reaches outside the wall: expected a place within {wall.length:g} x "
                         f"{wall.built_height:g} m; move it or make it smaller")
    if above - first < 1:
        raise InputError(f"{what} is less than one course of {wall.brick.height:g} m high; make it higher")
    if above == wall.courses and first == 0:
        raise InputError(f"{what} reaches from the base to the top and cuts the wall in two: expected a course below "
                         "or above it; give it a sill, or make two walls")
    narrowest = min(opening.left, wall.length - opening.right)
    if narrowest < wall.brick.length / 2 - 1e-9:
        raise InputError(f"{what} cuts off a pier: {max(narrowest, 0.0):.4g} m are left beside it, at least half "
                         f"a brick ({wall.brick.length / 2:g} m) is needed; move it or make it narrower")


def _check_opening_apart(wall, opening, other, what):
    first, above = wall.opening_courses(opening)
    other_first, other_above = wall.opening_courses(other)
    gap = max(opening.left - other.right, other.left - opening.right)
    shared_courses = min(above, other_above) - max(first, other_first)
    if shared_courses >= 0 and gap < wall.brick.length / 2 - 1e-9:
        raise InputError(f"{what} leaves {gap:.4g} m to another opening beside it: at least half a brick "
                         f"({wall.brick.length / 2:g} m) or one course must stay between; move one of them")


SOILS = (1e5, 1e12)
"""Least and largest modulus of subgrade reaction [N/m3]."""
SOIL_VELOCITIES = (20, 2000)
"""Least and largest shear-wave velocity of a soil [m/s]."""


def _option(default, help_, **more):
    """A field of ModelOptions and all that the command line, file names and tables need of it.

    help_: for people; metavar: of a number; choices: of a word; tag: what a history's file is
    called where the option is not the default, a template of the options; seed: it only draws one of many alike.
    """
    return field(default=default, metadata={"help": help_, "metavar": None, "choices": None, "tag": None,
                                            "seed": False, **more})


_OF_MODES = ("brick_order", "plane", "brick_mass", "brick_damping")


@dataclass(frozen=True)
class ModelOptions:
    """Modelling choices that the paper leaves open, the same in every solver.

    lintel: "elastic" leaves every opening its own lintel (`damage.wall.lintels`); where it has none, the joints of all
        courses over it stay elastic.  In place of all lintels, "none" lets these joints break, and a number keeps those
        of so many of the lowest courses elastic (as a word: 2 becomes "2", 0 becomes "none").
    top: the precompression's mass sits on "piers" (one rigid cap each), is spread "uniform" over
        the top course, or is one rigid "beam".
    load: that mass is the precompression over the wall's whole "length", so that the piers beside openings have more,
        or over its "piers" alone, which then have just that stress.
    cells: contact points per half brick of a bed joint.
    contacts: where the points of a bed joint lie: "interior" of the cells, at the "corners" (ends) of each overlap, or
        at the "gauss" points of two cells together; head joints have one at mid-height, one at each end, or two Gauss
        points.
    strength_cov, strength_seed: coefficient of variation of the joints' strengths, and what seeds them:
        each joint between two bricks has one lognormal factor of mean 1 on tensile strength and cohesion.
    supports: "one" below the whole wall, or one below each brick of the base ("bricks"), whose forces the history has.
    soil: "rigid", or springs below the base (`damage.wall.soil`) of so many N/m3 vertically, as a word; soil_shear:
        horizontal over vertical stiffness; footing: width over which they act [m]; soil_velocity: shear-wave velocity
        [m/s] of a soil with radiation damping, 0 without.
    fibres: bonds with fracture energies are so many brittle ones in parallel (`damage.wall.fibres`); 0: the smooth law,
        which YADE does not have: there 16.
    bricks: "rigid", their compliance lumped into the joints, or "deformable" (`damage.wall.strain`), with polynomials
        of brick_order 2 or 3 in plane "stress" or "strain", the mass of the strain modes times brick_mass, which
        lengthens the time step by its root, and brick_damping of their critical damping.
    brick_cells: a whole deformable brick is so many rigid cells, glued elastically (`damage.wall.split`); 0: strain
        modes, which YADE does not have: there 4.
    """

    lintel: str = _option("elastic", "over an opening: its own lintel, or else all joints elastic; instead, joints "
                          "able to fail like any other (none), or elastic in the N lowest courses",
                          metavar="elastic|none|N", tag="lintel-{lintel}")
    top: str = _option("piers", "distribution of the mass that gives the precompression",
                       choices=("piers", "uniform", "beam"), tag="top-{top}")
    load: str = _option("length", "where the precompression is the mean stress: over the whole length, or in the piers",
                        choices=("length", "piers"), tag="load-{load}")
    cells: int = _option(2, "contact points per half brick", metavar="N")
    contacts: str = _option("interior", "position of the contact points in a joint",
                            choices=("interior", "corners", "gauss"), tag="{contacts}")
    strength_cov: float = _option(0.0, "lognormal scatter of the joints' strengths: coefficient of variation",
                                  metavar="COV", tag="strength-{strength_cov:g}-{strength_seed}")
    strength_seed: int = _option(0, "seed of the joints' strengths", metavar="N", seed=True)
    supports: str = _option("one", "one support below the wall, or one below each brick of the base, with reactions of "
                            "its own in the history", choices=("one", "bricks"), tag="supports-{supports}")
    soil: str = _option("rigid", "soil below the base: rigid, or its vertical modulus of subgrade reaction, springs "
                        "without tension", metavar="rigid|N_M3", tag="soil-{soil}")
    soil_shear: float = _option(0.5, "soil: horizontal stiffness over the vertical one", metavar="SHARE",
                                tag="soil-shear-{soil_shear:g}")
    footing: float = _option(0.45, "soil: width of the footing [m]", metavar="M", tag="footing-{footing:g}")
    soil_velocity: float = _option(0.0, "soil: shear-wave velocity, for radiation damping (reference solver); 0: "
                                   "none", metavar="M_S", tag="soil-velocity-{soil_velocity:g}")
    fibres: int = _option(0, "number of parallel brittle elements of a softening joint; 0: one smooth law, in YADE 16 "
                          "elements",
                          metavar="N", tag="fibres-{fibres}")
    bricks: str = _option("rigid", "rigid bricks, whose compliance is lumped into the joints, or deformable ones "
                          "(strain modes, in YADE glued cells)", choices=("rigid", "deformable"), tag="{bricks}")
    brick_cells: int = _option(0, "deformable bricks: number of rigid cells of a whole brick, glued elastically, 2 to "
                               "16; 0: strain modes, in YADE 4 cells", metavar="N", tag="brick-cells-{brick_cells}")
    brick_order: int = _option(2, "deformable bricks: order of their displacements, 2 (linear strain) or 3",
                               metavar="2|3", tag="order-{brick_order}")
    plane: str = _option("stress", "deformable bricks: plane stress, or plane strain", choices=("stress", "strain"),
                         tag="plane-{plane}")
    brick_mass: float = _option(9.0, "deformable bricks: factor on the mass of their strain modes, 1 to 25; the time "
                                "step grows with its root", metavar="FACTOR", tag="brick-mass-{brick_mass:g}")
    brick_damping: float = _option(0.05, "deformable bricks: damping of their strain modes over the critical one, 0 "
                                   "to 1", metavar="RATIO", tag="brick-damping-{brick_damping:g}")

    def __post_init__(self):
        for one in fields(self):
            if one.metadata["choices"]:
                check_choice(one.name, getattr(self, one.name), one.metadata["choices"])
        object.__setattr__(self, "lintel", _lintel_word(self.lintel))
        check_whole("cells", self.cells, 1, 16)
        if self.contacts == "gauss" and self.cells % 2:
            raise InputError(f"--contacts gauss with --cells {self.cells}: expected an even number, since Gauss points "
                             "come in pairs; give --cells 2")
        check_range("strength_cov", self.strength_cov, 0, 2)
        check_whole("strength_seed", self.strength_seed, 0, MOST_SEED)
        object.__setattr__(self, "soil", _soil_word(self.soil))
        check_range("--soil-shear", self.soil_shear, 0.01, 10)
        check_range("--footing [m]", self.footing, 0.01, 10)
        if self.soil_velocity:
            check_range("--soil-velocity [m/s]", self.soil_velocity, *SOIL_VELOCITIES)
        for name in ("soil_shear", "footing", "soil_velocity"):
            usual = type(self).__dataclass_fields__[name].default
            if self.soil == "rigid" and getattr(self, name) != usual:
                raise InputError(f"--{name.replace('_', '-')} {getattr(self, name):g} without --soil: expected the "
                                 "soil's stiffness [N/m3], too; give both, or leave it out")
        check_whole("fibres", self.fibres, 0, 64)
        check_whole("brick_cells", self.brick_cells, 0, 16)
        if self.brick_cells % 2:
            raise InputError(f"--brick-cells {self.brick_cells}: expected an even number, since bricks lie on two "
                             "halves of others; give --brick-cells 4")
        check_whole("brick_order", self.brick_order, 2, 3)
        check_range("brick_mass", self.brick_mass, 1, 25)
        check_range("brick_damping", self.brick_damping, 0, 1)
        needs = "with rigid bricks: expected only beside --bricks deformable; give both, or leave it out"
        self._check_default(() if self.deforms else (*_OF_MODES, "brick_cells"), needs)
        self._check_default(_OF_MODES if self.brick_cells else (), "with bricks of glued cells, as always in YADE: "
                            "expected strain modes, which the reference solver has; leave it out")

    def _check_default(self, names, problem):
        """InputError where one of these options is given."""
        for one in fields(self):
            if one.name in names and getattr(self, one.name) != one.default:
                raise InputError(f"--{one.name.replace('_', '-')} = {getattr(self, one.name)!r} {problem}")

    @property
    def deforms(self):
        """Whether bricks are deformable."""
        return self.bricks == "deformable"

    @property
    def has_modes(self):
        """Whether bricks have strain modes."""
        return self.deforms and not self.brick_cells

    def tags(self):
        """The differences of this model from the default in a file's name: a list of words."""
        return [one.metadata["tag"].format(**asdict(self)) for one in fields(self)
                if one.metadata["tag"] and getattr(self, one.name) != one.default]


def _soil_word(soil):
    """"rigid", or a stiffness [N/m3] as its shortest word.

    >>> _soil_word("rigid"), _soil_word(4.4e8), _soil_word("1.2e8")
    ('rigid', '4.4e+08', '1.2e+08')
    """
    if soil == "rigid":
        return soil
    try:
        check_range("--soil [N/m3]", float(soil), *SOILS)
    except (InputError, ValueError, TypeError) as error:
        raise InputError(f"--soil {soil}: expected rigid, or the modulus of subgrade reaction from {SOILS[0]:g} to "
                         f"{SOILS[1]:g} N/m3 (soft clay about 1e7, dense sand 1e8); correct it") from error
    return f"{float(soil):g}"


def _lintel_word(lintel):
    """"elastic", "none", or a number of courses as its shortest word; 0 is "none", so that equal models are called so.

    >>> _lintel_word(2), _lintel_word("02"), _lintel_word(0), _lintel_word("elastic")
    ('2', '2', 'none', 'elastic')
    """
    if lintel in ("elastic", "none"):
        return lintel
    try:
        check_whole("lintel", int(lintel) if isinstance(lintel, str) else lintel, 0, MOST_BRICKS)
    except (InputError, ValueError) as error:
        raise InputError(f"lintel = {lintel!r}: expected elastic, none, or how many courses stay elastic, 0 to "
                         f"{MOST_BRICKS}; choose one of them") from error
    return str(int(lintel)) if int(lintel) else "none"


USUAL_MODEL = {one.name: one.default for one in fields(ModelOptions) if not one.metadata["seed"]} | {"joints": "face"}
"""{column: default} of the choices that distinguish models; joints: `History.joint_normals`."""
