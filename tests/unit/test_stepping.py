"""Stepping from Python: states are values, inputs mean what they say, mistakes are told."""

import copy
import pickle
from pathlib import Path

import numpy as np
import pytest
from arms import arm, beam, compliance, general, hinge, paper_arm, point, rigid, swing_angle
from arms import drive as drive_along
from numpy.typing import NDArray
from part_arms import arm_of_parts
from pytest import approx

import flexarm
from flexarm import InvalidFile, InvalidParameter, NotConverged, State, Stepper

SECTION = general(5.82e-4, 2.37e-7)


def two_links(**more: object) -> flexarm.Arm:
    """Two beams, an elbow that changes the solver's matrix, friction that remembers."""
    return arm(
        name="two links",
        joints=[
            hinge("shoulder", "upper", gear_ratio=100, rotor_inertia=1e-3),
            hinge("elbow", "lower", parent="upper", at="end"),
        ],
        links=[
            beam("upper", [0, 0, 1.5], SECTION, elements=2, damping_ratio=0.01),
            beam("lower", [0, 0, 1.0], SECTION, elements=2),
        ],
        payloads=[{"name": "load", "link": "lower", "position": [0, 0, 1], "mass": 5.0}],
        points=[point("elbow", "upper", [0, 0, 1.5]), point("tip", "lower", [0, 0, 1.0])],
        effects=[
            compliance("shoulder", 2e5, 50.0),
            {"name": "coulomb_friction", "at": "elbow", "torque": 3.0},
        ],
        **more,
    )


def inputs(k: int) -> dict[str, float]:
    t = 2e-3 * k
    return {"shoulder": 60 + 20 * np.sin(5 * t), "elbow": 0.4 + 1.5 * t**2}


def go(sim: Stepper, state: State, begin: int, end: int) -> State:
    for k in range(begin, end):
        state = sim.step(state, inputs(k + 1))
    return state


@pytest.fixture
def sim() -> Stepper:
    return Stepper(two_links(), {"shoulder": "torque", "elbow": "motor"}, step=2e-3)


@pytest.fixture
def start(sim: Stepper) -> State:
    return sim.start(joints={"shoulder": 0.5, "elbow": 0.4})


# ---------------------------------------------------------------------------- states


def test_a_state_from_a_file_goes_on_to_the_same_bits(sim: Stepper, start: State, tmp_path: Path) -> None:
    half = go(sim, start, 0, 150)
    end = go(sim, half, 150, 300)
    half.save(tmp_path / "half.state")
    other = Stepper(two_links(), {"shoulder": "torque", "elbow": "motor"}, step=2e-3)
    assert go(other, State.load(tmp_path / "half.state"), 150, 300) == end
    assert go(other, pickle.loads(pickle.dumps(half)), 150, 300) == end
    assert go(sim, copy.deepcopy(half), 150, 300) == end  # after the same stepper had gone further
    assert end != half
    assert end.time == approx(0.6)
    assert hash(go(sim, half, 150, 300)) == hash(end)


def test_a_step_leaves_the_state_it_starts_from(sim: Stepper, start: State) -> None:
    before = pickle.dumps(start)
    sim.step(start, inputs(1))
    assert pickle.dumps(start) == before
    with pytest.raises(ValueError, match="read-only"):
        start.stored.state["scalars"][0] = 1.0
    with pytest.raises(AttributeError):
        start.time = 3.0  # type: ignore[misc]


def test_states_of_other_arms_and_broken_files_are_refused(
    sim: Stepper, start: State, tmp_path: Path
) -> None:
    other = two_links(gravity=[0, 0, -1.6])
    with pytest.raises(InvalidParameter, match="belongs to another arm"):
        Stepper(other, {"shoulder": "torque", "elbow": "motor"}).joint(start, "elbow")
    with pytest.raises(InvalidParameter, match="belongs to another arm"):
        Stepper(two_links(), {"shoulder": "motor"}).step(start, {"shoulder": 0.5})
    path = tmp_path / "state.npz"
    with pytest.raises(InvalidFile, match=r"state\.npz: file: there is no such file"):
        State.load(path)
    path.write_bytes(b"no zip")
    with pytest.raises(InvalidFile, match="cannot be read as a stored state"):
        State.load(path)
    np.savez(path, a=1)
    with pytest.raises(InvalidFile, match="is no stored state"):
        State.load(path)
    start.save(path)
    with np.load(path) as file:
        flat = dict(file)
    np.savez(path, **{**flat, "state.frames": np.zeros((2, 12))})
    with pytest.raises(InvalidParameter, match=r"array 'frames' .* must be \d+ x 12, got 2 x 12"):
        sim.step(State.load(path), inputs(1))
    with pytest.raises(InvalidFile, match="output: cannot be written"):
        start.save(tmp_path / "no" / "state.npz")


