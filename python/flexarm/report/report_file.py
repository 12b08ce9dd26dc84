"""`report.json`, format `flexarm-diagnosis/1`: what programs read of a diagnosis.

Unknown numbers, such as the deviation of what the data do not determine, are null. Besides the agreed keys,
`details` holds the sentences and curves of the page.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from flexarm.configuration import config
from flexarm.json_values import plain
from flexarm.report.sentences import remarks_beside, unpredicted_sentence

if TYPE_CHECKING:
    from flexarm.comparison.before_after import BeforeAfter
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.law_curve import LawCurve


FORMAT = "flexarm-diagnosis/1"

Known = Annotated[float | None, BeforeValidator(plain)]
"""None for a number that is not finite, which JSON has not."""
Probability = Annotated[float, Field(ge=0, le=1)]


class Entry(BaseModel):
    """A table of a report's file; unknown keys are errors."""

    model_config = ConfigDict(extra="forbid")


class ParameterEntry(Entry):
    """A fitted parameter with its 90 % interval."""

    name: str
    value: float
    std: Known
    low90: Known
    high90: Known
    unit: str


class AlternativeEntry(Entry):
    """An alternative that the data cannot exclude."""

    name: str
    at: str | list[str]
    probability: Probability


class EffectEntry(Entry):
    """A named effect."""

    name: str
    at: str | list[str]
    probability: Probability
    parameters: list[ParameterEntry]
    alternatives: list[AlternativeEntry]
    evidence: str
    figures: list[str]


class NuisanceEntry(Entry):
    """A clock or frame that was fitted along."""

    name: str
    at: str
    parameters: list[ParameterEntry]
    undetermined: list[str] = []


class WhereEntry(Entry):
    """A place in direction, state and frequency where the gap exceeds the noise."""

    signal: str
    direction: str
    when: str
    band_hz: Annotated[list[Known], Field(min_length=2, max_length=2)]
    rms: float
    noise_rms: Known


class RefinedEntry(Entry):
    """A nominal value that moved inside its stated uncertainty."""

    parameter: str
    value: float
    std: Known
    nominal: float


class GapEntry(Entry):
    """Total of the main signal before and after, pooled over records."""

    before_rms: Known
    after_rms: Known
    noise_rms: Known
    before_max: Known
    after_max: Known


class GapsEntry(Entry):
    """The gap on what was fitted and on what was held back."""

    signal: str
    unit: str
    train: GapEntry
    held_out: GapEntry


class RejectedEntry(Entry):
    """A candidate that was not taken."""

    name: str
    at: str | list[str]
    log_bayes_factor: Known
    why: str


class ProvenanceEntry(Entry):
    """Where the report comes from."""

    version: str
    git: str
    inputs_sha256: dict[str, str]
    seed: int
    step: float = 2e-3
    seconds: float
    rejected: list[RejectedEntry]


class StageEntry(Entry):
    """A model on the way to the repaired one."""

    label: str
    rms: dict[str, Known]


class PoseEntry(Entry):
    """A frame of measurement in the base."""

    xyz: list[float]
    rpy: list[float]


class ChannelEntry(Entry):
    """Residual of a channel after the fit."""

    record: str
    signal: str
    channel: int
    rows: int
    chi_square: Known
    autocorrelation: Known
    discrepancy: Known
    length: Known


class CorrelationEntry(Entry):
    """Correlation of two fitted parameters."""

    parameters: Annotated[list[str], Field(min_length=2, max_length=2)]
    value: Known


class MotionEntry(Entry):
    """Range and rate of a joint in a record."""

    record: str
    joint: str
    unit: str
    lowest: float
    highest: float
    rms_rate: Known


class PriorEntry(Entry):
    """Prior range of a fitted parameter."""

    effect: str
    at: str | list[str]
    parameter: str
    low: float
    typical: float
    high: float
    unit: str
    uniform: bool
    source: str


class StatisticsEntry(Entry):
    """Statistics of the fit."""

    channels: list[ChannelEntry] = Field(default_factory=list)
    correlations: list[CorrelationEntry] = Field(default_factory=list)
    motions: list[MotionEntry] = Field(default_factory=list)
    priors: list[PriorEntry] = Field(default_factory=list)
    unseen: list[str] = Field(default_factory=list)


