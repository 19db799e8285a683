"""A joint law of one's own, as CONTRIBUTING.md says to add it, in a copy of the repository and in
both solvers."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from collections import namedtuple

import pytest
from conftest import REPOSITORY, one_line_error, run_command, written
from numpy.testing import assert_allclose
from test_guides import clone  # noqa: F401

from damage import Joint
from damage.law.joint_law import Material
from yade_scripts import joint_tracker
from yade_scripts.joint_tracker import check_law

SHORT_STAGES = """#!{python}
import runpy, sys
sys.path.insert(0, "")
from damage.run import settings
settings.RAMP_S = settings.HOLD_S = settings.SETTLE_S = 0.02
sys.argv[:] = sys.argv[2:]
runpy.run_module("damage", run_name="__main__", alter_sys=True)
"""
READ = """
import json, math, sys
sys.path.insert(0, "")
import damage
found = []
for solver in "reference", "yade":
    history = damage.read_history(f"{solver}.h5")
    breaks = history.events.query("kind == 'shear'")
    found.append({"shear_n": float(history.series["base_shear_n"].iloc[-20:].mean()),
                  "weight_n": float(history.bodies["mass_kg"].sum() * damage.units.GRAVITY),
                  "friction_j": float(history.series["friction_energy_j"].iloc[-1]),
                  "cohesion_pa": float((breaks["shear_stress_pa"].abs() + math.tan(math.radians(32))
                                        * breaks["normal_stress_pa"]).min())})
print(json.dumps(found))
"""
KEPT = 0.8  # of the walk's wall


def test_what_is_added_to_the_material_has_a_default():
    """Else every call with the friction alone, as tests have it, breaks."""
    assert set(Material._fields) - set(Material._field_defaults) == {"friction"}


FOLDER = "tests/yade/own_law"


def test_the_walk_s_diff_still_applies():
    run_command("git", "apply", "--check", f"{FOLDER}/law.diff", status=0)


@pytest.fixture(scope="module")
def walked(clone, yade_command):  # noqa: F811
    """A copy in which the walk was followed: its commands run in plain Python, since compiling
    takes a minute."""
    shutil.copytree(REPOSITORY / FOLDER, clone / FOLDER)
    section = (REPOSITORY / "CONTRIBUTING.md").read_text().partition("## A joint law")[2]
    commands = re.search(r"^```sh\n(.*?)^```$", section, re.MULTILINE | re.DOTALL)[1]
    program = written(clone.parent / "bin" / "python3", SHORT_STAGES.format(python=sys.executable))
    done = subprocess.run(
        ["bash", "-euc", commands],
        cwd=clone,
        capture_output=True,
        text=True,
        env={
            **os.environ,
            "PATH": f"{program.parent}:{os.environ['PATH']}",
            "PYTHONPATH": "",
            "NUMBA_DISABLE_JIT": "1",
        },
    )
    assert done.returncode == 0, done.stdout + done.stderr
    read = run_command(sys.executable, "-c", READ, cwd=clone, check=True)
    tracker = clone / "yade_scripts" / "joint_tracker.py"
    tracker.write_text(tracker.read_text().replace('"friction_kept",', ""))
    refused = run_command("./yade", "-n", f"{FOLDER}/kept.toml", "--pushover", "0.12", cwd=clone)
    return done.stdout, *json.loads(read.stdout), refused


@pytest.mark.yade
@pytest.mark.long
def test_both_solvers_end_with_the_friction_that_is_kept(walked):
    printed, reference, yade, _ = walked
    assert "verdict: within the tolerances" in printed
    by_hand = KEPT * math.tan(math.radians(32)) * reference["weight_n"]
    assert_allclose([reference["shear_n"], yade["shear_n"]], by_hand, rtol=5e-3)
    assert_allclose(yade["shear_n"], reference["shear_n"], rtol=1e-3)
    assert_allclose(yade["friction_j"], reference["friction_j"], rtol=5e-3)
    assert f"{by_hand / 1e3:.2f} kN" in (REPOSITORY / "CONTRIBUTING.md").read_text()
    # A bond fails by its cohesion and all of its friction: only what slides has less.
    assert_allclose(reference["cohesion_pa"], 0.24e6, rtol=0.05)


@pytest.mark.yade
@pytest.mark.long
def test_yade_refuses_a_law_that_it_is_not_said_to_follow(walked):
    refused = walked[-1]
    assert refused.returncode == 2 and "Traceback" not in refused.stderr
    assert (
        "joint law with friction_kept = 0.8: expected 1.0, as YADE's joints do not follow it"
        in refused.stderr
    )


def test_yade_knows_every_number_of_today_s_law(monkeypatch):
    """One of a law that softens in another way, of the Material alone, is refused."""
    check_law(
        Joint(
            mode_i_fracture_energy=10.0,
            mode_ii_fracture_energy=100.0,
            compressive_strength=1e7,
            compressive_fracture_energy=1e4,
            friction_angle=0.5,
        )
    )
    softer = namedtuple("Material", ["friction", "softening_power"], defaults=[1.0])
    monkeypatch.setattr(joint_tracker, "material_of", lambda joint: softer(0.6))
    check_law(Joint())
    monkeypatch.setattr(joint_tracker, "material_of", lambda joint: softer(0.6, 2.0))
    assert "joint law with softening_power = 2.0: expected 1.0" in one_line_error(
        check_law, Joint()
    )
