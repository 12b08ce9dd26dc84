"""The outcome of a calibration: parameters with intervals, families, correlations, and the updated model."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from flexarm.arguments import takes
from flexarm.arm.consistency import missing
from flexarm.arrays import Floats
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.calibration_estimates import CalibratedFamily, CalibratedFrame, CalibratedParameter, ChiSquare
from flexarm.errors import InvalidParameter
from flexarm.output import SavedAsDirectory
from flexarm.pictures import Summarised
from flexarm.report import calibration as calibration_report
from flexarm.report.calibration import KIND, REPORT, CalibrationFile
from flexarm.report.gap_figures import BeforeAfter
from flexarm.report.storage import stored_parts, tuple_of

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.comparison.comparison import Comparison


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(BeforeAfter, SavedAsDirectory, Summarised):
    """The result of `calibrate`.

    Attributes
    ----------
    arm, updated : Arm
        The nominal model; the model with the estimates, without clocks and frames.
    parameters : tuple of CalibratedParameter
        Families first, then nominal values, clocks and frames.
    correlations : ndarray, shape (m, m)
        Of the parameters, in their order.
    families : tuple of CalibratedFamily
        In the order asked for.
    frames : tuple of CalibratedFrame
        Estimated poses of frames of measurement.
    chi_square : ChiSquare
        Goodness of fit.
    before, after : dict of str to Comparison
        By record, held-out ones too: the gap of the nominal and of the updated model, aligned.
    training, held_out : tuple of str
        Names of the records. Without a held-out one, blocks were held back.
    hold_out_kind : str
        "repetition", "interpolation" or "extrapolation" of the training, or "blocks".
    main_signal : str
        The signal of the report's `gap`.
    remarks : tuple of str
        Sentences on limits of the result.
    provenance : dict
        version, git, inputs_sha256, seconds.
    """

    arm: Arm
    updated: Arm
    parameters: tuple[CalibratedParameter, ...]
    correlations: Floats
    families: tuple[CalibratedFamily, ...]
    frames: tuple[CalibratedFrame, ...]
    chi_square: ChiSquare
    before: Mapping[str, Comparison]
    after: Mapping[str, Comparison]
    training: tuple[str, ...]
    held_out: tuple[str, ...]
    hold_out_kind: str
    main_signal: str
    remarks: tuple[str, ...] = ()
    provenance: Mapping[str, Any] = field(default_factory=dict)

    @takes()
    def parameter(self, name: str) -> CalibratedParameter:
        """Return the estimate of a parameter.

        Raises
        ------
        InvalidParameter
            If it was not estimated.
        """
        for each in self.parameters:
            if each.name == name:
                return each
        raise InvalidParameter(missing("parameter", name, [each.name for each in self.parameters]))

    @property
    def confounded(self) -> list[tuple[str, str, float]]:
        """Pairs of determined parameters of high correlation, the highest first."""
        known = [k for k, each in enumerate(self.parameters) if each.determined]
        pairs = [
            (self.parameters[i].name, self.parameters[j].name, float(self.correlations[i, j]))
            for a, i in enumerate(known)
            for j in known[a + 1 :]
            if abs(self.correlations[i, j]) > CalibrationPolicy.correlated
        ]
        return sorted(pairs, key=lambda pair: -abs(pair[2]))

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `calibration.json`, checked against its format."""
        return calibration_report.calibration_dict(self)

    def summary(self) -> str:
        """Estimates with 90 % intervals, correlations and gaps, as text."""
        return calibration_report.summary(self)

    @classmethod
    @takes()
    def load(cls, path: str | Path) -> Self:
        """Return what `save` or `flexarm calibrate` wrote.

        Parameters
        ----------
        path : str or Path
            The directory, or the calibration.json in it; updated.toml and gaps.nc are beside it.

        Raises
        ------
        InvalidFile
            If a file is missing, or is not what a calibration wrote.

        Examples
        --------
        >>> flexarm.Calibration.load("calibrated").plot(record="other_day")  # doctest: +SKIP
        """
        told, common = stored_parts(path, KIND, REPORT, CalibrationFile)
        names = told["correlations"]["parameters"]
        return cls(
            **common,
            parameters=tuple_of(CalibratedParameter, told["parameters"], None),
            correlations=np.reshape(told["correlations"]["matrix"], (len(names), len(names))),
            families=tuple_of(CalibratedFamily, told["families"], None),
            frames=tuple_of(CalibratedFrame, told["frames"], None),
            chi_square=ChiSquare(**{k: v for k, v in told["chi_square"].items() if k != "reduced"}),
            provenance=told["provenance"],
        )

    def write(self, directory: Path, model: Path | None = None) -> None:
        """Write calibration.json, report.html, updated.toml, gaps.nc and figures into a directory that is
        there. With the file of the nominal model, updated.toml keeps its comments.
        """
        calibration_report.write(self, directory, model)
