"""Tap, pluck and drop tests: a record without a drive that begins in motion is free vibration.

The records come from the nonlinear simulation: a jerk of the hinge, and what rings on after it.
"""

import numpy as np
import pytest
from arms import TUBE, beam, compliance, hinge, point

import flexarm
from flexarm.comparison.free_vibration import simulate_free_vibration
from flexarm.linear.free_motion import free_motion
from flexarm.record import Frame
from flexarm.validation.sensor_check import check

ANGLE, STIFFNESS = 0.3, 1e5
TIP = {
    "name": "tip",
    "quantity": "position",
    "point": "tip",
    "axes": ["x", "z"],
    "frame": "tracker",
    "rate_hz": 20,
    "noise_std": 5e-5,
}
RATE = {
    "name": "imu",
    "quantity": "angular_rate",
    "point": "tip",
    "axes": ["y"],
    "rate_hz": 100,
    "noise_std": 1e-3,
}
TORQUE = {"name": "torque", "quantity": "motor_torque", "joint": "hinge", "side": "output", "rate_hz": 100}


def arm(stiffness: float = STIFFNESS, sensors: tuple[dict, ...] = (TIP,), **tables: object) -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        {
            "joints": [hinge("hinge", "rod")],
            "links": [beam("rod", [0, 0, 3.0], TUBE, damping_ratio=0.005)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0, 0, 3.0])],
            "effects": [compliance("hinge", stiffness, 150.0)],
            "sensors": list(sensors),
            **tables,
        }
    )


def plucked(truth: flexarm.Arm, seed: int = 1) -> flexarm.Record:
    """What the sensors see from 0.6 s after a jerk on."""
    t = np.linspace(0, 10, 5001)
    jerk = ANGLE + 4e-3 * np.exp(-(((t - 1.0) / 0.08) ** 2))
    run = flexarm.simulate(truth, flexarm.Drive.from_samples(t, {"hinge": jerk}), rotations=True)
    seen = flexarm.measure(
        run,
        truth.sensors,
        np.random.default_rng(seed),
        frames={"tracker": Frame(translation=1e-3, rotation=5e-4)},
    )
    after = [
        s.replace(time=s.time[s.time > 1.6], values=s.values[s.time > 1.6]) for s in seen.signals.values()
    ]
    return flexarm.Record(
        signals=after, initial="moving", joints={"hinge": ANGLE}, clocks=seen.clocks, frames=seen.frames
    )


@pytest.fixture(scope="module")
def record() -> flexarm.Record:
    return plucked(arm())


def test_states_ring_at_the_frequencies_and_dampings_of_the_modes():
    motion = free_motion(arm(), {"hinge": ANGLE}, 3)
    poles = np.linalg.eigvals(motion.A)
    modes = flexarm.modes(arm(), {"hinge": ANGLE}, count=3)
    assert np.sort(np.abs(poles))[::2] == pytest.approx(2 * np.pi * modes.frequency_hz, rel=1e-4)
    damping = -poles.real / np.abs(poles)
    assert np.sort(damping)[::2] == pytest.approx(np.sort(modes.damping_ratio), rel=0.02)


def test_velocities_are_rates_of_positions():
    motion = free_motion(arm(), {"hinge": ANGLE}, 3)
    run = motion.run(np.array([0.05, 0, 0.001, 0.3, 0, 0]), np.linspace(0, 0.5, 2001))
    rates = np.gradient(run.position[:, 0], run.time, axis=0)
    assert run.velocity[1:-1, 0] == pytest.approx(rates[1:-1], abs=2e-4 * np.abs(rates).max())


def test_a_right_model_leaves_noise_and_a_soft_one_a_gap(record):
    found = flexarm.compare(arm(), record)
    assert found.signals["tip"].rms["total"] < 1.1 * found.signals["tip"].noise_rms
    assert any("ring freely" in note for note in found.notes)
    soft = flexarm.compare(arm(0.8 * STIFFNESS), record).signals["tip"]
    assert soft.rms["total"] > 5 * soft.noise_rms


def test_rates_and_torques_are_predicted_too():
    both = plucked(arm(sensors=(TIP, RATE, TORQUE)))
    run = simulate_free_vibration(arm(), both, 2e-3)
    torque = both.signals["torque"]
    predicted = np.interp(torque.time, run.time, run.motor_torque[:, 0])
    assert predicted == pytest.approx(torque.values[:, 0], abs=0.02 * np.ptp(torque.values))
    assert flexarm.compare(arm(), both).signals["imu"].rms["total"] < 2e-3


def test_the_check_takes_it_as_it_is(record):
    assert record.check() == []
    found = check(arm(), {"pluck": record})
    assert found.faults == ()
    assert found.remarks == ()


@pytest.mark.parametrize("factor", [0.85, 1.2])
def test_a_diagnosis_finds_the_stiffness_of_a_joint(record, factor):
    key = "effects.joint_compliance.hinge.stiffness"
    found = flexarm.diagnose(arm(factor * STIFFNESS, uncertainty={key: 0.3}), {"pluck": record})
    assert found.verdict == "adequate"
    [refined] = found.refined
    assert refined.value == pytest.approx(STIFFNESS, abs=3 * refined.std)
    assert refined.std < 5e-3 * STIFFNESS


def test_a_diagnosis_finds_a_modulus(record):
    nominal = arm(uncertainty={"links.rod.material.youngs_modulus": 0.1})
    rod = nominal.links[0]
    stiffer = rod.replace(material=rod.material.replace(youngs_modulus=1.1 * rod.material.youngs_modulus))
    found = flexarm.diagnose(nominal.replace(links=(stiffer,)), {"pluck": record})
    assert found.verdict == "adequate"
    [refined] = found.refined
    assert refined.value == pytest.approx(rod.material.youngs_modulus, abs=3 * refined.std)


def test_a_record_of_unknown_places_alone_is_refused(record):
    unknown = record.replace(frames={"tracker": Frame(unknown=True)})
    with pytest.raises(flexarm.InvalidParameter, match="shows no free vibration"):
        flexarm.compare(arm(), unknown)


def test_without_a_word_on_its_start_a_record_without_a_drive_is_doubted(record):
    [problem] = [p for p in record.replace(initial="equilibrium").check() if p.where == "drive"]
    assert 'of a tap, pluck or drop test say initial = "moving"' in problem.what
