"""A gear couples two joints: angle of its input = ratio x angle of its output, whichever of them is told."""

import numpy as np
import pytest
from arms import TUBE, beam, compliance, hinge, point, rigid
from pytest import approx

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.effects import DriveLag
from flexarm.errors import InvalidParameter
from flexarm.measurement.measure import measure
from flexarm.measurement.predict import read

RATIO = 120.0
ROD = beam("rod", [0, 0, 3.0], TUBE, theory="timoshenko")
ROD_MASS = 13.7  # kg


@pytest.fixture(scope="module")
def arm() -> flexarm.Arm:
    """A motor's shaft beside the hinge of a 3 m tube."""
    return flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "joints": [hinge("shaft", "rotor"), hinge("hinge", "rod")],
            "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": RATIO}],
            "links": [rigid("rotor", 1.0, inertia=[1e-3, 1e-3, 1e-3]), ROD],
            "payloads": [{"name": "load", "link": "rod", "position": [0.0, 0.0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0, 0, 3.0])],
        }
    )


def test_output_told_stands_where_the_input_would_put_it(arm):
    by_output = flexarm.static(arm, joints={"hinge": 0.5})
    by_input = flexarm.static(arm, joints={"shaft": 0.5 * RATIO})
    assert by_output.link_angle == approx([0.5 * RATIO, 0.5])
    assert by_output.position == approx(by_input.position, abs=1e-9)
    assert np.abs(by_output.displacement).max() < 0.02  # 15 mm of sag, no turn


def test_angles_that_contradict_their_gear_are_refused(arm):
    with pytest.raises(InvalidParameter, match="contradicts gear 'reducer'"):
        flexarm.static(arm, joints={"hinge": 0.5, "shaft": 3.0})


@pytest.mark.parametrize("side", ["motor", "output"])
def test_a_run_follows_a_drive_on_the_output_as_one_on_the_input(arm, side):
    """Both sides of a rigid hinge are one angle."""
    time = np.linspace(0, 1, 51)
    angle = 0.2 * np.sin(time) ** 2
    on_input = flexarm.simulate(arm, flexarm.Drive.from_samples(time, {"shaft": RATIO * angle}))
    on_output = flexarm.simulate(arm, flexarm.Drive.from_samples(time, {"hinge": angle}, side))
    assert on_output.joint_angle[-1] == approx([RATIO * angle[-1], angle[-1]])
    assert on_output.position == approx(on_input.position, abs=1e-9)


def test_a_compliance_behind_a_gear_softens_the_arm():
    """The gear turns the output's motor side; the spring behind it lowers f1 as it does without a gear."""
    one = {
        "links": [ROD],
        "joints": [hinge("hinge", "rod")],
        "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": 1e5}],
    }
    geared = {
        **one,
        "links": [ROD, rigid("wheel", 0.1, inertia=[1e-4, 1e-4, 1e-4])],
        "joints": [*one["joints"], hinge("shaft", "wheel")],
        "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 120}],
    }
    direct = flexarm.modes(flexarm.Arm.from_dict(one), count=2).frequency_hz
    behind = flexarm.modes(flexarm.Arm.from_dict(geared), count=2).frequency_hz
    stiff = flexarm.modes(flexarm.Arm.from_dict(one).without_effect("joint_compliance", "hinge"), count=1)
    assert behind == pytest.approx(direct, rel=1e-9)
    assert behind[0] < 0.95 * stiff.frequency_hz[0]


