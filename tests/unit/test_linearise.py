"""Linear models: poles, static gains and transients are those of the nonlinear arm."""

import json
from pathlib import Path

import numpy as np
import pytest
from arms import TUBE, arm, beam, compliance, general, hinge, paper_arm, point, rigid
from numpy.typing import NDArray
from part_arms import arm_of_parts
from pytest import approx

import flexarm
from flexarm import Drive, InvalidParameter, LinearModel, linearise
from flexarm.arm.sensor import Sensor
from flexarm.cli.run import run

SECTION = general(5.82e-4, 2.37e-7)
ROTOR = {"gear_ratio": 100, "rotor_inertia": 1e-3}


def two_links(**more: object) -> flexarm.Arm:
    """Two beams, a compliant shoulder with its rotor, an elbow driven rigidly, and an axis that tilts."""
    return arm(
        name="two links",
        joints=[
            hinge("shoulder", "upper", **ROTOR),
            {**hinge("elbow", "lower", parent="upper", at="end"), "axis": [0, 0.6, 0.8]},
        ],
        links=[
            beam("upper", [0, 0, 1.5], SECTION, elements=2, damping_ratio=0.01, theory="timoshenko"),
            beam("lower", [0, 0, 1.0], SECTION, elements=2),
        ],
        payloads=[
            {"name": "load", "link": "lower", "position": [0, 0, 1], "mass": 5.0, "inertia": [0.1, 0.1, 0.1]}
        ],
        points=[point("middle", "upper", [0, 0, 0.6]), point("tip", "lower", [0, 0.1, 1.0])],
        effects=[compliance("shoulder", 2e5, 150.0)],
        **more,
    )


POSE = {"shoulder": 0.7, "elbow": 0.9}


def positive(values: NDArray[np.complex128]) -> NDArray[np.complex128]:
    return np.array([value for value in values if value.imag > 0])


# ------------------------------------------------------------------------------ poles


def test_poles_are_the_modes_of_the_held_arm() -> None:
    """-zeta omega +- i omega sqrt(1 - zeta^2), rotor and dampers included, about the loaded pose."""
    model = linearise(two_links(), POSE)
    assert model.input_names == ("shoulder.angle", "elbow.angle")
    modes = flexarm.modes(two_links(), joints=POSE, count=6)
    poles = positive(model.poles)[:6]
    assert poles.imag / (2 * np.pi) == approx(modes.damped_frequency_hz, rel=1e-8)
    assert -poles.real / np.abs(poles) == approx(modes.damping_ratio, rel=1e-6)


def test_the_upright_arm_let_go_falls_at_the_rate_of_its_pendulum() -> None:
    """A stiff bar on a free hinge: s^2 = + m g c/J upright, - m g c/J hanging."""
    mass, c, inertia = 3.0, 0.8, 0.2
    for height, sign in ((c, 1.0), (-c, -1.0)):
        model = arm(
            joints=[hinge("hinge", "bar", rotor_inertia=0.05, gear_ratio=2)],
            links=[rigid("bar", mass, [0, 0, height], [inertia, inertia, 0.01])],
            points=[point("end", "bar", [0, 0, height])],
        )
        found = linearise(model, inputs={"hinge": "torque"})
        square = mass * 9.81 * c / (inertia + mass * c**2 + 4 * 0.05)
        assert np.sort(found.poles**2) == approx(sign * square, rel=1e-9)
        assert found.input_at_rest == approx([0.0], abs=1e-9)


def test_a_soft_upright_arm_let_go_keeps_the_sign_of_its_instability() -> None:
    """A flexible rod gives way under its load and falls at nearly the rigid pendulum's rate."""
    model = linearise(paper_arm(elements=4), inputs={"hinge": "torque"})
    growing = model.poles[model.poles.real > 1e-6]
    assert len(growing) == 1
    mass = 7850 * 5.82e-4 * 3
    rigid_rate = np.sqrt((14.1 * 3 + mass * 1.5) * 9.81 / (14.1 * 9 + mass * 3))
    assert growing[0].real == approx(rigid_rate, rel=1e-2)
    assert growing[0].imag == 0


def test_an_arm_that_buckles_under_its_weight_is_refused() -> None:
    with pytest.raises(flexarm.NotConverged):
        linearise(paper_arm(spring=200.0))  # m g L is 600 N m


