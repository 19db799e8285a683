"""Evidence for a run: which of its quantities lie outside the range of validity, and where it says
so."""

import json
import re
from dataclasses import replace
from math import atan

import pytest
from conftest import run_here, wall_file

from damage import Floor, Joint, Wall
from damage.applications.report.report import page
from damage.measure.evidence import describe, evidence_for, outside
from damage.measure.pushed import hand_capacities
from damage.measure.tables import summary_row
from damage.rounded import to_bits

SHAKEN = {
    "loading": {"kind": "harmonic", "period_s": 0.2, "amplitude_g": 0.05},
    "sequence": [1.0],
    "rest_s": 1.0,
}
WALL = Wall("w", 2.0, 2.0)
HOUSE = Wall("house", 6.2, 5.6, precompression=0.0, joint=Joint(friction_angle=atan(0.82)))
RESULT = {
    "max_drift_ratio": 0.001,
    "max_offset_mm": 1.0,
    "max_offset_over_overlap": 0.1,
    "collapsed_at_s": None,
    "tension_breaks": 9,
    "shear_breaks": 1,
    "crushed_length_m": 0.0,
    "split_length_m": 0.0,
    "energy_error_fraction": 1e-4,
}
DRY = Joint(tensile_strength=0.0, cohesion=0.0)
RECORD = {"kind": "record", "scale": 1.0, "vertical": None}


def names_outside(wall=WALL, result=(), **parameters):
    found = evidence_for(wall, SHAKEN | parameters, RESULT | dict(result))
    return [name for name, one in found.items() if one["inside"] is False]


def test_a_wall_within_the_evidence_is_inside():
    assert names_outside() == []
    assert names_outside(replace(WALL, joint=DRY, precompression=0.1e6)) == []
    found = evidence_for(WALL, SHAKEN, RESULT)
    assert re.fullmatch(
        r"evidence for this run: inside the range of validity in all 1\d quantities",
        describe(found),
    )


def test_a_house_is_outside_in_four_quantities():
    found = evidence_for(HOUSE, SHAKEN)
    assert outside(found) == [
        "precompression of mortar joints 0 MPa (0.3 to 0.9 MPa)",
        "length 6.2 m (1 to 4.05 m)",
        "height 5.62 m (1 to 2.78 m)",
        "tan(phi) 0.82 (0.42 to 0.63)",
    ]


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("vertical components of the motion", {"loading": RECORD | {"vertical": {"record": "up"}}}),
        ("drift", {"result": {"max_drift_ratio": 0.0031}}),
        ("slip of a joint", {"result": {"max_offset_mm": 10.1}}),
        ("slip over the overlap of the faces", {"result": {"max_offset_over_overlap": 1.01}}),
        ("bricks followed after a fall", {"result": {"collapsed_at_s": 0.5}, "after_fall": True}),
        ("precompression of mortar joints", {"pier_stress_pa": 0.95e6}),
        ("precompression of dry joints", {"wall": replace(WALL, joint=DRY)}),
        (
            "storeys",
            {"wall": replace(WALL, floors=[Floor(1.05, 200.0), Floor(2.025, 200.0)])},
        ),
        ("cohesion of mortar joints", {"wall": replace(WALL, joint=Joint(cohesion=0.1e6))}),
        ("shear failures of brittle joints", {"result": {"tension_breaks": 4, "shear_breaks": 5}}),
        ("split or crushed length", {"result": {"split_length_m": 0.1}}),
        ("period of a harmonic motion", {"loading": SHAKEN["loading"] | {"period_s": 0.05}}),
        ("amplitude of a harmonic motion", {"sequence": [1.0, -2.5]}),
        ("scale of a record", {"loading": RECORD | {"scale": -2.1}}),
        ("rest after the motion", {"rest_s": 0.2}),
        ("energy balance error", {"result": {"energy_error_fraction": 0.011}}),
    ],
)
def test_each_quantity_outside_alone(name, given):
    assert names_outside(**given) == [name]


