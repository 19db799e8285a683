"""Read a history file into pandas frames."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path
from typing import ClassVar

import h5py
import numpy as np
import pandas as pd

from damage.checks import check_file, record_from
from damage.errors import InputError
from damage.history import schema
from damage.history.contacts import Contacts
from damage.history.head import check_seal, read_head
from damage.history.parts import HouseRows, wall_of
from damage.house.placing import Placing, placing_of
from damage.house.space import SHARES
from damage.index import DRIFT_LIMIT, THRESHOLD, damage_index
from damage.motion.loading import Loading, loading_from_dict
from damage.units import rounded
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import Wall
from damage.wall.plan import Plan, plan_of


def _at_all_joints(name):
    """Property of a History: a field of its Contacts at all joints, made on first use, which most
    runs never see."""
    return cached_property(
        lambda history: history.contacts.at_all_joints(name, len(history.joints))
    )


@dataclass(frozen=True, repr=False)
class History:
    """One run.

    joints: DataFrame, a row a contact point (kind bed/head/brick, x_m, z_m, length_m, first_body,
    ...);
    bodies: DataFrame, a row a brick or cap (course -1); series: DataFrame over time, with the stage
    (settlement, motion, rest, settling); events: DataFrame (time_s, joint, kind
    tension/shear/opened/slipped, normal_stress_pa, shear_stress_pa, opening_m, slip_m).
    contacts: samples of the active contact points; opening_m, slip_m, offset_m: those of all,
    (n_times, n_joints); broken, at_limit, crushed, ended: bool of that shape.
    snapshot_time_s: (n_snapshots,); displacement: (n_snapshots, n_bodies, 3) [m, m, rad];
    supports: DataFrame, a row a support
    (left_m, right_m); support_displacement [m, m, rad], support_force [N, N, N m]: (n_times,
    n_supports, 3).
    joint_stress_pa: (n_times, n_joints, 2) normal stress, tension positive, and shear stress of
    each contact point, None without `--stresses`; static_stage: DataFrame, a row a
    look at the static stage (time_s, unbalanced_force). static: results of the static stage;
    parameters: everything that defined the run, as stored in the file; `loading`, `model` and
    `masonry_wall` return most of it as records; `wall` is the wall's name.
    status: complete, interrupted, failed, or unfinished (still running, or killed).
    house: HouseRows of the history of a house, whose walls are unfolded side by side, None of a
    plane wall; `parts` has those of its walls.
    heard: what `damage.run` gave as warnings while it ran, texts with codes; none of a file.

    >>> history.complete, history.loading.name, history.masonry_wall.length, history.model.top
    (True, 'harmonic_0.2s_0.05g', 0.9, 'piers')
    >>> history.sequence, [loading.peak_g for loading in history.event_loadings]
    ((1.0,), [0.05])
    >>> len(history.series), len(history.moving), history.time_step_s, vibrating.eigen_period_s
    (21, 16, None, 0.1)
    >>> round(float(history.joint_length_m.sum()), 2), history.plan.n_bricks  # [m]
    (6.98, 27)
    >>> history.is_intact, history.active.joints.tolist(), history.states.joints.tolist()
    (False, [0, 1, 5], [0, 1, 5])
    >>> history.kind, houses.kind, [wall.wall for wall in houses.parts]
    ('wall', 'house', ['front', 'side'])
    >>> float(houses.largest_index.max())  # of any of its walls
    0.0
    >>> houses.of_wall("front").of_face("outside").path.name
    'house:front:outside.h5'
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
    contacts: Contacts
    supports: pd.DataFrame
    support_displacement: np.ndarray
    support_force: np.ndarray
    static_stage: pd.DataFrame
    snapshot_time_s: np.ndarray
    displacement: np.ndarray
    joint_stress_pa: np.ndarray | None = None
    house: HouseRows | None = None
    heard: tuple = ()

    opening_m: ClassVar = _at_all_joints("opening_m")
    slip_m: ClassVar = _at_all_joints("slip_m")
    offset_m: ClassVar = _at_all_joints("offset_m")
    broken: ClassVar = _at_all_joints("broken")
    at_limit: ClassVar = _at_all_joints("at_limit")
    crushed: ClassVar = _at_all_joints("crushed")
    ended: ClassVar = _at_all_joints("ended")

    def __repr__(self):
        return f"<History {self.wall}, {self.loading.name}, {self.solver} solver: {_end_of(self)}>"

    def _repr_html_(self):
        """A table for notebooks, with its wall, motion, end, index and largest drift."""
        rows = [
            ("wall", self.wall),
            ("motion", self.loading.name),
            ("solver", self.solver),
            ("run", _end_of(self)),
        ]
        if len(self.series):
            index = self.index()["DI"]
            drift = self.series["drift_ratio"].abs().max()
            residual = f", residual {index.iloc[-1]:.3f}" if self.complete else ""
            rows += [
                ("damage index", f"maximum {index.max():.3f}{residual}"),
                ("drift ratio", f"up to {rounded(100 * drift, 3)} %"),
                (
                    "failures",
                    f"{int(self.states.broken[-1].sum())} of {len(self.joints)} contact points",
                ),
            ]
        cells = "".join(
            f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows
        )
        return f"<table><caption>History</caption>{cells}</table>"

    @property
    def complete(self) -> bool:
        """Whether the run came to its end (a collapse is an end, too)."""
        return self.status == "complete"

    @cached_property
    def loading(self) -> Loading:
        """The `damage.motion.loading.Loading` that drove the run; a `RecordedMotion` where it was a
        record."""
        return loading_from_dict(self.parameters["loading"])

    @cached_property
    def model(self) -> ModelOptions:
        """ModelOptions of the run."""
        return record_from(ModelOptions, self.parameters.get("model", {}))

    @cached_property
    def masonry_wall(self) -> Wall:
        """The `damage.Wall` as it was laid out."""
        return Wall.from_dict(self.parameters["wall"])

    @cached_property
    def plan(self) -> Plan:
        """The `damage.wall.plan.Plan` of this wall under its `model`."""
        return plan_of(self.masonry_wall, self.model)

    @cached_property
    def joint_length_m(self) -> np.ndarray:
        """Tributary length of each contact point, zero on the cut of a brick: (n_joints,) [m]."""
        return np.where(self.joints["kind"] == "brick", 0.0, self.joints["length_m"])

    @property
    def sequence(self) -> tuple[float, ...]:
        """Factors of the motion, one for each event."""
        return tuple(self.parameters.get("sequence", (1.0,)))

    @cached_property
    def event_loadings(self) -> tuple[Loading, ...]:
        """The Loading of each event, in their order; a sequence of one motion has the same for
        all."""
        motions = [loading_from_dict(table) for table in self.parameters.get("motions", [])]
        return (
            tuple(motions[event["motion"]] for event in self.parameters["events"])
            if motions
            else (self.loading,) * len(self.sequence)
        )

    @property
    def strongest_factor(self) -> float:
        """Largest factor on `loading`, which is the strongest motion of a sequence: absolute
        value."""
        return max(
            abs(factor)
            for factor, loading in zip(self.sequence, self.event_loadings)
            if loading == self.loading
        )

    @cached_property
    def time_s(self) -> np.ndarray:
        """Times of the samples since the start of the (first) motion, (n_times,) [s].

        >>> history.time_s[-1].round(3)
        0.2
        """
        return self.series["time_s"].to_numpy()

    @property
    def time_step_s(self) -> float | None:
        """Time step of the solver [s]."""
        return self.parameters.get("time_step_s")

    @property
    def eigen_period_s(self) -> float | None:
        """First period of the intact wall by its eigenvalues [s]."""
        return self.parameters.get("eigen_period_s")

    @property
    def moving(self) -> pd.DataFrame:
        """The series without the settling stages."""
        return schema.moving(self.series)

    @cached_property
    def parts(self) -> "list[History]":
        """Histories of the walls of a house, FILE:WALL.h5, each in its plane; of a single wall this
        one."""
        if self.house is None or self.house.outside:
            return [self]
        return [self.of_wall(name) for name in self.placing.names]

    @property
    def kind(self) -> str:
        """What it is of: "wall", or "house" of all walls of one."""
        return "wall" if self.parts[0] is self else "house"

    def of_wall(self, name: str) -> "History":
        """The History of a wall of a house, in its plane and without the joints to other walls;
        energies and forces of supports are those of the house.  Of a wall: that of one of FACES
        (`of_face`)."""
        return wall_of(self, name)

    def of_face(self, face: str) -> "History":
        """The History of a wall of a house as one of its FACES shows it, as of a plane wall: the
        contact points there, each with the whole of its length."""
        return self.of_wall(face)

    def check_one_layer(self) -> None:
        """Raise InputError of a wall of a house, which has other cracks at each of its faces."""
        if "share" in self.joints:
            raise InputError(
                f"{self.path} has cracks of its own at each face: expected one face of a wall, as"
                f" {self.parts[0].path.stem}:outside{self.path.suffix}; give that"
            )

    @cached_property
    def placing(self) -> Placing:
        """`damage.house.placing.Placing` of the walls of a house."""
        return placing_of(self.parameters["house"]["walls"])

    def slip_by(self, slip: str) -> np.ndarray:
        """Slip by a criterion, (n_times, n_joints) [m]; for `shear-limit`, which needs none, that
        by `displacement`.

        >>> history.slip_by("displacement").shape == history.opening_m.shape
        True
        """
        return self.slip_m if slip == "accumulated" else self.offset_m

    def index(
        self,
        threshold: float = THRESHOLD,
        drift_limit: float = DRIFT_LIMIT,
        slip: str = "displacement",
    ) -> pd.DataFrame:
        """The damage index over time: `damage.index.damage_index` of this run, by this criterion of
        slip.

        >>> history.index()[["DI_drift", "DI"]].max().round(4).tolist()
        [0.05, 0.0729]
        """
        if self.house and len(self.parameters["house"]["walls"]) > 1:
            raise InputError(
                f"{self.path} is of a house, which has an index of each wall: expected one of them,"
                f" as {self.parts[0].path}; give that, or python3 -m damage index {self.path}"
            )
        asked = threshold, drift_limit, slip
        if asked not in self._indices:
            active = self.active
            self._indices[asked] = damage_index(
                self.time_s,
                self.series["drift_ratio"].to_numpy(),
                active.opening_m,
                active.slip_by(slip),
                active.at_limit,
                self.joint_length_m[active.joints],
                threshold=threshold,
                drift_limit=drift_limit,
                slip_criterion=slip,
                total_length=self.joint_length_m.sum(),
            )
        return self._indices[asked].copy()

    @property
    def largest_index(self) -> np.ndarray:
        """DI over time, (n_times,); of a house that of the wall where it is largest."""
        return np.max([part.index()["DI"] for part in self.parts], axis=0)

    @cached_property
    def active(self) -> Contacts:
        """The Contacts that ever opened, slipped or reached their shear limit: measures need no
        others."""
        return self.contacts.with_any("opening_m", "slip_m", "offset_m", "at_limit")

    @cached_property
    def states(self) -> Contacts:
        """The Contacts that ever were in another state than intact."""
        return self.contacts.with_any("state")

    @property
    def is_intact(self) -> bool:
        """Whether no joint ever failed or reached its shear limit."""
        return not bool(self.states.broken.any() or self.states.at_limit.any())

    @cached_property
    def _indices(self):
        """Damage indices computed so far, which several tables need: {(threshold, drift limit,
        slip): DataFrame}."""
        return {}


