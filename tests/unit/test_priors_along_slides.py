"""What is plausible of a joint that slides is what is plausible of one that turns a pinion."""

import numpy as np
import pytest
from arms import hinge, rigid
from pytest import approx

from flexarm import Arm, InvalidParameter, Record, Signal
from flexarm.arm.effect import effect_class
from flexarm.arm.joint_units import PINION, priors_in
from flexarm.arm.motor_limits import stall_torque
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.sensor_zeros import with_zeros, without_idle_zeros
from flexarm.effects import (
    EncoderEccentricity,
    EncoderHarmonics,
    EncoderOffset,
    JointCompliance,
    JointStiffening,
    MotorFriction,
    OilColumn,
)

POWERS = {"m": 1, "m/s": 1, "N": -1, "N/m": -2, "N/m3": -4, "N s/m": -2}
JOINT_LAWS = (
    "backlash",
    "cable_torque",
    "coulomb_friction",
    "joint_compliance",
    "joint_hysteresis",
    "joint_stiffening",
    "lugre_friction",
    "motor_friction",
    "transmission_error",
    "viscous_friction",
)


def machine(kind: str, ratio: float = 1.0, **tables) -> Arm:
    joint = {**hinge("axis", "rod"), "type": kind, "gear_ratio": ratio}
    return Arm.from_dict({"joints": [joint], "links": [rigid("rod", 4, [0, 0, 1], [0, 2, 2])], **tables})


TURNS, SLIDES = machine("revolute"), machine("prismatic")


@pytest.mark.parametrize("name", JOINT_LAWS)
def test_every_number_goes_with_the_power_of_the_lever_that_its_unit_has(name):
    kind = effect_class(name)
    about, along = (priors_in(kind.typical("axis", arm), arm) for arm in (TURNS, SLIDES))
    assert about.keys() == along.keys()
    for key, prior in along.items():
        times = PINION ** POWERS.get(prior.unit, 0)
        for number in ("low", "typical", "high"):
            assert getattr(prior, number) == approx(times * getattr(about[key], number)), key


def test_a_search_begins_with_a_spring_as_stiff_as_slides_are():
    spring = JointCompliance(at="axis")
    assert spring.first_stiffness(TURNS) == 1e5
    assert spring.first_stiffness(SLIDES) == approx(1e7)


def test_springs_of_a_heavy_machine_are_stiffer_in_proportion_and_alike_at_its_joints():
    """The house of an excavator turns on a drive of 1e7 N m/rad, and no search from 1e5 finds it."""
    tip = {"name": "wrist", "type": "revolute", "parent": "rod", "child": "hand", "axis": [0, 1, 0]}
    tables = {"joints": [hinge("axis", "rod"), tip], "links": [rigid("rod", 4, [0, 0, 1], [0, 2, 2])]}
    load = {"name": "load", "link": "rod", "position": [0, 0, 3], "mass": 2e3}
    tables["links"].append(rigid("hand", 2, [0, 0, 2], [0, 1, 1]))
    heavy = Arm.from_dict({**tables, "payloads": [load]})
    times = (4 * 1 + 2e3 * 3 + 2 * 2) / 63
    for at in ("axis", "wrist"):
        spring = JointCompliance(at=at)
        assert spring.first_stiffness(heavy) == approx(times * 1e5)
        prior = priors_in(spring, heavy)["stiffness"]
        assert (prior.low, prior.high) == (approx(3e3), approx(times * 4e6))


def test_what_follows_from_a_stated_spring_or_motor_keeps_to_it():
    """Damping and cubic stiffness go with the stiffness in N/m, friction with what the motor overcomes."""
    spring = JointCompliance(at="axis", stiffness=4e6)
    assert priors_in(spring, SLIDES)["damping"].typical == approx(2e-3 * 4e6)
    (bending,) = priors_in(JointStiffening(at="axis"), SLIDES.with_effect(spring)).values()
    assert bending.typical == approx(0.5 * 4e6 / (3 * (1e-3 * PINION) ** 2))
    motor = {"joint": "axis", "resistance": 2.0, "torque_constant": 0.05, "voltage_limit": 12.0}
    control = {"type": "state_feedback", "joint": "axis", "position_gain": 1.0, "sample_time": 4e-3}
    weak = machine("prismatic", 300.0, motors=[motor], controllers=[control])
    assert priors_in(MotorFriction(at="axis"), weak)["coulomb"].high == approx(stall_torque(weak, "axis"))


def test_cylinders_are_stated_in_their_own_numbers():
    oil = OilColumn(at="axis", bulk_modulus=1.2e9, piston_area=1e-2, dead_volume=1e-3, stroke=1.0)
    about, along = (priors_in(oil, arm)["piston_area"] for arm in (TURNS, SLIDES))
    assert (along.low, along.high, along.unit) == (about.low, about.high, "m2")


RULED = machine("prismatic", encoders={"ruler": "axis"})


def test_an_encoder_of_another_name_than_its_joint_has_the_units_of_the_joint():
    prior = priors_in(EncoderOffset(at="ruler"), RULED)["offset"]
    assert prior == priors_in(EncoderOffset(at="axis"), SLIDES)["offset"]
    assert prior.unit == "m"


def test_the_record_says_which_encoders_measure_slides():
    t = np.linspace(0, 2, 41)
    encoder = Signal(
        name="ruler",
        quantity="joint_angle",
        time=t,
        values=0.1 * t,
        joint="axis",
        side="motor",
        noise_std=1e-6,
        zero_std=1e-4,
    )
    record = Record(signals=[encoder], drive=("ruler",))
    arm = with_zeros(SLIDES, {"run": record}, SelectionPolicy())
    assert dict(arm.encoders) == {"ruler": "axis"}
    assert dict(arm.uncertainty) == {"effects.encoder_offset.ruler.offset_m": 1e-4}
    assert without_idle_zeros(arm, SLIDES) == SLIDES


@pytest.mark.parametrize("kind", [EncoderEccentricity, EncoderHarmonics])
def test_errors_over_a_turn_need_an_encoder_that_turns(kind):
    with pytest.raises(InvalidParameter, match=r"repeats with turns, and the joint of 'ruler' slides"):
        RULED.with_effect(kind(at="ruler", amplitude=1e-4))


def test_an_uncertain_offset_of_an_encoder_that_only_the_record_knows_has_either_unit():
    effects = [{"name": "encoder_offset", "at": "ruler"}]
    for unit in ("rad", "m"):
        key = f"effects.encoder_offset.ruler.offset_{unit}"
        assert machine("prismatic", effects=effects, uncertainty={key: 1e-4}).uncertainty
    with pytest.raises(InvalidParameter, match="offset_rad"):
        machine(
            "prismatic",
            effects=effects,
            encoders={"ruler": "axis"},
            uncertainty={"effects.encoder_offset.ruler.offset_rad": 1e-4},
        )


def test_encoders_name_joints_of_the_model():
    with pytest.raises(InvalidParameter, match=r"encoders\.ruler.*'axle'"):
        machine("prismatic", encoders={"ruler": "axle"})
