r"""Values and intervals of everything that was fitted, by a block bootstrap.

Residuals of a fit are not independent: what the model lacks lasts, and poses of a record share it. So whole
groups of rows (`choosing.left_out`), blocks of time or static records, all channels together, are
drawn with replacement, and the fit is repeated to first order [Kuensch1989]:

.. math:: p_b = p - H^{-1} \Bigl( \sum_j (w_{jb} - 1) g_j - \xi_b / \sigma \Bigr), \quad
   H = J^T J + \Lambda, \quad g_j = \sum_{i \in j} J_i^T r_i                                           (1)

w_jb is how often group j was drawn; static records are few and each pulls the fit towards itself, so r_i is
there what is missed if the record is left out. J are the derivatives by effects' parameters and unknowns
together, Lambda their priors' weights. What a prior contributes is uncertain by the prior's own sigma,
xi ~ N(0, 1), so that what the data leave open keeps the width of its prior.

No simulation is exact, and a fit hides from its own residual what the simulation errs in the direction of its
parameters. An error moves like what it is an error of, but out of phase with it: a surrogate [Theiler1992] of
the parameter's own column of J has the same spectrum with random phases, here as large as `DISCREPANCY` of
the noise where it is largest. With a = J H^-1 u_p, by which a parameter depends on residuals, and transforms
A and S of a and of that surrogate in a channel of n samples, it adds the variance

.. math:: \sum_\text{channels} \frac{1}{n^2} \sum_f |A_f|^2 |S_f|^2                                   (2)

Intervals are quantiles of p_b, mapped to the parameters' own scales.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.choosing.evidence import DISCREPANCY
from flexarm.diagnosis.choosing.left_out import groups, joint_slopes, left_out, poses
from flexarm.diagnosis.fitting.fit import Fit
from flexarm.diagnosis.named import Estimate, Nuisance, Refined
from flexarm.diagnosis.residuals.observed import Observed

DRAWS = 600


@dataclass(frozen=True, eq=False)
class Estimates:
    """What was fitted, with its uncertainty.

    Attributes
    ----------
    effects : list of tuple of Estimate
        For each effect of the fit.
    nuisances : tuple of Nuisance
        Clocks and frames.
    refined : tuple of Refined
        Nominal values.
    """

    effects: list[tuple[Estimate, ...]]
    nuisances: tuple[Nuisance, ...]
    refined: tuple[Refined, ...]


def estimates(fit: Fit, observed: Observed, seed: int = 0) -> Estimates:
    """Eq. (1) for a fit."""
    moved = draws(fit, observed, np.random.default_rng(seed))
    k = len(fit.z)
    return Estimates(
        [_of_effect(fit, i, moved[:, :k]) for i in range(len(fit.members))], *_of_unknowns(fit, moved[:, k:])
    )


def draws(fit: Fit, observed: Observed, rng: np.random.Generator, discrepancy: float = DISCREPANCY) -> Floats:
    """p_b - p of (1), shape (DRAWS, k + m)."""
    slopes, residual, prior = joint_slopes(fit)
    count = slopes.shape[1]
    scale = 1.0 / np.sqrt(np.maximum(np.sum(slopes**2, axis=0) + prior, 1e-300))
    misses = np.where(poses(observed), left_out(fit, observed), residual)
    g = np.stack([(slopes[rows].T @ misses[rows]) * scale for rows in groups(observed) if len(rows)])
    hessian = (slopes * scale).T @ (slopes * scale) + np.diag(prior * scale**2)
    inverse = np.linalg.pinv(hessian, hermitian=True)
    weights = rng.multinomial(len(g), np.full(len(g), 1.0 / len(g)), size=DRAWS) - 1.0
    xi = rng.standard_normal((DRAWS, count))
    moved: Floats = -(weights @ g - xi * np.sqrt(prior) * scale) @ inverse * scale  # eq. (1)
    errors = discrepancy * surrogates(observed, slopes, scale[:, None] * inverse * scale)
    return moved + errors * rng.standard_normal((DRAWS, count))


def surrogates(observed: Observed, slopes: Floats, inverse: Floats) -> Floats:
    """Root of (2) for an error as large as the noise, shape (k + m,); inverse: H^-1."""
    channels = [where for _, where in observed.channels()]
    largest = np.max([np.mean(slopes[where] ** 2, axis=0) for where in channels], axis=0)
    shapes = slopes / np.sqrt(np.maximum(largest, 1e-300))
    depends = slopes @ inverse
    variance = np.zeros(slopes.shape[1])
    for where in channels:
        a, s = (np.abs(np.fft.fft(x[where], axis=0)) for x in (depends, shapes))
        variance += np.sum((a * s) ** 2, axis=0) / len(a) ** 2  # eq. (2)
    return np.sqrt(variance)


def _of_effect(fit: Fit, i: int, moved: Floats) -> tuple[Estimate, ...]:
    member = fit.members[i]
    places = {c.name: j for j, c in enumerate(fit.coordinates) if c.candidate == i}
    found = []
    for name, value, unit in member.effect.parameters():
        if name not in places:
            continue
        j = places[name]
        coordinate, z = fit.coordinates[j], float(fit.z[j])
        reach = max(coordinate.bound, abs(z))
        values = np.array([coordinate.value(float(np.clip(z + dz, -reach, reach))) for dz in moved[:, j]])
        low, high = (float(q) for q in np.quantile(values, [0.05, 0.95]))
        own = coordinate.prior.unit if unit == "SI" else unit  # that of the signal
        turns = whole_turns(value) if name == "phase" else 0.0
        ends = (min(low, value) - turns, max(high, value) - turns)
        found.append(Estimate(name, value - turns, float(values.std()), *ends, own))
    return tuple(found)


def whole_turns(phase: float) -> float:
    """What a phase is beyond half a turn either way [rad], in whole turns."""
    return 2 * pi * round(phase / (2 * pi))


def _of_unknowns(fit: Fit, moved: Floats) -> tuple[tuple[Nuisance, ...], tuple[Refined, ...]]:
    best = fit.projection.best(fit.residual)
    nuisances: dict[tuple[str, str], list[Estimate]] = {}
    refined = []
    for j, unknown in enumerate(fit.unknowns.each):
        if unknown.kind == "start":
            continue
        value, std = unknown.centre + unknown.kept(float(best[j])), float(moved[:, j].std())
        if unknown.kind == "nominal":
            refined.append(Refined(unknown.key, value, std, unknown.centre, unknown.unit))
            continue
        low, high = (value + float(q) for q in np.quantile(moved[:, j], [0.05, 0.95]))
        name = unknown.key.split(".", 3)[3]
        nuisances.setdefault(unknown.place, []).append(Estimate(name, value, std, low, high, unknown.unit))
    return tuple(Nuisance(*place, tuple(each)) for place, each in nuisances.items()), tuple(refined)
