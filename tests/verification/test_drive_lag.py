"""Joints that follow their drives late: closed forms, an ordinary differential equation, and records."""

import numpy as np
import pytest
from arms import G, arm, crane, hinge, point, rigid, smooth_step, tracker
from scipy.integrate import solve_ivp

import flexarm
from flexarm import Drive, InvalidParameter, Record, Signal, simulate, static
from flexarm.arm import Sensor
from flexarm.arm.parameter import with_value
from flexarm.cli.virtual_record import sensed, simulated
from flexarm.drive.lag import lagged
from flexarm.effects import DriveLag
from flexarm.measurement.measure import measure
from flexarm.stepping import Stepper

DELAY, TAU = 0.03, 0.05
TIME = np.linspace(0, 2, 81)
SWING = 0.8 * smooth_step(TIME / 1.5)


def ramp(end: float = 1.0) -> Drive:
    """0.5 rad/s from t = 0 on."""
    return Drive.from_samples([0.0, 0.25, 0.5, end], {"hinge": [0.0, 0.125, 0.25, 0.5 * end]})


@pytest.mark.parametrize("tau", [1e-3, 0.05, 0.4])
def test_behind_a_ramp_the_joint_is_the_ramp_less_delay_and_time_constant(tau: float) -> None:
    """y(t) = r (s - tau + tau exp(-s/tau)) with s = t - D, from rest; it settles after the ramp ends."""
    y = lagged(ramp().joints["hinge"], DELAY, tau)
    s = np.linspace(0, 1, 400)
    assert y(s + DELAY) == pytest.approx(0.5 * (s - tau + tau * np.exp(-s / tau)), abs=2e-9)
    at_end = 0.5 * (1 - tau + tau * np.exp(-1 / tau))
    later = np.linspace(0, 3, 300)
    settled = 0.5 + (at_end - 0.5) * np.exp(-later / tau)
    assert y(1 + DELAY + later) == pytest.approx(settled, abs=2e-9)
    assert y(np.array([-1.0, 0.0, DELAY])) == pytest.approx(0.0)


def test_a_smooth_drive_is_followed_as_the_differential_equation_says_and_smoothly() -> None:
    u = Drive.from_samples(TIME, {"hinge": SWING}).joints["hinge"]
    y = lagged(u, DELAY, TAU)
    exact = solve_ivp(
        lambda t, x: (u(t - DELAY) - x) / TAU,
        (0, 3),
        [0.0],
        rtol=1e-11,
        atol=1e-13,
        max_step=5e-3,
        dense_output=True,
    )
    t = np.linspace(0, 3, 500)
    assert y(t) == pytest.approx(exact.sol(t)[0], abs=2e-8)
    motion = y.polynomial()
    left, right = (np.array([motion(t + h) for t in y.breaks[1:-1]]) for h in (-1e-11, 1e-11))
    assert left[:, :2] == pytest.approx(right[:, :2], abs=1e-8)
    assert lagged(u, 0.0, 0.0)(t) == pytest.approx(u(t), abs=0)


def pendulum(**more: object) -> flexarm.Arm:
    tables = {
        "gravity": [0, 0, -G],
        "joints": [hinge("hinge", "rod")],
        "links": [rigid("rod", 5.0, com=(0, 0, 1.0))],
        "points": [point("tip", "rod", [0, 0, 1.0])],
    }
    return arm(**{**tables, **more})


def test_a_run_follows_late_and_tells_what_it_was_told() -> None:
    drive = Drive.from_samples(TIME, {"hinge": SWING})
    late = pendulum().with_effect(DriveLag(at="hinge", delay=DELAY, time_constant=TAU))
    run = simulate(late, drive)
    y = lagged(drive.joints["hinge"], DELAY, TAU)
    assert run.drive_angle[:, 0] == pytest.approx(y(run.time), abs=1e-12)
    assert run.joint_command[:, 0] == pytest.approx(drive.joints["hinge"](run.time), abs=1e-12)
    by_hand = simulate(pendulum(), Drive({"hinge": y}, end=drive.end))
    assert run.position == pytest.approx(by_hand.position, abs=1e-10)
    assert np.array_equal(static(late, {"hinge": 0.3}).position, static(pendulum(), {"hinge": 0.3}).position)


@pytest.mark.parametrize("key", ["delay", "time_constant"])
@pytest.mark.parametrize("driven_by", ["drive", "record"])
def test_derivatives_of_a_run_are_differences_of_runs(key: str, driven_by: str) -> None:
    model = crane().with_effect(DriveLag(at="hinge", delay=DELAY, time_constant=TAU))
    path = f"effects.drive_lag.hinge.{key}"
    drive = Drive.from_samples(TIME, {"hinge": SWING})
    told = drive if driven_by == "drive" else commanded(drive)
    found = simulate(model, told, sensitivities=[path, "payloads.load.mass"]).sensitivities.by(path)[
        "position"
    ]
    value = getattr(model.effects[0], key)
    up, down = (simulate(with_value(model, path, value + h), told).position for h in (1e-4, -1e-4))
    difference = (up - down) / 2e-4
    assert np.abs(difference).max() > 0.1
    assert found == pytest.approx(difference, abs=1e-3 * np.abs(difference).max())


