"""Claims about sensors, on a rigid arm whose motion is known in closed form."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from arms import LENGTH, G, arm, beam, hinge, point, rigid

from flexarm import Arm, Drive, simulate
from flexarm.arm.sensor import Sensor
from flexarm.errors import InvalidParameter
from flexarm.measurement import CannotMeasure, ClockError, Registration, measure, predict
from flexarm.measurement.sampling import EARLY, sample
from flexarm.record import Clock, Frame

HEIGHT, RATIO = 0.4, 120.0

BAR = {"shape": "rectangle", "width": 0.04, "height": 0.06}
ARM = arm(
    joints=[hinge("hinge", "rod", origin={"xyz": [0, 0, HEIGHT]}, gear_ratio=RATIO)],
    links=[beam("rod", [0, 0, LENGTH], BAR, theory="timoshenko", up=[1, 0, 0])],
    points=[point("tip", "rod", [0, 0, LENGTH])],
)


def angle(t):
    return 0.8 * np.sin(1.3 * t)


def rate(t):
    return 0.8 * 1.3 * np.cos(1.3 * t)


def tip(t):
    return np.stack([LENGTH * np.sin(angle(t)), 0 * t, HEIGHT + LENGTH * np.cos(angle(t))], axis=-1)


def motion(duration=10.0, step=0.002, wind_up=2e-3):
    """The rigid arm's motion; the motor is `wind_up` ahead of the link."""
    t = np.arange(0, duration + step / 2, step)
    q, v, a = angle(t), rate(t), -(1.3**2) * angle(t)
    down = np.stack([np.sin(q), 0 * t, np.cos(q)], axis=-1)
    ahead = np.stack([np.cos(q), 0 * t, -np.sin(q)], axis=-1)
    specific = np.stack([LENGTH * a - G * np.sin(q), 0 * t, G * np.cos(q) - LENGTH * v**2], axis=-1)
    half = np.stack([0 * t, np.sin(q / 2), 0 * t, np.cos(q / 2)], axis=-1)
    return SimpleNamespace(
        arm=ARM,
        points=("tip",),
        joints=("hinge",),
        time=t,
        position=(LENGTH * down + [0, 0, HEIGHT])[:, None],
        velocity=(LENGTH * v[:, None] * ahead)[:, None],
        orientation=np.where(t[:, None] > 5, -half, half)[:, None],  # q and -q are the same rotation
        angular_rate=np.stack([0 * t, v, 0 * t], axis=-1)[:, None],
        acceleration=specific[:, None],
        joint_angle=q[:, None],
        joint_rate=v[:, None],
        drive_angle=q[:, None] + wind_up,
        drive_rate=v[:, None],
        motor_torque=(500 * np.sin(q))[:, None],
    )


def sensor(**keys):
    place = {} if "joint" in keys or "link" in keys else {"point": "tip"}
    return Sensor.model_validate({"name": "sensor", "rate_hz": 37.0, **place, **keys})


def noiseless(**keys):
    signal = measure(motion(), [sensor(**keys)], np.random.default_rng(0)).signals["sensor"]
    return signal.time, signal.values


def test_motor_side_is_ahead_by_the_wind_up():
    t, motor = noiseless(quantity="joint_angle", joint="hinge")
    _, output = noiseless(quantity="joint_angle", joint="hinge", side="output")
    np.testing.assert_allclose(output[:, 0], angle(t), atol=1e-12)  # Hermite: h^4 q''''/384 = 1e-13
    np.testing.assert_allclose(motor - output, 2e-3, atol=1e-12)


def test_rate_is_the_derivative_of_the_angle():
    t, values = noiseless(quantity="joint_rate", joint="hinge")
    np.testing.assert_allclose(values[:, 0], rate(t), atol=1e-6)  # central differences: h^2 q'''/6


def test_torque_at_the_shaft_is_the_output_torque_over_the_ratio():
    t, shaft = noiseless(quantity="motor_torque", joint="hinge")
    _, output = noiseless(quantity="motor_torque", joint="hinge", side="output")
    np.testing.assert_allclose(shaft * RATIO, output, rtol=1e-12)
    np.testing.assert_allclose(output[:, 0], 500 * np.sin(angle(t)), atol=1e-3)


