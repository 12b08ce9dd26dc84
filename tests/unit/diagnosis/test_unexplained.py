"""Claims about what is left: frequency, size, place, in numbers and in a sentence."""

import numpy as np
import pytest
from planted import run_of

from flexarm.errors import InvalidParameter
from flexarm.report.state_figures import gap_figure
from flexarm.residual_analysis.localisation import localise
from flexarm.residual_analysis.unexplained import unexplained_residual

SIZE = 8e-4


def vibration(frequency):
    return {"tip": lambda t: SIZE * np.stack([np.sin(2 * np.pi * frequency * t), 0 * t], axis=1)}


@pytest.fixture(scope="module")
def run():
    return run_of("one joint")


@pytest.mark.parametrize("frequency", [1.7, 3.3])
def test_a_vibration_is_named_by_its_frequency(run, frequency):
    """To within a quarter of 1/T; its share is all but the noise, 1/200 of the squares."""
    found = unexplained_residual(localise(run.showing(vibration(frequency))))
    assert found.signal == "tip"
    assert found.frequency_hz == pytest.approx(frequency, abs=0.25 / 36)
    assert found.frequency_share > 0.5  # the tangent turns with the arm and takes a part of x only
    assert found.rms == pytest.approx(SIZE / np.sqrt(2), rel=0.05)
    assert found.ratio == pytest.approx(SIZE / np.sqrt(2) / (4e-5 * np.sqrt(2)), rel=0.05)
    assert f"{found.frequency_hz:.3g} Hz" in str(found)
    assert found.band == "mode 1"  # up to twice its 2.4 Hz; the mode across the plane, 2.8 Hz, is not seen


def test_a_vibration_above_half_the_rate_is_among_the_aliases(run):
    found = unexplained_residual(localise(run.showing(vibration(7.1))))
    assert found.frequency_hz == pytest.approx(2.9, abs=0.25 / 36)
    assert min(abs(f - 7.1) for f in found.aliases_hz) < 0.25 / 36


def test_the_greatest_gap_is_where_it_was_planted(run):
    bump = {"tip": lambda t: 5e-3 * np.stack([np.exp(-(((t - 20.0) / 0.3) ** 2)), 0 * t], axis=1)}
    found = unexplained_residual(localise({"a": run.showing({}, 1), "b": run.showing(bump, 2)}))
    assert found.record == "b"
    assert found.time == pytest.approx(20.0, abs=0.15)
    assert "of b" in str(found)


def test_a_burst_is_told_by_its_interval(run):
    """exp(-2 (t - 20)^2/0.8^2) holds half of itself within 0.27 s of 20 s; to two samples of 0.1 s."""

    def gap(t):
        envelope = np.exp(-(((t - 20.0) / 0.8) ** 2))
        return 5e-3 * np.stack([envelope * np.sin(2 * np.pi * 3.1 * t), 0 * t], axis=1)

    found = unexplained_residual(localise(run.showing({"tip": gap})))
    assert found.burst == (pytest.approx(19.73, abs=0.2), pytest.approx(20.27, abs=0.2))
    assert "half of it from" in str(found)
    lasting = unexplained_residual(localise(run.showing(vibration(3.1))))
    assert lasting.burst is None


def test_a_vibration_whose_frequency_wanders_is_found_near_its_middle(run):
    """3 % of 3 Hz, slowly: no line of the periodogram holds half of what the band holds."""

    def wave(t):
        return SIZE * np.stack([np.sin(2 * np.pi * 3 * (t + 0.03 * 4 * np.sin(t / 4))), 0 * t], axis=1)

    found = unexplained_residual(localise(run.showing({"tip": wave})))
    assert found.frequency_hz == pytest.approx(3.0, rel=0.04)
    assert found.frequency_share > 0.5


def test_a_figure_shows_the_gap_with_units(run):
    located = localise(run.showing(vibration(1.7)))
    figure = gap_figure(located)
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels == ["angle of hinge [rad]", "rate of hinge [rad/s]", "torque of hinge [N m]", "time [s]"]
    drawn = {line.get_label(): line.get_ydata() for line in figure.axes[-1].get_lines()}
    assert np.std(drawn["gap"]) > 0.5 * SIZE
    assert located.plot("hinge torque").axes
    with pytest.raises(InvalidParameter, match="no signal 'hub'; there are hinge torque, tip"):
        located.plot("hub")
