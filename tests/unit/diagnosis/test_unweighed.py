"""Claims about signals that no model predicts, of which no noise is stated, or that no fit sees."""

import diagnoses
import numpy as np
import pytest

from flexarm import Record, Signal
from flexarm.comparison import compare
from flexarm.diagnosis.naming import noise_remarks, payload_remarks, unfitted_remarks
from flexarm.diagnosis.problem import Problem
from flexarm.record import CarriedPayload
from flexarm.validation.sensor_check import check


def changed(record: Record, name: str, **changes: object) -> Record:
    """The record with another signal of that name."""
    return record.replace(signals={**record.signals, name: record.signals[name].replace(**changes)})


def voltage(record: Record, **stamps: np.ndarray) -> Record:
    """The record with the voltage of a motor, of which the model has none."""
    count = len(next(iter(stamps.values())))
    signal = Signal(
        name="volts", quantity="motor_voltage", joint="hinge", values=np.ones(count), noise_std=0.1, **stamps
    )
    return record.replace(signals={**record.signals, "volts": signal})


@pytest.fixture(scope="module")
def silent() -> Record:
    """A tracker of unknown noise."""
    return changed(diagnoses.record(1), "tip", noise_std=None)


def test_a_signal_that_the_model_does_not_predict_is_told_once_with_its_reason():
    records = {
        name: voltage(diagnoses.record(seed), time=np.linspace(0, 12, 50))
        for name, seed in (("a", 1), ("b", 3))
    }
    told = [remark for remark in check(diagnoses.nominal(), records).remarks if "volts" in remark]
    assert told == [
        "a and b: volts is not compared: (motor_voltage) needs motor voltage, which this simulation does not "
        "hold"
    ]


def test_a_signal_without_a_value_is_told_once():
    empty = changed(
        diagnoses.record(1), "tip", values=np.full((len(diagnoses.record(1).signals["tip"]), 2), np.nan)
    )
    both = diagnoses.record(1)
    tip = empty.signals["tip"].replace(name="other")
    told = check(diagnoses.nominal(), {"a": both.replace(signals={**both.signals, "other": tip})}).remarks
    assert [remark for remark in told if "other" in remark] == [
        "a: other is not compared: no row holds a value in every channel"
    ]


def test_a_comparison_says_what_is_not_aligned_where_nothing_can_be(silent):
    """Clock and frame have sigmas, and no signal that could be weighed against them."""
    found = compare(diagnoses.nominal(), silent)
    assert found.aligned.parameters == ()
    assert "no noise is stated for tip: not used to align clock tracker and frame tracker" in found.notes


def test_a_diagnosis_says_which_noise_counts_and_what_is_not_aligned(silent):
    """Second differences of a gap of centimetres show little more than the noise of 50 um."""
    [told] = noise_remarks(Problem(diagnoses.with_spring(), {"a": silent}))
    assert told.startswith("no noise is stated for tip: the ")
    size = float(told.split("the ")[1].split()[0])
    assert "µm that its values show" in told and 35 < size < 100
    assert told.endswith("not aligned by it, in clock tracker and frame tracker")
    assert list(noise_remarks(Problem(diagnoses.with_spring(), {"a": diagnoses.record(1)}))) == []


def test_a_signal_of_which_nothing_is_fitted_is_told():
    """Seven rows without a stated noise do not show it."""
    full = diagnoses.record(1)
    few = full.signals["tip"]
    few = few.replace(name="few", values=few.values[:7], time=few.time[:7], noise_std=None)
    problem = Problem(diagnoses.with_spring(), {"a": full.replace(signals={**full.signals, "few": few})})
    assert list(unfitted_remarks(problem, {"a": ("tip", "few")})) == [
        "a: few is not fitted: no noise is stated, and its values are too few or too even to show it"
    ]


def test_a_mass_that_the_records_state_is_believed_and_that_is_said():
    """Two campaigns that wrote 5 kg for 6.5 kg were told as a load off its centre."""
    arm = diagnoses.nominal().replace(uncertainty={"payloads.load.mass": 0.05})
    weighing = diagnoses.record(1).replace(payloads={"load": CarriedPayload(mass=5.0)})
    [said] = payload_remarks(Problem(arm, {"a": weighing}, step=0.01))
    assert said.startswith(
        "the mass of load is what the records state, and its uncertainty in the model has no part"
    )
    assert list(payload_remarks(Problem(arm, {"a": diagnoses.record(1)}, step=0.01))) == []
