"""Exposure of an address: places, catalogues, the ground-motion model, and what they give
together."""

import json
import math
from decimal import Decimal, getcontext
from types import MappingProxyType

import numpy as np
import pandas as pd
import pytest
from conftest import one_line_error, written
from scipy import stats

from damage.applications.groningen.exposure import places
from damage.applications.groningen.exposure.catalogue import read_catalogue
from damage.applications.groningen.exposure.columns import TABLES
from damage.applications.groningen.exposure.exposure import Exposure
from damage.applications.groningen.exposure.ground_motion import COMPONENTS, model_named
from damage.applications.groningen.exposure.models.bommer_2022 import Model
from damage.csv_table import from_words
from damage.draws import Draws

getcontext().prec = 30
ZEERIJP = {"magnitude": 3.4, "x_m": 245789.0, "y_m": 598263.0}
"""The earthquake of 2018-01-08 as the catalogue that ships has it, epicentre in RD [m]."""
GARSTHUIZEN = (53.36786, 6.71359)
LOPPERSUM = (53.3325, 6.7475)
DELFZIJL = (53.3300, 6.9180)


@pytest.fixture(scope="module")
def catalogue():
    return read_catalogue()


def by_hand(coefficients, magnitude, epicentral_km, vs30=200):
    """PGV [mm/s] of the published equation in decimals, with plain branches in place of limits."""
    c = [Decimal(str(one)) for one in coefficients]
    size = Decimal(str(magnitude))
    far = Decimal(str(epicentral_km))
    r = (far**2 + 9 + (2 * (c[5] + c[6] * size)).exp()).sqrt()
    ln = c[0] + c[1] * size + c[7] * (Decimal(vs30) / 200).ln()
    if r <= 7:
        ln += c[2] * r.ln()
    elif r <= 12:
        ln += c[2] * Decimal(7).ln() + c[3] * (r / 7).ln()
    else:
        ln += c[2] * Decimal(7).ln() + c[3] * (Decimal(12) / 7).ln() + c[4] * (r / 12).ln()
    return float(10 * ln.exp())


class TestModel:
    # As printed in the publication's table, typed a second time.
    PRINTED = MappingProxyType(
        {
            "GEO": "-3.9045 2.3004 -2.6496 -1.0908 -2.0089 -3.3276 1.1513 -0.2977",
            "LRG": "-3.3996 2.3258 -2.8522 -1.0151 -2.1002 -3.4407 1.1513 -0.3295",
            "MAX": "-3.2738 2.3343 -2.8857 -1.0060 -2.1016 -3.3940 1.1513 -0.3354",
        }
    )

    @pytest.mark.parametrize("component", PRINTED)
    @pytest.mark.parametrize("case", [(1.5, 0), (3.4, 2.554), (3.6, 8.5), (3.5, 24)])
    @pytest.mark.parametrize("vs30", [200, 320])
    def test_median_by_hand(self, component, case, vs30):
        expected = by_hand(self.PRINTED[component].split(), *case, vs30)
        assert float(Model(component).median_mm_s(*case, vs30)) == pytest.approx(
            expected, rel=1e-12
        )

    @pytest.mark.parametrize(
        "component, known",
        [
            ("LRG", ["0x1.e38acc014a454p+3", "0x1.18d4c1de1f6b2p+2", "0x1.83e9e9b605d36p-5"]),
            ("GEO", ["0x1.5552d731fc862p+3", "0x1.bce7c195adcd9p+1", "0x1.4d4199df66d6bp-5"]),
            ("MAX", ["0x1.07b39ab134bd7p+4", "0x1.33e50fb81c91ep+2", "0x1.a68b5e7d29efap-5"]),
        ],
    )
    def test_medians_have_the_same_bits_on_every_machine(self, component, known):
        found = Model(component).median_mm_s([3.4, 3.6, 2.4], [2.554, 8.5, 24.0], 180.0)
        assert [one.hex() for one in found.tolist()] == known

    def test_values_exceeded(self):
        model = Model()
        assert model.deviations.sigma == pytest.approx(
            math.sqrt(0.2448**2 + 0.2406**2 + 0.4569**2), rel=1e-12
        )
        rare = model.exceeded_mm_s(2.0, 0.01)
        assert rare == pytest.approx(2 * math.exp(2.3263479 * model.deviations.sigma), rel=1e-7)
        assert model.exceedance(2.0, rare) == pytest.approx(0.01, rel=1e-9)
        assert model.exceedance(2.0, 2.0) == 0.5

    @pytest.mark.parametrize("component", Model.components)
    def test_draws_have_the_published_deviations_and_correlations(self, component):
        """100 000 draws of two events at two sites; tolerances: five standard errors of a standard
        deviation,
        s / sqrt(2 n), and of a correlation, (1 - r²) / sqrt(n)."""
        n = 100_000
        model = Model(component)
        event, site, within = model.draw(Draws(1), n, 2, 2)
        tau, phi_s2s, phi_ss = model.deviations
        for terms, scale in ((event, tau), (site, phi_s2s), (within, phi_ss)):
            assert np.std(terms.reshape(n, -1), axis=0) == pytest.approx(
                scale, abs=5 * scale / math.sqrt(2 * n)
            )
        total = event + site + within
        variance = model.deviations.sigma**2
        assert total.std(axis=0) == pytest.approx(
            math.sqrt(variance), abs=5 * math.sqrt(variance / (2 * n))
        )
        for one, other, shared in (
            (total[:, 0, 0], total[:, 1, 0], phi_s2s**2),
            (total[:, 0, 0], total[:, 0, 1], tau**2),
            (total[:, 0, 0], total[:, 1, 1], 0.0),
        ):
            expected = shared / variance
            assert np.corrcoef(one, other)[0, 1] == pytest.approx(
                expected, abs=5 * (1 - expected**2) / math.sqrt(n)
            )


