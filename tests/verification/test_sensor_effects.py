"""Signatures of sensors' effects: what each makes of the paper's arm, against closed forms.

The tip of a rigid arm of length L at the angle q is L (sin q, 0, cos q); the motion is known in closed form,
so predictions are compared with formulas. Where drives matter a run is simulated, measured and compared.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from arms import LENGTH, arm, hinge, paper_arm, point, rigid, smooth_step
from scipy.spatial.transform import Rotation

from flexarm import Arm, Drive, Record, Signal, compare, measure, simulate, static
from flexarm.arm.sensor import Sensor
from flexarm.cli.virtual_record import sensed, simulated
from flexarm.comparison.align import align
from flexarm.comparison.alignment_parameters import stated_placement
from flexarm.comparison.simulated_record import pair_record
from flexarm.effects import (
    ClockDrift,
    DeadChannel,
    EncoderEccentricity,
    EncoderOffset,
    EncoderQuantisation,
    EncoderScale,
    FrameDrift,
    FrameRegistration,
    Outliers,
    Saturation,
    SensorOffset,
    SignError,
    TimeDelay,
    UnitError,
)
from flexarm.measurement import predict
from flexarm.record import Clock, Frame

TRACKER, ENCODER = 5e-5, 1.5e-6

# ------------------------------------------------------- a motion in closed form

T0 = 3.0
"""Start of the motion [s]: drifts count from it."""


def angle(t):
    return 0.9 * np.sin(0.7 * (t - T0))


def rate(t):
    return 0.63 * np.cos(0.7 * (t - T0))


def tip(t):
    q = angle(t)
    return LENGTH * np.stack([np.sin(q), 0 * q, np.cos(q)], axis=-1)


def velocity(t):
    q = angle(t)
    return LENGTH * rate(t)[:, None] * np.stack([np.cos(q), 0 * q, -np.sin(q)], axis=-1)


RIGID = arm(
    joints=[hinge("hinge", "rod", gear_ratio=120)],
    links=[rigid("rod", 10.0, [0, 0, 1.5], [8, 8, 0.1])],
    points=[point("tip", "rod", [0, 0, LENGTH])],
)


def motion(effects=()):
    """The rigid arm's motion, 30 s from T0, as a simulation of a model with these effects has it."""
    t = T0 + np.arange(0, 30.001, 0.002)
    return SimpleNamespace(
        arm=RIGID.replace(effects=tuple(effects)),
        points=("tip",),
        joints=("hinge",),
        time=t,
        position=tip(t)[:, None],
        velocity=velocity(t)[:, None],
        joint_angle=angle(t)[:, None],
        joint_rate=rate(t)[:, None],
        drive_angle=angle(t)[:, None],
        drive_rate=rate(t)[:, None],
    )


STAMPS = T0 + np.arange(0.1, 29.0, 0.37)
SEEN = {
    "tip": Signal(
        name="tip", quantity="position", point="tip", clock="lan", frame="tracker", time=STAMPS,
        values=np.zeros((len(STAMPS), 3)),
    ),
    "encoder": Signal(
        name="encoder", quantity="joint_angle", joint="hinge", side="output", clock="plc", time=STAMPS,
        values=0 * STAMPS,
    ),
}  # fmt: skip


def shown(signal, *effects, **options):
    """Readings at STAMPS with these effects."""
    return predict(motion(effects), SEEN[signal], **options)


@pytest.mark.parametrize("at", ["tip", "lan"])
def test_a_delay_opens_a_gap_of_the_tips_speed_times_the_delay(at):
    """reading(s) = tip(s - delay): 1 ms at up to 1.9 m/s; the rest is delay^2/2 x acceleration (1.7 m/s2)."""
    gap = shown("tip", TimeDelay(at=at, delay=1e-3)) - tip(STAMPS)
    np.testing.assert_allclose(gap, -1e-3 * velocity(STAMPS), atol=0.5e-6 * 1.7)
    assert np.abs(gap).max() > 1.8e-3
    assert np.array_equal(shown("encoder", TimeDelay(at=at, delay=1e-3)), shown("encoder"))


