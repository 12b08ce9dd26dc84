"""The outcome of a diagnosis: verdict, named effects with their rivals, what is uncertain, the repaired model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.comparison import Comparison

Verdict = Literal["effects", "adequate", "unexplained", "unusable"]


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter.

    Attributes
    ----------
    name : str
        As `Effect.parameters` spells it, such as "stiffness" or "offset.x".
    value, std, low90, high90 : float
        Estimate, 1 sigma, and the 90 % interval [unit].
    unit : str
        Of all four.
    """

    name: str
    value: float
    std: float
    low90: float
    high90: float
    unit: str


@dataclass(frozen=True)
class Alternative:
    """An effect that the data cannot tell from the named one.

    Attributes
    ----------
    name, at : str
        Effect and place.
    probability : float
        Among the named effect and its alternatives.
    """

    name: str
    at: str
    probability: float


@dataclass(frozen=True)
class NamedEffect:
    """An effect that the diagnosis names.

    Attributes
    ----------
    name, at : str
        Effect and place.
    probability : float
        That this is the effect, all alternatives considered.
    parameters : tuple of Estimate
        What was fitted.
    alternatives : tuple of Alternative
        All others within a Bayes factor of 20.
    evidence : str
        One sentence for a person.
    """

    name: str
    at: str
    probability: float
    parameters: tuple[Estimate, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    evidence: str = ""


@dataclass(frozen=True)
class Nuisance:
    """A clock offset or registration that was fitted along: an effect within its stated uncertainty."""

    name: str
    at: str
    parameters: tuple[Estimate, ...]


@dataclass(frozen=True)
class Refined:
    """A nominal value that was refined within its stated uncertainty; `parameter` is its key."""

    parameter: str
    value: float
    std: float
    nominal: float
    unit: str = ""


@dataclass(frozen=True)
class Rejected:
    """A candidate that was tried: what it left of the gap, and why it was not taken."""

    name: str
    at: str
    log_bayes_factor: float
    why: str


@dataclass(frozen=True)
class Stage:
    """A model on the way from the nominal to the repaired one, with its gap by record [m or the signal's unit].

    Attributes
    ----------
    label : str
        What was added: "nominal", an effect, "nominal values refined".
    rms : dict of str to float
        Total rms of the main signal, aligned, by record (the held-out one too).
    """

    label: str
    rms: Mapping[str, float]


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """What `diagnose` found.

    Attributes
    ----------
    verdict : {"effects", "adequate", "unexplained", "unusable"}
        In a word.
    arm, updated : Arm
        The nominal model; the model with the effects and refined values, without nuisances.
    effects : tuple of NamedEffect
        Most probable first.
    nuisances, refined, rejected
        What was fitted along, which nominal values moved, which candidates were not taken.
    where : tuple of dict
        Where simulation and measurement disagree: entries of the report's `where`.
    before, after : dict of str to Comparison
        By record, held-out ones too: the gap of the nominal and of the updated model, aligned.
    training, held_out : tuple of str
        Names of the records. Without a held-out one, blocks of time were held back.
    hold_out_kind : str
        "repetition", "interpolation" or "extrapolation" of the training, or "blocks".
    main_signal : str
        The signal of the report's `gap`.
    stages : tuple of Stage
        The gap shrinking.
    constancy : tuple of dict
        Each effect's parameters by record alone: {"effect", "at", "parameter", "unit", "values": {record:
        (value, std)}, "q", "p_value", "constant": bool, "moves_with": str}.
    remainder : str
        Description of what is left, a sentence; empty if the rest is noise.
    remarks : tuple of str
        What the reader should know: outliers removed, what the data cannot tell.
    next_experiment : str
        One sentence, empty if nothing is left to separate.
    provenance : dict
        version, git, inputs_sha256, seed, seconds.
    """

    verdict: Verdict
    arm: Arm
    updated: Arm
    effects: tuple[NamedEffect, ...] = ()
    nuisances: tuple[Nuisance, ...] = ()
    refined: tuple[Refined, ...] = ()
    rejected: tuple[Rejected, ...] = ()
    where: tuple[Mapping[str, Any], ...] = ()
    before: Mapping[str, Comparison] = field(default_factory=dict)
    after: Mapping[str, Comparison] = field(default_factory=dict)
    training: tuple[str, ...] = ()
    held_out: tuple[str, ...] = ()
    hold_out_kind: str = "blocks"
    main_signal: str = ""
    stages: tuple[Stage, ...] = ()
    constancy: tuple[Mapping[str, Any], ...] = ()
    remainder: str = ""
    remarks: tuple[str, ...] = ()
    next_experiment: str = ""
    provenance: Mapping[str, Any] = field(default_factory=dict)
