"""What a run comes to in five lines and three numbers, before the technical part, in English or
Dutch."""

from functools import partial

import numpy as np
import pandas as pd

from damage.applications.report.words import number, words
from damage.index import THRESHOLD
from damage.measure.cracks import cracked
from damage.measure.evidence import outside
from damage.units import MILLIMETRE

_STATES = "settled_crack_width_mm", "residual_crack_width_mm", "pgv_m_s"


def plain(history, summary, row, members, language="en"):
    """{"lines": five sentences, "cards": [(name, value or None, as shown, unit, range over
    members)]} of a History.

    summary: of `summarise`; row: of `summary_row`; members: their table, None without.
    """
    say, shown = partial(words, language), partial(number, language)
    of_row = _states(pd.DataFrame([row], columns=_STATES))
    states = {name: None if np.isnan(value) else value for name, value in of_row.iloc[0].items()}
    spread, cards = of_row if members is None else _states(members), []
    for name, unit in (("left", "mm"), ("added", "mm"), ("pgv", "mm/s")):
        of = spread[name].dropna()
        cards.append(
            (
                say(f"card_{name}"),
                states[name],
                shown(states[name]),
                unit,
                (
                    ""
                    if len(of) < 2
                    else say(
                        "card_members", count=len(of), least=shown(of.min()), most=shown(of.max())
                    )
                ),
            )
        )
    return {"lines": _lines(history, summary, states, say, shown), "cards": cards}


def _states(table):
    """Of each row of a table of `summary_row`: widest crack `before` the motion, `left` at rest
    after it, and `added` to the former [mm]; `pgv` [mm/s]; NaN where there is none."""
    before, left, pgv = (table[name].astype(float) for name in _STATES)
    before = before.fillna(0.0)
    return pd.DataFrame(
        {"before": before, "left": left, "added": left - before, "pgv": pgv / MILLIMETRE}
    )


def _lines(history, summary, states, say, shown):
    left, pgv, before = states["left"], states["pgv"], shown(states["before"])
    events, settled = len(history.sequence), summary["settled_psi"] is not None
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
        say(what, count=events, pgv=shown(pgv)),
        say(
            "plain_before_settled" if settled and pgv is not None else "plain_before", width=before
        ),
        say("plain_largest", width=shown(summary["max_crack_width_mm"])),
        say(
            "plain_fell" if history.collapsed_at_s is not None else now,
            width=shown(left),
            limit=shown(THRESHOLD / MILLIMETRE),
            added=shown(states["added"]),
        ),
        say("plain_outside", count=len(beyond)) if beyond else say("plain_inside"),
    ]
