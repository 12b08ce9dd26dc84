"""Missing laws of an unexplained diagnosis: where a motion is missing, of what it is a function, its gap."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from flexarm.arm import Arm
from flexarm.budget import allows
from flexarm.comparison.free_vibration import rings_freely
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit import FIT_ERRORS, Fit
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.sensor_zeros import without_idle_zeros
from flexarm.diagnosis.verification import repaired
from flexarm.effects.tabulated_law import TabulatedLaw, states_of_table
from flexarm.law_curve import LawCurve, LawKind
from flexarm.missing_law.curves import as_torque, curve_in_time, curve_of_fit, curve_of_law, stiffness_of
from flexarm.missing_law.latent import Latent, latent_motions, noise_scale
from flexarm.missing_law.law import Law, LawSearch
from flexarm.missing_law.policy import LawPolicy
from flexarm.missing_law.prediction import LawCheck, gaps_with_law
from flexarm.missing_law.refit import FittedLaw, fitted_law
from flexarm.missing_law.shapes import is_constant
from flexarm.missing_law.states import ANGLE_OF, States, joint_states, other_angles
from flexarm.missing_law.windup import driven_joints

NOTHING = (
    "no missing law was found: no motion of a joint, the base, a link or a sensor and no force at a "
    "payload is more likely than noise"
)
BRANCHES_OF = {
    "law": ("value",),
    "change": ("value", "value_after"),
    "law with memory": ("value", "value_falling"),
}
"""Fields of `tabulated_law` that hold the curves of a law, by its kind."""
STATELESS = ("time", "none")
"""Kinds that are no function of a state."""


@dataclass(frozen=True, eq=False)
class AddedLaw:
    """A law that is an effect of the updated model."""

    fitted: FittedLaw
    """With all that was fitted along."""
    arm: Arm
    """The nominal model with it."""


@dataclass(frozen=True, eq=False)
class MissingLaws:
    """Result of the search: laws, the most probable first."""

    curves: tuple[LawCurve, ...] = ()
    added: AddedLaw | None = None
    """The first of them that is an effect and predicts what was held out."""
    why: str = ""
    """Reason if there are none."""


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A curve, and the law as an effect of the model if it is one."""

    curve: LawCurve
    added: AddedLaw | None = None

    @property
    def evidence(self) -> float:
        return 0.0 if self.added is None else self.added.fitted.model.log_evidence

    @property
    def noise(self) -> float:
        return np.inf if self.added is None else self.added.fitted.model.noise


def missing_laws(
    estimator: Estimator, fits: Sequence[Fit], check: LawCheck, policy: LawPolicy | None = None
) -> MissingLaws:
    """Return the laws that explain what a fitted model leaves, the most probable first.

    `fits` are models that leave a gap, the simplest first. The first to which a law is added is taken, else
    the most likely one with a law that is a function of a state, or the last one. Records must be motions
    along drives, or poses. The result is empty if no latent motion is more likely than none by
    `policy.evidence`.
    """
    policy = policy or LawPolicy()
    if why := not_inferred(estimator.problem, fits[0].nuisance.arm):
        return MissingLaws(why=why)
    tried: list[MissingLaws] = []
    evidence: list[float] = []
    for fit in fits:
        about = _Inference(estimator, fit, check, policy)
        found = [_unless_worse(each) for each in about.laws()]
        fitted = (each for each in found if each.added is not None)
        added = next((each.added for each in fitted if check.accepts(each.curve.held_out, policy)), None)
        tried.append(MissingLaws(tuple(each.curve for each in found), added, "" if found else NOTHING))
        if added is not None:
            return tried[-1]
        evidence.append(about.evidence)
    likely = (tried[k] for k in sorted(range(len(tried)), key=lambda k: -evidence[k]))
    of_state = (laws for laws in likely if any(each.kind not in STATELESS for each in laws.curves))
    return next(of_state, tried[-1])


