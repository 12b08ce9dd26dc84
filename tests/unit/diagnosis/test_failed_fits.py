"""One model that cannot be simulated ends no diagnosis; an error of the program does."""

from types import SimpleNamespace

import pytest
from numpy.linalg import LinAlgError

from flexarm.arm.prior import Prior
from flexarm.diagnosis.choosing import promising
from flexarm.diagnosis.fitting.coordinate import Coordinate
from flexarm.errors import InvalidParameter, NotConverged

FAILURES = [
    NotConverged("no equilibrium"),
    InvalidParameter("mass must be positive"),
    LinAlgError("singular"),
]
NOTHING = SimpleNamespace(members=())


def failing(error, at):
    """A fitter that finds everything but one thing."""

    def fit(members):
        if members[0] == at:
            raise error
        return members[0]

    return SimpleNamespace(fit=fit, observed=None)


def fitted(error, monkeypatch):
    """What is found of three effects, of which the second leads to an error."""
    monkeypatch.setattr(promising, "explained", lambda *_: False)
    shares = [SimpleNamespace(members=(name,), share=0.9) for name in ("tilt", "bow", "play")]
    return promising._fitted(failing(error, "bow"), shares, NOTHING, NOTHING)


@pytest.mark.parametrize("error", FAILURES, ids=lambda error: type(error).__name__)
def test_what_cannot_be_fitted_is_left_out(error, monkeypatch):
    assert fitted(error, monkeypatch) == ["tilt", "play"]


def test_arrays_that_do_not_fit_together_are_no_model_that_cannot_be_simulated(monkeypatch):
    """What NumPy says of them is a ValueError, as an InvalidParameter is."""
    with pytest.raises(ValueError, match="broadcast"):
        fitted(ValueError("operands could not be broadcast together"), monkeypatch)


def test_a_value_that_has_no_logarithm_is_refused_by_name():
    mass = Coordinate(0, "mass", Prior(1.0, 4.0, 2.0, "log", "kg", "a test"))
    with pytest.raises(InvalidParameter, match="mass must be positive, got 0 kg"):
        mass.z(0.0)
