"""The compiled functions run once as plain Python: where coverage sees them, and with the same results."""

import ast
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY
from numba.core.dispatcher import Dispatcher
from numpy.testing import assert_allclose

from damage.mechanics import samples, step
from damage.mechanics.compiled import COMPILING, PLAIN
from damage.reference.fast import alone, blocks, together
from damage.reference.fast.compiled import FAST
from damage.reference.wall import ReferenceWall
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.modes import natural_modes
from damage.wall.parameters import Joint, Opening, Wall

WALL = Wall("pier", 0.675, 0.3, [Opening(0.225, 0.225, 0.15)], lintel="courses",
            joint=Joint(tensile_strength=5e3, cohesion=5e4))


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


def fallen(solver):
    """A wall whose bricks are pulled apart by 5 mm and come back."""
    bodies = solver.layout.bodies
    apart = np.zeros((len(bodies), 3))
    apart[:, 1] = 0.005 / 0.075 * (bodies.z - bodies.z.min())
    solver.displacement = apart
    solver.run(3)
    apart[:, 1] *= np.where(bodies.course < 0, 0.0, -1300.0)  # the heavy top mass stays up
    solver.velocity = apart
    solver.run(60)


CASES = {shaken: {}, relaxed: {}, pushed: {}, damped: {"alpha": 5.0, "beta": 1e-6}, fallen: {"new_contacts": True}}


def all_results(fast):
    """{case and quantity: array} of all CASES, by the fast step or the plain one, and of deformable bricks."""
    results, rigid = {}, lay_out(WALL)
    deformable = lay_out(WALL, ModelOptions(bricks="deformable", contacts="gauss"))
    for case, options, layout, label in (*((case, options, rigid, "") for case, options in CASES.items()),
                                         (relaxed, {}, deformable, "deformable_"),
                                         (damped, CASES[damped], deformable, "deformable_")):
        solver = ReferenceWall(layout, 0.3 * natural_modes(layout).critical_time_step_s, fast=fast, **options)
        case(solver)
        steps, joints, kinds, values = solver.drain_events()
        for name, value in {"place": solver.displacement, "velocity": solver.velocity, "force": solver.force,
                            "slip": solver.slip, "opening": solver.opening, "energy": solver.energy,
                            "kinetic": solver.kinetic_energy(), "elastic": solver.elastic_energy(), "values": values,
                            "events": np.column_stack([steps, joints, kinds])}.items():
            results[f"{label}{case.__name__}_{name}"] = value
    return results


@pytest.mark.parametrize("fast", [True, False], ids=["fast", "plain"])
def test_plain_python_gives_what_the_compiled_functions_give(tmp_path, fast):
    """But for fused multiply-adds, which round once instead of twice."""
    done = subprocess.run([sys.executable, __file__, tmp_path / "plain.npz", "fast" if fast else "plain"],
                          capture_output=True, text=True, env={
                              **os.environ, "NUMBA_DISABLE_JIT": "1", "PYTHONPATH": os.pathsep.join(
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


def imports_of(path):
    """Files of this package that a module imports from."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("damage"):
            base = REPOSITORY.joinpath(*node.module.split("."))
            found |= {base / f"{one.name}.py" for one in node.names} | {base.with_suffix(".py")}
    return {path for path in found if path.is_file()}


@pytest.mark.parametrize(("package", "modules"), [
    (PLAIN, [step, samples]), (FAST, [alone, together, blocks])], ids=["plain", "fast"])
def test_all_sources_of_compiled_code_are_in_the_digest(package, modules):
    """What a module of compiled functions imports, directly or not, is compiled into them: functions and constants."""
    compilers = {one.folder / "compiled.py" for one in (PLAIN, FAST)}  # decide how; what they import is not compiled
    to_follow = {path for path in package.folder.glob("*.py") if re.search(
        r"^@(compiled|inlined|entry|inlined_entry)$", path.read_text(), re.MULTILINE)}
    assert len(to_follow) > 4
    needed = {package.folder / "compiled.py"}
    while to_follow:
        needed |= to_follow
        to_follow = {imported for path in to_follow - compilers for imported in imports_of(path)} - needed
    assert set(package.sources) == needed
    functions = [value for module in modules for value in vars(module).values() if isinstance(value, Dispatcher)]
    own = [one for one in functions if one.py_func.__module__.startswith(modules[0].__package__)]
    assert len(own) > 10
    assert all(package.digest in one.py_func.__qualname__ for one in own)


def test_a_function_that_is_no_entry_is_not_called_by_python():
    """It has no code for that: numba would call address zero."""
    with pytest.raises(TypeError, match="clear is for compiled callers: expected one that is declared an entry"):
        blocks.clear(np.zeros(64), np.uint64(0), np.uint64(8))


@pytest.mark.parametrize("elsewhere", [False, True])
def test_machine_code_of_other_sources_is_not_found_whatever_their_times(tmp_path, elsewhere):
    """A file of another version may be older than what is cached, as tar and rsync -a leave it; NUMBA_CACHE_DIR may be
    shared."""
    package = tmp_path / "damage"
    shutil.copytree(REPOSITORY / "damage", package, ignore=shutil.ignore_patterns("__pycache__", "data"))
    env = {**os.environ, "PYTHONPATH": str(tmp_path)}
    if elsewhere:
        env["NUMBA_CACHE_DIR"] = str(tmp_path / "kept")

    def tried():
        """Where a function is cached, and whether the line was printed that the solver is compiled."""
        program = ("from damage.mechanics import cache; from damage.reference.fast import blocks;"
                   "from damage.reference.fast.compiled import FAST;"
                   "import numba, numpy as np;"
                   "arguments = np.zeros(64), np.uint64(0), np.uint64(8);"
                   "blocks.clear.compile(tuple(map(numba.typeof, arguments)));"
                   "print(cache.kept_in(FAST.folder), FAST.digest, sep='\\n')")
        *said, folder, digest = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, check=True, env=env,
                                               capture_output=True, text=True).stdout.splitlines()
        assert said in ([], [COMPILING])
        folder = Path(folder)
        assert folder.is_relative_to(tmp_path / "kept" if elsewhere else package / "reference" / "fast")
        (index,) = folder.glob("blocks.clear-*.nbi")
        assert digest in index.name  # and the machine code of other sources is deleted
        return index, bool(said)

    first, compiles = tried()
    assert compiles and tried() == (first, False)
    for name in ("history/schema.py", "wall/joint_law.py"):
        with (package / name).open("a", encoding="utf-8") as file:
            file.write("\nANOTHER = 1\n")
        os.utime(package / name, (0, 0))
        index, compiles = tried()
        assert compiles and index != first
        first = index


if __name__ == "__main__":
    np.savez(sys.argv[1], **all_results(sys.argv[2] == "fast"))
