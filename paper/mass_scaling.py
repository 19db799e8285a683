"""Tables of docs/validation/step-and-damping.md: walls with softening joints in explicit steps and
with mass scaling.

    python3 -m paper mass_scaling runs DIR [--draws 32] [--cases CASE ...]  # rows of DIR/runs.csv;
                                                                            # continues there
    python3 -m paper mass_scaling table DIR/runs.csv                        # medians, two-sample
                                                                            # tests
    python3 -m paper mass_scaling curves DIR/runs.csv                       # fragility and lives
    python3 -m paper mass_scaling rocking | falling | skipped

A draw is one of the joints' strengths (coefficient of variation 0.3), or a life of the address.
Runs are not repeated where their energy balance is off, so that each step is judged by itself.  A
further case is a line of CASES.
"""

import sys
import time
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import binomtest, ks_2samp

import damage
from damage.applications.studies.fragility import solve
from damage.history.in_memory import HistoryInMemory
from damage.law.modes import natural_modes
from damage.measure.tables import summary_row
from damage.mechanics.tables import FRACTURE, FRICTION, HAS_FAILED
from damage.motion.intensity import pgv_m_s
from damage.reference.session import run_references
from damage.reference.wall import ReferenceWall
from damage.run import monitor, scheme
from damage.run.options import parse_run
from damage.run.schedule import SOFTENING_STEP_FACTOR, STEP_FACTOR
from damage.run.settings import ADAPTIVE_DAMPING, LOCAL_DAMPING, SETTLE_S
from damage.units import GRAVITY
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from damage.wall.parameters import Joint, Wall
from paper.bench import REPOSITORY, arguments, option, print_row, print_table, silenced, wall_file
from paper.softening import softened


def _record(path, *window):
    return [
        "--record",
        str(REPOSITORY / "damage" / "data" / path),
        "--window",
        *window,
        "--rest",
        "0.1",
    ]


BGAR = _record("zeerijp_20180108/BGAR_HGE_acc_m_s2.csv", "18.2", "20.7")
BZN1 = _record("zeerijp_20180108/BZN1_HGE_acc_m_s2.csv", "17.5", "20")
MID1 = _record("huizinge_20120816_synthetic/MID1_N_synthetic_acc_m_s2.csv", "0.8", "2.5")
LIFE = [
    "--address",
    str(REPOSITORY / "studies" / "addresses" / "garsthuizen.toml"),
    "--rest",
    "0.1",
]
DEFORM, SETTLED = (
    ["--bricks", "deformable", "--contacts", "gauss"],
    [
        "--settle",
        "hogging",
        "--distortion",
        "1/600",
    ],
)
SYMMETRIC, ASYMMETRIC, SOLID = (
    f"walls/variants/{name}_softening.py" for name in ("symmetric", "asymmetric", "solid")
)
CASES = {
    **{
        f"symmetric_mid1_{scale}": (SYMMETRIC, [*MID1, "--scale", scale])
        for scale in ("1", "1.5", "2", "3", "3.5")
    },
    "symmetric_mid1": (SYMMETRIC, [*MID1, "--scale", "2.5"]),
    "symmetric_bgar": (SYMMETRIC, [*BGAR, "--scale", "2.5"]),
    "symmetric_bzn1": (SYMMETRIC, [*BZN1, "--scale", "3"]),
    "symmetric_harmonic": (SYMMETRIC, ["--harmonic", "0.2", "0.05", "--rest", "0.1"]),
    "symmetric_settled": (SYMMETRIC, [*SETTLED, *MID1, "--scale", "1.5"]),
    "symmetric_sequence": (SYMMETRIC, [*MID1, "--scale", "2", "--sequence", "1,0.8,1,0.6"]),
    "symmetric_life": (SYMMETRIC, LIFE),
    "symmetric_pushed": (SYMMETRIC, ["--cyclic", "0.05,0.1", "--speed", "0.01"]),
    "asymmetric_mid1": (ASYMMETRIC, [*MID1, "--scale", "2.5"]),
    "asymmetric_bgar": (ASYMMETRIC, [*BGAR, "--scale", "2.5"]),
    "terrace_bgar": ("walls/terrace_end.toml", [*BGAR, "--scale", "2"]),
    "house_mid1": ("walls/two_storeys.toml", [*MID1, "--scale", "1.5"]),
    "front_settled": ("paper/claim_walls/front_S.toml", [*SETTLED, *BGAR, "--scale", "2"]),
    "solid_harmonic": (SOLID, ["--harmonic", "0.1", "0.3", "--rest", "0.1"]),
    "solid_mid1": (SOLID, [*MID1, "--scale", "4"]),
    "deformable_mid1": (SYMMETRIC, [*MID1, "--scale", "2.5", *DEFORM]),
    "deformable_bgar": (SYMMETRIC, [*BGAR, "--scale", "2.5", *DEFORM]),
    "deformable_asymmetric": (ASYMMETRIC, [*MID1, "--scale", "2.5", *DEFORM]),
}
"""{case: (wall file, words)}."""
SCHEMES = {
    "explicit": ["--mass-scaling", "none", "--settling", "adaptive"],
    **{
        step: ["--mass-scaling", "selective", "--dt", step]
        for step in ("2e-4", "1e-4", "5e-5", "4e-4")
    },
    "half": ["--mass-scaling", "none", "--settling", "adaptive"],
    "large": ["--mass-scaling", "none", "--settling", "adaptive"],
    "lintels": ["--mass-scaling", "lintels", "--settling", "adaptive"],
    "local": ["--mass-scaling", "none"],
}
"""{scheme: its words}; half: half of the explicit step; large: explicit steps in which runs are
repeated first; lintels: longer ones with scaled lintels; local: explicit as by default,
with local damping in settling stages."""
FACTORS = {"half": 0.5 * SOFTENING_STEP_FACTOR, "large": STEP_FACTOR}
"""{scheme: its step over the critical one}."""
FIRST = "half", "local", "4e-4"
"""Schemes of the first eight draws alone."""
COMPARED = {
    "max_DI": "max DI",
    "max_drift_ratio": "drift",
    "residual_DI": "residual DI",
    "max_psi": "Psi",
    "max_crack_width_mm": "widest crack",
    "failed_length_m": "failed length",
}
FIELDS = [
    "case",
    "scheme",
    "draw",
    "cpu_s",
    *COMPARED,
    "settled_psi",
    "energy_error_fraction",
    "collapsed_at_s",
]