def _unless_worse(law: _Candidate) -> _Candidate:
    """Return a law, reported as none if the held-out gap grows with it."""
    gap = law.curve.held_out
    if gap.before_rms is None or gap.after_rms is None or gap.after_rms <= gap.before_rms:
        return law
    says = f"{law.curve.says}, but with it the held-out gap grows"
    return _Candidate(replace(law.curve, kind="none", says=says))


def not_inferred(problem: Problem, arm: Arm) -> str:
    """Return why no law can be inferred from these records; empty if one can."""
    for name, record in problem.records.items():
        if record.kind == "motion" and rings_freely(record):
            return f"no missing law was sought: {name} is a free vibration, which no motor's angle drives"
        if not driven_joints(problem, arm, name):
            return f"no missing law was sought: {name} turns no joint by the angle of its motor"
    return ""


def law_remarks(laws: MissingLaws, best: Fit) -> tuple[str, ...]:
    """Return why no law was sought, or that one replaces effects that explain a part of the gap."""
    if laws.added is None:
        return (laws.why,) if laws.why else ()
    left = [f"{name} at {at}" for name, at in best.places if (name, at) not in laws.added.fitted.fit.places]
    law = laws.added.fitted.law
    said = f"the updated model has the law of {law.at} in place of {', '.join(left)}"
    return (said,) if left else ()


@dataclass(frozen=True, eq=False)
class _Place:
    """What is told of a place."""

    latent: Latent
    evidence: float
    """Log evidence of its motion in time, or of its linear law if that is greater."""
    told: list[_Candidate]

    @property
    def simulated(self) -> float:
        """The evidence, or that of a law that was fitted through the simulation."""
        return max([self.evidence, *(each.evidence for each in self.told if each.added is not None)])


