"""Fragility curves: known medians and dispersions come back, bounds hold what they say, bad studies
are refused."""

import numpy as np
import pandas as pd
import pytest
from conftest import refused_with
from numpy.testing import assert_allclose
from scipy.optimize import brentq
from scipy.special import ndtr, ndtri
from scipy.stats import binom
from scipy.stats import t as student

from damage.applications.studies.fragility import (
    Fragility,
    at_intensities,
    curve,
    fit_all,
    fragility,
    in_words,
    load_runs,
    mixed,
    solve,
)
from damage.applications.studies.fragility_picture import fragility_pictures
from damage.applications.studies.new_record import new_record
from damage.applications.studies.ordered import with_one_dispersion
from damage.applications.studies.states import (
    LEVELS,
    State,
    check_states,
    leading,
    parse_state,
)
from damage.measure.tables import write_table

MEDIAN_G = 0.2
DISPERSION = 0.4
INTENSITIES_G = np.arange(1, 9) / 20


def fit(intensity, exceed, runs):
    """(median, dispersion)."""
    return solve(intensity, exceed, runs)[:2]


def walls(n_walls, seed, level=0.05):
    """Runs of walls whose capacity is lognormal: each exceeds the level in all motions stronger
    than it."""
    random = np.random.default_rng(seed)
    capacity_g = MEDIAN_G * np.exp(DISPERSION * random.standard_normal(n_walls))
    pga_g, wall = (column.ravel() for column in np.meshgrid(INTENSITIES_G, np.arange(n_walls)))
    exceeds = pga_g > capacity_g[wall]
    return pd.DataFrame(
        {
            "wall": "w",
            "status": "complete",
            "record": "r",
            "pga_g": pga_g,
            "strength_seed": wall,
            "strength_cov": 0.3,
            "collapsed_at_s": np.nan,
            "max_DI": np.where(exceeds, 2, 0.5) * level,
            "max_crack_width_mm": 10 * pga_g / capacity_g[wall],
            "max_psi": 0.0,
        }
    )


def made(level, median, dispersion, intensity="pga_g", **more):
    """A curve of the maximum DI that is known."""
    usual = {"samples": np.zeros((0, 2)), "n_replicates": 0, "n_records": 5, "n_walls": 20}
    return Fragility(
        "max_DI",
        level,
        median,
        dispersion,
        n_runs=100,
        n_exceeding=50,
        intensity=intensity,
        **usual | more,
    )


