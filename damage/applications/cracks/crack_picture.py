"""Picture of digitised cracks: the polylines as they were drawn, and the joints that they were put
on."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D

from damage.draw import style
from damage.draw.wall import COLUMN_PT, line_width, widest_line
from damage.index import THRESHOLD
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
def crack_picture(pattern, mapped, layout, threshold=THRESHOLD):
    """Figure of one CrackPattern and its MappedCracks on the undeformed wall of a Layout."""
    wall = layout.wall
    figure, ax = style.new_figure(
        0.5 + (style.COLUMN_WIDTH - 0.5) * wall.built_height / wall.length
    )
    bricks = body_corners(body_table(layout), np.zeros((len(layout.bodies), 3)))[: layout.n_bricks]
    ax.add_collection(
        PolyCollection(bricks, facecolors=style.BRICK_COLOUR, edgecolors="none", zorder=1)
    )
    ax.add_collection(
        LineCollection(tributary_ends(joint_table(layout)), colors="0.8", linewidths=0.25, zorder=2)
    )
    states, table = joint_states(mapped.table, threshold), mapped.table
    widest_pt = widest_line(
        layout.bodies.height[: layout.n_bricks].min(), (wall.length, wall.built_height), COLUMN_PT
    )
    drawn = pattern.stretches
    ax.add_collection(
        LineCollection(
            ends_of(drawn),
            colors=style.SKY,
            capstyle="round",
            zorder=2.5,
            linewidths=line_width(drawn["width_m"].to_numpy(float), widest_pt) + HALO,
        )
    )
    for state, (_, colour) in STATES.items():
        rows = table[states == state]
        ax.add_collection(
            LineCollection(
                ends_of(rows),
                colors=colour,
                capstyle="butt",
                zorder=3,
                linewidths=line_width(rows["width_m"].to_numpy(float), widest_pt),
            )
        )
    margin = 0.02 * max(wall.length, wall.built_height)
    ax.axhspan(-margin, 0, facecolor=style.GROUND_COLOUR, lw=0, zorder=0)
    ax.set(
        xlim=(-margin, wall.length + margin),
        ylim=(-margin, wall.built_height + margin),
        aspect="equal",
        xlabel="x [m]",
        ylabel="z [m]",
    )
    drift = "unknown" if np.isnan(pattern.drift_ratio) else f"{100 * pattern.drift_ratio:.3g} %"
    figure.suptitle(
        f"{wall.name}, load level {pattern.level:g}, drift ratio {drift}\n{mapped.drawn_m:.2f} m"
        f" drawn, {mapped.unmapped_m:.2f} m of them on no joint",
        x=0.02,
        ha="left",
    )
    style.legend_below(figure, _handles(states, threshold, widest_pt), columns=3)
    return figure


def joint_states(table, threshold=THRESHOLD):
    """Key of STATES of every row of a MappedCracks's table, (n_rows,)."""
    opened, slipped = table["opening_m"] > threshold, table["slip_m"].abs() > threshold
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
        Line2D([], [], color=style.SKY, lw=width + HALO, label="as drawn"),
        *(
            Line2D([], [], color=colour, lw=width, label=label.format(limit=limit))
            for state, (label, colour) in STATES.items()
            if np.any(states == state)
        ),
    ]
