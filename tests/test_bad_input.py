"""Bad input to a run: one clear line, a non-zero status, no file that looks whole.

Both solvers read their input by the same functions, so that most of it is tried in this process, by the reference
solver's command; YADE is started once for each way on which it leaves.
"""

import os
import re

import pytest
from conftest import REPOSITORY, wall_file, written

from damage.reference.session import run_reference

RECORDS = {
    "nan": ("time_s,acc_m_s2\n0.0,0.1\n0.005,nan\n0.01,0.2\n", "finite|NaN|nan"),
    "empty": ("", "empty|no data"),
    "gal": ("time_s,acc_m_s2\n0.0,0.0\n0.005,80\n0.01,-80\n",
            r"PGA of the base motion = 8\.15.* g, expected .* to 5 g: cm/s2"),
    "one-column": ("0.1\n0.2\n0.3\n", "two columns|column"),
}

WALLS = {
    "opening-outside": ("Wall('w', 2.0, 1.0, [Opening(1.5, 1.0, 0.5)])", "outside"),
    "pier-cut-off": ("Wall('w', 2.0, 1.0, [Opening(0.05, 1.0, 0.5)])", "cuts off a pier"),
    "negative-strength": ("Wall('w', 2.0, 1.0, joint=Joint(tensile_strength=-1.0))", "tensile_strength"),
    "strength-in-mpa": ("Wall('w', 2.0, 1.0, joint=Joint(tensile_strength=0.1))", r"0\.1 MPa is 0\.1e6 Pa"),
    "degrees": ("Wall('w', 2.0, 1.0, joint=Joint(friction_angle=32))", "radians"),
    "zero-brick": ("Wall('w', 2.0, 1.0, brick=Brick(height=0.0))", "Brick.height"),
}

OPTIONS = {
    "pushover-nowhere": (["--pushover", "0"], "expected a number from 1e-06"),
    "unknown-option": (["--harmonix", "0.2", "0.05"], "--harmonix"),
    "missing-record": (["--record", "no_such_file.csv"], "no_such_file.csv"),
    "negative-step": (["--dt", "-1e-5"], "--dt .s. = -1e-05: expected a number from 1e-09"),
    "amplitude-in-gal": (["--harmonic", "0.2", "49"], "PGA of the base motion = 49 g.*--accept-implausible"),
    "unstable-step": (["--dt", "4.6e-5"], "stable"),
    "no-number": (["--rest", "long"], "--rest"),
    "nan-rest": (["--rest", "nan"], "--rest"),
    "two-motions": (["--harmonic", "0.2", "0.05", "--free-vibration"], "choose one"),
    "scale-without-record": (["--scale", "2"], "--scale"),
    "half-a-cycle": (["--harmonic", "0.2", "0.05", "--cycles", "0"], "cycle"),
    "cyclic-text": (["--cyclic", "0.1;0.2"], "commas"),
    "boundary-without-push": (["--boundary", "fixed"], "--boundary"),
    "unknown-lintel": (["--lintel", "granite"], "granite"),
    "loose-deformable-bricks": (["--bricks", "deformable", "--new-contacts"], "loose bricks collide as rigid ones"),
    "fibres-of-brittle-joints": (["--fibres", "8"], "are brittle"),
}

IN_YADE = {
    "parsed": (["--harmonix", "0.2", "0.05"], "--harmonix"),
    "beyond-its-law": (["--beta", "1e-6"], "--beta"),
    "its-time-step": (["--dt", "4.6e-5"], "stable"),
    "its-view": (["--view"], "screen"),
    "its-console": (["--console", "during"], "invalid choice: 'during'"),
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


SYMMETRIC = REPOSITORY / "walls" / "symmetric.py"


@pytest.mark.parametrize("case", RECORDS)
def test_bad_record(case, refused, tmp_path):
    text, complaint = RECORDS[case]
    record = written(tmp_path / "record.csv", text)
    refused(complaint, SYMMETRIC, "--record", record, "--out", tmp_path / "out.h5")


@pytest.mark.parametrize("case", WALLS)
def test_bad_wall(case, refused, tmp_path):
    refused(WALLS[case][1], wall_file(tmp_path / "wall.py", WALLS[case][0]), "--out", tmp_path / "out.h5")


@pytest.mark.parametrize("case", OPTIONS)
def test_bad_option(case, refused, tmp_path):
    words, complaint = OPTIONS[case]
    refused(complaint, SYMMETRIC, *words, "--out", tmp_path / "out.h5")


def test_folder_that_cannot_be_written(refused, tmp_path):
    blocked = tmp_path / "blocked"
    if os.geteuid() == 0:  # root writes everywhere but below a file
        blocked.write_text("a file, not a folder")
    else:
        blocked.mkdir(mode=0o500)
    refused("cannot write|choose another", SYMMETRIC, "--out", blocked / "out.h5")


def test_output_that_is_a_folder(refused, tmp_path):
    refused("is a folder", SYMMETRIC, "--out", tmp_path)


def test_output_that_is_there_already(refused, tmp_path_factory):
    out = written(tmp_path_factory.mktemp("earlier") / "out.h5", b"of an earlier run")
    refused("--overwrite", SYMMETRIC, "--out", out)
    assert out.read_bytes() == b"of an earlier run"


@pytest.mark.parametrize("name", ["first.txt", "first", ".h5", "first.h5.txt", "first.H5"])
def test_a_history_whose_name_does_not_end_in_h5(name, refused, tmp_path):
    refused(r"expected a name that ends in \.h5", SYMMETRIC, "--out", tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_pictures_of_another_run_stay(refused, tmp_path):
    picture = tmp_path / "first" / "wall.png"
    picture.parent.mkdir()
    picture.write_bytes(b"of another run")
    refused("the pictures of first.h5 would go there", SYMMETRIC, "--out", tmp_path / "first.h5")
    assert [path.name for path in tmp_path.iterdir()] == ["first"] and picture.read_bytes() == b"of another run"


@pytest.mark.yade
class TestYade:
    @pytest.mark.parametrize("case", IN_YADE)
    def test_bad_option(self, case, yade_command, tmp_path):
        words, complaint = IN_YADE[case]
        done = yade_command(SYMMETRIC, *words, "--out", tmp_path / "out.h5")
        assert_refused(done.returncode, done.stdout, done.stderr, complaint, tmp_path)

    def test_bad_wall(self, yade_command, tmp_path):
        done = yade_command(wall_file(tmp_path / "wall.py", WALLS["opening-outside"][0]), "--out", tmp_path / "out.h5")
        assert_refused(done.returncode, done.stdout, done.stderr, WALLS["opening-outside"][1], tmp_path)
