"""Sets of candidates in the linearised problem, on moves made up of numbers."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.screening import RIDGE, Linear, Probed, screen, screen_sets
from flexarm.effects import EncoderOffset

ROWS = 60


def candidate(name: str) -> Candidate:
    probe = EncoderOffset(at=name, offset=1e-3)
    return Candidate(EncoderOffset(at=name), ("offset",), (probe,), {"offset": 0.0})


def setup(gap: np.ndarray, moves: dict[str, np.ndarray]) -> tuple:
    """A fitter without effects, one unknown of no use, and probed candidates."""
    projection = Projection(np.zeros((ROWS, 1)), np.ones(1))
    estimator = SimpleNamespace(
        taken=lambda members: frozenset(),
        without=lambda taken: (None, projection),
        problem=SimpleNamespace(policy=SelectionPolicy()),
    )
    fit = SimpleNamespace(
        places=(),
        spots=frozenset(),
        members=(),
        residual=gap,
        projected=projection.project(gap),
        jacobian=np.empty((ROWS, 0)),
        cost=float(gap @ gap),
    )
    return estimator, [Probed(candidate(name), move[:, None]) for name, move in moves.items()], fit


@pytest.fixture
def hidden():
    """A gap that three moves explain exactly, each of which hides in what the others take away."""
    rng = np.random.default_rng(3)
    u, v, w, d, e, *decoys = np.linalg.qr(rng.standard_normal((ROWS, 12)))[0].T
    gap = u + v + w
    moves = {"pitch": u + 5 * d, "roll": v - 5 * d + 5 * e, "place": w - 5 * e}
    return setup(-gap, moves | {f"decoy_{k}": 0.5 * gap + x for k, x in enumerate(decoys)})


def test_three_that_help_only_together_are_found_together(hidden):
    alone = screen(*hidden)
    assert {share.members[0].at for share in alone[:7]} == {f"decoy_{k}" for k in range(7)}
    best = screen_sets(*hidden, size=3)[0]
    assert {member.at for member in best.members} == {"pitch", "roll", "place"}
    assert best.share > 0.98
    assert [m.effect.offset for m in best.members] == pytest.approx([1e-3] * 3, rel=0.02)


def test_a_pair_explains_what_least_squares_with_a_ridge_say(hidden):
    estimator, probed, fit = hidden
    linear = Linear(estimator, probed, fit)
    share, chosen = linear.ranked(linear.sets(range(4), 2))[0]
    D = np.concatenate([probed[k].moves for k in chosen], axis=1)
    rows = np.vstack([D, RIDGE * np.eye(2)])
    alpha = np.linalg.lstsq(rows, np.concatenate([-fit.residual, np.zeros(2)]), rcond=None)[0]
    left = fit.residual + D @ alpha
    assert share == pytest.approx(1 - left @ left / fit.cost, abs=1e-12)


def test_a_law_at_both_axes_of_a_place_is_one_candidate_and_two_laws_are_none():
    rng = np.random.default_rng(4)
    x, y = np.linalg.qr(rng.standard_normal((ROWS, 2)))[0].T
    found = screen(*setup(-(x + y), {"first": x, "second": y}), {"first": "second"})
    assert [m.at for m in found[0].members] == ["first", "second"]
    assert found[0].share > 0.97 > found[1].share
