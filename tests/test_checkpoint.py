"""Checkpoints: a run that was killed or interrupted continues to the bits of one that was not."""

import os
import shutil
import signal

import numpy as np
import pytest
from conftest import REPOSITORY, SHORT, one_line_error, written

import damage
from benchmarks.same_bits import differences
from damage.reference.session import run_reference
from damage.run import run as run_module
from damage.run.before import read_earlier
from damage.run.checkpoint import checkpoint_path, read_checkpoint
from damage.wall.layout import lay_out

SMALL = "walls/variants/small.py"
OFTEN = ("--checkpoint", "0.001")
SHAKE = (SMALL, "--harmonic", "0.06", "0.6", "--rest", "0.1", "--no-pictures", "--quiet")
LOOSE = 0.4e-3  # opening [m] from which bricks collide in YADE
RUNS = {
    "settled": ("--settle", "hogging", "--distortion", "1/500", "--stresses", "--point", "0.3", "0.3"),
    "pushed": (SMALL, "--pushover", "0.02", "--no-pictures", "--quiet"),
    "falling": (SMALL, "--harmonic", "0.1", "1.5", "--rest", "0.1", "--new-contacts", "--after-fall", "--no-pictures",
                "--quiet"),
    "deformable": ("--bricks", "deformable", "--rest", "0"),
    "scaled": ("window.toml", "--harmonic", "0.06", "1.5", "--cycles", "2", "--rest", "0", "--no-pictures", "--quiet"),
