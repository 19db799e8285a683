"""Read a history file into pandas frames."""

import json
from dataclasses import dataclass
from functools import cached_property, partial
from html import escape
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
import pandas as pd

from damage.checks import check_file, record_from
from damage.errors import InputError
from damage.history import schema
from damage.history.head import check_seal, read_head
from damage.index import DRIFT_LIMIT, THRESHOLD, damage_index
from damage.law.states import AT_LIMIT, BROKEN, CRUSHED, ENDED
from damage.motion.loading import loading_from_dict
from damage.units import rounded
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Wall
from damage.wall.plan import plan_of


class ActiveContacts(NamedTuple):
    """Sparse contact data: only contact points that ever opened, slipped or reached their shear limit.

    joints: (n,) indices of these contact points, increasing; opening_m, slip_m, offset_m [m]: (n_times, n); at_limit:
    bool (n_times, n).
    """

    joints: np.ndarray
    opening_m: np.ndarray
    slip_m: np.ndarray
    offset_m: np.ndarray
    at_limit: np.ndarray

    def slip_by(self, slip):
        """Slip by a criterion, as `History.slip_by`, (n_times, n) [m]."""
        return self.slip_m if slip == "accumulated" else self.offset_m


class States(NamedTuple):
    """Sparse states of contact points: only those at which any state was ever set.

    joints: (n,) indices of these contact points, increasing; broken, at_limit, crushed, ended: bool (n_times, n).
    """

    joints: np.ndarray
    broken: np.ndarray
    at_limit: np.ndarray
    crushed: np.ndarray
    ended: np.ndarray


def _sparse(kind, joints, frames):
    """ActiveContacts or States (kind) from frames of joints (n,), {name: (n_times, n)}, without inactive ones."""
    asked = [frames[name] for name in kind._fields[1:]]
    ever = np.any([any_bit(frame) for frame in asked], axis=0)
    return kind(joints[ever], *(frame[:, ever] for frame in asked))


def any_bit(rows):
    """Flags (n,) of the columns of rows (n_rows, n) in which any bit is set, that of minus zero included."""
    return np.bitwise_or.reduce(rows.view(f"u{rows.itemsize}"), axis=0) > 0


class _Frames:
    """A field of a History, (n_times, n_joints), computed on first access: studies never use it for most runs."""

    def __set_name__(self, owner, name):
        self._name = name

    def __get__(self, history, owner=None):
        if history is None:
            raise AttributeError(self._name)  # the field has no default
        held = vars(history)
        if callable(held[self._name]):
            held[self._name] = held[self._name]()
        return held[self._name]

    def __set__(self, history, value):
        vars(history)[self._name] = value


