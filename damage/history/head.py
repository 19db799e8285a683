"""The first 512 bytes of a history, before HDF5's own (its user block): what made the file, and a
seal on the rest.

    masonry-damage-history 9
    software 0.2.0
    model reference 6b1f0c9a52e4
    sealed sha256 5891b5b522d5df08... of 412345 bytes

It is text, so that `head -c 512 FILE.h5` shows it and a study reads it quickly.  The last line is
`open` until everything else is on the disk.  A file with a broken seal is never opened by HDF5,
which may hang or crash on one damaged byte.
"""

import hashlib
import json
import os
import re
from dataclasses import dataclass, replace
from pathlib import Path

from damage.errors import InputError
from damage.history.schema import SCHEMA, SCHEMA_VERSION
from damage.provenance import UNKNOWN

HEAD_BYTES = 512  # the least that HDF5 allows
_LINES = re.compile(
    SCHEMA + rf" {SCHEMA_VERSION}\nsoftware ([^\n]*)\nmodel ([^\n]*)\n"
    r"(?:open|sealed sha256 ([0-9a-f]{64}) of (\d+) bytes)\n\0*"
)
_NUMBER = re.compile(SCHEMA.encode() + rb" (\d+)\n")


@dataclass(frozen=True)
class Head:
    """software, model: what made the file, in words; sha256, n_bytes: of what follows the block,
    None while open."""

    software: str
    model: str
    sha256: str | None = None
    n_bytes: int | None = None

    @classmethod
    def of_run(cls, attributes):
        """The open Head of a run with these attributes."""
        versions = json.loads(attributes["versions_json"])
        model = versions.get("model", UNKNOWN)
        return cls(versions.get("masonry-damage", UNKNOWN), f"{attributes['solver']} {model}")

    @property
    def sealed(self):
        """Whether the run that wrote the file closed it."""
        return self.sha256 is not None

    def as_bytes(self):
        """The block itself."""
        end = f"sealed sha256 {self.sha256} of {self.n_bytes} bytes" if self.sealed else "open"
        lines = (
            f"{SCHEMA} {SCHEMA_VERSION}",
            f"software {self.software}",
            f"model {self.model}",
            end,
        )
        return "".join(f"{line}\n" for line in lines).encode().ljust(HEAD_BYTES, b"\0")


def write_head(path, head):
    """Write the block of a new history, whose HDF5 part begins behind it."""
    with open(path, "r+b", buffering=0) as file:
        file.write(head.as_bytes())


def seal(path):
    """Seal a closed history: write the digest of its bytes."""
    sha256, n_bytes = _digest(path)
    write_head(path, replace(read_head(path), sha256=sha256, n_bytes=n_bytes))


def read_head(path):
    """The Head of a history.  Raises InputError for any other file."""
    try:
        with open(path, "rb") as file:
            block = file.read(HEAD_BYTES)
    except OSError as error:
        raise InputError(
            f"{path} cannot be read ({error.strerror}); give the path of a history (.h5)"
        ) from error
    version = _NUMBER.match(block)
    if version and int(version[1]) != SCHEMA_VERSION:
        remedy = "update the software" if int(version[1]) > SCHEMA_VERSION else "run it again"
        raise InputError(
            f"{path} has schema version {int(version[1])}, this software reads {SCHEMA_VERSION};"
            f" {remedy}"
        )
    match = _LINES.fullmatch(block.decode("ascii", errors="replace"))
    if not match or len(block) < HEAD_BYTES:
        what = "its first 512 bytes are damaged" if version else "it begins otherwise"
        raise InputError(
            f"{path} cannot be read as a history ({what}); expected a file that a run wrote"
        )
    software, model, sha256, n_bytes = match.groups()
    return Head(software, model, sha256, n_bytes and int(n_bytes))


def check_seal(path, head):
    """Raise InputError unless the bytes of the file are those that were sealed."""
    n_bytes = os.path.getsize(path) - HEAD_BYTES
    if n_bytes != head.n_bytes:
        raise InputError(
            f"{path} has {n_bytes} bytes behind its head, {head.n_bytes} were sealed: it was cut"
            " short or changed since its run; take another copy, or run it again"
        )
    if _digest(path)[0] != head.sha256:
        raise InputError(
            f"{path} is not what its run sealed (its SHA-256 differs): it was damaged or changed;"
            " take another copy, or run it again"
        )


def _digest(path):
    """(SHA-256, number) of the bytes behind the head."""
    with open(path, "rb") as file:
        file.seek(HEAD_BYTES)
        return (
            hashlib.file_digest(file, "sha256").hexdigest(),
            Path(path).stat().st_size - HEAD_BYTES,
        )
