"""The diagnosis: load -> check -> align -> simulate -> locate -> screen -> fit -> choose -> patch -> verify.

Each step is a function of its own module, with a result that one can look at alone; this page calls them in
their order.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from math import log10
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.parameter import with_value
from flexarm.comparison.beside import Beside, beside
from flexarm.comparison.compare import compare
from flexarm.comparison.comparison import Comparison
from flexarm.configuration import version
from flexarm.diagnosis.candidates import SOFTER, SPRINGS, candidates
from flexarm.diagnosis.check import check, named_records
from flexarm.diagnosis.choose import REACH, Choice, choose, leaves_gap, probabilities
from flexarm.diagnosis.constancy import constancy
from flexarm.diagnosis.estimates import Estimates, estimates
from flexarm.diagnosis.evidence import log_bayes_factor
from flexarm.diagnosis.evidence_sentence import evidence_sentence
from flexarm.diagnosis.fit import Fit, Fitter
from flexarm.diagnosis.floor import floor
from flexarm.diagnosis.further import next_experiment
from flexarm.diagnosis.hold_out import hold_back, hold_out_kind, hold_out_why
from flexarm.diagnosis.left_open import left_open
from flexarm.diagnosis.left_out import missed
from flexarm.diagnosis.locate import locate
from flexarm.diagnosis.observed import Observed
from flexarm.diagnosis.remainder import describe_remainder
from flexarm.diagnosis.result import Alternative, Diagnosis, NamedEffect, Refined, Rejected, Stage
from flexarm.diagnosis.rhythm import rhythms
from flexarm.diagnosis.ring_down import describe_ring_downs, ring_downs
from flexarm.diagnosis.screen import probe
from flexarm.diagnosis.transfer import carried
from flexarm.diagnosis.unknowns import unknowns

if TYPE_CHECKING:
    from flexarm.record import Record

Progress = Callable[[float, str], object] | None

COARSE = 2.0
"""Steps of fits over those of the diagnosis; what they miss is corrected about the model at hand."""
CAP = 0.98
"""Greatest probability of a name: some mechanism may be in no vocabulary."""
CONFIDENT = 0.5
"""Greatest probability of a name whose parameter moves, or beside a gap that nothing explains."""
WORTH_KEEPING = 0.5
"""Least part of the gap in data left out that effects close, to be kept where they do not explain all."""
CARRIED = 0.2
"""The same of what the model as stated misses in each part of the training, were it left out of the fit."""


def diagnose(
    arm: Arm,
    records: Mapping[str, Record] | Sequence[Record],
    hold_out: Record | None = None,
    *,
    jobs: int | None = None,
    seed: int = 0,
    step: float = 2e-3,
    alpha: float = -0.05,
    progress: Progress = None,
) -> Diagnosis:
    """Names the physical effect that a model lacks, where it sits, and how sure that is.

    Parameters
    ----------
    arm : Arm
        The nominal model, with `[uncertainty]` where values are uncertain.
    records : dict of str to Record, or sequence of Record
        What to explain; all are fitted together.
    hold_out : Record, optional
        Never used for fitting or choosing: the check of the repair. Without one, blocks of time are held
        back.
    jobs : int, optional
        Number of simulations at once; default one a core.
    seed : int
        Of the bootstrap; same seed, same answer.
    step, alpha : float
        Of all simulations [s], [-].
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
    provenance = {"version": version(), "seed": seed}
    tell(0.0, "checking")
    checked = check(arm, given, step=step)
    remarks = (*map(str, checked.outliers), *checked.remarks)
    if checked.faults:
        return Diagnosis(
            "unusable",
            arm,
            arm,
            effects=tuple(
                NamedEffect(f.name, f.at, f.probability, f.parameters, f.alternatives, f.evidence)
                for f in checked.faults
            ),
            training=tuple(given),
            remarks=remarks,
            provenance={**provenance, "seconds": time.monotonic() - begun},
        )
    named = dict(checked.records)
    held = {} if hold_out is None else {_name(hold_out, named): hold_out}
    kind = "blocks" if hold_out is None else hold_out_kind(named, hold_out)
    why = "" if hold_out is None else hold_out_why(named, hold_out)
    if hold_out is None:
        parts = {name: hold_back(record) for name, record in named.items()}
        named = {name: fitted for name, (fitted, _) in parts.items()}
        held = {f"{name}, held-back blocks": back for name, (_, back) in parts.items()}
    tell(0.1, "simulating")
    observed = Observed(arm, named, step=COARSE * step, alpha=alpha, jobs=jobs or os.cpu_count() or 1)
    fitter = Fitter.nominal(observed, unknowns(observed)).centred()
    rhythm = rhythms(fitter.fit(()).rest, observed)
    probed = probe(
        fitter,
        candidates(observed, fitter.unknowns.arm, rhythm, SOFTER),
        lambda done: tell(0.15 + 0.25 * done, "screening"),
    )
    choice = choose(fitter, probed, lambda what, done: tell(0.4 + 0.4 * done, what))
    tell(0.8, "intervals")
    sizes = estimates(choice.best, observed, seed)
    open_gap = leaves_gap(choice.best, choice.null, observed)
    drifts = constancy(choice.best, observed, choice.value)
    effects = _named(choice, sizes, drifts, open_gap, observed)
    verdict = "unexplained" if open_gap else "effects" if effects else "adequate"
    keep = not open_gap or _worth_keeping(choice, observed)
    updated = repaired(arm, choice.best, sizes, keep) if keep or not open_gap else arm
    tell(0.83, "next experiment")
    further = next_experiment(choice, observed, open_gap)
    tell(0.85, "verifying")
    everything = {**named, **held}
    compared = partial(compare, step=step, alpha=alpha)
    updated, moved = left_open(
        arm, updated, tuple(filter(_moved, sizes.refined)), lambda model: _gaps(compared, model, named)
    )
    before, after = _gaps(compared, arm, everything), _gaps(compared, updated, everything)
    main = main_signal(named, before)
    pairs_before = {name: beside(arm, record, step=step) for name, record in named.items()}
    pairs_after = {name: beside(updated, record, step=step) for name, record in named.items()}
    located, located_after = _located(pairs_before), _located(pairs_after)
    remarks = (*remarks, *floor(pairs_after, step=step, alpha=alpha).notes)
    left = describe_remainder(located_after) if open_gap and located_after else None
    swings = describe_ring_downs(ring_downs(pairs_before)) if open_gap else ""
    return Diagnosis(
        verdict,  # type: ignore[arg-type]
        arm,
        updated,
        effects,
        sizes.nuisances,
        () if updated is arm else moved,
        _rejected(choice, observed),
        where=located.where if located else (),
        before=before,
        after=after,
        training=tuple(named),
        held_out=tuple(held),
        hold_out_kind=kind,
        hold_out_why=why,
        main_signal=main,
        stages=_stages(compared, arm, updated, choice, everything, main, before, after),
        constancy=tuple(drifts),
        remainder=" ".join(said for said in (str(left or ""), swings) if said),
        remarks=remarks,
        next_experiment=further.sentence,
        provenance={**provenance, "seconds": time.monotonic() - begun},
        located=located,
        located_after=located_after,
    )


