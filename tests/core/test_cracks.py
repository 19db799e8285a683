"""Cracks and Psi of histories whose answer is a closed form."""

import numpy as np
import pytest
from conftest import refused_with
from pytest import approx
from small_history import make_history, small_layout

from damage.index import THRESHOLD
from damage.measure.cracks import (
    JOINING_GAP,
    PSI_FROM,
    crack_table,
    cracks_at,
    mean_width,
    psi,
    psi_history,
    psi_summary,
    psi_value,
)
from damage.units import MILLIMETRE
from damage.wall.kinds import HEAD


def along_x(start, length, z=0.0):
    return [[start, z], [start + length, z]]


def test_psi_of_one_visible_crack_is_one_and_grows_as_korswagen_says():
    assert psi_value(1, 0.1e-3) == approx(2 * 0.1**0.3)
    assert psi_value(1, 1e-3) == approx(2)
    assert psi_value(1, 5e-3) == approx(3.24, abs=0.01)
    assert psi_value(3, 1e-3) == approx(2 * 3**0.15)
    assert psi_value(0, 0.0) == 0


def test_width_is_weighted_by_width_and_length():
    """c_w of 1 mm over 0.1 m and 3 mm over 0.2 m, opening and slip combined by Pythagoras."""
    ends = np.array([along_x(0, 0.1), along_x(0.1, 0.2), along_x(0.5, 0.1)])
    table = crack_table(ends, [1e-3, 1.8e-3, 0.0], [0.0, -2.4e-3, 0.05e-3])
    c_w = (1 * 0.1 + 9 * 0.2) / (1 * 0.1 + 3 * 0.2)
    assert psi(table) == approx(2 * c_w**0.3)
    assert (len(table), table["crack"].nunique()) == (2, 1)
    assert mean_width(table["width_m"], table["length_m"]) == approx(c_w * MILLIMETRE)


@pytest.mark.parametrize("gap, cracks", [(0.0, 1), (0.9 * JOINING_GAP, 1), (1.1 * JOINING_GAP, 2)])
@pytest.mark.parametrize("direction", ["along", "across", "corner"])
def test_cracks_closer_than_ten_millimetres_are_one(gap, cracks, direction):
    shift = {
        "along": (0.1 + gap, 0.0),
        "across": (0.05, gap),
        "corner": (0.1 + 0.6 * gap, 0.8 * gap),
    }[direction]  # 3-4-5 triangle
    first = np.array(along_x(0.0, 0.1))
    table = crack_table(np.stack([first, first + shift]), [1e-3, 1e-3], [0.0, 0.0])
    assert table["crack"].nunique() == cracks
    assert psi(table) == approx(2 * cracks**0.15)


def test_a_stepped_crack_is_one_and_an_intact_joint_parts_it(tmp_path):
    """Bed and head joints around one brick's corner; then the same without its head joint."""
    layout = small_layout()
    contacts = layout.contacts
    head = int(np.flatnonzero(contacts.kind[: layout.n_joints] == HEAD)[4])
    x = contacts.x[head]
    z = contacts.z[head]
    half = layout.wall.brick.height / 2
    beside = [
        int(j)
        for j in np.flatnonzero(
            ((np.abs(contacts.x - x + 0.028125) < 1e-6) & (np.abs(contacts.z - z + half) < 1e-6))
            | ((np.abs(contacts.x - x - 0.028125) < 1e-6) & (np.abs(contacts.z - z - half) < 1e-6))
        )
    ]
    assert len(beside) == 2
    step = make_history(tmp_path / "step.h5", layout, opening=dict.fromkeys([head, *beside], 1e-3))
    interrupted = make_history(
        tmp_path / "interrupted.h5", layout, opening=dict.fromkeys(beside, 1e-3)
    )
    assert cracks_at(step, -1).groupby("crack")["length_m"].sum().tolist() == approx(
        [0.075 + 2 * 0.05625]
    )
    assert sorted(cracks_at(step, 3)["joint"]) == sorted([head, *beside])
    assert cracks_at(interrupted, -1)["crack"].tolist() == [1, 2]
    assert psi(cracks_at(interrupted, -1)) == approx(2 * 2**0.15)


def test_psi_over_time_is_that_of_each_sample(tmp_path):
    """Random widths about the threshold, which flicker; the run's figures are those of the
    tables."""
    random = np.random.default_rng(5)
    layout = small_layout()
    joints = range(0, layout.n_joints, 2)
    history = make_history(
        tmp_path / "random.h5",
        layout,
        opening={j: np.abs(random.normal(0, 1e-4, 21)) for j in joints},
        slip={j: random.normal(0, 1e-4, 21) for j in joints},
    )
    over_time = psi_history(history, THRESHOLD)
    tables = [cracks_at(history, k) for k in range(21)]
    assert over_time["psi"].to_numpy() == approx([psi(table) for table in tables])
    assert over_time["cracks"].tolist() == [table["crack"].nunique() for table in tables]
    assert over_time["crack_length_m"].to_numpy() == approx([t["length_m"].sum() for t in tables])
    summary = psi_summary(history, THRESHOLD)
    assert (
        summary["max_psi"]
        == over_time["psi"].max()
        > over_time["psi"].iloc[-1]
        == summary["residual_psi"]
    )
    assert summary["max_crack_width_mm"] == approx(max(t["width_m"].max() for t in tables) * 1e3)


def test_the_threshold_itself_is_cracked_and_a_closed_crack_is_none(tmp_path):
    """0.1 mm, and the 0.02 mm of Psi, in single precision; a crack that closes leaves no
    residual."""
    for least in (PSI_FROM, THRESHOLD):
        opening = np.where(np.arange(21) < 10, least, 0.0)
        history = make_history(tmp_path / "visible.h5", opening={7: opening}, overwrite=True)
        summary = psi_summary(history, least)
        assert summary["max_psi"] == approx(2 * (least * 1e3) ** 0.3)
        assert (summary["residual_psi"], summary["residual_crack_width_mm"]) == (0, 0)
    assert len(cracks_at(history, -1)) == 0 == psi(cracks_at(history, -1))


def test_an_uncracked_or_unfinished_run(tmp_path):
    history = make_history(tmp_path / "intact.h5", status="unfinished")
    assert psi_summary(history) == {
        "max_psi": 0,
        "max_crack_width_mm": 0,
        "residual_psi": None,
        "residual_crack_width_mm": None,
    }
    refused_with("sample 21: expected .* a whole number from 0 to 20", cracks_at, history, 21)
    refused_with("threshold = -1: expected a positive number", psi_history, history, -1)
