"""Claims about effects of sensors as data: where they act, in which order, and what cannot be."""

import numpy as np
import pytest
from arms import arm as arm_of
from arms import beam, general, hinge, paper_arm, point

from flexarm import Arm, Record, Signal
from flexarm.arm import effect_class
from flexarm.arm.sensor import Sensor
from flexarm.effects import (
    ClockDrift,
    DeadChannel,
    EncoderEccentricity,
    EncoderHarmonics,
    EncoderOffset,
    EncoderQuantisation,
    EncoderScale,
    FrameDrift,
    FrameRegistration,
    FrameScale,
    Outliers,
    Saturation,
    SensorOffset,
    SignError,
    TimeDelay,
    UnitError,
)
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.measurement import ClockError, Registration
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.outliers import drive_outliers
from flexarm.record import Clock, Frame

ENCODER = Sensor(name="hinge", quantity="joint_angle", joint="hinge", clock="controller", rate_hz=250)
TIP = Sensor(
    name="tip", quantity="position", point="tip", axes=("x", "z"), frame="tracker", clock="lan", rate_hz=10
)
EXAMPLES = [
    EncoderOffset(at="hinge", offset=2e-3),
    EncoderScale(at="hinge", scale=1.002),
    EncoderEccentricity(at="hinge", amplitude=2e-4, phase=0.4),
    EncoderQuantisation(at="hinge", step=1e-5),
    TimeDelay(at="tip", delay=0.004),
    ClockDrift(at="lan", rate=3e-5),
    FrameRegistration(at="tracker", translation=(1e-3, 0, -2e-3), rotation=(0, 5e-4, 0)),
    FrameDrift(at="tracker", velocity=(2e-7, 0, 1e-7)),
    DeadChannel(at="tip", channels=("x",), value=0.5),
    SignError(at="tip", channels=("z",)),
    UnitError(at="tip", factor=1000.0),
    Saturation(at="tip", limit=2.5),
    Outliers(at="tip", share=0.01, size=0.02),
    SensorOffset(at="tip", offset=(1e-3, 0.0, 2e-3)),
    EncoderHarmonics(at="hinge", order=3.0, amplitude=1e-4, phase=0.4),
    FrameScale(at="tracker", scale=1.0003),
]
ALL = paper_arm(1).replace(effects=tuple(EXAMPLES), sensors=(ENCODER, TIP))


@pytest.mark.parametrize("effect", EXAMPLES, ids=lambda effect: effect.name)
def test_an_effect_is_found_by_its_name_and_rebuilt_from_its_table(effect):
    table = effect.to_plain()
    assert effect_class(table.pop("name"))(**table) == effect
    again = type(effect)(**{**table, **{"at": effect.at}})
    values = {name: value for name, value, _ in effect.parameters()}
    assert again.with_parameters(values) == effect


@pytest.mark.parametrize("effect", EXAMPLES, ids=lambda effect: effect.name)
def test_every_parameter_has_a_prior_and_a_derivative(effect):
    priors = effect.priors(ALL)
    assert list(priors) == [name for name, _, _ in effect.parameters()]
    for name, value, unit in effect.parameters():
        assert priors[name].unit == unit
        assert priors[name].source
        assert priors[name].low < value < priors[name].high
    smooth = {effect.derivative(name) for name in priors} == {"smooth"}
    assert smooth == (effect.name not in ("encoder_quantisation", "saturation", "outliers", "sign_error"))


def test_a_model_with_every_effect_is_written_and_read(tmp_path):
    ALL.to_toml(tmp_path / "arm.toml")
    assert Arm.from_toml(tmp_path / "arm.toml") == ALL
    assert ALL.warnings == ()


def test_names_of_channels_are_no_parameters():
    assert EXAMPLES[9].parameters() == []
    assert [name for name, _, _ in EXAMPLES[8].parameters()] == ["value"]
    assert [name for name, _, _ in EXAMPLES[13].parameters()] == ["offset.x", "offset.y", "offset.z"]
    assert SensorOffset(at="torque", offset=3).parameters() == [("offset", 3.0, "SI")]
    with pytest.raises(InvalidParameter, match="has no parameter 'channels'; it has value"):
        EXAMPLES[8].with_parameters({"channels": 1.0})


