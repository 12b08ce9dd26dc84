"""What a motor can overcome, and priors of friction that stay within it."""

import numpy as np
import pytest
from arms import hinge, rigid
from pytest import approx

from flexarm import Arm, Drive
from flexarm.arm.effect import read_effect
from flexarm.arm.motor_limits import back_emf_damping, stall_torque
from flexarm.arm.sensor import Sensor
from flexarm.control import simulate_closed_loop
from flexarm.measurement.measure import measure

MOTOR = {
    "joint": "hinge",
    "resistance": 2.0,
    "torque_constant": 0.05,
    "efficiency": 0.8,
    "voltage_limit": 12.0,
}
FULL_SPEED = {"type": "state_feedback", "joint": "hinge", "position_gain": 1e6, "sample_time": 4e-3}


def machine(**motor):
    """A level rod behind a reducer of 100; its controller asks for all that there is."""
    return Arm.from_dict(
        {
            "gravity": [0, 0, 0],
            "joints": [hinge("hinge", "rod", gear_ratio=100, rotor_inertia=1e-4)],
            "links": [rigid("rod", 4, [0, 0, 1], [0, 2, 2])],
            "motors": [MOTOR | motor],
            "controllers": [FULL_SPEED],
        }
    )


def rate_at_the_end(arm, name, **values):
    friction = read_effect({"name": name, "at": "hinge", **values})
    command = Drive.from_samples([0, 0.01, 8], {"hinge": [0, 100.0, 100.0]}, side="command")
    return simulate_closed_loop(arm.with_effect(friction), command, step=4e-3).joint_rate[-1, 0]


def test_dry_friction_above_the_stall_torque_holds_the_joint_and_below_it_does_not():
    arm = machine()
    most = stall_torque(arm, "hinge")
    assert most == approx(0.8 * 100 * 0.05 * 12 / 2)
    assert abs(rate_at_the_end(arm, "coulomb_friction", torque=1.02 * most)) < 1e-6
    assert rate_at_the_end(arm, "coulomb_friction", torque=0.9 * most) > 0.1


def test_viscous_friction_like_that_of_the_back_emf_halves_the_rate_without_load():
    """12 V over 0.05 V s/rad times 100; eight seconds are some hundred time constants."""
    arm = machine()
    free = 12 / (0.05 * 100)
    assert rate_at_the_end(arm, "viscous_friction", coefficient=1e-9) == approx(free, rel=1e-3)
    damping = back_emf_damping(arm, "hinge")
    assert rate_at_the_end(arm, "viscous_friction", coefficient=damping) == approx(free / 2, rel=1e-3)


def test_a_limit_of_the_torque_counts_where_it_is_the_smaller_one():
    """It is that of the torque on the rotor, behind the efficiency."""
    arm = machine(torque_limit=0.1)
    most = stall_torque(arm, "hinge")
    assert most == approx(100 * 0.1)
    assert abs(rate_at_the_end(arm, "coulomb_friction", torque=1.05 * most)) < 1e-4
    assert rate_at_the_end(arm, "coulomb_friction", torque=0.9 * most) > 0.1


def test_a_motor_that_turns_backwards_overcomes_as_much():
    arm = machine()
    [joint] = arm.joints
    back = arm.replace(joints=[joint.replace(gear_ratio=-joint.gear_ratio)])
    assert stall_torque(back, "hinge") == stall_torque(arm, "hinge")


def test_the_motor_of_a_joint_behind_a_gear_turns_with_all_ratios():
    """u = R T/(eta k_m) + k_m w, T and w at the shaft of a motor 50 times -2 as fast as the joint."""
    wrist = {**hinge("wrist", "hand", parent="rod"), "origin": {"xyz": [0, 0, 1], "rpy": [0, 0, 0]}}
    cascade = {
        "type": "cascade",
        "joint": "wrist",
        "position_gain": 10,
        "velocity_gain": 50,
        "sample_time": 2e-3,
    }
    arm = Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod", gear_ratio=50, rotor_inertia=1e-3), wrist],
            "links": [rigid("rod", 4, [0, 0, 0.5], [0, 2, 2]), rigid("hand", 1, [0, 0, 0.2], [0, 0.1, 0.1])],
            "gears": [{"name": "belt", "input": "hinge", "output": "wrist", "ratio": -2}],
            "motors": [{k: v for k, v in MOTOR.items() if k != "voltage_limit"} | {"joint": "wrist"}],
            "controllers": [cascade],
        }
    )
    time = np.linspace(0, 1, 501)
    command = Drive.from_samples(time, {"wrist": 0.1 * np.sin(3 * time)}, side="command")
    run = simulate_closed_loop(arm, command)
    sensors = [
        Sensor(name=name, quantity=name, joint="wrist", side=side, rate_hz=500)
        for name, side in (("motor_voltage", None), ("motor_torque", "motor"), ("joint_rate", "motor"))
    ]
    seen = measure(run, sensors, np.random.default_rng(0)).signals
    torque, rate = (seen[name].values[10:, 0] for name in ("motor_torque", "joint_rate"))
    volts = 2.0 * torque / (0.8 * 0.05) + 0.05 * -100 * rate
    assert seen["motor_voltage"].values[10:, 0] == approx(volts, abs=0.02 * np.abs(volts).max())
    assert stall_torque(machine(torque_limit=5.0), "hinge") == stall_torque(machine(), "hinge")
    assert np.isinf(stall_torque(machine(voltage_limit=None), "hinge"))


@pytest.mark.parametrize(
    ("effect", "limits"),
    [
        ("coulomb_friction", {"torque": stall_torque}),
        ("viscous_friction", {"coefficient": back_emf_damping}),
        ("motor_friction", {"coulomb": stall_torque, "viscous": back_emf_damping}),
    ],
)
def test_friction_of_a_small_machine_is_as_much_smaller_as_its_motor(effect, limits):
    """All of the prior moves by one factor; where no motor is stated, it stands as it is."""
    arm = machine()
    law = read_effect({"name": effect, "at": "hinge"})
    usual = law.priors(arm.replace(motors=(), controllers=()))
    for name, limit in limits.items():
        found, before = law.priors(arm)[name], usual[name]
        assert found.high == approx(limit(arm, "hinge"))
        assert found.high < before.high
        assert found.typical / before.typical == approx(found.high / before.high)
        assert found.low / before.low == approx(found.high / before.high)
        assert law.priors(machine(resistance=1e-4))[name] == before
