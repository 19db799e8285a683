"""Work of friction in the dry contacts of YADE's law, consistent with the work of central
differences on the bodies.

A step in which the shear force decreases from F to F' [N] while the contact slides by ds [m]
dissipates
(F + F') / 2 ds.  A step in which the contact opens while its bodies slide by du [m] dissipates F /
2 (F / k_s + du). YADE's law sums F' ds over all contacts and steps; this module adds the
difference.  It does so at every step, since lightly compressed contacts open and close from one
step to the next.
"""

from dataclasses import dataclass

from yade import Vector3

# [m], opening from which a contact is not checked until the next choice (up to 0.3 m/s)
_NEAR = 5e-5


class FrictionWork:
    """Work of friction in all contacts of a Law2_ScGeom_FrictPhys_CundallStrack that traces its
    energy.

    The contacts of joints are added as they form.  For collisions of loose bricks only YADE's sum
    is available.
    """

    def __init__(self, law):
        self._law, self._rest, self._watched, self._near = law, 0.0, {}, []

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
        geom, phys, key = contact.geom, contact.phys, (contact.id1, contact.id2)
        # YADE returns references: these vectors always have the present values.
        self._watched[key] = _Watched(
            geom, phys.shearForce, geom.shearInc, 0.5 / phys.ks, Vector3(phys.shearForce)
        )
        self._near = list(self._watched.values())

    def forget(self, contact):
        """Remove an interaction."""
        del self._watched[contact.id1, contact.id2]

    def end(self, contact, stored):
        """Remove an interaction whose elastic energy `stored` [J] dissipates."""
        self.forget(contact)
        self._near = list(self._watched.values())
        self._rest += stored

    def watch_again(self, contacts, keys, states, slid):
        """Take over the state of another one: contacts: {(id1, id2): interaction}; keys, states: of
        those watched, in their order: shear force in the last step (3) [N], closed, half the
        compliance [m/N], whether it is checked; slid: YADE's sum [J]."""
        self._watched = {}
        for key, (*before, closed, half, _) in zip(map(tuple, keys), states):
            contact = contacts[key]
            geom, force = contact.geom, contact.phys.shearForce
            self._watched[key] = _Watched(
                geom, force, geom.shearInc, half, Vector3(before), bool(closed)
            )
        self._near = [one for one, state in zip(self._watched.values(), states) if state[-1]]
        self._law.initPlasticDissipation(slid)

    def step(self, anew):
        """Add the work of a step; to be called after every step.  anew: choose anew the contacts
        that are checked until the next choice, those that are closed or may close."""
        if anew:
            self._near = [
                one
                for one in self._watched.values()
                if one.closed or one.geom.penetrationDepth > -_NEAR
            ]
        self._rest += sum(map(_what_is_left_out, self._near))


@dataclass(slots=True)
class _Watched:
    """State of a contact: geom; force, increment: references to its shear force [N] and shear
    increment [m]; half its shear compliance [m/N]; before: shear force in the last step [N];
    closed: in the last step."""

    geom: object
    force: Vector3
    increment: Vector3
    half_compliance: float
    before: Vector3
    closed: bool = True


def _what_is_left_out(one):
    """Work of friction in a contact in the last step that YADE's sum lacks [J]."""
    is_closed = one.geom.penetrationDepth >= 0
    if not (is_closed or one.closed):
        return 0.0
    fall = one.before - one.force
    one.before, one.closed = Vector3(one.force), is_closed
    return fall.squaredNorm() * one.half_compliance - fall.dot(one.increment) / 2
