"""Houses in YADE: a wall by itself wherever it stands, rocking, symmetry, corners, and what reads
their histories."""

import json
import signal

import h5py
import numpy as np
import pytest
from conftest import REPOSITORY, SHORT, TINY, wall_file, written
from numpy.testing import assert_allclose
from scipy.sparse.linalg import spsolve

from damage import read_history
from damage.history.in_space import InSpace
from damage.house.house import read_house
from damage.house.layout import lay_out_house
from damage.linear.modes import stiffness_matrix
from damage.measure.energy import energy_error
from damage.run.checkpoint import checkpoint_path, read_checkpoint

pytestmark = pytest.mark.yade

MOTION = "--harmonic 0.05 0.5 --cycles 1 --rest 0.02 --no-pictures"
DATA = REPOSITORY / "yade_scripts/wall_data.py"
BRIEF = (*SHORT, "SHORTEST_S=0.1")


def _check(yade_command, *words):
    """{check: figures} of some of the checks of space.py."""
    script = REPOSITORY / "tests/yade/checks/space.py"
    done = yade_command("-n -x -j1", script, *words, status=0)
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def checked(yade_command):
    """Those that take seconds, one after the other in one YADE."""
    return _check(yade_command, "block box tilt dry ties masonries bonded")


@pytest.fixture(scope="module")
def turned(yade_command, tmp_path_factory):
    """Histories of a wall that cracks, and of its house, turned by 37 degrees with the motion."""
    folder = tmp_path_factory.mktemp("space")
    wall = wall_file(folder / "tiny.py", TINY)
    house = written(
        folder / "house.toml",
        'name = "house"\nheading = 37\n'
        '[[walls]]\nfile = "tiny.py"\norigin = [3, 1]\ndirection = 37\n',
    )
    for words, name in (((wall,), "wall"), ((DATA, house), "house")):
        yade_command(*SHORT, *words, MOTION, "--out", folder / f"{name}.h5", status=0)
    return {name: read_history(folder / f"{name}.h5") for name in ("wall", "house")}


def test_a_house_of_one_wall_moves_as_the_wall(turned):
    wall = turned["wall"]
    house = turned["house"]
    drift = [one.series["drift_ratio"].abs().max() for one in (wall, house)]
    shear = [one.series["base_shear_n"].abs().max() for one in (wall, house)]
    assert_allclose(drift[1], drift[0], rtol=0.02)
    assert_allclose(shear[1], shear[0], rtol=0.02)
    failed = [one.broken[-1].mean() for one in (wall, house)]
    assert failed[0] > 0.02
    assert abs(failed[1] - failed[0]) < 0.1
    assert abs(house.index()["DI"].max() - wall.index()["DI"].max()) < 0.03
    assert energy_error(house.series) < 0.01
    assert (
        np.abs(house.house.across_m).max() < 0.01 * house.series["top_displacement_m"].abs().max()
    )


def test_a_wall_of_a_house_is_read_in_its_plane(turned, output_of, error_of):
    house = turned["house"]
    part = read_history(house.path.with_name("house:tiny.h5"))
    assert part.wall == "tiny"
    assert part.masonry_wall.name == "tiny"
    for name in ("DI", "DI_drift"):
        assert_allclose(part.index()[name], house.index()[name], atol=1e-12)
    assert part.plan.n_bricks == len(part.bodies[part.bodies["course"] >= 0])
    assert "tiny / harmonic" in output_of("index", part.path)
    said = error_of("index", house.path.with_name("house:roof.h5"))
    assert "no wall or face roof: expected one of tiny" in said


