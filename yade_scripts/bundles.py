"""Softening bonds in YADE as parallel elements (`damage.wall.fibres`): one bond and one dry contact
for each contact point.

All elements of a contact point have the same opening and shear displacement.  The intact ones have
always been elastic: together they are one bond with their share of the area, which fails with the
weakest.  The failed ones are one dry contact.  An element joins it with its shear stress at the
friction limit.  Where the stress of the others differs, all take the mean, and the loss of elastic
energy counts as friction.

YADE's law removes the entire force of a bond that fails.  The force of the intact elements is
restored in the same step, as forces on its two members, before the bodies move.
"""

import math
from typing import NamedTuple

import numpy as np
from yade import O

from damage.law.joint_law import stays_elastic


class Broken(NamedTuple):
    """Failed parallel element: its share of the area [-], kind "tension" or "shear", whether it was
    the last one."""

    share: float
    kind: str
    last: bool


class Bundles:
    """Parallel elements of a YadeWall whose layout has them."""

    def __init__(self, model):
        self.model, self.fibres, contacts = model, model.layout.fibres, model.layout.contacts
        # For each contact point the row of its weakest intact element, and the row after its last
        # one.
        self._weakest = np.flatnonzero(np.append(True, self.fibres.last[:-1]))
        self._end = np.flatnonzero(self.fibres.last) + 1
        self._area, self._normal, self._shear = (
            contacts.area,
            contacts.normal_stiffness,
            contacts.shear_stiffness,
        )

    def held(self, joint):
        """Share of the area of a contact point that is intact [-]."""
        return float(self.fibres.share[self._weakest[joint] : self._end[joint]].sum())

    def give_way(self, joint, sigma, tau):
        """Fail the weakest elements of a bond that failed in YADE's law, and restore the others.

        sigma, tau: stresses in the elements that were intact [Pa].  Returns the failed ones,
        [Broken, ...].
        """
        bond = self.model.bonds[joint]
        let_go = bond.phys.normalForce + bond.phys.shearForce  # force by the law in this step
        broken = self._weakest_of(joint, sigma, tau)
        failed, area, last = sum(one.share for one in broken), self._area[joint], broken[-1].last
        pressed = min(sigma, 0.0)
        rubs = math.copysign(min(abs(tau), -pressed * bond.phys.tanFrictionAngle), tau)
        bears = self.model.force_on(joint, bond.geom, failed * area * pressed, failed * area * rubs)
        held = 0.0 if last else self.held(joint)
        bears += self.model.force_on(joint, bond.geom, held * area * sigma, held * area * tau)
        push(bond, bears - let_go)
        self._rub(joint, failed, rubs)
        if last:
            self.model.part(joint)
        else:
            self._bond_again(joint, bond, held, sigma, tau)
        return broken

    def _weakest_of(self, joint, sigma, tau):
        """Elements that fail, at least the weakest intact one: [Broken, ...]; stresses [Pa]."""
        fibres, broken = self.fibres, []
        while True:
            row = self._weakest[joint]
            kind = "tension" if sigma > fibres.tensile_strength[row] else "shear"
            broken.append(Broken(float(fibres.share[row]), kind, bool(fibres.last[row])))
            if broken[-1].last:
                return broken
            self._weakest[joint] = row = row + 1
            friction = self.model.physics[joint].tanFrictionAngle
            if stays_elastic(
                sigma, tau, fibres.tensile_strength[row], fibres.cohesion[row], friction
            ):
                return broken

    def _bond_again(self, joint, bond, held, sigma, tau):
        """Make a failed bond the bond of its intact elements, `held` of the area, with these
        stresses [Pa]."""
        row, area, phys = self._weakest[joint], held * self._area[joint], bond.phys
        phys.isCohesive, phys.crossSection = True, float(area)
        # The distance of the members grows with the square of the slip; setting initD removes the
        # excess.
        phys.initD = bond.geom.penetrationDepth + float(sigma / self._normal[joint])
        phys.kn, phys.ks = float(area * self._normal[joint]), float(area * self._shear[joint])
        phys.FnMax = float(area * self.fibres.tensile_strength[row])
        phys.FsMax = float(area * self.fibres.cohesion[row])
        phys.normalForce = self.model.force_on(joint, bond.geom, area * sigma, 0.0)
        phys.shearForce = self.model.force_on(joint, bond.geom, 0.0, area * tau)

    def _rub(self, joint, share, stress):
        """Add failed elements, a share of the area, with their shear stress [Pa] to the dry contact
        of a joint."""
        if joint not in self.model.frayed:
            self.model.fray(joint)
        dry, area = self.model.frayed[joint], share * self._area[joint]
        dry.phys.kn += float(area * self._normal[joint])
        dry.phys.ks += float(area * self._shear[joint])
        dry.phys.shearForce += self.model.force_on(joint, dry.geom, 0.0, area * stress)
        self.model.work.renew(joint, dry)


def push(bond, force):
    """Add a force [N] at the contact point to a bond's second member, and its opposite to the
    first."""
    geom = bond.geom
    for member, sign, radius in ((bond.id1, -1.0, geom.refR1), (bond.id2, 1.0, geom.refR2)):
        O.forces.addF(member, sign * force)
        O.forces.addT(member, (radius - geom.penetrationDepth / 2) * geom.normal.cross(-force))
