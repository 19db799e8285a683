"""Modelling choices that the paper leaves open, the same in every solver; each is checked once,
when it is made."""

from dataclasses import asdict, dataclass, fields

from damage.checks import check_range, check_whole
from damage.errors import InputError
from damage.fields import MOST_BRICKS, MOST_SEED, check_fields, choice, option_of, quantity, text
from damage.wall.lintels import KINDS_OF_LINTELS

SOILS = (1e5, 1e12)
"""Least and largest modulus of subgrade reaction [N/m3]."""

_KINDS = tuple(kind for kind in KINDS_OF_LINTELS if kind != "stone")
"""Kinds of lintels that are complete by their name."""
_OF_SOIL = ("soil_shear", "footing")


@dataclass(frozen=True)
class ModelOptions:
    """Modelling choices that the paper leaves open, the same in every solver.

    lintel: "elastic" leaves every opening its own lintel (`damage.wall.lintels`); where it has
        none, the joints of all courses over it stay elastic.  In place of all lintels, "none" lets
        these joints break, a number keeps those of so many of the lowest courses elastic (as a
        word: 2 becomes "2", 0 becomes "none"), and a kind, like "concrete", puts such lintels over
        all openings.
    top: the precompression's mass sits on "piers" (one rigid cap each), is spread "uniform" over
        the top course, or is one rigid "beam".
    load: that mass is the precompression over the wall's whole "length", so that the piers beside
        openings have more, or over its "piers" alone, which then have just that stress.
    cells: contact points per half brick of a bed joint.
    contacts: where the points of a bed joint lie: "interior" of the cells, at the "corners" (ends)
        of each overlap, or at the "gauss" points of two cells together; head joints have one at
        mid-height, one at each end, or two Gauss points.
    strength_cov, strength_seed: coefficient of variation of the joints' strengths, and what seeds
        them: each joint between two bricks has one lognormal factor of mean 1 on tensile strength
        and cohesion.
    inputs: the wall as "given", or what its user does not know drawn by strength_seed from ranges
        (`damage.house.drawn`): of a wall whose masonry was "tested", or of "typical" masonry.
    supports: "one" below the whole wall, or one below each brick of the base ("bricks"), whose
    forces the history has.
    soil: "rigid", or springs below the base (`damage.wall.soil`) of so many N/m3 vertically, as a
        word; soil_shear: horizontal over vertical stiffness; footing: width over which they act
        [m].
    bricks: "rigid", their compliance lumped into the joints, or "deformable"
        (`damage.wall.strain`), with brick_damping of their strain modes' critical damping.
    """

    lintel: str = text(
        default="elastic",
        metavar="elastic|none|N|KIND",
        tag="lintel-{lintel}",
        help=(
            "over an opening: its own lintel, or else all joints elastic; instead, joints able to"
            " fail like any other (none), elastic in the N lowest courses, or lintels of a kind"
            f" ({', '.join(_KINDS)})"
        ),
    )
    top: str = choice(
        ("piers", "uniform", "beam"),
        default="piers",
        tag="top-{top}",
        help="distribution of the mass that gives the precompression",
    )
    load: str = choice(
        ("length", "piers"),
        default="length",
        tag="load-{load}",
        help="where the precompression is the mean stress: over the whole length, or in the piers",
    )
    cells: int = quantity(
        "1", 1, 16, whole=True, default=2, metavar="N", help="contact points per half brick"
    )
    contacts: str = choice(
        ("interior", "corners", "gauss"),
        default="interior",
        tag="{contacts}",
        help="position of the contact points in a joint",
    )
    strength_cov: float = quantity(
        "1",
        0,
        2,
        default=0.0,
        metavar="COV",
        tag="strength-{strength_cov:g}-{strength_seed}",
        help="lognormal scatter of the joints' strengths: coefficient of variation",
    )
    strength_seed: int = quantity(
        "1",
        0,
        MOST_SEED,
        whole=True,
        default=0,
        metavar="N",
        seed=True,
        help="seed of the joints' strengths and of drawn inputs",
    )
    inputs: str = choice(
        ("given", "tested", "typical"),
        default="given",
        tag="{inputs}-{strength_seed}",
        help=(
            "what a user does not know of the wall: as given, or drawn from the ranges of"
            " damage/data/ranges, with tests of its masonry or without"
        ),
    )
    supports: str = choice(
        ("one", "bricks"),
        default="one",
        tag="supports-{supports}",
        help=(
            "one support below the "
            "wall, or one below each brick of the base, with reactions of its own in the history"
        ),
    )
    soil: str = text(
        default="rigid",
        metavar="rigid|N_M3",
        tag="soil-{soil}",
        help=(
            "soil below the base: rigid, or "
            "its vertical modulus of subgrade reaction, springs without tension"
        ),
    )
    soil_shear: float = quantity(
        "1",
        0.01,
        10,
        default=0.5,
        metavar="SHARE",
        tag="soil-shear-{soil_shear:g}",
        help="soil: horizontal stiffness over the vertical one",
    )
    footing: float = quantity(
        "m",
        0.01,
        10,
        default=0.45,
        metavar="M",
        tag="footing-{footing:g}",
        help="soil: width of the footing [m]",
    )
    bricks: str = choice(
        ("rigid", "deformable"),
        default="rigid",
        tag="{bricks}",
        help=(
            "rigid bricks, whose compliance is lumped into the joints, or deformable ones with"
            " strain modes (reference solver)"
        ),
    )
    brick_damping: float = quantity(
        "1",
        0,
        1,
        default=0.05,
        metavar="RATIO",
        tag="brick-damping-{brick_damping:g}",
        help="deformable bricks: damping of their strain modes over the critical one, 0 to 1",
    )

    def __post_init__(self):
        check_fields(self)
        vars(self)["lintel"] = _lintel_word(self.lintel)
        if self.contacts == "gauss" and self.cells % 2:
            raise InputError(
                f"--contacts gauss with --cells {self.cells}: expected an even number, since Gauss"
                " points come in pairs; give --cells 2"
            )
        vars(self)["soil"] = _soil_word(self.soil)
        self._check_default(
            _OF_SOIL if self.soil == "rigid" else (),
            "without --soil: expected the soil's stiffness [N/m3], too; give both, or leave it out",
        )
        self._check_default(
            () if self.has_modes else ("brick_damping",),
            "with rigid bricks: expected only beside --bricks deformable; give both, or leave it"
            " out",
        )

    def _check_default(self, names, problem):
        """InputError where one of these options is given."""
        for attribute in fields(self):
            if attribute.name in names and getattr(self, attribute.name) != attribute.default:
                raise InputError(
                    f"{option_of(attribute)} = {getattr(self, attribute.name)!r} {problem}"
                )

    @property
    def draws(self):
        """Whether the wall differs by strength_seed."""
        return bool(self.strength_cov) or self.inputs != "given"

    @property
    def has_modes(self):
        """Whether bricks have strain modes."""
        return self.bricks == "deformable"

    def tags(self):
        """The differences of this model from the default in a file's name: a list of words."""
        return [
            attribute.metadata["tag"].format(**asdict(self))
            for attribute in fields(self)
            if attribute.metadata["tag"] and getattr(self, attribute.name) != attribute.default
        ]


