"""Steps along laws with corners, over ripples that differences do not see past."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.arm.prior import Prior
from flexarm.diagnosis.fitting.coordinate import Coordinate
from flexarm.diagnosis.fitting.pattern import STEPS, stepped_over

PRIOR = Prior(1e-4, 2e-3, 5e-4, "log", "rad", "made up")


def problem_of(height, smooth=False):
    """As much of a fit and its fitter as the search asks for: one gap, of which `height` is C."""
    coordinate = Coordinate(0, "gap", PRIOR, smooth)
    problem = SimpleNamespace(
        rows=lambda z: np.array([np.sqrt(height(coordinate.value(float(z[0]))))]),
        members_at=lambda z: coordinate.value(float(z[0])),
    )
    fitter = SimpleNamespace(
        problem=lambda members: problem,
        with_effects=lambda members: None,
        observed=SimpleNamespace(prepare=list),
    )
    start = np.array([coordinate.z(1e-3)])
    return SimpleNamespace(coordinates=(coordinate,), z=start, members=1e-3), fitter


def rippled(gap):
    """Least at 1.07e-3; ripples of 1 % of the gap have least values of their own."""
    x = np.log(gap / 1.07e-3)
    return 1 + 1e4 * x**2 + 3 * (1 - np.cos(2 * np.pi * np.log(gap / 1e-3) / 0.01))


def test_a_ripple_is_stepped_over():
    near = 1e-3 * np.linspace(1.0, 1.003, 61)
    assert 0 < np.argmin([rippled(gap) for gap in near]) < 60  # downhill ends within the ripple
    found = stepped_over(*problem_of(rippled))
    assert found == pytest.approx(1.07e-3, rel=STEPS[-1])


def test_where_no_step_leads_down_nothing_moves():
    assert stepped_over(*problem_of(lambda gap: 1 + abs(np.log(gap / 1e-3)))) == pytest.approx(1e-3)


def test_smooth_laws_are_left_to_newton():
    fit, fitter = problem_of(rippled, smooth=True)
    assert stepped_over(fit, fitter) is fit.members