class TestFit:
    def test_exact_shares_give_back_the_curve(self):
        x = np.geomspace(0.05, 0.8, 9)
        assert_allclose(
            fit(x, 1e3 * curve(x, MEDIAN_G, DISPERSION), np.full(9, 1e3)),
            (MEDIAN_G, DISPERSION),
            rtol=1e-4,
        )

    @pytest.mark.parametrize(
        ("intensity", "exceed", "runs", "expected"),
        [
            ([0.05, 0.1, 0.2, 0.4, 0.8], [1, 3, 9, 17, 20], [20] * 5, (0.1967399282, 0.6889519606)),
            (
                [0.02, 0.07, 0.15, 0.31, 0.6],
                [0, 2, 3, 9, 4],
                [5, 12, 7, 11, 4],
                (0.1543910703, 0.7412603618),
            ),
            (
                [0.03, 0.05, 0.08, 0.11, 0.16, 0.2, 0.27, 0.35, 0.5, 0.7],
                [0, 0, 1, 0, 0, 1, 0, 1, 1, 1],
                [1] * 10,
                (0.1655572040, 0.9675116797),
            ),
            ([0.1, 0.2, 0.4], [4, 3, 7], [10] * 3, (0.2330692756, 1.8013867377)),
        ],
    )
    def test_it_is_the_probit_regression_of_statsmodels(self, intensity, exceed, runs, expected):
        """Version 0.15.0 of statsmodels, on ln x, where a + b ln x = ln(x / median) / dispersion:

        y, n, x = map(np.array, (exceed, runs, intensity))
        family = sm.families.Binomial(link=sm.families.links.Probit())
        model = sm.GLM(np.column_stack([y, n - y]), sm.add_constant(np.log(x)), family=family)
        a, b = model.fit(tol=1e-14, maxiter=200).params
        print(np.exp(-a / b), 1 / b)
        """
        assert_allclose(fit(intensity, exceed, runs), expected, rtol=1e-5)

    def test_many_walls_give_back_the_curve_that_they_were_drawn_from(self):
        found = fragility(walls(20_000, seed=2), "max_DI", 0.05, "pga_g", 0)
        assert_allclose((found.median, found.dispersion), (MEDIAN_G, DISPERSION), rtol=0.02)

    def test_a_step_bounds_the_median_by_its_ends_whatever_is_drawn(self):
        assert_allclose(fit([0.1, 0.2, 0.4], [0, 5, 5], [5, 5, 5]), (0.02**0.5, 0))
        runs = pd.concat([walls(6, seed=1), walls(6, seed=1).assign(record="s")])
        runs["max_psi"] = np.where(runs["pga_g"] > 0.22, 3.0, 0.0)
        found = fragility(runs, "max_psi", 2.0, "pga_g", replicates=20)
        row = found.row()
        assert_allclose(
            [row["median_both_low_g"], row["median_both_high_g"], row["dispersion"]],
            [0.2, 0.25, 0],
        )
        assert_allclose(found.bounds([0.19, 0.21, 0.3]), [[0, 0, 1], [0, 1, 1]])

    @pytest.mark.parametrize(
        ("exceed", "why", "side"),
        [
            ([8, 6, 4, 2], "at its bound of 3: no rising curve", 0),
            ([5, 5, 5, 5], "at its bound of 3: no rising curve", 0),
            ([0, 0, 0, 1], "one intensity only has runs of both kinds", 1),
            ([9, 10, 10, 10], "one intensity only has runs of both kinds", -1),
            ([0, 0, 0, 0], "no run exceeds it", 1),
            ([10, 10, 10, 10], "every run exceeds it", -1),
            ([0, 0, 1, 3], "median would lie above all intensities", 1),
            ([6, 8, 9, 10], "median would lie below all intensities", -1),
        ],
    )
    def test_runs_that_determine_no_curve(self, exceed, why, side):
        """10 runs at each of four intensities."""
        one = solve([0.05, 0.1, 0.2, 0.4], exceed, [10] * 4)
        assert why in one.why and one.side == side and np.isnan([one.median, one.dispersion]).all()

    def test_a_collapse_exceeds_every_level(self):
        runs = walls(10, seed=3)
        runs["collapsed_at_s"] = 1.0
        assert fragility(runs, "max_psi", 2.0, "pga_g", replicates=0).n_exceeding == len(runs)


@pytest.mark.parametrize(("n_records", "n_walls"), [(5, 5), (8, 3)])
def test_intervals_of_the_median_cover_the_known_one(n_records, n_walls):
    """Over 40 studies with a median of 0.2 g; numbers outside occur in one of 500 such tests.
    Percentiles of few samples lie further in than those of many: between 40, at ranks 2.95 and
    38.05, are 0.856 of a distribution, and not 0.90."""
    studies = 40
    samples = 40
    outside = 2 * (1 + 0.05 * (samples - 1)) / (samples + 1)
    bounds = np.array(
        [
            fragility(
                recorded(n_records, 0.4, seed, n_walls, levels=8), "max_DI", 0.1, "pga_g", samples
            ).median_bounds()[:, 0]
            for seed in range(studies)
        ]
    )
    above = np.sum(bounds[:, 0] > 0.2)
    below = np.sum(bounds[:, 1] < 0.2)
    least, most = binom.ppf((0.001, 0.999), studies, outside)
    assert least <= above + below <= most
    assert max(above, below) <= binom.ppf(0.999, studies, outside / 2)


@pytest.mark.parametrize(("n_records", "n_walls"), [(5, 12), (12, 5)])
def test_bounds_of_a_mean_of_five_are_students(n_records, n_walls):
    """Resampled means of five logarithms scatter by sqrt(4 / 5) of their standard error, 0.1;
    Student's interval has that error and the quantile of four degrees of freedom."""
    shares = (np.arange(2000) + 0.5) / 2000
    medians = MEDIAN_G * np.exp(0.1 * np.sqrt(4 / 5) * ndtri(shares))
    samples = np.column_stack([medians, np.full(2000, DISPERSION)])
    one = made(
        0.1,
        MEDIAN_G,
        DISPERSION,
        samples=samples,
        n_replicates=2000,
        n_records=n_records,
        n_walls=n_walls,
    )
    half = 0.1 * student.ppf(0.95, 4)
    assert_allclose(np.log(one.median_bounds()[:, 0] / MEDIAN_G), (-half, half), rtol=0.01)


