"""The run that another one continues, repeated: for a solver that keeps no state."""

import json
from dataclasses import replace

from damage.errors import InputError
from damage.run.before import read_earlier
from damage.run.options import parse_run
from damage.run.settings import Softening


def earlier_runs(settings, layout, backend, model, time_step):
    """RunSettings of all runs that `settings` continues, the first one first.

    They follow from the commands in the histories.  layout: of the wall that continues; backend: a
    damage.run.session.Backend; model: digest of the model's code; time_step [s] of the run that continues.  Raises
    InputError where a history is not one that could be continued (`damage.run.before.read_earlier`), is of another
    solver or time step, or where its command no longer describes it.
    """
    found = []
    while settings.continued:
        path = settings.continued
        history = read_earlier(path, layout, model)
        if history.solver != backend.name:
            raise InputError(f"--continue {path}: a run of the {history.solver} solver; expected one of the "
                             f"{backend.name} solver, which repeats it; run it there first")
        if history.time_step_s != time_step:
            raise InputError(f"--continue {path}: its time step is {history.time_step_s!r} s, expected that of this "
                             f"run, {time_step!r} s; give --dt {history.time_step_s!r}")
        settings = settings_of(history, layout.wall.joint, backend)
        found.insert(0, settings)
    return tuple(found)


def settings_of(history, joint, backend):
    """The RunSettings of a History by its command."""
    command = history.command
    words = command.split()
    words = words[next((k for k, word in enumerate(words) if word.startswith("--")), len(words)):]
    try:
        settings = parse_run(words, "", backend.name)
    except InputError as error:
        raise InputError(f"--continue {history.path}: its command, {command!r}, cannot be repeated ({error}); expected "
                         "its files in this folder; or give both halves in one run, as --sequence 1,0.5") from error
    settings = settings.for_joint(joint, backend.softening or Softening()).for_bricks(backend.brick_cells)
    settings = settings.for_period(history.eigen_period_s)
    other = [name for name, value in json.loads(json.dumps(settings.as_dict())).items()
             if name != "command" and history.parameters.get(name, value) != value]
    if other:
        raise InputError(f"--continue {history.path}: its command, {command!r}, no longer describes it: {other[0]} was "
                         f"{history.parameters[other[0]]!r}; expected its files unchanged in this folder; run it again")
    return replace(settings, overwrite=False, pictures=False)
