"""The stages, samples and ends of a run with a solver that only keeps its clock, and what is
written of them; numbers that decide a run, each against what it stands for."""

import math
from pathlib import Path

import numpy as np
import pytest
from conftest import contents, parsed, without_progress
from numpy.testing import assert_allclose
from short_runs import RUNS
from small_history import small_layout

import damage
from damage import read_history
from damage.history.writer import HistoryWriter
from damage.measure.summary import summarise
from damage.motion.loading import mean_velocities
from damage.run import settings as run_settings
from damage.run.cooperative import to_its_end
from damage.run.monitor import (
    fastest_fallen,
    have_fallen,
    unbalanced_force,
)
from damage.run.prepare import Backend
from damage.run.run import LOOK_STEPS, Run
from damage.run.schedule import choose_time_step, sample_steps
from damage.run.session import run_session
from damage.run.settings import HOLD_AT_MOST_S, LOCAL_DAMPING, RAMP_S
from damage.run.solver import Instants
from damage.start import reported
from damage.units import GRAVITY

DT = 1e-3  # [s]; a sample then lasts ten steps
SHAKEN = "--harmonic 0.1 0.2 --cycles 2 --rest 0.3"


class Clockwork:
    """A solver whose bodies rest but for the drop of brick 0, with energies that a test gives; it
    returns so many samples at once."""

    stretch_samples = 0

    def __init__(
        self,
        layout,
        at_once=1,
        unbalanced=0.0,
        falls_at_step=None,
        kinetic_j=lambda step: 0.0,
        damping_j=0.0,
        input_j=lambda step: 0.0,
        slip_m=lambda step: 0.0,
        offset_m=lambda step: 0.0,
        breaks_at_steps=(),
    ):
        self.layout = layout
        self.time_step = DT
        self.clock = 0
        self.input_j = input_j
        self.slip_m = slip_m
        self.offset_m = offset_m
        self.unbalanced = unbalanced
        self.falls_at_step = falls_at_step
        self.at_once = at_once
        self.kinetic_j = kinetic_j
        self.damping_j = damping_j
        self.breaks_at_steps = breaks_at_steps
        self.log = []
        self.events = []
        self.moved_m = self.velocity = 0.0

    def start(self, base, gravity):
        self.clock = 0
        self.base = base
        self.gravity = gravity
        self.log.append("start")

    def damp(self, **how):
        self.log.append(how)

    def shift(self, offsets):
        self.log.append(offsets)

    def set_velocities(self, velocities):
        self.velocities = velocities

    def saved_state(self):
        """None, as of a solver that cannot say it."""

    def hold(self, bodies, rotation, stiffness=0.0):
        self.at_once = 1
        self.log.append(("hold", rotation))

    def push(self, velocity):
        self.velocity = velocity
        self.log.append(("push", velocity))

    def move_supports(self, velocities):
        self.log.append(("move", velocities))

    def prescribe_no_more(self):
        self.log.append("no more")

    def advance(self, n_steps, sample_steps=None, on_samples=None, since=None):
        end = self.clock + n_steps
        seen = [self.instants()] if on_samples and self.clock == 0 else []
        goes_on = not seen or on_samples(*seen)
        seen.clear()
        while goes_on and self.clock < end:
            self.clock += 1
            self.moved_m += DT * self.velocity
            if on_samples and self.clock in self.breaks_at_steps:
                self.events.append((self.clock, 0, "tension", 1.0, 2.0, 0.0, 0.0))
            if on_samples and self.clock % sample_steps == 0:
                seen.append(self.instants())
            if len(seen) == self.at_once or (seen and self.clock == end):
                goes_on = on_samples(together(seen))
                seen.clear()
        return ()

    def instants(self):
        displacement = np.zeros((len(self.layout.bodies), 3))
        n = self.layout.n_joints
        displacement[:, 0] = self.moved_m
        if self.falls_at_step is not None and self.clock >= self.falls_at_step:
            displacement[0, 1] = -1.0
        contacts = {
            "opening_m": np.zeros(n),
            "slip_m": np.full(n, self.slip_m(self.clock)),
            "offset_m": np.full(n, self.offset_m(self.clock)),
            "state": np.zeros(n, int),
        }
        return Instants.single(
            clock=self.clock,
            displacement=displacement,
            support_displacement=np.zeros((1, 3)),
            support_force=np.zeros((1, 3)),
            joints=slice(None),
            contacts=contacts,
            top_force_n=np.nan,
            kinetic_j=self.kinetic_j(self.clock),
            elastic_j=0.0,
            input_j=self.input_j(self.clock),
            friction_j=0.0,
            fracture_j=0.0,
            damping_j=self.damping_j,
        )

    def forces(self):
        weight = np.column_stack(
            [
                np.zeros_like(self.layout.bodies.mass),
                GRAVITY * self.layout.bodies.mass,
                np.zeros_like(self.layout.bodies.mass),
            ]
        )
        return weight + [self.unbalanced, 0.0, 0.0], np.ones(len(self.layout.contacts))

    def base_reaction(self):
        return 1.0

    def drain_events(self):
        events = self.events
        self.events = []
        return events