def train(*, by: str) -> flexarm.Simulation:
    """The fall of a rod whose motor turns two gears in series, one of its joints told a torque of zero."""
    joints = [hinge("motor", "rotor"), hinge("middle", "wheel"), hinge("hinge", "rod")]
    gears = [("first", "motor", "middle", -4.0), ("second", "middle", "hinge", 25.0)]
    arm = flexarm.Arm.from_dict(
        {
            "joints": joints,
            "gears": [dict(zip(("name", "input", "output", "ratio"), gear, strict=True)) for gear in gears],
            "links": [*(rigid(name, 0.1, inertia=[1e-3] * 3) for name in ("rotor", "wheel")), ROD],
        }
    )
    time = np.linspace(0, 0.2, 11)
    drive = flexarm.Drive.from_samples(time, {by: 0 * time}, side="torque")
    return flexarm.simulate(arm.replace(gravity=(9.81, 0.0, 0.0)), drive, step=2e-3)


def test_letting_the_last_of_gears_in_series_go_lets_all_go():
    by_last, by_first = train(by="hinge"), train(by="motor")
    assert abs(by_last.joint_angle[-1, 2]) > 0.01
    assert by_last.joint_angle[-1] == approx(by_first.joint_angle[-1], rel=1e-6)


def test_a_motors_torque_is_the_same_behind_a_gear_table_and_a_gear_ratio(arm):
    """Rotor and load are those of a joint with this ratio, asked at the shaft or at the hinge."""
    load = {"name": "load", "link": "rod", "position": [0.0, 0.0, 3.0], "mass": 14.1}
    own = {"gear_ratio": RATIO, "rotor_inertia": 1e-3}
    plain = flexarm.Arm.from_dict(
        {"joints": [hinge("hinge", "rod", **own)], "links": [ROD], "payloads": [load]}
    )
    time = np.linspace(0, 2, 101)
    angle = 0.3 * np.sin(time) ** 2

    def torque(machine: flexarm.Arm, joint: str, side: str) -> np.ndarray:
        run = flexarm.simulate(machine, flexarm.Drive.from_samples(time, {"hinge": angle}))
        sensor = Sensor(name="torque", quantity="motor_torque", joint=joint, side=side, rate_hz=10)
        return read(run, sensor, np.array([0.7, 1.9]))[:, 0]

    light = rigid("rotor", 1e-6, inertia=[1e-3, 1e-3, 1e-3])
    geared = arm.replace(
        links=(
            flexarm.Arm.from_dict({"joints": [hinge("shaft", "rotor")], "links": [light]}).links[0],
            *arm.links[1:],
        )
    )
    for side in ("motor", "output"):
        expected = torque(plain, "hinge", side)
        assert torque(geared, "hinge", side) == approx(expected, rel=1e-4)
    assert torque(geared, "shaft", "motor") == approx(torque(plain, "hinge", "motor"), rel=1e-4)


def test_the_holding_torque_of_a_geared_joint_is_told_at_its_output(arm):
    model = flexarm.linearise(arm, {"hinge": 0.5}, inputs={"hinge": "torque"}, outputs=["hinge"])
    [holding] = model.input_at_rest
    weight = 9.81 * np.sin(0.5) * 3.0 * (14.1 + ROD_MASS / 2)
    assert abs(holding) == approx(weight, rel=0.01)  # sag shifts the load


def test_a_lag_at_the_input_of_a_gear_is_refused_by_a_stepper(arm):
    late = arm.with_effect(DriveLag(at="shaft", delay=0.0, time_constant=0.1))
    with pytest.raises(InvalidParameter, match="drive_lag at 'shaft'"):
        flexarm.Stepper(late, {"hinge": "motor"})


