"""Arguments of a wrong type or shape are refused by name before any work is done."""

import inspect
import subprocess
import sys
import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import flexarm
from flexarm import (
    Arm,
    Drive,
    InterfaceSet,
    InvalidFile,
    InvalidParameter,
    JointDrive,
    Record,
    Signal,
    Simulation,
    SolidMesh,
    Stepper,
    accept_matrices,
    campaign,
    compare,
    compare_responses,
    diagnose,
    linearise,
    measure,
    modes,
    plan,
    read_mesh,
    reduce_mesh,
    simulate,
    simulate_all,
    static,
)
from flexarm.effects import JointCompliance
from flexarm.record.table import Clock
from flexarm.solids import ring
from flexarm.superelement import SuperElement

SIGNAL = Signal(name="tip", quantity="position", values=np.zeros((2, 3)), time=[0.0, 1.0], point="tip")

WRONG = [b"x", [1, 2], np.zeros((3, 3)), {"nobody": "x"}, {"nobody": [1, 2]}, object()]
KINDS = ["bytes", "list", "matrix", "texts", "lists", "object"]


@pytest.fixture(scope="module")
def arm(model_text: str) -> Arm:
    """The arm of the crane."""
    return Arm.from_dict(tomllib.loads(model_text))


@pytest.mark.parametrize("wrong", WRONG, ids=KINDS)
@pytest.mark.parametrize(
    ("function", "names"),
    [
        (static, ["arm", "joints", "forces", "at_link", "sensitivities"]),
        (modes, ["arm", "joints", "count", "sensitivities"]),
        (simulate, ["arm", "drive", "step", "alpha", "end", "sensitivities"]),
        (linearise, ["arm", "joints", "inputs", "modes"]),
        (Stepper, ["arm", "inputs", "step", "alpha", "forces"]),
        (Arm.from_toml, ["path"]),
        (Record.load, ["path"]),
        (Simulation.load, ["path"]),
        (SuperElement.load, ["path"]),
        (Drive.from_csv, ["path", "arm"]),
    ],
)
def test_a_wrong_argument_is_named(
    arm: Arm, function: Callable[..., Any], names: list[str], wrong: Any
) -> None:
    sound = {"arm": arm, "inputs": {"hinge": "motor"}, "path": "arm.toml", "drive": Drive({})}
    for name in names:
        given = {key: value for key, value in sound.items() if key in names}
        with pytest.raises(InvalidParameter, match="nobody|" + name):
            function(**{**given, name: wrong})


def test_a_wrong_state_and_wrong_inputs_are_named(arm: Arm) -> None:
    stepper = Stepper(arm, {"hinge": "motor"})
    for wrong in (None, "x", [1, 2], {"hinge": 1.0}):
        with pytest.raises(InvalidParameter, match="state: must be a State"):
            stepper.step(wrong, {"hinge": 0.0})  # type: ignore[arg-type]
    for wrong in (None, "x", [1, 2]):
        with pytest.raises(InvalidParameter, match="inputs: must be a dictionary"):
            stepper.step(stepper.start(), wrong)  # type: ignore[arg-type]


