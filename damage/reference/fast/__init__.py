"""The fast time step: `damage.mechanics.step` in vectors of eight numbers, to the same bits.

It requires rigid bodies and a fixed set of interfaces.
"""


def takes(layout):
    """Whether the fast step can move the wall of a damage.wall.layout.Layout; the plain step moves every wall."""
    return layout.strain is None
