"""A survey as the page draws it: cracks and areas without one, to and from a crack file."""

import numpy as np
import pandas as pd

from damage.applications.cracks.crack_file import OF_SURVEY, REQUIRED, SEEN_AS
from damage.checks import check_choice, check_range
from damage.errors import InputError
from damage.measure.cracks import ENDS
from damage.wall.geometry import joint_table, tributary_ends

SURVEY = "survey.csv"
MOST_LINES = 500
"""Largest number of cracks and areas of a survey."""
MOST_POINTS = 500
"""Largest number of points of a crack."""


def surveyed(survey, layout):
    """What the page shows of a Survey: its numbers, and the joints of a Layout that it is put on,
    x, z of both ends [m]."""
    ends = tributary_ends(joint_table(layout))[survey.table["joint"]]
    joints = np.round(ends.reshape(-1, 4), 4).tolist()
    return survey.as_dict() | {"file": SURVEY, "joints": joints}


def redrawn(pattern):
    """Cracks and areas of a CrackPattern that the page wrote, as it draws them."""
    cracks = []
    for _, line in pattern.stretches.groupby("line"):
        ends = line[list(ENDS)].to_numpy(float)
        cracks.append(
            {
                "label": str(line["crack"].iloc[0]),
                "points": [*ends[:, :2].tolist(), ends[-1, 2:].tolist()],
                "width_mm": round(1e3 * line["width_m"].iloc[0], 6),
                "offset": SEEN_AS.get(line["offset"].iloc[0], "unknown"),
            }
        )
    return {
        "cracks": cracks,
        "areas": pattern.clear.tolist(),
        "limit_mm": round(1e3 * pattern.detection_limit_m, 6),
        "error_mm": round(1e3 * pattern.width_error_m, 6),
    }


def points_of(what, points, least, most):
    """An array (n, 2) of points from the page; InputError for anything else."""
    if not isinstance(points, list) or not least <= len(points) <= most:
        raise InputError(f"{what}: expected {least} to {most} points; mark them again")
    for point in points:
        if not isinstance(point, list) or len(point) != 2:
            raise InputError(f"{what}: expected two numbers a point; mark them again")
        for value in point:
            check_range(what, value, -1e5, 1e5)
    return np.array(points, float)


def as_csv(cracks, areas, limit_mm, error_mm):
    """The text of a crack file of what was drawn."""
    check_range("detection limit [mm]", limit_mm, 0.001, 100)
    check_range("error of widths [mm]", error_mm, 0, 100)
    if (
        not isinstance(cracks, list)
        or not isinstance(areas, list)
        or not 1 <= len(cracks) + len(areas) <= MOST_LINES
    ):
        raise InputError(
            f"the survey: expected 1 to {MOST_LINES} cracks and areas; draw one, or take some out"
        )
    accuracy = {"detection_limit_mm": float(limit_mm), "width_error_mm": float(error_mm)}
    rows = []
    for number, crack in enumerate(cracks, start=1):
        points = points_of(
            f"crack {number}",
            crack.get("points") if isinstance(crack, dict) else None,
            2,
            MOST_POINTS,
        )
        check_range(f"width of crack {number} [mm]", crack.get("width_mm"), 0.001, 1000)
        check_choice(f"offset of crack {number}", crack.get("offset"), ("yes", "no", "unknown"))
        sizes = {"width_mm": float(crack["width_mm"]), "offset": crack["offset"]}
        last = len(points)
        rows += [
            {
                "crack": crack.get("label") or number,
                "point": k,
                "x_m": x,
                "z_m": z,
                **(sizes if k < last else {}),
            }
            for k, (x, z) in enumerate(points, start=1)
        ]
    for number, area in enumerate(areas, start=1):
        corners = np.sort(points_of(f"area {number}", area, 2, 2), axis=0)
        rows += [
            {"crack": f"area{number}", "point": k, "x_m": x, "z_m": z, "mode": "none"}
            for k, (x, z) in enumerate(corners, start=1)
        ]
    # a line that begins with a label like #1 would be a comment
    first = sorted(REQUIRED, key="crack".__eq__)
    table = pd.DataFrame(rows, columns=[*first, "width_mm", "mode", *OF_SURVEY])
    table = table.round({"x_m": 4, "z_m": 4}).assign(**accuracy)
    return table.to_csv(index=False, lineterminator="\n")
