"""A sensor that repeats a value: frozen while the drives move, and at rest where they stand."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.record import Signal
from flexarm.validation.saturation import constant_runs, find_frozen

TIME = np.arange(0.0, 10.0, 0.01)


def channel(driven, predicted):
    """Readings to a millimetre that follow a prediction for five seconds and then stay where they are."""
    follows = np.round(np.where(TIME < 5.0, predicted, 0.03), 3)
    signal = Signal(
        name="tip", quantity="deflection", time=TIME, values=follows, noise_std=2.9e-4, axes=("y",)
    )
    return SimpleNamespace(
        signal=signal, measured=follows, predicted=predicted, driven=driven, time=TIME, label="tip y"
    )


@pytest.fixture
def swinging():
    return 0.03 * np.cos(2 * np.pi * 1.8 * TIME)


def test_an_arm_at_rest_is_no_frozen_sensor_where_only_the_model_rings_on(swinging):
    """A model without damping; the drive stands for the last five seconds."""
    assert find_frozen(channel(TIME < 5.0, swinging)) is None


def test_a_sensor_that_stays_while_the_drive_moves_is_frozen(swinging):
    found = find_frozen(channel(np.ones(len(TIME), dtype=bool), swinging))
    assert found is not None
    rows, sentence = found
    assert rows[TIME >= 5.0].all()
    assert rows[TIME < 5.0].sum() < 10
    assert "repeats a value" in sentence


def test_noisy_runs_are_as_long_as_readings_stay_whatever_precedes_them():
    """Readings creep by less than the width before they stand: no short run may take their first rows."""
    creeping, standing = np.linspace(0.0, 1.0, 10), np.full(30, 1.0)
    y = np.concatenate([creeping, standing, 1.0 + creeping[1:]])
    found = constant_runs(y, 0.25, fewest=20)
    assert found == [(7, 40)]
    assert all(np.ptp(y[i:j]) <= 0.25 for i, j in found)
