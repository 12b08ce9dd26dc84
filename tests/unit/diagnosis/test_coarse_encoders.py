"""Encoders whose steps no record tells of: seen in readings, and counted as noise of what they drive."""

import numpy as np
import pytest
from planted import run_of

import flexarm
from flexarm import Record, Signal
from flexarm.comparison.drive_outliers import clean_drives
from flexarm.diagnosis.coarse_encoders import coarse_encoders, with_coarse_encoders
from flexarm.diagnosis.problem import Problem
from flexarm.record.quantisation_grid import quantisation_step

STEP, ENCODER_NOISE = 8e-4, 2e-6


def read(step, noise=ENCODER_NOISE, seed=2):
    """A record whose encoder has noise and then rounds, and what it drives has noise."""
    shown = run_of("one joint").showing({}, seed).record
    encoder = shown.signals["hinge encoder"]
    noisy = encoder.values + noise * np.random.default_rng(seed).standard_normal(encoder.values.shape)
    values = np.round(noisy / step) * step if step else noisy
    encoder = encoder.replace(values=values, noise_std=noise)
    return shown.replace(signals=[encoder, *(s for s in shown.signals.values() if s.name != encoder.name)])


@pytest.mark.parametrize("scale", [1.0, 1 / 120, np.pi / 180])
def test_the_step_of_a_lattice_is_found_in_any_unit(scale):
    counts = np.round(900 * np.sin(np.arange(0, 20, 0.004)))
    assert quantisation_step(counts * 7e-4 * scale) == pytest.approx(7e-4 * scale, rel=1e-9)


def test_readings_that_are_not_rounded_are_on_no_lattice():
    rng = np.random.default_rng(3)
    wave = np.sin(np.arange(0, 20, 0.004))
    assert quantisation_step(wave + 1e-6 * rng.standard_normal(len(wave))) == 0.0
    assert quantisation_step(np.full(50, 0.3)) == 0.0  # nothing moves: nothing is known of steps
    assert quantisation_step(np.array([np.nan, 0.1])) == 0.0


def test_what_a_record_states_or_a_model_knows_is_not_found_again():
    arm, record = run_of("one joint").simulation.arm, read(STEP)
    (found,) = coarse_encoders(arm, {"run": record})
    assert (found.at, found.step) == ("hinge encoder", pytest.approx(STEP, rel=1e-6))
    assert coarse_encoders(arm.with_effect(found), {"run": record}) == ()
    encoder = record.signals["hinge encoder"].replace(noise_std=STEP / np.sqrt(12))
    told = [encoder, *(s for s in record.signals.values() if s.name != encoder.name)]
    assert coarse_encoders(arm, {"run": record.replace(signals=told)}) == ()
    assert coarse_encoders(arm, {"run": read(0.0)}) == ()


def test_the_noise_that_steps_add_is_what_they_leave():
    """Without it residuals are many in places; with it hardly one and no less than a quarter, as of four
    roundings the largest error counts, twice."""
    arm = run_of("one joint").simulation.arm
    problem = Problem(arm, {"run": read(STEP)}, step=4e-3)
    noisier, (encoder,) = with_coarse_encoders(problem, seed=0)
    assert encoder.effect.step == pytest.approx(STEP, rel=1e-6)

    def left(of):
        residual = of.residual(of.arm)
        return {(r.signal, r.channel): np.sqrt(np.mean(residual[r.where] ** 2)) for r in of.rows}

    before, after = left(problem), left(noisier)
    assert before["tip", 0] > 5
    assert 0.25 < after["tip", 0] < 1.2
    named = encoder.named(0.9)
    assert (named.name, named.at) == ("encoder_quantisation", "hinge encoder")
    assert named.parameters[0].low90 < STEP < named.parameters[0].high90


