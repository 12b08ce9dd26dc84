"""All channels of a record, each under its best hypothesis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexarm.comparison.subject import Placement, Subject
from flexarm.diagnosis.checks.channel import Channel, channels
from flexarm.diagnosis.checks.finding import Finding
from flexarm.diagnosis.checks.placing import placing
from flexarm.diagnosis.checks.plateaus import dead_from, frozen, saturated
from flexarm.diagnosis.checks.slopes import judged

AT_ITS_ENDS = 0.8
"""Share of the repeated values that lie at the ends of the range, where a channel is cut off, not frozen."""


def findings(name: str, subject: Subject) -> list[Finding]:
    """What every channel of a record looks like beside one simulation of it."""
    placement = placing(subject)
    return [_finding(channel, subject, placement) for channel in channels(name, subject, placement)]


def _finding(channel: Channel, subject: Subject, placement: Placement) -> Finding:
    """One channel: its slope first, then its plateaus."""
    slope = judged(channel, subject, placement)
    if slope.name:
        return slope
    held, cut = frozen(channel), saturated(channel)
    if cut is not None and (held is None or np.mean(cut[1][held[0]]) > AT_ITS_ENDS):
        return cut[0]
    if held is None:
        return slope
    repeated = tuple(map(int, channel.rows[held[0]]))
    return dead_from(channel, *held) or replace(slope, frozen=repeated, sentence=held[1])
