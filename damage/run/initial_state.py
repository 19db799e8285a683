"""What a wall went through before a run: the state at the end of another run, and joints that lost
their bond."""

import io
from dataclasses import replace

import numpy as np
from numpy.lib.recfunctions import repack_fields

from damage.errors import InputError
from damage.history.reader import opened, read_history
from damage.history.schema import STATE
from damage.history.writer import layout_tables

KEPT = (
    *("displacement", "out_of_plane", "support_displacement"),
    *("elastic_j", "friction_j", "fracture_j"),
)
"""Fields of the Instants at the first run's time zero, from which displacements and energies
count."""


# --- the end of another run -----------------------------------------------------------------------


def as_bytes(tables):
    """The bytes (n,) of {name: array}, a NumPy archive without padding between fields: equal for
    equal values."""
    file = io.BytesIO()
    # not compressed: an interrupted run waits for it
    np.savez(file, **{name: repack_fields(table) for name, table in tables.items()})
    return np.frombuffer(file.getvalue(), "u1")


def read_state(path, layout, origin, solver):
    """State of the solver, {name: array}, at the end of the run with the history `path`.

    solver: another one of the same layout and settings, whose state has the same tables; other
    arguments and errors as of `read_earlier`; raises InputError where the history has no state, or
    that of other options, too.
    """
    read_earlier(path, layout, origin)
    with opened(path) as file:
        packed = file[STATE][()]
    if not len(packed):
        raise InputError(
            f"--continue {path}: it holds no state of its solver; expected a run of the reference"
            " solver of this version; run it again"
        )
    tables = unpacked(packed)
    shapes = {name: table.shape for name, table in tables.items()}
    if any(shapes.get(name) != table.shape for name, table in solver.saved_state().items()):
        raise InputError(
            f"--continue {path}: its state of the solver is that of a run with other options;"
            " expected the bricks, joints and options of this one; give them, or run it again"
        )
    return tables


def unpacked(packed):
    """The tables of an archive (`as_bytes`), {name: array}."""
    with np.load(io.BytesIO(packed.tobytes()), allow_pickle=False) as archive:
        return dict(archive)


def read_earlier(path, layout, origin, option="--continue", ended=True):
    """The History of a run that another one continues.

    layout: damage.wall.layout.Layout of the wall that continues; origin: name of the solver, digest
    of the model's code; option: that asks for it; ended: whether it has to be complete.  Raises
    InputError where the history is none, is not complete, or is of another solver, wall or version
    of the model.
    """
    history = read_history(path)
    if ended and (not history.complete or history.collapsed_at_s is not None):
        how = "collapsed" if history.complete else history.status
        raise InputError(
            f"--continue {path}: its run is {how}; expected a complete run of a wall that stands;"
            " run it again" + ("" if history.complete else f", or continue it: --resume {path}")
        )
    (solver, model) = origin
    made_by = history.versions.get("model")
    if history.solver != solver:
        raise InputError(
            f"{option} {path}: a run of the {history.solver} solver; expected one of the {solver} "
            "solver, which alone can read its state; give one"
        )
    if made_by != model:
        raise InputError(
            f"{option} {path}: made by another version of the model ({made_by}, this is {model}),"
            " whose state has another meaning; run the first half again with this one"
        )
    with opened(path) as file:
        other = [
            name
            for name, values in layout_tables(layout).items()
            if not np.array_equal(file[name][()], values)
        ]
        earlier = history.masonry_wall
        other += [
            name
            for name in ("joint", "brick")
            if getattr(earlier, name) != getattr(layout.wall, name)
        ]
        if other:
            raise InputError(
                f"{option} {path}: the history of another wall, {history.wall}: {other[0]} differs"
                f" from that of {layout.wall.name}; expected the same wall, model options,"
                " --scatter and --seed; give them"
            )
    return history


def zero_of(state, now):
    """Instants `now` with the values at the first run's time zero in place of KEPT."""
    return now._replace(
        **{name: state[f"zero_{name}"] for name in KEPT if getattr(now, name) is not None}
    )


def with_zero(state, zero):
    """A solver's state with the KEPT values of Instants at time zero."""
    values = {name: getattr(zero, name) for name in KEPT}
    return state | {
        f"zero_{name}": np.asarray(value) for name, value in values.items() if value is not None
    }


# --- joints without bond --------------------------------------------------------------------------


def without_bond(layout, joints):
    """The layout whose contact points `joints`, (n_joints,) of bool, carry compression and friction
    alone."""
    contacts = layout.contacts
    strengths = {
        name: np.where(joints, 0.0, getattr(contacts, name))
        for name in ("tensile_strength", "cohesion")
    }
    return replace(layout, contacts=replace(contacts, **strengths))
