"""Selective mass scaling: periods by their closed form, energies, equal bits in both widths, the
factor beside SciPy's, which runs are accepted, and the symmetric wall beside explicit steps."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import REPOSITORY, in_python, parsed, refused_with
from numpy.testing import assert_allclose
from pytest import approx
from scipy.linalg import eigh
from scipy.sparse.linalg import splu
from short_runs import SMALL

from damage import ModelOptions, Wall, load_wall, run
from damage.errors import RunError
from damage.house.drawn import drawn, ranges
from damage.linear.modes import Modes, inside_lintels, mass_vector, natural_modes, stiffness_matrix
from damage.mechanics.factor import scaled_mass
from damage.mechanics.tables import DAMPING
from damage.reference.lanes import run_together
from damage.reference.wall import ReferenceWall
from damage.run import monitor, scheme
from damage.run.monitor import Borne
from damage.run.schedule import STEP_FACTOR
from damage.wall.kinds import LINTEL_COURSE
from damage.wall.layout import lay_out
from damage.wall.restraints import Restraint

SYMMETRIC = REPOSITORY / "walls" / "variants" / "symmetric_softening.py"
SHAKEN = {"harmonic": (0.06, 0.4), "cycles": 2, "rest": 0.1}
MILDLY = SHAKEN | {"harmonic": (0.06, 0.25)}


SOFT = replace(
    SMALL, joint=replace(SMALL.joint, mode_i_fracture_energy=10.0, mode_ii_fracture_energy=100.0)
)


@pytest.fixture(scope="module")
def layout():
    return lay_out(SOFT)


def modes_of(critical_s, masonry_s=None, period_s=0.06):
    """Modes of which the rule of steps asks, in place of those of a wall."""
    return Modes(np.array([period_s]), None, critical_s, masonry_s or critical_s)


def free_wall(layout, time_step, scaled=slice(None), **how):
    """A wall without weight, at rest."""
    wall = ReferenceWall(layout, time_step, scaled=scaled, **how)
    wall.start(np.zeros((0, 2)), np.zeros(1))
    return wall


@pytest.mark.parametrize("mode, time_step", [(0, 1e-4), (3, 2e-4)])
def test_a_mode_vibrates_with_the_period_of_the_closed_form(mode, time_step):
    """sin(omega' dt / 2) = dt / 2 omega / sqrt(1 + dt^2 omega^2 / 2): T1 to T4 of the symmetric
    wall, 5 to 30 Hz."""
    layout = lay_out(load_wall(SYMMETRIC))
    modes = natural_modes(layout)
    exact = 2 * np.pi / modes.period_s[mode]
    slower = (
        2 / time_step * np.arcsin(time_step / 2 * exact / np.sqrt(1 + time_step**2 * exact**2 / 2))
    )
    wall = free_wall(layout, time_step)
    shape = 1e-7 * modes.shape[mode]
    n = round(9.75 * 2 * np.pi / slower / time_step)
    wall.displacement = shape
    wall.velocity = shape * (1 - np.cos(slower * time_step)) / time_step
    wall.run(n)
    mass = mass_vector(layout)
    now = (
        (mass * wall.displacement.ravel())
        @ shape.ravel()
        / ((mass * shape.ravel()) @ shape.ravel())
    )
    assert now == approx(np.cos(slower * n * time_step), abs=1e-5)
    assert abs(now - np.cos(exact * n * time_step)) > 1e-4


def keeps_its_energy(layout, samples, steps):
    wall = free_wall(layout, 1e-4)
    wall.velocity = 1e-8 * natural_modes(layout).shape[0]
    total = []
    for _ in range(samples):
        total.append(wall.kinetic_energy() + wall.elastic_energy() + wall.energy[DAMPING])
        wall.run(steps)
    assert_allclose(total, total[0], rtol=1e-7)


def test_kinetic_energy_with_the_matrix_closes_the_balance_of_a_linear_wall(layout):
    keeps_its_energy(layout, 20, 13)


def in_plain_python():
    """Steps of walls whose compilation takes longer than they do."""
    soil = ModelOptions(soil="1e9")
    deformable = ModelOptions(bricks="deformable", contacts="gauss")
    for model in (deformable, soil):
        for held in (False, True):
            solves_as_scipy_does(lay_out(SOFT, model), held)
    wall = Wall("w", 0.45, 0.3, joint=SOFT.joint)
    keeps_its_energy(lay_out(wall, deformable), 3, 7)
    for model in (ModelOptions(), deformable):
        for scaled in (slice(None), None):
            is_as_among_two(lay_out(replace(wall, height=0.15), model), scaled)


def is_as_among_two(layout, scaled):
    """A wall has the same bits alone and beside another; scaled: as of a ReferenceWall."""
    alone, first, second = (ReferenceWall(layout, 1e-5, scaled=scaled) for _ in range(3))
    for wall, peak in ((alone, 1e3), (first, 1e3), (second, 2e3)):
        wall.start(np.column_stack([np.full(20, peak), np.zeros(20)]))
    alone.run(8)
    run_together([first, second], 8)
    for name in ("place", "velocity", "force", "states"):
        one, other = (getattr(wall.system, name).tolist() for wall in (alone, first))
        assert one == other, name


def test_a_step_solves_with_the_matrix_as_scipy_does(layout):
    for held in (False, True):
        solves_as_scipy_does(layout, held)
    in_python("import test_mass_scaling as t; t.in_plain_python()", NUMBA_DISABLE_JIT="1")


def test_a_brick_on_the_ground_without_neighbours_is_scaled():
    layout = lay_out(Wall("one", 0.225, 0.075, joint=SOFT.joint, precompression=0.0))
    assert len(layout.bodies) == 1
    solves_as_scipy_does(layout, False)


def solves_as_scipy_does(layout, held, scaled=slice(None)):
    wall = free_wall(layout, 2e-4, scaled, beta=1e-6)
    if held:
        wall.hold(layout.pushed_bodies, rotation=True)
    n = len(layout.bodies)
    size = wall.system.place.shape[1]
    place = 1e-8 * np.random.default_rng(1).normal(size=(n, size))
    place[wall.system.inverse_mass[:n] == 0] = 0.0
    wall.system.place[:n] = place
    wall.displacement = place[:, :3]
    force = wall.system.force[:n].copy()
    if layout.strain:
        force[:, 3:] -= layout.strain.stiffness * place[:, 3:]
    force = force.ravel()
    wall.run(1)
    force[wall.system.inverse_mass[:n].ravel() == 0] = 0.0
    expected = 2e-4 * splu(wall.mass.whole.sparse().tocsc()).solve(force)
    found = wall.system.velocity[:n].ravel()
    assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


def test_the_matrix_is_that_of_the_definition(layout):
    whole = scaled_mass(layout, 2e-4, 1e-6).whole
    expected = (
        np.diag(mass_vector(layout))
        + 0.5 * 2e-4 * (2e-4 + 1e-6) * stiffness_matrix(layout).toarray()
    )
    assert_allclose(whole.sparse().toarray(), expected, rtol=1e-12, atol=1e-12)


class TestLintels:
    @pytest.fixture(scope="class")
    def wall(self):
        return replace(SOFT, lintel="timber")

    def test_scaled_ones_limit_no_step_and_nothing_else_is_scaled(self, wall):
        """The bound is that of a mediant: K1 + K2 over M + dt^2/2 K2 is at most the larger one of
        K1 over M and 2/dt^2."""
        layout = lay_out(wall)
        modes = natural_modes(layout)
        inside = inside_lintels(layout)
        step = modes.masonry_time_step_s
        assert inside.any() and step > 1.3 * modes.critical_time_step_s
        scaled = scaled_mass(layout, step, 0.0, points=inside).whole.sparse().toarray()
        stiffness = stiffness_matrix(layout).toarray()
        mass = mass_vector(layout)
        added = (scaled - np.diag(mass)).reshape(len(layout.bodies), 3, -1)
        of_lintel = layout.bodies.course == LINTEL_COURSE
        assert not added[~of_lintel].any() and added[of_lintel].any(axis=(1, 2)).all()
        squared = eigh(stiffness, scaled, eigvals_only=True)
        assert 2 / np.sqrt(squared[-1]) > 0.999 * step
        assert 2 * np.pi / np.sqrt(squared[:3]) == approx(modes.period_s[:3], rel=1e-4)

    def test_a_step_couples_the_beams_alone(self, wall):
        layout = lay_out(wall)
        for held in (False, True):
            solves_as_scipy_does(layout, held, inside_lintels(layout))
        matrix = scaled_mass(layout, 2e-4, 1e-6, points=inside_lintels(layout)).matrix
        of_others = np.flatnonzero(layout.bodies.course != LINTEL_COURSE)
        assert matrix.body[: matrix.alone].tolist() == of_others.tolist()

    def test_tops_that_are_held_otherwise_have_masses_of_their_own(self, wall):
        fixed, free = (
            lay_out(replace(wall, restraints=[Restraint("top", rotation)]))
            for rotation in ("fixed", "free")
        )
        keys = {
            scaled_mass(one, 2e-4, 1e-6, points=inside_lintels(one)).key for one in (fixed, free)
        }
        assert len(keys) == 2

    def test_other_runs_keep_all_masses(self, wall):
        asked = parsed("--settling local")
        (settings, _), *_ = scheme.schemes(asked, wall, modes_of(4e-5, 8e-5))
        assert settings.mass_scaling == "none"

    def test_a_wall_on_ground_that_settles_moves_as_in_explicit_steps(self, wall):
        how = SHAKEN | {"settle": "hogging", "distortion": 1 / 600, "settling": "adaptive"}
        scaled = run(wall, **how)
        explicit = run(wall, **how, mass_scaling="none")
        assert (scaled.parameters["mass_scaling"], scaled.parameters["repeats"]) == ("lintels", 0)
        assert scaled.time_step_s > 2 * explicit.time_step_s and explicit.broken.any()
        found, expected = (one.series["drift_ratio"].abs().max() for one in (scaled, explicit))
        assert found == approx(expected, rel=0.01)


@pytest.mark.long
@pytest.mark.parametrize(
    "inputs, lintel", [("given", None), ("typical", None), ("given", "timber")]
)
def test_a_wall_has_the_same_bits_alone_and_among_eight(layout, inputs, lintel):
    """Each wall whose inputs are drawn has a mass matrix of its own."""
    of = replace(layout.wall, lintel=lintel) if lintel else layout.wall

    def shaken(level):
        wall = lay_out(drawn(of, ranges(inputs), level), layout.options)
        step = 2e-4 if inputs == "given" else 2e-4 - 5e-6 * level
        scaled = slice(None)
        if lintel:
            step = 0.6 * natural_modes(wall).masonry_time_step_s
            scaled = inside_lintels(wall)
            level *= 30
        wall = ReferenceWall(wall, step, beta=1e-6, scaled=scaled)
        turns = np.arange(800) / 300
        wall.start(level * np.column_stack([np.sin(2 * np.pi * turns), 0 * turns]))
        return wall

    walls = [shaken(level) for level in range(2, 8)]
    alone = shaken(6)
    run_together(walls, 400, 400)
    alone.run(400, 400)
    other = walls[4]
    assert np.count_nonzero(alone.state) > 5
    for name in ("place", "velocity", "force", "states", "energy"):
        one, two = (getattr(wall.system, name).tolist() for wall in (alone, other))
        assert one == two
    assert alone.kinetic_energy() == other.kinetic_energy()


@pytest.mark.parametrize("dt", [1e-5, 1e-3])
def test_steps_below_the_explicit_one_and_beyond_what_was_shown_are_refused(dt):
    said = "expected more than the critical one"
    refused_with(said, run, SOFT, **SHAKEN, mass_scaling="selective", dt=dt)


@pytest.mark.parametrize(
    "words, step_s",
    [
        ("", 1e-4),
        ("--sequence 1,0.5", 1e-4),
        ("--lintel none", 1e-4),
        ("--bricks deformable --contacts gauss", 5e-5),
        ("--mass-scaling none", None),
        ("--dt 1e-5", None),
        ("--pushover 0.1", None),
        ("--free-vibration", None),
        ("--settle hogging", None),
        ("--settle hogging --harmonic 0.2 0.05", None),
        ("--settle hogging --harmonic 0.2 0.05 --settling adaptive", None),
        ("--contacts gauss", None),
        ("--bricks deformable", None),
        ("--soil 1e8", None),
        ("--settling local", None),
        ("--relaxation local", None),
    ],
)
def test_the_rule_takes_larger_steps_where_they_were_compared(words, step_s):
    """Steps of a stiff wall with an opening and softening joints; None: explicit."""

    def of(wall, period_s=0.06):
        (settings, step), *_ = scheme.schemes(
            parsed(words), wall, modes_of(4e-5, period_s=period_s)
        )
        return step if settings.mass_scaling == "selective" else None

    assert of(SOFT) == step_s
    assert of(SOFT, 0.2) == (2e-4 if step_s == 1e-4 else step_s)
    assert of(SMALL) is None and of(replace(SOFT, openings=())) is None
    assert of(replace(SOFT, brick=replace(SOFT.brick, tensile_strength=1e6))) is None


@pytest.mark.parametrize(
    "words, shares, first",
    [
        ("", [1.286, 0.643, 0.35], "lintels"),
        ("--mass-scaling lintels", [1.286, 0.643, 0.35], "lintels"),
        ("--mass-scaling none", [0.35], "none"),
    ],
)
def test_on_ground_that_settles_large_explicit_steps_come_first(words, shares, first):
    """Larger ones, where lintels limit the critical step."""
    words = f"--settle hogging --harmonic 0.2 0.05 --settling adaptive {words}"
    settings = parsed(words)
    found = scheme.schemes(settings, SOFT, modes_of(4e-5, 8e-5))
    assert [one.mass_scaling for one, _ in found] == [first] + ["none"] * (len(shares) - 1)
    assert [step / 4e-5 for _, step in found] == approx(shares, rel=0.02)
    if settings.mass_scaling is None:
        alone = scheme.schemes(settings, SOFT, modes_of(4e-5))
        assert alone == found[1:]


@pytest.mark.parametrize("masonry_s, words", [(4e-5, ""), (8e-5, "--dt 1e-5")])
def test_scaled_lintels_that_change_no_step_are_refused(masonry_s, words):
    settings = parsed(f"--mass-scaling lintels {words}")
    refused_with("no --dt", scheme.schemes, settings, SOFT, modes_of(4e-5, masonry_s))


class TestAcceptance:
    def test_an_explicit_run_replaces_those_that_are_not_accepted(self, monkeypatch, tmp_path):
        monkeypatch.setattr(scheme, "ACCEPTED_ERROR", 0.0)
        explicit = run(SOFT, **SHAKEN, mass_scaling="none")
        found = run(SOFT, **SHAKEN, mass_scaling="selective", out=str(tmp_path / "run.h5"))
        assert found.parameters["repeats"] == 3 and found.parameters["repeated_for"] == "energy"
        assert found.parameters["mass_scaling"] == "none" and found.complete
        assert found.series.equals(explicit.series)

    @pytest.mark.parametrize("repeats, then", [(1, "selective"), (2, "none")])
    def test_half_the_step_comes_first_then_large_explicit_ones(self, monkeypatch, repeats, then):
        errors = iter([1.0] * repeats + [0.0])
        monkeypatch.setattr(
            "damage.run.session.check_energy", lambda error: scheme.check_energy(next(errors))
        )
        found = run(SOFT, **SHAKEN, mass_scaling="selective", dt=2e-4).parameters
        large = STEP_FACTOR * found["critical_time_step_s"]
        assert found["time_step_s"] == (1e-4 if then == "selective" else approx(large, 0.01))
        assert (found["repeats"], found["mass_scaling"]) == (repeats, then)

    def test_a_failure_is_that_of_explicit_steps(self, monkeypatch):
        left = iter([True, True, False])

        def fails(error):
            if next(left):
                raise RunError("blew up")

        monkeypatch.setattr("damage.run.session.check_energy", fails)
        found = run(SOFT, **MILDLY)
        assert found.complete and (
            found.parameters["repeats"],
            found.parameters["repeated_for"],
        ) == (2, "failure")

    def test_a_falling_brick_makes_the_run_explicit_at_once(self, monkeypatch):
        monkeypatch.setattr(monitor, "ACCEPTED_DROP_M", 1e-6)
        found = run(SOFT, **SHAKEN, mass_scaling="selective", dt=2e-4)
        assert (found.parameters["repeats"], found.parameters["repeated_for"]) == (1, "drop")
        assert found.parameters["mass_scaling"] == "none"


class TestDrop:
    @pytest.fixture
    def spandrel(self, layout):
        """Bricks above the opening, which no bed joint bears."""
        lowest = [
            brick
            for brick in range(layout.n_bricks)
            if layout.bodies.z[brick] > 0.45 and abs(layout.bodies.x[brick] - 0.5625) < 0.2
        ]
        assert lowest
        return lowest

    def test_of_a_spandrel(self, layout, spandrel):
        motion = np.zeros((2, len(layout.bodies), 3))
        motion[1, spandrel, 1] = -6e-4
        assert_allclose(Borne(layout).largest_drop(motion), [0.0, 6e-4], atol=1e-12)

    def test_none_of_a_wall_that_moves_or_turns_as_a_whole(self, layout):
        motion = np.zeros((1, len(layout.bodies), 3))
        angle = 0.02
        motion[0, :, 1] = (
            -5e-3 + np.sin(angle) * layout.bodies.x - (1 - np.cos(angle)) * layout.bodies.z
        )
        motion[0, :, 2] = angle
        assert Borne(layout).largest_drop(motion)[0] < 1e-4


@pytest.mark.long
def test_a_run_with_deformable_bricks_is_accepted():
    """Compiled, which takes most of its time; the step itself: `in_plain_python`."""
    how = SHAKEN | {"bricks": "deformable", "contacts": "gauss"}
    found = run(SOFT, **how).parameters
    assert (found["mass_scaling"], found["repeats"]) == ("selective", 0)