def test_a_massless_motor_behind_a_spring_and_damper_relaxes() -> None:
    """phi' c + k (phi - theta) = T: with the link held still by its inertia the rate is near k/c."""
    stiffness, damping = 100.0, 1000.0
    model = arm(
        gravity=[0, 0, 0],
        joints=[hinge("hinge", "bar")],
        links=[rigid("bar", 1e6, [0, 0, 0], [1e6, 1e6, 1e6])],
        effects=[compliance("hinge", stiffness, damping)],
    )
    found = linearise(model, inputs={"hinge": "torque"}, outputs=["hinge"])
    assert "relaxation_1" in found.state_names
    assert np.sort(found.poles.real)[0] == approx(-stiffness / damping, rel=1e-3)
    response = found.frequency_response(1.0)[0, 0, 0]
    assert response == approx(-1 / (1e6 * (2 * np.pi) ** 2), rel=1e-3)


def test_the_relaxation_of_a_massless_motor_is_that_of_the_nonlinear_arm() -> None:
    """The paper's arm hanging, its motor without inertia behind spring and damper, pulsed with 5 N m."""
    model, step = paper_arm(elements=2), 1e-3
    model = flexarm.Arm.from_dict(model.to_dict() | {"effects": [compliance("hinge", 1e4, 500.0)]})
    found = linearise(model, {"hinge": 2.5}, inputs={"hinge": "torque"}, outputs=["hinge"])
    t = step * np.arange(401)
    u = 5 * pulse(t)[:, None]
    sim = flexarm.Stepper(model, {"hinge": "torque"}, step=step, alpha=0.0)
    state, seen = sim.start(joints={"hinge": 2.5}), []
    for k in range(1, len(t)):
        middle = float(0.5 * (u[k, 0] + u[k - 1, 0]))
        state = sim.step(state, {"hinge": float(found.input_at_rest[0]) + middle})
        seen.append(sim.joint(state, "hinge").angle)
    y = step_response(found, u, step)[1:, 0]
    assert y + found.output_at_rest[0] == approx(np.array(seen), abs=0.01 * np.abs(y).max())


def test_a_massless_motor_behind_a_spring_follows_at_once() -> None:
    """Without rotor and damper the torque acts on the link: theta'' = T/J, phi - theta = T/k."""
    motor = Sensor(name="phi", quantity="joint_angle", joint="hinge", side="motor", rate_hz=1.0)
    model = arm(
        gravity=[0, 0, 0],
        joints=[hinge("hinge", "bar")],
        links=[rigid("bar", 1.0, [0, 0, 0], [2.0, 2.0, 2.0])],
        effects=[compliance("hinge", 100.0)],
    )
    found = linearise(model, inputs={"hinge": "torque"}, outputs=["hinge", motor])
    assert found.A.shape == (2, 2)
    response = found.frequency_response(0.5)[0, :, 0]
    theta = -1 / (2.0 * np.pi**2)
    assert response == approx([theta, theta + 1 / 100.0], rel=1e-9)
    rate = Sensor(name="phi_rate", quantity="joint_rate", joint="hinge", side="motor", rate_hz=1.0)
    with pytest.raises(InvalidParameter, match="give the rotor of the joint an inertia"):
        linearise(model, inputs={"hinge": "torque"}, outputs=[rate])


def test_an_arm_of_super_elements_has_its_modes_as_poles(tmp_path: Path) -> None:
    tables = arm_of_parts(tmp_path, segments=2)
    model = arm(**tables, effects=[compliance("hinge", 1e5, 300.0)])
    found = linearise(model, {"hinge": 0.8}, outputs=["tip"])
    modes = flexarm.modes(model, joints={"hinge": 0.8}, count=4)
    poles = positive(found.poles)[:4]
    assert poles.imag / (2 * np.pi) == approx(modes.damped_frequency_hz, rel=1e-7)
    assert -poles.real / np.abs(poles) == approx(modes.damping_ratio, rel=1e-5, abs=1e-9)
    e = 1e-4
    plus, minus = (flexarm.static(model, {"hinge": 0.8 + s * e}).position[0] for s in (1, -1))
    assert found.static_gain()[:, 0] == approx((plus - minus) / (2 * e), rel=1e-6, abs=1e-8)


