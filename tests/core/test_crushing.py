"""Joints that crush or soften, and bricks that split: layouts, histories, both solvers on one
joint, walls with known results; the law: `test_joint_law.py`."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import REPOSITORY, one_line_error, parsed
from numpy.testing import assert_allclose
from pytest import approx
from short_runs import solver_of
from small_history import make_history

import damage
from damage import Brick, Joint, ModelOptions, Opening, Wall, load_wall
from damage.law.joint_law import diagonal_tension
from damage.measure.summary import summarise
from damage.measure.tables import summary_row
from damage.run.settings import SOFTENING_BETA_S
from damage.wall.file import wall_from
from damage.wall.kinds import CAP, CUT
from damage.wall.layout import lay_out
from damage.wall.parameters import crushing_energy, softening_energies
from damage.wall.split import CUT_POINTS
from verification import crushing, softening

SPLITTING = Brick(tensile_strength=1e6)


@pytest.mark.yade
@pytest.mark.long
def test_a_crushed_joint_slides_alike_in_both_solvers():
    """Stresses along the path and both energies within 0.5 %; sliding takes tan(phi) of what
    crushing has left."""
    path = crushing.crushed_and_slid()
    yade, reference = (
        crushing.driven_along(solver, crushing.SOFTENS, path) for solver in ("yade", "reference")
    )
    for name in ("normal_stress", "shear_stress"):
        there = getattr(reference, name)
        assert_allclose(getattr(yade, name), there, atol=5e-3 * np.abs(there).max())
    assert_allclose(
        [yade.friction, yade.fracture], [reference.friction, reference.fracture], rtol=5e-3
    )
    pressed = path[:, 0].argmin() + 400  # the end of the first slide at the last depth
    strength = -reference.normal_stress[pressed]
    assert strength < 0.4 * crushing.STRENGTH
    assert reference.shear_stress[pressed] == approx(
        np.tan(softening.JOINT.friction_angle) * strength, rel=1e-3
    )


class TestParameters:
    def test_the_rule_is_continuous_and_above_80_mpa_proportional(self):
        assert crushing_energy(11.22e6) == approx(17952)
        # the sources' constants: 2 % apart
        assert crushing_energy(12e6) == approx(1.6 * 12e3, rel=0.03)
        assert crushing_energy(100e6) == approx(33e3)

    def test_lintels_and_cuts_do_not_crush(self):
        wall = Wall("lintel", 0.9, 0.45, joint=Joint(compressive_strength=5e6), brick=SPLITTING)
        contacts = lay_out(wall).contacts
        crushes = np.isfinite(contacts.compressive_strength)
        assert_allclose(crushes, (contacts.kind != CUT) & (contacts.kind != CAP))


class TestCuts:
    def test_halves_keep_mass_moment_and_inertia_of_their_bricks(self):
        wall = Wall("small", 0.9, 0.45)
        whole = lay_out(wall).bodies
        split = lay_out(replace(wall, brick=SPLITTING)).bodies
        for weight in (np.ones_like, lambda x: x, np.square):
            sums = [np.sum(of.mass * weight(of.x)) for of in (whole, split)]
            if weight is np.square:
                sums = [
                    total + np.sum(of.inertia - of.mass * of.height**2 / 12)
                    for total, of in zip(sums, (whole, split))
                ]
            assert_allclose(*sums)
        assert_allclose(np.unique(split.length.round(9)), [SPLITTING.length / 2, 0.9])

    def test_whole_bricks_alone_are_cut(self):
        wall = Wall("window", 1.53, 0.975, (Opening(0.63, 0.4, 0.6),), lintel="courses")
        whole = lay_out(wall)
        split = lay_out(replace(wall, brick=SPLITTING))
        contacts = split.contacts
        cuts = contacts.kind == CUT
        n_whole = np.isclose(whole.bodies.length[: whole.n_bricks], SPLITTING.length).sum()
        assert 0 < n_whole < whole.n_bricks
        assert np.sum(cuts) == CUT_POINTS * n_whole
        assert not contacts.elastic[cuts].any()
        assert_allclose(contacts.tensile_strength[cuts], 0.8e6)
        for body in (contacts.first, contacts.second):
            on = np.flatnonzero(body >= 0)
            reach = np.abs(contacts.x[on] - split.bodies.x[body[on]])
            assert np.all(reach <= split.bodies.length[body[on]] / 2 + 1e-9)

    def test_the_index_and_its_length_are_of_joints_alone(self):
        wall = Wall("small", 0.9, 0.45)
        whole = lay_out(wall)
        split = lay_out(replace(wall, brick=SPLITTING))
        assert split.total_joint_length == approx(whole.total_joint_length)
        assert split.n_joints - whole.n_joints == CUT_POINTS * 21

    def test_a_course_is_as_soft_as_its_bricks(self):
        """A cut takes its share of the bricks' compliance from the head joints beside it."""
        wall = Wall("row", 0.9, 0.075, precompression=0.0)
        stiffness = []
        for brick in (Brick(), SPLITTING):
            contacts = lay_out(replace(wall, brick=brick)).contacts
            across = contacts.upright
            pairs = {}
            for row in np.flatnonzero(across):
                key = int(contacts.first[row]), int(contacts.second[row])
                pairs[key] = (
                    pairs.get(key, 0.0) + contacts.normal_stiffness[row] * contacts.area[row]
                )
            stiffness.append(sum(1 / value for value in pairs.values()))
        half = SPLITTING.length / 2 / SPLITTING.young_modulus / (0.075 * 0.1025)
        # four cuts, and three joints less a half each
        assert stiffness[1] == approx(stiffness[0] + half, rel=1e-9)


