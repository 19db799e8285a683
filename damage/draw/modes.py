"""Picture of the natural modes of a wall."""

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from damage.draw.style import BODY_COLOURS, COLUMN_WIDTH, DARK, GROUND_COLOUR, styled
from damage.wall.geometry import body_corners, body_table, kinds_of_bodies

VISIBLE_SHARE = 0.08  # largest drawn displacement of a mode over the height of the wall


@styled
def modes_picture(layout, modes):
    """Figure of the mode shapes with their periods, two in a row, over the undeformed outline.

    layout: damage.wall.layout.Layout; modes: damage.law.modes.Modes of it.
    """
    n = len(modes.period_s)
    rows, ratio = -(-n // 2), layout.wall.built_height / layout.wall.length
    figure = Figure(figsize=(2 * COLUMN_WIDTH, rows * (COLUMN_WIDTH * ratio + 0.25) + 0.3), layout="constrained")
    for number, ax in enumerate(figure.subplots(rows, 2, squeeze=False).ravel()):
        ax.axis("off")
        if number < n:
            _draw_mode(ax, layout, modes.shape[number, :, :3])
            ax.set_title(f"mode {number + 1}: {modes.period_s[number]:.4f} s", fontsize="medium")
    figure.suptitle(f"{layout.wall.name}: natural modes with intact joints; critical time step "
                    f"{modes.critical_time_step_s:.3g} s", x=0.02, ha="left")
    return figure


def _draw_mode(ax, layout, shape):
    bodies = body_table(layout)
    rest = body_corners(bodies, np.zeros_like(shape))
    # Small enough that rotations are displacements of the linear mode, then enlarged as such.
    moved = body_corners(bodies, 1e-6 * shape) - rest
    largest = np.hypot(moved[..., 0], moved[..., 1]).max()
    corners = rest + moved * VISIBLE_SHARE * layout.wall.built_height / largest
    kinds = kinds_of_bodies(layout.bodies.course)
    ax.add_collection(PolyCollection(rest[kinds == "bricks"], facecolors="none", edgecolors="0.85", linewidths=0.3))
    for kind, colour in BODY_COLOURS.items():
        ax.add_collection(PolyCollection(corners[kinds == kind], facecolors=colour, edgecolors=DARK, linewidths=0.25))
    ax.axhline(0, color=GROUND_COLOUR, lw=2, zorder=0)
    margin = 1.2 * VISIBLE_SHARE * layout.wall.built_height
    points = rest.reshape(-1, 2)
    ax.set(xlim=(points[:, 0].min() - margin, points[:, 0].max() + margin),
           ylim=(-margin / 2, points[:, 1].max() + margin), aspect="equal")
