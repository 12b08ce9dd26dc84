"""Wrong calls of the library: each argument of each public callable in turn replaced by what it cannot be."""

from __future__ import annotations

import datetime
import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from torture.campaign import Campaign
from torture.sandbox import Case, Step


class Nothing:
    """An object that no one knows."""

    def __repr__(self) -> str:
        return "Nothing()"


WRONG: tuple[object, ...] = (
    None, True, -1, 0, 1, 2.5, 1e300, -1e300, 10**400, float("nan"), float("inf"), 1j, "", "nobody",
    "x" * 5000, "a\x00b", b"hinge", [], [None], ["nobody"], [1.0, "x"], [[1.0], [1.0, 2.0]], {}, {1: 2},
    {"nobody": 1.0}, {"hinge": None}, {"hinge": "x"}, {"hinge": float("nan")}, {"hinge": 1e300}, set(),
    iter(()), np.zeros(0), np.zeros((2, 3)), np.full(3, np.nan), np.array(["x"]), np.array(None),
    np.zeros((0, 3)), Nothing(), Nothing, max, Ellipsis, datetime.date(2026, 1, 1), Path("nobody"), Path("/"),
    range(3),
)  # fmt: skip


@dataclass(frozen=True)
class Call:
    """A right call: the function's name, and its arguments by name (positions as numbers)."""

    name: str
    function: Callable[..., object]
    arguments: Mapping[str | int, Any]

    def made(self, changed: Mapping[str | int, Any]) -> object:
        arguments = {**self.arguments, **changed}
        places = sorted(key for key in arguments if isinstance(key, int))
        named = {key: value for key, value in arguments.items() if isinstance(key, str)}
        return self.function(*(arguments[place] for place in places), **named)


def _effects() -> dict[str, tuple[Callable[..., object], dict[str | int, Any]]]:
    """Effects with all that they state; whether they fit an arm is asked elsewhere."""
    from flexarm import effects

    stated = {
        "Backlash": {"at": "hinge", "gap": 1e-3},
        "JointCompliance": {"at": "hinge", "stiffness": 1e5, "damping": 10.0},
        "PayloadOffset": {"at": "load", "offset": [0.0, 0, 0.1]},
        "LinkBow": {"at": "rod", "tip_offset": [0.0, 0, 0.01], "time_constant": 10.0},
        "TabulatedLaw": {"at": "hinge", "quantity": "torque", "of": "rate", "x": [0.0, 1], "value": [0.0, 1]},
    }
    return {f"effects.{name}": (getattr(effects, name), dict(values)) for name, values in stated.items()}