def commanded(drive: Drive, quantity: str = "joint_command") -> Record:
    """A record of what the joint was told, exact."""
    time = np.linspace(drive.start, drive.end, 401)
    angle = drive.joints["hinge"](time)
    side = {} if quantity == "joint_command" else {"side": "motor"}
    signal = Signal(
        name="told",
        quantity=quantity,
        joint="hinge",
        unit="rad",
        time=time,
        values=angle,
        noise_std=0.0,
        **side,
    )
    return Record(signals=[signal], drive="told")


def test_without_a_controller_a_joint_follows_its_command() -> None:
    drive = Drive.from_samples(TIME, {"hinge": SWING})
    exact = simulate(pendulum(), drive)
    found = simulate(pendulum(), commanded(drive), end=drive.end)
    assert found.position == pytest.approx(exact.position, abs=1e-7)


def test_virtual_records_hold_the_drive_and_not_what_the_motor_made_of_it() -> None:
    """The encoder that drives shows what the joint was told; the others show where it is."""
    drive = Drive.from_samples(TIME, {"hinge": SWING})
    seen = [
        Sensor(name="told", quantity="joint_angle", joint="hinge", rate_hz=100),
        Sensor(name="turned", quantity="joint_angle", joint="hinge", rate_hz=100),
    ]
    late = pendulum().with_effect(DriveLag(at="hinge", time_constant=TAU))
    run = simulate(late, drive)
    record = measure(run, seen, np.random.default_rng(0), drive=["told"])
    time = record.signals["told"].time
    assert record.signals["told"].values[:, 0] == pytest.approx(drive.joints["hinge"](time), abs=1e-6)
    assert record.signals["turned"].values[:, 0] == pytest.approx(
        lagged(drive.joints["hinge"], 0.0, TAU)(time), abs=1e-6
    )
    by_command = sensed(run, late, drive, 0)
    assert by_command.signals["hinge"].quantity == "joint_angle"
    assert by_command.signals["hinge"].values[:, 0] == pytest.approx(
        drive.joints["hinge"](run.time), abs=1e-12
    )
    again = simulated(by_command, run, late)
    assert np.array_equal(again.signals["hinge"].values, by_command.signals["hinge"].values)
    assert flexarm.compare(late, again).signals["hinge"].rms["total"] < 1e-9
    repeated = simulate(late, again, end=drive.end)
    assert repeated.position == pytest.approx(run.position, abs=1e-7)


def test_a_lag_at_the_output_of_a_gear_moves_to_its_input() -> None:
    geared = arm(
        gravity=[0, 0, -G],
        joints=[hinge("shaft", "rotor"), hinge("hinge", "rod")],
        gears=[{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 4.0}],
        links=[rigid("rotor", 1.0, inertia=(0.1, 0.1, 0.1)), rigid("rod", 5.0, com=(0, 0, 1.0))],
        points=[point("tip", "rod", [0, 0, 1.0])],
    )
    drive = Drive.from_samples(TIME, {"hinge": SWING})
    wanted = simulate(pendulum().with_effect(DriveLag(at="hinge", time_constant=TAU)), drive).joint_angle[
        :, 0
    ]
    for at in ("hinge", "shaft"):
        run = simulate(geared.with_effect(DriveLag(at=at, time_constant=TAU)), drive)
        assert run.joint_angle[:, 1] == pytest.approx(wanted, abs=2e-9)


def test_what_cannot_lag_is_refused() -> None:
    late = DriveLag(at="hinge", time_constant=TAU)
    torque = Drive.from_samples(TIME, {"hinge": 0 * TIME}, side="torque")
    with pytest.raises(
        InvalidParameter, match="acts on a prescribed angle, and this run prescribes a torque"
    ):
        simulate(pendulum().with_effect(late), torque)
    with pytest.raises(InvalidParameter, match="a stepper follow their inputs at once"):
        Stepper(pendulum().with_effect(late), {"hinge": "motor"})
    with pytest.raises(InvalidParameter, match="time_constant: must be at least 0"):
        DriveLag(at="hinge", time_constant=-1.0)


def test_a_diagnosis_names_the_lag_of_a_commanded_joint() -> None:
    """Command and tracker on one clock: a delay and a time constant of a quick motion."""
    model = crane(uncertainty={})
    truth = model.with_effect(DriveLag(at="hinge", delay=0.02, time_constant=0.04))
    t = np.linspace(0, 8, 401)
    drive = Drive.from_samples(t, {"hinge": 0.6 * np.sin(1.5 * t) * smooth_step(t / 3)})
    run = simulate(truth, drive)
    seen = tracker().replace(clock=None, frame="base", rate_hz=20)
    record = measure(run, [seen], np.random.default_rng(4))
    told = commanded(drive).signals["told"]
    record = record.replace(
        signals={"told": told.replace(clock=record.signals["tip"].clock), **record.signals}, drive=("told",)
    )
    found = flexarm.diagnose(model, [record], seed=1)
    names = {found.effects[0].name, *(other.name for other in found.effects[0].alternatives)}
    assert "drive_lag" in names
