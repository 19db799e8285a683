"""What a wall went through before a run: the state at the end of another run, and cracks that were surveyed."""

import io
from dataclasses import replace

import numpy as np
from numpy.lib.recfunctions import repack_fields

from damage.errors import InputError, warn
from damage.history.reader import opened, read_history
from damage.history.schema import STATE
from damage.history.writer import layout_tables
from damage.measure.crack_paths import crack_paths
from damage.measure.survey import check_share

KEPT = "displacement", "support_displacement", "elastic_j", "friction_j", "fracture_j", "strain"
"""Of the Instants at the first run's time zero, from which displacements and energies count; the strain of deformable
bricks, None of rigid ones, moves material points."""


# --- the end of another run -----------------------------------------------------------------------------

def as_bytes(tables):
    """The bytes (n,) of {name: array}, a NumPy archive without padding between fields: equal for equal values."""
    file = io.BytesIO()
    np.savez_compressed(file, **{name: repack_fields(table) for name, table in tables.items()})
    return np.frombuffer(file.getvalue(), "u1")


def read_state(path, layout, origin, solver):
    """State of the solver, {name: array}, at the end of the run with the history `path`.

    solver: another one of the same layout and settings, whose state has the same tables; other arguments and errors as
    of `read_earlier`; raises InputError where the history has no state, or that of other options, too.
    """
    read_earlier(path, layout, origin)
    like = with_zero((solver.saved_state() or {}) | {
        "set_in_motion_j": np.array(0.0), "base_moves": np.array(False)}, solver.instants())
    with opened(path) as file:
        packed = file[STATE][()]
    if not len(packed):
        raise InputError(f"--continue {path}: it holds no state of its solver; expected a run of the reference solver "
                         "of this version without --new-contacts; run it again")
    tables = unpacked(packed)
    if _shapes(tables) != _shapes(like):
        raise InputError(f"--continue {path}: its state of the solver is that of a run with other options; expected "
                         "the bricks, joints and options of this one; give them, or run it again")
    return tables


def unpacked(packed):
    """The tables of an archive (`as_bytes`), {name: array}."""
    with np.load(io.BytesIO(packed.tobytes()), allow_pickle=False) as archive:
        return dict(archive)


def _shapes(tables):
    return {name: np.shape(table) for name, table in tables.items()}


def read_earlier(path, layout, origin, option="--continue", ended=True):
    """The History of a run that another one continues.

    layout: damage.wall.layout.Layout of the wall that continues; origin: name of the solver, digest of the model's
    code; option: that asks for it; ended: whether it has to be complete.  Raises InputError where the history is none,
    is not complete, or is of another solver, wall or version of the model.
    """
    history = read_history(path)
    if ended and (not history.complete or history.collapsed_at_s is not None):
        how = "collapsed" if history.complete else history.status
        raise InputError(f"--continue {path}: its run is {how}; expected a complete run of a wall that stands; run it "
                         "again" + ("" if history.complete else f", or continue it: --resume {path}"))
    (solver, model), made_by = origin, history.versions.get("model")
    if history.solver != solver:
        raise InputError(f"{option} {path}: a run of the {history.solver} solver; expected one of the {solver} "
                         "solver, which alone can read its state; give one")
    if made_by != model:
        raise InputError(f"{option} {path}: made by another version of the model ({made_by}, this is {model}), whose "
                         "state has another meaning; run the first half again with this one")
    with opened(path) as file:
        other = [name for name, values in layout_tables(layout).items() if not np.array_equal(file[name][()], values)]
        if other:
            raise InputError(f"{option} {path}: the history of another wall, {history.wall}: {other[0]} differs from "
                             f"that of {layout.wall.name}; expected the same wall, model options, --scatter and "
                             "--seed; give them")
    return history


def zero_of(state, now):
    """Instants `now` with the values at the first run's time zero in place of KEPT."""
    return now._replace(**{name: state[f"zero_{name}"] for name in KEPT if getattr(now, name) is not None})


def with_zero(state, zero):
    """A solver's state with the KEPT values of Instants at time zero."""
    values = {name: getattr(zero, name) for name in KEPT}
    return state | {f"zero_{name}": np.asarray(value) for name, value in values.items() if value is not None}


# --- surveyed cracks ---------------------------------------------------------------------------------------

def with_cracks(layout, cracks):
    """The layout whose contact points along Surveyed cracks have no bond: they carry compression and friction alone.

    Straight lines become the nearest paths along joints (`damage.measure.crack_paths`).  Elastic contact points stay as
    they are, with a warning; what the survey comes to is printed.  Raises InputError where less than half of it lies on
    joints.
    """
    contacts = layout.contacts
    paths = crack_paths(np.reshape(cracks.stretches, (-1, 2, 2)), layout, cracks.tolerance_m)
    check_share(paths, f"--cracked {cracks.file}", layout)
    failed = np.zeros(len(contacts), bool)
    failed[paths.table["joint"]] = True
    if elastic := int(contacts.elastic[failed].sum()):
        warn(f"--cracked {cracks.file}: {elastic} of {failed.sum()} contact points are elastic by --lintel and stay so")
    failed &= ~contacts.elastic
    print(f"cracks of {cracks.file}: {paths.drawn_m:.2f} m, {100 * paths.share:.0f} % of it on joints up to "
          f"{1e3 * paths.apart_m:.0f} mm away; {failed.sum()} of {layout.n_joints} contact points "
          f"({contacts.length[failed].sum():.2f} m) start without bond; widths are not used")
    fibres = layout.fibres and _without_bond(layout.fibres, failed[layout.fibres.contact])
    return replace(layout, contacts=_without_bond(contacts, failed), fibres=fibres)


def _without_bond(table, failed):
    return replace(table, **{name: np.where(failed, 0.0, getattr(table, name))
                             for name in ("tensile_strength", "cohesion")})
