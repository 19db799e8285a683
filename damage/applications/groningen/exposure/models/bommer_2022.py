"""PGV of induced earthquakes in the Groningen field.

J. J. Bommer, P. J. Stafford, M. Ntinalexis (2022), Journal of Seismology,
doi:10.1007/s10950-022-10120-w, of the version of October 2021.
"""

from types import MappingProxyType

import numpy as np

from damage.applications.groningen.exposure.ground_motion import GroundMotionModel
from damage.elementary import exp, log

DEPTH_KM = 3.0
"""Depth of all events [km]: that of the field, with which the model was fitted."""
NEAR_KM, FAR_KM = 7.0, 12.0
"""Distances at which the attenuation changes [km]."""
REFERENCE_M_S = 200.0
"""VS30 without site effect [m/s]."""

_COLUMNS = "c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8", "tau", "phi_s2s", "phi_ss"
_ROWS = {
    "GEO": (
        -3.9045,
        2.3004,
        -2.6496,
        -1.0908,
        -2.0089,
        -3.3276,
        1.1513,
        -0.2977,
        0.2488,
        0.2420,
        0.4160,
    ),
    "LRG": (
        -3.3996,
        2.3258,
        -2.8522,
        -1.0151,
        -2.1002,
        -3.4407,
        1.1513,
        -0.3295,
        0.2448,
        0.2406,
        0.4569,
    ),
    "MAX": (
        -3.2738,
        2.3343,
        -2.8857,
        -1.0060,
        -2.1016,
        -3.3940,
        1.1513,
        -0.3354,
        0.2470,
        0.2442,
        0.4530,
    ),
}


class Model(GroundMotionModel):
    """The model of Bommer, Stafford and Ntinalexis for Groningen."""

    source = (
        "Bommer, Stafford, Ntinalexis (2022), doi:10.1007/s10950-022-10120-w; all events at 3 km"
        " depth"
    )
    components = MappingProxyType(
        {
            "LRG": "larger of both horizontal components",
            "GEO": "geometric mean of both",
            "MAX": "largest in any horizontal direction",
        }
    )
    default = "LRG"
    coefficients = MappingProxyType(
        {component: dict(zip(_COLUMNS, row, strict=True)) for component, row in _ROWS.items()}
    )

    def median_mm_s(self, magnitude, epicentral_km, vs30_m_s):
        """As of GroundMotionModel; hypocentral distances with DEPTH_KM."""
        c1, c2, c3, c4, c5, c6, c7, c8 = (self.values[name] for name in _COLUMNS[:8])
        magnitude, epicentral_km = np.asarray(magnitude, float), np.asarray(epicentral_km, float)
        distance_km = np.sqrt(
            epicentral_km * epicentral_km + DEPTH_KM * DEPTH_KM + exp(2 * (c6 + c7 * magnitude))
        )
        ln_cm_s = (
            c1
            + c2 * magnitude
            + c3 * log(np.minimum(distance_km, NEAR_KM))
            + c4 * log(np.clip(distance_km, NEAR_KM, FAR_KM) / NEAR_KM)
            + c5 * log(np.maximum(distance_km, FAR_KM) / FAR_KM)
            + c8 * log(vs30_m_s / REFERENCE_M_S)
        )
        return 10.0 * exp(ln_cm_s)
