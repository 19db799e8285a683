"""The top of a wall in YADE, moved quasi-statically: its horizontal velocity is prescribed."""

import numpy as np
from yade import O

HELD = {"cantilever": "xyXZ", "fixed": "xyXYZ"}  # degrees of freedom that do not follow their forces


class PushedTop:
    """Moves the layout's pushed bodies as a TopDisplacement says, with a new velocity every `interval_s` [s].

    velocities: of all intervals, (n_intervals,) [m/s]; velocity: the present one.
    """

    def __init__(self, layout, scene, loading, interval_s):
        self.velocities, self.velocity = loading.velocities(interval_s, layout.pushed_height), 0.0
        self.scene, self.bodies = scene, layout.pushed_bodies
        self.states = [scene.states[body] for body in self.bodies]
        self.mass = float(layout.bodies.mass[self.bodies].sum())
        for state in self.states:
            state.blockedDOFs = HELD[loading.boundary]
        held = [0, 2] if loading.boundary == "fixed" else [0]
        scene.follows[np.ix_(self.bodies, held)] = 0.0

    def prescribe(self, interval):
        """Take the velocity of an interval; returns the jump of the kinetic energy [J].  The last one stays."""
        old, self.velocity = self.velocity, float(self.velocities[min(interval, len(self.velocities) - 1)])
        for state in self.states:
            state.vel = (self.velocity, state.vel[1], state.vel[2])
        return 0.5 * self.mass * (self.velocity**2 - old**2)

    def force(self):
        """Horizontal force that moves the top [N]: what the joints below hold it back with."""
        return -sum(O.forces.f(cell, True)[0] for body in self.bodies for cell in self.scene.members[body])

    def power(self):
        """Of that force [W]."""
        return self.force() * self.velocity
