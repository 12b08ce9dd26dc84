"""Claims about what is left: frequency, size, place, in numbers and in a sentence."""

import numpy as np
import pytest
from planted import run_of

from flexarm.diagnosis.gap_figure import gap_figure
from flexarm.diagnosis.locate import locate
from flexarm.diagnosis.remainder import describe_remainder, periodogram, remainder_of
from flexarm.errors import InvalidParameter

SIZE = 8e-4


def vibration(frequency):
    return {"tip": lambda t: SIZE * np.stack([np.sin(2 * np.pi * frequency * t), 0 * t], axis=1)}


@pytest.fixture(scope="module")
def run():
    return run_of("one joint")


@pytest.mark.parametrize("frequency", [1.7, 3.3])
def test_a_vibration_is_named_by_its_frequency(run, frequency):
    """To within a quarter of 1/T; its share is all but the noise, 1/200 of the squares."""
    found = remainder_of(locate(run.showing(vibration(frequency))))
    assert found.signal == "tip"
    assert found.frequency_hz == pytest.approx(frequency, abs=0.25 / 36)
    assert found.frequency_share > 0.5  # the tangent turns with the arm and takes a part of x only
    assert found.rms == pytest.approx(SIZE / np.sqrt(2), rel=0.05)
    assert found.ratio == pytest.approx(SIZE / np.sqrt(2) / (4e-5 * np.sqrt(2)), rel=0.05)
    assert f"{found.frequency_hz:.3g} Hz" in str(found)


def test_a_remainder_is_also_a_dictionary_with_its_sentence(run):
    located = locate(run.showing(vibration(1.7)))
    found, described = remainder_of(located), describe_remainder(located)
    assert described["sentence"] == str(found)
    assert described["frequency_hz"] == found.frequency_hz


def test_a_vibration_above_half_the_rate_is_among_the_aliases(run):
    found = remainder_of(locate(run.showing(vibration(7.1))))
    assert found.frequency_hz == pytest.approx(2.9, abs=0.25 / 36)
    assert min(abs(f - 7.1) for f in found.aliases_hz) < 0.25 / 36


def test_the_greatest_gap_is_where_it_was_planted(run):
    bump = {"tip": lambda t: 5e-3 * np.stack([np.exp(-(((t - 20.0) / 0.3) ** 2)), 0 * t], axis=1)}
    found = remainder_of(locate({"a": run.showing({}, 1), "b": run.showing(bump, 2)}))
    assert found.record == "b"
    assert found.time == pytest.approx(20.0, abs=0.15)
    assert "of b" in str(found)


def test_a_sine_takes_all_of_itself_whatever_the_samples():
    rng = np.random.default_rng(0)
    time = np.sort(rng.uniform(0, 40, 400))
    frequencies, powers = periodogram(time, np.sin(2 * np.pi * 1.23 * time + 0.7))
    assert frequencies[np.argmax(powers)] == pytest.approx(1.23, abs=1 / 160)
    assert powers.max() > 0.98


def test_a_figure_shows_before_and_after_with_units(run):
    before, after = locate(run.showing(vibration(1.7))), locate(run.showing({}))
    figure = gap_figure(before, after)
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels == ["angle of hinge [rad]", "rate of hinge [rad/s]", "torque of hinge [N m]", "time [s]"]
    drawn = {line.get_label(): line.get_ydata() for line in figure.axes[-1].get_lines()}
    assert np.std(drawn["before"]) > 5 * np.std(drawn["after"])
    assert before.plot("hinge torque").axes
    with pytest.raises(InvalidParameter, match="no signal 'hub'; there are hinge torque, tip"):
        before.plot("hub")
