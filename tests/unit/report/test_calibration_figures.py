"""Figures of a calibration."""

from types import SimpleNamespace

from pytest import approx

from flexarm.calibration_estimates import CalibratedFamily, CalibratedParameter, Range
from flexarm.report.calibration import _figures, members


def test_a_value_outside_its_interval_is_drawn_where_it_is():
    """The most probable value of a skewed posterior may lie below the 5 % quantile."""
    key, prior = "effects.joint_compliance.lift.stiffness", Range(1e5, 1e4, 1e6)
    each = CalibratedParameter(key, "family", 1.0e5, 1e4, 1.2e5, 1.5e5, "N m/rad", prior, 0.9, "", "")
    family = CalibratedFamily("joint_compliance", "stiffness", "N m/rad", ("lift",), None, 1.0)
    figure = members(SimpleNamespace(parameter=lambda name: each), family)  # type: ignore[arg-type]
    interval, value = figure.axes[0].lines
    assert list(interval.get_xdata()) == approx([120, 150])  # kN m/rad
    assert list(value.get_xdata()) == approx([100])


def test_families_of_turning_and_sliding_joints_have_figures_of_their_own(monkeypatch):
    """One effect and parameter, in N m/rad and in N/m: the second file replaced the first."""
    monkeypatch.setattr("flexarm.report.calibration.gaps_along", lambda found, section: iter(()))
    monkeypatch.setattr("flexarm.report.calibration.correlations", lambda found: None)
    monkeypatch.setattr("flexarm.report.calibration.members", lambda found, family: None)
    families = [
        CalibratedFamily("joint_compliance", "stiffness", unit, (at,), None, 1.0)
        for unit, at in (("N m/rad", "lift"), ("N/m", "extension"))
    ]
    names = [name for name, *_ in _figures(SimpleNamespace(families=families))]  # type: ignore[arg-type]
    assert names[:2] == ["joint_compliance-stiffness", "joint_compliance-stiffness-2"]
