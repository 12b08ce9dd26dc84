"""Closed loops against the exact motion of a rotor under held torques and voltages."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from arms import hinge, point, rigid
from pytest import approx

from flexarm import Arm, Drive, InvalidParameter, NotConverged, Record, Signal, simulate
from flexarm.control import simulate_closed_loop
from flexarm.control.closed_loop import add_controller_states
from flexarm.control.limits import limited_motors
from flexarm.measurement.measure import measure

INERTIA = 7.0  # about the joint: 4 kg at 1 m, 2 kg m2 about its centre, 1 kg m2 of the rotor
CASCADE: dict[str, Any] = {
    "type": "cascade",
    "joint": "hinge",
    "position_gain": 5.0,
    "velocity_gain": 200.0,
    "integral_time": 0.3,
    "sample_time": 4e-3,
}
MOTOR: dict[str, Any] = {"joint": "hinge", "resistance": 2.0, "torque_constant": 0.05, "efficiency": 0.8}
FEEDBACK: dict[str, Any] = {
    "type": "state_feedback",
    "joint": "hinge",
    "position_gain": 20.0,
    "rate_gain": 4.0,
    "sample_time": 4e-3,
}


def rigid_arm(gravity: float = 0.0, **tables: Any) -> Arm:
    return Arm.from_dict(
        {
            "gravity": [0, 0, -gravity],
            "joints": [hinge("hinge", "rod", gear_ratio=100, rotor_inertia=1e-4)],
            "links": [rigid("rod", 4, [0, 0, 1], [0, 2, 2])],
            "points": [point("tip", "rod", [0, 0, 2])],
            **tables,
        }
    )


def step_command(size: float = 0.1, at: float = 0.02, end: float = 2.0) -> Drive:
    time = np.arange(0, end + 1e-9, 4e-3)
    return Drive.from_samples(time, {"hinge": np.where(time >= at - 1e-9, size, 0.0)}, side="command")


def exact_cascade(n: int) -> np.ndarray:
    """φ_k of J φ'' = T_k, T_k held over T_s, by the cascade's own equations."""
    h, angle, rate, integral, found = 4e-3, 0.0, 0.0, 0.0, []
    for k in range(n):
        found.append(angle)
        command = 0.1 if k >= 5 else 0.0
        error = 5.0 * (command - angle) - rate
        torque = 200.0 * error + integral
        integral += 200.0 * h / 0.3 * error
        angle += h * rate + h**2 / 2 * torque / INERTIA
        rate += h * torque / INERTIA
    return np.array(found)


def exact_feedback(n: int) -> np.ndarray:
    """φ_k of J φ'' = a u_k - c φ', u_k held: the rate decays to a u/c with time constant J/c."""
    a = 0.8 * 0.05 * 100 / 2.0
    c = a * 0.05 * 100
    h, angle, rate, found = 4e-3, 0.0, 0.0, []
    decay = np.exp(-c * h / INERTIA)
    for k in range(n):
        found.append(angle)
        u = 20.0 * ((0.1 if k >= 5 else 0.0) - angle) - 4.0 * rate
        final = a * u / c
        angle += final * h + (rate - final) * (1 - decay) * INERTIA / c
        rate = final + (rate - final) * decay
    return np.array(found)


@pytest.mark.parametrize(
    ("tables", "exact"),
    [
        ({"controllers": [CASCADE]}, exact_cascade),
        ({"controllers": [FEEDBACK], "motors": [MOTOR]}, exact_feedback),
    ],
    ids=["cascade", "voltage"],
)
def test_sampled_loop_converges_to_the_exact_discrete_motion(tables: Any, exact: Any) -> None:
    """A jump of the held torque acts half a step late, so the error is of first order in the step."""
    wanted = exact(501)
    error = []
    for parts in (4, 8, 16):
        run = simulate_closed_loop(rigid_arm(**tables), step_command(), step=4e-3 / parts, alpha=0.0)
        error.append(np.abs(run.drive_angle[::parts, 0] - wanted).max())
    assert error[-1] < 3e-4 * 0.1 * 10
    assert error[0] / error[1] == approx(2, rel=0.1)
    assert error[1] / error[2] == approx(2, rel=0.1)


def test_step_response_of_the_cascade_has_the_position_loops_time_constant() -> None:
    """With a velocity loop 40 times as fast, φ = φ_c (1 - exp(-K_p t)) but for their ratio."""
    stiff = {**CASCADE, "velocity_gain": INERTIA * 200, "integral_time": None, "sample_time": 1e-3}
    arm = rigid_arm(controllers=[{k: v for k, v in stiff.items() if v is not None}])
    run = simulate_closed_loop(arm, step_command(at=0.02), step=5e-4)
    later = run.time > 0.1
    wanted = 0.1 * (1 - np.exp(-5 * (run.time - 0.02)))
    assert run.drive_angle[later, 0] == approx(wanted[later], abs=0.1 * 5 / 200)


