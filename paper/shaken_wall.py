"""The wall US-1 of a shaking table, shaken by its runs in sequence; the tables of
docs/validation/shaken-walls.md.

    python3 -m paper shaken_wall FOLDER bearings    # which bearing six runs choose at three heights
    python3 -m paper shaken_wall FOLDER prediction  # draws beside the test, and the second wall's
                                                    # later prediction
    python3 -m paper shaken_wall FOLDER heights     # peaks at three heights by both bearings, and
                                                    # errors
    python3 -m paper shaken_wall FOLDER coverage    # five runs by draws of all inputs
    python3 -m paper shaken_wall FOLDER choices     # what load, bearing, stiffness and law change
    python3 -m paper shaken_wall FOLDER period      # what would have to be lost for the periods of
                                                    # the test
    python3 -m paper shaken_wall FOLDER solvers     # run 21 in both solvers

FOLDER has the files that docs/validation/shaken-walls.md names; they have no licence and do not
ship.
"""

import hashlib
import math
import sys
from dataclasses import replace
from itertools import product, starmap
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.optimize import brentq
from scipy.signal import butter, sosfiltfilt

from damage import Brick, Joint, Wall
from damage.history.buffer import Buffer
from damage.law.modes import natural_modes
from damage.measure.cycles import natural_period
from damage.measure.energy import energy_error_of
from damage.motion.formats import write_csv
from damage.motion.intensity import response_spectrum
from damage.motion.loading import Recorded
from damage.motion.record import Record, scaled
from damage.motion.sequence import Event
from damage.reference.ensembles import move
from damage.reference.session import BACKEND
from damage.run.cooperative import as_they_end
from damage.run.run import Run
from damage.run.schedule import choose_time_step
from damage.run.settings import RunSettings
from damage.units import GRAVITY
from damage.wall.drawn import Range, drawn, ranges
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from damage.wall.parameters import RULE
from damage.wall.restraints import Restraint
from paper.bench import REPOSITORY, Bench, arguments, option

TABLES = REPOSITORY / "docs" / "tables"
HEIGHT_M, COURSES, WIDTH_M, THICK_M, DENSITY = 2.58, 43, 1.292, 0.21, 1885.0
SENSORS_M = 0.66, 1.26, 2.06
PERIOD_S, DAMPING = 0.09153, 0.05
"""First period before run 1, and damping of the spectral displacement of each run at that
period."""
MOTIONS = {
    "HU12": ("hu12_x6_table_velocity_mm_s.txt", None),
    "FR76": ("fr76_x1_table_velocity_mm_s.txt", 12.0),
}
"""Strong phases of table velocity [mm/s] at 0.005 s, and where they are low-passed [Hz]."""
STEP_S, REST_S = 0.005, 1.5
DRAWS, COV = 19, 0.35
"""Of 19 draws the least and the largest hold a twentieth in 90 of 100 cases."""
CHOSEN_ON = 5, 10, 14, 17, 19, 21
"""Runs that the bearing may be chosen on, all of HU12; the others judge."""
RIGID_PA = 1e15
"""Modulus of the bricks: all compliance is the joints', by the measured period."""


class Case(NamedTuple):
    """load_n: on the top [N]; stiffness [N/m], friction, play [m]: of the bearing, stiffness None
    where the top is driven; moving_kg: mass that slides with it; period_s: to which the joints'
    stiffness is fitted; cohesion [Pa]; softens: whether joints soften; damping: ratio at the first
    period; cells: contact points of a joint.  By default with the first bearing, chosen on runs 1
    to 10."""

    load_n: float = 10.35e3
    stiffness: float | None = 3e6
    friction: float = 0.1
    play: float = 3e-3
    moving_kg: float = 50.0
    period_s: float = PERIOD_S
    cohesion: float = 0.3e6
    softens: bool = True
    damping: float = 0.0
    cells: int = 8


