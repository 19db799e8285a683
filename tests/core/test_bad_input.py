"""Bad input: one clear line, a non-zero status, no file that looks whole.  Each message is tested
once, here: of walls, options and commands, and of the files of studies and cracks; that of records
is in `test_formats.py`.

Both solvers read their input by the same functions, so that most of it is tried in this process, by
the reference solver's command; YADE is started once for each way on which it leaves.
"""

import os
import re
import shutil
import sys
from functools import partial
from pathlib import Path

import pytest
from conftest import REPOSITORY, one_line_error, refused_with, run_command, wall_file, written
from small_history import make_history, small_layout

from damage import Brick, InputError, Joint, ModelOptions, Opening, Wall, load_wall
from damage.__main__ import main
from damage.applications.cracks import crack_mapping
from damage.applications.cracks.crack_file import read_cracks
from damage.applications.cracks.dic import read_field
from damage.applications.studies.definition import load_study
from damage.csv_table import read_csv
from damage.fields import Column
from damage.files import LONGEST_LINE
from damage.linear.modes import natural_modes
from damage.motion.record import Record, band_passed
from damage.reference.session import run_reference
from damage.run.options import make_parser, parse_run
from damage.run.paths import free_name
from damage.run.schedule import check_size, choose_time_step
from damage.wall.layout import lay_out

SYMMETRIC = REPOSITORY / "walls" / "symmetric.py"
RECORD = str(REPOSITORY / "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv")
ADDRESS = str(REPOSITORY / "studies/addresses/garsthuizen.toml")

# --- walls, options and names of a run ------------------------------------------------------------