def test_a_worn_drive_train_counts_by_its_tangent() -> None:
    """Teeth that touch, a stiffening spring, a gear that errs: gains and poles of the arm as it stands."""
    effects = [
        compliance("hinge", 1e5, 200.0),
        {"name": "joint_stiffening", "at": "hinge", "cubic_stiffness": 1e9},
        {"name": "backlash", "at": "hinge", "gap": 4e-4},
        {"name": "transmission_error", "at": "hinge", "amplitude": 2e-4, "multiple": 0.5, "phase": 0.4},
        {"name": "cable_torque", "at": "hinge", "stiffness": 50.0, "rest_angle": 0.1},
    ]
    table = paper_arm(elements=2).to_dict() | {"effects": effects}
    table["joints"][0]["gear_ratio"] = 120.0
    model = flexarm.Arm.from_dict(table)
    found = linearise(model, {"hinge": 0.8}, outputs=["tip"])
    assert found.input_names == ("hinge.angle",)
    e = 1e-5
    plus, minus = (flexarm.static(model, {"hinge": 0.8 + s * e}).position[0] for s in (1, -1))
    assert found.static_gain()[:, 0] == approx((plus - minus) / (2 * e), rel=1e-5, abs=1e-7)
    modes = flexarm.modes(model, joints={"hinge": 0.8}, count=4)
    poles = positive(found.poles)[:4]
    assert poles.imag / (2 * np.pi) == approx(modes.damped_frequency_hz, rel=1e-7)


def test_a_prismatic_joint_speaks_of_metres_and_newtons() -> None:
    """A mass on a spring along x: m x'' = k (u - x)."""
    slide = {"name": "slide", "type": "prismatic", "parent": "base", "child": "bar", "axis": [1, 0, 0]}
    model = arm(
        joints=[slide],
        links=[rigid("bar", 4.0, [0, 0, 0], [0.1, 0.1, 0.1])],
        points=[point("end", "bar", [0, 0, 0])],
        effects=[compliance("slide", 900.0)],
    )
    found = linearise(model, {"slide": 0.3})
    assert (found.input_units, found.output_units[0]) == (("m",), "m")
    assert np.abs(found.poles) == approx([15.0, 15.0], rel=1e-9)
    assert found.static_gain()[:2, 0] == approx([1.0, 1.0], rel=1e-9)
    assert found.output_at_rest[:2] == approx([0.3, 0.3], abs=1e-12)
    assert linearise(model, inputs={"slide": "acceleration"}).input_units == ("m/s2",)


# --------------------------------------------------------------------- static gains, C


SENSORS: list[dict[str, object]] = [
    {"name": "motor", "quantity": "joint_angle", "joint": "shoulder"},
    {"name": "link", "quantity": "joint_angle", "joint": "shoulder", "side": "output"},
    {"name": "torque", "quantity": "motor_torque", "joint": "shoulder"},
    {"name": "elbow_torque", "quantity": "motor_torque", "joint": "elbow", "side": "output"},
    {"name": "tracker", "quantity": "position", "point": "tip"},
    {"name": "turn", "quantity": "orientation", "point": "tip"},
    {"name": "level", "quantity": "inclination", "point": "tip", "axes": ["x"]},
    {"name": "gyro", "quantity": "angular_rate", "point": "tip"},
    {"name": "imu", "quantity": "acceleration", "point": "tip"},
    {"name": "gauge", "quantity": "strain", "link": "upper", "position": 0.3, "fibre": [0.01, 0.03]},
    {"name": "bend", "quantity": "deflection", "point": "middle"},
]


def sensed(model: flexarm.Arm) -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        model.to_dict() | {"sensors": [{**sensor, "rate_hz": 100} for sensor in SENSORS]}
    )


def at_rest(model: flexarm.Arm, joints: dict[str, float], push: dict[str, list[float]]) -> dict[str, object]:
    """Readings of the equilibrium, through the stepper."""
    told = dict.fromkeys(joints, "motor")
    sim = flexarm.Stepper(model, told, forces=["tip"])
    state = sim.start(joints=joints, forces=push)
    return {sensor.name: sim.sensor(state, sensor.name) for sensor in model.sensors}


def flat(readings: dict[str, object]) -> NDArray[np.float64]:
    return np.concatenate([np.atleast_1d(np.asarray(value)) for value in readings.values()])