def test_a_wrong_argument_is_named_before_work(arm: Arm) -> None:
    """Of each public callable each argument in turn is what it can never be."""
    record = Record(signals=[SIGNAL])
    run = simulate(arm, Drive({}, end=0.01))
    element = {"name": "x", "interfaces": ("a",), "positions": np.zeros((1, 3))}
    element |= {"rotations": np.eye(3)[None], "frequency_hz": np.zeros(0)}
    element |= {name: np.eye(6) for name in ("stiffness", "mass", "damping")}
    calls: list[tuple[Callable[..., Any], dict[str, Any]]] = [
        (compare, {"arm": arm, "record": record, "align": True, "bands": [1.0]}),
        (diagnose, {"arm": arm, "records": [record], "hold_out": record, "n_jobs": 1, "seed": 0}),
        (plan, {"arm": arm, "drives": [Drive({})], "n_jobs": 1, "clocks": {}}),
        (simulate_all, {"runs": [], "n_jobs": 1}),
        (campaign, {"study": "x", "out": "y", "resume": False, "scheduler": "z", "n_jobs": 1}),
        (measure, {"simulation": run, "sensors": [], "rng": None, "drive": (), "clocks": {}}),
        (Drive.from_record, {"record": record, "arm": arm}),
        (Drive.from_samples, {"time": [0.0, 1.0], "values": {"hinge": [0.0, 1.0]}, "side": "motor"}),
        (JointDrive, {"breaks": [0.0, 1.0], "coefficients": [[0.0]], "side": "motor"}),
        (Record, {"signals": [SIGNAL], "drive": (), "clocks": {"clock": Clock()}, "joints": {}}),
        (record.check, {"arm": arm}),
        (record.applied_to, {"arm": arm}),
        (record.save, {"path": "new"}),
        (Signal, {"name": "s", "quantity": "time", "values": [], "noise_std": 1.0, "axes": ()}),
        (SuperElement, element),
        (SolidMesh, {"points": np.zeros((1, 3)), "cells": {}, "point_sets": {}, "materials": {}}),
        (read_mesh, {"path": "x", "unit": "m", "materials": None, "merge": 0.0}),
        (reduce_mesh, {"mesh": "x", "interfaces": {}, "mass": 1.0, "damping_ratio": 0.0, "name": "x"}),
        (accept_matrices, {"stiffness": "x", "grids": "x", "interfaces": {}, "mass": 1.0, "tolerance": 0.1}),
        (arm.to_toml, {"path": "x"}),
        (arm.joint, {"name": "hinge"}),
        (Stepper(arm, {"hinge": "motor"}).start, {"joints": {}, "forces": {}}),
    ]
    for function, sound in calls:
        for name in sound.keys() - {"rng"}:
            for wrong in (object(), 1j, b"x", {1: object()}):
                if name in ("records", "runs") and isinstance(wrong, bytes | dict):
                    continue  # looked at one by one
                with pytest.raises(InvalidParameter, match=f"^{name}: must be"):
                    function(**{**sound, name: wrong})


@pytest.mark.parametrize("jobs", [float("nan"), 0, -1, 10**60, "2", True])
def test_a_number_of_jobs_is_a_whole_number_of_at_least_one(arm: Arm, jobs: Any) -> None:
    with pytest.raises(InvalidParameter, match="jobs: must be a whole number of at least 1"):
        simulate_all([(arm, Drive({}))], n_jobs=jobs)


def test_the_number_of_jobs_is_taken_by_its_former_name(arm: Arm) -> None:
    runs = [(arm, Drive({}, end=0.01))]
    with pytest.warns(DeprecationWarning, match="simulate_all: jobs is now n_jobs"):
        [other] = simulate_all(runs, jobs=1)  # type: ignore[call-arg]
    [one] = simulate_all(runs, n_jobs=1)
    assert np.array_equal(one.position, other.position)
    with (
        pytest.warns(DeprecationWarning),
        pytest.raises(InvalidParameter, match="n_jobs: must be a whole number"),
    ):
        simulate_all(runs, jobs=0)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="jobs"):
        simulate_all(runs, jobs=1, n_jobs=1)  # type: ignore[call-arg]


def test_the_name_of_an_arm_can_be_printed() -> None:
    for name in ("a\x00", "a\u202e", "x" * 5000):
        with pytest.raises(InvalidParameter, match="name"):
            Arm.from_dict({"name": name, "joints": [], "links": []})


def test_a_value_inside_a_dictionary_is_shown(arm: Arm) -> None:
    with pytest.raises(InvalidParameter, match=r"got \{'boom': '0.3'\}"):
        static(arm, joints={"boom": "0.3"})  # type: ignore[dict-item]