def test_quantities_without_rates_take_differences_of_uneven_steps():
    """Central ones of a parabola are exact, and so is what lies between; at both ends they are one-sided."""
    time = np.array([0.0, 0.1, 0.3, 0.4, 0.8, 0.9])
    between = np.linspace(0.1, 0.8, 30)
    assert sample(time, time**2, between) == pytest.approx(between**2, abs=1e-14)
    ends = np.array([0.05, 0.85])
    rates = np.gradient(time**2, time)
    assert sample(time, time**2, ends) == pytest.approx(sample(time, time**2, ends, rates))
    assert sample(time[:2], time[:2], np.array([0.05])) == pytest.approx(0.05)


def test_samples_at_the_steps_are_an_array_of_their_own():
    """Also where the motion is read-only, as that of a simulation is."""
    time = np.linspace(0.0, 1.0, 5)
    values = time**2
    values.setflags(write=False)
    found = sample(time, values, time)
    found -= found[2]
    assert list(found + values[2]) == list(values)


def test_position_is_sampled_at_the_sensors_own_instants():
    t, values = noiseless(quantity="position", axes=["z", "x"])
    np.testing.assert_allclose(np.diff(t), 1 / 37, rtol=1e-9)
    np.testing.assert_allclose(values, tip(t)[:, [2, 0]], atol=1e-11)


def test_a_sensor_of_more_samples_than_memory_holds_is_refused():
    sensor = Sensor(name="tip", quantity="position", point="tip", rate_hz=1e9)
    with pytest.raises(
        InvalidParameter, match=r"sensors\.tip\.rate_hz: makes 1e\+10 samples of 10 s; allowed"
    ):
        measure(motion(), [sensor], np.random.default_rng(1))


def test_slow_tracker_aliases_the_mode_that_it_undersamples():
    """2.5 Hz sampled at 2.3 Hz appears at 0.2 Hz, with its full amplitude."""
    run = motion(duration=60.0)
    run.position = np.stack([np.cos(2 * np.pi * 2.5 * run.time)] + [0 * run.time] * 2, axis=-1)[:, None]
    run.velocity = np.gradient(run.position, run.time, axis=0)
    record = measure(run, [sensor(quantity="position", axes=["x"], rate_hz=2.3)], np.random.default_rng(0))
    signal = record.signals["sensor"]
    np.testing.assert_allclose(signal.values[:, 0], np.cos(2 * np.pi * 0.2 * signal.time), atol=1e-3)


def test_orientation_turns_with_the_frame():
    """A frame turned by 0.5 rad about y sees a body at angle q at q - 0.5."""
    record = measure(
        motion(),
        [sensor(quantity="orientation", frame="tracker")],
        np.random.default_rng(0),
        frames={"tracker": Frame(rpy=(0, 0.5, 0))},
    )
    signal = record.signals["sensor"]
    half = (angle(signal.time) - 0.5) / 2
    sign = np.sign(signal.values[:, 3] * np.cos(half))
    np.testing.assert_allclose(
        signal.values * sign[:, None],
        np.stack([0 * half, np.sin(half), 0 * half, np.cos(half)], axis=-1),
        atol=1e-6,
    )


def test_inertial_unit_feels_gravity_upward_and_the_centrifugal_force():
    run = motion()
    t, force = noiseless(quantity="acceleration")
    q, v, a = angle(t), rate(t), -(1.3**2) * angle(t)
    np.testing.assert_allclose(force[:, 0], LENGTH * a - G * np.sin(q), atol=1e-4)
    np.testing.assert_allclose(force[:, 2], G * np.cos(q) - LENGTH * v**2, atol=1e-4)
    np.testing.assert_allclose(noiseless(quantity="angular_rate", axes=["y"])[1][:, 0], v, atol=1e-6)
    assert run.acceleration[0, 0, 2] == pytest.approx(G - LENGTH * rate(0) ** 2)


def test_inclination_of_the_rod_is_its_angle_above_the_horizontal():
    t, values = noiseless(quantity="inclination", axes=["z"])
    np.testing.assert_allclose(values[:, 0], np.pi / 2 - np.abs(angle(t)), atol=1e-5)
    t, values = noiseless(quantity="inclination", axes=["x"])
    np.testing.assert_allclose(values[:, 0], -angle(t), atol=1e-6)