WALLS = {
    "Wall('w', 2.0, 1.0, [Opening(0.05, 1.0, 0.5)])": "cuts off a pier",
    "Wall('w', 2.0, 1.0, joint=Joint(tensile_strength=0.1))": r"0\.1 MPa is 0\.1e6 Pa",
    "Wall('w', 2.0, 1.0, joint=Joint(friction_angle=32))": "radians",
    "Wall('w', 2.0, -1.0)": r"line \d+: Wall\.height = -1\.0: expected",
    "Wall('w/\\n', 2.0, 1.0)": r"line \d+: Wall\.name = ",
    "Wall('w' * 200, 2.0, 1.0)": "expected up to 100 letters",
    "Wall('w', 2.0, 1.0, openings=3)": r"line \d+: Wall\.openings has 3",
    "Wall('w', 2.0, 1.0, brick=3)": r"line \d+: failed with Attribute",
    "Wall('w', lenght=1, height=1)": r"Wall\(lenght=...\): expected length",
    "Wall('w', 1, 1, joint=Joint(cohesions=1))": r"Joint\(cohesions=...\): expected cohesion",
    "Wall('w', 1, 1, openings=[Opening(left=1, wide=1, height=1)])": (
        r"Opening\(wide=...\): expected "
    ),
    "Wall('w', 1, 1, colour=2)": r"Wall\(colour=...\): expected one of name, length, height",
    "Wall('w', 2.0, 0.975, [Opening(0.5, 1.0, 0.975)])": "reaches from the base to the top",
    "Wall('w', 3.0, 1.0, [Opening(0.5, 1.0, 0.5), Opening(1.55, 0.5, 0.5)])": "another opening",
    "Wall('w', 0.05, 1.0)": "smaller than half a brick",
    "Lintel('stone')": "expected the stone's modulus",
    "Lintel('arch', modulus=1e9)": "expected of a beam alone",
    "Lintel('timber', bearing=0.0)": "Lintel.bearing = 0.0",
    "Opening(0.8, 0.8, 0.8, lintel=3)": "expected Lintel",
    "Opening(0.8, 0.8, 0.8, lintel={'knid': 'timber'})": "expected kind, height",
    "Wall('w', 2.0, 1.0, lintel='wood')": "expected one of concrete",
    "Restraint('left', 'free')": "party wall",
    "Restraint('top', play=0.01)": "but no stiffness",
    "Wall('w', 1, 1, (), 0, restraints=[Restraint('top')])": "top without precompression",
    "Wall('w', 1.0, 1.0, restraints=[Restraint('top', mass=1e6)])": "precompression weighs",
    "Wall('w', 1.0, 1.0, restraints=[Restraint('top')] * 2)": "2 restraints",
    "Wall('w', 1.0, 1.0, restraints=[Opening(0.3, 0.3, 0.3)])": r"expected Restraint\(",
    "Floor(1.0, mass_per_area=60.0)": "tributary_width = None m: expected both",
    "Wall('w', 2.0, 2.4, floors=[Floor(1.0, 800.0, mass_per_area=60.0, tributary_width=2.1)])": (
        "mass = 800 kg, but 60 kg/m2 on 2 x 2.1 m are 252 kg"
    ),
    "Joint(compressive_strength=0.0)": "expected above zero, or None",
    "Joint(compressive_fracture_energy=1e4)": "joints that do not crush",
    "Brick(fracture_energy=30.0)": "bricks without a tensile strength",
    "Joint(mode_i_fracture_energy=5)": "neither for a brittle bond",
    "Joint(mode_ii_fracture_energy=5)": "neither for a brittle bond",
    **{
        f"Joint(mode_i_fracture_energy=5, mode_ii_fracture_energy=50, tensile_strength={given})": (
            "both above zero"
        )
        for given in (0, 1e6)
    },
    "wall()": r"line \d+: failed with RecursionError",
    "None": r"no function wall\(\)",
}
"""{what wall() returns: complaint}"""
WALL_FILES = {
    "x = 1\ndef wall(:\n": "wall.py line 2: failed with SyntaxError: invalid syntax",
    "if 1:\n\tx = 1\n        y = 2\n": "wall.py line 3: failed with TabError",
    "x = 1\0\n": "null bytes",
    "import no_such_library\n": "line 1: failed with ModuleNotFoundError",
    "def wall():\n    x = 1\n    raise KeyError('a\\x1b[31mb\\nc')\n": (
        "line 3: failed with KeyError"
    ),
    "import sys\nsys.exit('bye')\n": "line 2: failed with SystemExit: bye",
    "x = 1\n": r"no function wall\(\)",
    "wall = 3\n": r"no function wall\(\)",
}
"""{text of a wall's file: complaint}"""
OPTIONS = {
    "--harmonix 0.2 0.05": "did you mean --harmonic",
    "--recrod=a.csv": "did you mean --record",
    "--record no_such_file.csv": "no_such_file.csv",
    "--record BGAR_HGE --window 6 5": "expected 0 <= start < end",
    "--record BGAR_HGE --scale 1000": "base motion of up to .* up to 100 g",
    "--dt 1e-9": r"in 3.1e\+09 steps .* up to 1e\+08 steps",
    "--dt 4.6e-5": "above the stable time step",
    "--harmonic 0.2 49": "PGA of the base motion = 49 g.*--accept-implausible",
    "--harmonic 0.2 1 --sequence 1,-1000": r"base motion of up to 1e\+03 g",
    "--harmonic 0.2 0.05 --free-vibration": "choose one",
    "--scale 2": "--scale",
    "--cyclic 0.1;0.2": "commas",
    "--cyclic " + ",".join(2000 * ["0.1"]): "2000 drifts",
    "--cyclic 20 --cycles 1000 --speed 0.001": "a run of .* up to 2000 s",
    "--boundary fixed": "--boundary",
    "--lintel granite": "granite",
    "--new-contacts": "bricks whose joints have ended collide in YADE",
    "--settle hoging": "expected one of hogging, sagging, tilt, knick, or a CSV file",
    "--settle hogging --distortion one": "expected a number, or a fraction like 1/500",
    "--distortion 1/500": "--distortion belongs to --settle",
    "--footing 0.6": "--footing = 0.6 without --soil",
    "--rayleigh 2 5 20": "ratio from 0 to 1",
    "--rayleigh 0.02 20 5": "rising",
    "--rayleigh 0.02 5 20 --beta 1e-6": "choose one",
    "--pushover 0.1 --rayleigh 0.02 5 20": "--rayleigh with a pushed top",
    "--mass-scaling selective --relaxation local": "--relaxation local",
    "--mass-scaling selective --settling local": "--settling local",
    "--tolerance-mm 10": "--tolerance-mm belongs to --cracked",
    "--unit g": "--unit belongs to --record",
    "--free-vibration --sequence 1,1": "--sequence belongs to",
}


