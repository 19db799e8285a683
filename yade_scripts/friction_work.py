"""What friction takes in the dry contacts of YADE's law, exactly as central differences do work on the bodies.

A step in which the shear force falls from F to F' [N] while the contact slides by ds [m] takes (F + F') / 2 ds; one in
which the contact opens while its bodies slide by du [m] takes F / 2 (F / k_s + du).  YADE's law sums F' ds over all its
contacts and steps; the rest is added here.  It is found step by step: contacts that are hardly pressed open and close
from one to the next.
"""

from yade import Vector3


class FrictionWork:
    """Work of friction in all contacts of a Law2_ScGeom_FrictPhys_CundallStrack that traces its energy.

    Contacts are joints' own, added as they come; of others, loose bricks' collisions, it knows YADE's sum alone.
    """

    def __init__(self, law):
        self._law, self._rest, self._watched, self._near = law, 0.0, {}, []

    @property
    def total(self):
        """So far [J]."""
        return self._law.plasticDissipation() + self._rest

    def add(self, contact, limit):
        """Watch this interaction, which begins with the shear force of a bond that broke.

        limit [N]: to which that falls in the next step; what the bond loses by it is fracture, no friction.
        """
        self._rest -= max(contact.phys.shearForce.norm() - limit, 0.0) ** 2 / (2 * contact.phys.ks)
        self.renew(contact)

    def renew(self, contact):
        """Watch this interaction from where it is now, with the stiffness and the shear force that it was given."""
        geom, phys, key = contact.geom, contact.phys, (contact.id1, contact.id2)
        # YADE hands out these vectors themselves: what is read here once goes on to show their values.
        self._watched[key] = _Watched(geom, phys.shearForce, geom.shearInc, 0.5 / phys.ks)
        self._near = list(self._watched.values())

    def forget(self, contact):
        """Watch this interaction no more."""
        del self._watched[contact.id1, contact.id2]

    def end(self, contact, stored):
        """Watch this interaction no more, whose elastic energy [J] goes."""
        self.forget(contact)
        self._near = list(self._watched.values())
        self._rest += stored

    def choose(self, reach):
        """From now on look only at contacts that are closed, or open by less than a reach [m]."""
        self._near = [one for one in self._watched.values() if one.closed or one.geom.penetrationDepth > -reach]

    def step(self):
        """After every step."""
        self._rest += sum(map(_what_is_left_out, self._near))


class _Watched:
    """A contact: geom; force [N] and increment of the slide [m], as they are now; half its shear compliance [m/N];
    before: force of the last step; closed: in the last step."""

    __slots__ = "before", "closed", "force", "geom", "half_compliance", "increment"

    def __init__(self, geom, force, increment, half_compliance):
        self.geom, self.force, self.increment, self.half_compliance = geom, force, increment, half_compliance
        self.before, self.closed = Vector3(force), True


def _what_is_left_out(one):
    """Of the last step's work in a contact what YADE's sum leaves out [J]."""
    is_closed = one.geom.penetrationDepth >= 0
    if not (is_closed or one.closed):
        return 0.0
    fall = one.before - one.force
    one.before, one.closed = Vector3(one.force), is_closed
    return fall.squaredNorm() * one.half_compliance - fall.dot(one.increment) / 2