@cache
def right(seeds: Path) -> tuple[Call, ...]:
    """A right call of each public callable; wrong ones differ from it in one argument."""
    import flexarm
    from flexarm.reduction import InterfaceSet

    arm = flexarm.Arm.from_toml(seeds / "example" / "arm.toml")
    record = flexarm.Record.load(seeds / "example" / "slow")
    t = [0.0, 0.01, 0.02, 0.03]
    drive = flexarm.Drive.from_samples(t, {"hinge": [0.1, 0.1, 0.11, 0.11]})
    run = flexarm.simulate(arm, drive)
    stepper = flexarm.Stepper(arm, {"hinge": "torque"}, forces=("tip",))
    state = stepper.start()
    mesh = flexarm.read_mesh(seeds / "bar.inp", "mm")
    element = flexarm.SuperElement.load(seeds / "element.nc")
    linear = flexarm.LinearModel.load(seeds / "linear.nc")
    signal = record.signals["tip"]
    other = flexarm.Record.load(seeds / "example" / "responses")
    found, fit = flexarm.Diagnosis.load(seeds / "diagnosis"), flexarm.Calibration.load(seeds / "fit")
    statics, shapes = flexarm.Statics.load(seeds / "statics.nc"), flexarm.Modes.load(seeds / "modes.nc")
    compared = flexarm.compare(arm, record)
    planned = flexarm.plan(arm, [drive], n_jobs=1)
    steel = mesh.materials or next(iter(arm.links)).material
    slopes = flexarm.static(arm, {"hinge": 0.1}, sensitivities=["payloads.load.mass"]).sensitivities
    matrices = {"grids": seeds / "grids.bdf", "order": "11 7 23", "unit": "mm", "interfaces": {"foot": 11}}
    calls: dict[str, tuple[Callable[..., object], dict[str | int, Any]]] = {
        "Arm": (
            flexarm.Arm,
            {"name": "x", "gravity": (0, 0, -9.8), "joints": arm.joints, "links": arm.links},
        ),
        "Arm.from_toml": (flexarm.Arm.from_toml, {0: seeds / "crane.toml"}),
        "Arm.from_dict": (flexarm.Arm.from_dict, {0: arm.to_dict()}),
        "Arm.to_toml": (arm.to_toml, {0: "new.toml"}),
        "Arm.joint": (arm.joint, {0: "hinge"}),
        "Arm.link": (arm.link, {0: "rod"}),
        "Arm.with_effect": (arm.with_effect, {0: arm.effects[0]}),
        "Arm.replace": (arm.replace, {"name": "x", "links": arm.links, "uncertainty": {}}),
        "Drive.from_samples": (flexarm.Drive.from_samples, {0: t, 1: {"hinge": [0.0] * 4}, "side": "motor"}),
        "Drive.from_csv": (flexarm.Drive.from_csv, {0: seeds / "drive.csv", 1: arm}),
        "Drive.from_record": (flexarm.Drive.from_record, {0: record, 1: arm}),
        "JointDrive": (flexarm.JointDrive, {0: np.arange(3.0), 1: np.zeros((2, 4)), 2: "motor"}),
        "Record.load": (flexarm.Record.load, {0: seeds / "example" / "slow"}),
        "Record.save": (record.save, {0: "record", "force": True}),
        "Record": (flexarm.Record, {"signals": record.signals, "drive": ("hinge",), "clocks": record.clocks}),
        "Record.check": (record.check, {0: arm}),
        "Record.replace": (record.replace, {"description": "x", "drive": ("hinge",), "joints": {}}),
        "Record.applied_to": (record.applied_to, {0: arm}),
        "Signal": (
            flexarm.Signal,
            {
                "name": "tip",
                "quantity": "position",
                "values": np.zeros((4, 2)),
                "time": np.arange(4.0),
                "unit": "m",
                "noise_std": 1e-3,
                "point": "tip",
                "axes": ("x", "z"),
            },
        ),
        "Signal.replace": (signal.replace, {"values": signal.values, "time": signal.time}),
        "simulate": (
            flexarm.simulate,
            {0: arm, 1: drive, "step": 2e-3, "alpha": -0.05, "end": 0.03, "forces": True, "dimension": "auto"}
            | {"sensitivities": ("payloads.load.mass",), "progress": None},
        ),
        "simulate_all": (flexarm.simulate_all, {0: [(arm, drive)], "n_jobs": 1, "step": 2e-3}),
        "static": (
            flexarm.static,
            {0: arm, 1: {"hinge": 0.1}, 2: {"tip": [1.0, 0, 0]}, "at_link": (), "sensitivities": ()},
        ),
        "modes": (
            flexarm.modes,
            {0: arm, 1: {"hinge": 0.1}, "count": 3, "gravity": True, "sensitivities": ()},
        ),
        "linearise": (
            flexarm.linearise,
            {0: arm, 1: {"hinge": 0.1}, "inputs": [("hinge", "torque")], "outputs": ["tip"], "modes": 2},
        ),
        "LinearModel.save": (linear.save, {0: "new.mat"}),
        "LinearModel.load": (flexarm.LinearModel.load, {0: seeds / "linear.mat"}),
        "measure": (
            flexarm.measure,
            {0: run, 1: arm.sensors[:1], 2: np.random.default_rng(0), "drive": ("hinge",), "clocks": None},
        ),
        "compare": (
            flexarm.compare,
            {0: arm, 1: record, 2: True, "step": 4e-3, "alpha": -0.05, "bands": [0, 1.0, 2.0]},
        ),
        "Simulation.save": (run.save, {0: "new.nc"}),
        "Simulation.load": (flexarm.Simulation.load, {0: seeds / "run" / "simulation.nc"}),
        "Simulation.at": (run.at, {0: [0.01], 1: "tip"}),
        "Statics.load": (flexarm.Statics.load, {0: seeds / "statics.nc"}),
        "Modes.load": (flexarm.Modes.load, {0: seeds / "modes.nc"}),
        "Diagnosis.load": (flexarm.Diagnosis.load, {0: seeds / "diagnosis"}),
        "diagnose": (flexarm.diagnose, {0: arm, 1: [], 2: None, "n_jobs": 1, "seed": 0, "step": 4e-3}),
        "plan": (flexarm.plan, {0: arm, 1: [], "n_jobs": 1, "step": 4e-3}),
        "read_mesh": (flexarm.read_mesh, {0: seeds / "bar.inp", 1: "mm", 2: None, "merge": 0.0}),
        "InterfaceSet": (InterfaceSet, {0: "foot", 1: "rigid", 2: [0.0, 0, 0], 3: np.eye(3)}),
        "reduce_mesh": (
            flexarm.reduce_mesh,
            {0: mesh, 1: {"foot": "foot"}, "modes": 1, "damping_ratio": 0.0, "mass": None, "name": "x"},
        ),
        "SolidMesh": (flexarm.SolidMesh, {0: mesh.points, 1: mesh.cells, "point_sets": {}, "materials": {}}),
        "SuperElement": (
            flexarm.SuperElement,
            {
                name: getattr(element, name)
                for name in (
                    *("name", "interfaces", "positions", "rotations", "stiffness"),
                    *("mass", "damping", "frequency_hz"),
                )
            },
        ),
        "SuperElement.load": (flexarm.SuperElement.load, {0: seeds / "element.nc"}),
        "SuperElement.save": (element.save, {0: "new.nc", 1: True}),
        "SuperElement.check": (element.check, {"mass": 3.3, "tolerance": 1e-5}),
        "accept_matrices": (
            flexarm.accept_matrices,
            {
                0: seeds / "K.mtx",
                1: seeds / "M.mtx",
                **matrices,
                "mass": None,
                "tolerance": 1e-5,
                "name": "x",
            },
        ),
        "Stepper": (
            flexarm.Stepper,
            {0: arm, 1: {"hinge": "torque"}, "forces": ("tip",), "step": 2e-3, "alpha": -0.05},
        ),
        "Stepper.start": (stepper.start, {0: {"hinge": 0.1}, 1: {"tip": [0, 0, 1.0]}}),
        "Stepper.step": (stepper.step, {0: state, 1: {"hinge": 1.0}, 2: {"tip": [0, 0, 1.0]}}),
        "Stepper.joint": (stepper.joint, {0: state, 1: "hinge"}),
        "Stepper.point": (stepper.point, {0: state, 1: "tip"}),
        "Stepper.sensor": (stepper.sensor, {0: state, 1: "tip"}),
        "State.save": (state.save, {0: "new.npz"}),
        "State.load": (flexarm.State.load, {0: seeds / "state.npz"}),
        "load": (flexarm.load, {0: seeds / "statics.nc"}),
        "config": (flexarm.config, {}),
        "show_config": (flexarm.show_config, {}),
        "import_record": (flexarm.import_record, {0: seeds / "logs" / "motive.csv.toml"}),
        "compare_responses": (flexarm.compare_responses, {0: arm, 1: other}),
        "calibrate": (
            flexarm.calibrate,
            {0: arm, 1: [], 2: ["joint_compliance"], 3: None, "n_jobs": 1, "step": 4e-3, "max_seconds": 1},
        ),
        "CalibrationPolicy": (flexarm.CalibrationPolicy, {"sizes": 9, "tolerance": 0.2}),
        "SelectionPolicy": (flexarm.SelectionPolicy, {"blocks": 24, "moves": ("pairs",)}),
        "Calibration.load": (flexarm.Calibration.load, {0: seeds / "fit"}),
        "Calibration.save": (fit.save, {0: "record", "force": True}),
        "Calibration.parameter": (fit.parameter, {0: fit.parameters[0].name}),
        "Calibration.gap": (fit.gap, {0: fit.training, 1: "tip"}),
        "campaign": (
            flexarm.campaign,
            {0: seeds / "example" / "study.toml", 1: "record", "n_jobs": 1, "resume": False, "force": True},
        ),
        "Campaign.load": (flexarm.Campaign.load, {0: seeds / "study"}),
        "Comparison.plot": (compared.plot, {"ax": None, "signal": "tip"}),
        "Plan.effect": (planned.effect, {0: planned.effects[0].name, 1: planned.effects[0].at}),
        "Plan.save": (planned.save, {0: "record", "force": True}),
        "Diagnosis.save": (found.save, {0: "record", "force": True}),
        "Diagnosis.gap": (found.gap, {0: found.training, 1: "tip"}),
        "Diagnosis.plot": (found.plot, {"ax": None, "record": None}),
        "Diagnosis.view": (found.view, {"record": None, "scale": 1.0, "urdf": None}),
        "export_urdf": (
            flexarm.export_urdf,
            {0: arm, 1: seeds / "example" / "robot.urdf", 2: "new.toml"},
        ),
        "export_mjcf": (flexarm.export_mjcf, {0: arm, 1: seeds / "example" / "robot.xml", 2: "new.toml"}),
        "export_part": (flexarm.export_part, {0: element, 1: "new.mat", "unit": "m"}),
        "Sensitivities.by": (slopes.by, {0: "payloads.load.mass"}),
        "Arm.without_effect": (arm.without_effect, {0: arm.effects[0].name, 1: arm.effects[0].at}),
        "Arm.sigma": (arm.sigma, {0: next(iter(arm.uncertainty), "payloads.load.mass")}),
        "Arm.view": (arm.view, {"joints": {"hinge": 0.1}, "urdf": None}),
        "Arm.plot": (arm.plot, {"ax": None, "joints": {"hinge": 0.1}}),
        "Simulation.view": (run.view, {"record": None, "scale": 1.0, "urdf": None}),
        "Simulation.plot": (run.plot, {"point": "tip", "ax": None}),
        "Statics.view": (statics.view, {"scale": 1.0, "urdf": None}),
        "Statics.save": (statics.save, {0: "new.nc"}),
        "Modes.view": (shapes.view, {"urdf": None}),
        "Modes.plot": (shapes.plot, {"ax": None, "mode": 1}),
        "Record.to_parquet": (record.to_parquet, {0: "new.npz"}),
        "LinearModel.frequency_response": (linear.frequency_response, {0: [1.0, 2.0]}),
        "SolidMesh.moved": (mesh.moved, {"rotation": np.eye(3), "translation": [0.0, 0, 0]}),
        "SolidMesh.joined": (mesh.joined, {0: mesh, "tolerance": 0.0}),
        "SolidMesh.merged": (mesh.merged, {0: 1e-9}),
        "SolidMesh.with_materials": (mesh.with_materials, {0: steel}),
        "SolidMesh.with_point_set": (mesh.with_point_set, {0: "new", 1: [0, 1]}),
        "SolidMesh.points_in_box": (mesh.points_in_box, {0: [-1.0] * 3, 1: [1.0] * 3}),
        "SolidMesh.save": (mesh.save, {0: "new.vtu", "force": True}),
        "SuperElement.moved": (element.moved, {0: np.eye(3), "translation": [0.0, 0, 0]}),
        "SuperElement.interface": (element.interface, {0: element.interfaces[0]}),
        "SuperElement.view": (element.view, {"mesh": None}),
        "InterfaceSet.from_text": (InterfaceSet.from_text, {0: "foot:rigid"}),
        "Drive.at_inputs": (drive.at_inputs, {0: arm}),
        "JointDrive.held": (flexarm.JointDrive.held, {0: t, 1: [0.0] * 4}),
        "Arm.with_value": (arm.with_value, {0: "payloads.load.mass", 1: 5.0}),
        "BaseStand": (flexarm.BaseStand, {"tilt": (0.0, 1e-3), "sigma": 1e-4}),
        "CarriedPayload": (flexarm.CarriedPayload, {"mass": 5.0, "inertia": (0.1, 0.1, 0.1)}),
        "Clock": (flexarm.Clock, {"offset": 0.0, "sigma": 0.01}),
        "DrawnLink": (flexarm.DrawnLink, {"length": 2.0}),
        "Frame": (flexarm.Frame, {"xyz": (0.0, 0, 0), "rotation": 1e-3, "unknown": False}),
        "Sensor": (flexarm.Sensor, arm.sensors[0].to_plain()),
        **_effects(),
    }
    return tuple(Call(name, function, arguments) for name, (function, arguments) in calls.items())


WRITES = (
    *("new.toml", "new.mat", "new.nc", "new.npz", "new.vtu", "record", "1", "nobody", "x" * 5000),
    *(f"new.mat{ending}" for ending in (".bdf", ".inp", ".op4")),
)


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    call = right(seeds)[number % len(right(seeds))]
    key = rng.choice(list(call.arguments) or ["nothing"])
    value = rng.choice(WRONG)
    label = f"flexarm.{call.name} with {key}={repr(value)[:60]}"
    step = Step(label, lambda: (call.made({key: value}), None)[1], writes=WRITES)
    return Case(label, (step,))


CAMPAIGN = Campaign("calls", "wrong calls of the library", case, 8000, 240)