def test_a_drifting_clock_opens_a_gap_that_grows_with_time():
    """reading at s = T0 + (s - T0)/(1 + rate): the gap over the speed is rate (s - T0), 50 ppm x 29 s."""
    rate_error = 5e-5
    gap = shown("tip", ClockDrift(at="lan", rate=rate_error)) - tip(STAMPS)
    late = rate_error * (STAMPS - T0)
    np.testing.assert_allclose(gap, -late[:, None] * velocity(STAMPS), atol=2e-6)  # late^2/2 x 1.9 m/s2
    assert np.abs(gap).max() > 2e-3
    exact = tip(T0 + (STAMPS - T0) / (1 + rate_error))
    np.testing.assert_allclose(shown("tip", ClockDrift(at="lan", rate=rate_error)), exact, atol=1e-11)


def test_a_registration_sees_a_rigid_copy():
    """R(rotation) p + translation about the base's origin, R by another library; distances stay."""
    effect = FrameRegistration(at="tracker", translation=(0.01, -0.02, 0.03), rotation=(0.2, -0.1, 0.3))
    copy = Rotation.from_rotvec(effect.rotation).apply(tip(STAMPS)) + effect.translation
    found = shown("tip", effect)
    np.testing.assert_allclose(found, copy, atol=1e-11)
    np.testing.assert_allclose(
        np.linalg.norm(found[1:] - found[0], axis=1),
        np.linalg.norm(tip(STAMPS)[1:] - tip(STAMPS)[0], axis=1),
        atol=1e-11,
    )


def test_a_drifting_frame_opens_a_gap_of_its_velocity_times_the_time_since_the_start():
    speed = np.array([3e-7, -1e-7, 2e-7])
    gap = shown("tip", FrameDrift(at="tracker", velocity=tuple(speed))) - tip(STAMPS)
    np.testing.assert_allclose(gap, np.outer(STAMPS - T0, speed), atol=1e-11)


def test_effects_of_one_frame_act_in_the_order_of_the_law():
    """measured = R true + translation + velocity t: the velocity is not turned."""
    turn = FrameRegistration(at="tracker", translation=(0.1, 0, 0), rotation=(0, 0.5, 0))
    found = shown("tip", FrameDrift(at="tracker", velocity=(1e-3, 0, 0)), turn)
    expected = Rotation.from_rotvec([0, 0.5, 0]).apply(tip(STAMPS))
    expected[:, 0] += 0.1 + 1e-3 * (STAMPS - T0)
    np.testing.assert_allclose(found, expected, atol=1e-11)


def test_quantisation_errs_by_half_a_step_at_most():
    """And by step/sqrt(12) rms over the 34 000 steps of this swing, whose rest has no pattern: to 20 %."""
    step = 1e-4
    error = shown("encoder", EncoderQuantisation(at="encoder", step=step))[:, 0] - angle(STAMPS)
    assert np.abs(error).max() <= step / 2 * (1 + 1e-9)
    assert np.sqrt(np.mean(error**2)) == pytest.approx(step / np.sqrt(12), rel=0.2)
    rough = shown("encoder", EncoderQuantisation(at="encoder", step=step), rounded=False)
    np.testing.assert_allclose(rough[:, 0], angle(STAMPS), atol=1e-11)


