"""Range of validity: what the evidence supports, and which quantities of a run lie outside
(*evidence for this run*).

QUANTITIES is the table of `docs/model/validity.md`.  A quantity with a `value` is judged for every
run: those of the wall and the motion before it, those of its results after it.  One that does not
apply to a run has the value None.
"""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import NamedTuple

from damage.measure.energy import ENERGY_ERROR
from damage.measure.pushed import hand_capacities
from damage.units import MILLIMETRE

PLACE = "docs/model/validity.md"
SIZES = {"%": 0.01, "MPa": 1e6}
"""{unit of limits: its size} where that is not the unit of a run's numbers."""
_ROUNDING = 1e-6
"""Share of a limit [-] up to which a value beyond it is rounding: that of inputs
(`damage.rounded`), of which a push to 0.3 % and motions have up to a tenth."""


class Quantity(NamedTuple):
    """A row of the range of validity.

    evidence, beyond: Markdown, what supports it and what is known outside; supported: in words,
    {range} for the limits; value: function of what `evidence_for` knows of a run, in SI units, None
    where no run can be judged; least, most: limits in `unit`, of a size of SIZES.
    """

    name: str
    evidence: str
    beyond: str
    supported: str = "{range}"
    value: Callable | None = None
    least: float = 0.0
    most: float = math.inf
    unit: str = ""

    @property
    def range(self):
        """The limits in words."""
        unit = f" {self.unit}" if self.unit else ""
        if self.most == 0:
            return "none"
        if self.least == self.most:
            return f"{self.most:g}{unit}"
        return (
            f"up to {self.most:g}{unit}"
            if self.least == 0
            else f"{self.least:g} to {self.most:g}{unit}"
        )

    def judge(self, run):
        """{"value", "least", "most", "unit", "inside"} of a run; value and inside None where the
        quantity does not apply."""
        value = self.value(run)
        inside = None
        if value is not None:
            value = float(value) / SIZES.get(self.unit.partition(" ")[0], 1.0)
            inside = self.least * (1 - _ROUNDING) <= value <= self.most * (1 + _ROUNDING)
        return {
            "value": value,
            "least": self.least,
            "most": self.most,
            "unit": self.unit,
            "inside": inside,
        }


def evidence_for(wall, parameters, result=None):
    """{name of a quantity: `Quantity.judge`} of all that can be judged of a damage.Wall and the
    parameters of its run, as a history has them; result: the numbers of
    `damage.measure.summary.summarise`, None before the run."""
    joint = wall.joint
    factors = parameters.get("sequence", [1.0])
    motions = [
        parameters["motions"][event["motion"]] for event in parameters.get("events", [])
    ] or [parameters["loading"]] * len(factors)
    run = SimpleNamespace(
        wall=wall,
        joint=joint,
        dry=joint.tensile_strength == 0 and joint.cohesion == 0,
        stress=parameters.get("pier_stress_pa", wall.precompression),
        boundary=parameters["loading"].get("boundary"),
        events=list(zip(motions, map(abs, factors))),
        shakes=parameters["loading"]["kind"] in ("harmonic", "record", "free_vibration"),
        rest_s=(parameters.get("events") or [{}])[-1].get("rest_s", parameters.get("rest_s")),
        result=result or {},
        corners=_corners(wall, parameters.get("house")),
        followed=bool(
            result and result["collapsed_at_s"] is not None and parameters.get("after_fall")
        ),
    )
    return {quantity.name: quantity.judge(run) for quantity in QUANTITIES if quantity.value}


def _corners(wall, house):
    """Number of the corners of a wall of a house, or of the house, None of another wall."""
    if house is None:
        return None
    named = [wall.name in corner["walls"] for corner in house["corners"]]
    return sum(named) or (len(named) if wall.name == house["name"] else 0)


def _storeys(run):
    top = run.wall.built_height - MILLIMETRE
    return 1 + len({floor.courses(run.wall)[1] for floor in run.wall.floors if floor.level < top})


def _largest(kind, name, factor=True):
    """Function of the largest value, by default times the factor on its motion, of all motions of a
    kind."""

    def value(run):
        peaks = [
            abs(motion[name]) * (by if factor else 1.0)
            for motion, by in run.events
            if motion["kind"] == kind and motion.get(name) is not None
        ]
        return max(peaks, default=None)

    return value


def _deciding_cohesion(run):
    """Share of its cohesion [-] below which the top bed joint slides before a stepped crack forms
    or the wall rocks; 0 where it never slides first, or always does; None of walls without forces
    by hand."""
    hand = hand_capacities(run.wall, run.boundary) if run.boundary and run.joint.softens else {}
    if not hand:
        return None
    bond = run.joint.cohesion * run.wall.length * run.wall.brick.thickness
    share = (min(hand["diagonal"], hand["rocking"]) - hand["sliding_top"]) / bond
    return share if 0 < share < 1 else 0.0


def _shear_share(run):
    tension, shear = (run.result.get(f"{kind}_breaks", 0) for kind in ("tension", "shear"))
    return None if run.joint.softens or tension + shear == 0 else shear / (tension + shear)


