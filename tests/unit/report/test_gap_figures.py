"""Claims about the figures of the gap: bars of all records fit, whatever their order."""

import diagnoses
import numpy as np
import pytest

from flexarm.comparison.bands import Band
from flexarm.comparison.gap import SignalGap
from flexarm.report.files import style
from flexarm.report.gap_figures import by_band


@pytest.mark.parametrize("order", [("slow", "fast", "other"), ("other", "fast", "slow")])
def test_no_bar_is_cut_off(order):
    """Records share one axis; the highest bar may belong to any of them."""
    with style():
        figure = by_band(diagnoses.of_effects(), order)
    tops = [patch.get_height() for ax in figure.axes for patch in ax.patches]
    assert len({ax.get_ylim() for ax in figure.axes}) == 1
    assert max(tops) < figure.axes[0].get_ylim()[1]


def test_the_noise_is_inside_where_nothing_exceeds_it():
    with style():
        figure = by_band(diagnoses.adequate(), ["slow", "fast"])
    for ax in figure.axes:
        [noise] = {float(line.get_ydata()[0]) for line in ax.get_lines()}
        assert noise < ax.get_ylim()[1]


def test_a_line_breaks_where_rows_are_left_out():
    """Of 10 Hz without the second from 1 to 2 s; poses stay as they are."""
    time = np.concatenate([np.arange(0.0, 1.0, 0.1), np.arange(2.0, 3.0, 0.1)])
    values = np.sin(time)
    bands = (Band(0.0, 5.0, 1.0),)
    gap = SignalGap("tip", "position", "m", time, {"x": values}, {}, {}, bands, None)
    at, line = gap.line("x")
    assert np.isnan(at[10]) and np.isnan(line[10])
    assert np.delete(line, 10) == pytest.approx(values)
    names = tuple(f"p{k}" for k in range(len(time)))
    poses = SignalGap("tip", "position", "m", time, {"x": values}, {}, {}, (), None, poses=names)
    assert poses.line("x")[0] is time
