"""Budget of time for long work: what no time is left for is left out, and said."""

from __future__ import annotations

from math import inf
from time import monotonic


class Budget:
    """Seconds that work may take, from now on.

    Attributes
    ----------
    seconds : float
        Wall-clock time [s]; infinite by default.
    left_out : list of str
        Work that no time was left for.
    """

    def __init__(self, seconds: float | None = None) -> None:
        self.seconds = inf if seconds is None else float(seconds)
        self.left_out: list[str] = []
        self._begun = monotonic()

    @property
    def spent(self) -> bool:
        """Return True if no time is left."""
        return monotonic() - self._begun >= self.seconds

    def allows(self, work: str) -> bool:
        """Return True if time is left; else note that this work is left out."""
        if self.spent and work not in self.left_out:
            self.left_out.append(work)
        return not self.spent

    @property
    def remarks(self) -> tuple[str, ...]:
        """Return a sentence on what was left out; none if all was done."""
        done = f"the budget of {self.seconds:g} s ended before {', '.join(self.left_out)}"
        return (done,) if self.left_out else ()
