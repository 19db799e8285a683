"""Crushing of joints in YADE, (C1) to (C3) of the joint law, by moving the rest positions of its
contacts.

YADE's laws have no crushing.  The rest length of a bond is `initD`, that of a tip on a face its
radius; both change by the plastic closure.  After the forces of a step are known, the force beyond
the strength is removed before the bodies move.  Only the friction limit of that step includes it.
"""

import numpy as np

from damage.law.joint_law import LawParameters, closure_growth, material_of

# [m], a joint farther than this from its strength is not checked until the next choice (up to 0.3
# m/s)
_NEAR = 5e-5


class Crushing:
    """Crushing of the joints of a SceneReader's wall."""

    def __init__(self, scene):
        contacts = scene.model.layout.contacts
        n = scene.model.layout.n_joints
        self._scene = scene
        self._strength = contacts.compressive_strength[:n].copy()
        self._stiffness = contacts.normal_stiffness[:n]
        self._limit = -self._strength / self._stiffness  # openings [m]
        joint = scene.model.layout.wall.joint
        self._law = LawParameters(
            0.0,
            0.0,
            0.0,
            0.0,
            material_of(joint),
            crushing_energy=(joint.compressive_fracture_energy or 0.0),
            compressive_strength=joint.compressive_strength or np.inf,
        )
        self._joints = np.flatnonzero(np.isfinite(self._limit)).tolist()
        self._near = []

    def step(self, anew):
        """Crush joints after a step; returns [(joint, increment of its plastic closure [m], work of
        it [J/m2]), ...].

        anew: choose anew the joints that are checked at every step.
        """
        opening = self._scene.opening_of
        limit = self._limit
        if anew:
            self._near = [joint for joint in self._joints if opening(joint) < limit[joint] + _NEAR]
        crushed = [
            (joint, *self._grow(joint, opening(joint)))
            for joint in self._near
            if opening(joint) < limit[joint]
        ]
        for joint, more, _ in crushed:
            self._scene.model.crush(joint, more)
        return crushed

    def _grow(self, joint, opening):
        """Increment of the plastic closure of a joint [m] and its work [J/m2] by the joint law;
        opening [m]: measured from the rest position."""
        law = self._law._replace(normal_stiffness=self._stiffness[joint])
        strength = self._strength[joint]
        more, left = closure_growth(-opening, self._scene.model.closure[joint], strength, law)
        self._strength[joint] = left
        self._limit[joint] = -left / self._stiffness[joint]
        return float(more), float((strength + left) / 2 * more)
