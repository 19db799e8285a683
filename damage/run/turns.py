"""Runs that step together: each yields the steps that its solver has to take; then the solvers take them."""

import numpy as np


def run_each(asked):
    """Let solvers take steps, one after the other; returns for each None, or the error that ended it.

    asked: (solver, *numbers of steps) of each.
    """
    failures = [None] * len(asked)
    for number, (solver, *steps) in enumerate(asked):
        try:
            solver.run(*steps)
        except Exception as error:
            failures[number] = error
    return failures


@np.errstate(over="ignore", invalid="ignore")  # a run that blows up says so itself
def take_turns(runs, move=run_each):
    """Advance runs until all have ended; returns the result of each.

    runs: generators of what `run_each` takes, as `damage.run.session.simulate`: what is to be taken before a run goes
    on; an error in it is raised there.  move: as `run_each`, takes the steps of all that have not ended.
    """
    ended, failures = {}, dict.fromkeys(runs)
    while failures:
        asked = {}
        for run, failure in failures.items():
            try:
                asked[run] = next(run) if failure is None else run.throw(failure)
            except StopIteration as end:
                ended[run] = end.value
        failures = dict(zip(asked, move(list(asked.values()))))
    return [ended[run] for run in runs]
