"""The offset of two bricks now, and what they slid while closed: both solvers along a path that is
known by hand."""

import math
from functools import partial

import numpy as np
import pytest
from numpy.testing import assert_allclose
from pytest import approx
from small_history import make_history, small_layout

from damage import Joint, ModelOptions, Wall
from damage.applications.cracks.capacity import drift_at_first_crack
from damage.applications.cracks.patterns import cracked
from damage.law.joint_law import ContactState, LawParameters, advance, material_of
from damage.measure.cracks import psi_value
from damage.measure.summary import summarise
from damage.measure.tables import index_table, summary_row
from damage.reference.solver import ReferenceSolver
from damage.wall.kinds import BED
from damage.wall.layout import lay_out

PAIR = Wall("pair", length=0.1125, height=0.15, precompression=0.0)
SOFT = Joint(mode_i_fracture_energy=5.0, mode_ii_fracture_energy=50.0)
CONTACTS = lay_out(PAIR).contacts
BETWEEN = np.flatnonzero((CONTACTS.kind == BED) & (CONTACTS.first >= 0))
KN = CONTACTS.normal_stiffness[BETWEEN[0]]
KS = CONTACTS.shear_stiffness[BETWEEN[0]]
MU = math.tan(math.radians(32))
# [m]: pressed together by 0.3 MPa; sheared elastically up to friction
PRESSED = -0.3e6 / KN
HELD = MU * 0.3e6 / KS

PATH = [  # opening, shear displacement; slip accumulated, offset [m]
    ((3e-4, 0.0), (0.0, 0.0)),  # the bond breaks
    ((3e-4, 5e-4), (0.0, 5e-4)),  # moved sideways while open
    ((PRESSED, 5e-4), (0.0, 5e-4)),  # closed, without shear
    ((PRESSED, 5e-4 + HELD / 2), (0.0, 5e-4)),  # friction holds: what is elastic is taken off
    ((PRESSED, 6e-4), (1e-4 - HELD, 6e-4 - HELD)),  # slid
    ((PRESSED, 6e-4 - HELD), (1e-4 - HELD, 6e-4 - HELD)),  # let go: what is elastic comes back
    ((3e-4, 6e-4 - HELD), (1e-4 - HELD, 6e-4 - HELD)),  # open: the whole offset
    ((3e-4, 0.0), (1e-4 - HELD, 0.0)),  # moved back
    ((PRESSED, 0.0), (1e-4 - HELD, 0.0)),  # closed where it was: nothing to be seen
    ((PRESSED, -2e-4), (1e-4 - 2e-4, -2e-4 + HELD)),  # slid the other way
]


class Pair:
    """Two bricks of the reference solver, the upper one at a prescribed position."""

    def __init__(self, joint=None, model=None):
        self.layout = lay_out(
            PAIR if joint is None else Wall("pair", 0.1125, 0.15, precompression=0.0, joint=joint),
            model or ModelOptions(),
        )
        self.solver = ReferenceSolver(self.layout, 1e-5)
        self.here = np.zeros(2)

    def go(self, there, steps=200):
        for opening, shear in np.linspace(self.here, there, steps + 1)[1:]:
            self.solver.displacement = [(0, 0, 0), (shear, opening, 0)]
        self.here = np.array(there)
        return self.solver


def test_the_offset_is_what_one_sees_now_and_slip_what_added_up():
    pair = Pair()
    for there, (slip, offset) in PATH:
        now = pair.go(there)
        assert_allclose(now.slip[BETWEEN], slip, atol=1e-12)
        assert_allclose(now.offset[BETWEEN], offset, atol=1e-12)
        assert np.all(now.offset[now.state == 0] == 0.0)


def test_a_bond_that_breaks_in_shear_keeps_what_friction_does_not_hold():
    pair = Pair()
    peak = (0.24e6 + MU * 0.3e6) / KS
    whole = pair.go((PRESSED, 0.99 * peak))
    assert np.all(whole.offset == 0.0)
    now = pair.go((PRESSED, 1.01 * peak))
    assert_allclose(now.offset[BETWEEN], 1.01 * peak - HELD)
    assert_allclose(now.slip[BETWEEN], 1.01 * peak - HELD)
    # opens: friction holds nothing
    assert_allclose(pair.go((1e-5, 1.01 * peak)).offset[BETWEEN], 1.01 * peak)


