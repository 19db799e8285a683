"""Figures and documents in the folder of a study, for the page."""

import base64

import numpy as np
from matplotlib.image import imread

from damage.applications.report.packing import as_png
from damage.errors import InputError

MOST_DOCUMENT_MB = 0.2
"""Largest size of a document that is shown."""
MOST_FIGURES_MB = 0.3
"""Largest size of all embedded figures; others are listed by name."""
FIGURE_WORDS = {
    "fig06": "The harmonic motions that shook the walls",
    "fig07": "Damage index and its components over time",
    "fig08": "Damage index against the amplitude of the motion",
    "fig09": "Drift over time by amplitude",
    "fig10": "The records that shook the walls, with their spectra",
    "fig11": "Residual damage against peak acceleration",
    "fig12": "Damage index against the largest drift",
    "cracks": "Cracked joints of the walls of single runs",
    "sequences": "Damage over sequences of shocks",
    "sensitivity": "How much modelling choices move the damage",
    "life": "Lives of a wall: damage over the years, and the events that caused it",
    "fragility": "Probability of exceeding levels of damage against intensity",
}


def figures(folder):
    """{"embedded": [figure], "named": [paths that are too large to embed]} of the PNG files of a
    study.

    They are looked for in its folders `figures` and `pictures` and in itself; pictures of single
    runs are left out.
    """
    places = folder / "figures", folder / "pictures", folder
    paths = [path for place in places for path in sorted(place.glob("*.png"))]
    embedded = []
    named = []
    left = MOST_FIGURES_MB * 1e6
    for path in paths:
        if path.stat().st_size > left:
            named.append(path.relative_to(folder).as_posix())
        else:
            left -= path.stat().st_size
            embedded.append(_embedded(path))
    return {"embedded": embedded, "named": named}


def _embedded(path):
    """One figure: name, data, width and height [px], what it shows in words."""
    try:
        height, width = imread(path).shape[:2]
    except (OSError, ValueError, SyntaxError) as error:
        raise InputError(
            f"{path} cannot be read as a picture ({error}); expected a PNG file, draw it again"
        ) from error
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return _figure(path.stem, data, width, height)


def _figure(name, data, width, height):
    words = figure_words(name)
    return {"name": name, "data": data, "width": width, "height": height, "words": words}


def figure_words(name):
    """Caption of a figure, from its name.

    >>> figure_words("fig12_drift_symmetric"), figure_words("mine")
    ('Damage index against the largest drift (fig12_drift_symmetric)', 'Figure mine')
    """
    caption = next((text for start, text in FIGURE_WORDS.items() if name.startswith(start)), None)
    return f"{caption} ({name})" if caption else f"Figure {name}"


def drawn(name, figure):
    """A matplotlib Figure as an embedded figure; width and height give its aspect ratio only."""
    return _figure(name, as_png(figure), *np.round(100 * figure.get_size_inches()).astype(int))


def documents(folder):
    """[(name, text)] of the documents that programs made of a folder's tables, as `conclusion` of a
    study does."""
    return [
        (path.stem, path.read_text(encoding="utf-8", errors="replace"))
        for path in sorted((folder / "tables").glob("*.md"))
        if path.stat().st_size < MOST_DOCUMENT_MB * 1e6
    ]
