"""Inputs of a wall that its user does not know, drawn from ranges with sources:
damage/data/ranges/ranges.csv, whose README says what each factor is on."""

from dataclasses import replace
from functools import cache
from typing import NamedTuple

import pandas as pd

from damage.draws import Draws
from damage.elementary import atan, exp, log, tan
from damage.errors import InputError
from damage.house.house import House
from damage.provenance import HERE, RANGES
from damage.rounded import to_bits

INPUTS = (
    "stiffness",
    "bond",
    "friction",
    "compressive_strength",
    "unit_strength",
    "density",
    "load",
    "bearing_stiffness",
    "bearing_friction",
    "bearing_play",
)
"""Only add: an input draws by its place."""
_STREAM = 3, 1
"""Between seed and input: seeds of joints (seed), members (seed, 1) and lives (seed, number) are
others."""


class Range(NamedTuple):
    """A distribution of a factor: lognormal of mean 1 with a coefficient of variation, or
    log-uniform between bounds where that is None."""

    cov: float | None
    low: float = 1.0
    high: float = 1.0

    def factor(self, seed):
        """The factor that a seed draws."""
        draws = Draws(seed)
        if self.cov is None:
            low = log(self.low)
            high = log(self.high)
            return float(to_bits(exp(low + (high - low) * draws.uniform(1)[0])))
        spread = log(1.0 + self.cov * self.cov) ** 0.5
        return float(to_bits(exp(spread * draws.normal(1)[0] - spread * spread / 2)))


@cache
def ranges(knowledge):
    """{input: Range} of a state of knowledge, "tested" or "typical"; empty for "given"."""
    table = pd.read_csv(HERE / RANGES)
    table = table[table["knowledge"] == knowledge].astype(object).where(table.notna(), None)
    return {row.input: Range(row.cov, row.low, row.high) for row in table.itertuples()}


def drawn(wall, of, seed):
    """A damage.Wall, or House, whose inputs have the factors that a seed draws.

    of: {of INPUTS: Range}; what it lacks is as given.  The friction coefficient stays below
    cohesion over tensile strength, where softening joints end.
    """
    if not of:
        return wall
    if unknown := sorted(set(of) - set(INPUTS)):
        raise InputError(f"range of {unknown[0]}: expected one of {', '.join(INPUTS)}; correct it")
    factor = {
        name: of[name].factor((seed, *_STREAM, number)) if name in of else 1.0
        for number, name in enumerate(INPUTS, 1)
    }
    if isinstance(wall, House):
        return replace(
            wall.with_each(lambda one: drawn(one, of, seed)),
            floors=[_times(floor, factor, {"mass_per_area": "load"}) for floor in wall.floors],
        )
    load = factor["load"]
    return replace(
        wall,
        brick=_times(wall.brick, factor, _BRICK),
        joint=_with_friction(_times(wall.joint, factor, _JOINT), factor["friction"]),
        precompression=load * wall.precompression,
        floors=[_times(floor, factor, _FLOOR) for floor in wall.floors],
        restraints=[
            _times(restraint, factor, _BEARING) if restraint.side == "top" else restraint
            for restraint in wall.restraints
        ],
    )


_BRICK = {
    "young_modulus": "stiffness",
    "shear_modulus": "stiffness",
    "density": "density",
    "tensile_strength": "unit_strength",
    "fracture_energy": "unit_strength",
}
_JOINT = {
    "normal_stiffness": "stiffness",
    "shear_stiffness": "stiffness",
    "tensile_strength": "bond",
    "cohesion": "bond",
    "mode_i_fracture_energy": "bond",
    "mode_ii_fracture_energy": "bond",
    "compressive_strength": "compressive_strength",
    "compressive_fracture_energy": "compressive_strength",
}
_FLOOR = {"mass": "load", "mass_per_area": "load"}
_BEARING = {name: f"bearing_{name}" for name in ("stiffness", "friction", "play")}


def _times(record, factor, inputs):
    """A record with the fields of {field: input} times their factors; what is None stays so."""
    values = {name: getattr(record, name) for name in inputs}
    return replace(
        record, **{name: factor[inputs[name]] * value for name, value in values.items() if value}
    )


def _with_friction(joint, factor):
    if factor == 1.0:
        return joint
    friction = factor * tan(joint.friction_angle)
    if joint.softens:
        friction = min(friction, joint.cohesion / joint.tensile_strength)
    return replace(joint, friction_angle=float(to_bits(atan(friction))))