# ---------------------------------------------------------------------------- motion


def test_angles_given_at_steps_move_the_tip_as_their_smooth_curve_does() -> None:
    """Rates are of order two: at 2 ms the paper's swing differs by far less than its tracker sees."""
    model = paper_arm(elements=2, spring=1e5)
    for alpha in (-0.05, 0.0):  # the angle does not ring even where nothing else is damped
        run = flexarm.simulate(model, drive_along({"hinge": swing_angle}, 6.0), step=2e-3, alpha=alpha)
        sim = Stepper(model, {"hinge": "motor"}, step=2e-3, alpha=alpha)
        state, tip, torque = sim.start(), [], []
        for t in run.time[1:]:
            state = sim.step(state, {"hinge": float(swing_angle(t))})
            tip.append(sim.point(state, "tip").position)
            torque.append(sim.joint(state, "hinge").motor_torque)
        assert np.abs(np.array(tip) - run.position[1:, 0]).max() < 1e-6
        assert np.abs(np.array(torque) - run.motor_torque[1:, 0]).max() < 0.05  # of 500 N m


def test_angles_with_their_rates_are_the_run_itself() -> None:
    model = paper_arm(elements=2, spring=1e5)
    omega = 3.0

    def angle(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return 0.1 * (omega * t - np.sin(omega * t))

    run = flexarm.simulate(model, drive_along({"hinge": angle}, 1.0), step=2e-3)
    sim = Stepper(model, {"hinge": "motor"}, step=2e-3)
    state = sim.start()
    for t in run.time[1:]:
        rates = 0.1 * omega * (1 - np.cos(omega * t)), 0.1 * omega**2 * np.sin(omega * t)
        state = sim.step(state, {"hinge": (float(angle(t)), *rates)})
    assert sim.point(state, "tip").position == approx(run.position[-1, 0], abs=1e-9)


def test_a_held_torque_is_the_one_that_simulate_holds() -> None:
    model = two_links()
    torque = flexarm.Drive.from_samples([0, 1], {"shoulder": [55.0, 55.0]}, side="torque")
    torque = flexarm.Drive(torque.joints, rest={"shoulder": 0.5, "elbow": 0.4}, start=0.0, end=0.4)
    run = flexarm.simulate(model, torque, step=2e-3)
    sim = Stepper(model, {"shoulder": "torque"}, step=2e-3)
    state = sim.start(joints={"shoulder": 0.5, "elbow": 0.4})
    for _ in range(200):
        state = sim.step(state, {"shoulder": 55.0})
    read = sim.joint(state, "shoulder")
    assert read.motor_torque == approx(55.0)
    assert read.drive_angle == approx(run.drive_angle[-1, 0], abs=1e-9)
    assert read.angle == approx(run.joint_angle[-1, 0], abs=1e-9)
    assert read.rate == approx(run.joint_rate[-1, 0], abs=1e-7)
    assert sim.point(state, "tip").velocity == approx(run.velocity[-1, 1], abs=1e-7)


def test_the_torque_of_the_start_keeps_the_arm_at_rest(sim: Stepper, start: State) -> None:
    holding = sim.joint(start, "shoulder").motor_torque
    assert abs(holding) > 20
    state = start
    for _ in range(50):
        state = sim.step(state, {"shoulder": holding, "elbow": 0.4})
    assert sim.point(state, "tip").position == approx(sim.point(start, "tip").position, abs=1e-9)


def test_a_free_pendulum_swings_at_its_own_frequency() -> None:
    """omega^2 = m g c/(J + m c^2) for a small swing of a rigid bar."""
    mass, c, inertia = 3.0, 0.8, 0.2
    model = arm(
        joints=[hinge("hinge", "bar")],
        links=[rigid("bar", mass, [0, 0, -c], [inertia, inertia, 0.01])],
        points=[point("end", "bar", [0, 0, -1])],
    )
    sim = Stepper(model, {"hinge": "free"}, step=1e-3, alpha=0.0)
    state = sim.start(joints={"hinge": 0.01})
    omega = np.sqrt(mass * 9.81 * c / (inertia + mass * c**2))
    while state.time < np.pi / omega - 5e-4:
        state = sim.step(state, {})
    read = sim.joint(state, "hinge")
    assert read.angle == approx(-0.01, rel=1e-4)
    assert abs(read.rate) < 1e-3 * 0.01 * omega + 0.01 * omega**2 * 5e-4


def test_a_gear_passes_the_angle_told_at_its_output_to_its_input() -> None:
    model = arm(
        joints=[
            hinge("motor", "rotor"),
            hinge("hinge", "bar"),
        ],
        links=[
            rigid("rotor", 0.5, inertia=[1e-3, 1e-3, 1e-3]),
            rigid("bar", 3.0, [0, 0, 0.5], [0.1, 0.1, 0.1]),
        ],
        gears=[{"name": "reducer", "input": "motor", "output": "hinge", "ratio": 50}],
    )
    sim = Stepper(model, {"hinge": "motor"}, step=1e-2)
    state = sim.start(joints={"hinge": 0.1})
    for k in range(1, 101):
        state = sim.step(state, {"hinge": 0.1 + 1e-5 * k**2})
    assert sim.joint(state, "hinge").angle == approx(0.2, abs=1e-9)
    assert sim.joint(state, "motor").angle == approx(50 * 0.2, abs=1e-7)
    assert sim.joint(state, "hinge").rate == approx(2e-5 * 100 / 1e-2, rel=1e-6)


def test_a_link_told_its_own_angle_does_not_feel_its_reducer() -> None:
    stiff, soft = (paper_arm(elements=2, spring=k) for k in (1e7, 1e4))
    tips = []
    for model in (stiff, soft):
        sim = Stepper(model, {"hinge": "output"}, step=5e-3)
        state = sim.start(joints={"hinge": 0.3})
        for k in range(1, 101):
            state = sim.step(state, {"hinge": 0.3 + 1e-5 * k**2})
        tips.append(sim.point(state, "tip").position)
    assert tips[0] == approx(tips[1], abs=1e-9)


def test_a_force_at_the_tip_bends_the_arm_as_statics_says() -> None:
    model = paper_arm(elements=2, damping_ratio=0.3)
    push = {"tip": [40.0, 10.0, 0.0]}
    sim = Stepper(model, {"hinge": "motor"}, forces=["tip"], step=1e-2, alpha=-0.3)
    state = sim.start()
    for _ in range(600):
        state = sim.step(state, {"hinge": 0.0}, push)
    wanted = flexarm.static(model, forces=push).position[0]
    assert sim.point(state, "tip").position == approx(wanted, abs=1e-6)
    assert sim.point(sim.start(forces=push), "tip").position == approx(wanted, abs=1e-10)


def test_a_shaken_base_and_a_growing_bow_step_as_they_run() -> None:
    """What depends on time itself goes on from state to state."""
    table = paper_arm(elements=2).to_dict()
    effects = [
        {"name": "base_compliance", "at": "base", "stiffness": 1e6, "damping": 1e3},
        {"name": "external_vibration", "at": "base", "amplitude": 50.0, "frequency": 4.0, "phase": 0.3},
        {"name": "link_bow", "at": "rod", "tip_offset": [0.01, 0.0, 0.0], "time_constant": 0.2},
    ]
    model = flexarm.Arm.from_dict(table | {"effects": effects})
    still = flexarm.Drive.from_samples([0, 1], {"hinge": [0.2, 0.2]})
    run = flexarm.simulate(model, still, step=2e-3, end=0.5)
    sim = Stepper(model, {"hinge": "motor"}, step=2e-3)
    state = sim.start(joints={"hinge": 0.2})
    for _ in range(250):
        state = sim.step(state, {"hinge": 0.2})
    assert np.abs(np.ptp(run.position[:, 0], axis=0)).max() > 5e-3
    assert sim.point(state, "tip").position == approx(run.position[-1, 0], abs=1e-9)


WORN = [
    compliance("hinge", 1e5, 200.0),
    {"name": "backlash", "at": "hinge", "gap": 4e-4},
    {"name": "joint_hysteresis", "at": "hinge", "torque": 20.0, "width": 1e-4},
    {"name": "transmission_error", "at": "hinge", "amplitude": 2e-4, "multiple": 0.5, "phase": 0.4},
]


@pytest.mark.parametrize("side", ["motor", "output"])
def test_a_worn_drive_train_steps_as_it_runs_and_from_a_file_too(side: str, tmp_path: Path) -> None:
    """Over the vertical the link falls through the backlash; its own angle goes back to the motor."""
    table = paper_arm(elements=2).to_dict() | {"effects": WORN}
    table["joints"][0]["gear_ratio"] = 120.0
    model = flexarm.Arm.from_dict(table)

    def angle(t: NDArray[np.float64]) -> NDArray[np.float64]:
        return 0.05 * np.cos(np.pi * t) ** 3

    run = flexarm.simulate(model, drive_along({"hinge": angle}, 1.0, side=side), step=2e-3)
    sim = Stepper(model, {"hinge": side}, step=2e-3)
    state = sim.start(joints={"hinge": 0.05})
    for k, t in enumerate(run.time[1:]):
        if k == 250:
            state.save(tmp_path / "half.npz")
        state = sim.step(state, {"hinge": float(angle(t))})
    assert sim.point(state, "tip").position == approx(run.position[-1, 0], abs=5e-6)
    again = State.load(tmp_path / "half.npz")
    for t in run.time[251:]:
        again = sim.step(again, {"hinge": float(angle(t))})
    assert again == state


def test_an_arm_of_super_elements_let_go_rests_under_its_holding_torque(tmp_path: Path) -> None:
    model = arm(**arm_of_parts(tmp_path, segments=2), effects=[compliance("hinge", 1e5)])
    sim = Stepper(model, {"hinge": "torque"}, step=2e-3)
    state = sim.start(joints={"hinge": 0.6})
    tip, holding = sim.point(state, "tip").position, sim.joint(state, "hinge").motor_torque
    for _ in range(20):
        state = sim.step(state, {"hinge": holding})
    assert sim.point(state, "tip").position == approx(tip, abs=1e-8)
    assert abs(holding) > 100


# ---------------------------------------------------------------------------- readings

SENSORS = [
    {"name": "encoder", "quantity": "joint_angle", "joint": "hinge"},
    {"name": "angle", "quantity": "joint_angle", "joint": "hinge", "side": "output"},
    {"name": "torque", "quantity": "motor_torque", "joint": "hinge"},
    {"name": "tracker", "quantity": "position", "point": "tip", "axes": ["x", "z"], "noise_std": 1e-3},
    {"name": "gyro", "quantity": "angular_rate", "point": "tip"},
    {"name": "imu", "quantity": "acceleration", "point": "tip"},
    {"name": "level", "quantity": "inclination", "point": "tip", "axes": ["z"]},
    {"name": "gauge", "quantity": "strain", "link": "rod", "position": 0.3, "fibre": [0.0, 0.03]},
    {"name": "bend", "quantity": "deflection", "point": "tip", "axes": ["x"]},
]


def test_sensors_read_a_state_as_they_read_a_run() -> None:
    """Accelerations of a run come from a spline through its velocities, those of a state are its own."""
    model = paper_arm(elements=2, spring=1e5)
    table = model.to_dict() | {"sensors": [{**sensor, "rate_hz": 100} for sensor in SENSORS]}
    model = flexarm.Arm.from_dict(table)
    run = flexarm.simulate(
        model, drive_along({"hinge": swing_angle}, 2.0), step=1e-3, end=1.2, rotations=True, forces=True
    )
    sim = Stepper(model, {"hinge": "motor"}, step=1e-3)
    state = sim.start()
    for t in run.time[1:1001]:
        state = sim.step(state, {"hinge": float(swing_angle(t))})
    from flexarm.measurement.predict import read

    for sensor in model.sensors:
        expected = read(run, sensor, np.array([1.0]))[0]
        found = sim.sensor(state, sensor.name)
        size = max(1e-6, float(np.abs(expected).max()))
        assert found == approx(expected, abs=2e-5 * size), sensor.name
    at_rest = sim.sensor(sim.start(joints={"hinge": 0.0}), "imu")
    assert at_rest == approx([0, 0, 9.81], abs=1e-9)


def test_the_acceleration_of_a_point_is_read_beside_its_velocity() -> None:
    model = paper_arm(elements=2)
    sim = Stepper(model, {"hinge": "motor"}, step=1e-3, alpha=-0.3)
    state = sim.start()
    for k in range(1, 201):
        state = sim.step(state, {"hinge": 0.5 * (1e-3 * k) ** 2 * (1e-3 * k)})
    before, now = sim.point(state, "tip"), sim.step(state, {"hinge": 0.5 * 0.201**3})
    rate = (sim.point(now, "tip").velocity - before.velocity) / 1e-3
    mean = (sim.point(now, "tip").acceleration + before.acceleration) / 2
    assert mean == approx(rate, abs=5e-3)
    assert before.rotation @ before.rotation.T == approx(np.eye(3), abs=1e-12)
    turn = before.rotation.T @ sim.point(now, "tip").rotation  # 1 + h times the mean rate's matrix
    mean_rate = (sim.point(now, "tip").angular_rate + before.angular_rate)[1] / 2
    assert turn[0, 2] / 1e-3 == approx(mean_rate, rel=1e-3)


# ---------------------------------------------------------------------------- mistakes


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"shoulder": 1.0}, "missing or unknown: elbow"),
        ({"shoulder": 1.0, "elbow": 0.4, "wrist": 1.0}, "missing or unknown: wrist"),
        ({"shoulder": float("nan"), "elbow": 0.4}, r"inputs\.shoulder: must be a finite number \[N m"),
        ({"shoulder": (1.0, 0.0, 0.0), "elbow": 0.4}, r"inputs\.shoulder: must be a finite number \[N m"),
        ({"shoulder": 1.0, "elbow": (0.4, 0.0)}, r"or \(angle, rate, acceleration\), got \(0\.4, 0\.0\)"),
        ({"shoulder": 1.0, "elbow": "far"}, r"inputs\.elbow: .* got 'far'"),
    ],
)
def test_inputs_that_no_step_can_be_made_of_are_told(
    sim: Stepper, start: State, given: dict[str, object], message: str
) -> None:
    with pytest.raises(InvalidParameter, match=message):
        sim.step(start, given)  # type: ignore[arg-type]