def strip(case, normal_stiffness):
    """The Wall of a Case with joints of this stiffness [Pa/m]."""
    energies = (
        {"mode_i_fracture_energy": RULE, "mode_ii_fracture_energy": RULE} if case.softens else {}
    )
    joint = Joint(
        normal_stiffness,
        0.4 * normal_stiffness,
        math.radians(36.9),
        0.875 * case.cohesion,
        case.cohesion,
        **energies,
    )
    brick = Brick(
        2 * THICK_M,
        HEIGHT_M / COURSES,
        WIDTH_M,
        DENSITY,
        young_modulus=RIGID_PA,
        shear_modulus=RIGID_PA / 2.5,
    )
    bearing = (
        {}
        if case.stiffness is None
        else {name: getattr(case, name) for name in ("stiffness", "friction", "play")}
    )
    return Wall(
        "us-1",
        THICK_M,
        HEIGHT_M,
        precompression=case.load_n / (THICK_M * WIDTH_M),
        brick=brick,
        joint=joint,
        restraints=[Restraint("top", **bearing, mass=case.moving_kg)],
    )


def fitted(case):
    """The Wall of a Case whose first period is the measured one."""

    def excess(exponent):
        return (
            natural_modes(
                lay_out(
                    strip(case, 10**exponent), ModelOptions(contacts="gauss", cells=case.cells)
                ),
                1,
            ).period_s[0]
            - case.period_s
        )

    if excess(12.0) > 0:
        raise ValueError(f"{case}: the bearing alone is softer than the measured period")
    return strip(case, 10 ** brentq(excess, 8.5, 12.0, xtol=1e-4))


# --- motions --------------------------------------------------------------------------------------


def read_runs(folder):
    """The table of runs, by run."""
    return pd.read_csv(folder / "US1_IM_vs_EDP.csv").set_index("run", drop=False)


def strong_phase(folder, name):
    """The acceleration of a strong phase as a Record; its size is that of the file."""
    file, lowpass_hz = MOTIONS[name]
    lines = [line for line in (folder / file).read_text().splitlines() if not line.startswith("#")]
    velocity = 1e-3 * np.array(" ".join(lines).split(), float)
    if lowpass_hz:
        velocity = sosfiltfilt(butter(4, lowpass_hz, fs=1 / STEP_S, output="sos"), velocity)
    return Record(name, STEP_S, np.gradient(velocity, STEP_S))


def displacement_mm(record):
    """Spectral displacement at PERIOD_S [mm]."""
    rested = replace(record, acceleration_m_s2=np.append(record.acceleration_m_s2, np.zeros(100)))
    return (
        1e3
        * GRAVITY
        * response_spectrum(rested, PERIOD_S, DAMPING)[0]
        * (PERIOD_S / 2 / math.pi) ** 2
    )


def synthetic(pga_g, sd_mm, seed=0, duration_s=10.0):
    """A motion of this peak acceleration and spectral displacement: white noise below the corner
    that gives both, under a rising and falling window."""
    time_s = np.arange(round(duration_s / STEP_S)) * STEP_S
    white = (
        np.random.default_rng(seed).standard_normal(len(time_s))
        * np.sin(np.pi * time_s / duration_s) ** 2
    )

    def below(corner_hz):
        noise = sosfiltfilt(
            butter(4, (0.5, corner_hz), "bandpass", fs=1 / STEP_S, output="sos"), white
        )
        return Record(f"EC40-like-{seed}", STEP_S, noise * pga_g * GRAVITY / np.abs(noise).max())

    corners = np.geomspace(2.0, 40.0, 60)
    found = [displacement_mm(below(corner)) - sd_mm for corner in corners]
    first = next(k for k in range(len(found) - 1) if found[k] < 0 <= found[k + 1])
    return below(
        brentq(
            lambda corner: displacement_mm(below(corner)) - sd_mm,
            corners[first],
            corners[first + 1],
            xtol=0.01,
        )
    )


