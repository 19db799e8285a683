"""Part of the page on a run: moving wall, lines over time, summary, and notes before its
results."""

import numpy as np
import pandas as pd

from damage.applications.report.packing import as_png, pack_arrays, quantised
from damage.applications.report.plain import plain
from damage.applications.studies.spread import members_in_words, spread_of
from damage.draw.preview import wall_preview
from damage.draw.run import ENERGIES, pictures_beside, wall_picture
from damage.draw.style import BODY_COLOURS
from damage.draw.wall import magnification
from damage.draw.words import run_title
from damage.history.in_space import motion_of
from damage.history.info import info
from damage.history.moments import (
    JOINT_STATES,
    joint_states,
    nearest,
    nearest_snapshot,
    spans_of,
    support_motion,
)
from damage.history.schema import is_moving
from damage.index import COMPONENTS
from damage.measure.energy import energy_groups
from damage.measure.evidence import QUANTITIES, describe
from damage.measure.results import KEY, SCALES, result_of, value_in
from damage.measure.summary import summarise
from damage.measure.tables import summary_row
from damage.units import GRAVITY
from damage.wall.geometry import cuts_of_lintels, kinds_of_bodies, tributary_ends

SERIES = (*COMPONENTS, "drift_ratio", "base_shear_kn", "base_x_g", "base_z_g", *ENERGIES)
"""Lines over time that the file holds of each run."""


def run_part(history, letter, language="en"):
    """Everything about one History, a dictionary for the page; letter: what the page calls the run;
    language: of its summary.

    Raises InputError of a file without a sample.
    """
    summary = summarise(history)
    index = history.index()
    row = summary_row(history)
    part = {
        "letter": letter,
        "title": run_title(history),
        "history": history,
        "file": history.path.name,
        "first": said_first(history, summary["warnings"]),
        "summary": summary,
        "evidence": _evidence(summary["evidence"]),
        "row": row,
        "info": info(history),
        "plain": plain(history, summary, row, language),
        "key": _key_numbers(history, summary),
        "scales": SCALES,
        "still": still(history),
        "preview": preview(history),
        "beside": {name: as_png(draw(history)) for name, draw in pictures_beside(history).items()},
        "drawn": drawn(history, index),
    }
    return part | {"words": in_words(part)}


def _evidence(evidence):
    """{"line", "rows"} of the evidence for a run: in one line, and for each quantity name, value,
    range and whether it is inside."""
    ranges = {quantity.name: quantity.range for quantity in QUANTITIES}
    return {
        "line": describe(evidence),
        "rows": [
            {
                "name": name,
                "range": ranges[name],
                "where": {True: "inside", False: "outside"}.get(quantity["inside"], ""),
                "value": (
                    "does not apply"
                    if quantity["inside"] is None
                    else f"{quantity['value']:.3g} {quantity['unit']}"
                ),
            }
            for name, quantity in evidence.items()
        ],
    }


def still(history):
    """The wall at its largest DI as a picture, for who has no scripts, and until the moving one is
    drawn."""
    return as_png(wall_picture(history))


def preview(history):
    """The wall as it was built, with its masses, elastic joints and names of piers and spandrels,
    as a picture."""
    supports = support_motion(history, None)
    return as_png(wall_preview(history.plan, history.bodies, history.joints, supports))


def said_first(history, warnings=()):
    """Notes on a History before its results, a list of str; empty where there are none."""
    until = history.time_s[-1]
    lines = {
        "complete": [],
        "interrupted": [
            f"interrupted at {until:.3f} s, before the run's end; every maximum is one so far"
        ],
        "failed": [f"failed at {until:.3f} s: do not rely on what is shown"],
        "unfinished": [
            f"without an end: a run writes the file now, or was killed. It reaches to {until:.3f}"
            " s; every maximum is one so far"
        ],
    }[history.status]
    if history.collapsed_at_s is not None:
        lines.append(
            f"collapsed at {history.collapsed_at_s:.3f} s: maxima are those until the run's end, "
            "residuals the state then"
        )
    if history.parameters.get("repeats"):
        lines.append(
            f"repeated {history.parameters['repeats']} times in smaller steps, last for its "
            f"{history.parameters['repeated_for']} (docs/validation/step-and-damping.md)"
        )
    return [*lines, *warnings]


