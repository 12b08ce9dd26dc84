"""Derivatives of runs under sampled controllers against differences of whole runs, and in limits.

Runs with derivatives are converged to 1e-13. Nothing but its controller holds a motor, so that what Newton's
iteration leaves of accelerations adds up: differences take steps far above it, in three sizes, extrapolated
to an error of the sixth power.
"""

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.helpers.arms import TUBE, G, beam, hinge, point, rigid, smooth_step

import flexarm
import flexarm.effects
from flexarm.arm.parameter import with_value
from flexarm.control import simulate_closed_loop
from flexarm.measurement.slopes import predict_slopes

END = 0.32  # s
CASCADE: dict[str, Any] = {
    "type": "cascade",
    "joint": "hinge",
    "position_gain": 5.0,
    "velocity_gain": 2500.0,
    "integral_time": 0.1,
    "sample_time": 4e-3,
}
FEEDBACK: dict[str, Any] = {
    "type": "state_feedback",
    "joint": "hinge",
    "position_gain": 150.0,
    "rate_gain": 20.0,
    "deflection": "bend",
    "deflection_gain": 30.0,
    "deflection_rate_gain": 5.0,
    "sample_time": 4e-3,
}
MOTOR = {"joint": "hinge", "resistance": 2.0, "torque_constant": 0.5, "efficiency": 0.8}
ENCODER = {"name": "encoder", "quantity": "joint_angle", "joint": "hinge", "rate_hz": 250}
BEND = {"name": "bend", "quantity": "deflection", "point": "tip", "axes": ["x"], "rate_hz": 250}
COMPLIANCE = {"name": "joint_compliance", "at": "hinge", "stiffness": 8e4, "damping": 160.0}
FRICTION = {"name": "motor_friction", "at": "hinge", "viscous": 20.0}


def planar_arm(**tables: Any) -> flexarm.Arm:
    """The paper's tube on a soft hinge with a geared motor and an encoder that errs."""
    return flexarm.Arm.from_dict(
        {
            "gravity": [0.0, 0.0, -G],
            "joints": [{**hinge("hinge", "rod"), "gear_ratio": 120, "rotor_inertia": 1e-3}],
            "links": [beam("rod", [0, 0, 3.0], TUBE, elements=2, damping_ratio=0.03)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0, 0, 3.0])],
            "effects": [
                COMPLIANCE,
                FRICTION,
                {"name": "link_length", "at": "rod", "error": 2e-3},
                {"name": "encoder_scale", "at": "encoder", "scale": 1.002},
                {"name": "encoder_offset", "at": "encoder", "offset": 1e-3},
                {"name": "encoder_eccentricity", "at": "encoder", "amplitude": 2e-3, "phase": 0.4},
            ],
            "sensors": [ENCODER, BEND],
            **tables,
        }
    )


def spatial_arm() -> flexarm.Arm:
    """A column that turns under a cascade, and a leaning rod on it under a voltage sampled half as often."""
    elbow = {**hinge("elbow", "rod", "column", gear_ratio=100, rotor_inertia=2e-4)}
    elbow["origin"] = {"xyz": [0.1, 0, 0.8], "rpy": [0.2, 0.0, 0.1]}
    voltage = {**FEEDBACK, "joint": "elbow", "position_gain": 60.0, "rate_gain": 6.0, "sample_time": 8e-3}
    return flexarm.Arm.from_dict(
        {
            "gravity": [0.4, 0.0, -G],
            "joints": [
                {**hinge("turn", "column"), "axis": [0, 0.1, 1], "gear_ratio": 80, "rotor_inertia": 1e-3},
                elbow,
            ],
            "links": [
                rigid("column", 20.0, [0.05, 0, 0.4], [1.0, 1.2, 0.4]),
                beam("rod", [0, 0.2, 1.5], {"shape": "round", "diameter": 0.03}, damping_ratio=0.02),
            ],
            "payloads": [
                {
                    "name": "load",
                    "link": "rod",
                    "position": [0, 0.2, 1.5],
                    "mass": 4.0,
                    "inertia": [0.1, 0.08, 0.05],
                }
            ],
            "points": [point("tip", "rod", [0, 0.2, 1.5]), point("off", "rod", [0.1, 0.2, 1.5])],
            "motors": [{**MOTOR, "joint": "elbow", "torque_constant": 0.3}],
            "sensors": [
                {
                    "name": "speed",
                    "quantity": "joint_rate",
                    "joint": "turn",
                    "side": "output",
                    "rate_hz": 250,
                },
                {
                    "name": "angle",
                    "quantity": "joint_angle",
                    "joint": "turn",
                    "side": "output",
                    "rate_hz": 250,
                },
                {**BEND, "point": "off"},
            ],
            "controllers": [{**CASCADE, "joint": "turn", "velocity_gain": 400.0}, voltage],
            "effects": [
                {"name": "joint_compliance", "at": "turn", "stiffness": 2e4, "damping": 30.0},
                {"name": "joint_compliance", "at": "elbow", "stiffness": 1e4, "damping": 20.0},
                {"name": "sensor_offset", "at": "bend", "offset": 1e-4},
                {"name": "base_tilt", "at": "base", "angle": [0.03, 0.05]},
            ],
        }
    )


