"""Robots: links one after the other on joints with reducers, as data; robot_chain.py makes rods of them.

A link points along z of its frame; joints turn about x, y or z of the one before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from chain import Base
from hub import Hub
from serial_chain import Floats

Angle = Callable[[Floats], tuple[Floats, Floats, Floats]]
"""phi, phi' and phi'' of a motor over its ratio at times [rad, s]."""
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Load:
    """A body at the end of a link: mass, centre from that end, inertia about the centre (all axes alike)."""

    mass: float = 0.0
    offset: Vector = (0.0, 0.0, 0.0)
    inertia: float = 0.0


@dataclass(frozen=True)
class Tube:
    """A beam along z; SI units. Bow and growth are reached as 1 - exp(-t/bow_time), or at once if it is 0.

    Attributes
    ----------
    bow : (x, y)
        Of the end, from uniform curvature.
    growth : float
        Stretch without a force [m].
    hardening : float
        Springs bear k x (1 + hardening |x|) [1/rad].
    """

    length: float
    EI: float
    GJ: float
    EA: float
    rho_A: float
    rho_I: float
    damping_ratio: float = 0.0
    load: Load = field(default_factory=Load)
    bow: tuple[float, float] = (0.0, 0.0)
    bow_time: float = 0.0
    growth: float = 0.0
    hardening: float = 0.0
    segments: int = 2

    @property
    def retardation(self) -> float:
        """2 zeta/omega_1 [s], omega_1 = 1.8751^2 sqrt(EI/(rho A L^4))."""
        return 2 * self.damping_ratio * self.length**2 / 1.875104069**2 * np.sqrt(self.rho_A / self.EI)


@dataclass(frozen=True)
class Block:
    """A rigid link: mass, its centre, inertia about it, and where its end is."""

    end: Vector
    mass: float
    com: Vector
    inertia: Vector


@dataclass(frozen=True)
class Turn:
    """A joint and the link it carries; `origin` is measured from the end of the link before.

    `rigid` in the hub means that the link follows the teeth.
    """

    name: str
    axis: str
    link_name: str
    link: Tube | Block
    hub: Hub = field(default_factory=Hub)
    origin: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Slosh:
    """A mass on a spring across the end of the last link, along x; kg, Hz and a ratio of damping."""

    mass: float
    frequency: float
    damping_ratio: float


@dataclass(frozen=True)
class Robot:
    """Turns one after the other on a base; what no vocabulary names: `drag` at the tip [N s2/m2], `slosh`,
    and `coupling`: the last motor turns by this part of the first one's angle besides.

    `tilt` turns the base about x and y; its compliance, in `base`, is about the first joint's axis.
    `planar`: nothing leaves the plane, so that rods bend about y alone.
    """

    turns: tuple[Turn, ...]
    planar: bool
    base: Base = field(default_factory=Base)
    tilt: tuple[float, float] = (0.0, 0.0)
    drag: float = 0.0
    slosh: Slosh | None = None
    coupling: float = 0.0
    gravity: float = 9.81

    def turn(self, name: str) -> Turn:
        """A joint by its name."""
        return next(turn for turn in self.turns if turn.name == name)

    def carried_by(self, link: str) -> Turn:
        """The joint that carries a link."""
        return next(turn for turn in self.turns if turn.link_name == link)

    def with_turn(self, turn: Turn) -> Robot:
        """The same with another joint or link in the place of one."""
        return replace(self, turns=tuple(turn if turn.name == old.name else old for old in self.turns))

    def with_hub(self, joint: str, **changes: float) -> Robot:
        """The same with another hub."""
        turn = self.turn(joint)
        return self.with_turn(replace(turn, hub=replace(turn.hub, **changes)))

    def with_link(self, link: str, **changes: object) -> Robot:
        """The same with another link."""
        turn = self.carried_by(link)
        return self.with_turn(replace(turn, link=replace(turn.link, **changes)))

    def with_load(self, link: str, **changes: object) -> Robot:
        """The same with another load at the end of a link."""
        return self.with_link(link, load=replace(self.carried_by(link).link.load, **changes))
