"""Bad input: one clear line, a non-zero status, no file that looks whole.  Each message is tested
once, here.

Both solvers read their input by the same functions, so that most of it is tried in this process, by
the reference solver's command; YADE is started once for each way on which it leaves.
"""

import os
import re

import pytest
from conftest import REPOSITORY, one_line_error, refused_with, wall_file, written
from small_history import make_history, small_layout

from damage.__main__ import main
from damage.errors import InputError
from damage.law.modes import natural_modes
from damage.motion.record import Record, band_passed
from damage.reference.session import run_reference
from damage.run.options import make_parser, parse_run
from damage.run.schedule import check_size, choose_time_step
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Opening, Wall

SYMMETRIC = REPOSITORY / "walls" / "symmetric.py"
RECORD = str(REPOSITORY / "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv")
ADDRESS = str(REPOSITORY / "studies/addresses/garsthuizen.toml")

WALLS = {
    "Wall('w', 2.0, 1.0, [Opening(0.05, 1.0, 0.5)])": "cuts off a pier",
    "Wall('w', 2.0, 1.0, joint=Joint(tensile_strength=-1.0))": "tensile_strength",
    "Wall('w', 2.0, 1.0, joint=Joint(tensile_strength=0.1))": r"0\.1 MPa is 0\.1e6 Pa",
    "Wall('w', 2.0, 1.0, joint=Joint(friction_angle=32))": "radians",
    "Wall('w', lenght=1, height=1)": r"Wall\(lenght=...\): expected length",
    "Wall('w', 1, 1, joint=Joint(cohesions=1))": r"Joint\(cohesions=...\): expected cohesion",
    "Wall('w', 1, 1, openings=[Opening(left=1, wide=1, height=1)])": (
        r"Opening\(wide=...\): expected "
    ),
    "Wall('w', 1, 1, colour=2)": r"Wall\(colour=...\): expected one of name, length, height",
}
OPTIONS = {
    "--harmonix 0.2 0.05": "did you mean --harmonic",
    "--recrod=a.csv": "did you mean --record",
    "--record no_such_file.csv": "no_such_file.csv",
    "--record BGAR_HGE --window 6 5": "expected 0 <= start < end",
    "--record BGAR_HGE --scale 1000": "base motion of up to .* up to 100 g",
    "--dt -1e-5": "--dt .s. = -1e-05: expected a number from 1e-09",
    "--dt 1e-9": r"in 3.1e\+09 steps .* up to 1e\+08 steps",
    "--dt 4.6e-5": "above the stable time step",
    "--harmonic 0.2 49": "PGA of the base motion = 49 g.*--accept-implausible",
    "--harmonic 0.2 1 --sequence 1,-1000": r"base motion of up to 1e\+03 g",
    "--harmonic 0.2 0.05 --free-vibration": "choose one",
    "--harmonic 0.2 0.05 --cycles 0": "cycle",
    "--scale 2": "--scale",
    "--cyclic 0.1;0.2": "commas",
    "--cyclic " + ",".join(2000 * ["0.1"]): "2000 drifts",
    "--cyclic 20 --cycles 1000 --speed 0.001": "a push of .* up to 2000 s",
    "--boundary fixed": "--boundary",
    "--lintel granite": "granite",
    "--bricks deformable --new-contacts": "loose bricks collide as rigid ones",
    "--fibres 8": "are brittle",
    "--rest 1e12": "0 to 2000",
}
IN_YADE = {
    "beyond-its-law": (["--beta", "1e-6"], "--beta"),
    "its-view": (["--view"], "screen"),
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
class TestYade:
    @pytest.mark.parametrize("case", IN_YADE)
    def test_bad_option(self, case, yade_command, tmp_path):
        words, complaint = IN_YADE[case]
        done = yade_command(SYMMETRIC, *words, "--out", tmp_path / "out.h5")
        assert_refused(done.returncode, done.stdout, done.stderr, complaint, tmp_path)


@pytest.mark.parametrize(
    "words, message",
    [
        ("index --thresholdmm 0.1 a.h5", "did you mean --threshold-mm? see --help"),
        ("--quite index", "did you mean --quiet? see --help"),
        ("help indx", "did you mean index?"),
        ("tables run a.h5 b.h5 --out stem", "tables run of 2 histories: expected one"),
    ],
)
def test_a_mistaken_command(words, message, capsys):
    assert main(words.split()) == 2
    said = capsys.readouterr().err
    assert message in said and said.startswith("error: ") and said.count("\n") == 1


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
    "--fibres ?": "0",
    "--soil ?": "1000000000",
    "--soil 1e8 --soil-velocity ?": "0",
    "--soil 1e8 --soil-shear ?": "0.5",
    "--soil 1e8 --footing ?": "0.5",
    "--pushover 0.1 --top-rotation ?": "0 1e-300 1000000000 0.5",
    "--settle hogging --distortion ?": "",
    "--checkpoint ?": "0.5",
    "--address A --life ?": "1000000000",
    "--bricks deformable --brick-mass ?": "",
    "--bricks deformable --brick-damping ?": "0 1e-300 0.5",
    "--bricks deformable --brick-order ?": "",
    "--bricks deformable --brick-cells ?": "0",
    "--brick-damping ?": "",
    "--seed ?": "0 1000000000",
    "--rest ?": "0 1e-300 0.5",
    "--dt ?": "",
    "--members ?": "",
    "--units ? 2": "",
}
"""{words of a run, ? the value: which of ODD go}; all others are refused before anything is
begun."""
COMMANDS = {
    "index H --threshold-mm ?": "0.5",
    "cracks H --at ?": "0 1e-300",
    "cracks C --wall W --tolerance-mm ?": "0.5",
    "modes W --cells ?": "",
    "fragility F --out O --replicates ?": "",
}
"""The same of commands, with files that are there, or are looked for after the options (F, O,
S)."""
FIELDS = {
    (Brick, "length"): "0.5",
    (Brick, "density"): "",
    (Brick, "young_modulus"): "1000000000",
    (Joint, "normal_stiffness"): "1000000000",
    (Joint, "tensile_strength"): "0 1e-300 1000000000 0.5",
    (Joint, "friction_angle"): "0 1e-300 0.5",
    (ModelOptions, "strength_cov"): "0 1e-300 0.5",
}


def that_go(function, complaint_of):
    """Those of ODD with which `function(value)` does not complain; of the others one line is held
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


def filled(template, files, value):
    return [files.get(word, word).replace("?", value) for word in template.split()]


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


@pytest.mark.parametrize("template", COMMANDS)
def test_odd_values_of_commands(template, files, complaint_of):
    assert (
        that_go(lambda value: main(filled(template, files, value)), complaint_of)
        == COMMANDS[template]
    )


@pytest.mark.parametrize("record, field", FIELDS)
def test_odd_numbers_of_a_wall(record, field):
    for word in set(ODD) - {"", "abc", 5000 * "9"}:
        if word in FIELDS[record, field].split():
            record(**{field: float(word)})
        else:
            one_line_error(record, **{field: float(word)})


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
    ("outline", "[[0, 2700], [2.2, 4200], [4.4, 2700]]", "expected a number from -1000 to 1000"),
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


@pytest.mark.parametrize("key, value, message", MISTAKES, ids=str)
def test_a_mistake_in_a_wall_as_data(key, value, message, tmp_path):
    assert load_wall(house(tmp_path)).name == "house"
    assert "expected" in refused_with(message, load_wall, house(tmp_path, key, value))