@dataclass(frozen=True, repr=False)
class History:
    """One run.

    joints: DataFrame, a row a contact point (kind bed/head/brick, x_m, z_m, length_m, first_body, ...);
    bodies: DataFrame, a row a brick or cap (course -1); series: DataFrame over time, with the stage
    (settlement, motion, rest, settling); events: DataFrame (time_s, joint, kind tension/shear/opened/slipped,
    normal_stress_pa, shear_stress_pa, opening_m, slip_m).
    opening_m, slip_m, offset_m: (n_times, n_joints); broken, at_limit, crushed, ended: bool of that shape.
    snapshot_time_s: (n_snapshots,); displacement: (n_snapshots, n_bodies, 3) [m, m, rad]; stress_pa: (n_snapshots,
    n_bodies, 5, 3) along x, along z and shear at the centre and the corners of each brick, None where bricks are rigid.
    supports: DataFrame, a row a support (left_m, right_m); support_displacement [m, m, rad], support_force [N, N, N m]:
    (n_times, n_supports, 3).
    joint_stress_pa: (n_times, n_joints, 2) normal stress, tension positive, and shear stress of each contact point,
    None without `--stresses`; point_displacement: (n_times, n_points, 2) along x and z of the material `points` [m],
    None without `--point`; static_stage: DataFrame, a row a look at the static stage (time_s, unbalanced_force).
    static: results of the static stage; parameters: everything that defined the run, as stored in the file; `loading`,
    `model` and `masonry_wall` return most of it as records; `wall` is the wall's name.
    status: complete, interrupted, failed, or unfinished (still running, or killed).
    """

    path: Path
    wall: str
    solver: str
    command: str
    status: str
    collapsed_at_s: float | None
    parameters: dict
    versions: dict
    static: dict
    attributes: dict
    joints: pd.DataFrame
    bodies: pd.DataFrame
    series: pd.DataFrame
    events: pd.DataFrame
    opening_m: np.ndarray = _Frames()
    slip_m: np.ndarray = _Frames()
    broken: np.ndarray = _Frames()
    at_limit: np.ndarray = _Frames()
    crushed: np.ndarray = _Frames()
    ended: np.ndarray = _Frames()
    offset_m: np.ndarray = _Frames()
    supports: pd.DataFrame
    support_displacement: np.ndarray
    support_force: np.ndarray
    static_stage: pd.DataFrame
    snapshot_time_s: np.ndarray
    displacement: np.ndarray
    stress_pa: np.ndarray | None = None
    joint_stress_pa: np.ndarray | None = None
    point_displacement: np.ndarray | None = None

    def __repr__(self):
        return f"<History {self.wall}, {self.loading.name}, {self.solver} solver: {_end_of(self)}>"

    def _repr_html_(self):
        """A table for notebooks, with its wall, motion, end, index and largest drift."""
        rows = [("wall", self.wall), ("motion", self.loading.name), ("solver", self.solver), ("run", _end_of(self))]
        if len(self.series):
            index, drift = self.index()["DI"], self.series["drift_ratio"].abs().max()
            residual = f", residual {index.iloc[-1]:.3f}" if self.complete else ""
            rows += [("damage index", f"maximum {index.max():.3f}{residual}"),
                     ("drift ratio", f"up to {rounded(100 * drift, 3)} %"),
                     ("failures", f"{int(self.states.broken[-1].sum())} of {len(self.joints)} contact points")]
        cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows)
        return f"<table><caption>History</caption>{cells}</table>"

    def plot_wall(self, ax, t="max", **options):
        """Draw the wall with its cracks at a time t [s], or "max" (of the damage index) or "end", into axes of a
        figure of yours: `damage.draw.run.plot_wall`."""
        return import_module("damage.draw.run").plot_wall(self, ax, t, **options)

    @property
    def complete(self):
        """Whether the run came to its end (a collapse is an end, too)."""
        return self.status == "complete"

    @cached_property
    def loading(self):
        """The `damage.motion.loading.Loading` that drove the run; a `RecordedMotion` where it was a record."""
        return loading_from_dict(self.parameters["loading"])

    @cached_property
    def model(self):
        """ModelOptions of the run."""
        return record_from(ModelOptions, self.parameters.get("model", {}))

    @cached_property
    def masonry_wall(self):
        """The `damage.Wall` as it was laid out."""
        return Wall.from_dict(self.parameters["wall"])

    @cached_property
    def plan(self):
        """The `damage.wall.plan.Plan` of this wall under its `model`."""
        return plan_of(self.masonry_wall, self.model)

    @cached_property
    def joint_length_m(self):
        """Tributary length of each contact point, zero on the cut of a brick: (n_joints,) [m]."""
        return np.where(self.joints["kind"] == "brick", 0.0, self.joints["length_m"])

    @property
    def points(self):
        """Places (x, z) of the material points in the undeformed wall [m], a list."""
        return [tuple(place) for place in self.parameters.get("points", [])]

    @property
    def sequence(self):
        """Factors of the motion, one for each event."""
        return tuple(self.parameters.get("sequence", (1.0,)))

    @cached_property
    def event_loadings(self):
        """The Loading of each event, in their order; a sequence of one motion has the same for all."""
        motions = [loading_from_dict(table) for table in self.parameters.get("motions", [])]
        return tuple(motions[event["motion"]] for event in self.parameters["events"]) if motions else \
            (self.loading,) * len(self.sequence)

    @property
    def strongest_factor(self):
        """Largest factor on `loading`, which is the strongest motion of a sequence: absolute value."""
        return max(abs(factor) for factor, loading in zip(self.sequence, self.event_loadings)
                   if loading.name == self.loading.name)

    @property
    def time_step_s(self):
        """Time step of the solver [s]."""
        return self.parameters.get("time_step_s")

    @property
    def eigen_period_s(self):
        """First period of the intact wall by its eigenvalues [s]."""
        return self.parameters.get("eigen_period_s")

    @property
    def moving(self):
        """The series without the settling stages."""
        return schema.moving(self.series)

    def slip_by(self, slip):
        """Slip by a criterion, (n_times, n_joints) [m]; for `shear-limit`, which needs none, that by `displacement`."""
        return self.slip_m if slip == "accumulated" else self.offset_m

    def index(self, threshold=THRESHOLD, drift_limit=DRIFT_LIMIT, slip="displacement"):
        """The damage index over time: `damage.index.damage_index` of this run, by this criterion of slip."""
        asked = threshold, drift_limit, slip
        if asked not in self._indices:
            active = self.active
            self._indices[asked] = damage_index(
                self.series["time_s"].to_numpy(), self.series["drift_ratio"].to_numpy(), active.opening_m,
                active.slip_by(slip), active.at_limit, self.joint_length_m[active.joints],
                threshold=threshold, drift_limit=drift_limit, slip_criterion=slip,
                total_length=self.joint_length_m.sum())
        return self._indices[asked].copy()

    @cached_property
    def active(self):
        """ActiveContacts of the run; most contact points stay inactive, so that measures are computed from these
        only."""
        return self._of_all(ActiveContacts)

    @cached_property
    def states(self):
        """The States of contact points."""
        return self._of_all(States)

    def _of_all(self, kind):
        return _sparse(kind, np.arange(len(self.joints)), {name: getattr(self, name) for name in kind._fields[1:]})

    @property
    def is_intact(self):
        """Whether no joint ever failed or reached its shear limit."""
        return not bool(self.states.broken.any() or self.states.at_limit.any())

    # What follows is of packages that come after this one in the order of imports.

    @cached_property
    def warnings(self):
        """Conditions under which the results are doubtful, a list of str with a `code` (`damage.measure.warnings`)."""
        return import_module("damage.measure.warnings").warnings_of(self)

    @property
    def evidence(self):
        """The range of validity (`docs/model/validity.md`), a DataFrame, a row a quantity: value, least, most, unit and
        whether this run is inside, None where the quantity does not apply."""
        evidence = import_module("damage.measure.summary").summarise(self)["evidence"]
        return pd.DataFrame(evidence).T.rename_axis("quantity")

    @cached_property
    def _indices(self):
        """Damage indices computed so far, which several tables need: {(threshold, drift limit, slip): DataFrame}."""
        return {}