def _result(name):
    return lambda run: run.result.get(name)


QUANTITIES = (
    Quantity(
        "direction",
        "closed forms within 2 %; [one shaken strip](../validation/shaken-walls.md)",
        "two-way bending, torsion and return walls: [houses](house.md) in YADE alone",
        supported="in the plane of the wall;"
        " [strips](../guides/own-wall.md#a-strip-in-one-way-bending) "
        "between floors bend out of it",
    ),
    Quantity(
        "corners with other walls",
        "[closed forms, limit analysis by hand](house.md#checks)",
        "no house has been compared with a test, nor another program with its motion",
        value=lambda run: run.corners,
        most=0.0,
    ),
    Quantity(
        "drift across the wall",
        "[closed forms of rocking and bending](house.md#checks)",
        "no test of a wall of a house has been compared",
        value=_result("max_drift_across_ratio"),
        most=0.0,
        unit="%",
    ),
    Quantity(
        "vertical components of the motion",
        "",
        "`--vertical` applies it; its effect has not been compared",
        supported="{range}: no study here has one",
        value=lambda run: any(motion.get("vertical") for motion, _ in run.events),
        most=0.0,
    ),
    Quantity(
        "drift",
        "[laboratory walls](../validation/laboratory.md)",
        "with equal joints, force falls too steeply after the "
        "peak; scatter and softening crushing: [after the peak](../validation/after-the-peak.md)",
        supported="{range} (pushed brick walls); 2 % in the index's definition",
        value=_result("max_drift_ratio"),
        most=0.3,
        unit="%",
    ),
    Quantity(
        "slip of a joint",
        "[slides, rocking](../validation/verification.md)",
        "bricks find new contacts [in YADE](yade.md#loose-bricks) alone",
        value=_result("max_offset_mm"),
        most=10.0,
        unit="mm",
    ),
    Quantity(
        "slip over the overlap of the faces",
        "as above",
        "a joint ends where its faces no longer overlap, with a warning",
        value=_result("max_offset_over_overlap"),
        most=1.0,
    ),
    Quantity(
        "bricks followed after a fall",
        "none",
        "the index ends; [`--after-fall`](yade.md#loose-bricks) follows loose bricks in"
        " YADE; no collapse has been compared with a test",
        supported="{range}: up to the first brick that drops by half its height",
        value=lambda run: run.followed,
        most=0.0,
    ),
    Quantity(
        "precompression of mortar joints",
        "[four tested walls](../validation/laboratory.md), peaks within 10 %",
        "no tested wall with mortar below 0.3 MPa",
        supported="{range} on brick walls, in the piers",
        value=lambda run: None if run.dry else run.stress,
        least=0.3,
        most=0.9,
        unit="MPa",
    ),
    Quantity(
        "precompression of dry joints",
        "[limit analysis; wall SW.30](../validation/dry-joints.md), peak 15 % below the tests",
        "at 1 MPa, dry stone walls peak "
        "[57 % too high](../validation/dry-joints.md) unless stones split",
        value=lambda run: run.stress if run.dry else None,
        most=0.15,
        unit="MPa",
    ),
    Quantity(
        "length",
        "[laboratory](../validation/laboratory.md), shipped walls",
        "20 000 bricks at most",
        value=lambda run: run.wall.length,
        least=1.0,
        most=4.05,
        unit="m",
    ),
    Quantity(
        "height",
        "as above",
        "as above",
        value=lambda run: run.wall.built_height,
        least=1.0,
        most=2.78,
        unit="m",
    ),
    Quantity(
        "storeys",
        "as above",
        "gables and floors follow "
        "[closed forms](../guides/own-wall.md#a-house), no tested house has been compared",
        value=_storeys,
        least=1.0,
        most=1.0,
    ),
    Quantity(
        "bond",
        "all tests",
        "walls laid two bricks thick were modelled as one layer; no cross bond, no ties",
        supported="running bond, one brick thick",
    ),
    Quantity(
        "cohesion of mortar joints",
        "[laboratory](../validation/laboratory.md)",
        "joints have no thickness; properties do not vary along a joint",
        supported="{range}; clay and calcium silicate brickwork",
        value=lambda run: None if run.dry else run.joint.cohesion,
        least=0.15,
        most=0.24,
        unit="MPa",
    ),
    Quantity(
        "tan(phi)",
        "as above",
        "as above",
        value=lambda run: math.tan(run.joint.friction_angle),
        least=0.42,
        most=0.63,
    ),
    Quantity(
        "shear failures of brittle joints",
        "[laboratory](../validation/laboratory.md)",
        "brittle joints underestimate the peak of shear walls by a quarter",
        supported="{range}: walls that rock. Softening joints: also walls that shear",
        value=_shear_share,
        most=50.0,
        unit="% of failed contact points",
    ),
    Quantity(
        "cohesion at which a bed joint slides before steps form",
        "[tested walls](../validation/after-the-peak.md#two-equal-walls) at 0 to 9 % "
        "crack in steps",
        "at the border: of two equal walls at 58 % one cracked in steps, one slid. No test "
        "gives the cohesion of one bed joint, so that neither mode nor ultimate drift is predicted",
        supported="{range}, which one joint in 200 falls short of by the scatter of 40 % of single "
        "specimens",
        value=_deciding_cohesion,
        most=35.0,
        unit="% of the mean",
    ),
    Quantity(
        "split or crushed length",
        "[deformable bricks](model.md#deformable-bricks): first periods within 4 %",
        "splitting and crushing are options; both move tested peaks by at most 7 %",
        supported="{range}: bricks rigid, intact",
        value=lambda run: (
            run.result["crushed_length_m"] + run.result["split_length_m"] if run.result else None
        ),
        most=0.0,
        unit="m",
    ),
    Quantity(
        "stiffness",
        "[laboratory](../validation/laboratory.md)",
        "moduli of wallet tests give half or twice the measured stiffness",
        supported="modulus fitted to the wall",
    ),
    Quantity(
        "period of a harmonic motion",
        "[both solvers](../validation/two-solvers.md)",
        "one wall on a shaking table has been compared: [shaken"
        " walls](../validation/shaken-walls.md)",
        supported="{range}; records",
        value=_largest("harmonic", "period_s", factor=False),
        least=0.06,
        most=1.0,
        unit="s",
    ),
    Quantity(
        "amplitude of a harmonic motion",
        "[results](../paper/results.md)",
        "near resonance 5 % of the period changes DI of brittle walls by a factor of 2 to 4",
        value=_largest("harmonic", "amplitude_g"),
        least=0.01,
        most=0.1,
        unit="g",
    ),
    Quantity(
        "scale of a record",
        "as above",
        "fragility scales records by up to 10",
        value=_largest("record", "scale"),
        most=2.0,
    ),
    Quantity(
        "repeated events",
        "[equal events](../paper/thirty-years.md#equal-events), [repeated "
        "loading](../validation/repeated-loading.md)",
        "1.5 to 1.9 times the tested loss of calcium silicate; piers on stepped cracks"
        " walk 0.1 to"
        " 0.3 mm an event of 45 mm/s, no test of that has been compared",
        supported="both solvers agree; softening spandrels lose force by repetition as tested"
        " clay does",
    ),
    Quantity(
        "rest after the motion",
        "[open points](../paper/open-points.md)",
        "undamped masses on top bounce and fail joints later; 0.2 % of damping prevents it",
        value=lambda run: run.rest_s if run.shakes else None,
        least=1.0,
        most=2.0,
        unit="s",
    ),
    Quantity(
        "energy balance error",
        "[two solvers](../validation/two-solvers.md)",
        "[warning, below](#energy-balance); run failed above 100 %",
        value=_result("energy_error_fraction"),
        most=100 * ENERGY_ERROR,
        unit="%",
    ),
    Quantity(
        "base",
        "[overview](../validation/overview.md)",
        "no settled building has been compared; soil has no mass, and "
        "no damping; it lengthens the period by 67 to 131 %",
        supported="rigid; [settlement and soil springs](model.md#ground) follow closed forms",
    ),
)


