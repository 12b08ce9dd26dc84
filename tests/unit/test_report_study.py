"""What a reproduction asks of its drive, evaluated quickly and as SciPy does it."""

import numpy as np
import pytest
from pytest import approx
from scipy.interpolate import PPoly

from flexarm.mockup import Experiment
from flexarm.reproduction.study import _scalar


@pytest.mark.parametrize("nu", [0, 1, 2, 3])
def test_a_drive_and_its_derivatives_are_those_of_its_polynomials(nu: int) -> None:
    """Inside; before and after, the angle is held and its derivatives vanish."""
    drive = Experiment(duration=4, period=3, rest=0).pure_sine().joints["hinge"]
    angle, wanted = _scalar(drive), PPoly(drive.coefficients, drive.breaks)
    times = [0.0, 4.0, *np.random.default_rng(1).uniform(0, 4, 200)]
    assert [angle(t, nu) for t in times] == approx(wanted(times, nu), rel=1e-12, abs=1e-12)
    for outside, edge in ((-0.5, 0.0), (4.5, 4.0)):
        assert angle(outside, nu) == (approx(float(wanted(edge))) if nu == 0 else 0.0)
