"""Figures of studies, from the tables that ship and from two points with histories."""

import numpy as np
import pytest
from conftest import REPOSITORY
from matplotlib.colors import to_rgba
from numpy.testing import assert_allclose
from scipy.optimize import minimize

from damage.draw.style import BLUE
from paper import figures as study_figures
from paper.harmonic_figures import against_amplitude
from paper.ida_figures import nonnegative_parabola, residual_against_pga
from paper.results import Missing, load_results, variants

TABLES = REPOSITORY / "docs" / "tables"
NEED_HISTORIES = {"fig07", "fig09", "fig10", "cracks", "sequences"}


def drawn(results):
    """{first word of its name: Figure, or why it is missing} of one figure of each kind."""
    figures = {}
    for name, draw in study_figures._figures(results):
        kind = name.partition("_")[0]
        if kind not in figures:
            try:
                figures[kind] = draw()
            except Missing as missing:
                figures[kind] = str(missing)
    return figures


@pytest.fixture(scope="module")
def shipped():
    return load_results(TABLES)


def test_tables_that_ship_are_drawn_and_what_needs_histories_is_named(shipped):
    figures = drawn(shipped)
    missing = {kind for kind, figure in figures.items() if isinstance(figure, str)}
    assert missing == NEED_HISTORIES
    assert figures.keys() - missing == {"fig06", "fig08", "fig11", "fig12", "sensitivity"}
    assert all(ax.has_data() for kind in figures.keys() - missing for ax in figures[kind].axes)


def test_medians_ranges_and_printed_values_are_those_of_the_tables(shipped):
    points = shipped.of_studies(
        ("ida", "crosscheck"), shipped.points["record"].notna() & (shipped.points["shocks"] == 1)
    )
    assert not points.duplicated(["point", "solver"]).any()
    variant = next(one for one in variants(points) if one.wall == "symmetric" and not one.differs)
    assert len(variant.reference) == 16 and len(variant.yade)
    figure = residual_against_pga(variant)
    ax = next(ax for ax in figure.axes if "BGAR" in ax.get_title(loc="left"))
    (bars,) = (one for one in ax.containers if to_rgba(one[0].get_color()) == to_rgba(BLUE))
    rows = variant.reference[variant.reference["record"].str.startswith("BGAR")]
    rows = rows.sort_values("pga_g")
    assert_allclose(bars[0].get_ydata(), rows["residual_DI_slip"])
    ends = np.array([segment[:, 1] for segment in bars[2][-1].get_segments()])
    assert_allclose(ends, rows[["residual_DI_slip_min", "residual_DI_slip_max"]])
    assert printed(figure) == [(0.16, 0.11)]
    harmonic = shipped.points[shipped.points["motion_period_s"].notna()]
    symmetric = next(one for one in variants(harmonic) if one.wall == "symmetric")
    assert (0.1, 0.13) in printed(against_amplitude(shipped, symmetric))


def printed(figure):
    """(x, y) of the values of the paper's text."""
    return [
        (line.get_xdata()[0], line.get_ydata()[0])
        for ax in figure.axes
        for line in ax.lines
        if line.get_marker() == "*"
    ]


@pytest.mark.parametrize(
    "y",
    [
        np.linspace(-1, 1, 12) ** 4,
        np.linspace(1, -1, 12) ** 3 * 1e-3,
        np.array([1, 0.2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3]),
    ],
)
def test_a_trend_that_is_held_is_the_best_of_those_nowhere_negative(y):
    """The same problem as a quadratic programme with a constraint at each of many places, of values
    up to 1, as its solver violates constraints by an absolute amount."""
    x = np.linspace(0.03, 0.2, 12)
    trend, held = nonnegative_parabola(x, y)
    t = (x - 0.03) / 0.17
    along = np.linspace(0, 1, 401)
    assert held and trend(0.03 + 0.17 * along).min() >= 0
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
