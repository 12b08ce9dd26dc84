"""The gap of a model before and after it is changed: what results of diagnosis and calibration share."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from flexarm.arguments import NAMES, TEXT, takes
from flexarm.arm import Arm
from flexarm.comparison.comparison import Comparison
from flexarm.comparison.pooled_gap import pooled_gap
from flexarm.fit_statistics import PooledGap
from flexarm.report.gap_figures import plot

if TYPE_CHECKING:
    from matplotlib.axes import Axes


class BeforeAfter:
    """The gap of a nominal and of an updated model."""

    arm: Arm
    updated: Arm
    before: Mapping[str, Comparison]
    after: Mapping[str, Comparison]
    """By record, held-out ones too: the gap of either, aligned."""
    training: tuple[str, ...]
    held_out: tuple[str, ...]
    main_signal: str
    """The signal of the report's `gap`."""

    @property
    def unit(self) -> str:
        """Unit of the main signal's gap; empty if nothing could be compared."""
        return self.unit_of(self.main_signal)

    def unit_of(self, signal: str) -> str:
        """Return the unit of the gap of a signal; empty if it could not be compared."""
        found = (comparison.signals.get(signal) for comparison in self.before.values())
        return next((gap.unit for gap in found if gap is not None), "")

    @property
    def has_gap(self) -> bool:
        """Return True if there is a gap to be shown: not where the data could not be compared at all."""
        return bool(self.unit)

    @takes(records=NAMES)
    def gap(self, records: Iterable[str], signal: str | None = None) -> PooledGap:
        """Return totals of a signal (default: the main one) before and after, pooled over records."""
        return pooled_gap(self.before, self.after, records, self.main_signal if signal is None else signal)

    @takes(record=TEXT)
    def plot(self, ax: Axes | None = None, record: str | None = None) -> Axes:
        """Return the main signal's gap before and after along a record, and the noise (2 sigma) as a band.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw.
        record : str, optional
            Which one; default: the first held-out one, or the first of training.

        Raises
        ------
        InvalidParameter
            If there is no such record, or nothing in it was compared.
        """
        return plot(self, ax, record)
