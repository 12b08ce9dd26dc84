"""The benchmark arm in EXUDYN: with skill, planar and spatial, and as its manual's examples go about it.

With skill means: the fast module, gravity and spring as built-in items, the drive as a symbolic function
that is evaluated without Python, modified Newton (the default), tolerances no tighter than the error asked
for, the faster of its linear solvers, no files. The spring between motor and arm, T = k (q(t) − θ), is a
linear spring to the ground and a load k q(t), as loads are cheaper than user functions of connectors.

As the examples go about it means: the default module and settings, two-node elements, and a spring whose
torque is a Python function.

The arm hangs along x, gravity along +x; the angle grows towards y.
"""

import math
import sys
import time
from itertools import pairwise

sys.exudynFast = "manual" not in " ".join(sys.argv[1:])

import exudyn as exu  # noqa: E402
import exudyn.itemInterface as item  # noqa: E402
import numpy as np  # noqa: E402
import problem  # noqa: E402
from exudyn.advancedUtilities import CreateSymbolicUserFunction  # noqa: E402
from exudyn.beams import GenerateBeamElementsAlongLine  # noqa: E402

EA = problem.YOUNGS_MODULUS * problem.AREA
EI = problem.YOUNGS_MODULUS * problem.SECOND_MOMENT
G = problem.YOUNGS_MODULUS / (2 * (1 + problem.POISSON_RATIO))
GA, GJ = G * problem.SHEAR_FACTOR * problem.AREA, 2 * G * problem.SECOND_MOMENT
RHO_A, RHO_I = problem.DENSITY * problem.AREA, problem.DENSITY * problem.SECOND_MOMENT


DENSE_UP_TO = 16
"""Nodes of a planar arm up to which EXUDYN's own dense solver is faster than its sparse one (measured)."""


def symbolic_angle(t):
    """q(t) of problem.py as an expression tree; `t` is one too."""
    x = t / problem.RAMP
    rise = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    s = exu.symbolic.IfThenElse(x < 1.0, rise, exu.symbolic.Real(1.0) + 0.0 * t)
    return problem.AMPLITUDE * exu.symbolic.sin(2 * math.pi * problem.FREQUENCY * t) * s


def plain_angle(t):
    """q(t) for Python user functions, without numpy's overhead."""
    x = min(t / problem.RAMP, 1.0)
    s = x**3 * (10 - 15 * x + 6 * x**2)
    return problem.AMPLITUDE * math.sin(2 * math.pi * problem.FREQUENCY * t) * s


def planar(mbs, case):
    """Geometrically exact beams in the plane (shear, rotary inertia); `nodes` 3: quadratic, 2: linear."""
    beam = item.ObjectBeamGeometricallyExact2D(
        nodeNumbers=[0] * case.get("nodes", 3),
        massPerLength=RHO_A,
        crossSectionInertia=RHO_I if case.get("theory", "timoshenko") == "timoshenko" else 0.0,
        axialStiffness=EA,
        shearStiffness=GA,
        bendingStiffness=EI,
    )
    gravity = [problem.GRAVITY, 0, 0]
    arm = GenerateBeamElementsAlongLine(
        mbs,
        [0, 0, 0],
        [problem.LENGTH, 0, 0],
        case["elements"],
        beam,
        gravity=gravity,
        groundConstraintsStart=[True, True, False],
    )
    hub, tip = arm["nodes"][0], arm["nodes"][-1]
    mbs.AddObject(item.ObjectRigidBody2D(nodeNumber=tip, mass=problem.PAYLOAD, inertia=0.0))
    fixed = mbs.AddNode(item.NodePointGround())
    ground = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=fixed, coordinate=0))
    turn = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=hub, coordinate=2))
    _hang(mbs, tip)
    spring = _python_spring if case["code"] == "exudyn-manual" else _symbolic_spring
    return tip, spring(mbs, ground, turn)


def _symbolic_spring(mbs, ground, turn):
    """A linear spring and a symbolic load."""

    def torque(mbs, t, load):
        return problem.SPRING * symbolic_angle(t)

    function = CreateSymbolicUserFunction(mbs, torque, "loadUserFunction", itemTypeName="LoadCoordinate")
    mbs.AddObject(item.CoordinateSpringDamper(markerNumbers=[ground, turn], stiffness=problem.SPRING))
    mbs.AddLoad(item.LoadCoordinate(markerNumber=turn, loadUserFunction=function))
    return function


def _python_spring(mbs, ground, turn):
    """A spring whose torque is a Python function."""

    def torque(mbs, t, number, rotation, rate, stiffness, damping, offset):
        return stiffness * (rotation - plain_angle(t))

    spring = item.CoordinateSpringDamper(
        markerNumbers=[ground, turn], stiffness=problem.SPRING, springForceUserFunction=torque
    )
    mbs.AddObject(spring)
    return torque


