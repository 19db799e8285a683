"""The code of plotly.js that draws in the file: its partial bundle `basic`, which holds all that is drawn here.

`page/plotly-basic.min.js` is what its makers publish, unchanged (MIT licence, beside it):

    npm pack plotly.js-basic-dist-min@4.1.1

The whole library, which the Python package plotly ships, makes reports 2 MB larger and takes twice as long to draw.
"""

import re
from functools import cache
from pathlib import Path

PAGE = Path(__file__).parent / "page"
"""The template of the page, its style, its program and this library."""


@cache
def plotly_code():
    """The code of plotly.js, text."""
    return (PAGE / "plotly-basic.min.js").read_text(encoding="utf-8")


def plotly_version():
    """Version of plotly.js, from its code.

    >>> plotly_version()
    '4.1.1'
    """
    return re.search(r"plotly\.js \(basic - minified\) v([\d.]+)", plotly_code())[1]
