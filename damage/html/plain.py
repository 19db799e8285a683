"""What a run comes to in five lines and three numbers, before the technical part, in English or Dutch."""

from functools import partial

import numpy as np

from damage.html.words import number, words
from damage.index import THRESHOLD
from damage.measure.cracks import cracked
from damage.measure.evidence import outside
from damage.units import MILLIMETRE


def plain(history, summary, row, members, language="en"):
    """{"lines": five sentences, "cards": [(name, value or None, as shown, unit, range over members)]} of a History.

    summary: of `summarise`; row: of `summary_row`; members: their table, None without.
    """
    say, shown = partial(words, language), partial(number, language)
    before, left, pgv = _states(row)
    cards = [(say("card_left"), left, "mm", _of(members, lambda table: _states(table)[1])),
             (say("card_added"), _less(left, before), "mm", _of(members, lambda table: _less(*_states(table)[1::-1]))),
             (say("card_pgv"), pgv, "mm/s", _of(members, lambda table: _states(table)[2]))]
    return {"lines": _lines(history, summary, (before, left, pgv), say, shown), "cards": [
        (name, value, shown(value), unit, "" if of is None else say(
            "card_members", count=len(of), least=shown(of.min()), most=shown(of.max())))
        for name, value, unit, of in cards]}


def _states(row):
    """Widest crack before the motion and at rest after it [mm], PGV [mm/s], of a row or a table of `summary_row`; None
    where there is none."""
    before, left, pgv = (row[name] for name in ("settled_crack_width_mm", "residual_crack_width_mm", "pgv_m_s"))
    if np.ndim(left):
        return before.astype(float).fillna(0.0), left.astype(float), pgv.astype(float) / MILLIMETRE
    known = None if left is None or np.isnan(left) else left
    return 0.0 if before is None else before, known, None if pgv is None else pgv / MILLIMETRE


def _less(left, before):
    return None if left is None else left - before


def _of(members, values):
    """Values (n,) of the members that have them; None where fewer than two do."""
    if members is None:
        return None
    found = values(members).dropna()
    return found if len(found) > 1 else None


def _lines(history, summary, states, say, shown):
    before, left, pgv = states
    events, settled = len(history.sequence), summary["settled_psi"] is not None
    limit = shown(THRESHOLD / MILLIMETRE)
    shaken = "plain_shaken" if events > 1 else "plain_shaken_once"
    what = shaken if pgv is not None else "plain_settled" if settled else "plain_pushed"
    now = "plain_no_end" if left is None else "plain_visible" if cracked(left * MILLIMETRE) else "plain_invisible"
    beyond = outside(summary["evidence"])
    return [
        say(what, count=events, pgv=shown(pgv)),
        say("plain_before_settled" if settled and pgv is not None else "plain_before", width=shown(before)),
        say("plain_largest", width=shown(summary["max_crack_width_mm"])),
        say("plain_fell" if history.collapsed_at_s is not None else now, width=shown(left), limit=limit,
            added=shown(_less(left, before))),
        say("plain_outside", count=len(beyond)) if beyond else say("plain_inside")]
