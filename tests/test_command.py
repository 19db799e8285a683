"""What every command has: its version, quiet, completion of a shell; and messages of a wall file's mistakes."""

import os
import re
import shlex
import shutil
import subprocess
import sys
from contextlib import suppress

import pytest
from conftest import REPOSITORY, one_line_error, run_command, wall_file, written

from damage.__main__ import command_parser, main
from damage.applications import GROUPS
from damage.commands.table import COMMANDS, PROGRAMS
from damage.history.reader import read_history
from damage.run.options import make_parser
from damage.version import VERSION
from damage.wall.file import load_wall

SMALL = "Wall('w', 0.45, 0.15)"


def test_the_version_has_the_package_s_name(output_of):
    assert output_of("--version").startswith(f"masonry-damage {VERSION}, commit ")


def test_quiet_leaves_files_and_no_word(tmp_path, capsys):
    wall = wall_file(tmp_path / "wall.py", SMALL)
    assert main(["modes", str(wall), "--out", str(tmp_path / "pictures")]) == 0
    printed = capsys.readouterr()
    assert "mode 1" in printed.out and "picture: " in printed.err
    assert main(["--quiet", "modes", str(wall), "--out", str(tmp_path / "quiet")]) == 0
    assert capsys.readouterr() == ("", "")
    assert (tmp_path / "quiet/modes.png").is_file()


def test_quiet_stands_anywhere(tmp_path, capsys):
    wall = wall_file(tmp_path / "wall.py", SMALL)
    for words in (["modes", "--quiet", str(wall)], ["modes", str(wall), "--quiet"]):
        assert main(words) == 0 and capsys.readouterr() == ("", "")


def test_a_quiet_study_hands_its_silence_on(tmp_path):
    """It is another program, which takes the place of this one."""
    done = run_command(sys.executable, "-m", "damage", "study", "quick", "--dry-run", "--quiet", "--out", tmp_path)
    assert (done.returncode, done.stdout) == (0, "")


@pytest.mark.parametrize("words, meant", [
    (["index", "--thresholdmm", "0.1", "a.h5"], "--threshold-mm"), (["plot", "a.h5", "--ot", "x"], "--out"),
    (["reference", "symmetric", "--harmonix", "0.2", "0.05"], "--harmonic"),
    (["reference", "symmetric", "--recrod=a.csv"], "--record"), (["--quite", "index"], "--quiet")], ids=" ".join)
def test_an_unknown_option_names_the_nearest(words, meant, error_of):
    """Also where one that is required is missing for it."""
    error = error_of(*words)
    assert error.count("\n") == 1 and f"did you mean {meant}? see --help" in error


def test_tables_of_two_runs_do_not_share_a_name(error_of):
    assert "tables run of 2 histories: expected one" in error_of("tables", "run", "a.h5", "b.h5", "--out", "stem")


def help_of(*words):
    with suppress(SystemExit):
        main(list(words))


@pytest.mark.parametrize("name", [*COMMANDS, "reference"])
def test_help_of_a_command_ends_with_two_examples_that_it_takes(name, capsys):
    assert name == "reference" or sum(name in names for names in GROUPS.values()) == 1
    parser = make_parser("reference", "reference") if name == "reference" else command_parser()
    help_of("help", name)
    shown = capsys.readouterr().out
    *_, first, second = shown.rstrip().splitlines()
    for line in (first, second):
        words = shlex.split(re.split(r" [|>] (?=[a-z])", line)[0])
        assert words[:4] == ["python3", "-m", "damage", name]
        parser.parse_args(words[5:] if name == "reference" else words[3:])
    help_of(name, "--help")
    assert capsys.readouterr().out == shown


def test_help_lists_all_commands_in_groups(capsys):
    help_of("help")
    shown = capsys.readouterr().out
    listed = re.findall(r"^  ([a-z][a-z-]+)  ", shown, re.MULTILINE)
    assert sorted(set(listed)) == sorted({*COMMANDS, *PROGRAMS, "help"}) and "other commands" not in shown
    assert main(["help", "indx"]) == 2 and "did you mean index?" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--help"], ["materials"], ["record", "BGAR_HGE"], ["study", "--help"]],
                         ids=" ".join)
def test_an_old_terminal_gets_replaced_letters(words):
    done = run_command("env", "PYTHONIOENCODING=ascii", sys.executable, "-m", "damage", *words)
    assert (done.returncode, done.stderr) == (0, "") and done.stdout.isascii()
    assert words != ["--help"] or "fa?ade" in done.stdout


def test_quiet_tells_errors(tmp_path, error_of):
    assert error_of("--quiet", "index", tmp_path / "none.h5").startswith("error: ")