def command(end: float = END, **sizes: float) -> flexarm.Drive:
    """From 0.3 rad of each joint along a smooth step."""
    t = np.arange(0, end + 1e-9, 4e-3)
    samples = {name: 0.3 + size * smooth_step(t / end) for name, size in (sizes or {"hinge": 0.1}).items()}
    return flexarm.Drive.from_samples(t, samples, side="command")


def extrapolated(of: Callable[[float], NDArray], value: float, step: float) -> tuple[NDArray, float]:
    """df/dp by central differences of three steps, and by how much extrapolations of two steps differ."""
    rough, fine, finest = ((of(value + h) - of(value - h)) / (2 * h) for h in (4 * step, 2 * step, step))
    coarse, close = (4 * fine - rough) / 3, (4 * finest - fine) / 3
    return np.asarray((16 * close - coarse) / 15), size(close - coarse)


def size(array: NDArray) -> float:
    """Of the largest entry; NaN, where there is no voltage, left out."""
    return float(np.abs(array[np.isfinite(array)]).max(initial=0.0))


def converged(
    arm: flexarm.Arm,
    drive: flexarm.Drive | flexarm.Record,
    step: float,
    keys: Iterable[str] = ("points.tip.position.x",),
) -> flexarm.Simulation:
    """A run whose Newton iterations end at rounding."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("flexarm.control.closed_loop.DIFFERENTIATED", 1e-15)
        return flexarm.simulate(arm, drive, step=step, sensitivities=keys)


def check(
    arm: flexarm.Arm, drive: flexarm.Drive | flexarm.Record, steps: dict[str, float], step: float = 2e-3
) -> None:
    """Every array by every parameter, in parts of the array's largest derivative."""
    found = converged(arm, drive, step, steps).sensitivities
    assert found is not None
    for parameter in found.parameters:
        runs: dict[float, flexarm.Simulation] = {}

        def at(p: float, name: str, key: str = parameter.key, runs: Any = runs) -> NDArray:
            if p not in runs:
                runs[p] = converged(with_value(arm, key, p), drive, step)
            return np.asarray(getattr(runs[p], name))

        for name, derivative in found.by(parameter.key).items():
            expected, doubt = extrapolated(
                lambda p, name=name: at(p, name), parameter.value, steps[parameter.key]
            )
            assert np.array_equal(np.isnan(derivative), np.isnan(expected)), (parameter.key, name)
            error, largest = size(derivative - expected), size(expected)
            if name in RATES:
                largest = max(largest, size(found.by(parameter.key)[RATES[name]]))
            assert error <= COARSER.get(name, 1e-6) * largest + 3 * doubt, (parameter.key, name)
            assert doubt <= DOUBT * largest, (parameter.key, name)


DOUBT = 5e-4
"""Greatest of differences, which rounding limits where a parameter hardly moves an array; 1e-7 is usual."""
COARSER = {name: 5e-6 for name in ("velocity", "joint_rate", "drive_rate", "motor_torque", "motor_voltage")}
"""Readings err by 1e-9, as what is differentiated by models beside the arm does; gains over the sample time
make 1e-6 of it. Rates are coordinates over the step, so rounding of them weighs as much more."""
RATES = {"velocity": "position", "joint_rate": "joint_angle", "drive_rate": "drive_angle"}
"""Beside a motion that hardly moves, as by an encoder's offset, rates count by what would move a second."""


