"""Values that the paper's text prints, as stars in our figures of the same quantity; its curves
have no numbers."""

from matplotlib.lines import Line2D

from damage.draw.style import PURPLE
from damage.draw.words import station_of
from paper.criteria import (
    AMPLITUDES_G,
    CYCLE_LENGTHS_S,
    LARGEST_DI,
    LARGEST_RESIDUAL_DI,
    PGA_G,
    SA_G,
    SCALES,
)

WALL = "symmetric"
"""The wall that figures 7 to 11 show."""
EVENT = {"MID1": "huizinge", "BGAR": "zeerijp"}
"""{station: event} of the paper's two records."""
_STAR = {"ls": "", "marker": "*", "ms": 8, "color": PURPLE}


def star(ax, x, y):
    """Draw a value of the paper's text; nothing where it prints none (None)."""
    if y is not None:
        ax.plot(x, y, zorder=6, clip_on=False, **_STAR)


def star_handles(drawn):
    """The legend's entry of the stars, in a list; empty where none is drawn."""
    return [Line2D([], [], label="printed in the paper's text", **_STAR)] if drawn else []


def largest_di(variant, period_s):
    """Figure 8: maximum DI at the largest amplitude, None where the text has none."""
    return LARGEST_DI.get(round(period_s, 6)) if variant.wall == WALL else None


def cycle_length_s(variant, amplitude_g):
    """Figure 9: duration of the last cycle [s], None where the text has none."""
    return (
        dict(zip(AMPLITUDES_G, CYCLE_LENGTHS_S)).get(round(amplitude_g, 6))
        if variant.wall == WALL
        else None
    )


def record_values(name):
    """Figure 10: PGA and spectral acceleration at 0.2 s [g] of a record, (None, None) of others."""
    event = EVENT.get(station_of(name))
    return (PGA_G[event], SA_G) if event else (None, None)


def largest_residual(variant, name):
    """Figure 11: (PGA [g], residual DI) of a record at its largest scale, (None, None) where the
    text has none."""
    if variant.wall == WALL and EVENT.get(station_of(name)) == "huizinge":
        return SCALES[-1] * PGA_G["huizinge"], LARGEST_RESIDUAL_DI
    return None, None