def test_the_strongest_event_of_a_sequence_of_records_counts():
    motions = [RECORD, RECORD | {"scale": 1.5}]
    events = [{"motion": 0, "rest_s": 1.0}, {"motion": 1, "rest_s": 0.5}]
    found = names_outside(loading=RECORD, motions=motions, events=events, sequence=[1.9, -1.6])
    assert found == ["scale of a record", "rest after the motion"]


def test_a_pushed_wall_whose_mode_one_joint_decides_is_at_the_border():
    """A stepped crack by hand between friction and the full bond of a bed joint."""
    name = "cohesion at which a bed joint slides before steps form"
    joint = Joint(mode_i_fracture_energy=11.0, mode_ii_fracture_energy=209.0)
    push = {"loading": {"kind": "pushover", "boundary": "fixed"}}

    def judged(stress, joint=joint):
        wall = replace(WALL, precompression=stress, joint=joint)
        return evidence_for(wall, push)[name]

    hand = hand_capacities(replace(WALL, precompression=0.3e6, joint=joint), "fixed")
    bond = joint.cohesion * WALL.length * WALL.brick.thickness
    share = 100 * (hand["diagonal"] - hand["sliding_top"]) / bond
    assert 35 < share < 100
    assert judged(0.3e6)["inside"] is False and judged(0.3e6)["value"] == pytest.approx(share)
    assert judged(2e6)["value"] == 0 and judged(2e6)["inside"]
    assert judged(0.3e6, Joint())["inside"] is None
    assert evidence_for(WALL, SHAKEN)[name]["inside"] is None


def test_what_rounding_of_inputs_adds_to_a_limit_is_inside():
    """A push to the limit of 0.3 % ends as far beyond it as its amplitude was rounded up."""
    end = to_bits(0.003)
    assert end > 0.003 * (1 + 4e-9)
    judged = [
        evidence_for(WALL, {"loading": {"kind": "pushover"}}, {**RESULT, "max_drift_ratio": drift})
        for drift in (end, 0.003 * (1 + 2**-24), 0.00300001)
    ]
    assert [one["drift"]["inside"] for one in judged] == [True, True, False]


def test_limits_are_inside_and_what_does_not_apply_is_neither():
    assert names_outside(replace(WALL, length=4.05, joint=Joint(friction_angle=atan(0.63)))) == []
    found = evidence_for(WALL, {"loading": {"kind": "pushover"}})
    assert found["rest after the motion"]["inside"] is found["drift"]["inside"] is None


def test_screen_json_history_tables_and_report_say_it(tmp_path, capsys, monkeypatch, output_of):
    # they take most of a page's time
    for name in ("run_part.still", "run_part.preview", "report.plotly_code"):
        monkeypatch.setattr(
            f"damage.applications.report.{name}", lambda *_: "plotly.js (basic - minified) v0"
        )
    high = "Wall('high', 0.45, 0.9, precompression=0.0, joint=Joint(friction_angle=0.687))"
    wall = wall_file(tmp_path / "w.py", high)
    out = tmp_path / "a.h5"
    history = run_here(out, wall, "--harmonic 0.1 0.05 --cycles 1 --rest 0.2")
    line = (
        "evidence for this run: outside the range of validity (docs/model/validity.md) in 5 of 16"
        " quantities: precompression of mortar joints 0 MPa (0.3 to 0.9 MPa), length 0.45 m (1 to"
        " 4.05 m), height 0.9 m (1 to 2.78 m), tan(phi) 0.82 (0.42 to 0.63), rest after the motion"
        " 0.2 s (1 to 2 s)"
    )
    assert line in capsys.readouterr().out.splitlines()
    shown = json.loads(output_of("index", out, "--json"))
    assert shown["evidence"]["length"] == {
        "value": 0.45,
        "least": 1.0,
        "most": 4.05,
        "unit": "m",
        "inside": False,
    }
    words = line.partition("quantities: ")[2].replace("), ", "); ")
    assert summary_row(history)["outside_validity"] == shown["outside_validity"] == words
    text = page([out], [])
    assert line in text and "<td>0.45 m</td><td>1 to 4.05 m</td><td>outside</td>" in text
    assert "<td>does not apply</td><td>up to 2</td><td></td>" in text
