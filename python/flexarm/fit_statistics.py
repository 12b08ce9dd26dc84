"""Statistics of a fit as data: residuals of channels, correlations, and what the records cover."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ChannelStatistics:
    """Residual of a channel after the fit, with the discrepancy that was estimated for it.

    Attributes
    ----------
    record, signal, channel
        Whose rows they are; channel counts from 0.
    rows : int
        n.
    chi_square : float
        Mean square over that of the stated noise.
    autocorrelation : float or None
        Of neighbouring rows; None of poses, which have no order.
    discrepancy : float
        1 sigma of the model discrepancy, over the stated noise.
    length : float or None
        Its correlation length [s]; None of poses, and without a discrepancy.
    """

    record: str
    signal: str
    channel: int
    rows: int
    chi_square: float
    autocorrelation: float | None
    discrepancy: float
    length: float | None


@dataclass(frozen=True)
class Correlation:
    """Correlation of two fitted parameters."""

    parameters: tuple[str, str]
    value: float


@dataclass(frozen=True)
class Motion:
    """What a record covers of a joint.

    Attributes
    ----------
    record, joint : str
        Of which record, and which joint.
    unit : str
        Of the joint's coordinate: rad or m.
    lowest, highest : float
        Its range [unit].
    rms_rate : float or None
        Rms rate over tenths of a second [unit/s]; None of poses.
    """

    record: str
    joint: str
    unit: str
    lowest: float
    highest: float
    rms_rate: float | None


@dataclass(frozen=True)
class FitStatistics:
    """What a reader checks a fit by.

    Attributes
    ----------
    channels : tuple of ChannelStatistics
        By record, signal and channel.
    correlations : tuple of Correlation
        The strongest ones, these first.
    motions : tuple of Motion
        Conditions under which the model was tried.
    unseen : tuple of str
        Effects of the vocabulary that these signals could not have shown.
    """

    channels: tuple[ChannelStatistics, ...] = ()
    correlations: tuple[Correlation, ...] = ()
    motions: tuple[Motion, ...] = ()
    unseen: tuple[str, ...] = ()
