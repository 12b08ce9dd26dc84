"""A closed loop beside EXUDYN: a four-bar with flexible coupler and rocker, driven by a torque on its crank.

    python benchmarks/four_bar.py [--exudyn-python PYTHON] [--rounds 5]

Crank A-B rigid, coupler B-C and rocker D-C beams of steel, no gravity, at rest at the start. The torque is
M sin(2 pi t) for 2 s. The result is the place of the middle of the coupler; its error is the largest at ten
instants against the finest run of the same code. Of a grid of elements and steps the cheapest setting below
each error is taken; both codes then take turns. EXUDYN is given skill as in `solve_exudyn.py`: planar beams
of three nodes, the fast module, a symbolic torque, the faster of its solvers.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from typing import Any

import measure
import numpy as np

CRANK, COUPLER, ROCKER, GROUND = 0.3, 0.9, 0.7, 0.8
"""Lengths [m]."""
START = 1.2
"""Angle of the crank at the start [rad]."""
SIDE, MODULUS, POISSON, DENSITY, CRANK_MASS = 0.012, 210e9, 0.3, 7850.0, 0.5
TORQUE, END = 1.5, 2.0
INSTANTS = np.linspace(0.2, END, 10)
ELEMENTS, STEPS = (1, 2, 4), (100, 200, 400, 800, 1600, 3200, 6400)
FINEST = (8, 16000)
LIMITS = (1.0, 0.1, 0.01)
"""Errors that settings must reach [mm]."""


def corners() -> tuple[np.ndarray, np.ndarray]:
    """Places of B and C at the start [m], C on the upper side of B-D."""
    b = CRANK * np.array([math.cos(START), math.sin(START)])
    to_d = np.array([GROUND, 0.0]) - b
    span = float(np.hypot(*to_d))
    angle = math.atan2(to_d[1], to_d[0])
    angle += math.acos((span**2 + COUPLER**2 - ROCKER**2) / (2 * span * COUPLER))
    return b, b + COUPLER * np.array([math.cos(angle), math.sin(angle)])


def with_flexarm(elements: int, steps: int, consistent_forces: bool = False) -> dict[str, Any]:
    """CPU seconds and places of the coupler's middle, of a run in flexarm."""
    import flexarm

    b, c = corners()
    coupler, rocker = math.atan2(*(c - b)[::-1]), math.atan2(c[1], c[0] - GROUND)
    section = {"shape": "rectangle", "width": SIDE, "height": SIDE}
    material = {"youngs_modulus": MODULUS, "poisson_ratio": POISSON, "density": DENSITY}

    def beam(name: str, length: float) -> dict[str, Any]:
        shape = {"section": section, "material": material, "elements": 2 * elements}
        return {"name": name, "type": "beam", "end": [length, 0, 0], **shape}

    def hinge(name: str, parent: str, child: str, x: float) -> dict[str, Any]:
        at = {"xyz": [x, 0, 0]}
        return {
            "name": name,
            "type": "revolute",
            "parent": parent,
            "child": child,
            "origin": at,
            "axis": [0, -1, 0],
        }

    inertia = CRANK_MASS * CRANK**2 / 12
    crank = {"name": "crank", "type": "rigid", "mass": CRANK_MASS, "com": [CRANK / 2, 0, 0]}
    arm = flexarm.Arm.from_dict(
        {
            "name": "four-bar",
            "gravity": [0, 0, 0],
            "links": [
                {**crank, "inertia": [1e-3 * inertia, inertia, inertia]},
                beam("coupler", COUPLER),
                beam("rocker", ROCKER),
            ],
            "joints": [
                hinge("A", "base", "crank", 0.0),
                hinge("B", "crank", "coupler", CRANK),
                hinge("D", "base", "rocker", GROUND),
            ],
            "closures": [
                {
                    "name": "C",
                    "type": "revolute",
                    "axis": [0, -1, 0],
                    "a": "coupler",
                    "a_at": "end",
                    "b": "rocker",
                    "b_at": "end",
                }
            ],
            "points": [{"name": "middle", "link": "coupler", "position": [COUPLER / 2, 0, 0]}],
            "assembly": {"A": START, "B": coupler - START, "D": rocker},
        }
    )
    t = np.linspace(0, END, 2001)
    drive = flexarm.Drive.from_samples(t, {"A": TORQUE * np.sin(2 * np.pi * t)}, side="torque")
    drive = flexarm.Drive(drive.joints, {"A": START}, 0.0, END)
    began = time.process_time()
    run = flexarm.simulate(arm, drive, step=END / steps, consistent_forces=consistent_forces)
    seconds = time.process_time() - began
    return {"cpu": seconds, "places": run.at(INSTANTS, "middle")[:, [0, 2]].tolist()}


