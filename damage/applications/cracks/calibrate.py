"""Joint properties from tests of two or three bricks: stiffnesses, and cohesion and friction by a
Mohr-Coulomb line through the peaks of triplets (EN 1052-3:2002, 8.2).

A couplet is tested across its joint, in compression, tension or by a bond wrench; a triplet is
sheared under a precompression.
"""

import math

import numpy as np
import pandas as pd
import scipy  # stats where it is used: it starts slowly

from damage.applications.cracks.capacity import pushed_loading
from damage.csv_table import read_csv
from damage.draw.words import counted
from damage.errors import InputError
from damage.fields import Column, ranges_of, short
from damage.units import MILLIMETRE
from damage.wall.parameters import Joint
from damage.wall.restraints import top_of

MPA = 1e6
COLUMNS = {
    "specimen": Column("", "its name; its rows in the order of loading", "U"),
    "normal_stress_mpa": Column(
        "MPa",
        "on the joint, tension positive, of a bond wrench at the edge; of a triplet minus the"
        " precompression",
        least=-1000,
        most=1000,
    ),
    "opening_mm": Column("mm", "of a couplet: across the joint there", least=-100, most=100),
    "shear_stress_mpa": Column(
        "MPa", "of a triplet: half of the force over the area of a joint", least=-1000, most=1000
    ),
    "slip_mm": Column("mm", "of a triplet: of the brick in the middle", least=-100, most=100),
}
ELASTIC = 0.1, 0.5
"""Shares of the largest stress between which a stiffness is taken, on first loading [-]."""
LEAST_PER_LEVEL = LEAST_LEVELS = 3
"""Specimens at each precompression, and precompressions, that EN 1052-3 asks for."""
CHARACTERISTIC = 0.8
"""Characteristic cohesion and friction over the mean ones (EN 1052-3)."""


def read_tests(path):
    """The rows of a CSV file of tests, a DataFrame with COLUMNS.  Raises InputError, with the line,
    where the file does not fit."""
    table = read_csv(path, COLUMNS, ("specimen", "normal_stress_mpa"))
    table.refuse_empty("specimen", "normal_stress_mpa")
    rows = table.rows
    sheared = rows["shear_stress_mpa"].notna()
    opened = rows["opening_mm"].notna()
    table.refuse(
        ~(sheared ^ opened), "expected opening_mm of a couplet, or shear_stress_mpa of a triplet"
    )
    table.refuse(
        sheared & (rows["normal_stress_mpa"] > 0),
        "normal_stress_mpa above zero of a triplet: expected minus its precompression; correct it",
    )
    return rows


def rows_of(history):
    """Rows of a couplet or triplet test, of a pushed History of one course of rigid bricks: a
    triplet where a restraint holds its top, else a couplet.  What half a brick deforms is taken
    off, as a laboratory does.  Raises InputError for another wall."""
    wall = history.masonry_wall
    series = history.series
    pushed_loading(history)
    if wall.courses != 1 or wall.openings:
        raise InputError(
            f"{history.path} is of wall {wall.name}: expected a couplet or a triplet, a wall of one"
            " course; copy walls/triplet.toml"
        )
    brick = wall.brick
    area = wall.length * wall.brick.thickness
    if top_of(wall):
        shear = series["top_force_n"] / (2 * area)
        slip = series["top_displacement_m"] - shear * brick.height / 2 / brick.shear_modulus
        rows = {
            "normal_stress_mpa": -wall.precompression / MPA,
            "shear_stress_mpa": shear / MPA,
            "slip_mm": slip / MILLIMETRE,
        }
    else:
        sample = np.searchsorted(series["time_s"], history.snapshot_time_s[:-1])
        edge = -history.support_force[sample, 0, 2] / (area * wall.length / 6)
        opening = -history.displacement[:-1, 0, 2] * wall.length / 2
        opening -= edge * brick.height / 2 / brick.young_modulus
        rows = {"normal_stress_mpa": edge / MPA, "opening_mm": opening / MILLIMETRE}
    return pd.DataFrame({"specimen": history.path.stem, **rows}).reindex(columns=list(COLUMNS))


def joined(tables):
    """Rows of several tables as one.  Raises InputError where two have a specimen of one name."""
    names = pd.Series([name for table in tables for name in table["specimen"].unique()])
    for name in names[names.duplicated()][:1]:
        raise InputError(
            f"specimen {name} is in two files: expected a name for each; rename one, or its file"
        )
    return pd.concat(tables, ignore_index=True)


def calibrated(tests):
    """Joint properties from rows with COLUMNS, a plain dictionary; what no specimen shows is left
    out.

    normal_stiffness, shear_stiffness [Pa/m], cohesion [Pa], friction [-]: {"value",
    "standard_error": None of a single specimen, "scatter": coefficient of variation between
    specimens, of cohesion and friction that of the peaks about the line, "specimens"}; of the last
    two "characteristic", too.  notes: what the standard asks for and the tests lack, and values
    that no joint has.
    """
    triplets = tests[tests["shear_stress_mpa"].notna()]
    couplets = tests[tests["shear_stress_mpa"].isna()]
    values = {
        "normal_stiffness": _stiffness(couplets, "normal_stress_mpa", "opening_mm"),
        "shear_stiffness": _stiffness(triplets, "shear_stress_mpa", "slip_mm"),
    }
    values = {name: value for name, value in values.items() if value}
    notes = []
    if len(triplets):
        line, notes = _mohr_coulomb(triplets)
        values |= line
    return {**values, "notes": [*notes, *_implausible(values)]}