def test_faults_of_a_sensor_show_as_what_they_are():
    p = tip(STAMPS)
    flipped = shown("tip", SignError(at="tip", channels=("x",)))
    np.testing.assert_allclose(flipped, p * [-1, 1, 1], atol=1e-11)
    np.testing.assert_allclose(shown("tip", UnitError(at="tip", factor=1e3)), 1e3 * p, atol=1e-8)
    np.testing.assert_allclose(
        shown("tip", Saturation(at="tip", limit=2.5)), np.clip(p, -2.5, 2.5), atol=1e-11
    )
    dead = shown("tip", DeadChannel(at="tip", channels=("z",), value=0.25))
    assert np.ptp(dead[:, 2]) == 0 and dead[0, 2] == 0.25
    np.testing.assert_allclose(dead[:, 0], p[:, 0], atol=1e-11)
    offset = shown("tip", SensorOffset(at="tip", offset=(1e-3, 0, -2e-3)))
    np.testing.assert_allclose(offset - p, np.tile([1e-3, 0, -2e-3], (len(p), 1)), atol=1e-11)
    outliers = shown("tip", Outliers(at="tip", share=0.3, size=1.0))
    np.testing.assert_allclose(outliers, p, atol=1e-11)  # nothing predicts them


SMOOTH = [
    (TimeDelay(at="tip", delay=2e-3), "delay", 1e-4),
    (ClockDrift(at="lan", rate=1e-4), "rate", 1e-5),
    (FrameRegistration(at="tracker", rotation=(0.1, 0.2, 0.0)), "rotation.y", 1e-4),
    (FrameRegistration(at="tracker"), "rotation.z", 1e-4),
    (FrameRegistration(at="tracker"), "translation.x", 1e-4),
    (FrameDrift(at="tracker"), "velocity.z", 1e-6),
    (SensorOffset(at="tip", offset=(0.0, 0.0, 0.0)), "offset.x", 1e-4),
    (UnitError(at="tip", factor=2.0), "factor", 1e-3),
]


@pytest.mark.parametrize(
    ("effect", "name", "h"), SMOOTH, ids=lambda value: str(getattr(value, "name", value))
)
def test_predictions_have_derivatives_by_the_parameters_of_smooth_effects(effect, name, h):
    """Central differences of h and h/2 differ by O(h^2): 1e-6 of the derivative, as sensitivities need.

    Between steps the motion is a cubic; a delay moves samples over its kinks of the third derivative, which
    cost less than that.
    """
    assert effect.derivative(name) == "smooth"
    value = dict((key, x) for key, x, _ in effect.parameters())[name]

    def slope(step):
        ahead, behind = (shown("tip", effect.with_parameters({name: value + s})) for s in (step, -step))
        return (ahead - behind) / (2 * step)

    size = np.abs(slope(h)).max()
    assert size > 0.1
    np.testing.assert_allclose(slope(h), slope(h / 2), atol=1e-6 * size)


def test_readings_of_linear_sensors_are_affine_in_the_motion():
    """Sensitivities pass through them: reading(a + s (b - a)) = reading(a) + s (reading(b) - reading(a))."""
    effects = (
        TimeDelay(at="lan", delay=0.013),
        ClockDrift(at="tip", rate=1e-4),
        FrameRegistration(at="tracker", translation=(0.1, 0, 0), rotation=(0.1, 0.2, 0.3)),
        FrameDrift(at="tracker", velocity=(1e-4, 0, 0)),
        SignError(at="tip", channels=("z",)),
        UnitError(at="tip", factor=25.4),
        SensorOffset(at="tip", offset=0.3),
    )
    one, other, between = (motion(effects) for _ in range(3))
    other.position = one.position[:, :, ::-1] ** 2
    other.velocity = 2 * one.position[:, :, ::-1] * one.velocity[:, :, ::-1]
    between.position = one.position + 0.3 * (other.position - one.position)
    between.velocity = one.velocity + 0.3 * (other.velocity - one.velocity)
    a, b, c = (predict(run, SEEN["tip"]) for run in (one, other, between))
    np.testing.assert_allclose(c, a + 0.3 * (b - a), rtol=1e-12, atol=1e-11)
    assert np.abs(b - a).max() > 1


# ------------------------------------------------------------ drives: runs of a model