def read_history(path: str | Path) -> History:
    """Read the history at `path`, also while a run writes it, or after a run was killed.

    Raises InputError where the file is missing, is not a history, has another schema, or was
    changed after its run closed it.  FILE:WALL.h5 is of a wall of the house in FILE.h5,
    FILE:WALL:outside.h5 of a face of it.

    >>> read_history(history.path).complete
    True
    """
    given = Path(path)
    house, part = _without_part(given)
    if part:
        return read_history(house).of_wall(part)
    file_path = check_file(path, "a history (.h5)")
    head = read_head(file_path)
    if head.sealed:
        check_seal(file_path, head)
    try:
        with opened(file_path) as file:
            # What is open has no end yet, whatever it says of itself.
            return history_of(file_path, dict(file["run"].attrs), file, ended=head.sealed)
    except InputError:
        raise
    except Exception as error:  # a damaged file may say anything
        message = (str(error).strip() or type(error).__name__).splitlines()[0]
        raise InputError(
            f"{file_path} cannot be read as a history ({message}); expected an HDF5 file that a run"
            " wrote"
        ) from error


def _without_part(path):
    """FILE.h5 and WALL of a path FILE:WALL.h5 that is no file; else the path, and ""."""
    house, _, part = path.stem.rpartition(":")
    return (
        (path.with_name(house + path.suffix), part) if house and not path.exists() else (path, "")
    )


