"""A diagnosis as a directory (JSON, page, updated.toml, gaps.nc, figures) and as text in a terminal."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import unified_diff
from functools import partial
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

from flexarm.arm.effect import effect_class
from flexarm.budget import ended_early
from flexarm.comparison.comparison import frame_words
from flexarm.named_effects import NORMAL_90, Estimate, NamedEffect
from flexarm.netcdf import save
from flexarm.output import PAGE, write_file
from flexarm.report.evidence_figures import candidates, constancy, law_rows, laws, of_effect
from flexarm.report.files import Drawing, drawn, filled, sheet, text_of, write_files
from flexarm.report.gap_figures import by_band, gaps_along, waterfall
from flexarm.report.report_file import provenance_of
from flexarm.report.sentences import (
    FITS_TOO,
    alternatives_sentence,
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
from flexarm.report.state_figures import against_states, main_direction, rotations, shown_joints, states_drawn
from flexarm.report.storage import GAPS, MODEL, REPORT, gap_contents
from flexarm.tables import toml_text
from flexarm.wording import effect_words, interval, listed, number, signed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from flexarm.diagnosis.result import Diagnosis
    from flexarm.fit_statistics import FitStatistics
    from flexarm.report.gap_figures import BeforeAfter

Row = dict[str, Any]


def write(diagnosis: Diagnosis, directory: Path, model: Path | None = None) -> None:
    """Write the files into a directory that is there; updated.toml keeps the comments of the model file."""
    report = diagnosis.to_json_dict()
    drawn = drawings(diagnosis)
    write_files(directory, drawn, (PAGE, page(diagnosis, drawn, report)), (REPORT, report))
    write_updated(diagnosis, directory / MODEL, model)
    save(gap_contents(diagnosis), directory / GAPS)


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
        **_told(d),
        early=ended_early(d.remarks),
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
        nuisances=list(_nuisance_rows(d)),
        rejected=sorted(d.rejected, key=lambda each: -each.log_bayes_factor)[:12],
        diff=list(_diff(d)),
        channels=list(channel_rows(d.statistics)),
        unseen=listed([effect_words(name) for name in d.statistics.unseen]),
        drawn=drawings,
        fits_too=FITS_TOO,
        effect_law=effect_law,
        provenance=report["provenance"],
    )


def _told(d: Diagnosis) -> Row:
    """Return what the page and the text both tell."""
    return {
        "d": d,
        "headline": headline(d),
        "verdict": verdict_sentence(d),
        "unpredicted": unpredicted_sentence(d),
        "remarks": remarks_beside(d),
        "laws": law_rows(d),
        "undetermined": [r.refined.parameter for r in d.refinements if not (r.determined or r.changed)],
        "stated": lambda effect: "" if d.verdict == "unusable" else stated_sentence(d, effect),
    }


def _effect(d: Diagnosis, effect: NamedEffect) -> Row:
    near, far = split_alternatives(effect)
    return {
        "named": effect,
        "evidence": effect.evidence[:1].upper() + effect.evidence[1:],
        "parameters": [_parameter(each) for each in effect.parameters],
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
    d, known = diagnosis, provenance_of(diagnosis.provenance)
    files = [name for name in known["inputs_sha256"] if name.endswith(".toml") and "/" not in name]
    text = filled(
        "updated.toml.j2",
        d=d,
        known=known,
        model=f"{files[0]}, {d.arm.name!r}" if files else repr(d.arm.name),
        added=[effect for effect in d.effects if _is_added(d, effect)],
        alternatives=alternatives_sentence,
        changed=[each for each in d.refined if each.value != each.nominal],
        left=[each.parameter for each in d.refined if each.value == each.nominal],
        plain="{:.6g}".format,
        normal_90=NORMAL_90,
        isfinite=isfinite,
    )
    lines = (
        part for line in text.splitlines() for part in textwrap.wrap(line, 118, subsequent_indent="    ")
    )
    head = "".join(f"# {line}\n" for line in lines)
    write_file(path, f"{head}\n{diagnosis.updated.toml_for(path.parent, model)}")


def _is_added(d: Diagnosis, effect: NamedEffect) -> bool:
    """Return True if a named effect was added to the model; faults of sensors and open questions are not."""
    pairs = [(d.updated.effect(effect.name, at), d.arm.effect(effect.name, at)) for at in effect.places]
    return any(added is not None and added != old for added, old in pairs)


def summary(diagnosis: Diagnosis) -> str:
    """All that matters on one screen."""
    d = diagnosis
    records = {name: name if "held" in name else f"{name} (held out)" for name in d.held_out}
    return text_of(
        "diagnosis.txt.j2",
        **_told(d),
        estimate=_estimate,
        nuisance_title=partial(nuisance_title, d),
        frame_words=frame_words,
        gaps=gap_lines(d, records),
        hold_out=hold_out_sentence(d),
    )


def _estimate(estimate: Estimate) -> str:
    value, low, high, unit = interval(estimate)
    return f"{estimate.name:<18}{value:>12} {unit:<12} 90 % interval {low} to {high}"


def gap_lines(diagnosis: BeforeAfter, records: Mapping[str, str]) -> str:
    """Return the tables of the gap by signal, with other names of some records."""
    lines = []
    for table in gap_tables(diagnosis):
        head = f"gap of {table.signal} [{table.unit}]"
        labels = [f"  {records.get(name, name)}" for name, _ in table.rows]
        wide = max(26, *(len(text) + 2 for text in (head, *labels)))
        columns = ("rms before", "rms after", "noise", "max before", "max after")
        rows = zip([head, *labels], [columns, *(cells for _, cells in table.rows)], strict=True)
        lines += [f"{text:<{wide}}" + "".join(f"{cell:>12}" for cell in cells) for text, cells in rows]
    return "\n".join(lines)