class DetailsEntry(Entry):
    """Details of the page besides the agreed keys."""

    training: list[str]
    held_out: list[str]
    hold_out_kind: str
    hold_out_why: str
    remainder: str
    remarks: list[str]
    stages: list[StageEntry]
    constancy: list[dict[str, Any]]
    frames: dict[str, dict[str, PoseEntry]] = Field(default_factory=dict)
    statistics: StatisticsEntry = Field(default_factory=StatisticsEntry)


class LawGapsEntry(Entry):
    """The gap without and with a law."""

    train: GapEntry
    held_out: GapEntry


class LawEntry(Entry):
    """A missing law as a curve."""

    at: str
    quantity: str
    of: str
    unit: str
    of_unit: str
    x: list[float]
    value: list[float]
    low90: list[float]
    high90: list[float]
    kind: Literal["law", "law with memory", "change", "time", "none"]
    instant_s: Known
    probability: Probability
    says: str
    gap: LawGapsEntry


class ReportFile(BaseModel):
    """The whole file."""

    model_config = ConfigDict(extra="forbid")
    format: Literal["flexarm-diagnosis/1"]
    verdict: Literal["effects", "adequate", "unexplained", "unusable"]
    effects: list[EffectEntry]
    nuisances: list[NuisanceEntry]
    where: list[WhereEntry]
    refined: list[RefinedEntry]
    gap: GapsEntry
    next_experiment: str
    provenance: ProvenanceEntry
    details: DetailsEntry
    laws: list[LawEntry] = Field(default_factory=list)


def report_dict(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the object of `report.json`, checked against the format."""
    d = diagnosis
    content = {
        "format": FORMAT,
        "verdict": d.verdict,
        "effects": [{**asdict(effect), "figures": d.figures_of(effect)} for effect in d.effects],
        "nuisances": [asdict(nuisance) for nuisance in d.nuisances],
        "where": [{key: cell[key] for key in WhereEntry.model_fields} for cell in d.where],
        "refined": [{key: getattr(each, key) for key in RefinedEntry.model_fields} for each in d.refined],
        "gap": gaps_of(d),
        "next_experiment": d.next_experiment,
        "provenance": {
            **provenance_of(d.provenance),
            "rejected": [asdict(candidate) for candidate in d.rejected],
        },
        "details": _details(d),
        "laws": [law_dict(law) for law in d.laws],
    }
    without = None if d.laws else {"laws"}
    return ReportFile.model_validate(plain(content)).model_dump(mode="json", exclude=without)


def law_dict(law: LawCurve) -> dict[str, Any]:
    """Return the entry of a missing law."""
    found = {key: getattr(law, key) for key in LawEntry.model_fields if key != "gap"}
    return {**found, "gap": {"train": asdict(law.train), "held_out": asdict(law.held_out)}}


def gaps_of(d: BeforeAfter) -> dict[str, Any]:
    """Return the gap of the main signal on what was fitted and on what was held back."""
    return {
        "signal": d.main_signal,
        "unit": d.unit,
        "train": asdict(d.gap(d.training)),
        "held_out": asdict(d.gap(d.held_out)),
    }


def provenance_of(given: Mapping[str, Any]) -> dict[str, Any]:
    """Return what is known of where it comes from; version and commit of this installation where nothing is
    said.
    """
    versions = config()
    return {
        "version": given.get("version", versions["flexarm"]),
        "git": given.get("git", versions["git"]),
        "inputs_sha256": dict(given.get("inputs_sha256", {})),
        "seed": given.get("seed", 0),
        "step": given.get("step", 2e-3),
        "seconds": given.get("seconds", 0.0),
    }


def _details(d: Diagnosis) -> dict[str, Any]:
    return {
        "training": d.training,
        "held_out": d.held_out,
        "hold_out_kind": d.hold_out_kind,
        "hold_out_why": d.hold_out_why,
        "remainder": d.remainder,
        "remarks": [*filter(None, [unpredicted_sentence(d)]), *remarks_beside(d)],
        "stages": [{"label": stage.label, "rms": stage.rms} for stage in d.stages],
        "constancy": d.constancy,
        "frames": {
            record: {name: {"xyz": xyz, "rpy": rpy} for name, (xyz, rpy) in found.items()}
            for record, found in d.frames.items()
            if found
        },
        "statistics": asdict(d.statistics),
    }
