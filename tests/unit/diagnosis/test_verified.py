"""What a repair is verified with: records beside models, simulated as the diagnosis was told to."""

import numpy as np
import pytest
from diagnoses import nominal, record, with_spring

from flexarm.comparison.compare import compare
from flexarm.diagnosis import verification
from flexarm.diagnosis.verification import SplitRecords
from flexarm.validation import initial_alignment as runs
from flexarm.validation.sensor_check import check


def test_records_are_simulated_with_the_damping_that_they_are_given():
    records = SplitRecords({"swing": record(1)}, {}, step=0.01, alpha=0.0, jobs=1)
    [seen] = records.aligned(nominal()).values()
    assert (seen.simulated.simulation.solver["step"], seen.simulated.simulation.solver["alpha"]) == (
        0.01,
        0.0,
    )


def test_the_gap_of_a_run_is_that_of_a_comparison():
    records = SplitRecords({"swing": record(1)}, {"other": record(2)}, step=0.01, alpha=0.0, jobs=1)
    found = records.gaps(nominal())
    assert found.keys() == {"swing", "other"}
    assert str(found["other"]) == str(compare(nominal(), record(2), step=0.01, alpha=0.0))


def test_gaps_before_and_after_are_split_in_the_same_bands():
    """A spring lowers the first mode, about which `compare` lays the bands of the softer model."""
    records = SplitRecords({"swing": record(1)}, {}, step=0.01, alpha=0.0, jobs=1)
    found = verification.verified(records, nominal(), with_spring(), [], [], open_gap=False)
    own = compare(with_spring(), record(1), step=0.01, alpha=0.0)
    before, after, alone = (
        each.signals["tip"].bands for each in (found.before["swing"], found.after["swing"], own)
    )
    edges = [np.array([(band.low, band.high) for band in bands]) for bands in (before, after)]
    assert edges[1] == pytest.approx(edges[0])  # of instants by clocks that differ by a rounding
    assert [band.high for band in alone][:-1] != [band.high for band in before][:-1]
    assert sum(band.rms**2 for band in after) == pytest.approx(sum(band.rms**2 for band in alone))


def test_a_verification_simulates_and_aligns_a_record_once_for_a_model(monkeypatch):
    runs = []

    def simulate_record(model, record, **options):
        runs.append((model, id(record)))
        return whole(model, record, **options)

    whole = verification.simulate_record
    monkeypatch.setattr(verification, "simulate_record", simulate_record)
    records = SplitRecords({"swing": record(1)}, {"other": record(2)}, step=0.01, alpha=0.0, jobs=1)
    arm = nominal()
    records.training_gaps(arm)
    verification.verified(records, arm, arm.replace(name="updated"), [], [], open_gap=True)
    assert len(runs) == len(set(runs)) == 4


def test_a_check_simulates_with_the_damping_that_it_is_given(monkeypatch):
    """Its hypotheses too: here an encoder counts the other way."""
    used = set()

    def simulate_all(*args, alpha, **options):
        used.add(alpha)
        return whole(*args, alpha=alpha, **options)

    whole = runs.simulate_all
    monkeypatch.setattr(runs, "simulate_all", simulate_all)
    hinge = record(1).signals["hinge"]
    flipped = record(1).replace(signals={**record(1).signals, "hinge": hinge.replace(values=-hinge.values)})
    found = check(nominal(), {"swing": flipped}, step=0.01, alpha=0.0)
    assert [fault.name for fault in found.faults] == ["sign_error"]
    assert used == {0.0}