class TestPlaces:
    def test_both_formulae_agree_in_the_field(self):
        x, y = np.meshgrid(np.linspace(225e3, 270e3, 10), np.linspace(565e3, 615e3, 10))
        there = places.to_rd(*places.to_wgs84(x, y))
        assert np.hypot(there[0] - x, there[1] - y).max() < 0.5

    def test_the_origin_and_a_published_point(self):
        """Amersfoort, and the Westertoren in Amsterdam: RD 120700.723, 487525.502 is 52.37453253,
        4.88352559."""
        assert places.to_wgs84(155000, 463000)[0] == pytest.approx(52.15517440, abs=1e-9)
        grid = (120700.723, 487525.502)
        degrees = (52.37453253, 4.88352559)
        assert places.to_wgs84(*grid) == pytest.approx(degrees, abs=3e-6)
        assert places.to_rd(*degrees) == pytest.approx(grid, abs=0.5)

    def test_they_have_the_same_bits_on_every_machine(self):
        x, y = places.to_rd(*LOPPERSUM)
        assert [float(one).hex() for one in (x, y, *places.to_wgs84(x, y))] == [
            "0x1.dfba3d502d102p+17",
            "0x1.2275fbc8c0a31p+19",
            "0x1.aaa8f5c2fd2f3p+5",
            "0x1.afd70a3fecdb6p+2",
        ]
        arrays = places.to_rd(*(np.array([one, one]) for one in LOPPERSUM))
        assert [list(one) for one in arrays] == [[x, x], [y, y]]


