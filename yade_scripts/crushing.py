"""Crushing of joints in YADE, (C1) and (C2) of the joint law, by moving the rest positions of its contacts.

YADE's laws have no crushing.  The rest length of a bond is `initD`, that of a tip on a face its radius; both change by
the plastic closure.  After the forces of a step are known, the force beyond the strength is removed before the bodies
move.  Only the friction limit of that step includes it.
"""

import numpy as np

_NEAR = 5e-5  # [m], a joint farther than this from its strength is not checked until the next choice (up to 0.3 m/s)


class Crushing:
    """Crushing of the joints of a SceneReader's wall."""

    def __init__(self, scene):
        contacts, n = scene.model.layout.contacts, scene.model.layout.n_joints
        self._scene = scene
        self._limit = -(contacts.compressive_strength / contacts.normal_stiffness)[:n]  # openings [m]
        self._joints = np.flatnonzero(np.isfinite(self._limit)).tolist()
        self._near = []

    def step(self, anew):
        """Crush joints after a step; returns [(joint, increment of its plastic closure [m]), ...].

        anew: choose anew the joints that are checked at every step.
        """
        opening, limit = self._scene.opening_of, self._limit
        if anew:
            self._near = [joint for joint in self._joints if opening(joint) < limit[joint] + _NEAR]
        crushed = [(joint, float(limit[joint] - opening(joint))) for joint in self._near
                   if opening(joint) < limit[joint]]
        for joint, more in crushed:
            self._scene.crush(joint, more)
        return crushed
