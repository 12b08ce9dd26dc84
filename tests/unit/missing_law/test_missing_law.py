"""Latent windups of a hinge with a cause that no effect of the vocabulary has."""

from __future__ import annotations

import hidden_laws
import numpy as np
import pytest
from hidden_laws import STIFFNESS, nominal, problem_of, record

import flexarm
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.search import missing_laws
from flexarm.missing_law.windup import TimeBasis, WindupResponse, added

INSTANT = 9.0


def softening(t, states):
    """A quarter of the stiffness is lost at an instant: 1/k grows by a third."""
    return np.where(t > INSTANT, -states["torque"] / STIFFNESS / 3, 0.0)


def bump(t, states):
    """A torque of 60 N m that the hinge gains near one angle."""
    return 60 * np.exp(-(((states["angle"] - 0.2) / 0.12) ** 2)) / STIFFNESS


def saturating(t, states):
    """A torque that the hinge loses, up to 60 N m, with its rate."""
    return -60 * np.tanh(states["rate"] / 0.15) / STIFFNESS


def quintic(t, states):
    """A windup that grows with the fifth power of the torque."""
    return 2e-4 * (states["torque"] / 600) ** 5


def nothing(t, states):
    return np.zeros_like(t)


def found_of(windup, **held_out):
    problem, estimator = problem_of(windup)
    return missing_laws(problem, [estimator.fit(())], held_out, "tip")


@pytest.mark.parametrize(
    ("windup", "quantity", "of", "kind"),
    [
        (softening, "windup", "torque", "change"),
        (bump, "torque", "angle", "law"),
        (saturating, "torque", "rate", "law"),
        (quintic, "windup", "torque", "law"),
    ],
)
def test_the_curve_is_the_hidden_one_within_a_tenth_of_its_peak(windup, quantity, of, kind):
    other = record(windup, 99, 0.7, 7.0)
    law = found_of(windup, other=other)[0]
    assert (law.at, law.quantity, law.of, law.kind) == ("hinge", quantity, of, kind)
    x = np.array(law.x)
    truth = windup(np.full(len(x), 2 * INSTANT), {"angle": x, "rate": x, "torque": x})
    truth = truth if quantity == "windup" else -STIFFNESS * truth
    assert np.abs(np.array(law.value) - truth).max() < 0.1 * np.abs(truth).max()
    assert law.held_out.before_rms > 5 * law.held_out.noise_rms
    closed = (law.held_out.before_rms - law.held_out.after_rms) / (
        law.held_out.before_rms - law.held_out.noise_rms
    )
    assert closed > 0.9


def test_the_instant_and_the_loss_of_stiffness_are_told():
    law = found_of(softening)[0]
    low, high = law.instant90
    assert low <= INSTANT <= high
    assert high - low < 0.2
    assert "25 ± 1 % softer" in law.says


def test_a_torque_and_its_windup_explain_alike_and_are_both_shown():
    first, second = found_of(bump)[:2]
    assert (first.quantity, second.quantity) == ("torque", "windup")
    assert first.probability == second.probability
    assert np.array(first.value) == pytest.approx(-STIFFNESS * np.array(second.value), rel=0.01)


@pytest.mark.parametrize("seed", [3, 4, 5, 6])
def test_nothing_is_drawn_where_nothing_is_missing(seed):
    problem, estimator = problem_of(nothing, seed)
    assert missing_laws(problem, [estimator.fit(())], {}, "tip") == ()


def test_the_linear_response_is_that_of_simulated_windups():
    """Eq. (2) of `windup`; the rest is a mode of 2.4 Hz in steps of 16 ms."""
    problem, estimator = problem_of(nothing)
    policy = LawPolicy(spacing=0.5)
    response = WindupResponse.of(problem, estimator.fit(()).nuisance.arm, "hinge", policy)
    motion = np.concatenate([1e-4 * np.sin(basis.places) for basis in response.bases.values()])
    moved = response.moved(motion)
    assert np.linalg.norm(moved - response.jacobian @ motion) < 0.02 * np.linalg.norm(moved)


def test_a_drive_and_a_spline_add_up():
    """Both are held outside of their own span."""
    t = np.linspace(0.0, 3.0, 31)
    drive = flexarm.Drive.from_samples(t, {"hinge": np.sin(t)}).joints["hinge"]
    basis = TimeBasis.over(1.0, 2.0, LawPolicy())
    coefficients = np.cos(np.arange(len(basis)))
    both = added(drive, basis.polynomial(coefficients))
    at = np.linspace(0.0, 3.0, 301)
    assert both(at) == pytest.approx(drive(at) + basis.at(at) @ coefficients, abs=1e-12)


def test_a_diagnosis_tells_the_law_and_keeps_it(tmp_path):
    records = {"slow": record(softening, 0, 0.8, 9.0), "fast": record(softening, 1, 0.6, 5.5)}
    other = record(softening, 99, 0.7, 7.0)
    found = flexarm.diagnose(nominal(), records, other, step=hidden_laws.STEP, jobs=2)
    assert found.verdict == "unexplained"
    law = found.laws[0]
    assert (law.at, law.of, law.kind) == ("hinge", "torque", "change")
    assert "missing law" in found.summary() and "25 ± 1 % softer" in " ".join(found.summary().split())
    found.save(tmp_path / "found")
    assert "What is missing has this shape" in (tmp_path / "found" / "report.html").read_text()
    again = flexarm.Diagnosis.load(tmp_path / "found").laws[0]
    assert again.value == pytest.approx(law.value)
    assert again.held_out == law.held_out
