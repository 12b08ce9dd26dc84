"""Sentences and tables of a diagnosis: verdict, gap by signal and record, alternatives.

Tables begin with the report's main signal. Another one is listed if the repair changes its gap noticeably, as
that of a torque by friction: in the training or in held-out data, by more than `changed` of itself and

    sqrt(|rms_before^2 - rms_after^2|) > `noticed` noise                                               (1)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from flexarm.budget import ended_early
from flexarm.fit_statistics import PooledGap
from flexarm.wording import (
    labelled_scale,
    listed,
    number,
    place_words,
    probability,
    reference_words,
    scale,
    signed,
    with_unit,
)

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis, HeldOutGap
    from flexarm.named_effects import Alternative, NamedEffect, Nuisance
    from flexarm.report.gap_figures import BeforeAfter


@dataclass(frozen=True)
class GapTable:
    """The gap of one signal by record: rms before and after, noise, greatest before and after [unit]."""

    signal: str
    unit: str
    rows: tuple[tuple[str, tuple[str, ...]], ...]


def gap_tables(diagnosis: BeforeAfter) -> list[GapTable]:
    """Of the main signal and of all others that the repair changes; none where nothing was compared."""
    signals = [diagnosis.main_signal, *changed_signals(diagnosis)]
    tables = [_table(diagnosis, signal) for signal in signals]
    return [table for table in tables if table.rows]


def changed_signals(diagnosis: BeforeAfter) -> list[str]:
    """Return signals other than the main one whose gap changes noticeably, in the order of the records."""
    d = diagnosis
    names = dict.fromkeys(name for comparison in d.before.values() for name in comparison.evidence)
    return [
        name
        for name in names
        if name != d.main_signal and any(changes(d.gap(of, name)) for of in (d.training, d.held_out))
    ]


def changes(gap: PooledGap) -> bool:
    """Return True if a gap changes by more than `changed`, and (1)."""
    # Of (1): what an effect must do to a channel to be taken is half of its noise as well.
    changed, noticed = 0.1, 0.5
    if gap.before_rms is None or gap.after_rms is None:
        return False
    change = abs(gap.before_rms - gap.after_rms) > changed * max(gap.before_rms, gap.after_rms)
    return change and abs(gap.before_rms**2 - gap.after_rms**2) > (noticed * (gap.noise_rms or 0.0)) ** 2


def _table(d: BeforeAfter, signal: str) -> GapTable:
    found = {
        name: gap
        for name in (*d.training, *d.held_out)
        if (gap := d.gap([name], signal)).before_rms is not None
    }
    factor, unit = labelled_scale([gap.before_rms for gap in found.values()], d.unit_of(signal))
    rows = []
    for name, gap in found.items():
        sizes = (gap.before_rms, gap.after_rms, gap.noise_rms, gap.before_max, gap.after_max)
        rows.append((name, tuple(number(None if size is None else factor * size) for size in sizes)))
    return GapTable(signal, unit, tuple(rows))


HEADLINES = {
    "effects": "A physical effect is missing from the model",
    "adequate": "The model is adequate",
    "unexplained": "A gap remains that no known effect explains",
    "unusable": "These data cannot be used as they are",
}
"""A verdict in a headline."""
RESIZED = "An effect of the model has other values than stated"
LISTED = 3
"""Most refined values, and signals, that a verdict names; tables have all."""


def headline(diagnosis: Diagnosis) -> str:
    """Return the verdict as a headline; several effects in the plural, those that the model has already as
    such.
    """
    if diagnosis.verdict == "unexplained" and ended_early(diagnosis.remarks):
        return "A gap remains, and the time for the search ended"
    if diagnosis.verdict != "effects":
        return HEADLINES[diagnosis.verdict]
    count, resized = len(diagnosis.effects), sum(in_model(diagnosis, each) for each in diagnosis.effects)
    if resized == count:
        return RESIZED if count == 1 else f"{count} effects of the model have other values than stated"
    if resized:
        return f"{count} physical effects are missing from the model or have other values"
    return HEADLINES["effects"] if count == 1 else f"{count} physical effects are missing from the model"


def verdict_sentence(diagnosis: Diagnosis) -> str:
    """Return what was found, in one or two sentences, after nominal values that moved far."""
    told = {"effects": _effects, "adequate": _adequate, "unexplained": _unexplained, "unusable": _unusable}[
        diagnosis.verdict
    ](diagnosis)
    return " ".join(part for part in (moved_sentence(diagnosis), *told) if part)


def moved_sentence(diagnosis: Diagnosis) -> str:
    """Return which nominal values moved beyond 3 sigma, one in 370 by chance; empty if none did."""
    far = [each for each in diagnosis.refinements if each.pull is not None and abs(each.pull) > 3]
    if not far:
        return ""
    told = [
        f"{each.refined.parameter} from {with_unit(each.refined.nominal, each.refined.unit)} to "
        f"{with_unit(each.refined.value, each.refined.unit)} ({signed(each.pull or 0.0, 1)} stated sigma)"
        for each in sorted(far, key=lambda each: -abs(each.pull or 0.0))
    ]
    more = f", and {len(told) - LISTED} more" if len(told) > LISTED else ""
    which = f"{', '.join(told[:LISTED])}{more}" if more else listed(told)
    who, was = ("A nominal value", "was") if len(told) == 1 else (f"{len(told)} nominal values", "were")
    it = "it" if len(told) == 1 else "they"
    return (
        f"{who} moved far beyond what is stated: {which}; {it} {was} stated wrongly, or {it} "
        f"{'stands' if it == 'it' else 'stand'} in for what is missing."
    )


def named(effect: NamedEffect) -> str:
    """Return an effect with place, probability and alternatives."""
    text = f"{place_words(effect.name, effect.at)} (probability {probability(effect.probability)})"
    rivals = alternatives_sentence(effect)
    return f"{text}, {rivals}" if rivals else text


def alternatives_sentence(effect: NamedEffect) -> str:
    """Return the alternatives of an effect in a clause; empty without any."""
    near, far = ([place_words(other.name, other.at) for other in each] for each in split_alternatives(effect))
    found = [f"which the data cannot tell from {listed(near, 'or')}"] if near else []
    found += [f"where {listed(far, 'or')} {FITS_TOO}"] if far else []
    return ", and ".join(found)


FITS_TOO = "would fit as well, but with values that few machines have"


def split_alternatives(effect: NamedEffect) -> tuple[list[Alternative], list[Alternative]]:
    """Return alternatives at most 20 times less probable, and implausible ones that fit as well."""
    near = [other for other in effect.alternatives if 20 * other.probability >= effect.probability]
    return near, [other for other in effect.alternatives if other not in near]


def in_model(diagnosis: Diagnosis, effect: NamedEffect) -> bool:
    """Return True if the nominal model has an effect of that name at that place."""
    return any(diagnosis.arm.effect(effect.name, at) is not None for at in effect.places)


def stated_sentence(diagnosis: Diagnosis, effect: NamedEffect) -> str:
    """Return the parameters of a named effect in the nominal model; empty if it has none."""
    old = diagnosis.arm.effect(effect.name, effect.places[0])
    if old is None or len(effect.places) > 1:
        return ""
    known = {name: value for name, value, _ in old.parameters()}
    named = [each for each in effect.parameters if each.name in known]
    told = [f"{each.name} {with_unit(known[each.name], each.unit)}" for each in named]
    return f"In the model as stated: {listed(told)}." if told else "The model as stated has it too."


def gap_sentence(diagnosis: Diagnosis) -> str:
    """How far the gap shrinks, on what was held out if anything was; if it hardly does, those that do."""
    d = diagnosis
    held_out = [f"{name!r}" for name in d.held_out]
    records = "records" if len(held_out) > 1 else "record"
    where = f"held-out {records} {listed(held_out)}" if held_out else "training records"
    main = d.gap(d.held_out or d.training)
    if main.before_rms is None or main.after_rms is None:
        return ""
    others = [] if changes(main) else changed_signals(d)[:LISTED]
    told = [f"On the {where} the gap of {d.main_signal!r} {_change(main, d.unit)}"]
    for signal in others:
        gap = d.gap(d.held_out or d.training, signal)
        told += [f"That of {signal!r} {_change(gap, d.unit_of(signal))}"] if gap.before_rms else []
    return " ".join(told)


def _change(gap: PooledGap, unit: str) -> str:
    """Return what happens to a gap, and the noise."""
    before, after, noise = _with_units(gap, unit)
    old, new = gap.before_rms or 0.0, gap.after_rms or 0.0
    size = f"{'shrinks' if new < old else 'grows'} from {before} to {after} rms"
    if abs(new - old) <= 0.01 * old:  # a per cent is no change
        size = f"is {after} rms"
    return f"{size}{f'; sensor noise is {noise}' if gap.noise_rms is not None else ''}."


def nuisance_title(diagnosis: Diagnosis, nuisance: Nuisance) -> str:
    """Return what is fitted along, where, and against what."""
    unknown = any(nuisance.at in found for found in diagnosis.frames.values())
    return f"{place_words(nuisance.name, nuisance.at)}{reference_words(nuisance.name, unknown)}"


def hold_out_sentence(diagnosis: Diagnosis) -> str:
    """Return what the held-out data are to the training; empty where nothing was fitted."""
    if not diagnosis.has_gap:
        return ""
    fitted = listed([f"{name!r}" for name in diagnosis.training])
    if diagnosis.held_out:
        held_out = listed([f"{name!r}" for name in diagnosis.held_out])
        if diagnosis.hold_out_kind == "blocks":
            return f"Fitted on {fitted} without {held_out}, which were never used to fit or to choose."
        article = "an" if diagnosis.hold_out_kind[:1] in "aeiou" else "a"
        why = "" if unpredicted_sentence(diagnosis) else diagnosis.hold_out_why  # stated with the verdict
        return (
            f"Fitted on {fitted}; {held_out} was never used to fit or to choose, and is "
            f"{article} {diagnosis.hold_out_kind} of the training{f': {why}' if why else ''}."
        )
    return f"Fitted on {fitted}; nothing was held back."


def unpredicted_sentence(diagnosis: Diagnosis) -> str:
    """Return what the model fails to predict of held-out data, and possible reasons; empty if nothing."""
    d, worst = diagnosis, diagnosis.unpredicted
    if worst is None:
        return ""
    who = "The repaired model" if d.updated != d.arm else "The model"
    what = f"{worst.record!r}" if d.hold_out_kind == "blocks" else f"the held-out record {worst.record!r}"
    size = f"{with_unit(worst.held_out, worst.unit)} rms are left of {worst.signal!r}{_times_noise(worst)}"
    rest = f"; the training is left with {with_unit(worst.training, worst.unit)}"
    return f"{who} does not predict {what}: {size}{'' if worst.training is None else rest}. {_why(d)}"


def contradicted_sentence(worst: HeldOutGap) -> str:
    """Return the sentence on an adequate model that held-out data contradict."""
    return (
        "No effect is missing as far as the training tells, but the model is not adequate: of "
        f"{worst.signal!r} in the held-out {worst.record!r} "
        f"{with_unit(worst.held_out, worst.unit)} rms are left{_times_noise(worst)}."
    )


def _times_noise(gap: HeldOutGap) -> str:
    return f", {number(gap.held_out / gap.noise, 2)} times the noise" if gap.noise else ""


def remarks_beside(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Return remarks except the one that is part of the verdict."""
    said = unpredicted_sentence(diagnosis)
    return tuple(remark for remark in diagnosis.remarks if remark != said)


