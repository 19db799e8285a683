"""Histories of a small wall, made by hand: what happens in them is known without a solver."""

import numpy as np

from damage import Wall, read_history
from damage.history.schema import GROUND, HOUSE
from damage.history.writer import HistoryWriter
from damage.law.states import AT_LIMIT, BROKEN, ENDED
from damage.motion.loading import FreeVibration, Harmonic, TopDisplacement
from damage.units import GRAVITY
from damage.wall.layout import lay_out

STAGES_21 = ("motion",) * 10 + ("rest",) * 6 + ("settling",) * 5
CYCLIC = TopDisplacement((0.2,), cycles=3, speed_m_s=0.02)
LOADINGS = {
    "cyclic": CYCLIC.as_dict(),
    "pushover": TopDisplacement((0.2,), cycles=0).as_dict(),
    "harmonic": Harmonic(0.2, 0.05).as_dict(),
    "free_vibration": FreeVibration().as_dict(),
    "record": {"kind": "record", "name": "NL.BGAR.HG1_x2_17-27s_vertical_baseline1_0.1-40Hz"},
}


def small_layout(**options):
    """Layout of a wall of 0.9 x 0.45 m: four bricks by six courses, and one cap."""
    return lay_out(Wall("small", 0.9, 0.45, **options))


def make_history(
    path,
    layout=None,
    *,
    stages=STAGES_21,
    step_s=0.01,
    drift=0.0,
    opening=None,
    slip=None,
    offset=None,
    broken=(),
    at_limit=(),
    ended=None,
    snapshots=None,
    row=None,
    loading="harmonic",
    status="complete",
    collapsed_at_s=None,
    overwrite=False,
    write=HistoryWriter,
    model=None,
    house=None,
    eigen_period_s=None,
):
    """Write a history of a few samples to `path` and read it back; or by `write`, HistoryInMemory,
    keep it.

    stages: of each of n_times samples, step_s apart; drift: drift ratio, (n_times,) or one number;
    opening, slip, offset: {joint: (n_times,) or one number [m]}, all others zero; no offset: that
    of the slip; broken, at_limit: further joints in that state from the first sample on; a joint
    that opens or
    slips is broken from the moment it does; ended: {joint: sample from which on it has ended};
    snapshots: {time_s: (n_bodies, 3) [m, m, rad]}, None for one at rest with every fifth sample;
    of a house (n_bodies, 6) with the motion out of plane [m, rad, rad];
    house: {"top_displacement_m", "across_m" or "top_across_m": (n_walls,)} of every sample, all
    others zero;
    row: {column of the series: (n_times,) or one number} over what is put in by itself;
    status: "unfinished" for a run that was killed; model: {option: value} other than the usual.
    """
    layout = layout or small_layout()
    n_times = len(stages)
    time_s = step_s * np.arange(n_times)
    columns = {**_usual_columns(layout, stages, time_s, drift, loading), **(row or {})}
    columns = {name: np.broadcast_to(values, n_times) for name, values in columns.items()}
    opened, slipped, away = (
        _frames(layout, n_times, values)
        for values in (opening, slip, slip if offset is None else offset)
    )
    state = _states(opened, np.abs(slipped) + np.abs(away), broken, at_limit)
    for joint, first in (ended or {}).items():
        state[first:, joint] |= ENDED
    writer = write(
        path,
        layout,
        solver="reference",
        versions={},
        overwrite=overwrite,
        parameters={
            "loading": LOADINGS[loading],
            "wall": layout.wall.as_dict(),
            "model": model or {},
            "eigen_period_s": eigen_period_s,
        }
        | layout.house_parameters,
    )
    frames = {"opening_m": opened, "slip_m": slipped, "offset_m": away, "state": state}
    ground = {f"ground/{name}": np.zeros((1, len(layout.supports), 3)) for name in GROUND}
    if layout.IN_SPACE:
        n_walls = len(layout.walls)
        rows = {name: np.zeros(n_walls) for name in HOUSE} | (house or {})
        rows |= {"base_acceleration_m_s2": 0.0, "failed_ties": 0}
        ground |= {f"house/{name}": np.array([values]) for name, values in rows.items()}
    n_moves = 6 if layout.IN_SPACE else 3
    for k, stage in enumerate(stages):
        row, contacts = (
            {name: values[k : k + 1] for name, values in group.items()}
            for group in (columns, frames)
        )
        writer.extend(stage, row, slice(None), contacts, ground)
    if snapshots is None:
        snapshots = {time: np.zeros((len(layout.bodies), n_moves)) for time in time_s[::5]}
    for time, displacement in snapshots.items():
        more = () if layout.strain is None else (np.zeros((len(layout.bodies), 5, 3)),)
        more = (displacement[:, 3:],) if layout.IN_SPACE else more
        writer.snapshot(time, displacement[:, :3], *more)
    writer.finish(status, collapsed_at_s)
    return read_history(path) if write is HistoryWriter else writer.history()


def _usual_columns(layout, stages, time_s, drift, loading):
    """A sine as base motion, a linear wall of 1 MN/m, and energies that balance."""
    drift = np.broadcast_to(drift, len(time_s))
    moving = (np.array(stages, dtype=str) == "motion") & (loading != "free_vibration")
    shear_n = 1e6 * layout.drift_height * drift
    strain_j = 0.5 * shear_n * layout.drift_height * drift
    return {
        "time_s": time_s,
        "drift_ratio": drift,
        "top_displacement_m": layout.drift_height * drift,
        "base_acceleration_x_m_s2": np.where(
            moving, 0.05 * GRAVITY * np.sin(2 * np.pi * time_s / 0.2), 0
        ),
        "base_acceleration_z_m_s2": 0.0,
        "base_shear_n": shear_n,
        "kinetic_energy_j": 0.0,
        "elastic_energy_j": strain_j,
        "gravity_energy_j": 0.0,
        "friction_energy_j": 0.0,
        "fracture_energy_j": 0.0,
        "damping_energy_j": 0.0,
        "input_energy_j": strain_j,
    }


def _frames(layout, n_times, values):
    frames = np.zeros((n_times, layout.n_joints))
    for joint, value in (values or {}).items():
        frames[:, joint] = value
    return frames


def _states(opened, slipped, broken, at_limit):
    """Bits of BROKEN and AT_LIMIT, (n_times, n_joints); both stay once they are set."""
    state = np.where(np.maximum.accumulate((opened > 0) | (slipped != 0), axis=0), BROKEN, 0)
    state[:, list(broken)] |= BROKEN
    state[:, list(at_limit)] |= BROKEN | AT_LIMIT
    return state
