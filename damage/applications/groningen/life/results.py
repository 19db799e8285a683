"""Results of lives: what each event did to each wall, and what became of the walls over the years.

`python3 -m damage lives FOLDER` takes the folder of a study with lives.
"""

import json
from dataclasses import replace
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import pandas as pd

from damage.applications.groningen.exposure.columns import TABLES
from damage.applications.groningen.exposure.lives import Draws, read_address
from damage.applications.groningen.life.estimate import probability
from damage.applications.studies.definition import load_study, study_of
from damage.applications.studies.folder import ROOT
from damage.applications.studies.records import read_records
from damage.errors import InputError
from damage.files import write_text
from damage.measure.tables import write_table
from damage.provenance import shown_path
from damage.wall.file import wall_path

OUTCOMES = {"psi": "at rest", "max_psi": "at any moment"}
VISIBLE = 1.0, 2.0
"""Values of Psi whose probabilities are given: one crack of 0.1 mm, one of 1 mm."""
POPULATION = 4000
"""Lives that are drawn and not run, for the distribution of PGV."""
NAME = "lives.toml"
POINT = "life"
LARGEST = "life_largest"


def life_study(folder, wall, address, options, lives):
    """The Study of lives with all events and with the largest alone, in a folder.

    wall: its file or the name of one that ships; address: {key of
    `damage.applications.groningen.exposure.lives.KEYS`: value}, None where not given; options: of
    each run, {name: value}; lives: their number.
    """
    points = {POINT: (address, options), LARGEST: (address | {"largest_alone": True}, options)}
    conclusion = {"conclusion": "python3 -m damage lives"}
    path = Path(folder) / NAME
    return study_of_lives(path, wall, points, lives, command="life", more=conclusion)


def study_of_lives(path, wall, points, lives, command, more=MappingProxyType({})):
    """The Study of so many lives of each point; its file `path`, and the addresses' files beside
    it, are written.

    points: {name: (address, options)} as of `life_study`; command: that asks for it; more: keys of
    the study.
    """
    wall = wall_path(wall)
    study = {"name": path.stem, "pictures": "none", **more}
    text = [
        f"# {lives} lives of {shown_path(wall)}; written by python3 -m damage {command}",
        *_toml(study),
    ]
    entries = []
    for point, (address, options) in points.items():
        lines = _toml({name: value for name, value in address.items() if value is not None})
        place = path.with_name(f"{point}.address.toml")
        write_text(place, "".join(f"{line}\n" for line in lines))
        entry = {"id": point, "wall": str(Path(wall).resolve()), "lives": lives}
        given = {"address": str(place.resolve()), **options}
        entries.append({**entry, "options": given})
        text += ["", "[[runs]]", *_toml(entry), f"options = {{ {', '.join(_toml(given))} }}"]
    write_text(path, "\n".join(text) + "\n")
    return study_of({**study, "runs": entries}, path, root=ROOT)


def _toml(table):
    """Lines of a flat table as TOML; JSON's numbers, words and lists are TOML's."""
    return [f"{name} = {json.dumps(value)}" for name, value in table.items()]


SETTLEMENT = "settlement"
"""Place and identifier of event 0 of a life on ground that settled."""
_SETTLED = {
    "max_psi": "settled_psi",
    "psi": "settled_psi",
    "max_DI": "settled_DI",
    "DI": "settled_DI",
    "crack_width_mm": "settled_crack_width_mm",
}
_SOURCES = {
    "max_psi": "max_psi",
    "psi": "residual_psi",
    "max_DI": "max_DI",
    "DI": "residual_DI",
    "crack_width_mm": "residual_crack_width_mm",
    "offset_after_mm": "offset_after_mm",
    "newly_failed": "newly_failed",
}