DRIVEN = [
    (EncoderScale(at="encoder", scale=1.01), "scale", 1e-4),
    (EncoderOffset(at="encoder", offset=0.02), "offset", 1e-3),
    (EncoderEccentricity(at="encoder", amplitude=1e-3, phase=0.3), "amplitude", 1e-3),
    (EncoderEccentricity(at="encoder", amplitude=0.01, phase=0.3), "phase", 1e-3),
    (TimeDelay(at="encoder", delay=0.01), "delay", 2e-4),
    (ClockDrift(at="plc", rate=1e-4), "rate", 1e-4),
]


def noisy_encoder():
    """A record that holds nothing but a noisy encoder."""
    t = np.arange(0, 20, 0.004)
    noise = ENCODER * np.random.default_rng(4).standard_normal(len(t))
    signal = Signal(name="encoder", quantity="joint_angle", joint="hinge", side="motor", clock="plc", time=t,
                    values=smooth_swing(20.0).joints["hinge"](t) + noise, noise_std=ENCODER)  # fmt: skip
    return Record(signals=[signal], drive="encoder", clocks={"plc": Clock()})


def test_no_parameter_of_a_sensor_moves_a_break_of_the_smoothed_drive():
    """Readings and stamps alone say where breaks lie; a break that comes or goes would be a jump of 1e-6."""
    plain = Drive.from_record(noisy_encoder(), RIGID).joints["hinge"]
    for effect in (EncoderEccentricity(at="encoder", amplitude=0.4), EncoderScale(at="encoder", scale=0.5)):
        moved = Drive.from_record(noisy_encoder(), RIGID.with_effect(effect)).joints["hinge"]
        assert np.array_equal(moved.breaks, plain.breaks)
        assert np.abs(moved.coefficients - plain.coefficients).max() > 0.1
    late = Drive.from_record(noisy_encoder(), RIGID.with_effect(TimeDelay(at="plc", delay=0.3)))
    np.testing.assert_allclose(late.joints["hinge"].breaks, plain.breaks - 0.3, atol=1e-12)


@pytest.mark.parametrize(("effect", "name", "h"), DRIVEN, ids=lambda x: str(getattr(x, "name", x)))
def test_a_smoothed_drive_has_derivatives_by_the_parameters_of_its_sensor(effect, name, h):
    """Central differences of h and h/2 agree to 1e-4 although the samples are noisy."""
    record = noisy_encoder()
    when = np.arange(0.5, 19.5, 0.01)
    value = dict((key, x) for key, x, _ in effect.parameters())[name]

    def slope(step):
        ahead, behind = (
            Drive.from_record(record, RIGID.with_effect(effect.with_parameters({name: value + s})))
            for s in (step, -step)
        )
        return (ahead.joints["hinge"](when) - behind.joints["hinge"](when)) / (2 * step)

    size = np.abs(slope(h)).max()
    assert size > 1e-3
    np.testing.assert_allclose(slope(h), slope(h / 2), atol=1e-4 * size)


def smooth_swing(duration, turns=0.7, frequency=0.15):
    """A swing that starts and turns smoothly, exact at 4 ms."""
    t = np.arange(0, duration, 0.004)
    return Drive.from_samples(t, {"hinge": turns * np.sin(2 * np.pi * frequency * t) * smooth_step(t / 3)})


SENSORS = (
    Sensor(name="encoder", quantity="joint_angle", joint="hinge", rate_hz=250, noise_std=ENCODER,
           clock="plc"),
    Sensor(name="tip", quantity="position", point="tip", axes=("x", "z"), rate_hz=10, noise_std=TRACKER,
           frame="tracker", clock="lan"),
)  # fmt: skip
BENCH = {
    "clocks": {"plc": Clock(), "lan": Clock(sigma=5e-5)},
    "frames": {"tracker": Frame(translation=1e-5, rotation=5e-6)},
}