def assert_refused(status, out, err, complaint, folder):
    """One line that names the trouble, a status that is not zero, nothing left behind."""
    assert status == 2, out + err
    errors = [line for line in err.splitlines() if line.startswith("error:")]
    assert len(errors) == 1, out + err
    assert re.search(complaint, errors[0]), errors[0]
    assert "Traceback" not in err + out
    assert not list(folder.rglob("*.h5")), "a history was left behind"


@pytest.fixture
def refused(capsys, tmp_path):
    """refused(complaint, WALL, *words): holds the reference solver's run to its refusal."""

    def run(complaint, *words):
        status = run_reference([str(word) for word in words])
        assert_refused(status, *capsys.readouterr(), complaint, tmp_path)

    return run


@pytest.mark.parametrize("wall", WALLS)
def test_bad_wall(wall, refused, tmp_path):
    refused(WALLS[wall], wall_file(tmp_path / "wall.py", wall), "--out", tmp_path / "out.h5")


@pytest.mark.parametrize("text", WALL_FILES)
def test_a_wall_file_that_fails_is_reported_with_its_line(text, refused, error_of, tmp_path):
    path = written(tmp_path / "wall.py", text)
    refused(WALL_FILES[text], path, "--out", tmp_path / "out.h5")
    assert re.search(WALL_FILES[text], error_of("modes", path))


@pytest.mark.parametrize("words", OPTIONS)
def test_bad_option(words, refused, tmp_path):
    refused(OPTIONS[words], SYMMETRIC, *words.split(), "--out", tmp_path / "out.h5")


def test_folder_that_cannot_be_written(refused, tmp_path):
    blocked = tmp_path / "blocked"
    if os.geteuid() == 0:  # root writes everywhere but below a file
        blocked.write_text("a file, not a folder")
    else:
        blocked.mkdir(mode=0o500)
    refused("cannot write|choose another", SYMMETRIC, "--out", blocked / "out.h5")


def test_output_that_is_there_already(refused, tmp_path_factory):
    folder = tmp_path_factory.mktemp("earlier")
    out = written(folder / "out.h5", b"of an earlier run")
    refused("--overwrite", SYMMETRIC, "--out", out)
    assert out.read_bytes() == b"of an earlier run"
    refused("is a folder", SYMMETRIC, "--out", folder)
    (folder / "first").mkdir()
    written(folder / "first" / "wall.png", b"of another run")
    refused("the pictures of first.h5 would go there", SYMMETRIC, "--out", folder / "first.h5")


@pytest.mark.parametrize(
    "name",
    ["first", ".h5", "first.h5.txt", "first.H5"],
)
def test_a_name_that_no_history_can_have(name, refused):
    refused(r"expected a name that ends in \.h5", SYMMETRIC, "--out", name)


@pytest.mark.yade
def test_what_yade_cannot_do(yade_command, tmp_path):
    done = yade_command(SYMMETRIC, "--bricks deformable --out", tmp_path / "out.h5")
    complaint = "--bricks deformable: YADE moves rigid bodies"
    assert_refused(done.returncode, done.stdout, done.stderr, complaint, tmp_path)


# --- commands -------------------------------------------------------------------------------------

COMMANDS = {
    "index --thresholdmm 0.1 a.h5": "did you mean --threshold-mm? see --help",
    "--quite index": "did you mean --quiet? see --help",
    "help indx": "did you mean index?",
    "tables run a.h5 b.h5 --out stem": "tables run of 2 histories: expected one",
    "reference -\x1b[31m": "\\x1b",
    "no\x1bsuch": "\\x1b",
    "index x.h5 --a\x9b2J": "\\x9b",
    "export H --vtkhdf H": "expected another file",
    "tables summary H --out H": "expected another file",
}
"""{words of a command, with a history H and a wall W: complaint}"""
NAMES = {
    "x" * 300: "a name of 300 bytes",
    "é" * 200: "a name of 400 bytes",
    "x/" * 4000: "File name too long",
    "a\x1b[31m": "a\\x1b[31m",
    "a\nb": "a\\nb",
    "a\udcff": "a\\udcff",
}
"""{name that no file can have, or that would garble a terminal: what is said of it}"""
WITH_NAMES = (
    "index ?",
    "record ?",
    "modes ?",
    "plot H --out ?",
    "tables summary H --out ?",
    "study-tables ? x",
    "reference ?",
    "reference W --record ?",
    "reference W --out ?",
    "cracks --dic ? --wall W",
)