def test_static_gains_of_every_sensor_are_the_differences_of_statics() -> None:
    """Accelerations as inputs leave no rest, so gains of angles are read off the drive's states."""
    model = sensed(two_links())
    inputs = [("shoulder", "acceleration"), ("elbow", "acceleration"), ("tip", "force")]
    found = linearise(model, POSE, inputs=inputs)
    fixed, drives = slice(None, -4), slice(-4, -2)
    own = found.A[fixed, fixed]
    by_force = found.D[:, 2:] - found.C[:, fixed] @ np.linalg.solve(own, found.B[fixed, 2:])
    by_angle = found.C[:, drives] - found.C[:, fixed] @ np.linalg.solve(own, found.A[fixed, drives])
    nothing = {"tip": [0.0, 0.0, 0.0]}
    for k, name in enumerate(POSE):
        e = 1e-4
        plus, minus = ({**POSE, name: POSE[name] + sign * e} for sign in (1, -1))
        expected = (flat(at_rest(model, plus, nothing)) - flat(at_rest(model, minus, nothing))) / (2 * e)
        assert by_angle[:, k] == approx(expected, rel=1e-5, abs=1e-6 * np.abs(expected).max()), name
    for axis in range(3):
        unit = 2.0 * np.eye(3)[axis]
        plus, minus = (flat(at_rest(model, POSE, {"tip": list(s * unit)})) for s in (1, -1))
        expected = (plus - minus) / 4.0
        assert by_force[:, axis] == approx(expected, rel=2e-5, abs=1e-9), axis
    assert found.output_at_rest == approx(flat(at_rest(model, POSE, nothing)), rel=1e-9, abs=1e-9)


def test_static_gains_of_angles_are_the_differences_of_statics_with_few_modes_too() -> None:
    model = two_links()
    for count in (None, 4, 0):
        found = linearise(
            model,
            POSE,
            inputs=[*dict.fromkeys(POSE, "angle").items(), ("tip", "force")],
            outputs=["tip"],
            modes=count,
        )
        assert len(found.A) == (len(found.A) if count is None else 2 * count)
        gain = found.D if count == 0 else found.static_gain()
        e = 1e-4
        for k, name in enumerate(POSE):
            plus, minus = (
                flexarm.static(model, {**POSE, name: POSE[name] + s * e}, {"tip": [0, 0, 0]}).position[1]
                for s in (1, -1)
            )
            assert gain[:, k] == approx((plus - minus) / (2 * e), rel=1e-6, abs=1e-7)
        plus, minus = (flexarm.static(model, POSE, {"tip": [s, 0, 0]}).position[1] for s in (1, -1))
        assert gain[:, 2] == approx((plus - minus) / 2, rel=1e-6, abs=1e-12)


# -------------------------------------------------------------------------- transients


def step_response(found: LinearModel, u: NDArray[np.float64], step: float) -> NDArray[np.float64]:
    """Exact for inputs that are linear between samples."""
    from scipy.signal import lsim

    _, y, _ = lsim(found.to_scipy(), u, step * np.arange(len(u)))
    return np.asarray(y).reshape(len(u), -1)