def read_history(path):
    """Read the history at `path`, also while a run writes it, or after a run was killed.

    Raises InputError where the file is missing, is not a history, has another schema, or was changed after its run
    closed it.
    """
    path = check_file(path, "a history (.h5)")
    head = read_head(path)
    if head.sealed:
        check_seal(path, head)
    try:
        with opened(path) as file:
            # What is open has no end yet, whatever it says of itself.
            return history_of(path, dict(file["run"].attrs), file, ended=head.sealed)
    except InputError:
        raise
    except Exception as error:  # a damaged file may say anything
        raise _unreadable(path, error) from error


def _unreadable(path, error):
    said = (str(error).strip() or type(error).__name__).splitlines()[0]
    return InputError(f"{path} cannot be read as a history ({said}); expected an HDF5 file that a run wrote")


def opened(path):
    """The HDF5 file of a history, open for reading, also while a run writes it or after it was killed."""
    return h5py.File(path, "r", libver="latest", swmr=not read_head(path).sealed)


def history_of(path, attributes, values, ended=True, joints=None):
    """History from the attributes of `run` and all columns by path, {"GROUP/NAME": array or dataset}.

    joints: where the frames are of some joints alone, their indices (n,), increasing; all others are inactive, and
    dense frames are made on first use.
    """
    n_times = _whole_rows(values, "series", "frames", "ground", "stresses", "points")
    n_snapshots = _whole_rows(values, "snapshots")
    optional = {"stress_pa": ("snapshots/stress_pa", n_snapshots),
                "joint_stress_pa": ("stresses/joint_stress_pa", n_times),
                "point_displacement": ("points/displacement", n_times)}
    table = _columns(values, "joints")
    frames = _frames(values, n_times)
    collapsed = float(values["run/collapsed_at_s"][()])
    history = History(
        path=path, wall=attributes["wall"], solver=attributes["solver"], command=attributes["command"],
        status=schema.STATUS[int(values["run/status"][()]) if ended else 0],
        collapsed_at_s=None if np.isnan(collapsed) else collapsed,
        parameters=json.loads(attributes["parameters_json"]), versions=json.loads(attributes["versions_json"]),
        static={name: float(values[f"static/{name}"][()]) for name in sorted(schema.TABLES["static"])},
        attributes=attributes, joints=_decode(table, "kind", schema.CODES["joints/kind"]),
        bodies=_columns(values, "bodies"),
        series=_number_shocks(_decode(_columns(values, "series", n_times), "stage", schema.STAGES)),
        events=_decode(_columns(values, "events", _whole_rows(values, "events")), "kind", schema.EVENTS),
        snapshot_time_s=values["snapshots/time_s"][:n_snapshots],
        displacement=values["snapshots/displacement"][:n_snapshots],
        **{field: values[path][:count] for field, (path, count) in optional.items() if path in values},
        supports=_columns(values, "supports"), support_displacement=values["ground/displacement"][:n_times],
        support_force=values["ground/force"][:n_times],
        static_stage=_columns(values, "static_stage", _whole_rows(values, "static_stage")),
        **(frames if joints is None else
           {name: partial(at_all_joints, rows, joints, len(table)) for name, rows in frames.items()}))
    if joints is not None:  # as its cached properties would compute it from dense frames
        vars(history).update(active=_sparse(ActiveContacts, joints, frames), states=_sparse(States, joints, frames))
    return history


