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
from collections.abc import Callable
from typing import Any

import measure
import numpy as np

CRANK, COUPLER, ROCKER, GROUND = 0.3, 0.9, 0.7, 0.8
"""Lengths [m]."""
BEAMS = {"coupler": COUPLER, "rocker": ROCKER}
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


def hinge(name: str, parent: str, child: str, x: float) -> dict[str, Any]:
    """A revolute joint in the x-z plane."""
    origin = {"xyz": [x, 0, 0]}
    found = {"name": name, "type": "revolute", "parent": parent, "child": child}
    return {**found, "origin": origin, "axis": [0, -1, 0]}


def beam(name: str, length: float, side: float, elements: int) -> dict[str, Any]:
    """A square beam of steel along x."""
    section = {"shape": "rectangle", "width": side, "height": side}
    material = {"youngs_modulus": MODULUS, "poisson_ratio": POISSON, "density": DENSITY}
    shape = {"section": section, "material": material, "elements": elements}
    return {"name": name, "type": "beam", "end": [length, 0, 0], **shape}


def bar(name: str, length: float) -> dict[str, Any]:
    """A rigid crank."""
    inertia = CRANK_MASS * length**2 / 12
    found = {"name": name, "type": "rigid", "mass": CRANK_MASS, "com": [length / 2, 0, 0]}
    return {**found, "inertia": [1e-3 * inertia, inertia, inertia]}


def simulated(model: dict[str, Any], point: str, steps: int, consistent_forces: bool) -> dict[str, Any]:
    """CPU seconds and places of a point, of a run in flexarm under the torque."""
    import flexarm

    arm = flexarm.Arm.from_dict(model)
    t = np.linspace(0, END, 2001)
    drive = flexarm.Drive.from_samples(t, {"A": TORQUE * np.sin(2 * np.pi * t)}, side="torque")
    drive = flexarm.Drive(drive.joints, {"A": START}, 0.0, END)
    began = time.process_time()
    run = flexarm.simulate(arm, drive, step=END / steps, consistent_forces=consistent_forces)
    seconds = time.process_time() - began
    return {"cpu": seconds, "places": run.at(INSTANTS, point)[:, [0, 2]].tolist()}


def with_flexarm(elements: int, steps: int, consistent_forces: bool = False) -> dict[str, Any]:
    """CPU seconds and places of the coupler's middle, of a run in flexarm."""
    b, c = corners()
    coupler, rocker = math.atan2(*(c - b)[::-1]), math.atan2(c[1], c[0] - GROUND)
    pin = {"name": "C", "type": "revolute", "axis": [0, -1, 0]}
    ends = {"a": "coupler", "a_at": "end", "b": "rocker", "b_at": "end"}
    beams = [beam(name, length, SIDE, 2 * elements) for name, length in BEAMS.items()]
    model = {
        "name": "four-bar",
        "gravity": [0, 0, 0],
        "links": [bar("crank", CRANK), *beams],
        "joints": [
            hinge("A", "base", "crank", 0.0),
            hinge("B", "crank", "coupler", CRANK),
            hinge("D", "base", "rocker", GROUND),
        ],
        "closures": [{**pin, **ends}],
        "points": [{"name": "middle", "link": "coupler", "position": [COUPLER / 2, 0, 0]}],
        "assembly": {"A": START, "B": coupler - START, "D": rocker},
    }
    return simulated(model, "middle", steps, consistent_forces)


