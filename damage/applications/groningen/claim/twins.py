"""Twins: each draw of motions, site, strengths and settlement by both causes, by each alone, and by
none.

A study has two points of lives with common random numbers: *shaken*, by the earthquakes on ground
at rest, and *both*, on ground that settled before the first one.  What the settlement did alone is
where *both* stood before the first earthquake, and a wall without either cause is where *shaken*
stood.
"""

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from damage.applications.cracks.at_rest import ENDING, FOLDER, SETTLED, START, read_patterns
from damage.applications.groningen.exposure.lives import read_address
from damage.applications.groningen.life.results import life_of, study_of_lives
from damage.applications.studies.definition import load_study
from damage.applications.studies.records import read_records
from damage.errors import InputError
from damage.measure.columns import MADE_BY
from damage.provenance import UNKNOWN
from damage.wall.geometry import joint_table, tributary_ends

NAME = "claim.toml"
SHAKEN = "shaken"
BOTH = "both"
"""Points of the study."""
STATES = {
    "none": (SHAKEN, START),
    "settlement": (BOTH, SETTLED),
    "earthquakes": (SHAKEN, None),
    "both": (BOTH, None),
}
"""{what acted: (point, moment of `damage.applications.cracks.at_rest`, None for the last)}."""
DRAWN = ("hogging", "sagging", "knick"), (1 / 6000, 1 / 450)
"""Profiles and distortions that the settlement is drawn from where nothing is known of it."""


def causes_of(address, options, settlement):
    """{point of the study: (address, options of its runs)}.

    address, options: as of `damage.applications.groningen.life.results.life_study`; settlement:
    options of a settlement of known shape and size, {} for one of DRAWN.
    """
    ground = {} if settlement else dict(zip(("settle", "distortion"), map(list, DRAWN)))
    # For both: by default, walls on ground that settled would have local damping, which leaves
    # other cracks at rest than the adaptive one of the others.
    options = {"supports": "bricks", "settling": "adaptive", **options}
    # longest first, so that the last runs do not step alone
    return {BOTH: (address | ground, options | settlement), SHAKEN: (address, options)}


def twins_study(folder, wall, causes, draws):
    """The Study of a claim in a folder; causes: of `causes_of`; draws: their number."""
    return study_of_lives(Path(folder) / NAME, wall, causes, draws, "claim")


@dataclass(frozen=True)
class Twins:
    """The draws of a claim that are done.

    numbers: (n,) of the lives; opening_m, offset_m: {of STATES: (n, n_joints)} [m] at rest; fell:
    {of STATES: (n,)}; ends: (n_joints, 2, 2) [m] of the contact points; events: {of SHAKEN, BOTH:
    table of `damage.applications.groningen.life.results.life_of` of all draws}; settlement: a row a
    draw: profile, distortion; made_by: {of MADE_BY: what it was when the draws were made}; outside:
    of each run, which quantities are outside the range of validity, in words.
    """

    numbers: np.ndarray
    opening_m: dict
    offset_m: dict
    fell: dict
    ends: np.ndarray
    events: dict
    settlement: pd.DataFrame
    made_by: dict = field(default_factory=dict)
    outside: tuple[str, ...] = ()

    def __len__(self):
        return len(self.numbers)

    @property
    def ground_is_known(self):
        """Whether all draws have the same settlement."""
        return len(self.settlement.drop_duplicates()) == 1

    @cached_property
    def width_m(self):
        """{of STATES: width of the widest crack (n,) [m]}, infinite of a wall that fell."""
        return self.widest_of(slice(None))

    def widest_of(self, joints):
        """Widest crack of some joints."""
        return {
            name: np.where(
                self.fell[name],
                np.inf,
                np.hypot(self.opening_m[name][:, joints], self.offset_m[name][:, joints]).max(
                    axis=1
                ),
            )
            for name in STATES
        }


def read_twins(folder, layout):
    """As `twins_of`, of a claim that was made."""
    folder = Path(folder)
    draws = {cause: read_address(folder / f"{cause}.address.toml") for cause in (SHAKEN, BOTH)}
    return twins_of(load_study(folder / NAME), draws, folder, layout)


def twins_of(study, draws, folder, layout):
    """The Twins whose runs are both done.  Raises InputError without two.

    study: of `twins_study`; draws: {point: Draws of its address}; layout: of the wall.
    """
    records = read_records(folder)
    done = {SHAKEN: {}, BOTH: {}}
    for run in study.runs:
        for number, record in records.of_point(run).items():
            path = folder / FOLDER / f"{run.name(number)}{ENDING}"
            if path.is_file():
                done[run.entry][run.offset + number] = record, path
    numbers = sorted(done[SHAKEN].keys() & done[BOTH].keys())
    if len(numbers) < 2:
        raise InputError(
            f"{folder}: {len(numbers)} draws are done; expected at least two; run the claim again"
        )
    runs = {point: [lives[number] for number in numbers] for point, lives in done.items()}
    patterns = {
        point: [read_patterns(path, record.get("patterns")) for record, path in lives]
        for point, lives in runs.items()
    }
    whole = {
        name: np.array(
            [pattern.of_moment(moment, layout.n_joints) for pattern in patterns[point]], "f4"
        )
        for name, (point, moment) in STATES.items()
    }
    rows = {point: [record["row"] for record, _ in lives] for point, lives in runs.items()}
    fell = {
        point: np.array([row.get("collapsed_at_s") is not None for row in of_point])
        for point, of_point in rows.items()
    }
    every_row = [*rows[SHAKEN], *rows[BOTH]]
    return Twins(
        numbers=np.array(numbers),
        opening_m={name: at_rest[:, 0] for name, at_rest in whole.items()},
        offset_m={name: at_rest[:, 1] for name, at_rest in whole.items()},
        fell={
            name: fell[point] if moment is None else np.zeros(len(numbers), bool)
            for name, (point, moment) in STATES.items()
        },
        ends=tributary_ends(joint_table(layout))[: layout.n_joints],
        events={
            point: pd.concat(
                [
                    life_of(record, draws[point], number)
                    for number, (record, _) in zip(numbers, lives)
                ],
                ignore_index=True,
            )
            for point, lives in runs.items()
        },
        settlement=pd.DataFrame(
            [{"profile": row["settlement"], "distortion": row["distortion"]} for row in rows[BOTH]]
        ),
        made_by=_made_by(folder, every_row),
        outside=tuple(row["outside_validity"] or "" for row in every_row),
    )


def _made_by(folder, rows):
    """`made_by` of Twins; rows: of their runs.  Raises InputError where they are of more than one
    version."""
    values = {name: sorted({str(row.get(name) or UNKNOWN) for row in rows}) for name in MADE_BY}
    for name, versions in values.items():
        if name.endswith("digest") and len(versions) > 1:
            raise InputError(
                f"{folder}: draws of {len(versions)} versions, {name} {', '.join(versions)}:"
                " expected one on a sheet; make the claim again with --remake"
            )
    return {name: ", ".join(versions) for name, versions in values.items()}
