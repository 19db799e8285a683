"""The program behind docs/validation/shaken-walls.md, and the kept predictions of tested walls."""

import hashlib
import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from damage.linear.modes import natural_modes
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from paper import shaken_wall

TABLES = Path(__file__).resolve().parents[2] / "docs" / "tables"


def test_the_run_has_its_spectral_displacement(tmp_path):
    """Of a made-up motion, a sine of 8 Hz."""
    velocity = 100 * np.sin(2 * math.pi * 8 * 0.005 * np.arange(240)) * np.hanning(240)
    rows = "\n".join(" ".join(f"{value:.3f}" for value in row) for row in velocity.reshape(-1, 20))
    (tmp_path / shaken_wall.MOTION).write_text(f"# mm/s\n{rows}\n")
    (tmp_path / "US1_IM_vs_EDP.csv").write_text("run,rec,pga,sd_T1\n1,HU12,0.05,0.3\n21,HU12,1,6\n")
    found = shaken_wall.displacement_mm(shaken_wall.motion(tmp_path))
    assert found == pytest.approx(6, rel=5e-3)


def test_the_joints_are_as_stiff_as_the_measured_period_asks_for():
    layout = lay_out(shaken_wall.fitted(), ModelOptions(contacts="gauss", cells=8))
    assert natural_modes(layout).period_s[0] == pytest.approx(shaken_wall.PERIOD_S, rel=1e-3)
    assert layout.bodies.mass[:-1].sum() == pytest.approx(1885 * 2.58 * 1.292 * 0.21)


def test_predictions_are_those_that_were_committed():
    names = "us2_later", "shear_walls", "us2"
    for path in (TABLES / f"{name}_prediction.csv" for name in names):
        digest, name = path.with_suffix(".sha256").read_text().split()
        assert name == path.name and digest == hashlib.sha256(path.read_bytes()).hexdigest()
    table = pd.read_csv(path)
    assert list(table["run"]) == list(range(1, 26)) and table[
        table["run"].isin([3, 6, 8, 11])
    ].iloc[:, 1:].isna().all(axis=None)