class Exudyn:
    """A planar mechanism in EXUDYN: crank from the origin, beams of quadratic elements, pins."""

    def __init__(self, crank: float) -> None:
        sys.exudynFast = True  # type: ignore[attr-defined]
        import exudyn as exu
        import exudyn.itemInterface as item

        self.exu, self.item = exu, item
        self.mbs = exu.SystemContainer().AddSystem()
        middle = 0.5 * crank * np.array([math.cos(START), math.sin(START)])
        self.node = self.mbs.AddNode(item.NodeRigidBody2D(referenceCoordinates=[*middle, START]))
        inertia = CRANK_MASS * crank**2 / 12
        body = item.ObjectRigidBody2D(nodeNumber=self.node, mass=CRANK_MASS, inertia=inertia)
        number = self.mbs.AddObject(body)
        self.ends = [
            self.mbs.AddMarker(item.MarkerBodyPosition(bodyNumber=number, localPosition=[x, 0, 0]))
            for x in (-crank / 2, crank / 2)
        ]
        self.pinned(self.ground(np.zeros(2)), self.ends[0])

    def pinned(self, marker: int, other: int) -> None:
        """Tie two markers by a pin."""
        self.mbs.AddObject(self.item.RevoluteJoint2D(markerNumbers=[marker, other]))

    def ground(self, x: np.ndarray) -> int:
        """Return the marker of a place on the ground."""
        body = self.mbs.AddObject(self.item.ObjectGround(referencePosition=[*x, 0]))
        return int(self.mbs.AddMarker(self.item.MarkerBodyPosition(bodyNumber=body)))

    def beam(self, start: np.ndarray, end: np.ndarray, side: float, elements: int) -> list[int]:
        """Return the nodes of a square beam of steel."""
        from exudyn.beams import GenerateBeamElementsAlongLine

        area, second_moment = side**2, side**4 / 12
        shear = MODULUS / (2 * (1 + POISSON)) * area * 10 * (1 + POISSON) / (12 + 11 * POISSON)
        template = self.item.ObjectBeamGeometricallyExact2D(
            nodeNumbers=[0] * 3,
            massPerLength=DENSITY * area,
            crossSectionInertia=DENSITY * second_moment,
            axialStiffness=MODULUS * area,
            shearStiffness=shear,
            bendingStiffness=MODULUS * second_moment,
        )
        ends = [*start, 0], [*end, 0]
        return list(GenerateBeamElementsAlongLine(self.mbs, *ends, elements, template)["nodes"])

    def at(self, node: int) -> int:
        """Return the marker of a node."""
        return int(self.mbs.AddMarker(self.item.MarkerNodePosition(nodeNumber=node)))

    def solved(self, node: int, elements: int, steps: int) -> dict[str, Any]:
        """CPU seconds and places of a node, of a run under the torque."""
        from exudyn.advancedUtilities import CreateSymbolicUserFunction

        exu, mbs = self.exu, self.mbs

        def torque(mbs: Any, t: Any, load: Any) -> Any:
            return TORQUE * exu.symbolic.sin(2 * math.pi * t)

        function = CreateSymbolicUserFunction(mbs, torque, "loadUserFunction", itemTypeName="LoadCoordinate")
        turn = mbs.AddMarker(self.item.MarkerNodeCoordinate(nodeNumber=self.node, coordinate=2))
        mbs.AddLoad(self.item.LoadCoordinate(markerNumber=turn, load=0, loadUserFunction=function))
        sensor = mbs.AddSensor(
            self.item.SensorNode(
                nodeNumber=node,
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


def with_exudyn(elements: int, steps: int) -> dict[str, Any]:
    """The same in EXUDYN, quadratic beam elements of three nodes."""
    mechanism = Exudyn(CRANK)
    b, c = corners()
    d = np.array([GROUND, 0.0])
    coupler, rocker = (mechanism.beam(*ends, SIDE, 2 * elements) for ends in ((b, c), (d, c)))
    mechanism.pinned(mechanism.ends[1], mechanism.at(coupler[0]))
    mechanism.pinned(mechanism.ground(d), mechanism.at(rocker[0]))
    mechanism.pinned(mechanism.at(coupler[-1]), mechanism.at(rocker[-1]))
    return mechanism.solved(coupler[len(coupler) // 2], elements, steps)


def error(places: list, exact: list) -> float:
    """Largest distance [mm]."""
    return float(1e3 * np.abs(np.array(places) - np.array(exact)).max())


Solver = Callable[..., dict[str, Any]]


def compare(script: str, about: str, flexarm: Solver, exudyn: Solver) -> None:
    """Print the finest runs of both codes, then a table; the same script solves in other processes."""
    if len(sys.argv) > 1 and sys.argv[1].startswith("{"):
        order = json.loads(sys.argv[1])
        solve_here = exudyn if order["code"] == "exudyn" else flexarm
        more = {"consistent_forces": True} if order["code"] == "flexarm, default" else {}
        print(json.dumps([solve_here(*case, **more) for case in order["cases"]]))
        return
    parser = argparse.ArgumentParser(description=about.splitlines()[0])
    parser.add_argument("--exudyn-python", help="interpreter that has EXUDYN")
    parser.add_argument("--rounds", type=int, default=5)
    chosen = parser.parse_args()
    pythons = dict.fromkeys(("flexarm", "flexarm, default"), sys.executable)
    pythons["exudyn"] = measure.exudyn_python(chosen.exudyn_python)

    def solve(code: str, cases: list[tuple[int, int]]) -> list[dict[str, Any]]:
        return measure.run(pythons[code], script, {"code": code, "cases": cases}).answer

    grid = [(n, steps) for n in ELEMENTS for steps in STEPS]
    finest, seen = {}, {}
    for code in pythons:
        finest[code], *found = solve(code, [FINEST, *grid])
        seen[code] = {
            case: {**run, "error": error(run["places"], finest[code]["places"])}
            for case, run in zip(grid, found, strict=True)
        }
    apart = error(finest["flexarm"]["places"], finest["exudyn"]["places"])
    moved = error(finest["exudyn"]["places"], [finest["exudyn"]["places"][0]] * len(INSTANTS))
    told = f"{1e3 * apart:.1f} micrometres apart, of motions of {moved:.0f} mm"
    print(f"finest runs, {2 * FINEST[0]} elements and {FINEST[1]} steps: {told}")
    print("| error at most | code | elements, step | error (mm) | solver (s) | a step (us) | x flexarm |")
    print("|---|---|---|---|---|---|---|")
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
            spread = measure.Spread.of(cpu[code])
            step = f"{1e6 * spread.median / steps:.3g}"
            print(
                f"| {limit:g} mm | {code} | {2 * n}, {1e3 * END / steps:.3g} ms "
                f"| {seen[code][n, steps]['error']:.3f} | {spread.text()} | {step} "
                f"| {measure.ratio(cpu[code], cpu['flexarm']).text()} |"
            )


if __name__ == "__main__":
    compare("four_bar.py", __doc__, with_flexarm, with_exudyn)
