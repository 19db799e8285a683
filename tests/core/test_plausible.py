"""Values in a wrong unit: found in a wall and a motion where a run begins, and in no wall that is
made in Python."""

from dataclasses import fields, replace

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, parsed, wall_file

from damage import Brick, Floor, Joint, Lintel, Opening, Wall, load_wall
from damage.applications.cracks.plausible import implausible_places
from damage.house.house import Diaphragm, House, Placed
from damage.house.plausible import PER_LENGTH, RANGES, implausible
from damage.house.ties import Ties

SOFTENING = Joint(
    mode_i_fracture_energy=12.0, mode_ii_fracture_energy=120.0, compressive_strength=5e6
)
WALL = Wall(
    "w",
    2.0,
    1.0,
    (Opening(0.5, 0.5, 0.5),),
    brick=Brick(tensile_strength=1e6, fracture_energy="rule"),
    joint=SOFTENING,
    floors=(Floor(1.0, 100.0, right=0.5),),
)
IN_MPA = Wall("w", 2.0, 1.0, joint=Joint(tensile_strength=0.1, cohesion=0.15))


def test_all_records_of_a_wall_and_of_a_house_are_looked_at():
    """How a value is held to its range: `test_fields.py`."""
    house = House("h", (Placed(Wall("w", 2.0, 1.0)),))
    vars(house)["floors"] = (Diaphragm(0.5, ("w",), 100.0),)
    vars(house)["ties"] = (Ties(("w", "w"), 4.0, 1e6, 1e3, 1e3),)
    kinds = {type(one).__name__ for one in (*WALL.records, *house.records)}
    assert {name.partition(".")[0] for name in RANGES} == kinds
    in_mpa = Joint(tensile_strength=0.1, cohesion=0.15)
    assert implausible(replace(WALL, joint=in_mpa, floors=(Floor(1.0, 1.0),)))[-1].startswith(
        f"{PER_LENGTH} = 0.5 kg/m"
    )


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
    "changed, meant",
    [
        ({"joint": Joint(cohesion=150.0)}, "150 kPa is 150e3 Pa"),
        ({"joint": replace(SOFTENING, mode_i_fracture_energy=0.012)}, "0.012 N/mm is 0.012e3"),
        ({"brick": Brick(density=18.6)}, "18.6 kN/m3 is 1896 kg/m3"),
        ({"floors": (Floor(1.0, 0.9),)}, "0.9 t is 0.9e3 kg"),
        ({"length": 300.0}, "300 mm is 300e-3 m, 300 cm is 300e-2 m"),
    ],
)
def test_the_unit_that_was_meant_is_named(changed, meant):
    assert meant in implausible(replace(WALL, **changed))[0]


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


def test_the_component_across_is_held_to_the_same_ranges():
    """It shakes a house: a unit that is wrong in it alone was not noticed."""
    asked = parsed("--record BGAR_HGE --across BGAR_HGN --window 17 27")
    asked.check_plausible(WALL)
    across = asked.loading.across
    too_large = replace(across, acceleration_m_s2=500 * across.acceleration_m_s2)
    wrong = replace(asked, loading=replace(asked.loading, across=too_large))
    assert "PGA of the base motion" in one_line_error(wrong.check_plausible, WALL)
