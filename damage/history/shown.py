"""A History in a line, and as a small table for notebooks."""

from html import escape

from damage.units import rounded


def in_a_line(history):
    """One line on a History, its `repr`."""
    return (f"<History {history.wall}, {history.loading.name}, {history.solver} solver: {how_it_ended(history)}, "
            f"{_samples(history)}>")


def as_html(history):
    """A History as HTML for notebooks: a table with its wall, motion, end, index and largest drift."""
    rows = [("wall", history.wall), ("motion", history.loading.name), ("solver", history.solver),
            ("run", f"{how_it_ended(history)}, {_samples(history)}")]
    if len(history.series):
        index, drift = history.index()["DI"], history.series["drift_ratio"].abs().max()
        residual = f", residual {index.iloc[-1]:.3f}" if history.complete else ""
        rows += [("damage index", f"maximum {index.max():.3f}{residual}"),
                 ("drift ratio", f"up to {rounded(100 * drift, 3)} %"),
                 ("failures", f"{_failures(history)} of {len(history.joints)} contact points")]
    cells = "".join(f"<tr><th>{escape(name)}</th><td>{escape(str(value))}</td></tr>" for name, value in rows)
    return f"<table><caption>History</caption>{cells}</table>"


def how_it_ended(history):
    """The status, and when the wall collapsed, where it did."""
    fell = history.collapsed_at_s
    return history.status if fell is None else f"{history.status}, collapsed at {fell:.3f} s"


def _samples(history):
    time_s = history.series["time_s"]
    return f"{len(time_s)} samples" + (f" to {time_s.iloc[-1]:.3f} s" if len(time_s) else "")


def _failures(history):
    """Contact points whose bond has failed."""
    return int(history.states.broken[-1].sum())
