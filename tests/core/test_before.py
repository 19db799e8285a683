"""What a wall went through before a run: runs that continue another, joints that start without a
bond."""

import shutil
from dataclasses import replace

import h5py
import numpy as np
import pytest
from conftest import parsed, refused_with, written
from numpy.testing import assert_array_equal
from short_runs import SMALL, SOFT

from damage import Opening, Wall, run
from damage.applications.cracks.options import Surveyed
from damage.history.head import seal
from damage.measure.summary import summarise
from damage.run.initial_state import without_bond
from damage.wall.layout import lay_out

SHAKE = {"harmonic": (0.06, 0.6), "rest": 0.1}


def halves(folder, wall, **options):
    """Histories of one run of two events, and of a run of the second from the end of the first."""
    shake = SHAKE | options
    whole = run(wall, sequence=(1, 0.6), out=folder / "whole.h5", **shake)
    run(wall, out=folder / "first.h5", **shake)
    if shake.pop("settle", None):  # once
        shake |= {"distortion": None, "supports": "bricks"}
    second = run(
        wall,
        sequence=(0.6,),
        out=folder / "second.h5",
        **shake,
        **{"continue": folder / "first.h5"},
    )
    return whole, second


@pytest.mark.parametrize(
    "wall, options",
    [
        (SMALL, {}),
        (SMALL, {"settle": "hogging", "distortion": 1 / 500}),
        # else each half is accepted, or repeated, by itself
        (SOFT, {"mass_scaling": "none"}),
        (SOFT, {"mass_scaling": "selective", "harmonic": (0.06, 0.25), "cycles": 2}),
    ],
    ids=["brittle", "settled", "soft", "scaled"],
)
def test_a_run_that_continues_is_the_second_half_bit_for_bit(tmp_path, wall, options):
    whole, second = halves(tmp_path, wall, **({"rest": 0.05} | options))
    n = len(second.series)
    assert whole.parameters["repeats"] == second.parameters["repeats"] == 0
    assert n > 50 and whole.series["shock"].iloc[-n + 1] == 2
    for name in second.series.columns.drop(["time_s", "shock", "stage"]):
        # The first sample is the last one of the first half.
        assert_array_equal(
            second.series[name].to_numpy()[1:], whole.series[name].to_numpy()[1 - n :], name
        )
    for name in ("opening_m", "slip_m", "offset_m", "broken", "at_limit", "support_force"):
        assert_array_equal(getattr(second, name), getattr(whole, name)[-n:], name)
    assert_array_equal(second.displacement[-1], whole.displacement[-1])
    assert (
        second.opening_m.max() > 0
        and len(second.events)
        == (
            whole.events["time_s"]
            > -second.series["time_s"].iloc[-1] + whole.series["time_s"].iloc[-1] + 1e-9
        ).sum()
    )


def test_a_history_of_another_wall_is_one_line(run_of):
    """Other strengths of the joints: `test_checkpoint.py`."""
    words = {**SHAKE, "continue": run_of("shaken").path}
    other = Wall("other", 1.125, 0.6, [Opening(0.3375, 0.45, 0.225, 0.15)], lintel="courses")
    refused_with("the history of another wall, small: joints/", run, other, **words)
    slippery = replace(SMALL, joint=replace(SMALL.joint, friction_angle=0.3))
    refused_with("another wall, small: joint differs", run, slippery, **words)


def test_a_history_without_a_state_is_one_line(run_of, tmp_path):
    """As those of YADE."""
    first = shutil.copy(run_of("shaken").path, tmp_path / "first.h5")
    with h5py.File(first, "a") as file:
        none = file["state/solver"][:0]
        del file["state/solver"]
        file["state/solver"] = none
    seal(first)
    refused_with("it holds no state of its solver", run, SMALL, **SHAKE, **{"continue": first})


# --- surveyed cracks ------------------------------------------------------------------------------

