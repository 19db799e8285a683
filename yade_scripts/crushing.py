"""Joints that crush, (C1) and (C2) of the joint law: YADE's laws do not know of it, their rest positions can be moved.

A bond at rest is `initD` long; a tip on a face has its radius for an offset, so that either moves by the closure.  Both
are looked at after the forces of a step are known, and what they are over the strength is taken back before anything
moves; friction alone had it for its limit in that step.
"""

import numpy as np

_NEAR = 5e-5  # [m], a joint that is so much farther from its strength needs no look until the next time: at 0.3 m/s


class Crushing:
    """Watches the joints of a SceneReader's wall that can crush."""

    def __init__(self, scene):
        contacts, n = scene.model.layout.contacts, scene.model.layout.n_joints
        self._scene = scene
        self._limit = -(contacts.compressive_strength / contacts.normal_stiffness)[:n]  # openings [m]
        self._joints = np.flatnonzero(np.isfinite(self._limit)).tolist()
        self._near = []

    def step(self, anew):
        """After every step; anew: choose anew which joints may crush until the next time.

        Returns [(joint, by how much it closed for good [m]), ...]."""
        opening, limit = self._scene.opening_of, self._limit
        if anew:
            self._near = [joint for joint in self._joints if opening(joint) < limit[joint] + _NEAR]
        crushed = [(joint, float(limit[joint] - opening(joint))) for joint in self._near
                   if opening(joint) < limit[joint]]
        for joint, more in crushed:
            self._scene.crush(joint, more)
        return crushed