def filled(template, files, value=""):
    """The words of a command, with paths in place of capitals and a value in place of ?."""
    return [files.get(word, word).replace("?", value) for word in template.split()]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    make_history(folder / "h.h5")
    wall_file(folder / "W.py", "Wall('small', 0.9, 0.45)")
    (folder / "C").write_text("crack,point,x_m,z_m,width_mm\n1,1,0.1,0.075,1\n1,2,0.3,0.075,1\n")
    names = {"H": "h.h5", "W": "W.py"} | {name: name for name in "CFOS"}
    return {letter: str(folder / name) for letter, name in names.items()} | {
        "R": RECORD,
        "A": ADDRESS,
    }


@pytest.mark.parametrize("template", COMMANDS)
def test_a_mistaken_command(template, files, error_of, monkeypatch):
    monkeypatch.chdir(REPOSITORY)
    read = SYMMETRIC, *(Path(files[letter]) for letter in "HW")
    before = [path.read_bytes() for path in read]
    assert COMMANDS[template] in error_of(*filled(template, files))
    assert [path.read_bytes() for path in read] == before


@pytest.mark.parametrize("name", NAMES, ids=ascii)
@pytest.mark.parametrize("template", WITH_NAMES)
def test_names_that_no_file_can_have(name, template, files, error_of):
    assert NAMES[name] in error_of(*filled(template, files, name))


def test_a_long_name_of_a_run_is_cut(tmp_path, monkeypatch):
    """Its record's name, factors and model make a default name of over 255 bytes: two runs of one
    start differ."""
    factors = ["1" + k * ",0.125" for k in (80, 81)]
    names = [
        free_name(
            small_layout().wall,
            parse_run(["--sequence", words, "--rest", "0"], "test", "reference"),
            "reference",
            tmp_path,
        ).name
        for words in factors
    ]
    assert len(set(names)) == 2 and all(len(os.fsencode(name)) < 220 for name in names)


# --- values that are zero, negative, infinite, none, huge -----------------------------------------

ODD = ("0", "-1", "inf", "nan", "1e-300", "1e300", "1000000000", 5000 * "9", "", "abc", "0.5")
RUN = {
    "--harmonic ? 0.05": "0.5",
    "--harmonic 0.2 ?": "0 1e-300 0.5",
    "--cycles ?": "",
    "--record R --scale ?": "0 -1 1e-300 0.5",
    "--record R --sample-step ?": "",
    "--cracked C --tolerance-mm ?": "0.5",
    "--record R --window ? 5": "0 1e-300 0.5",
    "--record R --baseline ?": "0",
    "--record R --band ? 10": "0.5",
    "--sequence 1,?": "0 -1 1e-300 0.5",
    "--pushover ?": "0.5",
    "--cyclic 0.1,?": "0.5",
    "--pushover 0.1 --speed ?": "0.5",
    "--pushover 0.1 --floor-share ? 1": "",
    "--pushover 0.1 --damping ?": "0 1e-300 0.5",
    "--cells ?": "",
    "--strength-cov ?": "0 1e-300 0.5",
    "--strength-seed ?": "0 1000000000",
    "--beta ?": "0 1e-300",
    "--rayleigh ? 5 20": "0 1e-300 0.5",
    "--rayleigh 0.02 ? 20": "0.5",
    "--scatter ?": "0 1e-300",
    "--soil ?": "1000000000",
    "--soil 1e8 --soil-shear ?": "0.5",
    "--soil 1e8 --footing ?": "0.5",
    "--pushover 0.1 --top-rotation ?": "0 1e-300 1000000000 0.5",
    "--settle hogging --distortion ?": "",
    "--checkpoint ?": "0.5",
    "--address A --life ?": "1000000000",
    "--bricks deformable --brick-damping ?": "0 1e-300 0.5",
    "--brick-damping ?": "",
    "--seed ?": "0 1000000000",
    "--rest ?": "0 1e-300 0.5",
    "--dt ?": "",
    "--members ?": "",
    "--units ? 2": "",
}
"""{words of a run, ? the value: which of ODD go}; all others are refused before anything is
begun."""
OF_COMMANDS = {
    "index H --threshold-mm ?": "0.5",
    "cracks H --at ?": "0 1e-300",
    "cracks C --wall W --tolerance-mm ?": "0.5",
    "modes W --cells ?": "",
    "fragility F --out O --replicates ?": "",
}
"""Commands and what is refused, with files that are there, or are looked for after the options (F,
O, S)."""