def _implausible(values):
    """Lines on values below zero or outside the plausible values of a Joint, which a wall file with
    them would be refused for."""
    ranges = ranges_of(Joint)
    angle = ranges["Joint.friction_angle"]
    ranges["Joint.friction"] = angle._replace(
        least=math.tan(angle.least), most=math.tan(angle.most), unit="[-]"
    )
    for name, result in values.items():
        value = result["value"]
        least, most, unit, *_ = ranges[f"Joint.{name}"]
        if value < 0:
            yield f"the line has a negative {name}: look at the tests, or take zero"
        elif not least <= value <= most:
            limit, end = (least, "least") if value < least else (most, "largest")
            yield (
                f"{name} is {value / limit:.2g} times the {end} plausible value, {short(limit)}"
                f" {unit}: look at the units of the columns"
            )


def _stiffness(rows, stress, displacement):
    """Mean slope of stress over displacement of the specimens [Pa/m], a table as of `calibrated`;
    None without any.  Zero stress is that of the column, wherever the first row lies."""
    slopes = []
    for name, test in rows.dropna(subset=[stress, displacement]).groupby("specimen", sort=False):
        load = test[stress].abs()
        rising = test.loc[: load.idxmax()]
        share = rising[stress].abs() / load.max()
        elastic = rising[share.between(*ELASTIC)]
        if len(test) > 1 and elastic[displacement].nunique() < 2:
            raise InputError(
                f"specimen {name}: {counted(len(elastic), 'row')} between {ELASTIC[0]:g} and"
                f" {ELASTIC[1]:g} of its largest {stress}, {load.max():g}, the first row at"
                f" {share.iloc[0]:.2g} of it; expected two or more whose {displacement} differs,"
                f" for a stiffness; add some, or leave {displacement} empty"
            )
        if len(elastic) > 1:
            slope = abs(scipy.stats.linregress(elastic[displacement], elastic[stress]).slope)
            slopes.append(slope * MPA / MILLIMETRE)
    if not slopes:
        return None
    mean = np.mean(slopes)
    deviation = np.std(slopes, ddof=1) if len(slopes) > 1 else math.nan
    return _value(mean, deviation / np.sqrt(len(slopes)), deviation / mean, len(slopes))


def _mohr_coulomb(triplets):
    """Cohesion and friction from the peaks of triplets, a line by least squares, and notes."""
    peaks = triplets.assign(shear_stress_mpa=triplets["shear_stress_mpa"].abs()).groupby("specimen")
    rows = triplets.loc[peaks["shear_stress_mpa"].idxmax()]
    normal = -rows["normal_stress_mpa"]
    shear = rows["shear_stress_mpa"].abs()
    levels = (normal / normal.max()).round(1).value_counts()
    if len(levels) < 2 or len(rows) < 3:
        raise InputError(
            f"{len(rows)} triplets under {len(levels)} precompression(s): expected three or more"
            " under two or more, for a line; test more"
        )
    notes = []
    if len(levels) < LEAST_LEVELS or levels.min() < LEAST_PER_LEVEL:
        notes.append(
            f"{levels.min()} or more triplets under each of {len(levels)} precompressions; EN"
            f" 1052-3 asks for {LEAST_PER_LEVEL} under each of {LEAST_LEVELS}"
        )
    line = scipy.stats.linregress(normal, shear)
    fitted = line.intercept + line.slope * normal
    scatter = np.sqrt(np.sum((shear / fitted - 1) ** 2) / (len(rows) - 2))
    values = {
        "cohesion": (line.intercept * MPA, line.intercept_stderr * MPA),
        "friction": (line.slope, line.stderr),
    }
    return {
        name: {
            **_value(*value, scatter, len(rows)),
            "characteristic": CHARACTERISTIC * float(value[0]),
        }
        for name, value in values.items()
    }, notes


def _value(value, standard_error, scatter, specimens):
    numbers = {"value": value, "standard_error": standard_error, "scatter": scatter}
    return {
        name: None if math.isnan(number) else float(number) for name, number in numbers.items()
    } | {"specimens": specimens}


def describe(values):
    """Text of what `calibrated` found: the table [joint] of a wall file."""
    lines = ["[joint]"]
    for name, value in values.items():
        if name == "notes":
            continue
        error = value["standard_error"]
        scatter = value["scatter"]
        counts = [counted(value["specimens"], "specimen")]
        counts += [] if error is None else [f"standard error {error:.2g}"]
        counts += [] if scatter is None else [f"scatter {100 * scatter:.2g} %"]
        if "characteristic" in value:
            counts.append(f"characteristic {value['characteristic']:.3g}")
        lines.append(f"{name} = {value['value']:.4g}".ljust(34) + f"# {', '.join(counts)}")
    if "cohesion" in values:
        scatter = values["cohesion"]["scatter"]
        lines.append(f"# strengths of a wall's joints: --strength-cov {scatter:.2g}")
    return "\n".join([*lines, *(f"# note: {note}" for note in values["notes"])])
