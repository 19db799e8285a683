"""Inputs of the runs of a point: the wall as built, every option as parsed, every file that was
read.

A study keeps them with its records (`damage.applications.studies.records`) and compares them before
it continues.  The wall file counts by the Wall that it makes, so that a module that it imports
counts and a comment does not; options count by the values that a run gets, defaults included.  A
history that runs continue counts by its content, lives by all that they are drawn from.

A run is made only where its inputs, once it has read them, are still those that its study began
with (`damage.applications.studies.worker`): files may change meanwhile.
"""

import hashlib
import json
from dataclasses import MISSING, dataclass, fields, is_dataclass

from damage.applications.studies.folder import ROOT
from damage.checks import check_file
from damage.house.coarser import in_units
from damage.house.house import House, load_wall_or_house
from damage.motion.record import Record
from damage.retired import retired
from damage.run.options import SOURCES
from damage.run.settings import RunSettings
from damage.wall.parameters import Wall

NO_INPUT = {
    RunSettings: {
        "out",
        "overwrite",
        "pictures",
        "quiet",
        "view",
        "console",
        "command",
        "checkpoint_s",
        "resumed",
    },
    Record: {
        "acceleration_m_s2",
        "time_step_s",
        "start_utc",
        "source",
        "unit",
        "first_s",
        "late_s",
    },
}
"""Fields that decide no value, or that follow from the files whose checksums stand beside them."""


@dataclass(frozen=True)
class Inputs:
    """The wall, or house, as built, and the settings of a point's first run; the others differ from
    it by their number alone.

    continued: SHA-256 of the history that the runs continue; drawn_from: of what their lives are
    drawn from; or None.
    """

    wall: Wall | House
    settings: RunSettings
    continued: str | None = None
    drawn_from: str | None = None


def inputs_of(run, root, wall=None):
    """The Inputs of a StudyRun; root: the repository; wall: as one of its runs has it, which is
    that of the file unless its inputs are drawn.  Raises InputError where wall, options or a file
    are bad."""
    settings = run.settings(root)
    as_read = wall if settings.model.inputs == "given" else None
    continued = (
        settings.continued
        and hashlib.sha256(
            check_file(
                settings.continued, "the history of the run that is continued (.h5)"
            ).read_bytes()
        ).hexdigest()
    )
    as_read = as_read or in_units(load_wall_or_house(root / run.wall), settings.units)
    as_read.check_run(settings, run.solver)
    drawn_from = None
    if run.varied == "life":
        options = run.options_of(1, root)
        drawn_from = next(source.digest(options) for source in SOURCES if source.digest)
    return Inputs(as_read, settings, continued, drawn_from)


def changes(task, inputs, wall=None):
    """How the inputs of a task differ from those in {StudyRun.id: `as_json` of then}, a list of
    words; wall: as its run has it, which may have imported modules that this process has of
    before."""
    note = inputs.get(task.point.id)
    return differences(note, inputs_of(task.point, ROOT, wall)) if note else []


def as_json(inputs):
    """Inputs as JSON has them: tables, lists, numbers and words."""
    return json.loads(json.dumps(_plain(inputs), default=float))


def differences(note, inputs):
    """Differences between a note and Inputs, a list of words like "wall.height 0.6 -> 0.45"; empty
    where they agree.

    note: of `as_json`.  A field that the note lacks came with a later version, and one that was
    removed (`damage.retired`) is of an older one: both agree at their defaults.  A field that is no
    input any more does not count.
    """
    return list(_differing(note, inputs, ""))


def _fields(record):
    """The fields of a record that are inputs."""
    return [
        attribute
        for attribute in fields(record)
        if attribute.name not in NO_INPUT.get(type(record), ())
    ]


def _plain(value):
    """A value as JSON has it: a record is a table with its kind."""
    if is_dataclass(value):
        return {"kind": type(value).__name__} | {
            field.name: _plain(getattr(value, field.name)) for field in _fields(value)
        }
    return [_plain(item) for item in value] if isinstance(value, (list, tuple)) else value


def _differing(then, now, name):
    if is_dataclass(now) and isinstance(then, dict) and then.get("kind") == type(now).__name__:
        for field in _fields(now):
            value = getattr(now, field.name)
            place = f"{name}.{field.name}".lstrip(".")
            if field.name in then:
                yield from _differing(then[field.name], value, place)
            elif value != _default(field):
                yield f"{place} {_word(value)}, which was not there"
        others = then.keys() - {"kind", *(attribute.name for attribute in fields(now))}
        yield from _of_other_versions({other: then[other] for other in sorted(others)}, name)
    elif isinstance(now, (list, tuple)) and isinstance(then, list) and len(then) == len(now):
        for number, pair in enumerate(zip(then, now)):
            yield from _differing(*pair, f"{name}[{number}]")
    elif then != _plain(now):
        yield f"{name} {_word(then)} -> {_word(_plain(now))}"


def _of_other_versions(values, name):
    """Yield what is to be said of fields {name: value} of a note that this version does not
    have."""
    for other, value in values.items():
        place = f"{name}.{other}".lstrip(".")
        gone = retired(other)
        if gone is None:
            yield f"{place} of a later version"
        elif value != gone.default:
            yield f"{place} {_word(value)}, which was removed"


def _default(attribute):
    """The default of a field; MISSING, which equals no value, where it has none."""
    return (
        attribute.default_factory()
        if attribute.default_factory is not MISSING
        else attribute.default
    )


def _word(value):
    """A value in a message, a checksum or a table cut short."""
    word = value if isinstance(value, str) else json.dumps(_plain(value), default=float)
    return word if len(word) <= 40 else f"{word[:12]}..."