@pytest.mark.parametrize("encoder", ["hinge encoder", "another encoder"])
def test_poses_beside_the_motion_have_no_part_in_it(encoder):
    """They state no noise of the encoder, or have another one: the motion alone tells of its steps."""
    arm, motion = run_of("one joint").simulation.arm, read(STEP)
    names = np.array(["a", "b", "c"])
    angle = Signal(name=encoder, quantity="joint_angle", joint="hinge", values=[-0.4, 0.3, 0.9], pose=names)
    tip = motion.signals["tip"].replace(time=None, pose=names, values=np.ones((3, 2)))
    static = Record(kind="static", drive=(encoder,), signals=[angle, tip])
    alone, [found] = with_coarse_encoders(Problem(arm, {"run": motion}, step=1e-2), seed=0)
    beside, [same] = with_coarse_encoders(Problem(arm, {"run": motion, "poses": static}, step=1e-2), seed=0)
    assert same == found
    assert [rows.sigma for rows in beside.rows if rows.record == "run"] == [r.sigma for r in alone.rows]
    assert {rows.sigma for rows in beside.rows if rows.record == "poses"} == {tip.noise_std}


def test_steps_that_nothing_shows_are_left_alone():
    """Of 4 urad, eight times the noise of the encoder: all moves by less than half of its own noise."""
    arm = run_of("one joint").simulation.arm
    problem = Problem(arm, {"run": read(4e-6, noise=5e-7)}, step=4e-3)
    assert len(coarse_encoders(arm, problem.records)) == 1
    assert with_coarse_encoders(problem, seed=0) == (problem, ())


def test_counts_of_a_slow_drive_are_no_outliers():
    """Near the edge of a count noise flips single readings while nothing else moves; a false one still is."""
    slow = read(STEP).signals["hinge encoder"]
    time = slow.time
    flicker = 0.05 * np.random.default_rng(4).standard_normal(len(time))
    counts = np.round(0.01 * np.sin(0.4 * time) / STEP + flicker)
    record = read(STEP)

    def driven(counts):
        encoder = slow.replace(values=(counts * STEP)[:, None])
        return record.replace(signals={**record.signals, encoder.name: encoder})

    assert clean_drives("run", driven(counts))[1] == []
    false = np.zeros_like(counts)
    false[len(false) // 2] = 60
    [removed] = clean_drives("run", driven(counts + false))[1]
    assert removed.rows == (len(false) // 2,)


@pytest.mark.slow
def test_a_diagnosis_that_names_steps_is_saved_with_them(tmp_path):
    """The repaired model smooths its drive by the steps, and that is a stage of its own in the report."""
    arm = run_of("one joint").simulation.arm
    found = flexarm.diagnose(arm, {"a": read(STEP, seed=2), "b": read(STEP, seed=3)}, n_jobs=1)
    assert (found.verdict, [e.name for e in found.effects]) == ("effects", ["encoder_quantisation"])
    found.save(tmp_path / "out")
    effect = flexarm.Arm.from_toml(tmp_path / "out" / "updated.toml").effect(
        "encoder_quantisation", "hinge encoder"
    )
    assert effect.step == pytest.approx(STEP, rel=1e-3)
    nominal, smoothed = found.stages[:2]
    assert smoothed.label == "encoder_quantisation at hinge encoder"
    assert all(smoothed.rms[name] < 0.8 * nominal.rms[name] for name in found.training)
    assert "encoder_quantisation-hinge-encoder.png" in {p.name for p in (tmp_path / "out").iterdir()}


def test_a_record_in_which_the_joint_rests_tells_nothing_of_steps():
    """It has one count, which contradicts no step that another record shows."""
    arm, record = run_of("one joint").simulation.arm, read(STEP)
    encoder = record.signals["hinge encoder"]
    still = encoder.replace(values=np.full_like(encoder.values, encoder.values[0]))
    resting = record.replace(signals=[still, *(s for s in record.signals.values() if s.name != encoder.name)])
    (found,) = coarse_encoders(arm, {"rest": resting, "run": record})
    assert found.step == pytest.approx(STEP, rel=1e-6)
    assert coarse_encoders(arm, {"rest": resting}) == ()