def _gaps(
    compared: Callable[[Arm, Record], Comparison], model: Arm, records: Mapping[str, Record]
) -> dict[str, Comparison]:
    return {name: compared(model, record) for name, record in records.items()}


def _moved(refined: Refined) -> bool:
    """Whether the data say anything of a nominal value: not of one across the plane of a planar arm."""
    return abs(refined.value - refined.nominal) > 1e-3 * refined.std


def _located(pairs: Mapping[str, Beside]) -> Any:
    kinds = {pair.record.kind for pair in pairs.values()}
    return locate(pairs) if len(kinds) == 1 else None


def repaired(arm: Arm, fit: Fit, sizes: Estimates, effects: bool = True) -> Arm:
    """The nominal model with refined values and, if asked for, the effects of a fit."""
    for refined in filter(_moved, sizes.refined):
        arm = with_value(arm, refined.parameter, _rounded(refined.value, refined.std))
    if not effects:
        return arm
    found = zip(fit.members, sizes.effects, strict=True)
    for member, values in sorted(found, key=lambda pair: pair[0].name not in SPRINGS):
        if member.needs is not None and arm.effect(member.needs.name, member.needs.at) is None:
            arm = arm.with_effect(member.needs)
        rounded = {each.name: _rounded(each.value, each.std) for each in values}
        arm = arm.with_effect(member.effect.with_parameters(rounded))
    return arm


def _rounded(value: float, std: float) -> float:
    """A value to a thousandth of its standard deviation, so that files do not feign more."""
    return value if not std > 0 else round(value, 3 - int(np.floor(log10(std))))


