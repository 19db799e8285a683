"""Makes the wheel and tries it in empty environments: Python 3.11 to 3.13, oldest and newest
versions of what it needs.

    python3 scripts/installed.py [--python 3.12] [--versions oldest|newest]

Each environment gets the wheel and packages from a package index, wheels alone, and in a folder
elsewhere runs the reference solver, index, pictures, a table, exports and a film; prints a line
each.  A Python is looked for on PATH and among pyenv's; one that is not there is skipped by name.
Exit status: 1 where one failed, else 0.

What takes time is to fetch and unpack 0.4 GB of packages and to compile the solver in each
environment; on stderr a line a step says how far it is.
"""

import argparse
import glob
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OLDEST = {
    "3.11": (
        "numpy==1.24.0",
        "scipy==1.10.0",
        "pandas==1.5.1",
        "h5py==3.8.0",
        "matplotlib==3.6.0",
        "numba==0.57.0",
    ),
    "3.12": (
        "numpy==1.26.0",
        "scipy==1.11.2",
        "pandas==2.1.1",
        "h5py==3.10.0",
        "matplotlib==3.8.0",
        "numba==0.59.0",
    ),
    "3.13": (
        "numpy==2.1.0",
        "scipy==1.14.1",
        "pandas==2.2.3",
        "h5py==3.12.1",
        "matplotlib==3.9.2",
        "numba==0.61.0",
    ),
}
"""The oldest that pyproject.toml allows and that have wheels for this Python."""
VERSIONS = ("oldest", "newest")
LIMIT_S = 900
"""Limit of one command [s]: what takes longer has failed."""
WALL = 'from damage import Wall\n\n\ndef wall():\n    return Wall("pier", length=0.9, height=0.9)\n'
NEEDS = "numpy scipy pandas h5py matplotlib numba"
WHERE = """
import sys, damage, importlib.metadata as installed
from pathlib import Path
folder = Path(damage.__file__).parent
assert folder.is_relative_to(sys.prefix), f"{folder} is not the installed package"
assert (folder / "py.typed").is_file(), "types are missing"
assert list(folder.glob("data/*/*.csv")), "data are missing"
assert installed.version("masonry-damage") == damage.__version__
print(" ".join(f"{name} {installed.version(name)}" for name in sys.argv[1].split()))
"""


class Failed(Exception):
    """A command failed; the message is its last line."""