class Lives(NamedTuple):
    """The lives of a point.

    draws: Draws of its address; table: a row an event, with the columns of lives.csv.
    """

    point: str
    draws: Draws
    table: pd.DataFrame

    @property
    def years(self):
        """First and last year of the catalogue."""
        return self.draws.exposure.catalogue.years

    @property
    def last(self):
        """The last row of every life, by seed and life, with the largest Psi of all of it."""
        return self.until(self.years[1])

    def until(self, year):
        """State of every life at the end of a year, by (seed, life): psi, max_psi, DI,
        crack_width_mm, largest_mm_s."""
        keys = ["seed", "life"]
        every = self.table.groupby(keys)["largest_mm_s"].first()
        so_far = self.table[self.table["time_utc"].str[:4].astype(int) <= year]
        states = so_far.groupby(keys).last().reindex(every.index)
        fell = states["fell"].eq(True)
        final = states[["psi", "DI", "crack_width_mm"]].astype(float).fillna(0.0)
        final["max_psi"] = so_far.groupby(keys)["max_psi"].max().reindex(every.index).fillna(0.0)
        final.loc[fell, ["psi", "max_psi"]] = np.inf
        return final.assign(largest_mm_s=every)

    def population(self):
        """Largest PGV (POPULATION,) [mm/s] of lives that are drawn only."""
        return self.draws.largest(range(1, POPULATION + 1))


def lives_of(folder):
    """Lives of the points of a study's folder, a list: those of one point and different seeds
    together, each life once.  InputError where there is none; points without lives are left out."""
    folder = Path(folder)
    study = load_study(folder / "study.toml", "reference")
    records = read_records(folder)
    parts = {}
    for run in study.runs:
        done = records.of_point(run) if run.varied == "life" else {}
        for number, record in done.items():
            draws = read_address(dict(run.options)["address"])
            _, tables = parts.setdefault(run.entry, (draws, []))
            tables.append(life_of(record, draws, run.offset + number).assign(point=run.entry))
    if not parts:
        raise InputError(
            f"{folder}: no life in it; expected the folder of a study with lives, as python3 -m"
            " damage life makes it"
        )
    columns = list(TABLES["lives.csv"])
    return [
        Lives(point, draws, pd.concat(tables).drop_duplicates(["seed", "life", "event"])[columns])
        for point, (draws, tables) in parts.items()
    ]


def life_of(record, draws, number):
    """Table of a life, from its record: a row an event, with the columns of lives.csv but `point`.

    A settlement of the ground is event 0.  A wall that fell undergoes no further event.
    """
    events = pd.DataFrame(record["shocks"])
    table = draws.life(number).iloc[: len(events)].drop(columns=["start_s", "end_s"])
    if len(table) != len(events) or not np.allclose(table["scale"], events["factor"], rtol=1e-12):
        raise InputError(
            f"{record['run']}: its events are not those of its address's file; expected these, run"
            " the study again"
        )
    for name, source in _SOURCES.items():
        table[name] = (
            events[source]
            .astype(float)
            .fillna(events[source.replace("residual_", "max_")])
            .to_numpy()
        )
    fell = record["row"].get("collapsed_at_s")
    table = table.assign(
        event=np.arange(1, len(table) + 1),
        fell=[False] * (len(table) - 1) + [fell is not None and fell == fell],
    )
    return pd.concat([*_settlement(record["row"], draws), table], ignore_index=True).assign(
        seed=draws.choices.seed, life=number, largest_mm_s=draws.largest([number])[0]
    )


def _settlement(row, draws):
    """Row of event 0 of a life, in a list that is empty where the ground rested; row: of
    summary.csv."""
    if row.get("settled_psi") is None:
        return []
    return [
        pd.DataFrame(
            [
                {
                    "event": 0,
                    "time_utc": f"{draws.exposure.catalogue.years[0]}-01-01T00:00:00",
                    "place": SETTLEMENT,
                    "id": SETTLEMENT,
                    "pgv_mm_s": 0.0,
                    "record": row["settlement"],
                    "scale": np.nan if row["distortion"] is None else row["distortion"],
                    "fell": False,
                    **{name: float(row[source]) for name, source in _SETTLED.items()},
                }
            ]
        )
    ]


def largest_alone(parts):
    """Return {point: (lives with all events, the same with the largest alone)} of the points that
    have both, as DataFrames of `Lives.until` with equal rows."""
    alone = {}
    for part, other in product(parts, repeat=2):
        # of the same place and choices, and of a point with the same name and one word more
        if (
            other.point.rpartition("_")[0] == part.point
            and other.draws.exposure.place == part.draws.exposure.place
            and not part.draws.choices.largest_alone
            and other.draws.choices == replace(part.draws.choices, largest_alone=True)
        ):
            first = part.last
            second = other.last
            both = first.index.intersection(second.index)
            if len(both) > 1:
                alone[part.point] = first.loc[both], second.loc[both]
    return alone


