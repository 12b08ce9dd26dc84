"""What is kept of one run: the variables of the results, and how a run of each kind makes them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ParamSpec, Protocol, TypeVar

from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.campaigns.study import Found


@dataclass(frozen=True)
class Variable:
    """A variable of the results, of which each sample has one value."""

    name: str
    unit: str
    text: str
    """SI unit, and what it is."""
    dims: tuple[str, ...] = ()
    """Names of the dimensions of one value."""
    coordinates: Mapping[str, Any] = field(default_factory=dict)
    """Of these dimensions."""
    units: Mapping[str, str] = field(default_factory=dict)
    """Units of the coordinates."""
    tolerance: float | None = None
    """Greatest deviation from the nominal value that is allowed."""
    measure: str = "value"
    """Either "series", "value", or the name of a statistic."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of one value."""
        return tuple(len(self.coordinates[dim]) for dim in self.dims)


Value = Floats | float | str | tuple[float, str]
"""An array, a number, a text, or a number with its unit where only some runs have it."""
Outcome = Mapping[str, Value]
"""Values by the name of their variable."""


class Runner(Protocol):
    """A kind of run, ready: it is sent to every worker, and holds all that a run needs but the arm."""

    variables: tuple[Variable, ...]
    """Those that every run has; a diagnosis adds what it finds."""

    @property
    def at_once(self) -> int:
        """Number of runs to be handed to `outcomes` together."""
        return 1

    def nominal(self, arm: Arm) -> list[Outcome]:
        """Run the nominal arm through every case, by default one; what runs are compared with is kept."""
        return [self.outcome(arm, 0)]

    def outcome(self, arm: Arm, case: int) -> Outcome:
        """Return what is kept of a run of one case."""
        ...

    def outcomes(self, arms: Sequence[Arm], cases: Sequence[int]) -> list[Outcome | Exception]:
        """Return what is kept of each run, or what it raised."""
        return [tried(self.outcome, arm, case) for arm, case in zip(arms, cases, strict=True)]


Args = ParamSpec("Args")
Made = TypeVar("Made")


def tried(make: Callable[Args, Made], *args: Args.args, **kwargs: Args.kwargs) -> Made | Exception:
    """Return what is made, or what that raised."""
    try:
        return make(*args, **kwargs)
    except Exception as error:  # a failed variant is a row, whatever it fails in
        return error


Prepared = tuple[Runner, Found]
"""A kind of run and what is wrong with the study's tables for it."""
