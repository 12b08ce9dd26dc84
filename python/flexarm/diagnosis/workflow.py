"""The diagnosis: check -> align -> simulate -> localise -> screen -> fit -> choose -> patch -> verify.

Each step is a function of its own module, with a result that one can look at alone; this page calls them in
their order.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from flexarm.arguments import FLAG, POLICY, takes
from flexarm.arm import Arm
from flexarm.arm.spring_effect import SpringEffect
from flexarm.budget import allows, budgeted, current, ended_early
from flexarm.configuration import version
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidates import candidates, dominant_frequencies
from flexarm.diagnosis.coarse_encoders import CoarseEncoder, with_errors_of_drives
from flexarm.diagnosis.design.next_experiment import NextExperiment, next_experiment
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.fit_statistics import constancy, fit_statistics
from flexarm.diagnosis.hold_out import left_out, masked_outliers, named_hold_out, outlier_remarks, split
from flexarm.diagnosis.naming import (
    named_effects,
    noise_remarks,
    payload_remarks,
    rejected,
    transient_remarks,
    unfitted_remarks,
)
from flexarm.diagnosis.noise_model import (
    discretisation_remarks,
    impute_noise,
    input_noise_by_signal,
    input_noise_errors,
    input_noise_remarks,
    step_remarks,
    with_fine_step,
)
from flexarm.diagnosis.nuisance import counted_from_stamps, nuisance_model
from flexarm.diagnosis.policy import FIT, SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.residual_rows import greatest_by_signal
from flexarm.diagnosis.result import Diagnosis, Verdict, adequate_if_predicted
from flexarm.diagnosis.screening import probe
from flexarm.diagnosis.selection import Choice, choose
from flexarm.diagnosis.sensor_zeros import of_model, set_zeros, with_zeros, without_idle_zeros
from flexarm.diagnosis.uncertainty import (
    Estimates,
    bound_sentence,
    estimates,
    has_implausible_size,
    restore_unidentifiable,
)
from flexarm.diagnosis.verification import SplitRecords, main_signal, repaired, verified, worth_keeping
from flexarm.missing_law.prediction import LawCheck
from flexarm.missing_law.search import MissingLaws, law_remarks, missing_laws
from flexarm.named_effects import NamedEffect, Refined
from flexarm.threads import one_blas_thread
from flexarm.validation.sensor_check import check, clean_records, named_records

if TYPE_CHECKING:
    from flexarm.record import Record

Progress = Callable[[float, str], object] | None


@takes(policy=POLICY, laws=FLAG)
@budgeted
@one_blas_thread()
def diagnose(
    arm: Arm,
    records: Mapping[str, Record] | Sequence[Record],
    hold_out: Record | None = None,
    *,
    n_jobs: int | None = None,
    seed: int = 0,
    step: float = 2e-3,
    alpha: float = -0.05,
    policy: SelectionPolicy | None = None,
    max_seconds: float | None = None,
    laws: bool = True,
    progress: Progress = None,
) -> Diagnosis:
    """Name the physical effect that a model lacks, where it sits, and how sure that is.

    Parameters
    ----------
    arm : Arm
        The nominal model, with `[uncertainty]` where values are uncertain.
    records : dict of str to Record, or sequence of Record
        What to explain; all are fitted together.
    hold_out : Record, optional
        Never used for fitting or choosing: the check of the repair, without its outliers. Without one, blocks
        of time are held back.
    n_jobs : int, optional
        Number of simulations at once; default one a core.
    seed : int
        Of what is drawn at random; same seed, same answer.
    step, alpha : float
        Of all simulations [s], [-]; records that ask for it get half or a quarter of the step.
    policy : SelectionPolicy, optional
        Thresholds of the search; all have a default.
    max_seconds : float, optional
        Time for the search [s]: then it concludes from what was fitted, and remarks say what was left out.
    laws : bool
        Infer the missing law where the gap stays unexplained (`flexarm.missing_law`).
    progress : callable, optional
        Gets the share done and what is being done.

    Returns
    -------
    Diagnosis

    Raises
    ------
    InvalidParameter
        If records and model do not fit each other, or nothing can be compared.
    NotConverged
        If the nominal model cannot be simulated.

    Examples
    --------
    >>> found = flexarm.diagnose(arm, [slow, fast], hold_out=other_day)  # doctest: +SKIP
    >>> found.save("diagnosis")  # doctest: +SKIP
    """
    begun = time.monotonic()
    tell = progress or (lambda done, what: None)
    given = named_records(records)
    held = named_hold_out(arm, hold_out, given)
    tell(0.0, "checking")
    checked = check(arm, given, step=step, alpha=alpha, progress=lambda done: tell(0.1 * done, "checking"))
    doubts = dict.fromkeys((*(f"model: {warning}" for warning in arm.warnings), *checked.doubts))
    said = (remark for remark in checked.remarks if remark not in current().remarks)  # added at the end
    remarks = (*doubts, *map(str, checked.outliers), *said)
    if checked.faults:
        faults = tuple(
            NamedEffect(f.name, f.at, f.probability, f.parameters, f.alternatives, f.evidence)
            for f in checked.faults
        )
        whence = _provenance(seed, step, begun)
        return Diagnosis(
            "unusable", arm, arm, effects=faults, training=tuple(given), remarks=remarks, provenance=whence
        )
    held, borrowed = impute_noise(checked.records, held)
    parted = split(arm, checked, clean_records(arm, held, step=step, alpha=alpha))
    tell(0.1, "choosing the time step")
    policy = policy or SelectionPolicy()
    problem = Problem(
        with_zeros(arm, parted.training, policy),
        parted.training,
        step=FIT.step_ratio * step,
        alpha=alpha,
        jobs=n_jobs or os.cpu_count() or 1,
        policy=policy,
    )
    problem = with_fine_step(problem, problem.arm)
    remarks = (*remarks, *step_remarks(step, problem.step / FIT.step_ratio))
    step = problem.step / FIT.step_ratio
    tell(0.12, "errors of drives")
    problem, coarse, input_noise = with_errors_of_drives(problem, seed)
    choice = _chosen(problem, tell)
    out = masked_outliers(choice.best, Criteria(problem, choice.null))
    if out.any():
        remarks = (*remarks, *outlier_remarks(out, problem))
        parted = replace(parted, training=left_out(parted.training, out, problem))
        problem = problem.without(out)
        choice = _chosen(problem, lambda done, what: tell(0.8, f"again: {what}"))
    tell(0.8, "intervals")
    found = _conclusion(choice, coarse, problem)
    tell(0.83, "next experiment")
    further = NextExperiment()
    if allows("the next experiment was sought"):
        further = next_experiment(choice, problem, found.verdict == "unexplained")
    if out.any():
        parted = parted.without_outliers(found.repaired, problem)
    split_records = SplitRecords(parted.training, parted.held_out, step, alpha, problem.jobs)
    updated, refined = _updated(found, problem, arm, split_records)
    missing, members, sizes = MissingLaws(), choice.best.members, found.sizes
    early = ended_early(current().remarks)  # an effect that was not tried may explain it
    if laws and not early and found.verdict == "unexplained" and allows("the missing law was sought"):
        tell(0.87, "missing law")
        signal = main_signal(split_records.training, split_records.training_gaps(arm))
        # effects may imitate parts of a gap: laws are sought about the model without them too
        about = [choice.null, choice.best] if choice.best.members else [choice.best]
        missing = missing_laws(choice.estimator, about, LawCheck(split_records, arm, updated, signal))
    if missing.added is not None:
        fitted = missing.added.fitted
        updated, members, sizes = missing.added.arm, fitted.fit.members, fitted.sizes
        refined = tuple(each for each in sizes.refined if each.changed)
    tell(0.95, "verifying")
    encoders = [encoder.effect for encoder in coarse]
    seen = verified(split_records, arm, updated, encoders, members, found.open_gap)
    told = Diagnosis(
        found.verdict,
        arm,
        updated,
        found.effects,
        counted_from_stamps(sizes.nuisances, problem),
        refined,
        rejected(choice, problem),
        where=seen.located.where if seen.located else (),
        before=seen.before,
        after=seen.after,
        training=tuple(parted.training),
        held_out=tuple(parted.held_out),
        hold_out_kind=parted.kind,
        hold_out_why=parted.why,
        main_signal=seen.main_signal,
        stages=seen.stages,
        constancy=found.drifts,
        remainder=" ".join(said for said in (found.ends, seen.remainder) if said),
        remarks=(
            *remarks,
            *borrowed,
            *parted.remarks,
            *unfitted_remarks(problem, checked.compared),
            *noise_remarks(problem),
            *payload_remarks(problem),
            *input_noise_remarks(input_noise | input_noise_by_signal(problem), problem),
            *(discretisation_remarks(problem) if choice.best.non_smooth else ()),
            *transient_remarks(choice.best, problem),
            *seen.remarks,
            *law_remarks(missing, choice.best),
            *current().remarks,
        ),
        next_experiment=further.sentence,
        statistics=fit_statistics(choice.best, problem),
        provenance=_provenance(seed, step, begun),
        located=seen.located,
        located_after=seen.located_after,
        laws=missing.curves,
    )
    no_gap = greatest_by_signal(problem.rows, lambda rows: rows.explained_square(choice.best.non_smooth))
    return adequate_if_predicted(told, no_gap, bool(problem.initial_conditions))


@dataclass(frozen=True)
class _Conclusion:
    """The conclusion of a choice: verdict, names with their sizes, and the updated model."""

    verdict: Verdict
    effects: tuple[NamedEffect, ...]
    sizes: Estimates
    drifts: tuple[Mapping[str, Any], ...]
    repaired: Arm
    kept: bool
    open_gap: bool
    ends: str


def _conclusion(choice: Choice, coarse: Sequence[CoarseEncoder], problem: Problem) -> _Conclusion:
    """Intervals, constancy, names; the model is repaired by what explains all or is better than nothing.

    What leaves a small part of a gap, with a parameter that each record would have otherwise or that no
    machine has, mimics it, and so does what explains all with a size where fits end.
    """
    arm = choice.estimator.with_effects(choice.best.members)
    sizes = estimates(choice.best, problem, input_noise_errors(problem, arm))
    drifts = tuple(constancy(choice.best, problem))
    criteria = Criteria(problem, choice.null)
    wrong = any(not each["constant"] for each in drifts) and criteria.leaves_anything(choice.best)
    share = criteria.policy.negligible_share if has_implausible_size(choice.best) else None
    open_gap = wrong or criteria.leaves_gap(choice.best, share)
    ends = bound_sentence(choice.best)
    unexplained = open_gap or bool(ends)
    effects = (
        *(encoder.named(problem.policy.most_certain) for encoder in coarse),
        *named_effects(choice, sizes, drifts, unexplained, problem, coarse=bool(coarse)),
    )
    keep = not unexplained or worth_keeping(choice, problem)
    model = repaired(problem.arm, choice.best, sizes) if keep else problem.arm
    verdict: Verdict = "unexplained" if unexplained else "effects" if effects else "adequate"
    return _Conclusion(verdict, effects, sizes, drifts, model, keep, open_gap, ends)


def _updated(
    found: _Conclusion, problem: Problem, stated: Arm, records: SplitRecords
) -> tuple[Arm, tuple[Refined, ...]]:
    """Return the updated model and its refined values, those that the data do not determine as stated."""
    updated, refined = found.repaired, tuple(each for each in found.sizes.refined if each.changed)
    if not found.kept:
        updated, refined = set_zeros(updated, refined, stated)
    updated, refined = restore_unidentifiable(problem.arm, updated, refined, records.training_gaps)
    updated = without_idle_zeros(updated, stated)
    return updated, of_model(refined, updated)


def _chosen(problem: Problem, tell: Callable[[float, str], object]) -> Choice:
    """Screens all effects at all places, fits what promises most, and chooses."""
    tell(0.14, "nominal model")
    estimator = Estimator.nominal(problem, nuisance_model(problem)).centred()
    rhythm = dominant_frequencies(estimator.fit(()).projected, problem)
    probed = probe(
        estimator,
        candidates(problem, estimator.nuisance.arm, rhythm, SpringEffect.softer),
        lambda done: tell(0.15 + 0.25 * done, "screening"),
    )
    return choose(estimator, probed, lambda what, done: tell(0.4 + 0.4 * done, what))


def _provenance(seed: int, step: float, begun: float) -> dict[str, Any]:
    return {"version": version(), "seed": seed, "step": step, "seconds": time.monotonic() - begun}
