"""Running lives: each is a sequence of records on one wall; its events' table is kept, and not computed again."""

import hashlib
import json
from pathlib import Path

import numpy as np
import pandas as pd

from damage.errors import InputError
from damage.files import write_text
from damage.history.schema import Column
from damage.life.draw import write_sequence
from damage.measure.tables import shocks_table, write_table
from damage.reference.python import run
from damage.wall.file import wall_path

VISIBLE = 1.0, 2.0
"""Psi whose probability is reported."""
Z95 = 1.959964
COLUMNS = {
    "life": Column("1", "number of the life, from 1"), "time_utc": Column("", "of the event"),
    "magnitude": Column("1", "local magnitude ML"), "place": Column("", "place nearest to the epicentre"),
    "id": Column("", "identifier of the catalogue"), "pgv_mm_s": Column("mm/s", "PGV that was drawn"),
    "record": Column("", "record that stands for the motion"), "scale": Column("1", "factor on it"),
    "max_psi": Column("1", "largest Psi in the event"),
    "psi": Column("1", "Psi at rest after it; largest of a wall that fell"),
    "max_DI": Column("1", "largest damage index in the event"), "DI": Column("1", "the same at rest after it"),
    "crack_width_mm": Column("mm", "width of the widest crack at rest"),
    "offset_after_mm": Column("mm", "largest offset of a joint's faces at rest"),
    "newly_failed": Column("1", "contact points whose bonds failed in it"),
    "fell": Column("bool", "whether the wall fell in it")}
"""Columns of lives.csv."""
YEARLY = {
    "year": Column("", "at whose end"), "median_psi": Column("1", "median over the lives of Psi at rest"),
    "median_DI": Column("1", "the same of the damage index"),
    **{f"p_psi_{level:g}{end}": Column("1", f"{words}probability of Psi >= {level:g} at rest")
       for level in VISIBLE for end, words in (("", ""), ("_low", "lower 95 % bound of the "),
                                               ("_high", "upper 95 % bound of the "))}}
"""Columns of life.csv."""


def run_lives(wall, draws, count, folder, say=print, **options):
    """Run lives 1 to `count` of a wall, or take those that `folder` has; returns the table of COLUMNS.

    wall: its file or the name of one that ships; draws: Draws; options: of damage.run, the same for all lives; the
    seeds of strengths are the lives' numbers.
    """
    folder = Path(folder)
    tables = []
    for number in range(1, count + 1):
        tables.append(_life(wall, draws.life(number), number, folder, options))
        say(f"life {number} of {count}: events {len(tables[-1])}, Psi {final(tables[-1], 'psi'):.2f}", flush=True)
    return pd.concat([table for table in tables if len(table)] or tables[:1], ignore_index=True)


def final(table, column):
    """The last value of a column, 0 of a life without an event."""
    return float(table[column].iloc[-1]) if len(table) else 0.0


def _life(wall, life, number, folder, options):
    """Table of a life; its file is NAME.csv beside NAME_sequence.csv, with a digest of all that made it."""
    name = folder / f"life_{number:05d}"
    options = {"rest": 0.5, **options, "strength_seed": number}
    made = hashlib.sha256((life.to_csv() + json.dumps(options, sort_keys=True)
                           + Path(wall_path(wall)).read_text()).encode()).hexdigest()[:16]
    path = name.with_suffix(".csv")
    if path.is_file() and path.read_text().startswith(f"# {made}\n"):
        return _read(path)
    table = life.drop(columns=["start_s", "end_s"])
    if len(life):
        history = run(wall, sequence=write_sequence(life, f"{name}_sequence.csv"), **options)
        table = _with_results(table, history)
    else:
        table = table.reindex(columns=[one for one in COLUMNS if one != "life"])
    table.insert(0, "life", number)
    return _read(write_text(path, f"# {made}\n" + table.to_csv(index=False)))


def _read(path):
    """A life's table as it is kept, so that one that was there equals one that has just been run."""
    return pd.read_csv(path, comment="#", dtype={"time_utc": str}, float_precision="round_trip")


def _with_results(life, history):
    """The events of a life with what each left; a wall that fell undergoes no further event."""
    events = shocks_table(history)
    table = life.iloc[:len(events)].copy()
    for name, source in (("max_psi", "max_psi"), ("psi", "residual_psi"), ("max_DI", "max_DI"), ("DI", "residual_DI"),
                         ("crack_width_mm", "residual_crack_width_mm"), ("offset_after_mm", "offset_after_mm"),
                         ("newly_failed", "newly_failed")):
        largest = events[source.replace("residual_", "max_")]
        table[name] = events[source].astype(float).fillna(largest).to_numpy()
    table["fell"] = [False] * (len(table) - 1) + [history.collapsed_at_s is not None]
    return table


def over_time(table, count, years):
    """DataFrame with a row a year: median Psi and DI of the lives at its end, and P(Psi >= VISIBLE) with Wilson's 95 %
    interval over lives; table: of `run_lives`; years: first and last."""
    rows = []
    for year in range(years[0], years[1] + 1):
        so_far = table[table["time_utc"].str[:4].astype(int) <= year].groupby("life").last()
        now = so_far.reindex(range(1, count + 1))
        psi, index = (np.where(now["fell"].eq(True), np.inf, now["psi"].fillna(0.0)), now["DI"].fillna(0.0))
        row = {"year": year, "median_psi": float(np.median(psi)), "median_DI": float(np.median(index))}
        for level in VISIBLE:
            p, low, high = wilson(int((psi >= level).sum()), count)
            row |= {f"p_psi_{level:g}": p, f"p_psi_{level:g}_low": low, f"p_psi_{level:g}_high": high}
        rows.append(row)
    return pd.DataFrame(rows)


def wilson(hits, count):
    """Share of hits and Wilson's 95 % interval of a probability.

    >>> [round(value, 4) for value in wilson(8, 10)]
    [0.8, 0.4902, 0.9433]
    """
    if count < 1:
        raise InputError(f"{count} lives: expected at least one; give --draws 100")
    p, z2 = hits / count, Z95**2
    middle, half = (p + z2 / (2 * count)) / (1 + z2 / count), \
        Z95 * np.sqrt(p * (1 - p) / count + z2 / (4 * count**2)) / (1 + z2 / count)
    return p, max(0.0, float(middle - half)), min(1.0, float(middle + half))


def write_lives(table, years, count, folder):
    """Write lives.csv and life.csv (year by year) into a folder; returns their paths."""
    return [write_table(table, Path(folder) / "lives.csv"),
            write_table(over_time(table, count, years), Path(folder) / "life.csv")]


def describe(table, count, years):
    """Text: what became of the lives."""
    yearly = over_time(table, count, years).iloc[-1]
    events = table.groupby("life").size().reindex(range(1, count + 1), fill_value=0)
    lines = [f"{count} lives, {years[0]} to {years[1]}: {events.median():g} events in the median life "
             f"({events.min()} to {events.max()})",
             f"at the end: median Psi {yearly['median_psi']:.2f}, median DI {yearly['median_DI']:.3f}"]
    lines += [f"P(Psi >= {level:g}) = {yearly[f'p_psi_{level:g}']:.3f}, 95 % interval over lives "
              f"{yearly[f'p_psi_{level:g}_low']:.3f} to {yearly[f'p_psi_{level:g}_high']:.3f}" for level in VISIBLE]
    return "\n".join(lines)
