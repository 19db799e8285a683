"""Cuts through bricks in YADE by the joint law itself, in place of YADE's.

YADE's bonds neither soften nor see the vertical stress of their brick.  Those of cuts never fail by
themselves: after the forces of a step are known, the joint law replaces those beyond its elastic
range, before the bodies move.
"""

import numpy as np

from damage.law.joint_law import (
    INTACT,
    ContactState,
    LawParameters,
    advance,
    diagonal_tension,
    inelastic_opening,
    material_of,
    range_left,
    stays_elastic,
)
from damage.wall.split import CUT_POINTS, beside_cuts
from yade_scripts.bundles import push

_NEAR = 0.8  # [-], share of its strengths from which a point is checked until the next choice


class Splitting:
    """Cuts of a SceneReader's wall, followed by its JointTracker; cohesion: (n_joints,) [Pa];
    slid: plastic shear displacement, (n_joints,) [m]; states: (n_joints, fields) of ContactState.
    """

    def __init__(self, scene, tracker):
        self._scene, self._tracker, layout = scene, tracker, scene.model.layout
        self._cuts, self._beside = beside_cuts(layout.contacts)
        self._joints = (self._cuts[:, None] + np.arange(CUT_POINTS)).ravel().tolist()
        self._brick, self._near = layout.wall.brick, []
        self._tension = layout.contacts.tensile_strength
        self._material = material_of(layout.wall.joint)
        self.cohesion = layout.contacts.cohesion[: layout.n_joints].copy()
        self.slid = np.zeros(layout.n_joints)
        self.states = np.tile(np.array(ContactState(), float), (layout.n_joints, 1))

    def confine(self):
        """Give all cuts what they bear in shear under the vertical stresses now."""
        for cut, beside in zip(self._cuts, self._beside):
            stress = [self._scene.force_of(k)[0] / self._scene.area[k] for k in beside if k >= 0]
            self.cohesion[cut : cut + CUT_POINTS] = diagonal_tension(
                self._brick.tensile_strength, sum(stress) / 4
            )

    def step(self, anew):
        """Apply the joint law after a step; returns [(joint, event, ContactState), ...] of bonds
        that failed.  anew: choose anew the points that are checked at every step."""
        if anew:
            self._near = [joint for joint in self._joints if self._is_near(joint)]
        failed = []
        for joint in self._near:
            if self._scene.model.bonded[joint]:
                event, new = self._advance(joint)
                if event != INTACT:
                    failed.append((joint, event, new))
        return failed

    def _law_of(self, joint):
        energy, tracker = self._brick.fracture_energy or 0.0, self._tracker
        return LawParameters(
            float(tracker.normal_stiffness[joint]),
            float(tracker.shear_stiffness[joint]),
            float(self._tension[joint]),
            float(self.cohesion[joint]),
            self._material,
            energy,
            energy,
        )

    def _trial(self, joint, stiffness):
        """Opening [m] and shear stress [Pa] by YADE's law, without what sliding adds to the
        distance of the bond's members."""
        scene, geom = self._scene, self._scene.geometries[joint]
        tau = scene.force_of(joint)[1] / float(scene.area[joint])
        apart = geom.refR1 + geom.refR2 - geom.penetrationDepth
        return scene.opening_of(joint) - (self.slid[joint] + tau / stiffness) ** 2 / (
            2 * apart
        ), tau

    def _is_near(self, joint):
        if not self._scene.model.bonded[joint]:
            return False
        state, law = self._state(joint), self._law_of(joint)
        opening, tau = self._trial(joint, law.shear_stiffness)
        left = range_left(state, law)
        sigma = law.normal_stiffness * opening
        within = stays_elastic(
            sigma, tau, _NEAR * left.tensile_strength, _NEAR * left.cohesion, left.friction
        )
        if state.kappa == 0.0:
            self._keep(joint, state._replace(normal_stress=sigma, shear_stress=tau))
        return state.kappa > 0.0 or not within

    def _state(self, joint):
        return ContactState(*self.states[joint].tolist())

    def _keep(self, joint, state):
        self.states[joint] = state

    def _advance(self, joint):
        """Event and ContactState of a point after a step, its forces on the bodies corrected."""
        scene, tracker, law = self._scene, self._tracker, self._law_of(joint)
        area, old = float(scene.area[joint]), self._state(joint)
        opening, tau = self._trial(joint, law.shear_stiffness)
        new, event = advance(opening, (tau - old.shear_stress) / law.shear_stiffness, old, law)
        self._keep(joint, new)
        if event == INTACT and new.kappa == 0.0:
            return event, new
        bond, sigma = scene.model.bonds[joint], law.normal_stiffness * scene.opening_of(joint)
        pull = scene.model.force_on(joint, bond.geom, area * (new.normal_stress - sigma), 0.0)
        rub = scene.model.force_on(joint, bond.geom, 0.0, area * (new.shear_stress - tau))
        push(bond, pull + rub)
        bond.phys.normalForce += pull
        bond.phys.shearForce += rub
        self.slid[joint] += (tau - new.shear_stress) / law.shear_stiffness
        tracker.softens(
            joint,
            area * (new.fracture_work - old.fracture_work),
            area * (new.friction_work - old.friction_work),
            inelastic_opening(opening, new.normal_stress, law.normal_stiffness),
            new.slip,
            self.slid[joint],
        )
        secant = new.normal_stress / opening if opening > 0 else law.normal_stiffness
        scene.normal_stiffness[joint] = area * secant
        return event, new