def test_bodies_stand_apart_in_space_by_what_their_joints_have_opened(turned):
    """The opening of a contact point is the distance of its two sides along its normal; that of the
    history counts from the unloaded wall, bodies from the end of the static stage."""
    house = turned["house"]
    space = InSpace(turned["house"])
    snapshot = int(np.argmax(np.abs(house.displacement[..., 0]).max(axis=1)))
    sample = int(np.abs(house.series["time_s"] - house.snapshot_time_s[snapshot]).argmin())
    opened = np.flatnonzero(house.opening_m[sample] > 1e-5)
    assert len(opened) > 3
    joints = house.joints.iloc[opened]
    wall = house.house.joint_wall[opened]
    places = np.stack([joints["x_m"], house.house.joint_y_m[opened], joints["z_m"]], axis=1)
    places = house.placing.in_house(wall, places[:, None])
    first, second = (space.moved(body, places, snapshot) for body in space.joint_bodies[opened].T)
    normal = np.where(
        (joints["kind"] == "head").to_numpy()[:, None], *house.placing.axes[0, [0, 2]]
    )
    apart = np.sum((second - first)[:, 0] * normal, axis=1)
    stiffness = joints["normal_stiffness_pa_m"].min()
    at_rest = 2 * house.masonry_wall.precompression / stiffness  # compression, not even
    assert_allclose(apart, house.opening_m[sample, opened], atol=at_rest, rtol=1e-3)
    assert at_rest < 0.05 * house.opening_m[sample].max()


def test_a_dry_block_rocks_out_of_plane_in_housner_s_quarter_period(checked):
    """Also where another solver takes over while contacts are out of reach: they close again."""
    found = checked["block"]
    assert_allclose(found["quarter_s"], found["exact_s"], rtol=0.01)
    assert found["gap_m"] < 1e-5
    out_of_reach, left = found["gone"]
    assert out_of_reach and not left


def test_a_box_with_floors_stays_symmetric_and_keeps_energy_and_momentum(checked):
    found = checked["box"]
    assert found["largest_m"] > 1e-6
    assert found["asymmetry"] < 1e-6
    assert_allclose(found["balance"], 1, atol=0.01)
    assert_allclose(found["momentum"], found["impulse"], rtol=1e-9)


def continued(yade_command, whole, words, *times):
    """Tables of the last checkpoint [s] at which a run was killed: what it continues to has the
    bits of the run at `whole`."""
    cut = whole.with_name("cut.h5")
    place = "--out"
    for time_s in times:
        done = yade_command(*BRIEF, f"KILLED_AT={time_s}", *words, place, cut)
        assert done.returncode == -signal.SIGKILL
        place = "--resume"
    there = read_checkpoint(checkpoint_path(cut), scene=False)
    yade_command(*BRIEF, *words, "--resume", cut, status=0)
    with h5py.File(whole) as one, h5py.File(cut) as other:
        names = []
        one.visit(names.append)
        for name in names:
            if isinstance(one[name], h5py.Dataset):
                np.testing.assert_array_equal(other[name][()], one[name][()], name)
    return there


def test_a_house_that_was_killed_continues_to_the_same_bits(turned, yade_command):
    whole = turned["house"].path
    words = (DATA, whole.with_suffix(".toml"), MOTION)
    there = continued(yade_command, whole, words, 0.03)
    assert there["tracker.broken"].any()
    assert np.abs(there["zero_out_of_plane"]).max() > 0


