"""Where the gap of an independently simulated machine is: a chain of rods with a spring, a gap, friction."""

import numpy as np
import pytest
import virtual_lab
from arms import EI, LENGTH, PAYLOAD, RHO_A, paper_arm
from chain import Link
from hub import Hub
from motion import Arm
from swings import Swing

from flexarm.comparison.aligned_record import simulate_record
from flexarm.residual_analysis.localisation import localise

LINK, RATIO = Link(LENGTH, EI, RHO_A, mass=PAYLOAD, damping_ratio=0.02), 120.0
SPRING = 1e5
SWING = Swing(amplitude=0.7, period=8.0, rise=4.0, middle=0.05)
LAB = virtual_lab.Lab(clock=1e-6, translation=1e-6, rotation=1e-6)


def located(hub, spring=None):
    """The machine's record, its clock and frame known, beside flexarm's arm with or without the spring."""
    machine = Arm(LINK, hub)
    record = virtual_lab.record(machine, SWING, 24.0, np.random.default_rng(4), LAB)
    model = paper_arm(elements=4, damping_ratio=0.02)
    if spring is not None:
        joint = model.joints[0].replace(gear_ratio=RATIO)
        model = paper_arm(elements=4, damping_ratio=0.02, spring=spring).replace(joints=(joint,))
    return localise(simulate_record(model, record))


@pytest.fixture(scope="module")
def without_spring():
    return located(Hub(stiffness=SPRING, damping=200.0))


def test_a_spring_that_the_model_lacks_is_tangential_slow_and_follows_the_torque(without_spring):
    first = without_spring.where[0]
    assert (first["signal"], first["direction"], first["band_hz"][0]) == ("tip", "tangential", 0.0)
    assert without_spring.dependence["tip"].best == "torque"
    assert without_spring.rotations.joints[0].hint == "compliance"


def test_its_rotation_is_torque_over_stiffness(without_spring):
    """Slope of the equivalent rotation over the torque: -1/k; ringing adds some per cent."""
    found = without_spring.rotations
    torque = found.states[0].torque
    assert float(found.joints[0].angle @ torque / (torque @ torque)) == pytest.approx(-1 / SPRING, rel=0.1)


def test_backlash_jumps_where_the_torque_reverses():
    found = located(Hub(stiffness=SPRING, damping=200.0, gap=8e-4), SPRING)
    tip = [each for each in found.where if each["signal"] == "tip"]
    assert ("tangential", "torque reversal") in [(each["direction"], each["when"]) for each in tip]
    assert found.rotations.joints[0].hint == "backlash"


def test_friction_in_the_bearing_jumps_where_the_motion_reverses():
    found = located(Hub(stiffness=SPRING, damping=200.0, coulomb=60.0), SPRING)
    assert found.where[0]["when"] == "motion reversal"
    assert found.dependence["torque"].best == "sense of motion"
