"""One source of the time step in two widths: a wall has the same bits alone and as any of eight,
whatever the others do, and those of plain Python but for fused multiply-adds."""

import ast
import fcntl
import gc
import os
import re
import shutil
import sys
import weakref
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY, in_python, run_command
from numba.core.dispatcher import Dispatcher
from numpy.testing import assert_allclose
from short_runs import solver_of

from damage import Brick, Joint, ModelOptions, Opening, Wall
from damage.law.states import ENDED, FAILED
from damage.mechanics import bodies, samples, step
from damage.mechanics.compiled import COMPILING, DIGEST, SOURCES, alone, kept_in
from damage.mechanics.simd import ONE
from damage.mechanics.tables import HAS_FAILED, RIGID
from damage.motion.loading import Harmonic
from damage.reference import ensembles
from damage.reference.lanes import MOST_LANES, run_together
from damage.reference.solver import ReferenceSolver
from damage.wall.layout import lay_out

WEAK = {"tensile_strength": 3e4, "cohesion": 8e4}
KINDS = {
    "brittle": (WEAK, {}),
    "deformable": (
        {"tensile_strength": 1e3, "cohesion": 1e3},
        {"bricks": "deformable", "contacts": "gauss"},
    ),
}
ACTIONS = {
    "shaken": {},
    "shaken vertically, too": {"vertical": 8.0},
    "damped by mass": {"alpha": 5.0},
    "damped by stiffness": {"beta": 1e-6},
    "local damping": {"local": 0.2},
    "adaptive damping": {"adaptive": 1.0},
    "pushed": {"push": 0.5},
    "pushed at two floors": {"push": 0.5, "spread": 2.0, "local": 0.7},
    "pushed to and fro": {"push": 1.0, "to_and_fro": True, "adaptive": 1.0},
    "hardly shaken": {"pga_g": 0.01},
    "damped by both": {"alpha": 2.0, "beta": 2e-6},
}


def make(kind, seed=0, **more):
    """A small wall with an opening, at rest and still without its weight; seed: of scattered
    strengths, 0 for none."""
    joint, options = KINDS[kind]
    wall = Wall(
        "pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses", joint=Joint(**joint)
    )
    scatter = {"strength_cov": 0.3, "strength_seed": seed} if seed else {}
    layout = lay_out(wall, ModelOptions(**options, **scatter))
    return solver_of(layout, 0.3, **more)


def begin(wall, push=0.0, to_and_fro=False, spread=0.0, vertical=0.0, pga_g=2.0, **damping):
    """Start a wall that has settled."""
    wall.damp(**damping)
    deforms = wall.strain is not None
    time_s = np.arange(600) * wall.time_step
    period_s = 0.004 if deforms else 0.02
    base = (
        Harmonic(period_s, pga_g * (2.5 if deforms else 1.0)).base_acceleration(time_s)
        if not push
        else np.zeros((600, 2))
    )
    base[:, 1] = vertical * np.cos(2 * np.pi * time_s / 0.03)
    wall.start(base)
    if spread:
        z = wall.layout.bodies.z
        shares = np.where(z > z.mean(), spread, 1.0) * wall.layout.bodies.mass
        wall.spread(shares / shares.sum())
    elif push:
        wall.hold(
            wall.layout.pushed_bodies, rotation=to_and_fro, stiffness=0.0 if to_and_fro else 1e5
        )


def push_on(wall, sample, push=0.0, to_and_fro=False, **_):
    """Set the speed of the top of a wall that is pushed, before a sample."""
    if push:
        wall.push(-push if to_and_fro and sample % 4 > 1 else push)


def act(wall, **action):
    """Let a wall settle and be shaken, or pushed, by itself; yields what its samples hold."""
    wall.damp(local=0.7)
    wall.run(200)
    begin(wall, **action)
    for sample in range(12):
        push_on(wall, sample, **action)
        wall.run(30, 20)
        yield everything(wall)


