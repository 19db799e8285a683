"""How a run integrates in time: explicitly, or with selective mass scaling; and which runs are
accepted.

One rule (`is_shown`) decides where nothing is asked for.  A run with mass scaling whose energy
balance error exceeds ACCEPTED_ERROR is repeated with half the step, then explicitly in steps that
are accepted by the same error, last in those of softening joints; one in which a brick drops by
ACCEPTED_DROP_M from what bore it is repeated explicitly at once, since the scaled masses of failed
joints would hold it up.  On ground that settles, where bricks above openings drop, a run begins
with these explicit steps.  The first of them have the masses of the segments of lintels' beams
scaled, which never fail and which alone limit the steps of many walls.
"""

from dataclasses import replace

from damage.errors import InputError
from damage.motion.loading import Harmonic, Recorded
from damage.run.monitor import ENERGY, NotAccepted
from damage.run.schedule import choose_time_step
from damage.run.settings import ACCEPTED_ERROR, LINTELS, MOST_SCALED_STEP_S, NONE, SELECTIVE
from damage.wall.model_options import ModelOptions

SLENDER_S = 0.15
"""First period from which on a wall with openings takes the longest of the steps below [s]."""
SLENDER_STEP_S = 2e-4
"""Time step with selective mass scaling of such a wall [s]
(docs/validation/step-and-damping.md)."""
STIFF_STEP_S = 1e-4
"""Time step with selective mass scaling of a stiffer wall [s]."""
DEFORMABLE_STEP_S = 5e-5
"""Time step with selective mass scaling of deformable bricks [s]."""
_SHOWN = ModelOptions(), ModelOptions(bricks="deformable", contacts="gauss")
"""Models of the runs of that table."""
_FREE = "lintel", "top", "load", "strength_cov", "strength_seed", "inputs", "supports"
"""Options that are free beside these models."""


def is_shown(settings, wall):
    """Whether a damage.Wall under RunSettings is of a kind that was shown to be as accurate with
    mass scaling as in explicit steps: one of `_is_compared` on ground that rests."""
    return settings.settlement is None and _is_compared(settings, wall)


def _is_compared(settings, wall):
    """Whether a run is of a kind that was compared with explicit steps of softening joints: such
    joints, openings, bricks that stay whole, shaken by a record or harmonically.  On ground that
    settles the residual DI follows the damping of settling stages, which would differ from the
    default: there it has to be asked for."""
    model = {name: getattr(settings.model, name) for name in _FREE}
    return (
        wall.joint.softens
        and len(wall.openings) > 0
        and not wall.brick.splits
        and wall.joint.compressive_strength is None
        and not wall.restraints
        and (settings.settlement is None or settings.settling == "adaptive")
        and isinstance(settings.loading, Harmonic | Recorded)
        and settings.model in [replace(shown, **model) for shown in _SHOWN]
        and "local" not in (settings.relaxation, settings.settling)
    )


def schemes(settings, wall, modes):
    """(RunSettings, time step [s]) of a run and of those that repeat it until one is accepted;
    wall: damage.Wall, its `damage.linear.modes.Modes`.
    Raises InputError where steps with mass scaling are no longer than explicit ones, or longer than
    was shown."""
    critical_s = modes.critical_time_step_s
    masonry_s = modes.masonry_time_step_s
    step_s = settings.time_step_s or settings.loading.preferred_step_s(
        DEFORMABLE_STEP_S
        if settings.model.has_modes
        else SLENDER_STEP_S
        if wall.openings and modes.period_s[0] >= SLENDER_S
        else STIFF_STEP_S
    )

    def explicit(settings):
        """Runs in the step of brittle joints, then in that of this wall's."""
        steps = {
            choose_time_step(settings, critical_s, softens)
            for softens in (False, wall.joint.softens)
        }
        return tuple((settings, step) for step in sorted(steps, reverse=True))

    def lintels_first(settings):
        """Explicit runs, before them one with scaled lintels where these limit the step."""
        if settings.model.has_modes or not masonry_s > critical_s:
            return explicit(settings)
        longer_s = choose_time_step(settings, masonry_s)
        return ((replace(settings, mass_scaling=LINTELS), longer_s), *explicit(settings))

    by_rule = settings.mass_scaling is None and settings.time_step_s is None
    if settings.mass_scaling is None:
        shown = by_rule and is_shown(settings, wall) and step_s > critical_s
        settings = replace(settings, mass_scaling=SELECTIVE if shown else NONE)
    if settings.mass_scaling == LINTELS:
        _check_lintels(settings, masonry_s > critical_s)
        return lintels_first(replace(settings, mass_scaling=NONE))
    if settings.mass_scaling == NONE:
        if by_rule and settings.settlement and _is_compared(settings, wall):
            return lintels_first(settings)
        return explicit(settings)[-1:]
    _check_selective(wall, step_s, critical_s)
    half = [(settings, step_s / 2)] if step_s / 2 > critical_s else []
    masses = replace(settings, mass_scaling=NONE, time_step_s=None)
    return ((settings, step_s), *half, *lintels_first(masses))


def _check_selective(wall, step_s, critical_s):
    """Raise InputError where mass scaling does not go with a wall or its time step [s]."""
    if wall.restraints:
        raise InputError(
            "--mass-scaling selective of a wall with restraints: expected one without; leave "
            "--mass-scaling out"
        )
    if not critical_s < step_s <= MOST_SCALED_STEP_S:
        raise InputError(
            f"--mass-scaling selective with a time step of {step_s:.4g} s: expected more than the"
            f" critical one of this wall, {critical_s:.3g} s, and up to {MOST_SCALED_STEP_S:g} s;"
            " give another --dt, or leave --mass-scaling out"
        )


def _check_lintels(settings, limit):
    """Raise InputError where the masses of lintels that are asked for have no effect; limit:
    whether these limit the time step."""
    if settings.time_step_s or settings.model.has_modes or not limit:
        raise InputError(
            "--mass-scaling lintels: expected a wall of rigid bricks in which beams of lintels"
            " limit the time step, and no --dt; leave it out"
        )


def check_energy(error):
    """Raise NotAccepted where the energy balance error [-] of a run is too large; for runs that can
    be repeated in smaller steps."""
    if error is not None and not error <= ACCEPTED_ERROR:
        raise NotAccepted(
            ENERGY,
            f"energy balance error {100 * error:.2g} %, more than the {100 * ACCEPTED_ERROR:g} % "
            "accepted in large steps",
        )


def scaling_warnings(settings, wall):
    """What of a run with mass scaling is outside of what it was shown to be accurate for: a list of
    lines."""
    if settings.mass_scaling != SELECTIVE or is_shown(settings, wall):
        return []
    return [
        "--mass-scaling selective is less accurate, or was not compared with explicit steps, for a"
        " wall, motion or options of this kind (docs/validation/step-and-damping.md): compare with"
        " --mass-scaling none"
    ]