def together(instants):
    """Instants of several."""

    def joined(values):
        if isinstance(values[0], dict):
            return {name: joined([one[name] for one in values]) for name in values[0]}
        return (
            values[0]
            if isinstance(values[0], slice) or values[0] is None
            else np.concatenate(values)
        )

    return Instants(*map(joined, zip(*instants)))


@pytest.fixture(params=[1, 7])
def at_once(request):
    """Samples that the Clockwork tells of at once."""
    return request.param


@pytest.fixture
def run_through(tmp_path, at_once):
    """run_through(words, keep_going, **of the Clockwork): runs it; returns (finished, Run,
    Clockwork, History)."""

    def run(words=SHAKEN, keep_going=lambda run, time_s: True, solver="yade", **clockwork):
        layout = small_layout()
        settings = parsed(words, solver)
        fake = Clockwork(layout, at_once, **clockwork)
        path = tmp_path / "run.h5"
        writer = HistoryWriter(
            path,
            layout,
            solver="yade",
            parameters={
                "loading": settings.loading.as_dict(),
                "wall": layout.wall.as_dict(),
                "model": {},
            },
            versions={},
            overwrite=True,
        )
        run = Run(layout, settings, fake, writer, keep_going)
        finished = to_its_end(run.come_to_rest())
        if finished:
            run.start()
            finished = to_its_end(run.run_all())
        writer.finish("complete" if finished else "interrupted", run.collapsed_at_s)
        return finished, run, fake, read_history(path)

    return run


def test_stages_bear_their_names_up_to_their_last_sample(run_through):
    finished, run, _, history = run_through()
    assert finished
    ends = history.series.groupby("stage", observed=True)["time_s"].max()
    assert_allclose(ends[["motion", "rest", "settling"]], [0.2, 0.5, 1.0])
    assert_allclose(history.series["time_s"], np.arange(101) * 10 * DT)
    assert_allclose(run.duration_s, 1.0)


def test_static_stage_ramps_gravity_up_and_ends_at_a_look_with_the_wall_at_rest(run_through):
    _, _, fake, history = run_through()
    assert history.static["duration_s"] == LOOK_STEPS * DT
    assert fake.log[:2] == [{"local": LOCAL_DAMPING}, "start"]


def test_static_stage_that_finds_no_rest_gives_up_and_says_so(run_through):
    _, _, _, history = run_through(unbalanced=1.0)
    assert_allclose(history.static["duration_s"], RAMP_S + HOLD_AT_MOST_S, atol=LOOK_STEPS * DT)
    assert history.static["duration_s"] > RAMP_S + HOLD_AT_MOST_S
    assert_allclose(history.static["unbalanced_force"], 1.0)