def act_together(walls, actions):
    """As `act`, of walls that advance together."""
    for wall in walls:
        wall.damp(local=0.7)
    run_together(walls, 200)
    for wall, action in zip(walls, actions):
        begin(wall, **action)
    for sample in range(12):
        for wall, action in zip(walls, actions):
            push_on(wall, sample, **action)
        assert run_together(walls, 30, 20) == [None] * len(walls)
        assert len(walls[0].lanes.walls) == min(len(walls), MOST_LANES)
        yield [everything(wall) for wall in walls]


def everything(wall):
    """State, events and present sample of a wall, as bytes."""
    # of no use without their damping
    of_use = wall.system._replace(relaxation=np.zeros(0), last=np.zeros(0))
    fields = [
        table if table.dtype.names is None else table[name]
        for table in of_use
        for name in table.dtype.names or ("",)
    ]
    instants = wall.instants()
    sample = [
        *instants.contacts.values(),
        *(value for value in instants if value is not instants.contacts),
    ]
    return as_bytes(
        [*fields, *np.atleast_1d(np.array(wall.drain_events(), dtype=object).astype(str)), *sample]
    )


def as_bytes(parts):
    return [
        np.ascontiguousarray(part).tobytes()
        for part in parts
        if part is not None and not isinstance(part, slice)
    ]


# --- the same bits in both widths -----------------------------------------------------------------


@pytest.mark.parametrize("kind", ["brittle", pytest.param("deformable", marks=pytest.mark.long)])
def test_a_wall_has_the_same_bits_alone_and_as_any_member_of_a_batch(kind):
    """Each member has strengths, a time step, damping and a motion of its own; ten are more than
    one batch.  Laws, bricks and springs that differ: `test_grid.py`."""

    def members():
        walls = [make(kind, seed) for seed in range(len(ACTIONS))]
        walls[5].time_step *= 0.9
        return walls

    assert len(ACTIONS) > MOST_LANES
    alone = members()
    expected = [list(act(wall, **action)) for wall, action in zip(alone, ACTIONS.values())]
    for order in (range(10), range(9, -1, -1), (3, 0, 7)):
        walls = members()
        actions = [[*ACTIONS.values()][k] for k in order]
        for sample, found in enumerate(act_together([walls[k] for k in order], actions)):
            assert found == [expected[k][sample] for k in order], sample
    failed = np.array([wall.system.states["broken"] > 0 for wall in alone])
    assert (failed.any(axis=0) & ~failed.all(axis=0)).any()  # in some of the walls


@pytest.mark.long
def test_joints_of_deformable_bricks_end_each_by_itself():
    """Three dry pairs are pushed at different speeds; the two fast ones reach their joint's end."""
    joint = Joint(tensile_strength=0.0, cohesion=0.0)
    wall = Wall("pair", 0.1125, 0.15, precompression=0.0, joint=joint)
    layout = lay_out(wall, ModelOptions(bricks="deformable", contacts="gauss", lintel="none"))
    speeds = 2.5, 0.1, -2.0
    together, alone = [[ReferenceSolver(layout, 4e-6) for _ in speeds] for _ in range(2)]
    for one, speed in zip([*together, *alone], speeds * 2):
        one.system.inverse_mass[0, :RIGID] = 0.0
        one.hold(np.array([1]), rotation=True)
        one.push(speed)
    for _ in range(10):
        run_together(together, 3000, 50)
        for one, other in zip(together, alone):
            other.run(3000, 50)
            assert everything(one) == everything(other)
    ends = [one.system.limits[-1, HAS_FAILED] for one in together]
    assert ends == [ENDED, FAILED, ENDED]


def test_walls_of_other_bricks_soil_or_strain_modes_are_reported():
    def built(joint=(), **options):
        wall = Wall(
            "w",
            0.9,
            0.45,
            joint=Joint(**WEAK | dict(joint)),
            brick=Brick(young_modulus=options.pop("young", 5e9)),
        )
        return ReferenceSolver(lay_out(wall, ModelOptions(**options)), 1e-6)

    for one, other in (
        (built(), built(cells=3)),
        (built(bricks="deformable"), built(bricks="deformable", young=5.2e9)),
    ):
        with pytest.raises(ValueError, match="other bricks"):
            run_together([one, other], 10)
        assert ensembles.move([(one, 1), (other, 1)]) == [None, None]


