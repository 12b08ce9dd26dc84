"""Check of a law that is a part of the model: the gap of records that were fitted, and of those held out."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import cached_property

from flexarm.arm import Arm
from flexarm.comparison.pooled_gap import pooled_gap
from flexarm.diagnosis.verification import Gaps, SplitRecords
from flexarm.law_curve import LawGap
from flexarm.missing_law.policy import LawPolicy


@dataclass(frozen=True, eq=False)
class LawCheck:
    """Records to check laws with, and the model without one."""

    records: SplitRecords
    """What was fitted, and what was held out."""
    stated: Arm
    updated: Arm
    """The nominal model as it was given, and the one that a diagnosis repaired without a law."""
    signal: str

    @cached_property
    def before(self) -> Gaps:
        """Gap of the model without a law by record."""
        return self.records.gaps(self.updated)

    def gaps(self, arm: Arm) -> tuple[LawGap, LawGap]:
        """Return the gap without and with a law, as `flexarm compare` prints it: fitted, and held out."""
        after = self.records.gaps(arm)
        train, held_out = (
            LawGap(**asdict(pooled_gap(self.before, after, names, self.signal)))
            for names in (self.records.training, self.records.held_out)
        )
        return train, held_out

    def accepts(self, held_out: LawGap, policy: LawPolicy) -> bool:
        """Return True if a law predicts enough of what was held out."""
        if held_out.before_rms is None or held_out.after_rms is None:
            return False
        return held_out.after_rms < (1 - policy.least_closed) * held_out.before_rms
