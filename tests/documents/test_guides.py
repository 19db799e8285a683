"""The guides are true: what they say to save is saved, what they say to type is typed, in a copy of
the repository."""

import os
import re
import shutil
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY, script_file, typed
from numpy.testing import assert_allclose
from test_after_peak import assert_same_numbers

import damage
from damage.measure.tables import summary_row
from paper import after_peak
from scripts import gallery

ROOT = REPOSITORY
GUIDES = ROOT / "docs" / "guides"
SHORTER = (
    ("--rest 1 ", "--cycles 1 --rest 0 "),
    ("--members 8", "--no-pictures --members 2"),
    ("--scale 3 --rest 0.2", "--rest 0"),
    ("[18.2, 20.2]", "[18.7, 18.9]"),
    ("options.rest = 0.2", "options.rest = 0"),
    ("scale = [4.0, 2.0, 1.0]", "scale = [4.0]"),
    ("--window 0.2 1.2", "--window 0.5 0.8"),
    *(
        (f"--out {name}.h5 ", f"--no-pictures --out {name}.h5 ")
        for name in ("two_windows", "settled", "shaken", "cracked", "house", "my_record")
    ),
    ("--pushover 1.75", "--pushover 0.1"),
    ("0.07,0.15,0.29,0.58,0.87,1.2,1.5,1.75", "0.05,0.1"),
    ("--rest 0.5", "--rest 0"),
    ("--cycles 2 --rest 0.3", "--cycles 1 --rest 0"),
    ("--harmonic 0.3 0.25 --cycles 1 --rest 0.1", "--harmonic 0.1 1 --cycles 1 --rest 0"),
)
"""What is typed with other numbers, or without pictures of the run, which decide nothing but how
long it takes: (in the guide, here)."""
BLOCK = re.compile(r"^```(sh|python|toml)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NEEDED = (
    "damage",
    "walls",
    "houses",
    "studies",
    "scripts",
    "yade_scripts",
    "run_all.sh",
    "yade",
    "pyproject.toml",
)

pytestmark = pytest.mark.xdist_group("guides")


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    """What a user has after a clone, with compiled code as it is here."""
    folder = tmp_path_factory.mktemp("guides") / "clone"
    folder.mkdir()
    for name in NEEDED:
        copy = shutil.copytree if (ROOT / name).is_dir() else shutil.copy2
        copy(ROOT / name, folder / name)
    (folder.parent / "bin").mkdir()
    script_file(folder.parent / "bin" / "python3", f'exec "{sys.executable}" "$@"')
    return folder


def blocks(name):
    """(language, text) of what a guide says to save and to type, `SHORTER`."""
    guide = (GUIDES / f"{name}.md").read_text(encoding="utf-8")
    for old, new in SHORTER:
        guide = guide.replace(old, new)
    return BLOCK.findall(guide)


def follow(name, clone, folder=None, after_first=None):
    """Save and type what a guide says; returns what its commands printed.  folder: where, if not in
    the clone, which is on Python's path then.  after_first(): called once the first file is there,
    before any command."""
    output = ""
    path = str(clone) if folder else ""
    folder = folder or clone
    for language, text in blocks(name):
        if language == "sh":
            done = subprocess.run(
                ["bash", "-euc", text],
                cwd=folder,
                capture_output=True,
                text=True,
                timeout=300,
                env={
                    **os.environ,
                    "PATH": f"{clone.parent / 'bin'}:{os.environ['PATH']}",
                    "PYTHONPATH": path,
                    "PYTHON": sys.executable,
                    "MASONRY_NO_INSTALL": "1",
                },
            )
            assert done.returncode == 0, (
                f"{name}: {text}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}"
            )
            output += done.stdout
        else:
            (first,) = re.findall(r"\A# (\S+)$", text, re.MULTILINE)[:1]
            (folder / first).write_text(text, encoding="utf-8")
            if after_first:
                after_first = after_first()
    return output


