"""Work of friction in the dry contacts of YADE's law, consistent with the work of central
differences on the bodies.

A step in which the shear force decreases from F to F' [N] while the contact slides by ds [m]
dissipates (F + F') / 2 ds.  A step in which the contact opens while its bodies slide by du [m]
dissipates F / 2 (F / k_s + du).  YADE's law sums F' ds over all contacts and steps; this module
adds the difference.  It does so at every step, since lightly compressed contacts open and close
from one step to the next.
"""

import numpy as np

from yade_scripts.memory import ContactNumbers

# [m], opening from which a contact is not checked until the next choice (up to 0.3 m/s)
_NEAR = 5e-5


class FrictionWork:
    """Work of friction in all contacts of a Law2_ScGeom_FrictPhys_CundallStrack that traces its
    energy.

    The dry contacts of joints, one of each of n contact points, are added as they form.  For
    collisions of loose bricks only YADE's sum is available.  numbers: ContactNumbers by contact
    point, of those.
    """

    def __init__(self, law, n):
        self._law, self._rest = law, 0.0
        self._watched, self.numbers = {}, ContactNumbers(n)  # keys are the contact points, in order
        # shear force in the last step [N], half the shear compliance [m/N]
        self._before, self._half_compliance = np.zeros((3, n)), np.zeros(n)
        self._closed = np.ones(n, bool)  # in the last step
        self._near = None  # those that are checked until the next choice, None for all

    @property
    def total(self):
        """Work of friction so far [J]."""
        return self._law.plasticDissipation() + self._rest

    def add(self, joint, contact, limit):
        """Add an interaction that begins with the shear force of a failed bond.

        limit: to which that force falls in the next step [N]; the energy lost by this is fracture,
        not friction.
        """
        self._rest -= max(contact.phys.shearForce.norm() - limit, 0.0) ** 2 / (2 * contact.phys.ks)
        self.renew(joint, contact)

    def renew(self, joint, contact):
        """Add or update an interaction with its present state, stiffness and shear force."""
        phys = contact.phys
        self._watch(joint, contact.geom, phys, phys.shearForce, True, 0.5 / phys.ks)

    def _watch(self, joint, geom, phys, force, closed, half_compliance):
        self._watched[joint] = None
        self.numbers.put(joint, geom, phys)
        self._before[:, joint], self._closed[joint] = tuple(force), closed
        self._half_compliance[joint], self._near = half_compliance, None

    def forget(self, joint):
        """Remove the interaction of a contact point."""
        del self._watched[joint]
        self._near = None

    def end(self, joint, stored):
        """Remove an interaction whose elastic energy `stored` [J] dissipates."""
        self.forget(joint)
        self._rest += stored

    @property
    def _all(self):
        return np.fromiter(self._watched, int, len(self._watched))

    def tables(self):
        """The contact points watched (n,), and their states (n, 6) as `watch_again` takes them."""
        joints, near = self._all, self._all if self._near is None else self._near
        columns = self._closed, self._half_compliance, np.isin(np.arange(len(self._closed)), near)
        return joints, np.column_stack([*self._before, *columns])[joints]

    def watch_again(self, contacts, joints, states, slid):
        """Take over the state of another one: contacts: {contact point: (geom, phys)}; joints,
        states: of those watched, in their order: shear force in the last step (3) [N], closed, half
        the compliance [m/N], whether it is checked; slid: YADE's sum [J]."""
        self._watched = {}
        for joint, (*before, closed, half, _) in zip(joints, states):
            self._watch(joint, *contacts[joint], before, bool(closed), half)
        self._near = self._all[[bool(state[-1]) for state in states]] if states else None
        self._law.initPlasticDissipation(slid)

    def step(self, anew):
        """Add the work of a step; to be called after every step.  anew: choose anew the contacts
        that are checked until the next choice, those that are closed or may close."""
        if not self._watched:
            return
        if anew or self._near is None:
            self._near = self._all
        near = self._near
        depth, slid, force = self.numbers.read(near)
        if anew:
            chosen = self._closed[near] | (depth > -_NEAR)
            near, depth, slid, force = (
                near[chosen],
                depth[chosen],
                slid[:, chosen],
                force[:, chosen],
            )
            self._near = near
        is_closed = depth >= 0
        checked = is_closed | self._closed[near]
        fall = self._before[:, near] - force
        self._before[:, near], self._closed[near] = force, is_closed
        left_out = _dot(fall, fall) * self._half_compliance[near]
        left_out -= _dot(fall, slid) / 2
        self._rest += sum(np.where(checked, left_out, 0.0).tolist())  # in the order of the contacts


def _dot(one, other):
    x, y, z = one * other
    return x + (y + z)
