"""Text of walls and motions for titles and labels of figures and reports."""

import re

from damage.motion.loading import AtRest, FreeVibration, Harmonic, RecordedMotion, TopDisplacement

EVENTS = {
    "MID1": ("Huizinge", "+"),
    "BGAR": ("Zeerijp", "x"),
    "BWSE": ("Zeerijp", "1"),
    "BZN1": ("Zeerijp", "2"),
    "BLOP": ("Zeerijp", "3"),
    **dict.fromkeys(
        (
            "BOWW",
            "BWIR",
            "BAPP",
            "G010",
            "G040",
            "G080",
            "G100",
            "G130",
            "G170",
            "G190",
            "G220",
            "G620",
        ),
        ("Zeerijp", ""),
    ),
}
"""Earthquake and marker ("" for none of its own) of the stations whose records ship, or have a
named place."""
_DIRECTIONS = {"N": "north", "E": "east", "Z": "vertical", "1": "horizontal 1", "2": "horizontal 2"}
_COUNTS = (
    "no",
    "one",
    "two",
    "three",
    "four",
    "five",
    "six",
    "seven",
    "eight",
    "nine",
    "ten",
    "eleven",
    "twelve",
)
_TOPS = {"cantilever": "free to rotate", "fixed": "kept from rotating"}


def record_label(name):
    """Earthquake, station and component of a record; a synthetic one is called so.

    >>> record_label("BGAR_HGE")
    'Zeerijp, BGAR east'
    >>> record_label("G100_HG2")
    'Zeerijp, G100 horizontal 2'
    >>> record_label("MID1_N_synthetic")
    'Huizinge, MID1 north, synthetic'
    """
    station = station_of(name)
    component = re.search(
        r"(?<![A-Za-z0-9])(?:HG)?([NEZ]|(?<=HG)[12])(?![A-Za-z0-9])", name.replace("_", " ")
    )
    if station is None or component is None:
        return name
    synthetic = ", synthetic" if "synthetic" in name else ""
    return f"{EVENTS[station][0]}, {station} {_DIRECTIONS[component.group(1)]}{synthetic}"


def station_of(name):
    """The known station that a record's name holds, or None."""
    return next((station for station in EVENTS if station in name), None)


def run_title(history):
    """Text: the wall and the motion of a History, as "Symmetric wall, harmonic motion of 0.2 s and
    0.05 g, three cycles"."""
    motion = motion_words(history.loading)
    events = counted(len(history.sequence), "event")
    if "motions" in history.parameters:
        records = {loading.horizontal.get("record") for loading in history.event_loadings}
        motion = f"sequence of {events}, {counted(len(records), 'record')}"
    elif len(history.sequence) > 1:
        motion += f", {events} × {', '.join(f'{factor:g}' for factor in history.sequence)}"
    if settlement := history.parameters.get("settlement"):
        motion = settlement_words(settlement) + (
            "" if motion == "no motion" else f", then {motion}"
        )
    return f"{wall_words(history.wall, history.kind)}, {motion}"


def settlement_words(settlement):
    """Text: a settlement as a history's parameters have it.

    >>> settlement_words({"profile": "hogging", "distortion": 1 / 2800})
    'hogging settlement of 1/2800'
    """
    distortion = settlement.get("distortion")
    return (
        f"settlement {settlement['profile']}"
        if distortion is None
        else (f"{settlement['profile']} settlement of 1/{round(1 / distortion)}")
    )


def wall_words(name, noun="wall"):
    """The name of a wall, HOUSE:WALL in studies, or of a house, as the start of a title.

    >>> wall_words("symmetric"), wall_words("north_wall_2"), wall_words("box", "house")
    ('Symmetric wall', 'North wall 2', 'Box house')
    >>> wall_words("terraced_house", "house"), wall_words("box:front")
    ('Terraced house', 'Box, front wall')
    """
    title = name.replace("_", " ").replace(":", ", ").strip()
    title = title[:1].upper() + title[1:]
    return title if noun in title.lower().split() else f"{title} {noun}"


def motion_words(loading):
    """Text: a `damage.motion.loading.Loading`; the name of one that has no words here.

    >>> motion_words(Harmonic(0.2, 0.05))
    'harmonic motion of 0.2 s and 0.05 g, three cycles'
    >>> motion_words(TopDisplacement((0.1, 0.2)))
    'top moved to and fro by drifts of 0.1, 0.2 %, two cycles each, free to rotate'
    >>> motion_words(TopDisplacement((0.5,), cycles=0, boundary="fixed"))
    'top pushed to a drift of 0.5 %, kept from rotating'
    >>> motion_words(FreeVibration())
    'free vibration in its first mode from 1 mm/s at the top'
    """
    if isinstance(loading, AtRest):
        return "no motion"
    if isinstance(loading, Harmonic):
        return (
            f"harmonic motion of {loading.period_s:g} s and {loading.amplitude_g:g} g, "
            f"{counted(loading.cycles, 'cycle')}"
        )
    if isinstance(loading, FreeVibration):
        return (
            f"free vibration in its first mode from {1e3 * loading.top_velocity_m_s:g} mm/s at"
            " the top"
        )
    if isinstance(loading, TopDisplacement):
        return _top_words(loading)
    return (
        _record_words(loading)
        if isinstance(loading, RecordedMotion)
        else loading.name.replace("_", " ")
    )


def _top_words(loading):
    drifts = ", ".join(f"{drift:g}" for drift in loading.amplitudes_pct)
    top = _TOPS[loading.boundary]
    floors = ", ".join(f"{share:g} at {level:g} m" for level, share in loading.floor_shares)
    what, top = (f"floors ({floors})", "forces in this ratio") if floors else ("top", top)
    if loading.cycles == 0:
        return f"{what} pushed to a drift of {loading.amplitudes_pct[0]:g} %, {top}"
    each = " each" if len(loading.amplitudes_pct) > 1 else ""
    by = "drifts" if each else "a drift"
    return (
        f"{what} moved to and fro by {by} of {drifts} %, {counted(loading.cycles, 'cycle')}{each},"
        f" {top}"
    )


def _record_words(loading):
    """Text: a `RecordedMotion`; for an old history without its record, the name of the motion."""
    record = loading.horizontal.get("record")
    if record is None:
        return f"record {loading.name}"
    vertical = [] if loading.vertical is None else ["with its vertical component"]
    return ", ".join([f"record {record_label(record)}", *vertical, *preparation(loading)])


def preparation(loading):
    """Texts of the processing steps of a Recorded or a `RecordedMotion`, a list."""
    parts = [
        "" if loading.scale in (None, 1) else f"times {loading.scale:g}",
        "" if loading.window_s is None else "{:g} to {:g} s of the file".format(*loading.window_s),
        ""
        if loading.baseline_order is None
        else f"baseline of order {loading.baseline_order} removed",
        "" if loading.band_hz is None else "band-pass {:g} to {:g} Hz".format(*loading.band_hz),
        "" if loading.interpolated_for_s is None else "interpolated",
    ]
    return [part for part in parts if part]


def counted(count, noun):
    """A count with its noun, in words up to twelve.

    >>> counted(1, "cycle"), counted(3, "cycle"), counted(20, "cycle")
    ('one cycle', 'three cycles', '20 cycles')
    """
    number = _COUNTS[count] if 0 <= count < len(_COUNTS) else str(count)
    return f"{number} {noun}{'' if count == 1 else 's'}"
