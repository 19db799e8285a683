"""A block that slides: down an incline, and on a shaken incline (Newmark 1965).

An incline of angle a is gravity turned by a: the block slides with g (sin a - cos a tan phi), and
rests where
a < phi.  Shaken along the incline by a_b(t), it sticks until -a_b passes the yield acceleration
a_y = g (cos a tan phi - sin a); then its velocity grows with -a_b - a_y until it is zero again:

    v(t) = (A/omega) (cos omega t - cos omega t_0) - a_y (t - t_0)      for a_b = A sin(omega t)

Ways are a few tenths of a millimetre, as in walls that crack, and 10 mm, as in walls that fall: a
contact's normal that leans with the slip s by s/h would let the block gain a further g s/h.

Uphill it would need a_b = g (cos a tan phi + sin a), which the motion does not reach, so it moves
downhill by the same way in every cycle.  Newmark, Effects of earthquakes on dams and embankments,
Géotechnique 15(2), doi:10.1680/geot.1965.15.2.139.
"""

import math

import numpy as np
from scipy.optimize import brentq

from damage.motion.loading import Harmonic
from damage.units import GRAVITY
from verification.block import DRY, one_block, settle, solver_of
from verification.problem import of_both

STEEP = math.radians(40)
FLAT = math.radians(31.5)
GENTLE = math.radians(20)
SLIDE_S = 0.015
FAR_S = 0.11
SHAKEN = Harmonic(period_s=0.02, amplitude_g=0.5, cycles=3)
REST_S = 0.01
BETA_S = 1e-5
"""Stiffness-proportional damping of the shaken block: without it the joint's vibration, which every
stop excites, makes the normal force chatter."""


def problems():
    """Slip on an incline steeper and flatter than the friction angle; slip of a block on a shaken
    incline."""
    friction = math.tan(DRY.friction_angle)
    way = GRAVITY * (math.sin(STEEP) - math.cos(STEEP) * friction) * SLIDE_S**2 / 2
    return [
        of_both(
            "incline of 40°",
            f"way in {SLIDE_S:g} s",
            "m",
            way,
            "Coulomb",
            3e-3,
            lambda: slide_down(STEEP),
            "incline",
            STEEP,
            SLIDE_S,
        ),
        of_both(
            "incline of 40°, far",
            f"way in {FAR_S:g} s",
            "m",
            way * (FAR_S / SLIDE_S) ** 2,
            "Coulomb",
            3e-3,
            lambda: slide_down(STEEP, FAR_S),
            "incline",
            STEEP,
            FAR_S,
        ),
        of_both(
            "incline of 31.5°",
            f"way in {SLIDE_S:g} s",
            "m",
            0.0,
            "Coulomb: below the friction angle of 32°",
            1e-7,
            lambda: slide_down(FLAT),
            "incline",
            FLAT,
            SLIDE_S,
        ),
        of_both(
            "shaken incline of 20°",
            "way after 3 cycles of 0.02 s, 0.5 g",
            "m",
            newmark_slip(SHAKEN, GENTLE, friction),
            "Newmark (1965)",
            {"reference": 3e-3, "yade": 5e-3},
            slide_shaken,
            "shaken",
        ),
    ]


def newmark_slip(motion, angle, friction):
    """Way [m] downhill of a rigid block on an incline that a Harmonic shakes, until it rests."""
    amplitude = motion.amplitude_g * GRAVITY
    omega = 2 * math.pi / motion.period_s
    limit = GRAVITY * (math.cos(angle) * friction - math.sin(angle))
    start = (math.pi + math.asin(limit / amplitude)) / omega

    def speed(t):
        return amplitude / omega * (math.cos(omega * t) - math.cos(omega * start)) - limit * (
            t - start
        )

    def way(t):
        return (
            amplitude
            / omega
            * (
                (math.sin(omega * t) - math.sin(omega * start)) / omega
                - math.cos(omega * start) * (t - start)
            )
            - limit * (t - start) ** 2 / 2
        )

    fastest = (2 * math.pi - math.asin(limit / amplitude)) / omega
    stop = brentq(speed, fastest, start + motion.period_s)
    # The last slide continues after the motion's end, where only friction and gravity act.
    end = motion.period_s
    last = way(end) + speed(end) ** 2 / (2 * limit) if stop > end else way(stop)
    return (motion.cycles - 1) * way(stop) + last


def downhill(angle):
    """Horizontal base acceleration and gravity [m/s2] that stand for an incline."""
    return -GRAVITY * math.sin(angle), GRAVITY * math.cos(angle)


def slide_down(angle, seconds=SLIDE_S):
    """Way of the block on an incline, after it came to rest on one just below the friction
    angle."""
    wall = _resting(FLAT, 0.0)
    steps = round(seconds / wall.time_step)
    along, gravity = downhill(angle)
    start = wall.displacement[0, 0]
    wall.start(np.tile([along, 0.0], (steps, 1)), np.array([gravity]))
    wall.run(steps)
    return (wall.displacement[0, 0] - start) * (seconds / (steps * wall.time_step)) ** 2


def slide_shaken():
    """Way of the block down the shaken incline."""
    wall = _resting(GENTLE, BETA_S)
    steps = round((SHAKEN.duration_s + REST_S) / wall.time_step)
    along, gravity = downhill(GENTLE)
    start = wall.displacement[0, 0]
    base = SHAKEN.base_acceleration(np.arange(steps) * wall.time_step) + np.array([along, 0.0])
    wall.start(base, np.array([gravity]))
    wall.run(steps)
    return wall.displacement[0, 0] - start


def _resting(angle, beta):
    """A block at rest on an incline that was tilted slowly."""
    wall = solver_of(one_block(), 0.3)
    settle(wall, GRAVITY)
    wall.local_damping = 0.7
    steps = round(0.02 / wall.time_step)
    angles = angle * np.minimum(np.arange(2 * steps) / steps, 1.0)
    wall.start(np.column_stack([-GRAVITY * np.sin(angles), 0 * angles]), GRAVITY * np.cos(angles))
    wall.run(2 * steps)
    wall.local_damping = 0.0
    wall.beta = beta
    wall.velocity = 0.0
    return wall