# ------------------------------------------------------------------ where they act


def test_effects_act_at_the_signal_its_clock_and_its_frame():
    encoder, tip = effects_of(ALL, ENCODER), effects_of(ALL, TIP)
    assert [e.name for e in (*encoder.before, *encoder.after)] == [
        "encoder_scale",
        "encoder_eccentricity",
        "encoder_harmonics",
        "encoder_offset",
        "encoder_quantisation",
    ]
    assert (encoder.delay, encoder.rate) == (0, 0)
    assert (tip.delay, tip.rate) == (0.004, 3e-5)
    assert list(tip.translation) == [1e-3, 0, -2e-3]
    assert list(tip.rotation) == [0, 5e-4, 0]
    assert list(tip.velocity) == [2e-7, 0, 1e-7]
    assert tip.scale == 1.0003


def test_harmonics_add_a_sine_of_a_multiple_of_the_angle_and_are_taken_back():
    own = ALL.replace(effects=(EncoderHarmonics(at="hinge", order=3.0, amplitude=1e-2, phase=0.4),))
    seen, true = effects_of(own, ENCODER), np.linspace(-3, 3, 50)[:, None]
    reading = seen.reading(true)
    assert reading == pytest.approx(true + 1e-2 * np.sin(3 * true + 0.4))
    assert seen.true(reading) == pytest.approx(true, abs=1e-14)


def test_harmonics_that_turn_a_reading_back_are_refused():
    with pytest.raises(InvalidParameter, match=r"must keep amplitude x order below 1, got 0.4 rad x 3"):
        ALL.with_effect(EncoderHarmonics(at="hinge", order=3.0, amplitude=0.4))


def test_a_frame_scale_multiplies_positions_from_the_origin_of_the_frame():
    own = ALL.replace(effects=(FrameScale(at="tracker", scale=1.001),))
    frame = Registration(origin=(0.5, 0.0, 1.0), rpy=(0.0, 0.0, 0.3))
    places = np.array([[1.0, 2.0, 3.0], [0.5, 0.0, 1.0]])
    scaled = effects_of(own, TIP).registration(frame).positions(places)
    assert scaled == pytest.approx(1.001 * frame.positions(places))


def test_a_joint_or_point_of_the_same_name_is_another_place():
    """The encoder "hinge" and the point "tip": only effects of sensors count there, and others elsewhere."""
    stiff = ALL.with_effect(effect_class("joint_compliance")(at="hinge", stiffness=1e5))
    assert effects_of(stiff, ENCODER) == effects_of(ALL, ENCODER)


def test_the_order_is_not_that_of_the_file():
    backward = ALL.replace(effects=tuple(reversed(EXAMPLES)))
    true = np.linspace(-1, 1, 7)[:, None]
    assert np.array_equal(effects_of(backward, ENCODER).reading(true), effects_of(ALL, ENCODER).reading(true))


def test_delays_at_a_signal_and_at_its_clock_add_up_and_count_once_where_both_have_one_name():
    both = ALL.replace(effects=(TimeDelay(at="lan", delay=1e-3), TimeDelay(at="tip", delay=2e-3)))
    assert effects_of(both, TIP).delay == pytest.approx(3e-3)
    same = TIP.replace(name="lan")
    assert effects_of(both, same).delay == pytest.approx(1e-3)


def test_stamps_add_up_what_is_stated_and_what_the_model_has():
    """stamp = t + (r_1 + r_2)(t - t_0) + d_1 + d_2, from a start t_0 = 5 s."""
    tip = effects_of(ALL, TIP)
    t = np.linspace(5, 90, 11)
    clock = tip.clock(ClockError(delay=0.1, rate=1e-5, since=5.0), 5.0)
    np.testing.assert_allclose(clock.stamps(t), t + 4e-5 * (t - 5) + 0.104, rtol=1e-15)
    np.testing.assert_allclose(clock.instants(clock.stamps(t)), t, rtol=1e-15)
    zero = ClockError(delay=0.1, rate=1e-5)
    np.testing.assert_allclose(zero.counted_from(40.0).stamps(t), zero.stamps(t), rtol=1e-15)


