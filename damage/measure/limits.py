"""Damage classes by published limits of the drift ratio, of Psi and of crack width."""

from dataclasses import dataclass

import numpy as np

from damage.history.schema import Column, measure


@dataclass(frozen=True)
class DamageClasses:
    """Published limits of a measure, in rising order, and the damage classes between them.

    name: column of the table; measure: "drift" (maximum drift ratio), "psi" (maximum Psi) or
    "width" (of the widest crack); bounds: (n,) limits [-], of a width [mm];
    classes: (n + 1,) names, a value equal to a bound is in the upper class; source: publication.
    """

    name: str
    measure: str
    bounds: tuple[float, ...]
    classes: tuple[str, ...]
    source: str

    @property
    def description(self):
        """Text: the classes with the bounds between them, then the source."""
        unit, factor = {"drift": (" %", 100), "psi": ("", 1), "width": (" mm", 1)}[self.measure]
        words = self.classes[0]
        for bound, upper in zip(self.bounds, self.classes[1:]):
            words += f", {factor * bound:.4g}{unit}, {upper}"
        return f"{words}; {self.source}"

    def classify(self, value):
        """Name of the damage class of a value [-], of a width [mm]; None for None.

        >>> LIMITS[2].classify(0.0009)
        'minor'
        """
        return (
            None
            if value is None
            else self.classes[int(np.searchsorted(self.bounds, value, side="right"))]
        )


_KORSWAGEN = (
    "P. A. Korswagen, dissertation on light damage of masonry, TU Delft: in-plane tests of {}"
    " walls, light damage from {} to {} % drift"
)
_LIGHT = ("none", "light", "beyond light")
LIMITS = (
    DamageClasses(
        "drift_class_korswagen_clay",
        "drift",
        (0.00058, 0.0048),
        _LIGHT,
        _KORSWAGEN.format("clay brick", 0.058, 0.48),
    ),
    DamageClasses(
        "drift_class_korswagen_calcium_silicate",
        "drift",
        (0.00050, 0.0029),
        _LIGHT,
        _KORSWAGEN.format("calcium silicate", 0.050, 0.29),
    ),
    DamageClasses(
        "drift_class_graziotti",
        "drift",
        (0.0007, 0.0012),
        ("none", "minor", "beyond minor"),
        "Graziotti et al., shake-table tests of a terraced house's end unit, as cited by Sarhosis"
        " et al. (2021), section 1: 0.07 % no damage, 0.12 % minor structural damage",
    ),
    DamageClasses(
        "drift_class_en_1998_1",
        "drift",
        (0.005, 0.0075, 0.01),
        ("up to 0.5 %", "up to 0.75 %", "up to 1 %", "over 1 %"),
        "EN 1998-1, 4.4.3.2, as cited by Sarhosis et al. (2021), section 2: storey drift under the"
        " frequent earthquake with brittle, ductile, no non-structural elements attached",
    ),
    DamageClasses(
        "drift_class_asce_7_16",
        "drift",
        (1 / 600, 1 / 400),
        ("up to 1/600", "up to 1/400", "over 1/400"),
        "ASCE 7-16, as cited by Sarhosis et al. (2021), section 2: usual allowable drift",
    ),
    DamageClasses(
        "psi_class",
        "psi",
        (1.0, 2.0, 3.5, 8.0),
        ("not visible", "visible", "light", "beyond light", "near collapse"),
        "P. A. Korswagen, dissertation on light damage of masonry, TU Delft: Psi = 1 just visible"
        " (0.1 mm), 2 about 1 mm, 3.5 about 5 mm and the end of light damage, 8 near collapse",
    ),
    DamageClasses(
        "crack_width_class",
        "width",
        (0.1, 1.0, 5.0, 15.0, 25.0),
        ("negligible", "very slight", "slight", "moderate", "severe", "very severe"),
        "Burland et al. (1977), with the angular distortion of Boscardin and Cording (1989,"
        " doi:10.1061/(ASCE)0733-9410(1989)115:1(1)): visible damage by the widest crack, one of 3"
        " mm or more counted by its width alone",
    ),
)


def bound(name, number):
    """Bound [-] with this index, counted from 0, of the entry of LIMITS with this name."""
    return next(limits for limits in LIMITS if limits.name == name).bounds[number]


@measure({limit.name: Column("", limit.description) for limit in LIMITS})
def classes(max_drift_ratio, max_psi, max_crack_width_mm):
    """Classes of a maximum drift ratio [-], a maximum Psi [-] and a widest crack [mm] by all
    LIMITS."""
    values = {"drift": max_drift_ratio, "psi": max_psi, "width": max_crack_width_mm}
    return [limits.classify(values[limits.measure]) for limits in LIMITS]
