"""What a run comes to in five sentences, before the technical part, in English or Dutch."""

from functools import partial

from damage.applications.report.words import number, words
from damage.index import THRESHOLD
from damage.measure.cracks import cracked
from damage.measure.evidence import outside
from damage.units import MILLIMETRE


def plain(history, summary, row, language="en"):
    """Five sentences on a History; summary: of `summarise`; row: of `summary_row`."""
    say = partial(words, language)
    shown = partial(number, language)
    left = row["residual_crack_width_mm"]
    pgv = row["pgv_m_s"]
    before = row["settled_crack_width_mm"] or 0.0
    events = len(history.sequence)
    settled = summary["settled_psi"] is not None
    shaken = "plain_shaken" if events > 1 else "plain_shaken_once"
    what = shaken if pgv is not None else "plain_settled" if settled else "plain_pushed"
    now = (
        "plain_no_end"
        if left is None
        else "plain_visible"
        if cracked(left * MILLIMETRE)
        else "plain_invisible"
    )
    beyond = outside(summary["evidence"])
    return [
        say(what, count=events, pgv=shown(pgv and pgv / MILLIMETRE)),
        say(
            "plain_before_settled" if settled and pgv is not None else "plain_before",
            width=shown(before),
        ),
        say("plain_largest", width=shown(summary["max_crack_width_mm"])),
        say(
            "plain_fell" if history.collapsed_at_s is not None else now,
            width=shown(left),
            limit=shown(THRESHOLD / MILLIMETRE),
            added=shown(None if left is None else left - before),
        ),
        say("plain_outside", count=len(beyond)) if beyond else say("plain_inside"),
    ]