@pytest.mark.long
def test_a_house_with_corners_and_floors_continues_to_the_same_bits(yade_command, tmp_path):
    """A slab and anchored joists, shaken at an angle: killed at rest and, with loose bricks, in the
    motion; on ground that settles; pushed; and a cavity wall whose ties have failed."""
    size = "length = 1.2\nheight = 0.8\nprecompression = 0\n"
    brick = "brick = { length = 0.4, height = 0.2, thickness = 0.2 }\n"
    joint = "joint = { tensile_strength = 1e4, cohesion = 2e4 }\n"
    for name, base in (("front", "whole"), ("side", "half")):
        text = f'name = "{name}"\nbase_course = "{base}"\n{size}{brick}{joint}'
        written(tmp_path / f"{name}.toml", text)
    text = 'name = "house"\nheading = 30\n'
    walls = '["front", "side", "right"]'
    for name, x in (("side", 0.1), ("right", 1.1)):
        text += f'[[walls]]\nfile = "side.toml"\nname = "{name}"\norigin = [{x}, -0.1]\n'
        text += f'direction = 90\n[[corners]]\nwalls = ["front", "{name}"]\nkind = "toothed"\n'
    text += '[[walls]]\nfile = "front.toml"\n'
    text += f'[[floors]]\nlevel = 0.4\nkind = "concrete"\nwalls = {walls}\nmass_per_area = 300\n'
    text += '[roof]\nwalls = ["side", "right"]\nmass_per_area = 50\nanchor_spacing = 0.4\n'
    house = written(tmp_path / "house.toml", text)
    for number, (loading, *times) in enumerate(
        (
            ("--harmonic 0.05 2 --cycles 1 --rest 0", -1, 0.03),
            ("--settle sagging --distortion 1/20000", -0.06),
            ("--pushover 0.1 --floor-share 0.4 1", 0.02),
            ("--harmonic 0.04 0.4 --cycles 1 --rest 0.02", 0.04),
        )
    ):
        whole = tmp_path / f"{number}.h5"
        words = (DATA, cavity(tmp_path) if number == 3 else house, loading, "--no-pictures")
        yade_command(*BRIEF, *words, "--out", whole, status=0)
        there = continued(yade_command, whole, words, *times)
        assert there["tracker.broken"].any() or number
        assert len(there["corners"]) or number
        assert len(there["removed"]) or number < 3
        whole.with_name("cut.h5").unlink()


def test_a_house_turns_with_its_ground_without_strain(checked):
    found = checked["tilt"]
    assert found["moved"] < 1e-3
    assert found["opening"] < 1e-4


def test_a_dry_house_that_slides_keeps_its_energy(checked):
    """Also what YADE's own sum of the work of friction lacks."""
    found = checked["dry"]
    assert_allclose(found["balance"], 1, atol=0.005)
    assert found["friction"] > 0.5
    assert found["left_out"] > 0.05


def test_ties_share_a_push_and_fail_at_their_strength_with_their_energy(checked):
    """Two blocks that slide and rock on their joints, springs joined by a third."""
    found = checked["ties"]
    for way in ("tension", "compression"):
        one = found[way]
        assert_allclose(one["share"], one["exact_share"], rtol=1e-4)
        assert abs(one["force_n"] - one["exact_n"]) < 50
    assert found["failed"] == 1
    assert_allclose(found["energies"], 1, atol=0.01)


def test_each_wall_of_a_house_slides_by_its_own_friction(checked):
    found = checked["masonries"]
    resting, sliding = found["moved_mm"]
    assert abs(resting) < 0.1
    assert_allclose(sliding, found["exact_mm"], rtol=0.02)


def cavity(tmp_path):
    """The file of two leaves, of which one bears a load and sways less, with ties that fail."""
    size = "length = 0.4\nheight = 0.8\njoint = { tensile_strength = 1e6, cohesion = 1e6 }\n"
    brick = "brick = { length = 0.4, height = 0.2, thickness = 0.1 }\n"
    for name, load in (("inner", 2e5), ("outer", 0)):
        written(
            tmp_path / f"{name}.toml", f'name = "{name}"\nprecompression = {load}\n{size}{brick}'
        )
    ties = 'walls = ["inner", "outer"]\nper_area = 6.25\nstiffness = 1e6\n'
    ties += "tension = 100\ncompression = 5000\n"
    walls = '[[walls]]\nfile = "inner.toml"\n[[walls]]\nfile = "outer.toml"\norigin = [0, 0.2]\n'
    return written(
        tmp_path / "cavity.toml", f'name = "cavity"\nheading = 90\n{walls}[[ties]]\n{ties}'
    )


