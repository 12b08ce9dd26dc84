"""Steps along laws with corners, over ripples that differences do not see past."""

from types import SimpleNamespace

import numpy as np
import pytest
from arms import compliance, crane

from flexarm.arm.prior import Prior
from flexarm.diagnosis.candidate import TransformedParameter
from flexarm.diagnosis.nuisance import NuisanceModel, NuisanceParameter
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.refinement import hooke_jeeves
from flexarm.effects import Backlash

PRIOR = Prior(1e-4, 2e-3, 5e-4, "log", "rad", "made up")


def problem_of(height, smooth=False):
    """As much of a fit and its fitter as the search asks for: one gap, of which `height` is C."""
    parameter = TransformedParameter(0, "gap", PRIOR, smooth)
    solver = SimpleNamespace(
        objective_rows=lambda z: np.array([np.sqrt(height(parameter.value(float(z[0]))))]),
        members_at=lambda z: parameter.value(float(z[0])),
    )
    estimator = SimpleNamespace(
        solver=lambda members: solver,
        with_effects=lambda members: None,
        problem=SimpleNamespace(prepare=list),
    )
    start = np.array([parameter.z(1e-3)])
    return SimpleNamespace(parameters=(parameter,), z=start, members=1e-3), estimator


def rippled(gap):
    """Least at 1.07e-3; ripples of 1 % of the gap have least values of their own."""
    x = np.log(gap / 1.07e-3)
    return 1 + 1e4 * x**2 + 3 * (1 - np.cos(2 * np.pi * np.log(gap / 1e-3) / 0.01))


def test_a_ripple_is_stepped_over():
    near = 1e-3 * np.linspace(1.0, 1.003, 61)
    assert 0 < np.argmin([rippled(gap) for gap in near]) < 60  # downhill ends within the ripple
    found = hooke_jeeves(*problem_of(rippled))
    assert found == pytest.approx(1.07e-3, rel=FIT.search_steps[-1])


def test_where_no_step_leads_down_nothing_moves():
    assert hooke_jeeves(*problem_of(lambda gap: 1 + abs(np.log(gap / 1e-3)))) == pytest.approx(1e-3)


def test_smooth_laws_are_left_to_newton():
    fit, estimator = problem_of(rippled, smooth=True)
    assert hooke_jeeves(fit, estimator) is fit.members


def test_nominal_values_are_stepped_over_ripples_too():
    """0.3 sigma, and no more than a fiftieth of what is hardly known; small where no law has corners."""
    values = (
        NuisanceParameter("payloads.load.mass", 10.0, 0.05, "kg", "nominal"),
        NuisanceParameter("links.rod.material.youngs_modulus", 2e11, 6e10, "Pa", "nominal"),
        NuisanceParameter("effects.time_delay.tracker.delay", 0.0, 1e-3, "s", "clock"),
    )
    smooth = crane(effects=[compliance("hinge", 1e5, 200.0)])
    cornered = smooth.with_effect(Backlash(at="hinge", gap=1e-3))
    found = NuisanceModel(smooth, values)
    assert found.steps(smooth) == {}
    assert found.steps(cornered) == pytest.approx(
        {"payloads.load.mass": 0.015, "links.rod.material.youngs_modulus": 4e9}
    )
