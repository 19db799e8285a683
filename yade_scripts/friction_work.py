"""Work of friction in the dry contacts of YADE's law, consistent with the work of central
differences on the bodies.

A step in which the shear force decreases from F to F' [N] while the contact slides by ds [m]
dissipates
(F + F') / 2 ds.  A step in which the contact opens while its bodies slide by du [m] dissipates F /
2 (F / k_s + du). YADE's law sums F' ds over all contacts and steps; this module adds the
difference.  It does so at every step, since lightly compressed contacts open and close from one
step to the next.
"""

import numpy as np
from yade import Vector3

from yade_scripts.memory import ContactNumbers

# [m], opening from which a contact is not checked until the next choice (up to 0.3 m/s)
_NEAR = 5e-5


class FrictionWork:
    """Work of friction in all contacts of a Law2_ScGeom_FrictPhys_CundallStrack that traces its
    energy.

    The contacts of joints, at most n at a time, are added as they form.  For collisions of loose
    bricks only YADE's sum is available.
    """

    def __init__(self, law, n):
        self._law, self._rest = law, 0.0
        self._rows, self._free = {}, list(range(n))  # rows of those watched, and other rows
        self._numbers = ContactNumbers(n)
        # shear force in the last step [N], half the shear compliance [m/N]
        self._before, self._half_compliance = np.zeros((3, n)), np.zeros(n)
        self._closed = np.ones(n, bool)  # in the last step
        self._near = None  # rows that are checked until the next choice, None for all

    @property
    def total(self):
        """Work of friction so far [J]."""
        return self._law.plasticDissipation() + self._rest

    def add(self, contact, limit):
        """Add an interaction that begins with the shear force of a failed bond.

        limit: to which that force falls in the next step [N]; the energy lost by this is fracture,
        not friction.
        """
        self._rest -= max(contact.phys.shearForce.norm() - limit, 0.0) ** 2 / (2 * contact.phys.ks)
        self.renew(contact)

    def renew(self, contact):
        """Add or update an interaction with its present state, stiffness and shear force."""
        phys = contact.phys
        self._watch(contact, phys.shearForce, True, 0.5 / phys.ks)

    def _watch(self, contact, force, closed, half_compliance):
        key = contact.id1, contact.id2
        row = self._rows.get(key)
        if row is None:
            row = self._rows[key] = self._free.pop()
        self._numbers.put(row, contact.geom, contact.phys)
        self._before[:, row], self._closed[row] = tuple(force), closed
        self._half_compliance[row], self._near = half_compliance, None

    def forget(self, contact):
        """Remove an interaction."""
        self._free.append(self._rows.pop((contact.id1, contact.id2)))
        self._near = None

    def end(self, contact, stored):
        """Remove an interaction whose elastic energy `stored` [J] dissipates."""
        self.forget(contact)
        self._rest += stored

    @property
    def _all(self):
        return np.fromiter(self._rows.values(), int, len(self._rows))

    def tables(self):
        """Bodies of the interactions watched (n, 2), and their states (n, 6) as `watch_again` takes
        them."""
        rows, near = self._all, self._all if self._near is None else self._near
        columns = self._closed, self._half_compliance, np.isin(np.arange(len(self._closed)), near)
        states = np.column_stack([*self._before, *columns])[rows]
        return np.array(list(self._rows), int).reshape(-1, 2), states

    def watch_again(self, contacts, keys, states, slid):
        """Take over the state of another one: contacts: {(id1, id2): interaction}; keys, states: of
        those watched, in their order: shear force in the last step (3) [N], closed, half the
        compliance [m/N], whether it is checked; slid: YADE's sum [J]."""
        self._free.extend(self._rows.values())
        self._rows = {}
        for key, (*before, closed, half, _) in zip(map(tuple, keys), states):
            self._watch(contacts[key], Vector3(before), bool(closed), half)
        self._near = self._all[[bool(state[-1]) for state in states]] if states else None
        self._law.initPlasticDissipation(slid)

    def step(self, anew):
        """Add the work of a step; to be called after every step.  anew: choose anew the contacts
        that are checked until the next choice, those that are closed or may close."""
        if not self._rows:
            return
        if anew:
            rows = self._all
            self._near = rows[self._closed[rows] | (self._numbers.depths(rows) > -_NEAR)]
        elif self._near is None:
            self._near = self._all
        near, numbers = self._near, self._numbers
        is_closed, force = numbers.depths(near) >= 0, numbers.forces(near)
        checked = is_closed | self._closed[near]
        fall = self._before[:, near] - force
        self._before[:, near], self._closed[near] = force, is_closed
        left_out = _dot(fall, fall) * self._half_compliance[near]
        left_out -= _dot(fall, numbers.increments(near)) / 2
        self._rest += sum(np.where(checked, left_out, 0.0).tolist())  # in the order of the contacts


def _dot(one, other):
    x, y, z = one * other
    return x + (y + z)