@pytest.mark.long
def test_a_run_counts_the_ties_that_fail(yade_command, output_of, tmp_path):
    house = cavity(tmp_path)
    motion = "--harmonic 0.04 0.4 --cycles 1 --rest 0.01 --no-pictures"
    out = tmp_path / "cavity.h5"
    yade_command(*SHORT, DATA, house, motion, "--out", out, status=0)
    history = read_history(out)
    assert history.house.failed_ties[0] == 0
    assert 0 < history.house.failed_ties[-1] <= 2
    assert energy_error(history.series) < 0.01
    failed = json.loads(output_of("index", out, "--json"))["failed_ties"]
    assert failed == history.house.failed_ties[-1]


def test_the_bond_of_a_toothed_front_that_fails_first_is_the_elastic_one(checked):
    """In the head joint at the middle of its top, where a plate on three sides bends most."""
    found = checked["bonded"]
    one = found["yade"]
    other = found["elastic"]
    assert_allclose(one.pop("multiplier"), other.pop("multiplier"), rtol=0.03)
    assert one == other
    assert found["kind"] == "tension"


@pytest.mark.long
def test_a_motion_in_space_is_the_same_whichever_way_its_components_are_named(
    yade_command, tmp_path
):
    """North and then west, or west and then south for a house whose heading is a right angle
    further; upwards it is the same."""
    time = 0.005 * np.arange(13)
    found = []
    waves = [size * np.sin(2 * np.pi * time / 0.06) for size in (2.0, 1.0, 0.5)]
    words = {"north": waves[0], "south": -waves[0], "west": waves[1], "up": waves[2]}
    for name, wave in words.items():
        rows = "\n".join(f"{t:.4f},{a:.6f}" for t, a in zip(time, wave))
        start = "# start 2018-01-08T14:00:37Z; time_s,acc_m_s2\ntime_s,acc_m_s2\n"
        words[name] = written(tmp_path / f"{name}.csv", start + rows + "\n")
    wall_file(tmp_path / "tiny.py", TINY)
    for heading, record, across in ((0, "north", "west"), (90, "west", "south")):
        house = written(
            tmp_path / f"at{heading}.toml",
            f'name = "h"\nheading = {heading}\n[[walls]]\nfile = "tiny.py"\n',
        )
        motion = ("--record", words[record], "--across", words[across], "--vertical", words["up"])
        out = ("--rest 0.01 --no-pictures --out", house.with_suffix(".h5"))
        yade_command(*SHORT, DATA, house, *motion, *out, status=0)
        found.append(read_history(house.with_suffix(".h5")))
    one, other = found
    tops = [run.house.top_displacement_m for run in found]
    assert_allclose(tops[1], tops[0], rtol=1e-6, atol=1e-9 * np.abs(tops[0]).max())
    assert_allclose(one.house.across_m, other.house.across_m, rtol=1e-6, atol=1e-12)
    assert np.abs(one.house.across_m).max() > 1e-5
    along = [run.series["base_acceleration_x_m_s2"].to_numpy() for run in found]
    assert_allclose(one.house.base_acceleration_m_s2, along[1], atol=1e-9)
    assert_allclose(other.house.base_acceleration_m_s2, -along[0], atol=1e-9)
    up = one.series["base_acceleration_z_m_s2"]
    assert_allclose(up.abs().max(), 0.5, rtol=0.02)
    assert energy_error(one.series) < 0.01