def file_of(path: str | Path) -> Path:
    """The file of a history, of which the path may name a wall or a face.

    >>> file_of(history.path).name
    'run.h5'
    """
    house, part = _without_part(Path(path))
    return file_of(house) if part else house


def opened(path: str | Path) -> h5py.File:
    """The HDF5 file of a history, open for reading, also while a run writes it or after it was
    killed."""
    return h5py.File(path, "r", libver="latest", swmr=not read_head(path).sealed)


def history_of(path: Path, attributes: dict, values: Mapping, ended: bool = True) -> History:
    """History from the attributes of `run` and all columns by path, {"GROUP/NAME": array or
    dataset}."""
    n_times = _whole_rows(values, "series", "frames", "ground", "stresses", "house")
    n_snapshots = _whole_rows(values, "snapshots")
    stresses = "stresses/joint_stress_pa"
    collapsed = float(values["run/collapsed_at_s"][()])
    return History(
        path=path,
        wall=attributes["wall"],
        solver=attributes["solver"],
        command=attributes["command"],
        status=schema.STATUS[int(values["run/status"][()]) if ended else 0],
        collapsed_at_s=None if np.isnan(collapsed) else collapsed,
        parameters=json.loads(attributes["parameters_json"]),
        versions=json.loads(attributes["versions_json"]),
        static={
            name: float(values[f"static/{name}"][()]) for name in sorted(schema.TABLES["static"])
        },
        attributes=attributes,
        joints=_joints(values),
        bodies=_columns(values, "bodies"),
        series=_number_shocks(_decode(_columns(values, "series", n_times), "stage", schema.STAGES)),
        events=_decode(
            _columns(values, "events", _whole_rows(values, "events")), "kind", schema.EVENTS
        ),
        snapshot_time_s=values["snapshots/time_s"][:n_snapshots],
        displacement=values["snapshots/displacement"][:n_snapshots],
        joint_stress_pa=values[stresses][:n_times] if stresses in values else None,
        supports=_columns(values, "supports"),
        support_displacement=values["ground/displacement"][:n_times],
        support_force=values["ground/force"][:n_times],
        static_stage=_columns(values, "static_stage", _whole_rows(values, "static_stage")),
        contacts=_contacts(values, n_times),
        house=_house(values, n_times, n_snapshots),
    )


