r"""Laws: a latent motion as a function of a state of its joint.

The motion is the spline in time nearest to a curve f over knots of the state y,

.. math:: c = (N^T N)^{-1} N^T H(y) f, \quad f \sim N(0, s^2 K(\ell)), \quad
          r \approx r_0 + J c + J_x x + e                                                             (1)

N are the splines and y the state at instants much finer than their knots, H interpolates linearly between
knots of the curve, K is the Matern covariance of these. So a curve is inferred from the data, not from the
latent motion. A *law* has one curve; a *law with memory* one for each sense of the motion; a *change* one
before and one after an instant, in each record or once in one of them. Hyperparameters maximise the marginal
likelihood; the kind and the state are selected by the predictive density of blocks left out (`gaussian`,
eq. (3)). The probability of an
instant is that of the evidence over all instants.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.sparse import block_diag as sparse_diagonal
from scipy.sparse import csr_matrix, diags

from flexarm.arrays import Floats, read_only
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.problem import Problem
from flexarm.law_curve import LawKind
from flexarm.missing_law.gaussian import ColumnSpace, GaussianModel, matern_root
from flexarm.missing_law.latent import Latent, noise_scale
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.states import States

Mask = NDArray[np.bool_]
SIGNED = ("rate", "torque")
"""States whose sign matters: friction and play change near zero."""


@dataclass(frozen=True, eq=False)
class Law:
    """A curve or two over a state."""

    kind: LawKind
    """One curve, one for each sense of motion ("law with memory"), or one before and after a "change"."""
    of: str
    knots: Floats
    """Of the state, shape (k,)."""
    mean: Floats
    root: Floats
    """Posterior mean and a root of the covariance of the curves' values, b curves one after the other."""
    model: GaussianModel
    """Eq. (1)."""
    predictive: float
    """Log predictive density of blocks left out."""
    left: float
    """Squared residual that the curve leaves."""
    instant: tuple[float, ...] = ()
    """When it changes, and the 90 % interval [s]; empty without one."""
    only: int = -1
    """Number of the record in which it changes; -1: in each."""

    def curve(self, which: int) -> tuple[Floats, Floats]:
        """Return mean and covariance of one of the curves, shapes (k,) and (k, k)."""
        rows = slice(which * len(self.knots), (which + 1) * len(self.knots))
        return self.mean[rows], self.root[rows] @ self.root[rows].T

    def values(self, states: dict[str, Floats], time: Floats, record: int = -1) -> Floats:
        """Return the motion at states and instants; `record` is -1 for one that was not fitted."""
        y = states[self.of]
        curves = [
            np.interp(y, self.knots, self.curve(k)[0]) for k in range(len(self.mean) // len(self.knots))
        ]
        if self.kind == "law with memory":
            return np.where(states["rate"] >= 0, curves[0], curves[1])
        if self.kind == "change":
            return np.where(
                _after(time, np.full(len(time), record), self.instant[0], self.only), *curves[::-1]
            )
        return curves[0]


def _after(time: Floats, record: np.ndarray, instant: float, only: int) -> Mask:
    """Return where an instant is over; `only` as of `Law`."""
    if only < 0:
        return np.asarray(time >= instant)
    return np.asarray((record > only) | ((record == only) & (time >= instant)) | (record < 0))


def knots_over(of: str, y: Floats, policy: LawPolicy) -> Floats:
    r"""Return the knots of a curve over a state, shape (k,); of signed states they are dense at zero.

    .. math:: x = \sinh(u)/c, \quad c = \sinh(a)/\max |y|
    """
    beyond = float(np.ptp(y)) / policy.curve_knots
    low, high = float(y.min()) - beyond, float(y.max()) + beyond
    if of not in SIGNED:
        return np.linspace(low, high, policy.curve_knots)
    c = np.sinh(policy.knot_density) / max(-low, high)
    return np.asarray(np.sinh(np.linspace(np.arcsinh(c * low), np.arcsinh(c * high), policy.curve_knots)) / c)


@cache
def curve_matern(count: int, length: float) -> Floats:
    """Return a root of the Matern covariance of knots, which are one apart over their range."""
    return read_only(matern_root(np.linspace(0.0, 1.0, count), length))


def _interpolation(y: Floats, knots: Floats) -> csr_matrix:
    """Return H of (1), shape (len(y), len(knots)), held beyond the knots."""
    held = np.clip(y, knots[0], knots[-1])
    below = np.clip(np.searchsorted(knots, held, side="right") - 1, 0, len(knots) - 2)
    above = (held - knots[below]) / (knots[below + 1] - knots[below])
    rows = np.arange(len(y))
    return csr_matrix(
        (
            np.concatenate([1 - above, above]),
            (np.concatenate([rows, rows]), np.concatenate([below, below + 1])),
        ),
        shape=(len(y), len(knots)),
    )


def blocks_of(problem: Problem, policy: LawPolicy) -> list[NDArray[np.intp]]:
    """Return rows of blocks of time, or of interleaved poses, all signals of a record together."""
    found = []
    for name in problem.records:
        rows = list(problem.rows_of(name))
        time = np.concatenate([each.time for each in rows])
        place = np.concatenate([np.arange(each.where.start, each.where.stop) for each in rows])
        if problem.records[name].kind == "static":
            number = np.rint(time).astype(int) % policy.blocks
        else:
            edges = np.linspace(time.min(), time.max(), policy.blocks + 1)[1:-1]
            number = np.searchsorted(edges, time)
        found += [place[number == k] for k in range(policy.blocks) if np.any(number == k)]
    return found


class LawSearch:
    """Curves of a latent motion over the states of its joint."""

    def __init__(self, latent: Latent, states: States, problem: Problem, fit: Fit, policy: LawPolicy) -> None:
        assert latent.response is not None
        self.latent, self.states, self.policy = latent, states, policy
        self.blocks = blocks_of(problem, policy)
        bases = latent.response.bases.values()
        splines = [basis.at(basis.fine(policy)) for basis in bases]
        inverse = block_diag(*(np.linalg.inv(each.T @ each) for each in splines))
        response = (latent.response.jacobian / noise_scale(problem, fit)[:, None]) @ inverse
        self.space = ColumnSpace.of(latent.data, response)
        self.splines = sparse_diagonal([csr_matrix(each) for each in splines]).tocsr()  # without zeros
        self._curves: dict[str, tuple[Floats, csr_matrix, Floats]] = {}
        self.explained = max(self.left_without - latent.model.left(), 1e-300)

    @property
    def left_without(self) -> float:
        """Squared residual without the motion."""
        return self.latent.data.cost()

    def motion(self) -> Floats:
        """Return the latent motion where states are known, shape (m,)."""
        return np.asarray(self.splines @ self.latent.mean)

    def share(self, law: Law) -> float:
        """Part of what the latent motion explains that a law explains [-]."""
        return (self.left_without - law.left) / self.explained

    def law(self, of: str) -> Law:
        """Return the law of a state."""
        return self._fitted("law", of, [np.ones(len(self.states.time), dtype=bool)])

    def with_memory(self, of: str) -> Law:
        """Return the law with memory of a state."""
        return self._fitted("law with memory", of, [self.states.rising, ~self.states.rising])

    def change(self, of: str, length: float) -> Law | None:
        """Return the law that changes at the most likely instant."""
        tried = [(each, self._evidence_of_change(of, each, length)) for each in self._instants()]
        if not tried:
            return None
        (instant, only), _ = max(tried, key=lambda each: each[1])
        step = float(np.ptp(self.states.time)) / self.policy.instants
        near = instant + np.linspace(-step, step, 2 * self.policy.finer + 1)
        values = np.array([self._evidence_of_change(of, (t, only), length) for t in near])
        weight = np.exp(values - values.max())
        share = np.cumsum(weight) / weight.sum()
        at = float(near[int(np.argmax(values))])
        half = float(near[1] - near[0]) / 2
        low, high = (float(np.interp(p, share, near + half)) for p in (0.05, 0.95))
        interval = (min(low, at - half), max(high, at + half))
        return self._fitted("change", of, self._sides(at, only), (at, *interval), only, (length,))

    def _instants(self) -> Iterator[tuple[float, int]]:
        time, record = self.states.time, self.states.record
        inner = np.linspace(time.min(), time.max(), self.policy.instants + 2)[1:-1]
        count = int(record.max()) + 1
        yield from ((float(t), -1) for t in inner)
        if count > 1:
            yield from ((float(t), k) for k in range(count) for t in inner if t < time[record == k].max())

    def _sides(self, instant: float, only: int) -> list[Mask]:
        after = _after(self.states.time, self.states.record, instant, only)
        return [~after, after]

    def _evidence_of_change(self, of: str, when: tuple[float, int], length: float) -> float:
        sides = self._sides(*when)
        if min(map(np.count_nonzero, sides)) < len(self.states.time) // self.policy.instants:
            return -np.inf
        return self.space.log_evidence(self._root(of, sides, length)[0])

    def _root(self, of: str, masks: Sequence[Mask], length: float) -> tuple[Floats, Floats, Floats]:
        """Return what turns unit normals into coefficients of splines, and into values at knots; knots."""
        knots, between, whole = self._curve(of)
        parts = [whole]
        if len(masks) == 2:  # which share all states
            one = (self.splines.T @ (diags(masks[0].astype(float)) @ between)).toarray()
            parts = [one, whole - one]
        matern = curve_matern(len(knots), length)
        root = block_diag(*[matern] * len(masks))
        return np.column_stack([part @ matern for part in parts]), root, knots

    def _curve(self, of: str) -> tuple[Floats, csr_matrix, Floats]:
        """Return the knots of a state, H of (1), and N^T H."""
        if of not in self._curves:
            y = self.states.values[of]
            knots = knots_over(of, y, self.policy)
            between = _interpolation(y, knots)
            self._curves[of] = knots, between, (self.splines.T @ between).toarray()
        return self._curves[of]

    def _fitted(
        self,
        kind: LawKind,
        of: str,
        masks: Sequence[Mask],
        instant: tuple[float, ...] = (),
        only: int = -1,
        lengths: Sequence[float] = (),
    ) -> Law:
        tried = [self._root(of, masks, length) for length in lengths or self.policy.curve_lengths]
        to_splines, root, knots = max(tried, key=lambda each: self.space.log_evidence(each[0]))
        model = self.space.model(to_splines)
        root = root * model.size
        mean, deviation = model.posterior()
        return Law(
            kind,
            of,
            knots,
            root @ mean,
            np.sqrt(model.noise) * (root @ deviation),
            model,
            model.predictive(self.blocks),
            model.left(),
            instant,
            only,
        )

    def best(self) -> list[Law]:
        """Return a law of each state, the most predictive first."""
        return sorted((self._simplest(each) for each in self.states.values), key=lambda law: -law.predictive)

    def _simplest(self, of: str) -> Law:
        """Return the law of a state of the simplest kind that no other clearly outdoes."""
        chosen = self.law(of)
        if "rate" not in self.states.values:  # of poses
            return chosen
        length = max(self.policy.curve_lengths)
        for other in (self.with_memory(of), self.change(of, length)):
            if (
                other is not None
                and other.predictive > chosen.predictive + self.policy.evidence
                and self.share(other) > self.share(chosen) + self.policy.memory_share
            ):
                chosen = other
        return chosen