@dataclass(frozen=True, eq=False)
class _Inference:
    """Inference of laws given one model."""

    estimator: Estimator
    fit: Fit
    check: LawCheck
    policy: LawPolicy

    @property
    def problem(self) -> Problem:
        return self.estimator.problem

    @cached_property
    def latents(self) -> list[Latent]:
        """Return the latent motions of all places that the time allows."""
        found = []
        for latent in latent_motions(self.problem, self.fit, self.policy):
            found.append(latent)
            if not allows("all places of a missing law were tried"):
                break
        return found

    @property
    def evidence(self) -> float:
        """Return the log evidence of the likeliest latent motion, with parameters as in BIC [Schwarz1978]."""
        scale = float(np.sum(np.log(noise_scale(self.problem, self.fit))))
        cost = 0.5 * len(self.fit.z) * float(np.log(len(self.problem))) + scale
        return max((each.model.log_evidence for each in self.latents), default=-np.inf) - cost

    def laws(self) -> list[_Candidate]:
        """Return the laws of all indistinguishable places."""
        known = [each for each in self.latents if each.gain > self.policy.evidence]
        if not known:
            return []
        thresholds = self.problem.policy
        first = min(map(self._rank, known))
        best = max(each.model.log_evidence for each in known if self._rank(each) == first)
        near = [each for each in known if each.model.log_evidence > best - thresholds.reach]
        near.sort(key=lambda each: -each.model.log_evidence)
        tried = [self._of_place(latent) for latent in near]
        best = max(each.evidence for each in tried if self._rank(each.latent) == first)
        places = [each for each in tried if each.evidence > best - thresholds.reach]
        places.sort(key=lambda each: -each.simulated)
        shares = _shares([each.simulated for each in places], thresholds.most_certain)
        laws = [
            replace(each, curve=replace(each.curve, probability=share * each.curve.probability))
            for place, share in zip(places, shares, strict=True)
            for each in place.told
        ]
        laws.sort(key=lambda each: (each.curve.kind in STATELESS, each.added is None))
        return laws[: self.policy.most_laws]

    def _rank(self, latent: Latent) -> tuple[bool, bool]:
        """Return what ranks places that leave others out: those that leave noise alone first, then joints."""
        return latent.model.noise > self.policy.adequate_noise, latent.slow

    def _of_place(self, latent: Latent) -> _Place:
        """Return a place with its laws over the best state; of a joint also as equivalent torques."""
        in_time, place = curve_in_time(latent, 1.0), partial(_Place, latent, latent.model.log_evidence)
        drifts = latent.length >= max(self.policy.lengths)
        outside = f"the {latent.quantity} at {latent.at} explains the gap; it is no part of the model"
        if latent.response is None:
            told = [_Candidate(replace(in_time, kind="time" if drifts else "none", says=outside))]
            return place(told)
        search, best = self._best_law(latent)
        if best is None:
            says = f"no state of {latent.response.joint} changes"
            return place([_Candidate(replace(in_time, kind="none", says=says))])
        in_blocks = latent.model.predictive(search.blocks)
        if not self._predicts(search, best, in_blocks):
            kind: LawKind = "time" if drifts and in_blocks > best.predictive else "none"
            nothing = f"follows no state: {best.of} explains {search.share(best):.0%}"
            what = "drifts with time" if kind == "time" else nothing
            says = outside if latent.slow else f"the windup of {latent.at} {what}"
            return place([_Candidate(replace(in_time, kind=kind, says=says))])
        place = partial(_Place, latent, max(latent.model.log_evidence, best.model.log_evidence))
        if latent.slow:
            curve = curve_of_law(latent, search, best, self.policy)
            told = list(self._fitted(latent, best, [curve])) or [_Candidate(curve)]
            whose = "" if best.of.startswith(ANGLE_OF) else f", with the {best.of} of {latent.response.joint}"
            return place([replace(each, curve=_said(each, whose, latent.law, self.policy)) for each in told])
        told = self._as_table(latent, search, best) or self._along_states(latent, search, best)
        shares = _shares([each.evidence for each in told], 1.0)
        pairs = zip(told, shares, strict=True)
        return place([replace(each, curve=replace(each.curve, probability=share)) for each, share in pairs])

    def _best_law(self, latent: Latent) -> tuple[LawSearch, Law | None]:
        """Return the best law of a place over states of its joint, if any changes, and the search for it.

        The angle of another joint is taken if it predicts clearly better.
        """

        def over(states: States) -> tuple[LawSearch, Law | None]:
            search = LawSearch(latent, states, self.problem, self.fit, self.policy)
            return search, next(iter(search.best()), None)

        search, best = over(joint_states(latent, self.policy))
        beside, other = over(other_angles(latent, self.policy))
        if other and (best is None or other.predictive > best.predictive + self.policy.evidence):
            return beside, other
        return search, best

    def _predicts(self, search: LawSearch, law: Law, in_blocks: float) -> bool:
        """Return True if a law explains enough, and predicts no worse than the motion in time does."""
        latent, share = search.latent, search.share(law)
        if latent.slow:  # told without a simulation of the law
            predicts = law.model.log_evidence > latent.model.log_evidence
        else:
            predicts = law.predictive > in_blocks - self.policy.evidence or share > self.policy.clear_share
        return predicts and share >= self.policy.least_share

    def _as_table(self, latent: Latent, search: LawSearch, best: Law) -> list[_Candidate]:
        """Return the law of a state, fitted through the simulation; one curve if that leaves only noise."""
        law = best if best.kind == "law" else search.law(best.of)
        told: list[_Candidate] = []
        if search.share(law) >= self.policy.least_share:
            told = list(self._fitted(latent, law, self._curves(latent, search, law)))
        if best.kind == "law":
            return told
        alone = [each for each in told if each.noise < self.policy.adequate_noise]
        return alone or list(self._fitted(latent, best, self._curves(latent, search, best)))

    def _curves(self, latent: Latent, search: LawSearch, law: Law) -> list[LawCurve]:
        """Return a law as a windup and, unless a function of torque, as an equivalent torque."""
        curve, stiffness = curve_of_law(latent, search, law, self.policy), stiffness_of(latent)
        return [as_torque(curve, stiffness), curve] if law.of != "torque" and stiffness else [curve]

    def _along_states(self, latent: Latent, search: LawSearch, law: Law) -> list[_Candidate]:
        """Return laws that are no effect of a model, with the gap that runs along their windup leave."""
        held_out = self.check.records.held_out
        train, held = gaps_with_law(latent, law, self.problem, held_out, self.check.signal, self.policy)
        curves = self._curves(latent, search, law)
        return [_Candidate(replace(each, train=train, held_out=held)) for each in curves]

    def _fitted(self, latent: Latent, law: Law, curves: Sequence[LawCurve]) -> Iterator[_Candidate]:
        """Yield laws as effects of a model, fitted through the simulation."""
        has_one = self.fit.nuisance.arm.effect(TabulatedLaw.name, latent.at) is not None
        if law.of == "motor_angle" or has_one or law.only >= 0:
            return
        stiffness = stiffness_of(latent)
        for curve in curves:
            keys = latent.law if latent.slow else {"quantity": curve.quantity}
            if keys is None or law.of not in states_of_table(keys["quantity"], curve.at):
                continue
            if law.kind == "law with memory" and (curve.quantity, law.of) != ("torque", "angle"):
                continue
            if not allows("the law was fitted through the simulation"):
                continue
            table = _table(law, curve, stiffness, keys)
            try:
                fitted = fitted_law(self.estimator, self.fit, table, self.policy)
                arm = repaired(self.problem.arm, fitted.fit, fitted.sizes)
                arm = without_idle_zeros(arm, self.check.stated)
                train, held_out = self.check.gaps(arm)
            except FIT_ERRORS:
                continue
            told = replace(
                curve_of_fit(curve, fitted, stiffness, self.policy), train=train, held_out=held_out
            )
            yield _Candidate(told, AddedLaw(fitted, arm))