# What moves the arm by some parts in a thousand, as the finest of three differences.
MECHANICS = {
    "links.rod.material.youngs_modulus": 1e9,
    "links.rod.damping_ratio": 1.5e-3,
    "payloads.load.mass": 0.05,
    "joints.hinge.rotor_inertia": 4e-6,
    "joints.hinge.gear_ratio": 0.2,
    "effects.joint_compliance.hinge.stiffness": 400.0,
    "effects.joint_compliance.hinge.damping": 6.0,
    "effects.motor_friction.hinge.viscous": 2.0,
    "effects.link_length.rod.error": 2e-3,
    "effects.encoder_scale.encoder.scale": 4e-3,
    "effects.encoder_offset.encoder.offset": 2e-3,
    "effects.encoder_eccentricity.encoder.amplitude": 5e-4,
}


@pytest.mark.parametrize("sample_time", [4e-3, 8e-3])
@pytest.mark.parametrize("law", ["P", "PI"])
def test_a_run_under_a_cascade_has_the_derivatives_of_differences(law: str, sample_time: float) -> None:
    controller = {**CASCADE, "sample_time": sample_time}
    if law == "P":
        del controller["integral_time"]
    check(planar_arm(controllers=[controller]), command(), MECHANICS)


def test_a_run_under_a_voltage_has_the_derivatives_of_differences() -> None:
    """State feedback with the deflection and differences of readings; the motor's numbers act too."""
    arm = planar_arm(controllers=[FEEDBACK], motors=[MOTOR])
    motor = {"resistance": 8e-3, "torque_constant": 2e-3, "efficiency": 4e-3}
    check(arm, command(), {**MECHANICS, **{f"motors.hinge.{name}": step for name, step in motor.items()}})


def test_two_joints_in_space_have_the_derivatives_of_differences() -> None:
    steps = {
        "links.rod.material.youngs_modulus": 1e9,
        "links.rod.damping_ratio": 2e-3,
        "joints.elbow.origin.xyz.z": 1e-3,
        "payloads.load.mass": 0.02,
        "payloads.load.position.y": 2e-3,
        "points.off.position.x": 2e-3,
        "joints.elbow.gear_ratio": 0.4,
        "joints.turn.rotor_inertia": 4e-6,
        "joints.turn.axis.y": 1e-3,
        "motors.elbow.torque_constant": 1e-3,
        "effects.joint_compliance.turn.stiffness": 100.0,
        "effects.joint_compliance.elbow.damping": 1.0,
        "effects.sensor_offset.bend.offset": 1e-3,
        "effects.base_tilt.base.angle.x": 1e-3,
    }
    check(spatial_arm(), command(turn=0.2, elbow=-0.1), steps)


def test_a_motor_before_a_gear_has_the_derivatives_of_differences() -> None:
    """The controller holds the shaft, whose torque the gear's ratio carries to the rod."""
    ratio = 20.0
    arm = flexarm.Arm.from_dict(
        {
            "gravity": [0.0, 0.0, -G],
            "joints": [hinge("shaft", "rotor"), hinge("hinge", "rod")],
            "gears": [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": ratio}],
            "links": [
                rigid("rotor", 1.0, inertia=[0.02, 0.02, 0.02]),
                beam("rod", [0, 0, 1.5], {"shape": "round", "diameter": 0.03}, damping_ratio=0.02),
            ],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 1.5], "mass": 3.0}],
            "points": [point("tip", "rod", [0, 0, 1.5])],
            "effects": [{**COMPLIANCE, "stiffness": 1e4, "damping": 20.0}],
            "controllers": [{**CASCADE, "joint": "shaft", "velocity_gain": 1.0, "integral_time": 0.3}],
        }
    )
    t = np.arange(0, END + 1e-9, 4e-3)
    angle = ratio * (0.3 + 0.1 * smooth_step(t / END))
    drive = flexarm.Drive.from_samples(t, {"shaft": angle}, side="command")
    check(arm, drive, {"gears.reducer.ratio": 0.02, "payloads.load.mass": 0.02})


def test_a_run_as_it_is_made_has_derivatives_to_its_own_accuracy() -> None:
    """Newton's iteration ends at 1e-13 of the reach; axial damping, 1e8 N/m, feels that most."""
    arm, drive = planar_arm(controllers=[CASCADE]), command()
    run, best = (
        flexarm.simulate(arm, drive, step=2e-3, sensitivities=MECHANICS),
        converged(arm, drive, 2e-3, MECHANICS),
    )
    assert run.sensitivities is not None and best.sensitivities is not None
    for name, bound in {
        "position": 1e-6,
        "joint_angle": 5e-6,
        "motor_torque": 3e-5,
        "joint_rate": 5e-5,
    }.items():
        found, expected = (each.sensitivities[name].reshape(-1, len(MECHANICS)) for each in (run, best))
        assert np.all(np.abs(found - expected).max(axis=0) <= bound * np.abs(expected).max(axis=0)), name


