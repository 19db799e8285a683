"""What every option of a run and of a command takes, and every number of a wall: zero, negative, infinite, none, huge.

A table says which of ODD go; all others are refused with one line before anything is begun.
"""

import math

import pytest
from conftest import REPOSITORY, one_line_error, refused_with, wall_file
from small_history import make_history, small_layout

import damage.__main__ as commands
from damage.errors import InputError
from damage.law.modes import natural_modes
from damage.motion.record import Record, band_passed, scaled
from damage.run.options import parse_run
from damage.run.schedule import check_size, choose_time_step
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Brick, Joint, Opening, Wall

ODD = ("0", "-1", "inf", "-inf", "nan", "1e-300", "1e300", "1000000000", "1" + 30 * "0", "9" * 5000, "", "abc",
       "0.5")
RECORD = str(REPOSITORY / "damage/data/zeerijp_20180108/BGAR_HGE_acc_m_s2.csv")
ADDRESS = str(REPOSITORY / "studies/addresses/garsthuizen.toml")
RUN = {
    "--harmonic ? 0.05": "0.5", "--harmonic 0.2 ?": "0 1e-300 0.5", "--cycles ?": "", "--cyclic 0.1 --cycles ?": "",
    "--record R --scale ?": "0 -1 1e-300 0.5",
    "--record R --sample-step ?": "", "--cracked C --tolerance-mm ?": "0.5",
    "--record R --window ? 5": "0 1e-300 0.5", "--record R --window 1 ?": "",
    "--record R --baseline ?": "0", "--record R --band ? 10": "0.5", "--record R --band 0.1 ?": "0.5",
    "--sequence ?": "0 -1 1e-300 0.5", "--sequence 1,?": "0 -1 1e-300 0.5",
    "--pushover ?": "0.5", "--cyclic ?": "0.5", "--cyclic 0.1,?": "0.5", "--pushover 0.1 --speed ?": "0.5",
    "--pushover 0.1 --damping ?": "0 1e-300 0.5", "--cells ?": "", "--strength-cov ?": "0 1e-300 0.5",
    "--strength-seed ?": "0 1000000000", "--beta ?": "0 1e-300", "--rayleigh ? 5 20": "0 1e-300 0.5",
    "--rayleigh 0.02 ? 20": "0.5", "--rayleigh 0.02 0.1 ?": "0.5",
    "--scatter ?": "0 1e-300", "--fibres ?": "0", "--soil ?": "1000000000", "--soil 1e8 --soil-shear ?": "0.5",
    "--soil 1e8 --footing ?": "0.5", "--soil 1e8 --soil-velocity ?": "0",
    "--pushover 0.1 --top-rotation ?": "0 1e-300 1000000000 0.5",
    "--settle hogging --distortion ?": "", "--checkpoint ?": "0.5",
    "--point ? 0.3": "0 -1 1e-300 0.5", "--point 0.3 ?": "0 -1 1e-300 0.5",
    "--address A --life ?": "1000000000",
    "--bricks deformable --brick-mass ?": "", "--bricks deformable --brick-damping ?": "0 1e-300 0.5",
    "--bricks deformable --brick-order ?": "", "--bricks deformable --brick-cells ?": "0", "--brick-damping ?": "",
    "--seed ?": "0 1000000000", "--rest ?": "0 1e-300 0.5", "--dt ?": "", "--members ?": "",
}
"""{words of a run, ? the value: which of ODD go}."""
YADE_ALONE = {"--past-collapse ?": "0 1e-300 0.5"}
COMMANDS = {
    "index H --threshold-mm ?": "0.5", "index H --drift-limit-pct ?": "0.5", "cracks H --at ?": "0 1e-300",
    "cracks H --threshold-mm ?": "0.5", "cracks C --wall W --tolerance-mm ?": "0.5",
    "cracks --dic D --wall W --margin-mm ?": "0 1e-300 0.5", "modes W --cells ?": "",
    "fragility F --out O --replicates ?": "", "study-tables S O -j ?": "",
}
"""Of the commands, with files that are there, or are looked for after the options (F, O, S)."""
OTHERS = {
    "longer than a run can be": (["--rest", "1e12"], "0 to 2000"),
    "many shocks": (["--sequence", ",".join(["1"] * 10**5)], "a run of .* expected up to 2000 s"),
    "many drifts": (["--cyclic", ",".join(["0.1"] * 2000)], "2000 drifts"),
    "a long push": (["--cyclic", "50", "--cycles", "1000"], "a push of .* up to 2000 s"),
    "many steps": (["--dt", "1e-9"], "in 3.1e\\+09 steps .* up to 1e\\+08 steps"),
    "a step beyond the critical": (["--dt", "0.5"], "above the stable time step"),
    "damping that asks for many steps": (["--beta", "0.5"], "steps"),
    "a window turned round": (["--record", RECORD, "--window", "6", "5"], "expected 0 <= start < end"),
    "a window outside": (["--record", RECORD, "--window", "0", "1e6"], "expected 0 <= start < end"),
    "a record in the wrong unit": (["--record", RECORD, "--scale", "1000"], "base motion of up to .* up to 100 g"),
    "shocks of 1000": (["--harmonic", "0.2", "1", "--sequence", "1,-1000"], "base motion of up to 1e\\+03 g"),
    "a name that no file can have": (["--record", "x" * 300], "a name of 300 bytes"),
    "a name with a terminal's code": (["--out", "a\x1b[31m.h5"], r"'a\\x1b\[31m.h5': expected a name without control"),
}