@pytest.mark.parametrize("before, after", [(["--quiet"], []), ([], ["--quiet"])], ids=["before", "after"])
def test_a_quiet_run_writes_its_history_and_no_word(tmp_path, capsys, before, after):
    wall_file(tmp_path / "wall.py", SMALL)
    words = [*before, "reference", str(tmp_path / "wall.py"), "--harmonic", "0.02", "0.01", "--cycles", "1", "--rest",
             "0", "--no-pictures", "--out", str(tmp_path / "a.h5"), *after]
    assert main(words) == 0
    assert capsys.readouterr() == ("", "")
    assert (tmp_path / "a.h5").is_file()
    assert main([word for word in words if word != "--quiet"] + ["--overwrite"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("wall w: 0.450 x 0.150 m") and "joints: tensile strength 0.21 MPa" in printed


@pytest.mark.parametrize("line, expected", [
    ("masonry-damage stu", {"study-tables", "study-schema"}), ("masonry-damage reference --rayl", {"--rayleigh"}),
    ("masonry-damage index --slip ", {"displacement", "accumulated", "shear-limit"})])
def test_a_shell_completes_commands_options_and_choices(tmp_path, line, expected):
    pytest.importorskip("argcomplete")
    answer = tmp_path / "answer"
    asked = {"_ARGCOMPLETE": "1", "_ARGCOMPLETE_IFS": "\n", "COMP_LINE": line, "COMP_POINT": str(len(line)),
             "_ARGCOMPLETE_STDOUT_FILENAME": str(answer)}
    done = subprocess.run([sys.executable, "-m", "damage"], cwd=REPOSITORY, env=os.environ | asked, timeout=60)
    assert done.returncode == 0
    assert {word.strip() for word in answer.read_text().split("\n")} >= expected


@pytest.mark.parametrize("call, nearest", [
    ('Wall("w", lenght=1, height=1)', "Wall(lenght=...): expected length"),
    ('Wall("w", 1, 1, joint=Joint(cohesions=1))', "Joint(cohesions=...): expected cohesion"),
    ('Wall("w", 1, 1, brick=Brick(heigth=1))', "Brick(heigth=...): expected height"),
    ('Wall("w", 1, 1, openings=[Opening(left=1, wide=1, height=1)])', "Opening(wide=...): expected "),
    ('Wall("w", 1, 1, colour=2)', "Wall(colour=...): expected one of name, length, height")])
def test_a_wrong_keyword_names_the_right_ones(tmp_path, call, nearest):
    wall_file(tmp_path / "wall.py", call)
    assert nearest in one_line_error(load_wall, tmp_path / "wall.py")


def test_a_wall_in_python_says_how_it_is_run():
    """By an interpreter that has no YADE, as others than Debian's have none."""
    code = ("import sys, runpy; sys.modules['yade'] = None; sys.argv = ['walls/solid.py']\n"
            "runpy.run_path('walls/solid.py', run_name='__main__')")
    done = run_command(sys.executable, "-c", code, status=3)
    assert "expected yade walls/solid.py [OPTIONS]" in done.stderr
    assert "python3 -m damage reference walls/solid.py" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.yade
def test_a_quiet_run_in_yade(yade_command, tmp_path):
    shutil.copyfile(REPOSITORY / "walls/solid.py", tmp_path / "wall.py")
    done = yade_command(tmp_path / "wall.py", "--quiet", "--harmonic", "0.2")  # a mistake: it ends at once
    assert done.returncode == 2
    assert "bricks are" not in done.stdout and "expected" in done.stderr


def test_what_is_sent_names_no_folder_of_this_machine(tmp_path, monkeypatch):
    """The history, its tables, pictures and report."""
    wall_file(tmp_path / "w.py", SMALL)
    record = written(tmp_path / "pulse.csv", "time_s,acc_m_s2\n0,0\n0.001,1\n0.002,0\n")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    out = tmp_path / "a.h5"
    assert main(["--quiet", "reference", str(tmp_path / "w.py"), "--record", str(record), "--rest", "0",
                 f"--out={out}"]) == 0
    assert main(["tables", "run", str(out), "--out", str(tmp_path / "t")]) == 0
    assert main(["report", str(out)]) == 0
    made = [path for path in tmp_path.rglob("*") if path.is_file() and path not in (record, tmp_path / "w.py")]
    assert {path.suffix for path in made} == {".h5", ".csv", ".json", ".html", ".png", ".pdf"}
    assert not [path for path in made if str(tmp_path).encode() in path.read_bytes()]
    assert read_history(out).command.endswith(f"w.py --record {record.name} --rest 0 --out=a.h5 --quiet")


@pytest.mark.parametrize("words", [["reference", "--help"], ["modes", "--help"], ["cracks", "--help"]], ids=" ".join)
def test_help_says_that_a_wall_file_is_executed(words, capsys):
    with suppress(SystemExit):
        main(words)
    assert "A wall file is Python and is executed" in " ".join(capsys.readouterr().out.split())