def test_poses_have_no_time():
    """Numbers of poses are no stamps: neither clocks nor the velocity of a frame act."""
    posed = Signal(
        name="tip", quantity="position", point="tip", frame="tracker", clock="lan",
        values=np.zeros((1, 3)), pose=np.array(["a"]),
    )  # fmt: skip
    seen = effects_of(ALL.replace(effects=tuple(e for e in EXAMPLES if e.at in ("lan", "tracker"))), posed)
    assert (seen.delay, seen.rate, list(seen.velocity)) == (0, 0, [0, 0, 0])
    assert list(seen.translation) == [1e-3, 0, -2e-3]


# ---------------------------------------------------------------------- the laws


def test_the_encoders_law_is_that_of_the_vocabulary():
    """reading = scale true + offset + amplitudes sin(order true + phase), then rounded to the step."""
    true = np.linspace(-7, 7, 1001)
    law = 1.002 * true + 2e-3 + 2e-4 * np.sin(true + 0.4) + 1e-4 * np.sin(3 * true + 0.4)
    encoder = effects_of(ALL, ENCODER)
    np.testing.assert_allclose(encoder.reading(true[:, None], rounded=False)[:, 0], law, rtol=1e-15)
    np.testing.assert_allclose(
        encoder.reading(true[:, None])[:, 0], 1e-5 * np.round(law / 1e-5), rtol=0, atol=1e-14
    )


def test_readings_tell_true_angles():
    """The inverse is exact to rounding, also of an eccentricity of half the scale; it has one true angle."""
    true = np.linspace(-7, 7, 1001)[:, None]
    for amplitude in (2e-4, 0.5):
        model = ALL.with_effect(EncoderEccentricity(at="hinge", amplitude=amplitude, phase=0.4))
        encoder = effects_of(model, ENCODER)
        np.testing.assert_allclose(encoder.true(encoder.reading(true, rounded=False)), true, atol=5e-15)
    turning = ALL.with_effect(EncoderEccentricity(at="hinge", amplitude=0.999))
    turning = turning.with_effect(EncoderScale(at="hinge", scale=0.5))
    encoder = effects_of(turning, ENCODER)
    with pytest.raises(InvalidParameter, match="amplitude must be less than the encoder's scale"):
        encoder.true(encoder.reading(true))


def test_faults_act_on_the_channels_that_they_name_in_the_order_of_a_sensor():
    """z: (1.5 + 0.002) clipped to 1.2, flipped, in mm; x: dead, whatever it was."""
    true = np.array([[0.7, 1.5], [0.8, -0.4]])
    model = ALL.with_effect(Saturation(at="tip", limit=1.2))
    reading = effects_of(model, TIP).reading(true)
    np.testing.assert_allclose(reading, [[0.5, -1200.0], [0.5, 398.0]], rtol=1e-15)
    back = effects_of(model, TIP).true(reading)
    assert np.isnan(back[:, 0]).all() and np.isnan(back[0, 1])  # dead; at the end of its range
    assert back[1, 1] == pytest.approx(-0.4, abs=1e-15)


def test_an_offset_of_three_numbers_counts_along_the_axes_that_are_measured():
    seen = effects_of(ALL.replace(effects=(SensorOffset(at="tip", offset=(1, 2, 3)),)), TIP)
    assert seen.reading(np.zeros((1, 2))).tolist() == [[1, 3]]
    one = SensorOffset(at="tip", offset=5, channels=("z",))
    seen = effects_of(ALL.replace(effects=(one,)), TIP)
    assert seen.reading(np.zeros((1, 2))).tolist() == [[0, 5]]


def test_a_unit_error_scales_the_noise_too_and_quantisation_adds_to_it():
    assert effects_of(ALL, TIP).noise(5e-5) == pytest.approx([5e-2, 5e-2])
    assert effects_of(ALL, ENCODER).noise(3e-6) == pytest.approx([np.hypot(3e-6, 1e-5 / np.sqrt(12))])


