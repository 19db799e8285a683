"""Work of friction in the dry contacts of YADE's law, consistent with the work of central
differences on the bodies.

A step in which the shear force decreases from F to F' [N] while the contact slides by ds [m]
dissipates (F + F') / 2 ds.  A step in which the contact opens while its bodies slide by du [m]
dissipates F / 2 (F / k_s + du).  YADE's law sums F' ds over all contacts and steps; this module
adds the difference.  It does so at every step, since lightly compressed contacts open and close
from one step to the next: 0.5 us a contact, which asks YADE for three vectors, kept by reference,
and does what it does with them in YADE's own vectors, five times as fast as in their components.
"""

from dataclasses import dataclass

import numpy as np
import yade
from yade import Vector3

# [m], opening from which a contact is not checked until the next choice (up to 0.3 m/s)
_NEAR = 5e-5
_ZERO = Vector3(0, 0, 0)  # a sum is another vector, which does not change


@dataclass(slots=True)
class _Watched:
    """A contact: its geom, shear force [N] and its shear displacement in a step [m], which change
    with the contact; before: shear force in the last step [N]; closed: in the last step;
    half_compliance: half the shear compliance [m/N]."""

    geom: yade.ScGeom
    force: Vector3
    slid: Vector3
    before: Vector3
    closed: bool
    half_compliance: float


class FrictionWork:
    """Work of friction in all contacts of a Law2_ScGeom_FrictPhys_CundallStrack that traces its
    energy.

    The contacts of joints are added as they form.  For collisions of loose bricks only YADE's sum
    is available.
    """

    def __init__(self, law):
        self._law, self._rest = law, 0.0
        self._watched = {}  # {(id1, id2): _Watched}
        self._near = None  # those that are checked until the next choice, None for all

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
        geom, force = contact.geom, contact.phys.shearForce
        self._watched[contact.id1, contact.id2] = _Watched(
            geom, force, geom.shearInc, force + _ZERO, True, 0.5 / contact.phys.ks
        )
        self._near = None

    def forget(self, contact):
        """Remove an interaction."""
        del self._watched[contact.id1, contact.id2]
        self._near = None

    def end(self, contact, stored):
        """Remove an interaction whose elastic energy `stored` [J] dissipates."""
        self.forget(contact)
        self._rest += stored

    def tables(self):
        """Bodies of the interactions watched (n, 2), and their states (n, 6) as `watch_again` takes
        them."""
        near = None if self._near is None else set(map(id, self._near))
        states = [
            (*one.before, one.closed, one.half_compliance, near is None or id(one) in near)
            for one in self._watched.values()
        ]
        return (
            np.array(list(self._watched), int).reshape(-1, 2),
            np.array(states, float).reshape(-1, 6),
        )

    def watch_again(self, contacts, keys, states, slid):
        """Take over the state of another one.

        contacts: {(id1, id2): (geom, phys)}; keys, states: of those watched, in their order: shear
        force in the last step (3) [N], closed, half the compliance [m/N], whether it is checked;
        slid: YADE's sum [J]."""
        self._watched = {
            (first, second): _Watched(
                geom, phys.shearForce, geom.shearInc, Vector3(before), bool(closed), half
            )
            for (first, second), (*before, closed, half, _) in zip(keys, states)
            for geom, phys in [contacts[first, second]]
        }
        self._near = [one for one, state in zip(self._watched.values(), states) if state[-1]]
        self._law.initPlasticDissipation(slid)

    def step(self, anew):
        """Add the work of a step; to be called after every step.  anew: choose anew the contacts
        that are checked until the next choice, those that are closed or may close."""
        if anew or self._near is None:
            self._near = [
                one
                for one in self._watched.values()
                if not anew or one.closed or one.geom.penetrationDepth > -_NEAR
            ]
        left_out = 0.0
        for one in self._near:
            closed = one.geom.penetrationDepth >= 0
            if closed or one.closed:
                fall = one.before - one.force
                left_out += fall.squaredNorm() * one.half_compliance - fall.dot(one.slid) / 2
            one.before, one.closed = one.force + _ZERO, closed
        self._rest += left_out
