"""Stresses of joints against statics of a pier and of a flat arch; what is shown of them."""

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from pytest import approx
from short_runs import SMALL

from damage import Brick, Joint, Lintel, ModelOptions, Opening, Wall
from damage.measure.joint_stress import contact_forces, sections_table
from damage.measure.tables import write_run_tables
from damage.reference.solver import ReferenceSolver
from damage.units import GRAVITY
from damage.wall.geometry import body_table, joint_table
from damage.wall.layout import lay_out
from verification.collapse import settled_wall

BRICK = Brick(0.2, 0.1, 0.1)
PIER = Wall(
    "pier",
    0.2,
    1.0,
    precompression=0.5e6,
    brick=BRICK,
    joint=Joint(tensile_strength=1e6, cohesion=1e6),
)
NO_TENSION = Joint(2e10, 1e10, 1.2, 0.0, 1e7)


def at_rest(layout, across=0.0, steps=60000):
    """Instants of a wall at rest under its weight and a horizontal acceleration of its base [m/s2],
    and the solver."""
    solver = ReferenceSolver(layout, 2e-5)
    solver.with_stresses = True
    solver.damp(adaptive=1.0)
    solver.start(np.tile([across, 0.0], (steps, 1)), np.full(1, GRAVITY))
    for _, count in solver.advance(steps):
        solver.run(count)
    return solver.instants(), solver


def as_history(layout, stress):
    """What the measures take of a History, of one sample."""
    joints = joint_table(layout).assign(area_m2=layout.contacts.area[: layout.n_joints])
    return SimpleNamespace(
        joint_stress_pa=stress,
        joints=joints,
        bodies=body_table(layout),
        plan=layout.plan,
        masonry_wall=layout.wall,
        path="x.h5",
        index=lambda **_: pd.DataFrame({"DI": [0.0]}),
        series=pd.DataFrame({"time_s": [0.0]}),
        time_s=np.zeros(1),
        largest_index=np.zeros(1),
    )


@pytest.fixture(scope="module")
def pier():
    """A pier of one brick under its weight, a mass on top, and a lateral field of 0.3 m/s2, at
    rest."""
    layout = lay_out(PIER, ModelOptions(contacts="gauss"))
    now, _ = at_rest(layout, 0.3)
    return layout, now


def carried(layout, now, z, across):
    """Weight [N], lateral force [N] and moment about the pier's axis [N m] of what is above a
    height, as displaced."""
    bodies = layout.bodies
    (ux, uz) = now.displacement[0, :, :2].T
    above = bodies.z > z
    order = np.argsort(bodies.z, kind="stable")
    axis = 0.1 + np.interp(z, np.append(0.0, bodies.z[order]), np.append(0.0, ux[order]))
    weight = GRAVITY * bodies.mass[above]
    lateral = -across * bodies.mass[above]
    arm = bodies.x[above] + ux[above] - axis
    return weight.sum(), lateral.sum(), lateral @ (bodies.z[above] + uz[above] - z) + weight @ arm


def test_thrust_of_a_pier_passes_where_statics_says(pier):
    layout, now = pier
    table = sections_table(as_history(layout, now.joint_stress_pa), ["rest"])
    assert list(table["part"].unique()) == ["pier 1"] and len(table) == 10
    turn = now.displacement[0, :, 2].max()
    for row in table.itertuples():
        weight, lateral, moment = carried(layout, now, row.place_m, 0.3)
        assert_allclose(row.normal_force_n, -weight, rtol=2e-5)
        # along the joint as it has turned
        assert abs(row.shear_force_n - lateral) <= 1.01 * weight * turn
        assert_allclose(row.thrust_x_m, 0.1 + moment / weight, atol=5e-6)
        assert_allclose(row.eccentricity_over_length, moment / weight / 0.2, atol=2.5e-5)