def _hang(mbs, tip):
    """Weight of the payload."""
    marker = mbs.AddMarker(item.MarkerNodePosition(nodeNumber=tip))
    weight = [problem.PAYLOAD * problem.GRAVITY, 0, 0]
    mbs.AddLoad(item.LoadForceVector(markerNumber=marker, loadVector=weight))


def spatial(mbs, case):
    """Two-node geometrically exact beams in space, on Lie group nodes."""
    section = exu.BeamSection()
    section.stiffnessMatrix = np.diag([EA, GA, GA, GJ, EI, EI])
    section.inertia = np.diag([2 * RHO_I, RHO_I, RHO_I])
    section.massPerLength = RHO_A
    n = case["elements"]
    length = problem.LENGTH / n
    nodes = [
        mbs.AddNode(item.NodeRigidBodyRotVecLG(referenceCoordinates=[k * length, 0, 0, 0, 0, 0]))
        for k in range(n + 1)
    ]
    for ends in pairwise(nodes):
        beam = item.ObjectBeamGeometricallyExact(nodeNumbers=list(ends), length=length, sectionData=section)
        body = mbs.AddObject(beam)
        mass = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=body))
        mbs.AddLoad(item.LoadMassProportional(markerNumber=mass, loadVector=[problem.GRAVITY, 0, 0]))
    point = item.ObjectMassPoint(nodeNumber=nodes[-1], mass=problem.PAYLOAD)
    mbs.AddObject(point)
    _hang(mbs, nodes[-1])
    hub = mbs.AddMarker(item.MarkerNodeRigid(nodeNumber=nodes[0]))
    ground = mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=mbs.AddObject(item.ObjectGround())))
    mbs.AddObject(item.GenericJoint(markerNumbers=[ground, hub], constrainedAxes=[1, 1, 1, 1, 1, 0]))
    return nodes[-1], _spatial_spring(mbs, [ground, hub])


def _spatial_spring(mbs, markers):
    """The same spring and symbolic load between frames in space."""

    def torque(mbs, t, load):
        return exu.symbolic.Vector([0.0, 0.0, problem.SPRING * symbolic_angle(t)])

    function = CreateSymbolicUserFunction(
        mbs, torque, "loadVectorUserFunction", itemTypeName="LoadTorqueVector"
    )
    mbs.AddObject(item.TorsionalSpringDamper(markerNumbers=markers, stiffness=problem.SPRING))
    mbs.AddLoad(item.LoadTorqueVector(markerNumber=markers[1], loadVectorUserFunction=function))
    return function


def settings(case):
    """Generalised alpha with spectral radius 0.9.

    `tolerance` is Newton's, relative and absolute, for residuals; `increments` one for increments instead,
    which many small spatial elements need, as there the residual has a floor above any useful tolerance.
    """
    s = exu.SimulationSettings()
    s.timeIntegration.endTime = case["end"]
    s.timeIntegration.numberOfSteps = case["steps"]
    s.timeIntegration.verboseMode = 0
    s.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    s.timeIntegration.adaptiveStep = False  # where Newton fails, the setting fails
    s.solution.file.write = False
    s.solution.sensors.writePeriod = 1.0
    newton = s.timeIntegration.newton
    if "tolerance" in case:
        newton.relativeTolerance, newton.absoluteTolerance = case["tolerance"]
    if "increments" in case:
        newton.residualMode = 1
        newton.relativeTolerance = newton.absoluteTolerance = case["increments"]
    if case["code"] == "exudyn-3d":  # without it Newton's iteration stalls above tolerances of 1e-4
        s.timeIntegration.generalizedAlpha.lieGroupSimplifiedKinematicRelations = True
    nodes = case["elements"] * (case.get("nodes", 3) - 1) + 1
    if case["code"] == "exudyn-3d" or nodes > DENSE_UP_TO:
        s.timeIntegration.generalizedAlpha.lieGroupAddTangentOperator = False  # the sparse solver's condition
        s.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return s


def solve(case):
    """One run; `case` holds code, elements, steps, end and settings. CPU seconds of SolveDynamic alone."""
    system = exu.SystemContainer().AddSystem()
    tip, function = (spatial if case["code"] == "exudyn-3d" else planar)(system, case)
    sensor = system.AddSensor(
        item.SensorNode(
            nodeNumber=tip,
            storeInternal=True,
            writeToFile=False,
            outputVariableType=exu.OutputVariableType.Position,
        )
    )
    system.Assemble()
    chosen = settings(case)
    began = time.process_time()
    system.SolveDynamic(chosen)
    seconds = time.process_time() - began
    del function  # the expression tree had to outlive the run
    t, x, y = system.GetSensorStoredData(sensor)[:, :3].T
    return {"cpu": seconds, "offsets": problem.offsets_at_instants(t, x, y)}


def version():
    """Of EXUDYN."""
    return {"exudyn": exu.__version__ if hasattr(exu, "__version__") else exu.config.Version()}
