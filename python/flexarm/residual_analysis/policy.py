"""Thresholds of the residual analysis, each with its unit and reason."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ResidualPolicy:
    """Thresholds of the residual analysis."""

    false_alarm: float = 1e-3
    """Probability [-] that any cell of a table exceeds white noise by chance: one table in a thousand."""
    order_false_alarm: float = 1e-5
    """Probability [-] that noise alone is taken for a motor order: hundreds are tested for each arm."""
    order_contrast: float = 3.0
    """Squares of a motor order over those of a wave of nearly the same order [-]: any wave explains some."""
    order_share: float = 0.01
    """Share of the squared gap below which a motor order is not reported [-]."""
    order_spacing: float = 0.1
    """Relative distance of the orders compared with a motor order [-]; 1/0.1 periods tell them apart."""
    peak_over_median: float = 15.0
    """Power of a spectral line over the median power [-]; white noise reaches ten."""
    modes: int = 2
    """Modes that are looked for in orders and folded bands: higher ones hold little of a motion."""
    band_half_width: float = 0.1
    """Half the width of a band about a frequency, over that frequency [-]: poses move frequencies so much."""
    covariate_gain: float = 0.05
    """Share of the squares that a more complex covariate must explain beyond a simpler one [-]."""
    explained_share: float = 0.5
    """Share of what is not constant that a covariate must explain to be named in a table [-]: most of it."""
    dominant_share: float = 0.25
    """Share of the squares that a band or covariate must hold to be named in a sentence [-]."""
    concentration: float = 0.15
    """Relative entropy of the squares given a condition that is reported [nat]: 77 % in half of the samples.
    """
    listed_share: float = 0.02
    """Share of the squared gap below which a band or joint is not listed [-]."""
    minor_share: float = 0.1
    """Share of a signal's largest part in a band below which its other directions are not listed [-]."""
    burst_share: float = 0.2
    """Share of all samples that may hold half of the squares of a burst [-]."""
    rest: float = 1e-3
    """Share of the greatest rate, or of a drive's range, below which a joint counts as at rest [-]."""
    noise_ratio: float = 1.5
    """Factor between stated and estimated noise from which they contradict each other [-]."""
    decay_periods: float = 3.0
    """Periods of a segment of a free decay [1]."""
    decay_segments: int = 3
    """Least segments [1] that show a change of frequency or damping."""
    decay_samples: int = 8
    """Least samples in a period [1]."""
    decay_amplitude: float = 15.0
    """Least amplitude of a decay segment over its standard deviation [-]: zeta is then known to 0.01."""
    decay_sigmas: float = 3.0
    """Standard deviations by which frequency or damping must change with the amplitude [-]."""
    frequency_change: float = 0.02
    """Relative change of a frequency with the amplitude that is reported [-]."""
    damping_change: float = 0.2
    """Relative change of a damping ratio with the amplitude that is reported [-]."""


POLICY = ResidualPolicy()