def main_signal(records: Mapping[str, Record], before: Mapping[str, Comparison]) -> str:
    """The signal of the report's gap: of positions the one that moves most, else the one that misses most."""
    travel: dict[str, float] = {}
    misses: dict[str, float] = {}
    for name, record in records.items():
        for signal, gap in before[name].evidence.items():
            values = record.signals[signal].values
            if gap.quantity == "position":
                spread = float(np.nansum(np.nanvar(values, axis=0)))
                travel[signal] = max(travel.get(signal, 0.0), spread)
            misses[signal] = max(misses.get(signal, 0.0), (gap.rms["total"] or 0.0) / (gap.noise_rms or 1.0))
    chosen = travel or misses
    return max(chosen, key=lambda signal: chosen[signal]) if chosen else ""


def _named(
    choice: Choice, sizes: Estimates, drifts: Sequence[Mapping[str, Any]], open_gap: bool, observed: Observed
) -> tuple[NamedEffect, ...]:
    """The chosen effects, each with its rivals within reach."""
    found = []
    for k, (member, rivals) in enumerate(zip(choice.best.members, choice.rivals, strict=True)):
        near = [rival for rival in rivals if rival.within_reach]
        odds = [min(p, CAP) for p in probabilities(near)]
        moving = [
            d
            for d in drifts
            if (d["effect"], d["at"], d["parameter"]) == (*member.place, member.free[0]) and not d["constant"]
        ]
        first = min(odds[0], CONFIDENT) if moving or open_gap else odds[0]
        alternatives = tuple(
            Alternative(rival.candidate.name, rival.candidate.at, p)
            for rival, p in zip(near, odds[1:], strict=True)
        )
        found.append(
            NamedEffect(
                member.name,
                member.at,
                first,
                sizes.effects[k],
                alternatives,
                evidence_sentence(choice, k, moving, open_gap, observed),
            )
        )
    return tuple(sorted(found, key=lambda effect: -effect.probability))


def _closes(best: Fit, null: Fit, observed: Observed) -> bool:
    """Whether a fit closes enough of the gap, also where it was not fitted, to be kept with one left."""
    return missed(best, observed) < (1 - WORTH_KEEPING) * missed(null, observed)


def _worth_keeping(choice: Choice, observed: Observed) -> bool:
    """Whether a fit that does not explain all is better than none: it closes half, or it predicts."""
    if not choice.best.members:
        return False
    best, null = choice.best, choice.null
    return _closes(best, null, observed) or carried(best, null, observed) > CARRIED


def _rejected(choice: Choice, observed: Observed) -> tuple[Rejected, ...]:
    """Rivals out of reach, and what was tried on the way."""
    found: dict[tuple[str, str], Rejected] = {}
    chosen = set(choice.best.places)
    for rivals in choice.rivals:
        for rival in rivals:
            if not rival.within_reach:
                place = rival.candidate.place
                found[place] = Rejected(*place, -rival.behind, "explains less in its place")
    for fit, _ in choice.tried:
        for place in fit.places:
            if place not in chosen and place not in found:
                behind = log_bayes_factor(fit, choice.best, observed, choice.value)
                if behind < -REACH:
                    found[place] = Rejected(*place, behind, "explains less")
    return tuple(sorted(found.values(), key=lambda each: -each.log_bayes_factor))


def _stages(
    compared: Callable[[Arm, Record], Comparison],
    arm: Arm,
    updated: Arm,
    choice: Choice,
    records: Mapping[str, Record],
    main: str,
    before: Mapping[str, Comparison],
    after: Mapping[str, Comparison],
) -> tuple[Stage, ...]:
    """The gap of the main signal from the nominal to the repaired model, an effect at a time."""

    def rms(found: Mapping[str, Comparison]) -> dict[str, float]:
        return {
            name: float(c.signals[main].rms["total"] or 0.0) for name, c in found.items() if main in c.signals
        }

    stages = [Stage("nominal", rms(before))]
    if updated.effects != arm.effects:
        model = arm
        for member in sorted(choice.best.members, key=lambda each: each.name not in SPRINGS):
            if member.needs is not None and model.effect(member.needs.name, member.needs.at) is None:
                model = model.with_effect(member.needs)
            model = model.with_effect(member.effect)
            found = {name: compared(model, record) for name, record in records.items()}
            stages.append(Stage(f"{member.name} at {member.at}", rms(found)))
    if updated != arm:
        stages.append(Stage("nominal values refined", rms(after)))
    return tuple(stages)


def _name(record: Record, taken: Mapping[str, Record]) -> str:
    """Of the held-out record."""
    name = record.path.name if record.path is not None else "held_out"
    return name if name not in taken else f"{name} (held out)"
