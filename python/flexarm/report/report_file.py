"""`report.json`, format `flexarm-diagnosis/1`: what programs read of a diagnosis.

Unknown numbers, such as the deviation of what the data do not determine, are null. Besides the agreed keys,
`details` holds the sentences and curves of the page.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field

from flexarm.configuration import config
from flexarm.fit_statistics import FitStatistics, PooledGap
from flexarm.json_values import plain
from flexarm.named_effects import NamedEffect, Nuisance, Probability, Rejected, Stage
from flexarm.report.sentences import remarks_beside, unpredicted_sentence

if TYPE_CHECKING:
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.law_curve import LawCurve
    from flexarm.report.gap_figures import BeforeAfter


FORMAT = "flexarm-diagnosis/1"

Known = Annotated[float | None, BeforeValidator(plain)]
"""None for a number that is not finite, which JSON has not."""


class Entry(BaseModel):
    """A table of a report's file; unknown keys are errors."""

    model_config = ConfigDict(extra="forbid")


@dataclass(frozen=True)
class EffectEntry(NamedEffect):
    """A named effect and its figures."""

    figures: tuple[str, ...] = ()


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


class GapsEntry(Entry):
    """The gap on what was fitted and on what was held back."""

    signal: str
    unit: str
    train: PooledGap
    held_out: PooledGap


class ProvenanceEntry(Entry):
    """Where the report comes from."""

    version: str
    git: str
    inputs_sha256: dict[str, str]
    seed: int
    step: float = 2e-3
    seconds: float
    rejected: list[Rejected]


class PoseEntry(Entry):
    """A frame of measurement in the base."""

    xyz: list[float]
    rpy: list[float]


class DetailsEntry(Entry):
    """Details of the page besides the agreed keys."""

    training: list[str]
    held_out: list[str]
    hold_out_kind: str
    hold_out_why: str
    remainder: str
    remarks: list[str]
    stages: list[Stage]
    constancy: list[dict[str, Any]]
    frames: dict[str, dict[str, PoseEntry]] = Field(default_factory=dict)
    statistics: FitStatistics = Field(default_factory=FitStatistics)


class LawGapsEntry(Entry):
    """The gap without and with a law."""

    train: PooledGap
    held_out: PooledGap


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


class ReportFile(Entry):
    """The whole file."""

    format: Literal["flexarm-diagnosis/1"]
    verdict: Literal["effects", "adequate", "unexplained", "unusable"]
    effects: list[EffectEntry]
    nuisances: list[Nuisance]
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
    details = {
        **{key: getattr(d, key) for key in DetailsEntry.model_fields},
        "remarks": [*filter(None, [unpredicted_sentence(d)]), *remarks_beside(d)],
        "stages": [asdict(stage) for stage in d.stages],
        "frames": {
            record: {name: {"xyz": xyz, "rpy": rpy} for name, (xyz, rpy) in found.items()}
            for record, found in d.frames.items()
            if found
        },
        "statistics": asdict(d.statistics),
    }
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
        "details": details,
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
