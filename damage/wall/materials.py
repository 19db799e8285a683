"""Masonry and brick formats by name, each value with its source: bricks and joints for a Wall.

A value without a source that was read is None; whoever makes a joint of such a material gives it.
`MISSING` says what is not here.
"""

import math
from typing import NamedTuple

from damage.checks import check_number, check_range
from damage.elementary import atan, tan
from damage.errors import InputError, did_you_mean
from damage.wall.parameters import Joint, brick_of_masonry

_EUCENTRE = "the tests' row of EPFL's database of modern masonry walls (damage/data/eucentre)"
_CALCIUM_SILICATE = (
    "F. Graziotti, A. Rossi, M. Mandirola, A. Penna, G. Magenes (2016), IBMAC 16, 1619-1628; "
    f"{_EUCENTRE}"
)
_CLAY = f"F. Graziotti and others (2016), report EUC128/2016U, Eucentre, Pavia; {_EUCENTRE}"
_KORSWAGEN = (
    "P. A. Korswagen, dissertation, TU Delft, 2022: fired clay brickwork, {} of three strengths"
)
_PAPER = "V. Sarhosis and others (2021), doi:10.1016/j.engstruct.2021.112529, Tables 1 and 2"
_MORTAR = 0.010  # [m]


class Masonry(NamedTuple):
    """Masonry as tested: what it is; young_modulus of masonry across its bed joints,
    tensile_strength, cohesion of these [Pa], friction coefficient [-], fracture energies [J/m2];
    None where the source has none."""

    what: str
    young_modulus: float
    tensile_strength: float | None
    cohesion: float
    friction: float
    mode_i_fracture_energy: float | None
    mode_ii_fracture_energy: float | None
    source: str


MATERIALS = {
    "sarhosis-2021": Masonry(
        "the paper's calcium silicate brickwork, brittle; its modulus follows from joints of "
        "12e11 Pa/m and bricks of 5.2 GPa, 0.075 m high",
        young_modulus=4.916e9,
        tensile_strength=0.21e6,
        cohesion=0.24e6,
        friction=float(tan(math.radians(32.0))),
        mode_i_fracture_energy=None,
        mode_ii_fracture_energy=None,
        source=_PAPER,
    ),
    "calcium-silicate": Masonry(
        "solid calcium silicate bricks, general-purpose mortar of 7.2 MPa; modulus of wallets",
        young_modulus=3256e6,
        tensile_strength=None,
        cohesion=0.21e6,
        friction=0.42,
        mode_i_fracture_energy=None,
        mode_ii_fracture_energy=None,
        source=_CALCIUM_SILICATE,
    ),
    "clay": Masonry(
        "solid clay bricks, general-purpose mortar of 4.1 MPa; modulus of wallets, twice that of"
        " the tested walls (docs/validation/laboratory.md)",
        young_modulus=9833e6,
        tensile_strength=None,
        cohesion=0.15e6,
        friction=0.55,
        mode_i_fracture_energy=None,
        mode_ii_fracture_energy=None,
        source=_CLAY,
    ),
    "clay-weak": Masonry(
        "clay brickwork, weak",
        young_modulus=3571e6,
        tensile_strength=0.112e6,
        cohesion=0.119e6,
        friction=0.82,
        mode_i_fracture_energy=5.6,
        mode_ii_fracture_energy=102.0,
        source=_KORSWAGEN.format("the lowest"),
    ),
    "clay-standard": Masonry(
        "clay brickwork, standard",
        young_modulus=3571e6,
        tensile_strength=0.16e6,
        cohesion=0.17e6,
        friction=0.82,
        mode_i_fracture_energy=11.3,
        mode_ii_fracture_energy=209.0,
        source=_KORSWAGEN.format("the middle"),
    ),
    "clay-strong": Masonry(
        "clay brickwork, strong",
        young_modulus=3571e6,
        tensile_strength=0.208e6,
        cohesion=0.221e6,
        friction=0.82,
        mode_i_fracture_energy=19.0,
        mode_ii_fracture_energy=353.0,
        source=_KORSWAGEN.format("the highest"),
    ),
}
"""{name: Masonry}."""


MISSING = (
    "clay brick in lime (before 1930), calcium silicate in thin-layer mortar, coefficients of"
    " variation and densities: no source with numbers could be read; S. Jafari, L. Panoutsopoulou,"
    " J. G. Rots (2015), report C31B60-3, TU Delft, tests original Groningen masonry"
)
"""What has no numbers here, and why."""


class Format(NamedTuple):
    """Length, thickness and height of a brick without mortar [m]."""

    length: float
    thickness: float
    height: float
    source: str