def test_names_and_numbers_that_do_not_fit_the_arm_are_told(sim: Stepper, start: State) -> None:
    model = two_links()
    with pytest.raises(
        InvalidParameter, match="inputs: there is no moving joint 'wrist'; there are shoulder, elbow"
    ):
        Stepper(model, {"wrist": "torque"})
    with pytest.raises(InvalidParameter, match="must be one of motor, output, torque, free, got 'push'"):
        Stepper(model, {"elbow": "push"})
    with pytest.raises(InvalidParameter, match="no point 'nose'; there are elbow, tip"):
        Stepper(model, {}, forces=["nose"])
    with pytest.raises(InvalidParameter, match="alpha"):
        Stepper(model, {}, alpha=0.2)
    with pytest.raises(InvalidParameter, match="step must be positive"):
        Stepper(model, {}, step=0.0)
    with pytest.raises(InvalidParameter, match="no force may act on 'tip'; name it in `forces`"):
        sim.step(start, inputs(1), {"tip": [1, 0, 0]})
    for read in (sim.joint, sim.point, sim.sensor):
        with pytest.raises(InvalidParameter, match=r"there is no .* 'wrist'"):
            read(start, "wrist")


def test_a_step_that_has_no_solution_says_when(sim: Stepper, start: State) -> None:
    with pytest.raises(NotConverged) as caught:
        sim.step(start, {"shoulder": 1e16, "elbow": 0.4})
    assert caught.value.time is not None
    assert sim.step(start, inputs(1)) == sim.step(start, inputs(1))


def test_the_former_name_of_inputs_is_taken_with_a_warning() -> None:
    with pytest.warns(DeprecationWarning, match="Stepper.told is now Stepper.inputs"):
        former = Stepper(paper_arm(), told={"hinge": "motor"})
    assert repr(former) == repr(Stepper(paper_arm(), {"hinge": "motor"}))


def test_a_loop_that_diverges_is_told_with_the_torque_that_it_asked_for():
    """Damping of 300 N m s/rad, sampled each millisecond, on a joint without a rotor."""
    links = [beam("rod", [0, 0, 1.0], SECTION)]
    light = arm(joints=[hinge("hinge", "rod")], links=links)
    sim = flexarm.Stepper(light, {"hinge": "torque"}, step=1e-3)
    state, torque = sim.start(), 1.0
    with pytest.raises(NotConverged, match=r"; the inputs were hinge = -?\d\S* N m$") as caught:
        for _ in range(10000):
            state = sim.step(state, {"hinge": torque})
            torque = -300.0 * sim.joint(state, "hinge").drive_rate
    assert caught.value.time is not None