CRACK = "crack,point,x_m,z_m,width_mm\n1,1,0,0.3,1\n1,2,0.3375,0.3,1\n"
"""A bed joint through the left pier, at mid-height of the opening."""


def with_cracks(layout, cracks):
    """The layout whose contact points along Surveyed cracks have no bond."""
    return without_bond(layout, cracks.joints(layout))


def test_joints_along_surveyed_cracks_have_no_bond(tmp_path):
    path = written(tmp_path / "cracks.csv", CRACK)
    layout = lay_out(SMALL)
    cracked = with_cracks(layout, Surveyed.read(path)).contacts
    failed = np.flatnonzero((cracked.tensile_strength == 0) & (cracked.cohesion == 0))
    expected = np.flatnonzero(
        (layout.contacts.z == layout.contacts.z[failed][0])
        & (layout.contacts.x < 0.3375)
        & ~layout.contacts.upright
    )
    assert_array_equal(failed, expected)
    assert layout.contacts.z[failed[0]] == pytest.approx(0.3)


DIAGONALS = "crack,point,x_m,z_m,width_mm\n" + "".join(
    f"{label},1,{x},{z},1\n{label},2,{x + 0.3},{z + 0.3},1\n"
    for label, x, z in (("A", 0.02, 0.02), ("B", 0.8, 0.25), ("C", 0.01, 0.28))
)
"""Three straight cracks across bricks and joints, 1.27 m together."""


def test_straight_lines_become_stepped_paths(tmp_path, capsys):
    """Piece by piece they would lie on 0.72 m of joints; the paths are longer than the lines."""
    along = tmp_path / "along.csv"
    across = tmp_path / "across.csv"
    along.write_text(CRACK)
    across.write_text(DIAGONALS)
    layout = lay_out(SMALL)
    with_cracks(layout, Surveyed.read(along))
    said = capsys.readouterr()
    assert (
        said.out
        == "cracks of along.csv: 0.34 m, 100 % of it on joints up to 0 mm away; 6 of 146 contact"
        " points (0.34 m) start without bond; widths are not used\n"
    )
    assert said.err == ""
    cracked = with_cracks(layout, Surveyed.read(across))
    freed = cracked.contacts.length[cracked.contacts.tensile_strength == 0].sum()
    assert freed > 1.27 and "1.27 m, 100 % of it on joints" in capsys.readouterr().out


def test_the_tolerance_of_a_survey(tmp_path):
    """A crack 20 mm above its bed joint is on it within half a brick's length, not within 10 mm."""
    path = written(tmp_path / "cracks.csv", CRACK.replace("0.3,1", "0.32,1"))
    settings = parsed(f"--cracked {path} --tolerance-mm 10")
    assert (
        settings.joints_without_bond.tolerance_m == 0.01
        and settings.as_dict()["cracked"]["tolerance_m"] == 0.01
    )
    refused_with(
        r"0.00 of 0.34 m of its cracks run along joints of wall small \(0 %\)",
        with_cracks,
        lay_out(SMALL),
        settings.joints_without_bond,
    )
    assert (
        with_cracks(lay_out(SMALL), Surveyed.read(path)).contacts.tensile_strength == 0
    ).sum() == 6


def test_bonds_that_a_survey_took_have_not_failed(tmp_path):
    """Neither under gravity nor later; others still count."""
    path = written(tmp_path / "cracks.csv", DIAGONALS)
    history = run(SMALL, cracked=path, **SHAKE)
    summary = summarise(history)
    freed = (
        (history.joints["tensile_strength_pa"] == 0) & (history.joints["cohesion_pa"] == 0)
    ).to_numpy()
    assert history.static["broken_joints"] > 0 and freed[history.broken[0]].all()
    assert not any("failed under gravity" in warning for warning in summary["warnings"])
    failed = history.broken[-1] & ~freed
    assert summary["tension_breaks"] + summary["shear_breaks"] == failed.sum() > 0