@cache
def _wall(name):
    """The damage.Wall of a case's file, of one with brittle joints with fracture energies by the
    rule."""
    made = load_wall(REPOSITORY / name)
    return made if made.joint.softens else softened(made, "rule")


def runs(folder, draws, names):
    """Append rows of all cases, draws and schemes that runs.csv lacks."""
    scheme.ACCEPTED_ERROR = monitor.ACCEPTED_DROP_M = np.inf
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "runs.csv"
    done = (
        set(map(tuple, pd.read_csv(path)[FIELDS[:3]].astype(str).to_numpy()))
        if path.is_file()
        else ()
    )
    for start, case, way in product(range(1, 1 + draws, 8), names, SCHEMES):
        asked = [
            draw
            for draw in range(start, min(start + 8, draws + 1))
            if (case, way, str(draw)) not in done
        ]
        wanted = (
            way in ("explicit", "5e-5")
            if "deformable" in case
            else (
                way != "5e-5"
                and not (start > 1 and way in FIRST)
                and (way != "lintels" or case == "front_settled")  # of beams
            )
        )
        if asked and wanted:
            rows = _batch(folder, case, way, asked)
            rows.to_csv(path, mode="a", header=not path.is_file(), index=False, float_format="%.5g")
            print(case, way, len(rows), f"{rows['cpu_s'].iloc[0]:.2f} s a run", flush=True)


