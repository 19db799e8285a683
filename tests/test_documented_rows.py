"""Tables of documents come out of today's model: of each study that ships, one run of one row of docs/tables."""

import pandas as pd
import pytest
from conftest import REPOSITORY

from damage.history.reader import read_history
from damage.measure.tables import summary_row
from damage.reference.session import run_references
from damage.studies.definition import load_study

LONG = pytest.mark.long
ROWS = [
    ("settlement", "symmetric-hogging-500-harmonic"),
    ("sequence", "symmetric_harmonic-0.2-0.025_sequence-1-1-1-1-1-1_rest-1"),
    ("harmonic", "asymmetric_harmonic-0.2-0.025_rest-2"),
    ("lintel", "symmetric_harmonic-0.2-0.05_cycles-2_lintel-2_rest-2"),
    ("nolintel", "symmetric_harmonic-0.06-0.1_lintel-none_rest-2"),
    ("validation", "comp2_1_pushover-0.3_boundary-fixed"),
    ("validation", "squat_pushover-0.12_speed-0.002"),
    ("sensitivity", "symmetric_harmonic-0.2-0.05_cycles-2_rest-2"),
    ("published", "symmetric_light_slow_record-MID1_N_synthetic_acc_m_s2_scale-0.75_window-0.8-2.5_rest-0.1"
                  "_strength-cov-0.3"),
    ("fragility", "symmetric_record-MID1_N_synthetic_acc_m_s2_scale-0.75_window-0.8-2.5_rest-0.1_strength-cov-0.3"),
    ("ends", "symmetric_harmonic-0.2-0.025_cycles-2_rest-2_contacts-corners"),
    ("ida", "symmetric_record-MID1_N_synthetic_acc_m_s2_scale-0.75_rest-1"),
    ("stations", "symmetric_record-BZN1_HGE_acc_m_s2_scale-1.12_window-17-25_rest-0.1_strength-cov-0.3"),
    ("deformable", "symmetric_harmonic-0.2-0.025_cycles-2_rest-2_bricks-deformable_contacts-corners_brick-damping-0"),
]
MEASURES = ["max_DI", "max_DI_open", "max_DI_slip", "residual_DI", "max_shear_limit_DI", "max_drift_ratio",
            "peak_base_shear_n", "max_crack_width_mm", "max_psi", "input_energy_j"]


@pytest.mark.parametrize("study, point", ROWS)
def test_a_row(study, point, tmp_path, monkeypatch):
    """The first member lies in the range that the row gives of its members; a single run is that run."""
    monkeypatch.chdir(REPOSITORY)
    table = pd.read_csv(REPOSITORY / f"docs/tables/{study}_points.csv")
    (_, row), = table[(table["point"] == point) & (table["solver"] == "reference")].iterrows()
    run, = (one for one in load_study(REPOSITORY / f"studies/{study}.toml", "reference").runs if one.point == point)
    out = tmp_path / "run.h5"
    assert [status for _, status in run_references(iter([(point, [*run.command(1), "--no-pictures", "--out", str(out)])]))] == [0]
    found = summary_row(read_history(out))
    print({name: (found[name], row[name], row[f"{name}_min"], row[f"{name}_max"]) for name in MEASURES})
    for name in MEASURES:
        assert row[f"{name}_min"] * (1 - 1e-6) <= found[name] <= row[f"{name}_max"] * (1 + 1e-6), name
