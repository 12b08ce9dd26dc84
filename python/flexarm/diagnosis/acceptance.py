"""Criteria of the search: when an effect is accepted, a model is adequate, and looking for more stops.

With e the residual of a model after its nuisance parameters x were eliminated, and s_c its residual above the
noise in channel c (eq. (2) of `diagnosis.evidence`; s_c0 of the model without effects), a larger model is
practically significant if in some channel it explains

    p_c = sqrt(mean over c of (e_old^2 - e_new^2)) > max(significant_noise, significant_share s_c0),   (1)

or if it resolves a prior-data conflict, the sum of pulls beyond two sigma,

    S = sum_i max(|x_i|/sigma_i - pull, 0).                                                            (2)

A model explains everything, and is adequate, or leaves a gap, respectively, if

    s_c <= max(significant_noise, adequate_share s_c0/2) in every channel, and S < conflict;           (3)
    max_c s_c > max(adequate_noise, adequate_share max_c s_c0).                                        (4)

An effect is accepted if its evidence is strong and it is significant, unless it is a clock or a frame within
its stated uncertainty, where the smaller model has it too. If it leaves a gap, it must also reduce it,

    C_new < (1 - least_reduction) C_old, or S_new < S_old - conflict,                                  (5)

and predict data left out better than the smaller model does. A clearly better prediction needs no other
evidence, which rests on size and correlation of an unknown residual. Nor does an equal prediction that is
far more plausible, with Student's t as prior of all values z, in sigma, that a model needs:

    U = 2 sum ln(1 + z^2/3).                                                                           (6)

Thresholds: `SelectionPolicy`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from flexarm.arrays import Floats
from flexarm.diagnosis.cross_validation import log_odds_lost, predicts_better, press_rms
from flexarm.diagnosis.evidence import above_noise, log_bayes_factor
from flexarm.diagnosis.fit import Fit
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem


@dataclass(frozen=True)
class Criteria:
    """Criteria for models of one problem."""

    problem: Problem
    """The records, and the policy."""
    null: Fit
    """The model without effects."""

    @property
    def policy(self) -> SelectionPolicy:
        """Thresholds."""
        return self.problem.policy

    def accepts(self, new: Fit, old: Fit) -> bool:
        """Return True if the evidence for a larger model is strong and what it explains is significant."""
        resolves = self.resolves_conflict(new, old)
        if self.as_stated(new, old) or not (self.significant(new, old) or resolves):
            return False
        enough = self.policy.relief_evidence if resolves else self.policy.strong_evidence
        strong = log_bayes_factor(new, old, self.problem) > enough
        if not self.leaves_gap(new):
            return strong
        if not self.reduces(new, old):
            return False
        if strong:
            return press_rms(new, self.problem) < press_rms(old, self.problem)
        return predicts_better(new, old, self.problem) or self.far_more_plausible(new, old)

    def far_more_plausible(self, new: Fit, old: Fit) -> bool:
        """Return True if the odds of (6) are strong, alone and with those of cross-validation."""
        gained = implausibility(old) - implausibility(new)
        lost, least = log_odds_lost([new, old], self.problem)
        strong = self.policy.strong_evidence
        return gained > strong and gained + least - lost > strong

    def as_stated(self, new: Fit, old: Fit) -> bool:
        """Return True if the added effect is a clock or frame shift within its stated uncertainty."""
        stated = {u.key: u for u in old.nuisance.parameters}
        pulls = [
            abs(value - stated[key].centre) / stated[key].sigma
            for member in new.members
            if member.place not in old.places
            for name, value, _ in member.parameters_in(new.nuisance.arm)
            for key in member.keys_of(name)
            if key in stated
        ]
        return bool(pulls) and max(pulls) < self.policy.pull

    def significant(self, new: Fit, old: Fit) -> bool:
        """Return True if a larger model explains enough of the gap in some channel, eq. (1)."""
        first, policy = self._varying(self.null), self.policy
        for each, where in self.problem.channels():
            square = float(np.mean(old.projected[where] ** 2) - np.mean(new.projected[where] ** 2))
            least = policy.significant_share * first[each.record, each.signal, each.channel]
            if np.sqrt(max(square, 0.0)) > max(policy.significant_noise, least):  # eq. (1)
                return True
        return False

    def reduces(self, new: Fit, old: Fit) -> bool:
        """Return True if a larger model that leaves a gap reduces it enough, or resolves a conflict."""
        return self.resolves_conflict(new, old) or (
            new.cost < (1.0 - self.policy.least_reduction) * old.cost  # eq. (5)
        )

    def conflict(self, fit: Fit) -> float:
        """Return the prior-data conflict of a model [sigma], eq. (2)."""
        return conflict(fit, self.policy)

    def in_conflict(self, fit: Fit) -> bool:
        """Return True if nuisance parameters of a model are in conflict with their priors."""
        return self.conflict(fit) > self.policy.conflict

    def resolves_conflict(self, new: Fit, old: Fit) -> bool:
        """Return True if a larger model resolves a prior-data conflict."""
        return self.conflict(old) - self.conflict(new) > self.policy.conflict

    def leaves_most(self, fit: Fit) -> bool:
        """Return True if a model leaves most of the gap without effects, or of the conflict if no gap."""
        most = self.policy.halfway
        if not beyond_noise(fit) > most * beyond_noise(self.null):
            return False
        return self.conflict(fit) > most * self.conflict(self.null) or self.leaves_gap(fit)

    def hardly_helps(self, fit: Fit) -> bool:
        """Return True if a model explains little of the gap without effects, and of the conflict."""
        left, before = 1.0 - self.policy.hardly_helps, self.conflict(self.null)
        little = beyond_noise(fit) > left * beyond_noise(self.null)
        return little and (self.conflict(fit) > left * before or before < self.policy.conflict)

    def explains(self, fit: Fit) -> bool:
        """Return True if nothing significant is left, and no conflict, eq. (3)."""
        return self.adequate(fit) and self.conflict(fit) < self.policy.conflict

    def adequate(self, fit: Fit) -> bool:
        """Return True if nothing significant is left above the noise, whatever the conflict."""
        first, left, policy = self._varying(self.null), self._above_noise(fit), self.policy
        share = policy.adequate_share / 2
        return all(left[c] <= max(policy.significant_noise, share * first[c]) for c in left)

    def leaves_anything(self, fit: Fit) -> bool:
        """Return True if a model leaves more than the noise, in whatever part of the gap."""
        return max(self._above_noise(fit).values()) > self.policy.adequate_noise

    def leaves_gap(self, fit: Fit, share: float | None = None) -> bool:
        """Return True if something else must be there, eq. (4); `share` replaces `adequate_share`."""
        share = self.policy.adequate_share if share is None else share
        first, left = max(self._varying(self.null).values()), max(self._above_noise(fit).values())
        return left > max(self.policy.adequate_noise, share * first)  # eq. (4)

    def all_leave_gaps(self, fits: Sequence[Fit]) -> bool:
        """Return True if each of some models leaves a gap."""
        return all(self.leaves_gap(fit) for fit in fits)

    def early_stop(self, found: Sequence[Fit], without: Fit, part: float) -> float:
        """Return C above which a fit is terminated early; infinite without any fit to compare with.

        That is some `part` of the way from the best fit back to none, and `alike` above the best in any case.
        """
        least = min((f.cost for f in found), default=inf)
        alike = (1 + self.policy.alike) * least
        return least if least == inf else alike + part * max(without.cost - least, 0.0)

    def _varying(self, fit: Fit) -> dict[tuple[str, str, int], float]:
        """Return what a model leaves above the noise without the constant of each channel.

        Shares refer to that: given an offset, a motion is a small part of the gap, and no small effect.
        """
        return above_noise(without_constants(fit.projected, self.problem), self.problem, fit.non_smooth)

    def _above_noise(self, fit: Fit) -> dict[tuple[str, str, int], float]:
        return above_noise(fit.projected, self.problem, fit.non_smooth)


def without_constants(rest: Floats, problem: Problem) -> Floats:
    """Return a residual without the mean of each channel."""
    found = rest.copy()
    for _, where in problem.channels():
        found[where] -= np.mean(rest[where])
    return found


def conflict(fit: Fit, policy: SelectionPolicy) -> float:
    """Return the prior-data conflict of a model [sigma], eq. (2)."""
    z = np.abs(fit.projection.solve(fit.residual)) / fit.nuisance.sigma
    return float(np.sum(np.maximum(z - policy.pull, 0.0)))  # eq. (2)


def beyond_noise(fit: Fit) -> float:
    """Return C of a model less that of white noise of the stated size."""
    return max(fit.cost - len(fit.residual), 0.0)


def implausibility(fit: Fit) -> float:
    """Return U, the log density of the values of a model below that of their modes, eq. (6)."""
    known = [float(z) for c, z in zip(fit.parameters, fit.z, strict=True) if c.prior.scale != "uniform"]
    unknown = fit.projection.solve(fit.residual) / fit.nuisance.sigma
    return float(2.0 * np.sum(np.log1p(np.square([*known, *unknown]) / 3.0)))  # eq. (6)
