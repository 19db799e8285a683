"""Figures of studies: what is drawn is what the tables hold, and what cannot be drawn is said."""

import shutil
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
import small_history
from conftest import REPOSITORY
from matplotlib.colors import to_rgba
from numpy.testing import assert_allclose
from scipy.optimize import minimize
from small_history import make_history

from damage.draw.style import BLACK, BLUE, VERMILLION
from damage.measure.tables import index_table, write_table
from damage.motion.formats import read_record, shipped_record_path
from damage.motion.intensity import response_spectrum
from damage.motion.loading import Recorded
from damage.units import GRAVITY
from paper import figures as study_figures
from paper.harmonic_figures import against_amplitude, drifts
from paper.ida_figures import against_drift, nonnegative_parabola, records, residual_against_pga
from paper.results import load_results, variants

AMPLITUDES_G = (0.025, 0.05, 0.1)
SCALES = (0.5, 1.0, 1.5, 2.0)
PERIOD_S = 0.2
RECORDS = ("MID1_N_synthetic", "BGAR_HGE")
MEASURES = [
    f"{state}_{part}"
    for state in ("max", "residual", "max_shear_limit", "residual_shear_limit")
    for part in ("DI", "DI_drift", "DI_open", "DI_slip")
]


def parabola(drift_pct):
    return 0.01 + 0.5 * drift_pct + 0.2 * drift_pct**2


def point_row(name, solver, strength, **columns):
    """A point of five runs, or a single one of YADE; all measures grow with its strength, each at
    its own rate."""
    row = {
        "point": name,
        "solver": solver,
        "wall": "small",
        "members": 5 if solver == "reference" else 1,
        "lintel": "elastic",
        "contacts": "interior",
        "beta_s": 1e-6 if solver == "reference" else 0.0,
        "status": "complete",
        "collapsed_at_s": np.nan,
        "eigen_period_s": 0.19,
        **columns,
    }
    values = {name: strength * (number + 1) / 100 for number, name in enumerate(MEASURES)}
    values |= {"max_drift_ratio": strength / 1000, "max_DI": parabola(strength / 10)}
    low, high = (0.9, 1.3) if solver == "reference" else (1.0, 1.0)
    for measure, value in values.items():
        row |= {measure: value, f"{measure}_min": low * value, f"{measure}_max": high * value}
    return row


def write_study(folder, rows, loading="harmonic"):
    """A study's folder: its tables, and the history and index table of every point's first run."""
    points = pd.DataFrame(rows)
    (folder / "runs").mkdir(parents=True)
    names = []
    for _, point in points.iterrows():
        names.append(
            [f"{point['point']}_{member}_{point['solver']}" for member in range(point["members"])]
        )
        history = folder / "runs" / f"{point.get('record', loading)}.h5"  # alike but for its motion
        table = folder / "tables" / f"{history.stem}.csv"
        if not history.exists():
            drift = 1e-3 * np.sin(2 * np.pi * np.arange(21) / 6 - 0.2)  # a cycle of 60 ms
            made = make_history(
                history,
                loading=history.stem,
                drift=drift,
                opening={0: 2e-4 * (np.arange(21) > 8)},
                at_limit=(3,),
            )
            write_table(index_table(made), table)
        shutil.copy(history, history.with_stem(names[-1][0]))
        shutil.copy(table, table.with_stem(f"{names[-1][0]}_index"))
    runs = points.assign(run=names).explode("run").assign(members=1)
    write_table(points, folder / "tables" / "points.csv")
    write_table(runs, folder / "tables" / "summary.csv")


def harmonic_rows(**columns):
    return [
        point_row(
            f"h{period_s}-{amplitude_g}",
            solver,
            20 * amplitude_g + 0.1 * (solver == "yade"),
            motion_period_s=period_s,
            amplitude_g=amplitude_g,
            cycles=3,
            **columns,
        )
        for period_s in (PERIOD_S, 0.33)
        for amplitude_g in AMPLITUDES_G
        for solver in ("reference", "yade")
    ]


def ida_rows():
    return [
        point_row(
            f"{name}-{scale}",
            solver,
            scale + 0.05 * number + 0.1 * (solver == "yade"),
            record=name,
            scale=scale,
            pga_g=0.1 * scale,
        )
        for number, name in enumerate(RECORDS)
        for scale in SCALES
        for solver in ("reference", "yade")
    ]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    with pytest.MonkeyPatch.context() as patch:
        for name, window_s in zip(RECORDS, (None, (17.0, 25.0))):
            motion = Recorded(read_record(shipped_record_path(name)), scale=2.0, window_s=window_s)
            patch.setitem(small_history.LOADINGS, name, motion.as_dict())
        write_study(folder / "harmonic", harmonic_rows())
        write_study(folder / "ida", ida_rows())
    return folder