class TestUndetermined:
    """Runs, and bootstrap samples, that determine no curve: "-" with the reason, and nothing
    exported."""

    @pytest.mark.parametrize(
        ("intensities", "exceed", "why"),
        [
            ((0.05, 0.1, 0.2, 0.4), (8, 6, 4, 2), "no rising curve"),
            ((0.05, 0.1, 0.2, 0.4), (5, 5, 5, 5), "no rising curve"),
            ((0.05, 0.1, 0.2, 0.4), (0, 0, 0, 1), "runs of both kinds"),
            ((0.2, 0.3), (4, 8), "2 intensities only, a curve needs 3 that differ by 1 %"),
            ((0.2, 0.3, 0.301), (4, 8, 8), "a curve needs 3 that differ by 1 %"),
        ],
    )
    def test_it_is_said_everywhere_and_no_curve_exported(
        self, intensities, exceed, why, tmp_path, output_of
    ):
        """Ten draws at each intensity.  Any two shares lie on a lognormal curve, which was drawn
        and exported with a median of 0.207 g."""
        of_one = walls(10, seed=1).query("pga_g == 0.05").assign(eigen_period_s=0.2)
        runs = pd.concat(
            of_one.assign(pga_g=pga_g, max_psi=np.where(of_one["strength_seed"] < n, 1.5, 0.5))
            for pga_g, n in zip(intensities, exceed)
        )
        write_table(runs, tmp_path / "tables" / "summary.csv")
        words = ["--state", "max_psi > 1", "--replicates", 20, "--at", 0.1]
        printed = output_of(
            "fragility", tmp_path, "--out", tmp_path / "f", "--export", tmp_path / "e", *words
        )
        assert [path.name for path in (tmp_path / "e").iterdir()] == ["fragility_coefficients.csv"]
        for table in ("f/fragility_pga_g", "f/fragility_pga_g_at", "e/fragility_coefficients"):
            row = pd.read_csv(tmp_path / f"{table}.csv").iloc[0]
            assert why in row["undetermined"], table
            unknown = row.filter(regex="^(median|dispersion|mean|new_record|probability)")
            assert unknown.isna().all(), table
        assert row["distribution"] == "none" and f"no curve, {row['undetermined']}" in printed
        fits = {"w": [fragility(runs, "max_psi", 1, "pga_g", replicates=20)]}
        ((_, figure),) = fragility_pictures(runs, fits)
        words = figure.axes[0].get_legend().get_texts()[0].get_text()
        assert (
            words.endswith(row["undetermined"]) and len(figure.axes[0].lines) == 1
        )  # the shares alone

    def test_runs_that_differ_by_more_than_motions_are_named(self):
        runs = pd.DataFrame({"wall": ["a", "a", "b"], "top": ["piers", "uniform", "piers"]})
        assert list(mixed(runs)) == ["wall a: one curve through runs that differ in top"]

    def test_draws_of_one_wall_are_not_called_walls(self):
        printed = in_words({"w": [fragility(walls(12, seed=1), "max_DI", 0.05, "pga_g", 0)]})
        assert "draws of strengths: 12, records: 1;" in printed and "walls" not in printed

    def test_samples_without_a_curve_open_the_bound_on_their_side(self):
        """One of three records harms nothing: samples with many of it have their median above all
        runs.  An interval of the others would end at a finite one."""
        runs = recorded(3, 0.1, seed=1)
        runs["pga_g"] = (runs["pga_g"] / (1 + 0.01 * runs["record"].str[1:].astype(int))).round(9)
        runs.loc[runs["record"] == "r2", "max_DI"] = 0.0
        one = fragility(runs, "max_DI", 0.25, "pga_g", replicates=200)
        low, high = one.median_bounds()[:, 0]
        above = np.isinf(one.samples[:, 0]).sum()
        assert above > 10 and low < one.median < 0.8 and np.isnan(high)
        assert one.bounds([0.2]) is None and one.row()["fitted_both"] == 200 - above
        assert f"{above} of 200 bootstrap samples determine no curve" in in_words({"w": [one]})


