"""Values in a wrong unit: found in a wall and a motion where a run begins, and in no wall that is
made in Python."""

from dataclasses import fields, replace

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, parsed, wall_file, written

from damage import Brick, Floor, Joint, Lintel, Opening, Wall, load_wall
from damage.__main__ import main
from damage.applications.cracks.plausible import implausible_places
from damage.house.house import Diaphragm, House, Placed
from damage.house.plausible import PER_LENGTH, RANGES, implausible
from damage.house.ties import Ties
from damage.motion.formats import shipped_record_path

SOFTENING = Joint(
    mode_i_fracture_energy=12.0, mode_ii_fracture_energy=120.0, compressive_strength=5e6
)
SPLITTING = Brick(tensile_strength=1e6, fracture_energy="rule")
WALL = Wall(
    "w",
    2.0,
    1.0,
    (Opening(0.5, 0.5, 0.5),),
    brick=SPLITTING,
    joint=SOFTENING,
    floors=(Floor(1.0, 100.0, right=0.5),),
)
HOUSE = {"Diaphragm": Diaphragm(0.5, ("w",), 100.0), "Ties": Ties(("w", "w"), 4.0, 1e6, 1e3, 1e3)}
PARTS = {"Brick": "brick", "Joint": "joint", "Lintel": "lintel"}
IN_MPA = Wall("w", 2.0, 1.0, joint=Joint(tensile_strength=0.1, cohesion=0.15))


def with_value(name, value):
    """The wall with a value in a field, "Joint.cohesion", past the checks of what can be
    computed."""
    record, field = name.split(".")
    if record in HOUSE:
        one = replace(HOUSE[record])
        vars(one)[field] = value
        house = House("h", (Placed(Wall("w", 2.0, 1.0)),))
        vars(house)["ties" if record == "Ties" else "floors"] = (one,)
        return house
    lists = {"Opening": "openings", "Floor": "floors"}
    changed = (
        WALL
        if record == "Wall"
        else getattr(WALL, lists[record])[0]
        if record in lists
        else getattr(WALL, PARTS[record])
    )
    changed = replace(changed)
    vars(changed)[field] = value
    if record == "Wall":
        return changed
    wall = replace(WALL)
    vars(wall)[lists.get(record) or PARTS[record]] = (changed,) if record in lists else changed
    return wall


@pytest.mark.parametrize("name", [name for name in RANGES if name != PER_LENGTH])
def test_each_field_is_held_to_its_range(name):
    least, most, unit, *_ = RANGES[name]

    def said_of(value):
        return [
            line for line in implausible(with_value(name, value)) if line.startswith(f"{name} = ")
        ]

    for value in (least, np.sqrt(least * most), most):
        assert said_of(value) == []
    for value in (least / 1.01, most * 1.01):
        (message,) = said_of(value)
        assert f" {unit}, expected " in message
    # no wrong unit makes it; where it cannot be, it is refused before
    assert implausible(with_value(name, 0.0)) == []


def test_every_number_of_a_wall_but_places_has_a_range():
    numbers = {
        f"{kind.__name__}.{one.name}"
        for kind in (Wall, Opening, Floor, Lintel, Brick, Joint, Diaphragm, Ties)
        for one in fields(kind)
        if "float" in str(one.type) and "tuple" not in str(one.type)
    }
    assert numbers | {PER_LENGTH} == {
        *RANGES,
        "Opening.left",
        "Opening.sill",
        "Floor.left",
        "Floor.right",
        "Diaphragm.anchor_spacing",
    }


@pytest.mark.parametrize(
    "name, value, meant",
    [
        ("Joint.cohesion", 150.0, "150 kPa is 150e3 Pa"),
        ("Joint.mode_i_fracture_energy", 0.012, "0.012 N/mm is 0.012e3"),
        ("Brick.density", 18.6, "18.6 kN/m3 is 1896 kg/m3"),
        ("Floor.mass", 0.9, "0.9 t is 0.9e3 kg"),
        ("Wall.length", 600.0, "600 mm is 600e-3 m, 600 cm is 600e-2 m"),
    ],
)
def test_the_unit_that_was_meant_is_named(name, value, meant):
    assert meant in implausible(with_value(name, value))[0]