class TestCatalogue:
    def test_what_ships(self, catalogue):
        events = catalogue.events
        assert len(events) == 1474 and catalogue.years == (1991, 2022)
        assert [int(np.sum(events.magnitude >= m)) for m in (1.5, 2.0, 2.5, 3.0)] == [
            356,
            118,
            44,
            14,
        ]
        assert list(events.time) == sorted(events.time)
        largest = events.loc[events.magnitude.idxmax()]
        assert (largest.place, largest.magnitude) == ("Huizinge", 3.6)

    def test_fdsn_text_is_read_as_the_same_events(self, catalogue, tmp_path):
        some = catalogue.events[100:110].reset_index(drop=True)
        latitude, longitude = places.to_wgs84(some.x_m, some.y_m)
        path = tmp_path / "events.txt"
        path.write_text(
            "#EventID|Time|Latitude|Longitude|Depth/km|Author|Catalog|Contributor|ContributorID|MagType|"
            "Magnitude|MagAuthor|EventLocationName|EventType\n"
            + "".join(
                f"{some.id[k]}|{some.time[k]:%Y-%m-%dT%H:%M:%S.%f}|{latitude[k]:.7f}|{longitude[k]:.7f}|"
                f"3.0|||KNMI||ML|{some.magnitude[k]}||{some.place[k]}|induced\n"
                for k in reversed(range(10))
            )
        )
        found = read_catalogue(path).events
        for name in ("time", "magnitude", "place", "id"):
            assert list(found[name]) == list(some[name])
        assert np.hypot(found.x_m - some.x_m, found.y_m - some.y_m).max() < 1.0

    ALL = "#EventID|Time|Latitude|Longitude|Depth/km|Catalog|Magnitude|EventType\n"
    FIRST = "a1|2018-01-08T14:00:52.5|53.363|6.751|3.0|A|3.4|induced or triggered event\n"
    HEAD = "date_utc,time_utc,magnitude,easting_rd_m,northing_rd_m\n"

    @pytest.mark.parametrize(
        "text, message",
        [
            (
                HEAD + "2018-01-08,14:00:52,3.4,245789,598263\n2018-01-09,late,3,245789,598263\n",
                "line 3: time",
            ),
            (HEAD + "2018-01-08,14:00:52,3.4,598263,245789\n", "line 2: epicentre outside"),
            ("date_utc,time_utc,magnitude\n2018-01-08,14:00:52,3.4\n", "no epicentres"),
            ("#EventID|Time|Magnitude\na|2018-01-08|3\n", "line 1: no column latitude, longitude"),
            (
                ALL + "q1|2018-02-08T14:00:58|53.36|6.75|0.0|A|1.5|quarry blast\n",
                "no event that the ground-motion models are for",
            ),
            ("<?xml version='1.0'?>\n<q:quakeml/>\n", "XML or JSON; expected CSV, or the text"),
        ],
    )
    def test_a_bad_line_is_named_and_another_format(self, tmp_path, text, message):
        assert message in one_line_error(read_catalogue, written(tmp_path / "bad.csv", text))

    @pytest.mark.parametrize(
        ("line", "note"),
        [
            (
                "b9|2018-01-08T14:00:52.9|53.36|6.75|3.0|A|3.4|earthquake",
                (
                    "lines 2 and 3 are 0.4 s and 0.3 km apart (M 3.4 "
                    "and 3.4): taken as one earthquake, line 3 left out"
                ),
            ),
            (
                "b9|2018-01-08T14:00:58.9|53.26|6.75|10.0|B|3.6|earthquake",
                "lines 2 and 3 are 6.4 s and 11.5 km apart",
            ),
            (
                "q1|2018-02-08T14:00:58|53.36|6.75|0.0|A|1.5|quarry blast",
                "no earthquake by its type: line 3",
            ),
            (
                "q1|2018-02-08T14:00:58|53.36|6.75|0.0|A|1.5|duplicate",
                "no earthquake by its type: line 3",
            ),
            (
                "t1|2018-04-13T01:20:00|53.36|6.75|17|A|3.8|earthquake",
                "deeper than 10 km, as tectonic earthquakes are",
            ),
            (
                "t2|1992-04-13T01:20:00|51.17|5.95|3|A|5.8|earthquake",
                "more than 10 km from the epicentres of the field",
            ),
        ],
    )
    def test_events_that_the_models_are_not_for_and_doubles_are_left_out_and_named(
        self, tmp_path, line, note
    ):
        path = written(tmp_path / "events.txt", self.ALL + self.FIRST + line + "\n")
        found = read_catalogue(path)
        assert (
            list(found.events.id) == ["a1"]
            and len(found.notes) >= 1
            and any(note in one for one in found.notes)
        )

    KNMI = (
        "YYMMDD,TIME,LOCATION,LAT,LON,DEPTH,MAG,EVALMODE\n"
        "20180108,140052.16,Zeerijp,53.363,6.751,3.0,3.4,manual\n"
    )

    @pytest.mark.parametrize(
        "line, time",
        [
            (
                "20221008,014259.72,Wirdum,53.318,6.773,3.0,3.1,manual",
                "2022-10-08 01:42:59.720000+00:00",
            ),
            (
                "20221008,259.72,Wirdum,53.318,6.773,3.0,3.1,manual",
                "2022-10-08 00:02:59.720000+00:00",
            ),
            ("20221008,000300,Wirdum,53.318,6.773,3.0,3.1,manual", "2022-10-08 00:03:00+00:00"),
        ],
    )
    def test_knmi_s_list_of_the_country_is_read_as_it_is(self, tmp_path, line, time):
        """Also where a spreadsheet took the first zeros off; an event in the sea is left out and
        named."""
        path = written(
            tmp_path / "all_induced.csv",
            self.KNMI + line + "\n20190101,000001,Sea,54.2,4.1,3.0,2,manual\n",
        )
        found = read_catalogue(path)
        events = found.events
        assert [str(one) for one in events.time] == ["2018-01-08 14:00:52.160000+00:00", time]
        assert list(events.place) == ["Zeerijp", "Wirdum"] and list(events.magnitude) == [3.4, 3.1]
        assert len(set(events.id)) == 2, "the list has no identifiers, but these are two events"
        assert (events.x_m[0], events.y_m[0]) == pytest.approx(places.to_rd(53.363, 6.751))
        (note,) = found.notes
        assert note.endswith("left out as outside the Netherlands: line 4")

    LATER = (
        "#EventID|Time|Latitude|Longitude|Depth/km|Author|Catalog|Contributor|ContributorID|MagType|Magnitude|"
        "MagAuthor|EventLocationName|EventType\n"
        "knmi2022a|2022-01-24T00:27:26.2|53.320000|6.730000|3.0|||KNMI|knmi2022a|MLn|0.61247||Loppersum|earthquake\n"
        "knmi2022b|2022-10-08T02:33:26.1|53.316000|6.781000|3.0|||KNMI|knmi2022b|MLn|3.09864||Wirdum|"
        "induced or triggered event\n"
        "knmi2022c|2022-11-09T10:00:00.5|53.100000|6.000000|18.0|||KNMI|knmi2022c|MLn|1.10012||Elsewhere|\n"
    )
    """In the form of KNMI's service: decimals of times and magnitudes, no author, catalogue and
    author of magnitude."""

    def test_later_events_of_the_service_continue_the_catalogue(
        self, catalogue, tmp_path, error_of, output_of
    ):
        """What both have is not doubled, what the models are not for is left out and named."""
        later = written(tmp_path / "later.txt", self.LATER)
        joined = tmp_path / "catalogue.csv"
        output_of("catalogue", later, "--out", joined)
        found = read_catalogue(joined)
        assert (
            len(found.events) == 1475
            and f"{found.end:%Y-%m-%dT%H:%M:%S.%f}" == "2022-10-08T02:33:26.100000"
        )
        assert found.events[:-1].equals(catalogue.events)
        exposure = Exposure(places.at_degrees(*GARSTHUIZEN), found, model_named("bommer-2022"))
        assert exposure.as_dict()["catalogue_ends"] == "2022-10-08"
        assert "its last event is of 2022-10-08, the catalogue's of 2022-10-08" in error_of(
            "catalogue", later, "--catalogue", joined, "--out", tmp_path / "c.csv"
        )


