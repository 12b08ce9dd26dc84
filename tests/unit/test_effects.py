"""Effects: found by name, written as they are, and made of the laws that their docs state."""

import numpy as np
import pytest
from arms import paper_arm

from flexarm import static
from flexarm.arm import KNOWN_EFFECTS, effect_class
from flexarm.assembly import machine_of
from flexarm.assembly.drive_train import Transmission
from flexarm.effects import (
    Backlash,
    CableTorque,
    CoulombFriction,
    DriveLag,
    Effect,
    GearRatio,
    JointCompliance,
    JointHysteresis,
    JointStiffening,
    JointTiltCompliance,
    LugreFriction,
    MotorFriction,
    TabulatedLaw,
    TransmissionError,
    ViscousFriction,
)
from flexarm.errors import InvalidParameter

EXAMPLES = [
    JointCompliance(at="hinge", stiffness=1e5, damping=30.0),
    CoulombFriction(at="hinge", torque=12.0),
    ViscousFriction(at="hinge", coefficient=3.0),
    MotorFriction(at="hinge", coulomb=5.0, viscous=2.0),
    JointStiffening(at="hinge", cubic_stiffness=5e9),
    JointHysteresis(at="hinge", torque=30.0, width=2e-4),
    Backlash(at="hinge", gap=5e-4),
    LugreFriction(
        at="hinge",
        coulomb=9.0,
        breakaway=12.0,
        bristle_stiffness=1e5,
        bristle_damping=300.0,
        viscous=3.0,
        stribeck_rate=5e-3,
    ),
    TransmissionError(at="hinge", amplitude=8e-5, multiple=2.0, phase=-1.0),
    GearRatio(at="hinge", scale=1.001),
    CableTorque(at="hinge", stiffness=20.0, rest_angle=0.4),
    JointTiltCompliance(at="hinge", stiffness=(1e5, 2e5), damping=(30.0, 60.0)),
    DriveLag(at="hinge", delay=0.01, time_constant=0.02),
    TabulatedLaw(at="hinge", quantity="torque", of="rate", x=(-0.1, 0.0, 0.3), value=(-9.0, 1.0, 20.0)),
]


BEARING = ["DahlFriction", "ViscousFriction", "LugreFriction", "CableTorque", "TabulatedTorque"]


def kinds(laws: list) -> list[str]:
    """Names of laws."""
    return [type(law).__name__ for law in laws]


@pytest.mark.parametrize("effect", EXAMPLES, ids=lambda effect: effect.name)
def test_an_effect_is_found_by_its_name_and_rebuilt_from_its_table(effect: Effect) -> None:
    table = effect.to_plain()
    assert effect_class(table.pop("name"))(**table) == effect


def test_effects_patch_the_drive_train_where_they_act() -> None:
    machine = machine_of(paper_arm(1).replace(effects=tuple(EXAMPLES)))
    train = machine.drive_trains["hinge"]
    assert (train.stiffness, train.damping) == (1e5, 30.0)
    assert (train.cubic_stiffness, train.gap, train.hysteresis) == (5e9, 5e-4, [(30.0, 2e-4)])
    assert train.transmission == Transmission(scale=1.001, amplitude=8e-5, multiple=2.0, phase=-1.0)
    assert kinds(train.bearing) == BEARING
    assert kinds(train.motor) == ["DahlFriction", "ViscousFriction"]


def test_the_machine_does_not_depend_on_the_order_of_the_file() -> None:
    forward = machine_of(paper_arm(1).replace(effects=tuple(EXAMPLES)))
    backward = machine_of(paper_arm(1).replace(effects=tuple(reversed(EXAMPLES))))
    for way in (forward, backward):
        assert kinds(way.drive_trains["hinge"].bearing) == BEARING


def test_the_structure_does_not_depend_on_values() -> None:
    """Laws with a torque of zero are there: sensitivities difference two systems of one structure."""
    still = paper_arm(1).replace(
        effects=(
            CoulombFriction(at="hinge"),
            ViscousFriction(at="hinge"),
            MotorFriction(at="hinge"),
            TransmissionError(at="hinge"),
        )
    )
    train = machine_of(still).drive_trains["hinge"]
    assert len(train.bearing) == len(train.motor) == 2
    assert train.transmission == Transmission(multiple=1.0)


def test_a_compliance_without_stiffness_leaves_the_joint_rigid() -> None:
    """A damper cannot act in a rigid joint: the tip stands as without the effect."""
    rigid = paper_arm(2)
    damped = rigid.with_effect(JointCompliance(at="hinge", damping=30.0))
    q = {"hinge": 0.8}
    assert np.array_equal(static(damped, q).position, static(rigid, q).position)


def test_parameters_are_set_by_the_names_they_are_printed_with() -> None:
    softer = EXAMPLES[0].with_parameters({"stiffness": 5e4})
    assert softer == JointCompliance(at="hinge", stiffness=5e4, damping=30.0)
    with pytest.raises(InvalidParameter, match=r"has no parameter 'stiffness\.x'; it has stiffness, damping"):
        EXAMPLES[0].with_parameters({"stiffness.x": 1.0})
    with pytest.raises(InvalidParameter, match="has no parameter 'at'"):
        EXAMPLES[0].with_parameters({"at": 1.0})
    with pytest.raises(InvalidParameter, match="stiffness: must be positive, got -1"):
        EXAMPLES[0].with_parameters({"stiffness": -1.0})


@pytest.mark.parametrize("effect", EXAMPLES, ids=lambda effect: effect.name)
def test_every_parameter_has_a_prior_and_a_derivative(effect: Effect) -> None:
    """In the parameter's unit, with a source; the values of the example are plausible."""
    priors = effect.priors(paper_arm(1))
    assert list(priors) == [name for name, _, _ in effect.parameters()]
    for name, value, unit in effect.parameters():
        assert priors[name].unit == unit
        assert priors[name].source
        assert priors[name].low < value < priors[name].high
        assert effect.derivative(name) in ("smooth", "one-sided", "none")


def test_parameters_come_with_units() -> None:
    assert EXAMPLES[0].parameters() == [("stiffness", 1e5, "N m/rad"), ("damping", 30.0, "N m s/rad")]
    assert str(EXAMPLES[1]) == "coulomb_friction at hinge: torque = 12 N m"


def test_known_effects_without_a_law_are_told_from_unknown_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KNOWN_EFFECTS, "joint_ageing", "joint")
    with pytest.raises(InvalidParameter, match=r"'joint_ageing' is known but cannot be simulated yet"):
        effect_class("joint_ageing")
    for name in ("joint_complianse", "", "os", "base", "__init__", "a.b", "../x"):
        with pytest.raises(InvalidParameter, match="unknown effect"):
            effect_class(name)