def _batch(folder, case, way, draws):
    """Rows of a case with a scheme, one a draw."""
    wall, words = CASES[case]
    step = (
        ["--dt", repr(FACTORS[way] * _modes(wall).critical_time_step_s)] if way in FACTORS else []
    )
    source = wall_file(folder / f"{Path(wall).stem}.toml", _wall(wall))
    lines = {
        draw: [
            str(source),
            *words,
            *SCHEMES[way],
            *step,
            "--strength-cov",
            "0.3",
            *(["--life", str(draw)] if words is LIFE else ["--strength-seed", str(draw)]),
            "--no-pictures",
            "--overwrite",
            "--out",
            str(folder / f"{case}_{way}_{draw}.h5"),
        ]
        for draw in draws
    }
    histories = dict.fromkeys(lines, HistoryInMemory)
    begun = time.process_time()
    with silenced() as said:
        statuses = dict(run_references(lines.items(), histories))
    if any(statuses.values()):
        sys.exit(f"{case} {way}: a run failed, or was interrupted\n{said.getvalue()[-2000:]}")
    spent = (time.process_time() - begun) / len(draws)
    rows = []
    for draw in draws:
        history = histories[draw].history()
        failed = {"failed_length_m": float(history.joint_length_m[history.broken[-1]].sum())}
        rows.append(
            {
                "case": case,
                "scheme": way,
                "draw": draw,
                "cpu_s": spent,
                **summary_row(history),
                **failed,
            }
        )
    return pd.DataFrame(rows)[FIELDS]


@cache
def _modes(wall):
    return natural_modes(lay_out(_wall(wall)))


def table(path):
    """Print medians of each step beside explicit ones, and the least p of two-sample tests over the
    measures."""
    found = pd.read_csv(path)
    print_table(
        "wall and motion",
        "step",
        "by the rule",
        "draws",
        *(f"{words} [%]" if words != "residual DI" else words for words in COMPARED.values()),
        "DI of a run [%]",
        "least p",
        "energy error [%]",
        "time [s]",
        "explicit [s]",
    )
    for case, way in product(CASES, SCHEMES):
        own, other = (
            found[(found["case"] == case) & (found["scheme"] == one)].set_index("draw")
            for one in (way, "explicit")
        )
        if not len(own):
            continue
        other = other.loc[own.index]
        error = 100 * own["energy_error_fraction"]
        tests = [ks_2samp(own[name], other[name]).pvalue for name in COMPARED]
        apart = (own["max_DI"] / other["max_DI"] - 1).abs().median()
        print_row(
            case.replace("_", " "),
            way,
            "yes" * (way == _by_the_rule(case)),
            len(own),
            *(_difference(own[name].median(), other[name].median(), name) for name in COMPARED),
            f"{100 * apart:.1f}",
            f"{min(tests):.2f}",
            f"{error.median():.3f} to {error.max():.3f}",
            f"{own['cpu_s'].median():.2f}",
            f"{other['cpu_s'].median():.2f}",
        )


def _by_the_rule(case):
    """The step with mass scaling of a case where nothing is asked for, None of an explicit one."""
    wall, words = CASES[case]
    settings = parse_run(
        [*words, *(["--life", "1"] if words is LIFE else [])], "", "reference"
    ).for_joint(_wall(wall).joint)
    (settings, step_s), *_ = scheme.schemes(settings, _wall(wall), _modes(wall))
    return next(
        (
            step
            for step in SCHEMES
            if settings.mass_scaling == "selective"
            and step[1:] in ("e-4", "e-5")
            and np.isclose(float(step), step_s, rtol=0.01)
        ),
        None,
    )


def _difference(value, other, name):
    """A median as the table has it: of residual DI itself, of the others what it is above the
    explicit one [%]."""
    return (
        f"{value:.4f}"
        if name == "residual_DI"
        else "0"
        if value == other
        else f"{100 * (value / other - 1):+.1f}"
    )