def test_arm_at_rest_stays_at_rest_under_gravity() -> None:
    """The integral part starts at the torque that holds the arm, -m g l sin φ about the axis."""
    arm = rigid_arm(gravity=9.81, controllers=[CASCADE])
    run = simulate(arm, Drive.from_samples([0, 1], {"hinge": [0.4, 0.4]}, side="command"))
    assert run.drive_angle[:, 0] == approx(np.full(len(run.time), 0.4), abs=1e-10)
    assert run.motor_torque[:, 0] == approx(np.full(len(run.time), -4 * 9.81 * np.sin(0.4)), rel=1e-6)


def test_torque_limit_of_the_cascade_holds_and_its_integral_part_waits() -> None:
    """Saturated, the arm moves as under the constant limit; the overshoot stays that of the free loop."""
    arm = rigid_arm(controllers=[{**CASCADE, "torque_limit": 20.0}])
    run = simulate_closed_loop(arm, step_command(0.5), step=1e-3)
    assert np.abs(run.motor_torque).max() == approx(20.0, rel=1e-9)
    early = (run.time > 0.02) & (run.time < 0.15)
    wanted = 20 / INERTIA * (run.time[early] - 0.02) ** 2 / 2
    assert run.drive_angle[early, 0] == approx(wanted, abs=5e-4 * 20 / INERTIA * 0.13)
    free = simulate_closed_loop(rigid_arm(controllers=[CASCADE]), step_command(0.5), step=1e-3)
    assert run.drive_angle.max() < 1.1 * free.drive_angle.max()


@pytest.mark.parametrize("step", [0.0, 1e-3])
def test_voltage_and_torque_limits_of_the_motor_hold(step: float) -> None:
    """Also where the loop's encoder counts in coarse steps: the back-EMF is that of the rotor."""
    motor = {**MOTOR, "voltage_limit": 1.5, "torque_limit": 0.02}
    encoder = {"name": "encoder", "quantity": "joint_angle", "joint": "hinge", "rate_hz": 250, "step": step}
    arm = rigid_arm(controllers=[FEEDBACK], motors=[motor], sensors=[encoder])
    run = simulate_closed_loop(arm, step_command(0.5), step=1e-3)
    assert np.nanmax(np.abs(run.motor_voltage)) == approx(1.5)
    # Between samples the back-EMF changes with the rate, by at most c φ'' T_s = 10 * 2/7 * 4e-3 N m.
    assert np.abs(run.motor_torque).max() == approx(0.02 * 100, abs=0.012)


def test_a_motor_that_ends_at_its_limit_away_from_its_command_is_told() -> None:
    """1 N m on 7 kg m2 does not come far in 2 s; 200 N m do."""
    for torque_limit, told in ((1.0, True), (200.0, False)):
        arm = rigid_arm(controllers=[{**CASCADE, "torque_limit": torque_limit}])
        doubts = list(limited_motors(simulate_closed_loop(arm, step_command(0.5), step=4e-3)))
        assert bool(doubts) == told
        assert not told or "is at its torque limit of 1 N m for" in doubts[0].what


def test_a_schedule_that_changes_more_than_gains_is_refused() -> None:
    arm = rigid_arm(controllers=[CASCADE])
    limited = arm.controllers[0].replace(torque_limit=20.0)
    refused = r"schedule\.hinge: changes torque_limit at t = 0 s; a schedule may change gains only"
    with pytest.raises(InvalidParameter, match=refused):
        simulate_closed_loop(arm, step_command(), step=1e-3, schedule={"hinge": lambda t: limited})


def test_energy_of_a_voltage_drive_balances_without_the_motors_electrical_loss() -> None:
    """d(E)/dt = motor power on the rotor: kinetic energy is the motor's work, nothing is damped."""
    arm = rigid_arm(controllers=[FEEDBACK], motors=[MOTOR])
    run = simulate_closed_loop(arm, step_command(), step=1e-3, alpha=0.0)
    assert run.damped == approx(np.zeros(len(run.time)), abs=1e-12)
    assert run.kinetic.max() > 0.05
    assert run.kinetic + run.elastic == approx(run.work, abs=5e-3 * run.kinetic.max())
    assert abs(run.motor_torque[-1, 0]) < 0.05 * np.abs(run.motor_torque).max()


def test_encoder_in_the_loop_gives_multiples_of_its_step_and_their_difference() -> None:
    """A P controller holds K_v (K_p (φ_c - φ) - Δφ/T_s) of the rounded readings."""
    step = 1e-3
    law = {k: v for k, v in CASCADE.items() if k != "integral_time"}
    encoder = {"name": "encoder", "quantity": "joint_angle", "joint": "hinge", "rate_hz": 250, "step": step}
    arm = rigid_arm(controllers=[law], sensors=[encoder])
    run = simulate_closed_loop(arm, step_command(), step=4e-3)
    read = np.round(run.drive_angle[:-1, 0] / step) * step
    rate = np.diff(read, prepend=read[0]) / 4e-3
    wanted = 200.0 * (5.0 * (run.joint_command[:-1, 0] - read) - rate)
    assert run.motor_torque[1:, 0] == approx(wanted, abs=1e-6)
    assert len(np.unique(read)) > 50


