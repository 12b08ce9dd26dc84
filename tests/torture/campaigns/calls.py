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
        "simulate_all": (flexarm.simulate_all, {0: [(arm, drive)], "jobs": 1, "step": 2e-3}),
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
        "diagnose": (flexarm.diagnose, {0: arm, 1: [], 2: None, "jobs": 1, "seed": 0, "step": 4e-3}),
        "plan": (flexarm.plan, {0: arm, 1: [], "jobs": 1, "step": 4e-3}),
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
        "State.save": (state.save, {0: "new.npz"}),
        "State.load": (flexarm.State.load, {0: seeds / "state.npz"}),
    }
    return tuple(Call(name, function, arguments) for name, (function, arguments) in calls.items())


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    call = right(seeds)[number % len(right(seeds))]
    key = rng.choice(list(call.arguments))
    value = rng.choice(WRONG)
    label = f"flexarm.{call.name} with {key}={repr(value)[:60]}"
    writes = ("new.toml", "new.mat", "new.nc", "new.npz", "record", "1", "nobody", "x" * 5000)
    step = Step(label, lambda: (call.made({key: value}), None)[1], writes=writes)
    return Case(label, (step,))


CAMPAIGN = Campaign("calls", "wrong calls of the library", case, 5000, 200)
