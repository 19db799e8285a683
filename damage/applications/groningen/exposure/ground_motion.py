"""Ground-motion models: the distribution of PGV at a place in an earthquake.

A model is a class with the attributes and the method of `GroundMotionModel`, in a file of its own
in `damage/applications/groningen/exposure/models`, where `model_named` finds it by the file's name.
"""

import math
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri

from damage.checks import check_choice
from damage.errors import InputError, did_you_mean
from damage.files import DATA

VS30_M_S = (50.0, 2000.0)
"""Bounds of the mean shear-wave velocity of the upper 30 m [m/s]: soil and rock."""


class Deviations(NamedTuple):
    """Standard deviations of ln PGV: tau of events, phi_s2s of sites, phi_ss of what remains."""

    tau: float
    phi_s2s: float
    phi_ss: float

    @property
    def sigma(self):
        """Total standard deviation of ln PGV."""
        return math.sqrt(sum(value**2 for value in self))


class GroundMotionModel:
    """Base of ground-motion models: ln PGV = ln median + event term + site term + within-event
    term.

    The three terms are independent and normal, with the Deviations of the component: the first is
    drawn once an event, the second once a site, the third once an event and site.
    source: the publication; components: {name: meaning}; default: the component that is used if
    none is asked for; coefficients: {component: {column: value}} in the columns of the publication,
    with tau, phi_s2s, phi_ss.
    """

    source: str
    components: Mapping
    default: str
    coefficients: Mapping

    def __init__(self, component=None):
        """component: one of `components`, None for the default.  Raises InputError for any
        other."""
        self.component = component or self.default
        check_choice("component", self.component, tuple(self.components))
        self.values = self.coefficients[self.component]
        self.deviations = Deviations(*(self.values[name] for name in Deviations._fields))

    def median_mm_s(self, magnitude, epicentral_km, vs30_m_s):
        """Median PGV [mm/s] by magnitude [-], epicentral distance [km] and VS30 [m/s], arrays whose
        shapes broadcast, or numbers."""
        raise NotImplementedError

    def exceeded_mm_s(self, median_mm_s, probability):
        """PGV [mm/s] that is exceeded with a probability, by its median."""
        return median_mm_s * math.exp(-ndtri(probability) * self.deviations.sigma)

    def exceedance(self, median_mm_s, pgv_mm_s):
        """Probability of exceeding a PGV [mm/s], by its median."""
        return ndtr(-np.log(pgv_mm_s / median_mm_s) / self.deviations.sigma)

    def draw(self, random, draws, events, sites=1):
        """Terms of ln PGV at random: (event, site, within-event), shapes (draws, events, 1),
        (draws, 1, sites) and (draws, events, sites); their sum is what ln PGV deviates from its
        median.  random: damage.draws.Draws."""
        shapes = (draws, events, 1), (draws, 1, sites), (draws, events, sites)
        return tuple(
            scale * random.normal(math.prod(shape)).reshape(shape)
            for scale, shape in zip(self.deviations, shapes)
        )


def model_named(name, component=None):
    """The model of a name, for a component.  Raises InputError where there is none."""
    files = (Path(__file__).parent / "models").glob("[!_]*.py")
    names = sorted(path.stem.replace("_", "-") for path in files)
    if name not in names:
        raise InputError(
            f"ground-motion model {name!r}: expected one of"
            f" {', '.join(names)}{did_you_mean(name, names)}"
        )
    return import_module(
        f"damage.applications.groningen.exposure.models.{name.replace('-', '_')}"
    ).Model(component)


COMPONENTS = DATA / "zeerijp_20180108" / "components.csv"
"""Horizontal components of the Zeerijp earthquake that ship: the README beside it says how the
columns were made."""
