"""Energies of a run, recorded with it or computed on demand.

They take a quarter of a run, and few are needed. A second run records them: it repeats the first bit by bit.
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
        """Return the energies that the core recorded after `led` instants; sums count from there."""
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
    """Return the recorded energies, or a function that computes them."""
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
    """Return a function that repeats the run up to `end` [s] for its energies alone."""

    def run() -> Energies:
        again = _core.TransientOptions()
        for name in ("start", "step", "alpha", "tolerance", "dimension"):
            setattr(again, name, getattr(options, name))
        again.end = end
        again.record_points = again.record_joints = False
        again.record_energies = True
        return Energies.of(_core.simulate(system, equilibrium, list(motions), again), led)

    return run
