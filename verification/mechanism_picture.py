"""The collapse mechanism of limit analysis beside that of the solver, both magnified."""

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from damage.draw.style import BRICK_COLOUR, CAP_COLOUR, COLUMN_WIDTH, DARK, MEDIUM, styled

REACH = 0.12  # of the wall's height: how far the largest displacement is drawn
MOVES = 0.02  # of the largest displacement: bodies that move more are drawn darker


@styled
def mechanisms(layout, motions):
    """Figure of the wall under each motion {title: (n_bodies, 3)}, side by side, over its outline at rest."""
    ratio = layout.wall.built_height / layout.wall.length
    height = min(80.0, 8 + 45 * ratio) / 25.4
    figure = Figure(figsize=(COLUMN_WIDTH, height), layout="constrained")
    axes = figure.subplots(1, len(motions), squeeze=False)[0]
    for ax, (title, motion) in zip(axes, motions.items()):
        scale = REACH * layout.wall.built_height / np.abs(corners(layout, motion) - corners(layout)).max()
        _draw(ax, layout, np.asarray(motion) * scale)
        ax.set_title(title, fontsize=7)
    return figure


def corners(layout, motion=None):
    """Corners (n_bodies, 4, 2) [m] of the bodies, displaced by small motions (n_bodies, 3)."""
    bodies = layout.bodies
    x = bodies.x[:, None] + 0.5 * bodies.length[:, None] * np.array([-1, 1, 1, -1])
    z = bodies.z[:, None] + 0.5 * bodies.height[:, None] * np.array([-1, -1, 1, 1])
    if motion is None:
        return np.stack([x, z], axis=2)
    ux, uz, turn = np.asarray(motion, float).T[:, :, None]
    return np.stack([x + ux - turn * (z - bodies.z[:, None]), z + uz + turn * (x - bodies.x[:, None])], axis=2)


def _draw(ax, layout, motion):
    ax.add_collection(PolyCollection(corners(layout), facecolors="none", edgecolors=MEDIUM, linewidths=0.3))
    moves = np.abs(motion[:, :2]).max(axis=1) > MOVES * np.abs(motion[:, :2]).max()
    colours = [CAP_COLOUR if move else BRICK_COLOUR for move in moves]
    ax.add_collection(PolyCollection(corners(layout, motion), facecolors=colours, edgecolors=DARK, linewidths=0.5))
    ax.add_line(Line2D([-0.05 * layout.wall.length, 1.05 * layout.wall.length], [0, 0], color=DARK, linewidth=1.2))
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.axis("off")


def save_mechanisms(name, result, folder):
    """Write FOLDER/NAME.png of a `verification.dry_walls.Result`; its path."""
    folder.mkdir(parents=True, exist_ok=True)
    figure = mechanisms(result.layout, {
        f"limit analysis: {result.bound.multiplier:.3f}": result.bound.motion,
        f"solver: {result.solver.multiplier:.3f}": result.solver.motion})
    path = folder / f"mechanism_{name}.png"
    figure.savefig(path)
    return path