def test_without_gains_the_derivatives_are_those_of_a_motor_without_torque() -> None:
    """A motor at 0 V brakes by c = eta (k_m n)^2/R: the open loop with that friction of the rotor."""
    silent = {"type": "state_feedback", "joint": "hinge", "position_gain": 0.0, "sample_time": 4e-3}
    arm = planar_arm(controllers=[silent], motors=[MOTOR])
    keys = [key for key in MECHANICS if "encoder" not in key and "gear_ratio" not in key]
    t = np.arange(0, END + 1e-9, 4e-3)
    still = {"hinge": np.full_like(t, 0.3)}
    closed = flexarm.simulate(
        arm, flexarm.Drive.from_samples(t, still, side="command"), step=2e-3, sensitivities=keys
    )
    braked = arm.with_effect(arm.effect("motor_friction", "hinge").replace(viscous=20 + 0.8 * 60**2 / 2))
    start = float(closed.drive_angle[0, 0])
    free = flexarm.Drive.from_samples(t, {"hinge": np.zeros_like(t)}, side="torque")
    open_loop = flexarm.simulate(
        braked, replace(free, rest={"hinge": start}), step=2e-3, dimension="space", sensitivities=keys
    )
    assert closed.sensitivities is not None and open_loop.sensitivities is not None
    assert size(closed.drive_angle - start) > 0.01  # it falls
    for name in ("position", "joint_angle", "drive_angle", "joint_torque"):
        expected = open_loop.sensitivities[name]
        assert size(closed.sensitivities[name] - expected) <= 1e-12 * size(expected), name


def test_an_integral_part_holds_the_motor_whatever_the_load_weighs() -> None:
    """At the end dφ/dm = 0, and torque and tip have the derivatives of statics at that angle."""
    arm = planar_arm(controllers=[{**CASCADE, "integral_time": 0.3}], effects=[COMPLIANCE])
    t = np.arange(0, 8.0 + 1e-9, 4e-3)
    drive = flexarm.Drive.from_samples(
        t, {"hinge": 0.3 + 0.2 * smooth_step(np.minimum(t, 1.0))}, side="command"
    )
    key = "payloads.load.mass"
    run = flexarm.simulate(arm, drive, step=4e-3, sensitivities=[key])
    at_rest = flexarm.static(arm, {"hinge": 0.5}, sensitivities=[key])
    assert run.sensitivities is not None and at_rest.sensitivities is not None
    found, expected = run.sensitivities.by(key), at_rest.sensitivities.by(key)
    assert size(found["drive_angle"]) > 1e-4
    assert abs(found["drive_angle"][-1, 0]) < 1e-7
    assert found["motor_torque"][-1, 0] == pytest.approx(expected["joint_torque"][0], rel=1e-5)
    assert found["position"][-1] == pytest.approx(expected["position"], rel=1e-4)


@pytest.mark.parametrize("limits", [{"torque_limit": 1.5}, {"voltage_limit": 3.0}])
def test_a_limit_passes_on_the_derivative_of_its_side(limits: dict[str, float]) -> None:
    """Held by a limit, the arm moves with the limit and not with what the law asks for."""
    arm = planar_arm(controllers=[FEEDBACK], motors=[{**MOTOR, **limits}])
    name, most = next(iter(limits.items()))
    drive = command(hinge=0.4)
    run = flexarm.simulate(arm, drive, step=2e-3)
    reached = run.motor_voltage if name == "voltage_limit" else run.motor_torque / 120
    assert size(reached) >= 0.999 * most
    check(
        arm,
        drive,
        {
            f"motors.hinge.{name}": 1e-4,
            "payloads.load.mass": 1e-3,
            "effects.encoder_scale.encoder.scale": 1e-4,
        },
    )


def test_a_cascade_at_its_limit_waits_and_so_do_the_derivatives_of_its_integral_part() -> None:
    """From the one limit to the other and free in between; no difference moves a sample across."""
    arm = planar_arm(controllers=[{**CASCADE, "torque_limit": 250.0}])
    t = np.arange(0, 0.6 + 1e-9, 4e-3)
    samples = 0.3 + 0.4 * smooth_step(np.minimum(t / 0.3, 1.0))
    drive = flexarm.Drive.from_samples(t, {"hinge": samples}, side="command")
    torque = flexarm.simulate(arm, drive, step=2e-3).motor_torque
    assert [torque.max(), torque.min(), size(torque[-1])] == pytest.approx([250.0, -250.0, 250.0])
    check(arm, drive, {"payloads.load.mass": 2e-3, "effects.joint_compliance.hinge.stiffness": 20.0})


