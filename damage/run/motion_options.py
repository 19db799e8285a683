"""The options of a motion, a push or a settlement, and what they make of the settings of a run."""

from pathlib import Path

from damage.arguments import Rows, arg, file_arg, file_path, flag, fraction, numbers
from damage.errors import InputError
from damage.motion.columns import UNITS_M_S2
from damage.motion.formats import read_record
from damage.motion.loading import (
    BOUNDARIES,
    AtRest,
    FreeVibration,
    Harmonic,
    Recorded,
    TopDisplacement,
)
from damage.motion.sequence import read_sequence, strongest
from damage.motion.settlement import PROFILES, Settlement, read_profile

USUAL_DISTORTION = 1 / 500
BY_FILE = "file"
"""Value of --unit for the unit that the file names; for tables whose cells may not be empty."""


def _factors(word):
    """The type of --sequence: numbers, or the path of a table."""
    return file_path(word) if word.lower().endswith(".csv") else numbers(word)


PREPARATION = (
    arg(
        "--unit",
        f"unit of a record whose header names none (default {BY_FILE}: as the file says)",
        choices=(BY_FILE, *UNITS_M_S2),
    ),
    arg(
        "--sample-step",
        "time between two samples of a record whose file has one "
        "column, sample numbers or rounded times",
        "S",
        float,
    ),
    arg("--scale", "factor on the record (default 1)", type_=float),
    arg("--window", "part of the record to use", ("T0_S", "T1_S"), float, nargs=2),
    arg("--baseline", "subtract a polynomial of this order from the record", "ORDER", int),
    arg(
        "--band",
        "band-pass the record, 4th order Butterworth, zero phase (default: no filter)",
        ("LOW_HZ", "HIGH_HZ"),
        float,
        nargs=2,
    ),
    file_arg(
        "--across",
        "FILE",
        "the record's other horizontal component, for measures of the largest of all directions"
        " (RotD100); shakes a house across its heading, not a plane wall",
    ),
)
"""The options that prepare a record; `recorded` reads them."""
MOTION_GROUPS = {
    "motion (one of; default --harmonic 0.2 0.05)": (
        arg(
            "--harmonic",
            "sinusoidal base acceleration that starts at zero",
            ("PERIOD_S", "AMPLITUDE_G"),
            float,
            nargs=2,
        ),
        arg(
            "--cycles",
            "cycles of the harmonic motion (default 3), or at each drift of --cyclic (default 2)",
            type_=int,
        ),
        file_arg(
            "--record", "FILE", "recorded ground motion, in a format of docs/guides/own-record.md"
        ),
        *PREPARATION,
        file_arg("--vertical", "FILE", "the record's vertical component"),
        flag(
            "--free-vibration",
            "free vibration in the first mode, which starts with 1 mm/s at the top",
            default=None,
        ),
        arg(
            "--sequence",
            "events on the same wall, damage carried over: the harmonic or recorded motion"
            " times each factor, then rest and settling (default 1); or different records, a"
            " row of a CSV file each (docs/guides/own-record.md)",
            "F,F,...|FILE.csv",
            _factors,
        ),
    ),
    "quasi-static loading, instead of a motion": (
        arg(
            "--pushover",
            "push the top to this drift, after --settle from where it stands then",
            "DRIFT_PCT",
            float,
        ),
        arg("--cyclic", "push the top cyclically to these drifts", "PCT,PCT,...", numbers),
        arg(
            "--floor-share",
            "push the floor at this level with this share of the force, by a spreader beam;"
            " repeatable, with a sum of 1; the drift is that of the resultant",
            ("LEVEL_M", "SHARE"),
            float,
            nargs=2,
            action=Rows,
        ),
        arg(
            "--boundary",
            "the pushed top may rotate (cantilever, default), or not (fixed)",
            choices=BOUNDARIES,
        ),
        arg(
            "--top-rotation",
            "rotational spring between the pushed top and what moves it (default 0: free)",
            "N_M_RAD",
            float,
        ),
        arg("--speed", "speed of the pushed top (default 0.005)", "M_S", float),
        arg(
            "--damping",
            "local damping of the pushed wall, 0 to 0.7 (default 0.7); the "
            "reference solver has it with --relaxation local only",
            "C",
            float,
        ),
    ),
    "settlement of the ground, before the motion or without one": (
        file_arg(
            "--settle",
            f"{'|'.join(PROFILES)}|FILE.csv",
            "move a support below each brick of the base by this profile, or by points x_m,uz_m, or"
            " levels x_m,height_m,date, of a file; without a motion the run ends then",
        ),
        arg(
            "--distortion",
            "of a named profile: relative deflection over half the wall's length, or the angle"
            f" of tilt and knick (default 1/{1 / USUAL_DISTORTION:g})",
            "1/500",
            fraction,
        ),
    ),
}
"""{title: arguments} of the groups of options that say how a wall is moved."""


