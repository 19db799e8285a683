"""Any legal wall: random ones with openings off the grid, gables, floors and every kind of
lintel."""

from collections import Counter

import numpy as np
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from damage import InputError, ModelOptions
from damage.units import GRAVITY
from damage.wall.file import wall_from
from damage.wall.kinds import BED, CUT, GROUND, HEAD
from damage.wall.layout import lay_out

SIZES = st.sampled_from([(0.28, 0.1), (0.225, 0.075), (0.21, 0.06), (0.4, 0.2)])
LINTELS = ("courses", "concrete", "timber", "steel", "arch")


def metres(least, most):
    """Lengths to 10 mm, as drawings have them."""
    return st.integers(round(100 * least), round(100 * most)).map(
        lambda hundredths: hundredths / 100
    )


@st.composite
def walls(draw):
    """Tables of a wall file; what is drawn need not be legal."""
    brick_length, brick_height = draw(SIZES)
    length = draw(metres(1.0, 4.0))
    height = draw(metres(0.8, 2.4))
    openings = draw(
        st.lists(
            st.fixed_dictionaries(
                {
                    "left": metres(0.3, 2.5),
                    "width": metres(0.3, 1.2),
                    "height": metres(0.2, 1.2),
                    "sill": metres(0.0, 0.9),
                }
            ),
            max_size=2,
        )
    )
    table = {
        "name": "any",
        "length": length,
        "height": height,
        "precompression": draw(st.sampled_from([0.0, 1e5])),
        "brick": {"length": brick_length, "height": brick_height, "thickness": 0.1},
        "openings": openings,
        "lintel": draw(st.sampled_from(LINTELS)),
        "base_course": draw(st.sampled_from(["whole", "half"])),
    }
    if draw(st.booleans()):
        table["outline"] = [[0.0, height / 2], [length / 2, height], [length, height / 2]]
        table["precompression"] = 0.0
    if draw(st.booleans()):
        table["floors"] = [
            {
                "level": draw(metres(0.5, 2.0)),
                "mass": 500.0,
                "kind": draw(st.sampled_from(["timber", "concrete"])),
            }
        ]
    return table


def laid_out(table, **options):
    """The Layout of a table; a wall that is refused is not legal, and another one is drawn."""
    try:
        return lay_out(wall_from(table), ModelOptions(**options))
    except InputError:
        assume(False)


any_legal_wall = settings(
    max_examples=30,
    deadline=None,
    derandomize=True,
    database=None,
    suppress_health_check=[HealthCheck.filter_too_much, HealthCheck.too_slow],
)


@any_legal_wall
@given(walls(), st.sampled_from(["interior", "corners", "gauss"]), st.booleans())
def test_every_joint_resists_rotation(table, placing, splits):
    """Two bodies that lie on each other, or two parts of a lintel, share contact points at two
    places or more, so that no brick, or half of one, can turn while a bed joint of its own is
    intact."""
    layout = laid_out(
        table | {"brick": table["brick"] | ({"tensile_strength": 2e6} if splits else {})},
        contacts=placing,
    )
    contacts = layout.contacts
    course = layout.bodies.course
    along = np.where(contacts.upright, contacts.z, contacts.x)
    in_lintel = (
        (course[contacts.first] < -2) & (course[contacts.second] < -2) & (contacts.first >= 0)
    )
    asked = np.flatnonzero(
        (contacts.kind == BED) | (contacts.kind == CUT) | (in_lintel & (contacts.kind == HEAD))
    )
    places = {(contacts.first[row], contacts.second[row], round(along[row], 6)) for row in asked}
    assert min(Counter((first, second) for first, second, _ in places).values()) >= 2