def test_gravity_comes_in_whole_steps_and_stays(run_through):
    ramps = []
    run_through(keep_going=lambda run, time_s: ramps.append(run.solver.gravity) or True)
    assert_allclose(ramps[0], GRAVITY * np.arange(201) / 200)
    assert_allclose(ramps[-1], [GRAVITY])


def test_the_share_of_a_run_grows_with_its_steps_while_the_ground_settles_too(run_through):
    shares = []
    run_through(
        f"{SHAKEN} --settle knick --distortion 0.001",
        keep_going=lambda run, time_s: shares.append((run.stage, run.share)) or True,
    )
    settling = [share for stage, share in shares if stage == "settlement"]
    assert len(settling) > 2 and np.ptp(settling) > 0.2 and np.diff(settling).min() > 0
    assert [share for _, share in shares] == sorted(share for _, share in shares)


def test_settling_is_damped_and_the_motion_is_not(run_through):
    _, _, fake, _ = run_through("--rest 0.1 --beta 1e-6", solver="reference")
    assert [how for how in fake.log if isinstance(how, dict)] == [
        {"adaptive": 1.0},
        *2 * [{"alpha": 0.0, "beta": 1e-6}],
        {"local": LOCAL_DAMPING},
    ]


def test_top_is_held_and_pushed_with_a_new_velocity_every_sample(run_through):
    _, run, fake, history = run_through("--pushover 0.02 --speed 0.01 --boundary fixed")
    assert ("hold", True) in fake.log
    velocities = [what[1] for what in fake.log if isinstance(what, tuple) and what[0] == "push"]
    loading = run.settings.loading
    height = run.layout.drift_height
    asked = mean_velocities(loading.drive.top, 10 * DT, len(velocities) - 1, height)
    assert_allclose(velocities[:-1], asked, atol=1e-12)
    assert velocities[-1] == 0.0
    assert len(velocities) == len(history.series)
    assert_allclose(history.series["drift_ratio"].iloc[-1], 0.02 / 100)


def test_collapse_is_an_end_and_the_last_sample(run_through):
    finished, run, _, history = run_through(
        falls_at_step=195, breaks_at_steps=(7, 198, 200, 201, 207)
    )
    assert_allclose(history.events["time_s"], [0.007, 0.198, 0.2])
    assert finished and history.collapsed_at_s == run.collapsed_at_s == pytest.approx(0.2)
    assert history.series["time_s"].iloc[-1] == history.collapsed_at_s
    assert history.snapshot_time_s[-1] == history.collapsed_at_s
    assert history.displacement[-1, 0, 1] == -1.0


@pytest.mark.parametrize("until_s, samples", [(-1.0, 0), (0.3, 51)])
def test_interrupt_ends_at_the_next_look_and_keeps_what_was_seen(run_through, until_s, samples):
    """Before time zero no sample exists; later the steps up to the look are kept."""
    finished, _, _, history = run_through(
        keep_going=lambda run, time_s: (run.stage == "static" and until_s > 0) or time_s < until_s
    )
    assert not finished and history.status == "interrupted"
    assert len(history.series) == samples


def test_damping_that_a_solver_cannot_tell_is_what_the_balance_lacks_in_settling(run_through):
    """10 J that swing away before settling are an error, which stays one; 3 J that go in settling
    were damped."""
    _, _, _, history = run_through(
        kinetic_j=lambda step: 10.0 if step <= 250 else 6.0 if step <= 700 else 3.0, damping_j=None
    )
    damped = history.series.set_index(history.series["time_s"].round(3))["damping_energy_j"]
    assert damped[0.5] == 0.0
    assert_allclose([damped[0.6], damped[1.0]], [0.0, 3.0])


