"""Claims about outliers of drives: a smooth motion has none, whatever its noise; planted ones are found."""

import numpy as np
import pytest

from flexarm.comparison.drive_outliers import clean_drives, drive_spikes
from flexarm.drive import Drive
from flexarm.example.files import joined
from flexarm.record import Record, Signal


def resampled(time, angle, rate):
    """A drive as an exact encoder reads it."""
    drive = Drive.from_samples(time, {"hinge": angle})
    return drive.joints["hinge"](np.arange(0, time[-1], 1 / rate))


def motions():
    """Moves from stop to stop, a sine cut off anywhere, a ramp, a trapezoid of the rate."""
    t = np.arange(0, 20, 0.02)
    ramp = np.clip((t - 6) / 3, 0, 1)
    rate = np.interp(t, [0, 2, 4, 8, 10, 20], [0, 0, 0.3, 0.3, 0, 0])
    return {
        "stops": joined((0, 0.7, -0.3, 0.2), 4.0),
        "sine": (t, 0.6 * np.sin(2 * np.pi * 0.2 * t)),
        "ramp": (t, 0.5 * ramp**2 * (3 - 2 * ramp)),
        "trapezoid": (t, np.cumsum(rate) * 0.02 - 0.5),
    }


@pytest.mark.parametrize("rate", [50, 250])
@pytest.mark.parametrize("name", motions())
def test_a_motion_without_noise_has_no_outliers(name, rate):
    assert not drive_spikes(resampled(*motions()[name], rate), 0.0).any()


@pytest.mark.parametrize("noise", [0.0, 2e-6])
@pytest.mark.parametrize("name", motions())
def test_planted_outliers_are_found_and_no_others(name, noise):
    """Of 0.5 mrad, 250 times the noise, one of them in the first row, two beside each other."""
    rng = np.random.default_rng(4)
    samples = resampled(*motions()[name], 250) + noise * rng.standard_normal(
        len(resampled(*motions()[name], 250))
    )
    planted = [0, 700, 1700, 1701, 2500]
    samples[planted] += np.array([5e-4, -5e-4, 5e-4, 6e-4, 5e-4])
    assert set(planted) == set(np.flatnonzero(drive_spikes(samples, noise)))


@pytest.mark.parametrize("row", [0, -1])
def test_a_row_at_an_end_is_told_as_far_off_as_it_is(row):
    """A reading at an end that is written twice, beside 0.3 rad/s at 250 Hz, is 1.2 mrad off, not 0."""
    t = np.arange(0, 8, 4e-3)
    angle = 0.3 / 0.5 * np.sin(0.5 * (t - t[row]))
    angle[row] = angle[row + 1 if row == 0 else row - 1]
    hinge = Signal(name="hinge", quantity="joint_angle", joint="hinge", side="motor", time=t, values=angle)
    _, [removed] = clean_drives("run", Record(signals=[hinge], drive=("hinge",)))
    assert removed.rows == (row % len(t),)
    assert removed.size == pytest.approx(1.2e-3, rel=1e-3)