def with_exudyn(elements: int, steps: int) -> dict[str, Any]:
    """The same in EXUDYN, quadratic beam elements of three nodes."""
    sys.exudynFast = True  # type: ignore[attr-defined]
    import exudyn as exu
    import exudyn.itemInterface as item
    from exudyn.advancedUtilities import CreateSymbolicUserFunction
    from exudyn.beams import GenerateBeamElementsAlongLine

    area, second_moment = SIDE**2, SIDE**4 / 12
    shear = MODULUS / (2 * (1 + POISSON)) * area * 10 * (1 + POISSON) / (12 + 11 * POISSON)
    mbs = exu.SystemContainer().AddSystem()
    b, c = corners()
    d = np.array([GROUND, 0.0])

    def pinned(marker: int, other: int) -> None:
        mbs.AddObject(item.RevoluteJoint2D(markerNumbers=[marker, other]))

    def ground(x: np.ndarray) -> int:
        body = mbs.AddObject(item.ObjectGround(referencePosition=[*x, 0]))
        return mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=body))

    def beam(start: np.ndarray, end: np.ndarray) -> list[int]:
        template = item.ObjectBeamGeometricallyExact2D(
            nodeNumbers=[0] * 3,
            massPerLength=DENSITY * area,
            crossSectionInertia=DENSITY * second_moment,
            axialStiffness=MODULUS * area,
            shearStiffness=shear,
            bendingStiffness=MODULUS * second_moment,
        )
        ends = [*start, 0], [*end, 0]
        return GenerateBeamElementsAlongLine(mbs, *ends, 2 * elements, template)["nodes"]

    def at(node: int) -> int:
        return mbs.AddMarker(item.MarkerNodePosition(nodeNumber=node))

    node = mbs.AddNode(item.NodeRigidBody2D(referenceCoordinates=[*(b / 2), START]))
    inertia = CRANK_MASS * CRANK**2 / 12
    crank = mbs.AddObject(item.ObjectRigidBody2D(nodeNumber=node, mass=CRANK_MASS, inertia=inertia))
    ends = [
        mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=crank, localPosition=[x, 0, 0]))
        for x in (-CRANK / 2, CRANK / 2)
    ]
    coupler, rocker = beam(b, c), beam(d, c)
    pinned(ground(np.zeros(2)), ends[0])
    pinned(ends[1], at(coupler[0]))
    pinned(ground(d), at(rocker[0]))
    pinned(at(coupler[-1]), at(rocker[-1]))

    def torque(mbs: Any, t: Any, load: Any) -> Any:
        return TORQUE * exu.symbolic.sin(2 * math.pi * t)

    function = CreateSymbolicUserFunction(mbs, torque, "loadUserFunction", itemTypeName="LoadCoordinate")
    turn = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=node, coordinate=2))
    mbs.AddLoad(item.LoadCoordinate(markerNumber=turn, load=0, loadUserFunction=function))
    sensor = mbs.AddSensor(
        item.SensorNode(
            nodeNumber=coupler[len(coupler) // 2],
            storeInternal=True,
            writeToFile=False,
            outputVariableType=exu.OutputVariableType.Position,
        )
    )
    mbs.Assemble()
    s = exu.SimulationSettings()
    s.timeIntegration.endTime, s.timeIntegration.numberOfSteps = END, steps
    s.timeIntegration.verboseMode = 0
    s.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    newton = s.timeIntegration.newton
    newton.relativeTolerance, newton.absoluteTolerance = 1e-5, 1e-4
    s.solution.file.write = False
    s.solution.sensors.writePeriod = 0.2
    if elements > 2:
        s.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    began = time.process_time()
    mbs.SolveDynamic(s)
    seconds = time.process_time() - began
    del function
    found = mbs.GetSensorStoredData(sensor)
    places = [[float(np.interp(t, found[:, 0], found[:, k])) for k in (1, 2)] for t in INSTANTS]
    return {"cpu": seconds, "places": places}


SOLVERS = {
    "flexarm": with_flexarm,
    "flexarm, default": lambda elements, steps: with_flexarm(elements, steps, True),
    "exudyn": with_exudyn,
}


def error(places: list, exact: list) -> float:
    """Largest distance [mm]."""
    return float(1e3 * np.abs(np.array(places) - np.array(exact)).max())


def main() -> None:
    """Print the finest runs, then a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--exudyn-python", help="interpreter that has EXUDYN")
    parser.add_argument("--rounds", type=int, default=5)
    chosen = parser.parse_args()
    pythons = dict.fromkeys(("flexarm", "flexarm, default"), sys.executable)
    pythons["exudyn"] = measure.exudyn_python(chosen.exudyn_python)

    def solve(code: str, cases: list[tuple[int, int]]) -> list[dict[str, Any]]:
        return measure.run(pythons[code], "four_bar.py", {"code": code, "cases": cases}).answer

    grid = [(n, steps) for n in ELEMENTS for steps in STEPS]
    finest, seen = {}, {}
    for code in pythons:
        finest[code], *found = solve(code, [FINEST, *grid])
        seen[code] = {
            case: {**run, "error": error(run["places"], finest[code]["places"])}
            for case, run in zip(grid, found, strict=True)
        }
    apart = error(finest["flexarm"]["places"], finest["exudyn"]["places"])
    print(f"finest runs, {2 * FINEST[0]} elements and {FINEST[1]} steps: {apart:.4f} mm apart")
    print("| error at most | code | elements, step | error (mm) | solver CPU (s) | x flexarm |")
    print("|---|---|---|---|---|---|")
    for limit in LIMITS:
        best = {
            code: min((case for case in grid if runs[case]["error"] < limit), key=lambda c: runs[c]["cpu"])
            for code, runs in seen.items()
        }
        cpu: dict[str, list[float]] = {code: [] for code in best}
        for _ in range(chosen.rounds):
            for code, case in best.items():
                cpu[code].append(min(run["cpu"] for run in solve(code, [case] * 4)[1:]))
        for code, (n, steps) in best.items():
            print(
                f"| {limit:g} mm | {code} | {2 * n}, {1e3 * END / steps:.3g} ms "
                f"| {seen[code][n, steps]['error']:.3f} | {measure.Spread.of(cpu[code]).text()} "
                f"| {measure.ratio(cpu[code], cpu['flexarm']).text()} |"
            )


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1].startswith("{"):
        order = json.loads(sys.argv[1])
        print(json.dumps([SOLVERS[order["code"]](*case) for case in order["cases"]]))
    else:
        main()