def test_contact_forces_carry_the_wall_and_every_brick():
    layout = lay_out(SMALL)
    now, _ = at_rest(layout)
    history = as_history(layout, now.joint_stress_pa)
    bodies = layout.bodies
    points = layout.contacts
    force = turned(layout, now, contact_forces(history, 0))
    base = points.first[: layout.n_joints] < 0
    assert force[base, 1].sum() == approx(GRAVITY * bodies.mass.sum(), rel=1e-9)
    on_bodies = np.zeros((len(bodies), 2))
    for sign, side in ((-1, points.first), (1, points.second)):
        of = side[: layout.n_joints]
        np.add.at(on_bodies, of[of >= 0], sign * force[of >= 0])
    on_bodies[:, 1] -= GRAVITY * bodies.mass
    # to the masses on top
    glued = np.concatenate([points.first[layout.n_joints :], points.second[layout.n_joints :]])
    on_bodies[glued] = 0.0
    assert np.abs(on_bodies).max() < 1e-9 * GRAVITY * bodies.mass.sum()


def turned(layout, now, force):
    """Contact forces (n_joints, 2) along the axes of the joints as they have turned, with the mean
    of both bodies."""
    ends = (side[: layout.n_joints] for side in (layout.contacts.first, layout.contacts.second))
    turn = sum(np.where(end < 0, 0.0, now.displacement[0, end, 2]) for end in ends) / 2
    along, up = force.T
    return np.column_stack(
        [along * np.cos(turn) - up * np.sin(turn), along * np.sin(turn) + up * np.cos(turn)]
    )


def flat_arch(courses, high):
    """The Layout of a flat arch of so many courses on two piers of so many others, that it spreads;
    joints without tension, which do not slide and hardly compress.

    Its thrust passes the top of the arch in the middle of the span L and the bottom at its ends, so
    that H h = V L / 4 with its height h and half its weight V = g h L / 2, g per area.  A pier of
    width B below its springing at the height z turns about its outer toe where H z > V B + W B / 2,
    W = g B (z + h): the arch stands if

        h / z > (L^2 / 8 - B^2 / 2) / (L B / 2 + B^2 / 2)

    which is 0.6 for L = 4 B.
    """
    brick = Brick(length=0.36, height=0.06, thickness=0.1)
    lintel = Lintel("arch", courses * brick.height, 0.0)
    opening = Opening(brick.length, 4 * brick.length, high * brick.height, 0.0, lintel)
    size = 6 * brick.length, (high + courses) * brick.height
    wall = Wall("arch", *size, (opening,), 0.0, brick=brick, joint=NO_TENSION)
    return lay_out(wall, ModelOptions(contacts="corners"))


def test_a_flat_arch_falls_5_percent_below_its_least_thickness():
    assert 4 / 7 == approx(0.95 * 0.6, rel=0.01)
    with pytest.raises(ValueError, match="does not stand under its own weight"):
        settled_wall(flat_arch(4, 7))


def test_thrust_of_a_flat_arch_is_the_parabola_of_its_weight():
    """24 bricks on end over 4 bricks' length, nothing on top: H is constant, H (z - crown) = -w (x
    - middle)^2 / 2.  It stands, 4 % above its least thickness."""
    layout = flat_arch(5, 8)
    brick = layout.wall.brick
    now, _ = at_rest(layout, steps=120000)
    table = sections_table(as_history(layout, now.joint_stress_pa), ["rest"])
    arch = table[table["part"] == "arch 1"]
    span = 4 * brick.length
    per_length = GRAVITY * brick.density * brick.thickness * 5 * brick.height
    assert_allclose(
        arch["place_m"].to_numpy(), brick.length + np.arange(25) * brick.height, atol=1e-9
    )
    thrust = -arch["normal_force_n"].mean()
    x = arch["place_m"].to_numpy() - 3 * brick.length
    assert_allclose(arch["normal_force_n"], -thrust, rtol=2e-3)
    assert_allclose(arch["shear_force_n"], per_length * x, atol=2e-3 * per_length * span)
    crown = arch["thrust_z_m"].iloc[12]
    assert_allclose(
        arch["thrust_z_m"], crown - per_length * x**2 / (2 * thrust), atol=2e-3 * 5 * brick.height
    )
    # The arch spreads its piers: its thrust comes near H h = V L / 4, from the top in the middle to
    # the bottom.
    assert (
        per_length * span**2 / 8 / (5 * brick.height)
        < thrust
        < 1.3 * per_length * span**2 / 8 / (5 * brick.height)
    )
    assert_allclose(
        table[table["part"] == "pier 1"]["normal_force_n"].iloc[0],
        -GRAVITY * layout.bodies.mass.sum() / 2,
        rtol=2e-3,
    )