def experiment(model, drive, seed=1, **keys):
    """The record of a run of this model along the true angle."""
    run = simulate(model, drive)
    sensors = [sensor.replace(**keys.get(sensor.name, {})) for sensor in SENSORS]
    return measure(run, sensors, np.random.default_rng(seed), drive=("encoder",), **BENCH)


FLEXIBLE = paper_arm(2, spring=1.5e5, damping_ratio=0.01)


def test_an_encoders_scale_opens_a_gap_that_grows_with_the_angle():
    """reading = s q drives the model to s q: the tangential gap of a rigid arm is L sin(q - s q)."""
    scaled = EncoderScale(at="encoder", scale=1.002)
    record = experiment(RIGID.with_effect(scaled), smooth_swing(12.0))
    gap = compare(RIGID, record, align=False).signals["tip"]
    q = smooth_swing(12.0).joints["hinge"](gap.time)
    np.testing.assert_allclose(gap.parts["tangential"], LENGTH * np.sin(-0.002 * q), atol=6 * TRACKER)
    assert np.abs(gap.parts["radial"]).max() < 6 * TRACKER  # L (1 - cos 0.0014) is 3e-6
    assert np.abs(gap.parts["tangential"]).max() > 4e-3


def test_an_eccentric_encoder_opens_a_gap_once_per_turn():
    """The gap of a rigid arm is -L amplitude sin(q + phase): over the angle, one harmonic, two turns here."""
    t = np.arange(0, 20, 0.004)
    drive = Drive.from_samples(t, {"hinge": 4 * np.pi * smooth_step(t / 20)})
    eccentric = EncoderEccentricity(at="encoder", amplitude=1e-3, phase=0.8)
    record = experiment(RIGID.with_effect(eccentric), drive)
    gap = compare(RIGID, record, align=False).signals["tip"]
    q = drive.joints["hinge"](gap.time)
    basis = np.stack([f(k * q) for k in (1, 2, 3) for f in (np.sin, np.cos)] + [np.ones_like(q)], axis=1)
    found = np.linalg.lstsq(basis, gap.parts["tangential"], rcond=None)[0]
    expected = -LENGTH * 1e-3 * np.array([np.cos(0.8), np.sin(0.8), 0, 0, 0, 0, 0])
    np.testing.assert_allclose(found, expected, atol=5 * TRACKER * np.sqrt(2 / len(q)) * 2)


ENCODER_EFFECTS = (
    EncoderScale(at="encoder", scale=1.003),
    EncoderEccentricity(at="encoder", amplitude=4e-4, phase=1.1),
    EncoderOffset(at="encoder", offset=-2e-3),
    EncoderQuantisation(at="encoder", step=4e-6),
)
CLOCK_EFFECTS = (
    TimeDelay(at="plc", delay=-0.006),
    TimeDelay(at="tip", delay=0.013),
    ClockDrift(at="plc", rate=2e-4),
    ClockDrift(at="lan", rate=-1e-4),
)
FRAME_EFFECTS = (
    FrameRegistration(at="tracker", translation=(3e-3, 0, -2e-3), rotation=(0, 1e-3, 0)),
    FrameDrift(at="tracker", velocity=(2e-5, 0, 1e-5)),
)


