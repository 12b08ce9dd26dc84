"""`report.html` of a diagnosis: one file that is read from top to bottom, figures inside, nothing fetched."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import unified_diff
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from flexarm.arm.effect import effect_class
from flexarm.budget import ended_early
from flexarm.report.evidence_figures import law_rows
from flexarm.report.files import Drawing, filled
from flexarm.report.sentences import (
    FITS_TOO,
    gap_tables,
    headline,
    hold_out_sentence,
    nuisance_title,
    remarks_beside,
    split_alternatives,
    stated_sentence,
    unpredicted_sentence,
    verdict_sentence,
)
from flexarm.tables import toml_text
from flexarm.wording import (
    effect_words,
    interval,
    listed,
    number,
    signed,
)

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.fit_statistics import FitStatistics
    from flexarm.named_effects import Estimate, NamedEffect

Row = dict[str, Any]


def page(d: Diagnosis, drawings: Sequence[Drawing], report: Mapping[str, Any]) -> str:
    """Return the page as HTML, with the figures as they were drawn and the provenance of `report.json`."""
    filters: dict[str, Callable[..., Any]] = {
        "breakable": lambda key: Markup("<wbr>").join(re.split(r"(?<=[._/])", key)),
        "minus": _minus,
    }
    rotations = d.located.rotations if d.located is not None else None
    return filled(
        "diagnosis.html.j2",
        filters,
        d=d,
        headline=headline(d),
        early=ended_early(d.remarks),
        verdict=verdict_sentence(d),
        unpredicted=unpredicted_sentence(d),
        remarks=remarks_beside(d),
        hold_out=hold_out_sentence(d) if d.training else "",
        gaps=gap_tables(d),
        # of a record whose name does not say so
        role={name: "" if "held" in name else "held out" for name in d.held_out}
        | dict.fromkeys(set(d.training) - set(d.held_out), "training"),
        follows=[
            {"signal": signal, "state": found.best, "share": f"{100 * found.share:.0f} %"}
            for signal, found in (d.located.dependence if d.located is not None else {}).items()
            if found.relevant
        ],
        rotations=rotations.joints if rotations is not None and len(rotations.joints) > 1 else (),
        effects=[_effect(d, each) for each in d.effects],
        refined=[each for each in d.refinements if each.determined or each.changed],
        undetermined=[
            each.refined.parameter for each in d.refinements if not (each.determined or each.changed)
        ],
        nuisances=list(_nuisance_rows(d)),
        rejected=sorted(d.rejected, key=lambda each: -each.log_bayes_factor)[:12],
        diff=list(_diff(d)),
        channels=list(channel_rows(d.statistics)),
        unseen=listed([effect_words(name) for name in d.statistics.unseen]),
        laws=law_rows(d),
        drawn=drawings,
        fits_too=FITS_TOO,
        effect_law=effect_law,
        provenance=report["provenance"],
    )


def _effect(d: Diagnosis, effect: NamedEffect) -> Row:
    near, far = split_alternatives(effect)
    return {
        "named": effect,
        "evidence": effect.evidence[:1].upper() + effect.evidence[1:],
        "parameters": [_parameter(each) for each in effect.parameters],
        "stated": "" if d.verdict == "unusable" else stated_sentence(d, effect),
        "near": near,
        "far": far,
    }


def effect_law(name: str) -> str:
    """Return what an effect is, in the first sentence of its documentation."""
    return (effect_class(name).__doc__ or "").strip().split("\n")[0]


def _parameter(estimate: Estimate) -> Row:
    value, low, high, unit = (_minus(text) for text in interval(estimate))
    return {"name": estimate.name, "value": value, "low": low, "high": high, "unit": unit or "–"}


def _minus(text: str) -> str:
    return text.replace("-", "−")


def _nuisance_rows(d: Diagnosis) -> Iterator[Row]:
    for nuisance in d.nuisances:
        title = nuisance_title(d, nuisance)
        for each in nuisance.parameters:
            if each.name not in nuisance.undetermined:
                yield {"title": title, **_parameter(each)}


def _diff(d: Diagnosis) -> Iterator[Row]:
    """Lines of the model file that changed, with three around them."""
    old, new = (toml_text(arm.to_dict()).splitlines() for arm in (d.arm, d.updated))
    for line in list(unified_diff(old, new, "nominal", "updated.toml", lineterm="", n=3))[2:]:
        kind = {"+": "plus", "-": "minus", "@": "place"}.get(line[:1], "")
        yield {"kind": kind, "text": "…" if kind == "place" else line}


def channel_rows(statistics: FitStatistics) -> Iterator[dict[str, str]]:
    """Return a row for each channel; one of several in a signal is named by its axis."""
    several = {(c.record, c.signal) for c in statistics.channels if c.channel > 0}
    for each in statistics.channels:
        lag = each.autocorrelation
        yield {
            "record": each.record,
            "signal": f"{each.signal} {each.axis}" if (each.record, each.signal) in several else each.signal,
            "rows": str(each.rows),
            "chi_square": number(each.chi_square, 2),
            "autocorrelation": "–" if lag is None else _minus(signed(lag, 2)),
            "discrepancy": number(each.discrepancy, 2) if each.discrepancy > 0 else "none",
            "length": "–" if each.length is None else f"{number(each.length, 2)} s",
        }
