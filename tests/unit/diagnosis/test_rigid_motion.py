"""Wrong drives of an arm of seven joints are found by its kinematics, with a simulation or two."""

from functools import cache

import numpy as np
import pytest

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.budget import limited
from flexarm.drive import Drive
from flexarm.record import Clock, Frame
from flexarm.validation import initial_alignment
from flexarm.validation.drive_hypotheses import rigid_motion
from flexarm.validation.sensor_check import check

LENGTHS = (0.33, 0.32, 0.2, 0.38, 0.1, 0.1, 0.15)
JOINTS = tuple(f"joint{k}" for k in range(1, 8))


def seven_joints() -> flexarm.Arm:
    """Rigid links along z that turn about z and y in turn."""
    joints = [
        {
            "name": name,
            "type": "revolute",
            "parent": f"link{k}" if k else "base",
            "child": f"link{k + 1}",
            "origin": {"xyz": [0, 0, LENGTHS[k - 1] if k else 0], "rpy": [0, 0, 0]},
            "axis": [0, 1, 0] if k % 2 else [0, 0, 1],
            "gear_ratio": 100,
        }
        for k, name in enumerate(JOINTS)
    ]
    links = [
        {
            "name": f"link{k + 1}",
            "type": "rigid",
            "mass": 2.0,
            "com": [0.01, 0, length / 2],
            "inertia": [0.02] * 3,
        }
        for k, length in enumerate(LENGTHS)
    ]
    tip = {"name": "tip", "link": "link7", "position": [0.05, 0, 0.15]}
    return flexarm.Arm.from_dict(
        {"format": "flexarm-arm/1", "name": "seven", "joints": joints, "links": links, "points": [tip]}
    )


@cache
def motion() -> tuple[flexarm.Arm, Drive]:
    """Sines of the joints about bent elbows, from rest."""
    rng, t = np.random.default_rng(4), np.arange(0, 8.0, 0.01)
    begins = np.clip(t / 2, 0, 1) ** 2 * (3 - 2 * np.clip(t / 2, 0, 1))
    angles = {
        name: 0.5 * (k % 2) + begins * rng.uniform(0.2, 0.5) * np.sin(2 * np.pi * rng.uniform(0.1, 0.4) * t)
        for k, name in enumerate(JOINTS)
    }
    return seven_joints(), Drive.from_samples(t, angles)


@cache
def record() -> flexarm.Record:
    arm, drive = motion()
    sensors = [
        Sensor(name="tip", quantity="position", point="tip", rate_hz=20, noise_std=5e-5, frame="tracker"),
        *(
            Sensor(name=name, quantity="joint_angle", joint=name, rate_hz=100, noise_std=5e-6)
            for name in JOINTS
        ),
        *(
            Sensor(name=f"{name}_torque", quantity="motor_torque", joint=name, rate_hz=50, noise_std=2e-3)
            for name in JOINTS
        ),
    ]
    return flexarm.measure(
        flexarm.simulate(arm, drive, step=5e-3),
        sensors,
        np.random.default_rng(1),
        drive=JOINTS,
        clocks={"": Clock()},
        frames={"tracker": Frame(translation=1e-3, rotation=5e-4)},
    )


def scaled(factors: dict[str, float]) -> flexarm.Record:
    """The record with some signals times a factor."""
    signals = {
        name: signal.replace(values=signal.values * factors.get(name, 1.0))
        for name, signal in record().signals.items()
    }
    return record().replace(signals=signals)


def test_without_flexibility_the_rigid_arm_moves_as_the_simulated_one():
    arm, drive = motion()
    time = np.linspace(0, 7.9, 400)
    seen = rigid_motion(arm, time, {name: each(time) for name, each in drive.joints.items()})
    run = flexarm.simulate(arm, drive, step=2e-3)
    assert np.max(np.abs(run.at(seen.time, "tip") - seen.position[:, 0])) < 1e-4
    assert np.isnan(seen.joint_torque).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("factors", "name"),
    [
        (dict.fromkeys(JOINTS, 180 / np.pi), "unit_error"),
        ({"joint4": 180 / np.pi}, "unit_error"),
        ({"joint3": -1.0}, "sign_error"),
        ({"joint6": 100.0}, "unit_error"),
    ],
    ids=["all in degrees", "one in degrees", "one flipped", "one of the motor"],
)
def test_few_hypotheses_are_simulated(factors, name, monkeypatch):
    driven = []
    simulate_all = initial_alignment.simulate_all
    monkeypatch.setattr(
        initial_alignment,
        "simulate_all",
        lambda pairs, **options: driven.extend(pairs := list(pairs)) or simulate_all(pairs, **options),
    )
    found = check(seven_joints(), {"run": scaled(factors)}, step=5e-3)
    assert {fault.at for fault in found.faults} == set(factors)
    assert {fault.name for fault in found.faults} == {name}
    assert len(driven) <= 6


def test_a_drive_that_no_place_shows_is_not_blamed_for_a_torque():
    """Behind the last encoder only torques are seen, and friction makes these what no model foretells."""
    rubbing = {
        name: signal.replace(values=np.sign(np.sin(3 * signal.time[:, None])) + 0.2 * signal.values)
        for name, signal in record().signals.items()
        if name in ("joint4_torque", "joint5_torque")
    }
    second = record().signals["joint1"].replace(name="joint1_second", side="output", file="")
    kept = {name: signal for name, signal in record().signals.items() if name != "tip"}
    found = check(
        seven_joints(),
        {"run": record().replace(signals={**kept, **rubbing, "joint1_second": second})},
        step=5e-3,
    )
    assert not [fault for fault in found.faults if fault.at in JOINTS]


def test_without_time_the_check_says_what_it_left_out():
    with limited(1e-9):
        found = check(seven_joints(), {"run": record()}, step=5e-3)
    assert not found.faults
    assert found.doubts == ("run: the model cannot be simulated: not within 1e-09 s",)
    assert found.remarks[-1].startswith("the budget of 1e-09 s ended before the simulation of run")
