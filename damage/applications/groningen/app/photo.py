"""Photographs that someone uploads: checked, without their metadata, and seen straight from the
front."""

import io
import warnings

import numpy as np

from damage.errors import InputError

MOST_BYTES = 20_000_000
"""Largest size of an upload [bytes]."""
MOST_PIXELS = 50_000_000
"""Largest number of pixels of an upload."""
LONGEST_PX = 4000
"""Longest side of a picture, to which longer ones are made smaller [pixels]."""
FORMATS = "JPEG", "PNG"
MARGIN_M = 0.1
"""Margin that is shown around the wall [m]."""
# of a rectified picture: its longer side, and pixels in a metre
_MOST_PX = 2400
_MOST_PX_M = 400
_LEAST_SHARE = 1e-4  # of the picture's area that four points have to enclose


def cleaned(data):
    """The bytes of a photograph as JPEG: turned as its metadata say, and without them.

    Raises InputError where it is larger than it may be, or no picture of FORMATS.
    """
    from PIL import Image, ImageOps

    try:
        if len(data) > MOST_BYTES:
            raise ValueError
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            picture = Image.open(io.BytesIO(data), formats=FORMATS)
            if picture.width * picture.height > MOST_PIXELS:
                raise ValueError
            upright = ImageOps.exif_transpose(picture).convert("RGB")
    except Exception as error:  # of a damaged file Pillow raises many kinds
        raise InputError(
            f"the photograph cannot be read; expected {' or '.join(FORMATS)} of up to"
            f" {MOST_BYTES / 1e6:g} MB and {MOST_PIXELS / 1e6:g} million pixels; save it as such"
        ) from error
    upright.thumbnail((LONGEST_PX, LONGEST_PX))
    return _as_jpeg(Image.frombytes("RGB", upright.size, upright.tobytes()))  # pixels alone


def _as_jpeg(picture):
    file = io.BytesIO()
    picture.save(file, "JPEG", quality=90)
    return file.getvalue()


def homography(source, target):
    """The (3, 3) matrix that maps four points (4, 2) of a plane onto four points (4, 2) of another.

    Raises InputError where three of either lie on a line, or they make no convex quadrilateral.
    """
    for points in (source, target):
        signed = turns(points)
        if not (np.all(signed > 0) or np.all(signed < 0)):
            raise InputError(
                "four points that make no convex quadrilateral; expected its corners one after the"
                " other; mark them again"
            )
    rows = []
    for (x, y), (u, v) in zip(source, target):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y], [0, 0, 0, x, y, 1, -v * x, -v * y]]
    return np.append(np.linalg.solve(np.array(rows, float), np.ravel(target)), 1.0).reshape(3, 3)


def turns(points):
    """Twice the signed area at each corner of a quadrilateral (4, 2)."""
    points = np.asarray(points, float)
    edge = np.roll(points, -1, axis=0) - points
    following = np.roll(points, -2, axis=0) - np.roll(points, -1, axis=0)
    return edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0]


def rectified(jpeg, pixels, places, length, height):
    """A photograph (bytes) as JPEG of the plane of a wall of this length and height [m], with
    MARGIN_M around it.

    pixels: four points (4, 2), x and y down from the upper left; places: the same on the wall, x
    and z up (4, 2) [m].
    """
    from PIL import Image

    picture = Image.open(io.BytesIO(jpeg))
    pixels = np.asarray(pixels, float)
    if np.abs(turns(pixels)).min() < _LEAST_SHARE * picture.width * picture.height:
        raise InputError(
            "the four points lie too near each other; expected corners as far apart as can be; mark"
            " them again"
        )
    wide = length + 2 * MARGIN_M
    high = height + 2 * MARGIN_M
    px_m = min(_MOST_PX_M, _MOST_PX / max(wide, high))
    size = round(wide * px_m), round(high * px_m)
    here = [((x + MARGIN_M) * px_m, (height + MARGIN_M - z) * px_m) for x, z in places]
    matrix = homography(here, pixels)
    return _as_jpeg(
        picture.transform(
            size, Image.Transform.PERSPECTIVE, matrix.ravel()[:8], Image.Resampling.BICUBIC
        )
    )
