"""Outliers of a tracker while the model predicts vibration."""

import numpy as np

from flexarm.validation.outliers import spikes

TIME = np.arange(0, 32, 0.1)
AMPLITUDE = 8e-3 * np.exp(-((TIME - 20) ** 2) / 8.0)
NOISE = np.array([5e-5])


def test_an_outlier_is_seen_where_the_predicted_vibration_is_in_phase():
    """10 mm beside a predicted vibration of 8 mm, of which the other rows show nothing but noise."""
    residual = NOISE * np.random.default_rng(1).standard_normal((len(TIME), 1))
    hit = [193, 220]
    residual[hit] += 0.01
    assert np.flatnonzero(spikes(residual, NOISE, AMPLITUDE[:, None])).tolist() == hit


def test_a_vibration_out_of_phase_is_no_outlier():
    """Teeth strike once: 10 mm in one row, beside a vibration of which the other rows miss a third."""
    residual = NOISE * np.random.default_rng(1).standard_normal((len(TIME), 1))
    residual[:, 0] += AMPLITUDE / 3 * np.sin(2 * np.pi * 3.1 * TIME)
    residual[193] += 0.01
    assert not spikes(residual, NOISE, AMPLITUDE[:, None]).any()
