"""When a run does what, in steps: the time step, the stages, the base motion of every step.

Every stage ends with a sample.
"""

import math
from dataclasses import dataclass

import numpy as np

from damage.errors import InputError
from damage.linear.modes import natural_modes
from damage.motion.samples import at_times
from damage.rounded import ACCELERATION, to_grid
from damage.run.settings import (
    LOCAL_DAMPING,
    LONGEST_S,
    MOST_STATES,
    MOST_STEPS,
    NONE,
    PUSH_PERIODS,
    SAMPLE_S,
    SELECTIVE,
    SETTLE_S,
)
from damage.run.solver import NO_MOTION
from damage.wall.restraints import top_of

STEP_FACTOR = 0.643
"""Working time step over the critical one: 3.0e-5 s for the shipped walls."""

SOFTENING_STEP_FACTOR = 0.35
"""Share of the critical step where joints soften (docs/validation/step-and-damping.md)."""

JOINT_STEPS = 10
"""Steps of which the interval of samples is a multiple: a solver may update its failed joints at
this interval."""


@dataclass(frozen=True)
class Stage:
    """name: "settlement", "motion", "rest" or "settling"; start_step, end_step: steps since the end
    of the static stage."""

    name: str
    start_step: int
    end_step: int


def choose_time_step(settings, critical_s, softens=False):
    """Return the run's time step [s]; raise InputError above the stable one.  softens: whether the
    wall's joints do.

    Viscous damping lowers the critical step to (2 / omega) (sqrt(1 + xi^2) - xi) with the ratio
    xi = alpha / (2 omega) + beta omega / 2; local damping by sqrt(1 + damping).
    """
    xi = (settings.beta_s or 0.0) / critical_s + settings.alpha_1_s * critical_s / 4
    limit = critical_s * min(np.sqrt(1 + xi * xi) - xi, 1 / np.sqrt(1 + LOCAL_DAMPING))
    if settings.time_step_s is None:
        factor = SOFTENING_STEP_FACTOR if softens else STEP_FACTOR
        return settings.loading.preferred_step_s(min(factor * critical_s, 0.85 * limit))
    if settings.time_step_s > limit:
        raise InputError(
            f"--dt {settings.time_step_s:g} s is above the stable time step {limit:.4g} s "
            f"(critical {critical_s:.4g} s, lowered by damping); give a smaller one"
        )
    return settings.time_step_s


def check_top(settings, layout, time_step):
    """Raise InputError where a pushed top that may not rotate has a restraint, or the rotational
    spring at the top is too stiff for the time step [s]: its own frequency on the body that carries
    the top has to stay below half of the stable one with its joints."""
    drive = settings.loading.drive
    if drive.top and not drive.top_rotates and top_of(layout.wall):
        raise InputError(
            f"--boundary fixed: a restraint holds the top of wall {layout.wall.name}, so that the"
            " push moves the course at mid-height, which turns; leave --boundary out"
        )
    if drive.floor_shares and settings.scales:
        raise InputError(
            f"--floor-share with --mass-scaling {settings.mass_scaling}: expected true masses;"
            " leave one of them out"
        )
    stiffness = drive.top_stiffness
    inertia = layout.bodies.inertia[layout.pushed_bodies].min()
    most = 0.25 * float(inertia) / time_step**2
    if stiffness > most:
        raise InputError(
            f"--top-rotation {stiffness:g} is too stiff for time steps of {time_step:.3g} s:"
            f" expected up to {most:.3g} N m/rad; give less, a smaller --dt, or --boundary fixed"
        )


def softening_warnings(settings, time_step, critical_s, beta_s):
    """What of a run's step and damping is outside of what softening joints were shown to need in a
    solver, by the damping [s] that it gives them: a list of lines."""
    warnings = []
    asked = settings.time_step_s is not None and not settings.scales
    if asked and time_step > 1.001 * SOFTENING_STEP_FACTOR * critical_s:
        warnings.append(
            f"--dt {time_step:.4g} s is {time_step / critical_s:.2f} of the critical step: expected"
            f" at most {SOFTENING_STEP_FACTOR:g} where joints soften; leave --dt out"
        )
    if settings.beta_s < beta_s and not settings.loading.drive.quasi_static:
        warnings.append(
            f"--beta {settings.beta_s:g} s: expected at least {beta_s:g} where joints"
            " soften, or cracks follow rounding and step; leave --beta out"
        )
    return warnings


def deformable_warnings(model, wall):
    """Choices of a ModelOptions and a damage.Wall that do not suit deformable bricks: a list of
    lines."""
    if not model.has_modes:
        return []
    warnings = []
    if model.contacts != "gauss":
        warnings.append(
            f"--bricks deformable with --contacts {model.contacts}: expected --contacts gauss,"
            " which alone passes the patch test; corner points fail joints at rest"
        )
    if not wall.joint.softens:
        warnings.append(
            "--bricks deformable with brittle joints: how many contact points fail depends on their"
            " number; give joints fracture energies (docs/model/model.md)"
        )
    if wall.brick.splits:
        warnings.append(
            f"--bricks deformable with a tensile strength of {wall.brick.tensile_strength / 1e6:g}"
            " MPa of the bricks: deformable bricks do not split, above it, either; for bricks that"
            " split give --bricks rigid"
        )
    return warnings