def _whole_rows(values, *groups):
    """Number of rows of groups: a killed run may have flushed one column more often than another."""
    return min(len(values[path]) for path in schema.COLUMNS if path.partition("/")[0] in groups and path in values)


def _frames(values, n_times):
    """{field of a History: its frames}."""
    state = values["frames/state"][:n_times]
    found = {name: values[f"frames/{name}"][:n_times] for name in ("opening_m", "slip_m", "offset_m")}
    return found | {name: (state & bit) > 0 for name, bit in (
        ("broken", BROKEN), ("at_limit", AT_LIMIT), ("crushed", CRUSHED), ("ended", ENDED))}


def at_all_joints(sparse, joints, n_joints):
    """Dense frames (n_times, n_joints) from those of some joints alone (n_times, n)."""
    rows = np.zeros((len(sparse), n_joints), sparse.dtype)
    rows[:, joints] = sparse
    return rows


def _number_shocks(series):
    """The series with the number of the event, from 1: a new one begins with each motion after settling."""
    settling = (series["stage"] == "settling").to_numpy()
    series["shock"] = 1 + np.cumsum(np.diff(settling.astype(int), prepend=0) < 0)
    return series


def _columns(values, group, n_rows=None):
    """Columns of a group that the schema names, as a DataFrame."""
    names = sorted(schema.TABLES[group])
    found = {name: values[f"{group}/{name}"][:n_rows] for name in names if f"{group}/{name}" in values}
    rows = range(len(next(iter(found.values()))))
    return pd.DataFrame({name: found.get(name, np.nan) for name in names}, index=rows)


def _decode(frame, column, names):
    frame[column] = pd.Categorical.from_codes(frame[column].astype(int), categories=names)
    return frame


def _end_of(history):
    """The status, when the wall collapsed, where it did, and how many samples there are."""
    fell, time_s = history.collapsed_at_s, history.series["time_s"]
    collapse = "" if fell is None else f", collapsed at {fell:.3f} s"
    last = f" to {time_s.iloc[-1]:.3f} s" if len(time_s) else ""
    return f"{history.status}{collapse}, {len(time_s)} samples{last}"