@pytest.mark.parametrize("align", [False, True], ids=["raw", "aligned"])
@pytest.mark.parametrize(
    "effects",
    [ENCODER_EFFECTS, CLOCK_EFFECTS, FRAME_EFFECTS, ENCODER_EFFECTS + CLOCK_EFFECTS + FRAME_EFFECTS],
    ids=["encoder", "clocks", "frame", "all"],
)
def test_a_model_that_has_the_effects_of_its_sensors_leaves_their_noise(effects, align):
    """Simulate, measure, compare: the drive is turned back into the true angle and true time.

    Total of two channels within 5 % of the noise (400 numbers: sigma 3.5 %); the same run without the effects
    leaves 10 times the noise and more. The drive signal is predicted to its own noise.
    """
    true = FLEXIBLE.replace(effects=(*FLEXIBLE.effects, *effects))
    record = experiment(true, smooth_swing(20.0))
    found = compare(true, record, align=align)
    gap, drive = found.signals["tip"], found.signals["encoder"]
    assert gap.rms["total"] == pytest.approx(gap.noise_rms, rel=0.1)
    assert gap.noise_rms == pytest.approx(TRACKER * np.sqrt(2))
    assert drive.rms["total"] == pytest.approx(drive.noise_rms, rel=0.05)
    assert compare(FLEXIBLE, record, align=False).signals["tip"].rms["total"] > 10 * gap.noise_rms


def test_an_alignment_counts_from_the_models_effects():
    """With the delay and registration that were there, clocks and frames stay within their stated sigmas."""
    effects = (*CLOCK_EFFECTS, *FRAME_EFFECTS)
    true = FLEXIBLE.replace(effects=(*FLEXIBLE.effects, *effects))
    record = experiment(true, smooth_swing(20.0))
    run = simulate(true, record)
    aligned = align(pair_record(run, record), stated_placement(record))
    assert aligned.beyond_prior == []
    moves = [abs(v - u.centre) / u.sigma for u, v in zip(aligned.parameters, aligned.values, strict=True)]
    assert max(moves) < 3
    nominal = align(pair_record(run, record, arm=FLEXIBLE), stated_placement(record))
    assert nominal.beyond_prior != []


def test_an_unknown_clock_and_frame_are_found_beside_the_models_effects():
    effects = (
        *CLOCK_EFFECTS,
        *FRAME_EFFECTS,
        SignError(at="tip", channels=("z",)),
        UnitError(at="tip", factor=1e3),
    )
    true = FLEXIBLE.replace(effects=(*FLEXIBLE.effects, *effects))
    record = experiment(true, smooth_swing(20.0))
    blind = record.replace(
        clocks={"plc": Clock(), "lan": Clock(unknown=True)}, frames={"tracker": Frame(unknown=True)}
    )
    gap = compare(true, blind).signals["tip"]
    assert gap.rms["total"] == pytest.approx(gap.noise_rms, rel=0.1)
    assert gap.noise_rms == pytest.approx(1e3 * TRACKER * np.sqrt(2))


def test_an_encoder_of_fine_steps_is_invisible_at_the_tip_after_smoothing():
    """2^21 steps per output turn: the tip moves by less than a tenth of the tracker's noise."""
    step = 2 * np.pi / 2**21
    rounds = FLEXIBLE.with_effect(EncoderQuantisation(at="encoder", step=step))
    drive = smooth_swing(12.0)
    record = experiment(rounds, drive, encoder={"noise_std": 0.0})
    assert np.abs(record.signals["encoder"].values % step / step - 0.5).min() > 0.49  # multiples of the step
    true, found = simulate(FLEXIBLE, drive), simulate(rounds, record)
    off = found.at(true.time[:-10], "tip") - true.at(true.time[:-10], "tip")
    assert np.sqrt(np.mean(np.sum(off**2, axis=1))) < 0.1 * TRACKER


def test_outliers_are_drawn_in_a_measurement_and_removed_in_a_comparison():
    """3 % of the rows off by 5 mm per channel: the gap is their root mean square without the effect.

    With it the noise is left; some 0.5 % of the outliers are too small to be told apart.
    """
    effect = Outliers(at="tip", share=0.03, size=5e-3)
    true = FLEXIBLE.with_effect(effect)
    record = experiment(true, smooth_swing(60.0))
    raw = compare(FLEXIBLE, record, align=False).signals["tip"]
    assert raw.rms["total"] == pytest.approx(5e-3 * np.sqrt(2 * 0.03), rel=0.5)  # 18 outliers: 24 %
    found = compare(true, record)
    gap = found.signals["tip"]
    assert gap.rms["total"] == pytest.approx(gap.noise_rms, rel=0.1)
    assert 600 * 0.03 - 3 * np.sqrt(18) < gap.removed < 600 * 0.03 + 3 * np.sqrt(18)
    assert any(f"{gap.removed} of 600 rows of tip are outliers" in note for note in found.notes)


