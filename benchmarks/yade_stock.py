"""Inside YADE: microseconds a step of the symmetric wall's bricks as loose polyhedra under YADE's
stock law for these, beside this project's model of the wall.

    ./yade -n -j1 benchmarks/yade_stock.py [--rounds 3]

The stock law (Ig2_Polyhedra_Polyhedra_PolyhedraGeom, Law2_PolyhedraGeom_PolyhedraPhys_Volumetric)
works out the volume in which two polyhedra overlap, and has no bond.  Bricks are made larger by a
tenth of a millimetre, so that all neighbours touch.  The two models take turns; the least of all
rounds counts.  YADE without polyhedra: status 3.
"""

import argparse
import math
import sys
import time
import timeit
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[1]))

import yade
from yade import O, utils

from damage.law.modes import natural_modes
from damage.run.schedule import STEP_FACTOR
from damage.start import EXIT_MISSING
from damage.units import GRAVITY
from damage.wall.file import load_wall
from damage.wall.layout import lay_out
from yade_scripts.leaving import run_and_leave
from yade_scripts.solver import YadeSolver

STEPS, PARTS, OVERLAP_M = 20, 3, 1e-4


def stock(layout, time_step):
    """Make the scene of loose bricks on a fixed one, under gravity."""
    O.reset()
    material = yade.PolyhedraMat(
        young=1e9, poisson=0.2, density=1900, frictionAngle=math.atan(0.75)
    )
    O.materials.append(material)
    bodies, depth = layout.bodies, layout.wall.brick.thickness
    boxes = [
        (x, z, length + OVERLAP_M, height + OVERLAP_M)
        for x, z, length, height in zip(bodies.x, bodies.z, bodies.length, bodies.height)
    ]
    below = 0.1
    boxes.append((layout.wall.length / 2, -below / 2, 2 * layout.wall.length, below + OVERLAP_M))
    for x, z, length, height in boxes:
        corners = [
            (x + a * length / 2, b * depth / 2, z + c * height / 2)
            for a in (-1, 1)
            for b in (-1, 1)
            for c in (-1, 1)
        ]
        O.bodies.append(utils.polyhedron(corners, material=material, fixed=z < 0))
    O.engines = [
        yade.ForceResetter(),
        yade.InsertionSortCollider([yade.Bo1_Polyhedra_Aabb()], verletDist=1e-3),
        yade.InteractionLoop(
            [yade.Ig2_Polyhedra_Polyhedra_PolyhedraGeom()],
            [yade.Ip2_PolyhedraMat_PolyhedraMat_PolyhedraPhys()],
            [yade.Law2_PolyhedraGeom_PolyhedraPhys_Volumetric()],
        ),
        yade.NewtonIntegrator(gravity=(0, 0, -GRAVITY), damping=0.7),
    ]
    O.dt = time_step


def own(layout, time_step):
    """Make the scene of this project's model, settling."""
    solver = YadeSolver(layout, time_step)
    solver.damp(local=0.7)
    solver.model.newton.gravity = (0, 0, -GRAVITY)


def microseconds(make, layout, time_step):
    """The least of some parts, a step; and how many contacts there are."""
    make(layout, time_step)
    O.run(STEPS, True)
    times = timeit.repeat(
        lambda: O.run(STEPS, True), timer=time.process_time, number=1, repeat=PARTS
    )
    return min(times) / STEPS * 1e6, sum(one.isReal for one in O.interactions)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    rounds = parser.parse_args(sys.argv[1:]).rounds
    if not hasattr(utils, "polyhedron"):
        print("this YADE has no polyhedra: no stock law to compare with")
        return EXIT_MISSING
    layout = lay_out(load_wall("walls/symmetric.py"))
    time_step = STEP_FACTOR * natural_modes(layout, 1).critical_time_step_s
    found = {"stock polyhedra": [], "this model": []}
    for _ in range(rounds):
        for name, make in zip(found, (stock, own)):
            found[name].append(microseconds(make, layout, time_step))
    for name, times in found.items():
        least, contacts = min(times)
        print(
            f"{name}: {least:.0f} us a step, {contacts} contacts, {least / contacts * 1e3:.0f} ns a"
            " contact and step"
        )
    print(
        "stock over this model:"
        f" {min(found['stock polyhedra'])[0] / min(found['this model'])[0]:.1f} a step"
    )
    return 0


run_and_leave(main)
