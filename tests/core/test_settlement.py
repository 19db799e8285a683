"""The ground: supports that follow a profile, against rigid-body motion, beams and statics; soil,
springs below the base without tension, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from checks.settling_support import pier, settle
from conftest import REPOSITORY, parsed, refused_with, rigid_turn, written
from numpy.testing import assert_allclose
from pytest import approx
from short_runs import SMALL, solver_of

import damage
from damage import Brick, Floor, Joint, ModelOptions, Opening, Wall, read_history, run
from damage.applications.cracks.compare import compare
from damage.errors import RunError
from damage.linear.modes import natural_modes
from damage.measure.cycles import natural_period
from damage.measure.damage_index import storey_drifts
from damage.measure.energy import energy_error_of
from damage.measure.ground import distortion
from damage.measure.pushed import first_loading
from damage.measure.summary import summarise
from damage.motion.loading import AtRest, Harmonic
from damage.motion.settlement import FASTEST_M_S, PROFILES, Settlement
from damage.reference.session import BACKEND
from damage.reference.solver import ReferenceSolver
from damage.run.banner import settlement_lines
from damage.run.cooperative import to_its_end
from damage.run.prepare import prepare
from damage.run.session import simulate
from damage.run.settings import RunSettings
from damage.run.solver import NO_MOTION
from damage.units import GRAVITY
from damage.wall.layout import Supports, lay_out

STRONG = Joint(tensile_strength=1e9, cohesion=1e9)
PIER = Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses", joint=STRONG)
N = 21
LENGTH = 0.3
HEIGHT = 0.5
BEAM = Wall(
    "beam",
    N * LENGTH,
    HEIGHT,
    brick=Brick(length=LENGTH, height=HEIGHT),
    joint=STRONG,
    precompression=0.0,
)
"""A single course of bricks side by side: a beam."""


def supports(n=8, length=4.0):
    edges = np.linspace(0, length, n + 1)
    return Supports(edges[:-1], edges[1:])


# --- profiles -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "profile, sign, chord", [("hogging", -1, 0), ("sagging", 1, 0), ("knick", -1, -1)]
)
def test_the_ground_has_the_distortion_that_was_asked_for(profile, sign, chord):
    """Hogging and sagging have the deflection over half the length; a knick deflects by half of it
    from its chord."""
    given = 1 / 500
    settlement = Settlement(profile, given)
    below = supports()
    end = settlement.displacement([1e3], below)[0]
    half = (below.right - below.left) / 2
    x = np.concatenate([below.left, below.right[-1:]])
    up = np.concatenate(
        [end[:, 1] - half * np.sin(end[:, 2]), end[-1:, 1] + half[-1] * np.sin(end[-1:, 2])]
    )
    # a rotation of finite size shortens its arm
    assert_allclose(up, settlement.vertical(x, 4.0), atol=1e-8)
    angular, ratio, relative_mm, tilt = distortion(x, up)
    factor = 0.5 if chord else 1.0
    assert angular == approx(factor * given, rel=1e-4)
    assert ratio == approx(sign * factor * given / 2, rel=1e-4)
    assert relative_mm == approx(1e3 * given * 2.0, rel=1e-4)
    assert tilt == approx(chord * given / 2, abs=1e-9)


@pytest.mark.parametrize("profile", PROFILES)
def test_last_bits_of_the_walls_lengths_do_not_reach_the_ground(profile):
    """Nor does the rounding of a profile that is level: the rotation there is zero."""
    settlement = Settlement(profile, 1 / 500)
    below = supports(7, 4.1)
    off = Supports(*(np.nextafter(edges, 9.0) for edges in (below.left, below.right)))
    time_s = np.linspace(0, 3, 301)
    moved = settlement.displacement(time_s, below)
    assert np.array_equal(moved, settlement.displacement(time_s, off))
    assert profile != "knick" or not moved[:, :3].any()
    level = Settlement("level.csv", None, (0.0, 1.7, 4.0, 4.1), (-0.0123, -0.0123, -0.0123, 0.0))
    assert not level.displacement(time_s, below)[:, below.right < 4.0, 2].any()


def test_the_ground_begins_and_ends_at_rest_and_is_slow():
    settlement = Settlement("hogging", 1 / 100)
    time_s = settlement.moving_s(4.0)
    speed = np.abs(settlement.velocities(time_s / 200, 250, supports(200)))[:, :, 1].max(axis=1)
    assert (
        speed[0] < 0.02 * FASTEST_M_S and speed[199] < 0.02 * FASTEST_M_S and not speed[200:].any()
    )
    assert FASTEST_M_S * 0.9 < speed.max() <= FASTEST_M_S


def test_a_profile_from_a_file(tmp_path):
    path = written(tmp_path / "dip.csv", "x_m,uz_m\n0,0\n1,-0.002\n4,0\n")
    settlement = parsed(f"--settle {path}").settlement
    assert_allclose(settlement.vertical([0.5, 1, 2.5], 4.0), [-0.001, -0.002, -0.001])
    refused_with(
        "reaches from x = 0 to 4 m, the wall from 0 to 4.05 m", settlement.check_length, 4.05
    )


@pytest.mark.parametrize("common", [-0.25, 0.25])
def test_what_all_points_have_in_common_is_taken_off(common):
    """A wall that sinks by 0.25 m as a whole does what one does that stays: the ground moves for a
    second, not for 79."""
    x = (0.0, 1.0, 4.0)
    up = np.array([0.0, -0.002, -0.003]) * np.sign(-common)
    one, deep = (Settlement("dip.csv", None, x, tuple(values)) for values in (up, up + common))
    time_s = np.linspace(0, 1, 9)
    below = supports()
    assert deep.common_m == pytest.approx(common) and deep.moving_s(4.0) == one.moving_s(4.0) == 1
    assert np.array_equal(one.displacement(time_s, below), deep.displacement(time_s, below))
    settings = parsed("--settle tilt --distortion 0.002")
    lines = settlement_lines(replace(settings, settlement=deep), lay_out(BEAM))
    assert lines == [
        f"settlement: the ground moves for 1 s, at most at 5 mm/s; {1e3 * common:g} mm of all"
        " points are taken off"
    ]


def test_levels_of_two_dates_are_a_profile(tmp_path, capsys):
    """What the right end went down between the surveys, whatever the course was like when built; of
    one date what it is below its highest point, with a warning."""
    path = tmp_path / "levels.csv"
    path.write_text(
        "x_m,height_m,date\n3.8,0.712,2003-06-01\n0.2,0.700,2003-06-01\n2,0.705,2003-06-01\n"
        "0.2,0.699,2021-06-01\n2,0.703,2021-06-01\n3.8,0.702,2021-06-01\n"
    )
    settlement = parsed(f"--settle {path}").settlement
    settlement.check_length(4.0)
    up = settlement.vertical([0.2, 2, 3.8], 4.0)
    assert_allclose(up - up[0], [0, -1e-3, -9e-3], atol=1e-12)
    assert settlement.vertical(4.0, 4.0) - settlement.vertical(3.8, 4.0) == approx(
        -8e-3 / 1.8 * 0.2
    )
    assert capsys.readouterr().err == ""
    # another way to write the same day
    path.write_text(path.read_text().replace("2003-06-01", "20030601", 1))
    assert parsed(f"--settle {path}").settlement == settlement
    path.write_text("x_m,height_m\n0,1.71\n2,1.70\n4,1.71\n")
    one = parsed(f"--settle {path}").settlement
    assert one.vertical(2, 4.0) - one.vertical(0, 4.0) == approx(-0.01)
    assert (
        "levels of one date: the course is taken as level when it was built"
        in capsys.readouterr().err
    )


@pytest.mark.parametrize(
    "text, said",
    [
        ("x,z\n0,0\n", "line 1: no column x_m; expected x_m and any of uz_m, height_m, date"),
        ("x_m,uz_m\n0,0\n1,a\n", "line 3: uz_m = 'a': expected a finite number"),
        ("x_m,uz_m\n0,0\n1,0\n", "uz_m is 0 m at every point; expected ground that bends"),
        ("x_m,uz_m\n0,-0.2\n9,-0.2\n", "uz_m is -0.2 m at every point"),
        ("x_m,height_m,date\n0,1,\n", "line 2: date = '': expected a day like 2019-05-22"),
        (
            "x_m,height_m,date\n0,1,2020-01-01\n1,1,2021-01-01\n",
            "1 level of one date; expected two or more",
        ),
        ("x_m,uz_m\n1,0\n0,1e-3\n", "does not rise"),
        ("x_m,uz_m\n0,0\n1,5\n", "expected a number from -1 to 1"),
    ],
)
def test_bad_profiles_are_one_line(tmp_path, text, said):
    path = written(tmp_path / "bad.csv", text)
    refused_with(said, parsed, f"--settle {path}")


# --- motion, forces, energy -----------------------------------------------------------------------


def test_a_tilt_of_the_whole_base_is_a_rigid_body_motion():
    """To 1e-9 m without weight, which would shear the tilted wall."""
    layout = lay_out(PIER, ModelOptions(supports="bricks"))
    solver = solver_of(layout)
    tilt = Settlement("tilt", 1 / 200)
    n = 100
    interval = tilt.moving_s(PIER.length) / 100
    steps = round(interval / solver.time_step)
    solver.damp(local=0.7)
    solver.start(NO_MOTION, np.zeros(1))
    for velocity in tilt.velocities(steps * solver.time_step, n + 20, layout.supports):
        solver.move_supports(velocity)
        solver.run(steps)
    assert_allclose(
        solver.instants().displacement[0], rigid_turn(layout.bodies, -1 / 200), rtol=0, atol=1e-9
    )


def settled(tmp_path, wall, settlement, model=None, change=lambda layout: layout, loading=None):
    """History and layout of a wall that settles; change: of the layout."""
    settings = RunSettings(
        loading=loading or AtRest(),
        settlement=settlement,
        model=model or ModelOptions(),
        rest_s=0.1,
        relaxation="adaptive",
        accept_implausible=True,
        out=tmp_path / "settled.h5",
        pictures=False,
        quiet=True,
    )
    prepared = prepare(BACKEND, "", lambda: wall, settings)
    prepared = replace(prepared, layout=change(prepared.layout))
    to_its_end(simulate(prepared, lambda run, time_s: True))
    return read_history(settings.out), prepared.layout


def loose_base(layout):
    """The layout whose base joint has no tensile strength and hardly any stiffness along the
    ground."""
    contacts = layout.contacts
    ground = layout.contacts.first < 0
    return replace(
        layout,
        contacts=replace(
            contacts,
            tensile_strength=np.where(ground, 0.0, contacts.tensile_strength),
            shear_stiffness=np.where(ground, 1e-4, 1.0) * contacts.shear_stiffness,
        ),
    )


def beam_stiffness(layout):
    """Bending and shear stiffness of the beam [N m2, N]: head joints, each for the length of a
    brick."""
    contacts = layout.contacts
    head = layout.contacts.upright
    second = HEIGHT**3 / 12
    depth = HEIGHT
    thickness = BEAM.brick.thickness
    return (
        contacts.normal_stiffness[head][0] * LENGTH * thickness * second,
        contacts.shear_stiffness[head][0] * LENGTH * thickness * depth,
    )


@pytest.mark.parametrize("profile", ["hogging", "sagging"])
def test_a_long_elastic_wall_that_the_ground_leaves_is_timoshenkos_beam(tmp_path, profile):
    """Hogging leaves the middle as its support: two cantilevers; sagging both ends: a beam on two
    supports."""
    history, layout = settled(
        tmp_path, BEAM, Settlement(profile, 1 / 150), ModelOptions(contacts="gauss"), loose_base
    )
    up = history.displacement[-1][:N, 1].astype(float)
    load = BEAM.brick.density * GRAVITY * HEIGHT * BEAM.brick.thickness
    (bending, shear) = beam_stiffness(layout)
    if profile == "hogging":
        span = N * LENGTH / 2 - LENGTH / 2  # to the middle of the last brick
        half = N * LENGTH / 2
        expected = load * span**2 / (24 * bending) * (
            6 * half**2 - 4 * half * span + span**2
        ) + load / shear * (half * span - span**2 / 2)
        found = up[N // 2] - up[[0, -1]].mean()
    else:
        # between the outermost Gauss points
        span = N * LENGTH - LENGTH * (1 - 1 / math.sqrt(3)) / 2
        expected = 5 * load * span**4 / (384 * bending) + load * span**2 / (8 * shear)
        rotation = history.displacement[-1][[0, N - 1], 2].astype(float)
        # from the end bricks' centres to these points
        inwards = LENGTH * (1 + 1 / math.sqrt(3)) / 4
        found = (up[[0, -1]] + inwards * np.array([-1, 1]) * rotation).mean() - up[N // 2]
    assert found == approx(expected, rel=0.05)


def test_reactions_of_a_wall_that_bridges_settled_supports_are_those_of_statics(tmp_path):
    """Supported at its left end and at two thirds of its length alone."""
    x = np.array([0.0, 1.2, 3.0, 4.2, 5.4, 6.3])
    right = 4.2
    ground = Settlement("bridge.csv", None, tuple(x), (0.0, -0.03, -0.03, 0.0, -0.03, -0.03))
    history, layout = settled(tmp_path, BEAM, ground, ModelOptions(contacts="gauss"), loose_base)
    reaction = -history.support_force[-1][:, 1].astype(float)
    weight = GRAVITY * layout.total_mass
    left = LENGTH * (1 - 1 / math.sqrt(3)) / 4
    expected = weight * (BEAM.length / 2 - left) / (right - left)
    carrying = slice(round(right / LENGTH) - 1, round(right / LENGTH) + 1)
    assert reaction[carrying].sum() == approx(expected, rel=0.01)
    assert reaction[0] == approx(weight - expected, rel=0.01)
    assert np.delete(reaction, [0, *range(carrying.start, carrying.stop)]) == approx(
        0.0, abs=1e-3 * weight
    )


# --- runs -----------------------------------------------------------------------------------------


def test_the_ground_settles_before_time_zero_and_rests_then(run_of):
    cracked = run_of("settled")
    series = cracked.series
    settlement = cracked.series["stage"] == "settlement"
    assert series["time_s"][settlement].iloc[-1] == approx(0.0, abs=1e-12)
    assert (series["time_s"][settlement] <= 0).all() and (series["time_s"][~settlement] > 0).all()
    rests = cracked.support_displacement[~settlement.to_numpy()]
    assert_allclose(rests, np.broadcast_to(rests[0], rests.shape), rtol=1e-6)
    assert not series["base_acceleration_x_m_s2"][settlement].any()
    assert (cracked.events["time_s"] < 0).any() and list(series["stage"].unique()) == [
        "settlement",
        "motion",
        "rest",
        "settling",
    ]


def test_a_run_that_continues_after_a_settlement_has_not_fallen(tmp_path):
    """The ground goes down by more than half a brick; damping of its settling is of that run."""
    wall = Wall("w", 2.25, 0.3, joint=STRONG)
    settled = tmp_path / "settled.h5"
    how = {"supports": "bricks", "accept_implausible": True}
    damage.run(wall, settle="tilt", distortion=0.02, out=settled, **how)
    shaken = damage.run(
        wall, harmonic=(0.05, 0.01), cycles=1, rest=0, **how, **{"continue": settled}
    )
    summary = summarise(shaken)
    assert summary["status"] == "complete" and summary["collapsed_at_s"] is None
    assert summary["damping_energy_j"] == 0


def test_cracks_of_the_settlement_stay_and_the_ground_s_work_is_in_the_balance(run_of):
    """The weight goes down with the ground."""
    cracked = run_of("settled")
    found = summarise(cracked)
    last = np.flatnonzero(cracked.series["stage"] == "settlement")[-1]
    assert found["settled_crack_width_mm"] > 0.1 and found["settled_psi"] > 1
    assert found["angular_distortion"] == approx(1 / 500, rel=0.1)
    assert cracked.opening_m[-1].max() > 0.5 * cracked.opening_m[last].max()
    assert cracked.series["input_energy_j"][last] < -1.0 and energy_error_of(cracked) < 2e-4


def test_without_a_motion_the_run_ends_at_time_zero():
    wall = replace(SMALL, floors=[Floor(0.225, 500.0)])
    history = damage.run(wall, settle="tilt", distortion=1 / 500)
    assert history.complete and set(history.series["stage"]) == {"settlement"}
    assert history.series["time_s"].iloc[-1] == approx(0.0, abs=1e-12)
    assert history.loading.name == "at_rest"
    assert history.series["base_rotation_rad"].iloc[-1] == approx(-1 / 500, rel=0.02)
    assert abs(history.series["drift_ratio"].iloc[-1]) < 1e-5  # the tilt itself is none
    storeys = storey_drifts(history)[1]
    assert storeys.shape[1] == 2 and np.abs(storeys).max() < 8e-5
    assert compare(history, [history])["agrees"]


@pytest.mark.long
def test_a_settlement_that_topples_the_wall_is_one_line(tmp_path):
    slender = Wall("slender", 0.225, 0.75, precompression=0.0, joint=STRONG)
    # 0.44, the diagonal 0.29 from upright
    ground = Settlement("steep.csv", None, (0.0, 0.225), (0.0, -0.1))
    with pytest.raises(RunError, match="not at rest on the settled ground.*smaller --distortion"):
        settled(tmp_path, slender, ground, change=loose_base)


def test_force_and_drift_of_a_push_count_from_its_start(run_of):
    """The settlement leaves a drift, and a displacement of the top that would be no part of a
    stiffness."""
    whole = run_of("settled, pushed")
    settling = whole.series["stage"] == "settlement"
    zero = whole.series[settling].iloc[-1]
    shear = whole.series["base_shear_n"]
    top = whole.series["top_displacement_m"]
    found = first_loading(whole)
    at = (shear >= 0.7 * shear.max()).idxmax()
    assert (
        not whole.series["top_force_n"][settling].any()
        and whole.series["top_force_n"].abs().max() > 1e3
    )
    assert zero["top_displacement_m"] > 1e-4 and energy_error_of(whole) < 1e-3
    assert found["secant_stiffness_n_per_m"] == approx(
        shear[at] / (top[at] - zero["top_displacement_m"])
    )
    assert found["drift_at_peak_force"] == approx(
        whole.series["drift_ratio"][shear.idxmax()] - zero["drift_ratio"], rel=1e-6
    )


# --- single supports ------------------------------------------------------------------------------


@pytest.mark.yade
@pytest.mark.long
def test_yade_moves_a_support_as_the_reference_solver_does(yade_command, tmp_path):
    """The left one of a pier."""
    script = REPOSITORY / "tests/yade/checks/settling_support.py"
    yade_command(script, tmp_path / "results.npz", status=0)
    found = np.load(tmp_path / "results.npz")
    (layout, time_step) = pier()
    expected = settle(ReferenceSolver(layout, time_step))
    assert_allclose(found["supports"], expected["supports"], rtol=1e-9, atol=1e-15)
    for name in ("moved", "reactions"):
        largest = np.abs(expected[name]).max()
        assert_allclose(found[name], expected[name], atol=0.01 * largest)
    assert_allclose(found["input_j"], expected["input_j"], rtol=0.02)


def test_one_support_and_one_below_each_brick_give_the_same_wall():
    """Supports at rest are one ground, however many: to the last bit."""
    walls = []
    for kind in ("one", "bricks"):
        layout = lay_out(
            Wall("pier", 1.35, 0.6, [Opening(0.45, 0.45, 0.3)], lintel="courses"),
            ModelOptions(supports=kind),
            scatter=0.3,
            seed=4,
        )
        wall = solver_of(layout)
        wall.start(Harmonic(0.02, 2.0).drive.base(np.arange(600) * wall.time_step))
        wall.run(600)
        walls.append(wall)
    one, bricks = walls
    assert np.array_equal(one.displacement, bricks.displacement) and one.state.any()
    assert_allclose(one.support_force[:, :2], [bricks.support_force[:, :2].sum(axis=0)], rtol=1e-12)
    assert len(bricks.support_force) == 4


# --- soil -----------------------------------------------------------------------------------------

SOIL = 1e8
FOOTING = 0.4


def block(length, height):
    """A rigid block on soil, on Gauss points, which integrate its springs exactly."""
    return Wall("block", length, height, precompression=0.0, brick=Brick(length, height, 0.2))


def stiffness(layout):
    """Vertical and horizontal springs per length [N/m2], of soil and base joint in series."""
    contacts = layout.contacts
    thickness = layout.wall.brick.thickness
    assert np.ptp(contacts.normal_stiffness) == 0
    return contacts.normal_stiffness[0] * thickness, contacts.shear_stiffness[0] * thickness


def test_springs_are_soil_and_base_joint_in_series_over_the_footing():
    options = {"contacts": "gauss", "footing": FOOTING, "soil_shear": 0.3}
    soft, rigid = (
        lay_out(block(1.0, 1.0), ModelOptions(soil=soil, **more))
        for soil, more in ((SOIL, options), ("rigid", {"contacts": "gauss"}))
    )
    for found, hard, soil in zip(stiffness(soft), stiffness(rigid), (SOIL, 0.3 * SOIL)):
        assert 1 / found == approx(1 / hard + 1 / (soil * FOOTING), rel=1e-12)
    assert not soft.contacts.tensile_strength.any() and np.all(
        soft.contacts.cohesion == rigid.contacts.cohesion
    )


def test_bricks_that_split_stand_on_the_soil_as_others_do():
    of_base = []
    for strength in (None, 1e6):
        wall = Wall("pier", 0.9, 0.6, brick=Brick(tensile_strength=strength))
        contacts = lay_out(wall, ModelOptions(soil=SOIL)).contacts
        of_base.append(contacts.normal_stiffness[contacts.first < 0])
    assert_allclose(of_base[1], of_base[0], rtol=1e-7)


def periods(layout, weight=True):
    """Closed form: periods [s] of sway and rocking of a rigid block on a bed of springs, with the
    weight's moment."""
    return (
        2
        * math.pi
        / np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(*matrices(layout, weight)))))
    )


