"""Softening joints: the law, the options that a run requires, and walls with known results."""

import math
from dataclasses import replace

import numpy as np
import pytest
from conftest import REPOSITORY, parsed, wall_file
from pytest import approx
from scipy.integrate import quad
from scipy.optimize import brentq

from damage import Joint, ModelOptions, Wall, load_wall, read_history
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
    share_left,
    strength_left,
)
from damage.measure.summary import summarise
from damage.reference.session import BACKEND
from damage.run.session import run_session
from damage.run.settings import SOFTENING_BETA_S
from damage.wall.layout import lay_out
from damage.wall.parameters import softening_energies

KN, KS, FT, C, MU, G1, G2 = 6.557e10, 2.687e10, 0.18e6, 0.21e6, 0.42, 5.0, 50.0
LAW = LawParameters(KN, KS, FT, C, Material(MU), G1, G2)
SOFT = Joint(mode_i_fracture_energy=G1, mode_ii_fracture_energy=G2)


def follow(path, law=LAW, state=None):
    """Drive a contact along [(opening, shear displacement), ...]: (states, events, work by the
    trapezium)."""
    state, opening, shear, work, states, events = state or ContactState(), 0.0, 0.0, 0.0, [], []
    for at, along in path:
        old = state
        state, event = advance(at, along - shear, state, law)
        work += 0.5 * (old.normal_stress + state.normal_stress) * (at - opening)
        work += 0.5 * (old.shear_stress + state.shear_stress) * (along - shear)
        opening, shear = at, along
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


class TestLaw:
    def test_a_softening_joint_follows_its_envelope_and_unloads_to_the_origin(self):
        opening = 2e-5
        (here,), events, _ = follow([(opening, 0.0)])
        # (S1) with (S3): sigma = f_t exp(-AREA f_t w / G_I), w = u - sigma / k_n.
        gap = opening - here.normal_stress / KN
        assert here.normal_stress == approx(FT * math.exp(-AREA * FT * gap / G1), rel=1e-9)
        assert here.gap == approx(gap) and not here.broken and events == [INTACT]
        back, _ = advance(opening / 2, 0.0, here, LAW)
        assert back.normal_stress == approx(here.normal_stress / 2) and back.kappa == here.kappa
        again, _ = advance(opening, 0.0, back, LAW)
        assert again.normal_stress == approx(here.normal_stress) and again.kappa == approx(
            here.kappa, rel=1e-9
        )
        closed, _ = advance(-1e-6, 0.0, here, LAW)
        # the cracked joint is as stiff in compression as ever
        assert closed.normal_stress == -1e-6 * KN

    def test_shear_unloads_with_its_stiffness_and_friction_does_not_soften(self):
        pressure = 0.3e6
        (here,), _, _ = follow([(-pressure / KN, 2e-4)])
        left = strength_left(False, LAW, here.kappa)[1]
        assert here.shear_stress == approx(left + MU * pressure)
        back, _ = advance(-pressure / KN, -1e-6, here, LAW)
        assert back.shear_stress == approx(here.shear_stress - 1e-6 * KS) and back.slip == here.slip
        assert here.slip == approx(2e-4 - here.shear_stress / KS)

    def test_opening_takes_cohesion_and_sliding_takes_tensile_strength(self):
        (opened,), _, _ = follow([(2e-5, 0.0)])
        assert strength_left(False, LAW, opened.kappa)[1] < 0.6 * C
        (slid,), _, _ = follow([(-1e-7, 2e-4)])
        tension = max(
            advance(k * 1e-8, 0.0, slid._replace(shear_stress=0.0), LAW)[0].normal_stress
            for k in range(1000)
        )
        assert tension == approx(FT * math.exp(-slid.kappa), rel=1e-2) and tension < 0.6 * FT

    @pytest.mark.parametrize("energy", [100.0, 5.0, 0.5])
    def test_opened_and_slid_at_once_it_is_on_its_envelope(self, energy):
        """(S1) to (S3), from where growth of kappa by itself is negligible to 0.99 of it."""
        law, draw = LAW._replace(mode_i_energy=energy), np.random.default_rng(2).uniform
        for _ in range(300):
            opening, shear = draw(0.0, 2e-5), draw(0.0, 2e-5)
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
        states, events, _ = follow([(k * 1e-7, 0.0) for k in range(3000)])
        failure = events.index(TENSION)
        assert states[failure - 1].normal_stress == approx(GONE * FT, rel=1e-2)
        assert all(
            state[:2] == (0.0, 0.0) and state.broken and not state.at_limit
            for state in states[failure:]
        )
        states, events, _ = follow([(-1e-6, k * 1e-6) for k in range(3000)])
        failure = events.index(SHEAR)
        assert (
            not states[failure - 1].at_limit and states[failure].at_limit and states[failure].broken
        )
        assert states[-1].shear_stress == approx(MU * 1e-6 * KN)


