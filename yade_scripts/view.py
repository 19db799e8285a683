"""YADE's 3D view of a running wall, where there is a screen."""

import numpy as np

from damage.errors import InputError


def open_view():
    """Open YADE's 3D view; returns a function that updates it, to be called between steps.

    Raises InputError where there is no screen.
    """
    import yade.runtime

    if not yade.runtime.hasDisplay:
        raise InputError(
            "--view needs a screen and none is here; leave --view out, or start YADE "
            "where DISPLAY is set and without -n"
        )
    from PyQt5.QtWidgets import QApplication
    from yade import O, qt

    view = qt.View()
    framed = False
    view.screenSize = (1000, 750)

    def refresh():
        nonlocal framed
        if not framed and len(O.bodies) > 0:  # the wall is built after the view
            corners = np.array([body.state.pos for body in O.bodies])
            view.viewDir = (0, 1, 0)
            view.upVector = (0, 0, 1)
            view.fitAABB(tuple(corners.min(axis=0) - 0.3), tuple(corners.max(axis=0) + 0.3))
            framed = True
        QApplication.processEvents()

    return refresh
