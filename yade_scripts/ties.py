"""Ties between the leaves of a cavity wall, elastic until one reaches its strength."""

import numpy as np


class Ties:
    """The ties of a scene; rows: their contact points (n_ties,)."""

    def __init__(self, scene):
        self.scene = scene
        self.model = scene.model
        layout = self.model.layout
        contacts = self.model.layout.contacts
        others = np.arange(layout.n_joints, len(contacts))
        self.rows = others[np.isfinite(contacts.tensile_strength[others])]
        self._stiffness = scene.normal_stiffness[self.rows]
        self._least, self._most = (
            sign * (strength * contacts.area)[self.rows]
            for sign, strength in (
                (-1, contacts.compressive_strength),
                (1, contacts.tensile_strength),
            )
        )

    @property
    def failed(self):
        """Their number."""
        return int((~self.model.bonded[self.rows]).sum())

    def forces(self):
        """Forces of all ties, tension positive (n_ties,) [N]."""
        opening = [self.scene.opening_of(row) for row in self.rows]
        return self._stiffness * np.array(opening)

    def step(self):
        """Remove those that have reached a strength; returns their elastic energy, which dissipates
        [J]."""
        if len(self.rows) == 0:
            return 0.0
        force = self.forces()
        failed = (force < self._least) | (force > self._most)
        for row in self.rows[failed]:
            self.model.remove(row)
        return 0.5 * float(np.sum(force[failed] ** 2 / self._stiffness[failed]))