def pulse(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """Up and down in 0.4 s, smooth to the third derivative."""
    x = np.clip(t / 0.4, 0, 1)
    return (4 * x * (1 - x)) ** 4


def test_a_small_motion_of_the_drives_differs_to_second_order_only() -> None:
    """Half the motion, a quarter of the gap: what is left is the nonlinearity, not the linear model."""
    model, step = two_links(), 2.5e-4
    t = np.arange(0, 0.6 + step / 2, step)
    found = linearise(model, POSE, outputs=["tip", "shoulder"])
    gaps = []
    for amplitude in (0.02, 0.01):
        u = amplitude * np.column_stack([pulse(t), -0.7 * pulse(t)])
        drive = Drive.from_samples(t, {n: q + u[:, k] for k, (n, q) in enumerate(POSE.items())})
        run = flexarm.simulate(model, drive, step=step, alpha=0.0)
        y = step_response(found, u, step) + found.output_at_rest
        gaps.append(np.abs(y[:, :3] - run.position[:, 1]).max())
        assert np.abs(y[:, 3] - run.joint_angle[:, 0]).max() < 0.02 * amplitude
    assert gaps[0] / gaps[1] == approx(4.0, rel=0.1)
    assert gaps[1] < 0.01 * np.abs(y[:, :3] - found.output_at_rest[:3]).max()


def test_a_small_torque_and_force_move_the_arm_as_the_nonlinear_one() -> None:
    model, step = sensed(two_links()), 5e-4
    t = step * np.arange(801)
    found = linearise(model, POSE, inputs=[("shoulder", "torque"), ("tip", "force")])
    assert found.input_names == ("shoulder.torque", "tip.force.x", "tip.force.y", "tip.force.z")
    holding = float(found.input_at_rest[0])
    gaps = []
    for amplitude in (8.0, 4.0):
        u = np.zeros((len(t), 4))
        u[:, 0], u[:, 3] = amplitude * pulse(t), -0.5 * amplitude * pulse(t)
        sim = flexarm.Stepper(model, {"shoulder": "torque"}, forces=["tip"], step=step, alpha=0.0)
        state, seen = sim.start(joints=POSE), []
        for k in range(1, len(t)):
            middle = 0.5 * (u[k] + u[k - 1])
            state = sim.step(state, {"shoulder": holding + middle[0]}, {"tip": middle[1:]})
            if k % 40 == 0:
                seen.append(np.concatenate([sim.sensor(state, s.name) for s in model.sensors]))
        y = step_response(found, u, step)[40::40] + found.output_at_rest
        gap, size = np.abs(y - np.array(seen)).max(axis=0), np.abs(y - found.output_at_rest).max(axis=0)
        gaps.append(np.linalg.norm(gap[[name.startswith("tracker") for name in found.output_names]]))
        for sensor in model.sensors:  # channels that hardly move count beside the sensor's others
            own = [i for i, name in enumerate(found.output_names) if name.split(".")[0] == sensor.name]
            share = gap[own].max() / size[own].max()
            assert share < 0.003 + 0.005 * amplitude, sensor.name  # inputs held over steps; nonlinearity
    assert gaps[0] / gaps[1] > 3.0  # second order, but for the held inputs


def test_an_acceleration_as_input_is_the_angle_twice_integrated() -> None:
    model = two_links()
    by_angle = linearise(model, POSE, inputs={"shoulder": "angle"}, outputs=["tip"])
    by_acceleration = linearise(model, POSE, inputs={"shoulder": "acceleration"}, outputs=["tip"])
    assert by_acceleration.state_names[-2:] == ("shoulder.angle", "shoulder.rate")
    f = np.array([0.3, 2.0, 17.0, 60.0])
    twice = -((2 * np.pi * f) ** 2)[:, None, None]
    assert by_acceleration.frequency_response(f) * twice == approx(by_angle.frequency_response(f), rel=1e-7)


def test_a_rigidly_held_link_and_its_rotor_ask_for_the_motors_acceleration() -> None:
    """T = (J + r^2 J_m) phi'' of a stiff bar without gravity, by angle refused, by default chosen."""
    torque = Sensor(name="torque", quantity="motor_torque", joint="hinge", side="output", rate_hz=1.0)
    model = arm(
        gravity=[0, 0, 0],
        joints=[hinge("hinge", "bar", **ROTOR)],
        links=[rigid("bar", 3.0, [0, 0, 0.5], [0.1, 0.1, 0.1])],
        points=[point("end", "bar", [0, 0, 1])],
    )
    found = linearise(model, outputs=[torque])
    assert found.input_names == ("hinge.acceleration",)
    assert found.input_units == ("rad/s2",)
    assert found.D[0, 0] == approx(0.1 + 3 * 0.25 + 100**2 * 1e-3, rel=1e-9)
    with pytest.raises(InvalidParameter, match=r'torque would follow .* take "acceleration" as the input'):
        linearise(model, inputs={"hinge": "angle"}, outputs=[torque])
    by_angle = linearise(model, outputs=["end"])
    assert by_angle.D[:, 0] == approx([1.0, 0.0, 0.0], abs=1e-9)


def test_a_gear_turns_its_output_by_the_ratio() -> None:
    model = arm(
        joints=[hinge("motor", "rotor"), hinge("hinge", "bar")],
        links=[
            rigid("rotor", 0.5, inertia=[1e-3, 1e-3, 1e-3]),
            rigid("bar", 3.0, [0, 0, -0.5], [0.1, 0.1, 0.1]),
        ],
        gears=[{"name": "reducer", "input": "motor", "output": "hinge", "ratio": 50}],
        points=[point("end", "bar", [0, 0, -1])],
        effects=[compliance("hinge", 1e4)],
    )
    found = linearise(model, outputs=["hinge"])
    assert found.input_names == ("motor.angle",)
    weight = 3 * 9.81 * 0.5  # pulls the link back towards hanging
    assert found.static_gain()[0, 0] == approx(1e4 / (1e4 + weight) / 50, rel=1e-9)
    by_output = linearise(model, inputs={"hinge": "angle"}, outputs=["hinge"])
    assert by_output.static_gain()[0, 0] == approx(1e4 / (1e4 + weight), rel=1e-9)
    let_go = linearise(model, inputs={"hinge": "torque"}, outputs=["hinge", "motor"])
    reflected = 50**2 * 1e-3
    inertia = reflected + 0.1 + 3 * 0.25
    assert np.abs(let_go.poles).min() == approx(np.sqrt(weight / inertia), rel=1e-3)
    assert let_go.static_gain()[:, 0] * weight == approx([1.0, 50 * (1 + weight / 1e4)], rel=1e-9)


def test_few_modes_keep_the_low_frequencies() -> None:
    model = two_links()
    inputs = [("shoulder", "torque"), ("tip", "force")]
    whole = linearise(model, POSE, inputs=inputs, outputs=["tip"])
    small = linearise(model, POSE, inputs=inputs, outputs=["tip"], modes=6)
    assert len(small.A) == 12
    f = np.array([0.1, 1.0, 5.0])
    expected = whole.frequency_response(f)
    assert small.frequency_response(f) == approx(expected, abs=1e-4 * np.abs(expected).max())


# ------------------------------------------------------------------------------- files


@pytest.mark.parametrize("name", ["arm.mat", "arm.nc"])
def test_a_file_gives_the_model_back(name: str, tmp_path: Path) -> None:
    found = linearise(two_links(), POSE, inputs=[("shoulder", "torque"), ("tip", "force")])
    found.save(tmp_path / name)
    read = LinearModel.load(tmp_path / name)
    for matrix in ("A", "B", "C", "D", "input_at_rest", "output_at_rest", "joint_values"):
        assert np.array_equal(getattr(read, matrix), getattr(found, matrix)), matrix
    for texts in ("input_names", "output_units", "state_names", "input_units", "state_units"):
        assert getattr(read, texts) == getattr(found, texts)
    assert read.arm == found.arm
    assert "8 states" in repr(found) or f"{len(found.A)} states" in repr(found)


def test_names_of_parts_become_names_that_matlab_takes(tmp_path: Path) -> None:
    from scipy.io import whosmat

    tables = arm_of_parts(tmp_path, segments=1)
    tables["links"][0]["name"] = "2-hub"
    tables["joints"][0]["child"], end = "2-hub:start", "2-hub:end"
    tables["payloads"][0]["link"] = tables["points"][0]["link"] = end
    found = linearise(arm(**tables))
    found.save(tmp_path / "arm.mat")
    names = [name for name, _, _ in whosmat(tmp_path / "arm.mat")]
    assert "x2_hub_sha256" in names
    assert all(name.isidentifier() for name in names)
    assert LinearModel.load(tmp_path / "arm.mat").arm.links[0].name == "2-hub"


def test_a_mat_file_holds_what_matlab_and_python_control_take(tmp_path: Path) -> None:
    import control
    from scipy.io import loadmat

    found = linearise(two_links(), POSE, outputs=["tip"])
    found.save(tmp_path / "arm.mat")
    m = loadmat(tmp_path / "arm.mat")
    n = len(found.A)
    assert (m["A"].shape, m["B"].shape, m["C"].shape, m["D"].shape) == ((n, n), (n, 2), (3, n), (3, 2))
    assert [str(cell[0]) for cell in m["input"][:, 0]] == ["shoulder.angle", "elbow.angle"]
    assert [str(cell[0]) for cell in m["output"][:, 0]] == ["tip.x", "tip.y", "tip.z"]
    assert m["joint_values"][:, 0] == approx([0.7, 0.9])
    system = control.ss(m["A"], m["B"], m["C"], m["D"])
    assert system.dcgain() == approx(found.static_gain(), rel=1e-6)


def test_python_control_takes_a_model_with_the_names_of_its_signals() -> None:
    found = linearise(two_links(), POSE, outputs=["tip"])
    system = found.to_control()
    assert system.input_labels == ["shoulder_angle", "elbow_angle"]
    assert system.output_labels == ["tip_x", "tip_y", "tip_z"]
    assert len(set(system.state_labels)) == len(found.A)
    assert system.dcgain() == approx(found.static_gain(), rel=1e-6)


def test_a_plot_names_its_units(tmp_path: Path) -> None:
    found = linearise(two_links(), POSE, outputs=["tip", "shoulder"])
    axes = found.plot(input="elbow.angle")
    assert axes.get_ylabel() == "output over elbow.angle\n[m/rad]"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["tip.x", "tip.y", "tip.z"]
    with pytest.raises(InvalidParameter, match="there is no output 'nose'"):
        found.plot(output="nose")


def test_a_plot_shows_the_phase_below_the_magnitude() -> None:
    """A driven angle moves the tip in phase far below resonance, and against it above."""
    rod = arm(
        joints=[hinge("hinge", "rod")],
        links=[beam("rod", [0, 0, 2.0], TUBE)],
        points=[point("tip", "rod", [0, 0, 2.0])],
    )
    _, phase = linearise(rod, {"hinge": 0.0}, outputs=["tip"]).plot(output="tip.x").figure.axes
    assert phase.get_xlabel() == "frequency [Hz]" and phase.get_ylabel() == "phase [deg]"
    degrees = phase.lines[0].get_ydata()
    assert degrees[0] == approx(0.0, abs=1.0)
    assert np.abs(degrees).max() > 170


def test_a_plot_leaves_out_what_does_not_answer() -> None:
    """The rigid joint's own angle is 1 at all frequencies; along y nothing moves but by rounding."""
    rod = arm(
        joints=[hinge("hinge", "rod")],
        links=[beam("rod", [0, 0, 2.0], TUBE)],
        points=[point("tip", "rod", [0, 0, 2.0])],
    )
    axes = linearise(rod, {"hinge": 0.5}, outputs=["hinge", "tip"]).plot()
    assert axes.get_ylabel() == "output over hinge.angle\n[m/rad]"
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["tip.x", "tip.z"]


# ---------------------------------------------------------------------------- mistakes


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"joints": {"wrist": 1.0}}, "no moving joint 'wrist'"),
        ({"inputs": {"wrist": "torque"}}, "no moving joint 'wrist'; there are shoulder, elbow"),
        ({"inputs": {"nose": "force"}}, "no point 'nose'; there are middle, tip"),
        ({"inputs": {"elbow": "push"}}, "must be one of angle, acceleration, torque, free, locked, got"),
        ({"inputs": {"tip": "torque"}}, r"inputs\.tip: must be one of force, got 'torque'"),
        ({"inputs": [("elbow", "angle"), ("elbow", "torque")]}, r"inputs\.elbow: is given twice"),
        ({"inputs": [("tip", "force"), ("tip", "force")]}, r"inputs\.tip: is given twice"),
        ({"outputs": ["nose"]}, "no sensor, point or moving joint 'nose'"),
        ({"modes": -1}, "modes: must not be negative, got -1"),
    ],
)
def test_names_that_do_not_exist_are_told(options: dict[str, object], message: str) -> None:
    with pytest.raises(InvalidParameter, match=message):
        linearise(two_links(), **options)  # type: ignore[arg-type]


