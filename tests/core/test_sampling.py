"""Runs with records in coarse steps: both samplings of one motion give one result."""

import numpy as np
import pytest
from conftest import one_line_error, parsed
from pytest import approx

from damage import Brick, Wall, run
from damage.draw.words import run_title
from damage.measure.summary import summarise
from damage.measure.tables import summary_row

STIFF = Wall(
    "stiff",
    0.84,
    1.5,
    precompression=0.1e6,
    brick=Brick(length=0.21, height=0.06, thickness=0.1),
)
"""Its first period is 0.0508 s: 2.5 steps of 0.02 s."""
PERIOD_S = 0.0508


def file_pga_g(step_s):
    """Largest sample of such a file [g]."""
    return np.abs(motion_g(np.arange(round(0.8 / step_s) + 1) * step_s)).max()


def motion_g(time_s):
    """Sines up to 21.75 Hz that swell and ebb [g]."""
    parts = (4.0, 0.01), (12.0, 0.015), (19.7, 0.025), (21.75, 0.01)
    swell = np.sin(np.pi * time_s / 0.8) ** 2
    return swell * sum(g * np.sin(2 * np.pi * hz * time_s) for hz, g in parts)


def sampled(folder, step_s, name="", scale=1.0):
    """A record's file of 0.8 s of `motion_g`, of which steps of 0.02 s hold everything."""
    time_s = np.arange(round(0.8 / step_s) + 1) * step_s
    acc_g = scale * motion_g(time_s)
    path = folder / f"{name or f'every_{1e3 * step_s:g}_ms'}.csv"
    path.write_text("time_s,acc_g\n" + "".join(f"{t:.4f},{a:.9f}\n" for t, a in zip(time_s, acc_g)))
    return path


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """{step [s]: History} of the stiff wall under both files."""
    folder = tmp_path_factory.mktemp("sampling")
    return {step_s: run(STIFF, sampled(folder, step_s), rest=0.1) for step_s in (0.02, 0.002)}


def test_a_record_in_coarse_steps_drives_a_stiff_wall_as_one_in_fine_steps(runs):
    """By lines between its samples it had 27 % less drift and base shear, and Sa(T1) was a third
    too small."""
    coarse, fine = (summarise(runs[step_s]) for step_s in (0.02, 0.002))
    for name in (
        "max_drift_ratio",
        "peak_base_shear_n",
        "sa_eigen_period_g",
        "pgv_m_s",
        "avg_sa_g",
        "arias_m_s",
        "d5_75_s",
    ):
        assert coarse[name] == approx(fine[name], rel=0.01), name
    rows = [summary_row(runs[step_s]) for step_s in (0.02, 0.002)]
    for name in ("pga_g", "sa_0.2_s_g", "peak_base_shear_n"):
        assert rows[0][name] == approx(rows[1][name], rel=0.01), name
    # of the file, and not of what was interpolated for this wall
    assert rows[0]["record_pga_g"] == approx(file_pga_g(0.02), rel=1e-6)
    assert rows[0]["record_pga_g"] < 0.99 * rows[0]["pga_g"]
    assert runs[0.02].eigen_period_s == approx(PERIOD_S, abs=1e-4)
    assert coarse["peak_base_shear_n"] > 1000


def test_the_run_says_that_it_interpolates_and_what_lines_would_take_off(runs):
    lost = 1 - np.sinc(0.02 / runs[0.02].eigen_period_s) ** 2
    assert (
        summarise(runs[0.02])["lost_by_lines"]
        == summary_row(runs[0.02])["lost_by_lines"]
        == approx(lost)
    )
    assert runs[0.02].parameters["loading"]["interpolated_for_s"] == runs[0.02].eigen_period_s
    assert summarise(runs[0.002])["lost_by_lines"] is None and "lost_by_lines" in summary_row(
        runs[0.002]
    )
    assert "interpolated_for_s" not in runs[0.002].parameters["loading"]
    assert ["interpolated" in run_title(runs[step_s]) for step_s in (0.02, 0.002)] == [True, False]


def test_all_events_of_a_sequence_are_interpolated_and_stay_the_same_motion(tmp_path):
    for name, scale in (("one", 1.0), ("two", 0.5)):
        sampled(tmp_path, 0.02, name, scale)
    (tmp_path / "sequence.csv").write_text("record,scale\none.csv,1\ntwo.csv,3\none.csv,0.5\n")
    asked = parsed(f"--sequence {tmp_path}/sequence.csv")
    driven = asked.for_period(PERIOD_S)
    first, second, third = (event.loading for event in driven.events)
    assert first is third and driven.loading is second and driven.peak_g > asked.peak_g
    assert {one.interpolated_for_s for one in (first, second)} == {PERIOD_S}
    assert [event.factor for event in driven.events] == [1, 3, 0.5]
    assert [event.loading.duration_s for event in driven.events] == [
        event.loading.duration_s for event in asked.events
    ]
    assert len(driven.as_dict()["motions"]) == 2


def test_a_record_whose_steps_exceed_half_the_period_is_refused_unless_it_is_accepted(tmp_path):
    words = f"--record {sampled(tmp_path, 0.04)}"
    said = one_line_error(parsed(words).for_period, PERIOD_S)
    assert (
        "every_40_ms: a time step of 0.04 s; expected at most half of the wall's first period of"
        " 0.0508 s" in said
    )
    driven = parsed(f"{words} --accept-implausible").for_period(PERIOD_S)
    assert driven.loading.interpolated_for_s == PERIOD_S
