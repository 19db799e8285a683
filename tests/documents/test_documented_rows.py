"""Tables of documents come out of today's model: of each study that ships, one run of one row of
docs/tables."""

import pandas as pd
import pytest
from conftest import REPOSITORY

from damage.applications.studies.definition import load_study
from damage.history.reader import read_history
from damage.measure.tables import summary_row
from damage.reference.session import run_references
from damage.run.options import words_of
from paper import document_figures, thirty_years

SINE = "symmetric_harmonic-0.2-0.025"
STRONG = "_window-0.8-2.5_rest-0.1_strength-cov-0.3"
ROWS = {"harmonic": "asymmetric_harmonic-0.2-0.025_rest-2"}
LONGER = {
    "nolintel": "symmetric_harmonic-0.06-0.1_lintel-none_rest-2",
    "ends": f"{SINE}_cycles-2_rest-2_contacts-corners",
    "published": f"symmetric_light_slow_record-MID1_N_synthetic_acc_m_s2_scale-0.75{STRONG}",
    "lintel": "symmetric_harmonic-0.2-0.05_cycles-2_lintel-2_rest-2",
    "sequence": f"{SINE}_sequence-1-1-1-1-1-1_rest-1",
    "ida": "symmetric_record-MID1_N_synthetic_acc_m_s2_scale-0.75_rest-1",
    "fragility": f"symmetric_record-MID1_N_synthetic_acc_m_s2_scale-0.75{STRONG}",
    "stations": (
        "symmetric_record-BZN1_HGE_acc_m_s2_scale-1.12_window-17-25_rest-0.1_strength-cov-0.3"
    ),
    "settlement": "symmetric-sagging-5000-harmonic",
    "sensitivity": f"{SINE}_cycles-2_rest-2",
}
NOT_OF_TODAY = {
    "validation": (
        "single runs of before inputs were rounded: as their cracks grow they part from those of"
        " today"
    ),
    "deformable": "of before inputs were rounded, too, and ten minutes a run",
    "crosscheck": "of YADE alone, in which a run takes hours",
}
MEASURES = [
    "max_DI",
    "max_DI_open",
    "max_DI_slip",
    "residual_DI",
    "max_shear_limit_DI",
    "max_drift_ratio",
    "peak_base_shear_n",
    "max_crack_width_mm",
    "max_psi",
    "input_energy_j",
]
BEFORE = {"published", "fragility", "stations", "settlement", "sensitivity"}
"""Made before inputs were rounded (CHANGELOG, 0.2.0): members of the same ensembles, in two
digits."""
# relative; tables have nine
DIGITS = 1e-8
TWO_DIGITS = 0.05


@pytest.mark.parametrize(
    "study", [*ROWS, *(pytest.param(name, marks=pytest.mark.long) for name in LONGER)]
)
def test_the_first_member_lies_in_the_range_that_its_row_gives_of_all(study, tmp_path, monkeypatch):
    """A row of a single run gives the values themselves."""
    monkeypatch.chdir(REPOSITORY)
    point = (ROWS | LONGER)[study]
    out = tmp_path / "run.h5"
    table = pd.read_csv(REPOSITORY / f"docs/tables/{study}_points.csv")
    row = table[(table["point"] == point) & (table["solver"] == "reference")].squeeze()
    runs = load_study(REPOSITORY / f"studies/{study}.toml", "reference").runs
    run = next(one for one in runs if one.point == point)
    command = [run.wall, *words_of(run.options_of(1)), "--no-pictures", "--out", str(out)]
    assert [status for _, status in run_references(iter([(point, command)]))] == [0]
    found = summary_row(read_history(out))
    for name in MEASURES:
        margin = (
            TWO_DIGITS * abs(found[name]) + 1e-3 * ("DI" in name)
            if study in BEFORE
            else DIGITS * abs(found[name])
        )
        assert row[f"{name}_min"] - margin <= found[name] <= row[f"{name}_max"] + margin, name


def test_every_table_of_points_has_such_a_row():
    tables = {
        path.name.removesuffix("_points.csv")
        for path in (REPOSITORY / "docs/tables").glob("*_points.csv")
    }
    assert tables == {*ROWS, *LONGER, *NOT_OF_TODAY}


def test_the_table_of_thirty_years_is_that_of_its_lives():
    kept = REPOSITORY / "docs/tables/benchmarks/lives_walls.csv"
    shown = pd.read_csv(kept, dtype=str, keep_default_na=False)
    pd.testing.assert_frame_equal(thirty_years.walls_table(thirty_years.LIVES), shown)


@pytest.mark.parametrize("draw", document_figures.FIGURES, ids=lambda draw: draw.__name__)
def test_every_figure_of_a_document_can_be_drawn(draw):
    assert all(ax.has_data() for ax in draw().axes)
