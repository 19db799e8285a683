"""Places in the Netherlands: in the Dutch grid (RD New, EPSG:28992) and in WGS84.

Between them two polynomials each way convert, good to about 0.5 m, by F. H. Schreutelkamp and G. L.
Strang van Hees (2001), Benaderingsformules voor de transformatie tussen RD- en
WGS84-kaartcoördinaten, Geodesia 43, 64-69.  No library converts in their place where it is
installed: the lives of an address are the same on every machine.
"""

import math
from dataclasses import dataclass

import numpy as np

from damage.checks import check_range
from damage.errors import InputError

NETHERLANDS_RD_M = (0.0, 300e3), (300e3, 630e3)
"""Bounds of easting and northing in RD [m]."""
NETHERLANDS_DEG = (50.5, 53.8), (3.0, 7.5)
"""Bounds of latitude and longitude [degrees], a little wider than the country."""
TOWNS_DEG = {
    "Groningen": (53.219, 6.567),
    "Winsum": (53.330, 6.520),
    "Bedum": (53.300, 6.602),
    "Uithuizen": (53.407, 6.676),
    "Ten Boer": (53.276, 6.694),
    "Loppersum": (53.333, 6.748),
    "Hoogezand": (53.162, 6.761),
    "Slochteren": (53.221, 6.806),
    "Appingedam": (53.321, 6.858),
    "Delfzijl": (53.330, 6.918),
    "Veendam": (53.106, 6.879),
    "Winschoten": (53.144, 7.037),
    "Assen": (52.997, 6.562),
}
"""Latitude and longitude of towns in and around the field, to about 1 km, for maps [degrees,
WGS84]."""

_ORIGIN_RD, _ORIGIN_DEG = (155000.0, 463000.0), (52.15517440, 5.38720621)  # Amersfoort
# (power of the first, power of the second, coefficient)
_LATITUDE = (
    (0, 1, 3235.65389),
    (2, 0, -32.58297),
    (0, 2, -0.2475),
    (2, 1, -0.84978),
    (0, 3, -0.0655),
    (2, 2, -0.01709),
    (1, 0, -0.00738),
    (4, 0, 0.0053),
    (2, 3, -0.00039),
    (4, 1, 0.00033),
    (1, 1, -0.00012),
)
_LONGITUDE = (
    (1, 0, 5260.52916),
    (1, 1, 105.94684),
    (1, 2, 2.45656),
    (3, 0, -0.81885),
    (1, 3, 0.05594),
    (3, 1, -0.05607),
    (0, 1, 0.01199),
    (3, 2, -0.00256),
    (1, 4, 0.00128),
    (0, 2, 0.00022),
    (2, 0, -0.00022),
    (5, 0, 0.00026),
)
_EASTING = (
    (0, 1, 190094.945),
    (1, 1, -11832.228),
    (2, 1, -114.221),
    (0, 3, -32.391),
    (1, 0, -0.705),
    (3, 1, -2.34),
    (1, 3, -0.608),
    (0, 2, -0.008),
    (2, 3, 0.148),
)
_NORTHING = (
    (1, 0, 309056.544),
    (0, 2, 3638.893),
    (2, 0, 73.077),
    (1, 2, -157.984),
    (3, 0, 59.788),
    (0, 1, 0.433),
    (2, 2, -6.439),
    (1, 1, -0.032),
    (0, 4, 0.092),
    (1, 4, -0.054),
)


@dataclass(frozen=True)
class Place:
    """A place: x_m, y_m in RD [m], latitude, longitude in WGS84 [degrees].  Made by `at` or
    `at_rd`."""

    x_m: float
    y_m: float
    latitude: float
    longitude: float


def at(latitude, longitude):
    """The Place of a latitude and a longitude [degrees, WGS84].  Raises InputError outside the
    Netherlands."""
    bounds = NETHERLANDS_DEG
    if within(bounds, longitude, latitude):
        raise InputError(
            f"--at {latitude:g} {longitude:g}: expected the latitude first, then the longitude;"
            " exchange them"
        )
    if not within(bounds, latitude, longitude):
        raise InputError(
            f"--at {latitude:g} {longitude:g}: expected a latitude from {bounds[0][0]:g} to"
            f" {bounds[0][1]:g} and a longitude from {bounds[1][0]:g} to {bounds[1][1]:g} degrees,"
            " in the Netherlands; correct it"
        )
    x, y = to_rd(latitude, longitude)
    return Place(float(x), float(y), float(latitude), float(longitude))


def at_rd(x_m, y_m):
    """The Place of an easting and a northing in RD [m].  Raises InputError outside the
    Netherlands."""
    for name, value, bounds in zip(("easting", "northing"), (x_m, y_m), NETHERLANDS_RD_M):
        check_range(f"--rd, {name} [m]", value, *bounds)
    latitude, longitude = to_wgs84(x_m, y_m)
    return Place(float(x_m), float(y_m), float(latitude), float(longitude))


def within(bounds, first, second):
    """Whether two numbers are within two pairs of bounds; flags where they are arrays."""
    return np.logical_and.reduce(
        [
            (least <= value) & (value <= most)
            for value, (least, most) in zip((first, second), bounds)
        ]
    )


def to_rd(latitude, longitude):
    """Easting and northing in RD [m] of latitudes and longitudes [degrees, WGS84], numbers or
    arrays."""
    p, q = (
        0.36 * (np.asarray(value) - origin)  # in units of 10 000 seconds of arc from Amersfoort
        for value, origin in zip((latitude, longitude), _ORIGIN_DEG)
    )
    return tuple(
        origin + _polynomial(terms, p, q)
        for origin, terms in zip(_ORIGIN_RD, (_EASTING, _NORTHING))
    )


def to_wgs84(x_m, y_m):
    """Latitude and longitude [degrees, WGS84] of eastings and northings in RD [m], numbers or
    arrays."""
    p, q = (
        1e-5 * (np.asarray(value) - origin)  # in units of 100 km from Amersfoort
        for value, origin in zip((x_m, y_m), _ORIGIN_RD)
    )
    return tuple(
        origin + _polynomial(terms, p, q) / 3600
        for origin, terms in zip(_ORIGIN_DEG, (_LATITUDE, _LONGITUDE))
    )


def _polynomial(terms, p, q):
    total = 0.0
    for i, j, factor in terms:
        total = total + math.prod([p] * i + [q] * j, start=factor)
    return total
