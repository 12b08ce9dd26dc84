"""Energies of a run, recorded with it or computed when somebody asks for them.

To sum them takes a quarter of a run, and few are asked for. A run is the same to the last bit when it is
made again, so they can be recorded by a second one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flexarm import _core
from flexarm.arrays import Floats, read_only


@dataclass(frozen=True, eq=False)
class Energies:
    """Energies, and what damping took and drives gave since the start [J]; shape (n,) each."""

    kinetic: Floats
    elastic: Floats
    gravity: Floats
    damped: Floats
    work: Floats

    @classmethod
    def of(cls, run: _core.Transient, led: int = 0) -> Energies:
        """As the core recorded them after `led` instants; what sums up counts from there."""
        found = {name: getattr(run, name)[led:] for name in NAMES}
        if led:
            found |= {name: found[name] - found[name][0] for name in SUMS}
        return cls(**{name: read_only(values) for name, values in found.items()})


NAMES = ("kinetic", "elastic", "gravity", "damped", "work")
SUMS = ("damped", "work")


def energies_of(
    found: _core.Transient,
    system: _core.System,
    equilibrium: _core.Equilibrium,
    motions: list[_core.PiecewisePolynomial],
    options: _core.TransientOptions,
    led: int,
) -> Energies | Callable[[], Energies]:
    """Recorded, or how to get them."""
    if options.record_energies:
        return Energies.of(found, led)
    return _recorded_again(system, equilibrium, motions, options, float(found.time[-1]), led)


def _recorded_again(
    system: _core.System,
    equilibrium: _core.Equilibrium,
    motions: Sequence[_core.PiecewisePolynomial],
    options: _core.TransientOptions,
    end: float,
    led: int,
) -> Callable[[], Energies]:
    """Makes the same run once more up to `end` [s], for its energies alone."""

    def run() -> Energies:
        again = _core.TransientOptions()
        for name in ("start", "step", "alpha", "tolerance", "dimension"):
            setattr(again, name, getattr(options, name))
        again.end = end
        again.record_points = again.record_joints = False
        again.record_energies = True
        return Energies.of(_core.simulate(system, equilibrium, list(motions), again), led)

    return run