def events_of(folder, runs, with_synthetic=False):
    """(Event of each run that has a motion, numbers of these runs)."""
    phases = {name: strong_phase(folder, name) for name in MOTIONS}
    sizes = {name: displacement_mm(record) for name, record in phases.items()}
    loadings = {name: Recorded(record) for name, record in phases.items()}
    events, numbers = [], []
    for run in runs.itertuples():
        if run.rec in loadings:
            events.append(Event(loadings[run.rec], run.sd_T1 / sizes[run.rec], REST_S))
        elif with_synthetic:
            events.append(Event(Recorded(synthetic(run.pga, run.sd_T1, run.run)), 1.0, REST_S))
        else:
            continue
        numbers.append(run.run)
    return events, numbers


# --- runs -----------------------------------------------------------------------------------------


class Watched(Run):
    """A run whose displacements at the sensors are kept: a row a sample in `kept`, of stage number,
    time [s] and displacements [m]."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        z = self.layout.bodies.z[: self.layout.n_bricks]
        self._bodies = [int(np.argmin(np.abs(z - height))) for height in SENSORS_M]
        self._ends, self.kept = [stage.end_step for stage in self.stages], []

    def take_samples(self, now):
        """As of Run."""
        moved = self._motion(now)[:, self._bodies, 0]
        stage = np.searchsorted(self._ends, now.clock)
        self.kept.extend(np.column_stack([stage, now.clock * self.solver.time_step, moved]))
        return super().take_samples(now)


def shaken(case, wall, events, seed):
    """A generator as `simulate` of one draw, which returns its table of events: peak and residual
    [mm] at the sensors, the period after it [s]."""
    model = ModelOptions(contacts="gauss", cells=case.cells, strength_cov=COV, strength_seed=seed)
    settings = RunSettings(
        events[0].loading,
        model,
        events=tuple(events),
        sequence=tuple(event.factor for event in events),
        rest_s=REST_S,
        beta_s=None,
        alpha_1_s=4 * math.pi * case.damping / case.period_s,
        relaxation="adaptive",
        accept_implausible=True,
    )
    settings = settings.for_joint(wall.joint, BACKEND.softening)
    layout = lay_out(wall, model)
    modes = natural_modes(layout)
    settings = settings.for_period(float(modes.period_s[0]))
    step = choose_time_step(settings, modes.critical_time_step_s, wall.joint.softens)
    run = Watched(
        layout, settings, BACKEND.make(layout, step, settings), Buffer(layout), lambda *_: True
    )
    yield from run.come_to_rest()
    run.start()
    yield from run.run_all()
    return table_of(np.array(run.kept), run.collapsed_at_s)


def table_of(kept, collapsed_at_s):
    """Rows of `shaken`: an event is three stages, motion, rest, settling."""
    rows, before = [], np.zeros(len(SENSORS_M))
    for first in range(0, 3 * (int(kept[:, 0].max()) // 3 + 1), 3):
        in_event = kept[(kept[:, 0] >= first) & (kept[:, 0] < first + 3)]
        rest = in_event[in_event[:, 0] == first + 1]
        late = rest[len(rest) // 2 :]
        end = in_event[-1, 2:]
        period = natural_period(late[:, 1], late[:, 4]) if len(late) > 20 else None
        rows.append(
            [
                *1e3 * np.abs(in_event[:, 2:] - before).max(axis=0),
                *1e3 * (end - before),
                *1e3 * end,
                np.nan if period is None else period,
            ]
        )
        before = end
    names = [
        f"{what}_{1e3 * height:.0f}"
        for what in ("peak_mm", "residual_mm", "moved_mm")
        for height in SENSORS_M
    ]
    table = pd.DataFrame(rows, columns=[*names, "period_after_s"])
    table["collapsed"] = False
    table.loc[table.index[-1], "collapsed"] = collapsed_at_s is not None
    return table


def draws_of(cases, events, seeds, numbers, inputs=None):
    """Table of all draws of cases {name: Case}: a row a case, seed and run; inputs: Ranges of what
    is drawn beside the strengths."""
    todo = [(name, seed) for name in cases for seed in seeds]
    walls = {name: fitted(case) for name, case in cases.items()}
    runs = (
        shaken(cases[name], drawn(walls[name], inputs, seed), events, seed) for name, seed in todo
    )
    tables = []
    for number, table in as_they_end(runs, move, 8):
        name, seed = todo[number]
        tables.append(table.assign(case=name, seed=seed, run=numbers[: len(table)]))
        print(f"{name}, draw {seed}: {len(table)} runs", file=sys.stderr, flush=True)
    return pd.concat(tables).sort_values(["case", "seed", "run"], ignore_index=True)


# --- the bearing ----------------------------------------------------------------------------------

STIFFNESSES, FRICTIONS, PLAYS_M = (
    (2e6, 3e6, 5e6),
    (0.05, 0.1, 0.2),
    (3e-3, 10e-3, 20e-3, 40e-3),
)
LOADS_N = 10.35e3, 27e3
"""The two readings of the load."""
PEAKS = ["peak_disp_bot_mm", "peak_disp_mid_mm", "peak_disp_top_mm"]
"""Columns of measured peaks at SENSORS_M."""
MOVED = [f"peak_mm_{1e3 * height:.0f}" for height in SENSORS_M]


def tested_peaks(folder):
    """Measured peaks by run, with the columns of draws."""
    tested = pd.read_csv(folder / "exp_Test9_tilt.csv").set_index("run")[PEAKS]
    return tested.set_axis(MOVED, axis=1)


def bearings(folder):
    """How far the peaks of CHOSEN_ON are from the test by each bearing: root mean square of
    ln(model / test)."""
    events, numbers = events_of(folder, read_runs(folder).loc[list(CHOSEN_ON)])
    tested = tested_peaks(folder).loc[numbers]
    cases = {
        str(case): case for case in starmap(Case, product(LOADS_N, STIFFNESSES, FRICTIONS, PLAYS_M))
    }
    rows = []
    for name, table in draws_of(cases, events, [1], numbers).groupby("case", sort=False):
        if len(table) < len(numbers):  # it fell
            continue
        peaks = table[MOVED].to_numpy()
        apart = np.log(peaks / tested.to_numpy())
        rows.append([*cases[name][:4], np.sqrt(np.mean(apart**2)), *apart.mean(axis=0), *peaks[-1]])
    table = pd.DataFrame(
        rows,
        columns=[
            "load_n",
            "stiffness_n_m",
            "friction",
            "play_m",
            "error",
            *(f"bias_{1e3 * height:.0f}" for height in SENSORS_M),
            *(f"run21_mm_{1e3 * height:.0f}" for height in SENSORS_M),
        ],
    )
    keep(
        table.sort_values(["error", "load_n", "stiffness_n_m", "friction", "play_m"]),
        "us1_bearings",
    )


def chosen():
    """The Case of the bearing of least error, to three digits; of plays that it does not tell
    apart the largest, as no run has met a stop."""
    table = pd.read_csv(TABLES / "benchmarks" / "us1_bearings.csv").round({"error": 3})
    best = table.sort_values(["error", "play_m"], ascending=[True, False]).iloc[0]
    return Case(*best[["load_n", "stiffness_n_m", "friction", "play_m"]])


def keep(table, name, folder=TABLES / "benchmarks"):
    """Write a table; returns its path."""
    path = folder / f"{name}.csv"
    table.to_csv(path, index=False, float_format="%.5g")
    print(path)
    return path


# --- the prediction -------------------------------------------------------------------------------

LAST = 25
"""Run of the second wall alone: the motion of run 22 times 2."""
QUANTILES = 5, 50, 95


def inputs_of(case):
    """Ranges of the inputs that are drawn; the load from one of its readings to the other."""
    return ranges("tested") | {"load": Range(None, *(one / case.load_n for one in LOADS_N))}


def prediction(folder):
    """US-1's runs beside the test, and those of the second wall, with the later bearing."""
    runs = read_runs(folder)
    events, numbers = events_of(folder, runs)
    strongest = events[numbers.index(22)]
    events, numbers = [*events, replace(strongest, factor=2 * strongest.factor)], [*numbers, LAST]
    case = chosen()
    draws = draws_of({"later": case}, events, range(1, DRAWS + 1), numbers, inputs_of(case))
    of_runs = quantiles(draws)
    table = runs[["rec", "sf", "pga", "pgv"]].set_axis(
        ["record", "scale", "pga_g", "pgv_m_s"], axis=1
    )
    keep(table.join([tested_of(folder), of_runs]).reset_index(), "us1_later_prediction")
    second = of_runs.reindex(range(1, LAST + 1)).reset_index(names="run")
    path = keep(second, "us2_later_prediction", TABLES)
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    path.with_suffix(".sha256").write_text(f"{digest}  {path.name}\n")


