"""Selection of samples of a run for the moving picture and for lines over time."""

import numpy as np

from damage.index import COMPONENTS

MOST_INSTANTS = 300
"""Instants of the moving picture of a run, the special ones aside."""
MOST_POINTS = 6000
"""Points of a line over time; of a longer run the smallest and largest of each stretch are kept."""


def instants(history, index):
    """Samples of a History that its moving picture shows, rising: snapshots, evenly chosen, and the special ones.

    index: `History.index` of it.
    """
    time_s = history.series["time_s"].to_numpy()
    at_snapshots = np.searchsorted(time_s, history.snapshot_time_s).clip(0, len(time_s) - 1)
    every = at_snapshots if len(at_snapshots) else np.arange(len(time_s))
    chosen = every[np.linspace(0, len(every) - 1, min(len(every), MOST_INSTANTS)).round().astype(int)]
    return np.unique(np.concatenate([chosen, special_samples(history, index)]))


def special_samples(history, index):
    """Samples of a History with an extreme value, of the first failure, the collapse, the first and the last one."""
    series, time_s = history.series, history.series["time_s"].to_numpy()
    drift = np.nan_to_num(series["drift_ratio"].to_numpy())
    found = [0, len(time_s) - 1, *(int(np.argmax(index[name])) for name in COMPONENTS), int(np.argmax(drift)),
             int(np.argmin(drift)), int(np.argmax(np.abs(np.nan_to_num(series["base_shear_n"])))),
             *(int(np.argmax(np.abs(field).max(axis=1)))
               for field in (history.opening_m, history.slip_by("displacement")))]
    moments = [history.collapsed_at_s, *history.events["time_s"][history.events["time_s"] >= 0][:1]]
    found += [int(np.argmin(np.abs(time_s - moment))) for moment in moments if moment is not None]
    return np.array(found)


def points(lines, needed):
    """Samples that lines over time are drawn from, rising: all, or extremes of stretches, and those needed.

    lines: (n_lines, n_times); needed: samples.
    """
    n_times = lines.shape[1]
    if n_times <= MOST_POINTS:
        return np.arange(n_times)
    stretches = max(MOST_POINTS // (2 * len(lines)), 1)
    edges = np.linspace(0, n_times, stretches + 1).astype(int)
    lines = np.nan_to_num(lines)
    extremes = [first + pick(lines[:, first:last], axis=1) for first, last in zip(edges, edges[1:])
                for pick in (np.argmin, np.argmax)]
    return np.unique(np.concatenate([*extremes, needed]))