def _soil_word(soil):
    """Return "rigid", or a stiffness [N/m3] as its shortest word.

    >>> _soil_word("rigid"), _soil_word(4.4e8), _soil_word("1.2e8")
    ('rigid', '4.4e+08', '1.2e+08')
    """
    if soil == "rigid":
        return soil
    try:
        check_range("--soil [N/m3]", float(soil), *SOILS)
    except (InputError, ValueError, TypeError) as error:
        raise InputError(
            f"--soil {soil}: expected rigid, or the modulus of subgrade reaction from {SOILS[0]:g}"
            f" to {SOILS[1]:g} N/m3 (soft clay about 1e7, dense sand 1e8); correct it"
        ) from error
    return f"{float(soil):g}"


def _lintel_word(lintel):
    """Return "elastic", "none", a kind of lintel, or a number of courses as its shortest word; 0 is
    "none", so that equal models are called so.

    >>> _lintel_word(2), _lintel_word("02"), _lintel_word(0), _lintel_word("elastic")
    ('2', '2', 'none', 'elastic')
    """
    if lintel == "stone":
        raise InputError(
            "--lintel stone: expected its modulus, too, which a wall file gives: lintel = { kind = "
            '"stone", modulus = 2e10 }; put it there, or choose another kind'
        )
    if lintel in ("elastic", "none", *_KINDS):
        return lintel
    try:
        check_whole("lintel", int(lintel) if isinstance(lintel, str) else lintel, 0, MOST_BRICKS)
    except (InputError, ValueError) as error:
        raise InputError(
            f"lintel = {lintel!r}: expected elastic, none, {', '.join(_KINDS)}, or how many courses"
            f" stay elastic, 0 to {MOST_BRICKS}; choose one of them"
        ) from error
    return str(int(lintel)) if int(lintel) else "none"


USUAL_MODEL = {
    attribute.name: attribute.default
    for attribute in fields(ModelOptions)
    if not attribute.metadata["seed"]
}
"""{column: default} of the choices that distinguish models."""