def matrices(layout, weight=True):
    """Mass and stiffness (2, 2) of the centre's displacement and the rotation."""
    wall = layout.wall
    up, along = stiffness(layout)
    mass = layout.total_mass
    half = wall.height / 2
    inertia = mass * (wall.length**2 + wall.height**2) / 12
    sway = along * wall.length
    rock = up * wall.length**3 / 12 - (mass * GRAVITY * half if weight else 0.0)
    # Of the centre's displacement and the rotation, which moves the base by half the height.
    k = np.array([[sway, sway * half], [sway * half, sway * half**2 + rock]])
    return np.diag([mass, inertia]), k


@pytest.mark.parametrize(
    "length, height, share", [(0.6, 1.8, 1.0), (1.8, 0.3, 0.05)], ids=["rocks", "slides"]
)
def test_the_period_of_a_block_is_that_of_the_closed_form(length, height, share):
    """A slender block rocks and a flat one on soft shear springs sways in its first mode."""
    options = {"contacts": "gauss", "soil": SOIL, "footing": FOOTING, "soil_shear": share}
    layout = lay_out(block(length, height), ModelOptions(**options))
    expected = periods(layout, weight=False).max()
    assert natural_modes(layout).period_s[0] == approx(expected, rel=1e-6)
    history = run(layout.wall, free_vibration=True, rest=0.6, **options)
    assert not history.opening_m.any()  # it does not lift off
    assert not history.series["drift_ratio"].any()  # of a rigid block, which only moves as its base
    found = natural_period(
        *(history.moving[name].to_numpy() for name in ("time_s", "top_displacement_m"))
    )
    assert found == approx(periods(layout).max(), rel=5e-3)


