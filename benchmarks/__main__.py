"""Speed and size, as ratios in one run: python3 -m benchmarks [PIECE ...]

PIECE, all of them by default, at most half an hour on a quiet core:

    speed       the reference solver beside YADE, one second of motion, intact and cracked
    kernel      the compiled step beside that of before joints could soften, lanes, and against
                the wall's size
    studies     members in lanes beside one after another, a study's time outside the kernel,
                processes, bytes a run
    memory      largest memory of a run in either solver, and of eight together

Each piece is a script beside this one, which says more and runs alone.  What needs YADE is passed
over by name where there is none.  Exit status: 1 where a piece failed, else 0.
"""

import argparse
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from yade_scripts import COMMAND

PIECES = {
    "speed": (sys.executable, "benchmarks/speed.py"),
    "kernel": (sys.executable, "benchmarks/kernel.py", "--sizes"),
    "studies": (sys.executable, "benchmarks/studies.py"),
    "memory": None,
}
RUN = (
    "walls/symmetric.py",
    "--harmonic",
    "0.2",
    "0.05",
    "--rest",
    "0.1",
    "--no-pictures",
    "--overwrite",
    "--quiet",
)
EIGHT = (
    "from damage.reference.session import run_references; import sys; words, out = sys.argv[2:],"
    " sys.argv[1]; list(run_references((str(k), [*words, '--out', f'{out}/{k}.h5']) for k in"
    " range(8)))"
)


def main():
    parser = argparse.ArgumentParser(
        prog="python3 -m benchmarks",
        description=__doc__.splitlines()[0],
        epilog="see the head of benchmarks/__main__.py",
    )
    parser.add_argument(
        "piece", nargs="*", metavar="PIECE", help=f"{', '.join(PIECES)}; all of them by default"
    )
    asked = parser.parse_args()
    for piece in {*asked.piece} - {*PIECES}:
        parser.error(f"{piece}: expected {', '.join(PIECES)}")
    print(
        f"{_processor()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}; Python"
        f" {platform.python_version()}"
    )
    return 1 if [piece for piece in asked.piece or PIECES if not works(piece)] else 0


def _processor():
    names = (
        [
            line.partition(":")[2].strip()
            for line in Path("/proc/cpuinfo").read_text().splitlines()
            if line.startswith("model name")
        ]
        if Path("/proc/cpuinfo").is_file()
        else []
    )
    return names[0] if names else platform.processor()


def works(piece):
    """Run a piece; whether it did."""
    print(f"\n== {piece}", flush=True)
    if piece == "memory":
        return memory()
    return subprocess.run(PIECES[piece], cwd=ROOT, env=_environment()).returncode == 0


def memory():
    """Print the largest memory of some runs, each a process of its own; whether all did."""
    statuses = []
    with tempfile.TemporaryDirectory() as folder:
        out = ("--out", f"{folder}/one.h5")
        ways = {
            "reference solver, one run": (sys.executable, "-m", "damage", "reference", *RUN, *out),
            "reference solver, eight together": (sys.executable, "-c", EIGHT, folder, *RUN),
        }
        if shutil.which("yade"):
            ways["YADE, one run"] = (*COMMAND, *RUN, *out)
        for name, words in ways.items():
            process = subprocess.Popen(
                words, cwd=ROOT, env=_environment(), stdout=subprocess.DEVNULL
            )
            _, status, used = os.wait4(process.pid, 0)
            print(
                f"{name}: {used.ru_maxrss / 1e3:.0f} MB"
                + (f", exit status {status}" if status else ""),
                flush=True,
            )
            statuses.append(status)
        sizes = [path.stat().st_size / 1e6 for path in Path(folder).glob("*.h5")]
        print(f"a history of these: {sum(sizes) / max(len(sizes), 1):.2f} MB")
    return not any(statuses)


def _environment():
    return {**os.environ, "PYTHONPATH": str(ROOT), "PYTHONNOUSERSITE": "1", "MPLBACKEND": "Agg"}


if __name__ == "__main__":
    sys.exit(main())