def curves(path):
    """Print medians and dispersions of fragility over the PGV of records, and the shares of lives,
    by both steps, with 95 % intervals: by 500 replicates of the draws, and Wilson's."""
    found = pd.read_csv(path)
    pgv = {
        case: 1e3 * pgv_m_s(parse_run(words, "", "reference").loading.applied())
        for case, (wall, words) in CASES.items()
        if wall == SYMMETRIC
        and words[0] == "--record"
        and not {"--sequence", "--bricks"} & set(words)
    }
    print_table("exceeding", "step", "median [mm/s]", "dispersion")
    for (measure, level), way in product(
        (("max_DI", 0.1), ("max_psi", 2.5)), ("explicit", "1e-4", "2e-4")
    ):
        chosen = found[(found["scheme"] == way) & found["case"].isin(pgv)]
        over = chosen.assign(over=chosen[measure] >= level).pivot(
            index="draw", columns="case", values="over"
        )
        drawn = np.random.default_rng(1).integers(len(over), size=(500, len(over)))
        intensity = np.array([pgv[case] for case in over.columns])
        fits = np.array(
            [
                solve(
                    intensity, over.iloc[rows].sum().to_numpy(), np.full(len(intensity), len(over))
                )[:2]
                for rows in (range(len(over)), *drawn)
            ]
        )
        low, high = np.quantile(fits[1:], (0.025, 0.975), axis=0)
        print_row(
            f"{measure} {level:g}",
            way,
            *(
                f"{value:.{digits}f} ({a:.{digits}f} to {b:.{digits}f})"
                for value, a, b, digits in zip(fits[0], low, high, (1, 2))
            ),
        )
    print_table("lives with", "step", "share")
    for (measure, level), way in product(
        (("max_psi", 1.0), ("max_psi", 2.0), ("max_DI", 0.05)), ("explicit", "1e-4", "2e-4")
    ):
        lives = found[(found["case"] == "symmetric_life") & (found["scheme"] == way)]
        count = int((lives[measure] >= level).sum())
        interval = binomtest(count, len(lives)).proportion_ci(method="wilson")
        print_row(
            f"{measure} {level:g}",
            way,
            f"{count} of {len(lives)} ({interval.low:.2f} to {interval.high:.2f})",
        )


def rocking():
    """Print free rocking of a pier whose base, or whose every joint, is dry, released with a speed
    of its top."""
    plain = Wall(
        "pier",
        4.5 * 0.225,
        33 * 0.075,
        precompression=0.3e6,
        joint=Joint(tensile_strength=0.21e6, cohesion=0.24e6),
    )
    print_table(
        "dry joints",
        "step",
        "peak [mm]",
        "second upward crossing [s]",
        "last peak [mm]",
        "friction [J]",
        "of kinetic energy [J]",
        "imbalance [J]",
    )
    for name, speed in (("base", 0.25), ("all", 0.15)):
        layout = lay_out(plain)
        dry = (layout.contacts.first < 0) | (name == "all")
        layout = replace(
            layout,
            contacts=replace(
                layout.contacts,
                **{
                    strength: np.where(dry, 0.0, getattr(layout.contacts, strength))
                    for strength in ("tensile_strength", "cohesion")
                },
            ),
        )
        modes = natural_modes(layout)
        for step in (0.643 * modes.critical_time_step_s, 1e-4, 2e-4):
            print_row(
                name,
                f"{step:.3g}",
                *_rocked(layout, step, step > modes.critical_time_step_s, speed * modes.shape[0]),
            )


def _rocked(layout, step, scaled, velocity):
    """Cells of a row of `rocking`."""
    wall = ReferenceWall(layout, step, scaled=slice(None) if scaled else None)
    wall.adaptive_damping = 1.0
    wall.start(np.zeros((0, 2)), GRAVITY * np.linspace(0.0, 1.0, round(0.2 / step)))
    wall.run(round(0.5 / step))
    wall.adaptive_damping = 0.0
    wall.start(np.zeros((0, 2)))
    wall.energy[:] = 0.0
    wall.velocity = velocity
    rest, kinetic, before = wall.displacement, wall.kinetic_energy(), _stored(wall, layout)
    every, top = round(2e-3 / step), []
    for _ in range(1250):
        wall.run(every)
        top.append(1e3 * (wall.displacement - rest)[layout.drift_bodies, 0].mean())
    top, time_s = np.array(top), np.arange(1, 1251) * every * step
    rises = np.flatnonzero((top[:-1] < 0) & (top[1:] >= 0))
    imbalance = _stored(wall, layout) - before + wall.energy[FRICTION] + wall.energy[FRACTURE]
    return (
        f"{np.abs(top).max():.2f}",
        f"{time_s[rises[1]]:.3f}",
        f"{np.abs(top[-312:]).max():.2f}",
        f"{wall.energy[FRICTION]:.1f}",
        f"{kinetic:.1f}",
        f"{imbalance:.3f}",
    )


def _stored(wall, layout):
    return (
        wall.kinetic_energy()
        + wall.elastic_energy()
        + GRAVITY * float(layout.bodies.mass @ wall.displacement[:, 1])
    )


