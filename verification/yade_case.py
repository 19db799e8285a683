"""Inside YADE: the problems of this package, one a process.

    ./yade -n -j1 verification/yade_case.py CASE [NUMBERS]

prints "result NUMBER".  The models are those of yade_scripts; what moves them is set in every step.
"""

import builtins
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

import numpy as np
from yade import O, PyRunner, Quaternion, Vector3

from damage.linear.modes import natural_modes
from damage.measure.cycles import natural_period
from damage.run.solver import NO_MOTION
from damage.units import GRAVITY
from damage.wall.kinds import CUT
from damage.wall.layout import lay_out
from verification import crushing, elastic, falling, rocking, sliding, splitting
from verification.block import one_block
from yade_scripts.bodies import TIP
from yade_scripts.crushing import Crushing
from yade_scripts.leaving import run_and_leave
from yade_scripts.model import build
from yade_scripts.scene import SceneReader
from yade_scripts.solver import YadeSolver


class Case:
    """A model, its arrays, and what is called in every step before the bodies move."""

    def __init__(self, layout, factor):
        self.layout = layout
        self.model = build(layout, factor * natural_modes(layout, 1).critical_time_step_s)
        self.scene = SceneReader(self.model)
        self.newton = self.model.newton
        self.crushing = Crushing(self.scene)
        self.newton.gravity = (0, 0, 0)
        self.each = None
        self.first = 0
        builtins.verification_step = self.step
        O.engines = [
            *O.engines[:-1],
            PyRunner(command="verification_step()", iterPeriod=1),
            self.newton,
        ]

    def run(self, steps, each=None):
        """Advance; each(k) is called in step k of these."""
        self.each = each
        self.first = O.iter
        O.run(steps, True)

    def step(self):
        """What the engine does in every step: broken bonds become dry joints, joints crush, then
        what `run` was given."""
        for joint in self.scene.beyond_strength()[0]:
            self.model.loosen(joint)
        self.crushing.step(anew=True)
        if self.each:
            self.each(O.iter - self.first)

    def field(self, along, gravity):
        """Uniform acceleration: backwards `along` x, downwards `gravity` [m/s2]."""
        self.newton.gravity = (-float(along), 0.0, -float(gravity))

    def rest(self):
        for state in self.scene.states:
            state.vel = state.angVel = Vector3.Zero

    def place(self, body=0):
        """Displacement (x, z) and rotation of a body."""
        return self.scene.motion()[body]


def fall(seconds):
    case = Case(one_block(), 0.5)
    state = case.scene.states[0]
    steps = round(seconds / O.dt)
    state.pos += Vector3(0, 0, 10.0)
    state.vel = Vector3(0, 0, GRAVITY * O.dt / 2)
    case.field(0.0, GRAVITY)
    case.run(steps)
    return (10.0 - case.place()[1]) * (seconds / (steps * O.dt)) ** 2


def bounce(height, key):
    case = Case(one_block(), 0.02)
    state = case.scene.states[0]
    state.pos += Vector3(0, 0, height)
    state.vel = Vector3(0, 0, GRAVITY * O.dt / 2)
    case.field(0.0, GRAVITY)
    steps = round(2.2 * math.sqrt(2 * height / GRAVITY) / O.dt)
    track = np.empty(steps)
    forces = []

    def each(k):
        track[k] = state.pos[2] - case.scene.start[0, 1]
        if track[k] < 0:
            forces.append(case.scene.base_reaction())

    case.run(steps, each)
    # The engine sees the place before the step, so the first one is that of time zero.
    return falling.apexes(track[1:], O.dt, max(forces))[falling.FIGURES[int(key)]]


def _resting(angle):
    """A block at rest on an incline that was tilted slowly."""
    case = Case(one_block(), 0.3)
    case.newton.damping = 0.7
    case.field(0.0, GRAVITY)
    steps = round(0.02 / O.dt)
    case.run(steps)
    case.run(2 * steps, lambda k: case.field(*sliding.downhill(angle * min(k / steps, 1.0))))
    case.newton.damping = 0.0
    case.rest()
    return case


def incline(angle, seconds):
    case = _resting(sliding.FLAT)
    steps = round(seconds / O.dt)
    start = case.place()[0]
    case.field(*sliding.downhill(angle))
    case.run(steps)
    return (case.place()[0] - start) * (seconds / (steps * O.dt)) ** 2


def shaken():
    case = _resting(sliding.GENTLE)
    motion = sliding.SHAKEN
    start = case.place()[0]
    steps = round((motion.duration_s + sliding.REST_S) / O.dt)
    along, gravity = sliding.downhill(sliding.GENTLE)
    base = motion.base_acceleration(np.arange(steps) * O.dt)[:, 0] + along
    case.run(steps, lambda k: case.field(base[min(k, steps - 1)], gravity))
    return case.place()[0] - start


def stack():
    layout = lay_out(elastic.STACK)
    case = Case(layout, 0.3)
    top = layout.drift_bodies[0]
    for state, (vx, vz, turn) in zip(case.scene.states, 1e-3 * natural_modes(layout, 1).shape[0]):
        state.vel = Vector3(vx, 0, vz)
        state.angVel = Vector3(0, -turn, 0)
    track = []
    case.run(
        round(elastic.STACK_S / O.dt),
        lambda k: k % 20 or track.append(case.scene.states[top].pos[0]),
    )
    return natural_period(20 * O.dt * np.arange(len(track)), np.array(track))


def onset(contacts, courses):
    return rocking.onset(("interior", "corners")[int(contacts)], int(courses), stands)


