"""Effective number of parameters of a clock or frame after an alignment.

Whitened readings with the Jacobian J with respect to the alignment parameters, and their priors, determine
the parameter i by the share

    R_ii,   R = (J^T J + diag(1/sigma^2))^-1 J^T J                                                     (1)

which is 0 where its prior holds it and 1 where the readings do [MacKay1992]. With p the sum of (1) over the
parameters of one clock or frame, N readings that are noise leave sqrt(1 - p/N) of themselves.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class EffectiveParameters:
    """Hold the effective parameters of a clock or frame."""

    name: str
    """Of the clock or frame."""
    count: float
    """p of (1)."""
    readings: int
    """Values of its signals that counted."""
    signals: tuple[str, ...]

    @property
    def overfitted(self) -> bool:
        """Return True if so few readings were aligned that their residual says little of a model."""
        rounding = 1e-6  # of p
        # Readings for each aligned value below which that is said: a fifth of the noise is then aligned
        # away.
        few = 3.0
        return self.readings < few * self.count * (1 - rounding)

    def __str__(self) -> str:
        left = max(0.0, 1.0 - self.count / self.readings) ** 0.5 if self.readings else 0.0
        values = f"{self.count:.2g} value{'s' * (self.count > 1)}"
        return (
            f"{self.readings} readings of {', '.join(self.signals)} are few for the {values} of {self.name} "
            f"that were aligned to them: of noise {100 * left:.0f} % would be left, and a gap may be "
            "aligned away"
        )