class TestExposure:
    @pytest.mark.parametrize(
        "place, median, rare, over",
        [
            (GARSTHUIZEN, "19.61", "74.1", (36, 19, 8, 3)),
            (LOPPERSUM, "12.96", "49.0", (42, 20, 12, 4)),
            (DELFZIJL, "1.972", "7.45", (6, 0, 0, 0)),
        ],
    )
    def test_three_addresses(self, catalogue, place, median, rare, over):
        """Figures of a separate program with the same data."""
        exposure = Exposure(places.at_degrees(*place), catalogue, Model())
        found = exposure.as_dict()
        assert f"{found['largest_median_mm_s']:.4g}" == median
        assert f"{found['one_percent_mm_s']:#.3g}" == rare
        assert tuple(int(np.sum(exposure.median_mm_s > level)) for level in (1, 2, 4, 8)) == over

    def test_probability_of_any_event_against_draws(self, catalogue):
        """2 000 draws; tolerance: four standard errors."""
        n = 2_000
        exposure = Exposure(places.at_degrees(*DELFZIJL), catalogue.between(2006, 2012), Model())
        median = exposure.median_mm_s[:, np.newaxis]
        random = Draws(2)
        largest = [
            (median * np.exp(sum(exposure.model.draw(random, n // 10, len(median))))).max(axis=1)
            for _ in range(10)
        ]
        for level in (1, 2, 5):
            p = exposure.at_least_once(level)
            share = np.mean(np.concatenate(largest) > level)
            assert share == pytest.approx(p, abs=4 * math.sqrt(p * (1 - p) / n))


class TestCommand:
    def test_json_and_files(self, output_of, tmp_path):
        found = json.loads(output_of("exposure", "--at", *LOPPERSUM, "--json", "--out", tmp_path))
        assert found["largest_median_mm_s"] == pytest.approx(12.96, abs=5e-3)
        columns = list(TABLES["exposure.csv"])
        assert len(found["events"]) == 1474 and set(found["events"][0]) == set(columns)
        table = pd.read_csv(tmp_path / "exposure.csv")
        assert list(table) == columns and len(table) == 1474
        assert {path.suffix for path in tmp_path.iterdir()} == {".csv", ".png", ".pdf"}

    def test_formulas_of_a_catalogue_reach_no_spreadsheet(self, tmp_path, output_of):
        """Place and identifier are foreign text."""
        names = "+1+cmd", "-2+3", "@SUM(A1)", "'t Zandt", "-5", '=HYPERLINK("x")'
        path = written(
            tmp_path / "events.txt",
            "#EventID|Time|Latitude|Longitude|Magnitude|EventLocationName\n"
            + "".join(
                f"{name}|2018-01-0{day}T14:00:52|53.36|6.75|3.4|{name}\n"
                for day, name in enumerate(names, 1)
            ),
        )
        output_of("exposure", "--at", 53.36, 6.75, "--catalogue", path, "--out", tmp_path / "out")
        table = pd.read_csv(tmp_path / "out/exposure.csv", dtype=str)
        safe = ["'+1+cmd", "'-2+3", "'@SUM(A1)", "'t Zandt", "-5", '\'=HYPERLINK("x")']
        assert list(table["place"]) == list(table["id"]) == safe
        assert list(from_words(table)["place"][[0, 3]]) == ["+1+cmd", "'t Zandt"]

    @pytest.mark.parametrize(
        "words, message",
        [
            ([], "which address"),
            (["--at", "52.37", "4.88"], "nearest epicentre"),
            (["--at", "53.3", "6.7", "--to", "2030"], "--to 2030"),
            (["--at", "53.3", "6.7", "--component", "ROT"], "component = 'ROT'"),
        ],
    )
    def test_bad_input_is_one_line(self, error_of, words, message):
        said = error_of("exposure", *words)
        assert message in said and "expected" in said


def station_residuals(model, vs30_m_s=200.0):
    """Residuals of ln PGV at the stations, of the larger horizontal component."""
    stations = pd.read_csv(COMPONENTS, comment="#").groupby("station", sort=False)
    x_m, y_m = places.to_rd(
        *(stations[name].first().to_numpy() for name in ("latitude", "longitude"))
    )
    distance_km = np.hypot(x_m - ZEERIJP["x_m"], y_m - ZEERIJP["y_m"]) / 1e3
    median = model.median_mm_s(ZEERIJP["magnitude"], distance_km, vs30_m_s)
    return np.log(stations["pgv_mm_s"].max() / median)


class TestResiduals:
    def test_stations_within_ten_kilometres(self):
        """Zeerijp at the 16 stations that ship: sigma within an event is 0.52 (LRG); the mean of 16
        may deviate by two standard errors, as the stations with their site terms are a sample; no
        event term is taken off."""
        model = Model()
        found = station_residuals(model)
        within = math.hypot(model.deviations.phi_s2s, model.deviations.phi_ss)
        assert len(found) == 16 and abs(found.mean()) < 2 * math.hypot(
            within / 4, model.deviations.tau
        )
        # as scattered as the model says, or less by
        assert stats.chi2.cdf(15 * found.var() / within**2, 15) > 0.025
        # no more than chance explains
        assert stats.chi2.sf(15 * found.var() / within**2, 15) > 0.025