def that_go(function, complaint_of):
    """Values of ODD with which `function(value)` does not complain; of the others one line is held
    to what it says."""
    complaints = {value: complaint_of(function, value) for value in ODD}
    for said in filter(None, complaints.values()):
        assert "\n" not in said and re.search(r"expected|invalid|choose|stable", said)
    return " ".join(value for value, said in complaints.items() if said is None)


@pytest.fixture
def complaint_of(capsys):
    """What the InputError says that a call raises, or a command prints; None where there is
    none."""

    def run(function, value):
        try:
            return capsys.readouterr().err.removesuffix("\n") if function(value) else None
        except InputError as error:
            return str(error)

    return run


def prepare(words, solver="reference"):
    """All that is looked at before a run begins."""
    settings = parse_run(words, "test", solver)
    layout = lay_out(small_layout().wall, settings.model)
    check_size(
        settings, layout, choose_time_step(settings, natural_modes(layout).critical_time_step_s)
    )


@pytest.mark.parametrize("template", RUN)
def test_odd_values_of_options(template, files, complaint_of):
    assert (
        that_go(lambda value: prepare(filled(template, files, value)), complaint_of)
        == RUN[template]
    )


@pytest.mark.parametrize("solver", ["reference", "yade"])
def test_every_number_on_a_command_line_is_tried(solver):
    """An option that is added without a row above fails here: it might accept NaN."""
    tried = {word for template in RUN for word in template.split() if word.startswith("--")}
    numbers = {
        option
        for action in make_parser("test", solver)._actions
        for option in action.option_strings
        if action.type in {int, float} or getattr(action.type, "__name__", "") in {"int", "float"}
    }
    assert numbers - tried == set() and len(numbers) > 15


@pytest.mark.parametrize("template", OF_COMMANDS)
def test_odd_values_of_commands(template, files, complaint_of):
    assert (
        that_go(lambda value: main(filled(template, files, value)), complaint_of)
        == OF_COMMANDS[template]
    )


def test_walls_and_records_that_cannot_be_computed():
    assert "48000000 bricks" in one_line_error(Wall, "w", 900.0, 900.0)
    assert "contact points" in one_line_error(lay_out, Wall("w", 20.0, 6.0), ModelOptions(cells=16))
    bricks = Brick(young_modulus=1e20, shear_modulus=1.0)
    stiff = Wall(
        "w", 4.0, 3.0, brick=bricks, joint=Joint(normal_stiffness=1e20, shear_stiffness=1.0)
    )
    assert "no natural modes" in one_line_error(natural_modes, lay_out(stiff))
    assert "outside" in one_line_error(Wall, "w", 2.0, 1.0, [Opening(1.5, 1.0, 0.5)])
    assert "0.001 <= low" in one_line_error(band_passed, Record("r", 1e-5, 2000 * [1.0]), 1e-4, 1e4)


# --- walls as data --------------------------------------------------------------------------------