def main():
    """Try all that are asked for; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--python", action="append", choices=OLDEST, help="one of them (default: all)"
    )
    parser.add_argument(
        "--versions", action="append", choices=VERSIONS, help="one of them (default: both)"
    )
    asked = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        wheel = make_wheel(Path(folder))
        print(f"wheel: {wheel.name}, {wheel.stat().st_size / 1e6:.2g} MB", flush=True)
        went_well = [
            works(wheel, version, kind)
            for version in asked.python or OLDEST
            for kind in asked.versions or VERSIONS
        ]
    return 0 if all(went_well) else 1


def works(wheel, version, kind):
    """Try the wheel on a Python with the oldest or the newest packages and print the result; False
    where it failed."""
    python = find_python(version)
    began = time.monotonic()
    if python is None:
        print(
            f"Python {version}, {kind}: skipped, there is no Python {version} on this machine",
            flush=True,
        )
        return True
    try:
        result = try_wheel(wheel, python, OLDEST[version] if kind == "oldest" else NEEDS.split())
    except Failed as error:
        result = f"FAILED: {error}"
    print(f"Python {version}, {kind}: {result}, {time.monotonic() - began:.0f} s", flush=True)
    return not result.startswith("FAILED")


def find_python(version):
    """An interpreter of a version like "3.12" that works, None where there is none."""
    homes = glob.glob(os.path.expanduser(f"~/.pyenv/versions/{version}.*/bin/python"))
    for python in (shutil.which(f"python{version}"), *sorted(homes)):
        ask = "import sys, venv, ensurepip; print('%d.%d' % sys.version_info[:2])"
        if (
            python
            and subprocess.run([python, "-c", ask], capture_output=True, text=True).stdout.strip()
            == version
        ):
            return python
    return None


def make_wheel(folder):
    """The wheel of this checkout, made of a copy of what git knows of it."""
    copy = folder / "source"
    files = run(
        "git",
        "ls-files",
        "-co",
        "--exclude-standard",
        "damage",
        "walls",
        "studies",
        "pyproject.toml",
        "README.md",
        "LICENSE",
        cwd=ROOT,
    ).split("\n")
    for name in filter(None, files):
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, copy / name)
    python = find_python("3.11") or sys.executable
    run(
        python,
        "-m",
        "pip",
        "wheel",
        "--quiet",
        "--no-deps",
        "--wheel-dir",
        folder,
        copy,
        cwd=folder,
    )
    return next(folder.glob("masonry_damage-*.whl"))


def try_wheel(wheel, python, packages):
    """Install the wheel into an empty environment and use it; returns the versions that were
    there."""
    with tempfile.TemporaryDirectory() as folder:
        inside = Path(folder) / "environment"
        elsewhere = Path(folder) / "elsewhere"
        elsewhere.mkdir()
        (elsewhere / "pier.py").write_text(WALL)
        run(python, "-m", "venv", inside, cwd=folder)
        new = inside / "bin" / "python"
        run(
            new,
            "-m",
            "pip",
            "install",
            "--quiet",
            "--no-compile",
            "--only-binary",
            ":all:",
            wheel,
            *packages,
            cwd=folder,
        )
        versions = run(new, "-c", WHERE, NEEDS, cwd=elsewhere).strip()
        use(inside / "bin" / "masonry-damage", elsewhere)
        return versions


def use(command, folder):
    """Run a wall, and read it in every way that needs a library of its own."""

    def do(*words):
        return run(command, *words, cwd=folder)

    if not do("--version").startswith("masonry-damage "):
        raise Failed("masonry-damage --version does not begin with the name")
    do("new-wall", "mine.toml")
    do("modes", "mine.toml")
    do("record", "BGAR_HGE")
    do(
        "reference",
        "pier.py",
        "--harmonic",
        "0.1",
        "0.3",
        "--cycles",
        "2",
        "--rest",
        "0.2",
        "--out",
        "a.h5",
    )
    if '"max"' not in do("index", "a.h5", "--json"):
        raise Failed("index has no maximum")
    do("plot", "a.h5", "--out", "pictures")
    do("tables", "summary", "a.h5", "--out", "summary.csv")
    do("export", "a.h5", "--vtkhdf", "a.vtkhdf")
    do("animate", "a.h5")
    made = [
        "pictures/wall_max.png",
        "pictures/wall_max.pdf",
        "a/index.png",
        "summary.csv",
        "a.vtkhdf",
        "a.gif",
    ]
    lacking = [name for name in made if not (folder / name).is_file()]
    if lacking:
        raise Failed(f"not made: {', '.join(lacking)}")


def run(*words, cwd):
    """The output of a command, without this checkout on Python's path.

    numba optimises nothing: that takes most of its time, and decides about speed alone.
    """
    began = time.monotonic()
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith("PYTHON")
    }
    words = [str(word) for word in words]
    shown = " ".join([Path(words[0]).name, *words[1:4]])
    try:
        done = subprocess.run(
            words,
            cwd=cwd,
            capture_output=True,
            text=True,
            timeout=LIMIT_S,
            env=environment
            | {
                "MPLBACKEND": "Agg",
                "PIP_DISABLE_PIP_VERSION_CHECK": "1",
                "NUMBA_OPT": "0",
            },
        )
    except subprocess.TimeoutExpired as error:
        raise Failed(f"{shown}: no end in {LIMIT_S} s") from error
    print(
        f"    {time.monotonic() - began:4.0f} s  {shown.partition(chr(10))[0]}",
        file=sys.stderr,
        flush=True,
    )
    if done.returncode:
        raise Failed(f"{shown}: {(done.stderr.strip() or 'no word').splitlines()[-1]}")
    return done.stdout


if __name__ == "__main__":
    sys.exit(main())
