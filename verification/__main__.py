"""Print every solver's results of the problems.

    python3 -m verification [NAME ...] [--solver reference|yade|both] [--markdown FILE]

NAME: begins the names of the problems to do, all by default.  Exit status: 0 all within their
tolerances, 1 not, 2 bad input.
"""

import argparse
import sys
from pathlib import Path

from verification import crushing, elastic, falling, loaded, rocking, sliding, softening, splitting
from verification.problem import SOLVERS

FAMILIES = (falling, sliding, rocking, elastic, loaded, softening, crushing, splitting)


def all_problems():
    """Every Problem, family by family."""
    return [problem for family in FAMILIES for problem in family.problems()]


def main(arguments=None):
    """Run the command; returns the exit status."""
    parser = argparse.ArgumentParser(
        prog="python3 -m verification", description=__doc__.splitlines()[0]
    )
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--solver", default="both", choices=(*SOLVERS, "both"))
    parser.add_argument(
        "--markdown", type=Path, metavar="FILE", help="write the table to this file"
    )
    parsed = parser.parse_args(arguments)
    problems = [
        problem
        for problem in all_problems()
        if not parsed.names or problem.name.startswith(tuple(parsed.names))
    ]
    if not problems:
        print(
            f"error: no problem begins with {' or '.join(parsed.names)}; expected one of "
            f"{', '.join(problem.name for problem in all_problems())}",
            file=sys.stderr,
        )
        return 2
    results = []
    for problem in problems:
        print(
            f"{problem.name}: {problem.quantity} {problem.exact_value:.6g} {problem.unit}"
            f" ({problem.source})"
        )
        for solver in SOLVERS if parsed.solver == "both" else (parsed.solver,):
            results.append(problem.judge(solver))
            print(f"  {describe(results[-1])}", flush=True)
    if parsed.markdown:
        parsed.markdown.write_text(markdown(results), encoding="utf-8")
    return 0 if all(result.holds is not False for result in results) else 1


def describe(result):
    """One result as a line."""
    if result.error is None:
        return f"{result.solver:10s} not done: {result.note}"
    return (
        f"{result.solver:10s} {result.value:<13.6g} error {_error(result)}, allowed"
        f" {_allowed(result)}: {_verdict(result)}"
    )


def _verdict(result):
    return "holds" if result.holds else "FAILS"


def _error(result):
    problem = result.problem
    return (
        f"{100 * result.error:+.3f} %"
        if problem.exact_value
        else f"{result.error:+.1e} {problem.unit}"
    )


def _allowed(result):
    tolerance = result.problem.tolerance[result.solver]
    return (
        f"{100 * tolerance:g} %"
        if result.problem.exact_value
        else f"{tolerance:.0e} {result.problem.unit}"
    )


def markdown(results):
    """A table of results."""
    lines = [
        "| problem | quantity | exact | solver | value | error | allowed | verdict |",
        "| --- " * 8 + "|",
    ]
    for result in results:
        problem = result.problem
        head = (
            f"| {problem.name} | {problem.quantity} | {problem.exact_value:.6g} {problem.unit} |"
            f" {result.solver} |"
        )
        lines.append(
            f"{head} not done: {result.note} | | | |"
            if result.error is None
            else (
                f"{head} {result.value:.6g} | {_error(result)} | {_allowed(result)} |"
                f" {_verdict(result)} |"
            )
        )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())
