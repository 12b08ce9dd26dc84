"""What an arm swings with when its record begins: fitted along, whatever it was, and told."""

import numpy as np
import pytest
from arms import crane, smooth_step, tracker
from diagnoses import SENSORS

import flexarm
from flexarm.diagnosis.design.experiment import from_record
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.naming import transient_remarks
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import NOISE_MODEL
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.record_conditions import initial_condition_jacobian
from flexarm.diagnosis.uncertainty import estimates
from flexarm.drive.lead_in import LEAD
from flexarm.record import Clock, Frame
from flexarm.validation.sensor_check import check

CUT = 8.0
"""When the record begins [s]; the motor jerks a second before."""


def angle(t):
    """A swing of 0.3 rad in 10 s, and a jerk of 2 mrad in 0.2 s that no record tells of."""
    s = np.clip((t - (CUT - 1.0)) / 0.2, 0.0, 1.0)
    return 0.3 * np.sin(2 * np.pi * t / 10.0) * smooth_step(t / 4.0) + 2e-3 * 64 * (s * (1 - s)) ** 3


@pytest.fixture(scope="module")
def problem():
    """What a tracker saw of it from `CUT` on, beside the model that was the machine."""
    t = np.arange(0.0, 20.0, 0.01)
    run = flexarm.simulate(crane(), flexarm.Drive.from_samples(t, {"hinge": angle(t)}), step=2e-3)
    known = {"clocks": {"controller": Clock(), "tracker": Clock()}, "frames": {"tracker": Frame()}}
    sensors = [SENSORS[0], tracker("tip", rate_hz=20)]
    seen = flexarm.measure(run, sensors, np.random.default_rng(4), drive=["hinge"], **known)
    late = []
    for signal in seen.signals.values():
        kept = signal.time >= CUT
        late.append(signal.replace(time=signal.time[kept], values=signal.values[kept]))
    return Problem(crane(), {"late": seen.replace(signals=late, initial="moving")}, step=4e-3)


@pytest.fixture(scope="module")
def fit(problem):
    return Estimator.nominal(problem, nuisance_model(problem)).fit(())


def test_nothing_but_noise_is_left_of_what_the_right_model_rings_with(problem, fit):
    """However it was excited: eight times the noise without it."""
    count = len(problem)
    assert np.sum(fit.residual**2) > 20 * count
    assert fit.cost == pytest.approx(count, abs=5 * np.sqrt(2 * count))


def test_one_joint_needs_two_jerks_a_mode_that_is_seen(problem):
    """Modes across the plane of motion are seen by nothing, and phases are two."""
    assert {start.joint for start in problem.initial_conditions} == {"hinge"}
    widths = [start.width for start in problem.initial_conditions]
    assert 2 <= len(widths) <= 4
    assert max(widths.count(width) for width in widths) == 2


def test_columns_are_in_proportion(problem):
    """A jerk twenty times as high moves all signals as much more, within a thousandth."""
    start = problem.initial_conditions[0]
    [column] = initial_condition_jacobian(problem, problem.arm, [start]).T
    finer = problem.with_step(problem.step / NOISE_MODEL.jerk_finer)
    high = finer.residual(problem.arm).copy()
    finer.write_residual(
        high, "late", finer.simulations.with_pulse(start, problem.arm, 20 * NOISE_MODEL.jerk_step)
    )
    move = (high - finer.residual(problem.arm)) / (20 * NOISE_MODEL.jerk_step)
    assert np.linalg.norm(move - column) < 1e-3 * np.linalg.norm(column)


def test_it_is_told_and_is_no_value_of_the_model(problem, fit):
    found = estimates(fit, problem)
    assert not found.nuisances
    assert not found.refined
    [sentence] = transient_remarks(fit, problem)
    assert sentence.startswith("late begins with the arm swinging, by up to")
    assert " mm at tip" in sentence


def test_records_that_begin_at_rest_have_none(problem):
    [record] = problem.records.values()
    still = Problem(crane(), {"late": record.replace(initial="equilibrium")}, step=4e-3)
    assert still.initial_conditions == ()


def test_a_record_that_says_rest_and_begins_in_motion_is_told(problem):
    """The run would ring with a jump of the rate that the arm never saw."""
    [record] = problem.records.values()
    [remark] = check(crane(), {"late": record.replace(initial="equilibrium")}).remarks
    assert remark.startswith("late: hinge moves in the first sample, at ")
    assert remark.endswith('state initial = "moving"')
    assert not check(crane(), {"late": record}).remarks
    notes = flexarm.compare(crane(), record.replace(initial="equilibrium"), step=4e-3).notes
    assert remark.removeprefix("late: ") in notes


def test_an_experiment_made_once_more_begins_in_motion_too(problem):
    """At twice the speed it is led in within half the time; the rise has the speed of what follows."""
    [record] = problem.records.values()
    again = from_record("again", record, crane())
    assert again.record(crane(), 4e-3, -0.05).initial == "moving"
    faster = again.faster(2.0).drive
    assert faster.lead == LEAD / 2
    motion = faster.joints["hinge"].polynomial()
    assert list(motion(faster.start - faster.lead)[1:]) == pytest.approx([0.0, 0.0], abs=1e-12)
    assert abs(motion(faster.start)[1]) > 0.1


def test_records_that_are_not_observed_have_no_rows(problem):
    """An experiment that is planned asks for the columns of the data at hand."""
    [record] = problem.records.values()
    other = Problem(crane(), {"other": record.replace(initial="equilibrium")}, step=4e-3)
    assert not initial_condition_jacobian(other, crane(), problem.initial_conditions).any()
    assert not other.jacobian(crane(), [problem.initial_conditions[0].key]).any()