SOFT_PATH = [
    (PRESSED, 4e-5),
    (1e-5, 4e-5),
    (2e-5, 8e-5),
    (PRESSED, 8e-5),
    (PRESSED, -1e-4),
    (3e-4, -2e-4),
    (PRESSED, -2e-4),
    (PRESSED, 1e-4),
]


def by_law(path, strengths, energies):
    """u_s - tau / k_s of the law where its bond has softened or is gone, at each corner."""
    law = LawParameters(KN, KS, *strengths, material_of(SOFT), *energies)
    state = ContactState()
    here = np.zeros(2)
    found = []
    for there in path:
        for opening, shear in np.linspace(here, there, 201)[1:]:
            state, _ = advance(opening, shear - here[1], state, law)
            here = np.array([opening, shear])
        found.append(here[1] - state.shear_stress / KS if state.broken or state.kappa > 0 else 0.0)
    return np.array(found)


def test_a_bond_that_softens():
    """The bond holds a part of its cohesion and opens and closes."""
    pair = Pair(SOFT)
    ours = [pair.go(there).offset[BETWEEN[0]] for there in SOFT_PATH]
    expected = by_law(SOFT_PATH, (SOFT.tensile_strength, SOFT.cohesion), (5.0, 50.0))
    assert_allclose(ours, expected, atol=1e-11)
    assert 0 < ours[0] < 4e-5 and abs(ours[-2]) > 1e-4


def test_a_rocking_brick_has_no_offset_and_one_that_turned_far_keeps_within_its_motion():
    """About a toe both faces stay in line along the joint's mean axes; whatever bricks do, a point
    counts once."""
    pair = Pair()
    pair.go((3e-4, 0.0))
    toe = np.array([-0.05625, -0.0375])  # from the upper brick's centre
    for turn in (1e-3, 0.1, 1.0, 3.0):
        cos = math.cos(turn)
        sin = math.sin(turn)
        x = toe[0] - (cos * toe[0] - sin * toe[1])
        z = toe[1] - (sin * toe[0] + cos * toe[1])
        pair.solver.displacement = [(0, 0, 0), (x, z, turn)]
        assert_allclose(pair.solver.offset[BETWEEN], 0.0, atol=1e-12)


# --- measures -------------------------------------------------------------------------------------


@pytest.fixture
def rattled(tmp_path):
    """A joint that slid to and fro by 0.3 mm and is back, one that is 0.15 mm off and slid by
    nothing."""
    ramp = np.minimum(np.arange(21), 10) / 10
    return partial(
        make_history,
        tmp_path / "rattled.h5",
        slip={3: 3e-4 * ramp, 5: 0.0},
        offset={5: 1.5e-4 * ramp},
        broken=(5,),
        drift=1e-4 * np.arange(21),
        overwrite=True,
    )


def test_each_measure_says_which_slip_it_shows(rattled):
    history = rattled()
    length = small_layout().contacts.length
    share = {joint: length[joint] / history.joints["length_m"].sum() for joint in (3, 5)}
    row = summary_row(history)
    assert row["max_DI_slip"] == approx(share[5]) and row["max_accumulated_DI_slip"] == approx(
        share[3]
    )
    assert (row["slip"], row["max_slip_mm"], row["max_offset_mm"]) == (
        "displacement",
        approx(0.3),
        approx(0.15),
    )
    assert (
        row["max_psi"] == approx(float(psi_value(1, 1.5e-4)), rel=1e-6)
        and row["psi_from_mm"] == 0.02
    )
    assert summarise(history, slip="accumulated")["max"]["DI_slip"] == approx(share[3])
    assert list(np.flatnonzero(cracked(history, "visible"))) == [5]
    table = index_table(history)
    assert table["accumulated_DI_slip"].iloc[-1] == approx(share[3])
    assert table["DI_slip"].iloc[-1] == approx(share[5]) and set(table["slip"]) == {"displacement"}
    assert drift_at_first_crack(history) == approx(7e-4)  # 0.105 mm