def _key_numbers(history, summary):
    """(label, value, the value in the digits that are known, unit, what else is said) of what one
    asks first; of a run with members their median and range, too."""
    members = spread_of(history) or {}
    cards = []
    for column in (*KEY, "settled_psi"):
        result = result_of(column)
        value = value_in(summary, column)
        if value is not None:
            more = [result.remark.format(**summary, whole="")]
            if column in members:
                more.append(f"{members['count']} members: {members_in_words(members, column)}")
            shown = result.factor * value, result.shown(value), result.unit
            cards.append((result.label, *shown, "; ".join(filter(None, more))))
    return cards


# --- what is drawn --------------------------------------------------------------------------------


def drawn(history, index):
    """Numbers for the drawings: {"arrays", "packed"} of `pack_arrays`, and lists and numbers
    besides."""
    chosen = instants(history, index)
    lines = _lines(history, index)
    indices = points(np.array([lines[name] for name in SERIES]), chosen)
    wall, more = _moving_wall(history, chosen)
    arrays = {name: values[indices].astype("f4") for name, values in lines.items()}
    settling, settlement = (
        (history.series["stage"] == stage).to_numpy()[indices]
        for stage in ("settling", "settlement")
    )
    settles = settling | settlement if is_moving(history.series).any() else settling
    arrays |= {
        "instant": np.searchsorted(indices, chosen).astype("i4"),
        "settles": settles.astype("u1"),
        **wall,
    }
    time_s = lines["time_s"]
    return (
        more
        | pack_arrays(arrays)
        | {
            "settling": spans_of(time_s[indices], settling),
            "settlement": spans_of(time_s[indices], settlement),
            "collapsed_at_s": history.collapsed_at_s,
            # as precise as the times that it is compared with
            "at_max": float(np.float32(time_s[int(np.argmax(index["DI"]))])),
            "n_instants": len(chosen),
        }
    )


def _lines(history, index):
    """{"time_s" and names of SERIES: (n_times,)} in the units of the drawings."""
    series = history.series
    columns = {
        "time_s": series["time_s"],
        "base_shear_kn": series["base_shear_n"] / 1e3,
        **{f"base_{axis}_g": series[f"base_acceleration_{axis}_m_s2"] / GRAVITY for axis in "xz"},
        **energy_groups(series),
    }
    columns |= {
        name: index[name] if name in index else series[name]
        for name in SERIES
        if name not in columns
    }
    return {name: np.asarray(values) for name, values in columns.items()}


def _moving_wall(history, chosen):
    """Arrays of the wall at the chosen samples, and what goes with them.

    Of contact points only those that are not intact in all of them, and the elastic ones;
    displacements, of the bodies and then of the supports, are those of the nearest snapshot, none
    where none is near, in steps of a 32767th of the largest.
    """
    states = np.array([joint_states(history, sample) for sample in chosen])
    ever = np.flatnonzero((states != JOINT_STATES.index("intact")).any(axis=0))
    width = np.hypot(
        history.opening_m[chosen][:, ever], history.offset_m[chosen][:, ever], dtype=float
    )
    near = [nearest_snapshot(history, time) for time in history.time_s[chosen]]
    motion = np.nan_to_num([motion_of(history, snapshot) for snapshot in near])
    supports = [support_motion(history, snapshot) for snapshot in near]
    places, step = quantised(
        np.concatenate([motion, [support.motion for support in supports]], axis=1)
    )
    bodies = history.bodies
    ends = tributary_ends(history.joints)
    elastic = np.setdiff1d(
        np.flatnonzero(history.joints["elastic"] & ~cuts_of_lintels(history.joints, bodies)), ever
    )
    arrays = {
        **{name: bodies[f"{name}_m"].astype("f4") for name in ("x", "z", "length", "height")},
        "kind": pd.Categorical(kinds_of_bodies(bodies["course"]), BODY_COLOURS).codes.astype("u1"),
        "ends": ends[ever].astype("f4").ravel(),
        "elastic_ends": ends[elastic].astype("f4").ravel(),
        **{
            f"{prefix}{name}": history.joints[f"{name}_body"].iloc[joints].astype("i4")
            for prefix, joints in (("elastic_", elastic), ("", ever))
            for name in ("first", "second")
        },
        "head": history.joints["kind"].iloc[ever].isin(("head", "brick")).astype("u1"),
        "place": places.ravel(),
        "support_x": ((supports[0].left + supports[0].right) / 2).astype("f4"),
        "snapshot": np.array([snapshot is not None for snapshot in near], "u1"),
        "state": states[:, ever].astype("u1").ravel(),
        "width_um": (
            np.nan_to_num(width / 1e-6).clip(0, np.iinfo("u2").max).round().astype("u2").ravel()
        ),
    }
    largest = motion[int(np.argmax(np.abs(motion[..., :2]).max(axis=(1, 2))))]
    return arrays, {
        "step": step.tolist(),
        "n_joints": len(history.joints),
        "n_ever": len(ever),
        "n_elastic": len(elastic),
        "magnify": magnification(bodies, largest),
    }


