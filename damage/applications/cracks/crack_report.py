"""Results of `python3 -m damage cracks`: cracks of a history, of a crack file or of a DIC field."""

from pathlib import Path

import h5py
import numpy as np
import pandas as pd

from damage.applications.cracks.crack_file import patterns_of, read_cracks, write_cracks
from damage.applications.cracks.crack_mapping import describe_level, largest, map_cracks
from damage.applications.cracks.dic import (
    MARGIN,
    field_warnings,
    measure,
    patterns_of_fields,
    read_field,
)
from damage.applications.cracks.dic import report as dic_report
from damage.applications.cracks.plausible import implausible_places, implausible_width
from damage.errors import InputError, warn
from damage.history.moments import choose_samples
from damage.history.reader import read_history
from damage.index import COMPONENTS
from damage.measure.cracks import cracks_at, ends_of, psi, psi_summary
from damage.units import MILLIMETRE
from damage.wall.file import load_wall
from damage.wall.layout import lay_out

SAME_NUMBERS = 5e-5
"""Bounds closer than this are printed as one number."""


def crack_report(asked):
    """(report, what `crack_pictures` draws) of the command's parsed options: of a history, a crack
    file or a DIC field.

    Options that do not belong to what there is are refused; of a history without `out` nothing is
    drawn.
    """
    if (asked.source is None) == (asked.dic is None):
        raise InputError(
            "expected one of FILE and --dic FIELD.csv; give a history, a crack file or a field"
        )
    limits = {
        "threshold": asked.threshold_mm * MILLIMETRE,
        "drift_limit": asked.drift_limit_pct / 100,
        "psi_from": asked.psi_from_mm * MILLIMETRE,
    }
    if asked.dic:
        _only_with("a DIC field", asked, "wall", without=("at", "tolerance_mm"))
        margin = MARGIN if asked.margin_mm is None else asked.margin_mm * MILLIMETRE
        report, *drawn = field_report(asked.dic, asked.wall, margin, export=asked.export, **limits)
    elif Path(asked.source).suffix == ".h5" or h5py.is_hdf5(asked.source):
        _only_with("a history", asked, without=("wall", "tolerance_mm", "margin_mm"))
        history = read_history(asked.source)
        if asked.export:
            history.check_one_layer()
        samples = choose_samples(history, ("max,end" if asked.at is None else asked.at).split(","))
        report = history_report(history, samples, export=asked.export, **limits)
        drawn = None
        if asked.out:
            layout = lay_out(history.masonry_wall, history.model)
            patterns = patterns_of(history, samples, limits["threshold"])
            drawn = [map_cracks(pattern, layout) for pattern in patterns], patterns, layout
    else:
        _only_with("a crack file", asked, "wall", without=("at", "export", "margin_mm"))
        patterns = read_cracks(asked.source)
        layout = lay_out(load_wall(asked.wall))
        warn(*_implausible(patterns, layout.wall))
        tolerance = asked.tolerance_mm and asked.tolerance_mm * MILLIMETRE
        report, mapped = pattern_report(patterns, layout, tolerance=tolerance, **limits)
        drawn = mapped, patterns, layout
    return report, drawn


def _implausible(patterns, wall):
    """What is implausible of the places and widths of CrackPatterns: a list of lines."""
    drawn = [pattern.stretches for pattern in patterns if len(pattern.stretches)]
    if not drawn:
        return []
    stretches = pd.concat(drawn)
    widths = implausible_width(stretches["width_m"].max() / MILLIMETRE)
    return list(filter(None, [implausible_places(ends_of(stretches), wall), widths]))


def _only_with(what, asked, needed=None, without=()):
    """Refuse options that do not belong to `what`, and a missing one that does."""
    if needed and getattr(asked, needed) is None:
        raise InputError(f"{what} needs --{needed}; give it, as in --wall walls/solid.py")
    for name in without:
        if getattr(asked, name) is not None:
            raise InputError(f"--{name.replace('_', '-')} does not belong to {what}; leave it out")


