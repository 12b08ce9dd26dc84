"""The sentence of a curve tells its size."""

import pytest

from flexarm.law_curve import LawCurve
from flexarm.missing_law.curves import as_torque


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ((0.0, 2e-3), "it spans 200 N m"),
        ((-4.0e-3, -3.9e-3), "it spans 10.0 N m about 395 N m"),  # a constant, above all
    ],
)
def test_a_curve_that_is_nearly_constant_is_told_with_its_middle(value, told):
    curve = LawCurve(
        at="hinge",
        quantity="windup",
        of="angle",
        unit="rad",
        of_unit="rad",
        x=(0.0, 1.0),
        value=value,
        low90=value,
        high90=value,
        kind="law",
        instant_s=None,
        probability=1.0,
        says="the windup of hinge as a function of angle has a shape; it spans little",
    )
    assert as_torque(curve, 1e5).says.endswith(f"; {told}")