class TestDiagonalTension:
    def test_a_cut_bears_what_the_stress_above_and_below_it_allows(self):
        """In the middle of a wall at rest: its load and half of its weight, within 2 %."""
        layout = lay_out(Wall("small", 0.9, 0.375, brick=SPLITTING))
        wall = solver_of(layout, 0.3)
        wall.adaptive_damping = 1.0
        wall.start(np.zeros((0, 2)))
        wall.run(round(0.1 / wall.time_step))
        contacts = layout.contacts
        weight = SPLITTING.density * 9.81 * layout.wall.height / 2
        course = layout.bodies.course[contacts.first]
        cuts = (contacts.kind == CUT) & (course == 2) & (abs(contacts.x - 0.45) < 0.2)
        found = wall.system.strengths["cohesion"][cuts] / contacts.area[cuts]
        assert found.mean() == approx(diagonal_tension(1e6, -0.3e6 - weight), rel=0.02)

    def test_a_wall_of_an_older_version_is_refused_with_what_to_write(self):
        table = {"name": "old", "length": 0.9, "height": 0.45, "brick": {"cohesion": 1e6}}
        for read in (wall_from, Wall.from_dict):
            assert "tensile strength f_t alone" in one_line_error(read, table)
        assert Wall.from_dict(table | {"brick": {"cohesion": None}}).brick == Brick()


class TestHistory:
    @pytest.fixture(scope="class")
    def history(self, tmp_path_factory):
        layout = lay_out(Wall("small", 0.9, 0.45, brick=SPLITTING))
        cuts = np.flatnonzero(layout.contacts.kind == CUT)
        return make_history(
            tmp_path_factory.mktemp("split") / "split.h5",
            layout,
            opening={int(cut): 1e-3 for cut in cuts[:CUT_POINTS]},
        )

    def test_a_split_brick_is_in_no_index_but_in_psi_and_a_column_of_its_own(self, history):
        found = summarise(history)
        assert found["max"]["DI"] == 0.0 and found["max_psi"] > 1
        assert (
            found["split_length_m"] == approx(SPLITTING.height) and found["crushed_length_m"] == 0.0
        )
        assert found["total_joint_length_m"] == approx(
            float(history.attributes["total_joint_length_m"])
        )
        assert summary_row(history)["split_length_m"] == approx(SPLITTING.height)


# --- joints that soften ---------------------------------------------------------------------------

FIVE_FIFTY = {"mode_i_fracture_energy": 5.0, "mode_ii_fracture_energy": 50.0}
SOFT = Joint(**FIVE_FIFTY)


def test_a_softening_wall_gets_a_little_damping():
    """And a smaller step: `test_run.py`."""
    assert parsed().for_joint(SOFT).beta_s == SOFTENING_BETA_S
    assert parsed().for_joint(Joint()).beta_s == 0.0
    assert parsed("--beta 0").for_joint(SOFT).beta_s == 0.0


def test_it_is_another_draw_than_that_of_the_walls_own_scatter():
    wall = Wall("w", 2.0, 1.5)
    both = lay_out(
        wall, ModelOptions(strength_cov=0.1, strength_seed=1), scatter=0.1, seed=1
    ).contacts
    own = lay_out(wall, ModelOptions(strength_cov=0.1, strength_seed=1)).contacts
    drawn = np.log(both.cohesion[~own.elastic] / own.cohesion[~own.elastic])
    assert abs(np.corrcoef(drawn, np.log(own.cohesion[~own.elastic]))[0, 1]) < 0.2


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "energies", "least", "most", "words"),
    [
        ("squat_tested", FIVE_FIFTY, 70e3, 85e3, {"pushover": 0.07}),
        ("comp2_4", FIVE_FIFTY, 119e3, 145e3, {"pushover": 0.06, "boundary": "fixed"}),
        (
            "comp2_4",
            softening_energies(0.13125e6),
            0.85 * 131.6e3,
            1.15 * 131.6e3,
            {"pushover": 0.1, "boundary": "fixed"},
        ),
        (
            "squat_tested",
            softening_energies(0.18375e6),
            0.85 * 77.3e3,
            1.15 * 77.3e3,
            {"pushover": 0.1},
        ),
        (
            "comp2_1",
            FIVE_FIFTY,
            0.97 * 59.0e3,
            1.03 * 59.0e3,
            {"pushover": 0.2, "boundary": "fixed"},
        ),
    ],
    ids=str,
)
def test_tested_walls_peak_where_the_document_says(name, energies, least, most, words):
    """Walls that shear have the tests' forces, of one that rocks the brittle wall's, pushed over
    slowly; docs/validation/laboratory.md."""
    wall = load_wall(REPOSITORY / "walls" / f"{name}.py")
    wall = replace(wall, joint=replace(wall.joint, **energies))
    summary = summarise(damage.run(wall, **words, speed=2e-3))
    assert summary["energy_error_fraction"] < 0.01
    assert least < summary["peak_force_n"] < most
