"""Gaps that are scanned: across ripples of C, to where a fit from the probe does not come."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.moves import proposals as promising
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.refinement import multi_start
from flexarm.effects import Backlash, CoulombFriction
from flexarm.errors import NotConverged

GAP = 2.2e-4
"""Where C is least [rad]."""


def cost(gap):
    """A valley with ripples in which least squares stop."""
    x = np.log(gap / GAP)
    return 1.0 + 40.0 * x**2 + 2.0 * np.sin(60.0 * x) ** 2


class Estimator:
    """As much of a fitter as is asked for; its fits stay where they start."""

    problem = SimpleNamespace(prepare=lambda arms: list(arms), policy=SelectionPolicy())

    def with_effects(self, members):
        return members

    def residual(self, members):
        [gap] = [member.effect.gap for member in members if member.name == "backlash"]
        if gap > 4e-4:
            raise NotConverged("the arm fell over")
        return np.array([np.sqrt(cost(gap))])

    def eliminated(self, members):
        return None, SimpleNamespace(project=lambda residual: residual)

    def fit(self, members):
        return SimpleNamespace(members=members, cost=float(self.residual(members) @ self.residual(members)))


def backlash(gap):
    effect = Backlash(at="hinge", gap=gap)
    return Candidate(effect, ("gap",), (effect,), {})


@pytest.mark.parametrize("found", [0.9e-4, 1.5e-4, 3.5e-4])
def test_a_fit_starts_again_near_the_right_gap(found):
    """Within a step of the series, though the model cannot be simulated with the largest gaps."""
    estimator = Estimator()
    again = multi_start(estimator.fit((backlash(found),)), estimator)
    assert again.members[0].effect.gap == pytest.approx(GAP, rel=0.18)


def test_what_is_right_stays(monkeypatch):
    estimator = Estimator()
    assert multi_start(estimator.fit((backlash(GAP),)), estimator) is None


def test_a_model_without_a_gap_is_not_scanned():
    friction = CoulombFriction(at="hinge", torque=3.0)
    fit = SimpleNamespace(members=(Candidate(friction, ("torque",), (friction,), {}),), cost=9.0)
    assert multi_start(fit, Estimator()) is None


def test_the_best_model_with_a_gap_is_scanned():
    """Where all leave something."""
    fits = [Estimator().fit((backlash(gap),)) for gap in (1.2e-4, 1.5e-4)]
    [again] = promising._multi_started(Estimator(), fits)
    assert again.cost < min(fit.cost for fit in fits)
    assert promising._multi_started(Estimator(), []) == []
