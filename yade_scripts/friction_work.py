"""Work of friction in the dry contacts of YADE's law, consistent with the work of central
differences on the bodies.

A step in which the shear force decreases from F to F' [N] while the contact slides by ds [m]
dissipates (F + F') / 2 ds.  A step in which the contact opens while its bodies slide by du [m]
dissipates F / 2 (F / k_s + du).  YADE's law sums F' ds over all contacts and steps; this module
adds the difference, (F - F') / 2 ds.  It does so at every step, since lightly compressed contacts
open and close from one step to the next.

YADE is asked for one contact after the other, and computes with its own vectors, which takes a
fraction of the time of their components in Python.
"""

from dataclasses import dataclass

import numpy as np
import yade
from yade import Vector3

# [m], opening from which a contact is not checked until the next choice (up to 0.3 m/s)
_NEAR = 5e-5
# a sum with it is another vector, which does not change with YADE's contact
_ZERO = Vector3(0, 0, 0)


@dataclass(slots=True)
class _Contact:
    """The dry contact of a contact point.

    geom: YADE's; force: shear force [N]; slid: shear displacement in the last step [m]: both change
    with YADE's contact; before: shear force in the last step [N]; closed: in the last step;
    half_compliance: half the shear compliance [m/N].
    """

    geom: yade.ScGeom
    force: Vector3
    slid: Vector3
    before: Vector3
    closed: bool
    half_compliance: float


class FrictionWork:
    """Work of friction in all contacts of a Law2_ScGeom_FrictPhys_CundallStrack that traces its
    energy.

    The dry contacts of joints, one of each contact point, are added as they form.  For collisions
    of loose bricks only YADE's sum is available.
    """

    def __init__(self, law):
        self._law = law
        self._rest = 0.0
        self._watched = {}  # {contact point: _Contact}, in the order in which they are summed
        self._near = None  # contacts that are checked until the next choice, None for all

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
        force = phys.shearForce + _ZERO
        self._watch(joint, contact.geom, phys, force, closed=True, half_compliance=0.5 / phys.ks)

    def _watch(self, joint, geom, phys, before, closed, half_compliance):
        """Add or update a contact with this shear force in the last step; other arguments as of
        _Contact."""
        force = phys.shearForce
        slid = geom.shearInc
        self._watched[joint] = _Contact(
            geom=geom,
            force=force,
            slid=slid,
            before=before,
            closed=closed,
            half_compliance=half_compliance,
        )
        self._near = None

    def forget(self, joint):
        """Remove the interaction of a contact point."""
        del self._watched[joint]
        self._near = None

    def end(self, joint, stored):
        """Remove an interaction whose elastic energy `stored` [J] dissipates."""
        self.forget(joint)
        self._rest += stored

    def tables(self):
        """The contact points watched (n,), and their states (n, 6) as `watch_again` takes them."""
        near = self._watched.values() if self._near is None else self._near
        checked = {id(contact) for contact in near}
        states = [
            (*contact.before, contact.closed, contact.half_compliance, id(contact) in checked)
            for contact in self._watched.values()
        ]
        return np.array(list(self._watched), int), np.array(states, float).reshape(-1, 6)

    def watch_again(self, contacts, joints, states, slid):
        """Take over the state of another one: contacts: {contact point: (geom, phys)}; joints,
        states: of those watched, in their order: shear force in the last step (3) [N], closed, half
        the compliance [m/N], whether it is checked; slid: YADE's sum [J]."""
        self._watched = {}
        for joint, (*before, closed, half_compliance, _) in zip(joints, states):
            self._watch(joint, *contacts[joint], Vector3(before), bool(closed), half_compliance)
        if states:
            self._near = [
                contact for contact, state in zip(self._watched.values(), states) if state[-1]
            ]
        self._law.initPlasticDissipation(slid)

    def step(self, anew):
        """Add the work of a step; to be called after every step.  anew: choose anew the contacts
        that are checked until the next choice, those that are closed or may close."""
        if anew or self._near is None:
            self._near = list(self._watched.values())
        if anew:
            self._near = [
                contact
                for contact in self._near
                if contact.closed or contact.geom.penetrationDepth > -_NEAR
            ]
        left_out = 0.0
        for contact in self._near:
            was_closed = contact.closed
            contact.closed = contact.geom.penetrationDepth >= 0
            if contact.closed or was_closed:
                fall = contact.before - contact.force
                left_out += (
                    fall.squaredNorm() * contact.half_compliance - fall.dot(contact.slid) / 2
                )
                contact.before = contact.force + _ZERO
        self._rest += left_out
