"""The common grid on which the samples of all controllers fall."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil, isclose

import numpy as np

from flexarm import _core
from flexarm.arm.controller import Controller
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter


@dataclass(frozen=True)
class SampleGrid:
    """The sample instants of controllers, and the equal steps in between."""

    tick: float
    """Shortest sample time [s]."""
    every: Mapping[str, int]
    """Ticks from sample to sample, by joint."""
    substeps: int
    """Steps in a tick."""

    @classmethod
    def of(cls, controllers: Mapping[str, Controller], longest: float) -> SampleGrid:
        """Return the grid of some controllers; its step is the largest part of a tick up to `longest` [s].

        Raise InvalidParameter if the sample times have no common grid.
        """
        tick = min(controller.sample_time for controller in controllers.values())
        every = {name: _multiple(controller, tick) for name, controller in controllers.items()}
        return cls(tick, every, max(1, ceil(tick / longest - 1e-9)))

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.tick / self.substeps

    def times(self, options: _core.TransientOptions) -> Floats:
        """Return when ticks of a run begin [s], a little late so that a change at a tick counts."""
        count = ceil((options.end - options.start) / self.tick - 1e-9)
        return options.start + self.tick * (np.arange(count, dtype=np.float64) + 1e-6)

    def held(self, ticks: Floats, count: int) -> Floats:
        """Repeat values held over ticks, shape (tick, ...), at the first `count` instants of the run."""
        return np.concatenate([np.repeat(ticks, self.substeps, axis=0), ticks[-1:]])[:count]


def _multiple(controller: Controller, tick: float) -> int:
    ratio = controller.sample_time / tick
    if not isclose(ratio, round(ratio), rel_tol=1e-9):
        what = f"must be a multiple of the shortest sample time, {tick:g} s, got {controller.sample_time:g} s"
        raise InvalidParameter(what, where=f"controllers.{controller.joint}.sample_time")
    return round(ratio)