def recorded(n_records, between, seed, n_walls=12, levels=6):
    """Runs in records that are more or less harmful than their PGA says, by a lognormal factor that
    PGV sees and PGA does not; walls scatter by 0.1."""
    random = np.random.default_rng(seed)
    factor = np.exp(between * random.standard_normal(n_records))
    capacity = np.exp(0.1 * random.standard_normal(n_walls))
    wall, record, step = (
        grid.ravel() for grid in np.meshgrid(*map(np.arange, (n_walls, n_records, levels)))
    )
    pga_g = np.geomspace(0.05, 0.8, levels)[step] * (1 + 0.01 * record)
    harm = pga_g * factor[record]
    return pd.DataFrame(
        {
            "wall": "w",
            "record": [f"r{k}" for k in record],
            "pga_g": pga_g,
            "pgv_m_s": 0.3 * harm,
            "strength_seed": wall,
            "strength_cov": 0.3,
            "status": "complete",
            "collapsed_at_s": np.nan,
            "max_DI": harm / capacity[wall] / 2,
            "max_crack_width_mm": 0.0,
            "max_psi": 0.0,
        }
    )


def study_of(medians, x, n_runs, dispersion):
    """What `new_record` takes of runs whose shares are exact: records of these medians, each at all
    intensities."""
    shares = curve(x, np.asarray(medians)[:, None], dispersion)
    return x, n_runs * shares, np.full(shares.shape, float(n_runs))


class TestNewRecord:
    def test_medians_that_are_known_give_students_interval(self):
        medians = np.exp([-1.9, -1.75, -1.6, -1.5, -1.2])
        one = new_record(*study_of(medians, np.geomspace(0.05, 0.8, 25), 2000, 0.1))
        logs = np.log(medians)
        half = student.ppf(0.95, 4) * logs.std(ddof=1) * np.sqrt(1 + 1 / 5)
        assert_allclose(
            np.log(one.median_bounds()), (logs.mean() - half, logs.mean() + half), atol=0.02
        )

    def test_nine_in_ten_new_records_lie_in_their_interval_and_few_in_that_of_the_mean(self):
        """Over 30 studies of five records whose medians scatter by 0.3: the share of new records is
        known for each interval, 0.90 expected of the first, with a standard deviation of 0.02."""
        held = {"new record": [], "mean": []}
        for seed in range(30):
            runs = recorded(5, 0.3, seed, n_walls=5)
            one = fragility(runs, "max_DI", 0.1, "pga_g", replicates=20)
            for name, (low, high) in (
                ("new record", one.new_record.median_bounds()),
                ("mean", one.median_bounds()[:, 0]),
            ):
                z = np.log(np.array([low, high]) / 0.2) / 0.3  # DI = 0.1 at a harm of 0.2 g
                held[name].append(np.diff(ndtr(z))[0])
        assert 0.85 < np.mean(held["new record"]) < 0.95
        assert np.mean(held["mean"]) < 0.75

    def test_the_median_of_its_own_probability_lies_in_the_interval_the_mean_need_not(self):
        """The mean was printed beside the interval: 0.032, and 0.000 to 0.003."""
        fits = {"w": [fragility(recorded(4, 0.6, 0, 4), "max_DI", 0.1, "pga_g", 0)]}
        table = at_intensities(fits, np.geomspace(0.02, 0.8, 12))
        inside = table["new_record_median"].between(
            table["new_record_low"], table["new_record_high"]
        )
        outside = ~table["new_record"].between(table["new_record_low"], table["new_record_high"])
        assert inside.all() and outside.any()

    def test_few_records_and_a_wide_interval_are_named(self):
        def printed(runs):
            return in_words({"w": [fragility(runs, "max_DI", 0.1, "pga_g", replicates=0)]})

        scattered = recorded(5, 0.6, 3, 4)
        bounds = fragility(scattered, "max_DI", 0.1, "pga_g", 0).new_record.median_bounds()
        factor = bounds[1] / bounds[0]
        assert factor > 10
        assert f"within a factor of {factor:.0f} only: these 5 records tell" in printed(scattered)
        assert "5 records are few: another may give medians far from these" in printed(scattered)
        alike = printed(recorded(12, 0.1, 6, 4))
        assert "factor" not in alike and "few" not in alike


