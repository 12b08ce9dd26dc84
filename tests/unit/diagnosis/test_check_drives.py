"""A drive in a wrong unit is named with its factor, and no sensor that only follows the wrong drive."""

from functools import cache, partial

import numpy as np
import pytest
from arms import drive, smooth_step, waist_and_elbow
from joint_motions import Sines
from lab_arms import HINGED, PLANAR

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.record import Clock, Frame
from flexarm.validation import initial_alignment as runs
from flexarm.validation.drive_hypotheses import implausible_drives
from flexarm.validation.sensor_check import check

END = 14.0
ARMS = {"one joint": HINGED.model(points=["tip"]), "two joints": PLANAR.model(points=["tip", "elbow_target"])}
RATIO = HINGED.joints[0].ratio
SHOULDER, ELBOW = (joint.ratio for joint in PLANAR.joints)
FREQUENCIES = np.array([0.12, 0.2, 0.45])
"""Of the swings, by which a tip in degrees looked better explained than an encoder in degrees."""


def swing(t: np.ndarray, amplitude: float, middle: float, slower: float) -> np.ndarray:
    """Three sines that start from rest."""
    return Sines(amplitude * np.array([0.6, 0.24, 0.16]), slower * FREQUENCIES, [0, 0, 0], middle)(t)[0]


@cache
def bench(kind: str, amplitude: float, middle: float) -> tuple[flexarm.Arm, flexarm.Record]:
    """An arm and a record of it: encoders, torques, tips; the joints swing about an angle [rad]."""
    arm = ARMS[kind]
    joints = [joint.name for joint in arm.moving_joints]
    motions = {
        name: partial(swing, amplitude=amplitude, middle=(k + 1) * middle, slower=0.8**k)
        for k, name in enumerate(joints)
    }
    run = flexarm.simulate(arm, drive(motions, END), step=5e-3)
    own = {"clock": "controller"}
    sensors = [
        *(_sensor(name, "joint_angle", 100, 2e-6, joint=name, **own) for name in joints),
        *(_sensor(f"{name}_torque", "motor_torque", 50, 0.04, joint=name, **own) for name in joints),
        *(
            _sensor(each.name, "position", 10, 4e-5, point=each.name, axes=("x", "z"), frame="tracker")
            for each in arm.points
        ),
    ]
    seen = flexarm.measure(
        run,
        sensors,
        np.random.default_rng(3),
        drive=joints,
        clocks={"controller": Clock()},
        frames={"tracker": Frame(translation=1e-3, rotation=5e-4)},
    )
    return arm, seen


def _sensor(name: str, quantity: str, rate: float, noise: float, **place: object) -> Sensor:
    return Sensor(name=name, quantity=quantity, rate_hz=rate, noise_std=noise, **place)


def blamed(kind: str, amplitude: float, middle: float, factors: dict[str, float], sees: str) -> dict:
    """Unit errors with their factors by signal, of a record whose drives are off by factors."""
    arm, record = bench(kind, amplitude, middle)
    signals = {
        name: signal.replace(values=signal.values * factors.get(name, 1.0))
        for name, signal in record.signals.items()
        if signal.quantity in ("joint_angle", *sees.split())
    }
    found = check(arm, {"run": record.replace(signals=signals)})
    assert all(fault.name == "unit_error" for fault in found.faults), found
    return {fault.at: fault.parameters[0].value for fault in found.faults}


@pytest.mark.parametrize("sees", ["position", "position motor_torque"])
@pytest.mark.parametrize("factor", [180 / np.pi, 1e3, RATIO, 1 / RATIO, np.pi / 180])
def test_a_small_swing_of_an_upright_arm_in_another_unit(factor, sees):
    """0.05 rad: the tip hardly moves up and down, and 110 is near 100 and 1000 of other units."""
    found = blamed("one joint", 0.05, 0.0, {"hinge": factor}, sees)
    assert found == {"hinge": pytest.approx(factor, rel=0.02)}


@pytest.mark.parametrize("sees", ["position", "position motor_torque"])
@pytest.mark.parametrize(
    ("joint", "factor"),
    [("shoulder", SHOULDER), ("shoulder", 1 / SHOULDER), ("elbow", ELBOW), ("elbow", 1 / ELBOW)],
)
def test_one_of_two_motors_whose_angle_is_not_divided_by_its_ratio_or_twice(joint, factor, sees):
    """The elbow, stretched instead of bent, is off by a metre that no offset of a frame explains."""
    found = blamed("two joints", 0.1, 0.3, {joint: factor}, sees)
    assert found == {joint: pytest.approx(factor, rel=0.02)}


