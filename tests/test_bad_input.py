"""Bad input through the real command: one clear line, a non-zero status, no file that looks whole."""

import os

import pytest
from conftest import REPOSITORY

pytestmark = pytest.mark.yade

WALL = '''
import sys
sys.path.insert(0, {repository!r})
from damage import Brick, Joint, Opening, Wall

def wall():
    return {wall}

if __name__ == "__main__":
    from yade_scripts.run import main
    main(wall)
'''

RECORDS = {
    "nan": ("time_s,acc_m_s2\n0.0,0.1\n0.005,nan\n0.01,0.2\n", "finite|NaN|nan"),
    "uneven-time": ("time_s,acc_m_s2\n0.0,0.1\n0.005,0.1\n0.017,0.2\n", "uniform|step"),
    "reversed-time": ("time_s,acc_m_s2\n0.01,0.1\n0.005,0.1\n0.0,0.2\n", "increas"),
    "empty": ("", "empty|no data"),
    "text": ("time_s,acc_m_s2\n0.0,hello\n0.005,0.2\n", "number"),
    "one-column": ("0.1\n0.2\n0.3\n", "two columns|column"),
}

WALLS = {
    "opening-outside": ("Wall('w', 2.0, 1.0, [Opening(1.5, 1.0, 0.5)])", "outside"),
    "pier-cut-off": ("Wall('w', 2.0, 1.0, [Opening(0.05, 1.0, 0.5)])", "cuts off a pier"),
    "negative-strength": ("Wall('w', 2.0, 1.0, joint=Joint(tensile_strength=-1.0))", "tensile_strength"),
    "degrees": ("Wall('w', 2.0, 1.0, joint=Joint(friction_angle=32))", "radians"),
    "zero-brick": ("Wall('w', 2.0, 1.0, brick=Brick(height=0.0))", "Brick.height"),
}

OPTIONS = {
    "unknown-option": (["--harmonix", "0.2", "0.05"], "--harmonix"),
    "missing-record": (["--record", "no_such_file.csv"], "no_such_file.csv"),
    "unstable-step": (["--dt", "4.6e-5"], "stable"),
    "negative-step": (["--dt", "-1e-5"], "positive"),
    "no-number": (["--rest", "long"], "--rest"),
    "nan-rest": (["--rest", "nan"], "--rest"),
    "two-motions": (["--harmonic", "0.2", "0.05", "--free-vibration"], "choose one"),
    "scale-without-record": (["--scale", "2"], "--scale"),
    "half-a-cycle": (["--harmonic", "0.2", "0.05", "--cycles", "0"], "cycle"),
    "viscous-damping": (["--beta", "1e-6"], "--beta"),
    "cyclic-text": (["--cyclic", "0.1;0.2"], "commas"),
    "boundary-without-push": (["--boundary", "fixed"], "--boundary"),
    "no-screen": (["--view"], "screen"),
    "unknown-lintel": (["--lintel", "steel"], "steel"),
}


def assert_refused(done, complaint, folder):
    """One line that names the trouble, a status that is not zero, nothing left behind."""
    import re

    assert done.returncode not in (0, 139), done.stdout + done.stderr
    errors = [line for line in done.stderr.splitlines() if line.startswith("error:")]
    assert len(errors) == 1, done.stdout + done.stderr
    assert re.search(complaint, errors[0]), errors[0]
    assert "Traceback" not in done.stderr + done.stdout
    assert not list(folder.rglob("*.h5")), "a history was left behind"


@pytest.mark.parametrize("case", RECORDS)
def test_bad_record(case, yade_command, tmp_path):
    text, complaint = RECORDS[case]
    record = tmp_path / "record.csv"
    record.write_text(text)
    done = yade_command("walls/symmetric.py", "--record", record, "--out", tmp_path / "out.h5")
    assert_refused(done, complaint, tmp_path)


@pytest.mark.parametrize("case", WALLS)
def test_bad_wall(case, yade_command, tmp_path):
    wall, complaint = WALLS[case]
    file = tmp_path / "wall.py"
    file.write_text(WALL.format(repository=str(REPOSITORY), wall=wall))
    done = yade_command(file, "--out", tmp_path / "out.h5")
    assert_refused(done, complaint, tmp_path)


@pytest.mark.parametrize("case", OPTIONS)
def test_bad_option(case, yade_command, tmp_path):
    words, complaint = OPTIONS[case]
    done = yade_command("walls/symmetric.py", *words, "--out", tmp_path / "out.h5")
    assert_refused(done, complaint, tmp_path)


def test_folder_that_cannot_be_written(yade_command, tmp_path):
    blocked = tmp_path / "blocked"
    if os.geteuid() == 0:  # root writes everywhere but below a file
        blocked.write_text("a file, not a folder")
    else:
        blocked.mkdir(mode=0o500)
    done = yade_command("walls/symmetric.py", "--out", blocked / "out.h5")
    assert_refused(done, "cannot write|choose another", tmp_path)


def test_output_that_is_a_folder(yade_command, tmp_path):
    done = yade_command("walls/symmetric.py", "--out", tmp_path)
    assert_refused(done, "is a folder", tmp_path)
