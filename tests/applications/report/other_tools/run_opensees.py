"""In OpenSeesPy: what scripts of `damage export --opensees` find, as JSON.

run_opensees.py weight WALL.py: settlement of the top [m], first period [s], joints that failed,
shares. run_opensees.py path BRICK.py PATH.json: forces on the ground along a path of the only brick
[m], without rotation. run_opensees.py shake WALL.py PERIOD_S AMPLITUDE_G CYCLES DT_S STEPS: motion
of the top [m], joints that failed. run_opensees.py push PIER.py NODE INCREMENT_M STEPS: base shear
along a push of a node, its weight.
"""

import json
import runpy
import sys
from math import pi, sin

import openseespy.opensees as ops

kind, script, *words = sys.argv[1:]
model = runpy.run_path(script)
model["build"]()


def on_ground():
    """Forces on the ground [N], along x and up, as elements bear them."""
    found = [0.0, 0.0]
    for joint, first, *_ in model["JOINTS"]:
        if first == 0:
            force = ops.eleResponse(joint, "force")
            found = [found[k] - force[k] for k in (0, 1)]
    return found


def weight():
    period = 2 * pi / ops.eigen(1)[0] ** 0.5
    found = model["weight"]()
    return {
        "found": found,
        "settlement_m": -model["top"](2),
        "period_s": period,
        "failed": len(model["JOINTS"]) - len(model["INTACT"]),
        "on_ground_n": on_ground(),
    }


def path(file):
    with open(file, encoding="utf-8") as given:
        places, forces = json.load(given), []
    times = [float(k) for k in range(len(places) + 1)]
    for k in (0, 1):
        ops.timeSeries(
            "Path", 10 + k, "-time", *times, "-values", 0.0, *(place[k] for place in places)
        )
        ops.pattern("Plain", 10 + k, 10 + k)
        ops.sp(1, k + 1, 1.0)
    ops.fix(1, 0, 0, 1)
    ops.wipeAnalysis()
    for command in (
        ("constraints", "Lagrange"),
        ("numberer", "Plain"),
        ("system", "FullGeneral"),
        ("test", "NormUnbalance", 1e-6, 50),
        ("algorithm", "Newton"),
    ):
        getattr(ops, command[0])(*command[1:])
    for _ in places:
        ops.integrator("LoadControl", 1.0)
        ops.analysis("Static")
        assert ops.analyze(1) == 0
        if model["break_joints"]():
            ops.integrator("LoadControl", 0.0)
            assert ops.analyze(1) == 0
        forces.append(on_ground())
    return {"forces_n": forces}


def shake(period_s, amplitude_g, cycles, dt_s, steps):
    assert model["weight"]()
    at_rest, dt_s, steps = model["top"](1), float(dt_s), int(steps)
    model["solver"](1.0, "Newton")
    angles = [2 * pi * k * dt_s / float(period_s) for k in range(steps + 2)]
    acceleration = [
        float(amplitude_g) * 9.81 * sin(angle) * (angle <= 2 * pi * float(cycles))
        for angle in angles
    ]
    ops.timeSeries("Path", 3, "-dt", dt_s, "-values", *acceleration)
    ops.pattern("UniformExcitation", 3, 1, "-accel", 3)
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    top = []
    for _ in range(steps):
        assert model["transient"](1, dt_s)
        top.append(model["top"](1) - at_rest)
    return {"top_m": top, "failed": len(model["JOINTS"]) - len(model["INTACT"])}


def push(node, increment, steps):
    found = model["weight"]()
    weight_n, shear = on_ground()[1], []
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    ops.load(int(node), 1.0, 0.0, 0.0)
    model["solver"](1e-6 * abs(weight_n))
    for _ in range(int(steps)):
        found = found and model["static"](1, "DisplacementControl", int(node), 1, float(increment))
        shear.append(on_ground()[0])
        if not found:
            break
    return {
        "found": found,
        "weight_n": weight_n,
        "shear_n": shear,
        "failed": len(model["JOINTS"]) - len(model["INTACT"]),
    }


print(json.dumps({"weight": weight, "path": path, "shake": shake, "push": push}[kind](*words)))