def tested_of(folder):
    """Measured peaks and residual displacements [mm] and periods before each run [s]."""
    metrics = pd.read_csv(folder / "exp_Test9_metrics.csv").set_index("run")
    period = pd.read_csv(folder / "exp_Test9_period_psd.csv").set_index("run")["T1_best_s"]
    table = tested_peaks(folder).assign(residual_mm=metrics["resid_rel_mm"], period_s=period)
    return table.add_prefix("tested_")


MEASURES = [*MOVED, "residual_mm", "period_s"]


def measures_of(draws):
    """The draws with columns MEASURES: residual at 2.06 m, period before the run.  A wall that fell
    has infinite peaks and no residual."""
    fallen = draws["collapsed"]
    return draws.assign(
        **{name: draws[name].where(~fallen, np.inf) for name in MOVED},
        residual_mm=draws["residual_mm_2060"].where(~fallen),
        period_s=draws.groupby(["case", "seed"])["period_after_s"].shift(),
    )


def quantiles(draws):
    """Quantiles over draws by run of MEASURES, by Weibull's plotting position."""
    return pd.DataFrame.from_dict(
        {
            run: {f"{name}_{q}": _at(of_run[name], q) for name in MEASURES for q in QUANTILES}
            for run, of_run in measures_of(draws).groupby("run")
        },
        orient="index",
    )


