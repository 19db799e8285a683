"""Modelling choices that the paper leaves open, the same in every solver; each is checked once, when it is made."""

from dataclasses import asdict, dataclass, field, fields

from damage.checks import check_choice, check_range, check_whole
from damage.errors import InputError
from damage.wall.lintels import KINDS_OF_LINTELS
from damage.wall.parameters import MOST_BRICKS, MOST_SEED

SOILS = (1e5, 1e12)
"""Least and largest modulus of subgrade reaction [N/m3]."""
SOIL_VELOCITIES = (20, 2000)
"""Least and largest shear-wave velocity of a soil [m/s]."""


_KINDS = tuple(kind for kind in KINDS_OF_LINTELS if kind != "stone")
"""Of lintels that are whole by their name."""


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
        courses over it stay elastic.  In place of all lintels, "none" lets these joints break, a number keeps those of
        so many of the lowest courses elastic (as a word: 2 becomes "2", 0 becomes "none"), and a kind, like
        "concrete", puts such lintels over all openings.
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
                          "able to fail like any other (none), elastic in the N lowest courses, or lintels of a kind "
                          f"({', '.join(_KINDS)})", metavar="elastic|none|N|KIND", tag="lintel-{lintel}")
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
    """"elastic", "none", a kind of lintel, or a number of courses as its shortest word; 0 is "none", so that equal
    models are called so.

    >>> _lintel_word(2), _lintel_word("02"), _lintel_word(0), _lintel_word("elastic")
    ('2', '2', 'none', 'elastic')
    """
    if lintel == "stone":
        raise InputError("--lintel stone: expected its modulus, too, which a wall file gives: lintel = { kind = "
                         '"stone", modulus = 2e10 }; put it there, or choose another kind')
    if lintel in ("elastic", "none", *_KINDS):
        return lintel
    try:
        check_whole("lintel", int(lintel) if isinstance(lintel, str) else lintel, 0, MOST_BRICKS)
    except (InputError, ValueError) as error:
        raise InputError(f"lintel = {lintel!r}: expected elastic, none, {', '.join(_KINDS)}, or how many courses stay "
                         f"elastic, 0 to {MOST_BRICKS}; choose one of them") from error
    return str(int(lintel)) if int(lintel) else "none"


USUAL_MODEL = {one.name: one.default for one in fields(ModelOptions) if not one.metadata["seed"]} | {"joints": "face"}
"""{column: default} of the choices that distinguish models; joints: `History.joint_normals`."""