def test_a_frame_adds_translations_rotations_and_velocities():
    frame = effects_of(ALL, TIP).registration(Registration((1, 1, 1), (0, 1e-4, 0), origin=(3, 0, 0)))
    np.testing.assert_allclose(frame.translation, [1.001, 1, 0.998])
    np.testing.assert_allclose(frame.rotation, [0, 6e-4, 0])
    late = frame.positions(np.zeros((1, 3)), np.array([100.0])) - frame.positions(np.zeros((1, 3)))
    np.testing.assert_allclose(late, [[1.0003 * 2e-5, 0, 1.0003 * 1e-5]], atol=1e-14)
    assert frame.origin == (3, 0, 0)


def test_outliers_are_told_apart_where_their_density_is_the_greater_one():
    """Both terms of the mixture, written out, at residuals of two channels around the limit."""
    effect, noise = Outliers(at="tip", share=0.02, size=1e-3), np.array([5e-5, 1e-4])
    r = np.random.default_rng(2).normal(size=(400, 2)) * 4e-4

    def density(spread):
        return np.prod(np.exp(-0.5 * (r / spread) ** 2) / spread, axis=1)

    contaminated = 0.02 * density(np.hypot(noise, 1e-3)) > 0.98 * density(noise)
    assert 50 < contaminated.sum() < 350
    assert np.array_equal(effect.told_apart(r, noise), contaminated)


# -------------------------------------------------------------------- what is refused


@pytest.mark.parametrize(
    ("kind", "keys", "message"),
    [
        (EncoderScale, {"scale": 0.0}, "scale: must be positive, got 0"),
        (EncoderEccentricity, {"amplitude": 1.5}, "amplitude: must be less than 1, got 1.5"),
        (EncoderQuantisation, {"step": -1e-6}, "step: must be .* got -1e-06"),
        (ClockDrift, {"rate": 2.0}, "rate: must be less than 0.5, got 2"),
        (FrameDrift, {"velocity": [1, 2]}, "velocity: must be a list of 3 numbers"),
        (SensorOffset, {"offset": [1.0, 2.0]}, "offset: must be a number, or a list of 3 numbers"),
        (SensorOffset, {"offset": "1"}, "offset: must be a number, or a list of 3 numbers"),
        (Outliers, {"share": 0.7}, "share: must be less than 0.5, got 0.7"),
        (UnitError, {"factor": 0.0}, "factor: must not be zero, got 0"),
        (SignError, {"channels": ["x", "x"]}, "channels: must name no channel twice"),
        (SignError, {"factor": 2}, "factor"),
    ],
)
def test_values_that_cannot_be_are_named(kind, keys, message):
    with pytest.raises(InvalidParameter, match=message):
        kind(at="tip", **keys)


@pytest.mark.parametrize(
    ("effect", "message"),
    [
        (EncoderScale(at="tip"), r"effects\.encoder_scale.*acts on joint_angle, but 'tip' measures position"),
        (SignError(at="tip", channels=("y",)), "names channel 'y'; 'tip' has x, z"),
        (DeadChannel(at="hinge", channels=("x",)), "'hinge' has only one, without a name"),
        (SensorOffset(at="hinge", offset=(1, 2, 3)), "needs one number as offset"),
    ],
)
def test_an_effect_that_cannot_act_on_its_signal_is_refused(effect, message):
    """At once where the model has a sensor of that name, else with the record that has such a signal."""
    with pytest.raises(InvalidParameter, match=message.rpartition("*")[2]):
        ALL.with_effect(effect)
    blind = paper_arm(1).with_effect(effect)
    signal = Signal(
        name="tip", quantity="position", point="tip", axes=("x", "z"), values=np.zeros((1, 2)), time=[0]
    )
    angle = Signal(name="hinge", quantity="joint_angle", joint="hinge", values=[0.0], time=[0.0])
    with pytest.raises(InvalidParameter, match=message):
        effects_of(blind, signal if effect.at == "tip" else angle)


