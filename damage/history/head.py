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
import re
from dataclasses import dataclass, replace

from damage.errors import InputError
from damage.history.schema import SCHEMA, SCHEMA_VERSION
from damage.provenance import UNKNOWN

HEAD_BYTES = 512  # the least that HDF5 allows
_LINES = re.compile(
    SCHEMA + rf" {SCHEMA_VERSION}\nsoftware ([^\n]*)\nmodel ([^\n]*)\n"
    r"(?:open|sealed (sha256 [0-9a-f]{64} of \d+ bytes))\n\0*"
)
_NUMBER = re.compile(SCHEMA.encode() + rb" (\d+)\n")


@dataclass(frozen=True)
class Head:
    """software, model: what made the file, in words; sealed: `_digest` of what follows the block,
    None while the run that writes it has not closed it."""

    software: str
    model: str
    sealed: str | None = None

    @classmethod
    def of_run(cls, attributes):
        """The open Head of a run with these attributes."""
        versions = json.loads(attributes["versions_json"])
        model = versions.get("model", UNKNOWN)
        return cls(versions.get("masonry-damage", UNKNOWN), f"{attributes['solver']} {model}")

    def as_bytes(self):
        """The block itself."""
        lines = (
            f"{SCHEMA} {SCHEMA_VERSION}",
            f"software {self.software}",
            f"model {self.model}",
            f"sealed {self.sealed}" if self.sealed else "open",
        )
        return "".join(f"{line}\n" for line in lines).encode().ljust(HEAD_BYTES, b"\0")


def write_head(path, head):
    """Write the block of a new history, whose HDF5 part begins behind it."""
    with open(path, "r+b", buffering=0) as file:
        file.write(head.as_bytes())


def seal(path):
    """Seal a closed history: write the digest of its bytes."""
    write_head(path, replace(read_head(path), sealed=_digest(path)))


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
    return Head(*match.groups())


def check_seal(path, head):
    """Raise InputError unless the bytes of the file are those that were sealed."""
    digest = _digest(path)
    if digest != head.sealed:
        raise InputError(
            f"{path} is not what its run sealed: behind its head it has {digest}, {head.sealed}"
            " were sealed: it was cut short, damaged or changed; take another copy, or run it again"
        )


def _digest(path):
    """SHA-256 and number of the bytes behind the head, in words."""
    with open(path, "rb") as file:
        file.seek(HEAD_BYTES)
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
        return f"sha256 {sha256} of {file.tell() - HEAD_BYTES} bytes"
