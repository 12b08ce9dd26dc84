"""Frequencies at which a gap swings."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.diagnosis.candidates import dominant_frequencies

RNG = np.random.default_rng(8)


def problem(*times):
    rows, start = [], 0
    for time in times:
        rows.append(SimpleNamespace(record="run", time=time, where=slice(start, start + len(time))))
        start += len(time)
    seconds = max(float(np.ptp(time)) for time in times)
    return SimpleNamespace(rows=rows, records={"run": SimpleNamespace(kind="motion")}, seconds=seconds)


def test_a_wave_is_found_within_a_quarter_of_a_peak():
    time = np.sort(RNG.uniform(0, 40, 400))
    rest = 3 * np.sin(2 * np.pi * 2.31 * time) + RNG.normal(size=400)
    assert dominant_frequencies(rest, problem(time))[0] == pytest.approx(2.31, abs=0.25 / 40)


def test_a_fast_signal_tells_a_frequency_from_its_alias_in_a_slow_one():
    """7.2 Hz looks like 2.8 Hz at 10 Hz; at 50 Hz it does not."""
    slow, fast = np.arange(0, 40, 0.1), np.arange(0, 40, 0.02)
    rest = np.concatenate([np.sin(2 * np.pi * 7.2 * t) + 0.3 * RNG.normal(size=len(t)) for t in (slow, fast)])
    assert dominant_frequencies(rest, problem(slow, fast))[0] == pytest.approx(7.2, abs=0.02)


def test_poses_have_no_rhythm():
    poses = problem(np.arange(5.0))
    poses.records["run"].kind, poses.seconds = "static", 0.0
    assert dominant_frequencies(np.ones(5), poses) == []