def bar(**more: object) -> flexarm.Arm:
    """A rigid bar without weight on a hinge."""
    return arm(
        gravity=[0, 0, 0],
        joints=[hinge("hinge", "bar")],
        links=[rigid("bar", 3.0, [0, 0, 0.5], [0.1, 0.1, 0.1])],
        points=[point("end", "bar", [0, 0, 1])],
        **more,
    )


def test_a_weightless_bar_let_go_is_a_double_integrator() -> None:
    found = linearise(bar(), inputs={"hinge": "torque"}, outputs=["hinge"])
    assert found.poles == approx([0, 0], abs=1e-9)
    response = found.frequency_response(1.0)[0, 0, 0]
    assert response == approx(-1 / ((0.1 + 3 * 0.25) * (2 * np.pi) ** 2), rel=1e-9)
    with pytest.raises(InvalidParameter, match="pole at zero"):
        found.static_gain()
    with pytest.raises(InvalidParameter, match="modes: leave out 1 motions without stiffness"):
        linearise(bar(), inputs={"hinge": "torque"}, modes=0)


def test_an_arm_in_which_nothing_moves_or_too_much_is_refused() -> None:
    for inputs in ({}, {"hinge": "locked"}, {"hinge": "locked", "end": "force"}):
        with pytest.raises(InvalidParameter, match="inputs: move nothing"):
            linearise(bar(), inputs=inputs)
    with pytest.raises(InvalidParameter, match=r"links: the arm has \d+ unknowns; .* take fewer elements"):
        linearise(paper_arm(elements=600))
    shafts = arm(
        joints=[hinge("motor", "rotor"), hinge("hinge", "bar")],
        links=[rigid("rotor", 0.5, inertia=[1e-3] * 3), rigid("bar", 3.0, [0, 0, -0.5], [0.1] * 3)],
        gears=[{"name": "reducer", "input": "motor", "output": "hinge", "ratio": 50}],
    )
    with pytest.raises(InvalidParameter, match="two inputs drive the same motor through gears"):
        linearise(shafts, inputs=[("motor", "angle"), ("hinge", "angle")])


