"""The compiled functions run once as plain Python: where coverage sees them, and with the same results."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY
from numpy.testing import assert_allclose

from damage.reference.wall import ReferenceWall
from damage.wall.layout import lay_out
from damage.wall.modes import natural_modes
from damage.wall.parameters import Joint, Opening, Wall

WALL = Wall("pier", 0.675, 0.3, [Opening(0.225, 0.225, 0.15)], joint=Joint(tensile_strength=5e3, cohesion=5e4))


def shaken(solver):
    """A wall that settles and is shaken until joints open and slide by more than the threshold."""
    solver.local_damping = 0.7
    solver.run(50)
    solver.local_damping = 0.0
    time = np.arange(250) * solver.time_step
    solver.start(np.column_stack([500 * np.sin(1200 * time), -400 * np.cos(2400 * time)]))
    solver.run(300)


def relaxed(solver):
    solver.adaptive_damping = 1.0
    solver.run(30)


def pushed(solver):
    solver.hold(solver.layout.pushed_bodies, rotation=True)
    solver.push(0.5)
    solver.run(60)


def damped(solver):
    solver.velocity = 0.02
    solver.run(60)


CASES = {shaken: {}, relaxed: {}, pushed: {}, damped: {"alpha": 5.0, "beta": 1e-6}}


def all_results(fast):
    """{case and quantity: array} of all CASES, by the fast step or the plain one."""
    layout = lay_out(WALL)
    results = {}
    step = 0.3 * natural_modes(layout).critical_time_step_s
    for case, options in CASES.items():
        solver = ReferenceWall(layout, step, fast=fast, **options)
        case(solver)
        steps, joints, kinds, values = solver.drain_events()
        for name, value in {"place": solver.displacement, "velocity": solver.velocity, "force": solver.force,
                            "slip": solver.slip, "opening": solver.opening, "energy": solver.energy,
                            "kinetic": solver.kinetic_energy(), "values": values,
                            "events": np.column_stack([steps, joints, kinds])}.items():
            results[f"{case.__name__}_{name}"] = value
    return results


@pytest.mark.parametrize("fast", [True, False], ids=["fast", "plain"])
def test_plain_python_gives_what_the_compiled_functions_give(tmp_path, fast):
    """But for fused multiply-adds, which round once instead of twice."""
    done = subprocess.run([sys.executable, __file__, tmp_path / "plain.npz", "fast" if fast else "plain"], capture_output=True, text=True,
                          env={**os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(
                              [str(REPOSITORY), os.environ.get("PYTHONPATH", "")])})
    assert done.returncode == 0, done.stderr
    plain, compiled = np.load(tmp_path / "plain.npz"), all_results(fast)
    assert set(compiled["shaken_events"][:, 2]) == {1, 2, 3, 4}  # tension, shear, opened, slipped
    for name, value in compiled.items():
        if name.endswith("events"):
            assert np.array_equal(plain[name], value), name
        else:
            scale = np.max(np.abs(value), initial=0.0) or 1.0
            assert_allclose(plain[name] / scale, value / scale, rtol=0, atol=1e-8, err_msg=name)


if __name__ == "__main__":
    np.savez(sys.argv[1], **all_results(sys.argv[2] == "fast"))


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_newer_law_is_compiled_anew(tmp_path, elsewhere):
    """numba's cache looks at the kernel's own file: without a look at the law's it would go on with the old one, in a
    folder that NUMBA_CACHE_DIR names, too."""
    package = tmp_path / "damage"
    shutil.copytree(REPOSITORY / "damage", package, ignore=shutil.ignore_patterns("__pycache__", "data"))
    env = {**os.environ, "PYTHONPATH": str(tmp_path)}
    if elsewhere:
        env["NUMBA_CACHE_DIR"] = str(tmp_path / "kept")
    told = subprocess.run([sys.executable, "-c", "from damage.mechanics import cache; print(cache.kept_in())"],
                          cwd=tmp_path, check=True, env=env, capture_output=True, text=True).stdout
    folder = Path(told.strip())
    assert folder.is_relative_to(tmp_path / "kept" if elsewhere else package / "mechanics")
    index = folder / "contacts.spring-1.py311.nbi"
    index.parent.mkdir(parents=True, exist_ok=True)
    index.touch()
    os.utime(package / "mechanics" / "tables.py", (0, 0))
    law = package / "wall" / "joint_law.py"
    for age_s, kept in ((-10, True), (10, False)):
        os.utime(law, (index.stat().st_mtime + age_s,) * 2)
        subprocess.run([sys.executable, "-c", "import damage.reference.fast.step"], cwd=tmp_path, check=True, env=env)
        assert index.exists() == kept
