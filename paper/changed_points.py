"""How far the tables of points of two versions are apart: medians, ranges, and the points that moved most.

    python3 paper/changed_points.py OLD NEW [STUDY ...]      # a table of docs/paper/changed-points.md

OLD holds an older version's STUDY_points.csv, or is a commit of this repository, whose docs/tables are taken; NEW holds
files of that name, too.  Of what changed in DI by slip, two causes are distinguished: the older tables' slip by
displacement is what is now called accumulated.
"""

import io
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).resolve().parents[1]
STUDIES = ("harmonic", "ida", "nolintel", "sensitivity", "sequence", "crosscheck", "validation")
MEASURES = (  # old column, new column, what it is, factor, decimals
    ("max_drift_ratio", "max_drift_ratio", "maximum drift ratio [%]", 100, 4),
    ("max_DI", "max_accumulated_DI", "maximum DI, slip accumulated", 1, 4),
    ("max_DI", "max_DI", "the same, slip by displacement now", 1, 4),
    ("max_shear_limit_DI", "max_shear_limit_DI", "maximum DI, slip by the shear limit", 1, 4),
    ("residual_DI", "residual_DI", "residual DI, slip by displacement now", 1, 4),
    ("residual_shear_limit_DI", "residual_shear_limit_DI", "residual DI, slip by the shear limit", 1, 4),
    ("max_psi", "max_psi", "maximum Psi", 1, 2),
)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    old, new, studies = sys.argv[1], Path(sys.argv[2]), sys.argv[3:] or STUDIES
    lines = [line for study in studies for line in rows_of(study, read_old(old, study),
                                                           read_new(new / f"{study}_points.csv"))]
    if not lines:
        sys.exit(f"error: {old} and {new} have no study in common; expected STUDY_points.csv in two folders, or in the "
                 "docs/tables of a commit")
    print("| study | quantity | points | moved by, median | most | there from, to "
          "| old median in the new range | widest range, old, new |\n" + "| --- " * 8 + "|")
    print(*lines, sep="\n")


def rows_of(study, old, new):
    """Lines of a study's table, solver by solver; none where a version has no table."""
    if old is None or new is None:
        return
    solvers = sorted(set(new.index.get_level_values("solver")))
    for solver in solvers:
        label = study if len(solvers) == 1 else f"{study}, {solver}"
        both = [table[table.index.get_level_values("solver") == solver] for table in (old, new)]
        for line in filter(None, (row_of(*both, *measure) for measure in MEASURES)):
            yield f"| {label} | {line}"
            label = ""


def short(point):
    """A point's name without what all of its study share."""
    point = re.sub(r"record-([A-Z0-9]+)_\S*?_scale-([0-9.]+)(_window-[0-9.-]+)?", r"\1 x \2", point)
    return re.sub(r"_rest-[0-9.]+", "", point).replace("_", " ")


def read_old(old, study):
    """Table of points of a folder or a commit, or None where it has none."""
    if Path(old).is_dir():
        return read_new(Path(old) / f"{study}_points.csv")
    done = subprocess.run(["git", "show", f"{old}:docs/tables/{study}_points.csv"], cwd=ROOT, capture_output=True)
    return table_of(io.BytesIO(done.stdout)) if done.returncode == 0 else None


def read_new(path):
    """Table of points of a file, or None where it is not there."""
    return table_of(path) if path.exists() else None


def table_of(source):
    """A table of points by point and solver."""
    return pd.read_csv(source, keep_default_na=False, na_values=[""]).set_index(["point", "solver"])


def row_of(old, new, old_name, new_name, label, factor, digits):
    """A line of the table: of the points that both have and that stood in both; of ranges, those of several runs."""
    if old_name not in old or new_name not in new:
        return None
    both = old[[old_name, f"{old_name}_min", f"{old_name}_max", "collapsed"]].set_axis(
        ["old", "old_min", "old_max", "old_collapsed"], axis=1).join(
            new[[new_name, f"{new_name}_min", f"{new_name}_max", "collapsed", "members"]].set_axis(
                ["new", "new_min", "new_max", "collapsed", "members"], axis=1), how="inner")
    both = both[(both["old_collapsed"] == 0) & (both["collapsed"] == 0)].dropna(subset=["old", "new"])
    if both.empty:
        return None
    off = (both["new"] - both["old"]).abs()
    most, several = off.idxmax(), both[both["members"] > 1]
    inside = several["old"].between(several["new_min"], several["new_max"]).sum()
    widths = [(several[f"{which}_max"] - several[f"{which}_min"]).max() * factor for which in ("old", "new")]
    ranges = f"{inside} of {len(several)} | {widths[0]:.{digits}f}, {widths[1]:.{digits}f}" if len(several) else "- | -"

    def text_of(value):
        return f"{factor * value:.{digits}f}"

    return (f"{label} | {len(both)} | {text_of(off.median())} | {text_of(off.max())} ({short(most[0])}) | "
            f"{text_of(both.loc[most, 'old'])}, {text_of(both.loc[most, 'new'])} | {ranges} |")


if __name__ == "__main__":
    main()