# --- of runs --------------------------------------------------------------------------------------


@pytest.fixture
def shaken(run_of):
    """A wall that cracks, with the stresses of its joints; and the same run
    without."""
    return run_of("stresses"), run_of("shaken")


def test_a_history_keeps_stresses_that_carry_the_wall_and_its_other_bits(shaken):
    kept, without = shaken
    joints = kept.joints
    series = kept.series
    base = (kept.joints["first_body"] < 0).to_numpy()
    assert (
        kept.joint_stress_pa.shape == (len(series), len(joints), 2)
        and without.joint_stress_pa is None
    )
    weights = joints["area_m2"].to_numpy()[base]
    normal, shear = np.moveaxis(kept.joint_stress_pa[:, base].astype(float), 2, 0) @ weights
    assert -normal[0] == approx(kept.static["weight_n"], rel=1e-6)
    assert_allclose(shear, series["base_shear_n"], atol=2e-3 * series["base_shear_n"].abs().max())
    # Small turns: until the first joint fails the axes of joints are those of the base.
    elastic = series["time_s"] < kept.events["time_s"].min()
    assert elastic.sum() > 3
    assert_allclose(
        shear[elastic],
        series["base_shear_n"][elastic],
        atol=1e-4 * series["base_shear_n"].abs().max(),
    )
    for name in ("opening_m", "slip_m", "broken"):
        assert_array_equal(getattr(kept, name), getattr(without, name))
    pd.testing.assert_frame_equal(series, without.series)


def test_the_static_stage_is_kept_to_where_it_ends(shaken):
    kept, _ = shaken
    stage = kept.static_stage
    assert stage["unbalanced_force"].iloc[-1] == kept.static["unbalanced_force"] < 1e-5
    assert stage["time_s"].iloc[-1] == approx(kept.static["duration_s"])
    assert_allclose(np.diff(stage["time_s"]), 500 * kept.time_step_s)
    assert stage["unbalanced_force"].iloc[0] > 0.1


def test_what_is_shown_of_them(shaken, tmp_path, output_of, error_of):
    kept, without = shaken
    added = {"run_stresses.csv", "run_sections.csv"}
    assert added <= {path.name for path in write_run_tables(kept, tmp_path / "run")}
    assert not added & {path.name for path in write_run_tables(without, tmp_path / "run")}
    words = ["--at", "rest,0.03", "--out", str(tmp_path / "st")]
    shown = output_of("stresses", kept.path, *words)
    assert "pier 1 at 0.000 m: N -" in shown
    table = pd.read_csv(tmp_path / "st" / "stresses.csv")
    first = table["normal_stress_pa"][: len(kept.joints)]
    assert_allclose(first, kept.joint_stress_pa[0, :, 0], rtol=1e-7)
    assert (tmp_path / "st" / "contact_forces_0.03.png").exists()
    assert "--at later: expected rest, max, end or a time [s]" in error_of(
        "stresses", kept.path, "--at", "later"
    )
    assert "has no stresses of joints: expected a run with --stresses" in error_of(
        "stresses", without.path
    )
