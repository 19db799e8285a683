"""Samples of the active contact points of a run; all others are intact and have zeros.

Most contact points are intact most of the time: solver, memory and file have the active ones alone,
and measures are computed from these.
"""

from typing import NamedTuple

import numpy as np

from damage.law.states import AT_LIMIT, BROKEN, CRUSHED, ENDED


def _has(bit, words):
    """Property of Contacts: whether their state has this bit."""
    return property(lambda contacts: (contacts.state & bit) > 0, doc=words)


class Contacts(NamedTuple):
    """Samples of some contact points.

    joints: (n,) indices of these contact points, increasing; opening_m, slip_m, offset_m [m] and
    state (bits of `damage.law.states`): (n_times, n), as in the file
    (docs/reference/history-schema.md).
    """

    joints: np.ndarray
    opening_m: np.ndarray
    slip_m: np.ndarray
    offset_m: np.ndarray
    state: np.ndarray

    broken = _has(BROKEN, "Whether the bond has failed, bool (n_times, n).")
    at_limit = _has(AT_LIMIT, "Whether it has failed in shear or slid, ever, bool (n_times, n).")
    crushed = _has(CRUSHED, "Whether it has been crushed, ever, bool (n_times, n).")
    ended = _has(ENDED, "Whether its faces have ceased to overlap, bool (n_times, n).")

    def slip_by(self, slip):
        """Slip by a criterion, as `History.slip_by`, (n_times, n) [m]."""
        return self.slip_m if slip == "accumulated" else self.offset_m

    def with_any(self, *names):
        """The Contacts of those joints at which any of these fields was ever other than zero."""
        ever = np.any([any_bit(getattr(self, name)) for name in names], axis=0)
        return Contacts(self.joints[ever], *(field[:, ever] for field in self[1:]))

    def at_all_joints(self, name, n_joints):
        """A field of all contact points of a wall, (n_times, n_joints)."""
        some = getattr(self, name)
        rows = np.zeros((len(some), n_joints), some.dtype)
        rows[:, self.joints] = some
        return rows


def any_bit(rows):
    """Flags (n,) of the columns of rows (n_rows, n) in which any bit is set, that of minus zero
    included."""
    return np.bitwise_or.reduce(rows.view(f"u{rows.itemsize}"), axis=0) > 0
