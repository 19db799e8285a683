"""Part of the page on a house: its walls in one table and in pictures, corners, energies."""

from damage.applications.report.packing import as_png
from damage.applications.report.tables import cell
from damage.draw.house import elevation_picture, space_picture, walls_picture
from damage.draw.words import run_title
from damage.measure.house import house_summary

WALLS = (
    ("maximum DI", ("max", "DI"), 1.0),
    ("residual DI", ("residual", "DI"), 1.0),
    ("drift along [%]", ("max_drift_ratio",), 100.0),
    ("drift across [%]", ("max_drift_across_ratio",), 100.0),
    ("Psi outside", ("max_psi_outside",), 1.0),
    ("Psi inside", ("max_psi_inside",), 1.0),
    ("widest crack outside [mm]", ("max_crack_width_outside_mm",), 1.0),
    ("inside [mm]", ("max_crack_width_inside_mm",), 1.0),
)
"""(heading, keys of a wall's summary, factor)."""
CORNERS = {
    "max_opening_mm": "widest opening [mm]",
    "residual_opening_mm": "at the end [mm]",
    "max_offset_mm": "largest offset [mm]",
    "failed_share": "failed bonds [share]",
}


def house_part(history, summaries):
    """Everything about the History of a house, a dictionary for the page; summaries: {name of a
    wall: `damage.measure.summary.summarise`}."""
    found = house_summary(history, summaries)
    pictures = (
        (
            elevation_picture(history),
            "All walls unfolded, with the cracks of both faces",
            "Above from outside, below from inside, each face seen from in front of it.",
        ),
        (
            space_picture(history),
            "The house at the largest DI of a wall",
            "Displacements are exaggerated; cracks of the faces that are seen.",
        ),
        (
            walls_picture(history),
            "Walls and corners over time",
            "Drift is that of a wall's top over its height, along the wall and across it.",
        ),
    )
    return {
        "title": run_title(history),
        "file": history.path.name,
        "status": found["status"],
        "heads": [name for name, _, _ in WALLS],
        "walls": [
            (name, [cell(_at(one, keys, factor)) for _, keys, factor in WALLS])
            for name, one in summaries.items()
        ],
        "corner_heads": list(CORNERS.values()),
        "corners": [
            (name, [cell(one[key]) for key in CORNERS]) for name, one in found["corners"].items()
        ],
        "pictures": [
            (as_png(figure, colours=256), alt, caption) for figure, alt, caption in pictures
        ],
        "wall_files": [part.path.name for part in history.parts],
    }


def _at(summary, keys, factor):
    """A value of a summary by its keys times a factor, None where there is none."""
    for key in keys:
        summary = None if summary is None else summary[key]
    return None if summary is None else factor * summary
