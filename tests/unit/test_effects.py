"""Effects: found by name, written as they are, and made of the laws that their docs state."""

from typing import Any

import pytest

from flexarm.arm.effect import KNOWN_EFFECTS, effect_class
from flexarm.effects import CoulombFriction, Effect, JointCompliance, MotorFriction, ViscousFriction
from flexarm.errors import InvalidParameter

EXAMPLES = [
    JointCompliance(at="hinge", stiffness=1e5, damping=30.0),
    CoulombFriction(at="hinge", torque=12.0),
    ViscousFriction(at="hinge", coefficient=3.0),
    MotorFriction(at="hinge", coulomb=5.0, viscous=2.0),
]


class NamesLaws:
    """In place of the compiled core: a law is its name and its numbers."""

    def __getattr__(self, law: str) -> Any:
        return lambda *numbers: (law, *numbers)


@pytest.mark.parametrize("effect", EXAMPLES, ids=lambda effect: effect.name)
def test_an_effect_is_found_by_its_name_and_rebuilt_from_its_table(effect: Effect) -> None:
    table = effect.to_plain()
    assert effect_class(table.pop("name"))(**table) == effect


def test_laws_stand_where_the_effect_acts() -> None:
    spring, dry, viscous, motor = EXAMPLES
    core = NamesLaws()
    assert spring.coupling_laws(core) == [("LinearSpring", 1e5, 30.0)]
    assert dry.bearing_laws(core) == [("DahlFriction", 12.0, 2e-5)]
    assert viscous.bearing_laws(core) == [("ViscousFriction", 3.0)]
    assert motor.motor_laws(core) == [("DahlFriction", 5.0, 2e-5), ("ViscousFriction", 2.0)]
    assert dry.coupling_laws(core) == dry.motor_laws(core) == spring.bearing_laws(core) == []


def test_parameters_left_out_are_without_effect() -> None:
    core = NamesLaws()
    assert CoulombFriction(at="hinge").bearing_laws(core) == []
    assert ViscousFriction(at="hinge").bearing_laws(core) == []
    assert MotorFriction(at="hinge").motor_laws(core) == []


def test_parameters_come_with_units() -> None:
    assert EXAMPLES[0].parameters() == [("stiffness", 1e5, "N m/rad"), ("damping", 30.0, "N m s/rad")]
    assert str(EXAMPLES[1]) == "coulomb_friction at hinge: torque = 12 N m"


def test_known_effects_without_a_law_are_told_from_unknown_ones() -> None:
    simulated = {effect.name for effect in EXAMPLES}
    for name in KNOWN_EFFECTS:
        if name not in simulated:
            with pytest.raises(InvalidParameter, match=f"{name}.* is known but cannot be simulated yet"):
                effect_class(name)
    for name in ("joint_complianse", "", "os", "base", "__init__", "a.b", "../x"):
        with pytest.raises(InvalidParameter, match="unknown effect"):
            effect_class(name)