GOOD = {
    "name": '"house"',
    "length": "4.4",
    "height": "4.2",
    "precompression": "0",
    "masonry": '{ material = "clay-standard", format = "waalformaat" }',
    "outline": "[[0, 2.7], [2.2, 4.2], [4.4, 2.7]]",
}
DOOR = "[[openings]]\nleft = 1.1\nwidth = 1.1\nheight = 2.1\n"
FLOOR = "[[floors]]\nlevel = 2.7\n"
MISTAKES = [
    (
        "masonry",
        '{ material = "clay-standart", format = "waalformaat" }',
        r"one of .* did you mean clay-standard\?",
    ),
    ("masonry", '{ material = "clay", format = "brick" }', "format 'brick': expected one of waal"),
    ("masonry", '{ material = "clay", format = "waalformaat" }', "give tensile_strength="),
    (
        "masonry",
        '{ material = "clay-weak", format = "waalformaat", mortar = 10 }',
        r"mortar \[m\] = 10: expected a number from 0 to 0.05",
    ),
    (
        "masonry",
        '{ material = "clay-weak", format = "waalformaat", wythes = 1.5 }',
        "whole number from 1",
    ),
    ("masonry", '{ material = "clay-weak" }', "give one of these"),
    ("+", "[brick]\nlength = 0.2", "leave one out"),
    ("outline", "[[0.5, 2.7], [2.2, 4.2], [4.4, 2.7]]", "the first at x = 0"),
    ("outline", "[[0, 2.7], [2.2, 4.2]]", "the last at x = 4.4 m"),
    ("outline", "[[0, 2.7], [3.2, 4.2], [2.2, 3], [4.4, 2.7]]", "from left to right"),
    ("height", "3.9", "Wall.height = 3.9 m at the highest point"),
    ("outline", "[2.7, 4.2, 2.7]", r"expected points \(x, z\)"),
    ("outline", "[[0, -1], [2.2, 4.2], [4.4, 2.7]]", "expected 0 or more"),
    ("precompression", "0.1e6", "masses by Wall.floors"),
    (
        "+",
        "[[openings]]\nleft = 2.2\nwidth = 1.54\nheight = 0.6\nsill = 2.7",
        "has nothing below it",
    ),
    ("+", "[[floors]]\nlevel = 9\nmass = 100", "expected a level with a course below it"),
    ("+", f"{FLOOR}mass = 100\nleft = 4.35", "expected half a brick"),
    ("+", f"{FLOOR}mass = 100\nright = 9", "correct left and right"),
    (
        "+",
        f"{DOOR}[[floors]]\nlevel = 1.2\nmass = 9\nleft = 1.2\nright = 2",
        "has no brick below it",
    ),
    (
        "+",
        f'{DOOR}[[floors]]\nlevel = 1.2\nmass = 9\nleft = 1.2\nright = 3\nkind = "concrete"',
        "has nothing below it",
    ),
    ("+", 2 * '[[floors]]\nlevel = 2.4\nmass = 900\nkind = "concrete"\n', "floors apart"),
    ("+", f'{FLOOR}mass = 100\nkind = "steel"', "expected one of timber, concrete"),
    ("+", FLOOR, "without a mass: expected mass"),
    ("+", 1001 * f"{FLOOR}mass = 900\n", "1001 floors: expected up to 1000"),
    ("+", f"{FLOOR}levl = 2.7", r"did you mean level\?"),
    ("+", "[floors]\nlevel = 2.7\nmass = 100", "double the brackets"),
    ("length", '"4.4 m"', "Wall.length = '4.4 m': expected a number"),
    ("lintel", "{ hight = 0.2 }", "did you mean height"),
    (
        "masonry",
        '{ material = "clay-weak", format = "rijnvorm", cohesoin = 1 }',
        "cohesoin",
    ),
    ("joint", "{ friction = 0.5, friction_angle = 0.5 }", "leave one out"),
    ("joint", '{ friction = "high" }', "friction = 'high'"),
    ("joint", '{ mode_i_fracture_energy = "rul" }', "mode_i_fracture_energy = 'rul'"),
    ("joint", '{ compressive_fracture_energy = "rule" }', r"compressive_strength=\.\.\."),
    (
        "joint",
        '{ mode_i_fracture_energy = "rule", tensile_strength = 0 }',
        r"tensile_strength=\.\.\.",
    ),
    (
        "masonry",
        "{ young_modulus = 4.9e9 }\nbrick.shear_modulus = 2e9",
        "shear_modulus beside",
    ),
    ("masonry", '{ young_modulus = "stiff" }', r"young_modulus of masonry .* = 'stiff'"),
    ("masonry", "{ young_modulus = 4.9e9, mortar = 0.01 }", r"beside \[brick\] and \[joint\]"),
    ("masonry", "{ young_modulus = 4.9e12 }", "softer"),
    ("length", None, "lacks length"),
    ("name", "house", "no TOML .* line 1"),
]


def house(folder, key="+", value=""):
    """The path of a wall as TOML: GOOD with another value, without it if that is None; "+" is
    written behind."""
    table = GOOD | ({} if key == "+" else {key: value})
    lines = [f"{name} = {given}" for name, given in table.items() if given is not None]
    return written(
        folder / "house.toml", "\n".join([*lines, value if key == "+" else ""]), encoding="utf-8"
    )


