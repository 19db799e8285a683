"""A wall in YADE, with joints by face or between the centres of cells."""

from yade import O

from yade_scripts.cell_model import build_cells
from yade_scripts.face_model import build_faces


def build(layout, dt):
    """Build the model of the layout's `joints` in YADE's scene; returns a YadeWall."""
    O.reset()
    O.dt = dt
    return {"face": build_faces, "centres": build_cells}[layout.options.joints](layout)
