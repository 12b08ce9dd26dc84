"""Claims about bands: energies add up, and a tone lies in its own band, however the samples fall."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexarm.comparison.bands import alias, band_edges, band_parts, band_split


def stamps(kind, count=360, rate=10.0, seed=0):
    rng = np.random.default_rng(seed)
    t = np.arange(count) / rate
    if kind == "drop-outs":
        t = t[rng.random(count) > 0.03]
    if kind == "jitter":
        t = t + rng.uniform(-0.05, 0.05, count) / rate
    return t


@pytest.mark.parametrize("kind", ["even", "drop-outs", "jitter"])
@pytest.mark.parametrize(("frequency", "band"), [(0.05, 0), (2.5, 1)])
def test_a_tone_lies_in_its_band(kind, frequency, band):
    t = stamps(kind)
    tone = np.sin(2 * np.pi * frequency * t + 0.4)[:, None]
    found = band_split(t, tone, [0, 1.25, 4.0, 5.0])
    leaked = sum(b.rms**2 for i, b in enumerate(found) if i != band)
    assert leaked < 0.04 * np.mean(tone**2)


def test_a_tone_near_nyquist_stays_in_the_last_band_of_even_samples():
    t = stamps("even")
    tone = np.sin(2 * np.pi * 4.6 * t)[:, None]
    assert band_split(t, tone, [0, 1.25, 4.0, 5.0])[2].rms ** 2 > 0.97 * np.mean(tone**2)


@given(
    count=st.integers(2, 400),
    seed=st.integers(0, 999),
    kind=st.sampled_from(["even", "drop-outs", "jitter"]),
    inner=st.lists(st.floats(0.05, 4.9), max_size=3, unique=True),
)
@settings(max_examples=60, deadline=None)
def test_squares_of_bands_add_up_to_the_mean_square(count, seed, kind, inner):
    t = stamps(kind, count, seed=seed)
    if len(t) < 2:
        return
    values = np.random.default_rng(seed).standard_normal((len(t), 2)) + 3.0
    found = band_split(t, values, band_edges(t, [], inner))
    assert sum(band.rms**2 for band in found) == pytest.approx(np.sum(values**2) / len(t), rel=1e-9)
    assert all(band.rms >= 0 for band in found)


@pytest.mark.parametrize("kind", ["even", "drop-outs"])
def test_noise_spreads_evenly_over_the_bands(kind):
    """Energy in proportion to the width of the band: 1.25, 2.75 and 1 of 5 Hz; five sigma of a chi-square."""
    t = stamps(kind, count=4000)
    values = np.random.default_rng(1).standard_normal((len(t), 1))
    for band in band_split(t, values, [0, 1.25, 4.0, 5.0]):
        share = (band.high - band.low) / 5.0
        assert band.rms**2 == pytest.approx(share, rel=5 * np.sqrt(2 / (share * len(t))) + 0.02)


def test_edges_follow_the_first_mode_up_to_nyquist():
    assert band_edges(np.arange(100) / 10, [2.0, 25.0]) == pytest.approx([0, 1.0, 4.0, 5.0])
    assert band_edges(np.arange(100) / 3.0, [2.0]) == pytest.approx([0, 1.0, 1.5])
    assert band_edges(np.arange(100) / 10, []) == pytest.approx([0, 0.625, 2.5, 5.0])
    assert band_edges(np.array([1.0]), [2.0]) == []


def test_aliases_fold_at_half_the_rate():
    assert alias(2.5, 2.3) == pytest.approx(0.2)
    assert alias(2.5, 10.0) == pytest.approx(2.5)
    assert alias(9.0, 10.0) == pytest.approx(1.0)


def test_stamps_that_a_file_rounds_are_equally_spaced():
    """A clock of 1 kHz in a file with microseconds: the split is that of the true stamps."""
    time = np.linspace(0.0, 5.0, 5000)  # 1.0002 ms apart
    values = np.column_stack([np.sin(2 * np.pi * 3 * time), np.cos(2 * np.pi * 90 * time)])
    edges = [0.0, 10.0, 100.0, 499.9]
    true, rounded = (band_split(t, values, edges) for t in (time, np.round(time, 6)))
    assert [band.rms for band in rounded] == [band.rms for band in true]
    whole, parts = (band_parts(t, values, edges)[0] for t in (time, np.round(time, 6)))
    assert np.array_equal(whole, parts)
