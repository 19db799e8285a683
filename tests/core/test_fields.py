"""Fields that say their limits once: the check and its message, the schema of a wall, words in
place of numbers; names that were removed."""

import math
import re
from copy import copy
from dataclasses import dataclass, fields, replace
from fractions import Fraction

import numpy as np
import pytest
from conftest import one_line_error, parsed, refused_with

from damage import Brick, Joint, Lintel, ModelOptions, Opening, Wall, run
from damage.applications.groningen.exposure.lives import Choices
from damage.checks import record_from
from damage.errors import heard
from damage.fields import check_fields, choice, implausible_fields, option_of, quantity
from damage.house.house import Corner, Diaphragm, House, Placed
from damage.house.ties import Ties
from damage.motion.loading import FreeVibration, Harmonic, Recorded, TopDisplacement
from damage.motion.record import Record
from damage.retired import RETIRED, Retired
from damage.run.options import SOLVERS, options_of_a_run
from damage.run.settings import RunSettings
from damage.wall.file import wall_schema
from damage.wall.floors import KINDS_OF_FLOORS, Floor
from damage.wall.restraints import Restraint


@dataclass(frozen=True)
class Beam:
    length: float = quantity("m", 0.1, 50.0, (0.5, 20), "a lintel; a bridge")
    count: int = quantity("1", 1, 9, whole=True, default=1)
    strength: float | str | None = quantity(
        "Pa", 0.0, 1e9, (1e5, 1e8), "peat; steel", words=("rule",), default=None
    )
    kind: str = choice(("oak", "fir"), default="fir")

    def __post_init__(self):
        check_fields(self)


@pytest.mark.parametrize(
    "given, said",
    [
        ({"length": 0.0}, "Beam.length = 0.0: expected a number from 0.1 to 50; correct it"),
        (
            {"length": 300},
            "Beam.length = 300: expected a number from 0.1 to 50; correct it: 300 cm is 300e-2 m",
        ),
        ({"length": None}, "Beam.length is missing: expected a number"),
        ({"length": True}, "Beam.length = True: expected"),
        (
            {"length": 1.0, "count": 1.5},
            "Beam.count = 1.5: expected a whole number, 1 to 9; correct it",
        ),
        (
            {"length": 1.0, "kind": "elm"},
            "Beam.kind = 'elm': expected one of oak, fir; choose one of them",
        ),
        (
            {"length": 1.0, "strength": "guess"},
            "Beam.strength = 'guess': expected a number from 0 to 1e+09",
        ),
    ],
)
def test_a_field_refuses_in_one_line(given, said):
    assert one_line_error(Beam, **given).startswith(said)


def _kinds_in(value):
    """Types of all values in tables and lists."""
    values = list(value.values()) if isinstance(value, dict) else value
    if isinstance(values, (list, tuple)):
        return {kind for one in values for kind in _kinds_in(one)}
    return {type(value)}


@pytest.mark.parametrize("number", [np.float32, np.int64, Fraction])
def test_numbers_of_other_kinds_become_those_that_files_take(number):
    zero, one, two, four = map(number, (0, 1, 2, 4))
    wall = Wall(
        "w",
        four,
        two,
        [Opening(one, one, one, lintel=Lintel("timber", one))],
        precompression=zero,
        brick=Brick(two, one, one, density=two),
        joint=Joint(two, one, one, tensile_strength=one),
        outline=[(zero, one), (one, two), (four, one)],
        floors=[Floor(one, one, left=zero, right=one)],
    )
    motions = (
        Harmonic(one, one),
        FreeVibration(one),
        TopDisplacement((one, two), floor_shares=((two, one),)),
        Recorded(Record("r", one, [0.0, 1.0, 0.0]), scale=two, window_s=(zero, two)),
    )
    for record in (wall, *motions):
        assert _kinds_in(record.as_dict()) <= {int, float, str, bool, type(None)}
    assert wall.joint.normal_stiffness == 2 and wall.outline[1] == (1, 2)


def test_words_and_a_default_of_none_stand_in_place_of_numbers():
    assert Beam(1.0).strength is None and Beam(1.0, strength="rule").strength == "rule"


def test_what_is_implausible_is_said_once_and_by_unit():
    beams = Beam(30.0, strength=0.2), Beam(30.0)
    length, strength = implausible_fields(*beams)
    assert (
        length == "Beam.length = 30 m, expected 0.5 to 20 m" and "0.2 MPa is 0.2e6 Pa" in strength
    )
    assert implausible_fields(*beams, unit="Pa") == [strength]
    for length, strength in ((0.5, 0.0), (20, 1e5), (5, 1e8)):
        assert implausible_fields(Beam(length, strength=strength)) == []
    assert len(implausible_fields(Beam(0.495), Beam(20.2), Beam(1.0, strength=1.01e8))) == 3


