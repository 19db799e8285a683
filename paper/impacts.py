"""Energy that a block keeps at a rocking impact, beside Housner's and tested ones: a table of
docs/validation/impacts.md.

    python3 -m paper impacts        # writes docs/tables/benchmarks/impacts.csv; half a minute

A block is let go from half its overturning angle on a dry joint, without damping or with that of
`--beta`.  By Housner it
keeps the share r^2 of its energy, r = 1 - 1.5 sin^2 alpha; the model's is the mean of six impacts,
by the peaks of its rotation.
"""

import math

import numpy as np
import pandas as pd

from damage import Brick, Joint, Wall
from damage.law.modes import natural_modes
from damage.reference.solver import ReferenceSolver
from damage.wall.layout import lay_out
from damage.wall.model_options import ModelOptions
from paper.bench import REPOSITORY, arguments

OUT = REPOSITORY / "docs" / "tables" / "benchmarks" / "impacts.csv"
WIDE_M, SLENDERNESS = 0.2, (3, 5)
CASES = (
    *((contacts, 2, beta) for contacts in ("interior", "corners") for beta in (0.0, 1e-4, 1e-3)),
    *(("gauss", cells, 0.0) for cells in (2, 4, 8, 16)),
    ("gauss", 8, 1e-3),
)
"""Contact points, cells, `--beta` [s]."""
STIFFNESSES = 4e9, 4e10
TESTED = {3: "0.97 (concrete)", 5: "0.95 (concrete), 0.67 (rubber)"}
"""Coefficients over Housner's r (M. A. ElGawady, Q. Ma, J. W. Butterworth, J. M. Ingham, 2008)."""
IMPACTS = 6


def block(slender, stiffness, contacts, cells):
    """Layout of a block of so many times its width in height."""
    brick = Brick(2 * WIDE_M, slender * WIDE_M, 0.5, 2000.0, young_modulus=1e15, shear_modulus=4e14)
    return lay_out(
        Wall(
            "block",
            WIDE_M,
            slender * WIDE_M,
            precompression=0.0,
            brick=brick,
            joint=Joint(stiffness, 0.4 * stiffness, math.atan(2.0), 0.0, 0.0),
        ),
        ModelOptions(contacts=contacts, cells=cells),
    )


def rotations_at_peaks(layout, start, n_peaks, beta=0.0):
    """Sizes of the rotation at its first peaks [rad], after the release from `start`."""
    critical = natural_modes(layout, 1).critical_time_step_s
    damped = beta / critical  # damping ratio of the highest mode, whose step is 2 / omega
    wall = ReferenceSolver(layout, 0.3 * critical * (math.hypot(1, damped) - damped))
    wall.damp(local=0.7)
    wall.run(round(0.2 / wall.time_step))
    wall.damp(beta=beta)
    place, half = wall.displacement, np.ptp(layout.contacts.x) / 2
    turn, high = start, layout.bodies.height[0] / 2
    place[0] += [
        high * math.sin(turn) + half * (1 - math.cos(turn)),
        half * math.sin(turn) - high * (1 - math.cos(turn)),
        -turn,
    ]
    wall.displacement = place
    wall.velocity = 0 * wall.velocity
    found, before, rate = [start], wall.displacement[0, 2], 0.0
    every, turned = max(1, round(2e-4 / wall.time_step)), False
    for _ in range(200_000):
        wall.run(every)
        now = wall.displacement[0, 2]
        speed = now - before
        turned |= now * found[-1] * (-1) ** len(found) > 0 and abs(now) > 0.05 * start
        if turned and speed * rate < 0 and abs(now) > 0.05 * start:
            found.append(abs(before))
            turned = False
            if len(found) > n_peaks:
                return np.array(found)
        before, rate = now, speed
    return np.array(found)


def kept_share(peaks, angle):
    """Share of the energy that an impact leaves, geometric mean; peaks: of the rotation [rad];
    angle: at which it overturns [rad]."""
    energy = 1 - (1 - peaks / angle) ** 2
    return (energy[-1] / energy[0]) ** (1 / (len(peaks) - 1))


def rows():
    """Rows of the table."""
    for slender in SLENDERNESS:
        for stiffness in STIFFNESSES:
            for contacts, cells, beta in CASES:
                layout = block(slender, stiffness, contacts, cells)
                lever = np.ptp(layout.contacts.x)
                angle = math.atan(lever / (slender * WIDE_M))
                housner = 1 - 1.5 * math.sin(angle) ** 2
                peaks = rotations_at_peaks(layout, 0.5 * angle, IMPACTS, beta)
                coefficient = math.sqrt(kept_share(peaks, angle))
                of_block = 1 - 1.5 / (1 + slender**2)
                yield {
                    "slenderness": slender,
                    "normal_stiffness_gpa_m": stiffness / 1e9,
                    "contacts": contacts,
                    "cells": cells,
                    "beta_s": beta,
                    "points": len(layout.contacts),
                    "lever_over_width": lever / WIDE_M,
                    "model": coefficient,
                    "housner_of_lever": housner,
                    "over_that": coefficient / housner,
                    "housner_of_block": of_block,
                    "over_that_of_block": coefficient / of_block,
                    "tested_over_that_of_block": TESTED[slender],
                }


def main():
    arguments(__doc__)
    table = pd.DataFrame(rows())
    table.to_csv(OUT, index=False, float_format="%.4g")
    print(table.to_string())
