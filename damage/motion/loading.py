"""Loadings of a run: a harmonic base motion, a record, a push, or an initial velocity.

Each is a `Loading` with a `name` fit for a file name; `as_dict` is what a history keeps of it,
`loading_from_dict` makes the record again.
"""

import math
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from damage.checks import check_positive, check_range, record_from
from damage.elementary import sin_of_turns
from damage.errors import InputError
from damage.fields import check_fields, choice, plausible, quantity, text
from damage.motion import record as prepare
from damage.motion.intensity import pga_g, response_spectrum
from damage.motion.record import Record
from damage.motion.samples import at_times, linear
from damage.rounded import to_bits
from damage.units import GRAVITY


@dataclass(frozen=True)
class Drive:
    """Prescribed motion of a wall; None where the loading prescribes nothing.

    base: time_s (n,) -> (n, 2), acceleration along x and z of the frame in which the wall and all
        supports are computed [m/s2];
    supports: time_s (n,), x_m (k,) -> (n, k, 3), displacement in that frame of the supports whose
        reference points stand at x_m [m, m, rad];
    top: time_s (n,), height_m -> (n,), horizontal displacement of the bodies that carry the top, at
    that height [m];
    top_rotates: whether these may rotate while they are moved; top_stiffness: of a rotational
        spring between each of them and what moves it [N m/rad];
    floor_shares: ((level [m], share [-]), ...) of the floors on which a spreader beam acts in place
        of the top; `top` is then its displacement;
    first_mode_m_s: velocity of the top in the first mode at time zero [m/s];
    local_damping: Cundall's, of a quasi-static loading [-]; None of a dynamic one.
    """

    base: Callable | None = None
    supports: Callable | None = None
    top: Callable | None = None
    top_rotates: bool = True
    top_stiffness: float = 0.0
    floor_shares: tuple = ()
    first_mode_m_s: float = 0.0
    local_damping: float | None = None

    @property
    def quasi_static(self) -> bool:
        """Whether the loading is so slow that the wall stays in equilibrium."""
        return self.local_damping is not None


def mean_velocities(
    displacement: Callable | None, interval_s: float, n: int, place
) -> np.ndarray | None:
    """Mean velocities in the first n intervals (n, ...) [m/s, of rotations rad/s], of a
    displacement(time_s, place) as `Drive.top` and `Drive.supports` are: constant within each
    interval, they lead to the displacement at its end.  None where there is none."""
    return (
        displacement
        and np.diff(displacement(np.arange(n + 1) * interval_s, place), axis=0) / interval_s
    )


PERIODS_S = (1e-3, 1000.0)
"""Least and largest period of a harmonic base motion [s]."""
HIGHEST_G = 100.0
"""Largest peak of a base motion [g]."""
MOST_CYCLES = 10**6
"""Largest number of cycles of a harmonic base motion."""
SINE_SAMPLES = 400
"""Samples in a cycle of a harmonic motion as a record: lines between are off by (pi / 400)^2 / 2 =
3e-5 of the peak."""


