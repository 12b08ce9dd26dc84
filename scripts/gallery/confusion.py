"""Shares of every effect's gap that every other effect could explain, in a set-up."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from gallery.experiments import MENU, POOR, RICH, Floats, Setup, paper_arm
from gallery.gaps import bench, stacked
from gallery.shares import LEFT, lasting, multiples, orthonormal, share_explained, without
from gallery.signatures import Signature, signature

FAINT = 3.0
"""Length of an aligned gap over its noise, all samples together, below which it is not seen."""
ALIKE = 0.95
"""R^2 from which an effect counts as confused with another one."""

TABLES = ("tabulated_law",)
"""Effects that take the shape of any law, hence nobody's rivals."""


@dataclass(frozen=True)
class Confusion:
    """R^2 in one set-up.

    Attributes
    ----------
    length : dict of str to float
        Of each effect's gap over the noise, all samples together.
    left : dict of str to float
        Share of that length which is left once clocks and frames are aligned.
    share : dict of str to (dict of str to float)
        R^2 of each effect's gap by each other one; empty where the gap is faint or aligned away.
    size : dict of str to (dict of str to float)
        How many times its typical size, or one sigma, the other one takes for that.
    """

    length: Mapping[str, float]
    left: Mapping[str, float]
    share: Mapping[str, Mapping[str, float]]
    size: Mapping[str, Mapping[str, float]]

    def rivals(self, name: str, least: float = ALIKE) -> dict[str, float]:
        """Effects that explain a share of at least `least`, the best first; of equals the smallest."""
        found = [rival for rival, r2 in self.share[name].items() if r2 >= least]
        found.sort(key=lambda rival: (-self._told(name, rival), self.size[name][rival]))
        return {rival: self.share[name][rival] for rival in found}

    def best(self, name: str) -> tuple[str, float]:
        """The effect that explains most of it, and how much."""
        return next(iter(self.rivals(name, least=-1.0).items()))

    def _told(self, name: str, rival: str) -> float:
        """R^2 as far as it is told: what differs less is alike."""
        return min(round(self.share[name][rival], 3), 0.999)


def nuisances(setup: Setup) -> Floats:
    """Basis of what a late tracker and its registration do, one clock and one frame for all runs."""
    each = {run: dict(bench(run, paper_arm()).nuisances()) for run in setup}
    labels = next(iter(each.values()))
    columns = [stacked({run: gaps[label] for run, gaps in each.items()}, setup) for label in labels]
    return orthonormal(np.stack(columns, axis=1))


def confusion(signatures: Iterable[Signature], setup: Setup) -> Confusion:
    """Every effect against every other one."""
    known = {each.name: each for each in signatures}
    basis = nuisances(setup)
    gap = {name: stacked(each.shown.gaps, setup) for name, each in known.items()}
    rest = {name: without(values[:, None], basis)[:, 0] for name, values in gap.items()}
    length = {name: float(np.linalg.norm(values)) for name, values in gap.items()}
    left = {name: float(np.linalg.norm(rest[name])) / max(length[name], 1e-300) for name in gap}
    columns = {name: lasting(_columns(each, setup), basis) for name, each in known.items()}
    spans = {name: orthonormal(found) for name, found in columns.items()}
    share: dict[str, dict[str, float]] = {name: {} for name in known}
    size: dict[str, dict[str, float]] = {name: {} for name in known}
    for name in known:
        if length[name] * left[name] < FAINT or left[name] < LEFT:
            continue
        for rival in known:
            if rival != name and rival not in TABLES:
                share[name][rival] = share_explained(rest[name], spans[rival])
                size[name][rival] = float(np.abs(multiples(rest[name], columns[rival])).max(initial=0.0))
    return Confusion(length, left, share, size)


def _columns(signature: Signature, setup: Setup) -> Floats:
    return np.stack([stacked(gaps, setup) for gaps in signature.columns.values()], axis=1)


@dataclass(frozen=True)
class Study:
    """Effects by name, and who explains whom in the poor set-up, with each addition, and in the rich one."""

    signatures: Mapping[str, Signature]
    poor: Confusion
    menu: Mapping[str, Confusion]
    rich: Confusion


def study(names: Iterable[str]) -> Study:
    """Simulates these effects on the paper's arm and compares them with one another."""
    found = {name: signature(name, paper_arm()) for name in names}
    menu = {label: confusion(found.values(), setup) for label, setup in MENU.items()}
    return Study(found, confusion(found.values(), POOR), menu, confusion(found.values(), RICH))