def test_a_file_is_told_where_an_effect_is_wrong(tmp_path):
    ALL.to_toml(tmp_path / "arm.toml")
    text = (tmp_path / "arm.toml").read_text().replace("scale = 1.002", "scale = -1.0")
    (tmp_path / "arm.toml").write_text(text)
    with pytest.raises(InvalidFile, match=r"arm\.toml: .*encoder_scale.*scale.*must be positive, got -1"):
        Arm.from_toml(tmp_path / "arm.toml")


def test_a_place_that_no_sensor_has_is_a_doubt():
    """Not an error: clocks, frames and signals belong to records, of which a model may serve several."""
    lost = ALL.replace(effects=(TimeDelay(at="traker"), FrameDrift(at="lan"), SignError(at="tracker")))
    doubts = {problem.where: problem.what for problem in lost.warnings}
    assert list(doubts) == [
        "effects.time_delay.traker",
        "effects.frame_drift.lan",
        "effects.sign_error.tracker",
    ]
    assert "no sensor has the frame 'lan', they have base, tracker" in doubts["effects.frame_drift.lan"]
    assert lost.replace(sensors=()).warnings == ()


def test_a_place_that_a_record_has_not_is_a_doubt_about_the_record():
    record = Record(
        signals=[
            Signal(name="encoder", quantity="joint_angle", joint="hinge", values=[0.0, 0.1], time=[0, 1],
                   clock="controller", noise_std=1e-6, side="motor")
        ],
        drive="encoder",
        clocks={"controller": Clock()},
        frames={"tracker": Frame()},
    )  # fmt: skip
    effects = (
        TimeDelay(at="controller"),
        FrameDrift(at="tracker"),
        EncoderOffset(at="encoder"),
        ClockDrift(at="contoller"),
        FrameRegistration(at="encoder"),
    )
    doubts = record.check_against(paper_arm(1).replace(effects=effects))
    assert [doubt.where for doubt in doubts] == [
        "effects.clock_drift.contoller",
        "effects.frame_registration.encoder",
    ]
    assert "no signal or clock 'contoller'; there are encoder, controller" in doubts[0].what


def test_two_joints_have_encoders_of_their_own():
    arm = arm_of(
        joints=[hinge("shoulder", "upper"), hinge("elbow", "lower", "upper", at="end")],
        links=[beam("upper", [0, 0, 1], general(1e-3, 1e-6)), beam("lower", [0, 0, 1], general(1e-3, 1e-6))],
        points=[point("tip", "lower", [0, 0, 1])],
        effects=[{"name": "encoder_offset", "at": "elbow", "offset": 0.01}],
    )
    for joint, offset in (("shoulder", 0.0), ("elbow", 0.01)):
        encoder = Sensor(name=joint, quantity="joint_angle", joint=joint, rate_hz=10)
        assert effects_of(arm, encoder).reading(np.zeros((1, 1))).item() == offset


def test_outliers_of_a_moving_drive_are_found_and_cost_their_neighbours_at_most():
    """Planted 1 mrad off samples that move by up to 3 mrad from one to the next, with a gap."""
    rng = np.random.default_rng(8)
    t = np.arange(0, 20, 0.004)
    samples = 0.7 * np.sin(1.1 * t) + 1.5e-6 * rng.standard_normal(len(t))
    planted = rng.choice(len(t), 40, replace=False)
    samples[planted] += 1e-3 * rng.choice([-1.0, 1.0], 40)
    samples[1000:1200] = np.nan
    found = drive_outliers(samples, 1.5e-6, Outliers(at="hinge", share=0.01, size=1e-3))
    seen = np.setdiff1d(planted, np.arange(1000, 1200))
    assert found[seen].all()
    assert not found[1000:1200].any()
    near = np.unique([planted + k for k in range(-3, 4)])
    far = np.setdiff1d(np.flatnonzero(found), [*near, *range(997, 1000), *range(1200, 1203)])
    assert len(far) <= 5  # of 4600 samples: 4 sigma of the predictions' own noise
    assert not drive_outliers(samples[:6], 1.5e-6, Outliers(at="hinge", share=0.01, size=1e-3)).any()
