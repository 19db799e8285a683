"""The code of plotly.js that draws in the file, from the Python package plotly, which ships it."""

import re
import warnings
from functools import cache

from damage.html.packing import pack_text


@cache
def plotly_code():
    """The whole code; ImportError where the package is missing."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # older ones ask for what newer Pythons deprecate
        from plotly.offline import get_plotlyjs
    return get_plotlyjs()


@cache
def packed_plotly():
    """The code as the page holds it."""
    return pack_text(plotly_code())


def plotly_version():
    """Its version as it says itself, "unknown" where it does not."""
    found = re.search(r"plotly\.js v(\d[\w.-]*)", plotly_code()[:1000])
    return found[1] if found else "unknown"