@pytest.mark.parametrize("n_walls, kind", [(3, "brittle"), (1, "deformable")])
def test_tables_are_freed_with_the_walls_without_the_garbage_collector(n_walls, kind):
    """A study runs thousands of walls in a process, whose few objects hold megabytes and hardly
    ever start it."""
    walls = [make(kind, seed) for seed in range(1, n_walls + 1)]
    run_together(walls, 1)
    left = [weakref.ref(one) for one in (*walls, walls[0].lanes)]
    gc.disable()
    try:
        del walls
        assert [one() for one in left] == [None] * (n_walls + 1)
    finally:
        gc.enable()


# --- plain Python ---------------------------------------------------------------------------------

SMALL = Wall(
    "pier",
    0.675,
    0.3,
    [Opening(0.225, 0.225, 0.15)],
    lintel="courses",
    joint=Joint(tensile_strength=5e3, cohesion=5e4),
)


def shaken(walls, run):
    """Walls that settle and are shaken until joints open and slide by more than the threshold."""
    for wall in walls:
        wall.local_damping = 0.7
    run(50)
    for k, wall in enumerate(walls):
        wall.local_damping = 0.0
        time = np.arange(250) * wall.time_step
        wall.start(
            (1.0 + k) * np.column_stack([500 * np.sin(1200 * time), -400 * np.cos(2400 * time)])
        )
    run(300)


def relaxed(walls, run):
    for wall in walls:
        wall.adaptive_damping = 1.0
    run(30)


def pushed(walls, run):
    for k, wall in enumerate(walls):
        wall.hold(wall.layout.pushed_bodies, rotation=True)
        wall.push(0.5 + k)
    run(60)


def damped(walls, run):
    for k, wall in enumerate(walls):
        wall.velocity = 0.02 * (1 - k)
    run(60)


CASES = {shaken: {}, relaxed: {}, pushed: {}, damped: {"alpha": 5.0, "beta": 1e-6}}


def all_results(n_walls):
    """{case and quantity: array} of the first of so many walls in all CASES, also of deformable
    bricks."""
    results = {}
    rigid = lay_out(SMALL)
    deformable = lay_out(SMALL, ModelOptions(bricks="deformable", contacts="gauss"))
    for case, options, layout, label in (
        *((case, options, rigid, "") for case, options in CASES.items()),
        (relaxed, {}, deformable, "deformable_"),
        (damped, CASES[damped], deformable, "deformable_"),
    ):
        walls = [solver_of(layout, 0.3, **options) for _ in range(n_walls)]
        case(walls, lambda steps, walls=walls: run_together(walls, steps))
        wall = walls[0]
        steps, joints, kinds, values = super(ReferenceSolver, wall).drain_events()
        for name, value in {
            "place": wall.displacement,
            "velocity": wall.velocity,
            "force": wall.force,
            "slip": wall.slip,
            "opening": wall.opening,
            "energy": wall.energy,
            "kinetic": wall.kinetic_energy(),
            "elastic": wall.elastic_energy(),
            "values": values,
            "events": np.column_stack([steps, joints, kinds]),
        }.items():
            results[f"{label}{case.__name__}_{name}"] = value
    return results


@pytest.mark.parametrize("n_walls", [1, pytest.param(2, marks=pytest.mark.long)])
def test_plain_python_gives_what_the_compiled_functions_give(tmp_path, n_walls):
    """But for fused multiply-adds, which round once instead of twice.  Vectors are arrays there."""
    in_python(
        "import numpy, test_widths as t; "
        f"numpy.savez({str(tmp_path / 'plain.npz')!r}, **t.all_results({n_walls}))",
        NUMBA_DISABLE_JIT="1",
    )
    plain = np.load(tmp_path / "plain.npz")
    compiled = all_results(n_walls)
    assert set(compiled["shaken_events"][:, 2]) == {1, 2, 3, 4}  # tension, shear, opened, slipped
    assert set(plain) == set(compiled)
    for name, value in compiled.items():
        if name.endswith("events"):
            assert np.array_equal(plain[name], value), name
        else:
            scale = np.max(np.abs(value), initial=0.0) or 1.0
            assert_allclose(plain[name] / scale, value / scale, rtol=0, atol=1e-8, err_msg=name)