def falling():
    """Print when a spandrel without a lintel falls: explicitly, with mass scaling alone, and as a
    user gets it."""
    accepted = monitor.ACCEPTED_DROP_M
    print_table("draw", "explicit [s]", "mass scaling alone [s]", "as offered [s]", "repeated for")
    for draw in range(1, 9):
        times = []
        for limit, words in (
            (accepted, {"mass_scaling": "none"}),
            (np.inf, {"mass_scaling": "selective"}),
            (accepted, {}),
        ):
            monitor.ACCEPTED_DROP_M = limit
            history = damage.run(
                str(REPOSITORY / SYMMETRIC),
                BGAR[1],
                window=(18.2, 20.7),
                scale=2.5,
                rest=0.1,
                lintel="none",
                strength_cov=0.3,
                strength_seed=draw,
                **words,
            )
            times.append(history.collapsed_at_s)
        print_row(
            draw,
            *("stands" if one is None else f"{one:.3f}" for one in times),
            history.parameters["repeated_for"],
        )


def skipped():
    """Print what events that leave a wall intact would have to share to need no steps: motions of
    lives that are equal, and the wall after such an event, BGAR at two factors, and before it."""
    lives = pd.read_csv(REPOSITORY / "docs" / "tables" / "lives" / "lives.csv", comment="#")
    print_table("lives", "events", "different motions")
    for point, events in lives.groupby("point"):
        print_row(point, len(events), len(events.drop_duplicates(["record", "scale"])))
    layout = lay_out(load_wall(REPOSITORY / "walls" / "symmetric.py"))
    print_table(
        "step",
        "damping in settling",
        "factor",
        "largest motion [mm]",
        "after settling [mm]",
        "1 s later [mm]",
        "nonlinear share of the motion",
    )
    explicit = STEP_FACTOR * natural_modes(layout).critical_time_step_s
    for step, damping in ((explicit, "local"), (explicit, "adaptive"), (2e-4, "adaptive")):
        moved = {factor: _shaken(layout, step, damping, factor) for factor in (0.1, 0.2)}
        share = np.abs(2 * moved[0.1][0] - moved[0.2][0]).max() / np.abs(moved[0.2][0]).max()
        for factor, (motion, *later) in moved.items():
            print_row(
                f"{step:.2g}",
                damping,
                factor,
                *(f"{1e3 * np.abs(one).max():.2g}" for one in (motion, *later)),
                f"{share:.1g}",
            )


def _shaken(layout, step, damping, factor):
    """Displacements (n_bodies, 3) of an intact wall from rest [m, m, rad]: 2 s into BGAR times a
    factor, after settling, 1 s later."""
    wall = ReferenceWall(layout, step, scaled=slice(None) if step >= 1e-4 else None)
    wall.adaptive_damping = ADAPTIVE_DAMPING
    wall.start(np.zeros((0, 2)), GRAVITY * np.linspace(0.0, 1.0, round(0.2 / step)))
    wall.run(round(1.5 / step))
    wall.adaptive_damping, rest, found = 0.0, wall.displacement, []
    motion = parse_run([*BGAR, "--scale", repr(factor)], "", "reference").loading
    wall.start(motion.drive.base(np.arange(round(motion.duration_s / step)) * step))
    rest_s = 0.1
    for stage, length_s in (
        ("motion", 2.0),
        ("rest", motion.duration_s - 2.0 + rest_s),
        ("settling", SETTLE_S),
        ("later", 1.0),
    ):
        if stage == "settling":
            wall.adaptive_damping, wall.local_damping = (
                (ADAPTIVE_DAMPING, 0.0) if damping == "adaptive" else (0.0, LOCAL_DAMPING)
            )
        wall.run(round(length_s / step))
        found.append(wall.displacement - rest)
    if (wall.system.limits[:, HAS_FAILED] > 0).any():
        sys.exit(f"joints failed at {factor} of BGAR: expected an intact wall")
    return found[0], *found[2:]


def main():
    parsed = arguments(
        __doc__,
        option("what", choices=("runs", "table", "curves", "rocking", "falling", "skipped")),
        option("path", type=Path, nargs="?", default=Path("results/mass_scaling/runs.csv")),
        option("--cases", nargs="+", choices=CASES, default=list(CASES)),
        option("--draws", type=int, default=32),
    )
    if parsed.what == "runs":
        runs(
            parsed.path if parsed.path.suffix != ".csv" else parsed.path.parent,
            parsed.draws,
            parsed.cases,
        )
    else:
        globals()[parsed.what](*[parsed.path] * (parsed.what in ("table", "curves")))
