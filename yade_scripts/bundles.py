"""Bonds that soften, as fibres (`damage.wall.fibres`): one bond and one dry contact for all fibres of a contact point.

All fibres of a contact point feel the same opening and shear displacement, and those that hold have been elastic ever
since: together they are one bond, of their share of the area, that breaks with the weakest.  Those that broke are one
dry contact.  Each enters it at its limit, where the others are too when it breaks in sliding on; where they are not,
their stresses become one, the mean, and what that takes of elastic energy counts as friction.

YADE's law lets go of all a bond bore when it breaks.  What the other fibres bear is put back in the same step, as
forces on its two members, before anything moves.
"""

import math
from typing import NamedTuple

import numpy as np
from yade import O, Vector3

from damage.wall.joint_law import friction_left, material_of, stays_elastic


class Broken(NamedTuple):
    """A fibre that broke: its share of the area [-], "tension" or "shear", whether it was the last."""

    share: float
    kind: str
    last: bool


class Bundles:
    """The fibres of a YadeWall whose layout has them."""

    def __init__(self, model):
        self.model, self.fibres, contacts = model, model.layout.fibres, model.layout.contacts
        # Row of the weakest fibre that holds, of every contact point; of the first of the next one's.
        self._weakest = np.flatnonzero(np.append(True, self.fibres.last[:-1]))
        self._end = np.flatnonzero(self.fibres.last) + 1
        self._area, self._normal, self._shear = contacts.area, contacts.normal_stiffness, contacts.shear_stiffness
        # A head joint's shear is positive along z, where its normal lies along x; a bed joint's the other way round.
        self._handed = np.where(contacts.upright, -1.0, 1.0)
        self._friction = friction_left(False, material_of(model.layout.wall.joint))

    def held(self, joint):
        """Share of the area that holds [-]."""
        return float(self.fibres.share[self._weakest[joint]:self._end[joint]].sum())

    def give_way(self, joint, sigma, tau):
        """The weakest fibres of a bond that YADE's law has broken do, the others hold on.

        sigma, tau [Pa]: stresses in the fibres that held.  Returns [Broken, ...].
        """
        bond = self.model.bonds[joint]
        let_go = bond.phys.normalForce + bond.phys.shearForce  # what the law made of it in this step
        broken = self._weakest_of(joint, sigma, tau)
        gone, area, last = sum(one.share for one in broken), self._area[joint], broken[-1].last
        pressed = min(sigma, 0.0)
        rubs = math.copysign(min(abs(tau), -pressed * self._friction), tau)
        bears = self._force(joint, bond.geom, gone * area * pressed, gone * area * rubs)
        held = 0.0 if last else self.held(joint)
        bears += self._force(joint, bond.geom, held * area * sigma, held * area * tau)
        _push(bond, bears - let_go)
        self._rub(joint, gone, rubs)
        if last:
            self.model.part(joint)
        else:
            self._bond_again(joint, bond, held, sigma, tau)
        return broken

    def _weakest_of(self, joint, sigma, tau):
        """The fibres that break, at least the weakest that holds: [Broken, ...]."""
        fibres, broken = self.fibres, []
        while True:
            row = self._weakest[joint]
            kind = "tension" if sigma > fibres.tensile_strength[row] else "shear"
            broken.append(Broken(float(fibres.share[row]), kind, bool(fibres.last[row])))
            if broken[-1].last:
                return broken
            self._weakest[joint] = row = row + 1
            if stays_elastic(sigma, tau, fibres.tensile_strength[row], fibres.cohesion[row], self._friction):
                return broken

    def _bond_again(self, joint, bond, held, sigma, tau):
        """Make of a broken bond that of the fibres that hold."""
        row, area, phys = self._weakest[joint], held * self._area[joint], bond.phys
        phys.isCohesive, phys.crossSection = True, float(area)
        # The line between the members grows with the square of the slip; what it was too long falls away here.
        phys.initD = bond.geom.penetrationDepth + float(sigma / self._normal[joint])
        phys.kn, phys.ks = float(area * self._normal[joint]), float(area * self._shear[joint])
        phys.FnMax = float(area * self.fibres.tensile_strength[row])
        phys.FsMax = float(area * self.fibres.cohesion[row])
        phys.normalForce = self._force(joint, bond.geom, area * sigma, 0.0)
        phys.shearForce = self._force(joint, bond.geom, 0.0, area * tau)

    def _rub(self, joint, share, stress):
        """Let the fibres that broke, a share of the area, rub with a shear stress [Pa] beside those that did before."""
        if joint not in self.model.frayed:
            self.model.fray(joint)
        dry, area = self.model.frayed[joint], share * self._area[joint]
        dry.phys.kn += float(area * self._normal[joint])
        dry.phys.ks += float(area * self._shear[joint])
        dry.phys.shearForce += self._force(joint, dry.geom, 0.0, area * stress)
        self.model.rub(joint)

    def _force(self, joint, geom, normal, shear):
        """Of an interaction on its second member, by YADE's order: normal (tension positive) and shear force [N]."""
        n, along = geom.normal, -float(self._handed[joint] * shear)
        return -float(normal) * n + along * Vector3(n[2], 0, -n[0])


def _push(bond, force):
    """Add a force [N] at the contact point on a bond's second member, and against it on the first."""
    geom = bond.geom
    for member, sign, radius in ((bond.id1, -1.0, geom.refR1), (bond.id2, 1.0, geom.refR2)):
        O.forces.addF(member, sign * force)
        O.forces.addT(member, (radius - geom.penetrationDepth / 2) * geom.normal.cross(-force))