FORMATS = {
    "waalformaat": Format(
        0.210, 0.100, 0.050, "tipp-zum-bau.de/waalformat, documentatie.org: 75 to the square metre"
    ),
    "waaldikformaat": Format(
        0.210, 0.100, 0.065, "tipp-zum-bau.de/waalformat: 58 to the square metre"
    ),
    "rijnvorm": Format(
        0.180, 0.085, 0.050, "users.telenet.be/debrandt/Steenbakkerij: terminology of bricks"
    ),
    "normalformat": Format(0.240, 0.115, 0.071, "the German NF; burma-ksa.com/nl/advices/1399"),
    "eucentre-clay": Format(0.208, 0.100, 0.050, _CLAY),
    "eucentre-calcium-silicate": Format(0.212, 0.102, 0.071, _CALCIUM_SILICATE),
}
"""{name: Format}."""


def masonry(
    material: str,
    brick_format: str,
    *,
    mortar: float = _MORTAR,
    wythes: int = 1,
    density: float = 1900.0,
    young_modulus: float | None = None,
    **joint: float,
) -> dict:
    """{"brick": Brick, "joint": Joint} of a material and a brick format by their names, as a Wall
    takes them.

    mortar: thickness of joints [m], part of the bricks' sizes; wythes: bricks side by side through
    the thickness, with mortar between them; density [kg/m3]; young_modulus: of masonry across its
    bed joints, in place of the material's [Pa], which the bricks are so stiff as to give; joint:
    other values for fields of the Joint, as tensile_strength, which a material without it needs.
    Raises InputError for unknown names and missing values.

    >>> sorted(masonry("clay-standard", "waalformaat"))
    ['brick', 'joint']
    """
    properties = _named("material", material, MATERIALS)
    size = _named("brick format", brick_format, FORMATS)
    check_range("mortar [m]", mortar, 0.0, 0.05)
    check_number("wythes", wythes, "a whole number from 1 to 6", lambda value: value in range(1, 7))
    known = Joint.__dataclass_fields__
    given = {name: value for name, value in properties._asdict().items() if name in known}
    given["friction_angle"] = float(atan(properties.friction))
    unknown = sorted(set(joint) - set(known))
    if unknown:
        raise InputError(
            f"masonry({unknown[0]}=...): expected a field of Joint{did_you_mean(unknown[0], given)}"
        )
    given |= joint
    if given["tensile_strength"] is None:
        raise InputError(
            f"material {material}: its source has no tensile strength of the joints: expected"
            " yours; give tensile_strength=... [Pa], as 0.21 / 0.24 of the cohesion like the"
            " paper's Table 1"
        )
    made = Joint(**given)
    modulus = properties.young_modulus if young_modulus is None else young_modulus
    brick = brick_of_masonry(
        modulus,
        made,
        length=size.length + mortar,
        height=size.height + mortar,
        thickness=wythes * size.thickness + (wythes - 1) * mortar,
        density=density,
    )
    return {"brick": brick, "joint": made}


def _named(what, name, known):
    """The record of a name; InputError where there is none."""
    if name not in known:
        raise InputError(
            f"{what} {name!r}: expected one of {', '.join(known)} (python3 -m damage materials)"
            f"{did_you_mean(name, known)}"
        )
    return known[name]


def as_dict() -> dict:
    """Materials and formats as plain tables, in SI units.

    >>> sorted(as_dict())
    ['formats', 'materials']
    """
    return {
        "materials": {name: material._asdict() for name, material in MATERIALS.items()},
        "formats": {name: brick._asdict() for name, brick in FORMATS.items()},
    }


def describe() -> str:
    """Materials and formats with sources, as text."""
    lines = []
    for name, material in MATERIALS.items():
        mode_i = material.mode_i_fracture_energy
        mode_ii = material.mode_ii_fracture_energy
        energies = "brittle" if mode_i is None else f"G_I {mode_i:g}, G_II {mode_ii:g} J/m2"
        tension = (
            "f_t not given"
            if material.tensile_strength is None
            else f"f_t {material.tensile_strength / 1e6:g} MPa"
        )
        lines += [
            (
                f"{name}: E {material.young_modulus / 1e6:g} MPa, {tension},"
                f" c {material.cohesion / 1e6:g} MPa, tan(phi) {material.friction:.3g}, {energies}"
            ),
            f"    {material.what}",
            f"    source: {material.source}",
        ]
    lines.append("brick formats, length x thickness x height without mortar:")
    for name, brick in FORMATS.items():
        sizes_mm = (1e3 * size for size in (brick.length, brick.thickness, brick.height))
        lines.append("{}: {:g} x {:g} x {:g} mm; ".format(name, *sizes_mm) + brick.source)
    return "\n".join([*lines, f"not here: {MISSING}"])