def test_an_effect_takes_values_by_name() -> None:
    with pytest.raises(
        InvalidParameter, match="JointCompliance takes values by name, at=, stiffness=, damping="
    ):
        JointCompliance("boom", 3e4)  # type: ignore[call-arg]


def test_the_signature_of_an_effect_tells_types_and_defaults() -> None:
    told = "(*, at: str, stiffness: float = inf, damping: float = 0.0)"
    assert str(inspect.signature(JointCompliance)) == told


def test_completion_lists_public_names_once_and_nothing_else() -> None:
    assert [name for name in dir(flexarm) if not name.startswith("_")] == sorted(
        [*flexarm.__all__, "diagnosis", "effects"]
    )
    assert len(dir(flexarm)) == len(set(dir(flexarm)))


def test_what_a_record_is_made_of_is_public() -> None:
    """One had to know the modules of clocks, frames, payloads and sensors."""
    assert {"BaseStand", "CarriedPayload", "Clock", "DrawnLink", "Frame", "Sensor"} <= set(dir(flexarm))


def test_completion_lists_every_effect() -> None:
    named = {"".join(map(str.capitalize, name.split("_"))) for name in flexarm.effects.KNOWN_EFFECTS}
    assert named <= set(dir(flexarm.effects))


@pytest.mark.parametrize(
    ("name", "told"),
    [("effects.Backlash", "Backlash"), *((f"diagnosis.{step}", step) for step in flexarm.diagnosis.__all__)],
)
def test_effects_and_steps_of_a_diagnosis_are_there_without_an_import(name: str, told: str) -> None:
    module = name.split(".")[0]
    code = f"import flexarm; print(flexarm.{name}.__name__, '{told}' in dir(flexarm.{module}))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == f"{told} True\n"


def test_a_wrong_argument_of_a_method_is_named(arm: Arm) -> None:
    part, found = ring(0.1, 0.2, 0.1, size=0.1, around=8), static(arm, sensitivities=["payloads.load.mass"])
    slopes, free = found.sensitivities, linearise(arm, inputs=[("hinge", "acceleration")])
    assert slopes is not None
    calls: list[tuple[str, Callable[[], Any]]] = [
        ("key", lambda: arm.sigma("nobody")),
        ("at", lambda: arm.without_effect("backlash", np.zeros(2))),  # type: ignore[arg-type]
        ("urdf", lambda: arm.view(urdf=3)),  # type: ignore[arg-type]
        ("path", lambda: arm.to_toml("")),
        ("key", lambda: slopes.by(np.zeros(0))),  # type: ignore[arg-type]
        ("moves", lambda: flexarm.SelectionPolicy(moves=0)),  # type: ignore[arg-type]
        ("frequency_hz", lambda: free.frequency_response(0.0)),
        ("scale", lambda: found.view(scale="x")),  # type: ignore[arg-type]
        ("ax", lambda: found.plot(ax={})),  # type: ignore[arg-type]
        ("tolerance", lambda: part.merged({})),  # type: ignore[arg-type]
        ("other", lambda: part.joined("part.inp")),  # type: ignore[arg-type]
        ("lower", lambda: part.points_in_box([1.0], [1.0] * 3)),
        ("rotation", lambda: part.moved(np.diag([1.0, 1.0, -1.0]))),
        ("text", lambda: InterfaceSet.from_text({})),  # type: ignore[arg-type]
        ("values", lambda: JointDrive.held([0.0, 1.0], [1.0])),  # type: ignore[arg-type]
        ("arm", lambda: Drive({}).at_inputs([])),  # type: ignore[arg-type]
        ("record", lambda: compare_responses(arm, {})),  # type: ignore[arg-type]
    ]
    for name, call in calls:
        with pytest.raises(InvalidParameter, match=f"^{name}: "):
            call()
    with pytest.raises(InvalidFile):
        arm.view(urdf="a\0b")
