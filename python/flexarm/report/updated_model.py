"""`updated.toml`: the repaired model, and above it where it comes from and what was changed.

The same diagnosis gives the same file, so there is no date in it. Values are in SI units like those below
them; 90 % intervals of refined nominal values are those of a normal distribution.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING

from flexarm.named_effects import NORMAL_90
from flexarm.output import write_file
from flexarm.report.report_file import provenance_of
from flexarm.report.sentences import rivals_sentence
from flexarm.wording import listed, place_words, probability

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.named_effects import Estimate, NamedEffect

WIDTH = 118
"""Of a line of the comment."""


def write_updated(diagnosis: Diagnosis, path: Path, model: Path | None = None) -> None:
    """Write the file, with the comments of the model file that was diagnosed, if that is given."""
    lines = [part for line in _head(diagnosis) for part in wrap(line, WIDTH, subsequent_indent="    ")]
    head = "".join(f"# {line}\n" for line in lines)
    write_file(path, f"{head}\n{diagnosis.updated.toml_for(path.parent, model)}")


def _head(d: Diagnosis) -> Iterator[str]:
    known = provenance_of(d.provenance)
    files = [name for name in known["inputs_sha256"] if name.endswith(".toml") and "/" not in name]
    model = f"{files[0]}, {d.arm.name!r}" if files else repr(d.arm.name)
    yield f"Made by flexarm diagnose {known['version']}, seed {known['seed']}: verdict {d.verdict}"
    yield f"from the model {model} and {_records(d.training)}"
    if d.held_out and d.hold_out_kind != "blocks":
        yield f"tried on {_records(d.held_out)}, which no fit has seen"
    kept = [effect for effect in d.effects if _in(d, effect)]
    moved = d.refinements
    changed = [each for each in moved if each.refined.value != each.refined.nominal]
    if not kept and not changed:
        yield "nothing is changed: this is the nominal model"
    if kept:
        yield "added, with 90 % intervals:"
    for effect in kept:
        yield f"  {place_words(effect.name, effect.at)}, probability {probability(effect.probability)}"
        yield from (f"    {_range(each)}" for each in effect.parameters)
        if rivals := rivals_sentence(effect):
            yield f"    {rivals}"
    if changed:
        yield "refined within the stated uncertainty, with 90 % intervals:"
    for each in changed:
        value, half, unit = each.refined.value, NORMAL_90 * each.refined.std, each.refined.unit
        ends = f", {_plain(value - half)} to {_plain(value + half)}" if isfinite(half) else ""
        change = f"{_plain(each.refined.nominal)} -> {_plain(value)}"
        yield f"  {each.refined.parameter}: {change}{ends} {unit}".rstrip()
    left = [each.refined.parameter for each in moved if each.refined.value == each.refined.nominal]
    if left:
        yield f"as they were, since the data do not determine them: {listed(left)}"


def _records(names: Sequence[str]) -> str:
    return f"the record{'s' if len(names) > 1 else ''} {listed(names)}"


def _in(d: Diagnosis, effect: NamedEffect) -> bool:
    """Return True if a named effect was added to the model; faults of sensors and open questions are not."""
    pairs = [(d.updated.effect(effect.name, at), d.arm.effect(effect.name, at)) for at in effect.places]
    return any(added is not None and added != old for added, old in pairs)


def _range(each: Estimate) -> str:
    unit = "" if each.unit in ("", "-", "1") else f" {each.unit}"
    return f"{each.name} = {_plain(each.value)}{unit}, {_plain(each.low90)} to {_plain(each.high90)}"


def _plain(value: float) -> str:
    """Six digits: intervals of a thousandth show in them."""
    return f"{value:.6g}"