def _said(told: _Candidate, whose: str, law: Mapping[str, str] | None, policy: LawPolicy) -> LawCurve:
    """Return the curve of a slow motion with the joint whose state it is of, and why it is no effect.

    A constant rotation across a joint is its place in the model. `law` is that of `Latent`.
    """
    curve, why = told.curve, ""
    if is_constant(np.array(curve.value), policy):
        whose = ""
    if told.added is None and law is None and not whose:
        why = f'; in the model it is the origin of {curve.at}: with an uncertainty "joints.{curve.at}.origin.'
        why += 'rpy_rad" a diagnosis refines it'
    elif told.added is None:
        why = "; it is no part of the model"
        if law is None:
            why += ", which has no table for a rotation of a joint across its axis"
        elif curve.of not in states_of_table(law["quantity"], curve.at):
            why += f", which has no table of the {curve.of.replace('_', ' ')} there"
    return replace(curve, says=f"{curve.says}{whose}{why}")


def _table(law: Law, curve: LawCurve, stiffness: float, keys: Mapping[str, str]) -> TabulatedLaw:
    """Return the linear estimate of a law as an effect."""
    per_windup = -stiffness if curve.quantity == "torque" else 1.0
    branches = dict(zip(BRANCHES_OF[law.kind], law.mean.reshape(-1, len(law.knots)), strict=True))
    return TabulatedLaw.model_validate(
        {
            "at": curve.at,
            **keys,
            "of": curve.of,
            "x": law.knots,
            "instant": law.instant[0] if law.instant else None,
            **{name: per_windup * each for name, each in branches.items()},
        }
    )


def _shares(evidence: Sequence[float], most: float) -> list[float]:
    """Return probabilities from log evidence and equal priors, each at most `most`."""
    weight = np.exp(np.array(evidence) - max(evidence, default=0.0))
    return [min(float(each), most) for each in weight / weight.sum()]
