"""The joint law against closed forms, and its energies against the work done on it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx
from scipy.integrate import quad
from scipy.optimize import brentq

from damage.law.joint_law import (
    AREA,
    GONE,
    INTACT,
    SHEAR,
    TENSION,
    ContactState,
    LawParameters,
    Material,
    advance,
    elastic_energy,
    elastic_range,
    range_left,
    share_left,
    stays_elastic,
    strength_left,
)

KN = 6.557e10
KS = 2.687e10
FT = 0.21e6
C = 0.24e6
MU = math.tan(math.radians(32))
G1 = 5.0
G2 = 50.0
FC = 3e6
G_C = 600.0
DEEP = FC / KN
"""Opening [m] at which a joint crushes, without its sign."""
LAW = LawParameters(KN, KS, FT, C, Material(MU))
SOFT = LAW._replace(mode_i_energy=G1, mode_ii_energy=G2)
CRUSHES = {"compressive_strength": FC}
CRUSHING = LAW._replace(**CRUSHES)
TOES = CRUSHING._replace(crushing_energy=G_C)
"""Crushing that softens."""
LAWS = {
    "brittle": LAW,
    "softening": SOFT,
    "crushing": CRUSHING,
    "softening and crushing": SOFT._replace(**CRUSHES),
    "all soften": SOFT._replace(**CRUSHES, crushing_energy=G_C),
}


def follow(path, law=LAW, state=None):
    """Drive a contact along [(opening, shear displacement), ...]: (states, events, work by the
    trapezium)."""
    state = state or ContactState()
    opening = 0.0
    shear = 0.0
    work = 0.0
    states = []
    events = []
    for at, along in path:
        old = state
        state, event = advance(at, along - shear, state, law)
        work += 0.5 * (old.normal_stress + state.normal_stress) * (at - opening)
        work += 0.5 * (old.shear_stress + state.shear_stress) * (along - shear)
        opening = at
        shear = along
        states.append(state)
        events.append(event)
    return states, events, work


def stored(state, opening, law=LAW):
    """Elastic energy [J/m2] of a state at an opening."""
    in_shear = 0.5 * state.shear_stress**2 / law.shear_stiffness
    if opening > 0:
        return 0.5 * state.normal_stress * opening + in_shear
    return elastic_energy(
        state.normal_stress, state.shear_stress, law.normal_stiffness, law.shear_stiffness
    )


def press(openings, law=CRUSHING):
    """States of a contact along openings [m]."""
    return follow([(opening, 0.0) for opening in openings], law)[0]


@pytest.mark.parametrize("compression", [0.0, 0.1e6, 0.3e6, 1.0e6])
def test_shear_peak_and_residual(compression):
    opening = -compression / KN
    peak = C + compression * MU
    step = peak / KS / 1000
    states, events, _ = follow([(opening, k * step) for k in range(1, 1200)])
    # One step resolves the peak to a thousandth.
    assert max(abs(s.shear_stress) for s in states) == approx(peak, rel=1.1e-3)
    assert states[-1].shear_stress == approx(compression * MU, rel=1e-12, abs=1e-9)
    assert events.count(SHEAR) == 1 and TENSION not in events
    # Equation (11): the whole displacement beyond the residual's elastic part is plastic slip.
    assert states[-1].slip == approx(1199 * step - compression * MU / KS, rel=1e-9)


def test_shear_under_tension_is_weaker_and_opens_the_joint():
    opening = 0.1e6 / KN
    weaker = C - 0.1e6 * MU
    states, events, _ = follow([(opening, 0.99 * weaker / KS), (opening, 1.01 * weaker / KS)])
    assert events == [INTACT, SHEAR]
    assert states[-1][:2] == (0.0, 0.0) and states[-1].at_limit and states[-1].slip == 0.0


def test_slip_is_frozen_while_open_and_reclosing_starts_without_shear():
    path = [
        (FT / KN * 1.01, 0.0),
        (2e-4, 0.0),
        (2e-4, 5e-4),
        (-0.2e6 / KN, 5e-4),
        (-0.2e6 / KN, 5e-4 + 1e-6),
    ]
    states, *_ = follow(path)
    assert states[2].slip == 0.0 and not states[2].at_limit
    assert states[3].normal_stress == approx(-0.2e6)
    assert states[3].shear_stress == 0.0
    assert states[4].shear_stress == approx(KS * 1e-6)


def test_sliding_under_a_changing_normal_stress_balances_step_by_step():
    """Coarse steps: the normal stress falls from 1 MPa to nothing and rises again while the joint
    slides."""
    state = ContactState(broken=True)
    work = 0.0
    opening = -1e6 / KN
    state, _ = advance(opening, 1e-4, state, LAW)  # to the limit
    state = state._replace(friction_work=0.0)
    stored = elastic_energy(state.normal_stress, state.shear_stress, KN, KS)
    for k in range(1, 21):
        old = state
        sigma = -1e6 * abs(math.cos(math.pi * k / 20))
        state, _ = advance(sigma / KN, 2e-5, state, LAW)
        work += (old.normal_stress + state.normal_stress) / 2 * (sigma - old.normal_stress) / KN
        work += (old.shear_stress + state.shear_stress) / 2 * 2e-5
        balance = (
            elastic_energy(state.normal_stress, state.shear_stress, KN, KS)
            - stored
            + state.friction_work
        )
        assert balance == approx(work, rel=1e-12)
    assert state.friction_work > 10


def test_shear_that_a_joint_still_holds_as_it_opens_is_dissipated():
    state = ContactState(normal_stress=-1e5, shear_stress=5e4, broken=True)
    opened, _ = advance(1e-9, 0.0, state, LAW)
    assert opened.friction_work == approx(0.5 * 5e4**2 / KS)
    assert (opened.normal_stress, opened.shear_stress, opened.slip) == (0.0, 0.0, 0.0)


class TestSoftening:
    """A joint that softens by both fracture energies."""

    def test_a_softening_joint_follows_its_envelope_and_unloads_to_the_origin(self):
        opening = 2e-5
        (here,), events, _ = follow([(opening, 0.0)], SOFT)
        # (S1) with (S3): sigma = f_t exp(-AREA f_t w / G_I), w = u - sigma / k_n.
        gap = opening - here.normal_stress / KN
        assert here.normal_stress == approx(FT * math.exp(-AREA * FT * gap / G1), rel=1e-9)
        assert here.gap == approx(gap) and not here.broken and events == [INTACT]
        back, _ = advance(opening / 2, 0.0, here, SOFT)
        assert back.normal_stress == approx(here.normal_stress / 2) and back.kappa == here.kappa
        again, _ = advance(opening, 0.0, back, SOFT)
        assert again.normal_stress == approx(here.normal_stress) and again.kappa == approx(
            here.kappa, rel=1e-9
        )
        closed, _ = advance(-1e-6, 0.0, here, SOFT)
        # the cracked joint is as stiff in compression as ever
        assert closed.normal_stress == -1e-6 * KN

    def test_shear_unloads_with_its_stiffness_and_friction_does_not_soften(self):
        pressure = 0.3e6
        (here,), _, _ = follow([(-pressure / KN, 2e-4)], SOFT)
        left = strength_left(False, SOFT, here.kappa)[1]
        assert here.shear_stress == approx(left + MU * pressure)
        back, _ = advance(-pressure / KN, -1e-6, here, SOFT)
        assert back.shear_stress == approx(here.shear_stress - 1e-6 * KS) and back.slip == here.slip
        assert here.slip == approx(2e-4 - here.shear_stress / KS)

    def test_opening_takes_cohesion_and_sliding_takes_tensile_strength(self):
        (opened,), _, _ = follow([(2e-5, 0.0)], SOFT)
        assert strength_left(False, SOFT, opened.kappa)[1] < 0.6 * C
        (slid,), _, _ = follow([(-1e-7, 2e-4)], SOFT)
        tension = max(
            advance(k * 1e-8, 0.0, slid._replace(shear_stress=0.0), SOFT)[0].normal_stress
            for k in range(1000)
        )
        assert tension == approx(FT * math.exp(-slid.kappa), rel=1e-2) and tension < 0.6 * FT

    @pytest.mark.parametrize("energy", [100.0, 5.0, 0.5])
    def test_opened_and_slid_at_once_it_is_on_its_envelope(self, energy):
        """(S1) to (S3), from where growth of kappa by itself is negligible to 0.99 of it."""
        law = SOFT._replace(mode_i_energy=energy)
        draw = np.random.default_rng(2).uniform
        for _ in range(300):
            opening = draw(0.0, 2e-5)
            shear = draw(0.0, 2e-5)
            (old, new), events, _ = follow([(opening, shear), (1.1 * opening, 1.2 * shear)], law)
            if SHEAR in events or TENSION in events:
                continue
            trial = old.shear_stress + KS * 0.2 * shear
            grown = FT * (new.gap - old.gap) / energy + C * (trial - new.shear_stress) / KS / G2
            assert new.kappa - old.kappa == approx(AREA * grown, rel=1e-9, abs=1e-12)
            assert new.normal_stress <= FT * math.exp(-new.kappa) * (1 + 1e-12)

    def test_its_curve_has_the_area_that_makes_it_take_its_fracture_energies(self):
        left = [share_left(kappa, LAW.material) for kappa in (0.0, 100.0)]
        assert left[0] == 1.0 and left[1] < GONE
        until = brentq(lambda kappa: share_left(kappa, LAW.material) - GONE, 0.0, 100.0, xtol=1e-12)
        assert quad(share_left, 0.0, until, (LAW.material,))[0] == approx(AREA, rel=1e-9)

    def test_the_bond_goes_at_its_last_hundredth_and_says_how(self):
        states, events, _ = follow([(k * 1e-7, 0.0) for k in range(3000)], SOFT)
        failure = events.index(TENSION)
        assert states[failure - 1].normal_stress == approx(GONE * FT, rel=1e-2)
        assert all(
            state[:2] == (0.0, 0.0) and state.broken and not state.at_limit
            for state in states[failure:]
        )
        states, events, _ = follow([(-1e-6, k * 1e-6) for k in range(3000)], SOFT)
        failure = events.index(SHEAR)
        assert (
            not states[failure - 1].at_limit and states[failure].at_limit and states[failure].broken
        )
        assert states[-1].shear_stress == approx(MU * 1e-6 * KN)


class TestCrushing:
    @pytest.mark.parametrize("law", [CRUSHING, SOFT._replace(**CRUSHES)])
    def test_stress_stays_at_the_strength_and_unloads_with_the_stiffness(self, law):
        pressed, less, again = press([-3 * DEEP, -2.5 * DEEP, -3.5 * DEEP], law)
        assert pressed.normal_stress == approx(-FC) and pressed.closure == approx(2 * DEEP)
        assert less.normal_stress == approx(-FC / 2) and less.closure == pressed.closure
        assert again.normal_stress == approx(-FC) and again.closure == approx(2.5 * DEEP)

    def test_a_step_across_the_strength_dissipates_the_trapezium_of_its_stresses(self):
        """From zero to f_c while the joint closes by 2 DEEP: f_c DEEP is put in, of which half is
        stored."""
        (state,) = press([-2 * DEEP])
        assert elastic_energy(state.normal_stress, 0.0, KN, KS) == approx(0.5 * FC * DEEP)
        assert state.fracture_work == approx(0.5 * FC * DEEP)

    def test_a_whole_bond_holds_across_the_closure(self):
        *_, pulled, gone = press(
            [-3 * DEEP, -2 * DEEP + 0.99 * FT / KN, -2 * DEEP + 1.01 * FT / KN]
        )
        assert pulled.normal_stress == approx(0.99 * FT) and not pulled.broken
        assert gone.broken and gone.normal_stress == 0.0

    def test_friction_is_that_of_the_strength(self):
        state = ContactState(broken=True)
        for _ in range(3):
            state, _ = advance(-5 * DEEP, 2 * FC / KS, state, CRUSHING)
        assert state.shear_stress == approx(MU * FC)

    def test_below_the_strength_nothing_differs_to_the_last_bit(self):
        path = np.random.default_rng(1).uniform(-0.99 * DEEP, 2 * FT / KN, 200)
        assert press(path) == press(path, LAW)


class TestSofteningCrushing:
    @pytest.mark.parametrize("steps", [1, 7, 500])
    def test_stress_follows_the_exponential_of_the_closure(self, steps):
        """(C3), in steps of any size: where it is pressed to decides, not how."""
        pressed = press(-np.linspace(0, 10 * DEEP, steps + 1)[1:], TOES)[-1]
        assert pressed.normal_stress == approx(
            -FC * math.exp(-FC * pressed.closure / G_C), rel=1e-12
        )
        assert pressed.closure == approx(10 * DEEP + pressed.normal_stress / KN, rel=1e-12)

    def test_it_unloads_with_its_stiffness_and_crushes_again_at_what_is_left(self):
        pressed, less, again = press([-5 * DEEP, -4.9 * DEEP, -5 * DEEP], TOES)
        assert less.normal_stress - pressed.normal_stress == approx(0.1 * FC)
        assert again.normal_stress == approx(pressed.normal_stress) and again.closure == approx(
            pressed.closure
        )
        left = range_left(pressed, TOES).compressive_strength
        assert (
            left == approx(-pressed.normal_stress, rel=1e-12)
            and range_left(ContactState(), TOES)[-1] == FC
        )


corners = st.lists(
    st.tuples(st.floats(-1.5e-4, 4e-5), st.floats(-2e-4, 2e-4)), min_size=1, max_size=6
)
"""Corners of paths: opening and shear displacement [m]; 5e-5 crushes."""


@pytest.mark.parametrize("name", LAWS)
def test_work_done_is_stored_or_dissipated(name):
    """Along any path of small steps: the trapezium of the work is exact while stresses are linear,
    so that each event within a step leaves a rest of the order of stress times step.  Nothing that
    is lost comes back."""
    law = LAWS[name]
    n = 400

    @settings(max_examples=30, deadline=None)
    @given(corners)
    def check(targets):
        at = np.array([(0.0, 0.0), *targets])
        path = np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b in zip(at, at[1:])])
        states, _, work = follow(path.tolist(), law)
        last = states[-1]
        largest = np.abs(np.diff(path, axis=0, prepend=[(0.0, 0.0)])).max()
        kept = stored(last, path[-1][0] + last.closure, law)
        stress = max(abs(state.normal_stress) + abs(state.shear_stress) for state in states)
        assert work - kept - last.friction_work - last.fracture_work == approx(
            0.0, abs=5 * (stress + FT + C) * largest * (1 + len(targets))
        )
        for value in ("kappa", "gap", "closure", "friction_work", "fracture_work"):
            assert (np.diff([getattr(state, value) for state in states]) >= 0).all()

    check()


@pytest.mark.parametrize("name", LAWS)
def test_stresses_stay_within_what_is_left(name):
    law = LAWS[name]

    @settings(max_examples=60, deadline=None)
    @given(corners)
    def check(targets):
        shear = 0.0
        state = ContactState()
        for opening, target in targets:
            state, _ = advance(opening, target - shear, state, law)
            shear = target
            strength, cohesion = strength_left(state.broken, law, state.kappa)
            assert (
                -law.compressive_strength * (1 + 1e-9)
                <= state.normal_stress
                <= strength * (1 + 1e-9)
            )
            assert (
                abs(state.shear_stress)
                <= max(cohesion - MU * state.normal_stress, 0.0) * (1 + 1e-9) + 1e-6
            )
            assert not (state.broken and state.normal_stress > 0)

    check()


near_the_strengths = st.tuples(
    st.floats(-2.0, 2.0), st.floats(-4.0, 4.0), st.booleans(), st.floats(-0.5, 0.5)
)


@settings(max_examples=300, deadline=None)
@given(near_the_strengths)
def test_the_elastic_domain_is_where_the_law_changes_nothing_but_stresses(place):
    """Opening over f_t/k_n, shear over c/k_s, and a shear stress that a broken contact still holds
    over c."""
    opening, shear, broken, held = place
    opening = opening * FT / KN
    shear = shear * C / KS
    state = ContactState(shear_stress=held * C if broken else 0.0, broken=broken, slip=1e-5)
    sigma = KN * opening
    trial = state.shear_stress + KS * shear
    new, event = advance(opening, shear, state, LAW)
    if stays_elastic(sigma, trial, *strength_left(broken, LAW), MU):
        assert event == INTACT and new == state._replace(normal_stress=sigma, shear_stress=trial)
    else:
        assert (
            event != INTACT
            or abs(new.shear_stress) < abs(trial)
            or new.normal_stress < sigma
            or trial == 0.0
        )


@settings(max_examples=300, deadline=None)
@given(st.floats(-2.0, 1.5), st.floats(-3.0, 3.0))
def test_the_elastic_range_is_the_domain_in_displacements(opening, shear):
    opening = opening * FT / KN
    shear = shear * C / KS
    in_stresses = stays_elastic(KN * opening, KS * shear, FT, C, MU)
    on_the_edge = math.isclose(KN * opening, FT) or math.isclose(
        abs(KS * shear), C - KN * opening * MU
    )
    assert on_the_edge or stays_elastic(opening, shear, *elastic_range(LAW)) == in_stresses