def fall_back(tilt):
    """As rocking.fall_back, in YADE: a block of no strength is lifted off first, which breaks its
    bonds."""
    layout = rocking.layout_of()
    case = Case(layout, 0.5)
    state = case.scene.states[0]
    x, z, sag = rocking.tilted(layout, tilt)
    state.pos += Vector3(0, 0, 1e-3)
    case.run(3)
    case.rest()
    upright = state.ori  # now that the tips are on
    # what the tip, which is round, reaches lower than the corner
    round_tip = TIP * (1 - math.cos(tilt))
    state.pos = Vector3(case.scene.start[0, 0] + x, 0, case.scene.start[0, 1] + z - sag + round_tip)
    state.ori = Quaternion(Vector3(0, 1, 0), tilt) * upright
    case.run(1)  # the members follow
    case.rest()
    case.field(0.0, GRAVITY)
    turns = [-tilt]

    def each(k):
        turns.append(case.place()[2])
        if turns[-1] >= 0:
            O.pause()

    case.run(round(2.0 / O.dt), each)
    return (len(turns) - 2 - turns[-1] / (turns[-1] - turns[-2])) * O.dt


def stands(layout, acceleration_g):
    """As rocking.stands, in YADE."""
    case = Case(layout, 0.5)
    case.newton.damping = 0.7
    case.field(0.0, GRAVITY)
    case.run(round(0.005 / O.dt))
    steps = round(rocking.RAMP_S / O.dt)
    along = -acceleration_g * GRAVITY
    case.run(steps, lambda k: case.field(along * k / steps, GRAVITY))
    case.field(along, GRAVITY)
    case.run(3 * steps)
    return abs(case.place()[2]) < rocking.LIFTED


def cantilever(finer):
    layout = elastic.cantilever(int(finer))
    if finer > 1:
        return elastic.balance(layout, _mover(Case(layout, 0.6)))
    case = Case(layout, 0.6)
    cap = len(layout.bodies) - 1
    clump = O.bodies[case.model.clumps[cap]]
    clump.state.blockedDOFs = "xyXZ"
    case.newton.damping = 0.7
    steps = round(0.05 / O.dt)
    clump.state.vel = Vector3(1e-6 / (steps * O.dt), 0, 0)
    case.run(steps)
    clump.state.vel = Vector3.Zero
    case.run(5 * steps)
    return case.scene.base_shear() / case.place(cap)[0]


def toe():
    """As crushing.toe, in YADE."""
    case = Case(crushing.block(), 0.5)
    case.newton.damping = 0.7
    case.field(0.0, GRAVITY)
    case.run(round(0.02 / O.dt))
    state = case.scene.states[0]
    state.blockedDOFs = "xyXZ"
    for speed, steps in crushing.pushes(O.dt):
        state.vel = (speed, state.vel[1], state.vel[2])
        case.run(steps)
    return -sum(O.forces.f(member, True)[0] for member in case.scene.members[0])


def column():
    """As crushing.column, in YADE."""
    layout = crushing.block()
    forces = []
    case = Case(layout, 0.5)
    case.field(0.0, 2 * crushing.column_force(layout) / layout.bodies.mass[0])
    case.run(200, lambda k: forces.append(case.scene.base_reaction()))
    return max(forces)


def splitting_load():
    """As splitting.load, in YADE."""
    layout = splitting.beam()
    solver = YadeSolver(layout, 0.5 * natural_modes(layout, 1).critical_time_step_s)
    solver.damp(local=0.7)
    n = round(splitting.RAMP_S / solver.time_step)
    field = splitting.ramp(layout, n)
    solver.start(NO_MOTION, field)
    solver.advance(n)
    return field[solver.drain_events()[0][0]] * layout.total_mass


def diagonal_tension(stress, what):
    """As splitting.sheared, in YADE."""
    layout = splitting.on_ground()
    step = 1e-6
    solver = YadeSolver(layout, step)
    forces = []
    here = np.zeros(2)
    for state in solver.scene.states:
        state.blockedDOFs = "xyzXYZ"
    for there in splitting.halves_moved(layout, stress):
        for state, speed in zip(solver.scene.states, (there - here) / step):
            state.vel = Vector3(0, 0, speed)
        here = there
        O.step()
        cuts = np.flatnonzero(layout.contacts.kind == CUT)
        forces.append(sum(solver.scene.force_of(cut)[1] for cut in cuts))
    return (max(forces), solver.tracker.fracture_energy)[int(what)]


def _mover(case):
    """The function that moves every body of a case and returns the contacts' forces on them, both
    (n_bodies, 3)."""
    states = case.scene.states
    scene = case.scene
    for state in states:
        state.blockedDOFs = "xyzXYZ"

    def forces_after(move):
        for state, (x, z, turn) in zip(states, move / O.dt):
            state.vel = Vector3(x, 0, z)
            state.angVel = Vector3(0, -turn, 0)
        case.run(1)
        case.rest()
        forces = []
        # The cells pass the step's velocity on to their bonds in the next step.
        case.run(1, lambda k: forces.extend(scene.resultants()))
        return np.array(forces)

    return forces_after


CASES = {
    case.__name__: case
    for case in (
        fall,
        bounce,
        incline,
        shaken,
        onset,
        fall_back,
        stack,
        cantilever,
        toe,
        column,
        splitting_load,
        diagonal_tension,
    )
}


def main():
    case, *numbers = sys.argv[1:]
    print("result", repr(float(CASES[case](*map(float, numbers)))))


run_and_leave(main)
