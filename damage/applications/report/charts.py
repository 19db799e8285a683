"""Lines of the page over time, and styles of joints and lines, which differ without colour, too."""

import numpy as np
from matplotlib.colors import to_hex

from damage.draw.run import ENERGIES, JOINT_COLOURS
from damage.draw.style import (
    BLACK,
    BLUE,
    BODY_COLOURS,
    GREEN,
    ORANGE,
    PURPLE,
    VERMILLION,
    drift_scale,
)
from damage.draw.wall import LEGEND_WIDTHS_MM, WIDEST_PT, line_width, widest_line
from damage.history.moments import JOINT_STATES
from damage.units import MILLIMETRE

PIXELS = 1.8
"""Pixels of a point of a line width: a third wider than in print, for visibility on screens."""
DRAWING_PX = 480, 320
"""Width and height that a wall fills in a page as wide as a common screen, without labels."""
DASHES = {"-": "solid", "--": "dash", ":": "dot", "-.": "dashdot"}
RUN_STYLES = (
    (BLUE, "solid"),
    (VERMILLION, "dash"),
    (GREEN, "dashdot"),
    (PURPLE, "dot"),
    (BLACK, "longdash"),
    (ORANGE, "longdashdot"),
)
"""Colour and dash of each run where several are drawn in one panel."""
COMPONENT_STYLES = {
    "DI": ("DI", BLACK, "solid"),
    "DI_drift": ("DI drift", GREEN, "dot"),
    "DI_open": ("DI open", VERMILLION, "dash"),
    "DI_slip": ("DI slip", BLUE, "dashdot"),
}
CRACKS = {
    "slipped": ("slipped", JOINT_COLOURS["slipped"], "2px,2px"),
    "opened": ("opened", VERMILLION, "solid"),
    "both": ("opened and slipped", JOINT_COLOURS["both"], "6px,2px"),
}
"""{state: name, colour, dash} of cracked joints, the gravest last.  Colours are those of the
pictures, except for opened joints: thin orange lines are too faint on screens.  Lines differ on
paper, too: what slipped is dotted, what did both is dashed."""
ELASTIC = {
    "name": "elastic, cannot fail",
    "colour": JOINT_COLOURS["elastic"],
    "dash": "4px,3px",
    "pixels": 0.9,
}
"""The line of joints that a lintel keeps elastic."""


def over_time(runs):
    """Panels over time, one below another: [{"title", "unit", "factor", "lines": [{"run", "series",
    "name", "colour", "dash"}]}]; of one run the components share a panel, of several each has its
    own."""
    if not runs:
        return []
    factor, unit = drift_scale(*(run["history"].series["drift_ratio"] for run in runs))
    above = [_drive(runs), _panel("Drift ratio", unit, runs, "drift_ratio", factor)]
    if len(runs) > 1:
        return [
            *above,
            *(_panel(label, "", runs, name) for name, (label, *_) in COMPONENT_STYLES.items()),
        ]
    return [
        *above,
        {
            "title": "Damage index",
            "unit": "",
            "factor": 1,
            "lines": [_line(0, name, *style) for name, style in COMPONENT_STYLES.items()],
        },
    ]


def _drive(runs):
    """The panel of what drives the runs: the base's motion or, where no base moves, the force that
    answers."""
    if not any(_moves(run, axis) for run in runs for axis in "xz"):
        return _panel("Base shear", "kN", runs, "base_shear_kn")
    panel = _panel("Base acceleration", "g", runs, "base_x_g")
    if len(runs) == 1 and _moves(runs[0], "z"):
        panel["lines"] = [
            _line(0, "base_x_g", "base, along the wall", BLACK, "solid"),
            _line(0, "base_z_g", "base, upwards", VERMILLION, "dot"),
        ]
    return panel


def _moves(run, axis):
    """Whether the base of a run moves along x or z."""
    return bool(np.nan_to_num(run["history"].series[f"base_acceleration_{axis}_m_s2"]).any())


def _panel(title, unit, runs, series, factor=1):
    names = [f"run {run['letter']}" if len(runs) > 1 else title.lower() for run in runs]
    return {
        "title": title,
        "unit": unit,
        "factor": factor,
        "lines": [
            _line(number, series, name, *style)
            for number, (name, style) in enumerate(zip(names, RUN_STYLES))
        ],
    }


def _line(run, series, name, colour, dash):
    return {"run": run, "series": series, "name": name, "colour": colour, "dash": dash}


def states_legend(runs=()):
    """Styles of joints and energies: {"states": [{"code", "name", "colour", "dash"}] of cracked
    ones, the gravest last, "bodies": [{"fill", "edge"}] by kind, "elastic", "energies", "widths":
    [{"from_mm", "pixels"}], how wide a line is by the class of its crack's width, the widest of
    them no more than half of the lowest brick of the runs}."""
    states = [
        {"code": JOINT_STATES.index(state), "name": name, "colour": colour, "dash": dash}
        for state, (name, colour, dash) in CRACKS.items()
    ]
    widest_pt = WIDEST_PT
    for history in (run["history"] for run in runs):
        brick_m = history.bodies["height_m"][history.bodies["course"] >= 0].min()
        span_m = history.attributes["length_m"], history.attributes["height_m"]
        drawing_pt = [pixels / PIXELS for pixels in DRAWING_PX]
        widest_pt = min(widest_pt, widest_line(brick_m, span_m, drawing_pt))
    uppers = (*LEGEND_WIDTHS_MM[1:], LEGEND_WIDTHS_MM[-1])
    bodies = [
        {"fill": to_hex(colour), "edge": to_hex(colour if kind == "lintels" else "0.69")}
        for kind, colour in BODY_COLOURS.items()
    ]
    energies = [
        {"series": name, "name": label, "colour": colour, "dash": DASHES[line]}
        for name, (label, colour, line) in ENERGIES.items()
    ]
    return {
        "states": states,
        "bodies": bodies,
        "elastic": ELASTIC,
        "energies": energies,
        "widths": [
            {
                "from_mm": low,
                "pixels": round(
                    float(PIXELS * line_width(MILLIMETRE * (low * high) ** 0.5, widest_pt)), 2
                ),
            }
            for low, high in zip(LEGEND_WIDTHS_MM, uppers)
        ],
    }