@pytest.fixture(scope="module")
def results(folder):
    return load_results(folder)


@pytest.fixture(scope="module")
def drawn(results):
    """{name: Figure} of all figures of the results."""
    return {name: draw() for name, draw in study_figures._figures(results)}


@pytest.fixture(scope="module")
def harmonic(results):
    (variant,) = variants(results.points[results.points["motion_period_s"].notna()])
    return variant


@pytest.fixture(scope="module")
def ida(results):
    (variant,) = variants(results.points[results.points["record"].notna()])
    return variant


def text(figure):
    """All text of a figure: title, panels, legends."""
    panels = [
        getattr(ax, side).get_text()
        for ax in figure.axes
        for side in ("title", "_left_title", "_right_title")
    ]
    legends = [entry.get_text() for legend in figure.legends for entry in legend.get_texts()]
    return "\n".join([figure._suptitle.get_text(), *panels, *legends])


def panel(figure, title):
    (found,) = (ax for ax in figure.axes if title in ax.get_title(loc="left"))
    return found


def medians(ax, colour):
    """x, y, lower and upper end of the range of the points with error bars in one colour."""
    (bars,) = (
        container
        for container in ax.containers
        if to_rgba(container[0].get_color()) == to_rgba(colour)
    )
    ends = np.array([segment[:, 1] for segment in bars[2][-1].get_segments()])
    return bars[0].get_xdata(), bars[0].get_ydata(), ends[:, 0], ends[:, 1]


def hollow(ax, colour):
    (found,) = (
        line
        for line in ax.lines
        if line.get_markerfacecolor() == "none"
        and len(line.get_xdata())
        and to_rgba(line.get_markeredgecolor()) == to_rgba(colour)
    )
    return found.get_ydata()


class TestAgainstAmplitude:
    @pytest.mark.parametrize(
        "state, title", [("max", "maximum, 0.33"), ("residual", "residual, 0.33")]
    )
    @pytest.mark.parametrize(
        "slip, prefix", [("displacement", ""), ("shear-limit", "shear_limit_")]
    )
    def test_medians_ranges_and_single_runs_are_the_tables(
        self, results, harmonic, state, title, slip, prefix
    ):
        ax = panel(against_amplitude(results, harmonic, slip), title)
        for name, colour in (("DI", BLACK), ("DI_slip", BLUE)):
            column = f"{state}_{prefix}{name}"
            rows = harmonic.reference[harmonic.reference["motion_period_s"] == 0.33]
            x, median, low, high = medians(ax, colour)
            # moved aside by less than 1 %
            assert_allclose(x, AMPLITUDES_G, atol=0.01 * max(AMPLITUDES_G))
            assert_allclose(
                np.array([median, low, high]), rows[[column, f"{column}_min", f"{column}_max"]].T
            )
            single = harmonic.yade.loc[harmonic.yade["motion_period_s"] == 0.33, column]
            assert_allclose(hollow(ax, colour), single)

    @pytest.mark.parametrize("column", [{"collapsed_at_s": 1.0}, {"collapsed": 1}])
    def test_a_collapse_is_crossed_out(self, results, harmonic, column):
        points = harmonic.reference.assign(**column)
        figure = against_amplitude(results, type(harmonic)("small", {}, points, harmonic.yade))
        crosses = [line for line in panel(figure, "maximum, 0.2").lines if line.get_marker() == "x"]
        assert sorted(len(line.get_xdata()) for line in crosses) == [0, len(AMPLITUDES_G)]
        assert "collapsed" in text(figure)


class TestOverTime:
    def test_the_last_full_cycle_is_marked_with_its_duration(self, results, harmonic):
        """At resonance: the period nearest to the wall's 0.19 s; a drift of six samples a cycle."""
        figure = drifts(results, harmonic)
        assert len(figure.axes) == len(AMPLITUDES_G) and "motion of 0.2 s" in text(figure)
        (red,) = (
            line
            for line in figure.axes[0].lines
            if to_rgba(line.get_color()) == to_rgba(VERMILLION)
        )
        assert red.get_linestyle() == "--"
        # whole samples of 10 ms inside it
        assert np.ptp(red.get_xdata()) == pytest.approx(0.06, abs=0.0101)
        assert "T = 0.06 s" in text(figure)


