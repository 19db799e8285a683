"""Files: where the package keeps its data, and writing whole or not at all."""

import io
import itertools
import json
import math
import os
import re
from contextlib import contextmanager, suppress
from pathlib import Path

from damage.errors import InputError

_PACKAGE = Path(__file__).parent
YADE = str(_PACKAGE.parent / "yade"), "-n", "-j1"
"""Command that runs a script in YADE without a screen, on one core, and without YADE's network
servers; of a clone."""
DATA = _PACKAGE / "data"
"""Records and tests that ship with the package; each folder's README says what they are."""


def shipped(folder):
    """Path of `walls`, `houses` or `studies`: in the installed package below `share`, in a clone
    beside the package (pyproject.toml maps one to the other)."""
    inside = _PACKAGE / "share" / folder
    return inside if inside.is_dir() else _PACKAGE.parent / folder


def shipped_files(folder, ending):
    """{name: path} of the files in a folder of `shipped`, by their names without the ending, like
    ".py"."""
    return {path.stem: path for path in sorted(shipped(folder).glob(f"*{ending}"))}


def shipped_path(path):
    """The shipped file of a path like walls/symmetric.py or damage/data/..., as it is in a clone;
    None where there is none."""
    path = Path(path)
    if path.is_absolute() or ".." in path.parts or not path.parts:
        return None
    candidates = (_PACKAGE.parent / path, shipped(path.parts[0]).joinpath(*path.parts[1:]))
    known = path.parts[0] in ("walls", "houses", "studies") or path.parts[:2] == ("damage", "data")
    return next((candidate for candidate in candidates if known and is_there(candidate)), None)


def is_there(path):
    """Whether a path is that of a file; no file has a name that is longer than the system takes."""
    try:
        return Path(path).is_file()
    except OSError:
        return False


LONGEST_LINE = 100_000
"""Characters of a line of text."""


def text_lines(path, data, most, errors="strict"):
    """Lines of a text file's bytes in UTF-8 or UTF-16, without their ends and without the Ctrl-Z by
    which DOS ended files; errors: what to do with other bytes, as of `open`.

    Raises InputError for more than `most` lines, or one over LONGEST_LINE: either would take far
    more memory, once it is cut in parts, than the file has bytes.
    """
    text = io.TextIOWrapper(io.BytesIO(data), encoding_of(data), errors)
    lines = [line.rstrip("\n") for line in itertools.islice(text, most + 1)]
    lines[-1:] = [line.rstrip("\x1a") for line in lines[-1:]]
    if len(lines) > most:
        raise InputError(f"{path}: more than {most} lines; expected fewer, take some out")
    for number, line in enumerate(lines, 1):
        if len(line) > LONGEST_LINE:
            raise InputError(
                f"{path} line {number}: {len(line)} characters; expected up to {LONGEST_LINE},"
                " break it into rows"
            )
    return lines


def encoding_of(data):
    """UTF-16 where a byte order mark says so, or zeros between the first letters; UTF-8 otherwise.

    >>> [encoding_of("time".encode(name)) for name in ("utf-16", "utf-16-be", "utf-8")]
    ['utf-16', 'utf-16-be', 'utf-8-sig']
    """
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    if re.match(rb"(?:[\t\n\r -~]\0){4}", data):
        return "utf-16-le"
    return "utf-16-be" if re.match(rb"(?:\0[\t\n\r -~]){4}", data) else "utf-8-sig"


@contextmanager
def whole_or_nothing(path):
    """A temporary name beside `path`, renamed to it at the end or removed after an error; its
    folder is made.

    Raises InputError where it cannot be written.
    """
    path = Path(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.unlink(missing_ok=True)  # a link of that name would lead elsewhere
        yield unfinished
        os.replace(unfinished, path)
    except (FileExistsError, NotADirectoryError) as error:
        raise InputError(
            f"cannot write {path}: {path.parent}, or a folder above it, is no folder; expected one;"
            " choose another place"
        ) from error
    except OSError as error:
        raise InputError(
            f"cannot write {path}: {error.strerror or error}; expected a disk with room "
            "and a folder that can be written to; make room, or choose another place"
        ) from error
    finally:
        with suppress(OSError):
            unfinished.unlink()


def write_text(path, text):
    """Write a text file, whole or not at all; returns its path."""
    return write_bytes(path, text.encode("utf-8"))


def write_bytes(path, data):
    """Write a file of bytes, whole or not at all; returns its path."""
    with whole_or_nothing(path) as unfinished:
        unfinished.write_bytes(data)
    return Path(path)


def json_text(content, **more):
    """Tables, lists, numbers and words as JSON, which knows no number that is not finite: null
    stands there.

    >>> json_text({"period_s": [0.2, float("nan")]})
    '{"period_s": [0.2, null]}'
    """
    return json.dumps(_finite(content), allow_nan=False, **more)


def _finite(content):
    if isinstance(content, dict):
        return {name: _finite(value) for name, value in content.items()}
    if isinstance(content, (list, tuple)):
        return [_finite(value) for value in content]
    return None if isinstance(content, float) and not math.isfinite(content) else content