def prepare(words, solver="reference"):
    """All that is looked at before a run begins."""
    settings = parse_run(words, "test", solver)
    layout = lay_out(small_layout().wall, settings.model)
    check_size(settings, layout, choose_time_step(settings, natural_modes(layout).critical_time_step_s))


def that_go(function, template, files):
    """Those of ODD with which `function(words)` does not complain; of the others one line is held to what it says."""
    complaint_by_word = {}
    for value in ODD:
        words = [files.get(word, word).replace("?", value) for word in template.split()]
        complaint_by_word[value] = complaint_of(function, words)
    complaints = [complaint for complaint in complaint_by_word.values() if complaint is not None]
    for complaint in complaints:
        assert "\n" not in complaint and any(word in complaint for word in ("expected", "invalid", "choose", "stable"))
    return " ".join(value for value, complaint in complaint_by_word.items() if complaint is None)


def complaint_of(function, *arguments):
    """What the InputError says that a call raises, None where it raises none."""
    try:
        function(*arguments)
    except InputError as error:
        return str(error)
    return None


@pytest.mark.parametrize("template", RUN)
def test_options_of_a_run(template, files):
    assert that_go(prepare, template, files | {"R": RECORD, "A": ADDRESS}) == RUN[template]


@pytest.mark.parametrize("template", YADE_ALONE)
def test_options_of_a_run_in_yade(template):
    assert that_go(lambda words: prepare(words, "yade"), template, {}) == YADE_ALONE[template]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("files")
    make_history(folder / "small.h5")
    wall_file(folder / "w.py", "Wall('small', 0.9, 0.45)")
    (folder / "c.csv").write_text("crack,point,x_m,z_m,width_mm\n1,1,0.1,0.075,1\n1,2,0.3,0.075,1\n")
    points = [f"{x / 100},{z / 200},0,0" for x in range(90) for z in range(90)]
    (folder / "d.csv").write_text("\n".join(["x_m,z_m,ux_m,uz_m", *points]))
    return {"H": str(folder / "small.h5"), "W": str(folder / "w.py"), "C": str(folder / "c.csv"),
            "D": str(folder / "d.csv")} | {name: str(folder / name) for name in "FOS"}