@pytest.mark.parametrize("key, value, message", MISTAKES, ids=lambda one: str(one)[:40])
def test_a_mistake_in_a_wall_as_data(key, value, message, tmp_path):
    assert load_wall(house(tmp_path)).name == "house"
    assert "expected" in refused_with(message, load_wall, house(tmp_path, key, value))


# --- files of studies, tables and cracks ----------------------------------------------------------

HEAD = "crack,point,x_m,z_m,width_mm\n"
CRACKS = {
    HEAD + "a,1,0,0,1\na,2,20000,20000,1\n": "line 3: x_m = 20000: expected -1000 to 1000",
    HEAD + "a,1,0,0,1e300\na,2,1,0,1\n": "line 2: width_mm = 1e300: expected 0 to 10000",
    HEAD
    + "".join(f"a{k},1,0,{k},1\na{k},2,900,{k},1\n" for k in range(20)): "cracks of 18000 m in all",
    HEAD + "a,1,0,0,1\na,2,0.": "line 3: 3 cells",
    HEAD + "\x1b[31m,2,0,0,1\n": "crack \\x1b[31m",
    "crack,point,x_m,z_m,width_mm,load_level\n"
    + "".join(f"a,1,0,0,1,{k}\na,2,1,0,1,{k}\n" for k in range(1001)): "1001 load levels",
    HEAD + "a,1,0,0,1\n" * 20_000 + "a,2,1,1,1\n": "20001 rows",
}
ONE_RUN = '[[runs]]\nwall = "walls/solid.py"\n'
OF_RECORD = f'name = "s"\n{ONE_RUN}options = {{{{ record = ["{{0}}", "{{0}}.csv"] }}}}\n'
GRID = (
    'name = "g"\n[[grid]]\nwall = "walls/solid.py"\noptions = {{ harmonic = ["{{a}}", "{{b}}"]'
    " }}\nvary = {{ {} }}\n"
)
DEEP = "[" * 200 + "1" + "]" * 200, "{a=" * 200 + "1" + "}" * 200
STUDIES = {
    GRID.format(
        "a = { from = 1, to = 1000000000 }, b = [0.1]"
    ): "stands for 100001 runs; expected up to 100000",
    GRID.format(
        "a = { from = 1, to = 1000 }, b = { from = 1, to = 1000 }"
    ): "stands for 1000000 runs",
    f'name = "g"\n{ONE_RUN}members = 1000000000\n': (
        "members = 1000000000: expected a whole number, 1 to 10000"
    ),
    f'name = "g"\n{ONE_RUN}samples = 0\noptions = {{ strength-cov = 0.3 }}\n': (
        "samples = 0: expected a whole number, 1 to"
    ),
    f'name = "g"\n{ONE_RUN}id = "{"x" * 300}"\n': "at most 120 letters",
    f'name = "g"\n{ONE_RUN}id = "a\\u001b"\n': "a\\x1b",
    'name = "g"\n[[runs]]\nwall = "a\\u001b[31m"\n': "a name without control characters",
    f'name = "g"\n[[runs]]\nwall = "{"x" * 300}"\n': "a name of 300 bytes",
    f'name = "s"\n[[runs]]\nwall = "{"x/" * 3000}"\n': "no file",
    OF_RECORD.format("x" * 300): "expected up to 255",
    OF_RECORD.format("x/" * 3000): "no file",
    "a = " + "[" * 5000: "no TOML",
    # Python's own recursion ended it while it was reported
    **{f"[[grid]]\nvary = {deep}\n": "more than 20 deep" for deep in DEEP},
    **{f"name = {deep}\n": "more than 20 deep" for deep in DEEP},
    **{f"[[runs]]\noptions = {deep}\n": "more than 20 deep" for deep in DEEP},
}
OF_RECORDS = {"record;scale\nBGAR_HGE;1,5\n": "unknown column 'scale'; expected any of record"}
FIELDS = {
    # pandas takes such a cell for a number, Python does not
    "x_m,z_m,ux_m,uz_m\n0.\0,0,0,0\n": "holds a zero byte",
    "time_s,acc_m_s2\n" + "1," * LONGEST_LINE: "100000",
    "1," * LONGEST_LINE: "100000",
}
READERS = [
    (read_cracks, CRACKS),
    (partial(load_study, solver="reference", root=REPOSITORY), STUDIES),
    (partial(read_csv, columns={"record": Column("", "")}), OF_RECORDS),
    (read_csv, {'a,b\n"0\n",1\n1,2,3\n': "line 4: 3 cells; expected 2"}),
    (read_field, FIELDS),
]