def test_rigid_arm_has_no_deflection_and_a_bent_one_its_own():
    assert np.abs(noiseless(quantity="deflection")[1]).max() < 1e-11
    bent = motion()
    ahead = np.stack([np.cos(angle(bent.time)), 0 * bent.time, -np.sin(angle(bent.time))], axis=-1)
    bent.position = bent.position + 0.01 * ahead[:, None]
    record = measure(bent, [sensor(quantity="deflection", axes=["x"])], np.random.default_rng(0))
    # the double's velocity leaves out 0.01 q' along the arm: h/8 of the step in rate across a step
    np.testing.assert_allclose(record.signals["sensor"].values, 0.01, atol=1e-8)


def test_strain_of_a_beam_that_is_loaded_between_its_ends_is_refused():
    """The forces at its ends do not tell those between; they gave up to twice the strain."""
    load = {"name": "load", "link": "rod", "position": [0, 0, LENGTH / 2], "mass": 5.0}
    loaded = Arm.from_dict({**ARM.to_dict(), "payloads": [load]})
    run = simulate(loaded, Drive.from_samples([0.0, 0.1], {"hinge": [0.1, 0.1]}), forces=True)
    gauge = sensor(quantity="strain", link="rod", position=0.2, fibre=[0.0, 0.03])
    with pytest.raises(CannotMeasure, match="between those of 'rod' load acts; make it two beams"):
        measure(run, [gauge], np.random.default_rng(0))


def test_strain_of_a_cantilever_under_its_own_weight():
    """M_y(x) = p (L - x)^2/2 for a uniform load p and eps = z M_y/(E I_y); exact, since M_y is a parabola."""
    run, p, z, x = motion(duration=0.1), 120.0, 0.03, 0.7
    start = [0, 0, -p * LENGTH, 0, p * LENGTH**2 / 2, 0]  # V_z = M_y'
    run.section_forces = np.broadcast_to(np.array([start, [0] * 6]), (len(run.time), 1, 2, 6))
    run.joint_rate = 0 * run.joint_rate
    record = measure(
        run, [sensor(quantity="strain", link="rod", position=x, fibre=[0.0, z])], np.random.default_rng(0)
    )
    i_y = 0.04 * 0.06**3 / 12
    np.testing.assert_allclose(record.signals["sensor"].values, z * p * (LENGTH - x) ** 2 / 2 / (210e9 * i_y))


@pytest.mark.parametrize("scale", [1.0, 1.5])
def test_strain_along_a_beam_that_spins_about_its_start(scale):
    """N(x) = rho A w^2 (L^2 - x^2)/2: 3/8 rho A w^2 L^2 in the middle, in any plane."""
    w, time = 6.0, np.linspace(0, 0.5, 101)
    spinning = arm(
        gravity=[0, 0, 0],
        joints=[
            hinge("tilt", "stub"),
            hinge("hinge", "rod", "stub", axis=[0, 0, 2]),
        ],
        links=[rigid("stub", 1.0), beam("rod", [LENGTH, 0, 0], BAR, up=[0, 0, 1])],
        effects=[{"name": "link_mass", "at": "rod", "scale": scale}],
    )
    steady = replace(Drive.from_samples(time, {"hinge": w * time}), rest={"tilt": 0.5}, rates={})
    run = simulate(spinning, steady, step=1e-3, forces=True)
    material = spinning.link("rod").material
    for x in (0.0, LENGTH / 2, 0.8 * LENGTH):
        gauge = sensor(quantity="strain", link="rod", position=x, fibre=[0.0, 0.0])
        found = measure(run, [gauge], np.random.default_rng(0)).signals["sensor"].values[-3:, 0]
        exact = scale * material.density * w**2 * (LENGTH**2 - x**2) / 2 / material.youngs_modulus
        np.testing.assert_allclose(found, exact, rtol=1e-3)


def test_noise_is_as_stated():
    """Standard deviation of n samples: sigma (1 +- 1/sqrt(2 n)); five sigma of it."""
    record = measure(
        motion(), [sensor(quantity="position", noise_std=5e-5, rate_hz=1000.0)], np.random.default_rng(3)
    )
    signal = record.signals["sensor"]
    error = signal.values - tip(signal.time)
    assert error.std() == pytest.approx(5e-5, rel=5 / np.sqrt(2 * error.size))
    assert signal.noise_std == 5e-5