def _at(values, share):
    """The value nearest to a quantile [%] by Weibull's plotting position, k / (n + 1); values may
    be infinite."""
    place = share / 100 * (len(values) + 1) - 1
    return np.sort(values)[int(np.clip(np.rint(place), 0, len(values) - 1))]


def heights(folder):
    """By the first bearing and by the later one, the first draw: peaks at the three sensors and
    periods beside the test, and errors of the runs chosen on and of the others."""
    tested = tested_of(folder)
    events, numbers = events_of(folder, read_runs(folder))
    draws = draws_of({"first": Case(), "later": chosen()}, events, [1], numbers)
    found = {
        bearing: measures_of(of).set_index("run")[[*MOVED, "period_s"]]
        for bearing, of in draws.groupby("case")
    }
    table = pd.concat(
        [tested.loc[numbers], *(of.add_prefix(f"{b}_") for b, of in found.items())], axis=1
    )
    table.insert(0, "chosen_on", table.index.isin(CHOSEN_ON).astype(int))
    keep(table.rename_axis("run").reset_index(), "us1_heights")
    rows = []
    for (bearing, of), judges in product(found.items(), (False, True)):
        chosen_on = [run for run in numbers if (run not in CHOSEN_ON) == judges]
        for name in of:
            apart = np.log(of[name] / tested[f"tested_{name}"]).loc[chosen_on].dropna()
            rows.append(
                {
                    "bearing": bearing,
                    "measure": name,
                    "runs": "others" if judges else "chosen on",
                    "n": len(apart),
                    "within_1.5": int((apart.abs() <= math.log(1.5)).sum()),
                    "factor": np.exp(np.sqrt((apart**2).mean())),
                    "bias": np.exp(apart.mean()),
                }
            )
    keep(pd.DataFrame(rows), "us1_errors")


