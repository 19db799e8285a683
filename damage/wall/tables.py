"""Records of arrays with a row a body, or a row a contact point."""

from dataclasses import fields

import numpy as np


def taken(table, index):
    """The record of these rows, by their indices, flags or a slice."""
    return type(table)(*(getattr(table, column.name)[index] for column in fields(table)))


def concatenated(tables):
    """The record of the rows of several, one behind the other."""
    return type(tables[0])(
        *(
            np.concatenate([getattr(table, column.name) for table in tables])
            for column in fields(tables[0])
        )
    )


def inertia_of(mass, length, height):
    """Moments of inertia of blocks about their centres [kg m2], by mass [kg] and sizes [m]."""
    return mass * (length * length + height * height) / 12
