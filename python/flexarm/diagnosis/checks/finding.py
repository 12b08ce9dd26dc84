r"""What a channel looks like, as competing hypotheses about its sensor.

A hypothesis H (in order; flipped; in another unit; dead; cut off) leaves a scatter m_H of the N independent
samples. With an unknown scale (Jeffreys' prior) its likelihood is proportional to m_H^{-N}, so that against
a sensor that is in order

.. math:: \ln B_H = N \ln(m_{in order}/m_H) + \ln\text{prior}_H                                       (1)

Source: [Gregory2005], chapter 9: marginalising a scale parameter.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import log

import numpy as np

from flexarm.diagnosis.checks.channel import Channel
from flexarm.diagnosis.checks.regression import independent

PRIOR = log(1e-3)
"""Of a channel to be at fault, in (1)."""


@dataclass(frozen=True, eq=False)
class Finding:
    """One channel under its best hypothesis.

    Attributes
    ----------
    channel : Channel
        Which.
    name : str
        Of the fault, empty if in order.
    log_bayes : float
        (1).
    cost : float
        N ln m of the best hypothesis, less its prior; to compare models of other channels by.
    values : dict of str to (value, std, unit)
        The fault's parameters.
    sentence : str
        For a person: how, by how much.
    strange : bool
        Whether no hypothesis explains what the channel shows.
    frozen : tuple of int
        Rows of the signal that repeat a value; too few for a fault.
    """

    channel: Channel
    name: str = ""
    log_bayes: float = 0.0
    cost: float = 0.0
    values: Mapping[str, tuple[float, float, str]] = field(default_factory=dict)
    sentence: str = ""
    strange: bool = False
    frozen: tuple[int, ...] = ()

    @property
    def key(self) -> tuple[str, str, str]:
        """Fault, signal and channel."""
        return self.name, self.channel.signal.name, self.channel.name


def log_bayes(count: int, before: float, after: float) -> float:
    """(1)."""
    if not before > 0:
        return PRIOR  # there was nothing to explain
    return independent(count) * float(np.log(before / after)) + PRIOR


def cost(count: int, scatter: float) -> float:
    """N ln m."""
    return independent(count) * float(np.log(scatter))
