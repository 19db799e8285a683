"""What every command has: its version, quiet, completion of a shell; and messages of a wall file's
mistakes."""

import re
import shlex
import sys
from contextlib import suppress

import pytest
from conftest import run_command, wall_file, written

from damage import read_history
from damage.__main__ import command_parser, main
from damage.applications import GROUPS
from damage.commands.table import COMMANDS, PROGRAMS
from damage.draw import run as pictures
from damage.run.options import make_parser
from damage.version import VERSION

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
    assert (
        sorted(set(listed)) == sorted({*COMMANDS, *PROGRAMS, "help"})
        and "other commands" not in shown
    )


def test_a_wall_in_python_says_how_it_is_run():
    """By an interpreter that has no YADE, as others than Debian's have none."""
    code = (
        "import sys, runpy; sys.modules['yade'] = None; sys.argv = ['walls/solid.py']\n"
        "runpy.run_path('walls/solid.py', run_name='__main__')"
    )
    done = run_command(sys.executable, "-c", code, status=3)
    assert "expected yade walls/solid.py [OPTIONS]" in done.stderr
    assert "python3 -m damage reference walls/solid.py" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_what_is_sent_names_no_folder_of_this_machine(tmp_path, monkeypatch):
    """The history, its tables, pictures and report."""
    wall_file(tmp_path / "w.py", SMALL)
    record = written(tmp_path / "pulse.csv", "time_s,acc_m_s2\n0,0\n0.001,1\n0.002,0\n")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    monkeypatch.setattr(pictures, "PICTURES", {"drift": pictures.drift_picture})  # one of six
    out = tmp_path / "a.h5"
    words = f"--quiet reference {tmp_path}/w.py --record {record} --rest 0 --out={out}"
    assert main(words.split()) == 0
    assert main(["tables", "run", str(out), "--out", str(tmp_path / "t")]) == 0
    assert main(["report", str(out)]) == 0
    made = [
        path
        for path in tmp_path.rglob("*")
        if path.is_file() and path not in (record, tmp_path / "w.py")
    ]
    assert {path.suffix for path in made} == {".h5", ".csv", ".json", ".html", ".png", ".pdf"}
    assert not [path for path in made if str(tmp_path).encode() in path.read_bytes()]
    assert read_history(out).command.endswith(
        f"w.py --record {record.name} --rest 0 --out=a.h5 --quiet"
    )
