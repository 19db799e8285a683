"""When a run does what: the shocks of a sequence, each with its motion, rest and settling, in steps.

Both solvers follow the same schedule.  Every stage ends with a sample.
"""

import math
from dataclasses import dataclass

import numpy as np

from damage.run.settings import SETTLE_S


@dataclass(frozen=True)
class Stage:
    """shock: number of the shock, from 1; name: "motion", "rest" or "settling"; start_step, end_step:
    steps since time zero."""

    shock: int
    name: str
    start_step: int
    end_step: int


def stages(settings, time_step, sample_steps):
    """The stages of a shaken wall, in order: a list of Stage.

    time_step [s]; sample_steps: steps between two samples.
    """
    lengths = {"motion": settings.loading.duration_s, "rest": settings.rest_s, "settling": SETTLE_S}
    found, start = [], 0
    for shock in range(1, len(settings.sequence) + 1):
        first, elapsed_s = start, 0.0
        for name, length_s in lengths.items():
            elapsed_s += length_s
            end = first + sample_steps * math.ceil((elapsed_s / time_step - 0.5) / sample_steps)
            found.append(Stage(shock, name, start, end))
            start = end
    return found


def base_acceleration(settings, schedule, time_step):
    """Base acceleration of every step along x and z, (n_steps, 2) [m/s2], up to the last motion's end.

    Each shock is the settings' loading times its factor.
    """
    motions = [stage for stage in schedule if stage.name == "motion"]
    n_steps = round(settings.loading.duration_s / time_step) + 1
    once = settings.loading.base_acceleration(np.arange(n_steps) * time_step)
    base = np.zeros((motions[-1].start_step + n_steps, 2))
    for factor, stage in zip(settings.sequence, motions):
        base[stage.start_step:stage.start_step + n_steps] = factor * once
    return base
