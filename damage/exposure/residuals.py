"""Residuals of a ground-motion model at the stations of an earthquake whose records ship."""

import numpy as np
import pandas as pd

from damage.exposure.places import to_rd
from damage.files import DATA

COMPONENTS = DATA / "zeerijp_20180108" / "components.csv"
"""Horizontal components of the Zeerijp earthquake that ship: the README beside it says how the columns were made."""
ZEERIJP = {"magnitude": 3.4, "x_m": 245789.0, "y_m": 598263.0}
"""The earthquake: magnitude, epicentre in RD [m], as the catalogue that ships has them."""


def station_residuals(model, path=COMPONENTS, vs30_m_s=200.0):
    """DataFrame with a row a station: station, epicentral_km, pgv_mm_s, median_mm_s, residual (of
    ln PGV).

    model: a GroundMotionModel of component LRG or GEO; PGV as the component defines it, of both horizontal components.
    """
    table = pd.read_csv(path, comment="#").groupby("station", sort=False, as_index=False).agg(
        latitude=("latitude", "first"), longitude=("longitude", "first"), largest=("pgv_mm_s", "max"),
        product=("pgv_mm_s", "prod"))
    x_m, y_m = to_rd(table["latitude"].to_numpy(), table["longitude"].to_numpy())
    distance_km = np.hypot(x_m - ZEERIJP["x_m"], y_m - ZEERIJP["y_m"]) / 1e3
    observed = table["largest"] if model.component == "LRG" else np.sqrt(table["product"])
    median = model.median_mm_s(ZEERIJP["magnitude"], distance_km, vs30_m_s)
    return pd.DataFrame({"station": table["station"], "epicentral_km": distance_km, "pgv_mm_s": observed,
                         "median_mm_s": median, "residual": np.log(observed / median)})