@pytest.mark.parametrize("sees", ["position", "position motor_torque"])
@pytest.mark.parametrize(
    "factors",
    [
        {"shoulder": 180 / np.pi, "elbow": 180 / np.pi},
        {"shoulder": SHOULDER, "elbow": ELBOW},
        {"shoulder": 1 / SHOULDER, "elbow": 1 / ELBOW},
    ],
    ids=["degrees", "motors' own angles", "divided twice"],
)
def test_all_angles_in_one_wrong_unit(factors, sees):
    """Who writes one angle in degrees writes all of them so."""
    found = blamed("two joints", 0.2, 0.3, factors, sees)
    assert found == {name: pytest.approx(factor, rel=0.02) for name, factor in factors.items()}


def test_degrees_of_a_motor_are_named_before_any_run_along_them(monkeypatch):
    """0.3 rad in degrees of a motor are over 300 turns of the joint: no model is driven by them."""
    driven = []
    simulate_all = runs.simulate_all

    def counted(pairs, **options):
        driven.extend(pairs := list(pairs))
        return simulate_all(pairs, **options)

    monkeypatch.setattr(runs, "simulate_all", counted)
    factor = RATIO * 180 / np.pi
    found = blamed("one joint", 0.3, 0.2, {"hinge": factor}, "position motor_torque")
    assert found == {"hinge": pytest.approx(factor, rel=0.02)}
    assert driven
    assert all(any(effect.name == "unit_error" for effect in arm.effects) for arm, _ in driven)


def test_a_turntable_that_turns_many_times_slowly_is_not_wild():
    arm, record = bench("one joint", 0.3, 0.2)
    hinge = record.signals["hinge"]
    slow = hinge.replace(values=5.0 * hinge.time[:, None] + 100.0)
    assert not implausible_drives(arm, record.replace(signals={**record.signals, "hinge": slow}))
    fast = hinge.replace(values=50.0 * hinge.time[:, None])
    assert implausible_drives(arm, record.replace(signals={**record.signals, "hinge": fast})) == {"hinge"}


def test_a_factor_that_no_unit_has_is_estimated():
    """Counts of an encoder with 4096 a turn: 652 of them a radian, found nearest to thousandths."""
    counts = 4096 / (2 * np.pi)
    found = blamed("one joint", 0.1, 0.0, {"hinge": counts}, "position motor_torque")
    assert found == {"hinge": pytest.approx(counts, rel=0.1)}


def test_the_sentence_tells_what_the_angles_are():
    arm, record = bench("two joints", 0.2, 0.3)
    turned = {
        joint.name: record.signals[joint.name].replace(values=record.signals[joint.name].values * joint.ratio)
        for joint in PLANAR.joints
    }
    faults = check(arm, {"run": record.replace(signals={**record.signals, **turned})}).faults
    for fault in faults:
        assert "the drives shoulder and elbow show 120 and 100 times the angle, the motor's own angle" in (
            fault.evidence
        )


@pytest.mark.parametrize("kind", ["one joint", "two joints"])
@pytest.mark.parametrize(("signal", "factor"), [("tip", 1e3), ("tip", 1 / 0.0254)])
def test_a_sensor_in_another_unit_is_not_its_drive(kind, signal, factor):
    for sees in ("position", "position motor_torque"):
        found = blamed(kind, 0.05, 0.0, {signal: factor}, sees)
        assert found == {signal: pytest.approx(factor, rel=0.05)}


@pytest.mark.parametrize("kind", ["one joint", "two joints"])
@pytest.mark.parametrize("amplitude", [0.05, 0.2])
def test_what_is_right_is_not_blamed(kind, amplitude):
    assert blamed(kind, amplitude, 0.3 if kind == "two joints" else 0.0, {}, "position motor_torque") == {}


def test_encoders_that_stand_for_each_others_joint_are_doubted():
    model = waist_and_elbow({"noise_std": 2e-5})
    t = np.linspace(0, 6, 301)
    s = smooth_step(t / 6)
    motion = flexarm.Drive.from_samples(t, {"waist": 1.2 * s, "elbow": 0.6 * np.sin(2 * np.pi * s)})
    record = flexarm.measure(
        flexarm.simulate(model, motion),
        model.sensors,
        np.random.default_rng(1),
        drive=["waist", "elbow"],
        frames={"tracker": Frame()},
    )
    assert check(model, {"run": record}).doubts == ()
    waist, elbow = record.signals["waist"], record.signals["elbow"]
    signals = {"waist": waist.replace(joint="elbow"), "elbow": elbow.replace(joint="waist")}
    found = check(model, {"run": record.replace(signals={**record.signals, **signals})})
    assert found.doubts == (
        "run: the arm follows waist and elbow far better exchanged: is each that of its joint?",
    )
    assert found.usable
