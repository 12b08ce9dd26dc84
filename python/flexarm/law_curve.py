"""A missing law as data: a curve of a motion or force over a state, where it sits and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from flexarm.fit_statistics import PooledGap

LawKind = Literal["law", "law with memory", "change", "time", "none"]


LawGap = PooledGap
"""Gap of the main signal without and with a law; None where the law predicts nothing."""


@dataclass(frozen=True)
class LawCurve:
    """A missing law."""

    at: str
    quantity: str
    """Place and what is missing there: "windup", "torque", "offset"; of slow motions with their
    direction, such as "rotation about x", "curvature towards y", "force along x and z"."""
    of: str
    """State that the curve is a function of."""
    unit: str
    of_unit: str
    """Of the curve and of the state."""
    x: tuple[float, ...]
    value: tuple[float, ...]
    low90: tuple[float, ...]
    high90: tuple[float, ...]
    """The curve with its 90 % band. Of a law with memory the branch of rising angles stands first, then that
    of falling ones, backwards; of a change the curve after the instant."""
    kind: LawKind
    """What was found: "law", "law with memory", "change", "time", "none"."""
    instant_s: float | None
    """When a law changes [s]."""
    probability: float
    """Among the laws that are shown."""
    says: str
    """The curve in one sentence."""
    train: LawGap = field(default_factory=LawGap)
    held_out: LawGap = field(default_factory=LawGap)
    """The gap without and with the law."""
    cloud_x: tuple[float, ...] = ()
    cloud_value: tuple[float, ...] = ()
    """The latent motion against the state, which no curve was assumed for."""
    instant90: tuple[float, ...] = ()
    """90 % interval of the instant [s]; empty without one."""