def sample_steps(time_step, mass_scaling=NONE):
    """Steps between two samples, nearest to SAMPLE_S; time_step [s].

    >>> sample_steps(3e-5), sample_steps(4e-4, "selective")
    (70, 5)
    """
    multiple = 1 if mass_scaling == SELECTIVE else JOINT_STEPS
    return multiple * max(1, round(SAMPLE_S / time_step / multiple))


def stages(settings, layout, time_step, sample_steps):
    """The stages after the static one, in order: a list of Stage.

    time_step [s]; sample_steps: steps between two samples.
    """
    sequence = []
    start = 0
    if settings.settlement:
        # the ground moves, then the wall comes to rest
        length_s = settings.settlement.moving_s(layout.ground.right.max()) + SETTLE_S
        start = sample_steps * math.ceil(length_s / (sample_steps * time_step))
        sequence = [Stage("settlement", 0, start)]
    if settings.loading.drive.quasi_static:
        height = layout.height_of_push(settings.loading.drive.floor_shares)
        # in the end what damping and the drift are behind fades
        rest_s = PUSH_PERIODS * float(natural_modes(layout).period_s[0])
        length_s = settings.loading.length_s(height) + rest_s
        n = math.ceil(length_s / (sample_steps * time_step))
        return [*sequence, Stage("motion", start, start + n * sample_steps)]
    if not settings.loading.moves:
        return sequence
    for event in settings.all_events:
        lengths = {"motion": event.loading.duration_s, "rest": event.rest_s, "settling": SETTLE_S}
        first = start
        elapsed_s = 0.0
        for name, length_s in lengths.items():
            elapsed_s += length_s
            end = first + sample_steps * math.ceil((elapsed_s / time_step - 0.5) / sample_steps)
            sequence.append(Stage(name, start, end))
            start = end
    return sequence


def zero_step(stages):
    """Step of time zero since the end of the static stage: the end of the settlement stage, if
    there is one."""
    return stages[0].end_step if stages[0].name == "settlement" else 0


def settlement_work(n_contacts):
    """Work of a step while the ground settles, over that of another one [-], of the reference
    solver: such walls are looked at after each sample, and step by themselves.

    Measured: about 6 of 146 contact points, where six walls share a process; a look costs what
    2600 contact points do, whatever the wall.

    >>> settlement_work(146), settlement_work(1810)
    (5.5, 2.6)
    """
    return round(1.5 + 2600 / (n_contacts + 500), 1)


def check_size(settings, layout, time_step):
    """Raise InputError of a run that is longer than can be, before anything is made for it;
    time_step [s]."""
    interval = sample_steps(time_step, settings.mass_scaling)
    steps = stages(settings, layout, time_step, interval)[-1].end_step
    length_s = steps * time_step
    if length_s > LONGEST_S:
        raise InputError(
            f"a run of {length_s:.6g} s: expected up to {LONGEST_S:g} s, a million samples; give a"
            " shorter motion or --rest, fewer --cycles or shocks, less drift or a larger --speed"
        )
    if steps > MOST_STEPS:
        raise InputError(
            f"a run of {length_s:.6g} s in {steps:.3g} steps of {time_step:.3g} s: expected up to "
            f"{MOST_STEPS:.0e} steps; give a larger --dt, less damping (--beta), or a shorter run"
        )
    # bytes of each
    states = steps / interval * layout.n_joints * (23 / 15 if settings.stresses else 1)
    if states > MOST_STATES:
        raise InputError(
            f"{steps / interval:.3g} samples of {layout.n_joints} contact points: expected up to "
            f"{MOST_STATES:.0e} states in all; give a shorter run, fewer --cells, or no --stresses"
        )


def base_acceleration(settings, schedule, time_step, axes=2):
    """Base acceleration of every step since the end of the static stage along x and z, (n_steps, 2)
    [m/s2], up to the last motion's end; none where the base is not accelerated.  Of three axes
    along x, z and the other horizontal direction, (n_steps, 3).

    Each event is its motion times its factor, rounded (`damage.rounded`).
    """
    if settings.loading.drive.base is None:
        return NO_MOTION
    starts = [stage.start_step for stage in schedule if stage.name == "motion"]
    lengths = [round(event.loading.duration_s / time_step) + 1 for event in settings.all_events]
    base = np.zeros((max(map(sum, zip(starts, lengths))), axes))
    for event, start, n_steps in zip(settings.all_events, starts, lengths):
        rows = slice(start, start + n_steps)
        time_s = np.arange(n_steps) * time_step
        in_plane = event.loading.drive.base(time_s)
        base[rows, :2] = to_grid(event.factor * in_plane, ACCELERATION)
        if axes == 3 and (record := event.loading.applied_across()) is not None:
            across = at_times(time_s, record.time_step_s, record.acceleration_m_s2)
            base[rows, 2] = to_grid(event.factor * across, ACCELERATION)
    return base