def _why(d: Diagnosis) -> str:
    fault = "that record has a fault of its own, which `flexarm check MODEL RECORD` looks for"
    if d.hold_out_kind == "blocks":
        return "Either something happens there and nowhere else, or these readings are at fault."
    if d.hold_out_kind == "extrapolation":
        beyond = f" ({d.hold_out_why})" if d.hold_out_why else ""
        return f"Either what lies beyond the training{beyond} shows what the training does not, or {fault}."
    return f"It lies within what the training covers: either the machine was another one then, or {fault}."


def _effects(diagnosis: Diagnosis) -> list[str]:
    missing = [named(effect) for effect in diagnosis.effects if not in_model(diagnosis, effect)]
    resized = [named(effect) for effect in diagnosis.effects if in_model(diagnosis, effect)]
    return [
        f"Missing from the model: {listed(missing)}." if missing else "",
        f"In the model with other values: {listed(resized)}." if resized else "",
        gap_sentence(diagnosis),
    ]


def _adequate(diagnosis: Diagnosis) -> list[str]:
    keys = [each.parameter for each in diagnosis.refined if each.value != each.nominal]
    if not keys:
        return ["No effect is missing as far as these data tell: the gap is noise.", gap_sentence(diagnosis)]
    who = "a nominal value" if len(keys) == 1 else f"{len(keys)} nominal values"
    explain = "explains" if len(keys) == 1 else "explain"
    which = f" ({listed(keys)})" if len(keys) <= LISTED else ""
    return [
        f"No effect is missing as far as these data tell: {who} inside the stated uncertainty{which} "
        f"{explain} the gap.",
        gap_sentence(diagnosis),
    ]


