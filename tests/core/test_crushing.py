"""Joints that crush, and bricks that split: the law by hand, layouts, histories, and both solvers
on one wall."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import one_line_error
from numpy.testing import assert_allclose
from pytest import approx
from short_runs import solver_of
from small_history import make_history

from damage.law.joint_law import (
    ContactState,
    LawParameters,
    Material,
    advance,
    diagonal_tension,
    elastic_energy,
    range_left,
)
from damage.measure.summary import summarise
from damage.measure.tables import summary_row
from damage.wall.file import wall_from
from damage.wall.kinds import CAP, CUT
from damage.wall.layout import lay_out
from damage.wall.parameters import Brick, Joint, Opening, Wall, crushing_energy
from damage.wall.split import CUT_POINTS
from verification import crushing, softening

KN, KS, FT, C, MU, FC = 6e10, 2.4e10, 0.2e6, 0.24e6, 0.6, 3e6
LAW = LawParameters(KN, KS, FT, C, Material(MU), compressive_strength=FC)
SOFT = LAW._replace(mode_i_energy=10.0, mode_ii_energy=100.0)
DEEP = FC / KN
"""Opening [m] at which LAW crushes, without its sign."""
G_C = 600.0
TOES = LAW._replace(crushing_energy=G_C)
"""LAW whose crushing softens; its bond softens, too: SOFT_TOES."""
SOFT_TOES = SOFT._replace(crushing_energy=G_C)
SPLITTING = Brick(tensile_strength=1e6)


def follow(openings, state=None, law=LAW):
    states = [state or ContactState()]
    for opening in openings:
        states.append(advance(opening, 0.0, states[-1], law)[0])
    return states[1:]


class TestLaw:
    @pytest.mark.parametrize("law", [LAW, SOFT])
    def test_stress_stays_at_the_strength_and_unloads_with_the_stiffness(self, law):
        pressed, less, again = follow([-3 * DEEP, -2.5 * DEEP, -3.5 * DEEP], law=law)
        assert pressed.normal_stress == approx(-FC) and pressed.closure == approx(2 * DEEP)
        assert less.normal_stress == approx(-FC / 2) and less.closure == pressed.closure
        assert again.normal_stress == approx(-FC) and again.closure == approx(2.5 * DEEP)

    def test_a_step_across_the_strength_dissipates_the_trapezium_of_its_stresses(self):
        """From zero to f_c while the joint closes by 2 DEEP: f_c DEEP is put in, of which half is
        stored."""
        (state,) = follow([-2 * DEEP])
        assert elastic_energy(state.normal_stress, 0.0, KN, KS) == approx(0.5 * FC * DEEP)
        assert state.fracture_work == approx(0.5 * FC * DEEP)

    def test_a_whole_bond_holds_across_the_closure(self):
        *_, pulled, gone = follow(
            [-3 * DEEP, -2 * DEEP + 0.99 * FT / KN, -2 * DEEP + 1.01 * FT / KN]
        )
        assert pulled.normal_stress == approx(0.99 * FT) and not pulled.broken
        assert gone.broken and gone.normal_stress == 0.0

    def test_friction_is_that_of_the_strength(self):
        state = ContactState(broken=True)
        for _ in range(3):
            state, _ = advance(-5 * DEEP, 2 * FC / KS, state, LAW)
        assert state.shear_stress == approx(MU * FC)

    def test_below_the_strength_nothing_differs_to_the_last_bit(self):
        path = np.random.default_rng(1).uniform(-0.99 * DEEP, 2 * FT / KN, 200)
        assert follow(path) == follow(path, law=LAW._replace(compressive_strength=math.inf))


class TestSofteningCrushing:
    @pytest.mark.parametrize("steps", [1, 7, 500])
    def test_stress_follows_the_exponential_of_the_closure(self, steps):
        """(C3), in steps of any size: where it is pressed to decides, not how."""
        pressed = follow(-np.linspace(0, 10 * DEEP, steps + 1)[1:], law=TOES)[-1]
        assert pressed.normal_stress == approx(
            -FC * math.exp(-FC * pressed.closure / G_C), rel=1e-12
        )
        assert pressed.closure == approx(10 * DEEP + pressed.normal_stress / KN, rel=1e-12)

    def test_it_unloads_with_its_stiffness_and_crushes_again_at_what_is_left(self):
        pressed, less, again = follow([-5 * DEEP, -4.9 * DEEP, -5 * DEEP], law=TOES)
        assert less.normal_stress - pressed.normal_stress == approx(0.1 * FC)
        assert again.normal_stress == approx(pressed.normal_stress) and again.closure == approx(
            pressed.closure
        )
        left = range_left(pressed, TOES).compressive_strength
        assert (
            left == approx(-pressed.normal_stress, rel=1e-12)
            and range_left(ContactState(), TOES)[-1] == FC
        )


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
        whole, split = lay_out(wall).bodies, lay_out(replace(wall, brick=SPLITTING)).bodies
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
        whole, split = lay_out(wall), lay_out(replace(wall, brick=SPLITTING))
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
        whole, split = lay_out(wall), lay_out(replace(wall, brick=SPLITTING))
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
        contacts, weight = layout.contacts, SPLITTING.density * 9.81 * layout.wall.height / 2
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
