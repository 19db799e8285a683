"""Soil below the base: springs in series with the base joint that carry no tension.

A Winkler foundation: a footing of width B on soil with the modulus of subgrade reaction k
(vertical) and r k (horizontal) is a spring of k B, r k B per length of the wall.  It is in series
with the base joint, which gets no tensile strength: the base lifts off where it would be pulled,
and has only friction from then on.  Supports, and with them all motion of the ground, are below the
springs.
"""

from dataclasses import replace

import numpy as np


def on_soil(layout):
    """The damage.wall.layout.Layout with its base contacts on the soil of its options; the same
    where that is rigid."""
    options = layout.options
    contacts = layout.contacts
    if options.soil == "rigid":
        return layout
    base = contacts.first < 0
    per_area = float(options.soil) * options.footing / layout.wall.brick.thickness
    stiffness = {
        name: np.where(
            base, _in_series(getattr(contacts, name), share * per_area), getattr(contacts, name)
        )
        for name, share in (("normal_stiffness", 1.0), ("shear_stiffness", options.soil_shear))
    }
    return replace(
        layout,
        contacts=replace(
            contacts, **stiffness, tensile_strength=np.where(base, 0.0, contacts.tensile_strength)
        ),
    )


def _in_series(first, second):
    return 1 / (1 / first + 1 / second)
