"""The readers that damaged files are given to: for each the undamaged files, how they are damaged, how they are read.

Wall files in Python are no data and may do anything, and histories and tables of runs are written by this program alone
(`tests/test_damaged_history.py`, `test_columns.py`): they are not among them.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import damage
from damage.files import DATA
from damage.laboratory import dic
from damage.measure import crack_file
from damage.measure.crack_mapping import map_cracks
from damage.measure.crack_paths import crack_paths
from damage.motion.formats import read_record, shipped_record_path
from damage.studies.definition import load_study
from damage.units import GRAVITY
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from tests.fuzz.mutators import MINISEED, TEXT, XML, mutate

REPOSITORY = Path(__file__).resolve().parents[2]
TRACE = "NL.BGAR..HGE"


@dataclass(frozen=True)
class Reader:
    """damage(folder, random): (bytes of a damaged file, what was done); use(path): reads it; suffix: of its name;
    needs: a library that is an optional extra."""

    damage: Callable
    use: Callable
    suffix: str
    needs: str = ""

    @property
    def lacking(self):
        """The library that is missing, or ""."""
        return "" if not self.needs or find_spec(self.needs) else self.needs


def _of(seeds, kinds, largest=10**6):
    """A `damage` of what `seeds(folder)` gives, a list of bytes."""
    def damage(folder, random):
        others = seeds(folder)
        return mutate(random.choice(others), random, others, kinds, largest)
    return damage


def _files(*patterns, first=None):
    @cache
    def seeds(folder):
        paths = [path for pattern in patterns for path in sorted(REPOSITORY.glob(pattern))]
        return ["".join(path.read_text().splitlines(keepends=True)[:first]).encode() for path in paths]
    return seeds


# --- undamaged files that are made ----------------------------------------------------------------

@cache
def _at2(folder):
    """A shipped record in both of PEER's layouts."""
    record = read_record(shipped_record_path("BGAR_HGE"))
    values = [f"{value: .7E}" for value in record.acceleration_m_s2[:2000] / GRAVITY]
    rows = "\n".join("  ".join(values[k:k + 5]) for k in range(0, len(values), 5))
    head = "PEER STRONG MOTION DATABASE RECORD\nZEERIJP, BGAR, HGE\nACCELERATION TIME SERIES IN UNITS OF G\n"
    return [f"{head}{count}\n{rows}\n".encode()
            for count in (f"NPTS=  {len(values)}, DT=  .0050 SEC", f" {len(values)}  .0050  NPTS, DT")]


@cache
def _shipped(pattern):
    return [path.read_bytes() for path in sorted(DATA.glob(pattern))]


@cache
def _run(folder):
    return damage.run(load_wall(REPOSITORY / "walls" / "variants" / "small.py"), harmonic=(0.06, 0.6), cycles=2,
                      rest=0.05)


@cache
def _layout():
    return lay_out(load_wall(REPOSITORY / "walls" / "variants" / "small.py"))


@cache
def _cracks(folder):
    """Cracks of a run at two samples, and drawn by hand with every way of giving sizes."""
    path, run = folder / "cracks.csv", _run(folder)
    crack_file.write_cracks(path, crack_file.patterns_of(run, (len(run.series) // 2, len(run.series) - 1)), ["a run"])
    drawn = ("# by hand\ncrack,point,x_m,z_m,width_mm,opening_mm,slip_mm,mode\na,1,0,0.1,1,,,tension\na,2,0.4,0.1,,,,\n"
             "b,1,0.1,0.2,,0.3,0.4,mixed\nb,2,0.1,0.5,0.5,,,shear\nb,3,0.5,0.6,,,,\nb,1,0.2,0.2,1,0.6,,\nb,2,0.9,0.2,,,,\n")
    return [path.read_bytes(), drawn.encode()]


@cache
def _field(folder):
    """Points of a wall that turns as a whole, two load levels, some points lost; and a small one without levels."""
    x, z = (part.ravel() for part in np.meshgrid(np.arange(0.01, 0.9, 0.03), np.arange(-0.05, 0.6, 0.03)))
    rows = [f"{level},{0.1 * level},{x[k]:.4f},{z[k]:.4f},"
            + ("," if k % 50 == 7 else f"{-1e-3 * level * z[k]:.6g},{1e-3 * level * x[k]:.6g}")
            for level in (1, 2) for k in range(len(x))]
    small = "".join(f"{x[k]:.3f},{z[k]:.3f},0,1e-4\n" for k in range(0, len(x), 3))
    return [("# a field\nload_level,drift_pct,x_m,z_m,ux_m,uz_m\n" + "\n".join(rows) + "\n").encode(),
            f"x_m,z_m,ux_m,uz_m\n{small}".encode()]


# --- how they are read ----------------------------------------------------------------------------

def _map(path):
    for pattern in crack_file.read_cracks(path):
        map_cracks(pattern, _layout())
        crack_paths(pattern.stretches, _layout())


def _measure(path):
    fields = dic.read_field(path)
    dic.report(dic.measure(fields, _layout()), _layout())


STATION = DATA / "zeerijp_20180108" / "NL.BGAR.xml"
READERS = {
    "csv": Reader(_of(_files("damage/data/*/*_acc_m_s2.csv", first=2000), TEXT, 5e7), read_record, ".csv"),
    "at2": Reader(_of(_at2, TEXT, 5e7), read_record, ".at2"),
    "miniseed": Reader(_of(lambda folder: _shipped("*/*.mseed"), MINISEED, 5e7),
                       lambda path: read_record(path, STATION), ".mseed", "obspy"),
    "stationxml": Reader(_of(lambda folder: _shipped("*/NL.BGAR.xml"), XML, 5e7),
                         lambda path: read_record(shipped_record_path(TRACE), path), ".xml", "obspy"),
    "study": Reader(_of(_files("studies/*.toml"), TEXT, 1e7),
                    lambda path: load_study(path, "both", REPOSITORY), ".toml"),
    "wall": Reader(_of(_files("walls/*.toml"), TEXT, 1e6), load_wall, ".toml"),
    "cracks": Reader(_of(_cracks, TEXT, 5e7), _map, ".csv"),
    "dic": Reader(_of(_field, TEXT, 5e7), _measure, ".csv"),
}