@pytest.mark.long
def test_the_first_wall_and_what_it_left(clone):
    assert "of a drift ratio of 2 %" in follow("first-wall", clone)
    assert damage.read_history(clone / "first.h5").complete
    assert (clone / "first" / "wall_max.png").stat().st_size > 10_000
    output = follow("reading-results", clone)
    worst = damage.read_history(clone / "first.h5").index()["DI"].max()
    assert f"maximum DI {worst:.4f}" in output
    assert (clone / "first_tables_index.csv").is_file()
    assert (clone / "three_moments.png").stat().st_size > 10_000


@pytest.mark.long
def test_numbers_beside_the_pictures_of_the_gallery(tmp_path):
    names = "harmonic", "softening", "sequence"
    runs = [gallery.run(name, tmp_path) for name in names]
    failed = [run.broken[-1].sum() for run in runs]
    index = [run.index()["DI"] for run in runs]
    residual = [f"{DI.iloc[-1]:.3f}" for DI in index]
    harmonic, softening, sequence = (gallery.GALLERY[name].see for name in names)
    assert f"up to {1e3 * runs[0].opening_m.max():.1f} mm" in harmonic
    assert f"DI reaches {index[0].max():.3f}, of which {residual[0]} remains" in harmonic
    assert f" {failed[1]} contact points fail instead of {failed[0]}." in softening
    assert f"only {residual[1]} of DI remains" in softening
    assert f"the residual DI, to {residual[2]}" in sequence


@pytest.mark.long
def test_a_wall_and_a_study_of_ones_own(clone):
    assert "mode 1: 0.09" in follow("own-wall", clone)
    assert damage.read_history(clone / "house.h5").masonry_wall.lintel.kind == "concrete"
    history = damage.read_history(clone / "two_windows.h5")
    assert len(history.masonry_wall.openings) == 2 and history.broken.any()
    output = follow("own-study", clone)
    points = pd.read_csv(clone / "results" / "my-study" / "tables" / "points.csv")
    assert len(points) == 2 and set(points["wall"]) == {"two-windows"}
    assert f"{points['max_DI'].max():.3f}" in output
    assert (clone / "my_study.html").is_file()


@pytest.mark.long
def test_a_wall_that_was_cracked_before(clone):
    wall = next(text for language, text in blocks("own-wall") if language == "python")
    (clone / "walls/two_windows.py").write_text(wall, encoding="utf-8")
    assert re.search(r"angular distortion +0.000333", follow("groningen", clone))
    runs = [damage.read_history(clone / f"{name}.h5") for name in ("settled", "shaken", "cracked")]
    settled, shaken, cracked = runs
    assert shaken.broken[0].sum() == settled.broken[-1].sum() > 0
    assert cracked.parameters["cracked"]["file"] == "survey.csv"
    before, widened, surveyed = (f"{summary_row(run)['max_crack_width_mm']:.2f}" for run in runs)
    guide = " ".join((GUIDES / "groningen.md").read_text(encoding="utf-8").split())
    assert f"cracks of {before} mm before any earthquake" in guide
    assert f"widens them to {widened} mm" in guide
    assert f"the widest crack is {surveyed} mm instead of {widened} mm" in guide


@pytest.mark.long
@pytest.mark.yade
def test_a_house(clone, yade_command):
    follow("house", clone)
    house = damage.read_history(clone / "small.h5")
    assert house.complete and house.broken.any()
    assert [wall.wall for wall in house.parts] == ["front", "left", "right"]
    corners = pd.read_csv(clone / "small_tables_corners.csv")
    assert set(corners["corner"]) == {"front / left", "front / right"}
    for name in ("small.png", "small/space_max.png", "small.gif", "small.html", "small.vtkhdf"):
        assert (clone / name).stat().st_size > 10_000, name


@pytest.mark.long
def test_a_record_of_ones_own(clone):
    assert "pga" in follow("own-record", clone).lower()
    history = damage.read_history(clone / "my_record.h5")
    assert history.complete and history.series["base_acceleration_x_m_s2"].abs().max() > 0.2 * 9.8


