"""The result of a diagnosis: verdict, effects with alternatives, refined values, held-out gap.

A right model leaves of a held-out record what it leaves of the training, or the noise. Held-out data choose
no effect. The signal with the largest held-out residual relative to training and noise is reported beside the
verdict if it exceeds them by `HELD_OUT_RATIO`.

No model is adequate that leaves `HELD_OUT_RATIO` of the noise of held-out data, input noise and
discretisation error included: the verdict is then "unexplained". Where the training begins in motion, the
initial vibration counts as noise too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import floor, isfinite, log10, sqrt
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Self

from flexarm.arguments import takes
from flexarm.arm.parameter import stated_sigma
from flexarm.comparison.align import KEPT
from flexarm.fit_statistics import FitStatistics
from flexarm.law_curve import LawCurve
from flexarm.named_effects import NamedEffect, Nuisance, Refined, Rejected, Stage
from flexarm.output import SavedAsDirectory, stems
from flexarm.pictures import Summarised, viewed
from flexarm.report import diagnosis as diagnosis_report
from flexarm.report.gap_figures import BeforeAfter
from flexarm.report.report_file import report_dict
from flexarm.report.sentences import contradicted_sentence
from flexarm.report.storage import stored
from flexarm.wording import scale, signed

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.comparison import Comparison
    from flexarm.record import Record
    from flexarm.residual_analysis.localisation import Localisation
    from flexarm.viewer import View


HELD_OUT_RATIO = 3.0
"""Four readings of noise, as two poses have, are as far off once in three million times."""
SIMULATION_ERROR = {"m": 1e-6, "rad": 1e-6}
"""Error of any simulation by unit, for records without noise."""

Verdict = Literal["effects", "adequate", "unexplained", "unusable"]


@dataclass(frozen=True)
class Refinement:
    """A refined value and its stated sigma."""

    refined: Refined
    """The value."""
    sigma: float | None
    """1 sigma that the model states; None if it states none."""

    @property
    def moved(self) -> float:
        """Return the distance from the nominal value [unit]."""
        return self.refined.value - self.refined.nominal

    @property
    def pull(self) -> float | None:
        """Return `moved` in stated sigmas."""
        return self.moved / self.sigma if self.sigma else None

    @property
    def determined(self) -> bool:
        """Return True if the data say more than was known."""
        return self.sigma is None or self.refined.std < KEPT * self.sigma

    @property
    def changed(self) -> bool:
        """Return True if the repaired model has another value; those that are left open mostly have not."""
        return self.refined.changed

    @property
    def texts(self) -> tuple[str, str, str]:
        """Moved and 1 sigma with the digits that this leaves, and the unit of both."""
        std = self.refined.std
        factor, unit = scale([self.moved, std], self.refined.unit)
        if not isfinite(std) or std <= 0:
            return signed(factor * self.moved, 2), "–", unit
        places = max(0, min(9, 1 - floor(log10(factor * std))))
        return signed(factor * self.moved, places), f"{factor * std:.{places}f}", unit


@dataclass(frozen=True)
class HeldOutGap:
    """Residuals of a signal after the update, in a held-out record and in the training, in its unit."""

    record: str
    signal: str
    unit: str
    held_out: float
    noise: float | None
    training: float | None

    @property
    def least(self) -> float:
        """Return what a simulation misses anyway."""
        return SIMULATION_ERROR.get(self.unit, 0.0)

    @property
    def ratio(self) -> float:
        """To the greater one of what is left of the training and the noise; zero where nothing is known."""
        known = max(self.noise or 0.0, self.training or 0.0, self.least)
        return self.held_out / known if known > 0 else 0.0


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
        return report_dict(self)

    def summary(self) -> str:
        """Verdict, effects with 90 % intervals, alternatives, gap, and what to measure next, as text."""
        return diagnosis_report.summary(self)

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
        return viewed(self, record=record, scale=scale, urdf=urdf)

    @classmethod
    @takes()
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
        return cls(**stored(path))

    def write(self, directory: Path, model: Path | None = None) -> None:
        """Write report.json, report.html, updated.toml, gaps.nc and the figures into a directory.

        The directory is there. With the file of the nominal model, updated.toml keeps its comments.
        """
        diagnosis_report.write(self, directory, model)


def adequate_if_predicted(
    d: Diagnosis, input_variance_ratio: Mapping[str, float], initial_transient: bool
) -> Diagnosis:
    """Return the diagnosis, "unexplained" if it is "adequate" and held-out data contradict that.

    `input_variance_ratio` is the mean square of input noise and discretisation error over that of the noise,
    by signal. `initial_transient` is True if a training record begins in motion: `compare` then shows
    vibrations that a fit removes.
    """
    if d.verdict != "adequate":
        return d

    def times(left: HeldOutGap) -> float:
        if left.noise is None or initial_transient:
            return left.ratio
        return left.held_out / max(
            left.noise * sqrt(1 + input_variance_ratio.get(left.signal, 0.0)), left.least, 1e-300
        )

    worst = max(held_out_gaps(d), key=times, default=None)
    if worst is None or times(worst) < HELD_OUT_RATIO:
        return d
    said = contradicted_sentence(worst)
    return replace(d, verdict="unexplained", remainder=" ".join(filter(None, (said, d.remainder))))


def held_out_gaps(d: Diagnosis) -> list[HeldOutGap]:
    """Return the held-out gap of each signal that is evidence, in each record."""
    found = []
    for record in d.held_out:
        for signal, gap in (d.after[record].evidence if record in d.after else {}).items():
            held, trained = d.gap([record], signal), d.gap(d.training, signal)
            if held.after_rms is not None:
                unit, after = gap.unit, held.after_rms
                found.append(HeldOutGap(record, signal, unit, after, held.noise_rms, trained.after_rms))
    return found