def test_outliers_of_an_encoder_do_not_drive_the_arm():
    true = FLEXIBLE.with_effect(Outliers(at="encoder", share=0.01, size=0.01))
    record = experiment(true, smooth_swing(12.0))
    gap = compare(true, record, align=False).signals["tip"]
    assert gap.rms["total"] == pytest.approx(gap.noise_rms, rel=0.15)
    assert compare(FLEXIBLE, record, align=False).signals["tip"].rms["total"] > 3 * gap.noise_rms


def test_a_fault_of_the_drives_sensor_is_taken_back():
    """An encoder of the wrong sign in degrees, whose range ends: what it does not show is a drop-out."""
    faults = (
        SignError(at="encoder"),
        UnitError(at="encoder", factor=180 / np.pi),
        Saturation(at="encoder", limit=0.699),
    )
    true = FLEXIBLE.replace(effects=(*FLEXIBLE.effects, *faults))
    record = experiment(true, smooth_swing(12.0))
    found = compare(true, record, align=False)
    gap = found.signals["tip"]
    assert gap.rms["total"] == pytest.approx(gap.noise_rms, rel=0.15)
    assert found.signals["encoder"].noise_rms == pytest.approx(180 / np.pi * ENCODER)


def test_what_flexarm_simulate_writes_is_compared_with_its_own_model():
    """The drive is written as the encoder of its name shows it, points as their sensors do."""
    effects = (
        EncoderScale(at="hinge", scale=1.01),
        EncoderOffset(at="hinge", offset=0.02),
        TimeDelay(at="hinge", delay=0.05),
        SignError(at="tip", channels=("x",)),
        TimeDelay(at="clock", delay=0.02),
        FrameRegistration(at="base", translation=(0.1, 0, 0)),
    )
    model = FLEXIBLE.replace(effects=(*FLEXIBLE.effects, *effects))
    swing = smooth_swing(8.0)
    run = simulate(model, swing)
    record = sensed(run, model, swing, 0)
    assert record.signals["hinge"].time[0] == pytest.approx(0.07)
    assert record.signals["tip"].time[0] == pytest.approx(0.02)
    gap = compare(model, record, align=False).signals["tip"]
    assert gap.max["total"] < 1e-6  # steps of the second run fall elsewhere: 1900 h^2 mm is 8e-3 mm at most
    again = simulated(record, run, model)
    for name in ("hinge", "tip"):
        np.testing.assert_allclose(again.signals[name].values, record.signals[name].values, atol=1e-12)


def test_poses_stand_where_their_encoder_says_they_are():
    """reading = 1.01 true + 0.02 in a static record: every pose is the equilibrium of the true angle."""
    angles = np.array([-0.8, 0.1, 0.9])
    places = np.array([static(FLEXIBLE, {"hinge": q}).position[0] for q in angles])
    names = np.array(["a", "b", "c"])
    record = Record(
        signals=[
            Signal(name="encoder", quantity="joint_angle", joint="hinge", side="motor",
                   values=1.01 * angles + 0.02, pose=names, noise_std=1e-6),
            Signal(name="tip", quantity="position", point="tip", values=places, pose=names, noise_std=1e-6),
        ],
        drive="encoder",
        kind="static",
    )  # fmt: skip
    model = FLEXIBLE.with_effect(EncoderScale(at="encoder", scale=1.01))
    model = model.with_effect(EncoderOffset(at="encoder", offset=0.02))
    model = model.with_effect(TimeDelay(at="clock", delay=0.5))  # poses have no time
    record = record.replace(clocks={"clock": Clock(), "lan": Clock(offset=0.5)})
    record = record.replace(
        signals=[s.replace(clock="lan" if s.name == "tip" else "clock") for s in record.signals.values()]
    )
    assert compare(model, record).signals["tip"].max["total"] < 1e-9
    assert compare(FLEXIBLE, record).signals["tip"].max["total"] > 0.02