HOLED = Wall("holed", 4.0, 3.0, (Opening(1.0, 1.2, 1.2, 0.9),), precompression=0.0)
DRAWN = np.array([[(1.0, 2.1), (0.6, 2.6)], [(2.2, 2.1), (2.7, 2.7)], [(0.0, 0.3), (3.9, 0.3)]])
"""From the upper corners of an opening upwards, and along a bed joint below it."""


@pytest.mark.parametrize(
    ("given", "off"),
    [(DRAWN, False), (100 * DRAWN, True), (DRAWN - (0, 3), True), (DRAWN[:0], False)],
)
def test_cracks_beside_the_wall(given, off):
    said = implausible_places(given, HOLED)
    assert (said is not None) == off
    assert not off or "x from its left end and z up from its base" in said


SHIPPED = [
    REPOSITORY / "examples/two_windows.py",
    *sorted(
        path
        for path in (REPOSITORY / "walls").glob("**/*.*")
        if path.suffix == ".toml" or (path.suffix == ".py" and "def wall()" in path.read_text())
    ),
]


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_walls_that_ship_are_plausible(path):
    assert implausible(load_wall(path)) == []


@pytest.mark.parametrize(
    "words, says",
    [
        (
            "--harmonic 0.2 5",
            (
                "--harmonic AMPLITUDE_G = 5 g, expected 0.0001 to 2 g: 5 % is 5e-2 g, 5 m/s2 is"
                " 0.5097 g"
            ),
        ),
        (
            "--harmonic 200 0.05",
            "--harmonic PERIOD_S = 200 s, expected 0.01 to 10 s: 200 ms is 200e-3 s",
        ),
        ("--record BGAR_HGE --scale -0.001", "--scale = -0.001, expected 0.01 to 100."),
        ("--record BGAR_HGE --sequence 0,0", "BGAR_HGE_x1: the base stands still"),
        ("--cyclic 0.1,25", "--pushover, --cyclic = 25 %, expected 0.0001 to 20 %"),
        ("--harmonic 0.2 1 --sequence 0.1,-6", "PGA of the base motion = 6 g"),
    ],
)
def test_a_motion_beyond_the_ranges_is_refused_unless_it_is_accepted(words, says):
    said = one_line_error(parsed(words).check_plausible, WALL)
    assert says in said and "--accept-implausible" in said
    parsed(f"{words} --accept-implausible").check_plausible(IN_MPA)


def test_usual_motions_and_a_pause_are_plausible():
    for words in (
        "",
        "--harmonic 0.2 2",
        "--record BGAR_HGE --scale -3 --sequence 1,0,-0.5",
        "--free-vibration",
        "--cyclic 0.025,0.05,2",
        "--settle hogging",
    ):
        parsed(words).check_plausible(WALL)


def test_modes_refuses_a_wall_unless_it_is_accepted(tmp_path, error_of, output_of):
    wall = "Wall('w', 0.45, 0.15, joint=Joint(tensile_strength=0.1, cohesion=0.15))"
    path = wall_file(tmp_path / "wall.py", wall)
    assert "0.15 MPa is 0.15e6" in error_of("modes", path)
    assert "mode 1" in output_of("modes", path, "--accept-implausible")


def test_a_record_in_gal_is_warned_of(tmp_path, capsys):
    rows = shipped_record_path().read_text().splitlines()
    in_gal = [
        f"{time},{100 * float(value)}"
        for time, value in (row.split(",") for row in rows if not row.startswith(("#", "time")))
    ]
    path = written(tmp_path / "gal.csv", "\n".join(["time_s,acc_m_s2", *in_gal]))
    assert main(["record", str(path)]) == 0
    assert "cm/s2 (gal) where m/s2 is expected" in capsys.readouterr().err
    assert main(["record", "BGAR_HGE", "--scale", "250"]) == 0
    assert (
        "warning: --scale = 250, expected 0.01 to 100: 250 % is 250e-2\n" in capsys.readouterr().err
    )


def test_the_component_across_is_held_to_the_same_ranges():
    """It shakes a house: a unit that is wrong in it alone was not noticed."""
    asked = parsed("--record BGAR_HGE --across BGAR_HGN --window 17 27")
    asked.check_plausible(WALL)
    across = asked.loading.across
    too_large = replace(across, acceleration_m_s2=500 * across.acceleration_m_s2)
    wrong = replace(asked, loading=replace(asked.loading, across=too_large))
    assert "PGA of the base motion" in one_line_error(wrong.check_plausible, WALL)
