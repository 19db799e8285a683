"""One run as a frozen record: what drives the wall, how it is modelled; and the settled numbers of every run."""

import math
from dataclasses import asdict, dataclass
from pathlib import Path

from damage.checks import check_not_negative, check_positive
from damage.errors import InputError
from damage.wall.parameters import ModelOptions

SAMPLE_S = 2e-3
"""Time between two samples of a history [s], about; a whole number of steps in the end."""
RAMP_S, HOLD_S, HOLD_AT_MOST_S = 0.2, 0.2, 3.0
"""Static stage: gravity ramps up, then holds until the wall is at rest [s]."""
AT_REST = 1e-5
"""Unbalanced force below which the static stage is over [-]."""
SETTLE_S = 0.5
"""Length of the settling stage [s] and its local damping [-]: the residual is its last state."""
LOCAL_DAMPING = 0.7
ADAPTIVE_DAMPING = 1.0
"""Share of the change of kinetic energy that adaptive damping takes [-]: of 0.4 to 2 it came to rest fastest."""
RELAXATIONS = ("adaptive", "local")


@dataclass(frozen=True)
class RunSettings:
    """One run: what drives the wall, how it is modelled, where the history goes.

    sequence: factors of the motion, a shock each; rest_s: free vibration after each shock [s], which ends
    with a settling stage; time_step_s: None for the solver's own;
    alpha_1_s, beta_s: damping proportional to mass [1/s] and stiffness [s] in dynamics; relaxation: how static
    solutions are found, one of RELAXATIONS; perturb_m: size of random offsets of the bricks [m]
    drawn with `seed`; past_collapse_s: how long bodies are followed after the first brick fell [s];
    out: history file, None for a name of its own below `results/`; command: what asked for it.
    """

    loading: object
    model: ModelOptions
    sequence: tuple[float, ...] = (1.0,)
    rest_s: float = 2.0
    time_step_s: float | None = None
    alpha_1_s: float = 0.0
    beta_s: float = 0.0
    relaxation: str = "local"
    perturb_m: float = 0.0
    seed: int = 0
    past_collapse_s: float = 0.0
    out: Path | None = None
    overwrite: bool = False
    pictures: bool = True
    view: bool = False
    command: str = ""

    def __post_init__(self):
        if not self.sequence or not all(map(math.isfinite, self.sequence)):
            raise InputError(f"--sequence {self.sequence}: expected factors of the motion, like 1,0.5,0.4")
        for option, value in (("--rest", self.rest_s), ("--beta", self.beta_s), ("--perturb", self.perturb_m),
                              ("--past-collapse", self.past_collapse_s)):
            check_not_negative(option, value)
        if self.time_step_s is not None:
            check_positive("--dt [s]", self.time_step_s)

    @property
    def duration_s(self):
        """From time zero to the end of the last settling stage [s]."""
        return len(self.sequence) * (self.loading.duration_s + self.rest_s + SETTLE_S)

    def as_dict(self):
        """All parameters as a plain dictionary, for files."""
        return {"loading": self.loading.as_dict(), "sequence": [float(factor) for factor in self.sequence],
                "model": asdict(self.model), "rest_s": self.rest_s, "settle_s": SETTLE_S, "alpha_1_s": self.alpha_1_s,
                "beta_s": self.beta_s, "relaxation": self.relaxation, "perturb_m": self.perturb_m, "seed": self.seed,
                "past_collapse_s": self.past_collapse_s, "command": self.command}


def rayleigh_factors(ratio, first_hz, second_hz):
    """(alpha [1/s], beta [s]) of C = alpha M + beta K with this damping ratio at two frequencies.

    ratio = alpha / (2 omega) + beta omega / 2 at both (Chopra, Dynamics of Structures, section 11.4).
    """
    if not (0 <= ratio < 1 and 0 < first_hz < second_hz < math.inf):
        raise InputError(f"--rayleigh {ratio:g} {first_hz:g} {second_hz:g}: expected a ratio from 0 to 1 and two "
                         "rising frequencies, like 0.02 5 20")
    first, second = 2 * math.pi * first_hz, 2 * math.pi * second_hz
    beta = 2 * ratio / (first + second)
    return beta * first * second, beta