def history_report(history, samples, threshold, drift_limit, psi_from, export):
    """The cracks of a History at samples (indices), a dictionary; written to `export` if it is
    given."""
    index = history.index(threshold, drift_limit)
    width = np.hypot(history.opening_m, history.offset_m)
    levels = []
    for number, sample in enumerate(samples, start=1):
        table = cracks_at(history, sample, threshold)
        levels.append(
            {
                "load_level": float(number),
                "time_s": float(history.time_s[sample]),
                "drift_pct": 100 * float(history.series["drift_ratio"].iloc[sample]),
                "cracks": int(table["crack"].nunique()),
                "crack_length_m": float(table["length_m"].sum()),
                "max_width_mm": float(width[sample].max() / MILLIMETRE),
                "psi": psi(cracks_at(history, sample, psi_from)),
                **{name: (float(index[name].iloc[sample]),) * 2 for name in COMPONENTS},
            }
        )
    if export:
        moments_s = ", ".join(f"{level['time_s']:.6g}" for level in levels)
        least = min(threshold, psi_from)
        write_cracks(
            export,
            patterns_of(history, samples, least),
            [
                (
                    f"cracks of {history.wall}, {history.loading.name}, solver {history.solver}, at"
                    f" {moments_s} s"
                ),
                (
                    f"joints whose width reaches {least / MILLIMETRE:g} mm;"
                    " docs/reference/crack-format.md"
                ),
            ],
        )
    run = psi_summary(history, psi_from) | {"psi_from_mm": psi_from / MILLIMETRE}
    report = _report(
        history.wall,
        "simulation",
        total_m=float(history.joint_length_m.sum()),
        levels=levels,
        threshold=threshold,
        psi_from=psi_from,
    )
    return report | {"run": run, "notes": []}


def _report(wall, source, total_m, levels, threshold, psi_from):
    """What all reports have, a dictionary; total_m: length of the joints [m]."""
    return {
        "wall": wall,
        "source": source,
        "threshold_mm": threshold / MILLIMETRE,
        "psi_from_mm": psi_from / MILLIMETRE,
        "total_joint_length_m": total_m,
        "levels": levels,
        "max": largest(levels),
    }


def pattern_report(patterns, layout, threshold, drift_limit, psi_from, tolerance=None):
    """The results of CrackPatterns on a Layout, a dictionary, and their MappedCracks."""
    mapped = [map_cracks(pattern, layout, tolerance) for pattern in patterns]
    limits = {"threshold": threshold, "psi_from": psi_from}
    levels = [
        describe_level(pattern, cracks, layout, drift_limit=drift_limit, **limits)
        for pattern, cracks in zip(patterns, mapped)
    ]
    total_m = layout.total_joint_length
    report = _report(layout.wall.name, "digitised cracks", total_m, levels, **limits)
    return report | {"notes": list(_notes(levels))}, mapped


def field_report(path, wall, margin, threshold, drift_limit, psi_from, export):
    """`pattern_report` of the cracks that the DIC field at `path` shows, written to `export` if
    given."""
    fields = read_field(path)
    layout = lay_out(load_wall(wall))
    measured = measure(fields, layout, margin)
    warn(*field_warnings(fields, measured, layout, margin))
    patterns = patterns_of_fields(fields, measured, layout, min(threshold, psi_from))
    report, mapped = pattern_report(patterns, layout, threshold, drift_limit, psi_from)
    limits = dic_report(measured, layout)
    notes = list(_dic_notes(limits, threshold, psi_from))
    report |= {"source": "DIC field", "dic": limits, "notes": notes + report["notes"]}
    if export:
        write_cracks(
            export,
            patterns,
            [
                (
                    f"cracks of {layout.wall.name} from the DIC field {Path(path).name}; "
                    "docs/reference/crack-format.md"
                ),
                *notes,
            ],
        )
    return report, mapped, patterns, layout


def _notes(levels):
    """Notes on the levels, a line each."""
    for level in levels:
        where = f"level {level['load_level']:g}: "
        if level["undecided_m"] > 0:
            yield (
                where
                + f"{level['undecided_m']:.3f} m of cracks give their width only: tension and shear"
                " cannot be distinguished there, and DI_open, DI_slip and DI lie between the"
                " bounds shown"
            )
        if level["drift_pct"] is None:
            yield where + "drift unknown: DI is that of the cracks alone"
        if level["unmapped_m"] > 5e-4:
            yield (
                where + f"{level['unmapped_m']:.3f} m of cracks lie on no joint (through bricks, or"
                " beside the wall): only psi_drawn counts them"
            )
        if level["surplus_m"] > 5e-4:
            yield (
                where
                + f"{level['surplus_m']:.3f} m drawn over joints beyond the joints' own length: not"
                " counted"
            )