@pytest.mark.parametrize("template", COMMANDS)
def test_options_of_commands(template, files, capsys):
    def run(words):
        if commands.main(words):
            raise InputError(capsys.readouterr().err.removesuffix("\n"))

    assert that_go(run, template, files) == COMMANDS[template]


@pytest.mark.parametrize("case", OTHERS)
def test_what_cannot_be_run(case):
    words, complaint = OTHERS[case]
    assert len(refused_with(complaint, prepare, words)) < 1600


FIELDS = {
    **{f"Brick.{name}": (lambda value, name=name: Brick(**{name: value}), "0.5") for name in
       ("length", "height", "thickness")},
    "Brick.density": (lambda value: Brick(density=value), ""),
    **{f"Brick.{name}": (lambda value, name=name: Brick(**{name: value}), "1000000000") for name in
       ("young_modulus", "shear_modulus")},
    **{f"Joint.{name}": (lambda value, name=name: Joint(**{name: value}), "1000000000") for name in
       ("normal_stiffness", "shear_stiffness")},
    **{f"Joint.{name}": (lambda value, name=name: Joint(**{name: value}), "0 1e-300 1000000000 0.5") for name in
       ("tensile_strength", "cohesion")},
    "Joint.friction_angle": (lambda value: Joint(friction_angle=value), "0 1e-300 0.5"),
    "Opening.left": (lambda value: Opening(value, 1.0, 1.0), "0 1e-300 0.5"),
    "Opening.width": (lambda value: Opening(0.0, value, 1.0), "0.5"),
    "Wall.length": (lambda value: Wall("w", value, 1.0), "0.5"),
    "Wall.height": (lambda value: Wall("w", 1.0, value), "0.5"),
    "Wall.precompression": (lambda value: Wall("w", 1.0, 1.0, precompression=value), "0 1e-300 1000000000 0.5"),
    "strength_cov": (lambda value: ModelOptions(strength_cov=value), "0 1e-300 0.5"),
    "time step of a record": (lambda value: Record("r", value, [0.0, 1.0]), "0.5"),
    "factor on a record": (lambda value: scaled(Record("r", 0.1, [0.0, 1.0]), value), "0 -1 1e-300 0.5"),
    "sample of a record": (lambda value: Record("r", 0.1, [0.0, value]), "0 -1 1e-300 0.5"),
}
"""{what: (a function of its value, which of ODD go)}."""


@pytest.mark.parametrize("field", FIELDS)
def test_numbers_of_a_wall_and_a_record(field):
    make, goes = FIELDS[field]
    complaint_by_word = {word: complaint_of(make, float(word)) for word in ODD if word not in ("", "abc", "9" * 5000)}
    assert " ".join(word for word, complaint in complaint_by_word.items() if complaint is None) == goes
    assert all("expected" in complaint for complaint in complaint_by_word.values() if complaint is not None)


def test_a_wall_of_more_bricks_or_contact_points_than_can_be():
    assert "48000000 bricks" in one_line_error(Wall, "w", 900.0, 900.0)
    assert "contact points" in one_line_error(lay_out, Wall("w", 20.0, 6.0), ModelOptions(cells=16))


def test_a_wall_of_stiffnesses_that_have_no_modes():
    bricks = Brick(young_modulus=1e20, shear_modulus=1.0)
    layout = lay_out(Wall("w", 4.0, 3.0, brick=bricks, joint=Joint(normal_stiffness=1e20, shear_stiffness=1.0)))
    assert "no natural modes" in one_line_error(natural_modes, layout)


def test_a_corner_far_below_the_sampling_rate_is_refused():
    record = Record("r", 1e-5, [math.sin(k) for k in range(2000)])
    assert "0.001 <= low" in one_line_error(band_passed, record, 1e-4, 1e4)
    assert max(abs(band_passed(record, 1e-3, 1e4).acceleration_m_s2)) < 2  # the lowest there is: no overflow