def test_events_count_from_time_zero(run_through):
    def break_one(run, time_s):
        if run.solver.clock in (0, LOOK_STEPS):
            run.solver.events.append((run.solver.clock, 0, "tension", 1.0, 2.0, 0.0, 0.0))
        return True

    _, _, _, history = run_through(keep_going=break_one)
    # One at the start of the static stage, which lasted one look; one at time zero; one a look
    # later.
    assert_allclose(history.events["time_s"], [-LOOK_STEPS * DT, 0.0, LOOK_STEPS * DT])


# --- runs that are not to be believed -------------------------------------------------------------


@pytest.fixture
def session(tmp_path, capsys, monkeypatch, at_once):
    """session(**of the Clockwork): a whole run of it from its command line; (status, what
    it said, History)."""

    def run(**clockwork):
        def make(layout, time_step, _settings):
            monkeypatch.setattr(f"{__name__}.DT", time_step)
            return Clockwork(layout, at_once, **clockwork)

        out = tmp_path / "run.h5"
        backend = Backend("reference", {}, make, Path(__file__).parent)
        words = f"{SHAKEN} --no-pictures --overwrite --out {out}".split()
        wall = small_layout().wall
        status = reported(lambda: run_session(backend, __file__, lambda: wall, words, "test"))
        printed = without_progress(capsys.readouterr().err)
        return status, printed.splitlines(), read_history(out)

    return run


@pytest.mark.parametrize(
    "error, failed, warned", [(0.009, False, 0), (0.9, False, 1), (1.1, True, 0), (1e15, True, 0)]
)
def test_a_run_whose_energies_do_not_balance_has_failed(session, error, failed, warned):
    """100 J came in at once, and all but what the test says to be wrong went into motion."""
    status, printed, history = session(
        input_j=lambda step: 100.0 * (step > 0),
        kinetic_j=lambda step: 100.0 * (1 + error) * (step > 0),
    )
    assert (status, history.status) == ((1, "failed") if failed else (0, "complete"))
    assert [line.partition(":")[0] for line in printed] == ["error"] * failed + ["warning"] * warned
    summary = summarise(history)
    assert_allclose(summary["energy_error_fraction"], error)
    assert len(summary["warnings"]) == (error > 0.01)


