"""The joint law against closed forms, and its energies against the work done on it."""

import math

import numpy as np
import pytest
import test_softening
from hypothesis import given, settings
from hypothesis import strategies as st
from pytest import approx

from damage.law.joint_law import (
    INTACT,
    SHEAR,
    TENSION,
    ContactState,
    LawParameters,
    Material,
    advance,
    elastic_energy,
    elastic_range,
    stays_elastic,
    strength_left,
)

KN, KS, FT, C, MU = 6.557e10, 2.687e10, 0.21e6, 0.24e6, math.tan(math.radians(32))
LAW = LawParameters(KN, KS, FT, C, Material(MU))


def follow(path, state=None, law=LAW):
    """States and events of a contact along [(opening, shear displacement), ...]."""
    return test_softening.follow(path, law, state)[:2]


@pytest.mark.parametrize("compression", [0.0, 0.1e6, 0.3e6, 1.0e6])
def test_shear_peak_and_residual(compression):
    opening = -compression / KN
    peak = C + compression * MU
    step = peak / KS / 1000
    states, events = follow([(opening, k * step) for k in range(1, 1200)])
    # One step resolves the peak to a thousandth.
    assert max(abs(s.shear_stress) for s in states) == approx(peak, rel=1.1e-3)
    assert states[-1].shear_stress == approx(compression * MU, rel=1e-12, abs=1e-9)
    assert events.count(SHEAR) == 1 and TENSION not in events
    # Equation (11): the whole displacement beyond the residual's elastic part is plastic slip.
    assert states[-1].slip == approx(1199 * step - compression * MU / KS, rel=1e-9)


def test_shear_under_tension_is_weaker_and_opens_the_joint():
    opening = 0.1e6 / KN
    weaker = C - 0.1e6 * MU
    states, events = follow([(opening, 0.99 * weaker / KS), (opening, 1.01 * weaker / KS)])
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
    states, _ = follow(path)
    assert states[2].slip == 0.0 and not states[2].at_limit
    assert states[3].normal_stress == approx(-0.2e6)
    assert states[3].shear_stress == 0.0
    assert states[4].shear_stress == approx(KS * 1e-6)


def test_sliding_under_a_changing_normal_stress_balances_step_by_step():
    """Coarse steps: the normal stress falls from 1 MPa to nothing and rises again while the joint
    slides."""
    state, work, opening = ContactState(broken=True), 0.0, -1e6 / KN
    state, _ = advance(opening, 1e-4, state, LAW)  # to the limit
    state = state._replace(friction_work=0.0)
    stored = elastic_energy(state.normal_stress, state.shear_stress, KN, KS)
    for k in range(1, 21):
        old, sigma = state, -1e6 * abs(math.cos(math.pi * k / 20))
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


SOFT = LAW._replace(mode_i_energy=5.0, mode_ii_energy=50.0)
CRUSHES = {"compressive_strength": 3e6}
LAWS = {
    "brittle": LAW,
    "softening": SOFT,
    "crushing": LAW._replace(**CRUSHES),
    "softening and crushing": SOFT._replace(**CRUSHES),
    "all soften": SOFT._replace(**CRUSHES, crushing_energy=600.0),
}
corners = st.lists(
    st.tuples(st.floats(-1.5e-4, 4e-5), st.floats(-2e-4, 2e-4)), min_size=1, max_size=6
)
"""Of paths: opening and shear displacement [m]; 5e-5 crushes."""


@pytest.mark.parametrize("name", LAWS)
def test_work_done_is_stored_or_dissipated(name):
    """Along any path of small steps: the trapezium of the work is exact while stresses are linear,
    so that each event within a step leaves a rest of the order of stress times step.  Nothing that
    is lost comes back."""
    law, n = LAWS[name], 400

    @settings(max_examples=30, deadline=None)
    @given(corners)
    def check(targets):
        at = np.array([(0.0, 0.0), *targets])
        path = np.concatenate([np.linspace(a, b, n + 1)[1:] for a, b in zip(at, at[1:])])
        states, _, work = test_softening.follow(path.tolist(), law)
        last, largest = states[-1], np.abs(np.diff(path, axis=0, prepend=[(0.0, 0.0)])).max()
        kept = test_softening.stored(last, path[-1][0] + last.closure, law)
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
        shear, state = 0.0, ContactState()
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
    opening, shear = opening * FT / KN, shear * C / KS
    state = ContactState(shear_stress=held * C if broken else 0.0, broken=broken, slip=1e-5)
    sigma, trial = KN * opening, state.shear_stress + KS * shear
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
    opening, shear = opening * FT / KN, shear * C / KS
    in_stresses = stays_elastic(KN * opening, KS * shear, FT, C, MU)
    on_the_edge = math.isclose(KN * opening, FT) or math.isclose(
        abs(KS * shear), C - KN * opening * MU
    )
    assert on_the_edge or stays_elastic(opening, shear, *elastic_range(LAW)) == in_stresses
