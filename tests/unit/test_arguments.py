"""Arguments of a wrong type or shape are refused by name before any work is done."""

import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from flexarm import (
    Arm,
    Drive,
    InvalidParameter,
    Record,
    Simulation,
    Stepper,
    linearise,
    modes,
    simulate,
    static,
)
from flexarm.superelement import SuperElement

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
        (Stepper, ["arm", "told", "step", "alpha", "forces"]),
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
    sound = {"arm": arm, "told": {"hinge": "motor"}, "path": "arm.toml", "drive": Drive({})}
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
