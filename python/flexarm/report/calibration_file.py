"""`calibration.json`, format `flexarm-calibration/1`: what programs read of a calibration."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from flexarm.json_values import plain
from flexarm.report.report_file import Entry, GapsEntry, Known, gaps_of, provenance_of

if TYPE_CHECKING:
    from flexarm.calibration.result import Calibration

FORMAT = "flexarm-calibration/1"


class RangeEntry(Entry):
    """A value with its 90 % interval."""

    value: float
    low90: Known
    high90: Known


class ParameterEntry(Entry):
    """An estimate; `name` is the key of the model's parameter."""

    name: str
    kind: Literal["family", "nominal", "clock", "frame", "base"]
    value: float
    std: Known
    low90: Known
    high90: Known
    unit: str
    prior: RangeEntry
    identifiability: Annotated[float, Field(ge=0, le=1)]
    family: str


class FamilyEntry(Entry):
    """A family of effects."""

    effect: str
    parameter: str
    unit: str
    at: list[str]
    shared: RangeEntry | None
    spread: float


class FrameEntry(Entry):
    """Pose of a frame of measurement in the base."""

    name: str
    xyz: list[float]
    rpy: list[float]


class CorrelationsEntry(Entry):
    """Correlations of the parameters, in their order."""

    parameters: list[str]
    matrix: list[list[float]]


class ChiSquareEntry(Entry):
    """Goodness of fit."""

    value: float
    rows: int
    parameters: float
    reduced: float
    inflation: dict[str, float]


class ProvenanceEntry(Entry):
    """Where the calibration comes from."""

    version: str
    git: str
    inputs_sha256: dict[str, str]
    step: float
    seconds: float


class DetailsEntry(Entry):
    """Records, and sentences for a person."""

    training: list[str]
    held_out: list[str]
    hold_out_kind: str
    remarks: list[str]


class CalibrationFile(BaseModel):
    """The whole file."""

    model_config = ConfigDict(extra="forbid")
    format: Literal["flexarm-calibration/1"]
    parameters: list[ParameterEntry]
    families: list[FamilyEntry]
    correlations: CorrelationsEntry
    frames: list[FrameEntry]
    chi_square: ChiSquareEntry
    gap: GapsEntry
    provenance: ProvenanceEntry
    details: DetailsEntry


def calibration_dict(found: Calibration) -> dict[str, Any]:
    """Return the object of `calibration.json`, checked against the format."""
    digits = 4  # of a correlation: more are noise
    provenance = provenance_of(found.provenance)
    content = {
        "format": FORMAT,
        "parameters": [asdict(each) for each in found.parameters],
        "families": [asdict(each) for each in found.families],
        "correlations": {
            "parameters": [each.name for each in found.parameters],
            "matrix": found.correlations.round(digits),
        },
        "frames": [asdict(each) for each in found.frames],
        "chi_square": {**asdict(found.chi_square), "reduced": found.chi_square.reduced},
        "gap": gaps_of(found),
        "provenance": {key: provenance[key] for key in ProvenanceEntry.model_fields},
        "details": {key: getattr(found, key) for key in DetailsEntry.model_fields},
    }
    return CalibrationFile.model_validate(plain(content)).model_dump(mode="json")