@any_legal_wall
@given(walls())
def test_bodies_do_not_overlap_and_cover_what_is_drawn(table):
    """The area of bricks, slabs and lintels is that of the courses between the outline and the
    openings: by hand, from the table's numbers, where the outline is a rectangle and no slab runs
    through an opening."""
    layout = laid_out(table)
    wall = layout.wall
    bodies = layout.bodies
    n = layout.n_below_caps
    x, z, length, height = (getattr(bodies, name)[:n] for name in ("x", "z", "length", "height"))
    apart = np.maximum(
        np.abs(x[:, None] - x) - (length[:, None] + length) / 2,
        np.abs(z[:, None] - z) - (height[:, None] + height) / 2,
    )
    assert apart[~np.eye(n, dtype=bool)].min() > -1e-9
    area = np.sum(length * height)
    assert_allclose(
        area,
        wall.brick.height * sum(right - left for runs in layout.plan.runs for left, right in runs)
        + np.sum((length * height)[layout.n_bricks :]),
        rtol=1e-9,
    )
    slabs = [floor.courses(wall) for floor in wall.floors if floor.kind == "concrete"]
    crossed = any(
        first < over and under < above
        for first, above in slabs
        for under, over in map(wall.opening_courses, wall.openings)
    )
    if not (wall.outline or crossed):
        holes = sum(
            opening.width * wall.brick.height * (above - first)
            for opening in wall.openings
            for first, above in [wall.opening_courses(opening)]
        )
        assert_allclose(area, wall.length * wall.built_height - holes, rtol=1e-9)


@any_legal_wall
@given(walls(), st.sampled_from(["piers", "uniform", "beam"]))
def test_the_mass_is_that_of_what_is_drawn(table, top):
    """Mass of bricks, lintels, floors and the precompression, each by its density, mass or stress;
    where the outline is a rectangle the first three by the table's numbers.  A part of a timber
    floor may lie on no brick."""
    layout = laid_out(table, top=top)
    wall = layout.wall
    bodies = layout.bodies
    bricks = slice(layout.n_bricks)
    lintels = slice(layout.n_bricks + len(layout.plan.slabs), layout.n_below_caps)
    brick = wall.brick
    lintel = wall.lintel
    section = bodies.height[lintels]
    density = brick.density
    # of its own height, where it has all courses that it wants
    if lintel.is_body and lintel.kind != "arch":
        wanted = brick.height * lintel.courses(brick)
        density = lintel.value_of("density")
        section = np.where(section > wanted - 1e-6, lintel.value_of("height"), section)
    masonry = (
        brick.density * brick.thickness * np.sum(bodies.length[bricks] * bodies.height[bricks])
    )
    beams = density * brick.thickness * np.sum(bodies.length[lintels] * section)
    floors = sum(floor.mass for floor in wall.floors)
    stress = table["precompression"]
    assert_allclose(
        layout.total_mass,
        masonry + beams + floors + stress * table["length"] * brick.thickness / GRAVITY,
        rtol=2.0**-26,
    )
    caps = 0 if top == "uniform" or not stress else 1 if top == "beam" else len(layout.plan.piers)
    assert len(bodies) - layout.n_below_caps == caps


@any_legal_wall
@given(walls())
def test_bed_joints_cover_what_lies_on_what(table):
    """The length of bed joints is that of the faces that touch, whatever the number of contact
    points on them."""
    layout = laid_out(table)
    bodies = layout.bodies
    contacts = layout.contacts
    n = layout.n_below_caps
    left = bodies.x[:n] - bodies.length[:n] / 2
    right = bodies.x[:n] + bodies.length[:n] / 2
    bottom = bodies.z[:n] - bodies.height[:n] / 2
    top = bodies.z[:n] + bodies.height[:n] / 2
    overlap = np.minimum(right[:, None], right) - np.maximum(left[:, None], left)
    touching = (np.abs(top[:, None] - bottom) < 1e-6) & (overlap > 1e-6)
    bed = contacts.kind == BED
    assert_allclose(
        contacts.length[bed & (contacts.first != GROUND)].sum(), overlap[touching].sum(), rtol=1e-9
    )
    assert_allclose(
        contacts.length[bed & (contacts.first == GROUND)].sum(),
        np.sum((right - left)[bottom < 1e-6]),
        rtol=1e-9,
    )
