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
    normal, shear = (
        np.where(base, 1 / (1 / stiffness + 1 / (share * per_area)), stiffness)
        for stiffness, share in (
            (contacts.normal_stiffness, 1.0),
            (contacts.shear_stiffness, options.soil_shear),
        )
    )
    contacts = replace(
        contacts,
        normal_stiffness=normal,
        shear_stiffness=shear,
        tensile_strength=np.where(base, 0.0, contacts.tensile_strength),
    )
    return replace(layout, contacts=contacts)