def test_quantised_encoder_gives_multiples_of_its_step():
    record = measure(
        motion(),
        [sensor(quantity="joint_angle", joint="hinge", side="output", step=1e-3, rate_hz=500.0)],
        np.random.default_rng(0),
    )
    signal = record.signals["sensor"]
    steps = signal.values / 1e-3
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-9)
    error = signal.values[:, 0] - angle(signal.time)
    assert np.abs(error).max() <= 0.5e-3 * (1 + 1e-9)
    assert error.std() == pytest.approx(1e-3 / np.sqrt(12), rel=0.1)
    assert signal.noise_std == pytest.approx(1e-3 / np.sqrt(12))


def test_units_of_a_sensor_are_converted():
    record = measure(
        motion(),
        [sensor(quantity="position", unit="mm", noise_std=0.05, step=0.01)],
        np.random.default_rng(0),
    )
    assert record.signals["sensor"].noise_std == pytest.approx(np.hypot(5e-5, 1e-5 / np.sqrt(12)))


def test_late_stamps_are_late_by_latency_delay_and_drift():
    keys = {"quantity": "position", "clock": "tracker", "latency_s": 0.01, "start": 0.5}
    record = measure(
        motion(),
        [sensor(**keys)],
        np.random.default_rng(0),
        clocks={"controller": Clock()},
        clock_errors={"tracker": ClockError(delay=0.02, rate=1e-3)},
    )
    signal = record.signals["sensor"]
    assert record.reference_clock == "controller"
    true = 0.5 + np.arange(len(signal)) / 37
    np.testing.assert_allclose(signal.time, (true + 0.01) * 1.001 + 0.02, rtol=1e-12)
    np.testing.assert_allclose(signal.values, tip(true), atol=1e-11)


def test_a_clock_is_late_by_its_stated_offset_unless_its_error_is_given():
    clocks = {"controller": Clock(), "tracker": Clock(offset=0.5)}
    for errors, late in ((None, 0.5), ({"tracker": ClockError(delay=0.2)}, 0.2)):
        record = measure(
            motion(),
            [sensor(quantity="position", clock="tracker")],
            np.random.default_rng(0),
            clocks=clocks,
            clock_errors=errors,
        )
        assert record.signals["sensor"].time[0] == late


def test_prediction_undoes_clock_and_frame():
    where = Registration(
        translation=(1e-3, 2e-3, -1e-3), rotation=(1e-3, 5e-4, 2e-3), origin=(4, 1, 0.5), rpy=(0, 0, 2)
    )
    late = ClockError(delay=0.03, rate=-2e-4)
    run = motion()
    record = measure(
        run,
        [sensor(quantity="position", frame="tracker", clock="tracker")],
        np.random.default_rng(0),
        clocks={"controller": Clock()},
        clock_errors={"tracker": late},
        registrations={"tracker": where},
    )
    signal = record.signals["sensor"]
    np.testing.assert_allclose(predict(run, signal, late, where), signal.values, atol=1e-12)
    assert np.nanmax(np.abs(predict(run, signal) - signal.values)) > 1.0


def test_registration_turns_about_the_base_origin_then_shifts():
    """Measured = R true + translation; by a quarter turn about z, x becomes y."""
    turned = Registration(rotation=(0, 0, np.pi / 2), translation=(0, 0, 1.0))
    np.testing.assert_allclose(turned.positions(np.array([[2.0, 0, 0]])), [[0, 2.0, 1.0]], atol=1e-15)


def test_jitter_moves_the_instants_and_not_the_stamps():
    record = measure(motion(), [sensor(quantity="position", jitter_std=1e-3)], np.random.default_rng(5))
    signal = record.signals["sensor"]
    np.testing.assert_allclose(np.diff(signal.time), 1 / 37, rtol=1e-9)
    along = (signal.values - tip(signal.time))[:, 0] / (
        LENGTH * rate(signal.time) * np.cos(angle(signal.time))
    )
    quick = np.abs(rate(signal.time)) > 0.5
    assert along[quick].std() == pytest.approx(1e-3, rel=0.2)