class Loading:
    """Base of all loadings; its values are those of one that prescribes nothing.

    kind: word by which a history tells them apart;
    drive: what it prescribes on a wall, a Drive, whose base moves by base_acceleration; duration_s:
    of the base's motion [s]; cycle_edges_s: where the motion's own cycles begin and end, (k,) [s];
    peak_g: largest acceleration of the base [g]; pga_g, sa_02_s_g: peak and 5 % spectral
    acceleration at 0.2 s [g] of the base along the wall, None where unknown; record_pga_g: peak of
    a record before it was interpolated for a wall [g]; lost_by_lines: of an interpolated record,
    else None; moves: whether there is a motion at all.

    >>> swing = FreeVibration(top_velocity_m_s=0.01)
    >>> swing.name, swing.drive.first_mode_m_s, swing.length_s(2.7), swing.preferred_step_s(1e-4)
    ('free_vibration_0.01m_s', 0.01, 0.0, 0.0001)
    >>> swing.for_period(0.2) is swing, swing.applied(), swing.applied_across()
    (True, None, None)
    """

    kind: ClassVar[str]
    name: str
    duration_s: float = 0.0
    cycle_edges_s: np.ndarray = np.zeros(0)
    peak_g: float = 0.0
    base_acceleration: Callable | None = None
    pga_g: float | None = None
    record_pga_g: float | None = None
    sa_02_s_g: float | None = None
    lost_by_lines: float | None = None
    moves = True

    @property
    def drive(self) -> Drive:
        return Drive(base=self.base_acceleration)

    def length_s(self, height: float) -> float:
        """Time from zero to the end of everything that is prescribed, on a wall whose top is at a
        height [m]: [s]."""
        return self.duration_s

    def preferred_step_s(self, max_step_s: float) -> float:
        """The time step that fits the motion, at most max_step_s [s]: here to its first six digits,
        which a run prints, so that it can be repeated from them."""
        return float(f"{max_step_s:.5e}")

    def for_period(self, period_s: float) -> "Loading":
        """The loading as it drives a wall of that first period [s]."""
        return self

    def applied(self) -> Record | None:
        """The base's motion along the wall as a record; None where it stands still, and of what a
        history keeps of a recorded motion, which is without its samples."""

    def applied_across(self) -> Record | None:
        """The motion at right angles to the wall, which is not applied, as a record; None where it
        is not known."""

    def as_dict(self) -> dict:
        """Everything that defines the motion, fit for JSON."""
        fields = vars(self)
        return {"kind": self.kind, "name": self.name, **fields, "duration_s": self.duration_s}


