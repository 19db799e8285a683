"""Arrays and pictures as text that a browser unpacks: gzip, then base64."""

import base64
import gzip
import io

import numpy as np
from PIL import Image


def pack_arrays(arrays):
    """{"packed": all arrays of {name: array} one after the other, "arrays": {name: [type, first
    byte, length]}}.

    Types are numpy's, little-endian: f4, i4, i2, u2, u1.

    >>> pack_arrays({"a": np.array([1, 2], "u1"), "b": np.array([0.5], "f4")})["arrays"]
    {'a': ['u1', 0, 2], 'b': ['f4', 8, 1]}
    """
    data = bytearray()
    places = {}
    for name, array in arrays.items():
        data += bytes(-len(data) % 8)  # so that a browser can look at an array in place
        values = np.asarray(array)
        places[name] = [values.dtype.str[1:], len(data), values.size]
        data += values.astype(values.dtype.newbyteorder("<")).tobytes()
    return {
        "packed": base64.b64encode(gzip.compress(bytes(data), 9, mtime=0)).decode("ascii"),
        "arrays": places,
    }


def quantised(values):
    """int16 of values (n, ..., k), and the step of each of the k columns: values are step times
    these numbers."""
    largest = np.abs(values).reshape(-1, values.shape[-1]).max(axis=0, initial=0.0)
    step = np.where(largest > 0, largest, 1.0) / np.iinfo(np.int16).max
    return np.round(values / step).astype("i2"), step


def fewer_colours(image, colours=64):
    """A Pillow image in fewer colours, rare ones as well; in 64 a third as large as a file."""
    return image.convert("RGB").quantize(
        colours, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE
    )


def as_png(figure, dots_per_inch=150, colours=64):
    """A matplotlib Figure as PNG of so many colours in base64."""
    buffer = io.BytesIO()
    small = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dots_per_inch, bbox_inches="tight")
    fewer_colours(Image.open(buffer), colours).save(small, "PNG", optimize=True)
    return base64.b64encode(small.getvalue()).decode("ascii")
