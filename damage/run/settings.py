"""One run as a frozen record: what drives the wall, how it is modelled; and the settled numbers of
every run."""

import math
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from damage.checks import check_range
from damage.errors import InputError
from damage.fields import MOST_SEED, check_fields, choice, quantity
from damage.house.plausible import ACCEPT, check_plausible
from damage.motion.intensity import pga_g, pgv_m_s
from damage.motion.loading import HIGHEST_G, Recorded
from damage.motion.plausible import implausible_motion, implausible_peak, implausible_velocity
from damage.motion.record import MOST_SCALE
from damage.motion.sequence import Event, as_table
from damage.motion.settlement import Settlement
from damage.wall.model_options import ModelOptions

SAMPLE_S = 2e-3
"""Time between two samples of a history [s], about; a whole number of steps in the end."""
RAMP_S = 0.2
"""Time in which gravity ramps up in the static stage [s]."""
HOLD_S = 0.2
"""Least time for which gravity then holds [s]."""
HOLD_AT_MOST_S = 3.0
"""Longest time for which gravity holds until the wall is at rest [s]."""
LONGEST_S = 2000.0
"""Longest run [s]."""
MOST_STEPS = 10**8
"""Largest number of time steps of a run."""
MOST_STATES = 10**9
"""Largest number of states of contact points in all samples of a run, fifteen bytes each when the
history is read."""
SETTLE_S = 0.5
"""Length of the settling stage [s]: the residual is its last state."""
LOCAL_DAMPING = 0.7
"""Local damping of the settling stage [-]."""
PUSH_PERIODS = 4
"""Length of the rest after a push, over the first period [-]."""
ADAPTIVE_DAMPING = 1.0
"""Share of the change of kinetic energy that adaptive damping takes [-]: of 0.4 to 2 it came to
rest fastest."""
SETTLED_BELOW = 0.01
"""Unbalanced force over contact forces up to which a wall is at rest on the settled ground [-]:
walls that stand had up to 1e-3, one that topples slowly, held up by local damping, 0.09."""
AFTER_FALL_S = 10.0
"""Longest time for which bricks are followed after the first one has fallen and the base is at rest
[s]."""
RESTS_BELOW_M_S = 0.05
"""Speed below which fallen bricks rest [m/s]; the standing part may still vibrate."""
RESTS_FOR_S = 0.2
"""Time for which fallen bricks are slower before they rest [s]."""
RELAXATIONS = ("adaptive", "local")
MOST_SCATTER = 0.2
"""Largest coefficient of variation by which members of an ensemble differ [-]: more is another
wall."""
SCATTER = 0.001
"""Coefficient of variation of the strengths by which members differ where nothing else is asked for
[-] (docs/guides/planning.md)."""
MOST_MEMBERS = 100
"""Largest number of members of a single run."""
MASS_SCALING = NONE, LINTELS, SELECTIVE = "none", "lintels", "selective"
MOST_SCALED_STEP_S = 4e-4
"""Largest time step with selective mass scaling [s]."""
ACCEPTED_ERROR = 0.004
"""Energy balance error of a run with selective mass scaling [-] above which it is repeated with a
smaller step."""
ACCEPTED_DROP_M = 0.5e-3
"""Drop of a brick in a run with selective mass scaling [m] from which it is repeated."""
SOFTENING_BETA_S = 1e-6
"""Stiffness-proportional damping that joints get which soften, where none is asked for [s]
(docs/validation/step-and-damping.md)."""