def settlement_of(given):
    """The Settlement of parsed options, None without one."""
    if given.settle is None:
        if given.distortion is not None:
            raise InputError("--distortion belongs to --settle; give both")
        return None
    if str(given.settle) in PROFILES:
        distortion = USUAL_DISTORTION if given.distortion is None else given.distortion
        return Settlement(str(given.settle), distortion)
    if given.settle.suffix.lower() != ".csv":
        raise InputError(
            f"--settle {given.settle}: expected one of {', '.join(PROFILES)}, or a CSV file;"
            " correct it"
        )
    if given.distortion is not None:
        raise InputError(
            "--distortion beside a profile from a file: the file says how far the ground settles;"
            " leave it out"
        )
    return read_profile(given.settle)


_BELONGS = {
    "cycles": ("harmonic", "cyclic"),
    **dict.fromkeys(
        ("floor_share", "boundary", "top_rotation", "speed", "damping"), ("pushover", "cyclic")
    ),
    "sequence": ("harmonic", "record"),
    **dict.fromkeys(
        ("unit", "sample_step", "scale", "window", "vertical", "across", "baseline", "band"),
        ("record",),
    ),
}


def motion_of(parsed):
    """{field of RunSettings: value} of the motion options."""
    if not isinstance(parsed.sequence, Path):
        return {"loading": _loading(parsed), "sequence": parsed.sequence or (1.0,)}
    refuse_motions(
        parsed,
        f"--sequence {parsed.sequence}",
        "the file has the records, their scales and windows",
        beside=("sequence", "baseline", "band"),
    )
    return fields_of_events(
        read_sequence(
            parsed.sequence,
            parsed.rest,
            **_given(baseline_order=parsed.baseline, band_hz=parsed.band),
        )
    )


def fields_of_events(events):
    """{field of RunSettings: value} of a sequence of different motions, a tuple of Event."""
    return {
        "loading": strongest(events).loading,
        "sequence": tuple(event.factor for event in events),
        "events": events,
    }


def refuse_motions(parsed, option, why, beside=()):
    """InputError where a motion, or what belongs to one, is among parsed options beside the option
    of another; beside: those that go with it."""
    others = [name for name in (*_MOTIONS, *_BELONGS) if name not in beside]
    if given := [name for name in others if getattr(parsed, name) is not None]:
        raise InputError(
            f"{option} and --{given[0].replace('_', '-')}: expected one of them, as {why}; leave"
            " the other out"
        )


def _loading(parsed):
    """The loading that the motion options ask for, or InputError where they contradict each
    other."""
    chosen = [name for name in _MOTIONS if getattr(parsed, name) is not None]
    if len(chosen) > 1:
        raise InputError(
            f"--{' and --'.join(chosen)} given together: choose one motion".replace("_", "-")
        )
    rests = not chosen and parsed.settle is not None and parsed.cycles is None
    motion = "at_rest" if rests else (chosen or ["harmonic"])[0]
    for option, owners in _BELONGS.items():
        if getattr(parsed, option) is not None and motion not in owners:
            raise InputError(
                f"--{option.replace('_', '-')} belongs to --{' or --'.join(owners)}, not to "
                f"--{motion.replace('_', '-')}; leave it out"
            )
    return AtRest() if rests else _MOTIONS[motion](parsed)


def _harmonic(parsed):
    return Harmonic(*(parsed.harmonic or (0.2, 0.05)), **_given(cycles=parsed.cycles))


def _given(**options):
    """The options that were given; of the others the loading has its own default."""
    return {name: value for name, value in options.items() if value is not None}


def _pushed(parsed):
    more = _given(
        boundary=parsed.boundary,
        speed_m_s=parsed.speed,
        local_damping=parsed.damping,
        top_rotation=parsed.top_rotation,
        floor_shares=parsed.floor_share,
    )
    if parsed.pushover is not None:
        return TopDisplacement((parsed.pushover,), cycles=0, **more)
    if parsed.cycles is not None and parsed.cycles < 1:
        raise InputError(
            f"--cycles {parsed.cycles}: expected at least one cycle at each drift; correct it"
        )
    return TopDisplacement(parsed.cyclic, **_given(cycles=parsed.cycles), **more)


def recorded(parsed):
    """The Recorded motion of parsed options: `record`, those of PREPARATION, and `vertical` where
    offered."""
    given = {
        "unit": None if parsed.unit == BY_FILE else parsed.unit,
        "sample_step_s": parsed.sample_step,
    }
    record = read_record(parsed.record, **given)
    others = {
        name: read_record(path, **given)
        for name in ("vertical", "across")
        if (path := getattr(parsed, name, None))
    }
    return Recorded(
        record,
        **others,
        **_given(
            scale=parsed.scale,
            window_s=parsed.window,
            baseline_order=parsed.baseline,
            band_hz=parsed.band,
        ),
    )


_MOTIONS = {
    "harmonic": _harmonic,
    "record": recorded,
    "free_vibration": lambda parsed: FreeVibration(),
    "pushover": _pushed,
    "cyclic": _pushed,
}
"""{option: what makes its Loading of parsed options}."""
