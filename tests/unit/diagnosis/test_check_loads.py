"""A load that no record states makes torques and strains several times as large, and no sensor faulty."""

from functools import cache

import numpy as np
import pytest
from arms import crane, smooth_step

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.record import Clock
from flexarm.validation.sensor_check import check

RATIO, STATED, CARRIED = 120, 1.0, 60.0
SENSORS = [
    Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-5),
    Sensor(name="tip", quantity="position", point="tip", rate_hz=10, noise_std=5e-5),
    Sensor(name="torque", quantity="motor_torque", joint="hinge", side="output", rate_hz=50, noise_std=0.5),
    Sensor(
        name="gauge",
        quantity="strain",
        link="rod",
        position=0.3,
        fibre=(0.0, 0.03),
        rate_hz=50,
        noise_std=1e-6,
    ),
    Sensor(name="bend", quantity="deflection", point="tip", axes=("x",), rate_hz=50, noise_std=2e-5),
]


def carrying(mass: float) -> flexarm.Arm:
    """A tube of 14 kg on a hinge with a gear of 120."""
    arm = crane()
    return arm.replace(payloads=tuple(load.replace(mass=mass) for load in arm.payloads))


@cache
def record() -> flexarm.Record:
    """Two slow moves with 60 kg."""
    t = np.arange(0, 10, 0.01)
    angle = 0.9 * smooth_step((t - 0.5) / 4) - 1.1 * smooth_step((t - 5) / 4)
    drive = flexarm.Drive.from_samples(t, {"hinge": angle})
    run = flexarm.simulate(carrying(CARRIED), drive, step=0.01, forces=True)
    return flexarm.measure(run, SENSORS, np.random.default_rng(2), drive=["hinge"], clocks={"clock": Clock()})


@pytest.mark.parametrize("sensor", ["torque", "gauge"])
def test_a_load_that_was_forgotten_is_asked_for(sensor):
    seen = record()
    alone = seen.replace(signals={name: seen.signals[name] for name in ("hinge", "tip", sensor)})
    found = check(carrying(STATED), {"run": alone})
    assert found.usable
    [remark] = [each for each in found.remarks if "which no unit gives" in each]
    assert remark.startswith(f"run: {sensor}") and remark.endswith(
        "does the arm carry what model and record state?"
    )
    assert check(carrying(CARRIED), {"run": alone}).remarks == ()


def test_a_deflection_under_thrice_the_load_is_in_no_other_unit():
    """It bends 2.5 times as far as beside the load that is stated; in millimetres a thousand times as far."""
    seen = record()
    bent = seen.replace(signals={name: seen.signals[name] for name in ("hinge", "tip", "bend")})
    assert check(carrying(20.0), {"run": bent}).usable
    metres = bent.signals["bend"]
    wrong = metres.replace(values=1e3 * metres.values)
    [fault] = check(carrying(20.0), {"run": bent.replace(signals={**bent.signals, "bend": wrong})}).faults
    assert (fault.name, fault.at) == ("unit_error", "bend")


@pytest.mark.parametrize(
    ("said", "factor", "why"),
    [
        ({"side": "motor"}, RATIO, "a torque on the output side does that is said to be on the motor side"),
        (
            {"scale": 1 / RATIO},
            1 / RATIO,
            "a torque on the motor side does that is said to be on the output side",
        ),
    ],
)
def test_a_torque_on_the_other_side_of_its_gear_is_named_so(said, factor, why):
    seen, torque = record(), record().signals["torque"]
    wrong = torque.replace(side=said.get("side", "output"), values=said.get("scale", 1.0) * torque.values)
    found = check(carrying(CARRIED), {"run": seen.replace(signals={**seen.signals, "torque": wrong})})
    [fault] = found.faults
    assert (fault.name, fault.at) == ("unit_error", "torque")
    assert fault.parameters[0].value == pytest.approx(factor, rel=0.05)
    assert why in fault.evidence
