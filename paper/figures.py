"""Figures from the results of studies: 6 to 12 of Sarhosis et al. (2021),
doi:10.1016/j.engstruct.2021.112529, crack maps, sequences and modelling choices, with what each
needs and its files.

Harmonic motions are taken from folders named harmonic, records from ida, YADE's repetitions from
crosscheck, walls without a lintel from nolintel; where no folder has the name, from all with such
points.
"""

from functools import partial

import pandas as pd

from damage.applications.studies.read import made_by_words
from damage.draw.style import save_figures
from damage.errors import InputError
from paper.harmonic_figures import against_amplitude, drifts, evolution, motions
from paper.ida_figures import against_drift, records, residual_against_pga
from paper.results import REFERENCE, YADE, Missing, variants
from paper.study_figures import choices, crack_maps, sequences

_SLIP_PARTS = {"displacement": "", "shear-limit": "_shear-limit"}
"""Criteria of slip that have figures of their own, and what stands for them in a file's name."""


def make_figures(results, folder):
    """Write all figures that the Results allow; yields (name, paths) or (name, reason why it is
    missing).

    Every figure is a PNG and a PDF in `folder`, which is created where missing.  Points with
    incomplete runs are left out and named.
    """
    ended = results.ended()
    for _, point in results.points.drop(ended.points.index).iterrows():
        yield (
            f"point {point['point']}",
            f"left out, its run in {point['folder']} is {point['status']}",
        )
    for name, draw in _figures(ended):
        if isinstance(draw, str):
            yield name, draw
            continue
        try:
            figure = draw()
        except (Missing, InputError) as error:
            yield name, str(error)
        else:
            yield name, save_figures([(name, figure)], folder, _made_by(ended.points))


def _made_by(points):
    """Origin of the runs of these points, for the metadata of a picture."""
    return (
        f"studies {', '.join(sorted({folder.name for folder in points['folder']}))};"
        f" {made_by_words(points)}"
    )


def _figures(results):
    """(name, function that draws it, or the reason why it cannot be drawn) of every figure."""
    yield from _harmonic(results)
    yield from _ida(results)
    points = results.points[_repeated(results.points)]
    for solver, name in ((REFERENCE, "sequences"), (YADE, "sequences_yade")):
        if (points["solver"] == solver).any():
            yield name, partial(sequences, results, points[points["solver"] == solver])
    varied = (
        results.points["folder"]
        .map(lambda folder: folder.name.startswith("sensitivity"))
        .astype(bool)
    )
    if varied.any():
        yield "sensitivity", partial(choices, results.points[varied])


def _harmonic(results):
    points = _having(results, "harmonic", "motion_period_s", "amplitude_g")
    if len(points) == 0:
        for name in (
            "fig06_motions",
            "fig07_evolution",
            "fig08_amplitude",
            "fig09_drift",
            "cracks_harmonic",
        ):
            yield name, "no point has a harmonic motion; run the study harmonic"
        return
    yield "fig06_motions", partial(motions, points)
    for variant in variants(points):
        part = variant.file_part
        yield f"fig07_evolution_{part}", partial(evolution, results, variant)
        for slip, slip_part in _SLIP_PARTS.items():
            yield (
                f"fig08_amplitude_{part}{slip_part}",
                partial(against_amplitude, results, variant, slip),
            )
        yield f"fig09_drift_{part}", partial(drifts, results, variant)
        yield f"cracks_harmonic_{part}", partial(crack_maps, results, variant)


def _ida(results):
    points = _having(results, "ida", "record", "scale", "pga_g")
    if len(points) == 0:
        for name in ("fig10_records", "fig11_residual", "fig12_drift", "cracks_ida"):
            yield name, "no point has a record with its scale and PGA; run the study ida"
        return
    yield "fig10_records", partial(records, results, points)
    for variant in variants(points):
        part = variant.file_part
        for slip, slip_part in _SLIP_PARTS.items():
            yield f"fig11_residual_{part}{slip_part}", partial(residual_against_pga, variant, slip)
            yield f"fig12_drift_{part}{slip_part}", partial(against_drift, variant, slip)
        yield f"cracks_ida_{part}", partial(crack_maps, results, variant)


def _having(results, study, *columns):
    """Points of a study that are single events and have a value in all these columns."""
    points = results.points
    if not set(columns) <= set(points):
        return points.iloc[:0]
    chosen = points[list(columns)].notna().all(axis=1) & ~_repeated(points)
    return results.of_studies((study, "crosscheck", "nolintel"), chosen)


def _repeated(points):
    """Flags of the points that are sequences of events."""
    return points["shocks"] > 1 if "shocks" in points else pd.Series(False, points.index)