def over_time(lives):
    """DataFrame with a row a year: medians over the lives, and probabilities with 95 % intervals;
    columns of life.csv."""
    rows = []
    population = lives.population()
    for year in range(lives.years[0], lives.years[1] + 1):
        now = lives.until(year)
        row = {
            "point": lives.point,
            "year": year,
            "lives": len(now),
            **{
                f"median_{name}": now[name].median()
                for name in ("psi", "max_psi", "DI", "crack_width_mm")
            },
        }
        for name, level in product(OUTCOMES, VISIBLE):
            estimate = probability(now[name] >= level, now["largest_mm_s"], population)
            row |= zip(
                (f"p_{name}_{level:g}{end}" for end in ("", "_low", "_high")),
                (estimate.p, *estimate.interval),
            )
        rows.append(row)
    return pd.DataFrame(rows)[list(TABLES["life.csv"])]


def contributions(lives):
    """What each event of the catalogue contributes, DataFrame with the largest first; columns of
    contributions.csv."""
    table = lives.table.copy()
    keys = ["seed", "life"]
    table["gain"] = table["psi"] - table.groupby(keys)["psi"].shift(fill_value=0.0)
    table["leads"] = (table["gain"] > 0) & (
        table["gain"] == table.groupby(keys)["gain"].transform("max")
    )
    n_lives = table.groupby(keys).ngroups
    events = (
        table.groupby("id")
        .agg(
            time_utc=("time_utc", "first"),
            magnitude=("magnitude", "first"),
            place=("place", "first"),
            lives=("life", "size"),
            mean_psi=("gain", "sum"),
            largest=("leads", "sum"),
        )
        .reset_index()
    )
    events[["mean_psi", "largest"]] /= n_lives
    total = events["mean_psi"].sum()
    events = events.assign(point=lives.point, share=events["mean_psi"] / total if total else 0.0)
    events = events.sort_values("mean_psi", ascending=False, ignore_index=True)
    return events[list(TABLES["contributions.csv"])]


def describe(parts):
    """Text: what became of the lives."""
    lines = []
    pairs = largest_alone(parts)
    for part in parts:
        last = part.last
        population = part.population()
        events = part.table[part.table["event"] > 0].groupby(["seed", "life"]).size()
        settled = part.table.loc[part.table["event"] == 0, "psi"]
        settlement = [
            f"  after the settlement: median Psi {settled.median():.2f} ({settled.min():.2f} to"
            f" {settled.max():.2f})"
        ] * (len(settled) > 0)
        lines += [
            (
                f"{part.point}: {len(last)} lives, {part.years[0]} to {part.years[1]},"
                f" {events.median():g} events in the median life ({events.min()} to"
                f" {events.max()}), median of the largest PGV {last['largest_mm_s'].median():.1f}"
                " mm/s"
            ),
            *(f"  warning: {warning}" for warning in part.draws.exposure.warnings),
            *settlement,
            (
                f"  at the end: median Psi {last['psi'].median():.2f}, median DI"
                f" {last['DI'].median():.4f}, median of the largest Psi"
                f" {last['max_psi'].median():.2f}"
            ),
        ]
        for name, level in product(OUTCOMES, VISIBLE):
            estimate = probability(last[name] >= level, last["largest_mm_s"], population)
            low, high = estimate.interval
            lines.append(
                f"  P(Psi >= {level:g}) {OUTCOMES[name]} = {estimate.p:.3f}, 95 % interval"
                f" {low:.3f} to {high:.3f}; for +-0.03: {estimate.lives_for(0.03)} lives"
            )
        if part.point in pairs:
            first, second = pairs[part.point]
            damaged = (first["psi"] > 0) & np.isfinite(first["psi"])
            if damaged.any():
                share = second.loc[damaged, "psi"] / first.loc[damaged, "psi"]
                lines.append(
                    f"  the largest event alone leaves {share.median():.2f} of the final Psi"
                    f" (median of {int(damaged.sum())} damaged walls; quartiles"
                    f" {share.quantile(0.25):.2f} to {share.quantile(0.75):.2f})"
                )
    return "\n".join(lines)


def write_lives(parts, folder):
    """Write the tables of lives into a folder; returns their paths.

    lives.csv: events; life.csv: year by year; contributions.csv: of each event.
    """
    folder = Path(folder)
    tables = {
        "lives.csv": pd.concat([part.table for part in parts]),
        "life.csv": pd.concat(map(over_time, parts)),
        "contributions.csv": pd.concat(map(contributions, parts)),
    }
    return [write_table(table, folder / name) for name, table in tables.items()]
