"""Crack maps of a study: the wall at maximum index and at the end, a row for each motion."""

from damage.draw.panels import add_heading, finish, grid, letter, motion_label, slip_note
from damage.draw.run import draw_wall, joint_handles
from damage.draw.style import styled
from damage.draw.wall import wall_shape
from paper.results import Missing

MOST_ROWS = 5
"""Rows of a page; of more motions the most damaging are shown."""

PANEL_PT = 205, 100
"""Width and height that a wall fills at most in a panel, without labels."""


@styled
def crack_maps(results, variant):
    """Walls of the strongest motions of each kind at maximum DI and at the end, in true scale.

    Where both solvers have a point, that of the reference solver is drawn.
    """
    points = variant.reference if len(variant.reference) else variant.yade
    points = points.dropna(subset="max_DI").sort_values("max_DI", ascending=False).head(MOST_ROWS)
    if len(points) == 0:
        raise Missing("no point with a damage index")
    solver = "reference solver" if len(variant.reference) else "YADE"
    histories = [(motion_label(point), results.history(point)) for _, point in points.iterrows()]
    figure, axes = grid(len(histories), 2, 2.35)
    shapes = []
    for first, row, (name, history) in zip(range(0, axes.size, 2), axes, histories):
        for number, (ax, sample, when) in enumerate(zip(row, ("max", "end"), ("largest index", "end")), first):
            shapes.append(wall_shape(history, sample).on_page(PANEL_PT))
            draw_wall(ax, shapes[-1])
            ax.label_outer()
            letter(ax, number, f"{name}\n{when}: DI {shapes[-1].index:.3f}, displacements × "
                   f"{shapes[-1].magnification:g}")
    widest = max(shapes, key=lambda shape: shape.crack_width_m.max(initial=0))
    add_heading(figure, f"Cracks, {variant.title}: the most damaging motions, first run of each, {solver}",
                slip_note(points))
    return finish(figure, joint_handles(widest), columns=5)
