"""What is there after `pip install` alone: walls, records and studies by name, from Python and in a
notebook."""

import io
import json
import sys
import tomllib
from contextlib import redirect_stdout

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, script_file
from test_guides import GUIDES, clone, follow  # noqa: F401

import damage
from damage.__main__ import main
from damage.files import shipped_files
from damage.motion.loading import Harmonic, TopDisplacement
from damage.wall.file import load_wall
from damage.wall.new import new_wall

SETUP = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))["tool"][
    "setuptools"
]
PIER = damage.Wall("pier", length=0.9, height=0.6)
SHORT = {"harmonic": (0.05, 0.1), "cycles": 1, "rest": 0}

pytestmark = pytest.mark.xdist_group("guides")


def test_every_package_is_installed_and_what_lies_beside_it():
    """A folder of the package that pyproject.toml does not list would be missing after pip
    install."""
    mine = {
        ".".join(path.parent.relative_to(REPOSITORY).parts)
        for path in REPOSITORY.glob("damage/**/__init__.py")
    }
    beside = {
        ".".join(("damage", "share", *path.relative_to(REPOSITORY).parts))
        for name in SETUP["package-dir"].values()
        for path in (REPOSITORY / name, *(REPOSITORY / name).iterdir())
        if path.is_dir() and not path.name.startswith(("_", "."))
    }
    assert set(SETUP["packages"]) == mine | beside
    for package, folder in SETUP["package-dir"].items():
        patterns = ["*.py", *SETUP["package-data"].get(package, [])]
        left = {path.name for path in (REPOSITORY / folder).iterdir() if path.is_file()} - {
            path.name for pattern in patterns for path in (REPOSITORY / folder).glob(pattern)
        }
        assert not left, f"{folder} has files that are not installed: {left}"


@pytest.mark.long
def test_the_guide_is_true_in_an_empty_folder(clone, tmp_path):  # noqa: F811
    script_file(clone.parent / "bin" / "damage", f'exec "{sys.executable}" -m damage "$@"')
    assert "study my-study: 2 of 2 runs done" in follow("from-pip", clone, tmp_path)
    for name in ("demo/symmetric.html", "mine.html", "results/my-study/tables/points.csv"):
        assert (tmp_path / name).is_file(), name


def test_the_notebook_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = GUIDES / "notebook.ipynb"
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    assert path.stat().st_size < 100_000 and not any(cell.get("outputs") for cell in cells)
    names = {}
    out = io.StringIO()
    with redirect_stdout(out):
        for cell in cells:
            if cell["cell_type"] == "code":
                exec("".join(cell["source"]), names)
    assert "<table>" in names["history"]._repr_html_() and names["figure"].axes
    weak, strong = (
        float(line.split()[-1])
        for line in out.getvalue().splitlines()
        if " MPa: maximum DI" in line
    )
    assert weak > strong
    assert "did you mean symmetric?" in out.getvalue()


class TestNames:
    @pytest.mark.parametrize("name", shipped_files("walls", ".py"))
    def test_a_new_wall_is_the_one_that_ships_but_for_its_name(self, tmp_path, name):
        path = new_wall(tmp_path / "mine", name)
        mine = load_wall(path).as_dict()
        theirs = load_wall(name).as_dict()
        assert mine.pop("name") == "mine" and theirs.pop("name") == name
        assert mine == theirs

    def test_a_new_wall_replaces_nothing(self, tmp_path):
        path = new_wall(tmp_path / "mine.toml")
        assert "mine.toml exists" in one_line_error(new_wall, path)


class TestRun:
    def test_in_memory_in_a_file_and_by_the_command_are_equal(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        new_wall("w.toml", "solid")
        in_memory = damage.run("w.toml", **SHORT)
        in_file = damage.run("w.toml", **SHORT, out="a.h5")
        words = "w.toml --harmonic 0.05 0.1 --cycles 1 --rest 0 --no-pictures --quiet --out b.h5"
        assert main(["reference", *words.split()]) == 0
        for other in (in_file, damage.read_history("b.h5")):
            assert in_memory.series.equals(other.series) and np.array_equal(
                in_memory.opening_m, other.opening_m
            )
        assert sorted(path.name for path in tmp_path.iterdir()) == ["a.h5", "b.h5", "w.toml"]
        assert in_file.command.startswith("python3 -m damage reference w.toml ")

    def test_a_motion_is_a_record_a_loading_or_options(self, capfd):
        by_options = damage.run(PIER, **SHORT)
        assert damage.run(PIER, Harmonic(0.05, 0.1, cycles=1), rest=0).series.equals(
            by_options.series
        )
        by_name = damage.run(PIER, "BGAR_HGE", window=(18.7, 18.8), rest=0)
        assert by_name.loading.name.startswith("BGAR_HGE")
        assert damage.run(PIER, pushover=0.001).loading == TopDisplacement((0.001,), cycles=0)
        assert len(damage.run(PIER, **SHORT | {"sequence": [1, 0.5]}).sequence) == 2
        assert capfd.readouterr().out == ""
