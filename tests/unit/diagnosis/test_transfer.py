"""What a repair says of parts of the training that it was not fitted to, on made-up linear problems."""

from types import SimpleNamespace

import numpy as np
import pytest

from flexarm.diagnosis.cross_validation import cross_validated_skill
from flexarm.diagnosis.fit import Projection

N = 100
TIMES = np.linspace(0, 10, N)


class OneRecord:
    """One record with one channel."""

    def __init__(self) -> None:
        self.records = {"run": None}
        row = SimpleNamespace(record="run", signal="tip", channel=0, time=TIMES)
        self.rows = (row,)

    def __len__(self) -> int:
        return N

    def channels(self):
        return [(self.rows[0], slice(0, N))]


def fit_of(gap: np.ndarray, moves: np.ndarray | None) -> SimpleNamespace:
    """Least squares for the sizes of moves, beside a frame that shifts all rows by 1 at most."""
    k = 0 if moves is None else moves.shape[1]
    moves = np.empty((N, 0)) if moves is None else moves
    size = np.linalg.lstsq(moves, -gap, rcond=None)[0] if k else np.zeros(0)
    parameter = SimpleNamespace(held=1 / 3)
    return SimpleNamespace(
        z=size,
        residual=gap + moves @ size,
        jacobian=moves,
        parameters=[parameter] * k,
        projection=Projection(np.ones((N, 1)), np.ones(1)),
        nuisance=SimpleNamespace(parameters=[SimpleNamespace(kind="frame")], sigma=np.ones(1)),
    )


def test_the_right_law_foretells_every_part():
    """Noise 1 is left; of 10 sin t the frame, aligned anew in each fifth, leaves 4.5 rms: 1 - 1/4.5."""
    law = np.sin(TIMES)
    gap = 10 * law + np.random.default_rng(2).standard_normal(N)
    found = cross_validated_skill(fit_of(gap, law[:, None]), fit_of(gap, None), gap, OneRecord())
    assert found == pytest.approx(0.78, abs=0.04)


def test_what_only_imitates_fails_where_the_data_end():
    """High powers of time fit a wave well, and say nothing of a part that they have not seen."""
    gap = 10 * np.sin(1.5 * TIMES)
    powers = 1e6 * np.stack([(TIMES / 10) ** k for k in range(1, 9)], axis=1)  # sizes within their priors
    imitation = fit_of(gap, powers)
    assert imitation.residual.std() < 0.5 * gap.std()
    assert cross_validated_skill(imitation, fit_of(gap, None), gap, OneRecord()) <= 0.0
