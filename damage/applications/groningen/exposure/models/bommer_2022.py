"""PGV of induced earthquakes in the Groningen field.

J. J. Bommer, P. J. Stafford, M. Ntinalexis (2022), Journal of Seismology,
doi:10.1007/s10950-022-10120-w, of the version of October 2021.
"""

from types import MappingProxyType

import numpy as np
import pandas as pd

from damage.applications.groningen.exposure.ground_motion import GroundMotionModel
from damage.elementary import exp, log
from damage.files import DATA

DEPTH_KM = 3.0
"""Depth of all events [km]: that of the field, with which the model was fitted."""
NEAR_KM = 7.0
"""Distance at which the attenuation first changes [km]."""
FAR_KM = 12.0
"""Distance at which the attenuation changes again [km]."""
REFERENCE_M_S = 200.0
"""VS30 without site effect [m/s]."""

_TABLE = pd.read_csv(
    DATA / "groningen" / "bommer_2022.csv", index_col="component", float_precision="round_trip"
)


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
    coefficients = MappingProxyType(_TABLE.to_dict("index"))

    def median_mm_s(self, magnitude, epicentral_km, vs30_m_s):
        """Medians as of GroundMotionModel; hypocentral distances with DEPTH_KM."""
        c1, c2, c3, c4, c5, c6, c7, c8 = (self.values[f"c{k}"] for k in range(1, 9))
        magnitude = np.asarray(magnitude, float)
        epicentral_km = np.asarray(epicentral_km, float)
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