@dataclass(frozen=True)
class Harmonic(Loading):
    """Horizontal base acceleration: a sine from zero, a whole number of cycles.

    period_s [s]; amplitude_g [g]; cycles: how many.

    >>> sine = Harmonic(period_s=0.2, amplitude_g=0.05)
    >>> sine.name, round(sine.duration_s, 3), sine.peak_g  # [s], [g]
    ('harmonic_0.2s_0.05g', 0.6, 0.05)
    """

    kind: ClassVar[str] = "harmonic"
    period_s: float = quantity(
        "s",
        *PERIODS_S,
        (0.01, 10),
        "machines; a hundred times the period of a house's wall",
        others={"ms": 1e-3},
        called="harmonic period [s]",
    )
    amplitude_g: float = quantity(
        "g",
        0,
        HIGHEST_G,
        (1e-4, 2),
        "times the largest factor of `--sequence`: traffic; strong shaking tables",
        called="harmonic amplitude [g]",
        others={"%": 0.01, "m/s2": 1 / GRAVITY, "cm/s2": 0.01 / GRAVITY},
    )
    cycles: int = quantity("1", 1, MOST_CYCLES, whole=True, default=3, called="cycles")

    __post_init__ = check_fields

    @property
    def name(self) -> str:
        count = "" if self.cycles == 3 else f"_{self.cycles:g}cycles"
        return f"harmonic_{self.period_s:g}s_{self.amplitude_g:g}g{count}"

    @property
    def duration_s(self) -> float:
        """Time of the last cycle's end [s]."""
        return self.cycles * self.period_s

    @property
    def cycle_edges_s(self) -> np.ndarray:
        return self.period_s * np.arange(self.cycles + 1)

    @property
    def pga_g(self) -> float:
        return self.amplitude_g

    @property
    def peak_g(self) -> float:
        return self.amplitude_g

    def preferred_step_s(self, max_step_s: float) -> float:
        """Largest step up to max_step that brings the sine's peaks onto steps [s].

        >>> round(Harmonic(0.2, 0.05).preferred_step_s(3e-3), 6)
        0.002941
        """
        quarter_s = self.period_s / 4
        return quarter_s / prepare.whole_steps(quarter_s, max_step_s)

    def applied(self) -> Record | None:
        """Record of the motion, SINE_SAMPLES a cycle as far as a record's steps allow; None where
        it has too many.

        >>> Harmonic(0.2, 0.05).applied().time_step_s
        0.0005
        """
        shortest, longest = prepare.TIME_STEPS_S
        # four, so that a sample is at every peak
        samples = 4 * max(
            math.ceil(self.period_s / longest / 4),
            min(SINE_SAMPLES // 4, int(self.period_s / shortest / 4)),
        )
        if samples * self.cycles >= prepare.MOST_SAMPLES // 2:
            return None
        time_s = np.arange(samples * self.cycles + 1) * (self.period_s / samples)
        return Record(self.name, self.period_s / samples, self._sine(time_s))

    def base_acceleration(self, time_s: np.ndarray) -> np.ndarray:
        """Along x and z, (n, 2) [m/s2], at times (n,) [s].

        >>> Harmonic(0.2, 0.05).base_acceleration(np.array([0.05])).round(3).tolist()
        [[0.491, 0.0]]
        """
        time_s = np.atleast_1d(np.asarray(time_s, dtype=np.float64))
        driven = (time_s >= 0) & (time_s <= self.duration_s)
        return np.column_stack((np.where(driven, self._sine(time_s), 0.0), np.zeros_like(time_s)))

    def _sine(self, time_s):
        """Acceleration (n,) [m/s2] of the sine without its ends at times (n,) [s]."""
        return self.amplitude_g * GRAVITY * sin_of_turns(time_s / self.period_s)


@dataclass(frozen=True)
class Recorded(Loading):
    """Base acceleration of a record, after baseline, band-pass, interpolation, window and scale, in
    this order.

    record: horizontal component.
    scale: factor on both components.
    window_s: start and end [s] of the part that is used, or None for all of it.
    vertical: component along z, or None.
    across: horizontal component at right angles, which is not applied and of which the largest of
        all directions is known (RotD100), or None.  Both are put on the time axis of the record
        (`damage.motion.record.on_axis_of`).
    baseline_order: order of the polynomial that is taken off, or None.
    band_hz: corners of the zero-phase band-pass [Hz], or None.
    interpolated_for_s: first period [s] of the wall for which both components are interpolated,
        band-limited (`for_period`), or None: lines between the record's samples.

    >>> along = Record("along", 0.01, np.sin(np.arange(101) / 5))
    >>> across = Record("across", 0.01, np.cos(np.arange(101) / 5))
    >>> motion = Recorded(along, scale=2.0, window_s=(0.2, 0.8), across=across)
    >>> motion.name, round(motion.duration_s, 3), round(motion.record_pga_g, 3)  # [s], [g]
    ('along_x2_0.2-0.8s', 0.6, 0.204)
    >>> len(motion.components), motion.late_s, len(motion.motion), motion.applied().name
    (2, {}, 1, 'along')
    >>> motion.base_acceleration(np.array([0.0, 0.6])).round(2).tolist()  # [m/s2]
    [[-1.51, 0.0], [-0.58, 0.0]]
    >>> round(motion.preferred_step_s(0.003), 5), motion.applied_across().duration_s  # [s]
    (0.0025, 0.6)
    >>> round(motion.for_period(0.05).lost_by_lines, 3), motion.as_dict()["horizontal"]["record"]
    (0.125, 'along')
    """

    record: Record
    scale: float = text(
        default=1.0,
        usual=plausible(
            0.01,
            100,
            "",
            "without its sign; the records of studies that ship get up to 10",
            others={"%": 0.01},
        ),
    )
    window_s: tuple[float, float] | None = None
    vertical: Record | None = None
    baseline_order: int | None = None
    band_hz: tuple[float, float] | None = None
    interpolated_for_s: float | None = None
    across: Record | None = None

    def __post_init__(self):
        check_fields(self)
        for key in ("window_s", "band_hz"):
            pair = getattr(self, key)
            if pair is not None and len(pair) != 2:
                raise InputError(f"{key} of {len(pair)} numbers; expected two, start and end")
        if self.across is not None:
            _check_pair(self.record, self.across)
        for name in ("vertical", "across"):
            if (other := getattr(self, name)) is not None:
                vars(self)[name] = prepare.on_axis_of(other, self.record, self.window_s)
        self.motion  # noqa: B018, prepared now so that a bad parameter is reported at once

    @property
    def components(self) -> tuple[Record, ...]:
        """The records, as they were read: the horizontal one, and others where there are any."""
        return tuple(filter(None, (self.record, self.vertical, self.across)))

    @property
    def late_s(self) -> dict[str, float]:
        """{name: by how much it began later than the horizontal one [s]} of other components that
        were moved by their times."""
        least_s = 0.5 * self.record.time_step_s
        return {
            component.name: component.late_s
            for component in self.components
            if abs(component.late_s) > least_s
        }

    @cached_property
    def motion(self) -> tuple[Record, ...]:
        """The prepared horizontal and, where there is one, vertical record."""
        return tuple(
            self._prepared(component)
            for component in (self.record, self.vertical)
            if component is not None
        )

    def _prepared(self, record):
        """Filters before the window: they need the quiet parts on both sides."""
        if self.baseline_order is not None:
            record = prepare.baseline_corrected(record, self.baseline_order)
        if self.band_hz is not None:
            record = prepare.band_passed(record, *self.band_hz)
        if self.interpolated_for_s is not None:
            record = prepare.interpolated(record, self.window_s)
        elif self.window_s is not None:
            record = prepare.windowed(record, *self.window_s)
        return prepare.scaled(record, self.scale)

    def for_period(self, period_s: float) -> "Recorded":
        """The loading, interpolated where the record has fewer than LEAST_A_PERIOD samples in the
        period."""
        coarse = self.record.time_step_s > period_s / prepare.LEAST_A_PERIOD
        return replace(self, interpolated_for_s=float(period_s)) if coarse else self

    @property
    def lost_by_lines(self) -> float | None:
        """Share of the motion at the wall's first period that lines between the record's samples
        would take off, where it is interpolated: 1 - sinc^2(step / period)."""
        if self.interpolated_for_s is None:
            return None
        return float(1 - np.sinc(self.record.time_step_s / self.interpolated_for_s) ** 2)

    def applied(self) -> Record:
        """The prepared horizontal record."""
        return self.motion[0]

    def applied_across(self) -> Record | None:
        """The record across the wall, prepared as the component along it."""
        return None if self.across is None else self._prepared(self.across)

    @property
    def name(self) -> str:
        parts = [re.sub(r"[^\w.-]+", "_", self.record.name), f"x{self.scale:g}"]
        if self.window_s is not None:
            parts.append("{:g}-{:g}s".format(*self.window_s))
        if self.vertical is not None:
            parts.append("vertical")
        if self.baseline_order is not None:
            parts.append(f"baseline{self.baseline_order}")
        if self.band_hz is not None:
            parts.append("{:g}-{:g}Hz".format(*self.band_hz))
        return "_".join(parts)

    @property
    def duration_s(self) -> float:
        """Time of the last sample that is used [s]."""
        return self.motion[0].duration_s

    @property
    def peak_g(self) -> float:
        return max(map(pga_g, self.motion))

    @property
    def record_pga_g(self) -> float:
        """Peak of the horizontal record, prepared but not interpolated [g]: the same for all
        walls."""
        return pga_g(replace(self, interpolated_for_s=None, vertical=None, across=None).motion[0])

    def preferred_step_s(self, max_step_s: float) -> float:
        """Largest step up to max_step that brings every sample onto a step [s]: no peak is lost
        between steps."""
        step_s = self.motion[0].time_step_s
        return step_s / prepare.whole_steps(step_s, max_step_s)

    def base_acceleration(self, time_s: np.ndarray) -> np.ndarray:
        """Along x and z, (n, 2) [m/s2], at times (n,) [s]: linear between samples, zero before the
        first and after the last."""
        time_s = np.atleast_1d(np.asarray(time_s, dtype=np.float64))
        acceleration = np.zeros((time_s.size, 2))
        for column, part in enumerate(self.motion):
            acceleration[:, column] = at_times(time_s, part.time_step_s, part.acceleration_m_s2)
        return acceleration

    def as_dict(self) -> dict:
        """Everything that defines the motion but the samples, fit for JSON."""
        same = (
            "name",
            "scale",
            "record_pga_g",
            "window_s",
            "baseline_order",
            "band_hz",
            "duration_s",
            "interpolated_for_s",
            "lost_by_lines",
        )
        return RecordedMotion(
            **{name: getattr(self, name) for name in same},
            horizontal=_origin(self.record),
            vertical=_origin(self.vertical),
            across=_origin(self.across),
            time_step_s=self.record.time_step_s,
            pga_g=pga_g(self.motion[0]),
            sa_02_s_g=float(response_spectrum(self.motion[0], [0.2])[0]),
        ).as_dict()


@dataclass(frozen=True)
class RecordedMotion(Loading):
    """A `Recorded` as read from a history: without the samples, which stay in the record's file.

    horizontal, vertical, across: {"record": its name, "file": without its folder, "sha256",
    "start_utc", "unit", and "given" where it was given how to read it} of the components;
    time_step_s: of the record's file [s]; pga_g, sa_02_s_g: of the motion as it was used [g];
    record_pga_g: before it was interpolated; the rest as in `Recorded`.  None is what an older
    file does not say."""

    name: str
    horizontal: dict = field(default_factory=dict)
    vertical: dict | None = None
    time_step_s: float | None = None
    scale: float | None = None
    pga_g: float | None = None
    sa_02_s_g: float | None = None
    window_s: tuple[float, float] | None = None
    baseline_order: int | None = None
    band_hz: tuple[float, float] | None = None
    duration_s: float | None = None
    interpolated_for_s: float | None = None
    lost_by_lines: float | None = None
    across: dict | None = None
    record_pga_g: float | None = None

    def base_acceleration(self, _time_s: np.ndarray) -> np.ndarray:
        raise InputError(
            f"{self.name}: a history does not hold the samples of its record; expected the record's"
            " file; read that"
        )

    def as_dict(self) -> dict:
        """The table of which `loading_from_dict` makes this again, fit for JSON; a motion whose
        samples were taken as they are says nothing of interpolation, one without another component
        nothing of it."""
        table = {"kind": "record", **asdict(self)}
        if self.across is None:
            del table["across"]
        if self.interpolated_for_s is None:
            del table["interpolated_for_s"], table["lost_by_lines"]
        return table | {"sa_0.2_s_g": table.pop("sa_02_s_g")}


@dataclass(frozen=True)
class FreeVibration(Loading):
    """No base motion: the wall starts with a velocity in the shape of its first mode.

    top_velocity_m_s: velocity of the wall's top [m/s].
    """

    kind: ClassVar[str] = "free_vibration"
    top_velocity_m_s: float = 1e-3

    def __post_init__(self):
        check_fields(self)
        check_positive("top velocity [m/s]", self.top_velocity_m_s)

    @property
    def name(self) -> str:
        usual = self.top_velocity_m_s == type(self).top_velocity_m_s
        return "free_vibration" + ("" if usual else f"_{self.top_velocity_m_s:g}m_s")

    @property
    def drive(self) -> Drive:
        return Drive(first_mode_m_s=self.top_velocity_m_s)


@dataclass(frozen=True)
class AtRest(Loading):
    """No motion: the run ends after its settlement."""

    kind: ClassVar[str] = "at_rest"
    name: ClassVar[str] = "at_rest"
    moves: ClassVar[bool] = False


BOUNDARIES = ("cantilever", "fixed")
EASE_S = 0.1
"""Time that a pushed top takes to start, to reverse and to stop [s]: longer than a wall's first
period, so that the wall does not vibrate."""
DRIFTS_PCT = (1e-6, 100.0)
"""Least and largest drift that a top is pushed to [%]: less is rounding."""
SPEEDS_M_S = (1e-6, 1.0)
"""Least and largest speed of a push [m/s]: more is not quasi-static."""


@dataclass(frozen=True)
class TopDisplacement(Loading):
    """Quasi-static: the top is moved such that the drift goes to and fro at a constant speed, and
    turns round smoothly; the base stands still.

    amplitudes_pct: drift ratios [%] to go to, in this order.
    cycles: full cycles (to +a, to -a) at each; 0 for a single push to the first amplitude.
    boundary: "cantilever", the top may rotate; "fixed", it may not (double fixed).
    speed_m_s: of the course that the drift is of [m/s]; local_damping [-], where the solver damps
        locally: the result depends on both when they are not slow and high; top_rotation:
        stiffness of a rotational spring between the top and the machine that moves it [N m/rad],
        of each body that carries the top; 0: free.
    floor_shares: ((level [m], share [-]), ...): push by a spreader beam on these floors instead,
        with forces that keep their ratio; the drift is that of their resultant: the mean
        displacement of the floors by their shares, over the mean of their heights.

    >>> push = TopDisplacement((0.1,), cycles=0, boundary="fixed")
    >>> push.name, push.turning_points(2.0).round(4).tolist(), round(push.length_s(2.0), 3)
    ('pushover_0.1pct_fixed', [0.002], 0.5)
    >>> [values.round(4).tolist() for values in push.schedule(2.0)]  # [s], [m]
    [[0.0, 0.4, 0.5], [0.0, 0.002, 0.002]]
    >>> push.top_displacement(np.array([0.0, 0.2, 9.0]), 2.0).round(4).tolist()  # [m]
    [0.0, 0.0008, 0.002]
    """

    amplitudes_pct: tuple[float, ...] = text(
        usual=plausible(1e-4, 20, "%", "a joint stays elastic; slender piers topple")
    )
    cycles: int = quantity("1", 0, 1000, whole=True, default=2, called="cycles")
    boundary: str = choice(BOUNDARIES, default="cantilever", called="boundary")
    speed_m_s: float = quantity("m/s", *SPEEDS_M_S, default=5e-3, called="speed [m/s]")
    # beyond, steps are unstable
    local_damping: float = quantity("1", 0, 0.7, default=0.7, called="local damping")
    top_rotation: float = quantity(
        "N m/rad", 0, 1e12, default=0.0, called="--top-rotation [N m/rad]"
    )
    floor_shares: tuple[tuple[float, float], ...] = ()

    def __post_init__(self):
        check_fields(self)
        if self.top_rotation and self.boundary == "fixed":
            raise InputError(
                f"--top-rotation {self.top_rotation:g} with --boundary fixed: expected a top that"
                " may rotate; leave one of them out"
            )
        if not self.amplitudes_pct:
            raise InputError("no drift to push the top to; expected one or more [%]; give some")
        for drift in self.amplitudes_pct:
            check_range("drift [%]", drift, *DRIFTS_PCT)
        if len(self.amplitudes_pct) > 1000:
            raise InputError(
                f"{len(self.amplitudes_pct)} drifts to push the top to; expected up to 1000; give"
                " fewer"
            )
        self._check_shares()

    def _check_shares(self):
        if not self.floor_shares:
            return
        for level, share in self.floor_shares:
            check_positive("level of --floor-share [m]", level)
            check_positive(f"--floor-share at {level:g} m", share)
        whole = math.fsum(share for _, share in self.floor_shares)
        if abs(whole - 1) > 1e-3:
            raise InputError(
                f"--floor-share: shares whose sum is {whole:g}: expected 1; correct them"
            )
        if self.boundary == "fixed" or self.top_rotation:
            raise InputError(
                "--floor-share with --boundary fixed or --top-rotation: expected floors that may"
                " rotate; leave one of them out"
            )

    @property
    def name(self) -> str:
        drifts = "-".join(f"{a:g}" for a in self.amplitudes_pct)
        kind = f"cyclic_{drifts}pct_{self.cycles}x" if self.cycles else f"pushover_{drifts}pct"
        more = [f"_top-rotation-{self.top_rotation:g}"] if self.top_rotation else []
        more += [f"_{share:g}-at-{level:g}m" for level, share in self.floor_shares]
        return f"{kind}_{self.boundary}{''.join(more)}"

    @property
    def drive(self) -> Drive:
        return Drive(
            top=self.top_displacement,
            top_rotates=self.boundary != "fixed",
            top_stiffness=self.top_rotation,
            floor_shares=self.floor_shares,
            local_damping=self.local_damping,
        )

    def turning_points(self, height: float) -> np.ndarray:
        """Top displacements [m] at which the motion reverses, for a wall of that height [m].

        >>> TopDisplacement((0.1,)).turning_points(2.0).round(4).tolist()
        [0.002, -0.002, 0.002, -0.002, 0.0]
        """
        amplitudes = to_bits(np.array(self.amplitudes_pct) / 100 * height)
        if self.cycles == 0:
            return amplitudes[:1]
        return np.append(np.outer(amplitudes, np.tile([1.0, -1.0], self.cycles)), 0.0)

    def top_displacement(self, time_s: np.ndarray, height: float) -> np.ndarray:
        """Displacement that is asked for [m] at times (n,) [s]; it stays where it ends.

        The mean of the schedule over the last EASE_S: the speed changes linearly, every turning
        point is reached.
        """
        times, points = self.schedule(height)
        areas = np.concatenate([[0.0], np.cumsum((points[1:] + points[:-1]) / 2 * np.diff(times))])

        def area(until_s):
            until_s = np.maximum(until_s, 0.0)
            knot = np.searchsorted(times, until_s, side="right") - 1
            displacement = linear(until_s, times, points)
            return areas[knot] + (points[knot] + displacement) / 2 * (until_s - times[knot])

        time_s = np.asarray(time_s, dtype=np.float64)
        return (area(time_s) - area(time_s - EASE_S)) / EASE_S

    def length_s(self, height: float) -> float:
        """Time of the motion's end [s]."""
        return float(self.schedule(height)[0][-1])

    def schedule(self, height: float) -> tuple[np.ndarray, np.ndarray]:
        """Times (k,) [s] and top displacements (k,) [m] from (0, 0): to every turning point, and a
        rest there."""
        points = np.concatenate([[0.0], self.turning_points(height)])
        moves = np.abs(np.diff(points)) / self.speed_m_s
        times = np.cumsum(np.column_stack([moves, np.full(len(moves), EASE_S)]))
        return np.concatenate([[0.0], times]), np.concatenate([[0.0], np.repeat(points[1:], 2)])

    def as_dict(self) -> dict:
        table = {
            "kind": "cyclic" if self.cycles else "pushover",
            "name": self.name,
            "amplitudes_pct": self.amplitudes_pct,
            "cycles": self.cycles,
            "boundary": self.boundary,
            "speed_m_s": self.speed_m_s,
            "ease_s": EASE_S,
            "follows": "drift",
            "local_damping": self.local_damping,
            "top_rotation": self.top_rotation,
        }
        return table | ({"floor_shares": self.floor_shares} if self.floor_shares else {})


_KINDS = {
    "harmonic": Harmonic,
    "record": RecordedMotion,
    "free_vibration": FreeVibration,
    "at_rest": AtRest,
    "pushover": TopDisplacement,
    "cyclic": TopDisplacement,
}


def loading_from_dict(table: dict) -> Loading:
    """The record of which a loading's `as_dict` made the table; of a recorded motion all but its
    samples.

    >>> loading_from_dict(Harmonic(0.2, 0.05).as_dict()) == Harmonic(0.2, 0.05)
    True
    """
    if table.get("kind") not in _KINDS:
        raise InputError(
            f"a loading of kind {table.get('kind')!r}: expected one of {', '.join(_KINDS)}; a later"
            " version wrote it, update the software"
        )
    table = {"sa_02_s_g" if name == "sa_0.2_s_g" else name: value for name, value in table.items()}
    return record_from(
        _KINDS[table["kind"]], table, derived=("kind", "name", "duration_s", "ease_s", "follows")
    )


def _check_pair(record, across):
    """Two components have to be horizontal ones of one station, by their names where these end in
    channels as HGE."""
    stations = [
        re.fullmatch(r"(.+)[._][A-Z]{2}[A-Z0-9]", component.name) for component in (record, across)
    ]
    same = record.name == across.name or (record.sha256 and record.sha256 == across.sha256)
    elsewhere = all(stations) and stations[0][1] != stations[1][1]
    if same or elsewhere or prepare.VERTICAL.fullmatch(across.name):
        raise InputError(
            f"across {across.name} beside {record.name}: expected the other horizontal component of"
            " the same station; give that one"
        )


def _origin(record):
    """Origin of a record: the file's name without its folder, which differs by machine."""
    return record and {
        "record": record.name,
        "file": Path(record.source).name,
        "sha256": record.sha256,
        "start_utc": record.start_utc,
        "unit": record.unit,
        **({"given": record.given} if record.given else {}),
    }