def test_the_base_lifts_off_at_the_exact_moment():
    """Stress by weight and moment is zero at the outermost point: M = W L^2 / (12 x)."""
    options = {"contacts": "gauss", "soil": SOIL, "footing": FOOTING}
    wall = block(0.6, 1.2)
    history = run(wall, pushover=0.06, speed=1e-4, **options)
    weight = GRAVITY * history.bodies["mass_kg"].sum()
    reach = wall.length / 2 - history.joints["x_m"].min()
    sample = int(np.argmax(history.opening_m.max(axis=1) > 0))
    lifted = history.joints["x_m"][history.opening_m[sample] > 0]
    assert len(lifted) == 1 and abs(lifted.iloc[0] - wall.length / 2) == approx(reach)
    moment = (
        history.series["top_force_n"] * wall.height / 2
        + weight * history.series["top_displacement_m"]
    )[sample]
    assert moment == approx(weight * wall.length**2 / (12 * reach), rel=5e-3)


def test_drift_leaves_the_rocking_of_the_base_out(run_of):
    """Most of the top's motion on soft soil is that of the base, whose rotation and translation
    have columns."""
    shaken = run_of("on soil")
    series = shaken.series
    assert energy_error_of(shaken) < 1e-4
    by_top = series["top_displacement_m"].abs().max() / shaken.attributes["drift_height_m"]
    assert series["drift_ratio"].abs().max() < 0.5 * by_top
    rebuilt = (
        series["drift_ratio"] * shaken.attributes["drift_height_m"]
        + series["base_translation_m"]
        - np.sin(series["base_rotation_rad"])
        * (shaken.attributes["drift_height_m"] - shaken.masonry_wall.brick.height / 2)
    )
    assert np.allclose(rebuilt, series["top_displacement_m"], atol=1e-12)


def test_a_rotational_spring_at_the_top_carries_its_share(tmp_path):
    """A block on soil that is pushed at its centre: springs of sway and rocking, the top's, and the
    weight's moment."""
    options = {"contacts": "gauss", "soil": SOIL, "footing": FOOTING}
    wall = block(0.6, 1.2)
    spring = 2e6
    layout = lay_out(wall, ModelOptions(**options))
    up, along = stiffness(layout)
    history = run(wall, pushover=0.01, speed=1e-4, top_rotation=spring, dt=5e-5, **options)
    rock = up * wall.length**3 / 12 + spring - GRAVITY * layout.total_mass * wall.height / 2
    expected = 1 / (1 / (along * wall.length) + (wall.height / 2) ** 2 / rock)
    last = history.series.iloc[-1]
    assert last["top_force_n"] / last["top_displacement_m"] == approx(expected, rel=5e-3)
    assert energy_error_of(history) < 1e-3
    refused_with(
        "is too stiff for time steps of",
        run,
        wall,
        pushover=0.01,
        top_rotation=1e12,
        **options,
    )
