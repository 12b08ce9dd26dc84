"""An inertial sensor whose axes are not those of its point is seen, and one in order is not doubted."""

import numpy as np
import pytest
from arms import arm as arm_of
from arms import crane, hinge, point, rigid, smooth_step

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.effects import JointCompliance
from flexarm.record import Frame
from flexarm.validation.sensor_check import check


@pytest.fixture(scope="module")
def bench():
    """A crane without its spring, and what an encoder and an accelerometer show of one that has it."""
    arm = crane(effects=[])
    soft = arm.with_effect(JointCompliance(at="hinge", stiffness=1.4e5, damping=180.0))
    t = np.arange(0, 8, 0.01)
    angle = 0.4 * np.sin(2 * np.pi * 0.3 * t) * smooth_step(t / 3)
    run = flexarm.simulate(soft, flexarm.Drive.from_samples(t, {"hinge": angle}), step=4e-3, rotations=True)
    imu = {"quantity": "acceleration", "point": "tip", "rate_hz": 50, "noise_std": 0.02}
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-5),
        Sensor(name="imu", **imu),
    ]
    return arm, flexarm.measure(run, sensors, np.random.default_rng(3), drive=["hinge"])


def doubts(bench, turn):
    arm, record = bench
    imu = record.signals["imu"]
    mounted = imu.replace(values=imu.values @ np.array(turn).T)
    return check(arm, {"run": record.replace(signals={**record.signals, "imu": mounted})}, step=4e-3).doubts


def test_a_sensor_along_the_axes_of_its_point_is_not_doubted(bench):
    assert doubts(bench, np.eye(3)) == ()


@pytest.mark.parametrize(
    ("turn", "told"),
    [
        ([[0, 0, 1], [0, 1, 0], [1, 0, 0]], "x reads z and z reads x of the model's point"),
        ([[0, 0, -1], [0, 1, 0], [1, 0, 0]], "x reads -z and z reads x of the model's point"),
    ],
)
def test_axes_that_are_exchanged_are_named(bench, turn, told):
    [said] = doubts(bench, turn)
    assert said.startswith(f"run: signals.imu: {told}; that leaves ")


@pytest.fixture(scope="module")
def tracked():
    """A boom that turns and lifts, its angles, a gyro, and its tip in a frame of which nothing is known."""
    base = {"type": "revolute", "parent": "base", "child": "mast", "axis": [0, 0, 1]}
    arm = arm_of(
        joints=[{"name": "turn", **base}, hinge("lift", "boom", "mast")],
        links=[rigid("mast", 5.0), rigid("boom", 5.0)],
        points=[point("tip", "boom", [2, 0, 1])],
    )
    t = np.arange(0, 8, 0.01)
    moves = {
        "turn": 0.6 * np.sin(0.9 * t) * smooth_step(t / 3),
        "lift": 0.5 * np.sin(1.7 * t) * smooth_step(t / 3),
    }
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(t, moves), step=4e-3, rotations=True)
    encoders = [
        Sensor(name=joint, quantity="joint_angle", joint=joint, rate_hz=100, noise_std=1e-5)
        for joint in moves
    ]
    seen = Sensor(name="tip", quantity="position", point="tip", rate_hz=20, noise_std=5e-5, frame="tracker")
    gyro = Sensor(name="gyro", quantity="angular_rate", point="tip", rate_hz=50, noise_std=1e-3)
    frames = {"tracker": Frame(unknown=True)}
    return arm, flexarm.measure(
        run, [*encoders, gyro, seen], np.random.default_rng(1), drive=list(moves), frames=frames
    )


def changed(record, name, values, without=()):
    """The record with other values of a signal, and without some signals."""
    signals = {**record.signals, name: record.signals[name].replace(values=values)}
    return record.replace(signals={key: each for key, each in signals.items() if key not in without})


