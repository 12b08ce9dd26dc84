"""Numbers that a calibration decides by, in one place."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CalibrationPolicy:
    """Priors of families, and when an estimate is at rest; each with its unit and reason."""

    spread: float = 1.0
    """Prior spread [-] of ln(size) in a family: a factor e, as base and wrist of an arm differ."""
    spread_members: float = 2.0
    """Members that the prior of a spread counts as [1]: it decides only where a family is small."""
    sizes: int = 9
    """Shared sizes that are tried first [1], from far below to far above what is plausible."""
    beyond: float = 3.0
    """How far they reach beyond the plausible range [factor]."""
    settled: float = 0.2
    """Greatest move [sigma] of an estimate at rest: a fifth is 2 % of its mean square error."""
    settled_first: float = 2.0
    """The same of shared sizes [sigma], which are a start of what follows."""
    iterations_first: int = 3
    """Most linearisations with shared sizes [1]."""
    foretold: float = 0.1
    """Part [-] of a step that derivatives may miss and are kept, as in `diagnosis.estimator`."""
    iterations: int = 30
    """Most linearisations of one estimation [1]."""
    longest: float = 1.5
    """Longest step of a logarithm [-]: further away a linearisation says nothing."""
    damping: float = 1e-3
    """First damping [-] of a step that led up, over the diagonal; tenfold with each further trial."""
    trials: int = 8
    """Most trials of one step [1]."""
    known: float = 0.5
    """Share [-] of its prior variance that data must remove from a parameter that they determine."""
    correlated: float = 0.9
    """Correlation [-] of two parameters that is told."""