def _unexplained(diagnosis: Diagnosis) -> list[str]:
    part = listed([named(effect) for effect in diagnosis.effects])
    early = ended_early(diagnosis.remarks)
    return [
        "More time may find names for it, and change the ones below: not all was tried." if early else "",
        diagnosis.remainder or "What remains of the gap exceeds the noise, and no known effect explains it.",
        f"Part of the gap may be {part}." if part else "",
        gap_sentence(diagnosis),
    ]


def _unusable(diagnosis: Diagnosis) -> list[str]:
    faults = listed([place_words(effect.name, effect.at) for effect in diagnosis.effects])
    who = "The sensor is" if len(diagnosis.effects) == 1 else "Sensors are"
    return [
        f"{who} at fault, not the physics: {faults}." if faults else "",
        "Repair the channel or leave it out of the record, then diagnose again.",
    ]


def _with_units(gap: PooledGap, unit: str) -> tuple[str, str, str]:
    """Before, after and noise with the prefix that suits the first, or the rest if that is a thousandth."""
    first = scale([gap.before_rms], unit)
    little = max(gap.after_rms or 0.0, gap.noise_rms or 0.0) < 1e-3 * (gap.before_rms or 0.0)
    rest = scale([gap.after_rms, gap.noise_rms], unit) if little else first

    def said(value: float | None, prefix: tuple[float, str]) -> str:
        factor, shown = prefix
        return f"{number(None if value is None else factor * value)} {shown}".rstrip()

    return said(gap.before_rms, first), said(gap.after_rms, rest), said(gap.noise_rms, rest)