@pytest.mark.parametrize(
    "what, odd",
    [("kinetic_j", np.nan), ("input_j", np.inf), ("slip_m", -np.inf), ("offset_m", np.nan)],
)
def test_a_run_that_blows_up_ends_at_once_and_keeps_what_was_finite(session, what, odd):
    status, printed, history = session(**{what: lambda step: odd if step >= 1000 else 0.0})
    assert (status, history.status) == (1, "failed")
    assert (
        len(printed) == 1 and "the run blew up" in printed[0] and "no longer finite" in printed[0]
    )
    steps = sample_steps(history.time_step_s)
    assert_allclose(
        history.series["time_s"], np.arange(999 // steps + 1) * steps * history.time_step_s
    )
    finite = history.series.drop(
        columns=["stage", "top_force_n", "base_translation_m", "base_rotation_rad"]
    )
    assert np.isfinite(finite.to_numpy(float)).all() and np.isfinite(history.slip_m).all()


@pytest.mark.parametrize("input_j, known", [(0.0, False), (1e-9, False), (1e-3, True)])
def test_no_input_no_percentage(session, input_j, known):
    """The wall weighs 29 kN and is 0.45 m high: 1.3e-8 J are rounding, the millijoule of a free
    vibration is not."""
    _, _, history = session(
        input_j=lambda step: input_j * (step > 0), kinetic_j=lambda step: 2e-9 * (step > 0)
    )
    assert (summarise(history)["energy_error_fraction"] is not None) == known


def test_large_walls_are_looked_at_more_often_and_move_alike(run_of, monkeypatch, tmp_path):
    """As often as samples are taken, where a sample takes a second; contact points that fail
    between two looks are alone in another order in the file."""
    usual = run_of("shaken")
    looked = []
    continues = Run._continues
    monkeypatch.setattr("damage.run.run.MOST_WORK", 1)
    monkeypatch.setattr(
        Run, "_continues", lambda run: looked.append(run.solver.clock) or continues(run)
    )
    wall, words = RUNS["shaken"]
    often = damage.run(wall, **words, out=tmp_path / "often.h5")
    assert len(looked) > 100
    for one, other in zip(often.contacts, usual.contacts):
        assert one.tobytes() == other.tobytes()
    ordered = "active/joint", "frames/"
    of_often, of_usual = (
        {name: kept for name, kept in contents(run.path).items() if not name.startswith(ordered)}
        for run in (often, usual)
    )
    assert of_often == of_usual


# --- numbers that decide a run --------------------------------------------------------------------

CRITICAL_S = 4.67e-5


def step_of(words="", softens=False):
    return choose_time_step(parsed(f"--free-vibration {words}"), CRITICAL_S, softens)


def test_the_time_step_is_a_share_of_the_critical_one():
    """And below 0.85 of the step that local damping of 0.7 leaves stable, 1 / sqrt(1.7)."""
    assert_allclose(step_of(), 0.643 * CRITICAL_S, rtol=1e-5)
    assert_allclose(step_of(softens=True), 0.35 * CRITICAL_S, rtol=1e-5)
    assert 0.643 < 0.85 / math.sqrt(1.7)


@pytest.mark.parametrize("beta_s", [2e-5, 1e-4, 1e-3])
def test_with_viscous_damping_the_time_step_is_085_of_the_stable_one(beta_s):
    """(2 / omega) (sqrt(1 + xi^2) - xi) with xi = beta omega / 2 and omega = 2 / critical step."""
    xi = beta_s / CRITICAL_S
    stable = CRITICAL_S * (math.sqrt(1 + xi**2) - xi)
    assert 0.85 * stable < 0.643 * CRITICAL_S
    assert_allclose(step_of(f"--beta {beta_s}"), 0.85 * stable, rtol=1e-5)


def test_a_brick_has_fallen_when_it_is_half_its_height_below_its_place():
    layout = small_layout()
    height = layout.bodies.height[3]
    motion = np.zeros((3, len(layout.bodies), 3))
    motion[:, 3, 1] = -0.49 * height, -0.51 * height, -0.6 * height
    assert have_fallen(layout, motion).tolist() == [False, True, True]
    # nor does a rigid top mass count
    motion[:, 3, 1] = 0.0
    motion[2, layout.n_bricks :, 1] = -1.0
    assert not have_fallen(layout, motion).any()


def test_bricks_in_flight_are_far_from_rest_by_a_number():
    """No contact carries force, every brick falls freely: the ratio is large, and no infinity goes
    into a history."""
    layout = small_layout()
    flying = unbalanced_force(
        layout, np.zeros((len(layout.bodies), 3)), np.zeros(len(layout.contacts.x))
    )
    assert flying == pytest.approx(1e9)


def test_a_wall_rests_when_no_brick_that_fell_moves():
    """Bodies that are still in their place may vibrate; the speed is that of centre and end."""
    layout = small_layout()
    height = layout.bodies.height[3]
    length = layout.bodies.length[3]
    before, now = np.zeros((2, len(layout.bodies), 3))
    now[3] = 0.4 * height, 0.0, 0.0
    assert fastest_fallen(layout, now, before, 0.02) == 0.0
    before[3] = (0.6 * height, 0, 0.1)
    now[3] = (0.6 * height + 3e-4, -4e-4, 0.1 - 1e-3)
    assert_allclose(fastest_fallen(layout, now, before, 0.02), (5e-4 + 1e-3 * length / 2) / 0.02)
    assert (run_settings.RESTS_BELOW_M_S, run_settings.RESTS_FOR_S, run_settings.AFTER_FALL_S) == (
        0.05,
        0.2,
        10.0,
    )
