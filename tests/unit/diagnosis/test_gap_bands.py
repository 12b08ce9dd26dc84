"""Claims about named bands: they cover all frequencies once, and say where a mode appears folded."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flexarm.comparison.bands import alias, band_parts, band_split
from flexarm.residual_analysis.spectrum import named_bands


def names(bands, frequency):
    """What lies at a frequency."""
    return [name for low, high, name in bands if low <= frequency < high]


@given(
    modes=st.lists(st.floats(0.2, 60.0), max_size=3, unique=True).map(sorted),
    rate=st.floats(1.0, 100.0),
)
@settings(max_examples=200, deadline=None)
def test_bands_cover_all_frequencies_without_gaps(modes, rate):
    bands, _ = named_bands(modes, rate)
    assert bands[0][0] == 0
    assert bands[-1][1] == pytest.approx(rate / 2)
    for (_, high, _), (low, _, _) in pairwise(bands):
        assert low == high
    assert all(low < high for low, high, _ in bands)


def test_modes_below_nyquist_lie_in_their_bands():
    bands, notes = named_bands([2.4, 21.0], 100.0)
    assert (names(bands, 0.5), names(bands, 2.4)) == (["quasi-static"], ["mode 1"])
    assert (names(bands, 21.0), names(bands, 45.0)) == (["mode 2"], ["above the modes"])
    assert notes == []


def test_the_paper_s_mode_of_2p5_hz_appears_at_0p2_hz_in_its_tracker_of_2p3_hz():
    bands, notes = named_bands([2.5, 30.0], 2.3)
    assert names(bands, 0.2) == ["quasi-static or mode 1 aliased"]
    assert names(bands, 1.0) == ["quasi-static"]
    assert any("mode 1 of 2.5 Hz appears at 0.2 Hz" in note for note in notes)
    assert any("mode 2 folds onto most" in note for note in notes)


@given(frequency=st.floats(5.5, 9.0))
@settings(max_examples=50, deadline=None)
def test_every_frequency_near_a_folded_mode_appears_in_its_band(frequency):
    bands, _ = named_bands([frequency], 10.0)
    for near in np.linspace(0.901, 1.099, 9) * frequency:
        (name,) = names(bands, alias(float(near), 10.0))
        assert name.endswith("mode 1 aliased")


@given(
    count=st.integers(3, 400),
    seed=st.integers(0, 999),
    even=st.booleans(),
    inner=st.lists(st.floats(0.05, 4.9), max_size=3, unique=True).map(sorted),
)
@settings(max_examples=60, deadline=None)
def test_band_parts_add_up_and_hold_the_energies_of_the_bands(count, seed, even, inner):
    rng = np.random.default_rng(seed)
    time = np.arange(count) / 10.0 + (0 if even else rng.uniform(-0.02, 0.02, count))
    values, edges = rng.standard_normal((count, 2)) + 3.0, [0.0, *inner, 5.0]
    parts, freedoms = band_parts(time, values, edges)
    assert parts.sum(axis=0) == pytest.approx(values, abs=1e-9)
    assert freedoms.sum() == count
    squares = [band.rms**2 * count for band in band_split(time, values, edges)]
    assert np.sum(parts**2, axis=(1, 2)) == pytest.approx(squares, abs=1e-6 * count)
    gram = np.einsum("aik,bik->ab", parts, parts)
    assert gram - np.diag(np.diag(gram)) == pytest.approx(0.0, abs=1e-9 * count)
