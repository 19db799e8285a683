"""How a run integrates in time: explicitly, or with selective mass scaling; and which runs are accepted.

A run with mass scaling whose energy balance error exceeds ACCEPTED_ERROR is repeated with half the step, then
explicitly; one in which a brick drops by ACCEPTED_DROP_M from what bore it is repeated explicitly at once, since the
scaled masses of failed joints would hold it up.
"""

from dataclasses import replace

from damage.errors import InputError, RunError
from damage.run.schedule import choose_time_step
from damage.run.settings import ACCEPTED_DROP_M, ACCEPTED_ERROR, MOST_SCALED_STEP_S, NONE, SELECTIVE

SLENDER_S = 0.15
"""First period from which on a wall with openings takes the longest of the steps below [s]."""
SLENDER_STEP_S, STIFF_STEP_S, DEFORMABLE_STEP_S = 2e-4, 1e-4, 5e-5
"""Time steps with selective mass scaling [s] (docs/validation/mass-scaling.md)."""
ENERGY, DROP, STEP = "energy", "drop", "step"


class NotAccepted(RunError):
    """A run with mass scaling that is to be repeated; code: ENERGY, DROP or STEP."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


def schemes(settings, wall, modes, decay_1_s):
    """(RunSettings, time step [s]) of a run and of those that repeat it until one is accepted; wall: damage.Wall;
    modes, decay_1_s: its natural ones, and `damage.wall.soil.fastest_decay`."""
    critical_s = modes.critical_time_step_s

    def explicit(settings):
        return settings, choose_time_step(settings, critical_s, wall.joint.softens, decay_1_s)

    if settings.mass_scaling != SELECTIVE:
        return (explicit(settings),)
    step_s = _scaled_step(settings, wall, modes)
    half = [(settings, step_s / 2)] if step_s / 2 > critical_s else []
    return ((settings, step_s), *half, explicit(replace(settings, mass_scaling=NONE, time_step_s=None)))


def _scaled_step(settings, wall, modes):
    """The first time step with mass scaling [s]; InputError below the explicit one, and above what was shown."""
    step_s, critical_s = settings.time_step_s, modes.critical_time_step_s
    if step_s is None:
        slender = len(wall.openings) > 0 and modes.period_s[0] >= SLENDER_S
        step_s = settings.loading.preferred_step_s(
            DEFORMABLE_STEP_S if settings.model.has_modes else SLENDER_STEP_S if slender else STIFF_STEP_S)
    if not critical_s < step_s <= MOST_SCALED_STEP_S:
        raise InputError(f"--mass-scaling selective with a time step of {step_s:.4g} s: expected more than the "
                         f"critical one of this wall, {critical_s:.3g} s, and up to {MOST_SCALED_STEP_S:g} s; give "
                         "another --dt, or leave --mass-scaling out")
    return step_s


def check_energy(settings, error):
    """Raise NotAccepted where the energy balance error [-] of a run with these settings is too large for its scheme."""
    if settings.mass_scaling == SELECTIVE and error is not None and not error <= ACCEPTED_ERROR:
        raise NotAccepted(ENERGY, f"energy balance error {100 * error:.2g} % with mass scaling, accepted up to "
                          f"{100 * ACCEPTED_ERROR:g} %")


def check_drop(drop_m, time_s):
    """Raise NotAccepted where a brick has dropped by so much [m] from what bore it; time_s: when."""
    if drop_m > ACCEPTED_DROP_M:
        raise NotAccepted(DROP, f"a brick has dropped by {1e3 * drop_m:.2g} mm from those that bore it by {time_s:.2f} "
                          f"s, with mass scaling accepted up to {1e3 * ACCEPTED_DROP_M:g} mm")


def scaling_warnings(settings, wall):
    """What of a run with mass scaling is outside of what it was shown to be accurate for: a list of lines."""
    if settings.mass_scaling != SELECTIVE or (wall.joint.softens and wall.openings):
        return []
    if wall.joint.softens:
        return ["--mass-scaling selective of a wall without openings: the widest crack may be 12 % too narrow "
                "(docs/validation/mass-scaling.md)"]
    return ["--mass-scaling selective with brittle joints: DI may be 13 % and residual DI several times too high; "
            "expected joints with fracture energies (docs/validation/mass-scaling.md)"]