class TestOwnStates:
    @pytest.mark.parametrize(
        ("text", "expected"),
        [
            ("moderate: max_psi > 2", ("max_psi", 2.0, "moderate")),
            ("residual_DI>0.05", ("residual_DI", 0.05, "")),
            (" visible crack :max_psi > 1e0 ", ("max_psi", 1.0, "visible crack")),
        ],
    )
    def test_what_is_read(self, text, expected):
        assert parse_state(text) == expected

    @pytest.mark.parametrize(
        ("text", "complaint"),
        [
            ("max_psi 2", "expected COLUMN > LEVEL"),
            ("max_psi < 2", "expected COLUMN > LEVEL"),
            ("", "expected COLUMN"),
            ("max_psi > two", "level 'two'; expected a finite number"),
            ("max_psi > nan", "expected a finite number"),
            ("a: b: max_psi > 2", "expected COLUMN > LEVEL"),
        ],
    )
    def test_what_is_refused(self, text, complaint):
        refused_with(complaint, parse_state, text)

    def test_columns_that_cannot_be_levels_are_refused(self):
        runs = walls(3, seed=1)
        for measure, complaint in (
            ("max_pzi", "no column max_pzi; .* perhaps max_psi"),
            ("status", "column status .* holds no numbers"),
            ("collapsed_at_s", "holds no numbers"),
        ):
            refused_with(complaint, check_states, runs, [State(measure, 1.0)])
        refused_with(
            "given twice",
            check_states,
            runs,
            [State("max_psi", 1.0, "a"), State("max_DI", 1.0, "a")],
        )
        runs.loc[4, "max_psi"] = np.nan
        refused_with("1 of 24 runs have no max_psi", check_states, runs, [State("max_psi", 1.0)])

    def test_the_command_takes_them_from_its_words_or_from_the_study_file(
        self, tmp_path, output_of, error_of
    ):
        runs = walls(12, seed=1).assign(peak_force_n=lambda table: 1e4 * table["pga_g"])
        write_table(runs, tmp_path / "tables" / "summary.csv")
        words = ["fragility", tmp_path, "--out", tmp_path / "f", "--replicates", 5]
        output_of(
            *words,
            "--state",
            "wide: max_crack_width_mm > 8",
            "--state",
            "max_DI > 0.05",
            "--intensity",
            "peak_force_n",
            "--at",
            1000,
            2000,
        )
        table = pd.read_csv(tmp_path / "f" / "fragility_peak_force_n.csv")
        assert list(table["state"]) == ["wide", "max_DI > 0.05"]
        assert table["median_N"].between(500, 4000).all()
        assert len(pd.read_csv(tmp_path / "f" / "fragility_peak_force_n_at.csv")) == 4
        (tmp_path / "study.toml").write_text(
            'states = ["a: max_DI > 0.06"]\nintensity = "peak_force_n"\n'
        )
        output_of(*words)
        assert list(pd.read_csv(tmp_path / "f" / "fragility_peak_force_n.csv")["state"]) == ["a"]
        for bad, complaint in (
            (["--state", "max_DI > x"], "level 'x'"),
            (["--intensity", "pga"], "perhaps pga_g"),
        ):
            assert complaint in error_of(*words, *bad)


def test_an_intensity_that_sees_the_records_harm_has_the_smaller_dispersion():
    """Walls scatter by 0.1, of which twelve draws are; the records by 0.6 on top."""
    runs = recorded(8, 0.6, seed=3)
    by_pgv = fragility(runs, "max_DI", 0.1, "pgv_m_s", replicates=0)
    by_pga = fragility(runs, "max_DI", 0.1, "pga_g", replicates=0)
    assert by_pgv.dispersion < 0.2 < by_pga.dispersion
    assert by_pgv.median == pytest.approx(0.3 * 0.2, rel=0.1)


def test_the_command_writes_table_and_picture(tmp_path, output_of, error_of):
    write_table(walls(12, seed=1), tmp_path / "tables" / "summary.csv")
    assert "dispersion" in output_of(
        "fragility", tmp_path, "--out", tmp_path / "f", "--replicates", 20
    )
    table = pd.read_csv(tmp_path / "f" / "fragility_pga_g.csv")
    assert len(table) == sum(map(len, LEVELS.values())) and set(table["runs"]) == {96}
    assert table.set_index("measure").loc["max_psi", "median_g"].isna().all()
    assert {path.suffix for path in (tmp_path / "f").glob("fragility_w_pga_g.*")} == {
        ".png",
        ".pdf",
    }
    error_of("fragility", tmp_path, "--out", tmp_path, "--intensity", "sa_0.2_s_g")


SLIGHT = [4, 10, 17, 23, 27, 30, 32, 33]
MODERATE = [0, 1, 5, 13, 21, 27, 31, 33]