@pytest.mark.parametrize("left", [[0, 1, 0], [1, 1, 1]], ids=["one axis turned", "all turned"])
def test_a_frame_of_the_other_hand_is_told_from_an_encoder_by_a_gyro(tracked, left):
    """The best turn of a mirrored frame spreads the fault over all axes, so that no gain is -1."""
    arm, record = tracked
    record = changed(record, "tip", record.signals["tip"].values * (1 - 2 * np.array(left)))
    [fault] = check(arm, {"run": record}, step=4e-3).faults
    assert (fault.name, fault.at, fault.channels, fault.alternatives) == ("sign_error", "tip", (), ())
    assert fault.probability > 0.99
    assert "tip shows the model in a mirror (" in fault.evidence


def test_a_frame_of_the_other_hand_and_a_turned_encoder_are_the_same_where_nothing_else_is_seen(tracked):
    """It was named for the encoder, as certain."""
    arm, record = tracked
    tip, turn = record.signals["tip"].values, record.signals["turn"].values
    for wrong in (
        changed(record, "tip", tip[:, [1, 0, 2]], ["gyro"]),
        changed(record, "turn", -turn, ["gyro"]),
    ):
        found = flexarm.diagnose(arm, {"run": wrong}, step=4e-3, n_jobs=1)
        [effect] = found.effects
        assert found.verdict == "unusable"
        assert (effect.name, effect.at, round(effect.probability, 1)) == ("sign_error", "tip", 0.5)
        assert [(each.name, each.at) for each in effect.alternatives] == [("sign_error", "turn")]


def test_a_frame_of_the_right_hand_is_in_order(tracked):
    arm, record = tracked
    assert check(arm, {"run": record}, step=4e-3).usable


@pytest.mark.parametrize(
    ("columns", "unknown", "seen"), [([1, 0], False, 1), ([0, 1], False, 0), ([1, 0], True, 0)]
)
def test_two_columns_of_a_plane_that_are_exchanged_are_seen_where_the_frame_is_stated(columns, unknown, seen):
    """x and z of the tip of an arm in a plane; an unknown frame may look at the plane from behind."""
    arm, t = crane(effects=[]), np.arange(0, 8, 0.01)
    angle = 0.8 * np.sin(2 * np.pi * 0.3 * t) * smooth_step(t / 3)
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(t, {"hinge": angle}), step=4e-3)
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-5),
        Sensor(name="tip", quantity="position", point="tip", axes=("x", "z"), rate_hz=20, noise_std=5e-5,
               frame="tracker"),
    ]  # fmt: skip
    frame = Frame(unknown=True) if unknown else Frame(translation=1e-3, rotation=5e-4)
    record = flexarm.measure(
        run, sensors, np.random.default_rng(1), drive=["hinge"], frames={"tracker": frame}
    )
    tip = record.signals["tip"]
    exchanged = {**record.signals, "tip": tip.replace(values=tip.values[:, columns])}
    found = check(arm, {"run": record.replace(signals=exchanged)}, step=4e-3)
    assert sum("mirror" in fault.evidence for fault in found.faults) == seen


def test_places_of_which_one_axis_is_all_but_missing_are_compared_without_them():
    """Two places in one frame; one has but few readings along z."""
    arm, t = crane(effects=[]), np.arange(0, 4, 0.01)
    angle = 0.8 * np.sin(2 * np.pi * 0.3 * t) * smooth_step(t / 3)
    run = flexarm.simulate(arm, flexarm.Drive.from_samples(t, {"hinge": angle}), step=4e-3)
    place = {"quantity": "position", "point": "tip", "axes": ("x", "z"), "rate_hz": 20, "noise_std": 5e-5}
    sensors = [
        Sensor(name="hinge", quantity="joint_angle", joint="hinge", rate_hz=100, noise_std=1e-5),
        *(Sensor(name=name, frame="tracker", **place) for name in ("tip", "half")),
    ]
    frames = {"tracker": Frame(translation=1e-3, rotation=5e-4)}
    record = flexarm.measure(run, sensors, np.random.default_rng(1), drive=["hinge"], frames=frames)
    tip, half = (record.signals[name].values[:, [1, 0]] for name in ("tip", "half"))
    half[:-5, 1] = np.nan
    found = check(arm, {"run": changed(changed(record, "tip", tip), "half", half)}, step=4e-3)
    assert any("tip shows the model in a mirror" in fault.evidence for fault in found.faults)
