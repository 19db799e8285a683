"""A problem with an exact solution, and the result of each solver."""

import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path

from yade_scripts import COMMAND

SOLVERS = ("reference", "yade")
ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Problem:
    """name; quantity: what is compared, with its unit; exact: its value, or a function of no
    arguments that works it out; source: of the solution; tolerance: {solver: largest relative
    error}, absolute where the exact value is zero; solvers: {solver: function without arguments
    that measures it, or a string that says why it cannot}.
    """

    name: str
    quantity: str
    unit: str
    exact: float | Callable
    source: str
    tolerance: dict
    solvers: dict[str, Callable | str]

    @cached_property
    def exact_value(self):
        """The number that `exact` is or works out, in `unit`."""
        return float(self.exact() if callable(self.exact) else self.exact)

    def judge(self, solver):
        """Result of one solver."""
        how = self.solvers[solver]
        if isinstance(how, str):
            return Result(self, solver, None, None, how)
        value = float(how())
        error = (value - self.exact_value) / (abs(self.exact_value) or 1.0)
        return Result(self, solver, value, error, "")


@dataclass(frozen=True)
class Result:
    """value, error (relative, absolute where the exact value is zero): None where the solver
    cannot;
    note: why it cannot."""

    problem: Problem
    solver: str
    value: float | None
    error: float | None
    note: str

    @property
    def holds(self):
        """Whether the error is within the tolerance; None where the solver cannot."""
        return (
            None if self.error is None else abs(self.error) <= self.problem.tolerance[self.solver]
        )


def of_both(name, quantity, unit, exact, source, tolerance, reference, *case):
    """A Problem that both solvers do; tolerance: of both, or {solver: its}; reference: function
    that measures it there; case: arguments of `ask_yade`."""
    tolerance = tolerance if isinstance(tolerance, dict) else dict.fromkeys(SOLVERS, tolerance)
    return Problem(
        name=name,
        quantity=quantity,
        unit=unit,
        exact=exact,
        source=source,
        tolerance=tolerance,
        solvers={"reference": reference, "yade": partial(ask_yade, *case)},
    )


def ask_yade(case, *numbers):
    """The number that `verification/yade_case.py CASE NUMBERS` prints from inside YADE."""
    output = run_yade("verification/yade_case.py", case, *map(repr, numbers))
    lines = [line for line in output.splitlines() if line.startswith("result ")]
    return float(lines[-1].split()[1])


def run_yade(script, *words):
    """The output of a script inside YADE; RuntimeError where it fails."""
    command = [*COMMAND, script, *map(str, words)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(
            f"{' '.join(command)} ended with status {done.returncode}:\n{done.stderr[-2000:]}"
        )
    return done.stdout