def test_drop_outs_are_rows_without_a_value():
    record = measure(
        motion(), [sensor(quantity="position", drop_out=0.2, rate_hz=400.0)], np.random.default_rng(1)
    )
    signal = record.signals["sensor"]
    lost = ~signal.valid
    assert np.isnan(signal.values[lost]).all()
    assert lost.mean() == pytest.approx(0.2, abs=5 * np.sqrt(0.2 * 0.8 / len(lost)))


def test_same_seed_gives_the_same_record():
    keys = {"quantity": "position", "noise_std": 1e-4, "drop_out": 0.1, "jitter_std": 1e-4}
    first, second, other = (
        measure(motion(), [sensor(**keys)], np.random.default_rng(seed)) for seed in (1, 1, 2)
    )
    assert first == second
    assert first != other


def test_after_the_run_nothing_is_known_and_before_it_the_arm_goes_on_as_it_starts():
    """For 0.05 s with the rate that it starts with, as clocks are late; a run that starts at rest rests."""
    run = motion()
    signal = measure(run, [sensor(quantity="position")], np.random.default_rng(0)).signals["sensor"]
    shifted = signal.replace(time=signal.time - 5.0)
    values = predict(run, shifted)
    before = tip(0.0) - EARLY * run.velocity[0, 0]
    early = values[shifted.time < -EARLY]
    np.testing.assert_allclose(early, np.broadcast_to(before, early.shape))
    late = signal.replace(time=signal.time + 5.0)
    assert np.array_equal(np.isnan(predict(run, late)[:, 0]), late.time > run.time[-1] + 1e-6)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"quantity": "motor_voltage", "joint": "hinge"}, "needs motor voltage, which this simulation"),
        ({"quantity": "joint_command", "joint": "hinge"}, "needs joint command"),
        ({"quantity": "position", "point": "elbow"}, "is at the point 'elbow'.* it holds tip"),
        ({"quantity": "strain", "link": "rod", "position": 1.0, "fibre": [0, 0.03]}, "needs section forces"),
        ({"quantity": "force"}, "force is an input"),
        (
            {"quantity": "deflection", "link": "rod", "position": 1.0},
            "no point on the axis of 'rod' at 1.0 m",
        ),
    ],
)
def test_what_a_simulation_does_not_hold_is_said(keys, words):
    with pytest.raises(CannotMeasure, match=words):
        noiseless(**keys)


def test_seedless_measurements_are_refused():
    with pytest.raises(InvalidParameter, match=r"must be a numpy\.random\.Generator, got int"):
        measure(motion(), [], 1)


def test_positions_along_two_axes_are_two_of_three():
    frame = Registration(
        (0.1, 0.2, -0.3), (0.02, 0.01, -0.03), (1, 2, 3), (0.3, -0.2, 1.0), (1e-3, 0, 2e-3), 1.001
    )
    base, elapsed = np.random.default_rng(3).normal(size=(5, 3)), np.arange(5.0)
    np.testing.assert_allclose(
        frame.positions(base, elapsed, [2, 0]), frame.positions(base, elapsed)[:, [2, 0]], rtol=1e-14
    )
    assert Registration().positions(base, elapsed, [1]).tolist() == base[:, [1]].tolist()


def test_sensor_that_starts_too_late_is_named():
    with pytest.raises(InvalidParameter, match="'sensor' starts at 20 s, after the end of a run of 10 s"):
        noiseless(quantity="position", start=20.0)


@pytest.mark.parametrize("rates", [True, False])
def test_many_instants_are_interpolated_like_a_few(rates):
    """To rounding: the step of an instant is that of the last one, the next, or looked for."""
    time = np.linspace(0, 3, 301)
    values = np.stack([np.sin(time), np.cos(2 * time)], axis=1)
    slopes = np.stack([np.cos(time), -2 * np.sin(2 * time)], axis=1) if rates else None
    instants = np.sort(np.random.default_rng(4).uniform(-0.01, 3.01, 1000))
    whole = sample(time, values, instants, slopes)
    parts = np.concatenate([sample(time, values, each, slopes) for each in np.array_split(instants, 3)])
    np.testing.assert_allclose(whole, parts, atol=1e-14)
