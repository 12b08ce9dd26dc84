"""A diagnosis as a directory (JSON, page, updated.toml, gaps.nc, figures) and as text in a terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.comparison.comparison import frame_words
from flexarm.named_effects import NORMAL_90, Estimate, NamedEffect
from flexarm.netcdf import save
from flexarm.output import PAGE, write_file
from flexarm.report.diagnosis_page import page
from flexarm.report.evidence_figures import candidates, constancy, law_rows, laws, of_effect
from flexarm.report.files import Drawing, drawn, sheet, write_files
from flexarm.report.gap_figures import by_band, gaps_along, waterfall
from flexarm.report.report_file import provenance_of
from flexarm.report.sentences import (
    alternatives_sentence,
    gap_tables,
    headline,
    hold_out_sentence,
    nuisance_title,
    remarks_beside,
    stated_sentence,
    unpredicted_sentence,
    verdict_sentence,
)
from flexarm.report.state_figures import against_states, main_direction, rotations, shown_joints, states_drawn
from flexarm.report.storage import GAPS, MODEL, REPORT, gap_contents
from flexarm.wording import interval, listed, place_words, probability, signed, with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.diagnosis.result import Diagnosis
    from flexarm.report.before_after import BeforeAfter


def write(diagnosis: Diagnosis, directory: Path, model: Path | None = None) -> None:
    """Write the files into a directory that is there; updated.toml keeps the comments of the model file."""
    report = diagnosis.to_json_dict()
    drawn = drawings(diagnosis)
    write_files(directory, drawn, (PAGE, page(diagnosis, drawn, report)), (REPORT, report))
    write_updated(diagnosis, directory / MODEL, model)
    save(gap_contents(diagnosis), directory / GAPS)


def drawings(d: Diagnosis) -> list[Drawing]:
    """All figures of a diagnosis, in the order of the page."""
    return drawn(_figures(d))


def _figures(d: Diagnosis) -> Iterator[tuple[str, str, str, Figure | None]]:
    if d.has_gap:
        yield from _of_gap(d)
    what = (
        "What is missing: the curve with its 90 % band, and the latent motion that no curve was assumed for "
        "(dots), of the most probable place and the next one."
    )
    yield "laws", "laws", what, laws(d)
    what = (
        "What was tried. The evidence that a candidate lacks against what was chosen (blue, 0); light blue: "
        "the data cannot tell it apart; grey: out of reach, right of the dashed line."
    )
    yield "candidates", "candidates", what, candidates(d)
    what = (
        "Each parameter fitted to one record alone (bars: 90 %), beside the value of all records together "
        "(line; band: 90 %). A right name's parameter stays where it is."
    )
    yield "constancy", "constancy", what, constancy(d)
    for effect in d.effects:
        for file in d.figures_of(effect):
            yield file.removesuffix(".png"), "effects", "", of_effect(d, effect)
    what = "The nominal arm without its bending, each driven joint in the middle of its range."
    yield "arm", "conditions", what, sketch(d)


def sketch(d: Diagnosis) -> Figure | None:
    """Draw the arm in the middle of the motions that were fitted; None if none were."""
    ranges: dict[str, list[float]] = {}
    for each in d.statistics.motions:
        ranges.setdefault(each.joint, []).extend((each.lowest, each.highest))
    if not ranges:
        return None
    middle = {joint: (min(ends) + max(ends)) / 2 for joint, ends in ranges.items()}
    figure, axes = sheet(1, 1, 3.2, legend=False)
    d.arm.plot(axes[0, 0], middle).set_title("")
    return figure


def _of_gap(d: Diagnosis) -> Iterator[tuple[str, str, str, Figure | None]]:
    records = [*d.training[:2], *d.held_out[:1]]
    yield ("states", "where", _of_states(d), against_states(d))
    what = (
        "The gap of all positions as small motions of the joints, of the nominal model, each against its "
        "own states: the joint where the cause sits, if it sits in one."
    )
    yield "rotations", "where", what, rotations(d)
    what = f"The gap of {d.main_signal} by band of frequencies: quasi-static, around the first mode, above."
    yield "bands", "where", what, by_band(d, records)
    what = f"From the nominal to the updated model: rms gap of {d.main_signal}, all directions, at each step."
    yield "stages", "shrinks", what, waterfall(d)
    yield from gaps_along(d, "shrinks")


def _of_states(d: Diagnosis) -> str:
    """Return the caption of the gap against the states of the joints."""
    shown = shown_joints(d)
    joints, states = [each.joint for each in shown], listed(states_drawn(shown))
    if not joints:
        return ""
    whose = f"of {joints[0]}" if len(joints) == 1 else f"of {listed(joints)}, a row each"
    return (
        f"The gap of {d.main_signal}, {main_direction(d)} (where it is greatest), in all of the training, "
        f"against {states} {whose}. A curve over the torque is a spring, two branches by sense "
        "of motion are friction, a wave over the angle is a gear or an encoder."
    )


def write_updated(diagnosis: Diagnosis, path: Path, model: Path | None = None) -> None:
    """Write the repaired model, and above it where it comes from and what was changed.

    The comments of the model file that was diagnosed are kept, if that is given. The same diagnosis gives the
    same file, so there is no date in it. Values are in SI units like those below them; 90 % intervals of
    refined nominal values are those of a normal distribution.
    """
    lines = [part for line in _head(diagnosis) for part in textwrap.wrap(line, 118, subsequent_indent="    ")]
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
    kept = [effect for effect in d.effects if _is_added(d, effect)]
    moved = d.refinements
    changed = [each for each in moved if each.refined.value != each.refined.nominal]
    if not kept and not changed:
        yield "nothing is changed: this is the nominal model"
    if kept:
        yield "added, with 90 % intervals:"
    for effect in kept:
        yield f"  {place_words(effect.name, effect.at)}, probability {probability(effect.probability)}"
        for size in effect.parameters:
            unit = "" if size.unit in ("", "-", "1") else f" {size.unit}"
            yield f"    {size.name} = {size.value:.6g}{unit}, {size.low90:.6g} to {size.high90:.6g}"
        if rivals := alternatives_sentence(effect):
            yield f"    {rivals}"
    if changed:
        yield "refined within the stated uncertainty, with 90 % intervals:"
    for each in changed:
        value, half, unit = each.refined.value, NORMAL_90 * each.refined.std, each.refined.unit
        ends = f", {value - half:.6g} to {value + half:.6g}" if isfinite(half) else ""
        change = f"{each.refined.nominal:.6g} -> {value:.6g}"
        yield f"  {each.refined.parameter}: {change}{ends} {unit}".rstrip()
    left = [each.refined.parameter for each in moved if each.refined.value == each.refined.nominal]
    if left:
        yield f"as they were, since the data do not determine them: {listed(left)}"


def _records(names: Sequence[str]) -> str:
    return f"the record{'s' if len(names) > 1 else ''} {listed(names)}"


def _is_added(d: Diagnosis, effect: NamedEffect) -> bool:
    """Return True if a named effect was added to the model; faults of sensors and open questions are not."""
    pairs = [(d.updated.effect(effect.name, at), d.arm.effect(effect.name, at)) for at in effect.places]
    return any(added is not None and added != old for added, old in pairs)


def summary(diagnosis: Diagnosis) -> str:
    """All that matters on one screen."""
    parts = [
        [
            f"{headline(diagnosis)}  [{diagnosis.verdict}]",
            *wrapped(verdict_sentence(diagnosis)),
            *wrapped(unpredicted_sentence(diagnosis)),
        ],
        _laws(diagnosis),
        [line for effect in diagnosis.effects for line in _effect(diagnosis, effect)],
        _refined(diagnosis),
        _nuisances(diagnosis),
        _gaps(diagnosis),
        _remarks(diagnosis),
    ]
    return "\n\n".join("\n".join(part) for part in parts if part)


def wrapped(text: str, indent: str = "", then: str | None = None) -> list[str]:
    """Return the lines of a text, indented as the first one or by `then` from the second on."""
    return textwrap.wrap(
        text,
        100,
        initial_indent=indent,
        subsequent_indent=indent if then is None else then,
        break_long_words=False,
        break_on_hyphens=False,
    )


def _laws(diagnosis: Diagnosis) -> list[str]:
    """Return lines on the missing laws, each with its probability and the gap of held-out data with it."""
    lines: list[str] = []
    for row in law_rows(diagnosis):
        text = f"missing law, probability {row['probability']}: {row['says']}"
        shrinks = "" if row["held_out"] == "–" else f" Held out: {row['held_out']}."
        lines += wrapped(text + shrinks, then="  ")
    return lines


def _effect(diagnosis: Diagnosis, effect: NamedEffect) -> list[str]:
    title = f"{place_words(effect.name, effect.at)}, probability {probability(effect.probability)}"
    lines = [title, *(_row(each) for each in effect.parameters)]
    if diagnosis.verdict != "unusable":
        lines += wrapped(stated_sentence(diagnosis, effect), "  ")
    lines += wrapped(effect.evidence, "  ")
    for other in effect.alternatives:
        words = place_words(other.name, other.at)
        lines.append(f"  or {words}, probability {probability(other.probability)}")
    return lines


def _row(estimate: Estimate) -> str:
    value, low, high, unit = interval(estimate)
    return f"  {estimate.name:<18}{value:>12} {unit:<12} 90 % interval {low} to {high}"


def _refined(diagnosis: Diagnosis) -> list[str]:
    found = diagnosis.refinements
    lines = ["nominal values refined: from, by +- 1 sigma, of what is stated"] if found else []
    for each in found:
        if each.determined or each.changed:
            moved, std, unit = each.texts
            nominal = with_unit(each.refined.nominal, each.refined.unit, 4)
            pull = "" if each.pull is None else f", {signed(each.pull, 1)} stated sigma"
            lines.append(f"  {each.refined.parameter}: {nominal} {moved} +- {std} {unit}{pull}")
    left = [each.refined.parameter for each in found if not (each.determined or each.changed)]
    return lines + (wrapped(f"as they were, not determined: {', '.join(left)}", "  ", "    ") if left else [])


def _nuisances(diagnosis: Diagnosis) -> list[str]:
    title = "clocks and frames, fitted along: within stated sigmas, or freely where unknown"
    lines = [title] if diagnosis.nuisances else []
    for nuisance in diagnosis.nuisances:
        lines.append(f"  {nuisance_title(diagnosis, nuisance)}")
        lines += [f"  {_row(each)}" for each in nuisance.parameters if each.name not in nuisance.undetermined]
        if nuisance.undetermined:
            lines.append(f"    as stated, not determined: {listed(nuisance.undetermined)}")
    return lines + [
        f"  {record}: {frame_words(name, pose)}"
        for record, found in diagnosis.frames.items()
        for name, pose in found.items()
    ]


def _gaps(diagnosis: Diagnosis) -> list[str]:
    """Return a table by record for each signal, and how the held-out data relate to the training."""

    def label(name: str) -> str:
        return f"{name} (held out)" if name in diagnosis.held_out and "held" not in name else name

    lines = gap_lines(diagnosis, label)
    return [*lines, *wrapped(hold_out_sentence(diagnosis))] if lines else []


def gap_lines(diagnosis: BeforeAfter, label: Callable[[str], str]) -> list[str]:
    """Return the tables of the gap by signal as lines, each record under its label."""
    lines = []
    for table in gap_tables(diagnosis):
        head = f"gap of {table.signal} [{table.unit}]"
        labels = [f"  {label(name)}" for name, _ in table.rows]
        wide = max(26, *(len(text) + 2 for text in (head, *labels)))
        columns = ("rms before", "rms after", "noise", "max before", "max after")
        rows = zip([head, *labels], [columns, *(cells for _, cells in table.rows)], strict=True)
        lines += [f"{text:<{wide}}" + "".join(f"{cell:>12}" for cell in cells) for text, cells in rows]
    return lines


def _remarks(diagnosis: Diagnosis) -> list[str]:
    lines: list[str] = []
    if diagnosis.remainder and diagnosis.verdict != "unexplained":
        lines += wrapped(f"remains: {diagnosis.remainder}", "", "  ")
    for remark in remarks_beside(diagnosis):
        lines += wrapped(f"note: {remark}", "", "  ")
    if diagnosis.next_experiment:
        lines += wrapped(f"measure next: {diagnosis.next_experiment}", "", "  ")
    return lines
