"""Houses as data, and their layouts, beside plane walls, beam theory and what must be refused."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, written
from numpy.testing import assert_allclose

from damage import Brick, Floor, Joint, ModelOptions, Opening, Wall, load_wall
from damage.house.drawn import drawn, ranges
from damage.house.house import Corner, Diaphragm, House, Placed, outline, read_house
from damage.house.layout import JOIST_M2, JOIST_PA, lay_out_house
from damage.house.meeting import warn_of_lone_walls
from damage.house.ties import Ties
from damage.linear.modes import natural_modes, stiffness_matrix
from damage.motion.settlement import Settlement
from damage.wall.kinds import BED, GROUND, SLAB_COURSE
from damage.wall.layout import lay_out

BOX = REPOSITORY / "houses/box.toml"
TALL = {"height": 0.8, "precompression": 0, "brick": Brick(0.4, 0.2, 0.2)}
ASHLAR = {"height": 0.4, "precompression": 0, "brick": Brick(0.4, 0.2, 0.2)}


def test_a_house_of_one_wall_has_the_wall_s_periods_wherever_it_stands():
    wall = Wall("small", 0.675, 0.6)
    plane = lay_out(wall)
    house = lay_out_house(House("one", [Placed(wall, (3, 1), 37)]))
    assert_allclose(house.total_joint_length, plane.total_joint_length, rtol=1e-12)
    found = natural_modes(house, 8)
    expected = natural_modes(plane, 2)
    apart = np.abs(found.period_s[:, np.newaxis] / expected.period_s - 1).min(axis=0)
    assert apart.max() < 1e-6
    assert found.critical_time_step_s <= expected.critical_time_step_s


def test_a_cantilever_vibrates_out_of_plane_as_a_beam():
    """Timoshenko's beam by Dunkerley's formula: bending, and shear on the whole section."""
    young = 1e9
    shear = 4e8
    wide = 0.4
    thick = 0.2
    high = 2.0
    brick = Brick(wide, 0.1, thick, young_modulus=young, shear_modulus=shear)
    wall = Wall("beam", wide, high, precompression=0, brick=brick, joint=Joint(1e13, 4e12))
    found = natural_modes(lay_out_house(House("beam", [Placed(wall, direction=20)])), 1)
    line = brick.density * wide * thick
    bending = 2 * np.pi * high**2 / 3.5160 * np.sqrt(line / (young * wide * thick**3 / 12))
    sliding = 4 * high * np.sqrt(line / (shear * wide * thick))
    assert_allclose(found.period_s[0], np.hypot(bending, sliding), rtol=0.01)


def test_a_wall_drifts_by_its_top_course_where_corners_take_the_bricks_over_its_piers():
    door = Opening(left=0.4, width=0.8, height=0.8)
    one = Wall("one", 1.6, openings=(door,), lintel="concrete", **ASHLAR | {"height": 1.2})
    other = Wall("other", 1.2, base_course="half", **ASHLAR | {"height": 1.2})
    places = (
        Placed(one),
        *(Placed(replace(other, name=name), (x, -0.1), 90) for name, x in (("l", 0.1), ("r", 1.5))),
    )
    house = House("u", places, [Corner(("one", name), "toothed") for name in "lr"])
    layout = lay_out_house(house)
    top = layout.wall_drift_bodies[0]
    assert len(top) > 0
    assert set(layout.bodies.course[top]) == {5} and set(layout.bodies.wall[top]) == {0}


def _box(tmp_path, old, new):
    for name in ("front.toml", "side.toml"):
        written(tmp_path / name, (BOX.parent / name).read_text())
    text = BOX.read_text()
    assert old in text
    return written(tmp_path / "house.toml", text.replace(old, new, 1))


def _floor(level, one, other, kind="timber"):
    """Words of the box, and the same behind a floor on two of its walls."""
    floor = f'level = {level}\nwalls = ["{one}", "{other}"]\nkind = "{kind}"\nmass_per_area = 400'
    return "[[corners]]", f"[[floors]]\n{floor}\n[[corners]]"


@pytest.mark.parametrize(
    "old, new, says",
    [
        ("[0.1, -0.1]", "[0.1, 0.3]", "front and left miss by 0.4 m: expected a toothed corner"),
        (
            "[0.1, -0.1]",
            "[0.101, -0.1]",
            "miss by 0.001 m: expected a toothed corner; origin = [0.1, -0.1] of left closes",
        ),
        (
            "[0, 1.8]",
            "[0, 1.5]",
            "miss by 0.3 m: expected a toothed corner; origin = [0, 1.8] of back closes it",
        ),
        (
            "direction = 90",
            "direction = -90",
            "miss by 0.2 m: expected a toothed corner; direction = 90 of left closes it",
        ),
        ("[0, 1.8]", "[1e4, 0]", "these are no metres, or of two plans"),
        ('"side.toml"\nname', '"front.toml"\nname', "expected a half brick of one in the place"),
        ('["front", "left"]', '["front", "lift"]', "expected two of its walls, front, left"),
        ('"toothed"', '"butted"', 'expected a butted corner; kind = "toothed" closes it'),
        ("direction = 90", "direction = 80", "another than a right angle: expected 90"),
        ('name = "right"', 'name = "left"', "two walls named left"),
        ('name = "box"', 'name = "box"\nroofs = 1', "has the key roofs: expected one of name"),
        (*_floor(2.6, "left", "right"), "takes courses 13 to 13 of 10"),
        (*_floor(1, "front", "left"), "floor at 1 m: walls front and left: expected"),
        (*_floor(1, "left", "attic"), "expected two or more of its walls, front"),
        (*_floor(1, "left", "right", "concrete"), "front is in its way at (0.200, 0.000, 0.900) m"),
        ('"side.toml"', '"sode.toml"', "no such wall file"),
        (
            '[[corners]]\nwalls = ["front", "left"]\nkind = "toothed"\n',
            "",
            "expected a corner of theirs in [[corners]]",
        ),
    ],
)
def test_a_house_that_cannot_be_is_refused_with_its_place(tmp_path, old, new, says):
    path = _box(tmp_path, old, new)
    assert says in one_line_error(lambda: lay_out_house(read_house(path)))


def _moved(house, change):
    """The house with other origins."""
    walls = [replace(one, origin=change(np.array(one.origin))) for one in house.walls]
    return replace(house, walls=walls)


def test_origins_of_a_map_or_in_another_unit_are_named():
    house = read_house(BOX)
    corner = np.array([252341.5, 593107.2])
    assert "subtract [252341.5, 593107.2] from each" in one_line_error(
        _moved, house, lambda origin: origin + corner
    )
    large = _moved(house, lambda origin: 100 * origin)
    assert "origins in m, as all are in cm, closes it" in one_line_error(lay_out_house, large)


def test_walls_may_be_given_clockwise():
    house = read_house(BOX)
    front, left, right, back = house.walls
    clockwise = (
        left,
        replace(back, origin=(2.0, 1.8), direction=180),
        replace(right, origin=(1.9, 1.9), direction=-90),
        front,
    )
    found = lay_out_house(replace(house, walls=clockwise))
    expected = lay_out_house(house)
    assert_allclose(found.total_mass, expected.total_mass)
    assert found.n_joints == expected.n_joints


@pytest.mark.parametrize("number", [1, 2, 4])
def test_a_wall_that_is_listed_twice_is_named(number):
    house = read_house(BOX)
    front = house.walls[0]
    again = replace(front, wall=replace(front.wall, name="again"))
    walls = *house.walls[:number], again, *house.walls[number:]
    assert "walls front and again lie on each other" in one_line_error(
        lay_out_house, replace(house, walls=walls)
    )


def test_walls_that_nothing_joins_are_named():
    lone = replace(_cavity(y=3.0), ties=())
    assert "joins inner, outer to another wall" in warn_of_lone_walls(lone)[0]
    slab = Diaphragm(0.8, ("inner", "outer"), 400, "concrete", 0.2)
    for joined in (_cavity(), replace(lone, floors=[slab]), read_house(BOX)):
        assert warn_of_lone_walls(joined) == []


def test_the_house_of_the_guide_ships():
    guide = (REPOSITORY / "docs/guides/house.md").read_text()
    for name in ("small", "small_front", "small_side"):
        _, _, rest = guide.partition(f"```toml\n# houses/{name}.toml\n")
        block, _, _ = rest.partition("```\n")
        assert block
        assert (REPOSITORY / f"houses/{name}.toml").read_text().endswith(block)


def test_a_house_is_found_by_its_name_and_one_that_is_not_suggests_another(
    tmp_path, output_of, error_of
):
    output_of("draw", "small", "--out", tmp_path / "small.svg")
    assert "did you mean small?" in error_of("draw", "smal")
    assert "did you mean houses/terraced.toml?" in error_of("draw", "houses/terrace.toml")


def test_what_takes_a_wall_says_that_this_is_a_house():
    assert "houses run by ./yade" in one_line_error(load_wall, BOX)
    soil = ModelOptions(soil=3e7)
    assert "house box with --soil" in one_line_error(lay_out_house, read_house(BOX), soil)


def test_equal_walls_of_a_house_have_strengths_of_their_own():
    layout = lay_out_house(read_house(BOX), ModelOptions(strength_cov=0.3, strength_seed=1))
    contacts = layout.contacts
    wall = layout.bodies.wall
    inside = (contacts.kind == BED) & (wall[contacts.first] == wall[contacts.second])
    bond = [
        contacts.tensile_strength[
            inside & (wall[contacts.second] == layout.house.names.index(name))
        ]
        for name in ("left", "right")
    ]
    assert len(bond[0]) == len(bond[1]) and not np.isclose(*bond).any()


def test_inputs_of_a_house_are_drawn_for_its_floors_too():
    house = read_house(REPOSITORY / "houses/terraced.toml")
    masses = [one.mass_per_area for one in drawn(house, ranges("typical"), 3).floors]
    factor = masses[0] / house.floors[0].mass_per_area
    assert factor != 1 and masses == [factor * one.mass_per_area for one in house.floors]


def test_corners_of_two_masonries_have_the_weaker_properties():
    """Each wall keeps its own, and gives up one half brick at the corner for a whole one of the
    other; in between they lie on each other, t x t, and meet end to face."""
    ends = ("one", "whole", 5e9, 2e5, 0.5, 1500), ("other", "half", 8e9, 1e5, 0.7, 2000)
    walls = []
    for name, base, stiff, bond, friction, density in ends:
        joint = Joint(stiff, 2e9, friction, 1e5, bond)
        brick = replace(ASHLAR["brick"], density=density)
        walls.append(Wall(name, 0.8, base_course=base, **ASHLAR | {"joint": joint, "brick": brick}))
    placed = Placed(walls[0]), Placed(walls[1], (0.1, -0.1), 90)
    layout = lay_out_house(House("two", placed, [Corner(("one", "other"), "toothed")]))
    assert_allclose(layout.total_mass, 0.2 * 0.2 * (1500 * (0.8 + 0.6) + 2000 * (0.6 + 0.8)))
    contacts = layout.contacts
    wall = layout.contacts.wall
    for number, cohesion in ((0, 2e5), (1, 1e5), (-1, 1e5)):
        assert set(contacts.cohesion[wall == number]) == {cohesion}
    friction = layout.of_contacts(np.array([0.5, 0.7]))
    assert [set(friction[wall == number]) for number in (0, 1, -1)] == [{0.5}, {0.7}, {0.5}]
    flat = (wall == -1) & (contacts.kind == 0)
    area = contacts.area
    upright = (wall == -1) & ~flat
    assert_allclose([area[flat].sum(), area[upright].sum()], [0.2 * 0.2, 2 * 0.2 * 0.2])
    brick = walls[0].brick
    assert_allclose(contacts.normal_stiffness[flat], 1 / (1 / 5e9 + 0.2 / brick.young_modulus))


def test_bricks_of_two_sizes_or_what_runs_in_the_plane_alone_are_refused():
    one = Wall("one", 0.9, 0.6)
    other = Wall("other", 0.9, 0.6, brick=Brick(0.45, 0.075, 0.1025))
    assert "expected one size" in one_line_error(House, "h", [Placed(one), Placed(other, (0, 3))])
    soft = Wall(
        "soft", 0.9, 0.6, joint=Joint(mode_i_fracture_energy=10, mode_ii_fracture_energy=50)
    )
    assert "fracture energies" in one_line_error(House, "h", [Placed(soft)])


def _condensed(layout, onto):
    """Stiffness of a layout with no load elsewhere, of the coordinates of one body."""
    full = stiffness_matrix(layout).toarray()
    of_each = len(full) // len(layout.bodies)
    kept = np.arange(of_each * onto, of_each * (onto + 1))
    rest = np.setdiff1d(np.arange(len(full)), kept)
    by_rest = np.linalg.solve(full[np.ix_(rest, rest)], full[np.ix_(rest, kept)])
    return (full[np.ix_(kept, kept)] - full[np.ix_(kept, rest)] @ by_rest)[:3, :3]


def test_a_slab_makes_walls_share_a_push_by_their_stiffness():
    """A push on the slab moves all walls alike, so that stiffnesses add up to that of the house,
    and mass is that of the whole slab."""
    walls = [Wall(name, wide, **TALL) for name, wide in (("a", 0.8), ("b", 1.6), ("c", 0.8))]
    placed = [Placed(one, (-one.length / 2, y)) for one, y in zip(walls, (0, 2, 4))]
    slab = Diaphragm(0.8, ("a", "b", "c"), 400, "concrete", 0.2)
    house = lay_out_house(House("three", placed, floors=[slab]))
    number = int(np.flatnonzero(house.bodies.course == SLAB_COURSE)[0])
    strip = Floor(0.8, 1.0, kind="concrete", depth=0.2)
    single = [lay_out(replace(one, floors=(strip,))) for one in walls]
    alone = [_condensed(one, one.n_bricks) for one in single]
    assert_allclose(_condensed(house, number), sum(alone), rtol=1e-6, atol=1e-6 * alone[1].max())
    shares = [(one @ np.linalg.solve(sum(alone), [1.0, 0, 0]))[0] for one in alone]
    assert_allclose(sum(shares), 1)
    assert shares[1] > 2 * shares[0]
    assert_allclose(house.bodies.mass[number], 400 * 1.6 * 4.2, rtol=1e-6)


@pytest.mark.parametrize("profile", ["hogging", "sagging", "knick", "tilt"])
def test_the_ground_below_a_house_follows_its_profile_along_the_heading(profile):
    """Below each brick the chord over the brick, from where the house begins to where it ends."""
    house = replace(read_house(BOX), heading=30)
    given = 1 / 500
    settlement = Settlement(profile, given)
    layout = lay_out_house(house, ModelOptions(supports="bricks"))
    heading = np.array([np.cos(np.radians(30)), 0.5])
    low, high = outline(house.walls)
    # both parts of the heading are positive
    begins = low @ heading
    length = (high - low) @ heading
    end = settlement.displacement([1e3], layout.ground)[0]
    bricks = [layout.contacts.second[layout.contacts.first == GROUND - k] for k in range(len(end))]
    there = np.array([len(one) > 0 for one in bricks])
    body = np.array([one[0] for one in bricks if len(one)])
    along = np.abs(layout.of_body[body, 0, :2] @ heading)
    width = along * layout.bodies.length[body] + np.sqrt(1 - along**2) * 0.2
    middle = layout.centres[body, :2] @ heading - begins

    def ground(x):
        return settlement.vertical(x, length)

    before = ground(middle - width / 2)
    after = ground(middle + width / 2)
    assert_allclose(end[there, 1], (before + after) / 2, atol=1e-8)
    assert_allclose(end[there, 2], np.arctan((after - before) / width), atol=1e-8)
    assert np.ptp(end[there, 1]) > 0.4 * given * length / 2


def test_timber_floors_load_parallel_walls_by_half_their_spans_and_anchors_tie_them():
    """The middle wall bears half of both spans; where one end wall moves away by a metre, each
    joist takes EA/L, one at least."""
    walls = [Placed(Wall(name, 1.6, **TALL), (0, y)) for name, y in (("a", 0), ("b", 2), ("c", 5))]
    floor = Diaphragm(0.8, ("a", "b", "c"), 50)
    free, tied, once, bare = (
        lay_out_house(House("three", walls, floors=floors))
        for floors in (
            [floor],
            [replace(floor, anchor_spacing=0.5)],
            [replace(floor, anchor_spacing=2.0)],
            [],
        )
    )
    more = [np.sum((free.bodies.mass - bare.bodies.mass)[free.bodies.wall == k]) for k in range(3)]
    assert_allclose(more, 50 * 1.6 * np.array([1, 2.5, 1.5]), rtol=1e-6)
    away = np.zeros((len(free.bodies), 6))
    away[free.bodies.wall == 2, 3] = 1.0
    held, one, loose = (
        away.ravel() @ stiffness_matrix(layout) @ away.ravel() for layout in (tied, once, free)
    )
    for force, joists in ((held, 3), (one, 1)):
        assert_allclose(force - loose, joists * JOIST_PA * JOIST_M2 / 3, rtol=1e-4)


def _cavity(per_area=6.25, y=0.3, **outer):
    """A house of two leaves, 1.6 x 0.8 m, the outer one seen from outside."""
    leaves = [Wall("inner", 1.6, **TALL), Wall("outer", 1.6, **TALL, **outer)]
    places = Placed(leaves[0]), Placed(leaves[1], (1.6, y), 180)
    return House("cavity", places, ties=[Ties(("inner", "outer"), per_area, 1e6, 1000, 500)])


def test_ties_join_the_units_of_two_leaves_at_the_same_place():
    """Four columns and two rows: each takes its stiffness where the outer leaf moves away, and none
    where it moves along; a window in one leaf takes away one."""
    window = Opening(left=0.8, width=0.4, height=0.4, sill=0.4)
    for outer, number in (({}, 8), ({"openings": (window,)}, 7)):
        house = _cavity(**outer)
        tied, loose = (lay_out_house(one) for one in (house, replace(house, ties=())))
        moved = np.zeros((2, len(tied.bodies), 6))
        moved[0, tied.bodies.wall == 1, 3] = moved[1, tied.bodies.wall == 1, 0] = 1.0
        found = [
            [one.ravel() @ stiffness_matrix(layout) @ one.ravel() for one in moved]
            for layout in (tied, loose)
        ]
        assert_allclose(np.subtract(*found), [number * 1e6, 0], rtol=1e-3, atol=50)
        ends = np.stack([tied.contacts.first, tied.contacts.second])[:, tied.n_joints :]
        places = tied.centres[ends]
        assert np.ptp(places[..., 0], axis=0).max() < 0.5


def test_ties_without_two_leaves_at_their_place_are_refused_with_it():
    assert "more than the thickness of 0.2 m" in one_line_error(_cavity, y=0.0)
    assert "at (1.6, 0.1) m: expected a cavity" in one_line_error(_cavity, y=0.1)
    window = Opening(left=0.4, width=0.8, height=0.4, sill=0.2)
    assert "as at (0.800, 0.000, 0.400) m" in one_line_error(
        lambda: lay_out_house(_cavity(0.5, openings=(window,)))
    )
    turned = replace(_cavity(), ties=())
    for walls, says in (
        (["inner", "attic"], "inner, outer, that are"),
        (["inner"] * 2, "parallel"),
    ):
        assert says in one_line_error(replace, turned, ties=[Ties(walls, 4, 1e6, 1e3, 1e3)])


def test_the_terraced_house_that_ships_weighs_what_its_floors_bring():
    """A slab on its whole plan in place of a course of the ring below it, and a roof between the
    middles of the party walls."""
    house = read_house(BOX.with_name("terraced.toml"))
    more = 450 * 4.5 * 5.0 + 80 * 4.25 * 5.0 - 1900 * 0.25 * (4.5 * 5.0 - 4.0 * 4.5)
    found = [lay_out_house(one).total_mass for one in (house, replace(house, floors=()))]
    assert_allclose(found[0] - found[1], more, rtol=1e-6)