@pytest.mark.parametrize("name", ["mode_i_fracture_energy", "mode_ii_fracture_energy"])
@pytest.mark.parametrize("value", [False, "", ()])
def test_nothing_in_a_word_is_no_fracture_energy(name, value):
    """They were taken as none."""
    assert f"Joint.{name} = {value!r}: expected a number" in one_line_error(Joint, **{name: value})


def test_an_option_is_called_as_it_is_typed():
    for given, said in (
        ({"brick_damping": 30}, "--brick-damping = 30: expected a number"),
        ({"footing": 30}, "--footing [m] = 30: expected a number"),
        ({"lintel": True}, "lintel = True: expected elastic, none"),
    ):
        assert one_line_error(ModelOptions, **given).startswith(said)


def test_the_schema_of_a_wall_has_what_its_fields_say():
    joint = wall_schema()["properties"]["joint"]
    floor = wall_schema()["properties"]["floors"]["items"]
    assert joint["properties"]["mode_i_fracture_energy"] == {
        "anyOf": [{"type": "number"}, {"const": "rule"}]
    }
    assert floor["properties"]["kind"] == {"enum": list(KINDS_OF_FLOORS)}
    assert all(one.metadata for kind in (Brick, Joint, Floor) for one in fields(kind))
    assert {one.name for kind in (Opening, Wall) for one in fields(kind) if not one.metadata} == {
        "name",
        "openings",
        "brick",
        "joint",
        "outline",
        "floors",
        "lintel",
        "restraints",
    }


WALL = Wall("w", 2.0, 1.0)
RECORDS = [
    Brick(),
    Joint(),
    Opening(0.5, 0.5, 0.5),
    WALL,
    Floor(1.0, 100.0),
    Lintel(),
    Restraint("top"),
    Placed(WALL),
    Corner(("w", "w")),
    Diaphragm(0.5, ("w",), 100.0),
    House("h", (Placed(WALL),)),
    Ties(("w", "w"), 4.0, 1e6, 1e3, 1e3),
    TopDisplacement((0.2,)),
    ModelOptions(),
    RunSettings(Harmonic(0.2, 0.05), ModelOptions()),
    Choices(),
]
LIMITED = [
    (record, one)
    for record in RECORDS
    for one in fields(record)
    if one.metadata and (one.metadata["choices"] or one.metadata["unit"] is not None)
]


def within_and_beyond(limits):
    """Values at the limits that a field's metadata say, and values just outside of them."""
    if limits["choices"]:
        return limits["choices"], ("nonsense",)
    ends = [end for end in (limits["least"], limits["most"]) if end != math.inf]
    step = limits["whole"] or None
    beyond = [ends[0] - step if step else math.nextafter(ends[0], -math.inf), math.nan, math.inf]
    beyond += [end + step if step else math.nextafter(end, math.inf) for end in ends[1:]]
    return ends, beyond


@pytest.mark.parametrize(
    ("record", "one"), LIMITED, ids=[f"{type(of).__name__}.{one.name}" for of, one in LIMITED]
)
def test_every_field_is_held_to_its_limits(record, one):
    """Every record's own check refuses it; a limit itself passes."""
    name = one.metadata["called"] or f"{type(record).__name__}.{one.name}"
    if isinstance(record, ModelOptions | RunSettings):
        name = option_of(one, unit=True)
    within, beyond = within_and_beyond(one.metadata)
    for value in within:
        at_limit = copy(record)
        vars(at_limit)[one.name] = value
        check_fields(at_limit)
    for value in beyond:
        said = refused_with(re.escape(f"{name} = "), replace, record, **{one.name: value})
        assert "expected" in said


# --- names that were removed ----------------------------------------------------------------------


def test_no_retired_name_is_an_option():
    taken = {name.replace("_", "-") for name in options_of_a_run()}
    assert not taken & set(RETIRED)


@pytest.mark.parametrize("solver", SOLVERS)
def test_on_a_command_line(solver):
    said = r"--past-collapse; --past-collapse was removed in 0\.2; give"
    refused_with(said, parsed, "--past-collapse", solver)


def test_in_python():
    said = "no option perturb: .*; --perturb was removed in 0.2; members"
    refused_with(said, run, "walls/symmetric.py", perturb=1e-9)


def test_in_a_file_of_an_older_version(monkeypatch):
    @dataclass(frozen=True)
    class Record:
        kept: int = 1

    monkeypatch.setitem(
        RETIRED, "old-field", Retired("--old-field was removed in 9.9; give --kept", 4)
    )
    assert record_from(Record, {"kept": 2, "old_field": 4}) == Record(2)
    with heard() as warnings:
        assert record_from(Record, {"kept": 2, "old_field": 5}) == Record(2)
    assert warnings == [
        "made with old_field = 5 by an older version: --old-field was removed in 9.9; give --kept"
    ]
    refused_with("a later version wrote it", record_from, Record, {"other": 5})