def _dic_notes(limits, threshold, psi_from):
    millimetres = {name: value / MILLIMETRE for name, value in limits.items()}
    yield (
        "noise of a point {noise_m:.4f} mm, which leaves a standard deviation of"
        " {opening_deviation_m:.4f} mm to a joint's opening".format(**millimetres)
    )
    yield (
        "elastic deformation is contained: up to {elastic_opening_m:.4f} mm of opening before a"
        " joint breaks, about {elastic_slip_m:.4f} mm of slip".format(**millimetres)
    )
    if 3 * limits["opening_deviation_m"] > threshold:
        yield (
            f"warning: three standard deviations exceed the threshold of {threshold / MILLIMETRE:g}"
            " mm; noise counts as cracks: measure more finely, or raise --threshold-mm"
        )
    most = (
        max(limits["elastic_opening_m"], limits["elastic_slip_m"])
        + 3 * limits["opening_deviation_m"]
    )
    if most > psi_from:
        yield (
            f"warning: noise and elastic deformation make up to {most / MILLIMETRE:.4f} mm, and Psi"
            f" counts cracks from {psi_from / MILLIMETRE:g} mm: measure more finely, or raise"
            " --psi-from-mm"
        )
    if limits["unseen_m"] > 0:
        yield (
            f"{limits['unseen_m']:.3f} m of joints lie at bricks with too few points: they count as"
            " uncracked"
        )


_COLUMNS = (
    ("level", "load_level", "{:g}"),
    ("time s", "time_s", "{:.3f}"),
    ("drift %", "drift_pct", "{:.4f}"),
    ("cracks", "cracks", "{:d}"),
    ("length m", "crack_length_m", "{:.3f}"),
    ("unmapped m", "unmapped_m", "{:.3f}"),
    ("width mm", "max_width_mm", "{:.3f}"),
    ("Psi", "psi", "{:.2f}"),
    ("Psi drawn", "psi_drawn", "{:.2f}"),
    ("DI", "DI", "{:.4f}"),
    ("DI_drift", "DI_drift", "{:.4f}"),
    ("DI_open", "DI_open", "{:.4f}"),
    ("DI_slip", "DI_slip", "{:.4f}"),
)


def describe(report):
    """A report as lines for people; bounds stand as low..high."""
    levels = report["levels"]
    columns = [column for column in _COLUMNS if column[1] in levels[0]]
    if len(levels) > 1:
        levels = [*levels, {"load_level": "max"} | report["max"]]
    rows = [[label for label, *_ in columns]]
    rows += [[_shown(level.get(key, ""), form) for _, key, form in columns] for level in levels]
    widths = [max(map(len, column)) for column in zip(*rows)]
    lines = [
        f"{report['wall']}: {report['source']}, threshold {report['threshold_mm']:g} mm, "
        f"Psi from {report['psi_from_mm']:g} mm, "
        f"{report['total_joint_length_m']:.3f} m of joints"
    ]
    lines += ["  ".join(cell.rjust(width) for cell, width in zip(row, widths)) for row in rows]
    if "run" in report:
        run = report["run"]
        residual = run["residual_psi"]
        lines.append(
            f"whole run: Psi up to {run['max_psi']:.2f}, widths up to"
            f" {run['max_crack_width_mm']:.3f} mm"
            + (
                ""
                if residual is None
                else f"; in the end {residual:.2f}, {run['residual_crack_width_mm']:.3f} mm"
            )
        )
    return "\n".join(lines + [f"note: {note}" for note in report["notes"]])


def _shown(value, form):
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    if isinstance(value, tuple):
        low, high = value
        return (
            form.format(high)
            if high - low < SAME_NUMBERS
            else f"{form.format(low)}..{form.format(high)}"
        )
    return form.format(value)
