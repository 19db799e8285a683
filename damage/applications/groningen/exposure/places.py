"""Places in the Netherlands: in the Dutch grid (RD New, EPSG:28992) and in WGS84.

Between them two polynomials each way convert, good to about 0.5 m, by F. H. Schreutelkamp and G. L.
Strang van Hees (2001), Benaderingsformules voor de transformatie tussen RD- en
WGS84-kaartcoördinaten, Geodesia 43, 64-69.  No library converts in their place where it is
installed: the lives of an address are the same on every machine.
"""

import math
from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.checks import check_range
from damage.errors import InputError
from damage.files import DATA

NETHERLANDS_RD_M = (0.0, 300e3), (300e3, 630e3)
"""Bounds of easting and northing in RD [m]."""
NETHERLANDS_DEG = (50.5, 53.8), (3.0, 7.5)
"""Bounds of latitude and longitude [degrees], a little wider than the country."""
TOWNS = DATA / "groningen" / "towns.csv"
"""Latitude and longitude of towns in and around the field, to about 1 km, for maps [degrees,
WGS84]."""
_TERMS = {
    name: list(terms[["i", "j", "factor"]].itertuples(index=False, name=None))
    for name, terms in pd.read_csv(
        DATA / "groningen" / "rd_wgs84.csv", float_precision="round_trip"
    ).groupby("of")
}
"""{result: [(power of the first, power of the second, coefficient)]}."""
# Amersfoort
_ORIGIN_RD = (155000.0, 463000.0)
_ORIGIN_DEG = (52.15517440, 5.38720621)


class Place(NamedTuple):
    """A place: x_m, y_m in RD [m], latitude, longitude in WGS84 [degrees].  Made by
    `at_degrees` or `at_rd`."""

    x_m: float
    y_m: float
    latitude: float
    longitude: float


def at_degrees(latitude, longitude):
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
        origin + _polynomial(name, p, q)
        for origin, name in zip(_ORIGIN_RD, ("easting", "northing"))
    )


def to_wgs84(x_m, y_m):
    """Latitude and longitude [degrees, WGS84] of eastings and northings in RD [m], numbers or
    arrays."""
    p, q = (
        1e-5 * (np.asarray(value) - origin)  # in units of 100 km from Amersfoort
        for value, origin in zip((x_m, y_m), _ORIGIN_RD)
    )
    return tuple(
        origin + _polynomial(name, p, q) / 3600
        for origin, name in zip(_ORIGIN_DEG, ("latitude", "longitude"))
    )


def _polynomial(name, p, q):
    total = 0.0
    for i, j, factor in _TERMS[name]:
        total = total + math.prod([p] * i + [q] * j, start=factor)
    return total