PIER = (
    "Wall('pier', 1.35, 1.2, joint=Joint(mode_i_fracture_energy=5.0, mode_ii_fracture_energy=50.0))"
)


def run(tmp_path, *words, wall=None, name="run.h5"):
    wall = wall or Wall("pier", 1.35, 1.2, joint=SOFT)
    out = tmp_path / name
    status = run_session(
        BACKEND,
        wall_file(tmp_path / "pier.py", PIER),
        lambda: wall,
        [*map(str, words), "--out", str(out), "--no-pictures"],
        prog="test",
    )
    return status, out


class TestRun:
    def test_a_softening_wall_gets_a_little_damping(self):
        """And a smaller step: `test_run_constants.py`."""
        assert parsed().for_joint(SOFT).beta_s == SOFTENING_BETA_S
        assert parsed().for_joint(Joint()).beta_s == 0.0
        assert parsed("--beta 0").for_joint(SOFT).beta_s == 0.0


class TestParameters:
    def test_none_and_zero_are_brittle(self):
        assert (
            not Joint().softens
            and not Joint(mode_i_fracture_energy=0.0, mode_ii_fracture_energy=0).softens
        )
        assert Joint(**softening_energies(0.2e6)).softens


class TestScatter:
    def test_it_is_another_draw_than_that_of_the_walls_own_scatter(self):
        wall = Wall("w", 2.0, 1.5)
        both = lay_out(
            wall, ModelOptions(strength_cov=0.1, strength_seed=1), scatter=0.1, seed=1
        ).contacts
        own = lay_out(wall, ModelOptions(strength_cov=0.1, strength_seed=1)).contacts
        drawn = np.log(both.cohesion[~own.elastic] / own.cohesion[~own.elastic])
        assert abs(np.corrcoef(drawn, np.log(own.cohesion[~own.elastic]))[0, 1]) < 0.2


def pushed(tmp_path, name, energies, *words):
    """Summary of a shipped wall with these fracture energies, pushed over slowly."""
    wall = load_wall(REPOSITORY / "walls" / f"{name}.py")
    wall = replace(wall, joint=replace(wall.joint, **energies))
    status, out = run(tmp_path, *words, "--speed", 2e-3, wall=wall, name=f"{name}.h5")
    assert status == 0
    summary = summarise(read_history(out))
    assert summary["energy_error_fraction"] < 0.01
    return summary["peak_force_n"]


FIVE_FIFTY = {"mode_i_fracture_energy": 5.0, "mode_ii_fracture_energy": 50.0}


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "energies", "least", "most", "words"),
    [
        ("squat_tested", FIVE_FIFTY, 70e3, 85e3, ["--pushover", 0.07]),
        ("comp2_4", FIVE_FIFTY, 119e3, 145e3, ["--pushover", 0.06, "--boundary", "fixed"]),
        (
            "comp2_4",
            softening_energies(0.13125e6),
            0.85 * 131.6e3,
            1.15 * 131.6e3,
            ["--pushover", 0.1, "--boundary", "fixed"],
        ),
        (
            "squat_tested",
            softening_energies(0.18375e6),
            0.85 * 77.3e3,
            1.15 * 77.3e3,
            ["--pushover", 0.1],
        ),
        (
            "comp2_1",
            FIVE_FIFTY,
            0.97 * 59.0e3,
            1.03 * 59.0e3,
            ["--pushover", 0.2, "--boundary", "fixed"],
        ),
    ],
    ids=str,
)
def test_tested_walls_peak_where_the_document_says(tmp_path, name, energies, least, most, words):
    """Of walls that shear the tests' forces, of one that rocks the brittle wall's;
    docs/validation/laboratory.md."""
    assert least < pushed(tmp_path, name, energies, *words) < most