def coverage(folder):
    """CHOICE_RUNS in sequence by draws of all inputs: measured values beside their ranges, and
    beside those of the kept draws of strengths alone with the first bearing."""
    tested = tested_of(folder)
    events, numbers = events_of(folder, read_runs(folder).loc[list(CHOICE_RUNS)])
    every = draws_of({"all": chosen()}, events, range(1, DRAWS + 1), numbers, inputs_of(chosen()))
    first = pd.read_csv(TABLES / "benchmarks" / "us1_first_draws.csv")
    rows = []
    for drawn_of, found in (("strengths", quantiles(first)), ("all", quantiles(every))):
        for name, run in product(MEASURES, CHOICE_RUNS):
            low, middle, high = (found.loc[run, f"{name}_{q}"] for q in QUANTILES)
            if not math.isnan(low):  # the period before the first run
                test = tested.loc[run, f"tested_{name}"]
                rows.append(
                    [drawn_of, name, run, test, low, middle, high, int(low <= test <= high)]
                )
    keep(
        pd.DataFrame(
            rows,
            columns=["drawn", "measure", "run", "tested", "least", "median", "most", "inside"],
        ),
        "us1_coverage",
    )


# --- choices --------------------------------------------------------------------------------------

CHOICES = {
    "as predicted": {},
    "play 10 mm": {"play": 10e-3},
    "top driven": {"stiffness": None},
    "load 27 kN": {"load_n": 27e3},
    "brittle joints": {"softens": False},
    "5 % damping": {"damping": 0.05},
    "friction 0.3": {"friction": 0.3},
    "bearing 1e7 N/m": {"stiffness": 1e7},
    "cohesion 0.15 MPa": {"cohesion": 0.15e6},
    "period 0.08 s": {"period_s": 0.08},
    "4 contact points": {"cells": 4},
}
CHOICE_RUNS = 10, 17, 21, 22, 24
EC40_RUNS = range(1, 13)
"""Runs up to the first one after the last of EC40."""


def choices(folder):
    """What each choice changes with the first bearing: five of the runs in sequence, the first
    draw; and runs 1 to 12 with and without motions like EC40."""
    runs = read_runs(folder)
    events, numbers = events_of(folder, runs.loc[list(CHOICE_RUNS)])
    seeds, rows = [1], []
    for name, change in CHOICES.items():
        of_runs = quantiles(draws_of({name: Case()._replace(**change)}, events, seeds, numbers))
        rows.append(
            {
                "choice": name,
                **{f"peak_mm_{run}": peak for run, peak in of_runs["peak_mm_2060_50"].items()},
                "residual_mm_24": of_runs["residual_mm_50"].get(24),
                "period_s_24": of_runs["period_s_50"].get(24),
            }
        )
        keep(
            pd.DataFrame(
                [
                    {
                        "choice": "test",
                        **{f"peak_mm_{run}": runs["edp"][run] for run in CHOICE_RUNS},
                    },
                    *rows,
                ]
            ),
            "us1_choices",
        )
    tables = {
        with_them: quantiles(draws_of({"prediction": Case()}, found[0], seeds, found[1]))[
            "peak_mm_2060_50"
        ]
        for with_them in (False, True)
        for found in [events_of(folder, runs.loc[list(EC40_RUNS)], with_them)]
    }
    keep(
        pd.DataFrame(
            {"without_mm": tables[False], "with_mm": tables[True], "tested_mm": runs["edp"]}
        )
        .dropna(subset=["with_mm"])
        .rename_axis("run")
        .reset_index(),
        "us1_ec40",
    )


# --- the period -----------------------------------------------------------------------------------

FACES = {1: "an eighth of the thickness at each face", 2: "a quarter", 3: "three eighths"}
"""{contact points lost at each face, of eight: words}."""
SHARES = 0.9, 0.8, 0.7, 0.6, 0.5, 0.4


