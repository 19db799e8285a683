"""YADE's 3D view of a running wall, where there is a screen."""

from damage.errors import InputError


def open_view():
    """Open YADE's 3D view; returns a function that keeps it alive between chunks of steps."""
    import yade.runtime

    if not yade.runtime.hasDisplay:
        raise InputError("--view needs a screen and none is here; leave --view out, or start YADE "
                         "where DISPLAY is set and without -n")
    from PyQt5.QtWidgets import QApplication
    from yade import qt

    view = qt.View()
    view.viewDir, view.upVector = (0, 1, 0), (0, 0, 1)
    view.showEntireScene()
    return QApplication.processEvents
