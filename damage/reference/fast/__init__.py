"""The fast time step: `damage.mechanics.step` in vectors of eight numbers, with bitwise identical results.

It requires a fixed set of interfaces (`takes`).  A single wall with deformable bricks advances by the plain step.
"""


def takes(layout, new_contacts=False):
    """Whether the fast step can move the wall of a damage.wall.layout.Layout; the plain step moves every wall.

    new_contacts: whether its bricks find new contacts.
    """
    return not new_contacts
