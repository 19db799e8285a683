"""Comparison picture of two histories: drift over time, and agreement of the joints."""

from textwrap import fill

import numpy as np

from damage.applications.cracks.compare import (
    compare_drift,
    compare_joints,
    joint_keys,
    joints_ever,
)
from damage.draw import style
from damage.draw.run import DASHES, JOINT_COLOURS, THIN
from damage.draw.words import run_title
from damage.wall.geometry import tributary_ends

JOINTS = {  # agreement of a joint: (label, colour, line width [pt])
    "intact": ("intact in both", "0.85", 0.25),
    "same": ("failed in both, same state", style.BLACK, 1.4),
    "other": ("failed in both, other state", style.ORANGE, 1.4),
    "first": ("failed in the first only", style.VERMILLION, 1.4),
    "second": ("failed in the second only", style.BLUE, 1.4),
}


@style.styled
def compare_picture(first, second):
    """Figure of two Histories of one wall: drift over time above, agreement of the joints below."""
    ratio = first.attributes["height_m"] / first.attributes["length_m"]
    figure, (above, below) = style.new_figure(
        1.6 + style.COLUMN_WIDTH * ratio, rows=2, height_ratios=(1.3, style.COLUMN_WIDTH * ratio)
    )
    lines = _draw_drift(above, first, second)
    agreement = joint_agreement(first, second)
    elastic = first.joints["elastic"].to_numpy(bool) & (agreement == "intact")
    segments = tributary_ends(first.joints)
    handles = []
    for state, (label, colour, width) in JOINTS.items():
        chosen = (agreement == state) & ~elastic
        style.add_lines(below, segments[chosen], colour, width)
        entry = f"{label}: {chosen.sum()} points"
        handles.append(style.line_handle(colour, entry, max(width, 0.8)))
    below.autoscale_view()
    below.set(aspect="equal", xlabel="x [m]", ylabel="z [m]")
    how = JOINT_COLOURS["elastic"], THIN["elastic"]
    style.add_lines(below, segments[elastic], *how, label="elastic", linestyles=DASHES["elastic"])
    joints = compare_joints(first, second)
    kappa = (
        "nothing failed"
        if joints["kappa"] is None
        else (
            f"{joints['broke_in_both']} of {joints['broke_in_either']} joints failed in both, kappa"
            f" {joints['kappa']:.2f}"
        )
    )
    style.put_title(figure, run_title(first), kappa)
    if elastic.any():
        entry = f"elastic, cannot fail: {elastic.sum()} points"
        handles.append(style.line_handle(JOINT_COLOURS["elastic"], entry, 0.8, DASHES["elastic"]))
    style.legend_below(figure, lines + handles, columns=2)
    style.settle_layout(figure)
    return figure


def joint_agreement(first, second):
    """Agreement of the contact points of the first History with the second, (n_joints,) keys of
    JOINTS.

    The contact points between two bricks are one joint, so that discretisations may differ.
    """
    here = joints_ever(first)
    second_states = joints_ever(second)
    both = here["broken"] & second_states["broken"]
    kinds = np.select(
        [
            both & (here["state"] == second_states["state"]),
            both,
            here["broken"],
            second_states["broken"],
        ],
        ["same", "other", "first", "second"],
        default="intact",
    )
    by_pair = dict(zip(here.index, kinds))
    return np.array([by_pair[pair] for pair in zip(*joint_keys(first))])


def _draw_drift(ax, first, second):
    lines = []
    factor, unit = style.drift_scale(
        *(history.series["drift_ratio"] for history in (first, second))
    )
    for history, label, colour, width in zip(
        (first, second), run_labels(first, second), (style.VERMILLION, style.BLUE), (1.4, 0.7)
    ):
        lines += ax.plot(
            history.time_s,
            factor * history.series["drift_ratio"],
            label=label,
            color=colour,
            lw=width,
        )
    drift = compare_drift(first, second)
    for time, label, line in (
        (drift["first_failure_s"], "first failure", ":"),
        (drift["diverged_at_s"], "diverged by 1 % of the peak", "--"),
    ):
        if time is not None:
            lines.append(ax.axvline(time, color=style.MEDIUM, lw=0.8, ls=line, label=label))
    ax.margins(x=0)
    style.plain_numbers(ax.yaxis)
    ax.set(xlabel="time [s]", ylabel=f"drift ratio [{unit}]")
    return lines


def run_labels(first, second):
    """Different labels of two Histories for a legend: their solvers, else their files, else files
    with folders."""
    pair = (first, second)
    names = [history.solver for history in pair]
    if names[0] == names[1]:
        parts = 1 if first.path.stem != second.path.stem else 2
        names = [
            f"{history.solver}, {'/'.join(history.path.with_suffix('').parts[-parts:])}"
            for history in pair
        ]
    return [
        fill(f"{which}: {name}", style.TITLE_CHARACTERS // 2)
        for which, name in zip(("first", "second"), names)
    ]