# --- machine code that is kept --------------------------------------------------------------------


def test_processes_that_begin_together_compile_one_after_the_other():
    """So that the second finds the machine code of the first."""
    name = "test.lock"
    with alone(name), (kept_in() / name).open("w") as other, pytest.raises(BlockingIOError):
        fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)
    with (kept_in() / name).open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)
    (kept_in() / name).unlink()


def imports_of(path):
    """Files of this package that a module imports from."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("damage"):
            base = REPOSITORY.joinpath(*node.module.split("."))
            found |= {base / f"{one.name}.py" for one in node.names} | {base.with_suffix(".py")}
    return {path for path in found if path.is_file()}


def test_all_sources_of_compiled_code_are_in_the_digest():
    """What a module of compiled functions imports, directly or not, is compiled into them:
    functions and constants."""
    compiler = SOURCES[0]  # decides how; what it imports is not compiled
    to_follow = {
        path
        for path in compiler.parent.glob("*.py")
        if re.search(r"^@(compiled|inlined|entry)$", path.read_text(), re.MULTILINE)
    }
    assert len(to_follow) > 4
    needed = {compiler}
    while to_follow:
        needed |= to_follow
        to_follow = {
            imported for path in to_follow - {compiler} for imported in imports_of(path)
        } - needed
    assert set(SOURCES) == needed
    own = [
        value
        for module in (step, samples)
        for value in vars(module).values()
        if isinstance(value, Dispatcher) and value.py_func.__module__.startswith("damage.mechanics")
    ]
    assert len(own) > 10
    assert all(DIGEST in one.py_func.__qualname__ for one in own)


def test_a_function_that_is_no_entry_is_not_called_by_python():
    """It has no code for that: numba would call address zero."""
    with pytest.raises(
        TypeError, match="turn_far is for compiled callers: expected one that is declared an entry"
    ):
        bodies.turn_far(ONE, np.zeros((1, 40, 1)), 0, 1, 0.5)


def test_machine_code_of_other_sources_is_not_found_whatever_their_times(tmp_path):
    """A file of another version may be older than what is cached, as tar and rsync -a leave it;
    NUMBA_CACHE_DIR may be shared."""
    package = tmp_path / "damage"
    shutil.copytree(
        REPOSITORY / "damage", package, ignore=shutil.ignore_patterns("__pycache__", "data")
    )
    env = {**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "kept")}

    def tried():
        """Where a function is cached, and whether the line was printed that the solver is
        compiled."""
        program = (
            "from damage.mechanics import bodies, compiled, simd;import numba, numpy as"
            " np;bodies.turn_far.compile(tuple(map(numba.typeof, (simd.ONE, np.zeros((1, 40, 1)),"
            " 0, 1, 0.5))));print(compiled.kept_in(), compiled.DIGEST, sep='\\n')"
        )
        *said, folder, digest = run_command(
            sys.executable, "-c", program, cwd=tmp_path, check=True, env=env
        ).stdout.splitlines()
        assert said[:1] in ([], [COMPILING])  # and lines while that lasts
        folder = Path(folder)
        assert folder.is_relative_to(tmp_path / "kept")
        (index,) = folder.glob("bodies.turn_far-*.nbi")
        assert digest in index.name  # and the machine code of other sources is deleted
        return index, bool(said)

    first, compiles = tried()
    assert compiles and tried() == (first, False)
    os.utime(package / "mechanics/bodies.py")  # as an update of other files or pip does
    assert tried() == (first, False)
    with (package / "law/joint_law.py").open("a", encoding="utf-8") as file:
        file.write("\nANOTHER = 1\n")
    os.utime(package / "law/joint_law.py", (0, 0))
    index, compiles = tried()
    assert compiles and index != first