class TestRecords:
    def test_spectra_are_those_of_the_windowed_record_times_the_scale(self, results, ida):
        figure = records(results, ida.points)
        ax = figure.axes[3]  # of the second row
        motion = Recorded(read_record(shipped_record_path("BGAR_HGE")), window_s=(17, 25)).motion[0]
        for line, scale in zip(ax.lines, SCALES):
            assert_allclose(line.get_ydata(), scale * response_spectrum(motion, line.get_xdata()))
        assert_allclose(figure.axes[2].lines[0].get_ydata(), motion.acceleration_m_s2 / GRAVITY)
        assert "Zeerijp, BGAR east, PGA 0.111 g" in text(figure)


class TestIda:
    def test_residuals_against_pga(self, ida):
        ax = panel(residual_against_pga(ida), "BGAR")
        rows = ida.reference[ida.reference["record"] == "BGAR_HGE"]
        x, median, _, high = medians(ax, BLUE)
        assert_allclose(x, rows["pga_g"], atol=0.01 * 0.2)
        assert_allclose(median, rows["residual_DI_slip"])
        assert_allclose(high, rows["residual_DI_slip_max"])

    def test_the_trend_line_is_the_parabola_of_all_records(self, ida):
        ax = panel(against_drift(ida), "maximum")
        (trend,) = (line for line in ax.lines if to_rgba(line.get_color()) == to_rgba(BLUE))
        assert_allclose(trend.get_ydata(), parabola(trend.get_xdata()))
        assert "R² = 1.00" in ax.get_title(loc="left")

    def test_a_trend_is_never_negative_and_says_that_it_was_held(self, ida):
        rows = ida.reference.assign(
            residual_DI=np.clip(
                ida.reference["residual_DI"] - 0.6 * ida.reference["residual_DI"].max(), 0, None
            )
        )
        ax = panel(against_drift(type(ida)("small", {}, rows, ida.yade.iloc[:0])), "residual")
        (trend,) = (line for line in ax.lines if to_rgba(line.get_color()) == to_rgba(BLUE))
        free = np.polynomial.Polynomial.fit(100 * rows["max_drift_ratio"], rows["residual_DI"], 2)
        assert free(trend.get_xdata()).min() < 0 <= trend.get_ydata().min()
        assert "trend held at 0 or above" in ax.get_title(loc="left")


class TestParabola:
    @pytest.mark.parametrize(
        "y",
        [
            np.clip(np.linspace(-1, 1, 12), 0, None),
            np.linspace(-1, 1, 12) ** 4,
            np.linspace(1, -1, 12) ** 3 * 1e-3,
            [1, 0.2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3],
        ],
    )
    def test_one_that_is_held_is_the_best_of_those_nowhere_negative(self, y):
        x, y = np.linspace(0.03, 0.2, 12), np.asarray(y)
        trend, held = nonnegative_parabola(x, y)
        t, along = (x - 0.03) / 0.17, np.linspace(0, 1, 401)
        assert held and trend(0.03 + 0.17 * along).min() >= 0
        # the same problem as a quadratic programme with a constraint at every one of many places
        # (of values up to 1, as its solver violates constraints by an absolute amount)
        unit = y / np.max(np.abs(y))
        best = minimize(
            lambda p: np.sum((np.vander(t, 3) @ p - unit) ** 2),
            np.zeros(3),
            method="SLSQP",
            options={"ftol": 1e-14, "maxiter": 500},
            constraints={"type": "ineq", "fun": lambda p: np.vander(along, 3) @ p},
        )
        cost = np.sum((trend(x) - y) ** 2) / np.max(np.abs(y)) ** 2
        assert cost == pytest.approx(best.fun, rel=1e-4)


class TestResults:
    def test_yade_goes_with_the_reference_points_modelled_alike(self, tmp_path):
        rows = harmonic_rows() + [
            row | {"point": row["point"] + "n"} for row in harmonic_rows(lintel="none")[:2]
        ]
        write_study(tmp_path / "harmonic", rows)
        found = variants(load_results(tmp_path).points)
        assert [
            (variant.differs, len(variant.reference), len(variant.yade)) for variant in found
        ] == [({}, 6, 6), ({"lintel": "none"}, 1, 1)]
        assert (
            found[1].file_part == "small_lintel-none"
            and found[1].title == "small wall, lintel none"
        )

    def test_what_a_solver_did_for_two_studies_counts_once(self, tmp_path, results):
        points = results.points[results.points["motion_period_s"].notna()]
        both = pd.concat(
            [points.assign(folder=tmp_path / name) for name in ("crosscheck", "harmonic")],
            ignore_index=True,
        )
        both = both.drop(index=len(points))  # one that crosscheck alone has
        found = type(results)(both, results.runs).of_studies(
            ("harmonic", "crosscheck"), both["wall"].notna()
        )
        assert len(found) == len(points) and not found.duplicated(["point", "solver"]).any()
        assert sorted(folder.name for folder in found["folder"]) == ["crosscheck"] + [
            "harmonic"
        ] * (len(points) - 1)