@pytest.mark.long
def test_a_wall_that_was_tested(clone):
    output = follow("tested-wall", clone)
    assert "cohesion = 2.4e+05 " in output
    assert "normal_stiffness = 1.2e+12 " in output
    made = damage.load_wall(clone / "walls" / "comp2_2.toml")
    by_rule = after_peak.tested_wall("COMP2_2")
    assert_same_numbers(made, by_rule, 5e-3)  # bricks of the guide split, too
    assert 1.4 * after_peak.toe_drift(by_rule) == pytest.approx(0.0175, rel=5e-3)


@pytest.mark.long
@pytest.mark.yade
def test_a_scene_for_yade_users(clone, yade_command):
    """The prompt as shown, typed in a terminal; the same script by YADE's own command; engines,
    O.save and O.load."""
    saved = []
    output = follow(
        "yade-users", clone, after_first=lambda: saved.extend(typed_in_the_guide(clone))
    )
    forces = np.loadtxt(clone / "force.csv", delimiter=",")
    assert len(forces) > 80
    assert_allclose(np.diff(forces[:, 0]), 0.01, atol=5e-5)  # each 10 ms, at the end of a step
    by_launcher = (clone / "force.csv").read_bytes()
    history = damage.read_history(clone / "pier.h5")
    assert history.versions["yade_engines"] == "PyRunner(write()), VTKRecorder"
    ground = history.joints.query("first_body < 0")
    share = ground["length_m"] / ground["length_m"].sum()
    joint = int(np.hypot(ground["x_m"] - 0.2, ground["z_m"]).idxmin())
    weight = history.static["weight_n"]
    # corners of a pier carry otherwise
    assert_allclose(forces[-1, 1], -share[joint] * weight, rtol=0.05)
    assert len(list(clone.glob("pier_boxes.*.vtu"))) > 3
    assert f"{-weight:.3f} N on the ground" in output
    assert re.findall(r"([\d.]+) N in \d+ contacts", output) == saved
    status, shown = typed(
        ["yade", "-n", *PIER_RUN, "--quiet", "--overwrite", "--console", "before"],
        ["run.stage, run.time, len(O.engines)", "exit"],
        clone,
    )
    assert status == 0 and "('static', 0.0, 7)" in shown and "the run follows" in shown, shown
    assert (clone / "force.csv").read_bytes() == by_launcher


PIER_RUN = ["pier.py", "--free-vibration", "--rest", "0", "--no-pictures", "--out", "pier.h5"]


def typed_in_the_guide(clone):
    """Type what the guide for YADE users shows at a terminal, and find what it shows there; the
    sums of forces."""
    (text,) = re.findall(
        r"^```text\n(.*?)^```$", (GUIDES / "yade-users.md").read_text(), re.MULTILINE | re.DOTALL
    )
    command, *_ = re.findall(r"^\$ (.*)$", text, re.MULTILINE)
    assert PIER_RUN == command.split()[2:-1]
    status, shown = typed(
        command.split(), re.findall(r"^In \[\d+\]: (.*)$", text, re.MULTILINE), clone
    )
    assert status == 0, shown
    for line in re.findall(r"^Out.*$", text, re.MULTILINE):
        # forces differ between machines in their last digits
        assert re.sub(r"\d+\.\d+ N'$", "", line) in shown, shown
    return re.findall(r"^Out.*'([\d.]+) N'", shown, re.MULTILINE)


def test_every_guide_is_followed_or_has_nothing_to_follow():
    followed = {
        "first-wall",
        "reading-results",
        "own-wall",
        "own-study",
        "own-record",
        "groningen",
        "house",
        "tested-wall",
        "yade-users",
        "from-pip",
    }  # the last in test_from_pip.py
    for path in GUIDES.glob("*.md"):
        assert (path.stem in followed) == bool(BLOCK.search(path.read_text(encoding="utf-8"))), (
            path.name
        )