def test_rounding_of_an_encoder_is_left_out_of_derivatives() -> None:
    """With steps the motion jumps with a parameter; over many of them it changes as without."""
    arm = planar_arm(controllers=[CASCADE], sensors=[{**ENCODER, "step": 1e-6}, BEND])
    key = "payloads.load.mass"
    found = flexarm.simulate(arm, command(), step=2e-3, sensitivities=[key])
    smooth = flexarm.simulate(planar_arm(controllers=[CASCADE]), command(), step=2e-3, sensitivities=[key])
    assert found.sensitivities is not None and smooth.sensitivities is not None
    assert not np.array_equal(found.motor_torque, smooth.motor_torque)
    above, below = (flexarm.simulate(with_value(arm, key, 14.1 + h), command(), step=2e-3) for h in (1, -1))
    for name in ("drive_angle", "position"):
        expected = smooth.sensitivities[name][..., 0]
        assert size(found.sensitivities[name][..., 0] - expected) < 1e-3 * size(expected), name
        steps = (getattr(above, name) - getattr(below, name)) / 2
        assert size(found.sensitivities[name][..., 0] - steps) < 0.05 * size(expected), name


def record_of(drive: flexarm.Drive) -> flexarm.Record:
    """The command as somebody recorded it."""
    t = np.arange(0, END + 1e-9, 4e-3)
    signal = flexarm.Signal(
        name="asked", quantity="joint_command", joint="hinge", time=t, values=drive.joints["hinge"](t + 1e-9)
    )
    return flexarm.Record(signals=[signal], drive="asked")


def test_effects_on_a_recorded_command_move_the_run() -> None:
    arm = planar_arm(controllers=[CASCADE]).with_effect(flexarm.effects.SensorOffset(at="asked", offset=1e-3))
    keys = {"effects.sensor_offset.asked.offset": 1e-3, "payloads.load.mass": 0.05}
    check(arm, record_of(command()), keys)


def test_voltages_have_derivatives_as_signals_and_in_files(tmp_path: Path) -> None:
    arm = planar_arm(controllers=[FEEDBACK], motors=[MOTOR])
    run = flexarm.simulate(arm, command(), step=2e-3, sensitivities=["motors.hinge.resistance"])
    assert run.sensitivities is not None
    derivative = run.sensitivities["motor_voltage"]
    volts = flexarm.Signal(
        name="volts",
        quantity="motor_voltage",
        joint="hinge",
        time=run.time[::4],
        values=np.zeros(len(run.time[::4])),
    )
    assert predict_slopes(run, volts)[:, 0] == pytest.approx(derivative[::4, 0], abs=1e-7 * size(derivative))
    run.save(tmp_path / "run.nc")
    stored = flexarm.Simulation.load(tmp_path / "run.nc").sensitivities
    assert stored is not None and np.array_equal(stored["motor_voltage"], derivative)


def test_what_has_no_derivative_in_a_loop_is_refused() -> None:
    arm, drive = planar_arm(controllers=[CASCADE]), command()
    with pytest.raises(flexarm.InvalidParameter, match="gains change by a schedule has no derivatives"):
        simulate_closed_loop(
            arm, drive, schedule={"hinge": lambda t: arm.controllers[0]}, sensitivities=["payloads.load.mass"]
        )
    with pytest.raises(flexarm.InvalidParameter, match=r"TABLE one of links, .* got 'controllers"):
        flexarm.simulate(arm, drive, sensitivities=["controllers.hinge.position_gain"])
    rounded = arm.with_effect(flexarm.effects.EncoderQuantisation(at="encoder", step=1e-4))
    with pytest.raises(flexarm.InvalidParameter, match="the law jumps with it"):
        flexarm.simulate(rounded, drive, sensitivities=["effects.encoder_quantisation.encoder.step"])
    late = arm.with_effect(flexarm.effects.TimeDelay(at="asked", delay=1e-3))
    with pytest.raises(flexarm.InvalidParameter, match="is the same one, or jumps to the next"):
        flexarm.simulate(late, record_of(drive), sensitivities=["effects.time_delay.asked.delay"])
