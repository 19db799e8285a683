"""Part of the page on a house: its walls in one table and in pictures, corners, energies."""

from damage.applications.report.packing import as_png
from damage.draw.house import elevation_picture, space_picture, walls_picture
from damage.draw.words import run_title
from damage.measure.house import house_summary
from damage.measure.results import CORNERS, WALLS, result_of, value_in


def house_part(history, summaries):
    """Everything about the History of a house, a dictionary for the page; summaries: {name of a
    wall: `damage.measure.summary.summarise`}."""
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
        "history": history,
        "heads": [result_of(column).heading for column in WALLS],
        "walls": [
            (name, [_cell(result_of(column), value_in(summary, column)) for column in WALLS])
            for name, summary in summaries.items()
        ],
        "corner_heads": [result.heading for result in CORNERS.values()],
        "corners": [
            (name, [_cell(result, corner[key]) for key, result in CORNERS.items()])
            for name, corner in house_summary(history, summaries)["corners"].items()
        ],
        "pictures": [
            (as_png(figure, colours=256), alt, caption) for figure, alt, caption in pictures
        ],
    }


def _cell(result, value):
    """A value of a Result as a cell of the page: (text, number or None)."""
    return result.shown(value), None if value is None else repr(float(result.factor * value))