@dataclass(frozen=True)
class RunSettings:
    """One run: what drives the wall, how it is modelled, where the history goes; fields without a
    text here are options of the command line, with its help.

    settlement: damage.motion.settlement.Settlement of the ground before the motion, or None; it
    needs a support below each brick of the base; continued: history of the run that this one
    continues, or None; joints_without_bond: what names the joints that have none from the start, a
    frozen record with `joints(layout)`, (n_joints,) of bool, and `implausible(wall)`, words or
    None; or None; sequence: factors of the motion, an event each;
    events: of a sequence of different records, whose factors `sequence` has and whose strongest
    motion `loading` is; life: what the events were drawn from, with its `number`, by which the
    joints' strengths are drawn, too, or None; event: the one event that `loading` is the motion of,
    with its `life`, the number or None; or None;
    rest_s: free vibration after each event [s], which ends with a settling stage;
    alpha_1_s, beta_s: damping proportional to mass [1/s] and stiffness [s] in dynamics, beta_s None
    for what the joints need (`for_joint`); mass_scaling: None for what suits the wall
    (`damage.run.scheme`);
    units: bricks and courses of which one unit stands (`damage.house.coarser`);
    relaxation, settling: how static solutions are found, and how a wall settles after a motion;
    checkpoint_s: computing time between two checkpoints [s], infinity for one at an interruption
    only; resumed: history of this very run, which continues from its checkpoint, or None; out:
    history file, None for a name of its own below `results/`; console: "before" or "after" the run,
    or None; command: what asked for it.
    """

    loading: object
    model: ModelOptions
    units: tuple[int, int] = (1, 1)
    settlement: Settlement | None = None
    continued: str | None = None
    joints_without_bond: object | None = None
    sequence: tuple[float, ...] = (1.0,)
    events: tuple[Event, ...] = ()
    life: dict | None = None
    event: dict | None = None
    rest_s: float = quantity(
        "s",
        0,
        LONGEST_S,
        default=2.0,
        option="rest",
        metavar="S",
        help="free vibration after the motion",
    )
    time_step_s: float | None = quantity(
        "s",
        1e-9,
        1,
        default=None,
        option="dt",
        metavar="S",
        help="time step (default: from the wall)",
    )
    alpha_1_s: float = 0.0
    beta_s: float | None = quantity(
        "s",
        0,
        1,
        words=(None,),
        default=0.0,
        option="beta",
        metavar="S",
        help=(
            "stiffness"
            f"-proportional damping (default 0, and {SOFTENING_BETA_S:g} where joints soften)"
        ),
    )
    mass_scaling: str | None = choice(
        MASS_SCALING,
        default=None,
        help=(
            "selective: steps of up to 2e-4 s by masses that grow with the stiffness of the intact"
            " wall; lintels: longer steps by those of lintels alone; a run that is not accepted is"
            " repeated in smaller steps (default: by the wall and its motion,"
            " docs/validation/step-and-damping.md)"
        ),
    )
    relaxation: str = "local"
    settling: str | None = choice(
        RELAXATIONS,
        default=None,
        help=(
            "damping of settling stages (default: local, as in "
            "YADE, and adaptive with mass scaling)"
        ),
    )
    scatter: float = quantity(
        "1",
        0,
        MOST_SCATTER,
        default=0.0,
        metavar="COV",
        help=("scatter of the joints' strengths, for ensembles: coefficient of variation"),
    )
    seed: int = quantity("1", 0, MOST_SEED, whole=True, default=0, help="seed of the scatter")
    members: int = quantity(
        "1",
        1,
        MOST_MEMBERS,
        whole=True,
        default=1,
        metavar="N",
        help=(
            "reference solver: N runs with strengths that scatter by --scatter (default"
            f" {SCATTER:g}), seeds from --seed (default 1) on; prints the median and range of what"
            " is measured, and keeps the history of the first"
        ),
    )
    checkpoint_s: float = math.inf
    resumed: str | None = None
    after_fall: bool = False
    stresses: bool = False
    accept_implausible: bool = False
    out: Path | None = None
    overwrite: bool = False
    pictures: bool = True
    quiet: bool = False
    view: bool = False
    console: str | None = None
    command: str = ""

    def __post_init__(self):
        if self.settlement and self.model.supports == "one":
            vars(self)["model"] = replace(self.model, supports="bricks")
        number = self.life["number"] if self.life else self.event and self.event["life"]
        if number is not None and self.model.draws:
            vars(self)["model"] = replace(self.model, strength_seed=number)
        self._check_past()
        if not self.sequence:
            raise InputError(
                "--sequence without a factor: expected factors of the motion, like 1,0.5,0.4"
            )
        for factor in self.sequence:
            check_range("a factor of --sequence", factor, -MOST_SCALE, MOST_SCALE)
        check_fields(self)
        for event in self.events:
            check_range("--rest [s]", event.rest_s, 0, LONGEST_S)
        self._check_scaling()
        self._check_motion()

    def _check_scaling(self):
        if not self.scales:
            return
        local = [name for name in ("relaxation", "settling") if getattr(self, name) == "local"]
        if local:
            raise InputError(
                f"--mass-scaling {self.mass_scaling} with --{local[0]} local: local damping needs"
                " the masses themselves; leave one of them out"
            )

    def _check_past(self):
        if not self.loading.moves and not self.settlement:
            raise InputError("no motion and no settlement: expected one of them; give one")
        if self.members > 1 and (self.resumed or self.checkpoint_s < math.inf):
            raise InputError(
                "--members with --checkpoint or --resume: expected a single run, as members step "
                "together; leave these out"
            )
        if self.resumed and (self.overwrite or self.out not in (None, Path(self.resumed))):
            raise InputError(
                f"--resume {self.resumed} with --out or --overwrite: expected one of them, as the"
                " run continues in the file that it has; leave the other out"
            )
        if self.continued and (
            self.after_fall or self.members > 1 or self.loading.drive.first_mode_m_s
        ):
            raise InputError(
                "--continue with --after-fall, --members or --free-vibration: expected one wall "
                "that continues from its last state; leave these out"
            )

    def _check_motion(self):
        if self.peak_g > HIGHEST_G:
            raise InputError(
                f"a base motion of up to {self.peak_g:.3g} g: expected up to {HIGHEST_G:g} g; give"
                " a smaller --scale or --sequence, or look at the record's unit"
            )

    @property
    def peak_g(self):
        """Largest acceleration of the base, at the largest factor of the sequence [g]."""
        return max(event.loading.peak_g * abs(event.factor) for event in self.all_events)

    @property
    def all_events(self):
        """The events in their order, a tuple of Event: those of a sequence of records, or the
        loading times each factor."""
        return self.events or tuple(
            Event(self.loading, factor, self.rest_s) for factor in self.sequence
        )

    @property
    def recorded(self):
        """The events whose motion is a record, a tuple of Event."""
        return tuple(event for event in self.all_events if isinstance(event.loading, Recorded))

    def check_plausible(self, wall):
        """InputError where a damage.Wall or the motion has values that are beyond those of masonry
        and earthquakes, unless they are accepted."""
        if self.accept_implausible:
            return
        check_plausible(wall)
        motions = [
            (motion, abs(event.factor))
            for event in self.recorded
            for motion in (event.loading.applied(), event.loading.applied_across())
            if motion is not None
        ]
        pgv = max((pgv_m_s(motion) * factor for motion, factor in motions), default=0.0)
        peak = max([self.peak_g, *(pga_g(motion) * factor for motion, factor in motions)])
        messages = [
            *implausible_motion(self.loading, (1.0,) if self.life else self.sequence),
            implausible_peak(peak) or implausible_velocity(pgv),
            self.joints_without_bond and self.joints_without_bond.implausible(wall),
        ]
        if messages := list(filter(None, messages)):
            raise InputError(
                f"{'; '.join(messages)}. Correct the value or its unit, or accept all values"
                f" as given: {ACCEPT}"
            )

    def for_period(self, period_s):
        """These settings with their motions as they drive a wall of that first period [s]
        (`Loading.for_period`). Raises InputError of a record whose samples cannot hold that period,
        unless implausible values are accepted."""
        motions = {
            id(loading): loading
            for loading in (self.loading, *(event.loading for event in self.events))
        }
        for motion in motions.values():
            if (
                isinstance(motion, Recorded)
                and motion.record.time_step_s > period_s / 2
                and not self.accept_implausible
            ):
                raise InputError(
                    f"{motion.record.name}: a time step of {motion.record.time_step_s:g} s;"
                    f" expected at most half of the wall's first period of {period_s:.3g} s, which"
                    " its samples do not hold: look at the time column, give a finer record, or"
                    f" accept it: {ACCEPT}"
                )
        driven = {key: motion.for_period(period_s) for key, motion in motions.items()}
        return replace(
            self,
            loading=driven[id(self.loading)],
            events=tuple(
                replace(event, loading=driven[id(event.loading)]) for event in self.events
            ),
        )

    @property
    def ground_moves(self):
        """Whether the ground moves below the base, so that the drift leaves the base's rigid motion
        out."""
        return self.settlement is not None or self.model.soil != "rigid"

    def for_joint(self, joint, softening_beta_s=SOFTENING_BETA_S):
        """These settings with the damping [s] that a solver gives a damage.wall.parameters.Joint
        which softens, where none was asked for."""
        if self.beta_s is not None:
            return self
        return replace(self, beta_s=softening_beta_s if joint.softens else 0.0)

    @property
    def scales(self):
        """Whether masses are scaled."""
        return self.mass_scaling in (LINTELS, SELECTIVE)

    @property
    def settles(self):
        """How the wall settles after a motion, one of RELAXATIONS."""
        return self.settling or ("adaptive" if self.scales else "local")

    def as_dict(self):
        """All parameters as a plain dictionary, for files."""
        as_they_are = (
            "rest_s",
            "alpha_1_s",
            "beta_s",
            "mass_scaling",
            "relaxation",
            "scatter",
            "seed",
            "after_fall",
            "command",
        )
        where_given = {
            "life": self.life,
            "event": self.event,
            "stresses": self.stresses,
            "units": self.units != (1, 1) and self.units,
        }
        return {
            "loading": self.loading.as_dict(),
            "settlement": self.settlement and asdict(self.settlement),
            "continued": self.continued and Path(self.continued).name,
            "cracked": self.joints_without_bond and asdict(self.joints_without_bond),
            "sequence": [float(factor) for factor in self.sequence],
            **as_table(self.events),
            "model": asdict(self.model),
            "settle_s": SETTLE_S,
            "settling": self.settles,
            **{name: getattr(self, name) for name in as_they_are},
            **{name: value for name, value in where_given.items() if value},
        }


def rayleigh_factors(ratio, first_hz, second_hz):
    """(alpha [1/s], beta [s]) of C = alpha M + beta K with this damping ratio at two frequencies.

    ratio = alpha / (2 omega) + beta omega / 2 at both (Chopra, Dynamics of Structures, section
    11.4).
    """
    if not (0 <= ratio < 1 and 0.01 <= first_hz < second_hz <= 1000):
        raise InputError(
            f"--rayleigh {ratio:g} {first_hz:g} {second_hz:g}: expected a ratio from 0 to 1 and two"
            " rising frequencies from 0.01 to 1000, like 0.02 5 20"
        )
    first = 2 * math.pi * first_hz
    second = 2 * math.pi * second_hz
    beta = 2 * ratio / (first + second)
    return beta * first * second, beta