# -------------------------------------------------------------- an encoder in the loop


def controlled(*effects):
    """A rigid arm without gravity under a stiff cascade that reads an encoder."""
    return RIGID.replace(
        gravity=(0.0, 0.0, 0.0),
        sensors=(Sensor(name="encoder", quantity="joint_angle", joint="hinge", rate_hz=500),),
        controllers=Arm.from_dict(
            {
                **RIGID.to_dict(),
                "controllers": [
                    {
                        "type": "cascade",
                        "joint": "hinge",
                        "position_gain": 8.0,
                        "velocity_gain": 4000.0,
                        "integral_time": 0.2,
                        "sample_time": 0.002,
                    }
                ],
            }
        ).controllers,
        effects=effects,
    )


def test_a_controller_follows_its_imperfect_encoder():
    """The loop brings the reading to the command: 1.02 q + 0.03 = c, at rest before and after the move."""
    effects = (EncoderScale(at="encoder", scale=1.02), EncoderOffset(at="encoder", offset=0.03))
    t = np.arange(0, 8, 0.002)
    command = 0.2 + 0.5 * smooth_step((t - 1) / 2)
    commanded = Drive.from_samples(t, {"hinge": command}, side="command")
    run = simulate(controlled(*effects), commanded)
    true = run.drive_angle[:, 0]
    early = run.time < 0.99
    np.testing.assert_allclose(true[early], (0.2 - 0.03) / 1.02, atol=1e-9)
    assert true[-1] == pytest.approx((0.7 - 0.03) / 1.02, abs=1e-5)
    record = sensed(run, run.arm, commanded, 0)
    assert record.signals["encoder"].values[-1, 0] == pytest.approx(0.7, abs=1e-5)


def test_an_encoder_that_hides_the_angle_cannot_close_a_loop():
    drive = Drive.from_samples([0, 1], {"hinge": [0.2, 0.2]}, side="command")
    with pytest.raises(ValueError, match=r"encoder of joint 'hinge' never shows the command 0\.2"):
        simulate(controlled(DeadChannel(at="encoder")), drive)


def test_a_dead_encoder_cannot_drive():
    record = experiment(FLEXIBLE, smooth_swing(2.0))
    with pytest.raises(ValueError, match="'encoder' cannot drive: dead_channel leave no value of it"):
        compare(FLEXIBLE.with_effect(DeadChannel(at="encoder")), record)


def test_effects_of_places_that_the_record_has_not_are_noted():
    record = experiment(FLEXIBLE, smooth_swing(4.0))
    lost = FLEXIBLE.with_effect(TimeDelay(at="traker", delay=1.0))
    found = compare(lost, record)
    assert any("time_delay.traker acts on nothing in this record" in note for note in found.notes)
    assert found.signals["tip"].rms == compare(FLEXIBLE, record).signals["tip"].rms


def test_a_run_may_be_used_again_with_other_effects_of_its_sensors():
    """What sensors of evidence do needs no new simulation."""
    record = experiment(FLEXIBLE.with_effect(TimeDelay(at="tip", delay=0.02)), smooth_swing(8.0))
    run = simulate(FLEXIBLE, record)
    for delay, holds in ((0.02, True), (0.0, False)):
        late = FLEXIBLE.with_effect(TimeDelay(at="tip", delay=delay))
        gap = compare(late, record, align=False, simulation=run).signals["tip"]
        assert (gap.rms["total"] < 1.2 * gap.noise_rms) == holds
    assert replace(run, arm=late).arm is late
