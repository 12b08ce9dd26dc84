"""What is slow of residuals: the sag of an arm beside its ringing, which is out of step."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.diagnosis.candidate import Candidate
from flexarm.diagnosis.fit import Projection
from flexarm.diagnosis.moves.proposals import slow_part
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.screening import Probed, screen, screen_sets
from flexarm.effects import EncoderOffset

TIME = np.arange(0, 40, 0.1)
SAG = np.sin(2 * np.pi * TIME / 18) * np.minimum(TIME / 3, 1)
POSES = 5


def problem():
    """A tracker at 10 Hz, and five poses."""
    end = len(TIME)
    rows = [
        SimpleNamespace(record="run", time=TIME, where=slice(0, end)),
        SimpleNamespace(record="poses", time=np.arange(POSES), where=slice(end, end + POSES)),
    ]
    kinds = {"run": SimpleNamespace(kind="motion"), "poses": SimpleNamespace(kind="static")}
    return SimpleNamespace(
        policy=SelectionPolicy(), records=kinds, channels=lambda: [(each, each.where) for each in rows]
    )


def rows(motion, poses=0.0):
    return np.concatenate([motion, np.full(POSES, poses)])[:, None]


def test_what_rings_hardly_shows_and_what_sags_does():
    """Of 4.1 Hz ten samples in a second leave |sin(10 x)/(10 sin x)| = 0.03, x = 0.41 pi; of 18 s, 0.995."""
    seen = slow_part(problem())
    ring = np.sin(2 * np.pi * 4.1 * TIME)
    assert np.std(seen(rows(ring))[20:-30]) < 0.04 * np.std(ring)
    assert seen(rows(SAG))[40:-30, 0] == pytest.approx(SAG[40:-25], abs=0.03)  # half a sample late


def test_poses_stay_and_what_was_given_too():
    given = rows(SAG, 3.0)
    kept = given.copy()
    assert np.array_equal(slow_part(problem())(given)[-POSES:], given[-POSES:])
    assert np.array_equal(given, kept)


@pytest.fixture
def out_of_step():
    """A mass three probes off rings at another frequency; a damping does what rings and nothing else."""
    ring = [8 * np.sin(2 * np.pi * f * TIME) * np.exp(-TIME / 30) for f in (4.1, 3.6)]
    gap = rows(3 * SAG + ring[0] - ring[1])[:, 0]
    moves = {"mass": rows(-SAG - 0.5 * ring[1]), "damping": rows(-ring[0]), "tilt": rows(0 * SAG - 0.3)}
    projection = Projection(np.zeros((len(gap), 1)), np.ones(1))
    estimator = SimpleNamespace(
        taken=lambda members: frozenset(),
        without=lambda taken: (SimpleNamespace(sigma=np.ones(1)), projection),
        problem=problem(),
    )
    fit = SimpleNamespace(
        places=(), spots=frozenset(), members=(), residual=gap, projected=projection.project(gap),
        jacobian=np.empty((len(gap), 0)), cost=float(gap @ gap),
    )  # fmt: skip

    def candidate(name):
        probe = EncoderOffset(at=name, offset=1e-3)
        return Candidate(EncoderOffset(at=name), ("offset",), (probe,), {"offset": 0.0})

    return estimator, [Probed(candidate(name), move) for name, move in moves.items()], fit


def test_the_right_effect_is_found_by_what_is_slow_in_its_size(out_of_step):
    assert screen(*out_of_step)[0].members[0].at == "damping"
    seen = slow_part(out_of_step[0].problem)
    first = screen(*out_of_step, seen=seen)[0]
    assert first.members[0].at == "mass"
    assert first.members[0].effect.offset == pytest.approx(3e-3, rel=0.1)
    assert first.share > 0.8


def test_sets_of_two_are_looked_at_alike(out_of_step):
    sets = screen_sets(*out_of_step, 2, slow_part(out_of_step[0].problem))
    assert {member.at for member in sets[0].members} >= {"mass"}
    assert sets[0].share > 0.8
