"""State and origin of a history: `python3 -m damage check` and `info`."""

from collections.abc import Iterator
from math import isnan
from pathlib import Path

from damage.errors import InputError
from damage.history.head import read_head
from damage.history.reader import History, file_of, read_history
from damage.motion.intensity import APPLIED
from damage.provenance import UNKNOWN, shown_path
from damage.wall.as_built import caps, describe_cap

WHOLE = "whole"
ENDED_EARLY = "ended early"
OPEN = "open"
DAMAGED = "damaged"
WORTH = {
    WHOLE: "complete, and byte for byte as its run sealed it",
    ENDED_EARLY: "as its run left it, which did not come to its end",
    OPEN: (
        "a run writes it now, or was killed: what was flushed is there, no checksum vouches for it"
    ),
    DAMAGED: "not to be used",
}


RESULTS = (
    "time_step_s",
    "repeats",
    "repeated_for",
    "critical_time_step_s",
    "eigen_period_s",
    "pier_stress_pa",
    "outside_validity",
    *APPLIED,
)
"""Parameters of a history that follow from the others: eigenvalues of the wall, the motion as
applied, and the time step unless --dt gives it."""


def check(path: str | Path) -> dict:
    """State of the file at `path`: {"file", "worth": one of WORTH, "status", "samples", "until_s",
    "says"}.

    >>> check(history.path)["worth"]
    'whole'
    """
    try:
        history = read_history(path)
        head = read_head(file_of(path))
    except InputError as error:
        unknown = dict.fromkeys(("status", "samples", "until_s"))
        return {"file": str(path), "worth": DAMAGED, **unknown, "says": str(error)}
    worth = OPEN if not head.sealed else WHOLE if history.complete else ENDED_EARLY
    time_s = history.time_s
    return {
        "file": str(path),
        "worth": worth,
        "status": history.status,
        "samples": len(time_s),
        "until_s": float(time_s[-1]) if len(time_s) else None,
        "says": WORTH[worth],
    }


def describe_check(checked: list[dict]) -> str:
    """Text of the results of `check`, a line for each file."""
    return "\n".join(
        (
            f"{file['worth']}: {file['says']}"
            if file["worth"] == DAMAGED
            else f"{file['worth']}: {file['file']}: {file['status']}, {file['samples']} samples"
            + ("" if file["until_s"] is None else f" to {file['until_s']:.3f} s")
            + f"; {file['says']}"
        )
        for file in checked
    )


def made_by(history: History) -> dict:
    """{"software", "commit", "model_digest"} of a History; "unknown" outside git and of other
    writers.

    >>> sorted(made_by(history))[:2]
    ['commit', 'model_digest']
    """
    return {
        name: history.versions.get(key, UNKNOWN)
        for name, key in (
            ("software", "masonry-damage"),
            ("commit", "commit"),
            ("model_digest", "model"),
        )
    }


def origin(history: History) -> str:
    """Origin of a History, for the metadata of a picture."""
    made = made_by(history)
    return (
        f"{history.path.name}: {history.command}; {history.solver} solver, masonry-damage"
        f" {made['software']}, commit {made['commit']}, model {made['model_digest']}"
    )


def info(history: History) -> dict:
    """Origin of a History, a plain dictionary: "parameters" as stored in the file, and "results",
    those that follow from other parameters.

    >>> sorted(info(history))[:2]
    ['caps', 'collapsed_at_s']
    """
    top = history.bodies[history.bodies["course"] == -1]
    joints = history.joints
    thickness = joints["area_m2"].sum() / joints["length_m"].sum() if len(joints) else float("inf")
    return {
        "file": shown_path(history.path),
        "wall": history.wall,
        "solver": history.solver,
        "status": history.status,
        "collapsed_at_s": history.collapsed_at_s,
        "created_utc": history.attributes["created_utc"],
        "machine": history.attributes["machine"],
        "command": history.command,
        **made_by(history),
        "versions": history.versions,
        "parameters": history.parameters,
        "results": results(history),
        "caps": caps(top["x_m"], top["length_m"], top["mass_kg"], thickness),
        "static": {name: None if isnan(value) else value for name, value in history.static.items()},
    }


def results(history: History) -> dict:
    """{name: value} of a History's parameters that follow from others."""
    return {name: history.parameters[name] for name in RESULTS if name in history.parameters}


def given(about: dict) -> dict:
    """The parameters without those derived from others; about: an `info`."""
    return {
        name: value for name, value in about["parameters"].items() if name not in about["results"]
    }


def describe(about: dict) -> str:
    """The `info` of a history as lines for people: what made it and its caps, the results that
    precede the motion (static stage, periods, measures of the motion), then every parameter that
    was given or has its default.

    >>> describe(info(history)).splitlines()[0]
    'file          run.h5'
    """
    lines = [f"{name:14s}{value}" for name, value in about.items() if isinstance(value, str)]
    lines += [
        f"{name:14s}{version}"
        for name, version in sorted(about["versions"].items())
        if name not in ("masonry-damage", "commit", "model")
    ]
    lines += map(describe_cap, about["caps"])
    for title, table in (
        ("static stage", about["static"]),
        ("results", about["results"]),
        ("parameters", given(about)),
    ):
        lines += [f"{title}:", *(f"  {name:42s}{value}" for name, value in flat(table))]
    return "\n".join(lines)


def flat(table: dict, above: str = "") -> Iterator[tuple[str, object]]:
    """(name with those of the tables above it, value) of all entries, however deep.

    >>> dict(flat({"wall": {"length": 0.9}, "status": "complete"}))
    {'wall.length': 0.9, 'status': 'complete'}
    """
    for name, value in table.items():
        if above == "house." and name == "walls":
            yield from flat({item["wall"]["name"]: item for item in value}, "house.walls.")
        elif isinstance(value, dict):
            yield from flat(value, f"{above}{name}.")
        else:
            yield f"{above}{name}", value