@pytest.mark.parametrize(("driven", "twist"), [("shaft", 0.3 / 5.0), ("hinge", 0.0)])
def test_a_torque_behind_gears_does_not_twist_the_spring_at_their_input(driven, twist):
    """T/(n k) under a torque of the shaft's motor, 0 under one at the hinge; both turn it by T t^2/(2 J)."""
    geared = flexarm.Arm.from_dict(
        {
            "gravity": [0, 0, 0],
            "joints": [hinge("hinge", "link"), hinge("shaft", "rotor")],
            "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 10.0}],
            "links": [rigid("link", 1.0, inertia=[2.0] * 3), rigid("rotor", 1e-6, inertia=[1e-9] * 3)],
            "effects": [compliance("shaft", 5.0, 0.05)],
        }
    )
    torque = np.full(11, 3.0 if driven == "hinge" else 0.3)
    drive = flexarm.Drive.from_samples(np.linspace(0, 0.5, 11), {driven: torque}, side="torque")
    run = flexarm.simulate(geared, drive, step=1e-3)
    assert run.joint_angle[-1, 0] == approx(3.0 * 0.5**2 / 2 / 2.0, rel=0.01)
    assert (run.drive_angle - run.joint_angle)[-1, 1] == approx(twist, abs=1e-6)


@pytest.mark.parametrize("driven", ["shaft", "hinge"])
def test_derivatives_by_the_ratio_of_a_gear_are_those_of_differences(arm, driven):
    """Where the drive names the output, the ratio turns the motor; where it names the input, the arm."""
    angle, key, h = 0.3 * (RATIO if driven == "shaft" else 1.0), "gears.reducer.ratio", 0.01
    time = np.linspace(0, 1, 51)
    drive = flexarm.Drive.from_samples(time, {driven: angle * np.sin(time) ** 2})

    def of(ratio, **options):
        other = arm.with_value(key, ratio)
        return (
            flexarm.static(other, joints={driven: angle}, **options),
            flexarm.simulate(other, drive, **options),
        )

    derived = of(RATIO, sensitivities=[key])
    for found, above, below in zip(derived, of(RATIO + h), of(RATIO - h), strict=True):
        for name in ("position", "drive_angle"):
            differences = (getattr(above, name) - getattr(below, name)) / (2 * h)
            assert found.sensitivities[name][..., 0] == approx(differences, abs=2e-7)
    moved = np.linalg.norm(derived[0].sensitivities["position"])
    assert moved < 1e-6 if driven == "hinge" else moved == approx(3.0 * 0.3 / RATIO, rel=0.02)


@pytest.mark.parametrize("at", ["shaft", "hinge"])
def test_a_record_holds_the_command_of_a_joint_that_lags_before_its_gear(arm, at):
    time = np.linspace(0, 1, 51)
    drive = flexarm.Drive.from_samples(time, {"hinge": 0.2 * np.sin(time) ** 2})
    key = f"effects.drive_lag.{at}.time_constant"
    late = arm.with_effect(DriveLag(at=at, delay=0.02, time_constant=0.05))
    run = flexarm.simulate(late, drive, sensitivities=[key])
    sensor = Sensor(name="s", quantity="joint_angle", joint="hinge", side="motor", rate_hz=100, noise_std=0.0)
    held = measure(run, [sensor], np.random.default_rng(0), drive=["s"]).signals["s"]
    assert held.values[:, 0] == approx(drive.joints["hinge"](held.time), abs=1e-9)
    above, below = (flexarm.simulate(late.with_value(key, tau), drive) for tau in (0.0501, 0.0499))
    differences = (above.position - below.position) / 2e-4
    assert run.sensitivities["position"][..., 0] == approx(differences, abs=1e-4 * np.abs(differences).max())


def test_a_lag_at_the_output_of_a_gear_acts_where_the_drive_names_its_input(arm):
    time = np.linspace(0, 1, 51)
    angle = 0.2 * np.sin(time) ** 2
    late = arm.with_effect(DriveLag(at="hinge", delay=0.02, time_constant=0.05))
    by_output = flexarm.simulate(late, flexarm.Drive.from_samples(time, {"hinge": angle}))
    input_drive = flexarm.Drive.from_samples(time, {"shaft": RATIO * angle})
    by_input, prompt = (flexarm.simulate(model, input_drive) for model in (late, arm))
    assert by_input.position == approx(by_output.position, abs=1e-9)
    assert np.abs(by_input.position - prompt.position).max() > 1e-3
