"""Budget of time for long work: what no time is left for is left out, and said.

with limited(60.0) as budget:
    ...                            # which asks `allows("the next step")` before its steps
print(*budget.remarks)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from math import inf, isfinite
from time import monotonic
from typing import ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")

BUDGET = "the budget of"
"""How the remark on what was left out begins."""


def ended_early(remarks: Sequence[str]) -> bool:
    """Return True if one of the remarks says that a budget ended before all was done."""
    return any(remark.startswith(BUDGET) for remark in remarks)


class Budget:
    """Wall-clock time [s] that work may take from now on, by default infinite, and what none was left for."""

    def __init__(self, seconds: float | None = None) -> None:
        self.seconds = inf if seconds is None else float(seconds)
        self.left_out: list[str] = []
        self._begun = monotonic()

    @property
    def left(self) -> float:
        """Return the time left [s], negative if more was taken."""
        return self._begun + self.seconds - monotonic()

    @property
    def spent(self) -> bool:
        """Return True if no time is left."""
        return self.left <= 0

    @property
    def remarks(self) -> tuple[str, ...]:
        """Return a sentence on what was left out; none if all was done."""
        *others, last = self.left_out or [""]
        work = f"{', '.join(others)} and {last}" if others else last
        return (f"{BUDGET} {self.seconds:g} s ended before {work}",) if last else ()


CURRENT: ContextVar[Budget] = ContextVar("budget")
"""Budget of the work under way; threads that it starts have none of their own."""


@contextmanager
def limited(seconds: float | None) -> Iterator[Budget]:
    """Limit the work of a block to some seconds; None: no limit."""
    budget = Budget(seconds)
    token = CURRENT.set(budget)
    try:
        yield budget
    finally:
        CURRENT.reset(token)


def budgeted(work: Callable[P, R]) -> Callable[P, R]:
    """Limit a function to its argument `max_seconds`, given by name, as `limited` does."""

    @wraps(work)
    def within(*args: P.args, **kwargs: P.kwargs) -> R:
        with limited(cast(float | None, kwargs.get("max_seconds"))):
            return work(*args, **kwargs)

    return within


def current() -> Budget:
    """Return the budget of the work under way, endless outside of `limited`."""
    return CURRENT.get(Budget())


@contextmanager
def until(part: float) -> Iterator[None]:
    """End a stage of the work when a part of the whole time [-] is gone: the rest is for later stages."""
    whole = current()
    stage = Budget(max(whole.left - (1 - part) * whole.seconds, 0.0)) if isfinite(whole.seconds) else whole
    stage.left_out = whole.left_out
    token = CURRENT.set(stage)
    try:
        yield
    finally:
        CURRENT.reset(token)


def allows(work: str) -> bool:
    """Return True if time is left; else note that this work is left out."""
    budget = current()
    if budget.spent and work not in budget.left_out:
        budget.left_out.append(work)
    return not budget.spent
