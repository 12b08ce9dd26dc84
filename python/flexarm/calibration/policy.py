"""Settings of a calibration."""

from __future__ import annotations

from dataclasses import dataclass

from flexarm.calibration_estimates import DETERMINED
from flexarm.diagnosis.policy import FamilyPolicy
from flexarm.former_names import takes_former_names


@takes_former_names(
    renamed={
        "spread": "family_spread",
        "spread_members": "family_count",
        "beyond": "range_factor",
        "settled": "tolerance",
        "settled_first": "tolerance_first",
        "foretold": "linearisation_error",
        "longest": "longest_step",
        "known": "determined",
    }
)
@dataclass(frozen=True)
class CalibrationPolicy(FamilyPolicy):
    """Settings of a calibration, all with a default."""

    sizes: int = 9
    """Shared sizes at which the multi-start begins [1]."""
    range_factor: float = 3.0
    """Factor by which these reach beyond the plausible range [-]."""
    tolerance: float = 0.2
    """Greatest move of a converged estimate [sigma]: a fifth is 2 % of its mean square error."""
    tolerance_first: float = 2.0
    """The same of shared sizes [sigma], from which the estimate of all members starts."""
    iterations_first: int = 3
    """Most linearisations with shared sizes [1]."""
    linearisation_error: float = 0.1
    """Part [-] of a step's change that derivatives may miss and are still used for the next step."""
    iterations: int = 30
    """Most linearisations of one estimation [1]."""
    restarts: int = 6
    """Most estimations [1], each from a lower point of the valley of the one before."""
    draws: int = 40
    """Draws from the prior [1] that are simulated for other starts where a gap stays."""
    starts: int = 3
    """The best of them [1], from which estimations start."""
    longest_step: float = 1.5
    """Longest step of a logarithm [-]: a linearisation holds no further."""
    damping: float = 1e-3
    """First damping [-] after a step that raised the objective, over the diagonal; tenfold each time."""
    trials: int = 8
    """Most trials of one step [1]."""
    determined: float = DETERMINED
    """Share of its prior variance [-] that data remove from a parameter that they determine."""
    correlated: float = 0.9
    """Correlation of two parameters [-] that is reported."""
    inflated: float = 2.0
    """Variance of a signal's residual over that of its noise [-] that is reported as a gap."""
    curved: float = 0.2
    """Part [-] of its rise at the ends of an interval by which an objective misses that of a normal posterior
    before its valley is traced."""
    reach: float = 12.0
    """Farthest point of a valley [sigma of the normal posterior]."""
    lost: float = 4.0
    """Fall of ln p [-] at which a valley ends: 2 % of its peak."""
    along: float = 0.3
    """Share of its variance [-] along the valley from which a parameter's interval follows it."""