def _joints(values):
    """The table of the joints, in a house with `y_m` and `share` of the thickness; 1 between two
    walls."""
    table = _decode(_columns(values, "joints"), "kind", schema.CODES["joints/kind"])
    if "placing/joint_y_m" not in values:
        return table
    y, wall = (values[f"placing/joint_{name}"][:] for name in ("y_m", "wall"))
    share = SHARES[np.sign(y).astype(int) + 1]
    return table.assign(y_m=y, share=np.where(wall < 0, 1.0, share))


def _house(values, n_times, n_snapshots):
    """The HouseRows of the history of a house, None of a plane wall."""
    if "placing/body_wall" not in values:
        return None
    older = {"failed_ties": np.zeros(n_times, "i4")}  # of files from before there were any
    return HouseRows(
        *(values[f"placing/{name}"][:] for name in schema.PLACING),
        *(values.get(f"house/{name}", older.get(name))[:n_times] for name in schema.HOUSE),
        values["snapshots/out_of_plane"][:n_snapshots],
    )


def _whole_rows(values, *groups):
    """Number of rows of groups: a killed run may have flushed one column more often than
    another."""
    return min(
        len(values[path])
        for path in schema.COLUMNS
        if path.partition("/")[0] in groups and path in values
    )


def _contacts(values, n_times):
    """The Contacts by increasing joints; columns of the file are in the order in which these became
    active."""
    frames = [values[f"frames/{name}"] for name in schema.FRAMES]
    n = min(len(values["active/joint"]), *(rows.shape[1] for rows in frames))
    joints = values["active/joint"][:n].astype(int)
    order = np.argsort(joints)
    return Contacts(joints[order], *(np.take(rows[:n_times, :n], order, axis=1) for rows in frames))


def _number_shocks(series):
    """The series with the number of the event, from 1: a new one begins with each motion after
    settling."""
    settling = (series["stage"] == "settling").to_numpy()
    series["shock"] = 1 + np.cumsum(np.diff(settling.astype(int), prepend=0) < 0)
    return series


def _columns(values, group, n_rows=None):
    """Columns of a group that the schema names, as a DataFrame."""
    return pd.DataFrame(
        {name: values[f"{group}/{name}"][:n_rows] for name in sorted(schema.TABLES[group])}
    )


def _decode(frame, column, names):
    frame[column] = pd.Categorical.from_codes(frame[column].astype(int), categories=names)
    return frame


def _end_of(history):
    """The status, when the wall collapsed, where it did, and how many samples there are."""
    fell = history.collapsed_at_s
    time_s = history.time_s
    collapse = "" if fell is None else f", collapsed at {fell:.3f} s"
    last = f" to {time_s[-1]:.3f} s" if len(time_s) else ""
    return f"{history.status}{collapse}, {len(time_s)} samples{last}"
