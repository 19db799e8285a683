"""How large a claim is, and about how long its draws take."""

from dataclasses import dataclass

import numpy as np

from damage.applications.studies.folder import ROOT
from damage.house.coarser import in_units
from damage.reference.session import BACKEND, STATIC_S
from damage.run.session import check, plan_of
from damage.wall.file import load_wall

RATES = 2e7, 2e8
"""Contact points times steps that a process takes in a second: of ten draws of large walls that
crack much, and of many of small ones; 96 draws of 12 304 contact points had 4.8e7, 192 of 2085
7e7, 480 of 336 7e7 to 1.2e8."""
OVERHEAD = 500
"""Contact points that what a step takes besides counts for."""
LIVES = 8
"""Whose motions say how long a draw is."""


@dataclass(frozen=True)
class Size:
    """contact_points: of the wall; steps: of a draw, by both of its runs, on average."""

    contact_points: int
    steps: float

    def minutes(self, draws, jobs):
        """Least and most of so many draws in so many processes [min]."""
        work = (self.contact_points + OVERHEAD) * self.steps * draws / jobs / 60
        return [max(1.0, work / rate) for rate in reversed(RATES)]

    def describe(self, draws, jobs):
        """So many draws in words, in so many processes."""
        low, high = map(two_digits, self.minutes(draws, jobs))
        return (
            f"{self.contact_points} contact points x {two_digits(self.steps)} steps x {draws}"
            f" draws: {low} to {high} minutes"
        )


def size_of(study):
    """The Size of a claim's study; nothing runs."""
    steps = 0.0
    # both runs of a draw; further points have the same for more draws
    for run in (run for run in study.runs if run.offset == 0):
        settings = [run.settings(ROOT, number) for number in range(1, LIVES + 1)]
        wall = in_units(load_wall(ROOT / run.wall), settings[0].units)
        plan = plan_of(BACKEND, wall, check(BACKEND, wall, settings[0]))
        steps += (STATIC_S + np.mean([one.duration_s for one in settings])) / plan.time_step
    return Size(plan.layout.n_joints, float(steps))


def two_digits(value):
    """A number rounded to two digits, in words without an exponent.

    >>> two_digits(123.4), two_digits(0.3), two_digits(1.26)
    ('120', '0.3', '1.3')
    """
    return f"{float(f'{value:.2g}'):.10g}"
