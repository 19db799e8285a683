"""Tables of the study `settlement`: cracks by the settlement alone, and Psi after a motion.

They are those of docs/paper/settled-walls.md:

    ./run_all.sh settlement --solver reference --keep summary
    python3 scripts/keep_tables.py results/settlement settlement  # keeps settlement_points.csv
    python3 -m paper settled_walls                                # two tables in Markdown
"""

import pandas as pd

from damage.measure.limits import LIMITS
from paper.bench import REPOSITORY, arguments, show
from paper.cracks_before import spread

POINTS = REPOSITORY / "docs" / "tables" / "settlement_points.csv"
PROTOTYPE_MM = {2000: 0.22, 1000: 0.69, 500: 1.64, 300: 2.90}
"""Widest crack in hogging by 1/N of an independent program, brittle joints, a single wall."""
NAMES, PROFILES = ("solid", "symmetric", "asymmetric"), ("hogging", "sagging")
JOINTS = {"brittle": (), "softening": ("softening",)}
"""Joints of the walls of the study `settlement`, with the words by which its points name them."""
MOTIONS = {
    "harmonic": "0.2 s, 0.05 g",
    "bgar-0.31": "BGAR x 0.31",
    "bgar-1.0": "BGAR x 1",
    "bgar-2.0": "BGAR x 2",
}
SHAKEN = 5000, 1000, 500, 300
"""One over the angular distortions after which walls are shaken."""
WIDTHS = next(limits for limits in LIMITS if limits.name == "crack_width_class")


def main():
    arguments(__doc__)
    points = pd.read_csv(POINTS)
    points = points[points["solver"] == "reference"].set_index("point")
    show(
        [
            "wall",
            "joints",
            "profile",
            "by",
            "runs",
            "widest crack [mm]",
            "prototype [mm]",
            "Ψ",
            "class (Burland)",
        ],
        [
            row
            for wall in NAMES
            for joints in JOINTS
            for row in cracks_by_distortion(points, wall, joints)
        ],
    )
    show(
        [
            "wall",
            "joints",
            "motion",
            "profile",
            "ground at rest",
            *(f"1/{inverse}" for inverse in SHAKEN),
        ],
        [row for wall in NAMES for joints in JOINTS for row in then_shaken(points, wall, joints)],
    )


def cracks_by_distortion(points, wall, joints):
    """Rows of the table of cracks by the settlement alone, of a wall; points: by their names."""
    for profile in PROFILES:
        for inverse in (5000, 2000, 1000, 500, 300, 200):
            if (row := point(points, wall, joints, profile, inverse)) is None:
                continue
            ends = ("_min", "", "_max") if row["members"] > 1 else ("",)
            width, psi = (
                spread(row[[name + end for end in ends]].astype(float))
                for name in ("settled_crack_width_mm", "settled_psi")
            )
            by_prototype = (wall, joints, profile) == ("symmetric", "brittle", "hogging")
            yield (
                wall,
                joints,
                profile,
                f"1/{inverse}",
                int(row["members"]),
                width,
                PROTOTYPE_MM.get(inverse, "") if by_prototype else "",
                psi,
                WIDTHS.classify(row["settled_crack_width_mm"]),
            )


def then_shaken(points, wall, joints):
    """Rows of the table of walls that settled and were shaken then: Ψ at rest before and after the
    motion."""
    for name, motion in MOTIONS.items():
        rest = point(points, wall, joints, "rest", name)
        for profile in PROFILES:
            cells = [
                at_rest(point(points, wall, joints, profile, inverse, name)) for inverse in SHAKEN
            ]
            if rest is not None or any(cells):
                yield wall, joints, motion, profile, at_rest(rest), *cells


def point(points, wall, joints, *parts):
    """Row of a point of the study `settlement`, None where it is not there."""
    name = "-".join(map(str, (wall, *JOINTS[joints], *parts)))
    if name.startswith("symmetric-softening") and parts[0] in PROFILES and len(parts) == 2:
        name = name.removeprefix("symmetric-")
    return points.loc[name] if name in points.index else None


def at_rest(row):
    """Ψ before and after a motion, in words; row: of a point, or None."""
    if row is None:
        return ""
    before, fell = 0.0 if pd.isna(row["settled_psi"]) else row["settled_psi"], int(row["collapsed"])
    after = f"{fell} of {int(row['members'])} fall" if fell else f"{row['residual_psi']:.2f}"
    return f"{before:.2f}, {after}"