@pytest.mark.parametrize(
    ("read", "text", "said"),
    [(read, text, said) for read, table in READERS for text, said in table.items()],
    ids=lambda value: value[:50] if isinstance(value, str) else "",
)
def test_a_file_of_a_study_or_of_cracks_that_is_refused(read, text, said, tmp_path):
    assert said in one_line_error(read, written(tmp_path / "given", text))


def test_a_long_crack_is_mapped_as_one_piece_would_be(tmp_path, monkeypatch):
    """Across the whole wall and far beyond it, in parts of 0.1 m and at once."""
    (tmp_path / "long.csv").write_text(
        HEAD + "a,1,-2.05,-1,1\na,2,3.1,1.52,1\nb,1,-0.5,0.0751,1\nb,2,1.4,0.0751,1\n"
    )
    (pattern,) = read_cracks(tmp_path / "long.csv")
    in_parts = crack_mapping.map_cracks(pattern, small_layout())
    monkeypatch.setattr(crack_mapping, "_CHUNK", 10**9)
    at_once = crack_mapping.map_cracks(pattern, small_layout())
    assert in_parts.table.equals(at_once.table) and len(in_parts.table) > 5
    assert in_parts.unmapped_m == at_once.unmapped_m > 1


def test_a_byte_order_mark_is_no_part_of_a_study_and_another_encoding_is_refused(tmp_path):
    path = tmp_path / "study.toml"
    text = f'name = "marked"\n{ONE_RUN}'
    path.write_text("\ufeff" + text, encoding="utf-8")
    assert load_study(path, "reference", REPOSITORY).name == "marked"
    path.write_text(text, encoding="utf-16")
    assert "no TOML in UTF-8" in one_line_error(load_study, path, "reference", REPOSITORY)
    with path.open("w") as file:
        file.truncate(10**12)  # a hole
    assert "1e+06 MB" in one_line_error(load_study, path, "reference", REPOSITORY)


# --- what may not be read, and what is missing ----------------------------------------------------


@pytest.mark.parametrize(
    ("library", "template"),
    [
        ("numpy", "index x.h5"),
        ("numba", "reference w.py"),
        ("matplotlib", "plot H --out o"),
        ("jinja2", "report H"),
    ],
)
def test_a_missing_library_is_named(library, template, files, damage_command, tmp_path):
    missing = f"raise ModuleNotFoundError('none here', name={library!r})"
    written(tmp_path / f"{library}.py", missing)
    path = os.pathsep.join([str(tmp_path), str(REPOSITORY)])
    environment = {**os.environ, "PYTHONPATH": path}
    done = damage_command(*filled(template, files), cwd=tmp_path, env=environment)
    assert done.returncode == 3 and len(done.stderr.splitlines()) == 1, done.stderr
    assert (
        f"cannot import {library}: expected Debian's package python3-{library}, or pip install"
        in done.stderr
    )


def test_compiled_code_finds_a_place_where_none_can_be_written(tmp_path):
    """The folder beside the sources, the home folder's and numba's own are files."""
    package = tmp_path / "damage"
    file = tmp_path / "file"
    shutil.copytree(
        REPOSITORY / "damage", package, ignore=shutil.ignore_patterns("__pycache__", "data")
    )
    for path in (file, package / "mechanics" / "__pycache__"):
        path.touch()
    code = (
        "import numba, os, damage.mechanics.step as k; print(k.__file__, numba.config.CACHE_DIR,"
        " os.path.isdir(numba.config.CACHE_DIR))"
    )
    odd = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR"), str(file))
    done = run_command(
        sys.executable,
        "-c",
        code,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path), **odd},
    )
    assert done.returncode == 0, done.stderr
    source, folder, there = done.stdout.split()
    assert source.startswith(str(tmp_path)) and there == "True"
    assert len(done.stderr.splitlines()) == 1 and "warning: no folder can be written" in done.stderr
    assert not os.path.exists(folder)
