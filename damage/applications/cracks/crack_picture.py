"""Picture of digitised cracks: the polylines as they were drawn, and the joints that they were put
on."""

import numpy as np

from damage.draw import style
from damage.draw.run import show_all
from damage.draw.wall import COLUMN_PT, line_width, widest_line
from damage.draw.words import wall_words
from damage.measure.cracks import ends_of
from damage.units import MILLIMETRE
from damage.wall.geometry import body_corners, body_table, joint_table, tributary_ends

STATES = {  # what a mapped joint has done: label, colour
    "fine": ("below {limit}", "0.5"),
    "slipped": ("slipped", style.BLUE),
    "opened": ("opened", style.ORANGE),
    "both": ("opened and slipped", style.BLACK),
    "undecided": ("opened or slipped", style.PURPLE),
}
# [pt] by which a polyline is wider than the joints that it was put on, which lie over it
HALO = 1.4


def crack_pictures(mapped, patterns, layout, threshold):
    """(name, Figure) of every load level."""
    for pattern, cracks in zip(patterns, mapped):
        yield f"cracks_level_{pattern.level:g}", crack_picture(pattern, cracks, layout, threshold)


@style.styled
def crack_picture(pattern, mapped, layout, threshold):
    """Figure of one CrackPattern and its MappedCracks on the undeformed wall of a Layout."""
    wall = layout.wall
    figure, ax = style.new_figure(
        0.5 + (style.COLUMN_WIDTH - 0.5) * wall.built_height / wall.length
    )
    bricks = body_corners(body_table(layout))[: layout.n_bricks]
    style.add_bodies(ax, bricks, style.BRICK_COLOUR, zorder=1)
    style.add_lines(ax, tributary_ends(joint_table(layout)), "0.8", 0.25, zorder=2)
    states = joint_states(mapped.table, threshold)
    table = mapped.table
    widest_pt = widest_line(
        layout.bodies.height[: layout.n_bricks].min(), (wall.length, wall.built_height), COLUMN_PT
    )
    drawn = pattern.stretches
    widths = line_width(drawn["width_m"].to_numpy(float), widest_pt) + HALO
    style.add_lines(ax, ends_of(drawn), style.SKY, widths, capstyle="round", zorder=2.5)
    for state, (_, colour) in STATES.items():
        rows = table[states == state]
        widths = line_width(rows["width_m"].to_numpy(float), widest_pt)
        style.add_lines(ax, ends_of(rows), colour, widths, capstyle="butt", zorder=3)
    show_all(ax, np.array([[0.0, 0.0], [wall.length, wall.built_height]]))
    drift = "unknown" if np.isnan(pattern.drift_ratio) else f"{100 * pattern.drift_ratio:.3g} %"
    style.put_title(
        figure,
        f"{wall_words(wall.name)}, load level {pattern.level:g}, drift ratio {drift}",
        f"{mapped.drawn_m:.2f} m drawn, {mapped.unmapped_m:.2f} m of them on no joint",
    )
    style.legend_below(figure, _handles(states, threshold, widest_pt), columns=3)
    return figure


def joint_states(table, threshold):
    """Key of STATES of every row of a MappedCracks's table, (n_rows,)."""
    opened = table["opening_m"] > threshold
    slipped = table["slip_m"].abs() > threshold
    undecided = table["opening_m"].isna() & (table["width_m"] > threshold)
    return np.select(
        [undecided, opened & slipped, opened, slipped],
        ["undecided", "both", "opened", "slipped"],
        "fine",
    )


def _handles(states, threshold, widest_pt):
    width = line_width(0.5 * MILLIMETRE, widest_pt)
    limit = f"{threshold / MILLIMETRE:g} mm"
    return [
        style.line_handle(style.SKY, "as drawn", width + HALO),
        *(
            style.line_handle(colour, label.format(limit=limit), width)
            for state, (label, colour) in STATES.items()
            if np.any(states == state)
        ),
    ]