def weakened(layout, points, n_joints):
    """A Layout whose lowest joints have lost this number of contact points at each face."""
    contacts = layout.contacts
    from_face, height = np.minimum(contacts.x, THICK_M - contacts.x).round(6), contacts.z.round(6)
    lost = np.isin(height, np.unique(height)[:n_joints]) & (
        from_face <= np.unique(from_face)[points - 1]
    )
    return replace(
        layout,
        contacts=replace(
            contacts,
            **{
                name: np.where(lost, 1e-6, 1.0) * getattr(contacts, name)
                for name in ("normal_stiffness", "shear_stiffness")
            },
        ),
    )


def periods(_):
    """How much longer the first period of the strip is by a loss of stiffness; the test's grew by
    13 and 22 %."""
    case = chosen()
    options = ModelOptions(contacts="gauss", cells=case.cells)
    wall = fitted(case)
    stiffness, rows = wall.joint.normal_stiffness, []

    def note(lost, changed, **more):
        period_s = natural_modes(changed, 1).period_s[0]
        rows.append({"lost": lost, **more, "longer_pct": 100 * (period_s / PERIOD_S - 1)})

    for share in SHARES:
        note(
            "stiffness of all joints",
            lay_out(strip(case, share * stiffness), options),
            share_left=share,
        )
    for share in SHARES:
        softer = case._replace(stiffness=share * case.stiffness)
        note(
            "stiffness of the bearing", lay_out(strip(softer, stiffness), options), share_left=share
        )
    for points, words in FACES.items():
        for joints in (1, 5, COURSES + 1):
            note(words, weakened(lay_out(wall, options), points, joints), joints=joints)
    keep(pd.DataFrame(rows).astype({"joints": "Int64"}), "us1_period")


# --- both solvers ---------------------------------------------------------------------------------

OPTIONS = (
    "--rest",
    0.3,
    "--contacts",
    "gauss",
    "--cells",
    8,
    "--strength-cov",
    COV,
    "--accept-implausible",
)


def solvers(folder):
    """Run 21 alone with the first bearing, brittle joints: eight draws in the reference solver; the
    first of them in YADE, with its own time step and with one of 40 microseconds."""
    runs = read_runs(folder)
    (event,), _ = events_of(folder, runs.loc[[21]])
    wall, rows = fitted(Case(softens=False)), []
    with TemporaryDirectory() as made:
        bench, motion = Bench(Path(made)), Path(made) / "run.csv"
        write_csv(scaled(event.loading.record, event.factor), motion, [])
        for run, seed, *more in (
            *((bench.run, seed) for seed in range(1, 9)),
            (bench.run_in_yade, 1),
            (bench.run_in_yade, 1, "--dt", 4e-5),
        ):
            history = run(wall, ["--record", motion, *OPTIONS, "--strength-seed", seed, *more])
            peak = (
                np.abs(history.series["drift_ratio"]).max() * history.attributes["drift_height_m"]
            )
            rows.append(
                {
                    "solver": history.solver,
                    "draw": seed,
                    "time_step_s": history.time_step_s,
                    "peak_mm_middle": 1e3 * peak,
                    "events": len(history.events),
                    "energy_balance_error_pct": 100 * energy_error_of(history),
                }
            )
    keep(pd.DataFrame(rows), "us1_solvers")


PROGRAMS = {
    "bearings": bearings,
    "prediction": prediction,
    "heights": heights,
    "coverage": coverage,
    "choices": choices,
    "period": periods,
    "solvers": solvers,
}


def main():
    parsed = arguments(__doc__, option("folder", type=Path), option("table", choices=PROGRAMS))
    try:
        PROGRAMS[parsed.table](parsed.folder)
    except FileNotFoundError as error:
        print(
            f"error: no file {error.filename}: expected the files that"
            f" docs/validation/shaken-walls.md names; put them into {parsed.folder}",
            file=sys.stderr,
        )
        return 2
    return 0
