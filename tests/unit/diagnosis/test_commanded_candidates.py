"""What may be wrong where a joint follows commands: friction of its motor, and a command that acts late."""

import numpy as np
import pytest
from arms import hinge, point, rigid

from flexarm import Arm, Record, Signal
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.problem import Problem
from flexarm.record import Clock

TIME = np.arange(0.0, 1.0, 0.01)


def places(drive, clock="board"):
    """All candidates, by name and place, of a rod that a command drives, or the angle that was read."""
    arm = Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [rigid("rod", 4, [0, 0, 1], [0, 2, 2])],
            "points": [point("end", "rod", [0, 0, 2])],
            "controllers": [
                {"type": "cascade", "joint": "hinge", "position_gain": 5.0, "velocity_gain": 200.0,
                 "integral_time": 0.3, "sample_time": 1e-2},
            ],
        }
    )  # fmt: skip
    swing = 0.1 * np.sin(3 * TIME) ** 2
    kinds = {"command": "joint_command", "angle": "joint_angle", "rate": "joint_rate"}
    signals = [
        Signal(name=name, quantity=kind, joint="hinge", values=swing, time=TIME, file="run.csv",
               noise_std=1e-4, clock="board" if name == drive else clock)
        for name, kind in kinds.items()
    ]  # fmt: skip
    clocks = {name: Clock() for name in dict.fromkeys(("board", clock))}
    record = Record(signals={s.name: s for s in signals}, drive=(drive,), clocks=clocks)
    found = candidates(Problem(arm, {"run": record}), arm)
    return {each.place: each for each in found}


def test_friction_of_a_motor_that_follows_commands_needs_no_torque_to_be_seen():
    """It moves the arm. Where the angle is imposed it costs torque, which nobody logged."""
    assert ("motor_friction", "hinge") in places("command")
    assert ("motor_friction", "hinge") not in places("angle")


def test_a_command_may_act_late_and_then_its_stamp_is_early():
    found = places("command")["time_delay", "command"]
    prior = found.priors["delay"]
    assert (prior.low, prior.typical, prior.high) == (-0.05, 0.0, 0.02)
    assert ("time_delay", "angle") not in places("angle")


def test_a_command_that_moves_with_a_clock_of_all_evidence_is_that_clock():
    found = places("command", clock="other")
    assert ("time_delay", "command") not in found
    assert ("time_delay", "other") in found


@pytest.mark.parametrize("drive", ["command", "angle"])
def test_a_clock_of_commands_does_not_drift_by_itself(drive):
    assert ("clock_drift", drive) not in places(drive)
