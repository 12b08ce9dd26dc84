"""Statistics of a fit as data: residuals of channels, correlations, and what the records cover."""

from __future__ import annotations

from dataclasses import dataclass

from flexarm.json_values import KnownOrNan


@dataclass(frozen=True)
class PooledGap:
    """Totals of a signal [its unit]; None where no record holds it, or no noise is stated."""

    before_rms: float | None = None
    after_rms: float | None = None
    """Eq. (1) of `flexarm.comparison.pooled_gap`, of the nominal and of the updated model."""
    noise_rms: float | None = None
    """Gap that a model without an error would leave."""
    before_max: float | None = None
    after_max: float | None = None
    """Greatest gap."""


@dataclass(frozen=True)
class ChannelStatistics:
    """Residual of a channel after the fit, with the discrepancy that was estimated for it."""

    record: str
    signal: str
    channel: int
    """Whose rows they are; channel counts from 0."""
    rows: int
    chi_square: KnownOrNan
    """Mean square over that of the stated noise."""
    autocorrelation: float | None
    """Of neighbouring rows; None of poses, which have no order."""
    discrepancy: KnownOrNan
    """1 sigma of the model discrepancy, over the stated noise."""
    length: float | None
    """Its correlation length [s]; None of poses, and without a discrepancy."""
    axis: str = ""
    """Name of the channel, empty of a scalar."""


@dataclass(frozen=True)
class Correlation:
    """Correlation of two fitted parameters."""

    parameters: tuple[str, str]
    value: KnownOrNan


@dataclass(frozen=True)
class Motion:
    """What a record covers of a joint."""

    record: str
    joint: str
    """Of which record, and which joint."""
    unit: str
    """Of the joint's coordinate: rad or m."""
    lowest: float
    highest: float
    """Its range [unit]."""
    rms_rate: float | None
    """Rms rate over tenths of a second [unit/s]; None of poses."""


@dataclass(frozen=True)
class PlausibleRange:
    """What was held plausible of a fitted parameter before the records were seen: its prior."""

    effect: str
    at: str | tuple[str, ...]
    parameter: str
    """Of which effect, where, and which of its parameters."""
    low: float
    typical: float
    high: float
    """Range that holds 95 % of machines, all of them if `uniform`, and the most plausible value [unit]."""
    unit: str
    uniform: bool
    """Whether every value of the range is as plausible as the others."""
    source: str
    """Where the values come from, one sentence."""


@dataclass(frozen=True)
class FitStatistics:
    """What a reader checks a fit by."""

    channels: tuple[ChannelStatistics, ...] = ()
    """By record, signal and channel."""
    correlations: tuple[Correlation, ...] = ()
    """The strongest ones, these first."""
    motions: tuple[Motion, ...] = ()
    """Conditions under which the model was tried."""
    priors: tuple[PlausibleRange, ...] = ()
    """Of the parameters of effects, in the order of the effects."""
    unseen: tuple[str, ...] = ()
    """Effects of the vocabulary that these signals could not have shown."""
