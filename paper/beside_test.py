"""Pictures of laboratory walls (`python3 -m paper specimens`): simulated envelopes beside the
test's, and the index against the drift."""

import numpy as np
from matplotlib.lines import Line2D

from damage.applications.cracks.capacity import capacity_curve, cycles_table, pushed_loading
from damage.applications.cracks.pushed import SPECIMENS, read_test
from damage.draw.panels import add_heading, finish, grid, letter
from damage.draw.run import DRIFT_LIMITS_PCT
from damage.draw.style import (
    BLACK,
    BLUE,
    GREEN,
    MEDIUM,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    save_figures,
    styled,
)
from damage.errors import InputError
from damage.history.info import origin

RUN_LOOKS = (
    (BLUE, "-", "o"),
    (ORANGE, "--", "s"),
    (GREEN, "-.", "^"),
    (PURPLE, ":", "D"),
    (SKY, (0, (5, 1)), "v"),
)
"""Colour, line and marker of each run, so that runs are distinguishable in grey, too."""
SIDES = ((1, 0), (-1, 1))  # direction of loading, its place in a test's pairs


def test_of(history):
    """The LaboratoryTest that a run's wall models; InputError where it models none."""
    if history.wall not in SPECIMENS:
        raise InputError(
            f"{history.path}: wall {history.wall} models no test; expected one of"
            f" {', '.join(SPECIMENS)}"
        )
    return read_test(SPECIMENS[history.wall])


@styled
def beside_test_picture(histories):
    """Figure of pushed Histories of one specimen: loops and envelopes beside the test's bilinear
    idealisation and peak, and the index at the largest drift of every cycle beside published
    limits."""
    tests = {test_of(history).specimen: test_of(history) for history in histories}
    if len(tests) != 1:
        raise InputError(f"runs of {len(tests)} specimens ({', '.join(tests)}); give runs of one")
    test = next(iter(tests.values()))
    figure, ((left, right),) = grid(1, 2, 2.9, width_ratios=(1.25, 1))
    cyclic = any(pushed_loading(history).cycles for history in histories)
    handles = [
        _draw_run(left, right, history, *look) for history, look in zip(histories, RUN_LOOKS)
    ]
    handles += _draw_test(left, test, SIDES if cyclic else SIDES[:1])
    handles += [
        right.axvline(drift, color=VERMILLION, lw=0.8, ls=line, label=label)
        for drift, label, line in DRIFT_LIMITS_PCT
    ]
    # What was simulated and the test's peaks; its long plateau may continue beyond.
    largest = max(history.series["drift_ratio"].abs().max() for history in histories)
    reach = 115 * max(*test.drift_at_peak, largest)
    left.axhline(0, color=MEDIUM, lw=0.4, zorder=0)
    left.axvline(0, color=MEDIUM, lw=0.4, zorder=0)
    left.set(
        xlabel="drift ratio [%]",
        ylabel="base shear [kN]",
        xlim=(-reach if cyclic else -0.05 * reach, reach),
    )
    right.set(
        xlabel="largest drift ratio to either side [%]", ylabel="DI at that instant", ylim=(0, None)
    )
    right.set_xlim(0, 1.05 * (100 * largest))
    letter(left, 0, "envelopes, and loops of cyclic runs" if cyclic else "pushed over")
    letter(right, 1, "damage index")
    add_heading(
        figure, f"{test.specimen}: simulated and measured; failure in the test: {test.mode}"
    )
    return finish(figure, handles, columns=2)


def _draw_run(left, right, history, colour, line, marker):
    series, loading = history.series, pushed_loading(history)
    cyclic, solver = loading.cycles > 0, "YADE" if history.solver == "yade" else history.solver
    if cyclic:
        left.plot(
            100 * series["drift_ratio"],
            series["base_shear_n"] / 1e3,
            color=colour,
            lw=0.3,
            alpha=0.5,
        )
    for sign in (1, -1) if cyclic else (1,):
        curve = capacity_curve(history, sign)
        left.plot(
            100 * sign * curve["drift_ratio"],
            sign * curve["force_n"] / 1e3,
            color=colour,
            lw=1.3,
            ls=line,
        )
    if cyclic:
        table = cycles_table(history)
        drift = np.column_stack([table["max_drift_pct"], -table["min_drift_pct"]]).ravel()
        index = table[["DI_at_max", "DI_at_min"]].to_numpy().ravel()
        right.plot(drift, index, color=colour, marker=marker, ms=3, lw=0.7, ls=line)
    else:
        right.plot(
            100 * series["drift_ratio"].abs(), history.index()["DI"], color=colour, lw=1.1, ls="--"
        )
    joints = "softening" if history.masonry_wall.joint.softens else "brittle"
    way = "cyclic" if cyclic else "pushover"
    return Line2D(
        [],
        [],
        color=colour,
        lw=1.3,
        ls=line,
        marker=marker if cyclic else "",
        ms=3,
        label=f"{history.wall}, {joints}, {solver}, {way} {1e3 * loading.speed_m_s:g} mm/s",
    )


def _draw_test(ax, test, sides):
    for sign, side in sides:
        force = test.bilinear_force_n[side]
        drift = np.array([0.0, test.elastic_drift[side], test.ultimate_drift[side]])
        force = np.array([0.0, force, force])
        lines = ax.plot(
            100 * sign * drift,
            sign * force / 1e3,
            color=BLACK,
            lw=1.1,
            ls="--",
            label="test, bilinear idealisation",
        )
        lines += ax.plot(
            100 * sign * test.drift_at_peak[side],
            sign * test.peak_force_n[side] / 1e3,
            color=BLACK,
            marker="*",
            ms=7,
            ls="",
            zorder=5,
            label="test, peak force",
        )
    return lines


def save(histories, folder):
    """Write the picture of each specimen among the Histories as PNG and PDF into a folder; returns
    the paths."""
    by_specimen, histories = {}, list(histories)
    for history in histories:
        by_specimen.setdefault(test_of(history).specimen, []).append(history)
    return save_figures(
        [
            (f"{specimen}_beside_test", beside_test_picture(runs))
            for specimen, runs in by_specimen.items()
        ],
        folder,
        "\n".join(map(origin, histories)),
    )
