"""The result of a diagnosis: verdict, effects with alternatives, refined values, held-out gap."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

from flexarm.arguments import PATH, takes
from flexarm.diagnosis.held_out_gap import HELD_OUT_RATIO, HeldOutGap, held_out_gaps
from flexarm.diagnosis.refined_values import Refinement, stated_sigma
from flexarm.fit_statistics import FitStatistics
from flexarm.law_curve import LawCurve
from flexarm.named_effects import NamedEffect, Nuisance, Refined, Rejected, Stage
from flexarm.output import SavedAsDirectory, stems
from flexarm.pictures import Summarised, viewed
from flexarm.report.before_after import BeforeAfter

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.comparison import Comparison
    from flexarm.record import Record
    from flexarm.residual_analysis.localisation import Localisation
    from flexarm.viewer import View


Verdict = Literal["effects", "adequate", "unexplained", "unusable"]


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(BeforeAfter, SavedAsDirectory, Summarised):
    """The result of `diagnose`.

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
    hold_out_why : str
        What of it lies beyond the training, in words.
    located, located_after : Localisation or None
        Where the gap is, all records of training together: of the nominal and of the updated model.
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
    statistics : FitStatistics
        Chi-square and autocorrelation by channel, correlations, motions, effects that no signal could show.
    provenance : dict
        version, git, inputs_sha256, seed, seconds.
    laws : tuple of LawCurve
        After "unexplained": what is missing, as curves, the most probable first.
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
    hold_out_why: str = ""
    main_signal: str = ""
    located: Localisation | None = None
    located_after: Localisation | None = None
    stages: tuple[Stage, ...] = ()
    constancy: tuple[Mapping[str, Any], ...] = ()
    remainder: str = ""
    remarks: tuple[str, ...] = ()
    next_experiment: str = ""
    statistics: FitStatistics = field(default_factory=FitStatistics)
    provenance: Mapping[str, Any] = field(default_factory=dict)
    laws: tuple[LawCurve, ...] = ()

    @property
    def frames(self) -> dict[str, dict[str, tuple[list[float], list[float]]]]:
        """Return found poses of unknown frames by record of training, xyz [m] and rpy [rad] in the base."""
        compared = self.after or self.before
        return {name: dict(compared[name].frames) for name in self.training if name in compared}

    @property
    def refinements(self) -> tuple[Refinement, ...]:
        """Return the refined values, each with the sigma that the nominal model states."""
        return tuple(Refinement(each, stated_sigma(self.arm, each.parameter)) for each in self.refined)

    @property
    def unpredicted(self) -> HeldOutGap | None:
        """Return the held-out gap that is largest relative to noise and training.

        None below `HELD_OUT_RATIO`.
        """
        worst = max(held_out_gaps(self), key=lambda gap: gap.ratio, default=None)
        return None if worst is None or worst.ratio < HELD_OUT_RATIO else worst

    def figures_of(self, effect: NamedEffect) -> list[str]:
        """Names of the files that `save` draws for a named effect."""
        places = [e.at if isinstance(e.at, str) else f"{len(e.at)}-places" for e in self.effects]
        names = stems([f"{e.name}-{at}" for e, at in zip(self.effects, places, strict=True)])
        return [f"{names[self.effects.index(effect)]}.png"] if self.has_gap else []

    # ------------------------------------------------------------------- output

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `report.json`, checked against its format."""
        from flexarm.report.report_file import report_dict

        return report_dict(self)

    def summary(self) -> str:
        """Verdict, effects with 90 % intervals, alternatives, gap, and what to measure next, as text."""
        from flexarm.report.diagnosis import summary

        return summary(self)

    def view(self, record: Record | None = None, scale: float = 1.0, urdf: str | Path | None = None) -> View:
        """Show the updated model in three dimensions, along a record with its measured points.

        The nominal model is beside it, at the click of a button.

        Parameters
        ----------
        record : Record, optional
            Which one; without it the model is shown at rest.
        scale : float
            Displacements from the rigid arm at the same drive angles are shown times it.
        urdf : str or Path, optional
            The URDF file whose meshes rigid links are drawn with.

        Returns
        -------
        View
            One page without network; see `Arm.view`.
        """
        found: View = viewed(self, record=record, scale=scale, urdf=urdf)
        return found

    @classmethod
    @takes(path=PATH)
    def load(cls, path: str | Path) -> Self:
        """Return what `save` or `flexarm diagnose` wrote.

        It prints, draws and saves the same, but for the gap against states of the joints (`located`), which
        is not kept.

        Parameters
        ----------
        path : str or Path
            The directory, or the report.json in it; updated.toml and gaps.nc are beside it.

        Raises
        ------
        InvalidFile
            If a file is missing, or is not what a diagnosis wrote.

        Examples
        --------
        >>> flexarm.Diagnosis.load("diagnosis").plot(record="other_day")  # doctest: +SKIP
        """
        from flexarm.report.storage import stored

        return cls(**stored(path))

    def write(self, directory: Path, model: Path | None = None) -> None:
        """Write report.json, report.html, updated.toml, gaps.nc and the figures into a directory.

        The directory is there. With the file of the nominal model, updated.toml keeps its comments.
        """
        from flexarm.report.diagnosis import write  # needed only to write

        write(self, directory, model)
