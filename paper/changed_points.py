"""How far the tables of points of two versions are apart: medians, ranges, and the points that moved most.

    python3 -m paper changed_points OLD NEW [STUDY ...]      # a table of docs/paper/changed-points.md

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

from paper.bench import REPOSITORY, show

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
    rows = [row for study in studies for row in rows_of(study, read(old, study), read(new, study))]
    if not rows:
        sys.exit(f"error: {old} and {new} have no study in common; expected STUDY_points.csv in two folders, or in the "
                 "docs/tables of a commit")
    show(("study", "quantity", "points", "moved by, median", "most", "there from, to",
          "old median in the new range", "widest range, old, new"), rows)


def read(version, study):
    """Table of points of a folder or a commit by point and solver, or None where it has none."""
    source = Path(version) / f"{study}_points.csv"
    if not Path(version).is_dir():
        done = subprocess.run(["git", "show", f"{version}:docs/tables/{study}_points.csv"], cwd=REPOSITORY,
                              capture_output=True)
        source = io.BytesIO(done.stdout) if done.returncode == 0 else None
    if source is None or (isinstance(source, Path) and not source.exists()):
        return None
    return pd.read_csv(source, keep_default_na=False, na_values=[""]).set_index(["point", "solver"])


def rows_of(study, old, new):
    """Rows of a study's table, solver by solver; none where a version has no table."""
    if old is None or new is None:
        return
    solvers = sorted(set(new.index.get_level_values("solver")))
    for solver in solvers:
        label = study if len(solvers) == 1 else f"{study}, {solver}"
        both = [table[table.index.get_level_values("solver") == solver] for table in (old, new)]
        for row in filter(None, (row_of(*both, *measure) for measure in MEASURES)):
            yield label, *row
            label = ""


def short(point):
    """A point's name without what all of its study share."""
    point = re.sub(r"record-([A-Z0-9]+)_\S*?_scale-([0-9.]+)(_window-[0-9.-]+)?", r"\1 x \2", point)
    return re.sub(r"_rest-[0-9.]+", "", point).replace("_", " ")


def row_of(old, new, old_name, new_name, label, factor, digits):
    """Cells of the points that both have and that stood in both; of ranges, those of several runs."""
    old_name = new_name if new_name in old else old_name  # tables since 0.2 have all definitions of slip
    if old_name not in old or new_name not in new:
        return None
    names = [name for which in ("old", "new") for name in (which, f"{which}_min", f"{which}_max", f"{which}_collapsed")]
    parts = [table[[name, f"{name}_min", f"{name}_max", "collapsed"]]
             for table, name in ((old, old_name), (new, new_name))]
    both = pd.concat(parts, axis=1, join="inner").set_axis(names, axis=1)
    both = both[(both["old_collapsed"] == 0) & (both["new_collapsed"] == 0)].dropna(subset=["old", "new"])
    if both.empty:
        return None
    off = (both["new"] - both["old"]).abs()
    most, several = off.idxmax(), both[new.loc[both.index, "members"] > 1]

    def texts(*values):
        return ", ".join(f"{factor * value:.{digits}f}" for value in values)

    inside = several["old"].between(several["new_min"], several["new_max"]).sum()
    widths = [(several[f"{which}_max"] - several[f"{which}_min"]).max() for which in ("old", "new")]
    ranges = (f"{inside} of {len(several)}", texts(*widths)) if len(several) else ("-", "-")
    return (label, len(both), texts(off.median()), f"{texts(off.max())} ({short(most[0])})",
            texts(*both.loc[most, ["old", "new"]]), *ranges)
