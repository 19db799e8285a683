"""The options --address, --event and --life of a run, whose motions are earthquakes at an
address."""

from dataclasses import replace

from damage.applications.groningen.exposure.lives import events_of, read_address
from damage.arguments import arg, file_arg, number_from
from damage.errors import InputError
from damage.fields import MOST_SEED
from damage.motion.formats import shipped_records
from damage.run.motion_options import fields_of_events, refuse_motions
from damage.run.options import Source, register


def _fields(given):
    """{field of RunSettings: value} of parsed options, empty without an address; raises
    InputError."""
    asked = "event" if given.event is not None else "life"
    if (given.address is None) != (getattr(given, asked) is None):
        raise InputError(
            "--address ADDRESS.toml and --life N, or --event DATE: expected both; give the other"
            " one, too"
        )
    if given.address is None:
        return {}
    refuse_motions(given, f"--{asked}", "the address decides the motions")
    draws = read_address(given.address)
    return _settlement(given, draws) | (_event if asked == "event" else _life)(given, draws)


def _settlement(given, draws):
    """The Settlement that a life draws, in a dictionary that is empty where it draws none."""
    drawn = given.life is not None and draws.settlement(given.life)
    if drawn and given.settle is not None:
        raise InputError(
            f"--settle {given.settle} and {given.address}, whose lives draw the settlement:"
            " expected one of them; leave --settle or the key settle out"
        )
    return {"settlement": drawn} if drawn else {}


def _event(given, draws):
    """The motion of a record, scaled, of the event of a date."""
    table = draws.event(given.event, given.life)
    (motion,) = events_of(table, given.rest)
    (row,) = table.to_dict("records")
    return {
        "loading": replace(motion.loading, scale=motion.factor),
        "sequence": (1.0,),
        "life": None,
        "event": row | {"life": given.life, **draws.as_dict()},
    }


def _life(given, draws):
    """The events of a life, and what decides them, fit for JSON."""
    return fields_of_events(events_of(draws.life(given.life), given.rest)) | {
        "event": None,
        "life": {"number": given.life, **draws.as_dict()},
    }


def _digest(options):
    """`Draws.digest`, which takes a quarter of a second and is asked for of each run: once while no
    record changes."""
    draws = read_address(options["address"])
    given = vars(draws)
    times = [path.stat().st_mtime_ns for path in shipped_records().values()]
    if given.get("digest_at") != times:
        given |= {"digest_at": times, "digest_then": draws.digest()}
    return given["digest_then"]


register(
    Source(
        "a life: the earthquakes at an address, one after the other, instead of a motion",
        (
            file_arg(
                "--address",
                "ADDRESS.toml",
                "where, and how motions are chosen (docs/guides/groningen.md)",
            ),
            arg(
                "--event",
                "one earthquake of the catalogue, like 2012-08-16, instead of a life: a record"
                " scaled to its median PGV at the address; with --life to the PGV drawn there",
                "DATE",
                str,
            ),
            arg(
                "--life",
                "number of the life: by it motions are "
                "drawn and, where --strength-cov or --inputs is given, the wall",
                "N",
                number_from(1, MOST_SEED, int),
            ),
        ),
        _fields,
        _digest,
    )
)
