"""How a run integrates in time: explicitly, or with selective mass scaling; and which runs are accepted.

A run with mass scaling whose energy balance error exceeds ACCEPTED_ERROR is repeated with half the step, then
explicitly; one in which a brick drops by ACCEPTED_DROP_M from what bore it is repeated explicitly at once, for the
scaled masses of its failed joints would hold it up.
"""

from dataclasses import replace

from damage.errors import RunError
from damage.run.schedule import choose_time_step
from damage.run.settings import ACCEPTED_DROP_M, ACCEPTED_ERROR, NONE, SELECTIVE


class NotAccepted(RunError):
    """A run with mass scaling that is to be repeated; code: ENERGY, DROP or STEP."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


ENERGY, DROP, STEP = "energy", "drop", "step"


def by_rule(settings, wall, can_scale):
    """These settings with the mass scaling that a damage.Wall gets where nothing else was asked for; can_scale: whether
    the solver has any."""
    if settings.mass_scaling is not None:
        return settings
    return replace(settings, mass_scaling=SELECTIVE if can_scale and _is_accurate(settings, wall) else NONE)


def _is_accurate(settings, wall):
    """Whether selective mass scaling was shown to be accurate for this wall and motion."""
    return False


def schemes(settings, critical_s, softens, decay_1_s):
    """(RunSettings, time step [s]) of a run and of those that repeat it until one is accepted; arguments: as of
    `damage.run.schedule.choose_time_step`."""
    def of(settings):
        return settings, choose_time_step(settings, critical_s, softens, decay_1_s)

    first = of(settings)
    if settings.mass_scaling != SELECTIVE:
        return (first,)
    explicit = of(replace(settings, mass_scaling=NONE, time_step_s=None))
    half = replace(settings, time_step_s=first[1] / 2)
    return (first, *([of(half)] if first[1] / 2 > critical_s else []), explicit)


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
