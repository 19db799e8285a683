"""Cost of a history's checksum: the seal in use, and HDF5's Fletcher filter as the alternative.

    python3 benchmarks/seal_cost.py [WALL.py] [OPTIONS OF A RUN]

runs the wall in the reference solver (walls/symmetric.py, 0.2 s, 0.05 g, 1 s of rest) and prints
seconds of the run, of sealing and of checking its history, and the sizes, as shares of the run's.
Best of five, in one process.
"""

import sys
import tempfile
import timeit
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from damage.history.head import HEAD_BYTES, check_seal, read_head, seal
from damage.history.reader import read_history
from damage.reference.session import run_reference

USUAL = [str(ROOT / "walls" / "symmetric.py"), "--harmonic", "0.2", "0.05", "--rest", "1"]


def main():
    """Measure and print."""
    words = sys.argv[1:] or USUAL
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.h5"
        run_s = best(
            lambda: run_reference([*words, "--out", str(path), "--no-pictures", "--overwrite"]),
            repeat=2,
        )  # the first one may compile
        size = path.stat().st_size
        seal_s, check_s, read_s = (
            best(work)
            for work in (
                lambda: seal(path),
                lambda: check_seal(path, read_head(path)),
                lambda: read_history(path),
            )
        )
        rewritten = {
            filters: rewrite(path, Path(folder) / "b.h5", filters) for filters in (False, True)
        }
    print(f"run {run_s:.2f} s, {size / 1e6:.2f} MB")
    print(
        f"sealing {1e3 * seal_s:.2f} ms, {100 * seal_s / run_s:.3f} % of the run; head {HEAD_BYTES}"
        f" bytes, {100 * HEAD_BYTES / size:.3f} % of the file"
    )
    print(f"checking {1e3 * check_s:.2f} ms, {100 * check_s / read_s:.1f} % of reading the history")
    (plain_s, plain), (checked_s, checked) = rewritten[False], rewritten[True]
    print(
        f"Fletcher filter on the data alone: {1e3 * (checked_s - plain_s):.2f} ms more for writing"
        f" them, {100 * (checked - plain) / size:.3f} % of the file"
    )


def best(work, repeat=5):
    """How long it takes at least [s]."""
    return min(timeit.repeat(work, number=1, repeat=repeat))


def rewrite(path, other, fletcher):
    """(seconds, bytes) of writing all datasets that grow again, with or without the filter."""
    with h5py.File(path) as file:
        data = [
            (item.name, item[()], item.chunks)
            for group in ("series", "frames", "events", "snapshots")
            for item in file[group].values()
        ]

    def work():
        with h5py.File(other, "w", libver="latest") as new:
            for name, values, chunks in data:
                new.create_dataset(
                    name,
                    data=values,
                    chunks=chunks,
                    maxshape=(None, *values.shape[1:]),
                    shuffle=True,
                    compression="gzip",
                    compression_opts=2,
                    fletcher32=fletcher,
                )

    return best(work), other.stat().st_size


if __name__ == "__main__":
    main()
