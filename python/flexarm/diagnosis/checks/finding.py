r"""What a channel looks like, as competing hypotheses about its sensor.

A hypothesis H (in order; flipped; in another unit; dead; cut off) leaves a scatter m_H of the N independent
samples. With an unknown scale (Jeffreys' prior) its likelihood is proportional to m_H^{-N}, so that against
a sensor that is in order

.. math:: \ln B_H = N \ln(m_{in order}/m_H) + \ln\text{prior}_H                                       (1)

Whether the channels or the drive are at fault is a question to all of them. Each explanation costs, summed
over the channels,

.. math:: N \ln \max(left, least) + \tfrac12 \sum_j a_j^2/S_j^2 - \ln\text{prior}                    (2)

with what it leaves and how far it strains what is no fault (`checks.regression`). `least` is that of the
readings and the same for all explanations: were it a share of the motion that each one claims, a sensor that
is said to show a thousandth of a wild motion would explain quiet readings better than the truth does.

Source: [Gregory2005], chapter 9: marginalising a scale parameter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import log

import numpy as np

from flexarm.diagnosis.checks.channel import Channel
from flexarm.diagnosis.checks.regression import independent

PRIOR = log(1e-3)
"""Of a channel to be at fault, in (1)."""
NOTHING = 1e-12
"""What is left at least: readings and prediction may both stand at 0 [SI]."""


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
        (2) of the best hypothesis, less its prior; to compare explanations of all channels by.
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


def cost(channel: Channel, left: float, strain: float = 0.0) -> float:
    """(2) of a hypothesis that leaves so much, and strains what is no fault by so much."""
    return independent(len(channel.rows)) * float(np.log(max(left, channel.least, NOTHING))) + strain


def cost_of_all(found: Sequence[Finding]) -> float:
    """(2) of all channels; those of one sensor that have one fault share its prior."""
    named = [(each.name, each.channel.signal.name) for each in found if each.name]
    return sum(each.cost for each in found) + PRIOR * (len(named) - len(set(named)))