def test_a_push_on_a_slab_meets_the_elastic_stiffness_in_its_direction(yade_command, tmp_path):
    """Two walls below a slab, pushed at 30 degrees: force over displacement by the joints'
    stiffness alone."""
    size = "length = 0.8\nheight = 0.8\nprecompression = 0\n"
    brick = "brick = { length = 0.4, height = 0.2, thickness = 0.2 }\n"
    joint = "joint = { tensile_strength = 2e6, cohesion = 2e6 }\n"
    written(tmp_path / "a.toml", 'name = "a"\n' + size + brick + joint)
    walls = ['[[walls]]\nfile = "a.toml"\n', 'name = "b"\norigin = [0, 1.0]\n']
    slab = 'level = 0.8\nkind = "concrete"\nwalls = ["a", "b"]\nmass_per_area = 300\n'
    text = f'name = "pair"\nheading = 30\n{walls[0]}{walls[0]}{walls[1]}[[floors]]\n{slab}'
    path = written(tmp_path / "house.toml", text)
    out = tmp_path / "pair.h5"
    push = ("--pushover 0.002 --floor-share 0.8 1.0 --no-pictures --out", out)
    yade_command(*SHORT, DATA, path, *push, status=0)
    history = read_history(out)
    layout = lay_out_house(read_house(path))
    shares = layout.push_shares([(0.8, 1.0)])
    along, across, up = layout.of_body.transpose(1, 0, 2) @ [np.sqrt(0.75), 0.5, 0.0]
    force = np.zeros((len(shares), 6))
    force[:, [0, 3, 1]] = np.column_stack([along, across, up]) * shares[:, np.newaxis]
    moved = spsolve(stiffness_matrix(layout).tocsc(), force.ravel()) @ force.ravel()
    found = history.displacement[-1] @ [1, 0, 0] * force[:, 0]
    found += history.house.out_of_plane[-1] @ [1, 0, 0] * force[:, 3]
    assert_allclose(history.series["top_force_n"].iloc[-1], found.sum() / moved, rtol=0.01)


@pytest.mark.long
def test_a_dry_front_between_toothed_walls_falls_at_the_multiplier_by_hand(yade_command):
    """The front of 10 bricks and the 8 of both wedges at 45 degrees turn about its outer edge and
    open all joints to the rest: no friction; sum m y / sum m z = 0.463."""
    found = _check(yade_command, "corner", 0.45, 0.48)["corner"]
    assert found["0.45"]["speed_mm_s"] < 0.1
    assert found["0.45"]["moved"] == 0
    assert found["0.48"]["speed_mm_s"] > 5
    assert found["0.48"]["moved"] > 5


@pytest.mark.long
@pytest.mark.parametrize("strength", [0, 5e4])
def test_a_strip_between_floors_folds_out_of_plane_as_the_plane_model(yade_command, strength):
    """Three hinges, at both ends and at the seventh of twelve courses: 0.971 by virtual work; bonds
    fail before."""
    found = _check(yade_command, "strip", strength, 0.94, 1.0)["strip"]
    for solver in ("yade", "plane"):
        assert abs(found[f"{solver} 0.94"]["speed_mm_s"]) < 0.1
        assert found[f"{solver} 1"]["speed_mm_s"] < -1
        gaping = found[f"{solver} 1"]["open"]
        assert (
            {"1.4": -1, "2.4": 1}.items()
            <= gaping.items()
            <= {"0.0": 1, "1.4": -1, "2.4": 1}.items()
        )


@pytest.mark.long
def test_each_wall_of_a_box_with_windows_has_its_index_and_pictures(
    yade_command, output_of, error_of, tmp_path
):
    out = tmp_path / "box.h5"
    words = ("--harmonic 0.1 0.5 --cycles 1 --rest 0.02 --out", out)
    yade_command(*SHORT, DATA, REPOSITORY / "houses/box.toml", *words, status=0)
    history = read_history(out)
    assert [part.wall for part in history.parts] == ["front", "left", "right", "back"]
    assert energy_error(history.series) < 0.01
    assert sum(len(part.joints) for part in history.parts) < len(history.joints)
    assert (tmp_path / "box" / "space_max.png").is_file()
    found = json.loads(output_of("index", out, "--json"))
    assert list(found["walls"]) == ["front", "left", "right", "back"]
    assert len(found["corners"]) == 4
    assert "has an index of each wall" in error_of("compare", out, out)
