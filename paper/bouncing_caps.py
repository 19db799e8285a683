"""Joints that break in the rest after a motion: a table of docs/paper/open-points.md.

    python3 -m paper bouncing_caps [--out DIR]

walls/symmetric.py in the reference solver, two cycles of 0.2 s and 0.075 g and 3 s of rest, with
smaller steps, with damping, with other masses on top.  Histories that are already in DIR are not
run again.
"""

from pathlib import Path

import numpy as np

from paper.bench import Bench, arguments, option, print_row, print_table

MOTION = ["--harmonic", "0.2", "0.075", "--cycles", "2", "--rest", "3"]
VARIANTS = {
    "as shipped": [],
    "half the step": ["--dt", "1.5e-5"],
    "a quarter of it": ["--dt", "0.75e-5"],
    "β 1e-6 s": ["--beta", "1e-6"],
    "0.2 % at 5 and 20 Hz": ["--rayleigh", "0.002", "5", "20"],
    "1 % at 5 and 20 Hz": ["--rayleigh", "0.01", "5", "20"],
    "mass spread": ["--top", "uniform"],
    "loading beam": ["--top", "beam"],
}
LATE_S, END_S = 1.0, 3.4
BREAKS = ("tension", "shear")


def frequency_hz(time_s, value):
    """Of the largest part of a vibration over 15 Hz, where caps bounce."""
    step_s = np.median(np.diff(time_s))
    even = np.interp(np.arange(time_s[0], time_s[-1], step_s), time_s, value - value.mean())
    size, frequency = (
        np.abs(np.fft.rfft(even * np.hanning(len(even)), 8192)),
        np.fft.rfftfreq(8192, step_s),
    )
    return frequency[frequency > 15][np.argmax(size[frequency > 15])]


def row_of(name, history):
    """Breaks early and late, swing of gravity's energy, its frequency, and breaks while it is above
    zero."""
    series, events = history.series, history.events
    breaks = events[events["kind"].isin(BREAKS) & (events["time_s"] <= END_S)]
    late = breaks[breaks["time_s"] > LATE_S]
    time_s, gravity_j = (series[one].to_numpy() for one in ("time_s", "gravity_energy_j"))
    rest = (time_s > LATE_S) & (time_s <= END_S)
    above = (np.interp(late["time_s"], time_s, gravity_j) > 0).mean() if len(late) else np.nan
    sway = series["top_displacement_m"].to_numpy()
    return [
        name,
        len(breaks) - len(late),
        len(late),
        f"{gravity_j[rest].min():.0f} to {gravity_j[rest].max():.0f}",
        f"{frequency_hz(time_s[rest], gravity_j[rest]):.1f}",
        f"{1e3 * np.ptp(sway[rest]) / 2:.2f}",
        f"{above:.0%}" if len(late) >= 10 else "-",
        f"{(gravity_j[rest] > 0).mean():.0%}",
    ]


def main():
    asked = arguments(
        __doc__, option("--out", type=Path, default=Path("results/bouncing_caps"), metavar="DIR")
    )
    bench = Bench(asked.out)
    print_table(
        "variant",
        f"joints' breaks up to {LATE_S:g} s",
        f"from then to {END_S:g} s",
        "swing of gravity's energy then [J]",
        "at [Hz]",
        "sway [mm]",
        "late breaks with caps above rest",
        "of the time they are",
    )
    for name, words in VARIANTS.items():
        print_row(*row_of(name, bench.run("symmetric", [*MOTION, *words], name)))
