"""Dual numbers follow the rules of differentiation, and laws take the branches that they take with floats."""

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st
from pytest import approx

from flexarm.control.actuator import VoltageDrive, differentiated
from flexarm.control.dual import Dual, between, slopes_of, value_of

numbers = st.floats(-10, 10).filter(lambda x: abs(x) > 1e-2)
DRIVE = VoltageDrive(torque_per_volt=20.0, back_emf=50.0, greatest_voltage=8.0, greatest_torque=120.0)


def dual(value: float, *slopes: float) -> Dual:
    return Dual(value, np.array(slopes))


@given(u=numbers, v=numbers, c=numbers)
def test_sums_products_and_quotients_have_their_derivatives(u: float, v: float, c: float) -> None:
    """f = (u v - c/v)/(c + u) + c u, by hand."""
    assume(abs(c + u) > 1e-2)
    found = (dual(u, 1, 0) * dual(v, 0, 1) - c / dual(v, 0, 1)) / (c + dual(u, 1, 0)) + c * dual(u, 1, 0)
    top = u * v - c / v
    assert isinstance(found, Dual)
    assert found.value == approx(top / (c + u) + c * u)
    assert found.slopes[0] == approx(v / (c + u) - top / (c + u) ** 2 + c)
    assert found.slopes[1] == approx((u + c / v**2) / (c + u))


@given(u=numbers, v=numbers)
def test_they_compare_by_their_values_also_with_numbers_of_numpy(u: float, v: float) -> None:
    assert (dual(u, 1) < dual(v, 2)) == (u < v) == (dual(u, 1) < v) == (u < dual(v, 2))
    assert (dual(u, 1) == v) == (u == v)
    assert value_of(max(dual(u, 1), v)) == max(u, v)
    product = np.float64(v) * dual(u, 1)
    assert isinstance(product, Dual) and product.slopes == approx([v])


@given(voltage=st.floats(-12, 12), rate=st.floats(-3, 3))
def test_a_motor_within_its_limits_or_at_them_has_the_derivatives_of_differences(
    voltage: float, rate: float
) -> None:
    """By voltage, rate and the torque limit; on a limit itself both sides differ."""

    def torque(u: float, w: float, limit: float) -> float:
        drive = VoltageDrive(20.0, 50.0, 8.0, limit)
        return value_of(drive.hold(u, w)[1])

    h = 1e-6
    corners = [abs(voltage) - 8, abs(20 * np.clip(voltage, -8, 8) - 50 * rate) - 120]
    assume(min(abs(corner) for corner in corners) > 1e-3)
    drive = differentiated(
        DRIVE,
        [(DRIVE, DRIVE)] * 2 + [tuple(VoltageDrive(20.0, 50.0, 8.0, 120 + d) for d in (h, -h))],
        [1, 1, 2 * h],
    )
    found = drive.hold(dual(voltage, 1, 0, 0), dual(rate, 0, 1, 0))[1]
    here = np.array([voltage, rate, 120.0])
    expected = [(torque(*(here + d)) - torque(*(here - d))) / (2 * h) for d in h * np.eye(3)]
    assert slopes_of(found, 3) == approx(np.array(expected), abs=1e-6)


def test_a_number_that_no_parameter_changes_stays_a_number() -> None:
    assert between(2.0, [(2.0, 2.0)], [1e-3]) == 2.0
    assert not isinstance(between(float("inf"), [(float("inf"), float("inf"))], [1e-3]), Dual)
    found = between(2.0, [(2.0, 2.0), (2.1, 1.9)], [1e-3, 0.1])
    assert slopes_of(found, 2) == approx([0.0, 2.0])
    assert slopes_of(3.0, 2) == approx([0.0, 0.0])
