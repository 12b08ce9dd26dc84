"""Intervals of a calibration where the simulator errs: records of the rods, whose formulation is another."""

from dataclasses import replace

import numpy as np
import pytest
from arms import PAYLOAD
from motion import Arm as Rods
from motion import move
from test_against_flexarm import HUB, LINK, STIFF, SWING, with_rotor

import flexarm
from flexarm import Clock, Record, Signal
from flexarm.effects.joint_compliance import JointCompliance

TIME = np.linspace(0, 8, 1601)
PRIORS = {
    "effects.joint_compliance.hinge.stiffness": (STIFF["stiffness"], 0.3),
    "effects.joint_compliance.hinge.damping": (STIFF["damping"], 0.3),
    "payloads.load.mass": (PAYLOAD, 0.05),
}
NOISE = 1e-5
"""Of the tip [m], of which the two formulations differ by up to a half."""


def drawn(seed: int) -> tuple[dict[str, float], Record]:
    """Return truths from the priors, and a record of the rods."""
    rng = np.random.default_rng(500 + seed)
    truth = {key: value * np.exp(sigma * rng.standard_normal()) for key, (value, sigma) in PRIORS.items()}
    stiffness, damping, mass = truth.values()
    rods = Rods(replace(LINK, mass=mass), replace(HUB, stiffness=stiffness, damping=damping))
    tip = move(rods, SWING, TIME).place(1.0)[::10]
    angle = np.array([SWING(t)[0] for t in TIME]) + 5e-6 * rng.standard_normal(len(TIME))
    seen = np.c_[tip[:, 0], np.zeros(len(tip)), tip[:, 1]] + NOISE * rng.standard_normal((len(tip), 3))
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", side="motor", time=TIME,
                   values=angle[:, None], noise_std=5e-6, clock="plc")  # fmt: skip
    point = Signal(name="tip", quantity="position", point="tip", time=TIME[::10], values=seen,
                   noise_std=NOISE, clock="plc")  # fmt: skip
    return truth, Record(kind="motion", drive=["hinge"], clocks={"plc": Clock()}, signals=[hinge, point])


@pytest.mark.slow
def test_truths_of_another_formulation_lie_in_their_intervals():
    """Nine in ten do on average; of these twelve at least nine."""
    arm = with_rotor(0.0).with_effect(JointCompliance(at="hinge", **STIFF))
    arm = arm.replace(uncertainty={key: sigma for key, (_, sigma) in PRIORS.items()})
    inside = 0
    for seed in range(4):
        truth, record = drawn(seed)
        found = flexarm.calibrate(arm, [record], n_jobs=1)
        inside += sum(
            (each := found.parameter(key)).low90 < value < each.high90 for key, value in truth.items()
        )
    assert inside >= 9
