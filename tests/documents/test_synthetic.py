"""The synthetic Huizinge record against its targets, and the files that scripts/make_records.py
makes."""

import sys

import numpy as np
import pandas as pd
import pytest
from conftest import REPOSITORY, run_command
from numpy.testing import assert_allclose

from damage.files import DATA
from damage.motion.formats import read_record, shipped_record_path, shipped_records, write_csv
from damage.motion.intensity import pga_g, response_spectrum, summary
from damage.motion.record import band_passed, scaled, windowed
from damage.units import GRAVITY
from scripts.synthetic import HUIZINGE, SEED

SCRIPT = REPOSITORY / "scripts" / "make_records.py"


@pytest.fixture(scope="module")
def record():
    return read_record(shipped_record_path("MID1_N_synthetic"))


def make(what, folder):
    done = run_command(sys.executable, SCRIPT, what, "--out", folder, status=0)
    return [folder / line.split("/")[-1] for line in done.stdout.splitlines()]


class TestShippedFile:
    def test_peaks_and_spectrum_are_the_published_ones(self, record):
        measures = summary(record)
        assert_allclose(measures["pga_g"] * GRAVITY, HUIZINGE.pga_m_s2, rtol=0.03)
        assert_allclose(measures["pgv_cm_s"], 100 * HUIZINGE.pgv_m_s, rtol=0.10)
        assert_allclose(response_spectrum(record, HUIZINGE.periods_s), HUIZINGE.sa_g, rtol=0.05)

    def test_velocity_and_displacement_end_at_zero(self, record):
        """Exact but for the file's seven digits: at most 5e-8 m/s2 a sample, for 6 s."""
        velocity = np.cumsum(record.acceleration_m_s2) * record.time_step_s
        displacement = np.cumsum(velocity) * record.time_step_s
        assert abs(velocity[-1]) < 5e-8 * 6.0
        assert abs(displacement[-1]) < 5e-8 * 6.0**2
        # no drift on the way: PGV for the 0.3 s of the strong part, halved
        assert np.abs(displacement).max() < 5e-3


@pytest.mark.long
def test_the_script_makes_the_shipped_motion_again(record, tmp_path):
    """Within 0.1 % of PGA: linear algebra rounds differently on another machine; wavelets that are
    off by 1e-11 of themselves change the motion by less than the file's seven digits."""
    [path] = make("synthetic", tmp_path)
    assert f"seed {SEED}" in path.read_text()
    assert_allclose(
        read_record(path).acceleration_m_s2, record.acceleration_m_s2, atol=1e-3 * HUIZINGE.pga_m_s2
    )


class TestZeerijp:
    def test_the_script_makes_the_shipped_files_again(self, made):
        ours = sorted((DATA / "zeerijp_20180108").glob("*.csv"))
        assert [path.name for path in ours] == sorted(path.name for path in made.iterdir())
        for path in ours:
            assert (made / path.name).read_bytes() == path.read_bytes()

    @pytest.fixture(scope="class")
    def made(self, tmp_path_factory):
        pytest.importorskip("obspy")
        folder = tmp_path_factory.mktemp("zeerijp")
        assert len(make("zeerijp", folder)) == 33  # components of 16 stations, and their table
        return folder

    def test_rows_of_the_study_follow_the_rule_for_scaling(self, tmp_path):
        (path,) = make("stations", tmp_path)
        assert path.read_bytes() == (REPOSITORY / "studies" / "stations.csv").read_bytes()
        table = pd.read_csv(DATA / "zeerijp_20180108" / "components.csv", comment="#").set_index(
            "record"
        )
        rows = pd.read_csv(path)
        assert rows["scale"].between(0.1, 10).all() and rows["record"].nunique() == 31
        pgv = rows["scale"] * [
            table.loc[name.split("/")[-1].split("_acc")[0], "pgv_mm_s"] for name in rows["record"]
        ]
        assert [int(((pgv / level - 1).abs() < 0.01).sum()) for level in (10, 20, 40, 80)] == [
            31,
            27,
            12,
            8,
        ]

    def test_table_of_components(self):
        """Windows, measures and the rule of the README.  PGV is of whole records: the filter sees
        the cut of a shortened one, which moves its peak by up to 25 %; those are compared through
        the script, above."""
        table = pd.read_csv(DATA / "zeerijp_20180108" / "components.csv", comment="#").set_index(
            "record"
        )
        assert (
            len(table) == 32
            and table["station"].nunique() == 16
            and table["epicentral_km"].max() < 10
        )
        assert set(table.index) == {name for name in shipped_records() if "_HG" in name}
        for name, row in table.iterrows():
            whole = read_record(shipped_record_path(name))
            cut, periods_s = (
                windowed(whole, row["start_s"], row["end_s"]),
                np.geomspace(0.05, 1, 30),
            )
            assert row["pga_g"] == pytest.approx(pga_g(cut), abs=6e-6)
            assert_allclose(
                response_spectrum(cut, periods_s), response_spectrum(whole, periods_s), rtol=0.05
            )
            assert row["sa_0.2_s_g"] == pytest.approx(response_spectrum(whole, [0.2])[0], rel=0.03)
            if whole.duration_s > 40:
                passed = summary(band_passed(whole, 0.5, 40))
                assert row["pgv_mm_s"] == pytest.approx(10 * passed["pgv_cm_s"], rel=1e-4)
        reach = [int((10 * table["pgv_mm_s"] >= pgv).sum()) for pgv in (10, 25, 50)]
        assert reach == [32, 19, 11]


def test_a_record_written_is_read_back(tmp_path):
    whole = scaled(read_record(shipped_record_path("BZN1_HGN")), 2.0)
    path = write_csv(whole, tmp_path / "BZN1_HGN_acc_m_s2.csv", [f"start {whole.start_utc}"])
    back = read_record(path)
    assert (back.name, back.time_step_s, back.start_utc) == (
        whole.name,
        whole.time_step_s,
        whole.start_utc,
    )
    assert_allclose(back.acceleration_m_s2, whole.acceleration_m_s2, rtol=5e-7)
    assert [found.name for found in tmp_path.iterdir()] == [path.name]