def test_deflection_in_the_loop_is_the_one_a_record_holds() -> None:
    """u = -K_2 d with the reading of the sensor that the controller names."""
    feedback = {**FEEDBACK, "position_gain": 5.0, "rate_gain": 0.5, "deflection": "bend"}
    bend = {"name": "bend", "quantity": "deflection", "point": "tip", "axes": ["x"], "rate_hz": 250}
    beam = {
        "name": "rod",
        "type": "beam",
        "end": [0, 0, 2],
        "section": {"shape": "round", "diameter": 0.03},
        "material": {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850},
    }
    arm = rigid_arm(
        links=[beam], sensors=[bend], motors=[MOTOR], controllers=[{**feedback, "deflection_gain": 100.0}]
    )
    run = simulate_closed_loop(arm, step_command(end=0.5), step=4e-3)
    seen = measure(run, arm.sensors, np.random.default_rng(0)).signals["bend"].values[:-1, 0]
    wanted = 5 * (run.joint_command[:-1, 0] - run.drive_angle[:-1, 0]) - 0.5 * run.drive_rate[:-1, 0]
    assert np.abs(seen).max() > 1e-4
    assert run.motor_voltage[:-1, 0] == approx(wanted - 100.0 * seen, abs=1e-9)


def test_gains_may_change_in_a_run() -> None:
    """With its gain at zero the motor only brakes: the arm stays."""
    arm = rigid_arm(controllers=[FEEDBACK], motors=[MOTOR])
    law = arm.controllers[0]
    silent = law.replace(position_gain=0.0)
    run = simulate_closed_loop(
        arm, step_command(), step=2e-3, schedule={"hinge": lambda t: silent if t < 1 - 1e-9 else law}
    )
    assert np.abs(run.drive_angle[run.time < 1]).max() == 0
    assert run.drive_angle[-1, 0] > 0.05


def test_record_with_a_command_drives_through_the_controller() -> None:
    command = step_command()
    time = np.arange(501) * 4e-3
    signal = Signal(
        name="command",
        quantity="joint_command",
        joint="hinge",
        time=time,
        values=command.joints["hinge"](time + 1e-9),
    )
    sensors = [
        {"name": "asked", "quantity": "joint_command", "joint": "hinge", "rate_hz": 50},
        {"name": "volts", "quantity": "motor_voltage", "joint": "hinge", "rate_hz": 50},
    ]
    arm = rigid_arm(controllers=[FEEDBACK], motors=[MOTOR], sensors=sensors)
    by_record = simulate(arm, Record(signals=[signal], drive="command"), end=2.0)
    by_hand = simulate(arm, command)
    assert np.array_equal(by_record.drive_angle, by_hand.drive_angle)
    seen = measure(by_record, arm.sensors, np.random.default_rng(0))
    assert seen.signals["asked"].values[-1, 0] == approx(0.1)
    assert np.abs(seen.signals["volts"].values).max() > 0.1


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InvalidParameter, match=r"joint 'hinge' is moved by a command, but has no controller"):
        simulate(rigid_arm(), step_command())
    with pytest.raises(InvalidParameter, match="step must be positive"):
        simulate(rigid_arm(controllers=[CASCADE]), step_command(), step=0.0)


@pytest.mark.parametrize(
    "tables",
    [
        {"controllers": [{**CASCADE, "velocity_gain": 4 * INERTIA / CASCADE["sample_time"]}]},
        {"motors": [MOTOR], "controllers": [{**FEEDBACK, "position_gain": -20.0}]},
    ],
    ids=["twice as stiff as its samples bear", "the wrong way round"],
)
def test_a_controller_that_diverges_is_named_with_its_time(tables: Any) -> None:
    """A rotor held for T_s bears less than K_v = 2 J/T_s or little more, and no gain of the wrong sign.

    A turn and the 0.1 rad of the command are allowed.
    """
    said = r"controller of joint 'hinge' diverges: at t = .* stands .* rad from its command, allowed are 6.38"
    with pytest.raises(NotConverged, match=said) as failure:
        simulate_closed_loop(rigid_arm(**tables), step_command(end=8.0), step=4e-3)
    assert failure.value.time is not None
    assert 0.02 < failure.value.time < 8.0


def test_a_failure_of_the_solver_says_what_the_controllers_did() -> None:
    arm = rigid_arm(controllers=[CASCADE])
    loops = {"hinge": SimpleNamespace(joint=0)}
    plant: Any = SimpleNamespace(angle=lambda joint, output: 0.25, rate=lambda joint, output: 300.0)
    told = add_controller_states(NotConverged("step 3", time=0.1), arm, loops, plant, {"hinge": 0.5})  # type: ignore[arg-type]
    assert str(told) == (
        "step 3; under its controller the motor of 'hinge' is 0.25 rad from its command and moves at "
        "300 rad/s"
    )
    assert told.time == 0.1