# --- in words -------------------------------------------------------------------------------------


def in_words(part):
    """{drawing: what it shows, for who cannot see it}."""
    history = part["history"]
    shown = part["drawn"]
    series = history.series
    shear_kn = series["base_shear_n"] / 1e3
    drift_pct = 100 * series["drift_ratio"]
    spans = (
        f"drift from {drift_pct.min():.3g} to {drift_pct.max():.3g} %, base shear from"
        f" {shear_kn.min():.3g} to {shear_kn.max():.3g} kN"
    )
    return {
        "wall": (
            f"Moving drawing of the {history.wall} wall, {history.attributes['length_m']:g} m long"
            f" and {history.attributes['height_m']:g} m high. Of its {shown['n_joints']} contact"
            f" points {shown['n_ever']} break in this run, {shown['n_elastic']} are elastic and"
            f" cannot fail. DI is largest at {shown['at_max']:.3f} s. The line below says what it"
            " shows."
        ),
        "hysteresis": f"Base shear against drift ratio: {spans}.",
        "energy": "Energies over time; a table below has them at the end.",
    }


MOST_INSTANTS = 300
"""Instants of the moving picture of a run, the special ones aside."""
MOST_POINTS = 6000
"""Points of a line over time; of a longer run the smallest and largest of each stretch are kept."""


def instants(history, index):
    """Samples of a History that its moving picture shows, rising: snapshots, evenly chosen, and the
    special ones.

    index: `History.index` of it.
    """
    time_s = history.time_s
    at_snapshots = np.searchsorted(time_s, history.snapshot_time_s).clip(0, len(time_s) - 1)
    every = at_snapshots if len(at_snapshots) else np.arange(len(time_s))
    chosen = every[
        np.linspace(0, len(every) - 1, min(len(every), MOST_INSTANTS)).round().astype(int)
    ]
    return np.unique(np.concatenate([chosen, special_samples(history, index)]))


def special_samples(history, index):
    """Samples of a History with an extreme value, of the first failure, the collapse, the first and
    the last one."""
    series = history.series
    time_s = history.time_s
    drift = np.nan_to_num(series["drift_ratio"].to_numpy())
    samples = [
        0,
        len(time_s) - 1,
        *(np.argmax(index[name]) for name in COMPONENTS),
        np.argmax(drift),
        np.argmin(drift),
        np.argmax(np.abs(np.nan_to_num(series["base_shear_n"]))),
        *(np.argmax(np.abs(field).max(axis=1)) for field in (history.opening_m, history.offset_m)),
    ]
    moments = [history.collapsed_at_s, *history.events["time_s"][history.events["time_s"] >= 0][:1]]
    samples += [nearest(time_s, moment) for moment in moments if moment is not None]
    return np.array(samples)


def points(lines, needed):
    """Samples that lines over time are drawn from, rising: all, or extremes of stretches, and those
    needed.

    lines: (n_lines, n_times); needed: samples.
    """
    n_times = lines.shape[1]
    if n_times <= MOST_POINTS:
        return np.arange(n_times)
    stretches = max(MOST_POINTS // (2 * len(lines)), 1)
    edges = np.linspace(0, n_times, stretches + 1).astype(int)
    lines = np.nan_to_num(lines)
    extremes = [
        first + pick(lines[:, first:last], axis=1)
        for first, last in zip(edges, edges[1:])
        for pick in (np.argmin, np.argmax)
    ]
    return np.unique(np.concatenate([*extremes, needed]))