def graded(slight, moderate, n_walls=40):
    """320 runs, of which so many of 40 are slightly, and moderately, damaged at 0.1 to 0.8 g."""
    psi = [
        np.repeat([3.0, 1.5, 0.0], [graver, milder - graver, n_walls - milder])
        for milder, graver in zip(slight, moderate)
    ]
    return (
        walls(n_walls, seed=1)
        .sort_values("pga_g", kind="stable")
        .assign(pga_g=np.repeat(np.arange(1, 9) / 10, n_walls), max_psi=np.concatenate(psi))
    )


GRADES = State("max_psi", 1.0, "slight"), State("max_psi", 2.0, "moderate")


class TestStatesOfOneMeasure:
    def test_a_crossing_is_named_with_its_intensity(self):
        """That at which both curves have the same probability."""
        fits = fit_all(graded(SLIGHT, MODERATE), "pga_g", 0, GRADES)["w"]
        slight, moderate = fits
        crossing = brentq(lambda x: slight.probability(x) - moderate.probability(x), 0.6, 0.8)
        printed = in_words({"w": fits})
        assert (
            f"moderate is likelier than slight, which it implies, from {crossing:.2f} g" in printed
        )
        assert "it is 0.72, and the medians are 0.340 (slight) and 0.484" in printed
        apart = fit_all(graded(SLIGHT, np.array(SLIGHT) // 2), "pga_g", 0, GRADES)
        assert "likelier" not in in_words(apart)

    def test_one_dispersion_is_the_ordinal_probit_of_statsmodels(self):
        """Version 0.15.0 of statsmodels, grades 0, 1, 2 over ln x:

        model = OrderedModel(pd.Series(pd.Categorical(grade, ordered=True)), log_x, distr="probit")
        found = model.fit(method="bfgs", gtol=1e-10, maxiter=1000)
        slope = found.params.iloc[0]
        thresholds = model.transform_threshold_params(found.params.values)[1:-1]
        print(np.exp(thresholds / slope), 1 / slope)
        """
        fits = fit_all(graded(SLIGHT, MODERATE), "pga_g", 0, GRADES)["w"]
        common = with_one_dispersion(fits)
        assert_allclose([fit.median for fit in common], [0.34013799, 0.48378855], rtol=1e-5)
        assert_allclose([fit.dispersion for fit in common], 0.72109038, rtol=1e-5)

    def test_a_step_takes_the_dispersion_of_another_state(self):
        """Beside a step the wider curve of a graver state crosses it: all runs are slightly
        damaged from 0.2 g on."""
        fits = fit_all(graded([0, *[40] * 7], MODERATE), "pga_g", 0, GRADES)["w"]
        assert fits[0].step == (0.1, 0.2) and fits[1].step is None
        slight, moderate = with_one_dispersion(fits)
        assert slight.step is None and slight.dispersion == moderate.dispersion > 0.1
        assert 0.1 < slight.median < 0.2 < moderate.median

    def test_a_state_without_a_curve_and_a_single_curve_stay(self):
        fits = fit_all(graded(SLIGHT, np.zeros(8, int)), "pga_g", 0, GRADES)["w"]
        assert with_one_dispersion(fits) == fits and fits[1].why


def test_two_walls_that_interpolate_a_record_differently_share_its_intensities():
    """By the motion as applied, 10 % apart, the curves had other intensities for each wall."""
    stiff = walls(12, seed=1).assign(record_pga_g=lambda runs: runs["pga_g"])
    soft = stiff.assign(wall="v", pga_g=1.1 * stiff["pga_g"])
    runs = pd.concat([stiff, soft])
    fits = fit_all(runs, leading(runs), 0, [State("max_DI", 0.05)])
    assert {ones[0].intensity for ones in fits.values()} == {"record_pga_g"}
    assert fits["w"][0].median == fits["v"][0].median


def test_studies_without_scattered_strengths_are_refused(tmp_path):
    refused_with("holds no tables/summary.csv", load_runs, tmp_path)
    write_table(walls(2, seed=1).assign(strength_cov=0.0), tmp_path / "tables" / "summary.csv")
    refused_with("no finished run with scattered strengths", load_runs, tmp_path)
    write_table(pd.DataFrame({"run": ["a"]}), tmp_path / "tables" / "summary.csv")
    refused_with("no column max_DI", load_runs, tmp_path)