def outside(evidence):
    """The quantities outside the range of validity with value and range, in words, a list of str.

    >>> length = {"value": 6.2, "least": 1.0, "most": 4.05, "unit": "m", "inside": False}
    >>> outside({"length": length})
    ['length 6.2 m (1 to 4.05 m)']
    >>> drift = {"value": 0.30002, "least": 0.0, "most": 0.3, "unit": "%", "inside": False}
    >>> outside({"drift": drift})
    ['drift 0.30002 % (up to 0.3 %)']
    """
    by_name = {quantity.name: quantity for quantity in QUANTITIES}
    return [
        f"{name} {_beyond(quantity)}{' ' * bool(quantity['unit'])}{quantity['unit']}"
        f" ({by_name[name].range})"
        for name, quantity in evidence.items()
        if quantity["inside"] is False
    ]


def names_outside(text):
    """Names of the quantities in the text of `outside`, joined by "; ", a set.

    >>> names_outside("length 6.2 m (1 to 4.05 m); drift across the wall 1 % (none)") == {
    ...     "length", "drift across the wall"
    ... }
    True
    """
    names = [quantity.name for quantity in QUANTITIES]
    # the longest: "drift" begins "drift across the wall", too
    return {
        max((name for name in names if part.startswith(f"{name} ")), key=len)
        for part in filter(None, text.split("; "))
    }


def _beyond(judged):
    """A value outside its limits in as many digits, three or more, as tell it from them."""
    digits = (f"{judged['value']:.{count}g}" for count in range(3, 17))
    limits = judged["least"], judged["most"]
    return next((text for text in digits if float(text) not in limits), str(judged["value"]))


def describe(evidence):
    """The evidence for a run in one line."""
    outer = outside(evidence)
    known = sum(quantity["inside"] is not None for quantity in evidence.values())
    if not outer:
        return f"evidence for this run: inside the range of validity in all {known} quantities"
    return (
        f"evidence for this run: outside the range of validity ({PLACE}) in {len(outer)} of {known}"
        f" quantities: {', '.join(outer)}"
    )