def stars(figure):
    """{start of the panel's title: (x, y)} of the values of the paper's text."""
    return {
        ax.get_title(loc="left")[:3]: tuple(map(float, (*line.get_xdata(), *line.get_ydata())))
        for ax in figure.axes
        for line in ax.lines
        if line.get_marker() == "*"
    }


class TestPaper:
    """What the paper's text prints stands beside our values, of the wall and the records that it is
    about."""

    def test_index_cycle_residual_and_record(self, results, harmonic, ida):
        harmonic, ida = (replace(one, wall="symmetric") for one in (harmonic, ida))
        figure = against_amplitude(results, harmonic)
        assert stars(figure) == {"(c)": (0.1, 0.13)} and "printed in the paper's text" in text(
            figure
        )
        said = text(drifts(results, harmonic))
        assert [said.count(f", paper {s} s") for s in ("0.20", "0.24", "0.39")] == [1, 1, 1]
        assert stars(residual_against_pga(ida)) == {"(a)": (0.16, 0.11)}
        figure = records(results, ida.points)
        assert stars(figure) == {"(b)": (0.2, 0.15), "(d)": (0.2, 0.15)}
        assert "(paper 0.08)" in text(figure) and "PGA 0.111 g (paper 0.11)" in text(figure)


class TestKeptTables:
    """Tables of points alone, as in docs/tables."""

    def test_what_needs_no_history_is_drawn_and_the_rest_named(self, folder, tmp_path, monkeypatch):
        for study in ("harmonic", "ida"):
            shutil.copy(folder / study / "tables" / "points.csv", tmp_path / f"{study}_points.csv")
        results = load_results(tmp_path)
        assert len(results.points) == len(load_results(folder).points) and len(results.runs) == 0
        monkeypatch.setattr(
            study_figures, "save_figures", lambda pairs, folder, made: [pairs[0][1]]
        )
        made = dict(study_figures.make_figures(results, tmp_path))
        missing = {name.split("_")[0] for name, of in made.items() if isinstance(of, str)}
        assert missing == {"fig07", "fig09", "fig10", "cracks"} and all(
            "it needs the study's own folder" in of for of in made.values() if isinstance(of, str)
        )
        _, y, *_ = medians(panel(made["fig11_residual_small"][0], "Zeerijp"), BLACK)
        kept = results.points[
            (results.points["record"] == "BGAR_HGE") & (results.points["solver"] == "reference")
        ]
        assert_allclose(y, kept["residual_DI"])

    def test_the_tables_that_ship_draw_figures_8_11_and_12(self):
        results = load_results(REPOSITORY / "docs" / "tables")
        names = [name for name, _ in study_figures._figures(results)]
        assert {
            "fig08_amplitude_symmetric",
            "fig11_residual_symmetric",
            "fig12_drift_asymmetric",
        } <= {*names}
        points = results.of_studies(
            ("ida", "crosscheck"),
            results.points["record"].notna() & (results.points["shocks"] == 1),
        )
        variant = next(one for one in variants(points) if one.wall == "symmetric")
        figure = residual_against_pga(variant)
        assert (
            len(variant.reference) == 16
            and len(variant.yade)
            and stars(figure) == {"(a)": (0.16, 0.11)}
        )


class TestCommand:
    def test_every_figure_of_the_results_can_be_drawn(self, drawn):
        assert list(drawn) == [
            "fig06_motions",
            "fig07_evolution_small",
            "fig08_amplitude_small",
            "fig08_amplitude_small_shear-limit",
            "fig09_drift_small",
            "cracks_harmonic_small",
            "fig10_records",
            "fig11_residual_small",
            "fig12_drift_small",
            "fig11_residual_small_shear-limit",
            "fig12_drift_small_shear-limit",
            "cracks_ida_small",
        ]

    def test_runs_without_an_end_are_left_out_and_named(self, results, tmp_path, monkeypatch):
        points = results.points.copy()
        points.loc[points["point"] == "h0.2-0.1", "status"] = "failed"
        monkeypatch.setattr(
            study_figures, "save_figures", lambda pairs, folder, made: [pairs[0][1]]
        )
        monkeypatch.setattr(study_figures, "_ida", lambda results: ())
        made = dict(study_figures.make_figures(type(results)(points, results.runs), tmp_path))
        assert "is failed" in made["point h0.2-0.1"]
        x, *_ = medians(panel(made["fig08_amplitude_small"][0], "maximum, 0.2"), BLACK)
        assert_allclose(x, AMPLITUDES_G[:2], atol=0.001)