def test_a_model_without_inputs_is_stored_too(tmp_path: Path) -> None:
    found = linearise(two_links(), POSE, inputs={"shoulder": "free"}, outputs=["tip"])
    for name in ("arm.mat", "arm.nc"):
        found.save(tmp_path / name)
        read = LinearModel.load(tmp_path / name)
        assert (read.B.shape, read.D.shape) == ((len(found.A), 0), (3, 0))
        assert np.array_equal(read.A, found.A)


def test_files_that_hold_no_linear_model_are_refused(tmp_path: Path) -> None:
    from scipy.io import savemat

    (tmp_path / "text.mat").write_text("no")
    savemat(tmp_path / "other.mat", {"A": np.eye(2)})
    for name in ("missing.mat", "text.mat", "other.mat", "missing.nc"):
        with pytest.raises(flexarm.InvalidFile, match=name):
            LinearModel.load(tmp_path / name)


# -------------------------------------------------------------------------- command line


def test_the_command_writes_what_the_function_gives(
    model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "arm.mat"
    command = ["linearise", str(model_file), "--joint", "hinge=0.4", "--out", str(out)]
    assert run([*command, "--input", "hinge=torque", "--output", "tip"]) == 0
    assert f"written to {out}" in capsys.readouterr().out
    expected = linearise(
        flexarm.Arm.from_toml(model_file), {"hinge": 0.4}, inputs={"hinge": "torque"}, outputs=["tip"]
    )
    assert np.array_equal(LinearModel.load(out).A, expected.A)
    assert run(command) == 2
    assert "exists already; allowed is a new file, or --force" in capsys.readouterr().err
    assert run([*command, "--force", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["file"] == str(out)
    assert told["inputs"][0]["unit"] in ("rad", "rad/s2")
    assert len(told["poles"]) == len(told["states"])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--out", "arm.txt"], "error: command line: --out: must end in .mat or .nc, got arm.txt"),
        (["--out", "no/arm.mat"], "error: no/arm.mat: output: cannot be written: there is no directory no"),
        (["--out", "arm.mat", "--input", "hinge"], "--input: must be NAME=KIND such as hinge=torque"),
        (["--out", "arm.mat", "--input", "hinge=push"], "inputs.hinge: must be one of angle, acceleration"),
        (["--out", "arm.mat", "--input", "nose=torque"], "inputs: there is no moving joint 'nose'"),
        (["--out", "arm.mat", "--output", "nose"], "outputs: there is no sensor, point or moving joint"),
        (["--out", "arm.mat", "--joint", "nose=1"], "there is no moving joint 'nose'"),
    ],
)
def test_mistakes_on_the_command_line_end_as_exit_code_2(
    model_file: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    options: list[str],
    message: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["linearise", str(model_file), *options]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.glob("*.mat"))


def test_an_arm_that_buckles_ends_as_exit_code_3(
    model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    soft = '\n[[effects]]\nname = "joint_compliance"\nat = "hinge"\nstiffness = 100.0\n'
    model_file.write_text(model_file.read_text() + soft)
    assert run(["linearise", str(model_file), "--out", str(tmp_path / "arm.mat")]) == 3
    assert "buckles" in capsys.readouterr().err


def test_the_summary_has_no_damping_of_minus_zero() -> None:
    """Rounding makes the real parts of undamped poles positive as often as negative."""
    model = linearise(arm(joints=[hinge("j", "b")], links=[beam("b", [1.0, 0, 0], SECTION, elements=4)]))
    assert model.poles.real.max() > 0
    assert "-0.000000" not in model.summary()
